//! Keys without effect: a written default is accepted, and any other value has an effect or is refused with a reason.

use crate::recorded_sensors::{LABELS, SKIN};
use crate::study::Study;
use bubbletouch::Result;
use bubbletouch::recognition::ClassifierKind;
use bubbletouch::study::{Plan, RecognitionSpec, StudySpec};
use toml::{Table, Value};

/// Returns a study with these lines of `[touches]`, `[signal]`, `[skin]`, `[recognition]`, and further tables.
fn text([touches, signal, skin, recognition, more]: [&str; 5]) -> String {
    format!(
        "question = \"?\"\n[objects]\nsets = [\"cans\"]\n[skin]\npitch_mm = 8.0\ntaxels = 8\nstroke_mm = 5.0\n{skin}\n\
         [touches]\nper_object = 8\ndepth_mm = {{ uniform = [2.0, 3.0] }}\n{touches}\n[signal]\n{signal}\n\
         [sensing]\n[recognition]\n{recognition}\n{more}\n"
    )
}

fn planned(text: &str) -> Result<()> {
    let spec = StudySpec::parse("x.toml", text)?;
    Plan::variants("x.toml", spec).map(drop)
}

fn refused(text: &str, words: &[&str]) {
    let said = planned(text).expect_err(text).to_string();
    for word in words {
        assert!(said.contains(word), "{text}\n{said}");
    }
}

/// Returns another value than the default of a key.
fn other(key: &str, default: &Value) -> Value {
    match (key, default) {
        ("multiclass", _) => "one_vs_rest".into(),
        ("solver", _) => "coordinate_descent".into(),
        ("scaling", _) => "none".into(),
        ("features", _) => "centred".into(),
        ("split", _) => "unseen_depth".into(),
        ("next_touch", _) => "farthest".into(),
        ("test_fraction" | "mislabelled_fraction", _) => 0.5.into(),
        (_, Value::Integer(n)) => (n + 1).into(),
        (_, Value::Float(number)) => (1.5 * number).into(),
        _ => panic!("{key} = {default} has no other value in this test"),
    }
}

#[test]
fn a_written_default_is_accepted_and_another_value_acts_or_is_refused_with_a_reason() {
    let usual = RecognitionSpec::usual();
    for key in [
        "c",
        "n_trees",
        "degree",
        "cv_folds",
        "tilt_augmentation",
        "test_fraction",
    ] {
        assert!(usual.contains_key(key), "{key}");
    }
    for features in ["raw", "polar_harmonics"] {
        for (kind, (name, _)) in ClassifierKind::ALL.iter().zip(ClassifierKind::NAMES) {
            let with = |key: &str, value: &Value| {
                let mut keys = Table::new();
                keys.insert("features".into(), features.into());
                keys.insert("classifier".into(), (*name).into());
                keys.insert(key.to_owned(), value.clone());
                text(["", "", "", &keys.to_string(), ""])
            };
            for (key, default) in usual.iter().filter(|(key, _)| *key != "classifier") {
                planned(&with(key, default)).unwrap_or_else(|error| panic!("{name}: {error}"));
                let changed = with(key, &other(key, default));
                let is_of_classifier =
                    bubbletouch::recognition::svm::classifiers::parameters::keys()
                        .any(|k| k == key);
                match planned(&changed) {
                    Ok(()) => assert!(!is_of_classifier || kind.uses(key), "{name}: {key}"),
                    Err(error) => {
                        let said = error.to_string();
                        let has_reason = [", but ", " without ", "uniform", "linear_svm", "beside"];
                        assert!(said.contains(&format!("key recognition.{key}")), "{said}");
                        assert!(
                            has_reason.iter().any(|words| said.contains(words)),
                            "{said}"
                        );
                    }
                }
            }
        }
    }
    // A list of the default alone is the default.
    let knn = "classifier = \"k_nearest\"\n";
    planned(&text(["", "", "", &format!("{knn}c = [1.0]"), ""])).unwrap();
    refused(
        &text(["", "", "", &format!("{knn}c = [1.0, 2.0]"), ""]),
        &["recognition.c", "no classifier"],
    );
}

