//! The tables of a study of a whole body as people read them: in the terminal, and in the page.

use crate::report::axis::short_number;
use crate::report::headlines::TextTable;
use crate::study::whole_body::table::{Series, Stage, WholeBodyTables};

/// What was asked beside what was measured; none if nothing was.
pub(super) fn bars_table(tables: &WholeBodyTables) -> Option<TextTable> {
    let rows = tables.bars.iter().map(|bar| {
        let asked = match bar.at_least {
            true => "at least",
            false => "at most",
        };
        vec![
            bar.what.clone(),
            format!("{} {}", short_number(bar.measured), bar.unit),
            format!("{asked} {}", short_number(bar.bar)),
            if bar.is_met { "yes" } else { "no" }.to_owned(),
        ]
    });
    let heads = vec![
        ("what", false),
        ("measured", true),
        ("asked", true),
        ("met", false),
    ];
    let note = "Medians over steps, on this machine.".to_owned();
    TextTable::of("What was asked", note, heads, rows.collect())
}

/// The scenes: what was touched, and the time from touch to answer.
pub(super) fn scenes_table(tables: &WholeBodyTables) -> Option<TextTable> {
    let scenes = tables.cases.iter();
    let scenes = scenes.filter(|(case, _)| case.series == Series::Scene);
    let rows = scenes.map(|(case, count)| {
        let times = tables.timing.iter().filter(|(of, _)| of == case);
        let median = |stage: Stage| {
            let times = times.clone().filter(|(_, time)| time.stage == stage);
            // The press is there once more with one thread.
            let times = times.take(if stage == Stage::Press { 1 } else { usize::MAX });
            let most = times.map(|(_, time)| time.us_median).reduce(f64::max);
            most.map_or(String::new(), |us| short_number(round(us)))
        };
        vec![
            case.name.clone(),
            case.n_spheres.to_string(),
            format!("{:.0}", count.touched_mean),
            format!("{:.0}", count.patches_touched_mean),
            median(Stage::Press),
            median(Stage::Compress),
            median(Stage::Classify),
            median(Stage::Whole),
        ]
    });
    let heads = vec![
        ("scene", false),
        ("spheres", true),
        ("touched", true),
        ("patches", true),
        ("press µs", true),
        ("compress µs", true),
        ("classify µs", true),
        ("all µs", true),
    ];
    let n_taxels = tables.cases.first().map_or(0, |(case, _)| case.n_taxels);
    let note =
        format!("A body of {n_taxels} taxels; medians over steps, of compressions the slowest.");
    TextTable::of("Scenes", note, heads, rows.collect())
}

/// How well objects are told apart from each compression.
pub(super) fn recognition_table(tables: &WholeBodyTables) -> Option<TextTable> {
    let first = tables.recognition.first()?;
    let rows = tables.recognition.iter().map(|row| {
        vec![
            row.compression.clone(),
            row.n_measurements.to_string(),
            format!("{:.3}", row.read_share),
            short_number(row.entries_per_taxel),
            format!("{:.0}", row.bytes_per_taxel),
            format!(
                "{:.3} [{:.3}, {:.3}]",
                row.accuracy, row.accuracy_low, row.accuracy_high
            ),
        ]
    });
    let heads = vec![
        ("compression", false),
        ("measurements", true),
        ("taxels read", true),
        ("entries a taxel", true),
        ("bytes a taxel", true),
        ("accuracy [95 %]", true),
    ];
    let note = format!(
        "A linear SVM, {} objects, {} training and {} test touches.",
        first.n_objects, first.n_training, first.n_test
    );
    TextTable::of("Recognition", note, heads, rows.collect())
}

/// Three digits are enough of a time.
fn round(us: f64) -> f64 {
    match us {
        us if us >= 100.0 => us.round(),
        us if us >= 10.0 => (10.0 * us).round() / 10.0,
        us => (100.0 * us).round() / 100.0,
    }
}
