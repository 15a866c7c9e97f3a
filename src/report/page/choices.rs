//! What to choose: the most accurate cell, and the cheapest of those that reach its interval.

use crate::report::answer::{Answer, accuracy_sentence};
use crate::report::page::frame::unbroken;
use crate::report::time_scale::time_words;
use crate::study::table::{Cell, CellScore, Pareto, Tables};
use std::collections::HashMap;
use std::fmt::Write;

/// A reason to choose a cell, and the cell.
type Choice<'a> = (&'static str, &'a Cell);

/// A table of choices; empty for a study of one cell.
pub(super) fn choices_html(tables: &Tables, answer: &Answer) -> String {
    if tables.summary.len() < 2 {
        return String::new();
    }
    let scores: HashMap<usize, &CellScore> =
        tables.summary.iter().map(|(c, s)| (c.cell, s)).collect();
    let costs: HashMap<usize, &Pareto> = tables.pareto.iter().map(|(c, p)| (c.cell, p)).collect();
    let mut html = "<p class=\"quiet\">“As good” means that the mean accuracy lies within the 95 % interval of the most accurate \
         cell; noise and imperfections are those of that cell; times are of this machine, its touches measured.</p><div class=\"wide words\" tabindex=\"0\" role=\"region\" \
         aria-label=\"What to choose\"><table><thead><tr><th scope=\"col\">if you want</th><th scope=\"col\">choose</th>\
         <th scope=\"col\" class=\"number\">accuracy [95 %]</th><th scope=\"col\" class=\"number\">a decision</th>\
         <th scope=\"col\" class=\"number\">to train</th></tr></thead><tbody>"
        .to_owned();
    for (reason, cell) in choices(tables, answer) {
        let score = scores.get(&cell.cell).map(|score| accuracy_sentence(score));
        let cost = costs.get(&cell.cell);
        let decide = cost.map(|cost| time_words(1e-6 * cost.predict_us_per_decision));
        let fit = cost.map(|cost| time_words(cost.fit_s));
        let _ = write!(
            html,
            "<tr><td>{reason}</td><td>{} (cell {})</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td></tr>",
            unbroken(&answer.place(cell)),
            cell.cell,
            score.unwrap_or_default(),
            decide.unwrap_or_default(),
            fit.unwrap_or_default()
        );
    }
    html + "</tbody></table></div>"
}

/// Among cells of the best one's noise and imperfections, which nobody chooses.
fn choices<'a>(tables: &'a Tables, answer: &'a Answer) -> Vec<Choice<'a>> {
    let (best, score) = &answer.best;
    let world = |cell: &Cell| (cell.noise_std, cell.strengths());
    let good: Vec<&(Cell, Pareto)> = tables
        .pareto
        .iter()
        .filter(|(cell, row)| row.accuracy >= score.accuracy_low && world(cell) == world(best))
        .collect();
    let cheapest = |cost: fn(&Cell, &Pareto) -> f64| {
        let costs = good.iter().map(|(cell, row)| (cell, cost(cell, row)));
        let found = costs.min_by(|(_, a), (_, b)| a.total_cmp(b));
        found.map(|(cell, _)| cell)
    };
    let mut found = vec![("the highest accuracy", best)];
    let fastest = cheapest(|_, row| row.predict_us_per_decision);
    found.extend(fastest.map(|cell| ("as good, fastest to decide", cell)));
    let trained = cheapest(|_, row| row.fit_s);
    found.extend(trained.map(|cell| ("as good, fastest to train", cell)));
    let frugal = cheapest(|cell, _| cell.measurements as f64);
    let frugal = frugal.filter(|cell| cell.measurements < best.measurements);
    found.extend(frugal.map(|cell| ("as good, fewest measurements", cell)));
    found
}
