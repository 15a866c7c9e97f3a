//! Runs a study of object detail: models of every mesh, their errors on all threads, then their times on one.

use super::deflection::Truth;
use super::plan::ObjectDetailPlan;
use super::recognition::{Felt, Sensor};
use super::score::{cell, score, truth};
use super::spec::DetailMethod;
use super::summary::summary;
use super::table::{DetailCell, DetailRecognition, DetailScore, DetailTime, ObjectDetailTables};
use super::variants::{Variant, levels, variants};
use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::study::object_files::NamedMesh;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft};
use crate::study::time_left::Piece;
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

/// What pieces of the study found.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct DetailRows {
    detail: Vec<(DetailCell, DetailScore)>,
    prepared: Vec<Prepared>,
    /// Of each object's models, in their order: microseconds a touch.
    touch_us: Vec<(String, Vec<f64>)>,
    recognition: Vec<DetailRecognition>,
}

/// What it took to make a model.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Prepared {
    prepare_s: f64,
    was_kept: bool,
}

impl PieceRows for DetailRows {
    fn append(&mut self, next: Self) {
        self.detail.extend(next.detail);
        self.prepared.extend(next.prepared);
        self.touch_us.extend(next.touch_us);
        self.recognition.extend(next.recognition);
    }
}

impl PieceStudy for ObjectDetailStudy {
    type Rows = DetailRows;
    type Tables = ObjectDetailTables;

    /// Of each object its models and their times; then each level and classifier, which all need all objects.
    fn pieces(&self) -> Vec<NamedPiece> {
        let mut pieces = Vec::new();
        for (group, mesh) in self.meshes.iter().enumerate() {
            let (scores, times) = (self.score_work(), self.time_work());
            pieces.push(NamedPiece::new(models_name(mesh), group, scores));
            pieces.push(NamedPiece::new(times_name(mesh), group, times));
        }
        let group = self.meshes.len();
        let names = self.recognition_names().into_iter();
        pieces.extend(names.map(|name| NamedPiece::new(name, group, self.recognition_work())));
        pieces
    }

    fn measure(&self, left: &PiecesLeft<DetailRows>) -> Result<()> {
        let learned = left.of(self.recognition_names(), String::clone);
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
        let n_models = left.of(needed.iter(), |mesh| models_name(mesh)).len();
        left.progress.stage("models", n_models as u64);
        let measured = needed
            .into_par_iter()
            .map(|mesh| self.object(mesh, sensor.as_ref(), &learned, left))
            .collect::<Result<Vec<_>>>()?;
        let timed = measured.iter().flatten();
        let timed = left.of(timed, |object| times_name(object.mesh));
        left.progress.stage("time touches", timed.len() as u64);
        for object in timed {
            left.finish(&times_name(object.mesh), || Ok(object.times()))?;
        }
        let felt = measured.into_iter().map(|object| object?.felt);
        let (Some(sensor), Some(felt)) = (sensor, felt.collect::<Option<Vec<_>>>()) else {
            return Ok(());
        };
        left.progress.stage("recognise", learned.len() as u64);
        let kinds = sensor.kinds();
        let levels = levels(&self.plan).into_iter().enumerate();
        let cells = levels.flat_map(|level| kinds.iter().map(move |&kind| (level, kind)));
        let cells: Vec<_> = cells.zip(self.recognition_names()).collect();
        cells
            .par_iter()
            .try_for_each(|&(((number, level), kind), ref name)| {
                left.finish(name, || {
                    Ok(DetailRows {
                        recognition: vec![sensor.row(&felt, (number, level), kind)?],
                        ..DetailRows::default()
                    })
                })
            })
    }

    fn shared_work(&self, left: &PiecesLeft<DetailRows>) -> Vec<Piece> {
        let learns = self.recognition_names().iter().any(|name| left.has(name));
        let mut work = Vec::new();
        for mesh in &self.meshes {
            if learns {
                work.push(self.feel_work());
            }
            if learns || left.has(&models_name(mesh)) || left.has(&times_name(mesh)) {
                work.push(self.model_work(mesh));
            }
        }
        work
    }

    fn tables(&self, rows: DetailRows) -> Result<ObjectDetailTables> {
        let mut tables = ObjectDetailTables {
            summary: summary(&rows.detail),
            ..ObjectDetailTables::default()
        };
        for (object, us) in &rows.touch_us {
            let made = rows.detail.iter().zip(&rows.prepared);
            let of_object = made.filter(|((cell, _), _)| cell.object == *object);
            let times = of_object.zip(us).map(|(((cell, _), made), &us_per_touch)| {
                let time = DetailTime {
                    us_per_touch,
                    prepare_s: made.prepare_s,
                    was_kept: made.was_kept,
                };
                (cell.clone(), time)
            });
            tables.timing.extend(times);
        }
        tables.recognition = rows.recognition;
        tables.detail = rows.detail;
        Ok(tables)
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
    fn recognition_names(&self) -> Vec<String> {
        let kinds = self.plan.recognition.iter();
        let kinds: Vec<_> = kinds.flat_map(|plan| &plan.classifiers).collect();
        let of_level = |(method, tolerance_mm): (DetailMethod, Option<f64>)| {
            let within = tolerance_mm.map_or(String::new(), |mm| format!(" within {mm} mm"));
            let names = kinds.iter();
            let names = names.map(move |kind| format!("{kind:?} from {method:?}{within}"));
            names.collect::<Vec<_>>()
        };
        levels(&self.plan).into_iter().flat_map(of_level).collect()
    }

    /// Makes an object's models and keeps how near they are; if they cannot be made, all fails that needs them, `learned` too.
    fn object<'a>(
        &self,
        mesh: &'a NamedMesh,
        sensor: Option<&Sensor>,
        learned: &[String],
        left: &PiecesLeft<DetailRows>,
    ) -> Result<Option<Measured<'a>>> {
        let mut names = vec![models_name(mesh), times_name(mesh)];
        names.extend_from_slice(learned);
        let measured = left.prepare(&names, || {
            left.during(&self.model_work(mesh), || Measured::new(self, mesh))
        })?;
        let Some(mut measured) = measured else {
            return Ok(None);
        };
        left.finish(&names[0], || Ok(measured.models(&self.plan)))?;
        if let Some(sensor) = sensor {
            let Measured {
                variants, truth, ..
            } = &measured;
            let felt = left.prepare(learned, || {
                left.during(&self.feel_work(), || {
                    sensor.measure(&mesh.name, variants, truth)
                })
            })?;
            measured.felt = felt;
        }
        Ok(Some(measured))
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
        let prepared = self.variants.iter().map(|variant| Prepared {
            prepare_s: variant.prepare_s,
            was_kept: variant.was_kept,
        });
        DetailRows {
            detail: detail.collect(),
            prepared: prepared.collect(),
            ..DetailRows::default()
        }
    }

    fn times(&self) -> DetailRows {
        let models = self.variants.iter().map(|variant| &variant.model);
        let us = models.map(|model| 1e6 * self.truth.seconds_per_touch(model));
        DetailRows {
            touch_us: vec![(self.mesh.name.clone(), us.collect())],
            ..DetailRows::default()
        }
    }
}
