//! What the page of a study of recognition has beside that of any study: sample touches, settings, and how often limits were reached.

use crate::error::Result;
use crate::report::csv_tables::LIMITS_FILE;
use crate::report::drawing::escape;
use crate::report::page::{Limit, ReportPage, Section, touches_html};
use crate::report::swept::{Setting, Swept};
use crate::table::{Table, short_number};
use std::fmt::Write;

/// Sample touches, settings, limits.
///
/// # Errors
/// A sample touch that nobody can draw.
pub fn sections(about: &ReportPage, tables: &[Table]) -> Result<Vec<Section>> {
    let touches: String = match about.gallery.is_empty() {
        true => about
            .snapshots
            .iter()
            .map(touches_html)
            .collect::<Result<_>>()?,
        false => about
            .gallery
            .iter()
            .map(touches_html)
            .collect::<Result<_>>()?,
    };
    Ok(vec![
        Section::new("touches", "Sample touches", touches),
        Section::new("settings", "Settings", settings_html(about, tables)),
        Section::new("limits", "Limits", limits_html(&about.limits)),
    ])
}

fn settings_html(about: &ReportPage, tables: &[Table]) -> String {
    let mut html = String::from("<dl>");
    for (name, value) in &about.settings {
        let class = match value.len() > 60 {
            true => " class=\"long\"",
            false => "",
        };
        let _ = write!(
            html,
            "<div{class}><dt>{}</dt><dd>{}</dd></div>",
            escape(name),
            escape(value)
        );
    }
    if let Some(cells) = tables.iter().find(|table| table.file == super::CELLS) {
        let rows: Vec<usize> = (0..cells.n_rows).collect();
        let swept = Swept::of(cells, &rows, &super::GIVEN_UP_FIRST);
        let mut write_one = |setting: &Setting, mark: &str| {
            let values: Vec<String> = setting
                .levels(&rows)
                .iter()
                .map(|&row| escape(&setting.label(row)))
                .collect();
            let (name, values) = (escape(&setting.column.words), values.join(", "));
            let _ = write!(html, "<div><dt>{name}{mark}</dt><dd>{values}</dd></div>");
        };
        swept
            .free
            .iter()
            .for_each(|setting| write_one(setting, " <span class=\"tag\">swept</span>"));
        swept
            .fixed
            .iter()
            .for_each(|setting| write_one(setting, ""));
    }
    html + "</dl>"
}

/// Limits of the model and of the solver that were reached.
fn limits_html(limits: &[Limit]) -> String {
    let item = |limit: &Limit| {
        let share = 100.0 * limit.count as f64 / limit.of.max(1) as f64;
        let (what, meaning) = (escape(&limit.what), escape(&limit.meaning));
        format!(
            "<li><b>{} of {}</b> {what} ({} %). {meaning}</li>",
            limit.count,
            limit.of,
            short_number(share)
        )
    };
    match limits.is_empty() {
        true => {
            format!("<p>Which limits were reached is not known: there is no {LIMITS_FILE}.</p>")
        }
        false => format!("<ul>{}</ul>", limits.iter().map(item).collect::<String>()),
    }
}
