//! Readings of taxels that measure forces along and across their axes, for touches that slide.

use crate::command::Case;
use crate::study::{Study, changed, features, run, scores_of_variant};
use bubbletouch::contact::{FrictionState, Press, Until, Workspace};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::simulate_array;
use bubbletouch::world::{Shear, Shears};
use glam::DVec2;
use ndarray::{Array2, Array3, Array4, s};
use std::collections::BTreeSet;

const STUDY: &str = include_str!("../fixtures/texts/shear.toml");

const N_TAXELS: usize = 64;

/// Returns the study with another text in the place of one that it contains.
fn with(old: &str, new: &str) -> String {
    changed(STUDY, &[(old, new)])
}

/// Returns the features that a study of one configuration gives its classifier: touches × values of a frame.
fn read(text: &str) -> Array2<f64> {
    features(text, (0, 0)).data.records
}

#[test]
fn frames_are_those_of_the_skin_pressed_and_drawn_by_hand() {
    let study = Study::new(STUDY);
    let array = &study.plan.array;
    let n_frames = 4;
    let frames = simulate_array(&study.touched, array, n_frames, &Silent);
    let frames = frames.to_array();
    assert_eq!(frames.ncols(), 3 * N_TAXELS);
    let shear = Shear {
        stiffness: 300.0,
        friction: 0.4,
    };
    let skin = array.patch();
    let mut friction = FrictionState::at_rest(skin, Shears::Equal(shear)).unwrap();
    let mut workspace = Workspace::new();
    let along = DVec2::from_angle(30_f64.to_radians()).extend(0.0);
    let mut row = 0;
    for object in &study.touched {
        for touch in &object.touches {
            let pose = touch.patch_from_object(&object.rests[touch.rest]);
            for frame in 1..=n_frames {
                let way = (touch.depth + 3e-3) * frame as f64 / n_frames as f64;
                let slide = (way - touch.depth).max(0.0) * along;
                let model = [object.object.model.clone()];
                let state = Some(&mut friction);
                let until = Until::Depth(way.min(touch.depth));
                Press::new(skin, &model, &[pose], until)
                    .slide(slide, state, &mut workspace)
                    .unwrap();
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
            let expected = f64::from(u8::from(a == b));
            let error = (1.0 + expected).sqrt();
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
    for (channel, least) in [(0, 0.0), (1, -1.0), (2, -1.0)] {
        let values = read.slice(s![.., channel * N_TAXELS..(channel + 1) * N_TAXELS]);
        let codes = values.iter().map(|v| (v * 1e9).round() as i64);
        let codes: BTreeSet<i64> = codes.collect();
        assert_eq!(codes.len(), 8);
        assert_eq!(values.fold(0.0, |low: f64, v| low.min(*v)), least);
        assert_eq!(values.fold(0.0, |high: f64, v| high.max(*v)), 1.0);
    }
}

#[test]
fn what_is_sensed_is_an_axis() {
    let text = with("sensed = \"shear\"\n", "")
        .replace("ensemble = \"identity\"", "measurements = 16")
        + "[axes]\n\"skin.sensed\" = [\"deflection\", \"force\", \"shear\"]\n";
    let tables = run(&text);
    let ratios = tables.summary.iter().map(|(of, _)| of.ratio);
    assert_eq!(ratios.collect::<Vec<_>>(), [4.0, 4.0, 12.0]);
    // A force is a deflection in another unit.
    let [deflection, force] = [0, 1].map(|number| scores_of_variant(&tables.accuracy, number));
    for (deflection, force) in deflection.iter().zip(&force) {
        assert_eq!(deflection.n_correct, force.n_correct);
    }
}

#[test]
fn the_command_writes_channels_of_their_own() {
    let case = Case::with("study.toml", STUDY);
    case.succeeds("touches study.toml --out touches");
    let frames: Array3<f32> = case.read_array("touches/frames.npy");
    assert_eq!(frames.dim(), (36, 8, 8));
    let shear: Array4<f32> = case.read_array("touches/shear.npy");
    assert_eq!(shear.dim(), (36, 2, 8, 8));
    assert!(shear.iter().any(|&force| force != 0.0));
    assert!(!case.path("touches/taxels.npy").exists());
    case.succeeds("run study.toml --out results");
}
