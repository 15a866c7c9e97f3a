//! What a study found, in sentences made from its tables.

use crate::report::axis::{Axis, AxisValue};
use crate::report::varying::Settings;
use crate::study::table::{Cell, CellScore, Tables};
use std::collections::HashMap;

/// Values up to which a sentence lists them all.
const MOST_LISTED: usize = 8;

/// The findings that hold for any study.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The cell with the highest mean accuracy (the first of equals).
    pub best: (Cell, CellScore),
    /// The cell with the fewest measurements among those whose mean accuracy reaches the best cell's interval.
    pub frugal: (Cell, CellScore),
    /// What each axis that varies by itself does.
    pub effects: Vec<Effect>,
    settings: Settings,
    n_cells: usize,
    n_capped: usize,
    n_left_out: usize,
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
        let first = rows.first()?;
        let best = rows.iter().fold(first, |best, row| {
            if row.1.accuracy > best.1.accuracy {
                row
            } else {
                best
            }
        });
        let good = rows
            .iter()
            .filter(|row| row.1.accuracy >= best.1.accuracy_low);
        let frugal = good.fold(best, |frugal, row| {
            let fewer = row.0.measurements < frugal.0.measurements;
            let better =
                row.0.measurements == frugal.0.measurements && row.1.accuracy > frugal.1.accuracy;
            if fewer || better { row } else { frugal }
        });
        let cells: Vec<&Cell> = rows.iter().map(|row| &row.0).collect();
        let settings = Settings::of(&cells);
        let left_out = tables.accuracy.iter().map(|(_, trial)| trial.n_left_out);
        Some(Self {
            best: best.clone(),
            frugal: frugal.clone(),
            effects: effects(rows, &settings),
            n_cells: rows.len(),
            n_capped: rows.iter().map(|row| row.1.n_capped).sum(),
            n_left_out: left_out.max().unwrap_or(0),
            settings,
        })
    }

    /// What varies in the study.
    pub(super) fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The findings, one sentence each, the most important first.
    pub fn sentences(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let (best, score) = &self.best;
        let place = self.place(best);
        sentences.push(match self.n_cells {
            1 => format!("Accuracy {}.", accuracy_sentence(score)),
            _ => format!("Best accuracy {} at {place}.", accuracy_sentence(score)),
        });
        let shown = self.settings.shown();
        if shown.iter().any(|levels| levels.axis == Axis::Measurements) {
            let (frugal, score) = &self.frugal;
            sentences.push(match frugal.cell == best.cell {
                true => {
                    "No cell with fewer measurements reaches the interval of the best.".to_owned()
                }
                false => format!(
                    "Within the interval of the best with the fewest measurements: {} at {}.",
                    accuracy_sentence(score),
                    self.place(frugal)
                ),
            });
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

    /// A word beside a cell in a table: `best`, `as good` (reaches the best's interval), or nothing.
    pub fn remark(&self, cell: &Cell, score: &CellScore) -> &'static str {
        if cell.cell == self.best.0.cell {
            "best"
        } else if score.accuracy >= self.best.1.accuracy_low {
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
