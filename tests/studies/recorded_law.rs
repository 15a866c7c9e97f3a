//! Law: a study of recorded frames of simulated touches gives the results of the simulated study, for any signal.

use crate::command::{Case, says, words};
use bubbletouch::signal::SENSOR_ERRORS;
use bubbletouch::study::{write_integers, write_npy};
use ndarray::{Array4, Array5, Axis, concatenate};
use ndarray_npy::read_npy;

const PRESSED: &str = include_str!("../fixtures/texts/recorded_law_pressed.toml");

const HUMAN: &str = include_str!("../fixtures/texts/recorded_law_human.toml");

const LEARNED: &str = "[sensing]\nmeasurements = 12\n[recognition]\nclassifier = \"linear_svm\"\n";

const TABLES: [&str; 4] = [
    "accuracy.csv",
    "summary.csv",
    "confusion.csv",
    "comparison.csv",
];

/// Runs a study, exports its touches, and runs the study of the exported touches.
fn is_the_same(touched: &str, skin: &str, rest: &str) {
    let case = Case::new();
    let head = "question = \"?\"\ntrials = 2\n";
    case.file("study.toml", format!("{head}{touched}\n{skin}\n{rest}"));
    case.succeeds(&["run", "study.toml", "--out", "simulated"]);
    case.succeeds(&["touches", "study.toml", "--out", "touches"]);
    let tables = std::fs::read_to_string(case.path("touches/recorded.toml")).unwrap();
    case.file("recorded.toml", format!("{head}{tables}\n{rest}"));
    case.succeeds(&words("run recorded.toml --objects touches --out recorded"));
    for name in TABLES {
        let read = |folder: &str| std::fs::read_to_string(case.path(folder).join(name)).ok();
        assert_eq!(
            read("recorded"),
            read("simulated"),
            "{name}\n{touched}{skin}{rest}"
        );
    }
    let counts = |folder: &str| {
        let limits = std::fs::read_to_string(case.path(folder).join("limits.csv")).unwrap();
        let rows = limits
            .lines()
            .map(|row| row.split(',').take(3).collect::<Vec<_>>().join(","));
        rows.collect::<Vec<_>>()
    };
    assert_eq!(
        counts("recorded"),
        counts("simulated"),
        "{touched}{skin}{rest}"
    );
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
        let own: String = about
            .strengths
            .iter()
            .map(|s| format!("{} = {value}\n", s.key))
            .collect();
        let signal = format!(
            "[signal]\nsteps = [\"{step}\", \"noise\"]\nnoise_std_full_scale = 0.02\n{own}"
        );
        is_the_same(&touched, SKIN, &(signal + LEARNED));
        steps.push(format!("{step:?}"));
        keys += &own;
    }
    // All sensor errors together, on touches that continue while they are read, with a damper.
    let signal = format!(
        "[signal]\nsteps = [\"force\", {}]\n{keys}",
        steps.join(", ")
    );
    let touched = format!("{PRESSED}frames = 2\nspeed_mm_per_s = 20.0\n");
    is_the_same(
        &touched,
        &format!("{SKIN}damping_n_s_per_m = 0.3\n"),
        &(signal + LEARNED),
    );
}

#[test]
fn recorded_human_touches_give_the_results_of_the_simulated_ones() {
    let skin = "[skin]\npitch_mm = 12.0\ntaxels = 8\nstroke_mm = 6.0\n";
    let signal = "[signal]\nsteps = [\"hysteresis\", \"gain\", \"noise\"]\nhysteresis_full_scale = [0.0, 0.2]\ngain_std = 0.1\nnoise_std_full_scale = 0.02\n";
    is_the_same(
        HUMAN,
        skin,
        &format!("{signal}{LEARNED}temporal_features = [\"deepest\", \"course\"]\n"),
    );
}

#[test]
fn recorded_touches_of_skins_that_read_shear_and_of_other_layouts_give_the_results_of_the_simulated_ones()
 {
    let signal = "[signal]\nsteps = [\"hysteresis\", \"noise\"]\nhysteresis_full_scale = 0.2\nnoise_std_full_scale = 0.02\n";
    let rest = format!("{signal}{LEARNED}");
    let shear = format!("{SKIN}sensed = \"shear\"\nfriction = 0.5\n");
    is_the_same(PRESSED, &shear.replace("friction = 0.5\n", ""), &rest);
    is_the_same(
        &format!("{PRESSED}frames = 3\nslide_mm = 3.0\n"),
        &shear,
        &rest,
    );
    is_the_same(PRESSED, &format!("{SKIN}layout = \"hexagonal\"\n"), &rest);
}

