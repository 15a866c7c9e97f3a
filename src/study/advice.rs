//! Advice: of settings that were measured in one condition of the world, the cheapest that is accurate enough, or the most accurate that
//! is cheap enough.

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// A setting, what it gives, and what it costs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// Its number in the study's tables; none where these have no cells.
    pub cell: Option<usize>,
    /// The choices in words.
    pub setting: String,
    /// The condition that it was measured in, in words; empty where a study has one.
    pub condition: String,
    /// What it costs.
    pub costs: Costs,
    /// Share of right decisions, 0 to 1.
    pub accuracy: f64,
    /// Lower end of its interval.
    pub accuracy_low: f64,
    /// Upper end of it.
    pub accuracy_high: f64,
}

/// What a setting costs; NaN for what is not known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Costs {
    /// Microseconds a decision.
    pub decision_us: f64,
    /// Seconds to train.
    pub training_s: f64,
    /// Taxels of the array.
    pub taxels: f64,
    /// Measurements a decision: of each frame of each fused touch.
    pub measurements: f64,
}

/// A cost that is to be small.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cost {
    /// Microseconds a decision.
    #[default]
    DecisionTime,
    /// Seconds to train.
    TrainingTime,
    /// Taxels of the array.
    Taxels,
    /// Measurements a decision.
    Measurements,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// At least this share of right decisions, more than 0 and at most 1, for as little as possible.
    Accuracy(f64),
    /// As many right decisions as possible for at most so much, positive, in the unit of the cost.
    Budget(f64),
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Advice {
    /// The cheapest setting whose accuracy is enough, or the most accurate that is cheap enough.
    pub choice: Offer,
    /// The cheapest setting whose whole interval is enough, where that is another than the choice and there is one.
    pub certain: Option<Offer>,
    /// The next setting of the front: the cheapest that is more accurate than the choice.
    pub next_up: Option<Offer>,
}

impl Cost {
    /// Of what a setting costs, this.
    pub fn of(self, offer: &Offer) -> f64 {
        let Costs {
            decision_us,
            training_s,
            taxels,
            measurements,
        } = offer.costs;
        match self {
            Self::DecisionTime => decision_us,
            Self::TrainingTime => training_s,
            Self::Taxels => taxels,
            Self::Measurements => measurements,
        }
    }

    /// So much of it: `210 µs a decision`, `64 measurements a decision`.
    pub fn in_words(self, cost: f64) -> String {
        match self {
            Self::DecisionTime => format!("{} a decision", cost_in_words(cost)),
            Self::TrainingTime => format!("{} to train", cost_in_words(1e6 * cost)),
            Self::Taxels => format!("{cost} taxels"),
            Self::Measurements => format!("{cost} measurements a decision"),
        }
    }
}

/// The settings that no other beats: each more accurate than all that cost as much or less. Cheapest first.
///
/// Of equals the first is kept. Offers with a number that is not finite have no place.
pub fn front(offers: &[Offer], cost: Cost) -> Vec<&Offer> {
    let mut sorted: Vec<&Offer> = finite(offers, cost).collect();
    // A stable sort: of equals the first stays first.
    sorted.sort_by(|a, b| cheaper(cost, a, b));
    let mut best = f64::NEG_INFINITY;
    sorted.retain(|offer| {
        let is_better = offer.accuracy > best;
        best = best.max(offer.accuracy);
        is_better
    });
    sorted
}

/// The cheaper first, of equal costs the more accurate.
fn cheaper(cost: Cost, a: &Offer, b: &Offer) -> std::cmp::Ordering {
    let by_cost = cost.of(a).total_cmp(&cost.of(b));
    by_cost.then(b.accuracy.total_cmp(&a.accuracy))
}

/// Answers a wish from what was measured in one condition.
///
/// # Errors
/// A wish out of its range; no offers; a wish that no offer fulfils: the error names the nearest.
pub fn advise(offers: &[Offer], wish: Wish, cost: Cost) -> Result<Advice> {
    let (place, given) = wish.in_words(cost);
    let refuse = |allowed: String| Error::input(place, &given, allowed);
    let (is_in_range, range) = match wish {
        Wish::Accuracy(share) => (share > 0.0 && share <= 1.0, "more than 0, at most 1"),
        Wish::Budget(most) => (most > 0.0 && most.is_finite(), "a positive number"),
    };
    if !is_in_range {
        return Err(refuse(range.to_owned()));
    }
    let front = front(offers, cost);
    let (Some(cheapest), Some(best)) = (front.first(), front.last()) else {
        return Err(refuse(
            "a table with at least one setting whose cost it says".to_owned(),
        ));
    };
    let place = match wish {
        Wish::Accuracy(share) => front.iter().position(|offer| offer.accuracy >= share),
        Wish::Budget(most) => front.iter().rposition(|offer| cost.of(offer) <= most),
    };
    let Some(place) = place else {
        return Err(refuse(match wish {
            Wish::Accuracy(_) => format!("at most {}", best.in_words(cost)),
            Wish::Budget(_) => format!("at least {}", cheapest.in_words(cost)),
        }));
    };
    let choice = front[place];
    let certain = match wish {
        Wish::Accuracy(share) => {
            // By place: costs that nobody knows are no numbers, which equal nothing.
            cheapest_certain(offers, share, cost).filter(|it| !std::ptr::eq(*it, choice))
        }
        Wish::Budget(_) => None,
    };
    Ok(Advice {
        choice: choice.clone(),
        certain: certain.cloned(),
        next_up: front.get(place + 1).map(|&offer| offer.clone()),
    })
}

