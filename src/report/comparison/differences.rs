//! Differences between two result folders, for rows with equal settings, and their statistical significance.
//!
//! Rows of two tables correspond if their choices, conditions and subjects are equal. If settings are repeated in trials, the means over common trials are
//! compared. If the table contains the numbers of training and test rows, a t-test paired over trials determines the significance. If values have confidence
//! intervals and no trials, a difference is significant if the two intervals are disjoint.

use crate::error::{Error, Result};
use crate::report::comparison::changes::common_rows;
use crate::report::swept::Setting;
use crate::row;
use crate::statistics::comparison::TrialSize;
use crate::statistics::many_tests::holm_of_some;
use crate::statistics::p_status::{CONFIDENCE, PStatus};
use crate::statistics::repeats::{Paired, Repeat};
use crate::table::{Column, Role, Table};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// Statistical significance of a difference between two runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Significance {
    /// Significant difference: p < 0.05 after correction, or disjoint intervals.
    Significant,
    /// Difference that was not tested, because there are no intervals and too few trials.
    Untested,
    /// Difference that is not significant, so that chance can explain it.
    NotSignificant,
    /// No difference, because both values are equal.
    Same,
}

const SIGNIFICANCE: &[(&str, &str)] = &[
    ("significant", "more than chance explains"),
    ("untested", "not tested"),
    ("not_significant", "chance explains it"),
    ("same", "none"),
];

row! {
/// Comparison of one number in two result folders, as a row of the tables that `bubbletouch compare` writes.
pub struct Difference {
    /// File name of the table that contains the number.
    table: String => Subject;
    /// Name of the column that contains the number.
    column: String => Subject;
    /// Settings of the compared rows (choices, conditions and subjects) that vary in the table, as text.
    setting: String => Subject;
    /// Index of the first row with this setting in the second folder's table, from 0.
    row: usize => Note: Linear;
    /// Number of trials that both folders contain; 1 if the setting has a single trial.
    n_trials: usize => Note "trials of both": Linear;
    /// Value in the first folder, averaged over common trials.
    first: f64 => Value(Neither): Linear;
    /// Value in the second folder, averaged over common trials.
    second: f64 => Value(Neither): Linear;
    /// Value in the second folder minus the value in the first folder.
    difference: f64 => Value(Neither): Linear between [difference_low, difference_high];
    /// Lower end of the 95 % confidence interval of the difference; empty if trials are not paired.
    difference_low: Option<f64> => Note "95 % interval, lower end": Linear;
    /// Upper end of the 95 % confidence interval of the difference; empty if trials are not paired.
    difference_high: Option<f64> => Note "95 % interval, upper end": Linear;
    /// Statistical significance of the difference between the two folders.
    significance: Significance => Outcome "difference" named SIGNIFICANCE;
    /// Two-sided p-value of the null hypothesis that the difference is zero; empty if there are too few trials.
    p_value: Option<f64> => Note "p-value": Linear;
    /// p-value after Holm's correction over all settings of the column.
    p_holm: Option<f64> => Value(Neither) "p (Holm)": Linear;
    /// Status of the p-value: present, or the reason why it is empty.
    p_status: Option<PStatus> => Outcome "test";
    /// Minimum number of trials for which a p-value can be computed; empty if no number of trials is sufficient.
    n_trials_needed: Option<usize> => Value(Neither) "trials needed": Linear;
} }

/// Returns the differences in all value and cost columns of the common tables; the rows of a column are adjacent. If several tables have a column for equal
/// settings, the first one is used.
///
/// # Errors
/// If no setting occurs in both folders, or the folders have no common trial of a setting.
pub fn differences(first: &[Table], second: &[Table]) -> Result<Vec<Difference>> {
    let mut known = HashSet::new();
    let mut found = Vec::new();
    let mut has_values = false;
    // A table without a file is derived from other tables and contains nothing new.
    for second in second.iter().filter(|table| !table.csv.is_empty()) {
        let Some(first) = first.iter().find(|first| first.file == second.file) else {
            continue;
        };
        let tables = [first, second];
        let columns = tables.map(setting_columns);
        let pairs = common_rows(tables, &columns, &Default::default());
        let is_repeated = tables.map(|table| table.place("trial").is_some());
        let is_alone = |side: usize| pairs.iter().all(|rows| rows[side].len() == 1);
        // Numbers of configurations differ between runs, and rows with equal settings cannot be told apart without trials.
        let has_cells =
            |columns: &Vec<Setting>| columns.iter().any(|one| one.column.name == "configuration");
        if columns
            .iter()
            .any(|columns| columns.is_empty() || has_cells(columns))
            || [0, 1]
                .iter()
                .any(|&side| !is_repeated[side] && !is_alone(side))
        {
            continue;
        }
        let settings: Vec<_> = columns[1].iter().map(|one| &one.column.name).collect();
        for column in &second.columns {
            let is_compared = matches!(column.role, Role::Value(_) | Role::Cost);
            let is_number = first.numbers(&column.name).is_some();
            if is_compared && is_number && known.insert((settings.clone(), &column.name)) {
                let rows = of_column(column, tables, &columns[1], &pairs)?;
                has_values |= column.role != Role::Cost && !rows.is_empty();
                found.extend(rows);
            }
        }
    }
    match has_values {
        true => Ok(found),
        false => Err(Error::input(
            "two runs",
            "no row of the one has the settings of a row of the other",
            "runs of one kind that share at least one setting",
        )),
    }
}

