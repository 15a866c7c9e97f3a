//! What a study found, in sentences made from its tables.

use crate::report::axis::{Axis, AxisValue};
use crate::report::varying::Settings;
use crate::study::table::{Cell, CellScore, Tables};
use crate::study::{condition_numbers, most_accurate};
use std::collections::HashMap;

/// Values up to which a sentence lists them all.
const MOST_LISTED: usize = 8;

/// The findings that hold for any study.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The cell with the highest mean accuracy (the first of equals), whatever its condition: an example to show.
    pub best: (Cell, CellScore),
    /// What is best in each condition of the world, in the order in which cells first have them.
    pub findings: Vec<Finding>,
    /// What each axis that varies by itself does.
    pub effects: Vec<Effect>,
    /// The place of each cell's condition among the findings, by the cell's number.
    finding_of: HashMap<usize, usize>,
    settings: Settings,
    n_cells: usize,
    n_capped: usize,
    n_left_out: usize,
}

/// What is best in one condition of the world.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The condition in words; empty if the study has one.
    pub condition: String,
    /// The cell with the highest mean accuracy (the first of equals).
    pub best: (Cell, CellScore),
    /// The cell with the fewest measurements a decision among those whose mean accuracy reaches the best cell's interval; of equals the
    /// more accurate.
    pub frugal: (Cell, CellScore),
}

impl Finding {
    /// Of the cells of a condition; none of none.
    fn of(rows: &[&(Cell, CellScore)], settings: &Settings) -> Option<Self> {
        let best = most_accurate_row(rows)?;
        let good = rows
            .iter()
            .filter(|row| row.1.accuracy >= best.1.accuracy_low);
        let read = |row: &(Cell, CellScore)| row.0.measurements_of_decision();
        let frugal = good.fold(best, |frugal, row| {
            let better = read(row) == read(frugal) && row.1.accuracy > frugal.1.accuracy;
            match read(row) < read(frugal) || better {
                true => row,
                false => frugal,
            }
        });
        Some(Self {
            condition: settings.condition_words(&best.0),
            best: best.clone(),
            frugal: frugal.clone(),
        })
    }

    /// Whether a cell is as accurate as its best, for what can be told.
    pub fn is_as_good(&self, accuracy: f64) -> bool {
        accuracy >= self.best.1.accuracy_low
    }
}

/// The first of the most accurate rows.
fn most_accurate_row<'a>(rows: &[&'a (Cell, CellScore)]) -> Option<&'a (Cell, CellScore)> {
    let accuracies = rows.iter().map(|row| row.1.accuracy).enumerate();
    most_accurate(accuracies).map(|place| rows[place])
}

/// Mean accuracy at each value of an axis, over those combinations of the other settings that have all of its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// Which axis.
    pub axis: Axis,
    /// Its values with the mean accuracy there.
    pub means: Vec<(AxisValue, f64)>,
    /// How many combinations of the other settings each mean is over.
    pub n_combinations: usize,
}

impl Answer {
    /// The findings; none for empty tables.
    pub fn of(tables: &Tables) -> Option<Self> {
        let rows = &tables.summary;
        let best = most_accurate_row(&rows.iter().collect::<Vec<_>>())?;
        let cells: Vec<&Cell> = rows.iter().map(|row| &row.0).collect();
        let settings = Settings::of(&cells);
        let conditions = condition_numbers(cells.iter().copied());
        let n_conditions = conditions.iter().max().map_or(0, |last| last + 1);
        let mut of_condition = vec![Vec::new(); n_conditions];
        for (row, &condition) in rows.iter().zip(&conditions) {
            of_condition[condition].push(row);
        }
        let findings = of_condition.iter();
        let findings = findings.filter_map(|rows| Finding::of(rows, &settings));
        let left_out = tables.accuracy.iter().map(|(_, trial)| trial.n_left_out);
        Some(Self {
            best: best.clone(),
            findings: findings.collect(),
            effects: effects(rows, &settings),
            finding_of: cells.iter().map(|c| c.cell).zip(conditions).collect(),
            n_cells: rows.len(),
            n_capped: rows.iter().map(|row| row.1.n_capped).sum(),
            n_left_out: left_out.max().unwrap_or(0),
            settings,
        })
    }

    /// What is best in the condition of a cell of the study.
    pub fn finding(&self, cell: &Cell) -> &Finding {
        &self.findings[self.condition(cell)]
    }

    /// The place of that among the findings.
    pub fn condition(&self, cell: &Cell) -> usize {
        self.finding_of.get(&cell.cell).copied().unwrap_or(0)
    }

    /// What varies in the study.
    pub(super) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The findings, one sentence each, the most important first.
    pub fn sentences(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let listed = match self.findings.len() {
            n if n > MOST_LISTED => {
                sentences.push(self.range_sentence());
                &self.findings[..1]
            }
            _ => &self.findings[..],
        };
        for finding in listed {
            sentences.extend(self.best_sentences(finding));
        }
        sentences.extend(self.effects.iter().map(Effect::sentence));
        if self.n_left_out > 0 {
            sentences.push(format!(
                "Up to {} test touches of a trial fill no whole group of fused touches and are left out.",
                self.n_left_out
            ));
        }
        if self.n_capped > 0 {
            sentences.push(format!(
                "{} binary SVMs stopped at the iteration cap: their cells may do better with more iterations or a smaller C.",
                self.n_capped
            ));
        }
        sentences
    }

