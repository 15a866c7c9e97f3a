//! The study of where recognition breaks, and the axes of a study that spoil what is learned.

use crate::command::Case;
use crate::standard_errors::{assert_expected, of_share};
use bubbletouch::kinds;
use bubbletouch::kinds::breaking_points::rows::{
    BreakingPoint, CellScore, Side, TrialScore, WayCell,
};
use bubbletouch::kinds::breaking_points::{BreakingPointsPlan, BreakingPointsSpec};
use bubbletouch::report::csv_tables::read_rows;
use std::fs;

const QUICK: &str = r#"
question = "What breaks?"
trials = 2

[objects]
sets = ["cans"]

[skin]
pitch_mm = 8.0
size_mm = 128.0
stroke_mm = 5.0

[touches]
per_object = 40
offset_x_mm = { uniform = [-5.0, 5.0] }
offset_y_mm = { uniform = [-5.0, 5.0] }
depth_mm = { uniform = [2.0, 4.0] }

[signal]
noise_std_full_scale = 0.005

[sensing]
ratio = 4

[recognition]
classifier = ["linear_svm", "k_nearest"]
c = 10.0

[[breaking_points]]
name = "noise"
label = "noise (share of full scale)"
keys = ["signal.noise_std_full_scale"]
values = [0.0, 0.005, 0.05, 0.5, 10.0]

[[breaking_points]]
name = "place"
label = "test touches off the middle, up to (mm)"
keys = ["touches.offset_x_mm", "touches.offset_y_mm"]
values = [0.0, 5.0, 20.0, 80.0]
as = "half_width"
touches = "test"

[[breaking_points]]
name = "detail"
label = "error of the objects that are learned from (mm)"
keys = ["objects.surface_error_mm"]
values = [0.25, 2.0, 8.0]
touches = "training"

[[breaking_points]]
name = "mislabelled"
label = "wrong labels (share)"
keys = ["recognition.mislabelled_fraction"]
values = [0.0, 0.5, 1.0]
scale = "linear"

[[breaking_points]]
name = "imbalance"
label = "class imbalance"
keys = ["recognition.class_imbalance"]
values = [1.0, 10.0, 30.0]

[[breaking_points]]
name = "c"
label = "C"
keys = ["recognition.c"]
values = [1e-12, 1e-6, 1.0, 1e6, 1e12]
beside = { "recognition.classifier" = "linear_svm" }
"#;

#[test]
fn each_way_breaks_where_it_must() {
    assert_eq!(kinds::about(QUICK).unwrap().table, "breaking_points");
    let case = Case::new();
    case.file("study.toml", QUICK);
    let (said, _) = case.succeeds(&["run", "study.toml", "--out", "1"]);
    assert!(said.contains("half of the best at"), "{said}");
    let cells: Vec<WayCell> = read_rows(&case.path("1/summary.csv")).unwrap();
    let scores: Vec<CellScore> = read_rows(&case.path("1/summary.csv")).unwrap();
    assert_eq!(
        cells.len(),
        2 * (5 + 4 + 3 + 3 + 3) + 5,
        "every point is a row"
    );
    let at = |way: &str, value: f64| -> Vec<f64> {
        let rows = cells.iter().zip(&scores);
        let of_way = rows.filter(|(cell, _)| cell.way == way && cell.value == value);
        of_way.map(|(_, score)| score.accuracy).collect()
    };
    let chance = 1.0 / 9.0;
    // The study's own setting is the same cell whichever way goes through it.
    assert_eq!(at("noise", 0.005), at("mislabelled", 0.0));
    assert_eq!(at("noise", 0.005), at("imbalance", 1.0));
    assert_eq!(at("noise", 0.005), at("place", 5.0));
    assert_eq!(at("noise", 0.005), at("detail", 0.25));
    assert!(
        at("noise", 0.0).iter().all(|&a| a > 0.7),
        "{:?}",
        at("noise", 0.0)
    );
    // Noise of ten full scales leaves chance; with all labels wrong it is below.
    for (cell, score) in cells.iter().zip(&scores) {
        if (&cell.way[..], cell.value) == ("noise", 10.0) {
            let standard_error = of_share(chance, score.n_trials * score.n_test);
            assert_expected("noise 10", score.accuracy, chance, standard_error);
        }
    }
    assert!(at("mislabelled", 1.0).iter().all(|&a| a < chance));
    let rows: Vec<BreakingPoint> = read_rows(&case.path("1/breaking_points.csv")).unwrap();
    for row in &rows {
        assert_eq!(row.half, 0.5 * row.best);
        assert_eq!(row.is_reached, row.breaks_at.is_some(), "{row:?}");
        let is_inside = |v: f64| match row.side {
            Side::Larger => (row.best_at..=row.end).contains(&v),
            Side::Smaller => (row.end..=row.best_at).contains(&v),
        };
        assert!(row.breaks_at.is_none_or(is_inside), "{row:?}");
    }
    let of = |way: &'static str| rows.iter().filter(move |row| row.way == way);
    assert!(of("noise").all(|row| row.side == Side::Smaller || row.is_reached));
    assert!(of("mislabelled").all(|row| row.is_reached && row.breaks_at.unwrap() > 0.3));
    let svg = fs::read_to_string(case.path("1/noise.svg")).unwrap();
    assert!(svg.contains("half of its best at") && svg.contains("chance"));
}

