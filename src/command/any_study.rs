//! A study of any kind, as the commands see it that run it, merge it, submit it and verify it.

use super::breaking_points_kind::BreakingPointsKind;
use super::listener::Listener;
use super::memory_args::{CeilingArgs, MemoryArgs, not_of_pieces};
use super::object_detail_kind::ObjectDetailKind;
use super::piece_kind::PieceRun;
use super::recognition_study::RecognitionStudy;
use super::reconstruction_kind::ReconstructionKind;
use super::speed_accuracy_kind::SpeedAccuracyKind;
use super::stability_kind::StabilityKind;
use super::study_args::StudyArgs;
use super::whole_body_kind::WholeBodyKind;
use bubbletouch::report::csv_tables::FAILURES_FILE;
use bubbletouch::study::journal::{Identity, Journal};
use bubbletouch::study::pieces::PieceManner;
use bubbletouch::study::progress::Progress;
use bubbletouch::study::{Part, StudyKind};
use bubbletouch::{Error, Result};
use std::path::Path;
use std::time::SystemTime;

/// A study that is loaded and checked.
pub trait AnyStudy {
    /// What its results depend on.
    fn identity(&self) -> &Identity;
    /// What its work is counted in: `cells` or `pieces`.
    fn units(&self) -> &'static str;
    /// How many; cells count once a trial.
    fn n_all(&self) -> usize;
    /// What it asks, and what it will take.
    fn plan(&self, ceiling: &CeilingArgs) -> Result<String>;
    /// Of a part, those of which a journal does not say what came of them.
    fn n_left(&self, part: Part, journal: &Journal) -> usize;
    /// Does what is left.
    fn run<'a>(&'a self, manner: &PieceManner<'a>) -> Result<Box<dyn AnyOutcome + 'a>>;
    /// Runs some of its work again, drawn at random, and says what it was, or which row of a folder is not the same.
    fn verify(&self, folder: &Path, n: usize, draw: u64) -> Result<String>;
}

/// What came of a study.
pub trait AnyOutcome {
    /// How much of it failed, and how much there is.
    fn n_failed(&self) -> usize;
    /// Writes tables, charts and page, the study and the manifest.
    fn write(&self, ended: &EndedRun) -> Result<()>;
    /// Says to a person, on standard output, what was found.
    fn tell(&self, folder: &Path) -> Result<()>;
}

/// A run that has done its work, and where its files go.
pub struct EndedRun<'a> {
    pub args: &'a StudyArgs,
    pub folder: &'a Path,
    pub started: SystemTime,
    /// What was finished before it.
    pub n_before: usize,
    pub progress: &'a dyn Progress,
}

/// Reads and checks a study of any kind and loads its objects; `memory` is needed where it will run.
pub fn load_study(
    args: &StudyArgs,
    folder: &Path,
    memory: Option<&MemoryArgs>,
) -> Result<Box<dyn AnyStudy>> {
    let kind = args.kind()?;
    let mut given = memory.into_iter().flat_map(MemoryArgs::given);
    if kind != StudyKind::Recognition
        && let Some((option, _)) = given.find(|(_, is_given)| *is_given)
    {
        return Err(not_of_pieces(option, kind));
    }
    Ok(match kind {
        StudyKind::Recognition => Box::new(RecognitionStudy::load(args, folder, memory)?),
        StudyKind::Reconstruction => Box::new(PieceRun::<ReconstructionKind>::load(args, folder)?),
        StudyKind::ObjectDetail => Box::new(PieceRun::<ObjectDetailKind>::load(args, folder)?),
        StudyKind::WholeBody => Box::new(PieceRun::<WholeBodyKind>::load(args, folder)?),
        StudyKind::Stability => Box::new(PieceRun::<StabilityKind>::load(args, folder)?),
        StudyKind::BreakingPoints => Box::new(PieceRun::<BreakingPointsKind>::load(args, folder)?),
        StudyKind::SpeedAccuracy => Box::new(PieceRun::<SpeedAccuracyKind>::load(args, folder)?),
    })
}

/// Writes and tells what came of a study; an error if some of it failed.
pub fn end(
    study: &dyn AnyStudy,
    outcome: &dyn AnyOutcome,
    run: &EndedRun,
    (listener, what): (Listener, &str),
) -> Result<()> {
    run.progress.stage("report", 1);
    outcome.write(run)?;
    run.progress.advance(1);
    let elapsed_s = seconds_since(run.started);
    run.progress.finish(&format!("{what}{elapsed_s:.1} s"));
    listener.finished(serde_json::json!({
        "event": "finished",
        "folder": run.folder,
        study.units(): study.n_all(),
        "finished_before": run.n_before,
        "failed": outcome.n_failed(),
        "elapsed_s": elapsed_s,
    }))?;
    if listener.is_person() {
        outcome.tell(run.folder)?;
    }
    failures(study, outcome, run.folder)
}

/// An error if some of a study failed.
pub fn failures(study: &dyn AnyStudy, outcome: &dyn AnyOutcome, folder: &Path) -> Result<()> {
    match outcome.n_failed() {
        0 => Ok(()),
        n_failed => Err(Error::Cells {
            path: folder.join(FAILURES_FILE),
            what: study.units(),
            n_failed,
            n_all: study.n_all(),
        }),
    }
}

pub fn seconds_since(started: SystemTime) -> f64 {
    started.elapsed().unwrap_or_default().as_secs_f64()
}
