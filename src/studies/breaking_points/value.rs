//! What happens at a value of a way: learned and tested as a recognition study does it.

use crate::engine::progress::Silent;
use crate::error::{Error, Result};
use crate::inputs::objects_spec::ObjectsSpec;
use crate::learning::classifiers::ClassifierKind;
use crate::objects::Object;
use crate::random::Seed;
use crate::studies::breaking_points::plan::{PlannedValue, PlannedWay};
use crate::studies::breaking_points::rows::WayCell;
use crate::studies::breaking_points::study::DrivenRows;
use crate::studies::recognition::frames::kept::Frames;
use crate::studies::recognition::frames::simulation::simulate_array;
use crate::studies::recognition::measurements::measurement::{
    Measurements, SensedBy, measure_group,
};
use crate::studies::recognition::plan::plan::Plan;
use crate::studies::recognition::sweep::sweep::Sweep;
use crate::studies::recognition::touches::drawn_touches::{TouchedObject, draw_touches};
use crate::studies::recognition::training::evaluation_inputs::FamilyInputs;
use crate::studies::recognition::training::trial::{Evaluation, Trial};
use rayon::prelude::*;
use std::sync::Arc;

/// The objects that ways touch, by what says so.
pub(super) type ObjectSets = Vec<(ObjectsSpec, Vec<Object>)>;

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
        let set = sets.iter().find(|(spec, _)| *spec == plan.spec.objects);
        let objects = set.map_or_else(Vec::new, |(_, objects)| objects.clone());
        let touched = draw_touches(objects, &plan.placement, &seed)?;
        let sweep = Sweep::new(plan, &touched)?;
        let frames = simulate_array(&touched, &plan.arrays[0], plan.frames[0], &Silent);
        Ok(Self {
            plan,
            touched,
            sweep,
            frames,
        })
    }

    /// Measured by what it draws and learns itself, or by what another did.
    fn measure(&self, trial: usize, sensed: Option<&Arc<SensedBy>>) -> Result<Measurements> {
        let group = &self.sweep.groups[0];
        let touches = (
            &self.touched as &dyn crate::studies::recognition::frames::touch_set::TouchSet,
            &self.frames,
        );
        let n_measurements = group.projected()[0];
        let inputs = group.inputs(self.plan);
        let trial = inputs.trial(&self.sweep, trial);
        measure_group(&inputs, touches, trial, (n_measurements, sensed))
    }

    /// An error unless what is learned here can be tested there: the same touches, split alike, measured by the same projection.
    fn check_alike(&self, tested: &Self) -> Result<()> {
        let shape = |world: &Self| {
            let array = &world.plan.arrays[0];
            let cell = &world.sweep.groups[0].cells[0];
            (array.shape(), cell.ensemble, cell.n_features())
        };
        let is_alike = self.sweep.labels == tested.sweep.labels
            && self.sweep.splits == tested.sweep.splits
            && shape(self) == shape(tested);
        match is_alike {
            true => Ok(()),
            false => Err(Error::input(
                "key touches",
                "other objects, touches, taxels or measurements where it is tested",
                "all: what is learned and what is tested must be alike but for what happens to it",
            )),
        }
    }
}

/// Learns and tests at a value, in all trials.
pub(super) fn evaluate(
    PlannedWay { spec: way, .. }: &PlannedWay,
    value: &PlannedValue,
    sets: &ObjectSets,
) -> Result<DrivenRows> {
    let learned = World::new(&value.learned, sets)?;
    let tested = value.tested.as_ref().map(|plan| World::new(plan, sets));
    let tested = tested.transpose()?;
    if let Some(tested) = &tested {
        learned.check_alike(tested)?;
    }
    let (plan, sweep) = (learned.plan, &learned.sweep);
    let families = sweep.groups[0].families();
    let families: Vec<(ClassifierKind, FamilyInputs)> = families
        .map(|cells| (cells[0].classifier, FamilyInputs::new(plan, sweep, cells)))
        .collect();
    // Of each classifier, trial by trial.
    let mut found: Vec<Vec<Evaluation>> = vec![Vec::new(); families.len()];
    for number in 0..value.learned.spec.trials {
        let measurements = learned.measure(number, None)?;
        let of_tested = tested.as_ref();
        let of_tested = of_tested.map(|world| world.measure(number, Some(&measurements.sensed)));
        let of_tested = of_tested.transpose()?;
        let trial = Trial {
            inputs: sweep.trial(plan, number)?,
            measurements: &measurements,
            tested: of_tested.as_ref().unwrap_or(&measurements),
        };
        let pairs = families.par_iter().zip(&mut found);
        pairs.try_for_each(|((_, family), found)| -> Result<()> {
            found.extend(trial.evaluate(family)?);
            Ok(())
        })?;
    }
    let (mut rows, mut groups) = (Vec::new(), Vec::new());
    for ((classifier, _), found) in families.iter().zip(found) {
        let cell = WayCell {
            way: way.name.clone(),
            touches: way.touches,
            value: value.value,
            classifier: *classifier,
        };
        for evaluation in found {
            rows.push((cell.clone(), evaluation.score, evaluation.time));
            groups.push(evaluation.groups);
        }
    }
    let n_objects = vec![(way.name.clone(), learned.touched.len())];
    Ok((rows, groups, n_objects))
}
