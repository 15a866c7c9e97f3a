//! An object in the part on contact: its models, the time of a touch of each, and how wrong it is.

use super::engines::Stepper;
use super::flat_rows::{FlatRows, Precision};
use super::plan::SpeedAccuracyPlan;
use super::rows::{ContactCell, ContactScore, ContactTime, ContactWay, Touched};
use super::solid_contact::press_solid;
use super::spec::ContactSpec;
use super::subject::Subject;
use crate::error::Result;
use crate::kinds::median_time::median_s;
use crate::kinds::object_detail::{DeflectionError, Reading, Truth};
use crate::objects::Model;
use crate::quantile::quantile;
use crate::random::Seed;
use crate::world::Placement;
use std::path::Path;
use std::time::Instant;

/// Millimetres in a metre.
const MM: f64 = 1e3;
/// How often each touch by rows is timed.
const N_REPEATS: usize = 5;

/// A way and an object, how near it is, and what it costs.
pub(super) type ContactRow = (ContactCell, ContactScore, ContactTime);

/// An object with its models and what exact contact says.
pub(super) struct Models<'a> {
    touched: Touched,
    subject: &'a Subject,
    truth: Truth,
    /// With the tolerance of packings, mm.
    models: Vec<(ContactWay, Option<f64>, Model)>,
}

/// What came of touches.
struct Found {
    n_touches: usize,
    /// Mean and 95th percentile, mm; none where a number was not finite.
    error_mm: Option<[f64; 2]>,
    /// Of a touch; none where nothing is stepped.
    n_steps: Option<usize>,
    /// Of a touch, median.
    seconds: f64,
}

