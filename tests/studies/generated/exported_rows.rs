//! Law: exported rows that are classified elsewhere give the predictions of the run.

use super::generator::{Generator, n_studies};
use super::outcome::{rows, run};
use bubbletouch::study::FeatureSet;
use bubbletouch::study::progress::Silent;
use ndarray::{Array1, Array2, ArrayView1, Axis};

/// Returns the number of test rows that a nearest-centroid classifier on standardised rows predicts correctly, by definition.
fn n_correct_of_nearest_centroid(set: &FeatureSet) -> usize {
    let (x, y) = (&set.data.records, &set.data.targets);
    let train = x.select(Axis(0), &set.split.train);
    let mean = train.mean_axis(Axis(0)).unwrap();
    let std = train.std_axis(Axis(0), 0.0);
    let scaled = |row: ArrayView1<f64>| -> Array1<f64> {
        let values = row.iter().zip(&mean).zip(&std);
        values
            .map(|((x, mean), std)| match *std > 1e-12 * mean.abs() {
                true => (x - mean) / std,
                false => 0.0,
            })
            .collect()
    };
    let n_classes = y.iter().max().unwrap() + 1;
    let mut sums = Array2::<f64>::zeros((n_classes, x.ncols()));
    let mut counts = vec![0.0; n_classes];
    for &row in &set.split.train {
        let mut sum = sums.row_mut(y[row]);
        sum += &scaled(x.row(row));
        counts[y[row]] += 1.0;
    }
    let distance = |row: &Array1<f64>, class: usize| -> f64 {
        let centroid = &sums.row(class) / counts[class];
        (row - &centroid).mapv(|d| d * d).sum()
    };
    let is_correct = |&&row: &&usize| {
        let scaled = scaled(x.row(row));
        let classes = (0..n_classes).filter(|class| counts[*class] > 0.0);
        let nearest =
            classes.min_by(|a, b| distance(&scaled, *a).total_cmp(&distance(&scaled, *b)));
        nearest == Some(y[row])
    };
    set.split.test.iter().filter(is_correct).count()
}

#[test]
fn exported_rows_give_the_answers_of_the_run() {
    let mut n_checked = 0;
    for number in 0..n_studies() {
        let mut generator = Generator::new("exported rows", number);
        let study = generator.study(|study| {
            // Decisions on several touches are not predictions of single rows.
            study.get("recognition.touches_per_decision").is_none()
        });
        let train_touches = generator.values("recognition.train_touches");
        let study = study
            .classified_by("nearest_centroid")
            .without("recognition.scaling")
            .with("recognition.train_touches", train_touches[..2].to_vec());
        let Ok(loaded) = study.load() else {
            continue;
        };
        let Ok(tables) = run(&loaded) else {
            continue;
        };
        n_checked += 1;
        for row in rows(&tables["accuracy.csv"]) {
            let [configuration, trial] =
                ["configuration", "trial"].map(|column| row[column].parse().unwrap());
            let part = loaded.part_of(configuration);
            let set = part.features((configuration, trial), &Silent).unwrap();
            let n_correct = n_correct_of_nearest_centroid(&set).to_string();
            let what = format!(
                "configuration {configuration}, trial {trial} of\n{}",
                study.text()
            );
            assert_eq!(n_correct, row["n_correct"], "{what}");
        }
    }
    assert!(n_checked >= n_studies() / 2, "{n_checked} studies");
}
