//! Studies of what accuracy costs.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::speed_accuracy::{speed_accuracy_folder, speed_accuracy_summary};
use bubbletouch::study::StudyKind;
use bubbletouch::study::pieces::{PieceStudy, Scale};
use bubbletouch::study::speed_accuracy::SpeedAccuracyStudy;
use bubbletouch::study::speed_accuracy::table::SpeedAccuracyTables;
use std::path::{Path, PathBuf};

pub struct SpeedAccuracyKind(SpeedAccuracyStudy);

impl PieceKind for SpeedAccuracyKind {
    type Study = SpeedAccuracyStudy;

    const KIND: StudyKind = StudyKind::SpeedAccuracy;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        let plan = args.speed_accuracy_plan()?;
        Ok(Self(SpeedAccuracyStudy::new(plan, Some(packings))?))
    }

    fn study(&self) -> &SpeedAccuracyStudy {
        &self.0
    }

    fn scale(&self) -> Scale {
        let plan = &self.0.plan;
        let mut touches = Vec::new();
        let mut bytes = 0.0;
        if let Some(contact) = &plan.contact {
            touches.push(format!(
                "{} of each object in contact",
                contact.spec.touches
            ));
        }
        if let Some(sweep) = &plan.recognition {
            let spec = &sweep.spec;
            let per_object = spec.training_touches + spec.test_touches;
            touches.push(format!("{per_object} of each in recognition"));
            let n_taxels = sweep.patches.iter().map(|patch| patch.grid.n_taxels());
            let n_taxels = n_taxels.max().unwrap_or(0);
            bytes = 8.0 * (spec.objects * per_object * n_taxels) as f64;
        }
        if let Some(resolution) = &plan.resolution {
            let most = resolution.spec.touches.iter().max().copied();
            touches.push(format!("up to {} of each in resolution", most.unwrap_or(0)));
        }
        Scale {
            objects: self.0.n_objects().to_string(),
            touches: touches.join(", "),
            n_configurations: self.0.pieces().len(),
            bytes,
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
        tables: &SpeedAccuracyTables,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>> {
        speed_accuracy_folder(folder, tables, about)
    }

    fn words(&self, tables: &SpeedAccuracyTables, width: usize) -> String {
        let mut words = speed_accuracy_summary(tables, width);
        let Some(contact) = &self.0.plan.contact else {
            return words;
        };
        if let Some(path) = contact.peers.as_ref().filter(|path| !path.exists()) {
            words += &format!("Without other programs: there is no {}\n", path.display());
        }
        if let Some(scans) = self.0.plan.scans().filter(|s| !s.meshes.is_dir()) {
            let folder = scans.meshes.display();
            words += &format!("Without scans: there is no folder {folder}; --objects names one\n");
        }
        words
    }
}
