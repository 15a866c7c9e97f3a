//! Generator of the page `guide/tables.md`, which lists all columns of all result tables.

use crate::inputs::doc_comment::plain;
use crate::report::comparison::differences::Difference;
use crate::studies::{entries, failures_about};
use crate::table::{Better, Column, Columns, FileAbout, Role};

/// Introduction of the page `guide/tables.md`.
const START: &str = "\
# Result tables

All columns of the CSV files in a results folder. This page is generated from the program. [Reference](reference.md) lists the keys of studies and scenes.

- Numbers have the unit of the column `unit`; fractions are from 0 to 1. An empty entry means that there is no value.
- **Role**: *choice* of a designer, *condition* of the world, *subject* of a measurement, *value* (measured; the arrow points to better values), *cost*, *outcome* or
  *note* (a count, an end of an interval, a remark). `bubbletouch advise`, `compare` and the page use the roles.
- A column marked *optional* is in the tables of some studies only; its meaning says of which.
- `[axes]` of a recognition study adds one column for each swept key behind the columns of the configuration. The column has the name and unit of the key.
";

/// Minimum number of columns that two tables share for the second table to refer to the columns of the first.
const MIN_SHARED: usize = 4;

/// Returns the page.
pub fn tables_page() -> String {
    let mut page = START.to_owned();
    for kind in entries().rev() {
        page.push_str(&format!("\n## Studies with `[{}]`\n", kind.about.table));
        let always = kind.tables.always.iter().map(|file| (file.about(), ""));
        let presence = " Only some studies have this table.";
        let of_parts = kind.tables.of_parts.iter();
        let of_parts = of_parts.map(|file| (file.about(), presence));
        let mut before: Vec<FileAbout> = Vec::new();
        for (file, presence) in always.chain(of_parts) {
            write_file(&file, presence, &before, &mut page);
            before.push(file);
        }
    }
    page.push_str("\n## All studies\n");
    let note = " The file has no rows if all work items succeeded.";
    write_file(&failures_about(), note, &[], &mut page);
    page.push_str(
        "\n## `bubbletouch compare --out`\n\nOne row for each number that both folders have.\n\n",
    );
    write_columns(&Difference::columns(), &mut page);
    page
}

/// Writes the section about a table file. Columns with which a file before begins too are not repeated.
fn write_file(file: &FileAbout, presence: &str, before: &[FileAbout], page: &mut String) {
    let times = match file.repeats {
        true => "",
        false => " Times differ between runs.",
    };
    let note = match file.note {
        "" => String::new(),
        note => format!(" {note}"),
    };
    page.push_str(&format!(
        "\n### `{}`\n\n{}.{note}{times}{presence}\n\n",
        file.name, file.title
    ));
    let n_shared = |other: &FileAbout| {
        let columns = other.columns.iter().zip(&file.columns);
        columns.take_while(|(other, own)| other == own).count()
    };
    let shared = before.iter().map(|other| (n_shared(other), other));
    let shared = shared.filter(|(n, _)| *n >= MIN_SHARED);
    // The first of several equally good tables has all of its columns listed.
    let shared = shared.reduce(|best, other| if other.0 > best.0 { other } else { best });
    let n = shared.map_or(0, |(n, other)| {
        let last = &other.columns[n - 1].name;
        page.push_str(&format!(
            "This table begins with the columns of `{}`, up to `{last}`. Further columns:\n\n",
            other.name
        ));
        n
    });
    write_columns(&file.columns[n..], page);
}

fn write_columns(columns: &[Column], page: &mut String) {
    page.push_str("| column | unit | role | meaning |\n|---|---|---|---|\n");
    for column in columns {
        let optional = if column.is_optional {
            " (optional)"
        } else {
            ""
        };
        page.push_str(&format!(
            "| `{}`{optional} | {} | {} | {} |\n",
            column.name,
            unit(column),
            role(column.role),
            plain(&column.meaning)
                .replace("\n\n", " ")
                .replace('|', "\\|"),
        ));
    }
}

/// Returns the unit of the column's numbers in the file. Charts show fractions as percent.
fn unit(column: &Column) -> &str {
    match column.unit.as_ref() {
        "%" | ":1" => "",
        "us" => "µs",
        unit => unit,
    }
}

fn role(role: Role) -> &'static str {
    match role {
        Role::Choice => "choice",
        Role::Condition => "condition",
        Role::Subject => "subject",
        Role::Value(Better::More) => "value ↑",
        Role::Value(Better::Less) => "value ↓",
        Role::Value(Better::Neither) => "value",
        Role::Cost => "cost ↓",
        Role::Outcome => "outcome",
        Role::Note => "note",
    }
}
