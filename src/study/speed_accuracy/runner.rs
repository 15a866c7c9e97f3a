//! Runs a study of speed against accuracy, part by part.

use super::contact::ContactPart;
use super::peers::read_peers;
use super::plan::SpeedAccuracyPlan;
use super::recognition_part::RecognitionPart;
use super::resolution::ResolutionPart;
use super::subject::{Subject, load_scans, load_subjects, scans_content};
use super::table::SpeedAccuracyTables;
use crate::error::Result;
use crate::study::objects_content;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::time_left::Piece;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A study of speed against accuracy and its objects.
pub struct SpeedAccuracyStudy {
    /// What to run.
    pub plan: SpeedAccuracyPlan,
    subjects: Vec<Subject>,
    /// Touched in the part on contact only.
    scans: Vec<Subject>,
    packings: Option<PathBuf>,
}

impl SpeedAccuracyStudy {
    /// Loads the objects; packings of meshes are looked for and kept in the folder `packings`, if one is given.
    ///
    /// # Errors
    /// Objects that are not there.
    pub fn new(plan: SpeedAccuracyPlan, packings: Option<PathBuf>) -> Result<Self> {
        let subjects = load_subjects(&plan.spec.objects)?;
        let scans = load_scans(plan.scans(), &plan.spec.objects)?;
        Ok(Self {
            plan,
            subjects,
            scans,
            packings,
        })
    }

    /// SHA-256 of what each object and scan is made from, by its name.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn content(&self) -> Result<BTreeMap<String, String>> {
        let objects = &self.plan.spec.objects;
        let mut content = objects_content(objects)?;
        content.extend(scans_content(self.plan.scans(), objects)?);
        Ok(content)
    }

    /// The study's objects; those that are only touched in the part on contact are not counted.
    pub fn n_objects(&self) -> usize {
        self.subjects.len()
    }

    fn objects(&self) -> (&[Subject], Option<&Path>) {
        (&self.subjects, self.packings.as_deref())
    }

    fn contact(&self) -> Option<ContactPart<'_>> {
        let contact = self.plan.contact.as_ref()?;
        let objects = (self.subjects.as_slice(), self.scans.as_slice());
        let packings = self.packings.as_deref();
        Some(ContactPart::new(&self.plan, contact, objects, packings))
    }

    fn recognition(&self) -> Option<RecognitionPart<'_>> {
        let sweep = self.plan.recognition.as_ref()?;
        Some(RecognitionPart::new(&self.plan, sweep, self.objects()))
    }

    fn resolution(&self) -> Option<ResolutionPart<'_>> {
        let resolution = self.plan.resolution.as_ref()?;
        Some(ResolutionPart::new(&self.plan, resolution, self.objects()))
    }
}

impl PieceStudy for SpeedAccuracyStudy {
    type Rows = SpeedAccuracyTables;
    type Tables = SpeedAccuracyTables;

    fn pieces(&self) -> Vec<NamedPiece> {
        let parts = [
            self.contact().map(|part| part.pieces()),
            self.recognition().map(|part| part.pieces()),
            self.resolution().map(|part| part.pieces()),
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

    fn measure(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Result<()> {
        self.contact().map_or(Ok(()), |part| part.measure(left))?;
        self.recognition()
            .map_or(Ok(()), |part| part.measure(left))?;
        self.resolution().map_or(Ok(()), |part| part.measure(left))
    }

    fn shared_work(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Vec<Piece> {
        let parts = [
            self.contact().map(|part| part.shared_work(left)),
            self.recognition().map(|part| part.shared_work(left)),
        ];
        parts.into_iter().flatten().flatten().collect()
    }

    fn tables(&self, mut tables: SpeedAccuracyTables) -> Result<SpeedAccuracyTables> {
        let contact = self.plan.contact.as_ref();
        if let Some(path) = contact.and_then(|contact| contact.peers.as_ref()) {
            tables.peers = read_peers(path)?;
        }
        Ok(tables)
    }
}

impl PieceRows for SpeedAccuracyTables {
    fn append(&mut self, next: Self) {
        self.contact.extend(next.contact);
        self.contact_timing.extend(next.contact_timing);
        self.recognition.extend(next.recognition);
        self.recognition_timing.extend(next.recognition_timing);
        self.resolution.extend(next.resolution);
        self.resolution_timing.extend(next.resolution_timing);
    }
}
