//! `report.html`: one page with everything in it, that needs no network and no script.

use crate::report::answer::Answer;
use crate::report::csv_tables::TABLE_FILES;
use crate::report::drawing::{Drawing, escape};
use crate::report::headlines::{confused_table, published_table};
use crate::report::html_tables::{limits_html, summary_html, times_html};
use crate::report::varying::Settings;
use crate::signal::Quantity;
use crate::study::table::{Cell, Tables};
use ndarray::Array2;
use std::fmt::Write;

const TEMPLATE: &str = include_str!("report.html");
/// How every page looks.
pub(super) const STYLE: &str = include_str!("style.css");

/// What a study says of itself, beside its tables.
#[derive(Clone, Debug, Default)]
pub struct ReportPage {
    /// The study's name.
    pub name: String,
    /// What it asks.
    pub question: String,
    /// What was expected before it ran; may be empty.
    pub expected: String,
    /// Settings worth knowing that no table holds: objects, touches, placement, seed. Name and value.
    pub settings: Vec<(String, String)>,
    /// Limits that were reached.
    pub limits: Vec<Limit>,
    /// Sample touches.
    pub snapshots: Option<Snapshots>,
    /// Whether accuracy is charted against time; `None` leaves it to the number of classifiers.
    pub pareto: Option<bool>,
    /// Seconds from start to end, if known.
    pub wall_s: Option<f64>,
    /// The command that makes the folder again.
    pub command: String,
    /// Program and version: `bubbletouch 0.1.0`.
    pub program: String,
}

/// How often a limit of the model was reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// What happened: `saturated taxels`.
    pub what: String,
    /// How often.
    pub count: u64,
    /// Out of how many.
    pub of: u64,
    /// What it means for the reader.
    pub meaning: String,
}

/// Sample touches for the picture of snapshots.
#[derive(Clone, Debug)]
pub struct Snapshots {
    /// Names and frames (ny × nx, row = y ascending).
    pub frames: Vec<(String, Array2<f64>)>,
    /// Millimetres between taxels.
    pub pitch_mm: f64,
    /// What the frames hold.
    pub quantity: Quantity,
    /// What was pressed how, and the noise.
    pub caption: String,
}

/// A picture for the page.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Title, and text for those who cannot see it.
    pub title: String,
    /// An `<svg>` or `<img>` element.
    pub element: String,
}

impl Picture {
    /// An SVG in the page.
    pub fn of(drawing: &Drawing, title: &str) -> Self {
        Self {
            title: title.to_owned(),
            element: drawing.svg(title),
        }
    }

    /// A drawing's PNG in the page: smaller than an SVG for pictures of many taxels.
    pub fn raster(drawing: &Drawing, png: &[u8], title: &str) -> Self {
        Self::of_png(png, (drawing.width(), drawing.height()), title)
    }

    /// A PNG in the page, with its width and height in pixels.
    pub fn of_png(png: &[u8], (width, height): (f64, f64), title: &str) -> Self {
        let data = base64(png);
        Self {
            title: title.to_owned(),
            element: format!(
                r#"<img src="data:image/png;base64,{data}" width="{width}" height="{height}" alt="{}">"#,
                escape(title)
            ),
        }
    }
}

/// The pictures of a study.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// Charts, the main one first.
    pub charts: Vec<Picture>,
    /// Charts of accuracy against time.
    pub times: Vec<Picture>,
    /// How many charts lie beside the page only.
    pub n_more_charts: usize,
    /// The confusion matrix of the best cell.
    pub confusion: Option<Picture>,
    /// Sample touches.
    pub touches: Option<Picture>,
}

