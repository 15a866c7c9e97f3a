//! Advice condition by condition: what the command says, and what programs read.

use super::advice::{Advice, Offer, Offers, Wish};
use crate::error::{Error, Result};

/// What is advised in a condition, or why nothing is.
pub struct Answer {
    /// In words; empty where there is one.
    pub condition: String,
    /// The advice, or what is wished that no choice gives.
    pub advice: Result<Advice>,
}

/// An answer a condition; with `worst` one for all, from each choice in the condition where its value is worst.
///
/// # Errors
/// There is advice in no condition: what the first says.
pub fn answers(offers: &Offers, wish: Wish, worst: bool) -> Result<Vec<Answer>> {
    let conditions = offers.by_condition();
    let answer = |condition: String, choices: &[Offer]| Answer {
        condition,
        advice: offers.advise(choices, wish),
    };
    let answers: Vec<Answer> = if worst && conditions.len() > 1 {
        let words = format!("the worst of {} conditions", conditions.len());
        vec![answer(words, &offers.worst())]
    } else {
        let answer = |choices: &Vec<Offer>| answer(offers.condition(&choices[0]), choices);
        conditions.iter().map(answer).collect()
    };
    if answers.iter().any(|answer| answer.advice.is_ok()) {
        return Ok(answers);
    }
    // Of several conditions the first speaks for all.
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

/// The answers for programs: the table, its columns of value and cost, and of each condition its choices with every column by name.
pub fn answers_json(offers: &Offers, answers: &[Answer]) -> serde_json::Value {
    let in_json = |offer: &Offer| offers.json(offer);
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
