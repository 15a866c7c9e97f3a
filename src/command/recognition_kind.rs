//! Studies that recognise objects.

use super::about_study::{add_manifest, add_touches, page_of_spec};
use super::piece_kind::{KindFacts, PieceKind};
use super::streams::note;
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::kinds::About;
use bubbletouch::kinds::ReportAbout;
use bubbletouch::kinds::recognition::{
    Outcome, RECOGNITION, RecognitionStudy, load_study, recognition_scale,
};
use bubbletouch::report::csv_tables::{LIMITS_FILE, read_rows};
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::{ReportPage, StudyAbout};
use bubbletouch::report::recognition;
use bubbletouch::report::results::{all_files, write_page};
use bubbletouch::study::pieces::Scale;
use bubbletouch::study::provenance::RECOGNITION_METHODS;
use std::path::{Path, PathBuf};

pub struct RecognitionKind {
    study: RecognitionStudy,
    scale: Scale,
}

impl RecognitionKind {
    fn page(&self, name: &str) -> Result<ReportPage> {
        let mut page = page_of_spec(&self.study.first().plan.spec, name);
        add_touches(&mut page, &self.study)?;
        Ok(page)
    }
}

impl PieceKind for RecognitionKind {
    type Study = RecognitionStudy;

    const KIND: About = RECOGNITION;

    const METHODS: &'static [(&'static str, &'static str)] = &RECOGNITION_METHODS;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        let mut source = args.source()?;
        source.packings = Some(packings);
        let study = load_study(&source)?;
        let (scale, _) = recognition_scale(&study, args.memory, &args.results);
        Ok(Self { study, scale })
    }

    fn study(&self) -> &RecognitionStudy {
        &self.study
    }

    fn scale(&self) -> Scale {
        self.scale.clone()
    }

    fn facts(&self) -> Result<KindFacts> {
        let spec = &self.study.first().plan.spec;
        Ok(KindFacts {
            toml: spec.to_toml(),
            asked: [spec.question.clone(), spec.expected.clone()],
            seed: spec.seed,
            content: self.study.content(),
        })
    }

    fn folder<'a>(
        &self,
        outcome: &Outcome,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>> {
        let mut page = self.page(&about.name)?;
        page.limits.clone_from(&outcome.limits);
        if let Some(manifest) = about.manifest.clone() {
            add_manifest(&mut page, manifest);
        }
        page.wall_s = Some(about.wall_s);
        all_files(folder, &outcome.tables, &page)
    }

    fn words(&self, outcome: &Outcome, width: usize) -> String {
        match recognition::tables_of(&outcome.tables, &[]) {
            Ok(tables) => recognition::words(&tables, width),
            Err(error) => error.to_string(),
        }
    }

    fn report(&self, folder: &Path, about: &ReportAbout) -> Result<()> {
        let mut page = self.page(&about.name)?;
        page.all_charts = about.all_charts;
        let limits = folder.join(LIMITS_FILE);
        match limits.exists() {
            true => page.limits = read_rows(&limits)?,
            false => note(format_args!(
                "note: the page does not say which limits were reached: there is no {}",
                limits.display()
            )),
        }
        if let Some(manifest) = about.manifest.clone() {
            add_manifest(&mut page, manifest);
        }
        page.command.clone_from(&about.command);
        write_page(folder, &recognition::read_tables(folder)?, &page).map(|_| ())
    }
}
