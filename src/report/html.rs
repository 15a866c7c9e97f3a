//! `report.html`: one page with everything in it, that needs no network and no script.

use crate::report::answer::{Answer, accuracy_sentence};
use crate::report::drawing::{Drawing, escape};
use crate::report::heat_map::Quantity;
use crate::report::varying::{Settings, classifier_name, short_number};
use crate::study::table::{Cell, Tables};
use ndarray::Array2;
use std::fmt::Write;

const TEMPLATE: &str = include_str!("report.html");

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
        let data = base64(png);
        let (width, height) = (drawing.width(), drawing.height());
        Self {
            title: title.to_owned(),
            element: format!(
                r#"<img src="data:image/png;base64,{data}" width="{width}" height="{height}" alt="{}">"#,
                escape(title)
            ),
        }
    }
}

/// The page.
pub fn page(
    about: &ReportPage,
    tables: &Tables,
    charts: &[Picture],
    confusion: Option<&Picture>,
    touches: Option<&Picture>,
) -> String {
    let answer = Answer::of(tables);
    fill(TEMPLATE, |name| match name {
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
        "charts" => charts.iter().map(figure).collect(),
        "touches" => section("Sample touches", touches.map(figure)),
        "summary" => summary_html(tables, answer.as_ref()),
        "confusion" => section("What was taken for what", confusion.map(figure)),
        "limits" => limits_html(about, tables),
        "times" => times_html(about, tables),
        "command" => escape(&about.command),
        "program" => escape(&about.program),
        other => format!("(no value for {other})"),
    })
}

/// Replaces each `{{name}}` of a template once, left to right: what is put in is never searched again.
fn fill(template: &str, value: impl Fn(&str) -> String) -> String {
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

fn summary_html(tables: &Tables, answer: Option<&Answer>) -> String {
    let cells: Vec<&Cell> = tables.summary.iter().map(|(cell, _)| cell).collect();
    let settings = Settings::of(&cells);
    let axes = settings.shown();
    let differences = |cell: usize| tables.comparison.iter().find(|row| row.cell == cell);
    let mut html = String::from("<table><thead><tr>");
    for levels in &axes {
        let _ = write!(html, "<th scope=\"col\">{}</th>", levels.heading());
    }
    html += "<th scope=\"col\">accuracy [95 %]</th><th scope=\"col\">macro-F1</th>\
             <th scope=\"col\">to the best</th><th scope=\"col\">p</th><th></th></tr></thead><tbody>";
    for (cell, score) in &tables.summary {
        let remark = answer.map_or("", |answer| answer.remark(cell, score));
        let _ = write!(
            html,
            "<tr{}>",
            if remark == "best" {
                " class=\"best\""
            } else {
                ""
            }
        );
        for levels in &axes {
            let value = levels.axis.value(cell);
            let _ = write!(html, "<td>{}</td>", escape(&value.label));
        }
        let row = differences(cell.cell).filter(|row| row.cell != row.best_cell);
        let difference = row.map_or(String::new(), |row| format!("{:+.3}", row.difference));
        let p = row
            .and_then(|row| row.p_value)
            .map_or(String::new(), p_sentence);
        let _ = write!(
            html,
            "<td>{}</td><td>{:.2}</td><td>{difference}</td><td>{p}</td><td>{remark}</td></tr>",
            accuracy_sentence(score),
            score.macro_f1
        );
    }
    html + "</tbody></table>"
}

fn p_sentence(p: f64) -> String {
    match p < 0.001 {
        true => "&lt; 0.001".to_owned(),
        false => format!("{p:.3}"),
    }
}

fn limits_html(about: &ReportPage, tables: &Tables) -> String {
    let capped: usize = tables.summary.iter().map(|(_, score)| score.n_capped).sum();
    let mut html = String::from("<ul>");
    for limit in &about.limits {
        let share = 100.0 * limit.count as f64 / limit.of.max(1) as f64;
        let _ = write!(
            html,
            "<li><b>{} of {}</b> {} ({} %). {}</li>",
            limit.count,
            limit.of,
            escape(&limit.what),
            short_number(share),
            escape(&limit.meaning)
        );
    }
    let _ = write!(
        html,
        "<li><b>{capped}</b> binary SVMs stopped at the iteration cap.{}</li>",
        if capped > 0 {
            " Their cells may do better with more iterations or a smaller C."
        } else {
            ""
        }
    );
    html + "</ul>"
}

fn times_html(about: &ReportPage, tables: &Tables) -> String {
    let mut html = String::new();
    if let Some(seconds) = about.wall_s {
        let _ = write!(
            html,
            "<p>The run took {} s from start to end.</p>",
            short_number(seconds)
        );
    }
    html += "<div class=\"wide times\"><table><thead><tr><th>stage</th><th>at</th><th>touches</th><th>µs a touch</th>\
             <th>processor s</th></tr></thead><tbody>";
    for stage in &tables.stages {
        let _ = write!(
            html,
            "<tr><td>{}</td><td>{} × {}, {} mm</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            escape(&stage.stage),
            stage.nx,
            stage.ny,
            short_number(stage.pitch_mm),
            stage.n_touches,
            short_number(stage.us_per_touch),
            short_number(stage.cpu_s)
        );
    }
    for row in recognition_times(tables) {
        html += &row;
    }
    html + "</tbody></table></div>"
}

/// One row a classifier for training and one for deciding, summed over cells and trials.
fn recognition_times(tables: &Tables) -> Vec<String> {
    let mut kinds: Vec<&'static str> = Vec::new();
    for (cell, _) in &tables.timing {
        let kind = classifier_name(cell.classifier);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let mut rows = Vec::new();
    for kind in kinds {
        let mine = tables
            .timing
            .iter()
            .filter(|(cell, _)| classifier_name(cell.classifier) == kind);
        let (mut fit_s, mut predict_s, mut n_predicted, mut n_trials) = (0.0, 0.0, 0.0, 0);
        for (_, time) in mine {
            fit_s += time.fit_s;
            predict_s += time.predict_s;
            n_trials += 1;
            if time.predict_us_per_touch > 0.0 {
                n_predicted += 1e6 * time.predict_s / time.predict_us_per_touch;
            }
        }
        let us = 1e6 * predict_s / f64::max(n_predicted, 1.0);
        rows.push(format!(
            "<tr><td>train {kind}</td><td>{n_trials} trials</td><td></td><td></td><td>{}</td></tr>\
             <tr><td>recognise with {kind}</td><td>{n_trials} trials</td><td>{n_predicted:.0}</td><td>{}</td><td>{}</td></tr>",
            short_number(fit_s),
            short_number(us),
            short_number(predict_s)
        ));
    }
    rows
}

fn section(title: &str, figure: Option<String>) -> String {
    match figure {
        Some(figure) => format!("<section><h2>{title}</h2>{figure}</section>"),
        None => String::new(),
    }
}

fn figure(picture: &Picture) -> String {
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
