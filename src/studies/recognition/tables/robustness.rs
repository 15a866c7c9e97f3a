//! Robustness: the value of a condition at which half of the accuracy above chance is lost.
//!
//! The value is computed for each design (configurations whose other columns are equal) and for each numeric condition with at least three values. Let a₀ be
//! the highest mean accuracy along the condition. From there, towards larger or smaller values, the result is the first value at which the accuracy is chance +
//! (a₀ − chance) / 2. Between two values the accuracy is interpolated linearly over the scale of the condition.
//!
//! The interval is simulated. Each mean accuracy a of n independent test rows is drawn from Beta(a n + ½, (1 − a) n + ½), and the value is computed again. The
//! interval contains the middle 95 % of the results, and lies between the value of a₀ and the last value. The number n is chosen so that a Wilson interval of n
//! rows is as wide as the interval in `summary.csv`. Folds and held-out groups therefore count as in that table.
//!
//! A draw in which a₀ is at most chance has no result. A design has no result if more than 2.5 % / k of the draws have none, where k is the number of values
//! from which a₀ is chosen (Bonferroni's correction): its accuracy may be chance at all values.

use crate::error::{Error, Result};
use crate::random::Seed;
use crate::report::swept::{Setting, Swept};
use crate::row;
use crate::statistics::p_status::CONFIDENCE;
use crate::studies::recognition::tables::chance::ChanceLevels;
use crate::table::{Column, Data, File, Role, Table};
use rand_distr::{Beta, Distribution};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub(crate) const ROBUSTNESS: File<Robustness> = File::new(
    "robustness.csv",
    "Robustness",
    "The value of a condition at which half of the accuracy above chance is lost, for each configuration that is most accurate along it.",
)
.summary();

row! {
/// Robustness of a design to one condition, a row of `robustness.csv`. The design consists of all settings except the condition.
pub struct Robustness {
    /// Number of the most accurate configuration of the design over all values of the condition, as in `summary.csv`.
    configuration: usize => Subject: Linear;
    /// Settings by which the design differs from all other designs.
    design: String => Subject;
    /// Column name of the condition whose effect is described, for example `noise_std`.
    condition: String => Subject;
    /// Direction, from the most accurate value of the condition, in which its values change: larger or smaller.
    direction: Direction => Subject "towards";
    /// Value of the condition at which the accuracy of the design is highest, in the unit of the condition.
    clean_at: f64 => Note "most accurate at": Linear;
    /// Highest mean accuracy of the design over all values of the condition, 0 to 1.
    clean_accuracy: f64 => Note "accuracy there": Share;
    /// Chance level of the accuracy, 0 to 1: one divided by the number of objects, or the fraction of the most frequent object if objects have unequal
    /// numbers of test touches.
    chance: f64 => Note: Share;
    /// Accuracy half-way between the highest accuracy and chance, 0 to 1: `chance + (clean_accuracy − chance) / 2`.
    half_accuracy: f64 => Note "half-way to chance": Share;
    /// Whether the accuracy falls to `half_accuracy` within the swept values, or why it does not.
    status: HalfStatus => Outcome "half-way is";
    /// Value of the condition at which the accuracy falls to `half_accuracy`, in its unit; empty if the accuracy stays above.
    half_accuracy_at: Option<f64> => Value(Neither) "half-way at": Linear between [half_accuracy_at_low, half_accuracy_at_high];
    /// Lower end of the 95 % interval of `half_accuracy_at`, in the unit of the condition; empty if it lies beyond the last value of the condition.
    half_accuracy_at_low: Option<f64> => Note "95 % interval of the place, lower end": Linear;
    /// Upper end of the 95 % interval of `half_accuracy_at`, in the unit of the condition; empty if it lies beyond the last value of the condition.
    half_accuracy_at_high: Option<f64> => Note "95 % interval of the place, upper end": Linear;
    /// Last value of the condition in the direction of `direction`, in the unit of the condition.
    end: f64 => Note "last value": Linear;
    /// Mean accuracy at the last value of the condition in the direction of `direction`, 0 to 1.
    accuracy_at_end: f64 => Note "accuracy at the last value": Share;
} }

