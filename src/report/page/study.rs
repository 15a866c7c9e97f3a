//! The page of a study of any kind.

use super::about::StudyAbout;
use super::data::PageData;
use super::frame::{Section, html, sentences_html};
use super::picture::{figure, png_element};
use super::provenance::provenance_html;
use crate::report::drawing::escape;
use crate::report::study_folder::{Beyond, ChartFormat, Found, NamedPicture};
use crate::table::{ChartSpec, Column, Scale, Table, short_number};

/// Letters of pictures for readers without script, at most: a study of thousands of rows has megabytes of them.
const MOST_PICTURES: usize = 600_000;
/// Rows of a table for readers without script, at most.
const MOST_ROWS: usize = 100;
/// Letters of tables for readers without script, at most.
const MOST_TABLES: usize = 150_000;

/// What stands on a page beside tables and charts.
#[derive(Default)]
pub(crate) struct Beside {
    /// The charts as SVG, in their order, for readers without script.
    pub charts: Vec<String>,
    /// Names of charts that were not drawn.
    pub left_out: Vec<String>,
    /// Pictures that are no charts, and sections of its own, which come before the tables.
    pub beyond: Beyond,
}

/// The page.
pub(crate) fn page(about: &StudyAbout, found: &Found, beside: &Beside) -> String {
    let data = PageData::of(found.tables, found.charts);
    let charts = charts_html(about, found.charts, &data, beside);
    let pictures = beside.beyond.pictures.iter().map(picture_html).collect();
    let mut sections = vec![
        Section::new("answer", "Answer", sentences_html(found.answers)),
        Section::new("charts", "Charts", charts),
        Section::new("choices", "What to choose", advice_html(found, &data)),
        Section::new("pictures", "Pictures", pictures),
    ];
    sections.extend_from_slice(&beside.beyond.sections);
    let provenance = about.manifest.as_ref().map(provenance_html);
    sections.extend([
        Section::new("tables", "Tables", tables_html(found.tables, &data)),
        Section::new("provenance", "Provenance", provenance.unwrap_or_default()),
        Section::new("again", "Make it again", again(about)),
    ]);
    html(about, &sections, &foot(about, found.tables), &data.json)
}

fn picture_html(picture: &NamedPicture) -> String {
    let title = &picture.title;
    figure(&png_element(&picture.png, picture.size, title), title)
}

/// A chart that the script draws, and its picture for readers without.
fn charts_html(
    about: &StudyAbout,
    charts: &[ChartSpec],
    data: &PageData,
    beside: &Beside,
) -> String {
    let mut letters = 0;
    let drawn = charts.iter().zip(&beside.charts);
    let held = drawn.filter(|(chart, _)| data.holds(chart.table));
    let place = |(number, (chart, svg)): (usize, (&ChartSpec, &String))| {
        let name = escape(&chart.name);
        let without = match letters + svg.len() <= MOST_PICTURES {
            true => {
                letters += svg.len();
                figure(svg, &chart.title)
            }
            false => {
                let ending = match about.chart_format {
                    ChartFormat::Png => "png",
                    ChartFormat::Svg | ChartFormat::Both => "svg",
                };
                format!("<p>This chart lies beside the page: {name}.{ending}.</p>")
            }
        };
        let title = escape(&chart.title);
        let note = match chart.note.is_empty() {
            true => String::new(),
            false => format!("<p class=\"quiet\">{}</p>", escape(&chart.note)),
        };
        format!(
            "<h3 id=\"chart-{name}\">{title}</h3>{note}<div class=\"chart\" data-chart=\"{number}\"></div><noscript>{without}</noscript>"
        )
    };
    let charts: String = held.enumerate().map(place).collect();
    charts + &not_drawn(&beside.left_out)
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
    let Some(table) =
        tables.find(|table| data.holds(table.file) && table.n_rows > 1 && table.offers_choices())
    else {
        return String::new();
    };
    format!(
        "<p class=\"quiet\">Conditions of the world are given, not chosen: each has its own advice. From the table “{title}”.</p><div data-advice=\"{file}\"></div>\
         <noscript><p>Advice needs script; <code>bubbletouch advise</code> gives the same.</p></noscript>",
        title = escape(table.title),
        file = escape(table.file)
    )
}

fn tables_html(tables: &[Table], data: &PageData) -> String {
    let mut letters = 0;
    let place = |table: &Table| {
        let (file, title, n) = (escape(table.file), escape(table.title), table.n_rows);
        let times = match table.repeats {
            true => "",
            false => " Times differ from run to run.",
        };
        let body = if n == 0 {
            "<p>No rows.</p>".to_owned()
        } else if data.holds(table.file) {
            let whole = without_script(table);
            letters += whole.len();
            let without = match letters <= MOST_TABLES {
                true => whole,
                false if table.csv.is_empty() => {
                    "<p>It needs script: it has no file of its own.</p>".to_owned()
                }
                false => format!("<p>It lies beside this page: {file}.</p>"),
            };
            format!("<div data-table=\"{file}\"></div><noscript>{without}</noscript>")
        } else {
            match table.csv.is_empty() {
                true => format!("<p>Its {n} rows are too many for a page.</p>"),
                false => format!(
                    "<p>Its {n} rows are too many for a page and lie beside it: {file}.</p>"
                ),
            }
        };
        let note = escape(&table.note);
        // A table that is made of others has no file.
        let name = match table.csv.is_empty() {
            true => String::new(),
            false => format!("{file}. "),
        };
        format!("<h3>{title}</h3><p class=\"quiet\">{name}{note}{times}</p>{body}")
    };
    tables.iter().map(place).collect()
}

fn without_script(table: &Table) -> String {
    let heads = table.columns.iter();
    let heads = heads.map(|column| format!("<th scope=\"col\">{}</th>", escape(&column.title())));
    let cell = |column: &Column, row: usize| {
        let class = match column.scale {
            Scale::Words => " class=\"word\"",
            _ => "",
        };
        let said = table.words(&column.name, row);
        format!("<td{class}>{}</td>", escape(&said))
    };
    let row = |row: usize| {
        let cells = table.columns.iter().map(|column| cell(column, row));
        format!("<tr>{}</tr>", cells.collect::<String>())
    };
    let more = match table.n_rows > MOST_ROWS {
        true => format!("<p>The first {MOST_ROWS} of {} rows.</p>", table.n_rows),
        false => String::new(),
    };
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>{more}",
        escape(table.title),
        heads.collect::<String>(),
        (0..table.n_rows.min(MOST_ROWS))
            .map(row)
            .collect::<String>()
    )
}

fn again(about: &StudyAbout) -> String {
    let took = match about.wall_s {
        s if s.is_finite() => format!(
            "<p>The run took {} s from start to end.</p>",
            short_number(s)
        ),
        _ => String::new(),
    };
    match &about.command[..] {
        "" => took,
        command => format!("{took}<pre><code>{}</code></pre>", escape(command)),
    }
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
