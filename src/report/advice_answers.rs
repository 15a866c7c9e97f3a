//! Answers of `bubbletouch advise`: advice for each condition, as text and as JSON.

use super::advice::{Advice, Candidate, Candidates, Requirement};
use crate::error::{Error, Result};

/// Advice for one condition, or the reason why no advice exists.
pub struct Answer {
    /// Condition as text; empty if the table has only one condition.
    pub condition: String,
    /// Advice for the condition, or an error that contains the requirement and the nearest candidate.
    pub advice: Result<Advice>,
}

/// Returns the advice under each condition, or the reason why there is none. If `worst` is true, returns a single answer that is based on the worst value of
/// each choice over all conditions.
///
/// # Errors
/// If no condition has advice; returns the error of the first condition.
pub fn answers(offers: &Candidates, wish: Requirement, worst: bool) -> Result<Vec<Answer>> {
    let conditions = offers.by_condition();
    let answer = |condition: String, choices: &[Candidate]| Answer {
        condition,
        advice: offers.advise(choices, wish),
    };
    let answers: Vec<Answer> = if worst && conditions.len() > 1 {
        let words = format!("the worst of {} conditions", conditions.len());
        vec![answer(words, &offers.worst())]
    } else {
        let answer = |choices: &Vec<Candidate>| answer(offers.condition(&choices[0]), choices);
        conditions.iter().map(answer).collect()
    };
    if answers.iter().any(|answer| answer.advice.is_ok()) {
        return Ok(answers);
    }
    // Only the error of the first condition is returned.
    let first = answers.into_iter().next();
    let Some((condition, Err(refused))) = first.map(|first| (first.condition, first.advice)) else {
        let given = "no choice whose value and cost are known";
        return Err(Error::input(offers.table.file, given, "at least one"));
    };
    Err(match condition.is_empty() {
        true => refused,
        false => refused.under(format!("with {condition}: ")),
    })
}

/// Returns the answers as JSON: the table, its value and cost columns, and the advised choices for each condition.
pub fn answers_json(offers: &Candidates, answers: &[Answer]) -> serde_json::Value {
    let in_json = |offer: &Candidate| offers.json(offer);
    let answers = answers
        .iter()
        .map(|Answer { condition, advice }| match advice {
            Ok(advice) => serde_json::json!({
                "condition": condition,
                "choice": in_json(&advice.choice),
                "certain": advice.certain.as_ref().map(in_json),
                "next_up": advice.next_up.as_ref().map(in_json),
            }),
            Err(refused) => {
                serde_json::json!({ "condition": condition, "refused": refused.to_string() })
            }
        });
    serde_json::json!({
        "table": offers.table.file,
        "value": offers.value.name,
        "cost": offers.cost.name,
        "answers": answers.collect::<Vec<_>>(),
    })
}
