//! Law: exported rows that are classified elsewhere give the predictions of the run.

use super::generator::{Generator, n_studies};
use super::outcome::{rows, run};
use crate::study::centroid_distances;
use bubbletouch::study::FeatureSet;
use bubbletouch::study::progress::Silent;

/// Returns the number of test rows that a nearest-centroid classifier on standardised rows predicts correctly, by definition.
fn n_correct_of_nearest_centroid(set: &FeatureSet) -> usize {
    let test = set.test().unwrap();
    let distances = centroid_distances(&set.training(None).unwrap(), &test.records);
    let nearest = distances.outer_iter().map(|row| {
        let nearest = row.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        nearest.map(|(class, _)| class)
    });
    let pairs = nearest.zip(&test.targets);
    pairs.filter(|(a, b)| *a == Some(**b)).count()
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
