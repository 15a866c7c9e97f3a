//! Published accuracies beside ours: which cells a claim is about, and the most accurate of them.

use super::role::{agree, column_name as column, condition_numbers, most_accurate, one_of};
use super::spec::PublishedSpec;
use super::table::{Cell, CellScore, Published};
use crate::error::{Error, Result};
use std::collections::BTreeSet;
use toml::{Table, Value};

/// Every claim is an accuracy about at least one cell.
///
/// # Errors
/// A claim whose accuracy is not from 0 to 1, a key that is no column of [`Cell`], a value that no cell has, or keys of which
/// no cell has all.
pub fn check_published(published: &[PublishedSpec], cells: &[&Cell]) -> Result<()> {
    published.iter().try_for_each(|claim| check(claim, cells))
}

fn check(claim: &PublishedSpec, cells: &[&Cell]) -> Result<()> {
    let place = |key: &str| format!("key report.published, claim '{}', {key}", claim.claim);
    if !(0.0..=1.0).contains(&claim.accuracy) {
        let allowed = "a share of test touches, 0 to 1";
        return Err(Error::input(place("accuracy"), claim.accuracy, allowed));
    }
    // One after the other: of many cells, all rows at once would be gigabytes.
    let rows = || cells.iter().map(|cell| cell.settings());
    for (key, wanted) in &claim.at {
        let of_key = || rows().filter_map(|mut row| row.remove(column(key)));
        if of_key().any(|value| agree(&value, wanted)) {
            continue;
        }
        let mut values: Vec<Value> = Vec::new();
        for value in of_key() {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        let known: BTreeSet<String> = rows()
            .flat_map(|row| row.into_iter().map(|(k, _)| k))
            .collect();
        let known: Vec<String> = known.into_iter().collect();
        let (given, allowed) = match values.is_empty() {
            true => ("is no setting of this study".to_owned(), one_of(known)),
            false => {
                let values = values.iter().map(ToString::to_string);
                (wanted.to_string(), one_of(values))
            }
        };
        return Err(Error::input(place(key), given, allowed));
    }
    match rows().any(|row| is_about(claim, &row)) {
        true => Ok(()),
        false => Err(Error::input(
            place("all keys together"),
            Value::Table(claim.at.clone()),
            "values that one cell of the study has together",
        )),
    }
}

/// Each claim beside the cell with the highest mean accuracy (the first of equals) among those it is about; once for each condition
/// that these cells have.
pub fn compare_with_published(
    published: &[PublishedSpec],
    summary: &[(Cell, CellScore)],
) -> Vec<(Cell, Published)> {
    let columns: Vec<Table> = summary.iter().map(|(cell, _)| cell.settings()).collect();
    let conditions = condition_numbers(summary.iter().map(|(cell, _)| cell));
    let n_conditions = conditions.iter().max().map_or(0, |last| last + 1);
    let mut rows = Vec::new();
    for claim in published {
        let about = (0..summary.len()).filter(|&place| is_about(claim, &columns[place]));
        let about: Vec<usize> = about.collect();
        for condition in 0..n_conditions {
            let within = about
                .iter()
                .copied()
                .filter(|&place| conditions[place] == condition);
            let within: Vec<usize> = within.collect();
            let accuracies = within
                .iter()
                .map(|&place| (place, summary[place].1.accuracy));
            if let Some(best) = most_accurate(accuracies) {
                rows.push(beside(claim, &summary[best], within.len()));
            }
        }
    }
    rows
}

fn beside(
    claim: &PublishedSpec,
    (cell, score): &(Cell, CellScore),
    n_matching: usize,
) -> (Cell, Published) {
    let ours = Published {
        claim: claim.claim.clone(),
        source: claim.source.clone(),
        published_accuracy: claim.accuracy,
        accuracy: score.accuracy,
        accuracy_low: score.accuracy_low,
        accuracy_high: score.accuracy_high,
        difference: score.accuracy - claim.accuracy,
        n_matching,
    };
    (cell.clone(), ours)
}

fn is_about(claim: &PublishedSpec, row: &Table) -> bool {
    let mut keys = claim.at.iter();
    keys.all(|(key, wanted)| {
        row.get(column(key))
            .is_some_and(|value| agree(value, wanted))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::ClassifierKind;

    fn claim(keys: &str) -> PublishedSpec {
        let text = format!("claim = \"it works\"\naccuracy = 0.9\nsource = \"[CL]\"\n{keys}");
        toml::from_str(&text).unwrap()
    }

    /// Two classifiers × two ratios × no or 10 % noise; accuracies grow with the number.
    fn summary() -> Vec<(Cell, CellScore)> {
        let mut rows = Vec::new();
        for noise_std in [0.0, 0.1] {
            for classifier in [ClassifierKind::LinearSvm, ClassifierKind::KNearest] {
                for (measurements, ratio) in [(64, 64.0), (41, 4096.0 / 41.0)] {
                    let cell = Cell {
                        cell: rows.len(),
                        noise_std,
                        classifier,
                        measurements,
                        ratio,
                        c: classifier.has_c().then_some(1.0),
                        ..crate::study::table::tests::cell()
                    };
                    let accuracy = 0.5 + 0.05 * rows.len() as f64;
                    let score = CellScore {
                        n_trials: 1,
                        n_test: 100,
                        accuracy,
                        accuracy_std: 0.0,
                        accuracy_low: accuracy - 0.1,
                        accuracy_high: accuracy + 0.1,
                        bootstrap_low: None,
                        bootstrap_high: None,
                        macro_f1: accuracy,
                        n_capped: 0,
                    };
                    rows.push((cell, score));
                }
            }
        }
        rows
    }

    #[test]
    fn a_claim_stands_beside_the_most_accurate_of_the_cells_with_its_settings_in_each_condition() {
        let summary = summary();
        for (keys, cells, n_matching) in [
            ("", &[3, 7][..], 4),
            ("noise = 0.0", &[3], 4),
            ("noise_std = 0", &[3], 4),
            ("classifier = \"linear_svm\"", &[1, 5], 2),
            (
                "classifier = \"linear_svm\"\nratio = 64\nnoise = 0.1",
                &[4],
                1,
            ),
            ("ratio = 100.0\nc = 1.0", &[1, 5], 1), // a ratio as it was asked for
            ("measurements = 64\nnoise = 0.0", &[2], 2),
        ] {
            let all: Vec<&Cell> = summary.iter().map(|(cell, _)| cell).collect();
            let claims = [claim(keys)];
            check_published(&claims, &all).unwrap();
            let found = compare_with_published(&claims, &summary);
            let of_cells: Vec<usize> = found.iter().map(|(cell, _)| cell.cell).collect();
            assert_eq!(of_cells, cells, "{keys}");
            for (cell, row) in found {
                assert_eq!(row.n_matching, n_matching, "{keys}");
                assert_eq!(row.accuracy, summary[cell.cell].1.accuracy);
                assert_eq!(row.difference, row.accuracy - 0.9);
            }
        }
    }

    #[test]
    fn a_claim_about_no_cell_is_refused_with_what_the_study_has() {
        let summary = summary();
        let cells: Vec<&Cell> = summary.iter().map(|(cell, _)| cell).collect();
        for (keys, said) in [
            ("colour = 1", "colour: is no setting of this study; one of "),
            ("cell = 0", "cell: is no setting of this study; one of "),
            ("ratio = 16.0", "ratio: 16.0; one of 64.0, 99.9"),
            (
                "classifier = \"rbf_svm\"",
                "classifier: \"rbf_svm\"; one of \"linear_svm\", \"k_nearest\"",
            ),
            ("classifier = 3", "classifier: 3; one of \"linear_svm\""),
            (
                "classifier = \"k_nearest\"\nc = 1.0",
                "values that one cell of the study has together",
            ),
        ] {
            let error = check_published(&[claim(keys)], &cells).unwrap_err();
            assert!(error.to_string().contains(said), "{error}");
        }
        let percent = PublishedSpec {
            accuracy: 98.0,
            ..claim("")
        };
        let error = check_published(&[percent], &cells).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("accuracy: 98; a share of test touches, 0 to 1"),
            "{error}"
        );
    }

    #[test]
    fn a_claim_needs_its_words_its_accuracy_and_its_source() {
        for missing in ["claim", "accuracy", "source"] {
            let lines = ["claim = \"a\"", "accuracy = 0.5", "source = \"[CL]\""];
            let text: Vec<&str> = lines
                .into_iter()
                .filter(|line| !line.starts_with(missing))
                .collect();
            let error = toml::from_str::<PublishedSpec>(&text.join("\n")).unwrap_err();
            assert!(error.message().contains(missing), "{error}");
        }
    }
}
