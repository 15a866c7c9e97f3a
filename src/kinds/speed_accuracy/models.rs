//! An object in the part on contact: its models, the time of a touch of each, and how wrong it is.

use super::engines::{damped, step_through};
use super::flat_rows::FlatRows;
use super::plan::SpeedAccuracyPlan;
use super::rows::{ContactCell, ContactScore, ContactTime, ContactWay, Touched};
use super::solid_contact::press_solid;
use super::spec::ContactSpec;
use super::subject::Subject;
use crate::error::Result;
use crate::kinds::median_time::median_s;
use crate::kinds::object_detail::{DeflectionError, Reading, Truth, in_mm};
use crate::objects::Model;
use crate::quantile::quantile;
use crate::random::Seed;
use crate::study::taxel_array::TaxelArray;
use std::path::Path;
use std::time::Instant;

/// How often each touch by rows is timed.
const N_REPEATS: usize = 5;

/// A way and an object, how near it is, and what it costs.
pub(super) type ContactRow = (ContactCell, ContactScore, ContactTime);

/// An object with its models and what exact contact says.
pub(super) struct Models<'a> {
    array: &'a TaxelArray,
    touched: Touched,
    subject: &'a Subject,
    truth: Truth,
    /// With the tolerance of packings, mm.
    models: Vec<(ContactWay, Option<f64>, Model)>,
    /// Which of them is the packing in the middle of the levels: fine enough not to hide what steps do, and not the dearest.
    middle: usize,
}

impl<'a> Models<'a> {
    /// Makes the models of an object or a scan, and the touches that judge them.
    pub fn new(
        plan: &'a SpeedAccuracyPlan,
        spec: &ContactSpec,
        (touched, subject): (Touched, &'a Subject),
        packings: Option<&Path>,
    ) -> Result<Self> {
        let placement = plan.placement_of(spec.touches);
        let exact = (plan.finest(), &Seed::new(plan.spec.seed));
        Ok(Self {
            array: &plan.array,
            models: subject.models(&plan.levels, packings)?,
            middle: plan.levels.len() / 2,
            truth: subject.truth(&plan.array, &placement, exact)?,
            touched,
            subject,
        })
    }

    /// Every model at rest, where the pose is given.
    pub fn at_rest(&self) -> Vec<ContactRow> {
        let models = self.models.iter().map(|(way, tolerance_mm, model)| {
            let error = Some(self.truth.error(model, 0.0));
            let seconds = self.truth.seconds_per_touch(model);
            self.row((*way, *tolerance_mm, model.n_spheres()), error, seconds)
        });
        let mut rows: Vec<ContactRow> = models.collect();
        rows.extend(self.by_rows().into_iter().flatten());
        rows.extend(self.marched());
        rows
    }

    /// The packing of the middle detail by rows of a flat patch, in doubles and in singles; not on other patches.
    fn by_rows(&self) -> Option<[ContactRow; 2]> {
        let (_, tolerance_mm, model) = &self.models[self.middle];
        let mut rows = FlatRows::new(self.array.patch())?;
        let spheres = model.spheres()?.spheres();
        let readings = &self.truth.readings;
        Some(
            [ContactWay::RowsInDoubles, ContactWay::RowsInSingles].map(|way| {
                let mut errors: Vec<f64> = Vec::new();
                for reading in readings {
                    rows.press(way, spheres, &reading.pressed());
                    errors.extend(reading.errors(&rows.deflections(way)));
                }
                // Every touch was made once before it counts.
                let repeats = (0..N_REPEATS).flat_map(|_| readings);
                let seconds = median_s(repeats, |reading: &Reading| {
                    rows.press(way, spheres, &reading.pressed());
                });
                let error = DeflectionError {
                    mean_mm: in_mm(errors.iter().sum()) / errors.len().max(1) as f64,
                    p95_mm: in_mm(quantile(&mut errors, 0.95)),
                };
                self.row(
                    (way, *tolerance_mm, model.n_spheres()),
                    Some(error),
                    seconds,
                )
            }),
        )
    }

    /// A solid by its distance function, which is what says what is right.
    fn marched(&self) -> Option<ContactRow> {
        let Subject::Solid(entry) = self.subject else {
            return None;
        };
        let seconds = median_s(&self.truth.readings, |reading: &Reading| {
            press_solid(self.array.patch(), &entry.solid, &reading.pressed());
        });
        let of = (ContactWay::SolidMarching, None, 0);
        Some(self.row(of, Some(DeflectionError::default()), seconds))
    }

    /// Some touches of the middle packing by one method with one time step.
    pub fn stepped(&self, method: ContactWay, dt_ms: f64, n_touches: usize) -> Result<ContactRow> {
        let (_, tolerance_mm, model) = &self.models[self.middle];
        let readings = &self.truth.readings;
        let chosen = &readings[..n_touches.min(readings.len())];
        let patch = damped(self.array)?;
        let (mut errors, mut seconds, mut n_steps) = (Vec::new(), Vec::new(), 0);
        let mut is_finite = true;
        for reading in chosen {
            let start = Instant::now();
            let (felt, n) = step_through((&patch, model), (method, 1e-3 * dt_ms), reading)?;
            seconds.push(start.elapsed().as_secs_f64());
            n_steps = n;
            is_finite &= felt.is_some();
            errors.extend(reading.errors(&felt.unwrap_or_default()));
        }
        is_finite &= errors.iter().all(|error| error.is_finite());
        let error = is_finite.then(|| DeflectionError::of(errors));
        let of = (method, *tolerance_mm, model.n_spheres());
        let (mut cell, mut score, time) = self.row(of, error, quantile(&mut seconds, 0.5));
        cell.dt_ms = Some(dt_ms);
        (score.n_touches, score.n_steps) = (chosen.len(), Some(n_steps));
        Ok((cell, score, time))
    }

    /// Of all touches, where nothing is stepped: a way with its tolerance (mm) and spheres, how wrong it is (no error where a number was not
    /// finite), and seconds a touch.
    fn row(
        &self,
        (way, tolerance_mm, n_spheres): (ContactWay, Option<f64>, usize),
        error: Option<DeflectionError>,
        seconds: f64,
    ) -> ContactRow {
        let cell = ContactCell {
            way,
            tolerance_mm,
            dt_ms: None,
            touched: self.touched,
            object: self.subject.name().to_owned(),
            n_spheres,
        };
        let score = ContactScore {
            n_touches: self.truth.readings.len(),
            error_mm: error.map(|error| error.mean_mm),
            error_p95_mm: error.map(|error| error.p95_mm),
            n_steps: None,
        };
        let us_per_touch = 1e6 * seconds;
        (cell, score, ContactTime { us_per_touch })
    }
}
