//! Confidence intervals of an accuracy whose test rows are held out in groups. A group may be all rows of a pose, a yaw, a grasp or a day.
//!
//! Outcomes of one group are correlated, so n rows of few groups contain less information than n independent rows. The interval describes how the accuracy
//! differs between groups. Source: Abadie et al., *When should you adjust standard errors for clustering?*, Quarterly Journal of Economics 138, 2023 (whole
//! groups are sampled).
//!
//! The accuracy over T tests is θ = 1/T Σ_t c_t/n_t. In test t, group g has n_gt rows, of which c_gt are correct. Then
//!
//! ```text
//! w_g = 1/T Σ_t n_gt/n_t     e_g = 1/T Σ_t (c_gt − θ n_gt)/n_t
//! V   = G/(G − 1) Σ_g e_g²   the cluster-robust variance of θ
//! D   = n V / θ(1 − θ)       the design effect, at least 1
//! M   = n Σ w_g² / (Σ w_g)²  the design effect if all rows of a group have one outcome
//! D*  = (k D + M)/(k + 1)    k = n min(θ, 1 − θ): number of rows with the rarer outcome
//! ```
//!
//! The interval is Wilson's interval for n/D* rows, with Student's t of G − 1 degrees of freedom instead of the normal quantile.
//!
//! - Counts divided by the design effect behave as counts of independent rows: Rao and Scott, *A simple method for the analysis of clustered binary data*,
//!   Biometrics 48, 1992.
//! - Student's t: Korn and Graubard, *Confidence intervals for proportions with small expected number of positive counts estimated from survey data*, Survey
//!   Methodology 24, 1998.
//!
//! Unlike in both sources, D* replaces D, because a few errors cannot show whether errors are clustered. Without errors, D is unknown, and each group
//! counts as one row. Each observed error increases the weight of D.
//!
//! Several tests may split one set of touches, so a group can be tested several times. The number n counts the rows of each group once.

use crate::statistics::comparison::student;
use crate::{Error, Result};
use bubbletouch_sim::statistics::interval::{Interval, check_confidence};
use serde::{Deserialize, Serialize};
use statrs::distribution::ContinuousCDF;
use std::collections::BTreeMap;

/// Minimum number of groups for an informative interval. With four groups, the 95 % quantile of Student's t is 3.2, whereas the normal quantile is 2.
pub const FEW_GROUPS: usize = 5;

/// Numbers of all test rows and of correctly recognised test rows in one group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "[usize; 3]", into = "[usize; 3]")]
pub struct GroupCount {
    /// Number that identifies the group.
    pub group: usize,
    /// Number of test rows in the group. A decision on touches of several groups counts as a row of each group, which widens intervals.
    pub n_rows: usize,
    /// Number of correctly recognised test rows in the group.
    pub n_correct: usize,
}

/// Serialises the counts of a group as an array of three numbers to save space, because there may be as many counts as touches.
impl From<GroupCount> for [usize; 3] {
    fn from(count: GroupCount) -> Self {
        [count.group, count.n_rows, count.n_correct]
    }
}

impl From<[usize; 3]> for GroupCount {
    fn from([group, n_rows, n_correct]: [usize; 3]) -> Self {
        Self {
            group,
            n_rows,
            n_correct,
        }
    }
}

/// Test of a classifier in which whole groups of rows are test rows.
#[derive(Clone, Copy, Debug)]
pub struct GroupedTest<'a> {
    /// Number of test rows.
    pub n_rows: usize,
    /// Number of correctly recognised test rows.
    pub n_correct: usize,
    /// Counts of rows in the test for each group; each group occurs once.
    pub groups: &'a [GroupCount],
}

/// Counts the rows and the correctly classified rows of each group; returns the counts in ascending order of group numbers.
pub fn count_groups(rows: impl IntoIterator<Item = (usize, bool)>) -> Vec<GroupCount> {
    let mut counts = BTreeMap::new();
    for (group, is_correct) in rows {
        let (n_rows, n_correct): &mut (usize, usize) = counts.entry(group).or_default();
        *n_rows += 1;
        *n_correct += usize::from(is_correct);
    }
    let counts = counts.into_iter();
    let counts = counts.map(|(group, (n_rows, n_correct))| GroupCount {
        group,
        n_rows,
        n_correct,
    });
    counts.collect()
}

