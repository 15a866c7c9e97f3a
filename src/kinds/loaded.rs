//! A study of a kind, for those who do not know which.

use super::any_study::{AnyOutcome, AnyStudy, ReportAbout};
use super::kind::{Facts, Kind};
use super::results::{Results, failures_table};
use super::source::Source;
use super::verified::{changed_row, drawn};
use crate::error::{Error, Result};
use crate::report::page::StudyAbout;
use crate::study::Part;
use crate::study::journal::{Identity, Journal};
use crate::study::memory::{GIB, machine_memory};
use crate::study::pieces::{
    FinishedPieces, PieceEstimate, PieceManner, PiecesRun, n_pieces_left, run_pieces,
};
use crate::study::progress::{Progress, Silent};
use crate::study::provenance::PROGRAM;
use std::path::Path;

/// A study that is read and checked, and what its results depend on.
pub struct Loaded<K> {
    pub(super) kind: K,
    pub(super) facts: Facts,
    pub(super) identity: Identity,
    pub(super) n_pieces: usize,
    /// Most bytes to hold.
    memory: Option<u64>,
}

impl<K: Kind> Loaded<K> {
    /// Reads and checks a study.
    ///
    /// # Errors
    /// Those of [`Kind::load`].
    pub fn load(source: &Source) -> Result<Self> {
        let kind = K::load(source)?;
        let facts = kind.facts()?;
        let (toml, content) = (facts.toml.clone(), facts.content.clone());
        Ok(Self {
            identity: Identity::new(toml, content, K::ABOUT.may_change),
            n_pieces: kind.pieces().len(),
            memory: source.memory.or_else(machine_memory),
            facts,
            kind,
        })
    }

    /// Threads on which its work items stay within the memory that it may take.
    fn n_threads(&self) -> Result<usize> {
        let scale = self.kind.scale();
        let Some(ceiling) = self.memory else {
            return Ok(rayon::current_num_threads());
        };
        scale.n_at_once(ceiling as f64).ok_or_else(|| {
            Error::input(
                "memory",
                format!("a ceiling of {:.2} GiB", ceiling as f64 / GIB),
                format!(
                    "at least {:.2} GiB for this study",
                    scale.least_bytes() / GIB
                ),
            )
        })
    }

    /// Does something on as many threads as there is memory for.
    fn within_memory<T: Send>(&self, work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
        let n_threads = self.n_threads()?;
        if n_threads == rayon::current_num_threads() {
            return work();
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let pool = pool.build().map_err(|error| {
            Error::input("threads", error, "a number that the system can start")
        })?;
        pool.install(work)
    }
}

impl<K: Kind> AnyStudy for Loaded<K> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn units(&self) -> &'static str {
        "pieces"
    }

    fn n_all(&self) -> usize {
        self.n_pieces
    }

    fn plan(&self) -> Result<String> {
        let n_threads = self.n_threads()?;
        let manner = PieceManner {
            journal: &Journal::none(),
            fail_fast: true,
            retries: false,
            part: Part::All,
            progress: &Silent,
        };
        let estimate = PieceEstimate {
            scale: self.kind.scale(),
            n_pieces: self.n_pieces,
            n_threads,
            work: PiecesRun::new(&self.kind, &manner).workload(),
        };
        Ok(format!("{}\n{estimate}", self.facts.question))
    }

    fn n_left(&self, part: Part, journal: &Journal) -> usize {
        n_pieces_left(&self.kind, part, journal)
    }

    fn run<'a>(&'a self, manner: &PieceManner<'a>) -> Result<Box<dyn AnyOutcome + 'a>> {
        let (finished, mut tables) = self.within_memory(|| {
            let pieces = PiecesRun::new(&self.kind, manner);
            manner.progress.expect(&pieces.workload());
            let FinishedPieces { rows, failures, .. } = pieces.run()?;
            Ok((failures, self.kind.tables(rows)?))
        })?;
        tables.push(failures_table(&finished)?);
        Ok(Box::new(Results {
            study: self,
            tables,
            n_failed: finished.len(),
        }))
    }

    fn verify(
        &self,
        folder: &Path,
        n: usize,
        draw: u64,
        progress: &dyn Progress,
    ) -> Result<String> {
        let chosen = drawn(&self.kind.pieces(), folder, (n, draw))?;
        let manner = PieceManner {
            journal: &Journal::none(),
            fail_fast: true,
            retries: false,
            part: Part::Holding(&chosen),
            progress,
        };
        let again =
            self.within_memory(|| self.kind.tables(run_pieces(&self.kind, &manner)?.rows))?;
        progress.finish("");
        // What other programs left stands in some tables, and no item made it.
        let of_others = self.kind.tables(K::Rows::default())?;
        let n_rows = changed_row(folder, &again, &of_others)?;
        Ok(format!(
            "{} of {} pieces ran again, and their {n_rows} rows without times are the same bytes",
            chosen.len(),
            self.n_pieces,
        ))
    }

    fn report(&self, folder: &Path, about: &ReportAbout) -> Result<()> {
        let tables = self.kind.read_tables(folder)?;
        let wall_s = about
            .manifest
            .as_ref()
            .and_then(|manifest| manifest.wall_s());
        let about = StudyAbout {
            name: about.name.clone(),
            question: self.facts.question.clone(),
            expected: self.facts.expected.clone(),
            wall_s: wall_s.unwrap_or(f64::NAN),
            command: about.command.clone(),
            program: PROGRAM.to_owned(),
            manifest: about.manifest.clone(),
            all_charts: about.all_charts,
        };
        self.folder_of(folder, &about, &tables)?.write().map(|_| ())
    }
}
