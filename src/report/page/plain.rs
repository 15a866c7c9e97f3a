//! Pages without script: of studies that are not of recognition.

use crate::report::axis::short_number;
use crate::report::drawing::{Drawing, escape};
use crate::report::page::about::StudyAbout;
use crate::report::page::frame::{Page, Section, sentences_html};
use crate::report::page::picture::{Picture, figures};
use comfy_table::{Row, Table};
use std::fmt::Write;

/// Question, sections, the command, and the names of the tables beside the page.
pub(crate) fn plain_page(about: &StudyAbout, found: Vec<Section>, files: &[&str]) -> String {
    let mut page = Page {
        question: about.question.clone(),
        expected: about.expected.clone(),
        foot: format!(
            "<p>{}. The tables behind this page lie beside it: {}. Times differ from run to run; all else does not.</p>",
            escape(&about.program),
            files.join(", ")
        ),
        ..with_sections(&about.name, found)
    };
    let body = format!(
        "<p>The run took {} s from start to end.</p>\n<pre><code>{}</code></pre>",
        short_number(about.wall_s.round()),
        escape(&about.command)
    );
    page.add(Section::new("again", "Make it again", body));
    page.html()
}

fn with_sections(name: &str, found: Vec<Section>) -> Page {
    let mut page = Page {
        name: name.to_owned(),
        ..Page::default()
    };
    for section in found {
        page.add(section);
    }
    page
}

/// What was found in sentences; left out if there are none.
pub(crate) fn answer(sentences: &[String]) -> Section {
    Section::new("answer", "Answer", sentences_html(sentences))
}

/// Charts, one below the other.
pub(crate) fn charts<'a>(
    drawn: impl IntoIterator<Item = &'a (String, String, Drawing)>,
) -> Section {
    let pictures = drawn.into_iter();
    let pictures: Vec<Picture> = pictures
        .map(|(_, title, drawing)| Picture::of(drawing, title))
        .collect();
    Section::new("charts", "Charts", figures(&pictures))
}

/// A table of the terminal as HTML, with a note above.
pub(crate) fn table(id: &'static str, title: &'static str, note: &str, table: &Table) -> Section {
    if table.row_iter().next().is_none() {
        return Section::default();
    }
    let texts = |row: &Row| -> Vec<String> { row.cell_iter().map(|cell| cell.content()).collect() };
    let rows: Vec<Vec<String>> = table.row_iter().map(texts).collect();
    let heads = table.header().map(texts).unwrap_or_default();
    let is_number = |column: usize| {
        let starts = |row: &Vec<String>| row[column].chars().next();
        let is_digit = |letter: char| letter.is_ascii_digit() || "-−+<".contains(letter);
        rows.iter().filter_map(starts).all(is_digit)
    };
    let class = |column: usize| match is_number(column) {
        true => "",
        false => " class=\"word\"",
    };
    let mut html = format!(
        "<p class=\"quiet\">{}</p><div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{title}\"><table><thead><tr>",
        escape(note)
    );
    for (column, head) in heads.iter().enumerate() {
        let class = class(column);
        let _ = write!(html, "<th scope=\"col\"{class}>{}</th>", escape(head));
    }
    html += "</tr></thead><tbody>";
    for row in &rows {
        html += "<tr>";
        for (column, text) in row.iter().enumerate() {
            let class = class(column);
            let _ = write!(html, "<td{class}>{}</td>", escape(text));
        }
        html += "</tr>";
    }
    Section::new(id, title, html + "</tbody></table></div>")
}
