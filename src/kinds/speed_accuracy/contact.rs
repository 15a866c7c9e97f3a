//! The part on contact: what an evaluation of each model costs, and how wrong it is.

use super::engines::{StepMethod, Stepper};
use super::models::{ContactRow, Models};
use super::plan::SpeedAccuracyPlan;
use super::rows::Touched;
use super::spec::ContactSpec;
use super::study::SpeedAccuracyRows;
use super::subject::{Subject, spread_evenly};
use crate::error::Result;
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::time_left::Piece;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// Contact of some of the objects.
pub(super) struct ContactPart<'a> {
    pub plan: &'a SpeedAccuracyPlan,
    pub spec: &'a ContactSpec,
    /// Objects of the study, then scans.
    pub chosen: Vec<(Touched, &'a Subject)>,
    pub packings: Option<&'a Path>,
}

/// An object stepped through time: a method, its time step, and the number of the object.
#[derive(Clone, Copy)]
struct StepRun {
    method: StepMethod,
    dt_ms: f64,
    object: usize,
}

/// Seconds for the models of an object, of a scan (which is packed), and for a step of those that are stepped through time, about.
const OBJECT_S: f64 = 0.2;
const SCAN_S: f64 = 30.0;
const STEP_S: f64 = 1e-4;

impl ContactPart<'_> {
    /// An object's models, and each of its ways through time, share the object's models.
    pub fn pieces(&self) -> Vec<NamedPiece> {
        let models = self
            .chosen
            .iter()
            .enumerate()
            .map(|(object, (touched, _))| {
                let work = match touched {
                    Touched::Object => OBJECT_S,
                    Touched::Scan => SCAN_S,
                };
                NamedPiece::new(self.models_name(object), object, Piece::of_stage(0, work))
            });
        let steps = self.steps().into_iter().map(|run| {
            let work = Piece::one_by_one(1, 1e3 * STEP_S / run.dt_ms);
            NamedPiece::new(self.step_name(&run), run.object, work)
        });
        models.chain(steps).collect()
    }

    fn models_name(&self, object: usize) -> String {
        let (touched, subject) = self.chosen[object];
        let whose = match touched {
            Touched::Object => "",
            Touched::Scan => "scan ",
        };
        format!("contact with {whose}{}", subject.name())
    }

    fn step_name(&self, run: &StepRun) -> String {
        let name = self.chosen[run.object].1.name();
        format!("{:?} of {} ms with {name}", run.method, run.dt_ms)
    }

    /// Methods and steps outside, so that the tables go by them. Scans are not stepped.
    fn steps(&self) -> Vec<StepRun> {
        let is_object = |&object: &usize| self.chosen[object].0 == Touched::Object;
        let objects: Vec<usize> = (0..self.chosen.len()).filter(is_object).collect();
        let stepped = spread_evenly(&objects, self.spec.stepped_objects);
        let mut runs = Vec::new();
        for method in StepMethod::built() {
            for &dt_ms in &self.spec.dt_ms {
                runs.extend(stepped.iter().map(|&&object| StepRun {
                    method,
                    dt_ms,
                    object,
                }));
            }
        }
        runs
    }

    /// Models on all threads, times on one.
    pub fn measure(&self, left: &PiecesLeft<SpeedAccuracyRows>) -> Result<()> {
        let steps = left.of(self.steps(), |run| self.step_name(run));
        let names_of = |object: usize| -> Vec<String> {
            let of_object = steps.iter().filter(|run| run.object == object);
            let models = left.of([self.models_name(object)], String::clone);
            models
                .into_iter()
                .chain(of_object.map(|run| self.step_name(run)))
                .collect()
        };
        let needed = (0..self.chosen.len()).map(|object| (object, names_of(object)));
        let needed: Vec<_> = needed.filter(|(_, names)| !names.is_empty()).collect();
        left.progress.stage("models", needed.len() as u64);
        let made = needed
            .into_par_iter()
            // One at a time: to pack a mesh takes from seconds to a minute.
            .with_max_len(1)
            .map(|(object, names)| {
                let make = || Models::new(self.plan, self.spec, self.chosen[object], self.packings);
                let made = left.prepare(&names, make)?;
                left.progress.advance(1);
                Ok(made.map(|made| (object, made)))
            })
            .collect::<Result<Vec<_>>>()?;
        let made: BTreeMap<usize, Models> = made.into_iter().flatten().collect();
        left.progress.stage("time touches", made.len() as u64);
        for (&object, models) in &made {
            left.finish(&self.models_name(object), || {
                Ok(of_contact(models.at_rest(self.plan)))
            })?;
        }
        left.progress.stage("step through time", steps.len() as u64);
        for run in &steps {
            if let Some(models) = made.get(&run.object) {
                left.finish(&self.step_name(run), || self.step(*run, models))?;
            }
        }
        Ok(())
    }

    fn step(&self, run: StepRun, models: &Models) -> Result<SpeedAccuracyRows> {
        let stepper = Stepper {
            patch: &self.plan.patch,
            model: models.middle_packing().1,
            method: run.method,
            dt: 1e-3 * run.dt_ms,
        };
        let row = models.stepped(&stepper, run.dt_ms, self.spec.stepped_touches)?;
        Ok(of_contact(vec![row]))
    }
}

fn of_contact(contact: Vec<ContactRow>) -> SpeedAccuracyRows {
    SpeedAccuracyRows {
        contact,
        ..SpeedAccuracyRows::default()
    }
}
