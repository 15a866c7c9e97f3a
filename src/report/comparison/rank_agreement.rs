//! Agreement between the rankings of designs in two studies, for example of a simulated and a real skin, whose settings may differ.
//!
//! A design is a combination of the choices and conditions for which both tables have common values. Rows with a value that only one table has are omitted. The
//! accuracy is averaged over all other columns.
//!
//! Two values are equal if their numbers and units are exactly equal. "Does not apply" (such as C of a k-NN classifier) is also a value. Compression ratios of
//! two tables are equal if one nominal ratio r gives both numbers of measurements m. For n taxels, m = n / r, rounded if n is not divisible by r.

use crate::report::swept::Setting;
use crate::statistics::p_status::CONFIDENCE;
use crate::statistics::rank_correlation::{SUFFICIENT_SETTINGS, kendall, kendall_interval};
use crate::table::{Column, Role, Table, Value, short_number};
use bubbletouch_sim::statistics::interval::Interval;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Name of the column by which designs are ranked.
const RANKED: &str = "accuracy";
/// Minimum number of designs in both studies for which their rankings are compared.
const FEWEST: usize = 5;

/// Agreement between the rankings of designs in two studies.
#[derive(Clone, Debug, PartialEq)]
pub struct RankAgreement {
    /// Number of designs that both studies contain.
    pub n_designs: usize,
    /// Kendall's rank correlation τ of the designs' accuracies in the two studies, −1 ≤ τ ≤ 1.
    pub tau: f64,
    /// Bootstrap confidence interval of the rank correlation over designs.
    pub interval: Interval,
    /// Description of each choice, with two counts of pairs of designs that differ only in this choice, and in choices that apply to one of its two values
    /// alone. The first is the number of pairs that both studies order alike; the second is the number of all pairs without a tie.
    pub choices: Vec<(String, usize, usize)>,
}

/// Compares the rankings of designs in two studies, from the first table with accuracies of each study. Returns `None` if the studies have too few common
/// designs.
pub fn rank_agreement(first: &[Table], second: &[Table]) -> Option<RankAgreement> {
    let ranked = |tables: &'_ [Table]| {
        let mut places = 0..tables.len();
        places.find(|&place| tables[place].numbers(RANKED).is_some())
    };
    let (first, second) = (&first[ranked(first)?], &second[ranked(second)?]);
    let (first, second) = (&Ranked::new(first), &Ranked::like(second, first));
    let shared = shared_choices(first, second);
    let (ours, theirs) = (designs(second, &shared), designs(first, &shared));
    let both: Vec<(&Design, [f64; 2])> = theirs
        .iter()
        .filter_map(|(design, accuracy)| Some((design, [*accuracy, *ours.get(design)?])))
        .collect();
    if both.len() < FEWEST {
        return None;
    }
    let accuracies: Vec<[f64; 2]> = both.iter().map(|(_, accuracies)| *accuracies).collect();
    let told = shared
        .iter()
        .enumerate()
        .filter(|(_, choice)| choice.values.len() > 1);
    Some(RankAgreement {
        n_designs: both.len(),
        tau: kendall(&accuracies)?,
        interval: kendall_interval(&accuracies, CONFIDENCE)?,
        choices: told
            .map(|(place, choice)| {
                let (same, all) = in_order(&both, place);
                (choice.column.words.to_string(), same, all)
            })
            .filter(|(.., all)| *all > 0)
            .collect(),
    })
}

impl RankAgreement {
    /// Returns two sentences that describe the agreement of the rankings.
    pub fn words(&self) -> Vec<String> {
        let [tau, low, high] = [self.tau, self.interval.low, self.interval.high].map(short_number);
        let choices = self.choices.iter();
        let choices = choices.map(|(words, same, all)| format!("{same} of {all} of {words}"));
        let choices: Vec<String> = choices.collect();
        let few = match self.n_designs < SUFFICIENT_SETTINGS {
            true => ", too narrow for so few designs",
            false => "",
        };
        vec![
            format!(
                "Both rank {} designs with a Kendall's τ of {tau} (95 % bootstrap interval {low} to {high}{few}).",
                self.n_designs
            ),
            format!(
                "Pairs of designs that differ in one choice alone and have the same order: {}.",
                choices.join(", ")
            ),
        ]
    }
}

