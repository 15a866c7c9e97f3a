//! Where values stand along an axis: the one scale of all charts.

use crate::table::{Along, Column, Data, Role, Scale as Spacing};

/// Part of a logarithmic axis on which zero stands apart.
pub(super) const SHELF: f64 = 0.09;
/// Values up to which a swept axis has its ticks at them.
const MOST_SWEPT: usize = 40;

/// Values along an axis, as parts of its length.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    kind: Kind,
    /// Where labels may stand, in rising order.
    pub ticks: Vec<Tick>,
    /// What runs along the axis.
    pub title: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Even {
        low: f64,
        high: f64,
    },
    /// Ends are powers of ten.
    Log {
        low: f64,
        high: f64,
        has_zero: bool,
    },
    /// At equal distances, the first at the beginning.
    Words(usize),
    /// The same from the end, as rows are read.
    Rows(usize),
    /// Numbers at equal distances, and whether ratios lie between them.
    Levels(Vec<f64>, bool),
}

/// A place on an axis that may have a label.
#[derive(Clone, Debug)]
pub(super) struct Tick {
    /// Part of the axis.
    pub at: f64,
    /// What stands there.
    pub label: String,
    /// Whether its label comes before its neighbours' where there is no room for all.
    pub is_round: bool,
}

impl Scale {
    /// That covers these values of a column; words by their place among `words`.
    pub fn of(column: &Column, (values, words): (&[f64], &[String]), along: Along) -> Self {
        let title = column.title();
        let is_swept = matches!(column.role, Role::Choice | Role::Condition | Role::Subject);
        let mut distinct: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let kind = match (column.scale, along) {
            (Spacing::Words, Along::X) => Kind::Words(words.len()),
            (Spacing::Words, Along::Y) => Kind::Rows(words.len()),
            (Spacing::Log, _) => log_ends(&distinct),
            (Spacing::Share, Along::Y) if column.unit.is_empty() && !is_swept => {
                share_ends(&distinct)
            }
            (_, Along::Y) if !is_swept => round_ends(&distinct),
            _ => swept_ends(&distinct),
        };
        let mut scale = Self {
            kind,
            ticks: Vec::new(),
            title,
        };
        scale.ticks = match (&scale.kind, is_swept && distinct.len() <= MOST_SWEPT) {
            (Kind::Words(_) | Kind::Rows(_), _) => scale.word_ticks(words),
            (_, true) => scale.ticks_at(column, &distinct),
            (_, false) => scale.ticks_at(column, &scale.round_values()),
        };
        scale
    }

    /// That gives each value of a column a tile of its own.
    pub fn of_tiles(column: &Column, (values, words): (&[f64], &[String]), along: Along) -> Self {
        if column.scale == Spacing::Words {
            return Self::of(column, (values, words), along);
        }
        let mut levels: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let is_log = column.scale == Spacing::Log && levels.iter().all(|&level| level > 0.0);
        let mut scale = Self {
            kind: Kind::Levels(levels.clone(), is_log),
            ticks: Vec::new(),
            title: column.title(),
        };
        scale.ticks = scale.ticks_at(column, &levels);
        scale
    }

    /// Where a value stands, part of the axis; none for what has no place on it.
    pub fn place(&self, value: f64) -> Option<f64> {
        let part = match &self.kind {
            Kind::Even { low, high } => (value - low) / (high - low),
            Kind::Log { has_zero, .. } if value == 0.0 => match has_zero {
                true => 0.5 * SHELF,
                false => return None,
            },
            Kind::Log {
                low,
                high,
                has_zero,
            } => {
                let shelf = if *has_zero { SHELF } else { 0.0 };
                shelf + (1.0 - shelf) * (value.log10() - low) / (high - low)
            }
            Kind::Words(n) => (value + 0.5) / *n as f64,
            Kind::Rows(n) => 1.0 - (value + 0.5) / *n as f64,
            Kind::Levels(levels, is_log) => {
                (among(levels, *is_log, value) + 0.5).clamp(0.0, levels.len() as f64)
                    / levels.len() as f64
            }
        };
        let is_inside = (-1e-9..=1.0 + 1e-9).contains(&part);
        is_inside.then(|| part.clamp(0.0, 1.0))
    }

    /// How many tiles stand along it.
    pub fn n_levels(&self) -> usize {
        match &self.kind {
            Kind::Words(n) | Kind::Rows(n) => *n,
            Kind::Levels(levels, _) => levels.len(),
            Kind::Even { .. } | Kind::Log { .. } => 1,
        }
    }

    /// Whether words stand along it, between which nothing is.
    pub fn is_words(&self) -> bool {
        matches!(self.kind, Kind::Words(_) | Kind::Rows(_))
    }

    /// Where zero's part of a logarithmic axis ends.
    pub fn shelf(&self) -> Option<f64> {
        matches!(self.kind, Kind::Log { has_zero: true, .. }).then_some(SHELF)
    }

