//! Tables of a page, as HTML. Each cell shows a rounded value with its unit and also contains the exact value from the file.

use crate::report::pictures::escape;
use crate::report::swept::{Setting, constant_phrases};
use crate::table::{Better, Column, Data, Role, Table};

/// Number of rows that the page shows of a table if the table is too large to be shown completely.
const N_FIRST_ROWS: usize = 100;

/// HTML of a table, with the number of rows that it contains.
pub(crate) struct TableHtml {
    pub html: String,
    /// Number of table rows in the HTML.
    pub n_rows: usize,
}

/// Column of an HTML table, which may combine several columns of the result table.
struct Shown<'a> {
    column: &'a Column,
    is_number: bool,
    /// Indices of the result-table columns that each HTML cell contains: the value, and the ends of its interval.
    held: Vec<usize>,
    /// Whether any column in `held` has different values in different rows.
    varies: bool,
    /// Whether the table has a single row.
    is_alone: bool,
}

/// Returns a table as HTML of at most `most_letters` bytes. If all rows together are longer, the HTML contains only the first rows.
pub(crate) fn table_html(table: &Table, most_letters: usize) -> TableHtml {
    let mut fields = fields(table).enumerate().peekable();
    let first = fields.peek().map(|(_, fields)| fields.clone());
    let shown = shown(table);
    let mut rows = String::new();
    let mut first_rows = 0;
    let mut n_rows = 0;
    for (row, fields) in fields {
        if row == N_FIRST_ROWS {
            first_rows = rows.len();
        }
        let cells = shown.iter().filter(|one| !one.is_said_once());
        let cells = cells.map(|one| one.cell(table, row, &fields));
        rows += &format!("<tr data-row={row}>{}</tr>\n", cells.collect::<String>());
        n_rows += 1;
        if rows.len() > most_letters && row >= N_FIRST_ROWS {
            rows.truncate(first_rows);
            n_rows = N_FIRST_ROWS;
            break;
        }
    }
    let names = table.columns.iter().map(|column| &column.name[..]);
    let names = escape(&names.collect::<Vec<_>>().join(","));
    let heads: String = shown.iter().map(|one| one.head(first.as_ref())).collect();
    let is_once = |_: &Setting| table.n_rows > 1;
    let once = match &constant_phrases(table, &table.all_rows(), is_once).join(", ")[..] {
        "" => String::new(),
        words => format!("<p class=\"quiet\">All rows: {}.</p>", escape(words)),
    };
    let (file, title) = (escape(table.file), escape(table.title));
    let html = format!(
        "{once}<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{title}\"><table data-table=\"{file}\" data-columns=\"{names}\">\
         <caption class=\"unseen\">{title}</caption><thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table></div>"
    );
    TableHtml { html, n_rows }
}

/// Returns the rows of the table's CSV file as lists of fields. For a table without a file, the values are formatted as in a file.
fn fields(table: &Table) -> Box<dyn Iterator<Item = Vec<String>> + '_> {
    if table.csv.is_empty() {
        let field = |data: &Data, row| {
            let value = data.value(row);
            value.map_or_else(String::new, |value| value.to_string())
        };
        let row = move |row| table.data.iter().map(|data| field(data, row)).collect();
        return Box::new((0..table.n_rows).map(row));
    }
    let rows = csv::Reader::from_reader(&table.csv[..]).into_records();
    let rows = rows.filter_map(Result::ok);
    Box::new(rows.map(|row| row.iter().map(str::to_owned).collect()))
}

/// Returns the columns of the HTML table. Ends of intervals have no column of their own, because the cells of the value column contain them.
fn shown(table: &Table) -> Vec<Shown<'_>> {
    let ends = |column: &Column| -> Vec<usize> {
        let ends = column.interval.iter().flatten();
        ends.filter_map(|name| table.place(name)).collect()
    };
    let all_ends: Vec<usize> = table.columns.iter().flat_map(ends).collect();
    let places = (0..table.columns.len()).filter(|place| !all_ends.contains(place));
    let shown = places.map(|place| {
        let column = &table.columns[place];
        let held = [vec![place], ends(column)].concat();
        let varies = |&place: &usize| table.data[place].varies(0..table.n_rows);
        Shown {
            column,
            is_number: matches!(table.data[place], Data::Numbers(_)),
            varies: held.iter().any(varies),
            is_alone: table.n_rows == 1,
            held,
        }
    });
    let mut shown: Vec<Shown> = shown.collect();
    // The script finds the cells of a row by the places of the header's cells.
    shown.sort_by_key(Shown::is_said_once);
    shown
}

impl Shown<'_> {
    /// Returns whether the column is a setting or a note that is equal in all rows. It is stated once, and its cells are left out.
    fn is_said_once(&self) -> bool {
        let is_found = matches!(
            self.column.role,
            Role::Value(_) | Role::Cost | Role::Outcome
        );
        !self.varies && !is_found && !self.is_alone
    }

    /// Returns the header cell of an HTML column. If the fields of its cells are equal in all rows, the attribute `data-v` of the header contains them.
    /// Tooltips of charts list the columns with `data-setting` or `data-found`, whose content precedes the value.
    fn head(&self, first: Option<&Vec<String>>) -> String {
        let column = self.column;
        let name = match column.words.chars().count() {
            1 => format!("{} = ", escape(&column.words)),
            _ => format!("{} ", escape(&column.words)),
        };
        let mut data = match column.role {
            Role::Choice | Role::Condition | Role::Subject if self.varies => {
                let name = if self.is_number { &name[..] } else { "" };
                format!(" data-setting=\"{name}\"")
            }
            Role::Value(_) | Role::Cost | Role::Outcome => format!(" data-found=\"{name}\""),
            _ => String::new(),
        };
        if column.role == Role::Value(Better::More) {
            data += " data-down";
        }
        if self.is_said_once() {
            data += " hidden";
        }
        if let (Some(first), false) = (first, self.varies) {
            data += &format!(" data-v=\"{}\"", escape(&self.joined(first)));
        }
        let held: Vec<String> = self.held.iter().map(usize::to_string).collect();
        format!(
            "<th scope=\"col\"{} data-held=\"{}\"{data} title=\"{}\">{}</th>",
            self.class(),
            held.join(" "),
            escape(&column.name),
            escape(&column.title())
        )
    }

    /// Returns the HTML of a table cell. If the fields of the cell vary between rows and differ from its text, the attribute `data-v` contains them.
    fn cell(&self, table: &Table, row: usize, fields: &[String]) -> String {
        let said = table.bounded(self.column, row);
        let values = self.joined(fields);
        let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "._-+".contains(letter);
        let value = match &values[..] {
            values if values == said || !self.varies => String::new(),
            plain if !plain.is_empty() && plain.chars().all(is_plain) => {
                format!(" data-v={plain}")
            }
            values => format!(" data-v=\"{}\"", escape(values)),
        };
        format!("<td{}{value}>{}</td>", self.class(), escape(&said))
    }

    /// Returns the fields of one cell of the HTML table, joined by spaces. If a cell has several fields, they are numbers without spaces.
    fn joined(&self, fields: &[String]) -> String {
        let values = self.held.iter().map(|&place| &fields[place][..]);
        values.collect::<Vec<_>>().join(" ")
    }

    fn class(&self) -> &'static str {
        if self.is_number {
            ""
        } else {
            " class=\"word\""
        }
    }
}
