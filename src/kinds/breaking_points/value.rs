//! What happens at a value of a way: learned and tested as a recognition study does it.

use super::plan::PlannedValue;
use super::rows::WayCell;
use super::spec::WaySpec;
use super::study::DrivenRows;
use crate::error::{Error, Result};
use crate::objects::Object;
use crate::random::Seed;
use crate::study::evaluation::{Evaluation, Trial};
use crate::study::frames::Frames;
use crate::study::measurement::{Measurements, measure_group};
use crate::study::object_files::load_objects;
use crate::study::plan::Plan;
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::{TouchedObject, draw_touches, simulate_array};
use crate::study::spec::ObjectsSpec;
use crate::study::sweep::Sweep;
use crate::study::table::Cell;
use rayon::prelude::*;
use std::path::Path;

/// What says which objects some studies touch, each once.
pub(super) fn object_specs<'a>(plans: impl Iterator<Item = &'a Plan>) -> Vec<&'a ObjectsSpec> {
    let mut specs: Vec<&ObjectsSpec> = Vec::new();
    for plan in plans {
        if !specs.contains(&&plan.spec.objects) {
            specs.push(&plan.spec.objects);
        }
    }
    specs
}

/// The objects that ways touch, by what says so.
pub(super) struct ObjectSets(Vec<(ObjectsSpec, Vec<Object>)>);

impl ObjectSets {
    pub fn load<'a>(
        plans: impl Iterator<Item = &'a Plan>,
        packings: Option<&Path>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let specs = object_specs(plans);
        progress.stage("objects", specs.len() as u64);
        let sets = specs.into_iter().map(|spec| {
            let objects = load_objects(spec, packings)?;
            progress.advance(1);
            Ok((spec.clone(), objects))
        });
        Ok(Self(sets.collect::<Result<_>>()?))
    }

    fn of(&self, plan: &Plan) -> Vec<Object> {
        let set = self.0.iter().find(|(spec, _)| *spec == plan.spec.objects);
        set.map_or_else(Vec::new, |(_, objects)| objects.clone())
    }
}

/// Touches of a plan, and how they are split.
struct World<'a> {
    plan: &'a Plan,
    touched: Vec<TouchedObject>,
    sweep: Sweep,
    frames: Frames,
}

impl<'a> World<'a> {
    fn new(plan: &'a Plan, sets: &ObjectSets) -> Result<Self> {
        let seed = Seed::new(plan.spec.seed);
        let touched = draw_touches(sets.of(plan), &plan.placement, &seed)?;
        let sweep = Sweep::new(plan, &touched)?;
        let frames = simulate_array(&touched, &plan.arrays[0], plan.frames[0], &Silent);
        Ok(Self {
            plan,
            touched,
            sweep,
            frames,
        })
    }

    fn measure(&self, trial: usize) -> Result<Measurements> {
        let group = &self.sweep.groups[0];
        let touches = (&self.touched as &dyn crate::study::TouchSet, &self.frames);
        let split = (trial, &self.sweep.splits[trial]);
        measure_group(self.plan, group, touches, split, group.projected()[0])
    }

    /// What can differ between what is learned and what is tested only by mistake.
    fn shape(&self) -> impl PartialEq {
        let grid = self.plan.arrays[0].grid;
        let cell = &self.sweep.groups[0].cells[0];
        (grid.nx, grid.ny, cell.ensemble, cell.n_features())
    }
}

/// Learns and tests at a value, in all trials.
pub(super) fn evaluate(
    way: &WaySpec,
    value: &PlannedValue,
    sets: &ObjectSets,
) -> Result<DrivenRows> {
    let learned = World::new(&value.learned, sets)?;
    let tested = value.tested.as_ref().map(|plan| World::new(plan, sets));
    let tested = tested.transpose()?;
    if let Some(tested) = &tested {
        check_alike(&learned, tested)?;
    }
    let families: Vec<&[Cell]> = learned.sweep.groups[0].families().collect();
    let mut evaluations: Vec<(usize, Evaluation)> = Vec::new();
    for number in 0..value.learned.spec.trials {
        let measurements = learned.measure(number)?;
        let of_tested = tested.as_ref().map(|world| world.measure(number));
        let of_tested = of_tested.transpose()?;
        let trial = Trial {
            plan: learned.plan,
            sweep: &learned.sweep,
            measurements: &measurements,
            tested: of_tested.as_ref().unwrap_or(&measurements),
            number,
        };
        let found = families.par_iter().map(|family| trial.evaluate(family));
        let found = found.collect::<Result<Vec<_>>>()?.into_iter().enumerate();
        evaluations
            .extend(found.flat_map(|(place, found)| found.into_iter().map(move |e| (place, e))));
    }
    // Classifier by classifier, and of each trial by trial.
    evaluations.sort_by_key(|(place, _)| *place);
    let mut rows = DrivenRows::default();
    rows.n_objects
        .insert(way.name.clone(), learned.touched.len());
    for (place, Evaluation { score, time, .. }) in evaluations {
        let cell = WayCell {
            way: way.name.clone(),
            touches: way.touches,
            value: value.value,
            classifier: families[place][0].classifier,
        };
        rows.accuracy.push((cell.clone(), score));
        rows.timing.push((cell, time));
    }
    Ok(rows)
}

/// What is learned can be tested: the same touches, split alike, measured by the same projection.
fn check_alike(learned: &World, tested: &World) -> Result<()> {
    let is_alike = learned.sweep.labels == tested.sweep.labels
        && learned.sweep.splits == tested.sweep.splits
        && learned.shape() == tested.shape();
    match is_alike {
        true => Ok(()),
        false => Err(Error::input(
            "key touches",
            "other objects, touches, taxels or measurements where it is tested",
            "all: what is learned and what is tested must be alike but for what happens to it",
        )),
    }
}