    /// Of very many conditions: where the best cell is most accurate, and where least.
    fn range_sentence(&self) -> String {
        let accuracy = |finding: &&Finding| finding.best.1.accuracy;
        let ends = (
            self.findings
                .iter()
                .max_by(|a, b| accuracy(a).total_cmp(&accuracy(b))),
            self.findings
                .iter()
                .min_by(|a, b| accuracy(a).total_cmp(&accuracy(b))),
        );
        let (Some(most), Some(least)) = ends else {
            return String::new();
        };
        format!(
            "Best accuracy in each of {} conditions: from {} with {} down to {} with {}.",
            self.findings.len(),
            accuracy_sentence(&most.best.1),
            most.condition,
            accuracy_sentence(&least.best.1),
            least.condition
        )
    }

    /// The most accurate cell of a condition, and the one of fewest measurements.
    fn best_sentences(&self, finding: &Finding) -> Vec<String> {
        let Finding {
            condition,
            best: (best, score),
            frugal: (frugal, frugal_score),
        } = finding;
        let with = match &condition[..] {
            "" => String::new(),
            words => format!(" with {words}"),
        };
        let at = |cell: &Cell| match &self.settings.choice_words(cell)[..] {
            "" => String::new(),
            words => format!(" at {words}"),
        };
        let mut sentences = vec![match self.n_cells {
            1 => format!("Accuracy {}.", accuracy_sentence(score)),
            _ => format!(
                "Best accuracy{with} {}{}.",
                accuracy_sentence(score),
                at(best)
            ),
        }];
        let shown = self.settings.shown();
        if shown.iter().any(|levels| levels.axis == Axis::Measurements) {
            sentences.push(match frugal.cell == best.cell {
                true => {
                    format!(
                        "No cell with fewer measurements reaches the interval of the best{with}."
                    )
                }
                false => format!(
                    "Within the interval of the best{with}, with the fewest measurements: {}{}.",
                    accuracy_sentence(frugal_score),
                    at(frugal)
                ),
            });
        }
        sentences
    }

    /// A word beside a cell in a table: `best` in its condition, `as good` (reaches the interval of that), or nothing.
    pub fn remark(&self, cell: &Cell, score: &CellScore) -> &'static str {
        let finding = self.finding(cell);
        if cell.cell == finding.best.0.cell {
            "best"
        } else if finding.is_as_good(score.accuracy) {
            "as good"
        } else {
            ""
        }
    }

    /// The settings of a cell that vary in the study: `classifier RBF SVM, m = 64`; empty if none varies.
    pub fn place(&self, cell: &Cell) -> String {
        let shown = self.settings.shown().into_iter();
        let parts: Vec<String> = shown.map(|levels| levels.axis.phrase(cell)).collect();
        parts.join(", ")
    }
}

impl Effect {
    /// `Mean accuracy by compression: 0.95 (4:1), 0.80 (64:1).`
    pub fn sentence(&self) -> String {
        let written = |(value, mean): &(AxisValue, f64)| format!("{mean:.2} ({})", value.label);
        let name = self.axis.name();
        if let ([first, .., last], true) = (&self.means[..], self.means.len() > MOST_LISTED) {
            let (first, last, n) = (written(first), written(last), self.means.len());
            return format!("Mean accuracy by {name}, {n} values: from {first} to {last}.");
        }
        let means: Vec<String> = self.means.iter().map(written).collect();
        format!("Mean accuracy by {name}: {}.", means.join(", "))
    }
}

/// `0.93 [0.90, 0.95]`.
pub fn accuracy_sentence(score: &CellScore) -> String {
    format!(
        "{:.2} [{:.2}, {:.2}]",
        score.accuracy, score.accuracy_low, score.accuracy_high
    )
}

fn effects(rows: &[(Cell, CellScore)], settings: &Settings) -> Vec<Effect> {
    let all: Vec<Axis> = settings.single().map(|levels| levels.axis).collect();
    let mut effects = Vec::new();
    for levels in settings.single() {
        let mut groups: HashMap<Vec<String>, Vec<Option<f64>>> = HashMap::new();
        for (cell, score) in rows {
            let others = all.iter().filter(|axis| **axis != levels.axis);
            let key = others.map(|axis| axis.value(cell).label).collect();
            let accuracies = groups
                .entry(key)
                .or_insert_with(|| vec![None; levels.values.len()]);
            let value = levels.axis.value(cell);
            if let Some(place) = levels.values.iter().position(|v| *v == value) {
                accuracies[place] = Some(score.accuracy);
            }
        }
        // Sorted, because a sum of floats depends on its order and a hash map has none.
        let mut complete: Vec<Vec<f64>> = groups
            .into_values()
            .filter_map(|accuracies| accuracies.into_iter().collect())
            .collect();
        complete.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        if complete.is_empty() {
            continue;
        }
        let mean = |place: usize| {
            complete
                .iter()
                .map(|accuracies| accuracies[place])
                .sum::<f64>()
                / complete.len() as f64
        };
        effects.push(Effect {
            axis: levels.axis,
            means: levels
                .values
                .iter()
                .cloned()
                .enumerate()
                .map(|(i, v)| (v, mean(i)))
                .collect(),
            n_combinations: complete.len(),
        });
    }
    effects
}
