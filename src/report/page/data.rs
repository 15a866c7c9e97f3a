//! Tables and charts as a page holds them: JSON, column by column, each value as short as it reads.

use crate::table::{ChartSpec, Column, Data, Role, Table};
use serde::{Serialize, Serializer};
use std::collections::{HashMap, HashSet};

/// Letters of all tables of a page, at most: with pictures it stays below 3 MB. Tables that would be more lie beside it.
const MOST_LETTERS: usize = 2_000_000;
/// Different numbers up to which a column is written as their places in a list.
const MOST_LEVELS: usize = 1000;

/// What the script draws from.
pub(super) struct PageData {
    /// Its text.
    pub json: String,
    /// Files of the tables that are in it.
    held: HashSet<&'static str>,
}

#[derive(Serialize)]
struct TableData<'a> {
    file: &'a str,
    title: &'a str,
    n: usize,
    columns: &'a [Column],
    data: Vec<ColumnData<'a>>,
}

/// The values of a column, whichever form is shorter.
#[derive(Serialize)]
#[serde(untagged)]
enum ColumnData<'a> {
    SameWord {
        same: &'a str,
    },
    SameNumber {
        same: Short,
    },
    Words {
        levels: &'a [String],
        codes: &'a [u32],
    },
    Levels {
        levels: Vec<Short>,
        codes: Vec<u32>,
    },
    Numbers(Vec<Short>),
}

/// A number in as few letters as it needs; absent if it is none.
#[derive(Clone, Copy)]
struct Short(f64);

impl Serialize for Short {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            n if !n.is_finite() => serializer.serialize_none(),
            n if n.fract() == 0.0 && n.abs() < 1e15 => serializer.serialize_i64(n as i64),
            n => serializer.serialize_f64(n),
        }
    }
}

impl PageData {
    /// Tables that charts show come first, then the smaller.
    pub fn of(tables: &[Table], charts: &[ChartSpec]) -> Self {
        let mut order: Vec<&Table> = tables.iter().filter(|table| table.n_rows > 0).collect();
        let is_charted = |table: &Table| charts.iter().any(|chart| chart.table == table.file);
        order.sort_by_key(|table| (!is_charted(table), table.csv.len()));
        let mut held = HashSet::new();
        let mut letters = 0;
        let mut texts = Vec::new();
        for table in order {
            let text = json_of(&TableData::of(table));
            if letters + text.len() <= MOST_LETTERS {
                letters += text.len();
                held.insert(table.file);
                texts.push(text);
            }
        }
        let charts: Vec<&ChartSpec> = charts
            .iter()
            .filter(|chart| held.contains(chart.table))
            .collect();
        let json = format!(
            "{{\"tables\":[{}],\"charts\":{}}}",
            texts.join(","),
            json_of(&charts)
        );
        Self { json, held }
    }

    /// Whether a table is in it.
    pub fn holds(&self, file: &str) -> bool {
        self.held.contains(file)
    }
}

fn json_of(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("numbers and texts have a JSON form")
}

impl<'a> TableData<'a> {
    fn of(table: &'a Table) -> Self {
        let data = table.columns.iter().zip(&table.data);
        Self {
            file: table.file,
            title: table.title,
            n: table.n_rows,
            columns: &table.columns,
            data: data
                .map(|(column, data)| ColumnData::of(column, data))
                .collect(),
        }
    }
}

impl<'a> ColumnData<'a> {
    fn of(column: &Column, data: &'a Data) -> Self {
        match data {
            Data::Words { levels, .. } if levels.len() == 1 => Self::SameWord { same: &levels[0] },
            Data::Words { levels, codes } => Self::Words { levels, codes },
            Data::Numbers(numbers) => {
                Self::of_numbers(numbers.iter().map(|&n| said(column, n)).collect())
            }
        }
    }

    fn of_numbers(numbers: Vec<Short>) -> Self {
        let mut places: HashMap<u64, u32> = HashMap::new();
        let mut levels: Vec<Short> = Vec::new();
        let mut codes: Vec<u32> = Vec::with_capacity(numbers.len());
        for &number in &numbers {
            let next = levels.len() as u32;
            let code = *places.entry(number.0.to_bits()).or_insert(next);
            if code == next {
                levels.push(number);
            }
            codes.push(code);
        }
        match levels.len() {
            1 => Self::SameNumber { same: levels[0] },
            n if n <= MOST_LEVELS.min(numbers.len() / 4) => Self::Levels { levels, codes },
            _ => Self::Numbers(numbers),
        }
    }
}

/// Settings as they are, since readers choose them; of all else six digits.
fn said(column: &Column, number: f64) -> Short {
    let is_setting = matches!(column.role, Role::Choice | Role::Condition | Role::Subject);
    Short(
        match is_setting || number.fract() == 0.0 || !number.is_finite() {
            true => number,
            false => format!("{number:.5e}").parse().unwrap_or(number),
        },
    )
}
