//! Law: a study of recorded frames of simulated touches gives the results of the simulated study, for any signal.

use crate::command::Case;
use crate::generated::generator::GeneratedStudy;
use crate::generated::recorded::is_recorded_as_simulated;
use bubbletouch::signal::SENSOR_ERRORS;
use ndarray::{Array4, Array5, Axis, concatenate};

const PRESSED: &str = include_str!("../../fixtures/texts/recorded_law_pressed.toml");

const HUMAN: &str = include_str!("../../fixtures/texts/recorded_law_human.toml");

const LEARNED: &str = "[sensing]\nmeasurements = 12\n[recognition]\nclassifier = \"linear_svm\"\n";

const HEAD: &str = "question = \"?\"\ntrials = 2\n";

/// Runs a study into `simulated`, and exports its touches into `touches`.
fn simulated(study: &str) -> Case {
    let case = Case::with("study.toml", format!("{HEAD}{study}"));
    case.succeeds("run study.toml --out simulated");
    case.succeeds("touches study.toml --out touches");
    case
}

/// Asserts that a study gives the tables of the study of its exported touches.
fn is_the_same(touched: &str, skin: &str, rest: &str) {
    let table = toml::from_str(&format!("{HEAD}{touched}\n{skin}\n{rest}")).unwrap();
    assert!(is_recorded_as_simulated(&GeneratedStudy { table }));
}

const SKIN: &str = "[skin]\npitch_mm = 4.0\ntaxels = 8\nstroke_mm = 5.0\n";

/// Tests every sensor error alone and after noise, with one frame and with several frames per touch.
#[test]
fn recorded_touches_give_the_results_of_the_simulated_ones_for_every_sensor_error() {
    let mut steps = Vec::new();
    let mut keys = String::new();
    for error in SENSOR_ERRORS {
        let about = error.about();
        let value = match about.step {
            "quantisation" => "8",
            "scan" => "20.0",
            "matrix_readout" => continue,
            _ => "0.1",
        };
        let touched = match (about.needs_motion, about.remembers) {
            (true, _) => format!("{PRESSED}frames = 3\nspeed_mm_per_s = 20.0\n"),
            (false, true) => format!("{PRESSED}frames = 3\n"),
            (false, false) => PRESSED.to_owned(),
        };
        let step = about.step;
        let own = about.strengths.iter();
        let own: String = own.map(|s| format!("{} = {value}\n", s.key)).collect();
        let noise = "noise_std_full_scale = 0.02\n";
        let signal = format!("[signal]\nsteps = [\"{step}\", \"noise\"]\n{noise}{own}");
        is_the_same(&touched, SKIN, &(signal + LEARNED));
        steps.push(format!("{step:?}"));
        keys += &own;
    }
    // All sensor errors together, on touches that continue while they are read, with a damper.
    let steps = steps.join(", ");
    let signal = format!("[signal]\nsteps = [\"force\", {steps}]\n{keys}");
    let touched = format!("{PRESSED}frames = 2\nspeed_mm_per_s = 20.0\n");
    let damped = format!("{SKIN}damping_n_s_per_m = 0.3\n");
    is_the_same(&touched, &damped, &(signal + LEARNED));
}

#[test]
fn recorded_human_touches_give_the_results_of_the_simulated_ones() {
    let skin = "[skin]\npitch_mm = 12.0\ntaxels = 8\nstroke_mm = 6.0\n";
    let signal = "[signal]\nsteps = [\"hysteresis\", \"gain\", \"noise\"]\nhysteresis_full_scale = [0.0, 0.2]\ngain_std = 0.1\nnoise_std_full_scale = 0.02\n";
    let features = "temporal_features = [\"deepest\", \"course\"]\n";
    is_the_same(HUMAN, skin, &format!("{signal}{LEARNED}{features}"));
}

#[test]
fn recorded_touches_of_skins_that_read_shear_and_of_other_layouts_give_the_results_of_the_simulated_ones()
 {
    let signal = "[signal]\nsteps = [\"hysteresis\", \"noise\"]\nhysteresis_full_scale = 0.2\nnoise_std_full_scale = 0.02\n";
    let rest = format!("{signal}{LEARNED}");
    let shear = format!("{SKIN}sensed = \"shear\"\nfriction = 0.5\n");
    is_the_same(PRESSED, &shear.replace("friction = 0.5\n", ""), &rest);
    let sliding = format!("{PRESSED}frames = 3\nslide_mm = 3.0\n");
    is_the_same(&sliding, &shear, &rest);
    is_the_same(PRESSED, &format!("{SKIN}layout = \"hexagonal\"\n"), &rest);
}

