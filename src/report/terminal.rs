//! What a run prints at its end: tables at the width of the terminal.

use crate::report::colours::Rgb;
use crate::report::swept::{Setting, Swept, without};
use crate::report::text_width::break_lines;
use crate::table::{Column, Data, Role, Scale, Table, Value};
use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, Table as TextTable, TableComponent,
    presets,
};
use std::io::IsTerminal;

/// Lines of a table, at most.
pub(super) const MOST_LINES: usize = 40;

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

/// A table as text without escape codes, lines at most `width` letters long: settings that are the same in all rows once above it, then a
/// line a row of what varies, was found and is the cost, as far as there is room.
///
/// Of more than 40 rows the text has the first, and says how many there are.
pub fn table_text(table: &Table, width: usize) -> String {
    let rows: Vec<usize> = (0..table.n_rows).collect();
    let mut text = constants(table, &rows, width);
    let mut columns: Vec<(String, Vec<String>, bool)> = Vec::new();
    let mut used = 0;
    for (column, data) in shown_columns(table) {
        let setting = Setting { column, data };
        let said = rows
            .iter()
            .take(MOST_LINES)
            .map(|&row| bounded(table, setting, row));
        let said: Vec<String> = said.collect();
        let head = column.words.to_string();
        // A long note breaks over lines, a number never does.
        let widest = said.iter().map(|text| letters(text)).max().unwrap_or(0);
        let wide = widest
            .min(if setting.is_number() { widest } else { 24 })
            .max(letters(&head).min(widest.max(10)));
        if !columns.is_empty() && used + wide + COLUMN_GAP > width {
            break;
        }
        used += wide + COLUMN_GAP;
        columns.push((head, said, setting.is_number()));
    }
    let mut lines = ruled_table(width);
    lines.set_header(columns.iter().map(|(head, ..)| head));
    for row in 0..table.n_rows.min(MOST_LINES) {
        lines.add_row(columns.iter().map(|(_, said, _)| &said[row]));
    }
    for (place, (_, said, is_number)) in columns.iter().enumerate() {
        if let Some(column) = lines.column_mut(place) {
            column.set_padding((0, 2));
            if *is_number {
                column.set_cell_alignment(CellAlignment::Right);
            }
            if said.iter().any(|text| text.contains('[')) {
                // An interval broken over two lines cannot be read down the column.
                column.set_constraint(ColumnConstraint::ContentWidth);
            }
        }
    }
    text += &finish(&lines);
    if table.n_rows > MOST_LINES {
        let (n, file) = (table.n_rows, table.file);
        text += &paragraph(
            &format!("The first {MOST_LINES} of {n} rows; all are in {file}."),
            width,
        );
    }
    text
}

/// What a terminal has room for: what varies, then what came of it, then what it costs.
fn shown_columns(table: &Table) -> impl Iterator<Item = (&Column, &Data)> {
    let rank = |column: &Column| match column.role {
        Role::Choice | Role::Condition | Role::Subject => Some(0),
        Role::Value(_) | Role::Outcome => Some(1),
        Role::Cost => Some(2),
        Role::Note => None,
    };
    let rows: Vec<usize> = (0..table.n_rows).collect();
    let is_shown = move |rank: usize, setting: Setting| match rank {
        // Of one row, the subject says what it is about.
        0 => setting.varies(&rows) || rows.len() == 1 && setting.column.role == Role::Subject,
        // What is the same for all, or for none, says nothing.
        _ if setting.is_number() => rows.iter().any(|&row| setting.data.value(row).is_some()),
        _ => setting.varies(&rows),
    };
    let columns = move |wanted: usize| {
        let is_shown = is_shown.clone();
        let all = table.columns.iter().zip(&table.data);
        all.filter(move |&(column, data)| {
            rank(column) == Some(wanted) && is_shown(wanted, Setting { column, data })
        })
    };
    (0..3).flat_map(columns)
}

/// A value with its interval: `0.93 [0.9, 0.95]`.
fn bounded(table: &Table, setting: Setting, row: usize) -> String {
    let Some(value) = setting.data.value(row) else {
        return String::new();
    };
    let is_share = setting.column.scale == Scale::Share && setting.column.unit.is_empty();
    let said = |number: f64| match is_share {
        true => format!("{number:.2}"),
        false => setting.column.tick(number),
    };
    let Value::Number(number) = value else {
        return setting.column.value_words(&value);
    };
    let end = |name: &str| {
        table
            .numbers(name)
            .map(|ends| ends[row])
            .filter(|end| end.is_finite())
    };
    let ends = setting
        .column
        .interval
        .as_ref()
        .and_then(|[low, high]| Some([end(low)?, end(high)?]));
    match ends {
        Some([low, high]) => format!("{} [{}, {}]", said(number), said(low), said(high)),
        None if is_share => said(number),
        None => setting.column.number_words(number),
    }
}

