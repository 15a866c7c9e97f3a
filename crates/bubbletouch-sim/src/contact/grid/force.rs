//! Presses of a flat grid of equal taxels along its axis to a force.
//!
//! On a grid every taxel moves along the direction of travel t. Contact requires the deflection t − t_i of taxel i, where t_i is the travel at which it begins
//! to move. The total force `F(t) = k Σ min(s, max(0, t − t_i))` is continuous, piecewise linear and never decreases. One deep press therefore yields all t_i,
//! from which the travel for a force follows.

use super::output_buffer::OutputBuffer;
use super::press::GridPress;
use crate::contact::force_goal::{FORCE_ACCURACY, unreachable_force};
use crate::contact::root_search::{Sample, crossing};
use crate::contact::{Contact, Until};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;

/// Presses a grid of taxels until its spring force reaches a target; the fast path of [`Until::Force`]. All taxels have one stiffness, N/m.
pub(crate) fn press(
    press: &mut GridPress,
    (objects, patch_from_objects): (&[Model], &[Pose]),
    (force, stiffness): (f64, f64),
    output: &mut OutputBuffer,
) -> Result<Option<Contact>> {
    let stroke = press.grid.stroke;
    let gathered = press.gather(objects, patch_from_objects, Until::Depth(stroke));
    let Some(first) = gathered else {
        press.touch_nothing();
        return Ok(None);
    };
    let mut curve = ForceCurve::new(press, stiffness, first + stroke);
    if curve.largest() < force {
        // This press is deep enough to reach every taxel that the objects can saturate.
        let depth = top(objects, patch_from_objects) + stroke - first;
        press.gather(objects, patch_from_objects, Until::Depth(depth));
        curve = ForceCurve::new(press, stiffness, first + depth);
    }
    let largest = curve.largest();
    if force > largest * (1.0 + ROUNDING) {
        let where_to = format!(
            "all {} taxels that the object reaches are at their stroke, {:.3} mm past first contact",
            curve.starts.len(),
            1e3 * (curve.end - first)
        );
        return Err(unreachable_force(force, largest, &where_to));
    }
    let travel = curve.travel(force.min(largest));
    Ok(Some(press.indent(travel, output)))
}

/// Relative rounding error of a force that is the sum of thousands of spring forces: far above 1e-16, far below any measurable difference.
const ROUNDING: f64 = 1e-12;

/// Total spring force of a grid as a function of its travel, up to a largest travel.
struct ForceCurve<'a> {
    /// Travels at which the taxels begin to move, metres.
    starts: &'a [f64],
    /// Travel beyond which the force is constant or unknown, metres.
    end: f64,
    stroke: f64,
    stiffness: f64,
}

impl<'a> ForceCurve<'a> {
    /// Creates the force curve of a grid against the objects gathered by `press`, up to a `travel` in metres.
    fn new(press: &'a mut GridPress, stiffness: f64, travel: f64) -> Self {
        let grid = press.grid;
        let starts = press.starts(travel);
        let last = starts.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        Self {
            starts,
            end: travel.min(last + grid.stroke),
            stroke: grid.stroke,
            stiffness,
        }
    }

    /// Returns the force, N, and its derivative with respect to the travel, N/m, at a travel in metres.
    fn at(&self, travel: f64) -> Sample {
        let (mut deflection, mut n_moving) = (0.0, 0);
        for start in self.starts {
            let needed = travel - start;
            deflection += needed.clamp(0.0, self.stroke);
            n_moving += usize::from(needed > 0.0 && needed < self.stroke);
        }
        Sample {
            value: self.stiffness * deflection,
            slope: self.stiffness * n_moving as f64,
        }
    }

    /// Returns the largest force of the curve, N.
    fn largest(&self) -> f64 {
        self.at(self.end).value
    }

    /// Returns the travel, metres, at which the springs carry `force`, N. This force must not exceed the largest force of the curve.
    fn travel(&self, force: f64) -> f64 {
        let first = self.starts.iter().fold(self.end, |a, &b| a.min(b));
        crossing(
            [first, self.end],
            (force, FORCE_ACCURACY * force),
            |travel| self.at(travel),
        )
    }
}

/// Returns the height of the highest point of all objects, or a larger value, in the patch frame, metres.
fn top(objects: &[Model], patch_from_objects: &[Pose]) -> f64 {
    let tops = objects.iter().zip(patch_from_objects);
    let tops = tops.map(|(object, pose)| {
        let bounds = object.bounds();
        pose.transform_point(bounds.center()).z + 0.5 * bounds.size().length()
    });
    tops.fold(f64::NEG_INFINITY, f64::max)
}