/// Tests that a minimal recording has the same touch history as the simulated touches.
#[test]
fn recorded_touches_come_after_others_as_simulated_ones_do() {
    let rest = format!(
        "[signal]\nsteps = [\"hysteresis\", \"noise\"]\nhysteresis_full_scale = [0.0, 0.2]\nnoise_std_full_scale = 0.02\n{LEARNED}"
    );
    let case = simulated(&format!("{PRESSED}{SKIN}{rest}"));
    let skin = SKIN.replace("taxels = 8\n", "");
    let run = |name: &str, more: &str| {
        let recorded = "[recorded]\nframes = \"frames.npy\"\nlabels = \"labels.npy\"\nnames = [\"golf\", \"tennis\", \"baseball\"]\nfull_scale = 5e-3\n";
        let file = format!("{name}.toml");
        case.file(&file, format!("{HEAD}{recorded}{more}{skin}{rest}"));
        case.succeeds(&["run", &file, "--objects", "touches", "--out", name]);
    };
    run("recorded", "");
    // The history has an effect.
    run("fresh", "previous_touch = \"none\"\n");
    let [expected, recorded, fresh] = ["simulated", "recorded", "fresh"]
        .map(|folder| case.read(&format!("{folder}/accuracy.csv")));
    assert_eq!(recorded, expected);
    assert_ne!(fresh, expected);
}

/// Tangential forces in a separate file give the same frames as all values in one file; tests/refusals/recorded_shear.toml has files that do not match.
#[test]
fn shear_in_a_file_of_its_own_is_joined_to_the_frames() {
    let touched = PRESSED.replace("per_object = 6", "per_object = 6\nframes = 2");
    let case = simulated(&format!("{touched}{SKIN}sensed = \"shear\"\n{LEARNED}"));
    let frames: Array4<f32> = case.read_array("touches/frames.npy");
    let shear: Array5<f32> = case.read_array("touches/shear.npy");
    let all = concatenate![Axis(2), frames.clone().insert_axis(Axis(2)), shear];
    case.write_array("touches/all.npy", &all);
    // The first four touches of each class are training touches.
    for (set, is_test) in [("a", false), ("b", true)] {
        let path = |name: &str| format!("touches/{name}_{set}.npy");
        let touches = (0..18).filter(|touch| (touch % 6 >= 4) == is_test);
        let touches: Vec<usize> = touches.collect();
        case.write_array(&path("frames"), &frames.select(Axis(0), &touches));
        case.write_array(&path("shear"), &shear.select(Axis(0), &touches));
        case.write_array(&path("all"), &all.select(Axis(0), &touches));
        case.write_integers(&path("labels"), touches.iter().map(|touch| touch / 6));
    }
    // The study is beside its files, so paths are relative to the folder of the study.
    let run = |keys: &str, sensed: &str| {
        let key = |key: &str| {
            let (key, name) = key.split_once(' ').unwrap();
            format!("{key} = \"{name}.npy\"\n")
        };
        let keys: String = keys.split(", ").map(key).collect();
        let skin = format!("[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n{sensed}");
        let text = format!("{HEAD}[recorded]\n{keys}full_scale = 5e-3\n{skin}{LEARNED}");
        case.file("touches/study.toml", text);
        case.run("run touches/study.toml --fresh --out out")
    };
    let sensed = "sensed = \"shear\"\nfriction = 0.5\n";
    let table = |keys: &str| {
        let ran = run(keys, sensed);
        assert!(ran.status.success(), "{ran:?}");
        case.read("out/accuracy.csv")
    };
    let labels = "labels labels";
    let one = table(&format!("frames all, {labels}"));
    assert_eq!(table(&format!("frames frames, shear shear, {labels}")), one);
    let sets = "frames frames_a, frames_test frames_b";
    let test = "labels labels_a, labels_test labels_b";
    let one = table(&format!("frames all_a, frames_test all_b, {test}"));
    let two = format!("{sets}, shear shear_a, shear_test shear_b, {test}");
    assert_eq!(table(&two), one);
}

/// Creates a folder of 18 touches of two frames with their shear, all together and divided into 12 training touches (`_a`) and 6 test touches (`_b`).
pub fn with_shear() -> Case {
    let case = Case::new();
    for (set, n) in [("", 18), ("_a", 12), ("_b", 6)] {
        let frames = Array4::from_shape_fn((n, 2, 8, 8), |(touch, ..)| touch as f32);
        case.write_array(&format!("frames{set}.npy"), &frames);
        let shear = Array5::<f32>::ones((n, 2, 2, 8, 8));
        case.write_array(&format!("shear{set}.npy"), &shear);
        let labels = (0..n).map(|touch| touch % 3);
        case.write_integers(&format!("labels{set}.npy"), labels);
    }
    case
}