    fn word_ticks(&self, words: &[String]) -> Vec<Tick> {
        let ticks = words.iter().enumerate().filter_map(|(place, word)| {
            Some(Tick {
                at: self.place(place as f64)?,
                label: word.clone(),
                is_round: false,
            })
        });
        ticks.collect()
    }

    fn ticks_at(&self, column: &Column, values: &[f64]) -> Vec<Tick> {
        let is_log = matches!(self.kind, Kind::Log { .. });
        let tick = |&value: &f64| {
            Some(Tick {
                at: self.place(value)?,
                label: column.tick(value),
                is_round: is_log && (value.log10() - value.log10().round()).abs() < 1e-9,
            })
        };
        values.iter().filter_map(tick).collect()
    }

    fn round_values(&self) -> Vec<f64> {
        match &self.kind {
            Kind::Even { low, high } => even_ticks(*low, *high),
            Kind::Log {
                low,
                high,
                has_zero,
            } => {
                let zero = has_zero.then_some(0.0).into_iter();
                zero.chain(log_ticks(*low, *high)).collect()
            }
            Kind::Levels(levels, _) => levels.clone(),
            Kind::Words(_) | Kind::Rows(_) => Vec::new(),
        }
    }
}

/// A twelfth of a decade at least, so that equal values do not stand at the edges.
fn log_ends(values: &[f64]) -> Kind {
    let mut positive = values.iter().copied().filter(|&v| v > 0.0);
    let (low, high) = match (positive.next(), values.last()) {
        (Some(low), Some(&high)) => (low.log10(), high.log10()),
        _ => (-1.0, 1.0),
    };
    let margin = f64::max(0.06 * (high - low), 0.08);
    Kind::Log {
        low: low - margin,
        high: high + margin,
        has_zero: values.contains(&0.0),
    }
}

/// From 0 to 1, however few of them the values reach, so that charts can be compared by eye.
fn share_ends(values: &[f64]) -> Kind {
    match round_ends(values) {
        Kind::Even { low, high } => Kind::Even {
            low: low.min(0.0),
            high: high.max(1.0),
        },
        other => other,
    }
}

/// Round numbers around the values, and zero where it is not far.
fn round_ends(values: &[f64]) -> Kind {
    let (low, high) = ends(values);
    let low = if low > 0.0 && low < 0.6 * high {
        0.0
    } else {
        low
    };
    let high = if high < 0.0 && high > 0.6 * low {
        0.0
    } else {
        high
    };
    let step = tick_step(high - low);
    Kind::Even {
        low: step * (low / step + 1e-9).floor(),
        high: step * (high / step - 1e-9).ceil(),
    }
}

fn swept_ends(values: &[f64]) -> Kind {
    let (low, high) = ends(values);
    let margin = 0.06 * (high - low);
    Kind::Even {
        low: low - margin,
        high: high + margin,
    }
}

/// The first and the last of sorted values, apart.
fn ends(values: &[f64]) -> (f64, f64) {
    match (values.first(), values.last()) {
        (Some(&low), Some(&high)) if high > low => (low, high),
        (Some(&low), _) => (
            low - 0.5 * low.abs().max(1e-12),
            low + 0.5 * low.abs().max(1e-12),
        ),
        _ => (0.0, 1.0),
    }
}

/// 1, 2 or 5 times a power of ten: about five steps over a length.
fn tick_step(length: f64) -> f64 {
    let raw = length / 5.0;
    let power = 10f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|f| f * power >= raw * 0.999);
    factor.unwrap_or(10.0) * power
}

/// Multiples of a round step between two ends.
pub(in crate::report) fn even_ticks(low: f64, high: f64) -> Vec<f64> {
    let step = tick_step(high - low);
    let (first, last) = (
        (low / step - 1e-9).ceil() as i64,
        (high / step + 1e-9).floor() as i64,
    );
    // A quotient by the inverse is the nearest number to what is meant, which the product is not: 3 × 0.1.
    let value = |tick: i64| match step < 1.0 {
        true => tick as f64 / (1.0 / step).round(),
        false => tick as f64 * step,
    };
    (first..=last).map(value).collect()
}

/// Powers of ten and, the fewer decades there are, the more of their multiples: at least about three.
fn log_ticks(low: f64, high: f64) -> Vec<f64> {
    const STEPS: [&[f64]; 4] = [
        &[1.0],
        &[1.0, 2.0, 5.0],
        &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
        &[
            1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4, 2.6, 2.8, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0,
            8.0, 9.0,
        ],
    ];
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let multiples = |factors: &[f64]| -> Vec<f64> {
        let all =
            (first..=last).flat_map(|power| factors.iter().map(move |&factor| (factor, power)));
        let all = all.map(|(factor, power)| match power {
            0.. => factor * 10f64.powi(power),
            // The nearest number, which a product with a rounded power is not.
            _ => factor / 10f64.powi(-power),
        });
        all.filter(|tick| (low..=high).contains(&tick.log10()))
            .collect()
    };
    let finer = STEPS.map(multiples);
    let enough = finer.iter().position(|ticks| ticks.len() >= 3);
    finer[enough.unwrap_or(STEPS.len() - 1)].clone()
}

