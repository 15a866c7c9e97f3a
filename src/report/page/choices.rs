//! Page section "What to choose": Pareto fronts of the table with choices, values and costs.

use crate::report::advice::{AdviceQuery, Candidate, Candidates};
use crate::report::pictures::drawing::escape;
use crate::report::study_content::Found;
use crate::table::Value;

/// Maximum number of rows that are listed for each Pareto front.
const MAX_ROWS: usize = 200;

/// Returns an HTML table of the best choices. For each condition, the table lists the choices that are better than all choices of equal or
/// lower cost. The HTML is empty if no table has choices with costs.
pub(crate) fn choices_html(found: &Found) -> String {
    let Ok(offers) = Candidates::new(found.tables, &AdviceQuery::default()) else {
        return String::new();
    };
    let (table, value) = (offers.table, offers.value);
    if !table.compares_choices() {
        return String::new();
    }
    format!(
        "<p class=\"quiet\">The Pareto front of “{}”: each row reaches its {} for the least {}. Each condition of the world has a front of its own. \
         <code>bubbletouch advise</code> selects a row by a value, a budget or another cost.</p>{}",
        escape(table.title),
        escape(&value.words),
        escape(&offers.cost.words),
        front_html(&offers)
    )
}

fn front_html(offers: &Candidates) -> String {
    let conditions = offers.by_condition();
    let has_conditions = conditions.len() > 1;
    let fronts: Vec<Candidate> = conditions
        .iter()
        .flat_map(|of_one| offers.front(of_one))
        .collect();
    let row = |offer: &Candidate| {
        let condition = match has_conditions {
            true => format!("<td class=word>{}</td>", escape(&offers.condition(offer))),
            false => String::new(),
        };
        format!(
            "<tr>{condition}<td>{}</td><td>{}</td><td class=word>{}</td></tr>\n",
            escape(&offers.table.bounded(offers.value, offer.row)),
            escape(&offers.cost.value_words(&Value::Number(offer.cost))),
            escape(&offers.setting(offer))
        )
    };
    let rows: String = fronts.iter().take(MAX_ROWS).map(row).collect();
    let condition = match has_conditions {
        true => "<th scope=\"col\" class=\"word\">condition</th>",
        false => "",
    };
    let more = match fronts.len() > MAX_ROWS {
        true => format!(
            "<p class=\"quiet\">The first {MAX_ROWS} of {} rows.</p>",
            fronts.len()
        ),
        false => String::new(),
    };
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Pareto front: {value} and {cost}\"><table><thead><tr>{condition}<th scope=\"col\">{value}</th>\
         <th scope=\"col\">{cost}</th><th scope=\"col\" class=\"word\">choice</th></tr></thead><tbody>\n{rows}</tbody></table></div>{more}",
        value = escape(&offers.value.words),
        cost = escape(&offers.cost.words),
    )
}
