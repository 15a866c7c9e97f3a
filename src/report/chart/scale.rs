//! Axis scale of charts: maps values to fractions of an axis.

use crate::report::pictures::{even_ticks, tick_step};
use crate::table::{Along, Column, Role, Scale};

/// Fraction of the length of a logarithmic axis that is reserved for the value zero.
pub(super) const SHELF: f64 = 0.09;
/// Maximum number of values of a swept setting for which the axis has a tick at each value. With more values, ticks are at round numbers.
const MAX_SWEPT: usize = 40;

/// AxisScale of an axis, which converts values to fractions of the axis length.
#[derive(Clone, Debug, Default)]
pub(super) struct AxisScale {
    /// Values at the ends of a continuous axis, or their logarithms.
    ends: (f64, f64),
    /// Values of an axis of texts or tiles, each with its position on the axis; empty for a continuous axis.
    pub levels: Vec<(f64, f64)>,
    is_log: bool,
    /// End of the part of a logarithmic axis that shows zero, as a fraction of the axis length; `None` if no value is zero.
    pub shelf: Option<f64>,
    /// Whether the axis shows texts; positions between two texts have no meaning.
    pub is_words: bool,
    /// Ticks that may have a label, in ascending order of their values.
    pub ticks: Vec<Tick>,
    /// Title of the axis.
    pub title: String,
}

/// Tick of an axis: a position that may have a label.
#[derive(Clone, Debug)]
pub(super) struct Tick {
    /// Position of the tick as a fraction of the axis length, from the start of the axis.
    pub at: f64,
    /// Text of the tick's label.
    pub label: String,
    /// Whether the tick is at a round number; labels of such ticks have priority if space is short.
    pub is_round: bool,
}

impl AxisScale {
    /// Creates a continuous scale that covers the given values of a column along an axis of the chart.
    pub fn new(column: &Column, values: &[f64], along: Along) -> Self {
        let is_swept = matches!(column.role, Role::Choice | Role::Condition | Role::Subject);
        let distinct = distinct(values);
        let is_log = column.scale == Scale::Log;
        let shelf = (is_log && distinct.contains(&0.0)).then_some(SHELF);
        let (low, high) = match (is_log, along) {
            (true, _) => log_ends(&distinct),
            (_, Along::Y) if !is_swept => {
                let (low, high) = round_ends(&distinct);
                match column.scale == Scale::Share && column.unit.is_empty() {
                    // Fractions always include 0 to 1, so that charts can be compared by eye.
                    true => (low.min(0.0), high.max(1.0)),
                    false => (low, high),
                }
            }
            _ => {
                let (low, high) = ends(&distinct);
                let margin = 0.06 * (high - low);
                (low - margin, high + margin)
            }
        };
        let ticks = match (is_swept && distinct.len() <= MAX_SWEPT, is_log) {
            (true, _) => distinct,
            (_, false) => even_ticks(low, high),
            (_, true) => {
                let zero = shelf.map(|_| 0.0).into_iter();
                zero.chain(log_ticks(low, high)).collect()
            }
        };
        let scale = Self {
            ends: (low, high),
            is_log,
            shelf,
            title: column.title(),
            ..Self::default()
        };
        scale.with_ticks(&ticks, |&tick| column.tick(tick))
    }

    /// Creates a scale with one position for each value of a column. Words keep the given order (from the top along y); numbers of tiles are ascending.
    pub fn of_levels(column: &Column, (values, words): (&[f64], &[String]), along: Along) -> Self {
        let is_words = column.scale == Scale::Words;
        let levels: Vec<f64> = match is_words {
            true => (0..words.len()).map(|word| word as f64).collect(),
            false => distinct(values),
        };
        let n = levels.len() as f64;
        let part = |(place, &level): (usize, &f64)| {
            let part = (place as f64 + 0.5) / n;
            match is_words && along == Along::Y {
                true => (level, 1.0 - part),
                false => (level, part),
            }
        };
        let scale = Self {
            levels: levels.iter().enumerate().map(part).collect(),
            is_words,
            title: column.title(),
            ..Self::default()
        };
        scale.with_ticks(&levels, |&level| match is_words {
            true => words[level as usize].clone(),
            false => column.tick(level),
        })
    }

