//! How places between the values of a way are measured.

use serde::{Deserialize, Serialize};

/// Room of zero before the smallest positive value of a logarithmic scale, decades. Larger: the chart is mostly zero; smaller: it
/// stands beside that value.
const ZERO: f64 = 0.5;

/// The scale of a way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WayScale {
    /// Decades take the same room; a zero stands half a decade before the smallest positive value.
    #[default]
    Logarithmic,
    /// Differences take the same room.
    Linear,
}

impl WayScale {
    /// The values from which it measures: the smallest positive one.
    pub fn start(values: impl IntoIterator<Item = f64>) -> f64 {
        let positive = values.into_iter().filter(|&value| value > 0.0);
        positive.fold(f64::INFINITY, f64::min)
    }

    /// Where a value stands. `start`: the smallest positive value of the way.
    pub fn place(self, value: f64, start: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic if value < start => ZERO * (value / start - 1.0),
            Self::Logarithmic => (value / start).log10(),
        }
    }

    /// What stands at a place.
    pub fn value(self, place: f64, start: f64) -> f64 {
        match self {
            Self::Linear => place,
            Self::Logarithmic if place < 0.0 => start * (1.0 + place / ZERO),
            Self::Logarithmic => start * 10f64.powf(place),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_stands_where_its_place_says_and_decades_are_equal() {
        for scale in [WayScale::Linear, WayScale::Logarithmic] {
            let mut before = f64::NEG_INFINITY;
            for value in [0.0, 1e-3, 0.01, 0.02, 0.5, 1.0, 700.0] {
                let place = scale.place(value, 0.01);
                assert!(place > before);
                assert!((scale.value(place, 0.01) - value).abs() < 1e-12 * (1.0 + value));
                before = place;
            }
        }
        let log = |value| WayScale::Logarithmic.place(value, 0.01);
        assert!((log(10.0) - log(1.0) - 1.0).abs() < 1e-12);
        assert_eq!((log(0.0), log(0.01)), (-ZERO, 0.0));
        assert_eq!(WayScale::start([0.0, 3.0, 0.5]), 0.5);
    }
}