/// Direction in which the values of a condition change: larger or smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// The condition changes towards larger values.
    Larger,
    /// The condition changes towards smaller values.
    Smaller,
}

/// Whether the accuracy falls to half-way between its maximum and chance within the swept values, or why it does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HalfStatus {
    /// The accuracy falls to half-way between its maximum and chance within the swept values.
    Found,
    /// The accuracy does not fall to half-way between its maximum and chance within the swept values.
    BeyondTheLastValue,
    /// The highest accuracy over all values of the condition is not above chance, or chance explains it.
    AllAtChance,
}

/// Number of random draws from which a confidence interval is computed. With a larger value, intervals vary less, but reports of many configurations take
/// longer. With 1,000 draws, the standard error of an interval's end is about a tenth of its half width.
const N_DRAWS: usize = 1000;

/// Minimum number of values of a condition for which robustness is computed. With two values, the result would only reflect the straight line between them.
const MIN_VALUES: usize = 3;

/// Length of the part of a logarithmic axis between zero and the smallest positive value of a condition, in decades. With a larger value, this range takes most
/// of the axis. With a smaller value, zero and the smallest positive value are hardly distinguishable.
const ZERO_DECADES: f64 = 0.5;

/// Ratio of the largest to the smallest positive value of a condition above which its chart axis is logarithmic.
pub(crate) const LOG_RATIO: f64 = 16.0;

/// Mean accuracy of a design at each value of a condition, in ascending order of the values.
struct Curve {
    values: Vec<f64>,
    accuracy: Vec<f64>,
    /// Number of independent test rows from which each mean accuracy is computed.
    n_test: Vec<f64>,
    chance: f64,
}

impl Curve {
    /// Returns the index of the highest accuracy; the first index if several accuracies are equal.
    fn best(&self) -> usize {
        let accuracy = &self.accuracy;
        let backwards = (0..accuracy.len()).rev();
        let best = backwards.max_by(|&a, &b| accuracy[a].total_cmp(&accuracy[b]));
        best.unwrap_or(0)
    }

    /// Returns the accuracy half-way between `accuracy` and the chance level.
    fn half_accuracy(&self, accuracy: f64) -> f64 {
        self.chance + 0.5 * (accuracy - self.chance)
    }

    /// Returns the indices of the condition's values, from the value with the highest accuracy to the smallest or the largest value.
    fn outwards(&self, direction: Direction) -> Vec<usize> {
        match direction {
            Direction::Smaller => (0..=self.best()).rev().collect(),
            Direction::Larger => (self.best()..self.values.len()).collect(),
        }
    }

    /// Returns the smallest positive value of a condition, and whether values above that value are shown on a logarithmic axis.
    fn scale(&self) -> (f64, bool) {
        let positive = self.values.iter().copied().filter(|&value| value > 0.0);
        let start = positive.fold(f64::INFINITY, f64::min);
        let last = self.values[self.values.len() - 1];
        (start, self.values[0] >= 0.0 && last / start >= LOG_RATIO)
    }

    /// Returns the position of a condition's value along its linear or logarithmic axis.
    fn place(&self, value: f64) -> f64 {
        match self.scale() {
            (_, false) => value,
            (start, true) if value < start => ZERO_DECADES * (value / start - 1.0),
            (start, true) => (value / start).log10(),
        }
    }

    /// Returns the value of the condition at a position along its axis; the inverse function of `place`.
    fn value(&self, place: f64) -> f64 {
        match self.scale() {
            (_, false) => place,
            (start, true) if place < 0.0 => start * (1.0 + place / ZERO_DECADES),
            (start, true) => start * 10f64.powf(place),
        }
    }

