//! Studies of a whole body of skin.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::whole_body_results::{whole_body_folder, whole_body_summary};
use bubbletouch::study::StudyKind;
use bubbletouch::study::file_content;
use bubbletouch::study::pieces::Scale;
use bubbletouch::study::whole_body::table::WholeBodyTables;
use bubbletouch::study::whole_body::{WholeBodyPlan, picture_body};
use std::path::{Path, PathBuf};

pub struct WholeBodyKind {
    plan: WholeBodyPlan,
    /// The robot's file.
    robot: PathBuf,
}

impl PieceKind for WholeBodyKind {
    type Study = WholeBodyPlan;

    const KIND: StudyKind = StudyKind::WholeBody;

    fn load(args: &StudyArgs, _packings: PathBuf) -> Result<Self> {
        let plan = args.whole_body_plan()?;
        let robot = args.folder().join(&plan.spec.whole_body.robot);
        Ok(Self { plan, robot })
    }

    fn study(&self) -> &WholeBodyPlan {
        &self.plan
    }

    fn scale(&self) -> Scale {
        // A taxel's place and what its compressions keep of it, bytes.
        const TAXEL_BYTES: f64 = 150.0;
        // Of a body, about, square metres.
        const AREA: f64 = 2.0;
        let plan = &self.plan;
        let learned = &plan.recognition;
        let n_touches = learned.objects.len() * (learned.n_training + learned.n_test);
        let n_taxels = AREA / (plan.pitch * plan.pitch);
        Scale {
            objects: format!(
                "{} to tell apart, {} scenes",
                learned.objects.len(),
                plan.scenes.len()
            ),
            touches: format!("{n_touches} on a body of about {n_taxels:.0} taxels"),
            n_configurations: plan.compressions.len() + plan.scenes.len(),
            bytes: TAXEL_BYTES * n_taxels,
            ..Scale::default()
        }
    }

    fn facts(&self) -> Result<KindFacts> {
        let spec = &self.plan.spec;
        Ok(KindFacts {
            toml: spec.to_toml(),
            asked: [spec.question.clone(), spec.expected.clone()],
            seed: spec.seed,
            content: [("robot".to_owned(), file_content(&self.robot)?)].into(),
        })
    }

    fn folder<'a>(
        &self,
        tables: &WholeBodyTables,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>> {
        let picture = picture_body(&self.plan, tables)?;
        whole_body_folder(folder, (tables, picture.as_ref()), about)
    }

    fn words(&self, tables: &WholeBodyTables, width: usize) -> String {
        whole_body_summary(tables, width)
    }
}
