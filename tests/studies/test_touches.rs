//! Studies whose test touches differ from the training touches: `[test]`, and axes one at a time.

use crate::command::filled;
use crate::study::{accuracies, assert_reads_back, changed, features, laid_out, run, table};
use bubbletouch::kinds::Study as _;
use bubbletouch::studies::recognition::charts::tables_of;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::Tables;
use bubbletouch::table::Role;

/// Returns a study of three objects on a training skin without faults. `touches` and `signal` are additional keys of these tables.
fn text(touches: &str, signal: &str, more: &str) -> String {
    filled(
        include_str!("../fixtures/texts/test_touches_text.toml"),
        &[("touches", &touches), ("signal", &signal), ("more", &more)],
    )
}

const TOUCHES: &str = "depth_mm = 2.0\noffset_y_mm = { uniform = [-6.0, 6.0] }";
const SIGNAL: &str = "noise_std_full_scale = 0.01";

fn base(more: &str) -> String {
    text(TOUCHES, SIGNAL, more)
}

/// Returns the feature rows on which a configuration's classifier is trained and tested.
fn rows(text: &str) -> [Vec<f64>; 2] {
    let set = features(text, (0, 1));
    [&set.split.train, &set.split.test].map(|rows| {
        let rows = rows.iter().map(|&row| set.data.records.row(row).to_vec());
        rows.flatten().collect()
    })
}

#[test]
fn test_rows_are_those_of_the_study_with_the_keys_in_place_and_training_rows_are_untouched() {
    let base = base("");
    let [learned, plain] = rows(&base);
    let faults = "steps = [\"noise\", \"smoothing\", \"faults\"]";
    let noise = "noise_std_full_scale = 0.01";
    let depth = "depth_mm = 2.0";
    let offset = "offset_y_mm = { uniform = [-6.0, 6.0] }";
    let wide = "offset_y_mm = { uniform = [-20.0, 20.0] }";
    let tilted = "tilt_x_deg = { uniform = [-20.0, 20.0] }\ndepth_mm = 2.0";
    let dead = format!("{faults}\n{noise}\ndead_fraction = 0.4");
    let [error, stroke] = ["surface_error_mm = 0.5", "stroke_mm = 5.0"];
    let faults = format!("signal.{faults}\nsignal.dead_fraction = 0.4");
    // Keys of `[test]`, and the change of the study that they stand for; none if the key is replaced by the same key.
    for (test, old, new) in [
        ("touches.depth_mm = 1.0", depth, ""),
        ("touches.offset_y_mm = { within = 20.0 }", offset, wide),
        ("touches.tilt_x_deg.within = 20.0", depth, tilted),
        ("signal.noise_std_full_scale = 0.2", noise, ""),
        // Another unit replaces the unit of the study.
        ("signal.noise_std_mm = 0.3", noise, ""),
        (&faults, noise, &dead),
        ("objects.surface_error_mm = 4.0", error, ""),
        ("skin.stroke_mm = 3.0", stroke, ""),
    ] {
        let mixed = rows(&format!("{base}\n[test]\n{test}"));
        let (_, own) = test.split_once('.').unwrap();
        let new = if new.is_empty() { own } else { new };
        let [_, driven] = rows(&changed(&base, &[(old, new)]));
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
    let sensing = "[sensing]\nensemble = \"principal_components\"";
    let learned = |test: &str| base(test).replace("[sensing]", sensing);
    let [plain, _] = rows(&learned(""));
    let [mixed, _] = rows(&learned("[test]\nsignal.noise_std_full_scale = 5.0"));
    assert!(plain == mixed);
}

#[test]
fn an_axis_of_test_touches_is_a_condition_with_a_robustness_row() {
    let axes = "\"test.signal.noise_std_full_scale\" = [0.01, 0.5, 5.0]";
    let study = laid_out(&base(&format!("[axes]\n{axes}"))).unwrap();
    let tables = study.run(&Silent).unwrap();
    let each = [0.01, 0.5, 5.0].map(|noise| {
        let test = format!("[test]\nsignal.noise_std_full_scale = {noise:?}");
        accuracies(&run(&base(&test)))
    });
    assert_eq!(accuracies(&tables), each.concat());
    let made = tables_of(&tables).unwrap();
    let summary = table(&made, "summary.csv");
    let (column, _) = summary.column("test_noise_std_full_scale").unwrap();
    assert_eq!(column.role, Role::Condition);
    let robustness = table(&made, "robustness.csv");
    assert_eq!(robustness.n_rows, 1);
    let at = robustness.number("half_accuracy_at", 0);
    assert!(0.01 < at && at < 5.0, "{at}");
    assert_reads_back(&study, &made);
}

const ONE_AT_A_TIME: &str = include_str!("../fixtures/texts/test_touches_one_at_a_time.toml");

#[test]
fn one_at_a_time_each_axis_leaves_the_study_as_it_is_written() {
    let study = laid_out(&base(ONE_AT_A_TIME)).unwrap();
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
    let robustness = table(&made, "robustness.csv");
    let conditions = (0..robustness.n_rows).map(|row| robustness.word("condition", row));
    let conditions: Vec<&str> = conditions.collect();
    assert!(conditions.contains(&"noise_std") && conditions.contains(&"test_offset_xy_mm"));
    assert_reads_back(&study, &made);
}

#[test]
fn another_axis_or_value_leaves_the_names_of_what_was_done() {
    let names = |axes: &str| -> Vec<(String, String)> {
        let pieces = laid_out(&base(axes)).unwrap().work_items();
        let names = pieces.into_iter().map(|piece| (piece.name, piece.inputs));
        names.collect()
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
    // The study as it is.
    assert!(plain.iter().all(|name| one.contains(name)));
}