    /// Returns whether half of the accuracy above chance is lost, the value of the condition at which it is lost, and the two ends of the value's interval. A
    /// number is `None` if it lies beyond the last value of the condition, or if the design is at chance.
    fn half(&self, direction: Direction, seed: &Seed) -> (HalfStatus, [Option<f64>; 3]) {
        let places: Vec<f64> = self.values.iter().map(|&value| self.place(value)).collect();
        let outwards = self.outwards(direction);
        let beyond = match direction {
            Direction::Smaller => f64::NEG_INFINITY,
            Direction::Larger => f64::INFINITY,
        };
        let crossing = |accuracy: &[f64]| {
            let highest = accuracy[outwards[0]];
            let half = self.half_accuracy(highest);
            let mut steps = outwards.windows(2);
            // The start is above half-way, and so is the accuracy before the first one that is not.
            let found = steps.find(|step| accuracy[step[1]] <= half).map(|step| {
                let (before, after) = (accuracy[step[0]], accuracy[step[1]]);
                let fraction = (before - half) / (before - after);
                places[step[0]] + fraction * (places[step[1]] - places[step[0]])
            });
            (highest > self.chance).then(|| found.unwrap_or(beyond))
        };
        let pairs = self.accuracy.iter().zip(&self.n_test);
        let betas = pairs.map(|(accuracy, n)| {
            let n_correct = accuracy * n;
            Beta::new(n_correct + 0.5, n - n_correct + 0.5).expect("both are positive")
        });
        let betas: Vec<Beta<f64>> = betas.collect();
        let mut rng = seed.rng();
        let mut draw = || {
            let drawn = betas.iter().map(|beta| beta.sample(&mut rng));
            crossing(&drawn.collect::<Vec<_>>())
        };
        let mut draws: Vec<f64> = (0..N_DRAWS).filter_map(|_| draw()).collect();
        draws.sort_by(f64::total_cmp);
        let tail = |n: usize| (0.5 * (1.0 - CONFIDENCE) * n as f64) as usize;
        let n_at_chance = (N_DRAWS - draws.len()) * self.values.len();
        let found = crossing(&self.accuracy).filter(|_| n_at_chance <= tail(N_DRAWS));
        let Some(place) = found else {
            return (HalfStatus::AllAtChance, [None; 3]);
        };
        let tail = tail(draws.len());
        let ends = [place, draws[tail], draws[draws.len() - 1 - tail]];
        let values = ends.map(|place| place.is_finite().then(|| self.value(place)));
        match values[0] {
            Some(_) => (HalfStatus::Found, values),
            None => (HalfStatus::BeyondTheLastValue, values),
        }
    }
}

/// Returns the number of test rows (at least 1) for which the 95 % Wilson interval around `accuracy` has the given width.
fn rows_of_interval(accuracy: f64, width: f64) -> f64 {
    // With a = z² / n and q = p (1 − p): width² (1 + a)² = 4 a q + a².
    const Z: f64 = 1.959_963_984_540_054;
    let (squared, q) = (width * width, accuracy * (1.0 - accuracy));
    if !(squared > 0.0 && squared < 1.0) {
        return 1.0;
    }
    let b = 2.0 * q - squared;
    let a = (-b + (b * b + (1.0 - squared) * squared).sqrt()) / (1.0 - squared);
    (Z * Z / a).max(1.0)
}

/// Returns the robustness table, computed from `summary`, which has one row per configuration. Returns `None` if no numeric condition has enough values.
///
/// # Errors
/// If an accuracy of the summary is not between 0 and 1, or a row cannot be written to a file.
pub(crate) fn robustness(summary: &Table, confusion: &Table) -> Result<Option<Table>> {
    let accuracies = summary.numbers("accuracy").unwrap_or_default();
    if let Some(row) = accuracies.iter().position(|one| !(0.0..=1.0).contains(one)) {
        // The first line of the file is its header.
        let place = format!("{}:{}, accuracy", summary.file, row + 2);
        return Err(Error::input(place, accuracies[row], "between 0 and 1"));
    }
    let chances = ChanceLevels::new(confusion);
    let mut rows = Vec::new();
    let swept = Swept::of(summary);
    let choices = swept.one_at_a_time.iter();
    let choices = choices.filter(|one| one.column.role == Role::Choice);
    let choices: Vec<&str> = choices.map(|one| &one.column.name[..]).collect();
    let follows = |column: &str| {
        let mut following = swept.following.iter();
        following.any(|one| one.column.name == column)
    };
    let conditions = summary.of_role(Role::Condition).into_iter();
    for condition in conditions.chain(choices.iter().copied()) {
        let is_choice = choices.contains(&condition);
        let Some((column, data @ Data::Numbers(values))) = summary.column(condition) else {
            continue;
        };
        let setting = Setting { column, data };
        let others = [Role::Choice, Role::Condition].map(|role| summary.of_role(role));
        let mut others = others.concat();
        others.retain(|column| *column != condition && !(is_choice && follows(column)));
        let curves = summary.groups(&others, 0..summary.n_rows).into_iter();
        let curves = curves.filter_map(|mut along| {
            along.retain(|&row| setting.position(row).is_some_and(f64::is_finite));
            along.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
            let repeats = |pair: &[usize]| values[pair[0]] == values[pair[1]];
            (along.len() >= MIN_VALUES && !along.windows(2).any(repeats)).then_some(along)
        });
        let curves: Vec<Vec<usize>> = curves.collect();
        let settings = Swept::new(summary, &curves.concat()).free;
        let sides = curves
            .par_iter()
            .flat_map_iter(|along| both_sides(summary, &chances, (condition, along), &settings));
        rows.par_extend(sides);
    }
    match rows.is_empty() {
        true => Ok(None),
        false => ROBUSTNESS.table(&rows).map(Some),
    }
}