/// What is the same in all rows, in a line or more; empty if nothing is.
fn constants(table: &Table, rows: &[usize], width: usize) -> String {
    if rows.len() < 2 {
        return String::new();
    }
    let fixed = Swept::of(table, rows).fixed;
    // An ideal world goes without saying.
    let is_said = |setting: &&Setting| {
        let value = setting.data.value(rows[0]);
        value.is_some()
            && !(setting.column.role == Role::Condition && value == Some(Value::Number(0.0)))
    };
    let parts = fixed
        .iter()
        .filter(is_said)
        .map(|setting| setting.phrase(rows[0]).replace(' ', "\u{a0}"));
    match &parts.collect::<Vec<_>>()[..] {
        [] => String::new(),
        parts => paragraph(&format!("All rows: {}", parts.join("\u{a0}· ")), width) + "\n",
    }
}

/// One setting across, the others down, and of each combination a value: for tables of more rows than a terminal has.
pub fn pivot_text(table: &Table, (across, value): (&str, &str), width: usize) -> String {
    let rows: Vec<usize> = (0..table.n_rows).collect();
    let swept = Swept::of(table, &rows);
    let (Some((column, data)), Some(values)) = (table.column(across), table.numbers(value)) else {
        return table_text(table, width);
    };
    let setting = Setting { column, data };
    let levels = setting.levels(&rows);
    let down = without(&swept.free, &setting);
    let lines = swept.groups(&down, &rows);
    let labels_wide: usize = down
        .iter()
        .map(|one| {
            let widths = lines.iter().map(|line| letters(&one.label(line[0])));
            widths.max().unwrap_or(0).max(letters(&one.column.words)) + COLUMN_GAP
        })
        .sum();
    let ticks: Vec<String> = levels.iter().map(|&row| setting.label(row)).collect();
    let mut used = labels_wide;
    let mut n_columns = 0;
    for tick in &ticks {
        used += letters(tick).max(4) + COLUMN_GAP;
        if n_columns > 0 && used > width {
            break;
        }
        n_columns += 1;
    }
    let mut shown = ruled_table(width);
    let names = down.iter().map(|one| one.column.words.to_string());
    shown.set_header(names.chain(ticks[..n_columns].iter().cloned()));
    for line in lines.iter().take(MOST_LINES) {
        let at = |&level: &usize| {
            let found = line.iter().find(|&&row| data.key(row) == data.key(level));
            found.map_or_else(|| "-".to_owned(), |&row| format!("{:.2}", values[row]))
        };
        let labels = down.iter().map(|one| one.label(line[0]));
        shown.add_row(labels.chain(levels[..n_columns].iter().map(at)));
    }
    for (place, column) in shown.column_iter_mut().enumerate() {
        column.set_padding((0, 2));
        if down.get(place).is_none_or(Setting::is_number) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let mut text = constants(table, &rows, width);
    let value = table
        .column(value)
        .map_or(value, |(column, _)| &column.words);
    text += &format!("{value}; across: {}\n", column.words);
    text += &finish(&shown);
    let hidden = (
        lines.len().saturating_sub(MOST_LINES),
        levels.len() - n_columns,
    );
    let remark = match hidden {
        (0, 0) => format!(
            "All {} rows with their intervals are in the tables.",
            table.n_rows
        ),
        (h, c) => format!(
            "Left out here: {h} of {} lines, {c} of {} columns; all {} rows are in the tables.",
            lines.len(),
            levels.len(),
            table.n_rows
        ),
    };
    text + &paragraph(&remark, width)
}

/// A table without lines that breaks its texts to fit a width, letters.
pub(super) fn plain_table(width: usize) -> TextTable {
    let mut table = TextTable::new();
    table.load_preset(presets::NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(width.min(usize::from(u16::MAX)) as u16);
    table
}

/// The same with a line below its header, at least 20 letters wide.
pub(super) fn ruled_table(width: usize) -> TextTable {
    let mut table = plain_table(width.max(20));
    table.remove_style(TableComponent::VerticalLines);
    table.set_style(TableComponent::HeaderLines, '-');
    table.set_style(TableComponent::MiddleHeaderIntersections, '-');
    table
}

pub(super) fn finish(table: &TextTable) -> String {
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
pub(super) fn paragraph(text: &str, width: usize) -> String {
    wrap(text, width).join("\n") + "\n"
}
