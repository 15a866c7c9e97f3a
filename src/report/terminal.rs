//! Text output on the terminal: tables that fit the width of the terminal.

use crate::report::pictures::colours::Rgb;
use crate::report::swept::{Setting, Swept, without};
use crate::report::text_width::break_lines;
use crate::table::{Column, Role, Table, Value};
use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, Table as TextTable, TableComponent, Width,
    presets,
};
use std::io::IsTerminal;

/// Maximum number of rows of a table that are shown on the terminal.
const MAX_LINES: usize = 40;

/// Number of spaces between two columns of a table.
const COLUMN_GAP: usize = 3;

/// Number of colours that a terminal or another output supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// No colours, because the output is a pipe or a file, `TERM=dumb`, or `NO_COLOR` is set.
    Plain,
    /// 256 colours of xterm.
    Colours256,
    /// 24-bit colours (true colour).
    TrueColour,
}

impl Ink {
    /// Returns the range of colours that standard output supports.
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

    /// Returns the escape code that sets the text colour; empty if colours are not supported.
    pub fn letter(self, colour: Rgb) -> String {
        self.code(38, colour)
    }

    /// Returns the escape code that sets the background colour; empty if colours are not supported.
    pub fn ground(self, colour: Rgb) -> String {
        self.code(48, colour)
    }

    /// Returns the escape code that restores the terminal's default colours; empty if colours are not supported.
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

/// Column of a table on the terminal, converted to text.
struct TextColumn {
    head: String,
    /// Text of the column in each row of the table.
    said: Vec<String>,
    is_number: bool,
    /// Largest width for which a column of words asks; longer texts wrap.
    most: usize,
}

impl TextColumn {
    /// Returns the smallest width of the column, characters. Headings and long texts wrap between words; numbers with units and intervals do not wrap.
    fn least_width(&self) -> usize {
        let widest = self.said.iter().map(|text| letters(text)).max();
        let widest = widest.unwrap_or(0);
        let most = if self.is_number { widest } else { self.most };
        widest.min(most).max(longest_word(&self.head))
    }
}

/// Largest width for which a column of words asks, characters. With a larger value, fewer columns fit; with a smaller value, more texts wrap.
const WIDE: usize = 24;

/// Returns a table as text without escape codes, in lines of at most `width` characters. Settings that are equal in all rows are stated once, at the start.
/// Each row then has a line with its varying settings, values and costs. If the settings leave no space for a value, one column has all choices and conditions. A
/// remark names the columns for which there is no space.
///
/// A table of more than 40 rows is shown as a pivot table: one setting runs along the columns. If the settings do not distinguish all rows, the text contains
/// the first 40 rows and the number of all rows.
pub fn table_text(table: &Table, width: usize) -> String {
    if table.n_rows > MAX_LINES
        && let Some(text) = pivot_text(table, width)
    {
        return text;
    }
    let n_lines = table.n_rows.min(MAX_LINES);
    let of = |setting: &Setting| TextColumn {
        head: setting.column.words.to_string(),
        said: (0..n_lines)
            .map(|row| table.bounded(setting.column, row))
            .collect(),
        is_number: setting.is_number(),
        most: WIDE,
    };
    let shown = shown_columns(table);
    let mut columns: Vec<TextColumn> = shown.iter().map(of).collect();
    let is_setting = |one: &&Setting| {
        matches!(
            one.column.role,
            Role::Choice | Role::Condition | Role::Subject
        )
    };
    let n_needed = 1 + shown.iter().filter(is_setting).count();
    if n_fitting(&columns, width) < n_needed.min(columns.len()) {
        let (settings, others): (Vec<Setting>, Vec<Setting>) = shown
            .iter()
            .copied()
            .partition(|one| matches!(one.column.role, Role::Choice | Role::Condition));
        let rows: Vec<usize> = (0..table.n_rows).collect();
        let following = Swept::new(table, &rows).following;
        let settings = following
            .iter()
            .fold(settings, |kept, one| without(&kept, one));
        let heads: Vec<&str> = settings.iter().map(|one| &one.column.words[..]).collect();
        let together = TextColumn {
            head: heads.join(", "),
            said: (0..n_lines)
                .map(|row| Setting::short_words(&settings, row))
                .collect(),
            is_number: false,
            most: width / 2,
        };
        columns = others.iter().map(of).collect();
        let n_subjects = others
            .iter()
            .filter(|one| one.column.role == Role::Subject)
            .count();
        if !settings.is_empty() {
            columns.insert(n_subjects, together);
        }
    }
    let heads: Vec<String> = columns.iter().map(|column| column.head.clone()).collect();
    let (lines, n_shown) = columns_text(columns, n_lines, width);
    let mut text = constants(table, width) + &lines;
    if let left_out @ [_, ..] = &heads[n_shown..] {
        let remark = format!("Left out at this width: {}.", left_out.join(", "));
        text += &paragraph(&remark, width);
    }
    if table.n_rows > MAX_LINES {
        let (n, file) = (table.n_rows, table.file);
        let remark = format!("The first {MAX_LINES} of {n} rows; all are in {file}.");
        text += &paragraph(&remark, width);
    }
    text
}

/// Returns the columns of a table to show: varying settings, followed by values and outcomes, and costs.
fn shown_columns(table: &Table) -> Vec<Setting<'_>> {
    let rank = |setting: &Setting| match setting.column.role {
        Role::Choice | Role::Condition | Role::Subject => 0,
        Role::Value(_) | Role::Outcome => 1,
        Role::Cost => 2,
        Role::Note => 3,
    };
    let columns = Setting::all(table);
    let mut shown: Vec<Setting> = columns.filter(|one| is_informative(table, one)).collect();
    shown.sort_by_key(rank);
    shown
}

