//! Studies that are made of pieces: what a kind has to say of itself, and all that follows from it.

use super::output::packings_beside;
use super::piece_rows::{compare, draw};
use super::study_args::StudyArgs;
use bubbletouch::files::write_bytes;
use bubbletouch::kinds::{
    About, AnyOutcome, AnyStudy, EndedRun, ReportAbout, threads_within, within_memory,
};
use bubbletouch::report::csv_tables::{FAILURES_FILE, csv_content};
use bubbletouch::report::folder::Folder;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::study_tables::StudyTables;
use bubbletouch::study::journal::{Identity, Journal};
use bubbletouch::study::pieces::{
    FinishedPieces, NamedPiece, Part, PieceEstimate, PieceFailure, PieceManner, PieceStudy,
    PiecesRun, Scale, n_pieces_left, run_pieces,
};
use bubbletouch::study::progress::{Progress, Silent};
use bubbletouch::study::provenance::{MANIFEST_FILE, Manifest, PROGRAM, RunFacts};
use bubbletouch::{Error, Result};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A kind of study that is made of pieces.
pub trait PieceKind: Sized {
    /// What runs.
    type Study: PieceStudy<Tables: StudyTables> + Sync;

    /// Which it is.
    const KIND: About;

    /// How intervals and p-values are made, by table and columns.
    const METHODS: &'static [(&'static str, &'static str)] = &[];

    /// Reads and checks a study, and loads its objects; packings are kept in a folder.
    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self>;
    /// What runs.
    fn study(&self) -> &Self::Study;
    /// How large it is.
    fn scale(&self) -> Scale;
    /// What its file says, and what that is about.
    fn facts(&self) -> Result<KindFacts>;
    /// Tables, charts and page, for a folder.
    fn folder<'a>(
        &self,
        tables: &Tables<Self>,
        folder: &'a Path,
        about: &StudyAbout,
    ) -> Result<Folder<'a>>;
    /// What a person reads at the end, in lines of about `width` letters.
    fn words(&self, tables: &Tables<Self>, width: usize) -> String;

    /// Charts and page of a folder again, from its tables.
    fn report(&self, folder: &Path, _about: &ReportAbout) -> Result<()> {
        let allowed = "a study that recognises objects (of any other, bubbletouch run draws again what is finished)";
        Err(Error::input(folder.display(), Self::KIND.words, allowed))
    }
}

/// What a study's file says, and what that is about.
pub struct KindFacts {
    /// The study with every default spelt out, as TOML.
    pub toml: String,
    /// What it asks, and what was expected.
    pub asked: [String; 2],
    /// Root of all randomness.
    pub seed: u64,
    /// SHA-256 of what the study's text does not say: objects and other files, by name.
    pub content: BTreeMap<String, String>,
}

/// The tables of a kind.
pub type Tables<K> = <<K as PieceKind>::Study as PieceStudy>::Tables;

/// The rows of a kind.
type Rows<K> = <<K as PieceKind>::Study as PieceStudy>::Rows;

/// A loaded study.
pub struct PieceRun<K> {
    kind: K,
    facts: KindFacts,
    identity: Identity,
    memory: Option<u64>,
    pieces: Vec<NamedPiece>,
}

impl<K: PieceKind> PieceRun<K> {
    pub fn load(args: &StudyArgs, folder: &Path) -> Result<Self> {
        let kind = K::load(args, packings_beside(folder))?;
        threads_within(&kind.scale(), args.memory)?;
        let facts = kind.facts()?;
        Ok(Self {
            identity: Identity::new(
                facts.toml.clone(),
                facts.content.clone(),
                K::KIND.may_change,
            ),
            memory: args.memory,
            pieces: kind.study().pieces(),
            facts,
            kind,
        })
    }
}

impl<K: PieceKind> AnyStudy for PieceRun<K> {
    fn identity(&self) -> &Identity {
        &self.identity
    }

