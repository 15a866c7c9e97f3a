//! Studies that recognise objects, loaded.

use super::about_study::{add_manifest, add_touches, limits, page_of_spec};
use super::memory_args::{MemoryArgs, Room};
use super::output::packings_beside;
use super::report::write_again;
use super::study_args::{LoadedStudy, StudyArgs};
use super::verify_cells::verify_cells;
use bubbletouch::Result;
use bubbletouch::files::write_bytes;
use bubbletouch::kinds::{AnyOutcome, AnyStudy, EndedRun, ReportAbout};
use bubbletouch::report::csv_tables::table_hashes;
use bubbletouch::report::page::Limit;
use bubbletouch::report::recognition::{tables_of, words};
use bubbletouch::report::results;
use bubbletouch::study::journal::{Identity, Journal};
use bubbletouch::study::memory::{AtOnce, MemoryPlan, machine_memory};
use bubbletouch::study::pieces::PieceManner;
use bubbletouch::study::progress::Progress;
use bubbletouch::study::provenance::{MANIFEST_FILE, Manifest, RECOGNITION_METHODS, RunFacts};
use bubbletouch::study::time_left::{Piece, Work};
use bubbletouch::study::{
    Estimate, FrameStorage, Manner, Outcome, Part, StudyKind, n_left, run_with, workload,
};
use std::path::Path;
use std::time::Instant;

pub struct RecognitionStudy {
    loaded: LoadedStudy,
    identity: Identity,
    room: Room,
}

impl RecognitionStudy {
    pub fn load(args: &StudyArgs, folder: &Path, memory: Option<&MemoryArgs>) -> Result<Self> {
        let ceiling = memory.map_or_else(|| Ok(machine_memory()), MemoryArgs::bytes)?;
        let loaded = args.load_within(Some(&packings_beside(folder)), ceiling)?;
        let room = match memory {
            Some(memory) => memory.room(&loaded, folder)?,
            // It does not run here.
            None => Room {
                storage: FrameStorage::in_memory(),
                memory: MemoryPlan {
                    at_once: AtOnce::ALL,
                    frames: u64::MAX,
                    most_bytes: f64::INFINITY,
                },
            },
        };
        Ok(Self {
            identity: Identity::new(
                loaded.plan.spec.to_toml(),
                loaded.touched.content(),
                StudyKind::Recognition.may_change(),
            ),
            loaded,
            room,
        })
    }

    /// What is done when all cells are there; a shard does nothing then.
    fn report_work(&self, part: Part) -> Piece {
        Piece::report(match part {
            Part::Shard(_) => 0.0,
            _ => results::planned_s(self.loaded.touched.samples_s()),
        })
    }
}

impl AnyStudy for RecognitionStudy {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn units(&self) -> &'static str {
        "cells"
    }

    fn n_all(&self) -> usize {
        self.loaded.n_evaluations()
    }

    fn plan(&self) -> Result<String> {
        let LoadedStudy {
            plan,
            touched,
            sweep,
            ..
        } = &self.loaded;
        let estimate = Estimate::new(plan, touched.as_ref(), sweep, &self.room.memory);
        Ok(format!("{}\n{estimate}", plan.spec.question))
    }

    fn n_left(&self, part: Part, journal: &Journal) -> usize {
        n_left(&self.loaded.plan, &self.loaded.sweep, part, journal)
    }

    fn run<'a>(&'a self, manner: &PieceManner<'a>) -> Result<Box<dyn AnyOutcome + 'a>> {
        let LoadedStudy {
            plan,
            touched,
            sweep,
            ..
        } = &self.loaded;
        let progress = manner.progress;
        let manner = Manner {
            journal: manner.journal,
            fail_fast: manner.fail_fast,
            retries: manner.retries,
            part: manner.part,
            storage: &self.room.storage,
            at_once: self.room.memory.at_once,
        };
        let report = self.report_work(manner.part);
        let work = workload(plan, sweep, touched.as_ref(), manner);
        // Before the clock starts, so that the time left speaks of work that is planned.
        if work.iter().any(|piece| piece.kind == Work::Touch) {
            touched.prepare();
        }
        progress.expect(&[&work[..], &[report]].concat());
        Ok(Box::new(RecognitionOutcome {
            study: self,
            outcome: run_with(plan, sweep, touched.as_ref(), progress, manner)?,
            report,
        }))
    }

    fn verify(
        &self,
        folder: &Path,
        n: usize,
        draw: u64,
        progress: &dyn Progress,
    ) -> Result<String> {
        verify_cells(&self.loaded, &self.room, (folder, progress), (n, draw))
    }

    fn report(&self, folder: &Path, about: &ReportAbout) -> Result<()> {
        write_again(&self.loaded, folder, about)
    }
}

struct RecognitionOutcome<'a> {
    study: &'a RecognitionStudy,
    outcome: Outcome,
    report: Piece,
}

impl RecognitionOutcome<'_> {
    fn manifest(&self, ended: &EndedRun, limits: &[Limit]) -> Result<Manifest> {
        let loaded = &self.study.loaded;
        let hashes = table_hashes(&self.outcome.tables, limits)?;
        let facts = RunFacts {
            study: ended.name.clone(),
            command: ended.command.clone(),
            paths_from: ended.paths_from.clone(),
            started: ended.started,
            seed: loaded.plan.spec.seed,
            n_cells: loaded.sweep.n_cells(),
            n_trials: loaded.plan.spec.trials,
            n_finished_before: ended.n_before,
            n_failed: self.n_failed(),
            tables_sha256: hashes.repeatable,
            times_sha256: hashes.times,
            methods: RECOGNITION_METHODS.into(),
        };
        Ok(Manifest::new(&self.study.identity, facts))
    }
}

impl AnyOutcome for RecognitionOutcome<'_> {
    fn n_failed(&self) -> usize {
        self.outcome.tables.failures.len()
    }

    fn write(&self, ended: &EndedRun) -> Result<()> {
        let start = Instant::now();
        let (loaded, folder) = (&self.study.loaded, ended.folder);
        let spec = &loaded.plan.spec;
        let mut page = page_of_spec(spec, &loaded.name);
        page.limits = limits(loaded, &self.outcome);
        let manifest = self.manifest(ended, &page.limits)?;
        add_touches(&mut page, loaded)?;
        add_manifest(&mut page, manifest.clone());
        page.wall_s = Some(ended.wall_s());
        let told = (ended.progress, &self.report);
        results::write_all_telling(folder, &self.outcome.tables, &page, told)?;
        write_bytes(&folder.join("study.toml"), spec.to_toml().as_bytes())?;
        write_bytes(&folder.join(MANIFEST_FILE), manifest.to_json().as_bytes())?;
        let took_s = start.elapsed().as_secs_f64();
        ended.progress.worked(&self.report, took_s);
        Ok(())
    }

    fn words(&self, width: usize) -> String {
        match tables_of(&self.outcome.tables, &[]) {
            Ok(tables) => words(&tables, width),
            Err(error) => error.to_string(),
        }
    }
}
