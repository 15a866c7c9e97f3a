//! Poses of touches, restricted to the pose parameters that have more than one value.

use crate::learning::evaluation::next_touch::Poses;
use crate::world::{Placement, Spread, Touch, TouchAxis};
use ndarray::Array2;
use std::f64::consts::TAU;

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
