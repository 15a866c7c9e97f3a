//! Studies of how detailed objects are.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::folder::Folder;
use bubbletouch::report::object_detail_results::{object_detail_folder, object_detail_summary};
use bubbletouch::report::page::StudyAbout;
use bubbletouch::study::object_detail::ObjectDetailStudy;
use bubbletouch::study::object_detail::table::ObjectDetailTables;
use bubbletouch::study::{load_named_meshes, objects_content};
use std::path::{Path, PathBuf};

pub struct ObjectDetailKind(ObjectDetailStudy);

impl PieceKind for ObjectDetailKind {
    type Study = ObjectDetailStudy;

    const WRITE_S: f64 = 1.0;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        let plan = args.object_detail_plan()?;
        let meshes = load_named_meshes(plan.meshes(), &plan.spec.objects)?;
        Ok(Self(ObjectDetailStudy {
            plan,
            meshes,
            packings: Some(packings),
        }))
    }

    fn study(&self) -> &ObjectDetailStudy {
        &self.0
    }

    fn facts(&self) -> Result<KindFacts> {
        let spec = &self.0.plan.spec;
        Ok(KindFacts {
            toml: spec.to_toml(),
            asked: [spec.question.clone(), spec.expected.clone()],
            seed: spec.seed,
            content: objects_content(&spec.objects)?,
        })
    }

    fn folder<'a>(
        &self,
        tables: &ObjectDetailTables,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>> {
        object_detail_folder(folder, tables, about)
    }

    fn words(&self, tables: &ObjectDetailTables, width: usize) -> String {
        let (n_meshes, n_models) = (self.0.meshes.len(), self.0.plan.n_models());
        let summary = object_detail_summary(tables, width);
        format!("{n_meshes} meshes, {n_models} models of each\n\n{summary}")
    }
}
