//! Chance level of the accuracy: the accuracy of the best answer that does not depend on the touch.

use crate::table::Table;
use std::collections::HashMap;

/// Number of test decisions on the most frequent object relative to the mean, above which objects have unequal numbers. With a smaller value, the rounding of a
/// split changes the chance level; with a larger one, a chance level above 1 in n objects is missed.
const UNEQUAL: f64 = 1.1;

/// Chance level of a configuration.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chance<'t> {
    /// Fraction of the test decisions that are on the most frequent object, 0 to 1; 1 in `n_objects` if all objects have about equal numbers.
    pub accuracy: f64,
    /// Most frequent object of the test decisions; `None` if all objects have about equal numbers.
    pub object: Option<&'t str>,
    /// Number of objects that are tested, at least 1.
    pub n_objects: usize,
}

impl<'t> Chance<'t> {
    /// Returns the chance level, given the rows of the confusion matrices of a configuration.
    fn new(confusion: &'t Table, rows: impl IntoIterator<Item = usize>) -> Self {
        let counts = confusion.groups(&["object"], rows).into_iter().map(|rows| {
            let count: f64 = rows.iter().map(|&row| confusion.number("count", row)).sum();
            (count, rows[0])
        });
        let counts: Vec<(f64, usize)> = counts.collect();
        let n_objects = counts.len().max(1);
        let all: f64 = counts.iter().map(|(count, _)| count).sum();
        let most = counts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let most = most.filter(|(count, _)| count * n_objects as f64 > UNEQUAL * all);
        Self {
            accuracy: most.map_or(1.0 / n_objects as f64, |(count, _)| count / all),
            object: most.map(|(_, row)| confusion.word("object", row)),
            n_objects,
        }
    }

    /// Returns the chance level in words, such as `chance (1 in 24)`.
    pub fn words(&self) -> String {
        match self.object {
            None => format!("chance (1 in {})", self.n_objects),
            Some(object) => format!("chance (always {object})"),
        }
    }
}

/// Chance levels of all configurations, from the confusion matrices.
pub(crate) struct ChanceLevels<'t> {
    of_cells: HashMap<u64, Chance<'t>>,
    of_all: Chance<'t>,
}

impl<'t> ChanceLevels<'t> {
    /// Computes the chance levels, given the table of confusion matrices.
    pub fn new(confusion: &'t Table) -> Self {
        let all = || 0..confusion.n_rows;
        let of_cells = confusion.groups(&["configuration"], all()).into_iter();
        let of_cells = of_cells.map(|rows| {
            let configuration = confusion.number("configuration", rows[0]);
            (configuration.to_bits(), Chance::new(confusion, rows))
        });
        Self {
            of_cells: of_cells.collect(),
            of_all: Chance::new(confusion, all()),
        }
    }

    /// Returns the chance level of a configuration. If only some confusion matrices are stored, all configurations have the same objects, and the level of all
    /// stored matrices holds for the others.
    pub fn of(&self, configuration: f64) -> Chance<'t> {
        self.own(configuration).unwrap_or(self.of_all)
    }

    /// Returns the chance level of a configuration; `None` if its confusion matrix is not stored.
    pub fn own(&self, configuration: f64) -> Option<Chance<'t>> {
        self.of_cells.get(&configuration.to_bits()).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::studies::recognition::rows::table_rows::Confusion;
    use crate::table::File;

    #[test]
    fn the_most_frequent_object_is_the_chance_level_of_unequal_objects() {
        let row = |configuration, object: &str, predicted: &str, count| Confusion {
            configuration,
            object: object.to_owned(),
            predicted: predicted.to_owned(),
            count,
        };
        let rows = [
            row(3, "mug", "mug", 40),
            row(3, "mug", "bowl", 22),
            row(3, "bowl", "mug", 38),
            row(4, "mug", "mug", 52),
            row(4, "bowl", "mug", 48),
        ];
        let table = File::<Confusion>::new("confusion.csv", "", "");
        let table = table.table(&rows).unwrap();
        let chances = ChanceLevels::new(&table);
        let found = |configuration| {
            let chance = chances.of(configuration);
            (chance.accuracy, chance.words())
        };
        assert_eq!(found(3.0), (0.62, "chance (always mug)".to_owned()));
        assert_eq!(found(4.0), (0.5, "chance (1 in 2)".to_owned()));
        // 114 of 200 decisions of both stored matrices.
        assert_eq!(found(9.0), (0.57, "chance (always mug)".to_owned()));
        assert!(chances.own(9.0).is_none());
    }
}
