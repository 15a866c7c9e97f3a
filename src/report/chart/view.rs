//! Data of a chart: the groups that form lines and panels, and the position of each row.

use super::scale::AxisScale;
use crate::error::{Error, Result};
use crate::report::pictures::Drawing;
use crate::report::swept::{Setting, constant_phrases};
use crate::table::{Along, At, ChartSpec, Data, Mark, Scale, Table, Value};
use std::collections::{HashMap, HashSet};

/// Maximum number of lines for which confidence intervals are drawn as bands. More bands would hide each other, so error bars replace them.
const MAX_BANDS: usize = 4;
/// Maximum number of lines with names at their ends; more names do not fit beside a panel.
const MAX_ENDS: usize = 16;
/// Maximum number of points with error bars; more error bars cannot be distinguished.
const MAX_WHISKERS: usize = 80;

/// Chart specification together with the table rows, groups and positions that it selects.
pub(super) struct View<'a> {
    pub spec: &'a ChartSpec,
    pub table: &'a Table,
    /// Indices of the table rows that the filters of the chart select.
    pub rows: Vec<usize>,
    /// Groups of rows that form the lines of the chart.
    pub lines: Groups,
    /// Groups of rows that form the panels of the chart.
    pub panels: Groups,
    /// Columns along the axes.
    pub x_column: Setting<'a>,
    pub y_column: Setting<'a>,
    /// Column that determines the colour of the tiles, in a chart of tiles.
    pub fill: Option<Setting<'a>>,
    /// Column whose texts are written above the points.
    pub label: Option<Setting<'a>>,
    pub x: AxisScale,
    pub y: AxisScale,
    /// Whether points are joined by lines along x; points at texts and named numbers are not joined.
    pub is_joined: bool,
    /// Title of each panel, such as `noise 10 %` or `RBF SVM`; empty if there is one panel.
    pub titles: Vec<String>,
    /// Positions of the rows in their panels, line by line along x.
    pub places: Vec<Place>,
}

/// Position of a table row within its panel of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Index of the row in the table.
    pub row: usize,
    /// Index of the panel that shows the row.
    pub panel: usize,
    /// Index of the line (series) to which the row belongs.
    pub line: usize,
    /// Horizontal position of the row as a fraction of the panel's width, from the left.
    pub x: f64,
    /// Vertical position of the row as a fraction of the panel's height, from below.
    pub y: f64,
    /// Ends of the row's confidence interval as fractions of the panel's height; `None` if there is no interval.
    pub interval: Option<[f64; 2]>,
}

/// Groups of table rows with equal values in some columns.
#[derive(Default)]
pub(super) struct Groups {
    /// Names of the columns by which rows are grouped, such as `classifier`; empty if rows are not grouped.
    pub heading: String,
    /// Values of the grouping columns as text, for each group; a single empty text if rows are not grouped.
    pub names: Vec<String>,
    /// Values of each group as a title; numbers are preceded by the name of their column.
    titles: Vec<String>,
    /// Index of the group of each table row; 0 for rows that are not shown.
    pub of: Vec<usize>,
}

