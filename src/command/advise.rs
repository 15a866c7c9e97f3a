//! `bubbletouch advise`: recommends a setting that meets a requirement.

use crate::command::terminal::say;
use bubbletouch::report::advice::{
    Advice, AdviceQuery, Answer, Candidates, Requirement, answers, answers_json,
};
use bubbletouch::{Error, Result, kinds};
use bubbletouch_sim::text::spelling::counted;
use std::path::PathBuf;

/// Find the cheapest configuration that meets all requirements
///
/// All requirements filter one Pareto front of value and cost. With --accuracy or --reach, the answer is the cheapest configuration that reaches the
/// value. Otherwise it is the best configuration within the limits (--budget, --max-…).
///
/// Noise, sensor errors and other properties of the world are conditions, not choices. There is one answer for each condition, for the conditions of
/// --given, or for the worst (--worst). A condition that no configuration meets is named with the reason.
///
/// The command reads the first table of the folder whose rows are choices with a value and a cost. In a recognition study, this is the table of all
/// configurations, with the times of the classifier alone. Accuracies are of simulated touches, and times are of the machine that ran the study.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  bubbletouch advise results/quickstart --accuracy 0.9 --max-measurements 64"
)]
pub struct Args {
    /// Results folder
    #[arg(default_value = "results/quickstart")]
    results: PathBuf,
    #[command(flatten)]
    wish: RequirementArgs,
    #[command(flatten)]
    query: AdviceQuery,
    /// Give one answer that holds in every condition
    ///
    /// Each choice has the value of its worst condition.
    #[arg(long, help_heading = "Selection")]
    worst: bool,
    /// Print the answer as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

#[derive(clap::Args)]
#[command(next_help_heading = "Requirements")]
#[group(required = true, multiple = true)]
struct RequirementArgs {
    /// Require this fraction of correct decisions, such as 0.9
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    accuracy: Option<f64>,
    /// Require this value, in the unit of its column
    ///
    /// The value is a lower bound, or an upper bound if smaller values are better.
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        conflicts_with = "accuracy"
    )]
    reach: Option<f64>,
    /// Limit the cost, in the unit of its column
    ///
    /// For example microseconds per decision, seconds of training, taxels, or measurements.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    budget: Option<f64>,
    /// Limit the measurements of a decision
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_measurements: Option<f64>,
    /// Limit the number of taxels
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_taxels: Option<f64>,
    /// Limit the time of a decision
    #[arg(long, value_name = "MS", allow_negative_numbers = true)]
    max_answer_ms: Option<f64>,
    /// Limit the training time
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    max_training_s: Option<f64>,
}

pub fn advise(args: &Args) -> Result<()> {
    let place = format!("{}: ", args.results.display());
    let (_, tables) = kinds::read_tables(&args.results)?;
    let mut asked = args.query.clone();
    asked.limits = args.limits();
    if args.wish.accuracy.is_some() {
        asked.value = Some("accuracy".to_owned());
    }
    let said = |error: Error| error.under(place.clone());
    let mut offers = Candidates::new(&tables, &asked).map_err(said)?;
    // Together with a required value, the budget is a limit.
    if let (Requirement::Value(_), Some(most)) = (args.requirement(), args.wish.budget) {
        offers.limit(&offers.cost.name, most).map_err(said)?;
    }
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

    /// Returns the upper bounds of cost columns, in the units of the columns.
    fn limits(&self) -> Vec<(String, f64)> {
        let wish = &self.wish;
        let limits = [
            ("measurements", wish.max_measurements),
            ("taxels", wish.max_taxels),
            ("decision_time", wish.max_answer_ms.map(|ms| 1e3 * ms)),
            ("training_time", wish.max_training_s),
        ];
        let given = limits.into_iter();
        let given = given.filter_map(|(name, most)| Some((name.to_owned(), most?)));
        given.collect()
    }

    fn in_words(&self, offers: &Candidates, answer: &Answer) -> String {
        let head = match &answer.condition[..] {
            "" => String::new(),
            words => format!("With {words}:\n"),
        };
        let left_out = match answer.n_left_out {
            0 => String::new(),
            n => format!(
                "\n{} left out: not measured, or beyond a limit, in at least one condition",
                counted(n, "choice")
            ),
        };
        match &answer.advice {
            Ok(advice) => head + &self.advice_in_words(offers, advice) + &left_out,
            Err(refused) => format!("{head}no configuration: {refused}"),
        }
    }

    fn advice_in_words(&self, offers: &Candidates, advice: &Advice) -> String {
        let choice = &advice.choice;
        let mut text = offers.setting(choice);
        // With several conditions, the answer for the worst one names the condition.
        let condition = offers.condition(choice);
        if self.worst && !condition.is_empty() {
            text += &format!("\n  worst with {condition}");
        }
        text += &format!("\n  {}", offers.gives(choice));
        if let Some(certain) = &advice.certain {
            let certain = offers.in_words(certain);
            text += &format!("\nIf the whole interval must be good enough: {certain}");
        }
        let next = advice.next_up.as_ref().map(|next| offers.in_words(next));
        match next {
            Some(next) => text + &format!("\nThe next step up: {next}"),
            None => text + "\nNo configuration is better",
        }
    }
}
