//! The page of a study of any kind.

use super::about::StudyAbout;
use super::data::PageData;
use super::frame::{Page, Section, sentences_html};
use super::picture::{Picture, figure, figures};
use super::provenance::provenance_html;
use crate::report::drawing::escape;
use crate::report::study_folder::Found;
use crate::table::{ChartSpec, Data, Table, short_number};
use std::fmt::Write;

/// Letters of pictures for readers without script, at most: a study of thousands of rows has megabytes of them.
const MOST_PICTURES: usize = 600_000;
/// Rows of a table for readers without script, at most.
const MOST_ROWS: usize = 100;
/// Letters of tables for readers without script, at most.
const MOST_TABLES: usize = 150_000;

/// What stands on a page beside tables and charts.
#[derive(Default)]
pub(crate) struct Beside {
    /// The charts as pictures, as many as are drawn, for readers without script.
    pub charts: Vec<Picture>,
    /// Names of charts that were not drawn.
    pub left_out: Vec<String>,
    /// Pictures that are no charts.
    pub pictures: Vec<Picture>,
    /// Sections of its own, before the tables.
    pub sections: Vec<Section>,
}

/// The page.
pub(crate) fn page(about: &StudyAbout, found: &Found, beside: Beside) -> String {
    let data = PageData::of(found.tables, found.charts);
    let mut page = Page {
        name: about.name.clone(),
        question: about.question.clone(),
        expected: about.expected.clone(),
        foot: foot(about, found.tables),
        ..Page::default()
    };
    page.add(Section::new(
        "answer",
        "Answer",
        sentences_html(found.answers),
    ));
    page.add(Section::new(
        "charts",
        "Charts",
        charts_html(found.charts, &data, &beside),
    ));
    page.add(Section::new(
        "choices",
        "What to choose",
        advice_html(found, &data),
    ));
    page.add(Section::new(
        "pictures",
        "Pictures",
        figures(&beside.pictures),
    ));
    for section in beside.sections {
        page.add(section);
    }
    page.add(Section::new(
        "tables",
        "Tables",
        tables_html(found.tables, &data),
    ));
    if let Some(manifest) = &about.manifest {
        page.add(Section::new(
            "provenance",
            "Provenance",
            provenance_html(manifest),
        ));
    }
    page.add(Section::new("again", "Make it again", again(about)));
    page.data = Some(data.json);
    page.html()
}

/// A chart that the script draws, and its picture for readers without.
fn charts_html(charts: &[ChartSpec], data: &PageData, beside: &Beside) -> String {
    let mut letters = 0;
    let mut html = String::new();
    let held = charts.iter().filter(|chart| data.holds(chart.table));
    for (number, chart) in held.enumerate() {
        let picture = beside
            .charts
            .iter()
            .find(|picture| picture.title == chart.title);
        let picture = picture.filter(|picture| {
            letters += picture.element.len();
            letters <= MOST_PICTURES
        });
        let without = match picture {
            Some(picture) => figure(picture),
            None => format!(
                "<p>This chart lies beside the page: {}.svg.</p>",
                escape(&chart.name)
            ),
        };
        let title = escape(&chart.title);
        let note = match chart.note.is_empty() {
            true => String::new(),
            false => format!("<p class=\"quiet\">{}</p>", escape(&chart.note)),
        };
        let _ = write!(
            html,
            "<h3 id=\"chart-{}\">{title}</h3>{note}<div class=\"chart\" data-chart=\"{number}\"></div><noscript>{without}</noscript>",
            escape(&chart.name)
        );
    }
    html + &not_drawn(&beside.left_out)
}

/// Which charts have no file, and how they get one.
fn not_drawn(left_out: &[String]) -> String {
    let (Some(first), Some(last)) = (left_out.first(), left_out.last()) else {
        return String::new();
    };
    format!(
        "<p class=\"quiet\">Of the files of charts only the first are drawn. {} more, from {} to {}, are left out; with script this page shows \
         every row, and <code>bubbletouch report FOLDER --all-charts</code> draws all files.</p>",
        left_out.len(),
        escape(first),
        escape(last)
    )
}

