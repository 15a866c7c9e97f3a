//! Runs a study of breaking points: every value of every way, on all threads.

use super::half::breaking_points;
use super::plan::{BreakingPointsPlan, PlannedValue, PlannedWay};
use super::rows::{BreakingPoint, CellScore, TrialScore, TrialTime, WayCell};
use super::value::{ObjectSets, evaluate};
use crate::error::Result;
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::bootstrap::Bootstrap;
use crate::study::Plan;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::summary::score;
use crate::study::time_left::Piece;
use crate::table::{File, Table};
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
    pub(super) accuracy: Vec<(WayCell, TrialScore)>,
    pub(super) timing: Vec<(WayCell, TrialTime)>,
    /// How many objects each way tells apart.
    pub(super) n_objects: BTreeMap<String, usize>,
}

impl PieceRows for DrivenRows {
    fn append(&mut self, next: Self) {
        self.n_objects.extend(next.n_objects);
        self.accuracy.extend(next.accuracy);
        self.timing.extend(next.timing);
    }
}

/// Tables.
pub(super) const ACCURACY: File<(WayCell, TrialScore)> =
    File::new("accuracy.csv", "Accuracy of every trial", "");
pub(super) const SUMMARY: File<(WayCell, CellScore)> =
    File::new("summary.csv", "Accuracy at every value", "");
pub(super) const BREAKS: File<BreakingPoint> = File::new(
    "breaking_points.csv",
    "Breaking points",
    "Each setting alone is driven to its ends; the interval is that of the place where accuracy is half of its best.",
)
.summary();
pub(super) const TIMING: File<(WayCell, TrialTime)> =
    File::new("timing.csv", "Time of every trial", "").of_times();

/// Objects that are not counted before they are loaded are as many as this, for estimates.
pub(super) const N_OBJECTS: usize = 30;
/// Processor-seconds to press, read and project one taxel in a trial, about.
const SECONDS_PER_READING: f64 = 1e-7;

impl BreakingPointsStudy {
    /// All values of all ways, each with its name as a work item.
    fn named_values(&self) -> impl Iterator<Item = (String, &PlannedWay, &PlannedValue)> {
        self.plan.ways.iter().flat_map(|way| {
            let values = way.values.iter();
            values.map(move |value| (format!("{} at {}", way.spec.name, value.value), way, value))
        })
    }
}

/// Numbers that a value reads of one object.
pub(super) fn n_read(value: &PlannedValue) -> usize {
    let of_plan =
        |plan: &Plan| plan.arrays[0].grid.n_taxels() * plan.placement.per_object.unwrap_or(1);
    value.plans().map(of_plan).sum()
}

impl PieceStudy for BreakingPointsStudy {
    type Rows = DrivenRows;

    fn pieces(&self) -> Vec<NamedPiece> {
        let pieces = self.named_values().enumerate();
        let pieces = pieces.map(|(group, (name, _, value))| {
            let n_read = (N_OBJECTS * n_read(value) * self.plan.spec.trials) as f64;
            let work = Piece::of_stage(0, SECONDS_PER_READING * n_read);
            // The study at this value is all that it depends on.
            let specs: Vec<_> = value.plans().map(|plan| &plan.spec).collect();
            NamedPiece::new(name, group, work).made_of(specs)
        });
        pieces.collect()
    }

    fn measure(&self, left: &PiecesLeft<DrivenRows>) -> Result<()> {
        let values = left.of(self.named_values(), |(name, ..)| name.clone());
        let plans = values.iter().flat_map(|(.., value)| value.plans());
        let sets = ObjectSets::load(plans, self.packings.as_deref(), left.progress)?;
        left.progress.stage("drive", values.len() as u64);
        values
            .par_iter()
            // One at a time: values of one way may all be slow.
            .with_max_len(1)
            .try_for_each(|(name, way, value)| {
                left.finish(name, || {
                    evaluate(&way.spec, value, &sets).map_err(|error| {
                        error.under(format!("way {} at {}, ", way.spec.name, value.value))
                    })
                })
            })
    }

    fn tables(&self, rows: DrivenRows) -> Result<Vec<Table>> {
        let mut bootstrap = Bootstrap::default();
        let cells = rows.accuracy.chunk_by(|a, b| a.0 == b.0);
        let summary = cells.map(|trials| {
            let scores: Vec<&TrialScore> = trials.iter().map(|(_, score)| score).collect();
            Ok((trials[0].0.clone(), score(&scores, &mut bootstrap)?))
        });
        let summary: Vec<(WayCell, CellScore)> = summary.collect::<Result<_>>()?;
        let breaks = self.plan.ways.iter().flat_map(|way| {
            let n_objects = rows.n_objects.get(&way.spec.name);
            self.breaks(way, &summary, n_objects.copied().unwrap_or(0))
        });
        Ok(vec![
            ACCURACY.of(&rows.accuracy)?,
            SUMMARY.of(&summary)?,
            BREAKS.of(&breaks.collect::<Vec<_>>())?,
            TIMING.of(&rows.timing)?,
        ])
    }
}

impl BreakingPointsStudy {
    /// Where a way breaks each classifier.
    fn breaks(
        &self,
        way: &PlannedWay,
        summary: &[(WayCell, CellScore)],
        n_objects: usize,
    ) -> Vec<BreakingPoint> {
        let of_way = summary.iter().filter(|(cell, _)| cell.way == way.spec.name);
        let mut curves: Vec<(ClassifierKind, Vec<(f64, CellScore)>)> = Vec::new();
        for (cell, score) in of_way {
            let point = (cell.value, score.clone());
            match curves.iter_mut().find(|curve| curve.0 == cell.classifier) {
                Some(curve) => curve.1.push(point),
                None => curves.push((cell.classifier, vec![point])),
            }
        }
        let seed = Seed::new(self.plan.spec.seed).named("breaking points");
        let seed = seed.named(&way.spec.name);
        let curves = curves.iter().enumerate();
        let breaks = curves.flat_map(|(number, (classifier, points))| {
            let seed = seed.numbered(number as u64);
            breaking_points((&way.spec, *classifier), points, n_objects, &seed)
        });
        breaks.collect()
    }
}
