//! The tables of a study depend on its text and its seed, but not on other configurations or other objects.

use crate::command::Case;
use crate::kinds::Kind;
use crate::study::{Study, changed, trials_of};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::{sample_frames, simulate_array};

/// Tables without times, and the resolved study.
const REPEATABLE: [&str; 5] = [
    "accuracy.csv",
    "summary.csv",
    "confusion.csv",
    "comparison.csv",
    "study.toml",
];

#[test]
fn another_seed_is_another_experiment_and_the_study_that_it_wrote_down_repeats_it() {
    let case = Case::with("study.toml", Kind::named("choices").study);
    case.succeeds("run study.toml --out seven");
    case.succeeds("run study.toml --seed 2019 --out eight");
    case.succeeds("run eight/study.toml --out again");
    assert!(case.bytes("seven/accuracy.csv") != case.bytes("eight/accuracy.csv"));
    case.same_files(["eight", "again"], &REPEATABLE);
}

/// Study with one configuration per ensemble; the tests add values to its axes.
const NARROW: &str = include_str!("../fixtures/texts/repeatability.toml");

#[test]
fn a_cell_does_not_depend_on_the_other_cells_of_its_study() {
    for ensemble in ["gaussian", "sbhe", "block_average", "subsample", "identity"] {
        let narrow = NARROW.replace("ENSEMBLE", ensemble);
        let own = format!("\"{ensemble}\"");
        let two = format!("[{own}, \"{}\"]", other_than(ensemble));
        let wide = changed(
            &narrow,
            &[
                ("pitch_mm = 4.0", "pitch_mm = [8.0, 4.0]"),
                ("full_scale = 0.2", "full_scale = [0.0, 0.2]"),
                ("smoothing_mm = 4.0", "smoothing_mm = [8.0, 4.0]"),
                ("ratio = 16", "ratio = [2, 64, 16]"),
                ("\"linear_svm\"", "[\"rbf_svm\", \"linear_svm\"]"),
                ("c = 1.0", "c = [0.1, 1.0]"),
                ("train_touches = 12", "train_touches = [4, 12]"),
                (&own, &two),
            ],
        );
        // The identity has one number of measurements; a ratio is refused.
        let alone = match ensemble {
            "identity" => narrow.replace("ratio = 16\n", ""),
            _ => narrow,
        };
        let alone = Study::new(&alone).run();
        let among = Study::new(&wide).run();
        assert_eq!(alone.accuracy.len(), 2);
        assert!(among.accuracy.len() > 100);
        let configuration = &alone.accuracy[0].0;
        let trials = trials_of(&among, configuration);
        let expected: Vec<_> = alone.accuracy.iter().map(|(_, s)| s).collect();
        assert_eq!(trials, expected, "{ensemble}");
    }
}

/// Returns the study without compression.
fn identity() -> String {
    NARROW
        .replace("ENSEMBLE", "identity")
        .replace("ratio = 16\n", "")
}

fn other_than(ensemble: &str) -> &str {
    match ensemble {
        "gaussian" => "sbhe",
        _ => "gaussian",
    }
}

#[test]
fn an_object_is_touched_the_same_whatever_else_is_in_the_set() {
    let uniform = identity();
    let listed = uniform
        .replace("{ uniform = [-10.0, 10.0] }", "[-8.0, 0.0, 8.0]")
        .replace("{ uniform = [0.0, 40.0] }", "{ grid = [0.0, 40.0, 5] }")
        .replace("{ uniform = [2.0, 4.0] }", "[2.0, 4.0]");
    for text in [uniform, listed] {
        let stable = text.replace("[touches]", "[touches]\nrest = \"stable\"");
        for text in [text, stable] {
            let few = Study::new(&text.replace("\"mug\", \"banana\", ", ""));
            let many = Study::new(&text);
            assert_eq!((few.touched.len(), many.touched.len()), (2, 4));
            let patch = &few.plan.array;
            let frames = |touched| simulate_array(touched, patch, 1, &Silent).to_array();
            let (few_frames, many_frames) = (frames(&few.touched), frames(&many.touched));
            for (label, object) in few.touched.iter().enumerate() {
                let name = &object.object.name;
                let other = many.touched.iter().position(|o| o.object.name == *name);
                let other = other.unwrap();
                assert_eq!(object.touches, many.touched[other].touches, "{name}");
                for touch in 0..24 {
                    let many = many_frames.row(24 * other + touch);
                    assert_eq!(few_frames.row(24 * label + touch), many);
                }
            }
        }
    }
}

#[test]
fn the_noise_on_a_touch_does_not_depend_on_the_other_objects() {
    let text = identity() + "[report]\nsamples = [\"power_drill\"]\n";
    let sample = |text: &str| {
        let study = Study::new(text);
        let samples = sample_frames(&study.plan, &study.sweep.groups, &study.touched).unwrap();
        samples.shown.frames[0].clone()
    };
    let (name, frame) = sample(&text);
    assert_eq!(name, "power drill");
    let few = text.replace("\"mug\", \"banana\", ", "");
    assert_eq!(sample(&few), (name.clone(), frame.clone()));
    let quiet = text.replace("full_scale = 0.2", "full_scale = 0.0");
    assert_ne!(sample(&quiet), (name, frame), "there is noise to compare");
}