/// Returns the columns whose values identify a setting; a setting has several trials.
fn setting_columns(table: &Table) -> Vec<Setting<'_>> {
    let columns = Setting::of_roles(table, &[Role::Choice, Role::Condition, Role::Subject]);
    columns.filter(|one| one.column.name != "trial").collect()
}

/// Returns the number in a column and row as an integer; `None` if the column or the number does not exist.
fn count(table: &Table, column: &str, row: usize) -> Option<usize> {
    let number = table.numbers(column)?[row];
    (!number.is_nan()).then_some(number as usize)
}

/// Returns the numbers of a column in the given rows as scores of trials.
fn repeats(table: &Table, column: &str, rows: &[usize]) -> Vec<Repeat> {
    let repeats = rows.iter().map(|&row| {
        let count = |column: &str| count(table, column, row);
        let trial = count("trial");
        let projection = count("projection");
        let split = count("split").filter(|_| projection.is_some());
        let split = count("distinct_split").or(split).or(trial);
        // The overlap of trials is counted in touches; a decision can use several touches.
        let size = |n_decisions: usize| {
            Some(TrialSize {
                n_train: count("n_train")?,
                n_test: n_decisions * count("touches_per_decision").unwrap_or(1),
                n_decisions,
            })
        };
        Repeat {
            trial: trial.unwrap_or(0),
            split: split.unwrap_or(0),
            projection,
            score: table.number(column, row),
            size: trial.and_then(|_| size(count("n_test")?)),
        }
    });
    repeats.filter(|repeat| !repeat.score.is_nan()).collect()
}

/// Compares one column in all settings that both tables have, with Holm's correction over them.
fn of_column(
    column: &Column,
    tables: [&Table; 2],
    settings: &[Setting],
    pairs: &[[Vec<usize>; 2]],
) -> Result<Vec<Difference>> {
    let n_rows = tables[1].n_rows;
    let varying = settings.iter().filter(|one| one.data.varies(0..n_rows));
    let varying: Vec<&Setting> = varying.collect();
    let mut rows = Vec::new();
    for pair in pairs {
        let phrase = |one: &&Setting| Some(one.column.phrase(&one.data.value(pair[1][0])?));
        let setting: Vec<String> = varying.iter().filter_map(phrase).collect();
        rows.extend(of_setting(column, tables, pair, setting.join(", "))?);
    }
    let p_values: Vec<Option<f64>> = rows.iter().map(|row| row.p_value).collect();
    for (row, p_holm) in rows.iter_mut().zip(holm_of_some(&p_values)) {
        row.p_holm = p_holm;
        if let Some(p) = p_holm.filter(|_| row.significance != Significance::Same) {
            row.significance = explained(p >= 1.0 - CONFIDENCE);
        }
    }
    Ok(rows)
}

fn explained(is_by_chance: bool) -> Significance {
    match is_by_chance {
        true => Significance::NotSignificant,
        false => Significance::Significant,
    }
}

/// Compares the numbers of one setting in the two folders; returns `None` if a number is missing.
fn of_setting(
    column: &Column,
    [first, second]: [&Table; 2],
    [theirs, ours]: &[Vec<usize>; 2],
    setting: String,
) -> Result<Option<Difference>> {
    let our_scores = repeats(second, &column.name, ours);
    let their_scores = repeats(first, &column.name, theirs);
    if our_scores.is_empty() || their_scores.is_empty() {
        return Ok(None);
    }
    let paired = Paired::new(&our_scores, &their_scores);
    if paired.n_trials() == 0 {
        let given = format!("{}: {setting}: no trial is in both", second.file);
        let allowed = "runs that share their trials";
        return Err(Error::input("two runs", given, allowed));
    }
    let tested = match column.role {
        Role::Cost => None,
        _ => paired.tested()?,
    };
    let tested = tested.as_ref();
    let (ours_mean, theirs_mean) = paired.means();
    // Intervals of single trials do not apply to the means over trials.
    let interval_of = |table: &Table, row: usize| match table.place("trial") {
        Some(_) => None,
        None => table.interval(column, row),
    };
    let intervals = interval_of(first, theirs[0]).zip(interval_of(second, ours[0]));
    let interval = tested.and_then(|tested| tested.interval);
    Ok(Some(Difference {
        table: second.file.to_owned(),
        column: column.name.to_string(),
        setting,
        row: ours[0],
        n_trials: paired.n_trials(),
        first: theirs_mean,
        second: ours_mean,
        difference: ours_mean - theirs_mean,
        difference_low: interval.map(|interval| interval.low),
        difference_high: interval.map(|interval| interval.high),
        significance: match intervals {
            _ if ours_mean == theirs_mean => Significance::Same,
            Some(([low, high], [from, to])) => explained(low <= to && from <= high),
            None => Significance::Untested,
        },
        p_value: tested.and_then(|tested| tested.p_value),
        p_holm: None,
        p_status: tested.map(|tested| tested.p_status),
        n_trials_needed: tested.and_then(|tested| tested.n_needed),
    }))
}
