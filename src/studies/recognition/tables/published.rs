//! Comparison of a study with published accuracies: finds the most accurate configuration to which each claim applies.

use crate::error::{Error, Result};
use crate::inputs::toml_value::number;
use crate::studies::recognition::rows::configuration::Configuration;
use crate::studies::recognition::rows::table_rows::{ConfigurationScore, Published};
use crate::studies::recognition::rows::{by_condition, most_accurate, settings_of};
use crate::studies::recognition::spec::study::PublishedSpec;
use crate::table::{Table, Value, column_name};
use std::fmt::Display;

/// Checks that every published claim has a valid accuracy and applies to at least one configuration.
///
/// # Errors
/// If an accuracy is not between 0 and 1, or a key is not a column of [`Configuration`]. If no configuration has a value, or all values of a claim.
pub fn check_published(
    published: &[PublishedSpec],
    configurations: &[&Configuration],
) -> Result<()> {
    if published.is_empty() {
        return Ok(());
    }
    let configurations = settings_of(configurations)?;
    published
        .iter()
        .try_for_each(|claim| check(claim, &configurations))
}

fn check(claim: &PublishedSpec, configurations: &Table) -> Result<()> {
    let refuse = |key: &str, given: &dyn Display, allowed: &str| {
        let place = format!("key report.published, claim '{}', {key}", claim.claim);
        Err(Error::input(place, given, allowed))
    };
    if !(0.0..=1.0).contains(&claim.accuracy) {
        let allowed = "a share of test touches, 0 to 1";
        return refuse("accuracy", &claim.accuracy, allowed);
    }
    let known = |name: &str| match name {
        "configuration" => String::new(),
        name => configurations.one_of(name, 0..configurations.n_rows),
    };
    for (key, wanted) in &claim.at {
        let (name, wanted) = (column_name(key), setting(wanted));
        let values = known(name);
        if values.is_empty() {
            let names = configurations.columns.iter().map(|column| &column.name[..]);
            let names: Vec<&str> = names.filter(|name| !known(name).is_empty()).collect();
            let allowed = format!("one of {}", names.join(", "));
            return refuse(key, &"is no setting of this study", &allowed);
        }
        if !(0..configurations.n_rows).any(|row| configurations.has_setting(name, row, &wanted)) {
            return refuse(key, &wanted, &values);
        }
    }
    match (0..configurations.n_rows).any(|row| is_about(claim, configurations, row)) {
        true => Ok(()),
        false => {
            let allowed = "values that one configuration of the study has together";
            refuse("all keys together", &claim.at, allowed)
        }
    }
}

/// Converts a value from a study file (TOML) to a value of a result table.
fn setting(written: &toml::Value) -> Value {
    match (number(written), written.as_str()) {
        (Some(number), _) => Value::Number(number),
        (_, Some(word)) => Value::Word(word.to_owned()),
        _ => Value::Word(written.to_string()),
    }
}

fn is_about(claim: &PublishedSpec, configurations: &Table, row: usize) -> bool {
    let mut keys = claim.at.iter();
    keys.all(|(key, wanted)| configurations.has_setting(column_name(key), row, &setting(wanted)))
}