/// Choice by which designs differ, with the values that occur in both tables.
struct Choice<'a> {
    column: &'a Column,
    values: BTreeSet<String>,
}

/// Design, given by the values of all its choices.
type Design = Vec<String>;

/// Table of a study in which compression ratios can be replaced by equivalent ratios of another table.
struct Ranked<'a> {
    table: &'a Table,
    /// Equivalent compression ratio in the other table for each compression ratio (as bits) of this table.
    ratios: HashMap<u64, f64>,
}

impl<'a> Ranked<'a> {
    fn new(table: &'a Table) -> Self {
        let ratios = HashMap::new();
        Self { table, ratios }
    }

    /// Pairs each compression ratio with the nearest ratio of the other table, if both can result from rounding one ratio.
    fn like(table: &'a Table, other: &Table) -> Self {
        let (ours, theirs) = (nominal_ratios(table), nominal_ratios(other));
        let nearest = |of: &NominalRatio, among: &[NominalRatio]| {
            let same = among.iter().copied().filter(|one| one.overlaps(of));
            same.min_by(|a, b| a.distance(of).total_cmp(&b.distance(of)))
        };
        let pairs = ours.iter().filter_map(|own| {
            let other = nearest(own, &theirs)?;
            let back = nearest(&other, &ours)?;
            (back == *own).then_some((own.ratio.to_bits(), other.ratio))
        });
        let ratios = pairs.collect();
        Self { table, ratios }
    }

    /// Returns the entry of a row as text with its unit; empty for a setting that does not apply, `None` without such a column.
    fn value(&self, column: &str, row: usize) -> Option<String> {
        let (column, data) = self.table.column(column)?;
        Some(match data.value(row) {
            None => String::new(),
            Some(Value::Number(number)) => {
                let is_ratio = column.name == "ratio";
                let other = self.ratios.get(&number.to_bits()).filter(|_| is_ratio);
                format!("{} {}", other.unwrap_or(&number), column.unit)
            }
            Some(Value::Word(word)) => word,
        })
    }
}

/// Compression ratio, and the range of ratios that would round to its number of measurements.
#[derive(Clone, Copy, PartialEq)]
struct NominalRatio {
    ratio: f64,
    least: f64,
    most: f64,
}

impl NominalRatio {
    fn overlaps(&self, other: &Self) -> bool {
        self.ratio == other.ratio || (self.least <= other.most && other.least <= self.most)
    }

    fn distance(&self, other: &Self) -> f64 {
        (self.ratio / other.ratio).ln().abs()
    }
}

/// Returns the distinct compression ratios in a table. Without numbers of measurements, each ratio is its own nominal ratio.
fn nominal_ratios(table: &Table) -> Vec<NominalRatio> {
    let rows = table.groups(&["ratio"], 0..table.n_rows);
    let ratios = rows.iter().map(|rows| {
        let ratio = table.number("ratio", rows[0]);
        let m = table.number("measurements", rows[0]);
        let n = ratio * m;
        let (least, most) = match m >= 1.0 {
            true => (n / (m + 0.5), n / (m - 0.5)),
            false => (ratio, ratio),
        };
        NominalRatio { ratio, least, most }
    });
    ratios.filter(|one| one.ratio.is_finite()).collect()
}

fn shared_choices<'a>(first: &Ranked<'a>, second: &Ranked) -> Vec<Choice<'a>> {
    let has_ratio = first.table.place("ratio").is_some();
    let choices = Setting::of_roles(first.table, &[Role::Choice, Role::Condition]);
    // Arrays of two sizes can share a compression ratio, but equal numbers of measurements mean different ratios.
    let choices = choices.filter(|one| !(has_ratio && one.column.name == "measurements"));
    let choices = choices.filter_map(|one| {
        let values = |ranked: &Ranked| -> BTreeSet<String> {
            let rows = 0..ranked.table.n_rows;
            let values = rows.filter_map(|row| ranked.value(&one.column.name, row));
            values.collect()
        };
        let (ours, theirs) = (values(second), values(first));
        let values: BTreeSet<String> = ours.intersection(&theirs).cloned().collect();
        (!values.is_empty()).then_some(Choice {
            column: one.column,
            values,
        })
    });
    choices.collect()
}

