//! What a chart shows of its table: rows, lines, panels, and where each row stands.

use super::scale::{Scale, values};
use crate::error::{Error, Result};
use crate::table::{Along, At, ChartSpec, Column, Data, Mark, Role, Rule, Table, Value};

/// Lines up to which bands do not hide each other; more lines get a whisker at each point.
const MOST_BANDS: usize = 4;
/// Points up to which whiskers can be told apart.
const MOST_WHISKERS: usize = 80;

/// A chart's spec with what it means of its table.
pub(super) struct View<'a> {
    pub spec: &'a ChartSpec,
    pub table: &'a Table,
    /// Rows that are shown.
    pub rows: Vec<usize>,
    /// Of each row that is shown its line, and the lines' names.
    pub lines: Groups,
    /// Of each row that is shown its panel, and the panels' names.
    pub panels: Groups,
    pub x: Scale,
    pub y: Scale,
    /// Whether lines are joined along x: between words, or a number and what stands for none of it, there is nothing.
    pub is_joined: bool,
    /// Rows that have a place, line by line along x.
    pub places: Vec<Place>,
}

/// Where a row stands in its panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The row of the table.
    pub row: usize,
    /// The number of its panel.
    pub panel: usize,
    /// The number of its line.
    pub line: usize,
    /// Part of the panel's width, from the left.
    pub x: f64,
    /// Part of the panel's height, from below.
    pub y: f64,
    /// The ends of its interval, as `y`; none if it has none.
    pub interval: Option<[f64; 2]>,
}

/// Rows by the values of some columns.
#[derive(Default)]
pub(super) struct Groups {
    /// What stands before the names: `classifier`; empty without columns.
    pub heading: String,
    /// Of each group its values in words; one empty name without columns.
    pub names: Vec<String>,
    /// The group of each row of the table; 0 of those that are not shown.
    pub of: Vec<usize>,
}

impl<'a> View<'a> {
    pub fn of(spec: &'a ChartSpec, tables: &'a [Table]) -> Result<Self> {
        let table = tables.iter().find(|table| table.file == spec.table);
        let table = table.ok_or_else(|| {
            let files: Vec<&str> = tables.iter().map(|table| table.file).collect();
            let given = format!("table {:?}", spec.table);
            Error::input(
                format!("chart {}", spec.name),
                given,
                format!("one of {}", files.join(", ")),
            )
        })?;
        let column = |name: &str| column_of(spec, table, name);
        let mut shown = Vec::new();
        for one in &spec.shown {
            shown.push((column(&one.column)?.1, &one.value));
        }
        let is_shown = |row: &usize| {
            let has = |(data, value): &(&Data, &Value)| data.value(*row).as_ref() == Some(*value);
            shown.iter().all(has)
        };
        let rows: Vec<usize> = (0..table.n_rows).filter(is_shown).collect();
        for name in spec.lines.iter().chain(&spec.panels) {
            column(name)?;
        }
        let lines = Groups::of(table, &spec.lines, &rows);
        let panels = Groups::of(table, spec.panels.as_slice(), &rows);
        let (mut x, y) = (column(&spec.x)?, column(&spec.y)?);
        x.0 = spec.x_is.as_ref().unwrap_or(x.0);
        let (mut x_values, y_values) = (values(x.0, x.1, &rows), values(y.0, y.1, &rows));
        if matches!(spec.mark, Mark::Tiles { .. }) {
            order_as(&mut x_values, &y_values.1);
        }
        let interval = interval_of(table, y.0);
        let mut along = [x_values.0.clone(), y_values.0.clone()];
        for bound in interval.into_iter().flatten() {
            along[1].extend(rows.iter().map(|&row| bound[row]));
        }
        for Rule {
            along: axis, at, ..
        } in &spec.rules
        {
            let along = &mut along[usize::from(*axis == Along::Y)];
            match at {
                At::Value(value) => along.push(*value),
                At::Column(name) => {
                    let numbers = table
                        .numbers(name)
                        .ok_or_else(|| no_column(spec, table, name))?;
                    along.extend(rows.iter().map(|&row| numbers[row]));
                }
            }
        }
        let is_tiles = matches!(spec.mark, Mark::Tiles { .. });
        let (x_scale, y_scale) = match is_tiles {
            true => (
                Scale::of_tiles(x.0, (&x_values.0, &x_values.1), Along::X),
                Scale::of_tiles(y.0, (&y_values.0, &y_values.1), Along::Y),
            ),
            false => (
                Scale::of(x.0, (&along[0], &x_values.1), Along::X),
                Scale::of(y.0, (&along[1], &y_values.1), Along::Y),
            ),
        };
        let is_broken = x_scale.is_words() || x.0.has_named_numbers();
        let mut view = Self {
            spec,
            table,
            rows,
            lines,
            panels,
            x: x_scale,
            y: y_scale,
            is_joined: spec.mark != Mark::Points && !is_broken,
            places: Vec::new(),
        };
        view.places = view.place_all((&x_values.0, &y_values.0), interval);
        Ok(view)
    }

