//! Which of several choices are worth their costs.

/// A choice: what it is compared within, and two costs, each the better the smaller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Only choices of the same level are compared.
    pub level: f64,
    /// What it costs.
    pub costs: [f64; 2],
}

impl Choice {
    /// Whether it is no worse than another of its level, and better in something.
    fn beats(&self, other: &Self) -> bool {
        let ([a, b], [x, y]) = (self.costs, other.costs);
        self.level == other.level && a <= x && b <= y && (a < x || b < y)
    }
}

/// For each choice, whether no other beats it.
pub fn unbeaten(choices: &[Choice]) -> Vec<bool> {
    let is_beaten = |choice: &Choice| choices.iter().any(|other| other.beats(choice));
    choices.iter().map(|choice| !is_beaten(choice)).collect()
}
