//! Object-detail study: computes models and their errors on all threads, and then computing times on one thread.

use crate::engine::work_items::pending::PendingItems;
use crate::engine::work_items::scale::{Scale, Stage};
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use crate::inputs::keys::KeyAbout;
use crate::inputs::object_files::{NamedMesh, load_named_meshes, objects_content};
use crate::inputs::packings::packing_path;
use crate::inputs::units::MM;
use crate::studies::model_recognition::check_apart;
use crate::studies::object_detail::measured::Measured;
use crate::studies::object_detail::plan::ObjectDetailPlan;
use crate::studies::object_detail::plan::object_detail_keys;
use crate::studies::object_detail::recognition::{Learned, Sensor};
use crate::studies::object_detail::rows::{
    DetailConfiguration, DetailRecognition, DetailScore, DetailSummary, DetailTime, LevelTime,
};
use crate::studies::object_detail::spec::ObjectDetailStudySpec;
use crate::studies::object_detail::summary::{costs, summary};
use crate::studies::object_detail::variants::levels;
use crate::studies::source::Source;
use crate::studies::study::{About, Facts, Findings, Resumes, Study, TableFiles};
use crate::table::{File, Table};
use rayon::prelude::*;
use std::path::PathBuf;

/// Object-detail study: its plan and its meshes.
pub struct ObjectDetailStudy {
    /// Plan of the study: the checked values of its keys, in SI units.
    pub plan: ObjectDetailPlan,
    /// Meshes of the study, one per object.
    pub meshes: Vec<NamedMesh>,
    /// Cache folder for packings (sphere models of meshes); `None` if packings are not cached.
    pub packings: Option<PathBuf>,
}

/// Results of all work items: deflection errors of models, their computing costs, and accuracies of classifiers.
pub type DetailRows = (
    Vec<(DetailConfiguration, DetailScore)>,
    Vec<(DetailConfiguration, DetailTime)>,
    Vec<DetailRecognition>,
);

/// File of the table of deflection errors, one row per object and model.
const DETAIL: File<(DetailConfiguration, DetailScore)> =
    File::new("object_detail.csv", "Models of each object", "");
const SUMMARY: File<DetailSummary> = File::new(
    "object_detail_summary.csv",
    "Models over all objects",
    "Medians and quartiles over objects. Deflection errors are means of |deflection − deflection of the exact mesh| over touched taxels; \
     errors after offset are without the best constant depth.",
)
.summary();
const TIMING: File<(DetailConfiguration, DetailTime)> =
    File::new("timing.csv", "Time of a touch of each model", "").of_times();
const COST: File<(DetailSummary, LevelTime)> =
    File::new("object_detail_cost.csv", "Cost of deflection errors", "")
        .of_times()
        .summary();
pub(super) const RECOGNITION: File<DetailRecognition> = File::new(
    "object_detail_recognition.csv",
    "Classifiers that learned from models",
    "",
);

/// Returns the number of the work item that computes all models of an object. For an index past the last object, returns the number of the first classifier's
/// item.
fn models_item(object: usize) -> usize {
    2 * object
}

/// Returns the number of the work item that measures the computing times of all models of an object.
fn times_item(object: usize) -> usize {
    models_item(object) + 1
}

/// Memory of a triangle in an exact model of a mesh, or in the surface from which its other models are computed, bytes.
const TRIANGLE_BYTES: f64 = 600.0;
/// Memory of a sphere of a model, bytes. A model has about as many spheres as the mesh has vertices.
const SPHERE_BYTES: f64 = 70.0;
/// Memory of the samples of a surface while it is packed, bytes.
const PACKING_BYTES: f64 = 6e7;

impl ObjectDetailStudy {
    /// Computes all models of an object and stores their errors. If the computation fails, all work items that need these models fail, including those in
    /// `learners`.
    fn object(
        &self,
        object: usize,
        learners: &[usize],
        left: &PendingItems<DetailRows>,
    ) -> Result<Option<Measured<'_>>> {
        let (mesh, mut made) = (&self.meshes[object], None);
        let measured = || Measured::new((&self.plan, self.packings.as_deref()), mesh);
        left.finish(models_item(object), || {
            let (object, surface) = measured()?;
            let scores = object.models(&self.plan, &surface);
            made = Some(object);
            Ok((scores, Vec::new(), Vec::new()))
        })?;
        let needed = [&[times_item(object)], learners].concat();
        // If the models are not computed, their rows are in the journal.
        left.prepare(&needed, || made.map_or_else(|| Ok(measured()?.0), Ok))
    }
}

impl Study for ObjectDetailStudy {
    const ABOUT: About = About {
        table: "object_detail",
        words: "a study of how detailed objects are",
        resumes: Resumes::ButFor(&[
            "question",
            "expected",
            "object_detail.recognition.classifiers",
        ]),
    };
    const TABLES: TableFiles = TableFiles {
        always: &[&DETAIL, &SUMMARY, &TIMING, &COST],
        of_parts: &[&RECOGNITION],
        read: None,
    };

    type Spec = ObjectDetailStudySpec;
    type Rows = DetailRows;

    fn keys() -> Vec<KeyAbout> {
        object_detail_keys()
    }