    fn place_all(&self, (xs, ys): (&[f64], &[f64]), interval: Option<[&[f64]; 2]>) -> Vec<Place> {
        let mut places = Vec::new();
        for (number, &row) in self.rows.iter().enumerate() {
            let (Some(x), Some(y)) = (self.x.place(xs[number]), self.y.place(ys[number])) else {
                continue;
            };
            let end = |bound: &[f64]| self.y.place(bound[row]);
            let interval = interval.and_then(|[low, high]| Some([end(low)?, end(high)?]));
            let line = self.lines.of[row];
            places.push(Place {
                row,
                panel: self.panels.of[row],
                line,
                x: x + self.beside(line),
                y,
                interval,
            });
        }
        places.sort_by(|a, b| {
            (a.panel, a.line)
                .cmp(&(b.panel, b.line))
                .then(a.x.total_cmp(&b.x))
        });
        places
    }

    /// Lines stand beside each other at a word, so that their whiskers do not hide each other.
    fn beside(&self, line: usize) -> f64 {
        if !self.x.is_words() || self.spec.mark != Mark::Line {
            return 0.0;
        }
        let n = self.lines.names.len() as f64;
        let step = f64::min(0.14, 0.6 / n) / self.x.n_levels() as f64;
        step * (line as f64 - 0.5 * (n - 1.0))
    }

    /// The line of a panel.
    pub fn line(&self, panel: usize, line: usize) -> Vec<&Place> {
        let is_it = |place: &&Place| place.panel == panel && place.line == line;
        self.places.iter().filter(is_it).collect()
    }

    /// Whether intervals are bands: of few lines.
    pub fn has_bands(&self) -> bool {
        self.has_interval() && self.is_joined && self.lines.names.len() <= MOST_BANDS
    }

    /// Whether intervals are whiskers.
    pub fn has_whiskers(&self) -> bool {
        let is_many = self.spec.mark == Mark::Points && self.places.len() > MOST_WHISKERS;
        self.has_interval() && !self.has_bands() && !is_many
    }

    fn has_interval(&self) -> bool {
        self.places.iter().any(|place| place.interval.is_some())
    }

    /// The number of the panel in which a place stands: tiles have a row of panels for each line.
    pub fn panel_of(&self, place: &Place) -> usize {
        match self.spec.mark {
            Mark::Tiles { .. } => place.line * self.panels.names.len() + place.panel,
            _ => place.panel,
        }
    }

    /// What a panel is: `noise 10 %`, `RBF SVM`.
    pub fn panel_title(&self, panel: usize) -> String {
        self.title(self.spec.panels.as_slice(), &self.panels.names[panel])
    }

    /// What a row of panels of tiles is.
    pub fn row_title(&self, row: usize) -> String {
        let name = &self.lines.names[row];
        match &self.spec.lines[..] {
            [_] => self.title(&self.spec.lines, name),
            _ => format!("{}: {name}", self.lines.heading),
        }
    }

    /// A number says what it is of.
    fn title(&self, columns: &[String], name: &str) -> String {
        match columns {
            [column] => match self.column(column) {
                Some((column, Data::Numbers(_))) => format!("{} {name}", column.words),
                _ => name.to_owned(),
            },
            _ => name.to_owned(),
        }
    }

    /// A column that the spec names.
    pub fn column(&self, name: &str) -> Option<(&'a Column, &'a Data)> {
        self.table.column(name)
    }

    /// What an interval is: what the words of its ends have in common before a comma, else both.
    pub fn interval_words(&self) -> Option<String> {
        let (y, _) = self.column(&self.spec.y)?;
        let [low, high] = y.interval.as_ref()?;
        let words = |name: &str| {
            self.column(name)
                .map(|(column, _)| column.words.to_string())
        };
        let (low, high) = (words(low)?, words(high)?);
        Some(match (low.split_once(", "), high.split_once(", ")) {
            (Some((same, _)), Some((other, _))) if same == other => same.to_owned(),
            _ => format!("{low} to {high}"),
        })
    }