    fn with_ticks(mut self, values: &[f64], label: impl Fn(&f64) -> String) -> Self {
        let is_round = |value: f64| (value.log10() - value.log10().round()).abs() < 1e-9;
        let ticks = values.iter().filter_map(|value| {
            Some(Tick {
                at: self.place(*value)?,
                label: label(value),
                is_round: self.is_log && is_round(*value),
            })
        });
        self.ticks = ticks.collect();
        self
    }

    /// Returns the position of a value as a fraction of the axis length; `None` if the value has no position.
    pub fn place(&self, value: f64) -> Option<f64> {
        if !self.levels.is_empty() {
            let mut levels = self.levels.iter();
            return levels.find_map(|&(level, part)| (level == value).then_some(part));
        }
        if self.is_log && value == 0.0 {
            return self.shelf.map(|shelf| 0.5 * shelf);
        }
        let value = match self.is_log {
            true => value.log10(),
            false => value,
        };
        let ((low, high), from) = (self.ends, self.shelf.unwrap_or(0.0));
        let part = from + (1.0 - from) * (value - low) / (high - low);
        value.is_finite().then_some(part.clamp(0.0, 1.0))
    }
}

/// Returns the distinct finite values in ascending order.
fn distinct(values: &[f64]) -> Vec<f64> {
    let mut distinct: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    distinct
}

/// Returns the lower and upper end of a logarithmic axis, which includes margins of at least a twelfth of a decade.
fn log_ends(values: &[f64]) -> (f64, f64) {
    let mut positive = values.iter().copied().filter(|&v| v > 0.0);
    let (low, high) = match (positive.next(), values.last()) {
        (Some(low), Some(&high)) => (low.log10(), high.log10()),
        _ => (-1.0, 1.0),
    };
    let margin = f64::max(0.06 * (high - low), 0.08);
    (low - margin, high + margin)
}

/// Returns round numbers as the lower and upper end of an axis around the values; includes zero if zero is near.
fn round_ends(values: &[f64]) -> (f64, f64) {
    let (mut low, mut high) = ends(values);
    if low > 0.0 && low < 0.6 * high {
        low = 0.0;
    }
    if high < 0.0 && high > 0.6 * low {
        high = 0.0;
    }
    let step = tick_step(high - low);
    (
        step * (low / step + 1e-9).floor(),
        step * (high / step - 1e-9).ceil(),
    )
}

/// Returns the first and the last of sorted values, moved apart if they are equal.
fn ends(values: &[f64]) -> (f64, f64) {
    let (Some(&low), Some(&high)) = (values.first(), values.last()) else {
        return (0.0, 1.0);
    };
    let margin = match high > low {
        true => 0.0,
        false => 0.5 * low.abs().max(1e-12),
    };
    (low - margin, high + margin)
}

/// Returns the ticks of a logarithmic axis, which are the powers of ten in its range. If there are fewer than three, also 2 and 5 times powers of ten. If these
/// are still too few, returns evenly spaced numbers.
fn log_ticks(low: f64, high: f64) -> Vec<f64> {
    let multiples = |factors: &[u32]| -> Vec<f64> {
        let powers = low.floor() as i32..=high.ceil() as i32;
        let all = powers.flat_map(|power| factors.iter().map(move |factor| (factor, power)));
        // Parsing gives the nearest number; a product with a rounded power does not.
        let all = all.filter_map(|(factor, power)| format!("{factor}e{power}").parse::<f64>().ok());
        all.filter(|tick| (low..=high).contains(&tick.log10()))
            .collect()
    };
    let steps: [&[u32]; 2] = [&[1], &[1, 2, 5]];
    let mut steps = steps.into_iter().map(multiples);
    let enough = steps.find(|ticks| ticks.len() >= 3);
    enough.unwrap_or_else(|| even_ticks(10f64.powf(low), 10f64.powf(high)))
}