#[test]
fn written_defaults_of_other_tables_are_accepted() {
    let linear = "classifier = \"linear_svm\"";
    for keys in [
        [
            "slide_mm = 0.0\nslide_deg = 0.0\nspeed_mm_per_s = 0.0",
            "",
            "",
            linear,
            "",
        ],
        [
            "",
            "noise_std_full_scale = 0.0\nsteps = [\"smoothing\"]\nsmoothing_mm = 0.0",
            "",
            linear,
            "",
        ],
        [
            "",
            "test_sensor = \"same_skin\"\ncombine = \"all\"",
            "",
            linear,
            "",
        ],
        [
            "",
            "",
            "layout = \"grid\"\nsensed = \"deflection\"\nstiffness_n_per_m = 100.0\ndamping_n_s_per_m = 0.0",
            linear,
            "",
        ],
    ] {
        planned(&text(keys)).unwrap_or_else(|error| panic!("{keys:?}\n{error}"));
    }
    let selected =
        text(["", "", "", linear, ""]).replace("[sensing]", "[sensing]\nselection = \"greedy\"");
    planned(&selected).unwrap();
    refused(
        &selected.replace("greedy", "random"),
        &[
            "key sensing.selection",
            "no ensemble of the study selects taxels",
        ],
    );
}

/// In a study with `[test]`, a key that training and test touches share acts if either uses it. A key of `[test]` acts in test touches.
#[test]
fn keys_of_studies_with_test_touches_are_checked() {
    let linear = "classifier = \"linear_svm\"";
    let test = |keys: &str| format!("[test]\n{keys}");
    let deeper = test("touches.depth_mm = 4.0");
    for (touches, skin, words) in [
        (
            "",
            "stiffness_n_per_m = 50.0",
            "key skin.stiffness_n_per_m: 50, but no force is read",
        ),
        (
            "",
            "damping_n_s_per_m = 0.5",
            "key skin.damping_n_s_per_m: 0.5, but no force is read",
        ),
        (
            "speed_mm_per_s = 5.0",
            "",
            "key touches.speed_mm_per_s: 5, but the skin has no damper",
        ),
    ] {
        refused(&text([touches, "", skin, linear, &deeper]), &[words]);
    }
    for (keys, words) in [
        (
            "skin.stiffness_n_per_m = 50.0",
            "key test.skin.stiffness_n_per_m: 50, but no force is read",
        ),
        (
            "touches.speed_mm_per_s = 5.0",
            "key test.touches.speed_mm_per_s: 5, but the skin has no damper",
        ),
    ] {
        refused(&text(["", "", "", linear, &test(keys)]), &[words]);
    }
    refused(
        &text([
            "",
            "",
            "",
            &format!("{linear}\nreadings_per_touch = 2"),
            &deeper,
        ]),
        &["key recognition.readings_per_touch: 2, but all readings"],
    );
    let force = "sensed = \"force\"";
    planned(&text([
        "",
        "",
        force,
        linear,
        &test("skin.stiffness_n_per_m = 50.0"),
    ]))
    .unwrap();
    // Only test touches move, or read a force.
    planned(&text([
        "",
        "",
        &format!("{force}\ndamping_n_s_per_m = 0.5"),
        linear,
        &test("touches.speed_mm_per_s = 5.0"),
    ]))
    .unwrap();
    planned(&text([
        "",
        "",
        "stiffness_n_per_m = 50.0",
        linear,
        &test("skin.sensed = \"force\""),
    ]))
    .unwrap();
    let axis = "[test]\ntouches.depth_mm = 4.0\n[axes]\n\"test.skin.sensed\" = [\"deflection\", \"force\"]";
    planned(&text(["", "", "stiffness_n_per_m = 50.0", linear, axis])).unwrap();
    let recorded = format!(
        "question = \"?\"\n[recorded]\n{LABELS}frames = \"f.npy\"\n{SKIN}stiffness_n_per_m = 50.0\n[sensing]\n[recognition]\n{linear}\n"
    );
    let said = planned(&recorded).unwrap_err().to_string();
    assert!(!said.contains("stiffness"), "{said}");
}

#[test]
fn a_list_of_a_key_with_one_value_and_a_number_of_equal_touches_are_refused_with_a_reason() {
    let linear = "classifier = \"linear_svm\"";
    refused(
        &text(["", "", "layout = [\"grid\", \"hexagonal\"]", linear, ""]),
        &[
            "x.toml:8, key skin.layout: a list; one value, or several as an axis: [axes] \"skin.layout\" = [\"grid\", \"hexagonal\"]",
        ],
    );
    refused(
        &text(["", "", "", &format!("{linear}\nsplit = [\"random\"]"), ""]),
        &["key recognition.split: a list; one value"],
    );
    let one_pose = text(["", "", "", linear, ""]).replace("{ uniform = [2.0, 3.0] }", "2.0");
    let said = Study::error(&one_pose);
    assert!(
        said.contains("key touches.per_object: 8; 1, the only pose: no value of it varies"),
        "{said}"
    );
    let said = Study::error(&one_pose.replace("depth_mm = 2.0", "depth_mm = [2.0, 3.0]"));
    assert!(
        said.contains("8; a number from 1 to 2, the combinations of the listed values"),
        "{said}"
    );
}
