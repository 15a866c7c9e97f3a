//! A flat grid of equal taxels pressed along its axis until it feels a force.
//!
//! On a grid every taxel moves along the direction of travel t, so taxel i needs t − t_i, t_i being where it begins to move; the total
//! force is `F(t) = k Σ min(s, max(0, t − t_i))`: continuous, piecewise linear, never falling. So the skin is pressed once,
//! deeply, to know all t_i, and the travel for a force is found among them.

use super::output_buffer::OutputBuffer;
use super::placed_objects::TravelGoal;
use super::press::GridPress;
use crate::contact::Contact;
use crate::contact::force_goal::{FORCE_ACCURACY, unreachable_force};
use crate::contact::root_search::{Sample, crossing};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;
use crate::text::in_range::positive;
use crate::world::EvenGrid;

/// See [`press_to_force`](crate::contact::press_to_force); taxels of one stiffness, N/m.
pub(crate) fn press(
    (grid, stiffness): (&EvenGrid, f64),
    objects: &[Model],
    patch_from_objects: &[Pose],
    force: f64,
    (press, output): (&mut GridPress, &mut OutputBuffer),
) -> Result<Option<Contact>> {
    positive("touch force", force, "N")?;
    let stroke = grid.stroke;
    let gathered = press.gather(grid, objects, patch_from_objects, TravelGoal::Depth(stroke));
    let Some(first) = gathered else {
        press.touch_nothing(grid);
        return Ok(None);
    };
    let mut curve = ForceCurve::of(press, (grid, stiffness), first + stroke);
    if curve.largest() < force {
        // Not before the first taxel is saturated: then all that is there counts.
        let depth = top(objects, patch_from_objects) + stroke - first;
        press.gather(grid, objects, patch_from_objects, TravelGoal::Depth(depth));
        curve = ForceCurve::of(press, (grid, stiffness), first + depth);
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
    Ok(Some(press.indent(grid, travel, output)))
}

/// What summing thousands of springs rounds a force by, as a share: far above 1e-16, far below what is felt.
const ROUNDING: f64 = 1e-12;

/// F(t) of a grid, up to a travel.
struct ForceCurve<'a> {
    /// t_i, metres.
    starts: &'a [f64],
    /// Where nothing changes any more, or nothing beyond is known; metres.
    end: f64,
    stroke: f64,
    stiffness: f64,
}

impl<'a> ForceCurve<'a> {
    /// Of what has been gathered, up to a travel.
    fn of(press: &'a mut GridPress, (grid, stiffness): (&EvenGrid, f64), travel: f64) -> Self {
        let starts = press.starts(grid, travel);
        let last = starts.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        Self {
            starts,
            end: travel.min(last + grid.stroke),
            stroke: grid.stroke,
            stiffness,
        }
    }

    /// F in N and its slope in N/m.
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

    /// N.
    fn largest(&self) -> f64 {
        self.at(self.end).value
    }

    /// Where it is a force that is not more than the largest.
    fn travel(&self, force: f64) -> f64 {
        let first = self.starts.iter().fold(self.end, |a, &b| a.min(b));
        crossing(
            [first, self.end],
            (force, FORCE_ACCURACY * force),
            |travel| self.at(travel),
        )
    }
}

/// A height in the patch frame that no object reaches beyond, metres.
fn top(objects: &[Model], patch_from_objects: &[Pose]) -> f64 {
    let tops = objects.iter().zip(patch_from_objects);
    let tops = tops.map(|(object, pose)| {
        let bounds = object.bounds();
        pose.transform_point(bounds.center()).z + 0.5 * bounds.size().length()
    });
    tops.fold(f64::NEG_INFINITY, f64::max)
}
