//! `bubbletouch run`: a study from its file to its folder of results.

use super::about_study::{add_manifest, add_touches, command_line, limits, page_of_spec};
use super::listener::Listener;
use super::memory_args::MemoryArgs;
use super::output::{packings_beside, terminal_width};
use super::run_breaking_points::run_breaking_points;
use super::run_object_detail::run_object_detail;
use super::run_reconstruction::run_reconstruction;
use super::run_speed_accuracy::run_speed_accuracy;
use super::run_stability::run_stability;
use super::run_whole_body::run_whole_body;
use super::study_args::{LoadedStudy, StudyArgs};
use super::study_folder::{Start, StudyFolder};
use bubbletouch::files::write_bytes;
use bubbletouch::report::csv_tables::repeatable_hashes;
use bubbletouch::report::{headlines, results, terminal};
use bubbletouch::study::journal::Identity;
use bubbletouch::study::provenance::{MANIFEST_FILE, Manifest, RunFacts};
use bubbletouch::study::time_left::{Piece, Work};
use bubbletouch::study::{Manner, Outcome, Part, Shard, StudyKind, n_left, run_with, workload};
use bubbletouch::{Error, Result};
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

#[derive(clap::Args)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Where to write tables, charts and report.html [default: results/ and the study's name]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Start over; what stands in the folder is kept beside it, as FOLDER.1, FOLDER.2 ... Without it, a run goes on from
    /// what an earlier run of the same study has finished
    #[arg(long)]
    fresh: bool,
    /// Stop at the first cell that fails, rather than record it in failures.csv and go on
    #[arg(long)]
    fail_fast: bool,
    /// Evaluate only part I of N of the cells, for one of N processes or machines; `bubbletouch merge` puts them together
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    listener: Listener,
    /// A demonstration runs anew unless it was interrupted.
    #[arg(skip)]
    is_demonstration: bool,
}

impl Args {
    /// What a bare `bubbletouch` runs.
    pub fn quickstart() -> Self {
        Self {
            study: StudyArgs::quickstart(),
            out: None,
            fresh: false,
            fail_fast: false,
            shard: None,
            memory: MemoryArgs::default(),
            listener: Listener::default(),
            is_demonstration: true,
        }
    }

    /// An error if there is an option that this kind of study has no use for yet.
    fn check_options(&self, kind: StudyKind) -> Result<()> {
        let given = [
            ("--fresh", self.fresh),
            ("--fail-fast", self.fail_fast),
            ("--shard", self.shard.is_some()),
        ];
        let given = given.into_iter().chain(self.memory.given());
        let given = given.into_iter().find(|(_, is_given)| *is_given);
        match given {
            Some((option, _)) if kind != StudyKind::Recognition => {
                let allowed = format!(
                    "no such option: it is for {}",
                    StudyKind::Recognition.words()
                );
                Err(Error::input(option, kind.words(), allowed))
            }
            _ => Ok(()),
        }
    }

    fn start(&self) -> Start {
        match (self.fresh, self.is_demonstration) {
            (true, _) => Start::Fresh,
            (false, true) => Start::Demonstration,
            (false, false) => Start::GoOn,
        }
    }
}

pub fn run(args: &Args) -> Result<()> {
    let folder = results_folder(&args.study, args.out.as_deref())?;
    let kind = args.study.kind()?;
    args.check_options(kind)?;
    match kind {
        StudyKind::Recognition => run_recognition(args, &folder),
        StudyKind::Reconstruction => run_reconstruction(&args.study, args.listener, &folder),
        StudyKind::ObjectDetail => run_object_detail(&args.study, args.listener, &folder),
        StudyKind::BreakingPoints => run_breaking_points(&args.study, args.listener, &folder),
        StudyKind::Stability => run_stability(&args.study, args.listener, &folder),
        StudyKind::SpeedAccuracy => run_speed_accuracy(&args.study, args.listener, &folder),
        StudyKind::WholeBody => run_whole_body(&args.study, args.listener, &folder),
    }
}

/// Where a study's results go.
pub fn results_folder(study: &StudyArgs, out: Option<&Path>) -> Result<PathBuf> {
    match out {
        Some(folder) => Ok(folder.to_owned()),
        None => Ok(Path::new("results").join(study.name()?)),
    }
}

