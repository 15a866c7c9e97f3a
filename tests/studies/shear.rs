//! Readings of taxels that measure forces along and across their axes, for touches that slide.

use crate::command::Case;
use crate::study::{Study, laid_out};
use bubbletouch::contact::{Approach, FrictionState, Workspace};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::simulate_array;
use bubbletouch::world::{Shear, Shears};
use glam::{DVec2, DVec3};
use ndarray::{Array2, Array3, Array4, s};

const STUDY: &str = r#"
question = "?"

[objects]
sets = ["balls"]
names = ["golf", "tennis", "baseball"]

[skin]
pitch_mm = 4.0
taxels = 8
stroke_mm = 5.0
stiffness_n_per_m = 200.0
sensed = "shear"
friction = 0.4
shear_stiffness_n_per_m = 300.0

[touches]
per_object = 12
offset_x_mm = { uniform = [-6.0, 6.0] }
offset_y_mm = { uniform = [-6.0, 6.0] }
depth_mm = [2.0, 7.0]
slide_mm = 3.0
slide_deg = 30.0

[signal]
noise_std_full_scale = 0.05

[sensing]
ensemble = "identity"

[recognition]
classifier = "linear_svm"
test_fraction = 0.25
"#;

const N_TAXELS: usize = 64;

fn with(old: &str, new: &str) -> String {
    let text = STUDY.replace(old, new);
    assert!(text != STUDY, "{old}");
    text
}

/// Returns the features that a study of one configuration gives its classifier: touches × values of a frame.
fn read(text: &str) -> Array2<f64> {
    let study = laid_out(text).unwrap();
    let features = study.first().features((0, 0), &Silent).unwrap();
    features.data.records().to_owned()
}

#[test]
fn frames_are_those_of_the_skin_pressed_and_drawn_by_hand() {
    let study = Study::new(STUDY);
    let array = &study.plan.arrays[0];
    let n_frames = 4;
    let frames = simulate_array(&study.touched, array, n_frames, &Silent);
    let frames = frames.to_array();
    assert_eq!(frames.ncols(), 3 * N_TAXELS);
    let shear = Shear {
        stiffness: 300.0,
        friction: 0.4,
    };
    let skin = array.patch();
    let approach = Approach::new(skin, DVec3::Z).unwrap();
    let mut friction = FrictionState::at_rest(skin, Shears::Equal(shear)).unwrap();
    let mut workspace = Workspace::new();
    let along = DVec2::from_angle(30_f64.to_radians()).extend(0.0);
    let mut row = 0;
    for object in &study.touched {
        for touch in &object.touches {
            let pose = touch.patch_from_object(&object.rests[touch.rest]);
            for frame in 1..=n_frames {
                let way = (touch.depth + 3e-3) * frame as f64 / n_frames as f64;
                let motion = (way.min(touch.depth), (way - touch.depth).max(0.0) * along);
                let model = [object.object.model.clone()];
                let state = Some(&mut friction);
                approach.press_and_slide(&model, &[pose], motion, state, &mut workspace);
                for taxel in 0..N_TAXELS {
                    let force = friction.force3()[taxel];
                    let felt = [workspace.deflections()[taxel], force.x, force.y];
                    for (channel, expected) in felt.into_iter().enumerate() {
                        let found = frames[[row, channel * N_TAXELS + taxel]];
                        let off = (found - expected).abs();
                        assert!(off < 1e-6 * expected.abs() + 1e-9, "row {row}: {found}");
                    }
                }
                row += 1;
            }
        }
    }
    assert_eq!(row, frames.nrows());
}

#[test]
fn each_channel_has_noise_of_its_own_and_the_first_is_the_force() {
    let clean = |text: &str| text.replace("= 0.05", "= 0.0");
    let (felt, noisy) = (read(&clean(STUDY)), read(STUDY));
    let force = with("\"shear\"", "\"force\"")
        .replace("friction = 0.4\nshear_stiffness_n_per_m = 300.0\n", "");
    assert_eq!(read(&force), noisy.slice(s![.., ..N_TAXELS]));
    let deflection = force
        .replace("sensed = \"force\"\n", "")
        .replace("stiffness_n_per_m = 200.0\n", "");
    let deflection = read(&clean(&deflection));
    let normal = felt.slice(s![.., ..N_TAXELS]);
    for (force, deflection) in normal.iter().zip(&deflection) {
        assert!((force - 200.0 * deflection).abs() < 1e-12);
    }
    // σ is 5 % of 5 mm · 200 N/m, equal on each channel.
    let noise = (&noisy - &felt) / 0.05;
    let channels = [0, 1, 2].map(|c| noise.slice(s![.., c * N_TAXELS..(c + 1) * N_TAXELS]));
    let n = channels[0].len() as f64;
    for (a, first) in channels.iter().enumerate() {
        for (b, second) in channels.iter().enumerate().skip(a) {
            let product = (first * second).sum() / n;
            let (expected, error) = if a == b {
                (1.0, 2f64.sqrt())
            } else {
                (0.0, 1.0)
            };
            // Five standard errors of this number of independent draws.
            let off = (product - expected).abs();
            assert!(off < 5.0 * error / n.sqrt(), "{a} {b}: {product}");
        }
    }
    // Shear has both signs, and is larger than rounding errors.
    let shear = felt.slice(s![.., N_TAXELS..]);
    assert!(shear.iter().any(|&f| f > 0.05) && shear.iter().any(|&f| f < -0.05));
}