#[test]
fn imbalance_takes_training_touches_and_no_test_touches() {
    let case = Case::new();
    let ways = QUICK.find("[[breaking_points]]").unwrap();
    let text = QUICK[..ways].replace(
        "c = 10.0",
        "c = 10.0\nclass_imbalance = [1.0, 16.0]\nmislabelled_fraction = [0.0, 0.25]\ntrain_touches = 16",
    );
    case.file("study.toml", &text);
    case.succeeds(&["run", "study.toml", "--out", "1"]);
    let scores: Vec<TrialScore> = read_rows(&case.path("1/accuracy.csv")).unwrap();
    // 16 · 16^(−r/8) of nine objects: 16, 11, 8, 6, 4, 3, 2, 1, 1.
    let n_train: Vec<usize> = scores.iter().map(|score| score.n_train).collect();
    assert_eq!(n_train.len(), 2 * 2 * 2 * 2);
    assert_eq!(n_train.iter().filter(|&&n| n == 144).count(), 8);
    assert_eq!(
        n_train.iter().filter(|&&n| n == 52).count(),
        8,
        "{n_train:?}"
    );
    assert!(scores.iter().all(|score| score.n_test == 90));
    let text = fs::read_to_string(case.path("1/accuracy.csv")).unwrap();
    let header = text.lines().next().unwrap();
    assert!(header.contains(",train_touches,mislabelled_fraction,class_imbalance,"));
    let svg = case.path("1").read_dir().unwrap().count();
    assert!(svg > 5);
}