/// Returns the mean accuracy of each design whose choices occur in both tables.
fn designs(ranked: &Ranked, shared: &[Choice]) -> BTreeMap<Design, f64> {
    let mut sums: BTreeMap<Design, (f64, f64)> = BTreeMap::new();
    for row in 0..ranked.table.n_rows {
        let values = shared.iter().map(|choice| {
            let value = ranked.value(&choice.column.name, row)?;
            choice.values.contains(&value).then_some(value)
        });
        let accuracy = ranked.table.number(RANKED, row);
        if let Some(design) = values.collect::<Option<Design>>()
            && accuracy.is_finite()
        {
            let (sum, n) = sums.entry(design).or_default();
            *sum += accuracy;
            *n += 1.0;
        }
    }
    let means = sums.into_iter().map(|(design, (sum, n))| (design, sum / n));
    means.collect()
}

/// Counts pairs of designs that differ only in one choice and have no tie. Returns the number of pairs with the same order in both studies, and the number of
/// all pairs. A choice that applies to one of the two values alone is no further difference, such as C beside a classifier without C.
fn in_order(designs: &[(&Design, [f64; 2])], choice: usize) -> (usize, usize) {
    let n_choices = designs.first().map_or(0, |(design, _)| design.len());
    let others = (0..n_choices).filter(|&other| other != choice);
    let others: Vec<(usize, bool)> = others
        .map(|other| (other, decides(designs, choice, other)))
        .collect();
    let differ_in_it_alone = |a: &Design, b: &Design| {
        let mut others = others.iter();
        others.all(|&(other, is_decided)| {
            let applies_to_one = a[other].is_empty() != b[other].is_empty();
            a[other] == b[other] || (is_decided && applies_to_one)
        })
    };
    let (mut same, mut all) = (0, 0);
    for (place, (design, own)) in designs.iter().enumerate() {
        for (other, its) in &designs[..place] {
            let order = (own[0] - its[0]) * (own[1] - its[1]);
            if order != 0.0 && design[choice] != other[choice] && differ_in_it_alone(design, other)
            {
                all += 1;
                same += usize::from(order > 0.0);
            }
        }
    }
    (same, all)
}

