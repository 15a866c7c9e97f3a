//! Functions that group rows by a key.

use crate::error::Result;
use crate::table::{Columns, File, Table};
use serde::Serialize;

/// Groups elements with equal keys; the order of the groups is the order in which the keys first occur.
pub(super) fn grouped<'a, T, K: PartialEq>(
    things: impl IntoIterator<Item = &'a T>,
    key: impl Fn(&T) -> K,
) -> Vec<(K, Vec<&'a T>)> {
    let mut groups: Vec<(K, Vec<&T>)> = Vec::new();
    for thing in things {
        let of_it = key(thing);
        match groups.iter_mut().find(|(known, _)| *known == of_it) {
            Some((_, group)) => group.push(thing),
            None => groups.push((of_it, vec![thing])),
        }
    }
    groups
}

/// Returns two tables for the rows of the same configurations: one with their results, one with their costs.
pub(super) fn found_and_cost<C, F, T>(
    found: &File<(C, F)>,
    cost: &File<(C, T)>,
    rows: &[(C, F, T)],
) -> Result<[Table; 2]>
where
    C: Columns + Serialize,
    F: Columns + Serialize,
    T: Columns + Serialize,
{
    let of_found: Vec<(&C, &F)> = rows.iter().map(|(of, found, _)| (of, found)).collect();
    let of_cost: Vec<(&C, &T)> = rows.iter().map(|(of, _, cost)| (of, cost)).collect();
    Ok([
        found.of_columns(<(C, F)>::columns(), &of_found)?,
        cost.of_columns(<(C, T)>::columns(), &of_cost)?,
    ])
}
