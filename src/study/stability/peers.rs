//! What other programs make of the same cells, as they left it in a file.

use super::plan::StabilityPlan;
use super::table::{PeerSource, StabilityCell, StabilityScore, StabilityTables, StabilityTime};
use crate::error::Result;
use crate::files::table_error;
use std::path::Path;

type Row = (StabilityCell, StabilityScore, StabilityTime, PeerSource);

/// Puts the rows of a plan's file behind those of the parts that have such a cell; nothing where there is no file.
///
/// The error names the file and the line.
pub(super) fn join_peers(plan: &StabilityPlan, tables: &mut StabilityTables) -> Result<()> {
    let Some(path) = plan.peers.as_ref().filter(|path| path.exists()) else {
        return Ok(());
    };
    let rows = read(path)?;
    let rows: Vec<Row> = rows
        .into_iter()
        .filter(|row| is_asked(plan, &row.0))
        .collect();
    let mut sources: Vec<String> = Vec::new();
    for (
        cell,
        score,
        time,
        PeerSource {
            program,
            version,
            date,
        },
    ) in rows
    {
        let source = format!("{program} {version}, {date}");
        if !sources.contains(&source) {
            sources.push(source);
        }
        let behind = tables
            .stability
            .partition_point(|(other, _)| other.part <= cell.part);
        tables.stability.insert(behind, (cell.clone(), score));
        tables.timing.insert(behind, (cell, time));
    }
    tables.peers = sources.join("; ");
    Ok(())
}

/// Whether the plan has a cell that differs in the method only.
fn is_asked(plan: &StabilityPlan, cell: &StabilityCell) -> bool {
    let cells = plan.parts.iter().flat_map(|part| &part.cells);
    let is_like = |other: &StabilityCell| {
        let of_method = StabilityCell {
            method: cell.method,
            solver_iterations: cell.solver_iterations,
            ..other.clone()
        };
        of_method == *cell
    };
    cell.method.is_peer() && cells.into_iter().any(is_like)
}

fn read(path: &Path) -> Result<Vec<Row>> {
    let failed = table_error(path, "a table as benches/peers/stability.py writes it");
    let mut reader = csv::Reader::from_path(path).map_err(&failed)?;
    let headers = reader.headers().map_err(&failed)?.clone();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(&failed)?;
        // A line is read once for each of its parts: serde's flattening takes an empty field for an empty text.
        rows.push((
            record.deserialize(Some(&headers)).map_err(&failed)?,
            record.deserialize(Some(&headers)).map_err(&failed)?,
            record.deserialize(Some(&headers)).map_err(&failed)?,
            record.deserialize(Some(&headers)).map_err(&failed)?,
        ));
    }
    Ok(rows)
}