/// Returns one row for each direction, starting from the highest accuracy, in which the condition has further values.
fn both_sides(
    summary: &Table,
    chances: &ChanceLevels,
    (condition, along): (&str, &[usize]),
    settings: &[Setting],
) -> Vec<Robustness> {
    let numbers = |column: &str| -> Vec<f64> {
        let rows = along.iter();
        rows.map(|&row| summary.number(column, row)).collect()
    };
    let n_test = along.iter().map(|&row| {
        let [accuracy, low, high] =
            ["accuracy", "accuracy_low", "accuracy_high"].map(|column| summary.number(column, row));
        rows_of_interval(accuracy, high - low)
    });
    let mut curve = Curve {
        values: numbers(condition),
        n_test: n_test.collect(),
        accuracy: numbers("accuracy"),
        chance: 0.0,
    };
    let best = curve.best();
    let row = along[best];
    let configuration = summary.number("configuration", row);
    curve.chance = chances.of(configuration).accuracy;
    let others = settings.iter().filter(|one| one.column.name != condition);
    let design = Setting::phrases(&others.copied().collect::<Vec<_>>(), row);
    let clean = curve.accuracy[best];
    let seed = Seed::new(0).named("robustness").named(condition);
    let seed = seed.numbered(configuration as u64);
    let side = |direction: Direction| {
        let outwards = curve.outwards(direction);
        let end = *outwards[1..].last()?;
        let seed = seed.numbered(direction as u64);
        let (status, [at, low, high]) = curve.half(direction, &seed);
        Some(Robustness {
            configuration: configuration as usize,
            design: design.clone(),
            condition: condition.to_owned(),
            direction,
            clean_at: curve.values[best],
            clean_accuracy: clean,
            chance: curve.chance,
            half_accuracy: curve.half_accuracy(clean),
            status,
            half_accuracy_at: at,
            half_accuracy_at_low: low,
            half_accuracy_at_high: high,
            end: curve.values[end],
            accuracy_at_end: curve.accuracy[end],
        })
    };
    let sides = [Direction::Larger, Direction::Smaller].map(side);
    sides.into_iter().flatten().collect()
}

/// Maximum number of conditions that a sentence lists; a chart marks the values of more conditions.
const MAX_LISTED: usize = 3;

/// Returns the values of a condition at which half of the accuracy above chance is lost, from the first to the last design that loses it: one text per direction,
/// such as `18–21 mm`, and none if no design loses it. Returns `None` if the table lacks the condition.
pub(crate) fn breaks(robustness: &Table, condition: &Column) -> Option<Vec<String>> {
    let rows = 0..robustness.n_rows;
    let own = rows.filter(|&row| robustness.word("condition", row) == condition.name);
    let directions = robustness.groups(&["direction"], own);
    let words = |rows: &Vec<usize>| {
        let at = rows.iter();
        let at = at.map(|&row| robustness.number("half_accuracy_at", row));
        let mut at: Vec<f64> = at.filter(|at| at.is_finite()).collect();
        at.sort_by(f64::total_cmp);
        let two_digits = |&number: &f64| format!("{number:.1e}").parse().unwrap_or(number);
        let [low, high] = [at.first()?, at.last()?].map(two_digits);
        let range = match condition.number_words(high) {
            high_words if low < high => format!("{}–{high_words}", condition.tick(low)),
            one => one,
        };
        Some(match (at.len(), rows.len()) {
            (n, all) if n < all => format!("{range} ({n} of {all} designs)"),
            _ => range,
        })
    };
    (!directions.is_empty()).then(|| directions.iter().filter_map(words).collect())
}

