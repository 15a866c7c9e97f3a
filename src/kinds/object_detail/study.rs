//! Runs a study of object detail: models of every mesh, their errors on all threads, then their times on one.

use super::deflection::Truth;
use super::plan::ObjectDetailPlan;
use super::recognition::{Felt, Sensor};
use super::rows::{
    DetailCell, DetailRecognition, DetailScore, DetailSummary, DetailTime, LevelTime,
};
use super::score::{cell, score, truth};
use super::spec::DetailMethod;
use super::summary::{costs, summary};
use super::variants::{Variant, levels, variants};
use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::recognition::ClassifierKind;
use crate::study::object_files::NamedMesh;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::time_left::Piece;
use crate::table::{File, Table};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A study of object detail and its meshes.
pub struct ObjectDetailStudy {
    /// What to run.
    pub plan: ObjectDetailPlan,
    /// Each is an object.
    pub meshes: Vec<NamedMesh>,
    /// Where packings are looked for and kept, if anywhere.
    pub packings: Option<PathBuf>,
}

/// What work items of the study found.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct DetailRows {
    detail: Vec<(DetailCell, DetailScore)>,
    timing: Vec<(DetailCell, DetailTime)>,
    recognition: Vec<DetailRecognition>,
}

impl PieceRows for DetailRows {
    fn append(&mut self, next: Self) {
        self.detail.extend(next.detail);
        self.timing.extend(next.timing);
        self.recognition.extend(next.recognition);
    }
}

/// Seconds for an object's models, a metre of the side of a square as large as its surface (the median of 37 scans of the YCB set); to time
/// them; for a classifier.
const MODELS_S_PER_M: f64 = 170.0;
const TIME_S: f64 = 0.3;
const RECOGNISE_S: f64 = 0.5;

/// Tables.
pub(super) const DETAIL: File<(DetailCell, DetailScore)> =
    File::new("object_detail.csv", "Models of each object", "");
pub(super) const SUMMARY: File<DetailSummary> = File::new(
    "object_detail_summary.csv",
    "Models over all objects",
    "Medians and quartiles over objects; deflection errors are means over touched taxels of |deflection − that of the exact mesh|, after \
     offset with the best constant depth taken off.",
)
.summary();
pub(super) const TIMING: File<(DetailCell, DetailTime)> =
    File::new("timing.csv", "Time of a touch of each model", "").of_times();
pub(super) const COST: File<(DetailSummary, LevelTime)> =
    File::new("object_detail_cost.csv", "What errors cost", "")
        .of_times()
        .summary();
pub(super) const RECOGNITION: File<DetailRecognition> = File::new(
    "object_detail_recognition.csv",
    "Classifiers that learned from models",
    "",
);

impl PieceStudy for ObjectDetailStudy {
    type Rows = DetailRows;

    /// Of each object its models and their times; then each level and classifier, which all need all objects.
    fn pieces(&self) -> Vec<NamedPiece> {
        let mut pieces = Vec::new();
        for (group, mesh) in self.meshes.iter().enumerate() {
            // To pack a larger surface takes longer.
            let models = Piece::of_stage(0, MODELS_S_PER_M * mesh.mesh.area().sqrt());
            pieces.push(NamedPiece::new(models_name(mesh), group, models));
            let times = Piece::one_by_one(1, TIME_S);
            pieces.push(NamedPiece::new(times_name(mesh), group, times));
        }
        let (group, work) = (self.meshes.len(), Piece::of_stage(2, RECOGNISE_S));
        let learned = self.learned().into_iter();
        pieces.extend(learned.map(|learned| NamedPiece::new(learned.name(), group, work)));
        pieces
    }

    fn measure(&self, left: &PiecesLeft<DetailRows>) -> Result<()> {
        let learned = left.of(self.learned(), Learned::name);
        let sensor = match learned.is_empty() {
            true => None,
            false => Sensor::of(&self.plan)?,
        };
        if sensor.is_some() && self.meshes.len() < 2 {
            return Err(Error::input(
                "object_detail.recognition",
                format!("{} meshes", self.meshes.len()),
                "at least 2 objects to tell apart",
            ));
        }
        let is_needed = |mesh: &&NamedMesh| {
            sensor.is_some() || left.has(&models_name(mesh)) || left.has(&times_name(mesh))
        };
        let needed: Vec<&NamedMesh> = self.meshes.iter().filter(is_needed).collect();
        left.progress.stage("models", needed.len() as u64);
        let names: Vec<String> = learned.iter().map(Learned::name).collect();
        let measured = needed
            .into_par_iter()
            .map(|mesh| self.object(mesh, sensor.as_ref(), &names, left))
            .collect::<Result<Vec<_>>>()?;
        let timed = left.of(measured.iter().flatten(), |object| times_name(object.mesh));
        left.progress.stage("time touches", timed.len() as u64);
        for object in timed {
            left.finish(&times_name(object.mesh), || Ok(object.times()))?;
        }
        let felt = measured.into_iter().map(|object| object?.felt);
        let (Some(sensor), Some(felt)) = (sensor, felt.collect::<Option<Vec<_>>>()) else {
            return Ok(());
        };
        left.progress.stage("recognise", learned.len() as u64);
        learned.par_iter().try_for_each(|learned| {
            left.finish(&learned.name(), || {
                let level = (learned.number, learned.level);
                let row = sensor.row(&felt, level, learned.classifier)?;
                Ok(DetailRows {
                    recognition: vec![row],
                    ..DetailRows::default()
                })
            })
        })
    }

