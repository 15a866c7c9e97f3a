//! Two folders of results side by side: what moved between rows of the same settings, and whether chance explains it.
//!
//! Of each table that both have, rows are the same whose choices, conditions and subjects are. Of those that are repeated in trials the means
//! are told, over trials that both have; where a table says on how many rows trials train and test, a t-test paired over trials tells whether
//! chance explains the difference. Of values with intervals it does not if the two are apart.

use crate::error::{Error, Result};
use crate::recognition::comparison::TrialSize;
use crate::recognition::many_tests::holm_of_some;
use crate::row;
use crate::study::CONFIDENCE;
use crate::study::repeats::{Paired, Repeat, Tested};
use crate::study::table::PStatus;
use crate::table::{Better, Column, Data, Role, Table};
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};

/// Whether chance explains a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Moved {
    /// Less than once in twenty such comparisons; or the intervals are apart.
    Surely,
    /// Nobody can say: there are no intervals, and no trials or too few.
    Untested,
    /// It does.
    ByChance,
    /// There is none.
    Same,
}

const MOVED: &[(&str, &str)] = &[
    ("surely", "more than chance explains"),
    ("untested", "not tested"),
    ("by_chance", "chance explains it"),
    ("same", "none"),
];

row! {
/// A number that both folders have: a row of what `bubbletouch compare` writes.
pub struct Difference {
    /// The table's file.
    table: String => Subject;
    /// Its column.
    column: String => Subject;
    /// Choices, conditions and subjects that vary, in words.
    setting: String => Subject;
    /// The first row in the second folder's table that has the setting, from 0.
    row: usize => Note: Linear;
    /// Trials that both have; 1 where nothing is repeated.
    n_trials: usize => Note "trials of both": Linear;
    /// In the first folder, mean over trials.
    first: f64 => Value(Neither): Linear;
    /// In the second.
    second: f64 => Value(Neither): Linear;
    /// Second less first.
    difference: f64 => Value(Neither): Linear between [difference_low, difference_high];
    /// Lower end of its 95 % interval, where trials are paired.
    difference_low: Option<f64> => Note "95 % interval, lower end": Linear;
    /// Upper end of it.
    difference_high: Option<f64> => Note "95 % interval, upper end": Linear;
    /// Whether chance explains it.
    moved: Moved => Outcome "difference" named MOVED;
    /// Two-sided p-value of no difference, where there are trials enough for one.
    p_value: Option<f64> => Note "p-value": Linear;
    /// The same after Holm's correction for all settings.
    p_holm: Option<f64> => Value(Neither) "p (Holm)": Linear;
    /// Why there is a p-value or none.
    p_status: Option<PStatus> => Outcome "test";
    /// Trials from which on there is one; empty where no number of them is enough.
    n_trials_needed: Option<usize> => Note "trials needed": Linear;
} }

/// A column of a table of both folders.
pub struct ColumnDifferences {
    /// What it is.
    pub column: Column,
    /// Settings of both folders.
    pub rows: Vec<Difference>,
    /// How many settings only the first has.
    pub n_first_only: usize,
    /// How many only the second has.
    pub n_second_only: usize,
}

/// All columns of values and of costs of the tables that two folders have; of columns that several tables say of the same settings, the first.
///
/// # Errors
/// No setting is in both; a setting of which both have other trials.
pub fn differences(first: &[Table], second: &[Table]) -> Result<Vec<ColumnDifferences>> {
    let mut told = HashSet::new();
    let mut found = Vec::new();
    // A table that is made of others tells nothing more.
    for second in second.iter().filter(|table| !table.csv.is_empty()) {
        let Some(first) = first.iter().find(|first| first.file == second.file) else {
            continue;
        };
        let [Some(first), Some(second)] = [first, second].map(Settings::of) else {
            continue;
        };
        for column in &second.table.columns {
            let is_told = matches!(column.role, Role::Value(_) | Role::Cost);
            let is_number = matches!(
                first.table.column(&column.name),
                Some((_, Data::Numbers(_)))
            );
            let what = (second.columns.clone(), column.name.to_string());
            if is_told && is_number && told.insert(what) {
                found.push(of_column(column, &first, &second)?);
            }
        }
    }
    let mut values = found.iter().filter(|one| one.column.role != Role::Cost);
    match values.all(|one| one.rows.is_empty()) {
        true => Err(Error::input(
            "two runs",
            "no row of the one has the settings of a row of the other",
            "runs of one kind that share at least one setting",
        )),
        false => Ok(found),
    }
}

