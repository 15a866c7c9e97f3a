//! `bubbletouch advise`: which setting to take.

use super::streams::say;
use bubbletouch::Result;
use bubbletouch::report::offers::read_offers;
use bubbletouch::study::advice::{Advice, Wish, advise as choose, cost_in_words};
use std::path::PathBuf;

/// Say which setting is the cheapest that is accurate enough, or the most accurate that is cheap enough.
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
    /// Answer in JSON
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
#[group(required = true, multiple = false)]
struct WishArgs {
    /// The share of right decisions that is needed, such as 0.9
    #[arg(long, value_name = "SHARE")]
    accuracy: Option<f64>,
    /// What a decision may cost, microseconds
    #[arg(long, value_name = "US")]
    budget_us: Option<f64>,
}

impl WishArgs {
    fn wish(&self) -> Wish {
        match (self.accuracy, self.budget_us) {
            (Some(share), _) => Wish::Accuracy(share),
            (None, us) => Wish::BudgetUs(us.unwrap_or(f64::NAN)),
        }
    }
}

pub fn advise(args: &Args) -> Result<()> {
    let offers = read_offers(&args.results)?;
    let advice = choose(&offers, args.wish.wish())?;
    match args.json {
        true => say(serde_json::json!(advice)),
        false => say(in_words(&advice)),
    }
}

fn in_words(advice: &Advice) -> String {
    let Advice {
        choice,
        certain,
        next_up,
    } = advice;
    let mut text = choice.setting.clone();
    text += &format!(
        "\n  right in {:.3} of the decisions (95 % interval {:.3} to {:.3}), {} each",
        choice.accuracy,
        choice.accuracy_low,
        choice.accuracy_high,
        cost_in_words(choice.cost_us)
    );
    if let Some(certain) = certain {
        text += &format!("\nWith the whole interval above: {}", certain.in_words());
    }
    match next_up {
        Some(next) => {
            text += &format!(
                "\nThe next step up gains {:.3} and costs {} more ({:.1} times as much): {}",
                next.accuracy - choice.accuracy,
                cost_in_words(next.cost_us - choice.cost_us),
                next.cost_us / choice.cost_us,
                next.in_words()
            );
        }
        None => text += "\nNothing here is more accurate",
    }
    text
}
