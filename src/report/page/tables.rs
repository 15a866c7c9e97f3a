//! The tables of the page that do not move: cells, limits reached, times.

use crate::report::answer::{Answer, accuracy_sentence};
use crate::report::axis::{classifier_name, short_number};
use crate::report::drawing::escape;
use crate::report::page::about::ReportPage;
use crate::report::run_differences::too_few_words;
use crate::study::table::{Cell, CellScore, Comparison, PStatus, Tables};
use std::collections::HashMap;
use std::fmt::Write;

/// Cells that a table without script shows, at most.
const MOST_CELLS: usize = 500;

/// Cells with their scores and their distances to the best, in their order or, of very many, the most accurate first.
pub(super) fn summary_html(tables: &Tables, answer: &Answer) -> String {
    let axes = answer.settings().shown();
    let rows = tables.comparison.iter().map(|row| (row.cell, row));
    let comparisons: HashMap<usize, &Comparison> = rows.collect();
    let mut rows: Vec<&(Cell, CellScore)> = tables.summary.iter().collect();
    let n_left_out = rows.len().saturating_sub(MOST_CELLS);
    let mut html = String::new();
    if n_left_out > 0 {
        rows.sort_by(|(_, a), (_, b)| b.accuracy.total_cmp(&a.accuracy));
        html += &format!(
            "<p>The {MOST_CELLS} most accurate cells; {n_left_out} more are in summary.csv.</p>"
        );
    }
    html += "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Summary of cells\"><table><thead><tr>";
    for levels in &axes {
        let _ = write!(html, "<th scope=\"col\">{}</th>", levels.heading());
    }
    let _ = write!(
        html,
        "<th scope=\"col\">accuracy [95 %]</th><th scope=\"col\">macro-F1</th><th scope=\"col\">to the best</th>\
         <th scope=\"col\">{}</th><th></th></tr></thead><tbody>",
        p_name(tables)
    );
    for (cell, score) in rows.into_iter().take(MOST_CELLS) {
        let remark = answer.remark(cell, score);
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
        let row = comparisons.get(&cell.cell);
        let row = row.filter(|row| row.cell != row.best_cell);
        let difference = row.map_or(String::new(), |row| format!("{:+.3}", row.difference));
        let p = match row {
            Some(row) if row.p_status == PStatus::TooFewTrials => "too few trials".to_owned(),
            _ => row
                .and_then(|row| p_value(row))
                .map_or(String::new(), p_sentence),
        };
        let _ = write!(
            html,
            "<td>{}</td><td>{:.2}</td><td>{difference}</td><td>{p}</td><td>{remark}</td></tr>",
            accuracy_sentence(score),
            score.macro_f1
        );
    }
    html + "</tbody></table></div>"
}

/// A p-value as a page shows it: corrected for the number of cells, but for tables of earlier versions.
pub(super) fn p_value(row: &Comparison) -> Option<f64> {
    row.p_holm.or(row.p_value)
}

/// Why a study has no p-values, if it has none for want of trials.
pub(super) fn too_few_trials(tables: &Tables) -> Option<String> {
    let of_others = tables
        .comparison
        .iter()
        .filter(|row| row.cell != row.best_cell);
    let row = of_others
        .into_iter()
        .find(|row| row.p_status == PStatus::TooFewTrials)?;
    let trials = row.n_trials_needed.map(|needed| (row.n_trials, needed));
    Some(too_few_words(trials))
}

/// What it is called.
pub(super) fn p_name(tables: &Tables) -> &'static str {
    match tables.comparison.iter().any(|row| row.p_holm.is_some()) {
        true => "p (Holm)",
        false => "p",
    }
}

fn p_sentence(p: f64) -> String {
    match p < 0.001 {
        true => "&lt; 0.001".to_owned(),
        false => format!("{p:.3}"),
    }
}

/// Limits of the model and of the solver that were reached.
pub(super) fn limits_html(about: &ReportPage, tables: &Tables) -> String {
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

/// What each stage cost.
pub(super) fn times_html(about: &ReportPage, tables: &Tables) -> String {
    let mut html = String::new();
    if let Some(seconds) = about.wall_s {
        let _ = write!(
            html,
            "<p>The run took {} s from start to end.</p>",
            short_number(seconds)
        );
    }
    html += "<div class=\"wide times\" tabindex=\"0\" role=\"region\" aria-label=\"Times\"><table><thead><tr><th scope=\"col\">stage</th><th scope=\"col\">at</th><th scope=\"col\">touches</th><th scope=\"col\">µs a touch</th>\
             <th scope=\"col\">processor s</th></tr></thead><tbody>";
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
    // Cells that differ in how many touches are fused share their fit and their scores: one of them is counted.
    let fused = tables.timing.iter().map(|(cell, _)| cell.fused_touches);
    let first = fused.min().unwrap_or(1);
    let timing = || {
        tables
            .timing
            .iter()
            .filter(|(c, _)| c.fused_touches == first)
    };
    let mut kinds: Vec<&'static str> = Vec::new();
    for (cell, _) in timing() {
        let kind = classifier_name(cell.classifier);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let mut rows = Vec::new();
    for kind in kinds {
        let mine = timing().filter(|(cell, _)| classifier_name(cell.classifier) == kind);
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
