//! Runs a study of breaking points: every value of every way, on all threads.

use super::plan::{BreakingPointsPlan, PlannedValue, PlannedWay};
use super::table::BreakingPointsTables;
use super::value::{Evaluated, ObjectSets, add_way, evaluate, object_specs};
use crate::error::Result;
use crate::study::object_files::objects_content;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::time_left::Piece;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A study of breaking points, and where packings are looked for and kept, if anywhere.
pub struct BreakingPointsStudy {
    /// What to run.
    pub plan: BreakingPointsPlan,
    /// The folder of packings.
    pub packings: Option<PathBuf>,
}

/// What was found at a value of a way, or at several.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct DrivenRows {
    values: Vec<Evaluated>,
}

impl PieceRows for DrivenRows {
    fn append(&mut self, next: Self) {
        self.values.extend(next.values);
    }
}

impl BreakingPointsStudy {
    /// SHA-256 of what each object is made from, by its name, over all sets of objects that ways touch.
    ///
    /// # Errors
    /// Objects that are not there.
    pub fn content(&self) -> Result<BTreeMap<String, String>> {
        let mut content = BTreeMap::new();
        let values = self.plan.ways.iter().flat_map(|way| &way.values);
        for spec in object_specs(values) {
            content.extend(objects_content(spec)?);
        }
        Ok(content)
    }

    /// All values of all ways, each with its name as a piece.
    fn named_values(&self) -> impl Iterator<Item = (String, &PlannedWay, &PlannedValue)> {
        let ways = self.plan.ways.iter();
        ways.flat_map(|way| {
            let values = way.values.iter();
            values.map(move |value| (format!("{} at {}", way.name, value.value), way, value))
        })
    }
}

impl PieceStudy for BreakingPointsStudy {
    type Rows = DrivenRows;
    type Tables = BreakingPointsTables;

    fn pieces(&self) -> Vec<NamedPiece> {
        let pieces = self.named_values().enumerate();
        let pieces = pieces.map(|(group, (name, _, value))| {
            let work = Piece::of_stage(0, value.planned_s());
            // The study at this value is all that it depends on.
            let driven = (
                &value.learned.spec,
                value.tested.as_ref().map(|tested| &tested.spec),
            );
            NamedPiece::new(name, group, work).made_of(driven)
        });
        pieces.collect()
    }

    fn measure(&self, left: &PiecesLeft<DrivenRows>) -> Result<()> {
        let values = left.of(self.named_values(), |(name, ..)| name.clone());
        let plans = values.iter().map(|(.., value)| *value);
        let sets = ObjectSets::load(plans, self.packings.as_deref(), left.progress)?;
        left.progress.stage("drive", values.len() as u64);
        values
            .par_iter()
            // One at a time: values of one way may all be slow.
            .with_max_len(1)
            .try_for_each(|(name, way, value)| {
                left.finish(name, || {
                    let found = evaluate(way, value, &sets).map_err(|error| {
                        error.under(format!("way {} at {}, ", way.name, value.value))
                    })?;
                    Ok(DrivenRows {
                        values: vec![found],
                    })
                })
            })
    }

    fn tables(&self, rows: DrivenRows) -> Result<BreakingPointsTables> {
        let mut tables = BreakingPointsTables::default();
        let mut evaluated = rows.values.into_iter().peekable();
        for way in &self.plan.ways {
            let of_way =
                std::iter::from_fn(|| evaluated.next_if(|found| found.way == way.name)).collect();
            add_way(&mut tables, way, of_way, self.plan.spec.seed)?;
        }
        Ok(tables)
    }
}
