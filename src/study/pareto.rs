//! Which of several choices are worth their costs.

/// A choice: what it is compared within, and two costs, each the better the smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Only choices of the same level are compared.
    pub level: f64,
    /// What it costs.
    pub costs: [f64; 2],
}

/// For each choice, whether no other of its level is no worse than it, and better in something. One that is not a number is
/// not compared. In the order of their costs, whoever comes later can be beaten only by the best of those before.
pub fn unbeaten(choices: &[Choice]) -> Vec<bool> {
    let is_number = |choice: &Choice| !choice.costs.iter().any(|cost| cost.is_nan());
    let mut order: Vec<usize> = (0..choices.len())
        .filter(|&index| is_number(&choices[index]))
        .collect();
    // 0 and −0 are the same cost.
    let key = |index: &usize| {
        let Choice { level, costs } = choices[*index];
        [level + 0.0, costs[0] + 0.0, costs[1] + 0.0]
    };
    order.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        let by = |place: usize| a[place].total_cmp(&b[place]);
        by(0).then_with(|| by(1)).then_with(|| by(2))
    });
    let mut is_unbeaten = vec![true; choices.len()];
    for of_level in order.chunk_by(|a, b| key(a)[0] == key(b)[0]) {
        let mut least: Option<f64> = None;
        for same_first in of_level.chunk_by(|a, b| key(a)[1] == key(b)[1]) {
            let of_these = key(&same_first[0])[2];
            for index in same_first {
                let second = key(index)[2];
                let is_less = least.is_none_or(|least| second < least);
                is_unbeaten[*index] = is_less && second == of_these;
            }
            least = Some(least.map_or(of_these, |least| least.min(of_these)));
        }
    }
    is_unbeaten
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    fn beats(choice: &Choice, other: &Choice) -> bool {
        let ([a, b], [x, y]) = (choice.costs, other.costs);
        choice.level == other.level && a <= x && b <= y && (a < x || b < y)
    }

    #[test]
    fn whom_nobody_beats_is_on_the_front() {
        let mut rng = Seed::new(3).named("pareto").rng();
        for n in [0, 1, 2, 5, 40, 300] {
            for steps in [2, 10, 1000] {
                // Few steps: many equal costs, some infinite, some no numbers.
                let mut cost = || match rng.gen_range(0..steps + 3) {
                    0 => f64::INFINITY,
                    1 if steps > 2 => f64::NAN,
                    2 => -0.0,
                    n => f64::from(n - 3),
                };
                let choices: Vec<Choice> = (0..n)
                    .map(|k| Choice {
                        level: f64::from(k % 3),
                        costs: [cost(), cost()],
                    })
                    .collect();
                let wanted = choices
                    .iter()
                    .map(|choice| !choices.iter().any(|other| beats(other, choice)));
                assert_eq!(
                    unbeaten(&choices),
                    wanted.collect::<Vec<_>>(),
                    "{choices:?}"
                );
            }
        }
    }
}