/// Returns whether a column is worth showing: its values differ between rows, or the column contains results.
fn is_informative(table: &Table, setting: &Setting) -> bool {
    let mut rows = 0..table.n_rows;
    match setting.column.role {
        Role::Note => false,
        // For a single row, the subject identifies it.
        Role::Subject if table.n_rows == 1 => true,
        // A pair of objects needs both names, even if the first is the same in all rows.
        Role::Subject => !setting.is_number() || setting.data.varies(rows),
        // A value or cost column that is absent in all rows has no information.
        Role::Value(_) | Role::Cost if setting.is_number() => {
            rows.any(|row| setting.data.value(row).is_some())
        }
        _ => setting.data.varies(rows),
    }
}

/// Returns the number of columns that fit into `width`, from the first one.
fn n_fitting(columns: &[TextColumn], width: usize) -> usize {
    let mut used = 0;
    let fits = |column: &&TextColumn| {
        used += column.least_width() + COLUMN_GAP;
        used <= width + COLUMN_GAP
    };
    columns.iter().take_while(fits).count()
}

/// Returns the first `n_lines` lines of the columns that fit into `width`, and the number of these columns.
fn columns_text(mut columns: Vec<TextColumn>, n_lines: usize, width: usize) -> (String, usize) {
    let n = n_fitting(&columns, width);
    columns.truncate(n.max(1));
    let mut shown = ruled_table(width);
    shown.set_header(columns.iter().map(|column| &column.head));
    for line in 0..n_lines {
        shown.add_row(columns.iter().map(|column| &column.said[line]));
    }
    for (text, column) in columns.iter().zip(shown.column_iter_mut()) {
        column.set_padding((0, 2));
        if text.is_number {
            column.set_cell_alignment(CellAlignment::Right);
        }
        // Headings and long texts wrap between words; numbers with units and intervals do not wrap. The width includes the padding.
        let most = if text.is_number {
            usize::MAX
        } else {
            text.most
        };
        let widest = text.said.iter().map(|text| letters(text)).max();
        let unbroken = widest.unwrap_or(0).min(most);
        let least = unbroken.max(longest_word(&text.head)) + 2;
        column.set_constraint(ColumnConstraint::LowerBoundary(Width::Fixed(least as u16)));
    }
    let lines = shown.lines();
    let lines: String = lines
        .map(|line| line.trim_end().to_owned() + "\n")
        .collect();
    (lines, columns.len())
}