#[test]
fn converters_and_faults_take_shear_of_either_sign() {
    let errors = "steps = [\"faults\", \"quantisation\"]\nadc_bits = 3\nstuck_fraction = 0.5\n";
    let text = with("noise_std_full_scale = 0.05\n", errors);
    let read = read(&text);
    let of = |channel: usize| {
        let values = read.slice(s![.., channel * N_TAXELS..(channel + 1) * N_TAXELS]);
        values
            .iter()
            .copied()
            .fold([0.0, 0.0], |[least, most], v| [v.min(least), v.max(most)])
    };
    assert_eq!(of(0), [0.0, 1.0]);
    for channel in [1, 2] {
        assert_eq!(of(channel), [-1.0, 1.0]);
    }
    let codes = |channel: usize| {
        let values = read.slice(s![.., channel * N_TAXELS..(channel + 1) * N_TAXELS]);
        let mut codes: Vec<i64> = values.iter().map(|v| (v * 1e9).round() as i64).collect();
        codes.sort_unstable();
        codes.dedup();
        codes.len()
    };
    assert!((0..3).all(|channel| codes(channel) == 8));
}

#[test]
fn what_is_sensed_is_an_axis() {
    let text = with("sensed = \"shear\"\n", "")
        .replace("ensemble = \"identity\"", "measurements = 16")
        + "[axes]\n\"skin.sensed\" = [\"deflection\", \"force\", \"shear\"]\n";
    let tables = laid_out(&text).unwrap().run(&Silent).unwrap();
    let ratios = tables
        .summary
        .iter()
        .map(|(configuration, _)| configuration.ratio);
    assert_eq!(ratios.collect::<Vec<_>>(), [4.0, 4.0, 12.0]);
    let scores = |number: usize| {
        let rows = tables.accuracy.iter();
        let rows = rows.filter(|(configuration, _)| configuration.variant.number == number);
        rows.map(|(_, score)| score.n_correct).collect::<Vec<_>>()
    };
    // A force is a deflection in another unit.
    assert_eq!(scores(0), scores(1));
}

#[test]
fn what_contradicts_itself_is_refused_by_its_key() {
    for (text, expected) in [
        (
            with("friction = 0.4\n", ""),
            "study.toml, key skin.sensed: shear; skin.friction beside it",
        ),
        (
            with("\"shear\"", "\"force\""),
            "study.toml, key skin.friction: 0.4, but the skin reads no shear; skin.sensed = \"shear\" beside it, or no such key",
        ),
        (
            with("slide_mm = 3.0\n", ""),
            "study.toml, key touches.slide_deg: 30, but touches do not slide; touches.slide_mm above 0 beside it, or no such key",
        ),
        (
            with("slide_mm = 3.0\nslide_deg = 30.0\n", ""),
            "study.toml, key skin.friction: 0.4, but tips stay where they first touch; a touches.slide_mm above 0 or a curved skin.layout beside it",
        ),
        (
            with("per_object", "speed_mm_per_s = 5.0\nper_object"),
            "study.toml, key touches.speed_mm_per_s: 5; 0 where skin.sensed is shear, and where touches slide",
        ),
        (
            with("[signal]", "[signal]\nsteps = [\"force\", \"noise\"]"),
            "study.toml, key signal.steps: force; no such step where skin.sensed is a force from the first step on",
        ),
        (
            with("noise_std_full_scale", "noise_std_mm"),
            "study.toml, key signal.noise_std_mm: millimetres of noise on a force; noise_std_n or noise_std_full_scale, or noise before force in signal.steps",
        ),
        (
            with("friction = 0.4", "friction = -0.4"),
            "study.toml, key skin.friction: -0.4; zero or a positive number, at least 1e-12",
        ),
    ] {
        assert_eq!(Study::error(&text), expected);
    }
    let matrix = with(
        "noise_std_full_scale = 0.05",
        "steps = [\"matrix_readout\"]\nline_resistance = 0.01",
    );
    assert!(Study::error(&matrix).contains("a resistance has no sign"));
}

#[test]
fn the_command_writes_channels_of_their_own() {
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.succeeds(&["touches", "study.toml", "--out", "touches"]);
    let frames: Array3<f32> = ndarray_npy::read_npy(case.path("touches/frames.npy")).unwrap();
    assert_eq!(frames.dim(), (36, 8, 8));
    let shear: Array4<f32> = ndarray_npy::read_npy(case.path("touches/shear.npy")).unwrap();
    assert_eq!(shear.dim(), (36, 2, 8, 8));
    assert!(shear.iter().any(|&force| force != 0.0));
    assert!(!case.path("touches/taxels.npy").exists());
    case.succeeds(&["run", "study.toml", "--out", "results"]);
}
