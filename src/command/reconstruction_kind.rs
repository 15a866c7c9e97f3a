//! Studies that reconstruct frames.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::random::Seed;
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::reconstruction_frames::{draw_samples, shown_cells};
use bubbletouch::report::reconstruction_results::reconstruction_folder;
use bubbletouch::report::reconstruction_text::reconstruction_summary;
use bubbletouch::study::StudyKind;
use bubbletouch::study::pieces::Scale;
use bubbletouch::study::reconstruction::ReconstructionStudy;
use bubbletouch::study::reconstruction::table::ReconstructionTables;
use bubbletouch::study::{draw_touches, load_objects, millimetres, objects_content};
use std::path::{Path, PathBuf};

pub struct ReconstructionKind(ReconstructionStudy);

impl PieceKind for ReconstructionKind {
    type Study = ReconstructionStudy;

    const KIND: StudyKind = StudyKind::Reconstruction;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        let plan = args.reconstruction_plan()?;
        let objects = load_objects(&plan.spec.objects, Some(&packings))?;
        let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed))?;
        Ok(Self(ReconstructionStudy::new(plan, touched)))
    }

    fn study(&self) -> &ReconstructionStudy {
        &self.0
    }

    fn scale(&self) -> Scale {
        let plan = &self.0.plan;
        let n_touches: usize = self.0.touched.iter().map(|t| t.touches.len()).sum();
        let n_taxels = plan.patch.grid.n_taxels() as f64;
        // Frames clean, read and reconstructed; one dictionary.
        let frames = 3.0 * n_touches as f64 * n_taxels;
        Scale {
            objects: self.0.touched.len().to_string(),
            touches: format!("{n_touches} on one array"),
            n_configurations: self.0.n_cells(),
            bytes: 8.0 * (frames + n_taxels * n_taxels),
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
        tables: &ReconstructionTables,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>> {
        let plan = &self.0.plan;
        let samples = self.0.samples(&shown_cells(tables))?;
        let grid = plan.patch.grid;
        let (shape, pitch_mm) = ((grid.ny, grid.nx), millimetres(grid.pitch));
        let frames = draw_samples(tables, &samples, shape, pitch_mm, plan.quantity())?;
        reconstruction_folder(folder, tables, &frames, about)
    }

    fn words(&self, tables: &ReconstructionTables, width: usize) -> String {
        let n_objects = self.0.touched.len();
        let summary = reconstruction_summary(tables, width);
        // Told after the frames were drawn: their numbers are known.
        let (n_train, n_test) = self.0.n_touches().unwrap_or_default();
        format!(
            "{n_objects} objects; dictionaries learned from {n_train} clean training touches, tested on {n_test} others\n\n{summary}"
        )
    }
}