/// Returns the confidence interval of the mean accuracy of `tests` for randomly drawn groups, and the number of groups. For a single group, the interval is 0
/// to 1.
///
/// # Errors
/// If there are no tests, a test has no rows or no groups, more rows are correct than exist, or the confidence is outside 0..1.
pub fn interval_of_groups(tests: &[GroupedTest], confidence: f64) -> Result<(Interval, usize)> {
    check_confidence(confidence)?;
    let Clustered {
        share,
        n_rows,
        n_groups,
    } = clustered(tests)?;
    let interval = match n_groups {
        0 | 1 => Interval {
            low: 0.0,
            high: 1.0,
        },
        _ => {
            let student = student(n_groups as f64 - 1.0);
            Interval::score(share, n_rows, student.inverse_cdf(0.5 + 0.5 * confidence))
        }
    };
    Ok((interval, n_groups))
}

/// Statistics that combine all tests on groups of rows.
struct Clustered {
    /// Mean accuracy over all tests.
    share: f64,
    /// Effective number of rows: the number of independent rows that would give an equal variance of the accuracy.
    n_rows: f64,
    /// Number of distinct groups in all tests.
    n_groups: usize,
}

fn clustered(tests: &[GroupedTest]) -> Result<Clustered> {
    if tests.is_empty() {
        return Err(Error::input(
            "interval of groups",
            "no tests",
            "at least one",
        ));
    }
    tests.iter().try_for_each(GroupedTest::check)?;
    let mean = |value: &dyn Fn(&GroupedTest) -> f64| {
        tests.iter().map(value).sum::<f64>() / tests.len() as f64
    };
    let share = mean(&|test| test.n_correct as f64 / test.n_rows as f64);
    // Per group: weight w_g, error e_g, and number of rows counted once.
    let mut groups = BTreeMap::<usize, (f64, f64, usize)>::new();
    for test in tests {
        let scale = 1.0 / (test.n_rows * tests.len()) as f64;
        for count in test.groups {
            let (weight, error, n_rows) = groups.entry(count.group).or_default();
            *weight += scale * count.n_rows as f64;
            *error += scale * (count.n_correct as f64 - share * count.n_rows as f64);
            *n_rows = count.n_rows.max(*n_rows);
        }
    }
    let n_groups = groups.len();
    if n_groups < 2 {
        return Ok(Clustered {
            share,
            n_rows: 0.0,
            n_groups,
        });
    }
    let sum = |value: fn(&(f64, f64, usize)) -> f64| groups.values().map(value).sum::<f64>();
    let in_groups =
        mean(&|test| test.groups.iter().map(|count| count.n_rows).sum::<usize>() as f64);
    let n = mean(&|test| test.n_rows as f64) * sum(|group| group.2 as f64) / in_groups;
    let spread = share * (1.0 - share);
    let variance = n_groups as f64 / (n_groups as f64 - 1.0) * sum(|group| group.1 * group.1);
    let most = n * sum(|group| group.0 * group.0) / sum(|group| group.0).powi(2);
    let rarer = n * share.min(1.0 - share);
    let effect = match spread > 0.0 {
        true => (rarer * (n * variance / spread).max(1.0) + most) / (rarer + 1.0),
        false => most,
    };
    Ok(Clustered {
        share,
        n_rows: n / effect,
        n_groups,
    })
}

/// Returns the confidence interval of an accuracy, and the number of groups from which it was computed. Without grouped tests, the interval is Wilson's for
/// `n_correct` of `n_rows` rows, and the number of groups is `None`. With grouped tests, [`interval_of_groups`] computes both.
///
/// # Errors
/// If there are no rows, more rows are correct than exist, or the confidence is outside 0..1.
pub fn interval_of(
    [n_correct, n_rows]: [usize; 2],
    tests: &[GroupedTest],
    confidence: f64,
) -> Result<(Interval, Option<usize>)> {
    if tests.is_empty() {
        let interval = Interval::wilson(n_correct, n_rows, confidence)?;
        return Ok((interval, None));
    }
    let (interval, n_groups) = interval_of_groups(tests, confidence)?;
    Ok((interval, Some(n_groups)))
}

