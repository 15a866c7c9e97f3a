//! Advice: of settings that were measured, the cheapest that is accurate enough, or the most accurate that is cheap enough.

use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};

/// A setting, what it gives, and what it costs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Offer {
    /// In words.
    pub setting: String,
    /// Microseconds a decision.
    pub cost_us: f64,
    /// Share of right decisions, 0 to 1.
    pub accuracy: f64,
    /// Lower end of its interval.
    pub accuracy_low: f64,
    /// Upper end of it.
    pub accuracy_high: f64,
}

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// At least this share of right decisions, more than 0 and at most 1, for as little as possible.
    Accuracy(f64),
    /// As many right decisions as possible for at most so many microseconds each, positive.
    BudgetUs(f64),
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

/// The settings that no other beats: each more accurate than all that cost as much or less. Cheapest first.
///
/// Of equals the first is kept. Offers with a number that is not finite have no place.
pub fn front(offers: &[Offer]) -> Vec<&Offer> {
    let mut sorted: Vec<&Offer> = offers.iter().filter(|offer| is_finite(offer)).collect();
    // A stable sort: of equals the first stays first.
    sorted.sort_by(|a, b| {
        let by_cost = a.cost_us.total_cmp(&b.cost_us);
        by_cost.then(b.accuracy.total_cmp(&a.accuracy))
    });
    let mut best = f64::NEG_INFINITY;
    sorted.retain(|offer| {
        let is_better = offer.accuracy > best;
        best = best.max(offer.accuracy);
        is_better
    });
    sorted
}

/// Answers a wish from what was measured.
///
/// # Errors
/// A wish out of its range; no offers; a wish that no offer fulfils: the error names the nearest.
pub fn advise(offers: &[Offer], wish: Wish) -> Result<Advice> {
    let (place, given) = wish.in_words();
    let refuse = |allowed: String| Error::input(place, &given, allowed);
    let (is_in_range, range) = match wish {
        Wish::Accuracy(share) => (share > 0.0 && share <= 1.0, "more than 0, at most 1"),
        Wish::BudgetUs(us) => (us > 0.0 && us.is_finite(), "a positive number"),
    };
    if !is_in_range {
        return Err(refuse(range.to_owned()));
    }
    let front = front(offers);
    let (Some(cheapest), Some(best)) = (front.first(), front.last()) else {
        return Err(refuse("a table with at least one setting".to_owned()));
    };
    let place = match wish {
        Wish::Accuracy(share) => front.iter().position(|offer| offer.accuracy >= share),
        Wish::BudgetUs(us) => front.iter().rposition(|offer| offer.cost_us <= us),
    };
    let Some(place) = place else {
        return Err(refuse(match wish {
            Wish::Accuracy(_) => format!("at most {}", best.in_words()),
            Wish::BudgetUs(_) => format!("at least {}", cheapest.in_words()),
        }));
    };
    let choice = front[place];
    let certain = match wish {
        Wish::Accuracy(share) => cheapest_certain(offers, share).filter(|it| *it != choice),
        Wish::BudgetUs(_) => None,
    };
    Ok(Advice {
        choice: choice.clone(),
        certain: certain.cloned(),
        next_up: front.get(place + 1).map(|&offer| offer.clone()),
    })
}

fn cheapest_certain(offers: &[Offer], share: f64) -> Option<&Offer> {
    let enough = offers
        .iter()
        .filter(|offer| is_finite(offer) && offer.accuracy_low >= share);
    enough.min_by(|a, b| a.cost_us.total_cmp(&b.cost_us))
}

fn is_finite(offer: &Offer) -> bool {
    offer.cost_us.is_finite() && offer.accuracy.is_finite()
}

impl Wish {
    /// What is asked for, and how much of it.
    fn in_words(self) -> (&'static str, String) {
        match self {
            Self::Accuracy(share) => ("accuracy", share.to_string()),
            Self::BudgetUs(us) => ("budget", format!("{us} µs a decision")),
        }
    }
}

impl Offer {
    /// `0.83 (0.80 to 0.86) for 210 µs a decision: RBF SVM, 64 measurements`.
    pub fn in_words(&self) -> String {
        let Self {
            setting,
            accuracy,
            accuracy_low,
            accuracy_high,
            ..
        } = self;
        let cost = cost_in_words(self.cost_us);
        format!(
            "{accuracy:.3} ({accuracy_low:.3} to {accuracy_high:.3}) for {cost} a decision: {setting}"
        )
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

    fn offer(setting: &str, cost_us: f64, accuracy: f64, half_width: f64) -> Offer {
        Offer {
            setting: setting.to_owned(),
            cost_us,
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

    #[test]
    fn nothing_beats_a_setting_of_the_front_and_something_beats_every_other() {
        let offers = offers();
        let front = front(&offers);
        let names: Vec<&str> = front.iter().map(|offer| offer.setting.as_str()).collect();
        assert_eq!(names, ["cheap", "middle", "best"]);
        for offer in &offers {
            let is_no_better_than =
                |on: &&Offer| on.cost_us <= offer.cost_us && on.accuracy >= offer.accuracy;
            assert!(front.iter().any(is_no_better_than), "{}", offer.setting);
        }
    }

    #[test]
    fn the_cheapest_that_is_accurate_enough_is_advised_with_the_certain_one_and_the_next() {
        let advice = advise(&offers(), Wish::Accuracy(0.9)).unwrap();
        assert_eq!(advice.choice.setting, "middle");
        assert_eq!(advice.certain.unwrap().setting, "certain");
        assert_eq!(advice.next_up.unwrap().setting, "best");
        let advice = advise(&offers(), Wish::Accuracy(0.95)).unwrap();
        assert_eq!(advice.choice.setting, "best");
        assert_eq!((advice.certain, advice.next_up), (None, None));
    }

    #[test]
    fn the_best_within_a_budget_is_advised_and_a_budget_is_a_limit_that_may_be_reached() {
        for (budget, choice) in [(10.0, "cheap"), (49.9, "cheap"), (199.0, "middle")] {
            let advice = advise(&offers(), Wish::BudgetUs(budget)).unwrap();
            assert_eq!(advice.choice.setting, choice, "{budget}");
        }
    }

    #[test]
    fn a_wish_that_nothing_fulfils_is_an_error_that_names_the_nearest() {
        let text = |wish| advise(&offers(), wish).unwrap_err().to_string();
        let dear = text(Wish::Accuracy(0.99));
        assert!(dear.contains("0.970") && dear.contains("best"), "{dear}");
        let cheap = text(Wish::BudgetUs(5.0));
        assert!(cheap.contains("10.0 µs") && cheap.contains("cheap"));
        for wish in [Wish::Accuracy(0.0), Wish::Accuracy(1.1)] {
            assert!(text(wish).contains("at most 1"));
        }
        assert!(text(Wish::BudgetUs(f64::NAN)).contains("positive"));
        assert!(advise(&[], Wish::Accuracy(0.5)).is_err());
        let broken = [offer("no number", f64::NAN, 0.99, 0.0)];
        assert!(advise(&broken, Wish::Accuracy(0.5)).is_err());
    }
}