impl<'a> Models<'a> {
    /// Makes the models of an object or a scan, and the touches that judge them.
    pub fn new(
        plan: &SpeedAccuracyPlan,
        spec: &ContactSpec,
        (touched, subject): (Touched, &'a Subject),
        packings: Option<&Path>,
    ) -> Result<Self> {
        let placement = Placement {
            per_object: Some(spec.touches),
            ..plan.placement.clone()
        };
        let finest = plan.levels[plan.levels.len() - 1];
        let mut models = Vec::new();
        for &level in &plan.levels {
            let packed = subject.packed(level, packings)?;
            models.push((ContactWay::PackedSpheres, Some(level), packed));
        }
        let vertices = subject.vertex_spheres()?;
        models.extend(vertices.map(|model| (ContactWay::VertexSpheres, None, model)));
        let mesh = subject.mesh();
        models.extend(mesh.map(|model| (ContactWay::ExactMesh, None, model)));
        let seed = Seed::new(plan.spec.seed);
        Ok(Self {
            truth: subject.truth(&plan.patch, &placement, (finest, &seed))?,
            touched,
            subject,
            models,
        })
    }

    /// The packing in the middle of the levels: fine enough not to hide what steps do, and not the dearest.
    pub fn middle_packing(&self) -> (Option<f64>, &Model) {
        let is_packing = |(way, ..): &&(ContactWay, _, _)| *way == ContactWay::PackedSpheres;
        let packings: Vec<_> = self.models.iter().filter(is_packing).collect();
        let (_, tolerance_mm, model) = packings[packings.len() / 2];
        (*tolerance_mm, model)
    }

    /// Every model at rest, where the pose is given.
    pub fn at_rest(&self, plan: &SpeedAccuracyPlan) -> Vec<ContactRow> {
        let models = self.models.iter().map(|(way, tolerance_mm, model)| {
            let found = Found {
                n_touches: self.truth.readings().len(),
                error_mm: Some(in_mm(self.truth.error(model, 0.0))),
                n_steps: None,
                seconds: self.truth.seconds_per_touch(model),
            };
            self.row((*way, *tolerance_mm, None), model.n_spheres(), found)
        });
        let mut rows: Vec<ContactRow> = models.collect();
        rows.extend(self.by_rows(plan).into_iter().flatten());
        rows.extend(self.marched(plan));
        rows
    }

    /// The packing of the middle detail by rows of a flat patch, in doubles and in singles; not on other patches.
    fn by_rows(&self, plan: &SpeedAccuracyPlan) -> Option<[ContactRow; 2]> {
        let (tolerance_mm, model) = self.middle_packing();
        let mut rows = FlatRows::new(&plan.patch)?;
        let spheres = model.spheres()?.spheres();
        let readings = self.truth.readings();
        let ways = [
            (ContactWay::RowsInDoubles, Precision::Doubles),
            (ContactWay::RowsInSingles, Precision::Singles),
        ];
        Some(ways.map(|(way, precision)| {
            let mut errors: Vec<f64> = Vec::new();
            for reading in readings {
                rows.press(precision, spheres, &reading.pressed());
                errors.extend(reading.errors(&rows.deflections(precision)));
            }
            // Every touch was made once before it counts.
            let repeats = (0..N_REPEATS).flat_map(|_| readings);
            let seconds = median_s(repeats, |reading: &Reading| {
                rows.press(precision, spheres, &reading.pressed());
            });
            let mean_mm = MM * errors.iter().sum::<f64>() / errors.len().max(1) as f64;
            let error_mm = [mean_mm, MM * quantile(&mut errors, 0.95)];
            let found = Found {
                n_touches: readings.len(),
                error_mm: Some(error_mm),
                n_steps: None,
                seconds,
            };
            self.row((way, tolerance_mm, None), model.n_spheres(), found)
        }))
    }

    /// A solid by its distance function, which is what says what is right.
    fn marched(&self, plan: &SpeedAccuracyPlan) -> Option<ContactRow> {
        let solid = self.subject.solid()?;
        let readings = self.truth.readings();
        let found = Found {
            n_touches: readings.len(),
            error_mm: Some([0.0; 2]),
            n_steps: None,
            seconds: median_s(readings, |reading: &Reading| {
                press_solid(&plan.patch, solid, &reading.pressed());
            }),
        };
        Some(self.row((ContactWay::SolidMarching, None, None), 0, found))
    }

    /// Some touches of the middle packing by one method with one time step.
    pub fn stepped(&self, stepper: &Stepper, dt_ms: f64, n_touches: usize) -> Result<ContactRow> {
        let readings = self.truth.readings();
        let chosen = &readings[..n_touches.min(readings.len())];
        let (mut errors, mut seconds, mut n_steps) = (Vec::new(), Vec::new(), 0);
        let mut is_finite = true;
        for reading in chosen {
            let start = Instant::now();
            let stepped = stepper.touch(reading)?;
            seconds.push(start.elapsed().as_secs_f64());
            n_steps = stepped.n_steps;
            match stepped.deflections {
                Some(felt) => errors.extend(reading.errors(&felt)),
                None => is_finite = false,
            }
        }
        is_finite &= errors.iter().all(|error| error.is_finite());
        let found = Found {
            n_touches: chosen.len(),
            error_mm: is_finite.then(|| in_mm(DeflectionError::of(errors))),
            n_steps: Some(n_steps),
            seconds: quantile(&mut seconds, 0.5),
        };
        let (tolerance_mm, model) = self.middle_packing();
        let setting = (stepper.method.way(), tolerance_mm, Some(dt_ms));
        Ok(self.row(setting, model.n_spheres(), found))
    }

    fn row(
        &self,
        (way, tolerance_mm, dt_ms): (ContactWay, Option<f64>, Option<f64>),
        n_spheres: usize,
        found: Found,
    ) -> ContactRow {
        let cell = ContactCell {
            way,
            tolerance_mm,
            dt_ms,
            touched: self.touched,
            object: self.subject.name().to_owned(),
            n_spheres,
        };
        let score = ContactScore {
            n_touches: found.n_touches,
            error_mm: found.error_mm.map(|[mean, _]| mean),
            error_p95_mm: found.error_mm.map(|[_, p95]| p95),
            n_steps: found.n_steps,
        };
        let time = ContactTime {
            us_per_touch: 1e6 * found.seconds,
        };
        (cell, score, time)
    }
}

fn in_mm(error: DeflectionError) -> [f64; 2] {
    [MM * error.mean, MM * error.p95]
}
