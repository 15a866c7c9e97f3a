//! Tables and charts as a page holds them: JSON, column by column, each value as short as it reads.

use crate::table::{ChartSpec, Column, Data, Table};
use serde::Serialize;
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
    /// Each once, and the place of each row's in that list; no places where all rows have the same.
    Levels {
        levels: Vec<Short<'a>>,
        codes: Vec<u32>,
    },
    Each(Vec<Short<'a>>),
}

/// A value in as few letters as it needs; a number that is none is null.
#[derive(Serialize)]
#[serde(untagged)]
enum Short<'a> {
    Word(&'a str),
    Whole(i64),
    Number(f64),
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
            let text = json_of(&TableData {
                file: table.file,
                title: table.title,
                n: table.n_rows,
                columns: &table.columns,
                data: table.data.iter().map(ColumnData::of).collect(),
            });
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

impl<'a> ColumnData<'a> {
    fn of(data: &'a Data) -> Self {
        let (levels, codes): (Vec<Short>, Vec<u32>) = match data {
            Data::Words { levels, codes } => {
                let levels = levels.iter().map(|word| Short::Word(word));
                (levels.collect(), codes.clone())
            }
            Data::Numbers(numbers) => {
                let (levels, codes) = coded(numbers);
                if levels.len() > (numbers.len() / 4).clamp(1, MOST_LEVELS) {
                    return Self::Each(numbers.iter().map(|&n| short(n)).collect());
                }
                (levels.into_iter().map(short).collect(), codes)
            }
        };
        let is_same = levels.len() == 1;
        let codes = if is_same { Vec::new() } else { codes };
        Self::Levels { levels, codes }
    }
}

/// Numbers, each once, and the place of each in that list.
fn coded(numbers: &[f64]) -> (Vec<f64>, Vec<u32>) {
    let mut places: HashMap<u64, u32> = HashMap::new();
    let mut levels = Vec::new();
    let code = |&number: &f64| {
        let next = levels.len() as u32;
        *places.entry(number.to_bits()).or_insert_with(|| {
            levels.push(number);
            next
        })
    };
    let codes = numbers.iter().map(code).collect();
    (levels, codes)
}

fn short<'a>(number: f64) -> Short<'a> {
    match number.fract() == 0.0 && number.abs() < 1e15 {
        true => Short::Whole(number as i64),
        false => Short::Number(number),
    }
}
