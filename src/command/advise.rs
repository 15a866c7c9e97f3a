//! `bubbletouch advise`: which setting to take.

use super::classify::word;
use super::streams::say;
use bubbletouch::report::offers::{Given, read_offers};
use bubbletouch::study::advice::{
    Advice, Cost, Offer, Wish, advise as choose, by_condition, worst_of,
};
use bubbletouch::{Error, Result};
use std::path::PathBuf;

/// Say which setting is the cheapest that is accurate enough, or the most accurate that is cheap enough.
///
/// Noise, sensor errors and whatever else the world sets are conditions, not choices: each condition of a study is answered for, or
/// those that are given, or the worst.
///
/// It reads what a run measured: `pareto.csv` of a study of what accuracy costs, or `pareto.csv` and `summary.csv` of a study that
/// recognises objects (whose times are those of the classifier alone). Accuracies are of simulated touches, times of the machine that
/// measured.
#[derive(clap::Args)]
pub struct Args {
    /// A folder of results
    #[arg(default_value = "results/speed_accuracy")]
    results: PathBuf,
    #[command(flatten)]
    wish: WishArgs,
    /// What is to be small: decision_time, training_time, taxels or measurements (of a decision)
    #[arg(long, value_name = "COST", default_value = "decision_time", value_parser = word::<Cost>)]
    cost: Cost,
    /// Only where a condition has this value: noise=0.05, gain_std=0.2, tested_on=another_skin; as often as needed
    #[arg(long, value_name = "CONDITION=VALUE")]
    given: Vec<String>,
    /// One answer for all conditions: each choice counts as accurate as in the condition that is worst for it
    #[arg(long)]
    worst: bool,
    /// Answer in JSON
    #[arg(long)]
    json: bool,
    /// The name that --budget had
    #[arg(long, hide = true, value_parser = renamed)]
    budget_us: Option<f64>,
}

#[derive(clap::Args)]
#[group(required = true, multiple = false)]
struct WishArgs {
    /// The share of right decisions that is needed, such as 0.9
    #[arg(long, value_name = "SHARE")]
    accuracy: Option<f64>,
    /// How much it may cost: microseconds a decision, seconds to train, taxels, or measurements a decision
    #[arg(long, value_name = "N")]
    budget: Option<f64>,
}

/// Refuses an option by a name that it has no more.
fn renamed(_: &str) -> std::result::Result<f64, String> {
    Err("it is called --budget, in the unit of --cost (microseconds a decision if that is left out)".to_owned())
}

impl WishArgs {
    fn wish(&self) -> Wish {
        match (self.accuracy, self.budget) {
            (Some(share), _) => Wish::Accuracy(share),
            (None, most) => Wish::Budget(most.unwrap_or(f64::NAN)),
        }
    }
}

/// What is advised in a condition, or why nothing is.
struct Answer {
    condition: String,
    advice: Result<Advice>,
}

pub fn advise(args: &Args) -> Result<()> {
    let given = args.given.iter().map(|text| Given::parse(text));
    let offers = read_offers(&args.results, &given.collect::<Result<Vec<_>>>()?)?;
    let answers = args.answers(&offers)?;
    match args.json {
        true => say(args.json_of(&answers)),
        false => {
            let texts: Vec<String> = answers.iter().map(|answer| args.in_words(answer)).collect();
            say(texts.join("\n\n"))
        }
    }
}

impl Args {
    /// An answer a condition; an error if there is advice in none.
    fn answers(&self, offers: &[Offer]) -> Result<Vec<Answer>> {
        let answer = |condition: String, offers: &[Offer]| Answer {
            condition,
            advice: choose(offers, self.wish.wish(), self.cost),
        };
        let conditions = by_condition(offers);
        let mut answers: Vec<Answer> = match self.worst {
            true => {
                let words = match conditions.len() {
                    1 => conditions[0][0].condition.clone(),
                    n => format!("the worst of {n} conditions"),
                };
                vec![answer(words, &worst_of(offers))]
            }
            false => conditions
                .iter()
                .map(|offers| answer(offers[0].condition.clone(), offers))
                .collect(),
        };
        match answers.iter().any(|answer| answer.advice.is_ok()) {
            true => Ok(answers),
            false if answers.is_empty() => Err(Error::input(
                self.results.display(),
                "no settings",
                "at least one",
            )),
            false => {
                // Of several conditions the first speaks for all.
                let Answer { condition, advice } = answers.swap_remove(0);
                let refused = advice.map(|_| ()).expect_err("there is advice in none");
                Err(match &condition[..] {
                    "" => refused,
                    words => refused.under(format!("with {words}: ")),
                })
            }
        }
    }

    fn json_of(&self, answers: &[Answer]) -> serde_json::Value {
        let answers = answers
            .iter()
            .map(|Answer { condition, advice }| match advice {
                Ok(advice) => serde_json::json!({
                    "condition": condition,
                    "choice": advice.choice,
                    "certain": advice.certain,
                    "next_up": advice.next_up,
                }),
                Err(refused) => {
                    serde_json::json!({ "condition": condition, "refused": refused.to_string() })
                }
            });
        serde_json::json!({ "cost": self.cost, "answers": answers.collect::<Vec<_>>() })
    }

    fn in_words(&self, Answer { condition, advice }: &Answer) -> String {
        let head = match &condition[..] {
            "" => String::new(),
            words => format!("With {words}:\n"),
        };
        match advice {
            Ok(advice) => head + &self.advice_in_words(advice),
            Err(refused) => format!("{head}nothing: {refused}"),
        }
    }

    fn advice_in_words(&self, advice: &Advice) -> String {
        let Advice {
            choice,
            certain,
            next_up,
        } = advice;
        let cost = self.cost;
        let mut text = choice.setting.clone();
        // That of the worst of several conditions says which.
        if self.worst && !choice.condition.is_empty() {
            text += &format!("\n  worst with {}", choice.condition);
        }
        text += &format!(
            "\n  right in {:.3} of the decisions (95 % interval {:.3} to {:.3}), {}",
            choice.accuracy,
            choice.accuracy_low,
            choice.accuracy_high,
            cost.in_words(cost.of(choice))
        );
        if let Some(certain) = certain {
            text += &format!(
                "\nWith the whole interval above: {}",
                certain.in_words(cost)
            );
        }
        match next_up {
            Some(next) => {
                let (more, now) = (cost.of(next), cost.of(choice));
                text += &format!(
                    "\nThe next step up gains {:.3} and costs {} more ({:.1} times as much): {}",
                    next.accuracy - choice.accuracy,
                    cost.in_words(more - now),
                    more / now,
                    next.in_words(cost)
                );
            }
            None => text += "\nNothing here is more accurate",
        }
        text
    }
}
