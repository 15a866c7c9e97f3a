//! Differences between two result folders, for rows with equal settings, and their statistical significance.
//!
//! Rows of two tables correspond if their choices, conditions and subjects are equal. If settings are repeated in trials, the means over common trials are
//! compared. If the table contains the numbers of training and test rows, a t-test paired over trials determines the significance. If values have confidence
//! intervals and no trials, a difference is significant if the two intervals are disjoint.

use crate::error::{Error, Result};
use crate::report::comparison::changes::{Configurations, key};
use crate::report::swept::Setting;
use crate::row;
use crate::statistics::comparison::TrialSize;
use crate::statistics::many_tests::holm_of_some;
use crate::statistics::p_status::{CONFIDENCE, PStatus};
use crate::statistics::repeats::{Paired, Repeat};
use crate::table::{Column, Role, Table};
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};

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
        let first = first.iter().find(|first| first.file == second.file);
        let (Some(first), Some(second)) = (first.and_then(Settings::new), Settings::new(second))
        else {
            continue;
        };
        let pairs = second.pairs(&first);
        let settings = second.columns.iter().map(|one| &one.column.name);
        let settings: Vec<_> = settings.collect();
        for column in &second.table.columns {
            let is_compared = matches!(column.role, Role::Value(_) | Role::Cost);
            let is_number = first.table.numbers(&column.name).is_some();
            if is_compared && is_number && known.insert((settings.clone(), &column.name)) {
                let rows = of_column(column, (&first, &second), &pairs)?;
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

/// Settings that occur in a table, with the row numbers of each setting.
struct Settings<'a> {
    table: &'a Table,
    /// Columns whose values identify a setting.
    columns: Vec<Setting<'a>>,
    /// Table rows of each setting (one per trial), in the order of first occurrence.
    groups: Vec<Vec<usize>>,
    is_repeated: bool,
}

impl<'a> Settings<'a> {
    /// Groups the rows of a table by their setting. Returns `None` if the table identifies configurations by numbers, because numbers differ between runs.
    /// Also returns `None` if several rows of a table without trials have the same setting.
    fn new(table: &'a Table) -> Option<Self> {
        let columns = Setting::of_roles(table, &[Role::Choice, Role::Condition, Role::Subject]);
        let columns = columns.filter(|one| one.column.name != "trial");
        let columns: Vec<Setting> = columns.collect();
        let groups = Setting::groups(&columns, table, &table.all_rows());
        let is_repeated = table.place("trial").is_some();
        let is_told_apart = is_repeated || groups.len() == table.n_rows;
        let has_cells = columns.iter().any(|one| one.column.name == "configuration");
        let is_known = !columns.is_empty() && !has_cells && is_told_apart;
        is_known.then_some(Self {
            table,
            columns,
            groups,
            is_repeated,
        })
    }

    /// Returns the setting of a row as text, which does not depend on the order of the columns.
    fn key(&self, row: usize) -> String {
        key(&self.columns, row, &Configurations::new())
    }

    /// Returns the rows of each setting that both tables have: in the other table, and in this table.
    fn pairs<'s>(&'s self, other: &'s Self) -> Vec<[&'s [usize]; 2]> {
        let known = other.groups.iter();
        let known = known.map(|rows| (other.key(rows[0]), &rows[..]));
        let known: HashMap<String, &[usize]> = known.collect();
        let pairs = self.groups.iter();
        let pairs = pairs.filter_map(|ours| Some([*known.get(&self.key(ours[0]))?, &ours[..]]));
        pairs.collect()
    }

    /// Returns the settings of a row as text, limited to columns whose values vary.
    fn words(&self, row: usize) -> String {
        let columns = self.columns.iter();
        let varying = columns.filter(|one| one.data.varies(0..self.table.n_rows));
        let said = varying.filter_map(|one| Some(one.column.phrase(&one.data.value(row)?)));
        said.collect::<Vec<_>>().join(", ")
    }

    /// Returns the number in a column and row as an integer; `None` if the column or the number does not exist.
    fn count(&self, column: &str, row: usize) -> Option<usize> {
        let number = self.table.numbers(column)?[row];
        (!number.is_nan()).then_some(number as usize)
    }

    /// Returns the numbers of a column in the given rows as scores of trials.
    fn repeats(&self, column: &str, rows: &[usize]) -> Vec<Repeat> {
        let repeats = rows.iter().map(|&row| {
            let trial = self.count("trial", row).unwrap_or(0);
            let projection = self.count("projection", row);
            let split = self.count("split", row).filter(|_| projection.is_some());
            let split = self.count("distinct_split", row).or(split);
            Repeat {
                trial,
                split: split.unwrap_or(trial),
                projection,
                score: self.table.number(column, row),
                size: self.trial_size(row),
            }
        });
        repeats.filter(|repeat| !repeat.score.is_nan()).collect()
    }

    /// Returns the numbers of training and test touches in the trial of a row; `None` if the table does not contain these numbers.
    fn trial_size(&self, row: usize) -> Option<TrialSize> {
        self.is_repeated.then_some(())?;
        let n_decisions = self.count("n_test", row)?;
        Some(TrialSize {
            n_train: self.count("n_train", row)?,
            // The overlap of trials is counted in touches; a decision can use several touches.
            n_test: n_decisions * self.count("touches_per_decision", row).unwrap_or(1),
            n_decisions,
        })
    }
}

/// Compares one column in all settings that both tables have, with Holm's correction over them.
fn of_column(
    column: &Column,
    (first, second): (&Settings, &Settings),
    pairs: &[[&[usize]; 2]],
) -> Result<Vec<Difference>> {
    let mut rows = Vec::new();
    for &[theirs, ours] in pairs {
        rows.extend(of_setting(column, (first, theirs), (second, ours))?);
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

type Rows<'a> = (&'a Settings<'a>, &'a [usize]);

/// Compares the numbers of one setting in the two folders; returns `None` if a number is missing.
fn of_setting(
    column: &Column,
    (first, theirs): Rows,
    (second, ours): Rows,
) -> Result<Option<Difference>> {
    let [ours_told, theirs_told] =
        [(second, ours), (first, theirs)].map(|(of, rows)| of.repeats(&column.name, rows));
    if ours_told.is_empty() || theirs_told.is_empty() {
        return Ok(None);
    }
    let paired = Paired::new(&ours_told, &theirs_told);
    let setting = second.words(ours[0]);
    if paired.n_trials() == 0 {
        let given = format!("{}: {setting}: no trial is in both", second.table.file);
        let allowed = "runs that share their trials";
        return Err(Error::input("two runs", given, allowed));
    }
    let tested = match column.role {
        Role::Cost => None,
        _ => paired.tested()?,
    };
    let tested = tested.as_ref();
    let (ours_mean, theirs_mean) = paired.means();
    let intervals = first.table.interval(column, theirs[0]);
    let intervals = intervals.zip(second.table.interval(column, ours[0]));
    let interval = tested.and_then(|tested| tested.interval);
    Ok(Some(Difference {
        table: second.table.file.to_owned(),
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
            // Intervals of single trials do not apply to the means over trials.
            Some(([low, high], [from, to])) if !first.is_repeated && !second.is_repeated => {
                explained(low <= to && from <= high)
            }
            _ => Significance::Untested,
        },
        p_value: tested.and_then(|tested| tested.p_value),
        p_holm: None,
        p_status: tested.map(|tested| tested.p_status),
        n_trials_needed: tested.and_then(|tested| tested.n_needed),
    }))
}