/// The settings of a table, and the rows that have them.
struct Settings<'a> {
    table: &'a Table,
    /// The columns that tell them apart.
    columns: Vec<&'a str>,
    /// Rows of each, the trials of repeated ones; in the order of their first.
    groups: Vec<Vec<usize>>,
    trials: Option<&'a [f64]>,
}

impl<'a> Settings<'a> {
    /// None of a table that names cells by their numbers, which other runs number otherwise, or whose rows nothing tells apart.
    fn of(table: &'a Table) -> Option<Self> {
        let roles = [Role::Choice, Role::Condition, Role::Subject];
        let columns = roles.iter().flat_map(|role| table.of_role(*role));
        let columns: Vec<&str> = columns.filter(|name| *name != "trial").collect();
        let groups = table.groups(&columns, 0..table.n_rows);
        let trials = table.numbers("trial");
        let is_told_apart = trials.is_some() || groups.len() == table.n_rows;
        let is_known = !columns.is_empty() && !columns.contains(&"cell") && is_told_apart;
        is_known.then_some(Self {
            table,
            columns,
            groups,
            trials,
        })
    }

    /// A setting by its values and their units; what is absent is left out.
    fn key(&self, row: usize) -> String {
        let columns = self
            .columns
            .iter()
            .filter_map(|name| self.table.column(name));
        let said = columns.filter_map(|(column, data)| {
            let value = data.value(row)?;
            Some(format!("{} {} {value};", column.name, column.unit))
        });
        let mut said: Vec<String> = said.collect();
        said.sort();
        said.concat()
    }

    /// The same in words: what varies.
    fn words(&self, row: usize) -> String {
        let varies = |data: &Data| {
            self.groups
                .iter()
                .any(|rows| data.key(rows[0]) != data.key(0))
        };
        let columns = self
            .columns
            .iter()
            .filter_map(|name| self.table.column(name));
        let said = columns.filter_map(|(column, data)| {
            let value = data.value(row).filter(|_| varies(data))?;
            Some(column.phrase(&value))
        });
        said.collect::<Vec<_>>().join(", ")
    }

    /// The numbers of a column in some rows.
    fn repeats(&self, column: &str, rows: &[usize]) -> Vec<Repeat> {
        let of_row = |&row: &usize| {
            let number = |name| {
                self.table
                    .numbers(name)
                    .map(|numbers| numbers[row] as usize)
            };
            Repeat {
                trial: self.trials.map_or(0, |trials| trials[row] as usize),
                place: number("split").zip(number("projection")),
                score: self.table.number(column, row),
            }
        };
        let repeats = rows.iter().map(of_row);
        repeats.filter(|repeat| !repeat.score.is_nan()).collect()
    }

    /// How trials split the touches; none where nothing says so.
    fn trial_size(&self, row: usize) -> Option<TrialSize> {
        let number = |name| {
            self.table
                .numbers(name)
                .map(|numbers| numbers[row] as usize)
        };
        self.trials?;
        Some(TrialSize {
            n_train: number("n_train")?,
            // How much the trials overlap is a matter of touches, however many of them one decision takes.
            n_test: number("n_test")? * number("fused_touches").unwrap_or(1),
        })
    }

    /// The interval of a value in a row.
    fn interval(&self, column: &Column, row: usize) -> Option<[f64; 2]> {
        let ends = column.interval.as_ref()?.each_ref();
        let ends = ends.map(|end| self.table.number(end, row));
        ends.iter().all(|end| !end.is_nan()).then_some(ends)
    }
}

