//! Finished cells → tables: by cell, then by trial.

use super::conditions::most_accurate;
use super::evaluation::Evaluation;
use super::summary::{compare_with_best, most_confused, pareto, summarise};
use super::table::{Cell, Confusion, Tables};
use super::variance_table::variances;
use crate::error::Result;
use std::collections::BTreeMap;

/// The names of an object and of what it was taken for, and how often.
type Counted = ([String; 2], usize);

/// Fills every table but those of stages and of published numbers; `name` says the class of a label in a cell.
pub fn tabulate(
    tables: &mut Tables,
    mut scored: Vec<(Cell, Evaluation)>,
    name: impl Fn(&Cell, usize) -> String,
) -> Result<()> {
    scored.sort_by_key(|(cell, evaluation)| (cell.cell, evaluation.score.trial));
    let mut confusions: BTreeMap<(usize, usize, usize), Counted> = BTreeMap::new();
    for (cell, evaluation) in scored {
        for &(object, predicted, count) in &evaluation.confusion {
            let names = || [object, predicted].map(|label| name(&cell, label));
            let known = confusions.entry((cell.cell, object, predicted));
            known.or_insert_with(|| (names(), 0)).1 += count;
        }
        tables.accuracy.push((cell.clone(), evaluation.score));
        tables.timing.push((cell, evaluation.time));
    }
    tables.confusion = confusions
        .into_iter()
        .map(|((cell, ..), ([object, predicted], count))| Confusion {
            cell,
            object,
            predicted,
            count,
        })
        .collect();
    tables.summary = summarise(&tables.accuracy)?;
    tables.variance = variances(&tables.accuracy)?;
    tables.comparison = compare_with_best(&tables.accuracy)?;
    let accuracies = tables.summary.iter();
    let accuracies = accuracies.map(|(cell, score)| (cell.cell, score.accuracy));
    if let Some(best) = most_accurate(accuracies) {
        tables.confused = most_confused(&tables.confusion, best);
    }
    tables.pareto = pareto(&tables.accuracy, &tables.timing)?;
    Ok(())
}
