//! Studies of where recognition breaks.

use super::piece_kind::PieceKind;
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::breaking_points_results::{
    breaking_points_summary, write_breaking_points,
};
use bubbletouch::report::page::StudyAbout;
use bubbletouch::study::breaking_points::BreakingPointsStudy;
use bubbletouch::study::breaking_points::table::BreakingPointsTables;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub struct BreakingPointsKind(BreakingPointsStudy);

impl PieceKind for BreakingPointsKind {
    type Study = BreakingPointsStudy;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        Ok(Self(BreakingPointsStudy {
            plan: args.breaking_points_plan()?,
            packings: Some(packings),
        }))
    }

    fn study(&self) -> &BreakingPointsStudy {
        &self.0
    }

    fn to_toml(&self) -> String {
        self.0.plan.spec.to_toml()
    }

    fn asked(&self) -> (&str, &str) {
        let spec = &self.0.plan.spec;
        (&spec.question, &spec.expected)
    }

    fn seed(&self) -> u64 {
        self.0.plan.spec.seed
    }

    fn content(&self) -> Result<BTreeMap<String, String>> {
        self.0.content()
    }

    fn write(
        &self,
        tables: &BreakingPointsTables,
        folder: &Path,
        about: &StudyAbout,
    ) -> Result<()> {
        write_breaking_points(folder, &self.0.plan.ways, tables, about).map(drop)
    }

    fn words(&self, tables: &BreakingPointsTables, width: usize) -> String {
        breaking_points_summary(tables, width)
    }
}
