//! Studies of where recognition breaks.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::breaking_points_results::{
    breaking_points_folder, breaking_points_summary,
};
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::study::StudyKind;
use bubbletouch::study::breaking_points::BreakingPointsStudy;
use bubbletouch::study::breaking_points::table::BreakingPointsTables;
use bubbletouch::study::breaking_points::{N_OBJECTS, PlannedValue};
use bubbletouch::study::pieces::Scale;
use std::path::{Path, PathBuf};

pub struct BreakingPointsKind(BreakingPointsStudy);

impl PieceKind for BreakingPointsKind {
    type Study = BreakingPointsStudy;

    const KIND: StudyKind = StudyKind::BreakingPoints;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        Ok(Self(BreakingPointsStudy {
            plan: args.breaking_points_plan()?,
            packings: Some(packings),
        }))
    }

    fn study(&self) -> &BreakingPointsStudy {
        &self.0
    }

    fn scale(&self) -> Scale {
        let values = || self.0.plan.ways.iter().flat_map(|way| &way.values);
        let n_taxels = |value: &PlannedValue| value.learned.arrays[0].grid.n_taxels();
        let per_object = |value: &PlannedValue| value.learned.placement.per_object.unwrap_or(1);
        let most = values()
            .map(|value| n_taxels(value) * per_object(value))
            .max();
        let touches = values().map(per_object).max().unwrap_or(0);
        let n_threads = rayon::current_num_threads();
        Scale {
            objects: "those of each value".to_owned(),
            touches: format!("up to {touches} of each object at each value"),
            n_configurations: values().map(|value| value.learned.classifiers.len()).sum(),
            // Values are driven on all threads, their frames in single precision.
            bytes: 4.0 * N_OBJECTS * (n_threads * most.unwrap_or(0)) as f64,
            ..Scale::default()
        }
    }

    fn facts(&self) -> Result<KindFacts> {
        let spec = &self.0.plan.spec;
        Ok(KindFacts {
            toml: spec.to_toml(),
            asked: [spec.question.clone(), spec.expected.clone()],
            seed: spec.seed,
            content: self.0.content()?,
        })
    }

    fn folder<'a>(
        &self,
        tables: &BreakingPointsTables,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>> {
        breaking_points_folder(folder, &self.0.plan.ways, tables, about)
    }

    fn words(&self, tables: &BreakingPointsTables, width: usize) -> String {
        breaking_points_summary(tables, width)
    }
}