/// Offers of each condition, in the order in which conditions first come.
pub fn by_condition(offers: &[Offer]) -> Vec<Vec<Offer>> {
    let mut conditions: Vec<Vec<Offer>> = Vec::new();
    for offer in offers {
        let known = conditions
            .iter_mut()
            .find(|known| known[0].condition == offer.condition);
        match known {
            Some(known) => known.push(offer.clone()),
            None => conditions.push(vec![offer.clone()]),
        }
    }
    conditions
}

/// Each choice in the condition where it is least accurate, at the most that it costs in any: what it gives whichever condition comes.
/// Choices that were not measured in every condition are left out.
pub fn worst_of(offers: &[Offer]) -> Vec<Offer> {
    let n_conditions = by_condition(offers).len();
    let mut settings: Vec<Vec<&Offer>> = Vec::new();
    for offer in offers {
        let known = settings
            .iter_mut()
            .find(|known| known[0].setting == offer.setting);
        match known {
            Some(known) => known.push(offer),
            None => settings.push(vec![offer]),
        }
    }
    settings.retain(|measured| measured.len() == n_conditions);
    let worst = settings.iter().filter_map(|measured| {
        let worst = measured
            .iter()
            .min_by(|a, b| a.accuracy.total_cmp(&b.accuracy))?;
        let most = |cost: Cost| measured.iter().map(|o| cost.of(o)).fold(f64::NAN, f64::max);
        let costs = Costs {
            decision_us: most(Cost::DecisionTime),
            training_s: most(Cost::TrainingTime),
            taxels: most(Cost::Taxels),
            measurements: most(Cost::Measurements),
        };
        Some(Offer {
            costs,
            ..(*worst).clone()
        })
    });
    worst.collect()
}

fn cheapest_certain(offers: &[Offer], share: f64, cost: Cost) -> Option<&Offer> {
    let enough = finite(offers, cost).filter(|offer| offer.accuracy_low >= share);
    enough.min_by(|a, b| cheaper(cost, a, b))
}

fn finite(offers: &[Offer], cost: Cost) -> impl Iterator<Item = &Offer> {
    let is_finite = move |offer: &&Offer| cost.of(offer).is_finite() && offer.accuracy.is_finite();
    offers.iter().filter(is_finite)
}

impl Wish {
    /// What is asked for, and how much of it.
    fn in_words(self, cost: Cost) -> (&'static str, String) {
        match self {
            Self::Accuracy(share) => ("accuracy", share.to_string()),
            Self::Budget(most) => match cost {
                Cost::DecisionTime => ("budget", format!("{most} µs a decision")),
                Cost::TrainingTime => ("budget", format!("{most} s to train")),
                Cost::Taxels | Cost::Measurements => ("budget", cost.in_words(most)),
            },
        }
    }
}

impl Offer {
    /// `0.83 (0.80 to 0.86) for 210 µs a decision: RBF SVM, 64 measurements`.
    pub fn in_words(&self, cost: Cost) -> String {
        let Self {
            setting,
            accuracy,
            accuracy_low,
            accuracy_high,
            ..
        } = self;
        let cost = cost.in_words(cost.of(self));
        format!("{accuracy:.3} ({accuracy_low:.3} to {accuracy_high:.3}) for {cost}: {setting}")
    }
}

