//! Two folders of results side by side: what moved between rows of the same settings, and whether chance explains it.
//!
//! Of each table that both have, rows are the same whose choices, conditions and subjects are. Of those that are repeated in trials the means
//! are told, over trials that both have; where a table says on how many rows trials train and test, a t-test paired over trials tells whether
//! chance explains the difference. Of values with intervals it does not if the two are apart.

use crate::error::{Error, Result};
use crate::report::swept::Setting;
use crate::row;
use crate::statistics::comparison::TrialSize;
use crate::statistics::many_tests::holm_of_some;
use crate::statistics::p_status::{CONFIDENCE, PStatus};
use crate::statistics::repeats::{Paired, Repeat};
use crate::table::{Better, Column, Role, Table};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashMap, HashSet};

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
    /// Settings of both folders with a number in both.
    pub rows: Vec<Difference>,
    /// How many settings both have, with and without numbers.
    pub n_both: usize,
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
        let first = first.iter().find(|first| first.file == second.file);
        let (Some(first), Some(second)) = (first.and_then(Settings::of), Settings::of(second))
        else {
            continue;
        };
        for column in &second.table.columns {
            let is_told = matches!(column.role, Role::Value(_) | Role::Cost);
            let is_number = first.table.numbers(&column.name).is_some();
            let settings = second.columns.iter().map(|one| &one.column.name);
            let what = (settings.collect::<Vec<_>>(), &column.name);
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
    columns: Vec<Setting<'a>>,
    /// Rows of each, the trials of repeated ones; in the order of their first.
    groups: Vec<Vec<usize>>,
    is_repeated: bool,
}

impl<'a> Settings<'a> {
    /// None of a table that names cells by their numbers, which other runs number otherwise, or whose rows nothing tells apart.
    fn of(table: &'a Table) -> Option<Self> {
        let columns = Setting::of_roles(table, &[Role::Choice, Role::Condition, Role::Subject]);
        let columns = columns.filter(|one| one.column.name != "trial");
        let columns: Vec<Setting> = columns.collect();
        let all: Vec<usize> = (0..table.n_rows).collect();
        let groups = Setting::groups(&columns, table, &all);
        let is_repeated = table.place("trial").is_some();
        let is_told_apart = is_repeated || groups.len() == table.n_rows;
        let has_cells = columns.iter().any(|one| one.column.name == "cell");
        let is_known = !columns.is_empty() && !has_cells && is_told_apart;
        is_known.then_some(Self {
            table,
            columns,
            groups,
            is_repeated,
        })
    }

    /// A setting by its values and their units; what is absent is left out.
    fn key(&self, row: usize) -> BTreeSet<String> {
        let columns = self.columns.iter();
        let said = columns.filter_map(|Setting { column, data }| {
            let value = data.value(row)?;
            Some(format!("{} {} {value};", column.name, column.unit))
        });
        said.collect()
    }

    /// The same in words: what varies.
    fn words(&self, row: usize) -> String {
        let columns = self.columns.iter();
        let varying = columns.filter(|one| one.data.varies(0..self.table.n_rows));
        let said = varying.filter_map(|one| Some(one.column.phrase(&one.data.value(row)?)));
        said.collect::<Vec<_>>().join(", ")
    }

    /// Returns a count, or `None` if the table does not have the column or the row has no number there.
    fn count(&self, column: &str, row: usize) -> Option<usize> {
        let number = self.table.numbers(column)?[row];
        (!number.is_nan()).then_some(number as usize)
    }

    /// The numbers of a column in some rows.
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

    /// How a trial splits the touches; none where nothing says so.
    fn trial_size(&self, row: usize) -> Option<TrialSize> {
        self.is_repeated.then_some(())?;
        Some(TrialSize {
            n_train: self.count("n_train", row)?,
            // How much the trials overlap is a matter of touches, however many of them one decision takes.
            n_test: self.count("n_test", row)? * self.count("fused_touches", row).unwrap_or(1),
        })
    }
}

fn of_column(column: &Column, first: &Settings, second: &Settings) -> Result<ColumnDifferences> {
    let known = first.groups.iter().map(|rows| (first.key(rows[0]), rows));
    let known: HashMap<BTreeSet<String>, &Vec<usize>> = known.collect();
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
        n_both,
        n_first_only: first.groups.len() - n_both,
        n_second_only: second.groups.len() - n_both,
    })
}

fn explained(is_by_chance: bool) -> Moved {
    match is_by_chance {
        true => Moved::ByChance,
        false => Moved::Surely,
    }
}

type Rows<'a> = (&'a Settings<'a>, &'a [usize]);

/// Of one setting; none where a number is absent.
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
    let paired = Paired::of(&ours_told, &theirs_told);
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
        moved: match intervals {
            _ if ours_mean == theirs_mean => Moved::Same,
            // Those of single trials say nothing of their means.
            Some(([low, high], [from, to])) if !first.is_repeated && !second.is_repeated => {
                explained(low <= to && from <= high)
            }
            _ => Moved::Untested,
        },
        p_value: tested.and_then(|tested| tested.p_value),
        p_holm: None,
        p_status: tested.map(|tested| tested.p_status),
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
