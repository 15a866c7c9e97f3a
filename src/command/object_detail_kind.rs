//! Studies of how detailed objects are.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::folder::Folder;
use bubbletouch::report::object_detail_results::{object_detail_folder, object_detail_summary};
use bubbletouch::report::page::StudyAbout;
use bubbletouch::study::StudyKind;
use bubbletouch::study::object_detail::ObjectDetailStudy;
use bubbletouch::study::object_detail::table::ObjectDetailTables;
use bubbletouch::study::pieces::Scale;
use bubbletouch::study::{load_named_meshes, objects_content};
use std::path::{Path, PathBuf};

pub struct ObjectDetailKind(ObjectDetailStudy);

impl PieceKind for ObjectDetailKind {
    type Study = ObjectDetailStudy;

    const KIND: StudyKind = StudyKind::ObjectDetail;

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

    fn scale(&self) -> Scale {
        let plan = &self.0.plan;
        let n_objects = self.0.meshes.len();
        let per_object = plan.placement.per_object.unwrap_or(1);
        let n_levels = plan.tolerances.len() * plan.spec.object_detail.methods.len() + 1;
        let (learned, n_classifiers) = match &plan.recognition {
            Some(learned) => (
                learned.n_training + learned.n_test,
                learned.classifiers.len(),
            ),
            None => (0, 0),
        };
        let n_taxels = plan.patch.grid.n_taxels() as f64;
        // Frames of every level, as they were and as they were read.
        let frames = (n_objects * learned) as f64 * n_taxels * plan.tolerances.len() as f64;
        Scale {
            objects: format!("{n_objects} meshes, in up to {n_levels} models each"),
            touches: match learned {
                0 => format!("{per_object} of each model"),
                n => format!("{per_object} of each model, {n} of each for recognition"),
            },
            n_configurations: n_objects * n_levels + n_levels * n_classifiers,
            bytes: 16.0 * frames,
            ..Scale::default()
        }
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