/// The place of a value among sorted levels, between and beyond them in proportion.
fn among(levels: &[f64], is_log: bool, value: f64) -> f64 {
    let spaced = |value: f64| if is_log { value.ln() } else { value };
    if let Some(exact) = levels.iter().position(|&level| level == value) {
        return exact as f64;
    }
    let last = levels.len() - 1;
    if last == 0 {
        return if value < levels[0] { -0.5 } else { 0.5 };
    }
    let above = levels
        .iter()
        .position(|&level| level > value)
        .unwrap_or(last)
        .max(1);
    let (low, high) = (spaced(levels[above - 1]), spaced(levels[above]));
    (above - 1) as f64 + (spaced(value) - low) / (high - low)
}

/// The words that are there, in the order of the table, and each row's place among them; numbers as they are.
pub(super) fn values(column: &Column, data: &Data, rows: &[usize]) -> (Vec<f64>, Vec<String>) {
    match data {
        Data::Numbers(numbers) => (rows.iter().map(|&row| numbers[row]).collect(), Vec::new()),
        Data::Words { levels, codes } => {
            let mut places = vec![f64::NAN; levels.len()];
            for &row in rows {
                places[codes[row] as usize] = 0.0;
            }
            let mut words = Vec::new();
            for (place, level) in places.iter_mut().zip(levels) {
                if !place.is_nan() {
                    *place = words.len() as f64;
                    words.push(column.word(level));
                }
            }
            (
                rows.iter()
                    .map(|&row| places[codes[row] as usize])
                    .collect(),
                words,
            )
        }
    }
}

/// Which ticks have room for their labels, each taking `half` of the axis to either side: the ends first, then round ones, then in order.
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

    fn column(scale: Spacing, role: Role) -> Column {
        Column::new("a", role, "a", "", scale)
    }

    fn labels(scale: &Scale) -> Vec<&str> {
        scale.ticks.iter().map(|tick| &tick.label[..]).collect()
    }

    #[test]
    fn a_logarithmic_axis_has_decades_of_one_length_and_zero_apart() {
        let values = [0.0, 1e-6, 1e-3, 1.0];
        let scale = Scale::of(&column(Spacing::Log, Role::Cost), (&values, &[]), Along::X);
        let at = |value| scale.place(value).unwrap();
        assert!((at(1e-3) - at(1e-6) - (at(1.0) - at(1e-3))).abs() < 1e-12);
        assert!(at(0.0) < SHELF && at(1e-6) > SHELF && at(1.0) < 1.0);
        assert_eq!(
            labels(&scale),
            ["0", "1e-6", "1e-5", "0.0001", "0.001", "0.01", "0.1", "1"]
        );
        assert_eq!(scale.place(-1.0), None);
        let none = Scale::of(&column(Spacing::Log, Role::Cost), (&[], &[]), Along::X);
        assert!(!none.ticks.is_empty() && none.place(0.0).is_none());
    }

    #[test]
    fn a_share_reaches_from_nothing_to_all_and_a_swept_value_has_a_tick() {
        let share = Scale::of(
            &column(Spacing::Share, Role::Note),
            (&[0.3, 0.4], &[]),
            Along::Y,
        );
        assert_eq!(labels(&share), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!((share.place(0.0), share.place(1.0)), (Some(0.0), Some(1.0)));
        let swept = Scale::of(
            &column(Spacing::Linear, Role::Choice),
            (&[7.0, 1.5, 7.0], &[]),
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
        assert_eq!(log_ticks(-0.5229, -0.2218), [0.3, 0.4, 0.5]);
    }

    #[test]
    fn labels_that_would_touch_give_way_to_the_ends_and_to_powers_of_ten() {
        let values: Vec<f64> = (0..=30)
            .map(|step| 10f64.powf(0.1 * f64::from(step)))
            .collect();
        let scale = Scale::of(
            &column(Spacing::Log, Role::Choice),
            (&values, &[]),
            Along::X,
        );
        let shown = thin(&scale.ticks, |_| 0.06);
        let kept = scale.ticks.iter().zip(&shown).filter(|(_, kept)| **kept);
        let kept: Vec<&str> = kept.map(|(tick, _)| &tick.label[..]).collect();
        for power in ["1", "10", "100", "1000"] {
            assert!(kept.contains(&power), "{kept:?}");
        }
        assert!(kept.len() < 9);
    }

    #[test]
    fn between_tiles_a_limit_stands_in_proportion() {
        let levels = [1.0, 10.0, 100.0];
        let scale = Scale::of_tiles(
            &column(Spacing::Log, Role::Choice),
            (&levels, &[]),
            Along::X,
        );
        let third = 1.0 / 3.0;
        assert!((scale.place(10f64.sqrt()).unwrap() - third).abs() < 1e-12);
        assert_eq!(scale.place(1e9), Some(1.0));
        assert_eq!(scale.place(1e-9), Some(0.0));
        assert_eq!(scale.n_levels(), 3);
    }
}