/// A place for advice on the first charted table that has choices with a value and a cost.
fn advice_html(found: &Found, data: &PageData) -> String {
    let charted = found.charts.iter().map(|chart| chart.table);
    let files = charted.chain(found.tables.iter().map(|table| table.file));
    let mut tables = files.filter_map(|file| found.tables.iter().find(|table| table.file == file));
    let Some(table) = tables.find(|table| data.holds(table.file) && table.offers_choices()) else {
        return String::new();
    };
    format!(
        "<p class=\"quiet\">Conditions of the world are given, not chosen: each has its own advice. From {}.</p><div data-advice=\"{0}\"></div>\
         <noscript><p>Advice needs script; <code>bubbletouch advise</code> gives the same.</p></noscript>",
        escape(table.file)
    )
}

fn tables_html(tables: &[Table], data: &PageData) -> String {
    let mut html = String::new();
    let mut letters = 0;
    for table in tables {
        let (file, title) = (escape(table.file), escape(table.title));
        let note = escape(&table.note);
        let times = if table.repeats {
            ""
        } else {
            " Times differ from run to run."
        };
        let _ = write!(
            html,
            "<h3>{title}</h3><p class=\"quiet\">{file}. {note}{times}</p>"
        );
        if table.n_rows == 0 {
            html += "<p>No rows.</p>";
        } else if data.holds(table.file) {
            let without = without_script(table);
            letters += without.len();
            let without = match letters <= MOST_TABLES {
                true => without,
                false => format!("<p>It lies beside this page: {file}.</p>"),
            };
            let _ = write!(
                html,
                "<div data-table=\"{file}\"></div><noscript>{without}</noscript>"
            );
        } else {
            let _ = write!(
                html,
                "<p>Its {} rows are too many for a page and lie beside it: {file}.</p>",
                table.n_rows
            );
        }
    }
    html
}

fn without_script(table: &Table) -> String {
    let title = escape(table.title);
    let mut html = format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{title}\"><table><thead><tr>"
    );
    for column in &table.columns {
        let _ = write!(html, "<th scope=\"col\">{}</th>", escape(&column.title()));
    }
    html += "</tr></thead><tbody>";
    for row in 0..table.n_rows.min(MOST_ROWS) {
        html += "<tr>";
        for (column, data) in table.columns.iter().zip(&table.data) {
            let class = if matches!(data, Data::Words { .. }) {
                " class=\"word\""
            } else {
                ""
            };
            let said = data
                .value(row)
                .map_or_else(String::new, |value| column.value_words(&value));
            let _ = write!(html, "<td{class}>{}</td>", escape(&said));
        }
        html += "</tr>";
    }
    html += "</tbody></table></div>";
    if table.n_rows > MOST_ROWS {
        let _ = write!(
            html,
            "<p>The first {MOST_ROWS} of {} rows.</p>",
            table.n_rows
        );
    }
    html
}

fn again(about: &StudyAbout) -> String {
    let mut html = String::new();
    if about.wall_s.is_finite() {
        let seconds = short_number(about.wall_s);
        let _ = write!(html, "<p>The run took {seconds} s from start to end.</p>");
    }
    if !about.command.is_empty() {
        let _ = write!(html, "<pre><code>{}</code></pre>", escape(&about.command));
    }
    html
}

fn foot(about: &StudyAbout, tables: &[Table]) -> String {
    let files = tables.iter().filter(|table| !table.csv.is_empty());
    let files: Vec<&str> = files.map(|table| table.file).collect();
    format!(
        "<p>{}. The tables behind this page lie beside it: {}. Times differ from run to run; all else does not.</p>",
        escape(&about.program),
        escape(&files.join(", "))
    )
}
