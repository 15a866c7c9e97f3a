//! What the page of a study of recognition has beside that of any study: sample touches, settings, and how often limits were reached.

use crate::error::Result;
use crate::report::csv_tables::LIMITS_FILE;
use crate::report::drawing::escape;
use crate::report::page::{Section, Snapshots, touches_html};
use crate::report::swept::Swept;
use crate::table::{Table, short_number};
use std::fmt::Write;

/// Sample touches, settings, limits.
///
/// # Errors
/// A sample touch that nobody can draw.
pub fn sections(
    settings: &[(String, String)],
    gallery: &[Snapshots],
    tables: &[Table],
) -> Result<Vec<Section>> {
    let touches: String = gallery.iter().map(touches_html).collect::<Result<_>>()?;
    Ok(vec![
        Section::new("touches", "Sample touches", touches),
        Section::new("settings", "Settings", settings_html(settings, tables)),
        Section::new("limits", "Limits", limits_html(tables)),
    ])
}

fn settings_html(settings: &[(String, String)], tables: &[Table]) -> String {
    let mut html = String::from("<dl>");
    for (name, value) in settings {
        let class = match value.len() > 60 {
            true => " class=\"long\"",
            false => "",
        };
        let (name, value) = (escape(name), escape(value));
        let _ = write!(html, "<div{class}><dt>{name}</dt><dd>{value}</dd></div>");
    }
    if let Some(cells) = tables.iter().find(|table| table.file == super::CELLS) {
        let rows: Vec<usize> = (0..cells.n_rows).collect();
        let swept = Swept::of(cells, &rows);
        let swept_ones = swept
            .free
            .iter()
            .map(|one| (one, " <span class=\"tag\">swept</span>"));
        for (setting, mark) in swept_ones.chain(swept.fixed.iter().map(|one| (one, ""))) {
            let values = setting.levels(&rows).into_iter();
            let values: Vec<String> = values.map(|row| escape(&setting.label(row))).collect();
            let (name, values) = (escape(&setting.column.words), values.join(", "));
            let _ = write!(html, "<div><dt>{name}{mark}</dt><dd>{values}</dd></div>");
        }
    }
    html + "</dl>"
}

/// Limits of the model and of the solver that were reached.
fn limits_html(tables: &[Table]) -> String {
    let table = tables.iter().find(|table| table.file == LIMITS_FILE);
    let Some(table) = table.filter(|table| table.n_rows > 0) else {
        return format!(
            "<p>Which limits were reached is not known: there is no {LIMITS_FILE}.</p>"
        );
    };
    let item = |row: usize| {
        let (count, of) = (table.number("count", row), table.number("of", row));
        let share = short_number(100.0 * count / of.max(1.0));
        let [what, meaning] = ["what", "meaning"].map(|name| escape(table.word(name, row)));
        format!("<li><b>{count} of {of}</b> {what} ({share} %). {meaning}</li>")
    };
    let items: String = (0..table.n_rows).map(item).collect();
    format!("<ul>{items}</ul>")
}
