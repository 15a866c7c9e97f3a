//! Runs a study of stability: all cells on all threads.

use super::cell::measure;
use super::cost::planned_s;
use super::peers::join_peers;
use super::plan::StabilityPlan;
use super::summary::summary;
use super::table::{StabilityCell, StabilityTables};
use crate::error::Result;
use crate::study::millimetres;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::time_left::Piece;
use rayon::prelude::*;

impl StabilityPlan {
    /// All cells, each with its name as a piece and its stroke.
    fn named_cells(&self) -> impl Iterator<Item = (String, &StabilityCell, f64)> {
        let cells = self.parts.iter();
        let cells = cells.flat_map(|part| part.cells.iter().map(|cell| (cell, part.stroke)));
        cells.map(|(cell, stroke)| (name(cell, stroke), cell, stroke))
    }
}

/// By its settings: which cells there are depends on what the program was built with.
fn name(cell: &StabilityCell, stroke: f64) -> String {
    let stroke_mm = millimetres(stroke);
    let StabilityCell {
        part,
        scene,
        method,
        taxels,
        stiffness_n_per_m,
        taxel_mass_kg,
        dt_s,
        ..
    } = cell;
    let iterations = cell.solver_iterations;
    let iterations = iterations.map_or(String::new(), |n| format!(" of {n} iterations"));
    let ball = cell.object_mass_kg;
    let ball = ball.map_or(String::new(), |mass| format!(", ball of {mass} kg"));
    format!(
        "part {part}: {scene:?} by {method:?}{iterations}, {taxels} taxels a side of {stiffness_n_per_m} N/m and {taxel_mass_kg} \
         kg and a stroke of {stroke_mm} mm{ball}, steps of {dt_s} s"
    )
}

/// What a cell is planned to take.
fn work(cell: &StabilityCell) -> Piece {
    Piece::of_stage(0, planned_s(cell))
}

impl PieceStudy for StabilityPlan {
    type Rows = StabilityTables;
    type Tables = StabilityTables;

    fn pieces(&self) -> Vec<NamedPiece> {
        NamedPiece::each_alone(self.named_cells().map(|(name, cell, _)| (name, work(cell))))
    }

    fn measure(&self, left: &PiecesLeft<StabilityTables>) -> Result<()> {
        let cells = left.of(self.named_cells(), |(name, ..)| name.clone());
        left.progress.stage("stability", cells.len() as u64);
        cells
            .par_iter()
            // One at a time: a cell takes from microseconds to a minute.
            .with_max_len(1)
            .try_for_each(|(name, cell, stroke)| {
                left.finish(name, || {
                    let (score, time) = measure(cell, self.pitch, *stroke)?;
                    Ok(StabilityTables {
                        stability: vec![((*cell).clone(), score)],
                        timing: vec![((*cell).clone(), time)],
                        ..StabilityTables::default()
                    })
                })
            })
    }

    fn tables(&self, mut tables: StabilityTables) -> Result<StabilityTables> {
        join_peers(self, &mut tables)?;
        tables.summary = summary(&tables.stability);
        Ok(tables)
    }
}

impl PieceRows for StabilityTables {
    fn append(&mut self, next: Self) {
        self.stability.extend(next.stability);
        self.timing.extend(next.timing);
    }
}
