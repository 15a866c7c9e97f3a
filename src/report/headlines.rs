//! Short tables that people ask for first; the same rows for the terminal and for the page.

use crate::report::drawing::escape;
use crate::report::page::Section;
use crate::report::terminal::{finish, ruled_table, wrap};
use comfy_table::{CellAlignment, ColumnConstraint};
use std::fmt::Write;

/// A table of texts with a title.
pub struct TextTable {
    title: &'static str,
    /// What to know before reading it.
    note: String,
    /// Heads of the columns, and whether a column holds numbers.
    heads: Vec<(&'static str, bool)>,
    rows: Vec<Vec<String>>,
}

impl TextTable {
    /// Rows under heads, of which some are numbers; none if there are no rows.
    pub(super) fn of(
        title: &'static str,
        note: String,
        heads: Vec<(&'static str, bool)>,
        rows: Vec<Vec<String>>,
    ) -> Option<Self> {
        (!rows.is_empty()).then_some(Self {
            title,
            note,
            heads,
            rows,
        })
    }

    /// For the terminal: the title and the note, the table, an empty line.
    pub fn text(&self, width: usize) -> String {
        let mut table = ruled_table(width);
        table.set_header(self.heads.iter().map(|(head, _)| *head));
        for row in &self.rows {
            table.add_row(row);
        }
        for (column, (_, is_number)) in table.column_iter_mut().zip(&self.heads) {
            column.set_padding((0, 2));
            if *is_number {
                column.set_cell_alignment(CellAlignment::Right);
                column.set_constraint(ColumnConstraint::ContentWidth);
            }
        }
        let said = wrap(&format!("{}. {}", self.title, self.note), width);
        format!("{}\n\n{}\n", said.join("\n"), finish(&table))
    }

    /// For a page: a section.
    pub(super) fn section(&self, id: &'static str) -> Section {
        Section::new(id, self.title, self.html())
    }

    fn html(&self) -> String {
        let class = |is_number: bool| match is_number {
            true => " class=\"number\"",
            false => "",
        };
        let title = self.title;
        let mut html = format!(
            "<p class=\"quiet\">{}</p><div class=\"wide words\" tabindex=\"0\" role=\"region\" \
             aria-label=\"{title}\"><table><thead><tr>",
            escape(&self.note)
        );
        for (head, is_number) in &self.heads {
            let class = class(*is_number);
            let _ = write!(html, "<th scope=\"col\"{class}>{head}</th>");
        }
        html += "</tr></thead><tbody>";
        for row in &self.rows {
            html += "<tr>";
            for (text, (_, is_number)) in row.iter().zip(&self.heads) {
                let class = class(*is_number);
                let _ = write!(html, "<td{class}>{}</td>", escape(text));
            }
            html += "</tr>";
        }
        html + "</tbody></table></div>"
    }
}
