//! Studies whose test touches differ from the training touches: `[test]`, and axes one at a time.

use crate::study::{self, Study};
use bubbletouch::Result;
use bubbletouch::kinds::Study as _;
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::report::folder::{table_files, write_files};
use bubbletouch::studies::recognition::charts::{read_tables, tables_of};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::Tables;
use bubbletouch::table::{Role, Table};

/// Returns a study of three objects on a training skin without faults. `touches` and `signal` are additional keys of these tables.
fn text(touches: &str, signal: &str, more: &str) -> String {
    format!(
        r#"
question = "?"
trials = 2
[objects]
sets = ["household"]
names = ["mug", "soup_can", "dice"]
surface_error_mm = 0.5
[skin]
pitch_mm = 4.0
taxels = 8
stroke_mm = 5.0
[touches]
per_object = 24
offset_x_mm = {{ uniform = [-6.0, 6.0] }}
yaw_deg = {{ within = 20.0 }}
{touches}
[signal]
{signal}
[sensing]
measurements = 16
[recognition]
classifier = "k_nearest"
test_fraction = 0.25
{more}
"#
    )
}

const TOUCHES: &str = "depth_mm = 2.0\noffset_y_mm = { uniform = [-6.0, 6.0] }";
const SIGNAL: &str = "noise_std_full_scale = 0.01";

fn base(more: &str) -> String {
    text(TOUCHES, SIGNAL, more)
}

fn run(text: &str) -> Tables {
    study::laid_out(text).unwrap().run(&Silent).unwrap()
}

fn refused(text: &str) -> String {
    let study: Result<RecognitionStudy> = study::laid_out(text);
    let error = study.map(|_| ()).expect_err("it is refused");
    assert_eq!(error.exit_code(), 2);
    error.to_string()
}

fn accuracies(tables: &Tables) -> Vec<f64> {
    let rows = tables.accuracy.iter();
    rows.map(|(_, score)| score.accuracy).collect()
}

/// Returns the feature rows on which a configuration's classifier is trained and tested.
fn rows(text: &str) -> [Vec<f64>; 2] {
    let study = study::laid_out(text).unwrap();
    let set = study.first().features((0, 1), &Silent).unwrap();
    [&set.split.train, &set.split.test].map(|rows| {
        let rows = rows.iter().map(|&row| set.data.records.row(row).to_vec());
        rows.flatten().collect()
    })
}

#[test]
fn test_rows_are_those_of_the_study_with_the_keys_in_place_and_training_rows_are_untouched() {
    let [learned, plain] = rows(&base(""));
    let faults = "steps = [\"noise\", \"smoothing\", \"faults\"]";
    for (test, touches, signal, change) in [
        (
            "touches.depth_mm = 1.0",
            TOUCHES.replace("2.0", "1.0"),
            SIGNAL.to_owned(),
            ("", ""),
        ),
        (
            "touches.offset_y_mm = { within = 20.0 }",
            TOUCHES.replace("-6.0, 6.0", "-20.0, 20.0"),
            SIGNAL.to_owned(),
            ("", ""),
        ),
        (
            "touches.tilt_x_deg.within = 20.0",
            format!("{TOUCHES}\ntilt_x_deg = {{ uniform = [-20.0, 20.0] }}"),
            SIGNAL.to_owned(),
            ("", ""),
        ),
        (
            "signal.noise_std_full_scale = 0.2",
            TOUCHES.to_owned(),
            "noise_std_full_scale = 0.2".to_owned(),
            ("", ""),
        ),
        // Another unit replaces the unit of the study.
        (
            "signal.noise_std_mm = 0.3",
            TOUCHES.to_owned(),
            "noise_std_mm = 0.3".to_owned(),
            ("", ""),
        ),
        (
            &format!("signal.{faults}\nsignal.dead_fraction = 0.4"),
            TOUCHES.to_owned(),
            format!("{faults}\n{SIGNAL}\ndead_fraction = 0.4"),
            ("", ""),
        ),
        (
            "objects.surface_error_mm = 4.0",
            TOUCHES.to_owned(),
            SIGNAL.to_owned(),
            ("surface_error_mm = 0.5", "surface_error_mm = 4.0"),
        ),
        (
            "skin.stroke_mm = 3.0",
            TOUCHES.to_owned(),
            SIGNAL.to_owned(),
            ("stroke_mm = 5.0", "stroke_mm = 3.0"),
        ),
    ] {
        let mixed = rows(&base(&format!("[test]\n{test}")));
        let changed = text(&touches, &signal, "").replace(change.0, change.1);
        let [_, driven] = rows(&if change.0.is_empty() {
            text(&touches, &signal, "")
        } else {
            changed
        });
        assert!(mixed[0] == learned, "{test}: training rows");
        assert!(mixed[1] == driven, "{test}: test rows");
        assert!(driven != plain, "{test} changes nothing");
    }
}

