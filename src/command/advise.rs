//! `bubbletouch advise`: which setting to take.

use crate::command::terminal::streams::say;
use bubbletouch::report::advice::{Advice, AdviceQuery, Candidates, Requirement};
use bubbletouch::report::advice_answers::{Answer, answers, answers_json};
use bubbletouch::{Result, kinds};
use std::path::PathBuf;

/// List the cheapest configuration that meets all requirements, or the best one
///
/// All requirements are filters of one Pareto front of value and cost. With --accuracy or --reach the answer is the cheapest configuration
/// that is good enough; without them it is the best one that the limits (--budget, --max-…) allow.
///
/// Noise, sensor errors and other properties of the world are conditions, not choices: there is an answer for each condition of a study,
/// for those that are given, or for the worst.
///
/// It reads the results of a study of any kind: the first table whose rows are choices with a value and a cost. Of a study that recognises
/// objects this is the table of all configurations, with the times of the classifier alone. Accuracies are those of simulated touches,
/// times those of the machine that ran the study.
#[derive(clap::Args)]
pub struct Args {
    /// A folder of results
    #[arg(default_value = "results/quickstart")]
    results: PathBuf,
    #[command(flatten)]
    wish: WishArgs,
    /// The cost to keep small: decision_time, training_time, taxels, measurements (of a decision), or any column of costs [default:
    /// decision_time, or the first cost of the table]
    #[arg(long, value_name = "COST")]
    cost: Option<String>,
    /// The column of values to judge by [default: accuracy, or the first value of the table]
    #[arg(long, value_name = "COLUMN", conflicts_with = "accuracy")]
    value: Option<String>,
    /// The table to read, by its file's name, if several have choices
    #[arg(long, value_name = "FILE")]
    table: Option<String>,
    /// Only where a condition has this value: noise=0.05, "noise=5 %", test_sensor=another_skin, none where it has no value; as often as needed
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
#[group(required = true, multiple = true)]
struct WishArgs {
    /// The share of right decisions that is needed, such as 0.9
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    accuracy: Option<f64>,
    /// The value that is needed, in the unit of its column: at least so much, or at most where less is better
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        conflicts_with = "accuracy"
    )]
    reach: Option<f64>,
    /// The largest --cost, in the unit of its column: microseconds a decision, seconds to train, taxels, measurements …
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    budget: Option<f64>,
    /// The most measurements of a decision
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_measurements: Option<f64>,
    /// The most taxels
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_taxels: Option<f64>,
    /// The longest time of a decision, milliseconds
    #[arg(long, value_name = "MS", allow_negative_numbers = true)]
    max_answer_ms: Option<f64>,
    /// The longest time to train, seconds
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    max_training_s: Option<f64>,
}

/// Refuses an option by a name that it has no more.
fn renamed(_: &str) -> std::result::Result<f64, String> {
    Err("it is called --budget, in the unit of --cost (microseconds a decision if that is left out)".to_owned())
}

pub fn advise(args: &Args) -> Result<()> {
    let place = format!("{}: ", args.results.display());
    let (_, tables) = kinds::read_tables(&args.results)?;
    let asked = AdviceQuery {
        table: args.table.clone(),
        value: match args.wish.accuracy {
            Some(_) => Some("accuracy".to_owned()),
            None => args.value.clone(),
        },
        cost: args.cost.clone(),
        given: args.given.clone(),
        limits: args.limits(),
    };
    let offers = Candidates::new(&tables, &asked).map_err(|error| error.under(place))?;
    let answers = answers(&offers, args.requirement(), args.worst)?;
    match args.json {
        true => say(answers_json(&offers, &answers)),
        false => {
            let texts = answers.iter().map(|answer| args.in_words(&offers, answer));
            say(texts.collect::<Vec<_>>().join("\n\n"))
        }
    }
}

impl Args {
    fn requirement(&self) -> Requirement {
        match (self.wish.accuracy.or(self.wish.reach), self.wish.budget) {
            (Some(value), _) => Requirement::Value(value),
            (None, Some(most)) => Requirement::Budget(most),
            (None, None) => Requirement::Best,
        }
    }

    /// Returns the limits of columns of costs, in the units of the columns.
    fn limits(&self) -> Vec<(String, f64)> {
        let wish = &self.wish;
        // Beside a value, the budget is one more filter.
        let has_value = wish.accuracy.or(wish.reach).is_some();
        let cost = self.cost.as_deref().unwrap_or("decision_time");
        let limits = [
            (cost, wish.budget.filter(|_| has_value)),
            ("measurements", wish.max_measurements),
            ("taxels", wish.max_taxels),
            ("decision_time", wish.max_answer_ms.map(|ms| 1e3 * ms)),
            ("training_time", wish.max_training_s),
        ];
        let given = limits.into_iter();
        let given = given.filter_map(|(name, most)| Some((name.to_owned(), most?)));
        given.collect()
    }

    fn in_words(&self, offers: &Candidates, Answer { condition, advice }: &Answer) -> String {
        let head = match &condition[..] {
            "" => String::new(),
            words => format!("With {words}:\n"),
        };
        match advice {
            Ok(advice) => head + &self.advice_in_words(offers, advice),
            Err(refused) => format!("{head}nothing: {refused}"),
        }
    }

    fn advice_in_words(&self, offers: &Candidates, advice: &Advice) -> String {
        let choice = &advice.choice;
        let mut text = offers.setting(choice);
        // That of the worst of several conditions says which.
        let condition = offers.condition(choice);
        if self.worst && !condition.is_empty() {
            text += &format!("\n  worst with {condition}");
        }
        text += &format!("\n  {}", offers.gives(choice));
        if let Some(certain) = &advice.certain {
            let certain = offers.in_words(certain);
            text += &format!("\nWith the whole interval good enough: {certain}");
        }
        let Some(next) = &advice.next_up else {
            return text + "\nNothing here is better";
        };
        let gain = offers.value_words((next.value - choice.value).abs());
        let cost = offers.cost.number_words(next.cost - choice.cost);
        let (times, next) = (next.cost / choice.cost, offers.in_words(next));
        text + &format!(
            "\nThe next step up gains {gain} and costs {cost} more ({times:.1} times as much): {next}"
        )
    }
}
