//! Comparison of two result folders: differing entries, and the agreement of their rankings of designs.

use bubbletouch::report::comparison::changes::{ChangedColumn, ComparedTable, changes};
use bubbletouch::report::comparison::rank_agreement::rank_agreement;
use bubbletouch::row;
use bubbletouch::table::{File, Table};

row! {
/// Row with the score of a configuration.
pub struct Scored {
    /// Number of the configuration.
    configuration: usize => Note: Linear;
    /// Choice that not every design has.
    c: Option<f64> => Choice "C": Log;
    /// Number of the trial.
    trial: usize => Subject: Linear;
    /// Outcome of the row.
    outcome: String => Outcome;
    /// Measured error.
    error: Option<f64> => Value(Less): Log;
    /// Auxiliary count.
    n_capped: usize => Note: Linear;
} }
row! {
/// Row with a count of an object.
pub struct Counted {
    /// Number of the configuration.
    configuration: usize => Subject: Linear;
    /// Name of the touched object.
    object: String => Subject;
    /// Number of cases.
    count: usize => Value(Neither): Linear;
} }

fn tables(numbers: [usize; 2], edit: impl Fn(usize, &mut Scored), count: usize) -> Vec<Table> {
    let row = |row: usize| {
        let mut scored = Scored {
            configuration: numbers[row / 3],
            c: (row < 3).then_some(1.0),
            trial: row % 3,
            outcome: "right".to_owned(),
            error: Some(0.25),
            n_capped: 0,
        };
        edit(row, &mut scored);
        scored
    };
    let rows: Vec<Scored> = (0..6).map(row).collect();
    let counted = |configuration| Counted {
        configuration: numbers[configuration],
        object: "mug".to_owned(),
        count: [7, count][configuration],
    };
    let scores: File<Scored> = File::new("scores.csv", "Scores", "");
    let counts: File<Counted> = File::new("counts.csv", "Counts", "");
    vec![
        scores.table(&rows).unwrap(),
        counts.table(&[0, 1].map(counted)).unwrap(),
    ]
}

#[test]
fn an_edit_of_any_entry_is_found_whatever_configurations_are_numbered() {
    let first = tables([0, 1], |_, _| {}, 9);
    let compared = |second: Vec<Table>| changes(&first, &second);
    // Other configuration numbers alone are no difference.
    let (rows, changed) = compared(tables([5, 3], |_, _| {}, 9));
    assert!(changed.is_empty(), "{changed:?}");
    assert_eq!(rows.len(), 2);
    for table in rows {
        assert_eq!((table.n_first_only, table.n_second_only), (0, 0));
    }
    let of_scores = |edit: &dyn Fn(usize, &mut Scored)| {
        let (mut rows, changed) = compared(tables([0, 1], edit, 9));
        (rows.remove(0), changed)
    };
    let column = |column: &str, n_same, change: &str| ChangedColumn {
        table: "scores.csv".to_owned(),
        column: column.to_owned(),
        n_same,
        n_changed: 6 - n_same,
        change: change.to_owned(),
    };
    let (rows, changed) = of_scores(&|row, scored| {
        if row > 3 {
            scored.outcome = "not_finite".to_owned();
            scored.error = None;
        }
    });
    assert_eq!(rows.n_both, 6);
    let wanted = [
        column("outcome", 4, "2 from right to not finite"),
        column("error", 4, "2 from 0.25 to nothing"),
    ];
    assert_eq!(changed, wanted);
    let (_, changed) = of_scores(&|row, scored| scored.n_capped = usize::from(row == 2));
    assert_eq!(changed, [column("n_capped", 5, "by 1")]);
    // A setting that does not apply is a different setting.
    let (rows, _) = of_scores(&|row, scored| scored.c = (row < 2).then_some(1.0));
    let wanted = ComparedTable {
        table: "scores.csv".to_owned(),
        n_both: 5,
        n_first_only: 1,
        n_second_only: 1,
    };
    assert_eq!(rows, wanted);
    // A configuration of a table that contains only its number.
    let (_, changed) = compared(tables([1, 0], |_, _| {}, 8));
    assert_eq!(changed[0].table, "counts.csv");
    assert_eq!(changed[0].n_changed, 1);
}

row! {
/// Row with the accuracy of a classifier.
pub struct Classified {
    /// Name of the classifier.
    classifier: String => Choice;
    /// Penalty C of an SVM.
    c: Option<f64> => Choice "C": Log;
    /// Compression ratio.
    ratio: f64 => Choice in ":1": Log;
    /// Accuracy, the ranked value.
    accuracy: f64 => Value(More): Share;
} }

/// Returns a table of an SVM with two C and a k-NN classifier, at three ratios.
fn classified(invert: &str) -> Vec<Table> {
    let mut rows = Vec::new();
    let nearest = ("k_nearest", None, 0.7);
    let designs = [("svm", Some(1.0), 0.9), ("svm", Some(10.0), 0.8), nearest];
    for (classifier, c, best) in designs {
        for (place, ratio) in [1.6, 2.0, 2.37].into_iter().enumerate() {
            let accuracy = best - 0.02 * place as f64;
            let inverted = 1.0 - accuracy;
            rows.push(Classified {
                classifier: classifier.to_owned(),
                c,
                ratio,
                accuracy: if classifier == invert {
                    inverted
                } else {
                    accuracy
                },
            });
        }
    }
    let file: File<Classified> = File::new("accuracy.csv", "Accuracy", "");
    vec![file.table(&rows).unwrap()]
}

#[test]
fn settings_that_do_not_apply_are_values_and_numbers_are_the_same_if_they_are_equal() {
    let same = rank_agreement(&classified(""), &classified("")).unwrap();
    assert_eq!((same.n_designs, same.tau), (9, 1.0));
    let inverted = rank_agreement(&classified(""), &classified("k_nearest")).unwrap();
    assert_eq!(inverted.n_designs, 9);
    assert!(inverted.tau < 0.9, "{inverted:?}");
}

row! {
/// Row with the accuracy under a noise level.
pub struct InNoise {
    /// Compression ratio.
    ratio: f64 => Choice in ":1": Log;
    /// Noise standard deviation.
    noise_std: f64 => Condition: Linear;
    /// Accuracy, the ranked value.
    accuracy: f64 => Value(More): Share;
} }

#[test]
fn noise_in_millimetres_is_no_noise_of_full_scale() {
    let noises = [0.5, 1.0];
    let rows = [4.0, 16.0, 64.0, 128.0, 256.0].map(|ratio| {
        noises.map(|noise_std| InNoise {
            ratio,
            noise_std,
            accuracy: 1.0 - 0.001 * ratio - 0.1 * noise_std,
        })
    });
    let file: File<InNoise> = File::new("accuracy.csv", "Accuracy", "");
    let first = vec![file.table(&rows.concat()).unwrap()];
    let mut second = first.clone();
    let column = second[0].place("noise_std").unwrap();
    second[0].columns[column].unit = "mm".into();
    // The mean over the common noise levels is ranked.
    assert_eq!(rank_agreement(&first, &second).unwrap().n_designs, 5);
    assert_eq!(rank_agreement(&first, &first).unwrap().n_designs, 10);
}