    fn tables(&self, rows: DetailRows) -> Result<Vec<Table>> {
        let summary = summary(&rows.detail);
        let costs = costs(&summary, &rows.timing);
        let mut tables = vec![
            DETAIL.of(&rows.detail)?,
            SUMMARY.of(&summary)?,
            TIMING.of(&rows.timing)?,
            COST.of(&costs)?,
        ];
        if self.plan.recognition().is_some() {
            tables.push(RECOGNITION.of(&rows.recognition)?);
        }
        Ok(tables)
    }
}

/// What a classifier learns from one level of models.
struct Learned {
    /// Of the level.
    number: usize,
    /// Method, and tolerance in mm.
    level: (DetailMethod, Option<f64>),
    classifier: ClassifierKind,
}

impl Learned {
    fn name(&self) -> String {
        let Self {
            level: (method, tolerance_mm),
            classifier,
            ..
        } = self;
        let within = tolerance_mm.map_or(String::new(), |mm| format!(" within {mm} mm"));
        format!("{classifier:?} from {method:?}{within}")
    }
}

fn models_name(mesh: &NamedMesh) -> String {
    format!("models of {}", mesh.name)
}

fn times_name(mesh: &NamedMesh) -> String {
    format!("times of {}", mesh.name)
}

impl ObjectDetailStudy {
    /// Level by level, of each every classifier; none if nothing learns.
    fn learned(&self) -> Vec<Learned> {
        let kinds = self.plan.recognition().into_iter();
        let kinds: Vec<ClassifierKind> = kinds.flat_map(|plan| plan.classifiers.clone()).collect();
        let levels = levels(&self.plan).into_iter().enumerate();
        let of_level = |(number, level)| {
            let kinds = kinds.iter();
            kinds.map(move |&classifier| Learned {
                number,
                level,
                classifier,
            })
        };
        levels.flat_map(of_level).collect()
    }

    /// Makes an object's models and keeps how near they are; if they cannot be made, all fails that needs them, `learned` too.
    fn object<'a>(
        &self,
        mesh: &'a NamedMesh,
        sensor: Option<&Sensor>,
        learned: &[String],
        left: &PiecesLeft<DetailRows>,
    ) -> Result<Option<Measured<'a>>> {
        let mut made = None;
        left.finish(&models_name(mesh), || {
            let object = made.insert(Measured::new(self, mesh)?);
            Ok(object.models(&self.plan))
        })?;
        let mut names = vec![times_name(mesh)];
        names.extend_from_slice(learned);
        let made = left.prepare(&names, || match made {
            Some(made) => Ok(made),
            // Its row is there from a run before.
            None => Measured::new(self, mesh),
        })?;
        let Some(mut made) = made else {
            return Ok(None);
        };
        if let Some(sensor) = sensor {
            let feel = || sensor.measure(&mesh.name, &made.variants, &made.truth);
            let felt = left.prepare(learned, feel)?;
            made.felt = felt;
        }
        Ok(Some(made))
    }
}

/// An object and its models.
struct Measured<'a> {
    mesh: &'a NamedMesh,
    surface: Surface,
    truth: Truth,
    variants: Vec<Variant>,
    /// What learning needs of each variant; none if nothing learns, or it cannot be had.
    felt: Option<Felt>,
}

impl<'a> Measured<'a> {
    fn new(study: &ObjectDetailStudy, mesh: &'a NamedMesh) -> Result<Self> {
        let surface = Surface::new(mesh.mesh.clone());
        let packings = study.packings.as_deref();
        let variants = variants(&study.plan, &mesh.place, &surface, packings)?;
        // The first of them is the mesh itself.
        let truth = truth(&study.plan, &mesh.name, &variants[0].model)?;
        Ok(Self {
            mesh,
            surface,
            truth,
            variants,
            felt: None,
        })
    }

    fn models(&self, plan: &ObjectDetailPlan) -> DetailRows {
        let n_points = plan.spec.object_detail.surface_points;
        let detail = self.variants.iter().map(|variant| {
            let score = score(variant, &self.surface, &self.truth, n_points);
            (cell(&self.mesh.name, variant), score)
        });
        DetailRows {
            detail: detail.collect(),
            ..DetailRows::default()
        }
    }

    fn times(&self) -> DetailRows {
        let timing = self.variants.iter().map(|variant| {
            let time = DetailTime {
                us_per_touch: 1e6 * self.truth.seconds_per_touch(&variant.model),
                prepare_s: variant.prepare_s,
                was_kept: variant.was_kept,
            };
            (cell(&self.mesh.name, variant), time)
        });
        DetailRows {
            timing: timing.collect(),
            ..DetailRows::default()
        }
    }
}
