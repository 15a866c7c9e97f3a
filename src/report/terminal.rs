//! Text output on the terminal: tables that fit the width of the terminal.

use crate::report::pictures::Rgb;
use crate::report::swept::{Setting, Swept, constant_phrases, without};
use crate::report::text_width::break_lines;
use crate::table::{Better, Role, Table, Value};
use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, Table as TextTable, TableComponent, Width,
    presets,
};
use std::borrow::Cow;

/// Maximum number of rows of a table that are shown on the terminal.
const MAX_LINES: usize = 40;

/// Number of spaces between two columns of a table.
const COLUMN_GAP: usize = 3;

/// Maximum number of characters of a table entry on the terminal; the rest is replaced by an ellipsis. The time to wrap a word grows with the square of its
/// length.
const MAX_LETTERS: usize = 1000;

/// Smallest width for which a table is laid out, characters.
const NARROWEST: usize = 20;

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
        match (console::colors_enabled(), console::true_colors_enabled()) {
            (false, _) => Self::Plain,
            (true, false) => Self::Colours256,
            (true, true) => Self::TrueColour,
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
/// Each row then has a line with its varying settings, values and costs; of more than 40 rows, those with the best values are shown. If the settings leave no
/// space for a value, one column has all choices and conditions. A remark names the columns for which there is no space.
pub fn table_text(table: &Table, width: usize) -> String {
    let rows = best_rows(table);
    let of = |setting: &Setting| TextColumn {
        head: setting.column.words.to_string(),
        said: rows
            .iter()
            .map(|&row| table.bounded(setting.column, row))
            .collect(),
        is_number: setting.is_number(),
        most: WIDE,
    };
    let shown = shown_columns(table);
    let mut columns: Vec<TextColumn> = shown.iter().map(of).collect();
    let n_of = |settings: &[Setting], roles: &[Role]| {
        let of_roles = settings
            .iter()
            .filter(|one| roles.contains(&one.column.role));
        of_roles.count()
    };
    let n_needed = 1 + n_of(&shown, &[Role::Choice, Role::Condition, Role::Subject]);
    if n_fitting(&columns, width) < n_needed.min(columns.len()) {
        let (settings, others): (Vec<Setting>, Vec<Setting>) = shown
            .iter()
            .copied()
            .partition(|one| matches!(one.column.role, Role::Choice | Role::Condition));
        let settings = without(&settings, &Swept::of(table).following);
        let heads: Vec<&str> = settings.iter().map(|one| &one.column.words[..]).collect();
        let together = TextColumn {
            head: heads.join(", "),
            said: rows
                .iter()
                .map(|&row| Setting::short_words(&settings, row))
                .collect(),
            is_number: false,
            most: width / 2,
        };
        columns = others.iter().map(of).collect();
        let n_subjects = n_of(&others, &[Role::Subject]);
        if !settings.is_empty() {
            columns.insert(n_subjects, together);
        }
    }
    let heads: Vec<String> = columns.iter().map(|column| column.head.clone()).collect();
    let (lines, n_shown) = columns_text(columns, rows.len(), width);
    let mut text = constants(table, width) + &lines;
    if let left_out @ [_, ..] = &heads[n_shown..] {
        let remark = format!("Left out at this width: {}.", left_out.join(", "));
        text += &paragraph(&remark, width);
    }
    if table.n_rows > MAX_LINES {
        let n = table.n_rows;
        let remark = format!("The best {MAX_LINES} of {n} rows; all are in the tables.");
        text += &paragraph(&remark, width);
    }
    text
}

/// Returns all rows of a table; of more than [`MAX_LINES`] rows, those with the best values in the first column that has a better direction, the best first.
fn best_rows(table: &Table) -> Vec<usize> {
    let mut rows = table.all_rows();
    if table.n_rows > MAX_LINES {
        let ranked = Setting::all(table).find_map(|one| match one.column.role {
            Role::Value(Better::More) => Some((one, -1.0)),
            Role::Value(Better::Less) => Some((one, 1.0)),
            _ => None,
        });
        if let Some((one, sign)) = ranked {
            let key = |row: &usize| sign * one.position(*row).unwrap_or(f64::INFINITY * sign);
            rows.sort_by(|a, b| key(a).total_cmp(&key(b)));
        }
        rows.truncate(MAX_LINES);
    }
    rows
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
        shown.add_row(columns.iter().map(|column| clipped(&column.said[line])));
    }
    for (text, column) in columns.iter().zip(shown.column_iter_mut()) {
        column.set_padding((0, 2));
        if text.is_number {
            column.set_cell_alignment(CellAlignment::Right);
        }
        // The width includes the padding.
        let least = Width::Fixed(text.least_width() as u16 + 2);
        column.set_constraint(ColumnConstraint::LowerBoundary(least));
    }
    let lines = shown.lines();
    let lines: String = lines
        .map(|line| {
            // The line below the header is as long as the columns with their gaps.
            let line: String = line.chars().take(width.max(NARROWEST)).collect();
            line.trim_end().to_owned() + "\n"
        })
        .collect();
    (lines, columns.len())
}

/// Returns a text with the settings that have equal values in all rows; empty if there are none.
fn constants(table: &Table, width: usize) -> String {
    if table.n_rows < 2 {
        return String::new();
    }
    // Conditions of zero (ideal ones) are omitted.
    let is_ideal = |one: &Setting| {
        one.column.role == Role::Condition && one.data.value(0) == Some(Value::Number(0.0))
    };
    match &constant_phrases(table, &table.all_rows(), |one| !is_ideal(one))[..] {
        [] => String::new(),
        said => paragraph(&format!("All rows: {}", said.join("\u{a0}· ")), width) + "\n",
    }
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

/// Creates a table with a line below its header, at least [`NARROWEST`] characters wide; its texts wrap to fit the width.
fn ruled_table(width: usize) -> TextTable {
    let mut table = TextTable::new();
    table.load_preset(presets::NOTHING);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(width.clamp(NARROWEST, usize::from(u16::MAX)) as u16);
    table.set_style(TableComponent::HeaderLines, '-');
    table.set_style(TableComponent::MiddleHeaderIntersections, '-');
    table
}

/// Returns a text of at most [`MAX_LETTERS`] characters and an ellipsis.
fn clipped(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(MAX_LETTERS) {
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
        None => Cow::Borrowed(text),
    }
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