/// Returns whether the value of one choice decides whether another choice applies: each value has it in all designs or in none.
fn decides(designs: &[(&Design, [f64; 2])], choice: usize, other: usize) -> bool {
    let mut applies: HashMap<&str, bool> = HashMap::new();
    designs.iter().all(|(design, _)| {
        let is_there = !design[other].is_empty();
        *applies.entry(&design[choice]).or_insert(is_there) == is_there
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::File;

    crate::row! {
    /// Row of a test table, which contains a design of a study and its accuracy.
    pub struct DesignRow {
        /// Number of taxels.
        taxels: usize => Choice: Linear;
        /// Name of the measurement ensemble.
        ensemble: String => Choice;
        /// Compression ratio (taxels per measurement).
        ratio: f64 => Choice in ":1": Log;
        /// Number of measurements after compression.
        measurements: usize => Choice "m": Log;
        /// Standard deviation of the sensor noise.
        noise_std: f64 => Condition: Linear;
        /// Accuracy of the design, by which designs are ranked.
        accuracy: f64 => Value(More): Share;
    } }

    const FILE: File<DesignRow> = File::new("accuracy.csv", "Accuracy", "");

    /// Returns a test table: three ensembles (block averages, Gaussian, subsampling), two compression ratios and the given noise levels.
    fn table(n_taxels: usize, accuracies: [f64; 6], noises: &[f64]) -> Vec<Table> {
        let mut rows = Vec::new();
        for (design, accuracy) in accuracies.into_iter().enumerate() {
            for (twice, noise_std) in noises.iter().enumerate() {
                let measurements = n_taxels / [4, 16][design % 2];
                rows.push(DesignRow {
                    taxels: n_taxels,
                    ensemble: ["block_average", "gaussian", "subsample"][design / 2].to_owned(),
                    ratio: n_taxels as f64 / measurements as f64,
                    measurements,
                    noise_std: *noise_std,
                    // The mean over both noises is ranked.
                    accuracy: accuracy + 0.3 * (twice as f64 - 0.5),
                });
            }
        }
        vec![FILE.table(&rows).unwrap()]
    }

    const REAL: [f64; 6] = [0.97, 0.90, 0.90, 0.81, 0.80, 0.60];

    #[test]
    fn studies_that_share_no_setting_are_compared_by_the_order_of_their_designs() {
        let real = table(1400, REAL, &[0.0, 0.0]);
        let found = rank_agreement(&table(4096, REAL.map(|a| 0.5 * a), &[0.1, 0.1]), &real);
        let found = found.unwrap();
        assert_eq!((found.n_designs, found.tau), (6, 1.0));
        let choice = |words: &str, pairs| (words.to_owned(), pairs, pairs);
        let (ensembles, ratios) = (choice("ensemble", 6), choice("ratio", 3));
        assert_eq!(found.choices, [ensembles, ratios]);
        // Two ensembles at one ratio are exchanged. This changes one of 14 pairs without a tie, and one of the pairs that differ in the ensemble.
        let mut other = REAL;
        other.swap(1, 3);
        let found = rank_agreement(&table(4096, other, &[0.1, 0.1]), &real).unwrap();
        assert!(
            found.tau < 1.0 && found.interval.low < found.tau,
            "{found:?}"
        );
        assert_eq!(found.choices[0], ("ensemble".to_owned(), 5, 6));
        let reversed = rank_agreement(&table(4096, REAL.map(|a| -a), &[0.1, 0.1]), &real);
        assert_eq!(reversed.unwrap().tau, -1.0);
    }

    #[test]
    fn a_choice_counts_although_another_applies_to_one_of_its_values_alone() {
        let design =
            |words: [&str; 3], accuracy: f64| (words.map(str::to_owned).to_vec(), [accuracy; 2]);
        let designs = [
            design(["svm", "1", "4"], 0.9),
            design(["svm", "10", "4"], 0.8),
            design(["k_nearest", "", "4"], 0.7),
            design(["svm", "1", "16"], 0.6),
            design(["svm", "10", "16"], 0.5),
            design(["k_nearest", "", "16"], 0.4),
        ];
        let designs: Vec<(&Design, [f64; 2])> = designs.iter().map(|(d, a)| (d, *a)).collect();
        // Classifier: each k-NN beside both SVMs of its ratio. C: the SVMs alone. Ratio: three pairs.
        assert_eq!(
            [0, 1, 2].map(|choice| in_order(&designs, choice).1),
            [4, 2, 3]
        );
        // An axis that one configuration alone varies does not apply to the others, but no choice decides this.
        let designs = [
            design(["4", "", "svm"], 0.9),
            design(["16", "", "svm"], 0.8),
            design(["4", "0.5", "svm"], 0.7),
        ];
        let designs: Vec<(&Design, [f64; 2])> = designs.iter().map(|(d, a)| (d, *a)).collect();
        assert_eq!([0, 1].map(|choice| in_order(&designs, choice).1), [1, 1]);
    }

    #[test]
    fn values_that_one_study_has_alone_are_left_out() {
        let real = table(1400, REAL, &[0.0]);
        let found = rank_agreement(&table(4096, REAL, &[0.0, 0.4]), &real).unwrap();
        assert_eq!((found.n_designs, found.tau), (6, 1.0));
        let few = table(1400, REAL, &[0.0]);
        let others: Vec<Table> = Vec::new();
        assert_eq!(rank_agreement(&few, &others), None);
    }
}
