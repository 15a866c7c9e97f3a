//! What a study of recognition found, in sentences made from its tables.

use super::CELLS;
use crate::report::swept::{Setting, Swept, without};
use crate::report::terminal::{MOST_LINES, paragraph, pivot_text, table_text};
use crate::table::{Table, Value};

/// Values up to which a sentence lists them all.
const MOST_LISTED: usize = 8;

/// What is best in each condition and within its interval the least to measure, what each setting does by itself, and what was left out.
pub fn answers(tables: &[Table]) -> Vec<String> {
    let Some(found) = Found::of(tables) else {
        return vec!["No cell has been computed.".to_owned()];
    };
    let mut sentences = Vec::new();
    let conditions = found.swept.by_condition(&found.rows);
    let listed = match conditions.len() {
        n if n > MOST_LISTED => {
            sentences.push(found.range(&conditions));
            &conditions[..1]
        }
        _ => &conditions[..],
    };
    for rows in listed {
        sentences.extend(found.best_of(rows));
    }
    sentences.extend(found.effects());
    let most = |file: &str, column: &str| {
        let table = tables.iter().find(|table| table.file == file);
        let numbers = table
            .and_then(|table| table.numbers(column))
            .unwrap_or_default();
        numbers.iter().copied().fold(0.0, f64::max)
    };
    let left_out = most("accuracy.csv", "n_left_out");
    if left_out > 0.0 {
        sentences.push(format!(
            "Up to {left_out} test touches of a trial fill no whole group of fused touches and are left out."
        ));
    }
    let capped: f64 = found
        .table
        .numbers("n_capped")
        .unwrap_or_default()
        .iter()
        .sum();
    if capped > 0.0 {
        sentences.push(format!(
            "{capped} binary SVMs stopped at the iteration cap: their cells may do better with more iterations or a smaller C."
        ));
    }
    if let Some(needed) = trials_needed(tables) {
        sentences.push(format!(
            "No p-values where trials are too few: {needed} are needed."
        ));
    }
    sentences
}

/// How many trials a p-value needs, if some cells have too few.
fn trials_needed(tables: &[Table]) -> Option<f64> {
    let table = tables.iter().find(|table| table.file == "comparison.csv")?;
    let ((_, status), needed) = (table.column("p_status")?, table.numbers("n_trials_needed")?);
    let too_few = Some(Value::from("too_few_trials"));
    let of_row = |row: usize| (status.value(row) == too_few).then_some(needed[row]);
    (0..table.n_rows)
        .filter_map(of_row)
        .find(|needed| needed.is_finite())
}

/// What a run prints at its end: all cells, the answers, and what is beside what was published and confused most often.
pub fn words(tables: &[Table], width: usize) -> String {
    let Some(found) = Found::of(tables) else {
        return "No cell has been computed.\n".to_owned();
    };
    let mut text = match found.table.n_rows {
        n if n > MOST_LINES => pivot_text(
            found.table,
            (&super::charts::along(found.table), "accuracy"),
            width,
        ),
        _ => table_text(found.table, width),
    };
    text.push('\n');
    for sentence in answers(tables) {
        text += &paragraph(&sentence, width);
    }
    for file in ["published.csv", "confused.csv", "variance.csv"] {
        if let Some(table) = tables
            .iter()
            .find(|table| table.file == file && table.n_rows > 0)
        {
            text += &format!("\n{}\n{}", table.title, table_text(table, width));
        }
    }
    text
}

struct Found<'a> {
    table: &'a Table,
    rows: Vec<usize>,
    swept: Swept<'a>,
    accuracy: &'a [f64],
    low: &'a [f64],
    high: &'a [f64],
    measurements: &'a [f64],
}

impl<'a> Found<'a> {
    fn of(tables: &'a [Table]) -> Option<Self> {
        let table = tables
            .iter()
            .find(|table| table.file == CELLS && table.n_rows > 0)?;
        let rows: Vec<usize> = (0..table.n_rows).collect();
        Some(Self {
            swept: Swept::of(table, &rows),
            accuracy: table.numbers("accuracy")?,
            low: table.numbers("accuracy_low")?,
            high: table.numbers("accuracy_high")?,
            measurements: table.numbers("measurements_per_decision")?,
            rows,
            table,
        })
    }

    /// The first of the most accurate.
    fn best(&self, rows: &[usize]) -> usize {
        let better = |best: usize, &row: &usize| {
            if self.accuracy[row] > self.accuracy[best] {
                row
            } else {
                best
            }
        };
        rows.iter().fold(rows[0], better)
    }

