//! What happens at a value of a way, and where the values of a way break it.

use super::half::Curve;
use super::plan::{PlannedValue, PlannedWay};
use super::table::{BreakingPoint, BreakingPointsTables, Side, WayCell};
use crate::error::{Error, Result};
use crate::objects::Object;
use crate::random::Seed;
use crate::recognition::ClassifierKind;
use crate::recognition::bootstrap::Bootstrap;
use crate::study::evaluation::{Evaluation, Trial};
use crate::study::frames::Frames;
use crate::study::measurement::{Measurements, measure_group};
use crate::study::object_files::load_objects;
use crate::study::plan::Plan;
use crate::study::progress::{Progress, Silent};
use crate::study::simulation::{TouchedObject, draw_touches, simulate_array};
use crate::study::spec::ObjectsSpec;
use crate::study::summary::score;
use crate::study::sweep::Sweep;
use crate::study::table::{Cell, CellScore};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What says which objects some values touch, each once.
pub(super) fn object_specs<'a>(
    values: impl Iterator<Item = &'a PlannedValue>,
) -> Vec<&'a ObjectsSpec> {
    let plans = values.flat_map(|value| [Some(&value.learned), value.tested.as_ref()]);
    let mut specs: Vec<&ObjectsSpec> = Vec::new();
    for plan in plans.flatten() {
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
        values: impl Iterator<Item = &'a PlannedValue>,
        packings: Option<&Path>,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let specs = object_specs(values);
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
        let split = (trial, &self.sweep.splits[trial]);
        let n_measurements = group.projected()[0];
        measure_group(
            self.plan,
            group,
            (&self.touched, &self.frames),
            split,
            n_measurements,
        )
    }
}

/// What was found at a value.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Evaluated {
    pub way: String,
    value: f64,
    n_objects: usize,
    /// The trials of each classifier.
    classifiers: Vec<(ClassifierKind, Vec<Evaluation>)>,
}

/// Learns and tests at a value, in all trials.
pub(super) fn evaluate(
    way: &PlannedWay,
    value: &PlannedValue,
    sets: &ObjectSets,
) -> Result<Evaluated> {
    let learned = World::new(&value.learned, sets)?;
    let tested = value.tested.as_ref().map(|plan| World::new(plan, sets));
    let tested = tested.transpose()?;
    if let Some(tested) = &tested {
        check_alike(&learned, tested)?;
    }
    let families: Vec<&[Cell]> = learned.sweep.groups[0].families().collect();
    let mut classifiers: Vec<_> = families
        .iter()
        .map(|family| (family[0].classifier, Vec::new()))
        .collect();
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
        let evaluated = families.par_iter().map(|family| trial.evaluate(family));
        for (rows, evaluations) in classifiers
            .iter_mut()
            .zip(evaluated.collect::<Result<Vec<_>>>()?)
        {
            // Which objects are confused is in no table.
            rows.1
                .extend(evaluations.into_iter().map(|evaluation| Evaluation {
                    confusion: Vec::new(),
                    ..evaluation
                }));
        }
    }
    Ok(Evaluated {
        way: way.name.clone(),
        value: value.value,
        n_objects: learned.touched.len(),
        classifiers,
    })
}

/// What is learned can be tested: the same touches, split alike, measured by the same projection.
fn check_alike(learned: &World, tested: &World) -> Result<()> {
    let grids = [learned, tested].map(|world| world.plan.arrays[0].grid);
    let shapes = grids.map(|grid| (grid.nx, grid.ny));
    let sensed = [learned, tested].map(|world| {
        let cell = &world.sweep.groups[0].cells[0];
        (cell.ensemble, cell.n_features())
    });
    let is_alike = learned.sweep.labels == tested.sweep.labels
        && learned.sweep.splits == tested.sweep.splits
        && shapes[0] == shapes[1]
        && sensed[0] == sensed[1];
    if is_alike {
        return Ok(());
    }
    Err(Error::input(
        "key touches",
        "other objects, touches, taxels or measurements where it is tested",
        "all: what is learned and what is tested must be alike but for what happens to it",
    ))
}

/// The rows of a way, value by value, and where it breaks each classifier.
pub(super) fn add_way(
    tables: &mut BreakingPointsTables,
    way: &PlannedWay,
    evaluated: Vec<Evaluated>,
    seed: u64,
) -> Result<()> {
    let n_objects = evaluated.first().map_or(0, |value| value.n_objects);
    let mut curves: Vec<(ClassifierKind, Vec<CellScore>)> = Vec::new();
    let mut bootstrap = Bootstrap::default();
    let values: Vec<f64> = evaluated.iter().map(|found| found.value).collect();
    for found in evaluated {
        for (place, (classifier, trials)) in found.classifiers.into_iter().enumerate() {
            let cell = WayCell {
                way: way.name.clone(),
                touches: way.touches,
                value: found.value,
                classifier,
            };
            let scores = trials.iter().map(|trial| &trial.score);
            let score = score(&scores.collect::<Vec<_>>(), &mut bootstrap)?;
            if curves.len() == place {
                curves.push((classifier, Vec::new()));
            }
            curves[place].1.push(score.clone());
            tables.summary.push((cell.clone(), score));
            for Evaluation { score, time, .. } in trials {
                tables.accuracy.push((cell.clone(), score));
                tables.timing.push((cell.clone(), time));
            }
        }
    }
    let seed = Seed::new(seed).named("breaking points").named(&way.name);
    for (number, (classifier, scores)) in curves.iter().enumerate() {
        let seed = seed.numbered(number as u64);
        let curve = (*classifier, &values[..], &scores[..]);
        let found = breaking_points(way, curve, n_objects, &seed);
        tables.breaking_points.extend(found);
    }
    Ok(())
}

/// One row a side of the best of a curve.
fn breaking_points(
    way: &PlannedWay,
    (classifier, values, scores): (ClassifierKind, &[f64], &[CellScore]),
    n_objects: usize,
    seed: &Seed,
) -> Vec<BreakingPoint> {
    let accuracy: Vec<f64> = scores.iter().map(|score| score.accuracy).collect();
    let n_test: Vec<usize> = scores.iter().map(|score| score.n_test).collect();
    let curve = Curve {
        values,
        accuracy: &accuracy,
        n_test: &n_test,
        scale: way.scale,
    };
    let (best, last) = (curve.best(), values.len() - 1);
    let row = |side| {
        let half = curve.half(side, &seed.numbered(side as u64));
        let end = match side {
            Side::Smaller => 0,
            Side::Larger => last,
        };
        let finite = |value: f64| value.is_finite().then_some(value);
        BreakingPoint {
            way: way.name.clone(),
            classifier,
            side,
            best: accuracy[best],
            best_low: scores[best].accuracy_low,
            best_high: scores[best].accuracy_high,
            best_at: values[best],
            half: 0.5 * accuracy[best],
            chance: 1.0 / n_objects as f64,
            is_reached: half.at.is_finite(),
            breaks_at: finite(half.at),
            breaks_at_low: finite(half.interval.low),
            breaks_at_high: finite(half.interval.high),
            end: values[end],
            accuracy_at_end: accuracy[end],
        }
    };
    curve.sides().into_iter().map(row).collect()
}
