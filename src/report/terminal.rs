//! What a run prints at its end: the summary table, at the width of the terminal.

use crate::report::answer::{Answer, accuracy_sentence};
use crate::report::axis::Axis;
use crate::report::chart_plan::plan_charts;
use crate::report::colours::Rgb;
use crate::report::text_width::break_lines;
use crate::report::varying::{Levels, Settings, unbroken_parts};
use crate::study::table::{Cell, CellScore, Tables};
use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, Table, TableComponent, presets,
};
use std::io::IsTerminal;

/// Cells up to which each gets a line; beyond, one axis runs across.
const MOST_LISTED: usize = 40;

/// Lines of the compact table, at most.
const MOST_LINES: usize = 40;

/// Blanks between two columns.
const COLUMN_GAP: usize = 3;

/// Which colours a stream may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// No escape codes: a pipe, a file, `TERM=dumb`, or `NO_COLOR` set.
    Plain,
    /// The 256 colours of xterm.
    Colours256,
    /// 24 bits.
    TrueColour,
}

impl Ink {
    /// What standard output may show now.
    pub fn of_stdout() -> Self {
        let variable = |name: &str| std::env::var(name).unwrap_or_default();
        let refused = !variable("NO_COLOR").is_empty() || variable("TERM") == "dumb";
        if refused || !std::io::stdout().is_terminal() {
            return Self::Plain;
        }
        match variable("COLORTERM").as_str() {
            "truecolor" | "24bit" => Self::TrueColour,
            _ => Self::Colours256,
        }
    }

    /// Escape code for the colour of letters.
    pub fn letter(self, colour: Rgb) -> String {
        self.code(38, colour)
    }

    /// Escape code for the colour behind letters.
    pub fn ground(self, colour: Rgb) -> String {
        self.code(48, colour)
    }

    /// Escape code for the terminal's own colours.
    pub fn reset(self) -> &'static str {
        match self {
            Self::Plain => "",
            Self::Colours256 | Self::TrueColour => "\x1b[0m",
        }
    }

    fn code(self, what: u8, [r, g, b]: Rgb) -> String {
        match self {
            Self::Plain => String::new(),
            Self::TrueColour => format!("\x1b[{what};2;{r};{g};{b}m"),
            Self::Colours256 => {
                let sixth = |channel: u8| (u16::from(channel) * 5 + 127) / 255;
                let colour = 16 + 36 * sixth(r) + 6 * sixth(g) + sixth(b);
                format!("\x1b[{what};5;{colour}m")
            }
        }
    }
}

/// The summary as text without escape codes, lines at most `width` letters long.
///
/// Settings that are the same in all cells stand once above the table. Up to 40 cells get a line each; more are shown with
/// one axis running across, and if even that is too long, the text says how many lines were left out and that
/// `full_table` has them.
pub fn summary_table(tables: &Tables, width: usize, full_table: &str) -> String {
    let cells: Vec<&Cell> = tables.summary.iter().map(|(cell, _)| cell).collect();
    if cells.is_empty() {
        return "No cell has been computed.\n".to_owned();
    }
    let settings = Settings::of(&cells);
    let mut text = String::new();
    let fixed: Vec<String> = settings.fixed.iter().map(Levels::sentence).collect();
    let fixed = format!("All cells: {}", unbroken_parts(&fixed));
    text += &paragraph(&fixed, width);
    text.push('\n');
    text += &if cells.len() <= MOST_LISTED {
        list(tables, &settings, width)
    } else {
        pivot(tables, &settings, width, full_table)
    };
    if settings
        .shown()
        .iter()
        .any(|levels| levels.heading() != levels.axis.name())
    {
        text += "Noise is its standard deviation in percent of the full scale.\n";
    }
    text.push('\n');
    for sentence in Answer::of(tables).iter().flat_map(Answer::sentences) {
        text += &paragraph(&sentence, width);
    }
    text
}

/// One line a cell.
fn list(tables: &Tables, settings: &Settings, width: usize) -> String {
    let axes = settings.shown();
    let best = Answer::of(tables).filter(|_| tables.summary.len() > 1);
    let mut table = ruled_table(width);
    let names = axes.iter().map(|levels| levels.axis.name().to_owned());
    let scores = ["accuracy [95 %]", "macro-F1", ""].map(str::to_owned);
    table.set_header(names.chain(scores));
    for (cell, score) in &tables.summary {
        let mut row: Vec<String> = axes
            .iter()
            .map(|levels| levels.axis.value(cell).label)
            .collect();
        row.push(accuracy_sentence(score));
        row.push(format!("{:.2}", score.macro_f1));
        row.push(
            best.as_ref()
                .map_or("", |best| best.remark(cell, score))
                .to_owned(),
        );
        table.add_row(row);
    }
    align(&mut table, &axes, 2);
    // An interval broken over two lines cannot be read down the column.
    if let Some(accuracy) = table.column_mut(axes.len()) {
        accuracy.set_constraint(ColumnConstraint::ContentWidth);
    }
    finish(&table)
}

