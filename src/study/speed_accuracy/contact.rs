//! The part on contact: what an evaluation of each model costs, and how wrong it is.

use super::contact_models::{
    Ready, cell, measure_models, measure_stepped, middle_packing, prepare,
};
use super::cost;
use super::engines::{StepMethod, Stepper};
use super::plan::{ContactPlan, SpeedAccuracyPlan};
use super::subject::{Subject, spread_evenly};
use super::table::{ContactCell, SpeedAccuracyTables, Touched};
use crate::error::Result;
use crate::study::pieces::{NamedPiece, PiecesLeft};
use crate::study::time_left::Piece;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// Contact of some of the objects.
pub(super) struct ContactPart<'a> {
    plan: &'a SpeedAccuracyPlan,
    contact: &'a ContactPlan,
    /// Objects of the study, then scans.
    chosen: Vec<(Touched, &'a Subject)>,
    packings: Option<&'a Path>,
}

/// An object stepped through time: a method, its time step (seconds, and as written), and the number of the object.
type StepRun = (StepMethod, f64, f64, usize);

impl<'a> ContactPart<'a> {
    pub fn new(
        plan: &'a SpeedAccuracyPlan,
        contact: &'a ContactPlan,
        (subjects, scans): (&'a [Subject], &'a [Subject]),
        packings: Option<&'a Path>,
    ) -> Self {
        let objects = spread_evenly(subjects, contact.spec.objects).into_iter();
        let objects = objects.map(|subject| (Touched::Object, subject));
        let scans = scans.iter().map(|scan| (Touched::Scan, scan));
        Self {
            plan,
            contact,
            chosen: objects.chain(scans).collect(),
            packings,
        }
    }

    /// An object's models, and each of its ways through time, share the object's models.
    pub fn pieces(&self) -> Vec<NamedPiece> {
        let models = (0..self.chosen.len())
            .map(|object| NamedPiece::new(self.models_name(object), object, cost::touches()));
        let steps = self.steps().into_iter();
        let steps =
            steps.map(|run| NamedPiece::new(self.step_name(&run), run.3, self.step_work(&run)));
        models.chain(steps).collect()
    }

    fn prepare_work(&self, object: usize) -> Piece {
        cost::models(self.chosen[object].0)
    }

    fn step_work(&self, &(method, dt, ..): &StepRun) -> Piece {
        cost::steps(method, dt)
    }

    fn models_name(&self, object: usize) -> String {
        let (touched, subject) = self.chosen[object];
        let whose = match touched {
            Touched::Object => "",
            Touched::Scan => "scan ",
        };
        format!("contact with {whose}{}", subject.name())
    }

    fn step_name(&self, (method, _, dt_ms, object): &StepRun) -> String {
        let name = self.chosen[*object].1.name();
        format!("{method:?} of {dt_ms} ms with {name}")
    }

    /// Methods and steps outside, so that the tables go by them. Scans are not stepped.
    fn steps(&self) -> Vec<StepRun> {
        let is_object = |&object: &usize| self.chosen[object].0 == Touched::Object;
        let objects: Vec<usize> = (0..self.chosen.len()).filter(is_object).collect();
        let stepped = spread_evenly(&objects, self.contact.spec.stepped_objects);
        let dts = || self.contact.dts.iter().zip(&self.contact.spec.dt_ms);
        let mut runs = Vec::new();
        for method in StepMethod::built() {
            for (&dt, &dt_ms) in dts() {
                runs.extend(stepped.iter().map(|&&object| (method, dt, dt_ms, object)));
            }
        }
        runs
    }

    /// Objects whose models something needs that is left.
    fn needed(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Vec<usize> {
        let steps = left.of(self.steps(), |run| self.step_name(run));
        let is_needed = |object: &usize| {
            left.has(&self.models_name(*object)) || steps.iter().any(|run| run.3 == *object)
        };
        (0..self.chosen.len()).filter(is_needed).collect()
    }

    /// What is made before anything is timed.
    pub fn shared_work(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Vec<Piece> {
        let needed = self.needed(left).into_iter();
        needed.map(|object| self.prepare_work(object)).collect()
    }

    /// Models on all threads, times on one.
    pub fn measure(&self, left: &PiecesLeft<SpeedAccuracyTables>) -> Result<()> {
        let timed = left.of(0..self.chosen.len(), |&object| self.models_name(object));
        let steps = left.of(self.steps(), |run| self.step_name(run));
        let needed = self.needed(left);
        let progress = left.progress;
        progress.stage("models", needed.len() as u64);
        let ready = needed
            .into_par_iter()
            // One at a time: to pack a mesh takes from seconds to a minute.
            .with_max_len(1)
            .map(|object| {
                let steps = steps.iter().filter(|run| run.3 == object);
                let mut names: Vec<String> = steps.map(|run| self.step_name(run)).collect();
                names.push(self.models_name(object));
                let prepare =
                    || prepare(self.plan, self.contact, self.chosen[object], self.packings);
                let work = self.prepare_work(object);
                let ready = left.prepare(&names, || left.during(&work, prepare))?;
                progress.advance(1);
                Ok(ready.map(|ready| (object, ready)))
            })
            .collect::<Result<Vec<_>>>()?;
        let ready: BTreeMap<usize, Ready> = ready.into_iter().flatten().collect();
        progress.stage("time touches", timed.len() as u64);
        for object in timed
            .iter()
            .filter_map(|object| ready.get_key_value(object))
        {
            left.finish(&self.models_name(*object.0), || {
                let mut tables = SpeedAccuracyTables::default();
                measure_models(self.plan, object.1, &mut tables);
                Ok(tables)
            })?;
        }
        progress.stage("step through time", steps.len() as u64);
        for run in &steps {
            if let Some(object) = ready.get(&run.3) {
                left.finish(&self.step_name(run), || self.step(run, object))?;
            }
        }
        Ok(())
    }

    fn step(&self, run: &StepRun, object: &Ready) -> Result<SpeedAccuracyTables> {
        let &(method, dt, dt_ms, _) = run;
        let (_, tolerance, model) = middle_packing(object);
        let stepper = Stepper {
            patch: &self.plan.patch,
            model,
            method,
            dt,
        };
        let cell = ContactCell {
            way: method.way(),
            tolerance_mm: tolerance.map(|tolerance| tolerance.mm),
            dt_ms: Some(dt_ms),
            ..cell(object, model)
        };
        let mut tables = SpeedAccuracyTables::default();
        let n_touches = self.contact.spec.stepped_touches;
        measure_stepped(cell, &stepper, object, n_touches, &mut tables)?;
        Ok(tables)
    }
}
