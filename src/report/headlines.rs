//! Short tables that people ask for first: published accuracies beside ours, what is confused most often, and what makes trials
//! differ; the same rows for the terminal and for the page.

use crate::report::answer::Answer;
use crate::report::axis::short_number;
use crate::report::drawing::escape;
use crate::report::page::Section;
use crate::report::terminal::{finish, ruled_table, wrap};
use crate::study::table::{Source, Tables};
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

/// Each published accuracy beside the most accurate of our cells that it is about; none if the study names none.
pub fn published_table(tables: &Tables) -> Option<TextTable> {
    if tables.published.is_empty() {
        return None;
    }
    let answer = Answer::of(tables)?;
    let row = |(cell, row): &(_, crate::study::table::Published)| {
        vec![
            format!("{} {}", row.claim, row.source),
            short_number(row.published_accuracy),
            format!(
                "{:.3} [{:.3}, {:.3}]",
                row.accuracy, row.accuracy_low, row.accuracy_high
            ),
            format!("{:+.3}", row.difference),
            match row.n_matching {
                1 => answer.place(cell),
                n => format!("{} (best of {n} cells)", answer.place(cell)),
            },
        ]
    };
    let rows: Vec<Vec<String>> = tables.published.iter().map(row).collect();
    (!rows.is_empty()).then_some(TextTable {
        title: "Beside what was published",
        note: "Ours: the most accurate of the cells that have the settings of the claim, in each condition that these were measured in."
            .to_owned(),
        heads: vec![
            ("published", false),
            ("accuracy", true),
            ("ours [95 %]", true),
            ("difference", true),
            ("our settings", false),
        ],
        rows,
    })
}

/// The pairs of objects that the best cell confuses most often; none if it confuses nothing.
pub fn confused_table(tables: &Tables) -> Option<TextTable> {
    if tables.confused.is_empty() {
        return None;
    }
    let answer = Answer::of(tables)?;
    let rows: Vec<Vec<String>> = tables
        .confused
        .iter()
        .map(|pair| {
            vec![
                pair.object.clone(),
                pair.predicted.clone(),
                format!("{:.2}", pair.share),
                format!("{} of {}", pair.count, pair.n_test),
            ]
        })
        .collect();
    let note = match &answer.place(&answer.best.0)[..] {
        "" => "All trials together.".to_owned(),
        place => format!("At {place}, all trials together."),
    };
    (!rows.is_empty()).then_some(TextTable {
        title: "Most often confused",
        note,
        heads: vec![
            ("touched", false),
            ("taken for", false),
            ("share", true),
            ("test touches", true),
        ],
        rows,
    })
}

/// What makes the best cell's accuracy differ from trial to trial; none unless trials tell splits from projections.
pub fn variance_table(tables: &Tables) -> Option<TextTable> {
    if tables.variance.is_empty() {
        return None;
    }
    let answer = Answer::of(tables)?;
    let best = &answer.best.0;
    let of_best = tables.variance.iter().filter(|row| row.cell == best.cell);
    let rows: Vec<Vec<String>> = of_best
        .map(|row| {
            let source = match row.source {
                Source::Split => format!("{} splits", row.n_levels),
                Source::Projection => format!("{} projections", row.n_levels),
                Source::Rest => "noise, and both together".to_owned(),
            };
            let std = [
                row.accuracy_std,
                row.accuracy_std_low,
                row.accuracy_std_high,
            ];
            let [std, low, high] = std.map(|std| format!("{std:.3}"));
            let percent = |share| format!("{:.0} %", 100.0 * share);
            vec![
                source,
                format!("{std} [{low}, {high}]"),
                row.share.map_or("-".to_owned(), percent),
                row.p_value.map_or(String::new(), |p| match p < 0.001 {
                    true => "< 0.001".to_owned(),
                    false => format!("{p:.3}"),
                }),
            ]
        })
        .collect();
    let note = match &answer.place(best)[..] {
        "" => String::new(),
        place => format!("At {place}."),
    };
    let heads = vec![
        ("source", false),
        ("standard deviation [95 %]", true),
        ("of the variance", true),
        ("p", true),
    ];
    TextTable::of("What makes trials differ", note, heads, rows)
}

/// All of them as text without escape codes, lines at most `width` letters long; empty if there are none.
pub fn text(tables: &Tables, width: usize) -> String {
    let all = [
        published_table(tables),
        confused_table(tables),
        variance_table(tables),
    ];
    let texts: Vec<String> = all.iter().flatten().map(|t| t.text(width)).collect();
    texts.concat()
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
