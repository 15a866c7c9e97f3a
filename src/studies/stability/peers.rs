//! What other programs make of the same cells, as they left it in a file.

use crate::error::Result;
use crate::report::csv_tables::read_rows;
use crate::studies::stability::plan::StabilityPlan;
use crate::studies::stability::rows::{PeerSource, StabilityCell, StabilityRow};

/// Rows of cells that a plan has but for the method, and who measured them: `MuJoCo 4.0.0, 2026-11-22`. Nothing where there is no file.
///
/// # Errors
/// The file is no such table; the error names it and the line.
pub(super) fn peer_rows(plan: &StabilityPlan) -> Result<(Vec<StabilityRow>, String)> {
    let Some(path) = plan.peers.as_ref().filter(|path| path.exists()) else {
        return Ok(Default::default());
    };
    // A line is read once for each of its parts: serde's flattening takes an empty field for an empty text.
    let cells = read_rows::<StabilityCell>(path)?.into_iter();
    let found = cells.zip(read_rows(path)?).zip(read_rows(path)?);
    let mut sources: Vec<String> = Vec::new();
    let mut rows = Vec::new();
    for (((cell, score), time), source) in found.zip(read_rows::<PeerSource>(path)?) {
        if is_asked(plan, &cell) {
            rows.push((cell, score, time));
            let source = format!("{} {}, {}", source.program, source.version, source.date);
            if !sources.contains(&source) {
                sources.push(source);
            }
        }
    }
    Ok((rows, sources.join("; ")))
}

/// Whether the plan has a cell that differs in the method only.
fn is_asked(plan: &StabilityPlan, cell: &StabilityCell) -> bool {
    let is_like = |(other, _): &(StabilityCell, _)| {
        let of_method = StabilityCell {
            method: cell.method,
            solver_iterations: cell.solver_iterations,
            ..other.clone()
        };
        of_method == *cell
    };
    cell.method.is_peer() && plan.cells.iter().any(is_like)
}
