//! Which work of a study a run does, and what of it was done before.

use super::finished::Finished;
use super::job::FinishedCell;
use super::journal::Journal;
use super::plan::Plan;
use super::shard::Shard;
use super::sweep::{Group, Sweep};
use super::table::Cell;
use std::collections::BTreeSet;

/// Which families of which trials a run evaluates.
#[derive(Clone, Copy, Debug)]
pub enum Part<'a> {
    /// All.
    All,
    /// One of several equal parts.
    Shard(Shard),
    /// Those that hold one of these: (number of the cell, trial).
    Holding(&'a BTreeSet<(usize, usize)>),
}

/// All trials and groups, with those of their families that belong to a part.
pub fn pieces<'a>(
    plan: &Plan,
    sweep: &'a Sweep,
    part: Part,
) -> Vec<(&'a Group, usize, Vec<&'a [Cell]>)> {
    let n_pieces = sweep.groups.len() * plan.spec.trials;
    let mut pieces = Vec::with_capacity(n_pieces);
    let mut n_families = 0;
    for trial in 0..plan.spec.trials {
        for group in &sweep.groups {
            let number = pieces.len();
            let is_in = |(place, family): &(usize, &[Cell])| match part {
                Part::All => true,
                Part::Shard(shard) => shard.takes((number, n_pieces), n_families + place),
                Part::Holding(cells) => {
                    let mut numbers = family.iter().map(|cell| (cell.cell, trial));
                    numbers.any(|number| cells.contains(&number))
                }
            };
            let families = group.families().enumerate().filter(is_in);
            let families = families.map(|(_, family)| family).collect();
            pieces.push((group, trial, families));
            n_families += group.families().count();
        }
    }
    pieces
}

/// Cells of a part, counted once a trial, of which a journal does not say what came of them.
pub fn n_left(plan: &Plan, sweep: &Sweep, part: Part, journal: &Journal) -> usize {
    let left_of = |family: &[Cell], trial| {
        let before = Finished::in_journal(journal, plan, (family, trial));
        before.iter().filter(|before| before.is_none()).count()
    };
    let of_piece = |(_, trial, families): (&Group, usize, Vec<&[Cell]>)| -> usize {
        families.iter().map(|family| left_of(family, trial)).sum()
    };
    pieces(plan, sweep, part).into_iter().map(of_piece).sum()
}

/// Every finished cell, from this run or from earlier ones, and how many are left.
pub fn with_what_was_done_before<'a>(
    plan: &Plan,
    sweep: &'a Sweep,
    journal: &Journal,
    mut finished: Vec<FinishedCell<'a>>,
) -> (Vec<FinishedCell<'a>>, usize) {
    let number = |(cell, trial, _): &FinishedCell| (cell.cell, *trial);
    let now: BTreeSet<(usize, usize)> = finished.iter().map(number).collect();
    let mut n_left = 0;
    for trial in 0..plan.spec.trials {
        for family in sweep.groups.iter().flat_map(Group::families) {
            // A family is evaluated as a whole.
            if now.contains(&(family[0].cell, trial)) {
                continue;
            }
            let before = Finished::in_journal(journal, plan, (family, trial));
            for (cell, before) in family.iter().zip(before) {
                match before {
                    Some(before) => finished.push((cell, trial, before)),
                    None => n_left += 1,
                }
            }
        }
    }
    (finished, n_left)
}