/// Microseconds in the unit that suits them, to three digits.
pub fn cost_in_words(us: f64) -> String {
    let (number, unit) = match us {
        us if us < 1e3 => (us, "µs"),
        us if us < 1e6 => (1e-3 * us, "ms"),
        us => (1e-6 * us, "s"),
    };
    let digits = match number {
        n if n < 10.0 => 2,
        n if n < 100.0 => 1,
        _ => 0,
    };
    format!("{number:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offer(setting: &str, cost: f64, accuracy: f64, half_width: f64) -> Offer {
        Offer {
            cell: None,
            setting: setting.to_owned(),
            condition: String::new(),
            costs: Costs {
                decision_us: cost,
                training_s: 1.0,
                taxels: 300.0 - cost,
                measurements: f64::NAN,
            },
            accuracy,
            accuracy_low: accuracy - half_width,
            accuracy_high: accuracy + half_width,
        }
    }

    fn offers() -> Vec<Offer> {
        vec![
            offer("dear and worse", 90.0, 0.70, 0.01),
            offer("middle", 50.0, 0.91, 0.03),
            offer("cheap", 10.0, 0.60, 0.02),
            offer("best", 200.0, 0.97, 0.01),
            offer("certain", 60.0, 0.905, 0.004),
            offer("as good as the middle", 50.0, 0.91, 0.03),
        ]
    }

    const TIME: Cost = Cost::DecisionTime;

    #[test]
    fn nothing_beats_a_setting_of_the_front_and_something_beats_every_other() {
        let offers = offers();
        let front = front(&offers, TIME);
        let names: Vec<&str> = front.iter().map(|offer| offer.setting.as_str()).collect();
        assert_eq!(names, ["cheap", "middle", "best"]);
        for offer in &offers {
            let is_no_better_than =
                |on: &&Offer| TIME.of(on) <= TIME.of(offer) && on.accuracy >= offer.accuracy;
            assert!(front.iter().any(is_no_better_than), "{}", offer.setting);
        }
    }

    #[test]
    fn the_cheapest_that_is_accurate_enough_is_advised_with_the_certain_one_and_the_next() {
        let advice = advise(&offers(), Wish::Accuracy(0.9), TIME).unwrap();
        assert_eq!(advice.choice.setting, "middle");
        assert_eq!(advice.certain.unwrap().setting, "certain");
        assert_eq!(advice.next_up.unwrap().setting, "best");
        let advice = advise(&offers(), Wish::Accuracy(0.95), TIME).unwrap();
        assert_eq!(advice.choice.setting, "best");
        assert_eq!((advice.certain, advice.next_up), (None, None));
    }

    #[test]
    fn another_cost_is_another_answer_and_one_that_nobody_knows_is_refused() {
        let advised = |cost| advise(&offers(), Wish::Accuracy(0.65), cost);
        assert_eq!(advised(TIME).unwrap().choice.setting, "middle");
        assert_eq!(advised(Cost::Taxels).unwrap().choice.setting, "best");
        assert_eq!(advised(Cost::TrainingTime).unwrap().choice.setting, "best");
        assert!(advised(Cost::Measurements).is_err());
    }

    #[test]
    fn the_best_within_a_budget_is_advised_and_a_budget_is_a_limit_that_may_be_reached() {
        for (budget, choice) in [(10.0, "cheap"), (49.9, "cheap"), (199.0, "middle")] {
            let advice = advise(&offers(), Wish::Budget(budget), TIME).unwrap();
            assert_eq!(advice.choice.setting, choice, "{budget}");
        }
    }

    #[test]
    fn the_worst_condition_of_each_choice_is_where_it_is_least_accurate_and_what_it_costs_at_most()
    {
        let at = |condition: &str, offer: Offer| Offer {
            condition: condition.to_owned(),
            ..offer
        };
        let offers = [
            at("quiet", offer("a", 5.0, 0.99, 0.0)),
            at("quiet", offer("b", 5.0, 0.90, 0.0)),
            at("quiet", offer("only here", 1.0, 1.0, 0.0)),
            at("noisy", offer("a", 6.0, 0.50, 0.0)),
            at("noisy", offer("b", 4.0, 0.80, 0.0)),
        ];
        assert_eq!(by_condition(&offers).len(), 2);
        let worst = worst_of(&offers);
        let found: Vec<(&str, f64, f64)> = worst
            .iter()
            .map(|o| (o.setting.as_str(), o.accuracy, o.costs.decision_us))
            .collect();
        assert_eq!(found, [("a", 0.50, 6.0), ("b", 0.80, 5.0)]);
    }

    #[test]
    fn a_wish_that_nothing_fulfils_is_an_error_that_names_the_nearest() {
        let text = |wish| advise(&offers(), wish, TIME).unwrap_err().to_string();
        let dear = text(Wish::Accuracy(0.99));
        assert!(dear.contains("0.970") && dear.contains("best"), "{dear}");
        let cheap = text(Wish::Budget(5.0));
        assert!(cheap.contains("10.0 µs") && cheap.contains("cheap"));
        for wish in [Wish::Accuracy(0.0), Wish::Accuracy(1.1)] {
            assert!(text(wish).contains("at most 1"));
        }
        assert!(text(Wish::Budget(f64::NAN)).contains("positive"));
        assert!(advise(&[], Wish::Accuracy(0.5), TIME).is_err());
        let broken = [offer("no number", f64::NAN, 0.99, 0.0)];
        assert!(advise(&broken, Wish::Accuracy(0.5), TIME).is_err());
    }
}