/// Tests that a minimal recording has the same touch history as the simulated touches.
#[test]
fn recorded_touches_come_after_others_as_simulated_ones_do() {
    let case = Case::new();
    let head = "question = \"?\"\ntrials = 2\n";
    let rest = format!(
        "[signal]\nsteps = [\"hysteresis\", \"noise\"]\nhysteresis_full_scale = [0.0, 0.2]\nnoise_std_full_scale = 0.02\n{LEARNED}"
    );
    case.file("study.toml", format!("{head}{PRESSED}{SKIN}{rest}"));
    case.succeeds(&["run", "study.toml", "--out", "simulated"]);
    case.succeeds(&["touches", "study.toml", "--out", "touches"]);
    let recorded = "[recorded]\nframes = \"frames.npy\"\nlabels = \"labels.npy\"\nnames = [\"golf\", \"tennis\", \"baseball\"]\nfull_scale = 5e-3\n";
    let skin = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n";
    case.file("recorded.toml", format!("{head}{recorded}{skin}{rest}"));
    case.succeeds(&words("run recorded.toml --objects touches --out recorded"));
    let read =
        |folder: &str| std::fs::read_to_string(case.path(folder).join("accuracy.csv")).unwrap();
    assert_eq!(read("recorded"), read("simulated"));
    // The history has an effect.
    case.file(
        "fresh.toml",
        format!("{head}{recorded}previous_touch = \"none\"\n{skin}{rest}"),
    );
    case.succeeds(&words("run fresh.toml --objects touches --out fresh"));
    assert_ne!(read("fresh"), read("simulated"));
}

/// Tangential forces in a separate file give the same frames as all values in one file; files that do not match are refused.
#[test]
fn shear_in_a_file_of_its_own_is_joined_to_the_frames() {
    let case = Case::new();
    let head = "question = \"?\"\ntrials = 2\n";
    let skin = format!("{SKIN}sensed = \"shear\"\n");
    let touched = PRESSED.replace("per_object = 6", "per_object = 6\nframes = 2");
    case.file("study.toml", format!("{head}{touched}{skin}{LEARNED}"));
    case.succeeds(&["touches", "study.toml", "--out", "touches"]);
    let frames: Array4<f32> = read_npy(case.path("touches/frames.npy")).unwrap();
    let shear: Array5<f32> = read_npy(case.path("touches/shear.npy")).unwrap();
    let all = concatenate![Axis(2), frames.clone().insert_axis(Axis(2)), shear];
    write_npy(&case.path("touches/all.npy"), &all).unwrap();
    // The first four touches of each class are training touches.
    let part = |is_test: bool| -> Vec<usize> {
        (0..18)
            .filter(|touch| (touch % 6 >= 4) == is_test)
            .collect()
    };
    for (set, is_test) in [("a", false), ("b", true)] {
        let path = |name: &str| case.path(&format!("touches/{name}_{set}.npy"));
        let touches = part(is_test);
        write_npy(&path("frames"), &frames.select(Axis(0), &touches)).unwrap();
        write_npy(&path("shear"), &shear.select(Axis(0), &touches)).unwrap();
        write_npy(&path("all"), &all.select(Axis(0), &touches)).unwrap();
        write_integers(&path("labels"), touches.iter().map(|touch| touch / 6)).unwrap();
    }
    let skin = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\nsensed = \"shear\"\nfriction = 0.5\n";
    let study = |keys: &str, skin: &str| {
        let keys: String = keys
            .split(", ")
            .map(|key| {
                let (key, name) = key.split_once(' ').unwrap();
                format!("{key} = \"{name}.npy\"\n")
            })
            .collect();
        format!("{head}[recorded]\n{keys}full_scale = 5e-3\n{skin}{LEARNED}")
    };
    let run = |name: &str, keys: &str, skin: &str| {
        // The study is beside its files, so paths are relative to the folder of the study.
        case.file(&format!("touches/{name}.toml"), study(keys, skin));
        let study = format!("touches/{name}.toml");
        case.run(&["run", &study, "--out", name])
    };
    let table = |name: &str, keys: &str| {
        let ran = run(name, keys, skin);
        assert!(
            ran.status.success(),
            "{}",
            String::from_utf8_lossy(&ran.stderr)
        );
        std::fs::read_to_string(case.path(name).join("accuracy.csv")).unwrap()
    };
    let labels = "labels labels";
    let one = table("one", &format!("frames all, {labels}"));
    assert_eq!(
        table("two", &format!("frames frames, shear shear, {labels}")),
        one
    );
    let test = "labels labels_a, labels_test labels_b";
    let one = table(
        "one_set",
        &format!("frames all_a, frames_test all_b, {test}"),
    );
    let sets = "frames frames_a, frames_test frames_b";
    let two = format!("{sets}, shear shear_a, shear_test shear_b, {test}");
    assert_eq!(table("two_sets", &two), one);
    for (keys, words) in [
        (
            format!("frames frames, shear frames, {labels}"),
            "frames.npy: an array of shape [18, 2, 8, 8]; shape [18, 2, 2, 8, 8] (\"n t c y x\")",
        ),
        (
            format!("frames frames, shear shear_a, {labels}"),
            "shear_a.npy: an array of shape [12, 2, 2, 8, 8]; shape [18, 2, 2, 8, 8]",
        ),
        (
            format!("{sets}, shear shear_a, {test}"),
            "key recorded.shear_test: no such key beside shear",
        ),
        (
            format!("{sets}, shear_test shear_b, {test}"),
            "no such key without recorded.shear and",
        ),
    ] {
        let refused = run("refused", &keys, skin);
        let said = String::from_utf8_lossy(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{said}\ndoes not say {words}");
    }
    let plain = "[skin]\npitch_mm = 4.0\nstroke_mm = 5.0\n";
    let refused = run(
        "refused",
        &format!("frames frames, shear shear, {labels}"),
        plain,
    );
    let said = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    says(&said, &["key recorded.shear: "]);
    says(&said, &["skin.sensed = \"shear\""]);
    assert!(!case.path("refused").exists());
}