/// Returns for each tick of an axis whether its label fits into the available space. A label needs `half` of the axis length on either side. Priority: the
/// ends, round ticks, other ticks.
pub(super) fn thin(ticks: &[Tick], half: impl Fn(&Tick) -> f64) -> Vec<bool> {
    let last = ticks.len().saturating_sub(1);
    let rank = |place: usize| match (place == 0 || place == last, ticks[place].is_round) {
        (true, _) => 0,
        (false, true) => 1,
        (false, false) => 2,
    };
    let mut order: Vec<usize> = (0..ticks.len()).collect();
    order.sort_by_key(|&place| rank(place));
    let mut shown = vec![false; ticks.len()];
    let mut taken: Vec<(f64, f64)> = Vec::new();
    for place in order {
        let (at, half) = (ticks[place].at, half(&ticks[place]));
        let is_free = |&(from, to): &(f64, f64)| at + half <= from || at - half >= to;
        if taken.iter().all(is_free) {
            taken.push((at - half, at + half));
            shown[place] = true;
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(scale: Scale, role: Role) -> Column {
        Column::new("a", role, "a", "", scale)
    }

    fn labels(scale: &AxisScale) -> Vec<&str> {
        scale.ticks.iter().map(|tick| &tick.label[..]).collect()
    }

    #[test]
    fn a_logarithmic_axis_has_decades_of_one_length_and_zero_apart() {
        let values = [0.0, 1e-6, 1e-3, 1.0];
        let scale = AxisScale::new(&column(Scale::Log, Role::Cost), &values, Along::X);
        let at = |value| scale.place(value).unwrap();
        assert!((at(1e-3) - at(1e-6) - (at(1.0) - at(1e-3))).abs() < 1e-12);
        assert!(at(0.0) < SHELF && at(1e-6) > SHELF && at(1.0) < 1.0);
        assert_eq!(
            labels(&scale),
            ["0", "10⁻⁶", "10⁻⁵", "0.0001", "0.001", "0.01", "0.1", "1"]
        );
        assert_eq!(scale.place(-1.0), None);
        let none = AxisScale::new(&column(Scale::Log, Role::Cost), &[], Along::X);
        assert!(!none.ticks.is_empty() && none.place(0.0).is_none());
    }

    #[test]
    fn a_share_reaches_from_nothing_to_all_and_a_swept_value_has_a_tick() {
        let share = AxisScale::new(&column(Scale::Share, Role::Note), &[0.3, 0.4], Along::Y);
        assert_eq!(labels(&share), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!((share.place(0.0), share.place(1.0)), (Some(0.0), Some(1.0)));
        let swept = AxisScale::new(
            &column(Scale::Linear, Role::Choice),
            &[7.0, 1.5, 7.0],
            Along::X,
        );
        assert_eq!(labels(&swept), ["1.5", "7"]);
    }

    #[test]
    fn round_ticks_are_round_and_inside() {
        for (low, high) in [(0.0, 1e-5), (0.3, 0.9), (-7.0, 1e6), (0.01, 0.0103)] {
            let ticks = even_ticks(low, high);
            assert!((3..=7).contains(&ticks.len()), "{ticks:?}");
            assert!(
                ticks
                    .iter()
                    .all(|t| (low - 1e-12..=high + 1e-12).contains(t))
            );
            assert!(ticks.is_sorted());
        }
        assert_eq!(even_ticks(0.0, 0.5), [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]);
        assert_eq!(log_ticks(-0.5229, -0.2218), [0.3, 0.4, 0.5, 0.6]);
    }

    #[test]
    fn labels_that_would_touch_give_way_to_the_ends_and_to_powers_of_ten() {
        let values: Vec<f64> = (0..=30)
            .map(|step| 10f64.powf(0.1 * f64::from(step)))
            .collect();
        let scale = AxisScale::new(&column(Scale::Log, Role::Choice), &values, Along::X);
        let shown = thin(&scale.ticks, |_| 0.06);
        let kept = scale.ticks.iter().zip(&shown).filter(|(_, kept)| **kept);
        let kept: Vec<&str> = kept.map(|(tick, _)| &tick.label[..]).collect();
        for power in ["1", "10", "100", "1000"] {
            assert!(kept.contains(&power), "{kept:?}");
        }
        assert!(kept.len() < 9);
    }
}
