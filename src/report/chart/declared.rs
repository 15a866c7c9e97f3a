//! Charts as constants: the columns of a table in their places. A kind of study lists its charts.

use crate::report::advice::Candidates;
use crate::report::swept::Setting;
use crate::table::{ChartSpec, Mark, Rule, Shown, Table};

/// Chart of a kind of study, as a constant. [`Chart::specs`] returns its specifications for the tables of a study.
///
/// In the texts, the name of a column in braces stands for the column's value in the first drawn row, such as `{noise_std}`. In the title, `{x}` and `{y}` stand
/// for the names of the axes, `{best}` for the cheapest value within the interval of the best, and `{choice}` for the choice that has it. In the note, `{note}` stands for the note of the table.
#[derive(Clone, Copy)]
pub struct Chart {
    /// File name of the table that the chart shows. A study without this table lacks the chart.
    pub table: &'static str,
    /// File name of the chart, without extension.
    pub name: &'static str,
    /// Title of the chart.
    pub title: &'static str,
    /// Explanation of the chart for the reader.
    pub note: &'static str,
    /// Name of the column along the x axis.
    pub x: &'static str,
    /// Name of the column along the y axis.
    pub y: &'static str,
    /// Columns that divide the rows into lines or point colours. Of several columns, those with one value are left out.
    pub lines: &'static [&'static str],
    /// Column that divides the rows into panels.
    pub panels: Option<&'static str>,
    /// Columns of which each combination of values has its own chart. A combination with a single value along x has no line chart.
    pub each: &'static [&'static str],
    /// Columns and the words that the drawn rows have in them.
    pub shown: &'static [(&'static str, &'static str)],
    /// Type of the marks.
    pub mark: Mark,
    /// Column and word of rows whose results are right; the markers of other rows are crosses.
    pub right: Option<(&'static str, &'static str)>,
    /// Reference lines across the chart.
    pub rules: &'static [Rule],
    /// Whether the Pareto front of the points is drawn.
    pub front: bool,
    /// Whether both axes have the same range and length.
    pub square: bool,
}

impl Chart {
    /// Line chart without table and axes, for the fields that a constant leaves out.
    pub const LINES: Self = Self {
        table: "",
        name: "",
        title: "{y} by {x}",
        note: "{note}",
        x: "",
        y: "",
        lines: &[],
        panels: None,
        each: &[],
        shown: &[],
        mark: Mark::Line,
        right: None,
        rules: &[],
        front: false,
        square: false,
    };

    /// Points with their Pareto front, for the fields that a constant leaves out.
    pub const FRONT: Self = Self {
        mark: Mark::Points,
        front: true,
        ..Self::LINES
    };

    /// Returns the specifications of the chart, one for each combination of the values of the columns `each`.
    pub fn specs(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let Some(table) = tables.iter().find(|table| table.file == self.table) else {
            return Vec::new();
        };
        let mut rows = table.all_rows();
        rows.retain(|&row| {
            let mut shown = self.shown.iter();
            shown.all(|(column, word)| table.word(column, row) == *word)
        });
        let mut groups = table.groups(self.each, rows);
        groups.retain(|rows| {
            let x = table.column(self.x);
            let is_line = self.mark == Mark::Line && !self.each.is_empty();
            !is_line || x.is_some_and(|(_, x)| x.varies(rows.iter().copied()))
        });
        groups.iter().map(|rows| self.spec(table, rows)).collect()
    }

    /// Returns the specification of the chart for one combination of the values of the columns `each`, which the given rows have.
    pub fn spec(&self, table: &Table, rows: &[usize]) -> ChartSpec {
        let filled = |text: &str, words: &dyn Fn(&Setting) -> String| {
            Setting::all(table).fold(text.to_owned(), |text, one| {
                let place = format!("{{{}}}", one.column.name);
                match text.contains(&place) {
                    true => text.replace(&place, &words(&one)),
                    false => text,
                }
            })
        };
        let code = |one: &Setting| one.data.value(rows[0]).map(|value| value.to_string());
        let name = filled(self.name, &|one| code(one).unwrap_or_default());
        let title = filled(self.title, &|one| one.title(rows[0]));
        let best = match title.contains("{best}") {
            true => Candidates::of_columns(table, self.y, self.x),
            false => None,
        };
        let (best, choice) = best.map_or_else(Default::default, |best| {
            let as_good = best.by_condition_of(rows).into_iter().next();
            let as_good = as_good.and_then(|of_one| best.best_and_as_good(&of_one));
            let choice = as_good.map(|[_, cheapest]| best.choices(&cheapest));
            (best.as_good_words(rows), choice.unwrap_or_default())
        });
        let title = title.replace("{best}", &best).replace("{choice}", &choice);
        let note = filled(self.note, &|one| one.label(rows[0]));
        let words = self.shown.iter();
        let words = words.map(|(column, word)| Shown::new(*column, *word));
        let each = self.each.iter();
        let each = each.filter_map(|column| table.shown(column, rows[0]));
        let is_line = |name: &&&str| {
            let column = table.column(name);
            self.lines.len() == 1
                || column.is_some_and(|(_, data)| data.varies(rows.iter().copied()))
        };
        let lines = self.lines.iter().filter(is_line);
        ChartSpec {
            note: note.replace("{note}", &table.note),
            shown: words.chain(each).collect(),
            lines: lines.map(|name| (*name).to_owned()).collect(),
            panels: self.panels.map(str::to_owned),
            mark: self.mark,
            right: self.right.map(|(column, word)| Shown::new(column, word)),
            rules: self.rules.to_vec(),
            front: self.front,
            square: self.square,
            ..table.chart(name, title, (self.y, self.x))
        }
    }
}
