//! Specification of a chart: its columns, and the type of its marks.

use super::{Table, Value};
use std::borrow::Cow;

/// Specification of a chart, which is drawn as SVG and PNG; the result page contains the SVG.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartSpec {
    /// File name of the chart, without extension.
    pub name: String,
    /// Title of the chart.
    pub title: String,
    /// Explanation of the chart for the reader, one or two sentences; may be empty.
    pub note: String,
    /// File name of the table that the chart shows.
    pub table: &'static str,
    /// Filters of the drawn rows; a row is drawn if it passes all filters.
    pub shown: Vec<Shown>,
    /// Name of the column along the x axis; the column defines the scale of the axis.
    pub x: String,
    /// Whether the x axis is logarithmic, whatever the scale of the column.
    pub log_x: bool,
    /// Name of the column along the y axis. If the column has an interval, the chart shows a band or error bars.
    pub y: String,
    /// Column whose texts are written above the points; `None` for points without such labels.
    pub label: Option<String>,
    /// Columns that divide the rows into lines or point colours, one for each combination of values.
    pub lines: Vec<String>,
    /// Column that divides the rows into panels, one for each value; `None` for a single panel.
    pub panels: Option<String>,
    /// Type of the marks: lines, points or tiles.
    pub mark: Mark,
    /// Rows whose results are right; the markers of other rows are crosses. `None` if all markers are alike.
    pub right: Option<Shown>,
    /// Reference lines across the chart, such as the chance level, a limit or a published value.
    pub rules: Vec<Rule>,
    /// Markers on the lines that are not rows of the table, such as the place at which an accuracy is halved.
    pub dots: Vec<Dot>,
    /// Small charts of the same table. They share the title, the legend and the y axis of this chart and replace its panels. Empty for a chart with panels of
    /// its own.
    pub parts: Vec<ChartSpec>,
    /// Whether both axes have the same range and length, as for places on a skin and for two values of one quantity.
    pub square: bool,
    /// Whether the Pareto front of the points is drawn. The x axis is the cost, and the role of the y column defines the better direction.
    pub front: bool,
}

impl Table {
    /// Creates the specification of a line chart of y against x, with the note of the table. In the title, the display names of the columns replace `{x}` and
    /// `{y}`; the title starts with a capital letter.
    pub fn chart(
        &self,
        name: impl Into<String>,
        title: impl Into<String>,
        (y, x): (&str, &str),
    ) -> ChartSpec {
        let words = |name| {
            let column = self.column(name);
            column.map_or_else(String::new, |(column, _)| column.words.to_string())
        };
        let title = title.into().replace("{x}", &words(x));
        let title = title.replace("{y}", &words(y));
        let mut letters = title.chars();
        let first = letters.next().map(char::to_uppercase);
        ChartSpec {
            name: name.into(),
            title: first.into_iter().flatten().chain(letters).collect(),
            note: self.note.clone(),
            table: self.file,
            x: x.to_owned(),
            y: y.to_owned(),
            ..ChartSpec::default()
        }
    }
}

impl Shown {
    /// Creates the filter of the rows with a value in a column.
    pub fn new(column: impl Into<String>, value: impl Into<Value>) -> Self {
        Self {
            column: column.into(),
            value: value.into(),
        }
    }
}

impl Rule {
    /// Creates a reference line at a constant value of an axis.
    pub fn at(along: Along, value: f64, words: impl Into<Cow<'static, str>>) -> Self {
        Self {
            along,
            at: At::Value(value),
            words: words.into(),
        }
    }

    /// Creates a constant reference line with a constant label.
    pub const fn constant(along: Along, at: At, words: &'static str) -> Self {
        Self {
            along,
            at,
            words: Cow::Borrowed(words),
        }
    }
}

/// Filter that selects the table rows with a given value in a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Name of the column that is filtered.
    pub column: String,
    /// Value that the rows must have; an empty word selects absent values.
    pub value: Value,
}

/// Type of the marks of a chart, such as lines, points or tiles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Mark {
    /// Points joined by lines along x. If the x column contains words, the points are not joined.
    #[default]
    Line,
    /// Points that are not joined by lines.
    Points,
    /// One coloured tile for each pair of x and y values.
    Tiles {
        /// Column that determines the colour of the tiles: outcomes with one colour each, or numbers on a sequential colour scale.
        fill: &'static str,
    },
}

impl Mark {
    /// Returns the name of the column that determines the colour of the marks; `None` if there is no such column.
    pub fn fill(self) -> Option<&'static str> {
        match self {
            Self::Tiles { fill } => Some(fill),
            _ => None,
        }
    }
}

/// Marker at a position on the line of a table row.
#[derive(Clone, Debug, PartialEq)]
pub struct Dot {
    /// Index of a table row on the line, which determines the colour of the marker.
    pub row: usize,
    /// Position of the marker, in the units of the x and the y column.
    pub at: (f64, f64),
}

/// Reference line across the chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Axis on which the reference line has its value.
    pub along: Along,
    /// Position of the reference line on its axis.
    pub at: At,
    /// Label of the reference line in the legend of the chart.
    pub words: Cow<'static, str>,
}

/// Position of a reference line on its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// Constant position on the axis.
    Value(f64),
    /// Column that contains the position of the reference line, for each panel and each value on the other axis. Examples: a chance level that depends on the
    /// number of objects, or a limit that depends on the mass.
    Column(&'static str),
}

/// Axis of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Horizontal axis (x).
    X,
    /// Vertical axis (y).
    Y,
}
