//! A chart as a value: which columns of which table it shows, and how.

use super::{Column, Table, Value};

/// What a chart shows. One renderer draws it as SVG and PNG, and the page contains the SVG.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartSpec {
    /// File name without ending.
    pub name: String,
    /// What it shows, in words.
    pub title: String,
    /// How to read it, in a sentence or two; empty where the chart says all.
    pub note: String,
    /// The file of its [table](super::Table).
    pub table: &'static str,
    /// Only rows with these values.
    pub shown: Vec<Shown>,
    /// The column along x; its scale is the column's.
    pub x: String,
    /// What runs along x where the column holds values of several things: its words, unit and scale in place of the column's.
    pub x_is: Option<Column>,
    /// The column along y. Its interval, if it has one, is drawn as a band or as whiskers.
    pub y: String,
    /// Columns of which each combination has a line, or a colour of points, of its own; of tiles, a row of panels.
    pub lines: Vec<String>,
    /// The column of which each value has a panel of its own.
    pub panels: Option<String>,
    /// How rows are drawn.
    pub mark: Mark,
    /// Lines across the chart: chance, a limit, a published value.
    pub rules: Vec<Rule>,
    /// Whether the Pareto front of the points is drawn: x is what it costs, and y is better as its [role](super::Role) says.
    pub front: bool,
}

impl Table {
    /// A line chart of two of its columns, y against x, with the table's note.
    pub fn chart(
        &self,
        name: impl Into<String>,
        title: impl Into<String>,
        (y, x): (&str, &str),
    ) -> ChartSpec {
        ChartSpec {
            name: name.into(),
            title: title.into(),
            note: self.note.clone(),
            table: self.file,
            x: x.to_owned(),
            y: y.to_owned(),
            ..ChartSpec::default()
        }
    }
}

impl Rule {
    /// At a value of an axis.
    pub fn at(along: Along, value: f64, words: impl Into<String>) -> Self {
        Self {
            along,
            at: At::Value(value),
            words: words.into(),
        }
    }
}

/// Rows of which a column has a value.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The column.
    pub column: String,
    /// Its value; an empty word where it has none.
    pub value: Value,
}

/// How rows are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Mark {
    /// Points joined along x; points alone where x is words.
    #[default]
    Line,
    /// Points alone.
    Points,
    /// A tile at each x and y.
    Tiles {
        /// The column that fills it: an outcome by a colour and a letter, a number by a sequential scale.
        fill: String,
        /// The column that is written on it, in place of the letter or the number; where it is absent, these stand there.
        sign: Option<String>,
    },
}

/// A line across the chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// The axis on which it stands.
    pub along: Along,
    /// Where.
    pub at: At,
    /// What it is.
    pub words: String,
}

/// Where a rule stands.
#[derive(Clone, Debug, PartialEq)]
pub enum At {
    /// At a value of its axis.
    Value(f64),
    /// Where a column says, in each panel for each place along the other axis: chance that depends on the number of objects, a limit that
    /// depends on the mass.
    Column(String),
}

/// An axis of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Across.
    X,
    /// Up.
    Y,
}