fn run_recognition(args: &Args, folder: &Path) -> Result<()> {
    let started = SystemTime::now();
    let loaded = args.study.load(Some(&packings_beside(folder)))?;
    let room = args.memory.room(&loaded, folder)?;
    let identity = identity(&loaded);
    let kept = StudyFolder::open(folder, &identity, (args.start(), args.shard), args.listener)?;
    let n_all = loaded.n_evaluations();
    let n_left = n_left(&loaded.plan, &loaded.sweep, Part::All, &kept.journal);
    if n_left < n_all {
        let n_before = n_all - n_left;
        let going_on = format!("going on: {n_before} of {n_all} cells were finished before");
        args.listener.remark(&going_on);
    }
    let manner = Manner {
        journal: &kept.journal,
        fail_fast: args.fail_fast,
        retries: true,
        part: args.shard.map_or(Part::All, Part::Shard),
        storage: &room.storage,
        at_once: room.at_once,
    };
    let progress = args.listener.progress();
    let report = report_work(&loaded, args.shard);
    let work = workload(&loaded.plan, &loaded.sweep, loaded.touched.as_ref(), manner);
    progress.expect(&[&work[..], &[report]].concat());
    let outcome = run_with(
        &loaded.plan,
        &loaded.sweep,
        loaded.touched.as_ref(),
        progress.as_ref(),
        manner,
    )?;
    kept.journal.sync()?;
    if let Some(shard) = args.shard {
        progress.finish(&format!("{:.1} s", seconds_since(started)));
        let study = args.study.study.display();
        args.listener.remark(&format!(
            "shard {shard} is done; when all are, put them together: bubbletouch merge {study}"
        ));
        return failures(&outcome, folder);
    }
    let finished = FinishedStudy {
        args: &args.study,
        folder,
        loaded: &loaded,
        identity: &identity,
        outcome: &outcome,
        started,
        n_before: n_all - n_left,
    };
    progress.stage("report", 1);
    let start = Instant::now();
    finished.write()?;
    progress.worked(&report, start.elapsed().as_secs_f64());
    progress.advance(1);
    progress.finish(&format!("{:.1} s", seconds_since(started)));
    if args.is_demonstration {
        kept.forget()?;
    }
    finished.tell(args.listener);
    failures(&outcome, folder)
}

/// What a run does when all cells are there; a shard does nothing then.
fn report_work(loaded: &LoadedStudy, shard: Option<Shard>) -> Piece {
    let cells: Vec<_> = loaded.sweep.cells().collect();
    Piece {
        kind: Work::Report,
        place: 0,
        planned_s: match shard {
            Some(_) => 0.0,
            None => results::planned_s(&cells),
        },
    }
}

/// What the results of a study depend on.
pub fn identity(loaded: &LoadedStudy) -> Identity {
    Identity::new(loaded.plan.spec.to_toml(), loaded.touched.content())
}

pub fn seconds_since(started: SystemTime) -> f64 {
    started.elapsed().unwrap_or_default().as_secs_f64()
}

/// A study with all its cells done, and where its files go.
pub struct FinishedStudy<'a> {
    pub args: &'a StudyArgs,
    pub folder: &'a Path,
    pub loaded: &'a LoadedStudy,
    pub identity: &'a Identity,
    pub outcome: &'a Outcome,
    pub started: SystemTime,
    /// Cells that were finished before this run, counted once a trial.
    pub n_before: usize,
}

impl FinishedStudy<'_> {
    /// Writes tables, charts, the page, the study and the manifest.
    pub fn write(&self) -> Result<()> {
        let tables = &self.outcome.tables;
        let manifest = self.manifest()?;
        let spec = &self.loaded.plan.spec;
        let mut page = page_of_spec(spec, &self.loaded.name);
        page.limits = limits(self.loaded, self.outcome);
        add_touches(&mut page, self.loaded)?;
        add_manifest(&mut page, manifest.clone());
        page.wall_s = Some(seconds_since(self.started));
        results::write_all(self.folder, tables, &page)?;
        write_bytes(&self.folder.join("study.toml"), spec.to_toml().as_bytes())?;
        let manifest = manifest.to_json();
        write_bytes(&self.folder.join(MANIFEST_FILE), manifest.as_bytes())
    }

    fn manifest(&self) -> Result<Manifest> {
        let spec = &self.loaded.plan.spec;
        let tables = &self.outcome.tables;
        let facts = RunFacts {
            study: self.loaded.name.clone(),
            command: command_line(self.args),
            started: self.started,
            seed: spec.seed,
            n_cells: self.loaded.sweep.n_cells(),
            n_trials: spec.trials,
            n_finished_before: self.n_before,
            n_failed: tables.failures.len(),
            tables_sha256: repeatable_hashes(tables)?,
        };
        Ok(Manifest::new(self.identity, facts))
    }

    /// Says on standard output what was found.
    pub fn tell(&self, listener: Listener) {
        let tables = &self.outcome.tables;
        listener.finished(serde_json::json!({
            "event": "finished",
            "folder": self.folder,
            "cells": self.loaded.n_evaluations(),
            "finished_before": self.n_before,
            "failed": tables.failures.len(),
            "elapsed_s": seconds_since(self.started),
        }));
        if !listener.is_person() {
            return;
        }
        let table = self.folder.join("summary.csv").display().to_string();
        println!(
            "{}",
            terminal::summary_table(tables, terminal_width(), &table)
        );
        print!("{}", headlines::text(tables, terminal_width()));
        println!(
            "Results in {}; open {}",
            self.folder.display(),
            self.folder.join("report.html").display()
        );
    }
}

/// An error if some cells failed.
pub fn failures(outcome: &Outcome, folder: &Path) -> Result<()> {
    let n_failed = outcome.tables.failures.len();
    match n_failed {
        0 => Ok(()),
        _ => Err(Error::Cells {
            path: folder.join("failures.csv"),
            n_failed,
            n_cells: outcome.tables.accuracy.len() + n_failed,
        }),
    }
}