    fn units(&self) -> &'static str {
        "pieces"
    }

    fn n_all(&self) -> usize {
        self.pieces.len()
    }

    fn plan(&self) -> Result<String> {
        let study = self.kind.study();
        let manner = PieceManner {
            journal: &Journal::none(),
            fail_fast: true,
            retries: false,
            part: Part::All,
            progress: &Silent,
        };
        let work = PiecesRun::new(study, &self.pieces, &manner).workload();
        let estimate = PieceEstimate {
            scale: self.kind.scale(),
            n_pieces: self.pieces.len(),
            n_threads: threads_within(&self.kind.scale(), self.memory)?,
            work,
        };
        Ok(format!("{}\n{estimate}", self.facts.asked[0]))
    }

    fn n_left(&self, part: Part, journal: &Journal) -> usize {
        n_pieces_left::<Rows<K>>(&self.pieces, part, journal)
    }

    fn run<'a>(&'a self, manner: &PieceManner<'a>) -> Result<Box<dyn AnyOutcome + 'a>> {
        let study = self.kind.study();
        let pieces = PiecesRun::new(study, &self.pieces, manner);
        manner.progress.expect(&pieces.workload());
        let FinishedPieces { rows, failures, .. } =
            within_memory(&self.kind.scale(), self.memory, || pieces.run())?;
        Ok(Box::new(PieceOutcome {
            run: self,
            tables: study.tables(rows)?,
            failures,
        }))
    }

    fn verify(
        &self,
        folder: &Path,
        n: usize,
        seed: u64,
        progress: &dyn Progress,
    ) -> Result<String> {
        let chosen = draw(&self.pieces, folder, (n, seed))?;
        let manner = PieceManner {
            journal: &Journal::none(),
            fail_fast: true,
            retries: false,
            part: Part::Only(&chosen),
            progress,
        };
        let study = self.kind.study();
        let again = study.tables(run_pieces(study, &manner)?.rows)?;
        progress.finish("");
        // What other programs left stands in some tables, and no piece made it.
        let of_others = study.tables(Rows::<K>::default())?;
        let n_rows = compare(folder, &again, &of_others)?;
        Ok(format!(
            "{} of {} pieces ran again, and their {n_rows} rows without times are the same bytes",
            chosen.len(),
            self.pieces.len(),
        ))
    }

    fn report(&self, folder: &Path, about: &ReportAbout) -> Result<()> {
        self.kind.report(folder, about)
    }
}

/// What came of all pieces.
struct PieceOutcome<'a, K: PieceKind> {
    run: &'a PieceRun<K>,
    tables: Tables<K>,
    failures: Vec<PieceFailure>,
}

impl<K: PieceKind> AnyOutcome for PieceOutcome<'_, K> {
    fn n_failed(&self) -> usize {
        self.failures.len()
    }

    fn write(&self, ended: &EndedRun) -> Result<()> {
        let (kind, folder) = (&self.run.kind, ended.folder);
        let KindFacts {
            toml, asked, seed, ..
        } = &self.run.facts;
        let [question, expected] = asked.clone();
        let hashes = self.tables.hashes()?;
        let facts = RunFacts {
            study: ended.name.clone(),
            command: ended.command.clone(),
            paths_from: ended.paths_from.clone(),
            started: ended.started,
            seed: *seed,
            n_cells: self.run.pieces.len(),
            n_trials: 1,
            n_finished_before: ended.n_before,
            n_failed: self.failures.len(),
            tables_sha256: hashes.repeatable,
            times_sha256: hashes.times,
            methods: K::METHODS.into(),
        };
        let manifest = Manifest::new(&self.run.identity, facts);
        let about = StudyAbout {
            name: ended.name.clone(),
            question,
            expected,
            wall_s: ended.wall_s(),
            command: ended.command.clone(),
            program: PROGRAM.to_owned(),
            manifest: Some(manifest.clone()),
            all_charts: false,
        };
        let made = kind.folder(&self.tables, folder, &about)?;
        made.write()?;
        let failures = folder.join(FAILURES_FILE);
        write_bytes(&failures, &csv_content(&failures, &self.failures)?)?;
        write_bytes(&folder.join("study.toml"), toml.as_bytes())?;
        write_bytes(&folder.join(MANIFEST_FILE), manifest.to_json().as_bytes())
    }

    fn words(&self, width: usize) -> String {
        let found = self.run.kind.words(&self.tables, width);
        format!("{}\n\n{found}\n", self.run.facts.asked[0])
    }
}