/// One axis across, the others down; only the accuracy.
fn pivot(tables: &Tables, settings: &Settings, width: usize, full_table: &str) -> String {
    let cells: Vec<&Cell> = tables.summary.iter().map(|(cell, _)| cell).collect();
    let first_chart = plan_charts(&cells).into_iter().next();
    let across = match settings.one_at_a_time.is_empty() {
        true => first_chart.map(|plan| plan.x),
        // Down run the words for the signal.
        false => {
            let mut varying = settings.varying.iter();
            varying.find(|levels| levels.axis != Axis::Signal).cloned()
        }
    };
    let Some(across) = across else {
        return list(tables, settings, width);
    };
    let down: Vec<&Levels> = settings
        .varying
        .iter()
        .filter(|levels| levels.axis != across.axis)
        .collect();
    let lines = pivot_lines(tables, &across, &down);
    let labels_wide: usize = down
        .iter()
        .enumerate()
        .map(|(i, levels)| {
            let widths = lines.iter().map(|line| letters(&line.labels[i]));
            widths.max().unwrap_or(0).max(letters(levels.axis.name())) + COLUMN_GAP
        })
        .sum();
    let column_wide = |i: usize| letters(&across.values[i].tick).max(4) + COLUMN_GAP;
    let mut n_columns = 0;
    let mut used = labels_wide;
    while n_columns < across.values.len()
        && (n_columns == 0 || used + column_wide(n_columns) <= width)
    {
        used += column_wide(n_columns);
        n_columns += 1;
    }
    let mut table = ruled_table(width);
    let names = down.iter().map(|levels| levels.axis.name().to_owned());
    let ticks = across.values[..n_columns]
        .iter()
        .map(|value| value.tick.clone());
    table.set_header(names.chain(ticks));
    for line in lines.iter().take(MOST_LINES) {
        let scores = line.accuracies[..n_columns]
            .iter()
            .map(|accuracy| match accuracy {
                Some(accuracy) => format!("{accuracy:.2}"),
                None => "-".to_owned(),
            });
        table.add_row(line.labels.iter().cloned().chain(scores));
    }
    align(&mut table, &down, n_columns);
    let mut text = format!("Mean accuracy; across: {}\n", across.axis.name());
    text += &finish(&table);
    let hidden_lines = lines.len().saturating_sub(MOST_LINES);
    let hidden_columns = across.values.len() - n_columns;
    let (n_lines, n_across, n_cells) = (lines.len(), across.values.len(), cells.len());
    let remark = match hidden_lines + hidden_columns {
        0 => format!("The intervals of all {n_cells} cells are in {full_table}"),
        _ => format!(
            "Left out here: {hidden_lines} of {n_lines} lines, {hidden_columns} of {n_across} columns; \
             all {n_cells} cells are in {full_table}"
        ),
    };
    text + &paragraph(&remark, width)
}

struct PivotLine {
    labels: Vec<String>,
    accuracies: Vec<Option<f64>>,
}

fn pivot_lines(tables: &Tables, across: &Levels, down: &[&Levels]) -> Vec<PivotLine> {
    let mut lines: Vec<PivotLine> = Vec::new();
    let mut places = std::collections::HashMap::new();
    for (cell, CellScore { accuracy, .. }) in &tables.summary {
        let label = |levels: &&Levels| levels.axis.value(cell).label;
        let labels: Vec<String> = down.iter().map(label).collect();
        let line = *places.entry(labels.clone()).or_insert_with(|| {
            lines.push(PivotLine {
                labels,
                accuracies: vec![None; across.values.len()],
            });
            lines.len() - 1
        });
        let value = across.axis.value(cell);
        let column = across.values.iter().position(|v| *v == value);
        if let Some(column) = column {
            lines[line].accuracies[column] = Some(*accuracy);
        }
    }
    lines
}

/// A table without lines that breaks its texts to fit a width, letters.
pub(super) fn plain_table(width: usize) -> Table {
    let mut table = Table::new();
    table.load_preset(presets::NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(width.min(usize::from(u16::MAX)) as u16);
    table
}

/// The same with a line below its header, at least 20 letters wide.
pub(super) fn ruled_table(width: usize) -> Table {
    let mut table = plain_table(width.max(20));
    table.remove_style(TableComponent::VerticalLines);
    table.set_style(TableComponent::HeaderLines, '-');
    table.set_style(TableComponent::MiddleHeaderIntersections, '-');
    table
}

/// Columns of numbers, by their indices.
pub(super) fn align_right(table: &mut Table, columns: impl IntoIterator<Item = usize>) {
    for column in columns {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
}

/// Numbers right, words left: columns of axes, then so many of numbers.
pub(super) fn align(table: &mut Table, axes: &[&Levels], n_numbers: usize) {
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        let is_word = axes
            .get(index)
            .is_some_and(|levels| levels.numbers().is_none());
        if !is_word && index < axes.len() + n_numbers {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
}

pub(super) fn finish(table: &Table) -> String {
    let lines = table.lines().map(|line| line.trim_end().to_owned() + "\n");
    lines.collect()
}

fn letters(text: &str) -> usize {
    text.chars().count()
}

/// Breaks a text at spaces (not at U+00A0) into lines of at most `width` letters.
pub(super) fn wrap(text: &str, width: usize) -> Vec<String> {
    break_lines(text, |line| letters(line) <= width)
}

/// The same as one text, a line end after each line.
fn paragraph(text: &str, width: usize) -> String {
    wrap(text, width).join("\n") + "\n"
}