    fn load(source: &Source) -> Result<Self> {
        let mut spec = ObjectDetailStudySpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed)?;
        source.replace_objects(&mut spec.objects);
        let plan = ObjectDetailPlan::new(&source.place, spec)?;
        let meshes = load_named_meshes(&plan.meshes, &plan.spec.objects)?;
        if plan.recognition().is_some() {
            check_apart(&source.place, meshes.len())?;
        }
        Ok(Self {
            meshes,
            packings: source.packings.clone(),
            plan,
        })
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.plan.spec;
        Ok(Facts::new(spec, objects_content(&spec.objects)?))
    }

    fn scale(&self) -> Scale {
        let n_objects = self.meshes.len();
        let n_levels = levels(&self.plan).len();
        let per_object = self.plan.placement.per_object.unwrap_or(1);
        let learned = self.plan.recognition();
        let n_learned = learned.map_or(0, |learned| learned.n_touches());
        let n_classifiers = learned.map_or(0, |learned| learned.classifiers.len());
        let n_taxels = self.plan.array.n_taxels();
        let n_measurements = learned.map_or(0, |learned| learned.measurements);
        let models = self.meshes.iter().map(|NamedMesh { mesh, .. }| {
            let n_spheres = (n_levels - 1) * mesh.vertices().len();
            let exact = TRIANGLE_BYTES * mesh.n_triangles() as f64;
            let kept = exact + SPHERE_BYTES * n_spheres as f64;
            let tolerances = &self.plan.spec.object_detail.tolerances_mm;
            let is_packed = tolerances.iter().all(|mm| {
                let folder = self.packings.as_deref();
                folder.is_some_and(|folder| packing_path(folder, mesh, mm * MM).exists())
            });
            [kept, exact + if is_packed { 0.0 } else { PACKING_BYTES }]
        });
        let models: Vec<[f64; 2]> = models.collect();
        Scale {
            objects: format!("{n_objects} meshes, in {n_levels} models each"),
            touches: match n_learned {
                0 => format!("{per_object} of each model"),
                n => format!("{per_object} of each model, {n} of each for recognition"),
            },
            n_configurations: n_levels * (n_objects + n_classifiers),
            bytes: models.iter().map(|[kept, _]| kept).sum::<f64>()
                + 8.0 * (n_objects * n_learned * n_levels * n_measurements) as f64,
            stages: vec![Stage {
                bytes: 0.0,
                // While models are computed, then while they are touched.
                items: models
                    .iter()
                    .map(|[_, made]| made.max(12.0 * (n_learned * n_taxels) as f64))
                    .collect(),
            }],
        }
    }

    /// Returns all work items. For each object, one item computes its models, and one item measures their computing times. The items of classifiers follow;
    /// they need the models of all objects.
    fn work_items(&self) -> Vec<WorkItem> {
        let mut items = Vec::new();
        for (group, NamedMesh { name, .. }) in self.meshes.iter().enumerate() {
            let mut add = |name| items.push(WorkItem::new(name, group));
            add(format!("models of {name}"));
            add(format!("times of {name}"));
        }
        let group = self.meshes.len();
        let learned = Learned::all(&self.plan).into_iter();
        items.extend(learned.map(|learned| WorkItem::new(learned.name(), group)));
        items
    }

    fn measure(&self, left: &PendingItems<DetailRows>) -> Result<()> {
        let learned = left.among(models_item(self.meshes.len()), Learned::all(&self.plan));
        let learners: Vec<usize> = learned.iter().map(|(number, _)| *number).collect();
        let spec = self.plan.recognition().filter(|_| !learned.is_empty());
        let sensor = spec.map(|spec| Sensor::new(&self.plan, spec)).transpose()?;
        let is_needed = |object: &usize| {
            !learned.is_empty() || left.has(models_item(*object)) || left.has(times_item(*object))
        };
        let needed: Vec<usize> = (0..self.meshes.len()).filter(is_needed).collect();
        left.progress.stage("models", needed.len() as u64);
        let made = needed.into_par_iter().map(|object| {
            let Some(made) = self.object(object, &learners, left)? else {
                return Ok(None);
            };
            let felt = match &sensor {
                Some(sensor) => left.prepare(&learners, || sensor.measure(&made))?,
                None => None,
            };
            Ok(Some((object, made, felt)))
        });
        let made = made.collect::<Result<Vec<_>>>()?;
        left.progress.stage("time touches", made.len() as u64);
        for (object, made, _) in made.iter().flatten() {
            left.finish(times_item(*object), || {
                Ok((Vec::new(), made.times(), Vec::new()))
            })?;
        }
        let felt = made.into_iter().map(|made| made?.2);
        let (Some(sensor), Some(felt)) = (sensor, felt.collect::<Option<Vec<_>>>()) else {
            return Ok(());
        };
        left.progress.stage("recognise", learned.len() as u64);
        learned.par_iter().try_for_each(|(number, learned)| {
            left.finish(*number, || {
                let row = sensor.row(&felt, learned)?;
                Ok((Vec::new(), Vec::new(), vec![row]))
            })
        })
    }

    fn tables(&self, (detail, timing, recognition): DetailRows) -> Result<Vec<Table>> {
        let summary = summary(&detail);
        let costs = costs(&summary, &timing);
        let mut tables = vec![
            DETAIL.table(&detail)?,
            SUMMARY.table(&summary)?,
            TIMING.table(&timing)?,
            COST.table(&costs)?,
        ];
        if self.plan.recognition().is_some() {
            tables.push(RECOGNITION.table(&recognition)?);
        }
        Ok(tables)
    }

    fn findings(&self, tables: &[Table]) -> Findings {
        Findings {
            charts: self.charts(tables),
            answers: self.answers(tables),
        }
    }
}