/// Returns a sentence on the conditions in which half of the accuracy above chance is lost, with their values if they are few, and on the conditions in which no
/// design loses it. Returns `None` if the study drives no condition.
pub(crate) fn robustness_words(tables: &[Table]) -> Option<String> {
    let of = |file: &str| tables.iter().find(|table| table.file == file);
    let (summary, table) = (of("summary.csv")?, of(ROBUSTNESS.name())?);
    let (mut lost, mut never) = (Vec::new(), Vec::new());
    for rows in table.groups(&["condition"], 0..table.n_rows) {
        let (column, _) = summary.column(table.word("condition", rows[0]))?;
        match &breaks(table, column)?[..] {
            [] => never.push(&column.words[..]),
            at => lost.push(format!("{} {}", column.words, at.join(" and "))),
        }
    }
    let said = match lost.len() {
        0 => "kept".to_owned(),
        n if n > MAX_LISTED => format!("lost in {n} of {} settings", n + never.len()),
        _ => format!("lost at {}", lost.join(", ")),
    };
    let never = match &never.join(", ")[..] {
        "" => String::new(),
        words => format!("; never with {words}"),
    };
    Some(format!(
        "Half of the accuracy above chance is {said}{never}."
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::interval::Interval;
    use crate::studies::recognition::rows::configuration::Configuration;
    use crate::studies::recognition::rows::configuration::tests::configuration;
    use crate::studies::recognition::rows::table_rows::{ConfigurationScore, Confusion};
    use rand_distr::Binomial;

    fn curve(values: &[f64], accuracy: &[f64], n_test: f64, chance: f64) -> Curve {
        Curve {
            values: values.to_vec(),
            accuracy: accuracy.to_vec(),
            n_test: vec![n_test; values.len()],
            chance,
        }
    }

    /// Returns test tables of configurations that differ in C and noise, with ten objects.
    fn tables_of(accuracies: &[(f64, f64, f64)]) -> (Table, Option<Table>) {
        let n_test = 1000;
        let configurations = accuracies.iter().enumerate();
        let configurations = configurations.map(|(number, &(c, noise_std, accuracy))| {
            let configuration = Configuration {
                configuration: number,
                c: Some(c),
                noise_std,
                ..configuration()
            };
            let n_correct = (accuracy * n_test as f64) as usize;
            let interval = Interval::wilson(n_correct, n_test, 0.95).unwrap();
            let score = ConfigurationScore {
                n_trials: 1,
                n_test,
                accuracy,
                accuracy_std: 0.0,
                accuracy_low: interval.low,
                accuracy_high: interval.high,
                n_groups: None,
                bootstrap_low: None,
                bootstrap_high: None,
                macro_f1: accuracy,
                balanced_accuracy: None,
                log_loss: None,
                n_capped: 0,
            };
            (configuration, score)
        });
        let rows = (0..10).map(|object| Confusion {
            configuration: 0,
            object: format!("object {object}"),
            predicted: "object 0".to_owned(),
            count: 1,
        });
        let summary = File::<(Configuration, ConfigurationScore)>::new("summary.csv", "", "");
        let summary = summary.table(&configurations.collect::<Vec<_>>()).unwrap();
        let confusion = File::<Confusion>::new("confusion.csv", "", "");
        let confusion = confusion.table(&rows.collect::<Vec<_>>()).unwrap();
        let robustness = robustness(&summary, &confusion).unwrap();
        (summary, robustness)
    }

    #[test]
    fn a_planted_curve_has_its_half_point_for_each_design() {
        let planted = [
            // 0.9 falls by 0.1 for each 0.1 of noise: half-way to chance 0.1 is 0.5, at a noise of 0.4.
            (1.0, 0.1, 0.8),
            (1.0, 0.0, 0.9),
            (1.0, 0.3, 0.6),
            (1.0, 0.6, 0.3),
            // The accuracy stays above half-way.
            (10.0, 0.0, 0.9),
            (10.0, 0.1, 0.95),
            (10.0, 0.3, 0.8),
            (10.0, 0.6, 0.7),
            // The accuracy is at chance.
            (100.0, 0.0, 0.1),
            (100.0, 0.1, 0.1),
            (100.0, 0.3, 0.08),
        ];
        let (summary, table) = tables_of(&planted);
        let table = table.unwrap();
        let words = |column: &str| -> Vec<String> {
            let rows = 0..table.n_rows;
            rows.map(|row| table.words(column, row)).collect()
        };
        assert_eq!(words("design"), ["C = 1", "C = 10", "C = 10", "C = 100"]);
        assert_eq!(
            words("direction"),
            ["larger", "larger", "smaller", "larger"]
        );
        assert_eq!(words("condition"), ["noise std"; 4]);
        let beyond = "beyond the last value";
        assert_eq!(words("status"), ["found", beyond, beyond, "all at chance"]);
        let number = |column: &str, row: usize| table.number(column, row);
        assert!((number("half_accuracy_at", 0) - 0.4).abs() < 1e-9);
        let (low, high) = (
            number("half_accuracy_at_low", 0),
            number("half_accuracy_at_high", 0),
        );
        assert!(
            0.35 < low && low < 0.39 && 0.41 < high && high < 0.45,
            "{low} {high}"
        );
        assert_eq!((number("clean_at", 0), number("clean_at", 1)), (0.0, 0.1));
        assert!((number("half_accuracy", 0) - 0.5).abs() < 1e-12);
        for row in 1..4 {
            assert!(number("half_accuracy_at", row).is_nan());
        }
        assert_eq!((number("end", 2), number("accuracy_at_end", 2)), (0.0, 0.9));
        let said = robustness_words(&[summary, table]).unwrap();
        let wanted = "Half of the accuracy above chance is lost at noise 40 % (1 of 3 designs).";
        assert_eq!(said, wanted);
        // Two values do not determine a curve.
        assert_eq!(tables_of(&planted[..2]).1, None);
    }

    #[test]
    fn half_way_lies_on_a_line_between_two_values_on_the_scale_of_the_condition() {
        // Half-way from 0.9 to chance 0.1 is 0.5.
        let log = curve(&[0.01, 0.1, 1.0, 10.0], &[0.9, 0.7, 0.3, 0.1], 1e6, 0.1);
        let half = |curve: &Curve, direction| curve.half(direction, &Seed::new(1));
        let [at, low, high] = half(&log, Direction::Larger).1.map(Option::unwrap);
        assert!((at - 10f64.powf(-0.5)).abs() < 1e-9, "{at}");
        assert!(low < at && at < high && high < 1.05 * low);
        let linear = curve(&[1.0, 2.0, 3.0], &[0.1, 0.9, 0.7], 1e6, 0.1);
        let (status, [at, ..]) = half(&linear, Direction::Smaller);
        assert_eq!(status, HalfStatus::Found);
        assert!((at.unwrap() - 1.5).abs() < 1e-9);
        let beyond = (HalfStatus::BeyondTheLastValue, [None; 3]);
        assert_eq!(half(&linear, Direction::Larger), beyond);
        // With few test rows the lower end may exist although the value itself does not.
        let unsure = curve(&[0.0, 1.0, 2.0], &[0.9, 0.8, 0.55], 12.0, 0.1);
        let (_, [at, low, high]) = half(&unsure, Direction::Larger);
        assert!(at.is_none() && low.unwrap() < 2.0 && high.is_none());
    }

    #[test]
    fn every_end_lies_between_the_start_and_the_last_value_or_is_empty() {
        let mut n_found = 0;
        for case in 0..300 {
            let mut rng = Seed::new(7).numbered(case).rng();
            // Few test rows near chance: many draws are below chance at the start. Half of the sweeps have a zero, some are logarithmic or negative.
            let shift = [0.0, 1.0, -2.5, 1e-3][case as usize % 4];
            let values = [0.0, 0.5, 2.0, 3.0, 40.0].map(|value| value + shift);
            let accuracy =
                values.map(|_| Binomial::new(20, 0.3).unwrap().sample(&mut rng) as f64 / 20.0);
            let curve = curve(&values, &accuracy, 20.0, 0.1);
            for direction in [Direction::Larger, Direction::Smaller] {
                let outwards = curve.outwards(direction);
                let ends = [outwards[0], outwards[outwards.len() - 1]];
                let ends = ends.map(|place| curve.values[place]);
                let range = ends[0].min(ends[1]) - 1e-9..=ends[0].max(ends[1]) + 1e-9;
                let (status, found) = curve.half(direction, &Seed::new(case));
                n_found += usize::from(status == HalfStatus::Found);
                for value in found.into_iter().flatten() {
                    assert!(range.contains(&value), "{value} {ends:?} {accuracy:?}");
                }
            }
        }
        assert!(n_found > 50, "{n_found}");
    }

    #[test]
    fn designs_that_guess_are_at_chance() {
        let n_cases = 200;
        let is_said = |case: &u64| {
            let mut rng = Seed::new(8).numbered(*case).rng();
            let guesses =
                [0.0; 11].map(|_| Binomial::new(100, 0.1).unwrap().sample(&mut rng) as f64 / 100.0);
            let values: Vec<f64> = (0..11).map(f64::from).collect();
            let curve = curve(&values, &guesses, 100.0, 0.1);
            curve.half(Direction::Larger, &Seed::new(*case)).0 != HalfStatus::AllAtChance
        };
        let n_said = (0..n_cases).filter(is_said).count();
        assert!(n_said <= 10, "{n_said} of {n_cases} designs");
    }

    #[test]
    fn the_interval_holds_the_true_place_as_often_as_it_says() {
        let values: Vec<f64> = (1..10).map(f64::from).collect();
        let truth = values.iter().map(|x| 0.1 + 0.8 / (1.0 + (x / 5.0).powi(4)));
        let truth: Vec<f64> = truth.collect();
        let n = 400;
        let half = |accuracy: &[f64], seed| {
            let curve = curve(&values, accuracy, n as f64, 0.1);
            let (_, half) = curve.half(Direction::Larger, &Seed::new(seed));
            half.map(|place| place.unwrap_or(f64::INFINITY))
        };
        let [exact, ..] = half(&truth, 0);
        let n_cases = 200;
        let holds = |case: &u64| {
            let mut rng = Seed::new(9).named("cases").numbered(*case).rng();
            let mut draw =
                |&p: &f64| Binomial::new(n, p).unwrap().sample(&mut rng) as f64 / n as f64;
            let seen: Vec<f64> = truth.iter().map(&mut draw).collect();
            let [_, low, high] = half(&seen, *case);
            low <= exact && exact <= high
        };
        let share = (0..n_cases).filter(holds).count() as f64 / n_cases as f64;
        assert!((0.9..=0.995).contains(&share), "{share}");
    }

    #[test]
    fn places_and_values_are_inverse_with_a_zero() {
        let curve = curve(&[0.0, 0.01, 10.0], &[0.9; 3], 1.0, 0.1);
        for value in [0.0, 1e-3, 0.01, 0.5, 7.0] {
            assert!((curve.value(curve.place(value)) - value).abs() < 1e-12);
        }
        assert_eq!(curve.place(0.0), -ZERO_DECADES);
    }

    #[test]
    fn the_width_of_wilsons_interval_gives_its_rows() {
        for (n_correct, n) in [(50, 100), (100, 100), (299, 320), (0, 7)] {
            let interval = Interval::wilson(n_correct, n, 0.95).unwrap();
            let found = rows_of_interval(n_correct as f64 / n as f64, interval.high - interval.low);
            assert!((found - n as f64).abs() < 1e-6 * n as f64, "{found} {n}");
        }
    }
}
