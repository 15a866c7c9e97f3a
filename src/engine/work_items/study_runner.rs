//! Runs a study piece by piece.

use crate::engine::journal::journal_file::Journal;
use crate::engine::progress::Progress;
use crate::engine::shard::Shard;
use crate::engine::work_items::NamedPiece;
use crate::engine::work_items::pending::PiecesLeft;
use crate::engine::work_items::record::{PieceResult, PieceRows};
use crate::error::Result;
use crate::row;
use crate::table::Table;
use std::collections::BTreeSet;

/// A study that is ready to run, in pieces.
pub trait PieceStudy {
    /// What a piece finds.
    type Rows: PieceRows;
    /// All pieces, in the order of their rows.
    fn pieces(&self) -> Vec<NamedPiece>;

    /// Does every piece that is left, in any order and on any threads; what several need is made for those that are left only.
    ///
    /// # Errors
    /// Those of [`PiecesLeft::finish`]; what no piece can do without.
    fn measure(&self, left: &PiecesLeft<Self::Rows>) -> Result<()>;

    /// Gives the rows of a piece, by its number, what its place among all pieces decides, such as numbers of cells: rows that the journal has
    /// may be of a study with other axes.
    fn place(&self, _number: usize, _rows: &mut Self::Rows) {}

    /// A piece in words, by its number: for failures.
    fn words(&self, _number: usize, piece: &NamedPiece) -> String {
        piece.name.clone()
    }

    /// The tables of the rows of all pieces, but for those that failed.
    ///
    /// # Errors
    /// A file that tables need cannot be read.
    fn tables(&self, rows: Self::Rows) -> Result<Vec<Table>>;
}

/// Which pieces of a study a run does.
#[derive(Clone, Copy, Debug)]
pub enum Part<'a> {
    /// All.
    All,
    /// One of several equal parts.
    Shard(Shard),
    /// Those of these numbers.
    Only(&'a BTreeSet<usize>),
}

/// How a run goes about its pieces.
#[derive(Clone, Copy)]
pub struct PieceManner<'a> {
    /// Where finished pieces are looked for and kept.
    pub journal: &'a Journal,
    /// Whether the first piece that fails ends the run.
    pub fail_fast: bool,
    /// Whether pieces that failed in an earlier run are tried again.
    pub retries: bool,
    /// Which pieces to do.
    pub part: Part<'a>,
    /// What is told how far the run is.
    pub progress: &'a dyn Progress,
}

row! {
/// A piece that failed: a row of `failures.csv`.
pub struct PieceFailure {
    /// The piece, in words.
    work_item: String => Subject "work item";
    /// What went wrong.
    error: String => Note;
} }

impl<'a> PieceManner<'a> {
    /// All at once; nothing is kept, and the first piece that fails ends the run.
    pub fn whole(progress: &'a dyn Progress) -> Self {
        Self {
            journal: Journal::none(),
            fail_fast: true,
            retries: false,
            part: Part::All,
            progress,
        }
    }
}

/// A run of a study's pieces that has read its journal.
pub struct PiecesRun<'a, S: PieceStudy> {
    study: &'a S,
    pieces: &'a [NamedPiece],
    /// What came of each before.
    before: Vec<Option<PieceResult<S::Rows>>>,
    left: PiecesLeft<'a, S::Rows>,
}

impl<'a, S: PieceStudy> PiecesRun<'a, S> {
    /// Of this study, with all its pieces.
    pub fn new(study: &'a S, pieces: &'a [NamedPiece], manner: &PieceManner<'a>) -> Self {
        let results = pieces.iter().map(|piece| manner.journal.get(&piece.key()));
        let before: Vec<Option<PieceResult<S::Rows>>> = results.collect();
        let is_in = is_in(pieces, manner.part);
        let is_left = before.iter().enumerate().map(|(number, result)| {
            let is_done = matches!(result, Some(Ok(_))) || (result.is_some() && !manner.retries);
            !is_done && is_in(number)
        });
        Self {
            study,
            pieces,
            left: PiecesLeft::new(manner, (pieces, is_left.collect())),
            before,
        }
    }

    /// How many pieces it will do.
    pub fn n_left(&self) -> usize {
        self.left.n()
    }

    /// Does what the journal has not yet: rows of all pieces that did not fail, now or before, in the order of pieces, and those that failed.
    /// The rows but for times are the same as if all were done at once.
    ///
    /// # Errors
    /// The journal cannot be written; what a piece fails of, if the first to fail ends the run; what no piece can do without.
    pub fn run(self) -> Result<(S::Rows, Vec<PieceFailure>)> {
        let Self { study, left, .. } = self;
        left.progress.expect(left.n());
        if left.n() > 0 {
            study.measure(&left)?;
        }
        let (is_left, mut now) = left.into_results();
        let mut rows = S::Rows::default();
        let mut failures = Vec::new();
        for (number, (piece, before)) in self.pieces.iter().zip(self.before).enumerate() {
            let passed_over = || Err("a defect of the program: it was passed over".to_owned());
            let result = match is_left[number] {
                true => Some(now.remove(&number).unwrap_or_else(passed_over)),
                false => before,
            };
            match result {
                Some(Ok(mut found)) => {
                    study.place(number, &mut found);
                    rows.append(found);
                }
                Some(Err(error)) => failures.push(PieceFailure {
                    work_item: study.words(number, piece),
                    error,
                }),
                // It is of another shard.
                None => {}
            }
        }
        Ok((rows, failures))
    }
}

/// Runs a whole study at once, keeps nothing, and ends at the first piece that fails.
///
/// # Errors
/// What a piece fails of.
pub fn run_whole<S: PieceStudy>(study: &S, progress: &dyn Progress) -> Result<S::Rows> {
    let pieces = study.pieces();
    let run = PiecesRun::new(study, &pieces, &PieceManner::whole(progress));
    Ok(run.run()?.0)
}

/// Whether a piece, by its number, belongs to a part.
fn is_in<'a>(pieces: &'a [NamedPiece], part: Part<'a>) -> impl Fn(usize) -> bool + 'a {
    let groups = pieces.iter().map(|piece| piece.group);
    let n_groups = groups.max().map_or(0, |last| last + 1);
    move |number| match part {
        Part::All => true,
        Part::Shard(shard) => shard.takes((pieces[number].group, n_groups), number),
        Part::Only(numbers) => numbers.contains(&number),
    }
}
