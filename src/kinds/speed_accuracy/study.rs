//! A study of speed against accuracy, part by part.

use super::contact_points::contact_points;
use super::models::ContactRow;
use super::plan::SpeedAccuracyPlan;
use super::rows::{
    ChainCell, ChainScore, ChainTime, ContactCell, ContactPoint, ContactScore, ContactTime,
};
use super::spec::SpeedAccuracyStudySpec;
use super::subject::{Subject, load_subjects};
use crate::error::Result;
use crate::kinds::model_recognition::check_apart;
use crate::kinds::{About, Facts, Files, Kind, Source, found_and_cost};
use crate::report::csv_tables::read_rows;
use crate::study::objects_content;
use crate::study::pieces::{NamedPiece, PieceStudy, PiecesLeft, Scale};
use crate::study::taxel_array::TaxelArray;
use crate::table::{File, Table};
use std::path::PathBuf;

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

/// What work items of the study found in contact and in recognition: a setting, how near or how often right it is, and what it costs.
pub type SpeedAccuracyRows = (Vec<ContactRow>, Vec<ChainRow>);

/// Tables of contact: what is found, what it costs, and both together.
const CONTACT: File<(ContactCell, ContactScore)> =
    File::new("contact.csv", "Contact: error of every object", "");
const CONTACT_TIMES: File<(ContactCell, ContactTime)> =
    File::new("contact_timing.csv", "Contact: time of every object", "").of_times();
pub(super) const CONTACT_PARETO: File<ContactPoint> =
    File::new("contact_pareto.csv", "Contact: error against time", "")
        .of_times()
        .summary();
/// Tables of recognition, in the same order.
const RECOGNITION: File<(ChainCell, ChainScore)> = File::new(
    "recognition.csv",
    "Recognition: accuracy of every chain",
    "",
);
const RECOGNITION_TIMES: File<(ChainCell, ChainTime)> = File::new(
    "recognition_timing.csv",
    "Recognition: time of every chain",
    "",
)
.of_times();
pub(super) const RECOGNITION_PARETO: File<ChainRow> =
    File::new("pareto.csv", "Recognition: accuracy against time", "")
        .of_times()
        .summary();

impl PieceStudy for SpeedAccuracyStudy {
    type Rows = SpeedAccuracyRows;

    fn pieces(&self) -> Vec<NamedPiece> {
        let mut pieces = self.contact_pieces();
        let groups = pieces.iter().map(|piece| piece.group);
        let n_groups = groups.max().map_or(0, |last| last + 1);
        pieces.extend(self.chain_pieces(n_groups));
        pieces
    }

    fn measure(&self, left: &PiecesLeft<SpeedAccuracyRows>) -> Result<()> {
        self.measure_contact(left)?;
        self.measure_chains(left)
    }

    fn tables(&self, (contact, chains): SpeedAccuracyRows) -> Result<Vec<Table>> {
        let mut tables = Vec::new();
        let parts = self.plan.parts();
        if parts.contact.is_some() {
            // What other programs take for the same press, as they left it in a file.
            let peers = match self.plan.peers.as_ref().filter(|path| path.exists()) {
                Some(path) => read_rows(path)?,
                None => Vec::new(),
            };
            tables.extend(found_and_cost(&CONTACT, &CONTACT_TIMES, &contact)?);
            tables.push(CONTACT_PARETO.of(&contact_points(&contact, &peers))?);
        }
        if parts.recognition.is_some() {
            tables.extend(found_and_cost(&RECOGNITION, &RECOGNITION_TIMES, &chains)?);
            tables.push(RECOGNITION_PARETO.of(&chains)?);
        }
        Ok(tables)
    }
}

impl Kind for SpeedAccuracyStudy {
    const ABOUT: About = About {
        table: "speed_accuracy",
        words: "a study of what accuracy costs",
        may_change: &[
            "question",
            "expected",
            "speed_accuracy.contact.dt_ms",
            "speed_accuracy.recognition.pitch_mm",
            "speed_accuracy.recognition.tolerances_mm",
            "speed_accuracy.recognition.ensemble",
            "speed_accuracy.recognition.ratio",
            "speed_accuracy.recognition.classifier",
        ],
    };
    const FILES_OF_PARTS: Files = &[
        &CONTACT,
        &CONTACT_TIMES,
        &CONTACT_PARETO,
        &RECOGNITION,
        &RECOGNITION_TIMES,
        &RECOGNITION_PARETO,
    ];

    fn load(source: &Source) -> Result<Self> {
        let mut spec = SpeedAccuracyStudySpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed);
        let contact = spec.speed_accuracy.contact.as_mut();
        let scans = contact.and_then(|contact| contact.scans.as_mut());
        match (&source.objects, scans) {
            (Some(folder), Some(scans)) => scans.meshes = folder.clone().into(),
            _ => source.replace_objects(&mut spec.objects),
        }
        let plan = SpeedAccuracyPlan::new(&source.place, &source.folder, spec)?;
        let subjects = load_subjects(&plan.spec.objects)?;
        if plan.parts().recognition.is_some() {
            check_apart(&source.place, subjects.len())?;
        }
        let scans = plan.scanned();
        Ok(Self {
            subjects,
            scans: scans.map_or(Ok(Vec::new()), |scans| load_subjects(&scans))?,
            packings: source.packings.clone(),
            plan,
        })
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.plan.spec;
        let mut content = objects_content(&spec.objects)?;
        if let Some(scans) = self.plan.scanned() {
            let scans = objects_content(&scans)?.into_iter();
            content.extend(scans.map(|(name, hash)| (format!("scan {name}"), hash)));
        }
        Ok(Facts::of(spec, content))
    }

    fn scale(&self) -> Scale {
        let parts = self.plan.parts();
        let mut touches = Vec::new();
        let mut bytes = 0.0;
        if let Some(contact) = &parts.contact {
            touches.push(format!("{} of each object in contact", contact.touches));
        }
        if let Some(sweep) = &parts.recognition {
            let per_object = sweep.n_touches();
            touches.push(format!("{per_object} of each in recognition"));
            let n_taxels = self.plan.arrays.iter().map(TaxelArray::n_taxels);
            bytes = 8.0 * (sweep.objects * per_object * n_taxels.max().unwrap_or(0)) as f64;
        }
        Scale {
            objects: self.subjects.len().to_string(),
            touches: touches.join(", "),
            n_configurations: self.pieces().len(),
            bytes,
            ..Scale::default()
        }
    }
}