/// The page.
pub fn page(about: &ReportPage, tables: &Tables, pictures: &Pictures) -> String {
    let answer = Answer::of(tables);
    fill(TEMPLATE, |name| match name {
        "style" => STYLE.to_owned(),
        "name" => escape(&about.name),
        "question" => escape(&about.question),
        "expected" => match about.expected.is_empty() {
            true => String::new(),
            false => format!(
                "<p class=\"quiet\">Expected: {}</p>",
                escape(&about.expected)
            ),
        },
        "answer" => answer_html(answer.as_ref()),
        "settings" => settings_html(about, tables),
        "charts" => charts_html(pictures),
        "touches" => section("Sample touches", pictures.touches.as_ref().map(figure)),
        "summary" => summary_html(tables, answer.as_ref()),
        "published" => published_table(tables).map_or(String::new(), |table| table.html()),
        "confusion" => section(
            "What was taken for what",
            pictures.confusion.as_ref().map(figure),
        ),
        "confused" => confused_table(tables).map_or(String::new(), |table| table.html()),
        "files" => TABLE_FILES.join(", "),
        "limits" => limits_html(about, tables),
        "times" => times_html(about, tables),
        "command" => escape(&about.command),
        "program" => escape(&about.program),
        other => format!("(no value for {other})"),
    })
}

/// Replaces each `{{name}}` of a template once, left to right: what is put in is never searched again.
pub(super) fn fill(template: &str, value: impl Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once("}}") {
            Some((name, rest)) => {
                filled += &value(name);
                filled += rest;
            }
            None => filled += part,
        }
    }
    filled
}

fn answer_html(answer: Option<&Answer>) -> String {
    let Some(answer) = answer else {
        return "<p>No cell has been computed.</p>".to_owned();
    };
    let sentences = answer.sentences();
    let mut html = format!("<p class=\"answer\">{}</p>", escape(&sentences[0]));
    if sentences.len() > 1 {
        html += "<ul>";
        for sentence in &sentences[1..] {
            let _ = write!(html, "<li>{}</li>", escape(sentence));
        }
        html += "</ul>";
    }
    html
}

fn charts_html(pictures: &Pictures) -> String {
    let mut html: String = pictures.charts.iter().map(figure).collect();
    if pictures.n_more_charts > 0 {
        let _ = write!(
            html,
            "<p>{} more charts lie beside this page: accuracy_by_….svg, one for each combination of the other settings.</p>",
            pictures.n_more_charts
        );
    }
    html.extend(pictures.times.iter().map(figure));
    html
}

fn settings_html(about: &ReportPage, tables: &Tables) -> String {
    let cells: Vec<&Cell> = tables.summary.iter().map(|(cell, _)| cell).collect();
    let settings = Settings::of(&cells);
    let swept = settings.varying.iter().map(|levels| (levels, "swept"));
    let fixed = settings.fixed.iter().map(|levels| (levels, "fixed"));
    let mut html = String::from("<dl>");
    for (name, value) in &about.settings {
        let _ = write!(
            html,
            "<div><dt>{}</dt><dd>{}</dd></div>",
            escape(name),
            escape(value)
        );
    }
    for (levels, how) in swept.chain(fixed) {
        let values: Vec<String> = levels.values.iter().map(|v| escape(&v.label)).collect();
        let mark = if how == "swept" {
            " <span class=\"tag\">swept</span>"
        } else {
            ""
        };
        let _ = write!(
            html,
            "<div><dt>{}{mark}</dt><dd>{}</dd></div>",
            levels.heading(),
            values.join(", ")
        );
    }
    html + "</dl>"
}

fn section(title: &str, figure: Option<String>) -> String {
    match figure {
        Some(figure) => format!("<section><h2>{title}</h2>{figure}</section>"),
        None => String::new(),
    }
}

/// A picture in its frame.
pub(super) fn figure(picture: &Picture) -> String {
    format!(
        "<figure tabindex=\"0\" aria-label=\"{}\"><div class=\"card\">{}</div></figure>",
        escape(&picture.title),
        picture.element
    )
}

/// RFC 4648 with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place)) as usize & 63];
            text.push(if place <= group.len() {
                char::from(letter)
            } else {
                '='
            });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_agrees_with_the_examples_of_rfc_4648() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn what_is_put_into_a_template_is_not_searched_for_names() {
        let value = |name: &str| format!("<{name} {{{{b}}}}>");
        assert_eq!(
            fill("x {{a}} y {{b}} z", value),
            "x <a {{b}}> y <b {{b}}> z"
        );
    }
}
