//! Studies of where recognition breaks.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::breaking_points_results::{
    breaking_points_folder, breaking_points_summary,
};
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::study::breaking_points::BreakingPointsStudy;
use bubbletouch::study::breaking_points::table::BreakingPointsTables;
use std::path::{Path, PathBuf};

pub struct BreakingPointsKind(BreakingPointsStudy);

impl PieceKind for BreakingPointsKind {
    type Study = BreakingPointsStudy;

    const WRITE_S: f64 = 6.0;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        Ok(Self(BreakingPointsStudy {
            plan: args.breaking_points_plan()?,
            packings: Some(packings),
        }))
    }

    fn study(&self) -> &BreakingPointsStudy {
        &self.0
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
