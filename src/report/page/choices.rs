//! What to choose in each condition of the world: the most accurate cell, and the cheapest of those that reach its interval.

use crate::report::answer::{Answer, Finding, accuracy_sentence};
use crate::report::drawing::escape;
use crate::report::page::frame::unbroken;
use crate::report::time_scale::time_words;
use crate::study::table::{Cell, CellScore, Pareto, Tables};
use std::collections::HashMap;
use std::fmt::Write;

/// The reasons to choose a cell, and the cell.
type Choice<'a> = (Vec<&'static str>, &'a Cell);

/// Conditions whose choices stand open on the page; of more the table is folded. Larger: it pushes everything else off the screen;
/// smaller: a study of a few levels of noise hides its answer.
const MOST_OPEN: usize = 6;

/// A table of choices; empty for a study of one cell.
pub(super) fn choices_html(tables: &Tables, answer: &Answer) -> String {
    if tables.summary.len() < 2 {
        return String::new();
    }
    let scores: HashMap<usize, &CellScore> =
        tables.summary.iter().map(|(c, s)| (c.cell, s)).collect();
    let costs: HashMap<usize, &Pareto> = tables.pareto.iter().map(|(c, p)| (c.cell, p)).collect();
    let has_conditions = answer.findings.len() > 1;
    let given = match has_conditions {
        true => "<th scope=\"col\">with</th>",
        false => "",
    };
    let mut html = format!(
        "<p class=\"quiet\">“As good” means that the mean accuracy lies within the 95 % interval of the most accurate cell of the same \
         condition: noise and sensor errors are given, not chosen. Times are of this machine, its touches measured.</p>\
         <div class=\"wide words\" tabindex=\"0\" role=\"region\" aria-label=\"What to choose\"><table><thead><tr>{given}\
         <th scope=\"col\">if you want</th><th scope=\"col\">choose</th>\
         <th scope=\"col\" class=\"number\">accuracy [95 %]</th><th scope=\"col\" class=\"number\">a decision</th>\
         <th scope=\"col\" class=\"number\">to train</th></tr></thead><tbody>"
    );
    for finding in &answer.findings {
        for (reasons, cell) in choices(tables, answer, finding) {
            let score = scores.get(&cell.cell).map(|score| accuracy_sentence(score));
            let cost = costs.get(&cell.cell);
            let decide = cost.map(|cost| time_words(1e-6 * cost.predict_us_per_decision));
            let fit = cost.map(|cost| time_words(cost.fit_s));
            let given = match has_conditions {
                true => format!("<td>{}</td>", escape(&finding.condition)),
                false => String::new(),
            };
            let _ = write!(
                html,
                "<tr>{given}<td>{}</td><td>{} (cell {})</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
                 <td class=\"number\">{}</td></tr>",
                reasons.join("; "),
                unbroken(&answer.settings().choice_words(cell)),
                cell.cell,
                score.unwrap_or_default(),
                decide.unwrap_or_default(),
                fit.unwrap_or_default()
            );
        }
    }
    html += "</tbody></table></div>";
    match answer.findings.len() {
        n if n > MOST_OPEN => {
            format!("<details><summary>In each of {n} conditions</summary>{html}</details>")
        }
        _ => html,
    }
}

/// Among the cells of a condition, each once.
fn choices<'a>(tables: &'a Tables, answer: &'a Answer, finding: &'a Finding) -> Vec<Choice<'a>> {
    let best = &finding.best.0;
    let is_of_it = |cell: &Cell| std::ptr::eq(answer.finding(cell), finding);
    let good: Vec<&(Cell, Pareto)> = tables
        .pareto
        .iter()
        .filter(|(cell, row)| finding.is_as_good(row.accuracy) && is_of_it(cell))
        .collect();
    let fastest = |cost: fn(&Pareto) -> f64| {
        let costs = good.iter().map(|(cell, row)| (cell, cost(row)));
        let found = costs.min_by(|(_, a), (_, b)| a.total_cmp(b));
        found.map(|(cell, _)| cell)
    };
    let to_decide = fastest(|row| row.predict_us_per_decision);
    let to_train = fastest(|row| row.fit_s);
    let reasons = [
        ("the highest accuracy", Some(best)),
        ("as good, fastest to decide", to_decide),
        ("as good, fastest to train", to_train),
        ("as good, fewest measurements", Some(&finding.frugal.0)),
    ];
    let mut found: Vec<Choice> = Vec::new();
    for (reason, cell) in reasons {
        let Some(cell) = cell else { continue };
        match found.iter_mut().find(|(_, known)| known.cell == cell.cell) {
            Some((reasons, _)) => reasons.push(reason),
            None => found.push((vec![reason], cell)),
        }
    }
    found
}
