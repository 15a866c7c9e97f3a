//! Answers of `bubbletouch advise`: advice for each condition, as text and as JSON.

use super::advice::{Advice, Candidate, Candidates, Requirement};
use crate::error::{Error, Result};

/// Advice for one condition, or the reason why no advice exists.
pub struct Answer {
    /// Condition as text; empty if the table has only one condition.
    pub condition: String,
    /// Advice for the condition, or an error that contains the requirement and the nearest candidate.
    pub advice: Result<Advice>,
    /// Number of choices that were not compared, because they were not measured or exceed a limit in at least one of several conditions.
    pub n_left_out: usize,
}

/// Returns the advice under each condition, or the reason why there is none. If `worst` is true, returns a single answer that is based on the worst value of
/// each choice over all conditions.
///
/// # Errors
/// If no condition has advice; returns the error of the first condition.
pub fn answers(offers: &Candidates, wish: Requirement, worst: bool) -> Result<Vec<Answer>> {
    let conditions = offers.conditions();
    let n = conditions.len();
    if worst && n > 1 {
        let (choices, n_left_out) = offers.worst()?;
        let condition = format!("the worst of {n} conditions");
        let advice = Ok(offers.advise(&choices, wish).map_err(|refused| {
            let best = offers.front(&choices).pop();
            let world = best.map_or_else(String::new, |best| offers.condition(&best));
            refused.under(format!("with {condition} ({world}): "))
        })?);
        return Ok(vec![Answer {
            condition,
            advice,
            n_left_out,
        }]);
    }
    let answers = conditions.into_iter().map(|(condition, choices)| Answer {
        condition,
        advice: offers.advise(&choices, wish),
        n_left_out: 0,
    });
    let answers: Vec<Answer> = answers.collect();
    if answers.iter().any(|answer| answer.advice.is_ok()) {
        return Ok(answers);
    }
    // Only the error of the first condition is returned.
    let first = answers.into_iter().next();
    let Some((condition, Err(refused))) = first.map(|first| (first.condition, first.advice)) else {
        let given = "no choice whose value and cost are known";
        return Err(Error::input(offers.table.file, given, "at least one"));
    };
    Err(match n {
        1 => refused,
        _ => refused.under(format!("in none of {n} conditions; with {condition}: ")),
    })
}

/// Returns the answers as JSON: the table, its value and cost columns, and the advised choices for each condition.
pub fn answers_json(offers: &Candidates, answers: &[Answer]) -> serde_json::Value {
    let in_json = |offer: &Candidate| offers.json(offer);
    let answers = answers.iter().map(
        |Answer {
             condition,
             advice,
             n_left_out,
         }| match advice {
            Ok(advice) => serde_json::json!({
                "condition": condition,
                "choice": in_json(&advice.choice),
                "certain": advice.certain.as_ref().map(in_json),
                "next_up": advice.next_up.as_ref().map(in_json),
                "n_left_out": n_left_out,
            }),
            Err(refused) => {
                serde_json::json!({ "condition": condition, "refused": refused.to_string() })
            }
        },
    );
    serde_json::json!({
        "table": offers.table.file,
        "value": offers.value.name,
        "cost": offers.cost.name,
        "answers": answers.collect::<Vec<_>>(),
    })
}