    /// Choices and conditions that have one value in the chart and stand nowhere in it, in words.
    pub fn constants(&self) -> String {
        let spec = self.spec;
        let used = |name: &str| {
            [&spec.x, &spec.y]
                .into_iter()
                .chain(&spec.lines)
                .chain(&spec.panels)
                .any(|n| n == name)
        };
        let columns = self.table.columns.iter().zip(&self.table.data);
        let columns = columns
            .filter(|(c, _)| matches!(c.role, Role::Choice | Role::Condition) && !used(&c.name));
        let phrases = columns.filter_map(|(column, data)| {
            let first = data.value(*self.rows.first()?)?;
            let is_same = |&row: &usize| data.value(row).as_ref() == Some(&first);
            self.rows
                .iter()
                .all(is_same)
                .then(|| column.phrase(&first).replace(' ', "\u{a0}"))
        });
        let phrases: Vec<String> = phrases.collect();
        match phrases.is_empty() {
            true => String::new(),
            false => format!("At {}.", phrases.join(", ")),
        }
    }
}

impl Groups {
    /// By the values of columns in the order of first rows; by one column of numbers in rising order.
    fn of(table: &Table, names: &[String], rows: &[usize]) -> Self {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut groups = table.groups(&names, rows.iter().copied());
        let columns = names.iter().filter_map(|name| table.column(name));
        let columns: Vec<(&Column, &Data)> = columns.collect();
        if let [(_, Data::Numbers(numbers))] = columns[..] {
            groups.sort_by(|a, b| numbers[a[0]].total_cmp(&numbers[b[0]]));
        }
        let mut of = vec![0; table.n_rows];
        for (group, rows) in groups.iter().enumerate() {
            rows.iter().for_each(|&row| of[row] = group);
        }
        let heading: Vec<&str> = columns.iter().map(|(c, _)| &c.words[..]).collect();
        let name = |group: &Vec<usize>| {
            let words = columns.iter();
            let words = words.map(|(column, data)| value_words(column, data, group[0]));
            words.collect::<Vec<_>>().join(", ")
        };
        Self {
            heading: heading.join(", "),
            names: groups.iter().map(name).collect(),
            of,
        }
    }
}

/// Puts words in the order of others, those first that these have: what is alike in rows and columns lies on the diagonal.
fn order_as((places, words): &mut (Vec<f64>, Vec<String>), others: &[String]) {
    let rank = |word: &String| {
        others
            .iter()
            .position(|other| other == word)
            .unwrap_or(others.len())
    };
    let mut order: Vec<usize> = (0..words.len()).collect();
    order.sort_by_key(|&word| rank(&words[word]));
    let mut now = vec![0.0; words.len()];
    for (place, &word) in order.iter().enumerate() {
        now[word] = place as f64;
    }
    *words = order.iter().map(|&word| words[word].clone()).collect();
    if !words.is_empty() {
        places
            .iter_mut()
            .for_each(|place| *place = now[*place as usize]);
    }
}

/// A value in words; of an absent one, what the column calls it.
pub(super) fn value_words(column: &Column, data: &Data, row: usize) -> String {
    match data.value(row) {
        Some(value) => column.value_words(&value),
        None => Some(column.word(""))
            .filter(|word| !word.is_empty())
            .unwrap_or_else(|| "none".to_owned()),
    }
}

fn column_of<'a>(spec: &ChartSpec, table: &'a Table, name: &str) -> Result<(&'a Column, &'a Data)> {
    table
        .column(name)
        .ok_or_else(|| no_column(spec, table, name))
}

fn no_column(spec: &ChartSpec, table: &Table, name: &str) -> Error {
    let names: Vec<&str> = table
        .columns
        .iter()
        .map(|column| &column.name[..])
        .collect();
    let place = format!("chart {} of {}", spec.name, table.file);
    Error::input(
        place,
        format!("column {name:?}"),
        format!("one of {}", names.join(", ")),
    )
}

fn interval_of<'a>(table: &'a Table, column: &Column) -> Option<[&'a [f64]; 2]> {
    let [low, high] = column.interval.as_ref()?;
    Some([table.numbers(low)?, table.numbers(high)?])
}
