//! Page sections that only recognition studies have: settings, and the limits that were reached.

use crate::report::page::{Section, definition, sentences_html};
use crate::report::pictures::escape;
use crate::report::swept::Swept;
use crate::studies::recognition::charts::answers::limits;
use crate::studies::recognition::tables::table_files::{CONFIGURATIONS, filled};
use crate::table::Table;

/// Returns the page sections about settings, and the number of times that each limit of the simulation or training was reached.
pub fn sections(settings: &[(String, String)], tables: &[Table]) -> Vec<Section> {
    let limits = limits(tables).into_iter().map(|(_, words)| words);
    let limits = match &sentences_html(&limits.collect::<Vec<_>>())[..] {
        "" => "<p>No limit was reached.</p>".to_owned(),
        items => items.to_owned(),
    };
    vec![
        Section::new("settings", "Settings", settings_html(settings, tables)),
        Section::new("limits", "Limits", limits),
    ]
}

/// Returns the study's description as HTML, followed by every setting with its values.
fn settings_html(settings: &[(String, String)], tables: &[Table]) -> String {
    let settings = settings.iter();
    let mut html: String = settings
        .map(|(name, value)| definition(&escape(name), value))
        .collect();
    if let Some(configurations) = filled(tables, CONFIGURATIONS) {
        let rows = configurations.all_rows();
        let Swept { free, fixed, .. } = Swept::of(configurations);
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