#[test]
fn a_test_table_with_the_studys_own_values_changes_no_score() {
    let same = base("[test]\ntouches.depth_mm = 2.0\nsignal.noise_std_full_scale = 0.01");
    let (same, plain) = (run(&same), run(&base("")));
    assert_eq!(accuracies(&same), accuracies(&plain));
    // Equal touches are simulated once.
    let made =
        |tables: &Tables| -> Vec<usize> { tables.stages.iter().map(|row| row.n_touches).collect() };
    assert_eq!(made(&same), made(&plain));
    let shallow = run(&base("[test]\ntouches.depth_mm = 0.1"));
    assert!(accuracies(&shallow) < accuracies(&plain));
    assert_eq!(made(&shallow)[0], made(&plain)[0]);
}

#[test]
fn what_is_learned_for_features_is_learned_from_training_touches() {
    // Principal components are fitted to training touches, so other test touches do not change them.
    let learned = |test: &str| {
        base(test).replace(
            "[sensing]",
            "[sensing]\nensemble = \"principal_components\"",
        )
    };
    let [plain, _] = rows(&learned(""));
    let [mixed, _] = rows(&learned("[test]\nsignal.noise_std_full_scale = 5.0"));
    assert!(plain == mixed);
}

#[test]
fn an_axis_of_test_touches_is_a_condition_with_a_robustness_row() {
    let axes = "\"test.signal.noise_std_full_scale\" = [0.01, 0.5, 5.0]";
    let study = study::laid_out(&base(&format!("[axes]\n{axes}"))).unwrap();
    let tables = study.run(&Silent).unwrap();
    let each = [0.01, 0.5, 5.0].map(|noise| {
        let test = format!("[test]\nsignal.noise_std_full_scale = {noise:?}");
        accuracies(&run(&base(&test)))
    });
    assert_eq!(accuracies(&tables), each.concat());
    let made = tables_of(&tables).unwrap();
    let find = |file: &str| made.iter().find(|table| table.file == file).unwrap();
    let (column, _) = find("summary.csv")
        .column("test_noise_std_full_scale")
        .unwrap();
    assert_eq!(column.role, Role::Condition);
    let robustness = find("robustness.csv");
    assert_eq!(robustness.n_rows, 1);
    let at = robustness.number("half_accuracy_at", 0);
    assert!(0.01 < at && at < 5.0, "{at}");
    assert_reads_back(&study, &made);
}

fn assert_reads_back(study: &RecognitionStudy, made: &[Table]) {
    let folder = tempfile::tempdir().unwrap();
    let toml = study.first().plan.spec.to_toml();
    std::fs::write(folder.path().join("study.toml"), toml).unwrap();
    write_files(folder.path(), table_files(made)).unwrap();
    let read = read_tables(folder.path()).unwrap();
    assert_eq!(read.len(), made.len());
    for (read, made) in read.iter().zip(made) {
        assert_eq!(read.columns, made.columns, "{}", made.file);
        assert!(read.csv == made.csv, "{}", made.file);
    }
}

const ONE_AT_A_TIME: &str = r#"
[axes]
combine = "one_at_a_time"
"test.touches.offset_{x,y}_mm.within" = [0.0, 6.0, 40.0]
"signal.noise_std_full_scale" = [0.01, 0.2, 2.0]
"touches.depth_mm" = [1.0, 2, 4.0]
"#;

#[test]
fn one_at_a_time_each_axis_leaves_the_study_as_it_is_written() {
    let study = study::laid_out(&base(ONE_AT_A_TIME)).unwrap();
    let settings = study.all_cells().map(|configuration| {
        let values = configuration.variant.values.iter();
        let names: Vec<&str> = values.clone().map(|v| v.column.name.as_ref()).collect();
        // The noise already has a column of its own.
        assert_eq!(names, ["test_offset_xy_mm", "depth_mm"]);
        let number = |value: &Option<toml::Value>| {
            let value = value.as_ref()?;
            value.as_float().or(value.as_integer().map(|n| n as f64))
        };
        let values: Vec<Option<f64>> = values.map(|v| number(&v.value)).collect();
        (configuration.noise_std, values[0], values[1])
    });
    let settings: Vec<_> = settings.collect();
    // A value that the study already has is not run twice.
    let (noise, depth) = (0.01, Some(2.0));
    let expected = [
        (noise, None, depth),
        (noise, Some(0.0), depth),
        (noise, Some(6.0), depth),
        (noise, Some(40.0), depth),
        (0.2, None, depth),
        (2.0, None, depth),
        (noise, None, Some(1.0)),
        (noise, None, Some(4.0)),
    ];
    assert_eq!(settings, expected);
    let tables = study.run(&Silent).unwrap();
    let scores = accuracies(&tables);
    // Offsets within 6 mm are the offsets of the study, drawn from the same streams.
    assert_eq!(scores[0..2], scores[4..6]);
    let noisy = text(TOUCHES, "noise_std_full_scale = 2.0", "");
    assert_eq!(scores[10..12], accuracies(&run(&noisy))[..]);
    let test = "[test]\ntouches.offset_x_mm = { uniform = [-40.0, 40.0] }\ntouches.offset_y_mm = { uniform = [-40.0, 40.0] }";
    assert_eq!(scores[6..8], accuracies(&run(&base(test)))[..]);
    let made = tables_of(&tables).unwrap();
    let robustness = made.iter().find(|table| table.file == "robustness.csv");
    let robustness = robustness.unwrap();
    let conditions: Vec<&str> = (0..robustness.n_rows)
        .map(|row| robustness.word("condition", row))
        .collect();
    assert!(conditions.contains(&"noise_std") && conditions.contains(&"test_offset_xy_mm"));
    assert_reads_back(&study, &made);
}