fn of_column(column: &Column, first: &Settings, second: &Settings) -> Result<ColumnDifferences> {
    let known = first.groups.iter().map(|rows| (first.key(rows[0]), rows));
    let known: HashMap<String, &Vec<usize>> = known.collect();
    let mut rows = Vec::new();
    let mut n_both = 0;
    for ours in &second.groups {
        if let Some(theirs) = known.get(&second.key(ours[0])) {
            n_both += 1;
            rows.extend(of_setting(column, (first, theirs), (second, ours))?);
        }
    }
    let p_values: Vec<Option<f64>> = rows.iter().map(|row| row.p_value).collect();
    for (row, p_holm) in rows.iter_mut().zip(holm_of_some(&p_values)) {
        row.p_holm = p_holm;
        if let Some(p) = p_holm.filter(|_| row.moved != Moved::Same) {
            row.moved = explained(p >= 1.0 - CONFIDENCE);
        }
    }
    Ok(ColumnDifferences {
        column: column.clone(),
        rows,
        n_first_only: first.groups.len() - n_both,
        n_second_only: second.groups.len() - n_both,
    })
}

fn explained(is_by_chance: bool) -> Moved {
    if is_by_chance {
        Moved::ByChance
    } else {
        Moved::Surely
    }
}

type Rows<'a> = (&'a Settings<'a>, &'a [usize]);

/// Of one setting; none where a number is absent.
fn of_setting(
    column: &Column,
    (first, theirs): Rows,
    (second, ours): Rows,
) -> Result<Option<Difference>> {
    let repeats = (
        second.repeats(&column.name, ours),
        first.repeats(&column.name, theirs),
    );
    if repeats.0.is_empty() || repeats.1.is_empty() {
        return Ok(None);
    }
    let size = second.trial_size(ours[0]);
    let is_tested = column.role != Role::Cost;
    let paired = Paired::of(
        &repeats.0,
        &repeats.1,
        size.unwrap_or(TrialSize {
            n_train: 1,
            n_test: 1,
        }),
    );
    if paired.n_trials() == 0 {
        let given = format!(
            "{}: {}: no trial is in both",
            second.table.file,
            second.words(ours[0])
        );
        return Err(Error::input(
            "two runs",
            given,
            "runs that share their trials",
        ));
    }
    let tested: Option<Tested> = match size.filter(|_| is_tested) {
        Some(_) => Some(paired.tested()?),
        None => None,
    };
    let (ours_mean, theirs_mean) = paired.means();
    let intervals = match first.trials.or(second.trials) {
        Some(_) => None,
        None => first
            .interval(column, theirs[0])
            .zip(second.interval(column, ours[0])),
    };
    let interval = tested.as_ref().and_then(|tested| tested.interval);
    Ok(Some(Difference {
        table: second.table.file.to_owned(),
        column: column.name.to_string(),
        setting: second.words(ours[0]),
        row: ours[0],
        n_trials: paired.n_trials(),
        first: theirs_mean,
        second: ours_mean,
        difference: ours_mean - theirs_mean,
        difference_low: interval.map(|interval| interval.low),
        difference_high: interval.map(|interval| interval.high),
        moved: match intervals {
            _ if ours_mean == theirs_mean => Moved::Same,
            Some(([low, high], [from, to])) => explained(low <= to && from <= high),
            None => Moved::Untested,
        },
        p_value: tested.as_ref().and_then(|tested| tested.p_value),
        p_holm: None,
        p_status: tested.as_ref().map(|tested| tested.p_status),
        n_trials_needed: tested.and_then(|tested| tested.n_needed),
    }))
}

impl ColumnDifferences {
    /// How many rows moved so, to the better (of values of which neither is, to the larger), and to the worse.
    pub fn counts(&self, is_counted: impl Fn(&Difference) -> bool) -> [usize; 2] {
        let less = matches!(self.column.role, Role::Cost | Role::Value(Better::Less));
        let count = |better: bool| {
            let moved = self.rows.iter().filter(|row| row.difference != 0.0);
            let moved = moved.filter(|row| ((row.difference > 0.0) != less) == better);
            moved.filter(|row| is_counted(row)).count()
        };
        [count(true), count(false)]
    }
}
