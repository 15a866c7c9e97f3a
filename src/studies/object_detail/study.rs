//! Object-detail study: computes models and their errors on all threads, and then computing times on one thread. A summary covers all objects.

use crate::inputs::object_files::{NamedMesh, load_named_meshes};
use crate::inputs::packings::packing_path;
use crate::studies::object_detail::charts::{CHARTS, answers};
use crate::studies::object_detail::measured::{Level, Measured, levels};
use crate::studies::object_detail::plan::*;
use crate::studies::object_detail::recognition::{Learned, Sensor};
use crate::studies::object_detail::rows::*;
use crate::studies::prelude::*;
use crate::studies::shared_steps::grouped;
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

impl Study for ObjectDetailStudy {
    const ABOUT: About = About {
        table: "object_detail",
        words: "a study of how detailed objects are",
    };
    const TABLES: TableFiles = TableFiles {
        always: &[&DETAIL, &SUMMARY, &TIMING, &COST],
        of_parts: &[&RECOGNITION],
    };

    const CHARTS: &'static [Chart] = CHARTS;

    type Spec = ObjectDetailStudySpec;
    type Rows = DetailRows;

    fn load(source: &Source) -> Result<Self> {
        let mut spec = ObjectDetailStudySpec::of(source)?;
        source.replace_objects(&mut spec.objects);
        let plan = ObjectDetailPlan::new(&source.place, spec)?;
        let meshes = load_named_meshes(&plan.meshes, &plan.spec.objects)?;
        if plan.recognition().is_some() && meshes.len() < 2 {
            let given = format!("{} objects to recognise", meshes.len());
            return Err(Error::input(
                &source.place,
                given,
                "at least 2 to tell apart",
            ));
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
        let shared = shared_inputs(&self.plan.spec, &Self::keys());
        let inputs = (&shared, levels(&self.plan));
        let mut items = Vec::new();
        for (group, NamedMesh { name, .. }) in self.meshes.iter().enumerate() {
            let mut add = |name| items.push(WorkItem::of(name, group, &inputs));
            add(format!("models of {name}"));
            add(format!("times of {name}"));
        }
        let group = self.meshes.len();
        let learned = Learned::all(&self.plan).into_iter();
        items.extend(learned.map(|learned| WorkItem::of(learned.name(), group, &inputs)));
        items
    }

    fn measure(&self, left: &PendingItems<DetailRows>) -> Result<()> {
        let objects = 0..self.meshes.len();
        let models: Vec<Shared<Measured>> = objects.clone().map(|_| Shared::default()).collect();
        let of_study = (&self.plan, self.packings.as_deref());
        let made =
            |object: usize| models[object].get(|| Measured::new(of_study, &self.meshes[object]));
        left.stage("models", objects.clone().map(models_item));
        objects.clone().into_par_iter().try_for_each(|object| {
            left.finish(models_item(object), || {
                let scores = made(object)?.scores(&self.plan);
                Ok((scores, Vec::new(), Vec::new()))
            })
        })?;
        left.progress
            .stage("time touches", self.meshes.len() as u64);
        objects.clone().try_for_each(|object| {
            left.finish(times_item(object), || {
                Ok((Vec::new(), made(object)?.times(), Vec::new()))
            })
        })?;
        let learned = (models_item(self.meshes.len())..).zip(Learned::all(&self.plan));
        let learned: Vec<_> = learned.filter(|(number, _)| left.has(*number)).collect();
        let (Some(spec), false) = (self.plan.recognition(), learned.is_empty()) else {
            return Ok(());
        };
        left.progress.stage("recognise", learned.len() as u64);
        let sensor = Sensor::new(&self.plan, spec)?;
        let numbers: Vec<usize> = learned.iter().map(|(number, _)| *number).collect();
        let felt = left.prepare(&numbers, || {
            let felt = objects
                .into_par_iter()
                .map(|object| sensor.measure(made(object)?));
            felt.collect::<Result<Vec<_>>>()
        })?;
        let Some(felt) = felt else { return Ok(()) };
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

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers(tables)
    }
}

type Row = (DetailConfiguration, DetailScore);

fn level(configuration: &DetailConfiguration) -> Level {
    (configuration.method, configuration.tolerance_mm)
}

/// Returns one row for each method and tolerance, which summarises all objects, in the order of first occurrence.
pub(super) fn summary(rows: &[Row]) -> Vec<DetailSummary> {
    let levels = grouped(rows, |(configuration, _)| level(configuration)).into_iter();
    levels
        .map(|(level, of_level)| summary_row(level, &of_level, rows))
        .collect()
}

fn summary_row((method, tolerance_mm): Level, of_level: &[&Row], rows: &[Row]) -> DetailSummary {
    let quartiles = |value: &dyn Fn(&Row) -> f64| {
        let mut values: Vec<f64> = of_level.iter().map(|row| value(row)).collect();
        [0.25, 0.5, 0.75, 1.0].map(|part| quantile(&mut values, part))
    };
    let spheres = quartiles(&|(configuration, _)| configuration.n_spheres as f64);
    let surface = quartiles(&|(_, score)| score.surface_error_mm);
    let farthest = quartiles(&|(_, score)| score.protrusion_max_mm.max(score.gap_max_mm));
    let error = quartiles(&|(_, score)| score.error_mm);
    let after = quartiles(&|(_, score)| score.error_after_offset_mm);
    let own = quartiles(&|(_, score)| score.error_own_contact_mm);
    let ratios = of_level.iter().filter_map(|(configuration, score)| {
        let packing = rows.iter().find(|(other, _)| {
            other.object == configuration.object
                && level(other) == (DetailMethod::Packing, tolerance_mm)
        })?;
        Some(score.error_after_offset_mm / packing.1.error_after_offset_mm)
    });
    let mut ratios: Vec<f64> = ratios.collect();
    DetailSummary {
        method,
        tolerance_mm,
        n_objects: of_level.len(),
        n_spheres_q1: spheres[0],
        n_spheres_median: spheres[1],
        n_spheres_q3: spheres[2],
        surface_error_q1_mm: surface[0],
        surface_error_median_mm: surface[1],
        surface_error_q3_mm: surface[2],
        surface_error_max_q1_mm: farthest[0],
        surface_error_max_median_mm: farthest[1],
        surface_error_max_q3_mm: farthest[2],
        error_q1_mm: error[0],
        error_median_mm: error[1],
        error_q3_mm: error[2],
        error_worst_mm: error[3],
        error_after_offset_q1_mm: after[0],
        error_after_offset_median_mm: after[1],
        error_after_offset_q3_mm: after[2],
        error_after_offset_worst_mm: after[3],
        error_own_contact_median_mm: own[1],
        error_own_contact_worst_mm: own[3],
        times_packing: (!ratios.is_empty()).then(|| quantile(&mut ratios, 0.5)),
    }
}

/// Returns the computing time per touch for each method and tolerance.
pub(super) fn costs(
    summary: &[DetailSummary],
    timing: &[(DetailConfiguration, DetailTime)],
) -> Vec<(DetailSummary, LevelTime)> {
    let cost = |row: &DetailSummary| {
        let of_level = (row.method, row.tolerance_mm);
        let times = timing
            .iter()
            .filter(|(configuration, _)| level(configuration) == of_level);
        let mut times: Vec<f64> = times.map(|(_, time)| time.us_per_touch).collect();
        let time = LevelTime {
            us_per_touch_median: quantile(&mut times, 0.5),
        };
        (row.clone(), time)
    };
    summary.iter().map(cost).collect()
}