#[test]
fn keys_that_are_out_of_range_are_named_with_their_way() {
    for (old, new, said) in [
        (
            "values = [0.0, 0.005, 0.05, 0.5, 10.0]",
            "values = [0.0, 1.0]",
            "breaking_points[1], key values: 2 values; at least 3",
        ),
        (
            "values = [0.0, 0.005, 0.05, 0.5, 10.0]",
            "values = [0.0, 2.0, 1.0]",
            "breaking_points[1], key values: 2 before 1; ascending",
        ),
        (
            "values = [0.0, 0.005, 0.05, 0.5, 10.0]",
            "values = [-1.0, 0.0, 1.0]",
            "breaking_points[1], key values: -1; zero or more",
        ),
        (
            "values = [0.0, 0.005, 0.05, 0.5, 10.0]",
            "values = [\"a\", 0.0, 1.0]",
            "breaking_points[1], key values: \"a\"; finite numbers",
        ),
        (
            "keys = [\"signal.noise_std_full_scale\"]",
            "keys = []",
            "breaking_points[1], key keys: an empty list",
        ),
        (
            "keys = [\"signal.noise_std_full_scale\"]",
            "keys = [\"signal.nois\"]",
            "breaking_points[1] at 0: unknown field `nois`",
        ),
        (
            "values = [0.0, 0.5, 1.0]",
            "values = [0.0, 0.5, 1.5]",
            "breaking_points[4] at 1.5, key recognition.mislabelled_fraction: 1.5",
        ),
        (
            "values = [1.0, 10.0, 30.0]",
            "values = [0.5, 10.0, 30.0]",
            "breaking_points[5] at 0.5, key recognition.class_imbalance: 0.5",
        ),
        (
            "name = \"place\"",
            "name = \"noise\"",
            "breaking_points.name: \"noise\" twice",
        ),
        (
            "name = \"place\"",
            "name = \"a b\"",
            "breaking_points[2], key name: 'a b'",
        ),
        (
            "ratio = 4",
            "ratio = [4, 8]",
            "key sensing.ratio: 2 settings",
        ),
        (
            "touches = \"test\"",
            "touches = \"some\"",
            "unknown variant `some`",
        ),
    ] {
        assert!(QUICK.contains(old), "{old}");
        let text = QUICK.replacen(old, new, 1);
        let plan = BreakingPointsSpec::parse("study.toml", &text)
            .and_then(|spec| BreakingPointsPlan::new("study.toml", spec));
        let error = plan.unwrap_err().to_string();
        assert!(
            error.contains(said) && error.starts_with("study.toml"),
            "{error}\nfor {said}"
        );
    }
    let case = Case::new();
    // Only what is alike can be learned here and tested there.
    let unlike = QUICK.replace(
        "keys = [\"objects.surface_error_mm\"]\nvalues = [0.25, 2.0, 8.0]",
        "keys = [\"sensing.ratio\"]\nvalues = [1, 2, 4]",
    );
    case.file("unlike.toml", &unlike);
    let imbalance = QUICK.replace("values = [1.0, 10.0, 30.0]", "values = [1.0, 10.0, 1000.0]");
    case.file("imbalance.toml", &imbalance);
    for (arguments, said) in [
        (
            &["run", "unlike.toml", "--fail-fast"][..],
            "way detail at 1, key touches",
        ),
        (
            &["run", "imbalance.toml", "--fail-fast"],
            "way imbalance at 1000, key recognition.class_imbalance",
        ),
    ] {
        let output = case.run(arguments);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(said), "{error}");
    }
}

/// The interval of an accuracy is that of the groups that are held out, as the recognition study of the same value says.
#[test]
fn intervals_come_from_groups_where_groups_are_held_out() {
    let (study, ways) = QUICK.split_at(QUICK.find("[[breaking_points]]").unwrap());
    let study = study.replace(
        "offset_x_mm = { uniform = [-5.0, 5.0] }",
        "offset_x_mm = [-4.0, -2.0, 0.0, 2.0, 4.0, 6.0]",
    );
    let study = format!("{study}keep_together = \"offset\"\nkeep_together_mm = 1.0\n");
    let study = study.replace(
        "offset_y_mm = { uniform = [-5.0, 5.0] }",
        "yaw_deg = { uniform = [0.0, 90.0] }",
    );
    let way = ways.split("[[breaking_points]]").nth(1).unwrap();
    let case = Case::new();
    case.file("study.toml", format!("{study}\n[[breaking_points]]{way}"));
    case.file("alone.toml", &study);
    case.succeeds(&["run", "study.toml", "--out", "ways"]);
    case.succeeds(&["run", "alone.toml", "--out", "alone"]);
    let alone: Vec<CellScore> = read_rows(&case.path("alone/summary.csv")).unwrap();
    let cells: Vec<WayCell> = read_rows(&case.path("ways/summary.csv")).unwrap();
    let scores: Vec<CellScore> = read_rows(&case.path("ways/summary.csv")).unwrap();
    let here = cells
        .iter()
        .zip(scores)
        .filter(|(cell, _)| cell.value == 0.005);
    let here: Vec<CellScore> = here.map(|(_, score)| score).collect();
    assert_eq!(here, alone);
    assert!(here.iter().all(|score| score.n_groups.is_some()));
}