impl GroupedTest<'_> {
    fn check(&self) -> Result<()> {
        let Self {
            n_rows, n_correct, ..
        } = *self;
        let mut groups = self.groups.iter();
        let is_right = groups.all(|group| group.n_rows > 0 && group.n_correct <= group.n_rows);
        if n_rows > 0 && n_correct <= n_rows && is_right && !self.groups.is_empty() {
            return Ok(());
        }
        let given = format!(
            "{n_correct} right of {n_rows} in {} groups",
            self.groups.len()
        );
        let allowed = "at least one row in each group, and no more right than rows";
        Err(Error::input("interval of groups", given, allowed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use crate::standard_errors::{assert_at_least, assert_at_most, of_mean, of_share};
    use rand::Rng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Beta, Binomial, Distribution};

    fn test(groups: &[GroupCount]) -> GroupedTest<'_> {
        GroupedTest {
            n_rows: groups.iter().map(|group| group.n_rows).sum(),
            n_correct: groups.iter().map(|group| group.n_correct).sum(),
            groups,
        }
    }

    fn counts(of: &[(usize, usize)]) -> Vec<GroupCount> {
        let of = of.iter().enumerate();
        let of = of.map(|(group, &(n_correct, n_rows))| GroupCount {
            group,
            n_rows,
            n_correct,
        });
        of.collect()
    }

    #[test]
    fn intervals_are_the_formula_evaluated_with_numpy_and_scipy() {
        // Expected values: the formula of the module documentation in NumPy 2.4.6 with SciPy's Student t.
        for (groups, low, high) in [
            (
                &[(9, 10), (7, 10), (10, 10), (4, 10), (10, 10), (8, 10)][..],
                0.47816183241473065,
                0.9458331458995818,
            ),
            (
                &[(12, 12), (30, 31), (8, 8), (25, 25), (19, 20)],
                0.5761040200168828,
                0.9993851364079627,
            ),
            (&[(20, 20); 12], 0.712405655620501, 1.0),
        ] {
            let groups = counts(groups);
            let (found, n_groups) = interval_of_groups(&[test(&groups)], 0.95).unwrap();
            assert_eq!(n_groups, groups.len());
            assert!((found.low - low).abs() < 1e-9, "{found:?}");
            assert!((found.high - high).abs() < 1e-9, "{found:?}");
        }
    }

    /// Draws G groups of m rows each, whose outcomes are correlated within a group (beta-binomial distribution).
    fn draw(
        rng: &mut ChaCha8Rng,
        (n_groups, n_rows): (usize, usize),
        (accuracy, correlation): (f64, f64),
    ) -> Vec<GroupCount> {
        let scale = (1.0 - correlation) / correlation;
        let beta = Beta::new(accuracy * scale, (1.0 - accuracy) * scale);
        let group = |group| {
            let p = match correlation {
                0.0 => accuracy,
                1.0 => f64::from(u8::from(rng.gen_bool(accuracy))),
                _ => beta.unwrap().sample(rng),
            };
            let n_correct = Binomial::new(n_rows as u64, p).unwrap().sample(rng) as usize;
            GroupCount {
                group,
                n_rows,
                n_correct,
            }
        };
        (0..n_groups).map(group).collect()
    }

    /// Returns the coverage and the mean width of two kinds of intervals: over groups of rows, and over single rows.
    fn coverage(sizes: (usize, usize), of: (f64, f64), rng: &mut ChaCha8Rng) -> [(f64, f64); 2] {
        let mut found = [(0.0, 0.0); 2];
        for _ in 0..N_DRAWS {
            let drawn = draw(rng, sizes, of);
            let drawn = test(&drawn);
            let by_groups = interval_of_groups(&[drawn], 0.95).unwrap().0;
            let by_rows = Interval::wilson(drawn.n_correct, drawn.n_rows, 0.95).unwrap();
            for ((held, width), interval) in found.iter_mut().zip([by_groups, by_rows]) {
                let holds = interval.low <= of.0 && of.0 <= interval.high;
                *held += f64::from(u8::from(holds)) / N_DRAWS as f64;
                *width += (interval.high - interval.low) / N_DRAWS as f64;
            }
        }
        found
    }

    const N_DRAWS: usize = 4000;

    #[test]
    fn intervals_hold_the_accuracy_however_rows_of_a_group_are_correlated() {
        let mut rng = Seed::new(29).rng();
        for n_groups in [2, 3, 5, 12, 40] {
            for accuracy in [0.6, 0.9, 0.98] {
                for correlation in [0.0, 0.1, 0.3, 1.0] {
                    let what = format!("{n_groups} groups, {accuracy}, {correlation}");
                    let found = coverage((n_groups, 20), (accuracy, correlation), &mut rng);
                    let [by_groups, by_rows] = found.map(|(held, _)| held);
                    // For accuracies near 1, score intervals cover only 0.93, also for independent rows.
                    assert_at_least(&what, by_groups, 0.93, of_share(0.93, N_DRAWS));
                    // 20 rows of correlation 0.3 carry as much information as three independent rows.
                    if correlation == 0.3 && accuracy < 0.95 {
                        assert_at_most(&what, by_rows, 0.65, of_share(0.65, N_DRAWS));
                    }
                }
            }
        }
    }

    #[test]
    fn rows_that_are_independent_lose_little_by_coming_in_groups() {
        let mut rng = Seed::new(30).rng();
        let [(_, by_groups), (_, by_rows)] = coverage((40, 20), (0.6, 0.0), &mut rng);
        // Student's t of 39 degrees of freedom is 3.2 % wider. The estimated design effect has standard deviation √(2/39) and a lower bound of 1, which adds
        // 0.09 on average. The prior design effect of one row a group has weight 1 in 321, which adds 0.06.
        let expected = 1.032 * f64::sqrt(1.0 + 0.09 + 19.0 / 321.0);
        // The relative standard error of the width is half of the relative standard error of the design effect.
        let standard_error = of_mean(0.5 * f64::sqrt(2.0 / 39.0), N_DRAWS);
        assert_at_most("width", by_groups / by_rows, expected, standard_error);
    }

    #[test]
    fn a_group_that_is_tested_again_is_the_same_group() {
        let groups = counts(&[(9, 10), (7, 10), (10, 10), (4, 10), (30, 40)]);
        let once = interval_of_groups(&[test(&groups)], 0.95).unwrap();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        let thrice = interval_of_groups(&[test(&groups); 3], 0.95).unwrap();
        near(thrice.0.low, once.0.low);
        near(thrice.0.high, once.0.high);
        assert_eq!((once.1, thrice.1), (5, 5));
        let mut turned = groups.clone();
        turned.reverse();
        let turned = interval_of_groups(&[test(&turned)], 0.95).unwrap();
        near(turned.0.low, once.0.low);
        // Each group forms a test of its own, so all groups have equal weights.
        let apart: Vec<GroupedTest> = groups.chunks(1).map(test).collect();
        assert_eq!(interval_of_groups(&apart, 0.95).unwrap().1, 5);
        let equal = counts(&[(3, 4), (2, 4), (4, 4), (1, 4), (4, 4), (3, 4)]);
        let apart: Vec<GroupedTest> = equal.chunks(1).map(test).collect();
        let (apart, together) = (
            interval_of_groups(&apart, 0.95).unwrap().0,
            interval_of_groups(&[test(&equal)], 0.95).unwrap().0,
        );
        near(apart.low, together.low);
        near(apart.high, together.high);
    }

    #[test]
    fn groups_of_one_row_without_errors_are_wilsons_with_students_t() {
        let rows = counts(&[(1, 1); 30]);
        let (found, _) = interval_of_groups(&[test(&rows)], 0.95).unwrap();
        let t = 2.045_229_642_132_703; // t.ppf(0.975, 29) of SciPy
        assert!(
            (found.low - 30.0 / (30.0 + t * t)).abs() < 1e-9,
            "{found:?}"
        );
        assert_eq!(found.high, 1.0);
    }

    #[test]
    fn one_group_says_nothing_and_impossible_counts_are_refused() {
        let one = counts(&[(9, 10)]);
        let all = Interval {
            low: 0.0,
            high: 1.0,
        };
        assert_eq!(interval_of_groups(&[test(&one)], 0.95).unwrap(), (all, 1));
        assert!(interval_of_groups(&[], 0.95).is_err());
        assert!(interval_of_groups(&[test(&[])], 0.95).is_err());
        assert!(interval_of_groups(&[test(&counts(&[(3, 2), (0, 4)]))], 0.95).is_err());
        assert!(interval_of_groups(&[test(&one)], 95.0).is_err());
    }
}
