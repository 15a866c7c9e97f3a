//! Studies of where contact methods break.

use super::piece_kind::{KindFacts, PieceKind};
use super::study_args::StudyArgs;
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::stability_results::{stability_folder, stability_summary};
use bubbletouch::study::StudyKind;
use bubbletouch::study::pieces::Scale;
use bubbletouch::study::stability::StabilityPlan;
use bubbletouch::study::stability::table::StabilityTables;
use bubbletouch::{Error, Result};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub struct StabilityKind(StabilityPlan);

impl PieceKind for StabilityKind {
    type Study = StabilityPlan;

    const KIND: StudyKind = StudyKind::Stability;

    fn load(args: &StudyArgs, _packings: PathBuf) -> Result<Self> {
        if args.objects.is_some() || args.seed.is_some() {
            let allowed = "neither: nothing is drawn at random, and a ball is what touches";
            return Err(Error::input("--objects, --seed", "given", allowed));
        }
        Ok(Self(args.stability_plan()?))
    }

    fn study(&self) -> &StabilityPlan {
        &self.0
    }

    fn scale(&self) -> Scale {
        // Of a taxel in a thread: the state, its history and an engine's body, bytes.
        const TAXEL_BYTES: f64 = 2000.0;
        let cells = || self.0.parts.iter().flat_map(|part| &part.cells);
        let most = cells().map(|cell| cell.taxels * cell.taxels).max();
        let n_threads = rayon::current_num_threads();
        Scale {
            objects: "a ball and a plunger".to_owned(),
            touches: format!("one a configuration, on up to {} taxels", most.unwrap_or(0)),
            n_configurations: self.0.n_cells(),
            bytes: TAXEL_BYTES * (n_threads * most.unwrap_or(0)) as f64,
            ..Scale::default()
        }
    }

    /// Nothing is drawn at random, and no object is loaded.
    fn facts(&self) -> Result<KindFacts> {
        let spec = &self.0.spec;
        Ok(KindFacts {
            toml: spec.to_toml(),
            asked: [spec.question.clone(), spec.expected.clone()],
            seed: 0,
            content: BTreeMap::new(),
        })
    }

    fn folder<'a>(
        &self,
        tables: &StabilityTables,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>> {
        stability_folder(folder, tables, about)
    }

    fn words(&self, tables: &StabilityTables, width: usize) -> String {
        let mut words = stability_summary(tables, width);
        if !cfg!(feature = "rapier") {
            words += "Without rapier's rows: this command was built without --features rapier\n";
        }
        words
    }
}