/// Returns a text with the settings that have equal values in all rows; empty if there are none.
fn constants(table: &Table, width: usize) -> String {
    let rows: Vec<usize> = (0..table.n_rows).collect();
    if rows.len() < 2 {
        return String::new();
    }
    let fixed = Swept::new(table, &rows).fixed;
    // Conditions of zero (ideal ones) are omitted.
    let is_said = |setting: &&Setting| {
        let value = setting.data.value(0);
        let is_ideal = setting.column.role == Role::Condition && value == Some(Value::Number(0.0));
        value.is_some() && !is_ideal
    };
    let said = fixed.iter().filter(is_said);
    let said: Vec<String> = said
        .map(|setting| setting.phrase(0).replace(' ', "\u{a0}"))
        .collect();
    match said.is_empty() {
        true => String::new(),
        false => paragraph(&format!("All rows: {}", said.join("\u{a0}· ")), width) + "\n",
    }
}

/// Returns a pivot table if a table has too many rows for the terminal: one setting in the columns, all others in the rows. Returns `None` if the settings do
/// not distinguish all rows.
fn pivot_text(table: &Table, width: usize) -> Option<String> {
    let rows: Vec<usize> = (0..table.n_rows).collect();
    let swept = Swept::new(table, &rows);
    let across = swept.main(&rows)?;
    let mut values = table.columns.iter();
    let value = values.find(|column| matches!(column.role, Role::Value(_)))?;
    if swept.groups(&swept.free, &rows).len() < rows.len() {
        return None;
    }
    let down = without(&swept.free, &across);
    let lines = swept.groups(&down, &rows);
    let shown = &lines[..lines.len().min(MAX_LINES)];
    let labels = down.iter().map(|one| TextColumn {
        head: one.column.words.to_string(),
        said: shown.iter().map(|line| one.label(line[0])).collect(),
        is_number: one.is_number(),
        most: WIDE,
    });
    let alone = Column {
        interval: None,
        ..value.clone()
    };
    let levels = across.levels(&rows);
    let at = |line: &Vec<usize>, level: usize| {
        let mut line = line.iter();
        let row = line.find(|&&row| across.data.key(row) == across.data.key(level));
        row.map_or_else(|| "-".to_owned(), |&row| table.bounded(&alone, row))
    };
    let values = levels.iter().map(|&level| TextColumn {
        head: across.label(level),
        said: shown.iter().map(|line| at(line, level)).collect(),
        is_number: true,
        most: WIDE,
    });
    let columns = labels.chain(values).collect();
    let (text, n_shown) = columns_text(columns, shown.len(), width);
    let n_hidden = down.len() + levels.len() - n_shown;
    let all = match (lines.len() - shown.len(), n_hidden) {
        (0, 0) => "A".to_owned(),
        (lines_hidden, columns_hidden) => format!(
            "Left out here: {lines_hidden} of {} lines, {columns_hidden} of {} columns; a",
            lines.len(),
            levels.len()
        ),
    };
    let remark = format!("{all}ll {} rows are in the tables.", table.n_rows);
    let head = format!("{}; across: {}\n", value.words, across.column.words);
    Some(constants(table, width) + &head + &text + &paragraph(&remark, width))
}

/// Formats rows of text as aligned columns without lines between them. The columns with indices in `texts` are left-aligned, all others right-aligned.
pub fn rows_text(
    header: &[&str],
    texts: &[usize],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let mut table = TextTable::new();
    table.load_preset(presets::NOTHING).set_header(header);
    table.add_rows(rows);
    for (number, column) in table.column_iter_mut().enumerate() {
        if !texts.contains(&number) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.to_string()
}

/// Creates a table with a line below its header, at least 20 characters wide; its texts wrap to fit the width.
fn ruled_table(width: usize) -> TextTable {
    let mut table = TextTable::new();
    table.load_preset(presets::NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(width.clamp(20, usize::from(u16::MAX)) as u16);
    table.set_style(TableComponent::HeaderLines, '-');
    table.set_style(TableComponent::MiddleHeaderIntersections, '-');
    table
}

fn longest_word(text: &str) -> usize {
    text.split_whitespace().map(letters).max().unwrap_or(0)
}

fn letters(text: &str) -> usize {
    text.chars().count()
}

/// Wraps a text at spaces (not at no-break spaces) into lines of at most `width` characters, each with a line break.
pub(crate) fn paragraph(text: &str, width: usize) -> String {
    break_lines(text, |line| letters(line) <= width).join("\n") + "\n"
}
