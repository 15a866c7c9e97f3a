//! Runs a study of stability: all cells on all threads.

use super::cell::measure;
use super::peers::join_peers;
use super::plan::StabilityPlan;
use super::summary::summary;
use super::table::StabilityTables;
use crate::error::Result;
use crate::study::progress::Progress;
use rayon::prelude::*;

/// Runs a study. The tables but for times are the same bytes at any number of threads.
///
/// # Errors
/// A scene that cannot be built: a cradle too deep for its ball; a file of peers that cannot be read.
pub fn measure_stability(plan: &StabilityPlan, progress: &dyn Progress) -> Result<StabilityTables> {
    progress.stage("stability", plan.n_cells() as u64);
    let cells = plan.parts.iter();
    let cells = cells.flat_map(|part| part.cells.iter().map(|cell| (cell, part.stroke)));
    let cells: Vec<_> = cells.collect();
    let measured = cells
        .par_iter()
        // One at a time: a cell takes from microseconds to a minute.
        .with_max_len(1)
        .map(|(cell, stroke)| {
            let found = measure(cell, plan.pitch, *stroke);
            progress.advance(1);
            found
        })
        .collect::<Result<Vec<_>>>()?;
    let mut tables = StabilityTables::default();
    for ((cell, _), (score, time)) in cells.into_iter().zip(measured) {
        tables.stability.push((cell.clone(), score));
        tables.timing.push((cell.clone(), time));
    }
    join_peers(plan, &mut tables)?;
    tables.summary = summary(&tables.stability);
    Ok(tables)
}
