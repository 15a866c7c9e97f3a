//! What other programs make of the same cells, as they left it in a file.

use super::plan::StabilityPlan;
use super::rows::{PeerSource, StabilityCell, StabilityRows, StabilityScore, StabilityTime};
use crate::error::Result;
use crate::report::csv_tables::read_rows;

/// Puts the rows of a plan's file behind those of the parts that have such a cell, and says who measured them.
///
/// # Errors
/// The file is no such table; the error names it and the line.
pub(super) fn join_peers(plan: &StabilityPlan, rows: &mut StabilityRows) -> Result<String> {
    let (peers, sources) = peer_rows(plan)?;
    for (cell, score, time) in peers {
        let behind = |(other, _): &(StabilityCell, _)| other.part <= cell.part;
        let behind = rows.stability.partition_point(behind);
        rows.stability.insert(behind, (cell.clone(), score));
        rows.timing.insert(behind, (cell, time));
    }
    Ok(sources)
}

type PeerRow = (StabilityCell, StabilityScore, StabilityTime);

/// Rows of cells that a plan has but for the method, and who measured them: `MuJoCo 4.0.0, 2026-11-22`. Nothing where there is no file.
///
/// # Errors
/// As of [`join_peers`].
pub(super) fn peer_rows(plan: &StabilityPlan) -> Result<(Vec<PeerRow>, String)> {
    let Some(path) = plan.peers.as_ref().filter(|path| path.exists()) else {
        return Ok(Default::default());
    };
    // A line is read once for each of its parts: serde's flattening takes an empty field for an empty text.
    let cells = read_rows::<StabilityCell>(path)?.into_iter();
    let found = cells.zip(read_rows(path)?).zip(read_rows(path)?);
    let mut sources: Vec<String> = Vec::new();
    let mut rows = Vec::new();
    for (((cell, score), time), source) in found.zip(read_rows::<PeerSource>(path)?) {
        if !is_asked(plan, &cell) {
            continue;
        }
        rows.push((cell, score, time));
        let PeerSource {
            program,
            version,
            date,
        } = source;
        let source = format!("{program} {version}, {date}");
        if !sources.contains(&source) {
            sources.push(source);
        }
    }
    Ok((rows, sources.join("; ")))
}

/// Whether the plan has a cell that differs in the method only.
fn is_asked(plan: &StabilityPlan, cell: &StabilityCell) -> bool {
    let is_like = |other: &StabilityCell| {
        let of_method = StabilityCell {
            method: cell.method,
            solver_iterations: cell.solver_iterations,
            ..other.clone()
        };
        of_method == *cell
    };
    cell.method.is_peer() && plan.cells().any(|(other, _)| is_like(other))
}
