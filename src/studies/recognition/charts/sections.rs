//! Page sections that only recognition studies have: settings, and the limits that were reached.

use crate::report::csv_tables::LIMITS_FILE;
use crate::report::page::{Section, definition};
use crate::report::pictures::drawing::escape;
use crate::report::swept::Swept;
use crate::studies::recognition::charts::filled::filled;
use crate::studies::recognition::charts::tables::CONFIGURATIONS;
use crate::table::{Table, short_number};

/// Returns the page sections about settings, and the number of times that each limit of the simulation or training was reached.
pub fn sections(settings: &[(String, String)], tables: &[Table]) -> Vec<Section> {
    vec![
        Section::new("settings", "Settings", settings_html(settings, tables)),
        Section::new("limits", "Limits", limits_html(tables)),
    ]
}

/// Returns the study's description as HTML, followed by every setting with its values.
fn settings_html(settings: &[(String, String)], tables: &[Table]) -> String {
    let settings = settings.iter();
    let mut html: String = settings
        .map(|(name, value)| definition(&escape(name), value))
        .collect();
    if let Some(configurations) = filled(tables, CONFIGURATIONS) {
        let rows: Vec<usize> = (0..configurations.n_rows).collect();
        let Swept { free, fixed, .. } = Swept::new(configurations, &rows);
        let free = free
            .iter()
            .map(|one| (one, " <span class=\"tag\">swept</span>"));
        for (setting, mark) in free.chain(fixed.iter().map(|one| (one, ""))) {
            let values = setting.levels(&rows).into_iter();
            let values: Vec<String> = values.map(|row| setting.label(row)).collect();
            let name = escape(&setting.column.words) + mark;
            html += &definition(&name, &values.join(", "));
        }
    }
    format!("<dl>{html}</dl>")
}

/// Returns HTML that lists the limits of the simulation and of the solver that were reached, with their counts.
fn limits_html(tables: &[Table]) -> String {
    let Some(table) = filled(tables, LIMITS_FILE) else {
        return String::new();
    };
    let item = |row: usize| {
        let (count, of) = (table.number("count", row), table.number("total", row));
        let share = short_number(100.0 * count / of.max(1.0));
        let [what, meaning] = ["limit", "meaning"].map(|name| escape(table.word(name, row)));
        format!("<li><b>{count} of {of}</b> {what} ({share} %). {meaning}</li>")
    };
    let reached = (0..table.n_rows).filter(|&row| table.number("count", row) > 0.0);
    match reached.map(item).collect::<String>() {
        items if items.is_empty() => "<p>No limit was reached.</p>".to_owned(),
        items => format!("<ul>{items}</ul>"),
    }
}
