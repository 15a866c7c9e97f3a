//! Touches of objects, drawn from placements (distributions of touch poses).

use crate::learning::evaluation::next_touch::Poses;
use crate::studies::prelude::*;
use crate::world::{RestPose, Spread, touches};
use ndarray::{Array1, Array2};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Object with its resting poses and the touches that are drawn for it.
#[derive(Clone, Debug)]
pub struct TouchedObject {
    /// Object that is touched.
    pub object: Object,
    /// Resting poses of the object; each touch contains the index of one.
    pub rests: Vec<RestPose>,
    /// Touches of the object in drawing order.
    pub touches: Vec<Touch>,
}

/// Draws the touches of every object. Each object has its own random stream, so its touches do not depend on the other objects.
///
/// # Errors
/// If a placement is invalid or gives too many touches.
pub fn draw_touches(
    objects: Vec<Object>,
    placement: &Placement,
    seed: &Seed,
) -> Result<Vec<TouchedObject>> {
    let touched = objects.into_par_iter().map(|object| {
        let rests = placement.rest.poses(&object.model);
        let touches = touches(placement, &rests, &touch_stream(seed, &object))?;
        Ok(TouchedObject {
            object,
            rests,
            touches,
        })
    });
    touched.collect()
}

/// Returns the label of each touch, which is the number of its class. The argument contains the name and the number of touches of each class.
pub fn touch_labels(classes: &[(&str, usize)]) -> Array1<usize> {
    let classes = classes.iter().enumerate();
    let labels = classes.flat_map(|(label, (_, n))| std::iter::repeat_n(label, *n));
    labels.collect()
}

/// Returns the seed of the random stream from which the touches of an object are drawn.
pub fn touch_stream(seed: &Seed, object: &Object) -> Seed {
    seed.named("touches").named(&object.name)
}

/// Returns the poses of touches, restricted to the pose parameters that have more than one value. Each parameter is divided by its range.
pub fn scaled_poses(placement: &Placement, touches: &[&Touch]) -> Poses {
    let spreads = placement.spreads().into_iter();
    let ranges = spreads.map(|(axis, spread)| (axis, range(spread)));
    let axes: Vec<(TouchAxis, f64)> = ranges.filter(|(_, range)| *range > 0.0).collect();
    let scaled = |(touch, axis): (usize, usize)| touches[touch].value(axes[axis].0) / axes[axis].1;
    let turn = |&(axis, range): &(TouchAxis, f64)| (axis == TouchAxis::Yaw).then_some(TAU / range);
    Poses {
        coordinates: Array2::from_shape_fn((touches.len(), axes.len()), scaled),
        turns: axes.iter().map(turn).collect(),
    }
}

/// Returns the largest value of a pose parameter minus its smallest value.
fn range(spread: &Spread) -> f64 {
    match spread {
        Spread::Uniform { low, high } => high - low,
        Spread::Values(values) => {
            let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            most - values.iter().copied().fold(f64::INFINITY, f64::min)
        }
    }
}