impl<'a> View<'a> {
    /// Selects the rows, groups and positions of a chart from the table that the specification names.
    pub fn new(spec: &'a ChartSpec, tables: &'a [Table]) -> Result<Self> {
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
        let mut rows = table.all_rows();
        for shown in &spec.shown {
            let data = column(&shown.column)?.data;
            let absent = || Value::from("");
            rows.retain(|&row| data.value(row).unwrap_or_else(absent) == shown.value);
        }
        let groups = |names: &[String]| -> Result<Groups> {
            let settings: Result<Vec<Setting>> = names.iter().map(|name| column(name)).collect();
            Ok(Groups::new(table, &settings?, &rows))
        };
        let (lines, panels) = (groups(&spec.lines)?, groups(spec.panels.as_slice())?);
        let fill = spec.mark.fill().map(column).transpose()?;
        let is_tiles = fill.is_some();
        let (x, y) = (column(&spec.x)?, column(&spec.y)?);
        let y_values = values(&y, &rows, &[]);
        // Equal words have equal positions along x and y, so that matching pairs are on the diagonal.
        let x_values = values(&x, &rows, if is_tiles { &y_values.1 } else { &[] });
        let interval = y.column.interval.as_ref();
        let interval =
            interval.and_then(|[low, high]| Some([table.numbers(low)?, table.numbers(high)?]));
        let mut along = [x_values.0.clone(), y_values.0.clone()];
        for bound in interval.into_iter().flatten() {
            along[1].extend(rows.iter().map(|&row| bound[row]));
        }
        for rule in &spec.rules {
            let along = &mut along[usize::from(rule.along == Along::Y)];
            match &rule.at {
                At::Value(value) => along.push(*value),
                // A limit of zero has no place on a logarithmic axis.
                At::Column(name) => {
                    let (values, _) = values(&column(name)?, &rows, &[]);
                    along.extend(values.into_iter().filter(|&value| value != 0.0));
                }
            }
        }
        if spec.square {
            let both = along.concat();
            along = [both.clone(), both];
        }
        let scale = |one: &Setting, own: &(Vec<f64>, Vec<String>), all: &[f64], side| match is_tiles
            || one.column.scale == Scale::Words
        {
            true => AxisScale::of_levels(one.column, (&own.0, &own.1), side),
            false => {
                let mut column = one.column.clone();
                if spec.log_x && side == Along::X {
                    column.scale = Scale::Log;
                }
                AxisScale::new(&column, all, side)
            }
        };
        let x_scale = scale(&x, &x_values, &along[0], Along::X);
        let is_broken = x_scale.is_words || x.column.has_named_numbers();
        let mut view = Self {
            spec,
            table,
            titles: panels.titles.clone(),
            lines,
            panels,
            rows,
            x_column: x,
            y_column: y,
            fill,
            label: spec.label.as_deref().map(column).transpose()?,
            x: x_scale,
            // A front fills its panel along both axes.
            y: scale(
                &y,
                &y_values,
                &along[1],
                if spec.front || spec.square {
                    Along::X
                } else {
                    Along::Y
                },
            ),
            is_joined: spec.mark == Mark::Line && !is_broken,
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

    /// Returns the horizontal offset of a line on an axis of texts; offsets keep error bars of different lines apart.
    fn beside(&self, line: usize) -> f64 {
        if !self.x.is_words || self.spec.mark != Mark::Line {
            return 0.0;
        }
        let n = self.lines.names.len() as f64;
        let step = f64::min(0.14, 0.6 / n) / self.x.levels.len() as f64;
        step * (line as f64 - 0.5 * (n - 1.0))
    }

    /// Returns whether confidence intervals are drawn as bands, which is the case for charts with few lines.
    pub fn has_bands(&self) -> bool {
        self.has_interval() && self.is_joined && self.lines.names.len() <= MAX_BANDS
    }

    /// Returns whether each line has its name at its end instead of in the legend: the lines of a single panel that are many, but not too many for its height.
    pub fn has_end_labels(&self) -> bool {
        let is_single = self.panels.names.len() == 1 && self.spec.parts.is_empty();
        let n = self.lines.names.len();
        self.is_joined && is_single && n > MAX_BANDS && n <= MAX_ENDS
    }

    /// Returns whether confidence intervals are drawn, as bands or as error bars.
    pub fn has_interval(&self) -> bool {
        let is_many =
            self.spec.mark != Mark::Line && !self.spec.front && self.places.len() > MAX_WHISKERS;
        !is_many && self.places.iter().any(|place| place.interval.is_some())
    }

    /// Returns whether the result of a row is right, or the chart does not distinguish it.
    pub fn is_right(&self, row: usize) -> bool {
        let right = self.spec.right.as_ref();
        right.is_none_or(|right| self.table.has_setting(&right.column, row, &right.value))
    }

    /// Returns the positions of the rows in a panel, line by line along x.
    pub fn here(&self, panel: usize) -> impl Iterator<Item = &Place> + Clone {
        self.places.iter().filter(move |place| place.panel == panel)
    }

    /// Returns the setting in the column with this name.
    pub fn column(&self, name: &str) -> Result<Setting<'a>> {
        column_of(self.spec, self.table, name)
    }

    /// Draws the mark of a row in an SVG group with data attributes: row number, and axis values with units.
    pub fn draw_mark(&self, drawing: &mut Drawing, place: &Place, draw: impl FnOnce(&mut Drawing)) {
        let row = place.row;
        let y = self.y_column.column;
        let mut data = vec![
            ("row", row.to_string()),
            ("x", self.x_column.label(row)),
            ("y", self.y_column.label(row)),
        ];
        if let Some([low, high]) = self.table.interval(y, row) {
            data.push(("interval", format!("{} to {}", y.tick(low), y.tick(high))));
        }
        data.extend(self.fill.map(|fill| ("fill", fill.label(row))));
        let panel = &self.titles[place.panel];
        if !panel.is_empty() {
            data.push(("panel", panel.clone()));
        }
        drawing.group(data, draw);
    }

    /// Returns the name of the confidence interval: the part before the comma that its two column names share, or both names. Returns `None` if there is no
    /// interval.
    pub fn interval_words(&self) -> Option<String> {
        let words = |name: &str| Some(self.column(name).ok()?.column.words.as_ref());
        let [low, high] = self.y_column.column.interval.as_ref()?;
        let (low, high) = (words(low)?, words(high)?);
        Some(match (low.split_once(", "), high.split_once(", ")) {
            (Some((same, _)), Some((other, _))) if same == other => same.to_owned(),
            _ => format!("{low} to {high}"),
        })
    }

    /// Returns a text about the rows that are not drawn in the chart: their number and the reasons. The text is empty if all rows are drawn.
    pub fn omitted(&self) -> String {
        let (n, n_shown, n_drawn) = (self.table.n_rows, self.rows.len(), self.drawn().len());
        if n_drawn == n {
            return String::new();
        }
        let axes = [self.x_column, self.y_column].into_iter().chain(self.fill);
        let lacks = |one: &Setting| self.rows.iter().any(|&row| one.data.value(row).is_none());
        let lacking = axes
            .filter(lacks)
            .map(|one| format!("no {}", one.column.words));
        let reasons = match &lacking.collect::<Vec<_>>().join(" or ")[..] {
            "" => "no place of their own".to_owned(),
            reasons => reasons.to_owned(),
        };
        let have = |n: usize| if n == 1 { "has" } else { "have" };
        let said = [
            (n_shown - n_drawn, &reasons[..]),
            (n - n_shown, "other settings"),
        ];
        let said = said.into_iter().filter(|(n, _)| *n > 0);
        let said = said.map(|(n, what)| format!("{n} {} {what}", have(n)));
        let said = said.collect::<Vec<_>>().join(", ");
        format!("{n_drawn} of {n} rows are drawn; {said}.")
    }

    /// Returns the rows whose marks are visible; a tile at the position of an earlier tile covers the earlier tile.
    pub fn drawn(&self) -> Vec<usize> {
        let Some(fill) = self.fill else {
            return self.places.iter().map(|place| place.row).collect();
        };
        let is_filled = |place: &&Place| fill.data.value(place.row).is_some();
        let seen = self.places.iter().filter(is_filled).map(|place| {
            let at = (place.panel, place.x.to_bits(), place.y.to_bits());
            (at, place.row)
        });
        let seen: HashMap<_, usize> = seen.collect();
        let mut rows: Vec<usize> = seen.into_values().collect();
        rows.sort_unstable();
        rows
    }

    /// Returns a text with the choices and conditions that are constant in the chart and that the chart does not show otherwise.
    pub fn constants(&self) -> String {
        let spec = self.spec;
        let mut rows: Vec<usize> = self.places.iter().map(|place| place.row).collect();
        rows.sort_unstable();
        let axes = [&spec.x, &spec.y].into_iter();
        let used: Vec<&String> = axes.chain(&spec.lines).chain(&spec.panels).collect();
        let is_used = |one: &Setting| used.iter().any(|name| **name == one.column.name);
        match &constant_phrases(self.table, &rows, |one| !is_used(one))[..] {
            [] => String::new(),
            said => format!("At {}.", said.join(", ")),
        }
    }
}

impl Groups {
    /// Groups rows with equal values in the given columns, in the order of first occurrence. Groups of a single numeric column are in ascending order.
    fn new(table: &Table, settings: &[Setting], rows: &[usize]) -> Self {
        let mut groups = Setting::groups(settings, table, rows);
        if let [one] = settings
            && let Data::Numbers(numbers) = one.data
        {
            groups.sort_by(|a, b| numbers[a[0]].total_cmp(&numbers[b[0]]));
        }
        let mut of = vec![0; table.n_rows];
        for (group, rows) in groups.iter().enumerate() {
            rows.iter().for_each(|&row| of[row] = group);
        }
        let joined = |words: &dyn Fn(&Setting) -> String| {
            settings.iter().map(words).collect::<Vec<_>>().join(", ")
        };
        let rows = groups.iter().map(|rows| rows[0]);
        let name = |row: usize| match settings {
            [one] => one.label(row),
            some => Setting::short_words(some, row),
        };
        Self {
            heading: joined(&|one| one.column.words.to_string()),
            names: rows.clone().map(name).collect(),
            titles: rows.map(|row| joined(&|one| one.title(row))).collect(),
            of,
        }
    }
}

/// Returns the values of a numeric setting in the given rows. For a setting of words, returns the index of each row's word, and the list of words. The words
/// are in the order of `first`, then in the order of the table.
fn values(one: &Setting, rows: &[usize], first: &[String]) -> (Vec<f64>, Vec<String>) {
    let (levels, codes) = match one.data {
        Data::Numbers(numbers) => {
            return (rows.iter().map(|&row| numbers[row]).collect(), Vec::new());
        }
        Data::Words { levels, codes } => (levels, codes),
    };
    let shown: HashSet<u32> = rows.iter().map(|&row| codes[row]).collect();
    let mut order: Vec<u32> = (0..levels.len() as u32)
        .filter(|code| shown.contains(code))
        .collect();
    let word = |code: u32| one.column.word(&levels[code as usize]);
    order.sort_by_key(|&code| {
        let place = first.iter().position(|other| *other == word(code));
        place.unwrap_or(first.len())
    });
    let mut places = vec![f64::NAN; levels.len()];
    for (place, &code) in order.iter().enumerate() {
        places[code as usize] = place as f64;
    }
    let of_row = |&row: &usize| places[codes[row] as usize];
    (
        rows.iter().map(of_row).collect(),
        order.into_iter().map(word).collect(),
    )
}

fn column_of<'a>(spec: &ChartSpec, table: &'a Table, name: &str) -> Result<Setting<'a>> {
    let found = table.column(name);
    let found = found.map(|(column, data)| Setting { column, data });
    found.ok_or_else(|| {
        let names: Vec<&str> = table.columns.iter().map(|c| &c.name[..]).collect();
        let place = format!("chart {} of {}", spec.name, table.file);
        let allowed = format!("one of {}", names.join(", "));
        Error::input(place, format!("column {name:?}"), allowed)
    })
}
