//! Page section "What to choose": Pareto fronts of the table with choices, values and costs.

use crate::report::advice::{AdviceQuery, Candidates};
use crate::report::pictures::drawing::escape;
use crate::report::study_content::Found;

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
    let fronts = conditions.iter().flat_map(|of_one| offers.front(of_one));
    // With one condition, the table has no column for it.
    let first = usize::from(conditions.len() < 2);
    let line = |tag: &str, cells: [String; 4]| {
        let classes = [" class=word", "", "", " class=word"];
        let cells = cells.iter().zip(classes).skip(first);
        let cells = cells.map(|(cell, class)| format!("<{tag}{class}>{}</{tag}>", escape(cell)));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    let [value, cost] = [&offers.value.words, &offers.cost.words].map(|words| words.to_string());
    let label = format!("Pareto front: {} and {}", escape(&value), escape(&cost));
    let head = line(
        "th",
        ["condition".to_owned(), value, cost, "choice".to_owned()],
    );
    let rows = fronts.map(|offer| {
        let value = offers.table.bounded(offers.value, offer.row);
        let cost = offers.cost.number_words(offer.cost);
        line(
            "td",
            [
                offers.condition(&offer),
                value,
                cost,
                offers.setting(&offer),
            ],
        )
    });
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{label}\"><table><thead>{head}</thead><tbody>\n{}</tbody></table></div>",
        rows.collect::<String>()
    )
}
