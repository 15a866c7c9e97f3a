//! Runs a study of speed against accuracy, part by part.

use super::contact::ContactPart;
use super::contact_points::contact_points;
use super::models::ContactRow;
use super::plan::SpeedAccuracyPlan;
use super::recognition::RecognitionPart;
use super::rows::{
    ChainCell, ChainScore, ChainTime, ContactCell, ContactPoint, ContactScore, ContactTime,
    PeerRow, Touched,
};
use super::subject::{Subject, spread_evenly};
use crate::error::Result;
use crate::report::csv_tables::read_rows;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::table::{Columns, File, Table};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A study of speed against accuracy and its objects.
pub struct SpeedAccuracyStudy {
    /// What to run.
    pub plan: SpeedAccuracyPlan,
    pub(super) subjects: Vec<Subject>,
    /// Touched in the part on contact only.
    pub(super) scans: Vec<Subject>,
    pub(super) packings: Option<PathBuf>,
}

/// A chain: what it is, what it gives, and what it costs.
pub(super) type ChainRow = (ChainCell, ChainScore, ChainTime);

/// What work items of the study found: a setting, how near or how often right it is, and what it costs.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct SpeedAccuracyRows {
    pub(super) contact: Vec<ContactRow>,
    pub(super) chains: Vec<ChainRow>,
}

impl PieceRows for SpeedAccuracyRows {
    fn append(&mut self, next: Self) {
        self.contact.extend(next.contact);
        self.chains.extend(next.chains);
    }
}

/// Tables of a part: what is found, what it costs, and both together.
pub(super) struct Part<C, S, T, P> {
    scores: File<(C, S)>,
    times: File<(C, T)>,
    pub pareto: File<P>,
}

pub(super) const CONTACT: Part<ContactCell, ContactScore, ContactTime, ContactPoint> = Part {
    scores: File::new("contact.csv", "Contact: error of every object", ""),
    times: File::new("contact_timing.csv", "Contact: time of every object", "").of_times(),
    pareto: File::new("contact_pareto.csv", "Contact: error against time", "")
        .of_times()
        .summary(),
};
pub(super) const CHAINS: Part<ChainCell, ChainScore, ChainTime, ChainRow> = Part {
    scores: File::new(
        "recognition.csv",
        "Recognition: accuracy of every chain",
        "",
    ),
    times: File::new(
        "recognition_timing.csv",
        "Recognition: time of every chain",
        "",
    )
    .of_times(),
    pareto: File::new("pareto.csv", "Recognition: accuracy against time", "")
        .of_times()
        .summary(),
};
impl SpeedAccuracyStudy {
    fn contact(&self) -> Option<ContactPart<'_>> {
        let spec = self.plan.parts().contact.as_ref()?;
        let objects = spread_evenly(&self.subjects, spec.objects).into_iter();
        let objects = objects.map(|subject| (Touched::Object, subject));
        let scans = self.scans.iter().map(|scan| (Touched::Scan, scan));
        Some(ContactPart {
            plan: &self.plan,
            spec,
            chosen: objects.chain(scans).collect(),
            packings: self.packings.as_deref(),
        })
    }

    fn recognition(&self) -> Option<RecognitionPart<'_>> {
        let sweep = self.plan.recognition.as_ref()?;
        let objects = (self.subjects.as_slice(), self.packings.as_deref());
        Some(RecognitionPart::new(&self.plan, sweep, objects))
    }
}

impl PieceStudy for SpeedAccuracyStudy {
    type Rows = SpeedAccuracyRows;
    type Tables = Vec<Table>;

    fn pieces(&self) -> Vec<NamedPiece> {
        let parts = [
            self.contact().map(|part| part.pieces()),
            self.recognition().map(|part| part.pieces()),
        ];
        let mut pieces: Vec<NamedPiece> = Vec::new();
        for mut part in parts.into_iter().flatten() {
            let groups = pieces.iter().map(|piece| piece.group);
            let first = groups.max().map_or(0, |last| last + 1);
            part.iter_mut().for_each(|piece| piece.group += first);
            pieces.extend(part);
        }
        pieces
    }

    fn measure(&self, left: &PiecesLeft<SpeedAccuracyRows>) -> Result<()> {
        self.contact().map_or(Ok(()), |part| part.measure(left))?;
        self.recognition().map_or(Ok(()), |part| part.measure(left))
    }

    fn tables(&self, rows: SpeedAccuracyRows) -> Result<Vec<Table>> {
        let mut tables = Vec::new();
        let parts = self.plan.parts();
        if parts.contact.is_some() {
            let peers = read_peers(self.plan.peers.as_deref())?;
            tables.extend(CONTACT.of(&rows.contact, &contact_points(&rows.contact, &peers))?);
        }
        if parts.recognition.is_some() {
            tables.extend(CHAINS.of(&rows.chains, &rows.chains)?);
        }
        Ok(tables)
    }
}

impl<C: Columns, S: Columns, T: Columns, P: Columns> Part<C, S, T, P> {
    fn of(&self, rows: &[(C, S, T)], points: &[P]) -> Result<[Table; 3]>
    where
        C: Serialize + Clone,
        S: Serialize + Clone,
        T: Serialize + Clone,
        P: Serialize,
    {
        let scores = rows.iter().map(|(c, s, _)| (c.clone(), s.clone()));
        let times = rows.iter().map(|(c, _, t)| (c.clone(), t.clone()));
        Ok([
            self.scores.of(&scores.collect::<Vec<_>>())?,
            self.times.of(&times.collect::<Vec<_>>())?,
            self.pareto.of(points)?,
        ])
    }

    /// Of a folder; none of a study without this part.
    pub fn read(&self, folder: &Path) -> Result<Vec<Table>> {
        let Some(pareto) = self.pareto.read_if_there(folder)? else {
            return Ok(Vec::new());
        };
        let found = [self.scores.read(folder)?, self.times.read(folder)?];
        Ok(found.into_iter().chain([pareto]).collect())
    }
}

/// What other programs take for the same press, as they left it in a file; none where there is no file.
fn read_peers(path: Option<&Path>) -> Result<Vec<PeerRow>> {
    match path.filter(|path| path.exists()) {
        Some(path) => read_rows(path),
        None => Ok(Vec::new()),
    }
}