/// Returns the most accurate configuration to which each claim applies; the first configuration if several are equal. The result has one row for each condition
/// of the matching configurations.
///
/// # Errors
/// If a configuration cannot be written as a row of a table.
pub fn compare_with_published(
    published: &[PublishedSpec],
    summary: &[(Configuration, ConfigurationScore)],
) -> Result<Vec<(Configuration, Published)>> {
    let configurations = || summary.iter().map(|(configuration, _)| configuration);
    let settings = settings_of(&configurations().collect::<Vec<_>>())?;
    let conditions = by_condition(configurations())?;
    let mut rows = Vec::new();
    for claim in published {
        for alike in &conditions {
            let mut about = alike.clone();
            about.retain(|&place| is_about(claim, &settings, place));
            let accuracy = |&place: &usize| (place, summary[place].1.accuracy);
            if let Some(best) = most_accurate(about.iter().map(accuracy)) {
                let (configuration, score) = &summary[best];
                let ours = Published {
                    claim: claim.claim.clone(),
                    source: claim.source.clone(),
                    published_accuracy: claim.accuracy,
                    accuracy: score.accuracy,
                    accuracy_low: score.accuracy_low,
                    accuracy_high: score.accuracy_high,
                    difference: score.accuracy - claim.accuracy,
                    n_matching: about.len(),
                };
                rows.push((configuration.clone(), ours));
            }
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::classifiers::ClassifierKind;

    fn claim(keys: &str) -> PublishedSpec {
        let text = format!("claim = \"it works\"\naccuracy = 0.9\nsource = \"[CL]\"\n{keys}");
        toml::from_str(&text).unwrap()
    }

    /// Returns a test summary of all combinations of two classifiers, two compression ratios, and noise of 0 or 10 %. Accuracies increase with the number of
    /// the configuration.
    fn summary() -> Vec<(Configuration, ConfigurationScore)> {
        let mut rows = Vec::new();
        for noise_std in [0.0, 0.1] {
            for classifier in [ClassifierKind::LinearSvm, ClassifierKind::KNearest] {
                for (measurements, ratio) in [(64, 64.0), (41, 4096.0 / 41.0)] {
                    let configuration = Configuration {
                        configuration: rows.len(),
                        noise_std,
                        classifier,
                        measurements,
                        ratio,
                        c: classifier.has_c().then_some(1.0),
                        ..crate::studies::recognition::rows::configuration::tests::configuration()
                    };
                    let accuracy = 0.5 + 0.05 * rows.len() as f64;
                    let score = ConfigurationScore {
                        n_trials: 1,
                        n_test: 100,
                        accuracy,
                        accuracy_std: 0.0,
                        accuracy_low: accuracy - 0.1,
                        accuracy_high: accuracy + 0.1,
                        n_groups: None,
                        bootstrap_low: None,
                        bootstrap_high: None,
                        macro_f1: accuracy,
                        balanced_accuracy: None,
                        log_loss: None,
                        n_capped: 0,
                    };
                    rows.push((configuration, score));
                }
            }
        }
        rows
    }

    #[test]
    fn a_claim_stands_beside_the_most_accurate_of_the_cells_with_its_settings_in_each_condition() {
        let summary = summary();
        for (keys, configurations, n_matching) in [
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
            let all: Vec<&Configuration> = summary
                .iter()
                .map(|(configuration, _)| configuration)
                .collect();
            let claims = [claim(keys)];
            check_published(&claims, &all).unwrap();
            let found = compare_with_published(&claims, &summary).unwrap();
            let of_cells: Vec<usize> = found
                .iter()
                .map(|(configuration, _)| configuration.configuration)
                .collect();
            assert_eq!(of_cells, configurations, "{keys}");
            for (configuration, row) in found {
                assert_eq!(row.n_matching, n_matching, "{keys}");
                assert_eq!(
                    row.accuracy,
                    summary[configuration.configuration].1.accuracy
                );
                assert_eq!(row.difference, row.accuracy - 0.9);
            }
        }
    }

    #[test]
    fn a_claim_about_no_cell_is_refused_with_what_the_study_has() {
        let summary = summary();
        let configurations: Vec<&Configuration> = summary
            .iter()
            .map(|(configuration, _)| configuration)
            .collect();
        for (keys, said) in [
            ("colour = 1", "colour: is no setting of this study; one of "),
            (
                "configuration = 0",
                "configuration: is no setting of this study; one of ",
            ),
            ("ratio = 16.0", "ratio: 16; one of 64, 99.9"),
            (
                "classifier = \"rbf_svm\"",
                "classifier: rbf_svm; one of linear_svm, k_nearest",
            ),
            ("classifier = 3", "classifier: 3; one of linear_svm"),
            (
                "classifier = \"k_nearest\"\nc = 1.0",
                "values that one configuration of the study has together",
            ),
        ] {
            let error = check_published(&[claim(keys)], &configurations).unwrap_err();
            assert!(error.to_string().contains(said), "{error}");
        }
        let percent = PublishedSpec {
            accuracy: 98.0,
            ..claim("")
        };
        let error = check_published(&[percent], &configurations).unwrap_err();
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