#[test]
fn another_axis_or_value_leaves_the_names_of_what_was_done() {
    let names = |axes: &str| -> Vec<String> {
        let pieces = study::laid_out(&base(axes)).unwrap().work_items();
        pieces.into_iter().map(|piece| piece.name).collect()
    };
    let all = names(ONE_AT_A_TIME);
    let few = names(&ONE_AT_A_TIME.replace(", 40.0]", "]").replace(", 2.0]", "]"));
    assert!(few.len() < all.len() && few.iter().all(|name| all.contains(name)));
    let plain = names("");
    let mut different = all.clone();
    different.sort();
    different.dedup();
    assert_eq!(different.len(), all.len());
    let one = names("[axes]\ncombine = \"one_at_a_time\"\n\"test.touches.depth_mm\" = [1.0, 3.0]");
    assert!(
        plain.iter().all(|name| one.contains(name)),
        "the study as it is"
    );
}

#[test]
fn what_test_touches_cannot_have_is_refused_by_its_key() {
    for (test, wanted) in [
        ("touches.dept_mm = 1.0", "key test: unknown field `dept_mm`"),
        ("touches.depth_mm = -1.0", "key test.touches.depth_mm: -1;"),
        ("touches.per_object = 5", "key test.touches.per_object: 5;"),
        ("touches.frames = 3", "key test.touches.frames: 3;"),
        (
            "sensing.ratio = 4.0",
            "key test.sensing: given for test touches;",
        ),
        (
            "recognition.c = 4.0",
            "key test.recognition: given for test touches;",
        ),
        ("depth_mm = 1.0", "key test.depth_mm: 1.0; a table:"),
        (
            "skin.taxels = 9",
            "key test.skin: 9 x 9 taxels; the taxels that are learned, 8 x 8",
        ),
        (
            "signal.dead_fraction = 0.1",
            "no \"faults\", but signal.dead_fraction is given; \"faults\" among the steps",
        ),
        (
            "signal.noise_std_full_scale = [0.1, 0.2]",
            "key test.signal.noise_std_full_scale: a list of 2 values; one value, or several as an axis",
        ),
        (
            "objects.names = [\"mug\", \"dice\"]",
            "key test: touches: 24 of dice, 24 of mug;",
        ),
        (
            "touches.offset_x_mm = [0.0, 1.0]\ntouches.yaw_deg.within = -3.0",
            "key test.touches.yaw_deg: -3;",
        ),
    ] {
        let said = refused(&base(&format!("[test]\n{test}")));
        assert!(said.contains(wanted), "{said}\nis not\n{wanted}");
    }
    let chosen =
        "touches_per_decision = 2\nnext_touch = \"farthest\"\n[test]\ntouches.depth_mm = 1.0";
    let said = refused(&base(chosen));
    assert!(
        said.contains("key test.touches: given where touches are chosen"),
        "{said}"
    );
    for (axes, wanted) in [
        (
            "combine = \"one_at_a_time\"\n\"signal.smoothing_mm\" = [1.0, 2.0]",
            "axes.\"signal.smoothing_mm\": none or several values in its table; one value",
        ),
        ("combine = \"some\"", "unknown variant `some`"),
        (
            "\"test.touches.depth_mm\" = [1.0, -1.0]",
            "axes.\"test.touches.depth_mm\": test.touches.depth_mm = -1.0; key test.touches.depth_mm",
        ),
        ("\"touches.tilt_{x,_deg\" = [1.0, 2.0]", "no path"),
    ] {
        let said = refused(&base(&format!("[axes]\n{axes}")));
        assert!(said.contains(wanted), "{said}\nis not\n{wanted}");
    }
    // A plan with test touches also contains the training touches.
    let test = base("[test]\ntouches.depth_mm = 1.0");
    assert!(std::panic::catch_unwind(|| Study::new(&test).of_items()).is_err());
}