    /// Of those that reach the best one's interval that of fewest measurements, of equals the more accurate.
    fn frugal(&self, rows: &[usize], best: usize) -> usize {
        let key = |row: usize| (self.measurements[row], -self.accuracy[row]);
        let good = rows
            .iter()
            .filter(|&&row| self.accuracy[row] >= self.low[best]);
        good.fold(
            best,
            |frugal, &row| if key(row) < key(frugal) { row } else { frugal },
        )
    }

    /// `0.93 [0.90, 0.95]`.
    fn accuracy(&self, row: usize) -> String {
        let [accuracy, low, high] = [self.accuracy, self.low, self.high].map(|of| of[row]);
        // Nearly always right is not always.
        match accuracy {
            0.995..1.0 => format!("{accuracy:.4} [{low:.4}, {high:.4}]"),
            _ => format!("{accuracy:.2} [{low:.2}, {high:.2}]"),
        }
    }

    fn best_of(&self, rows: &[usize]) -> Vec<String> {
        let best = self.best(rows);
        if self.rows.len() == 1 {
            return vec![format!("Accuracy {}.", self.accuracy(best))];
        }
        let with = match &self.swept.condition_words(best)[..] {
            "" => String::new(),
            words => format!(" with {words}"),
        };
        let at = |row: usize| match &self.swept.choice_words(row)[..] {
            "" => String::new(),
            words => format!(" at {words}"),
        };
        let colon = if with.is_empty() { "" } else { ":" };
        let mut sentences = vec![format!(
            "Best accuracy{with}{colon} {}{}.",
            self.accuracy(best),
            at(best)
        )];
        let is_measured = |setting: &Setting| setting.column.name == "measurements";
        if self.swept.varying().any(is_measured) {
            let frugal = self.frugal(rows, best);
            sentences.push(match frugal == best {
                true => format!(
                    "No cell with fewer measurements reaches the interval of the best{with}."
                ),
                false => format!(
                    "Within the interval of the best{with}, with the fewest measurements: {}{}.",
                    self.accuracy(frugal),
                    at(frugal)
                ),
            });
        }
        sentences
    }

    /// Of very many conditions: where the best cell is most accurate, and where least.
    fn range(&self, conditions: &[Vec<usize>]) -> String {
        let mut bests: Vec<usize> = conditions.iter().map(|rows| self.best(rows)).collect();
        bests.sort_by(|&a, &b| self.accuracy[b].total_cmp(&self.accuracy[a]));
        let end = |row: usize| {
            format!(
                "{} with {}",
                self.accuracy(row),
                self.swept.condition_words(row)
            )
        };
        let (most, least) = (end(bests[0]), end(bests[bests.len() - 1]));
        format!(
            "Best accuracy in each of {} conditions: from {most} down to {least}.",
            conditions.len()
        )
    }

    /// Mean accuracy at each value of a setting, over those combinations of the others that have all of its values.
    fn effects(&self) -> Vec<String> {
        let effect = |setting: &Setting| {
            let others = without(&self.swept.free, setting);
            let levels = setting.levels(&self.rows);
            let is_level =
                |row: usize, level: usize| setting.data.key(row) == setting.data.key(level);
            let complete: Vec<Vec<f64>> = self
                .swept
                .groups(&others, &self.rows)
                .iter()
                .filter_map(|rows| {
                    let at = |&level: &usize| {
                        rows.iter()
                            .find(|&&row| is_level(row, level))
                            .map(|&row| self.accuracy[row])
                    };
                    levels.iter().map(at).collect()
                })
                .collect();
            if complete.is_empty() {
                return None;
            }
            let mean = |place: usize| {
                complete.iter().map(|row| row[place]).sum::<f64>() / complete.len() as f64
            };
            let said: Vec<String> = levels
                .iter()
                .enumerate()
                .map(|(place, &row)| format!("{:.2} ({})", mean(place), setting.label(row)))
                .collect();
            let name = &setting.column.words;
            Some(match &said[..] {
                [first, .., last] if said.len() > MOST_LISTED => {
                    format!(
                        "Mean accuracy by {name}, {} values: from {first} to {last}.",
                        said.len()
                    )
                }
                _ => format!("Mean accuracy by {name}: {}.", said.join(", ")),
            })
        };
        self.swept.free.iter().filter_map(effect).collect()
    }
}
