//! A grid patch pressed until it feels a force.
//!
//! On a grid every taxel moves along the direction of travel t, so taxel i needs t − t_i, t_i being where it begins to move; the total
//! force is `F(t) = k Σ min(s, max(0, t − t_i))`: continuous, piecewise linear, never falling. So the skin is pressed once,
//! deeply, to know all t_i, and the travel for a force is found among them.

use super::crossing::{Sample, crossing};
use super::indentation::Goal;
use super::{Contact, Workspace};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{Patch, Scene, Taxel};

/// To which part of the force its travel is found, unless the last bit of the travel is more.
pub(super) const ACCURACY: f64 = 1e-13;

/// Presses until the springs carry `force` newtons together, Σ k δ: to within 1e-12 of it, or to the last bit of the travel.
///
/// `None` (and zero deflections) where the patch meets nothing. The travel may be negative, as that of
/// [`press_to_depth`](super::press_to_depth): to the depth of this travel past [`first_contact`](super::first_contact) it is the same press.
///
/// # Errors
/// A force that is not a positive number; one that is more than what the object can press into the taxels' strokes: the text
/// says the largest force, and its travel.
///
/// # Panics
/// If there are not as many poses as objects.
///
/// ```
/// use bubbletouch::contact::{Workspace, press_to_force};
/// use bubbletouch::geometry::Pose;
/// use bubbletouch::objects::{Sphere, SphereUnion};
/// use bubbletouch::world::{Grid, Patch, Scene, Taxel};
/// use glam::DVec3;
///
/// let grid = Grid { nx: 32, ny: 32, pitch: 2e-3 };
/// let taxel = Taxel { radius: 1e-3, stiffness: 100.0, damping: 0.0, stroke: 5e-3 };
/// let patch = Patch::new(grid, taxel)?;
/// let ball = Sphere { center: DVec3::new(0.0, 0.0, 0.1), radius: 0.03 };
/// let scene = Scene { patch, objects: vec![SphereUnion::new(vec![ball])?.into()] };
/// let mut workspace = Workspace::new();
/// press_to_force(&scene, &[Pose::IDENTITY], 5.0, &mut workspace)?.expect("the ball is over the patch");
/// let force = taxel.stiffness * workspace.deflections().iter().sum::<f64>();
/// assert!((force - 5.0).abs() < 5e-12);
/// # Ok::<(), bubbletouch::Error>(())
/// ```
pub fn press_to_force(
    scene: &Scene,
    patch_from_objects: &[Pose],
    force: f64,
    workspace: &mut Workspace,
) -> Result<Option<Contact>> {
    check_force(force)?;
    let Patch { taxel, .. } = scene.patch;
    let gathered = workspace.gather(scene, patch_from_objects, Goal::Depth(taxel.stroke));
    let Some(first) = gathered else {
        workspace.touch_nothing(&scene.patch);
        return Ok(None);
    };
    let mut curve = ForceCurve::of(workspace, &scene.patch, first + taxel.stroke);
    if curve.largest() < force {
        // Not before the first taxel is saturated: then all that is there counts.
        let depth = top(scene, patch_from_objects) + taxel.stroke - first;
        workspace.gather(scene, patch_from_objects, Goal::Depth(depth));
        curve = ForceCurve::of(workspace, &scene.patch, first + depth);
    }
    let largest = curve.largest();
    if force > largest * (1.0 + ROUNDING) {
        let where_to = format!(
            "all {} taxels that the object reaches are at their stroke, {:.3} mm past first contact",
            curve.starts.len(),
            1e3 * (curve.end - first)
        );
        return Err(too_much(force, largest, &where_to));
    }
    let travel = curve.travel(force.min(largest));
    Ok(Some(workspace.indent(&scene.patch, travel)))
}

/// What summing thousands of springs rounds a force by, as a share: far above 1e-16, far below what is felt.
const ROUNDING: f64 = 1e-12;

/// F(t) of a patch, up to a travel.
struct ForceCurve<'a> {
    /// t_i, metres.
    starts: &'a [f64],
    /// Where nothing changes any more, or nothing beyond is known; metres.
    end: f64,
    taxel: Taxel,
}

impl<'a> ForceCurve<'a> {
    /// Of what the workspace has gathered, up to a travel.
    fn of(workspace: &'a mut Workspace, patch: &Patch, travel: f64) -> Self {
        let starts = workspace.starts(patch, travel);
        let last = starts.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
        Self {
            starts,
            end: travel.min(last + patch.taxel.stroke),
            taxel: patch.taxel,
        }
    }

    /// F in N and its slope in N/m.
    fn at(&self, travel: f64) -> Sample {
        let (mut deflection, mut n_moving) = (0.0, 0);
        for start in self.starts {
            let needed = travel - start;
            deflection += needed.clamp(0.0, self.taxel.stroke);
            n_moving += usize::from(needed > 0.0 && needed < self.taxel.stroke);
        }
        Sample {
            value: self.taxel.stiffness * deflection,
            slope: self.taxel.stiffness * n_moving as f64,
        }
    }

    /// N.
    fn largest(&self) -> f64 {
        self.at(self.end).value
    }

    /// Where it is a force that is not more than the largest.
    fn travel(&self, force: f64) -> f64 {
        let first = self.starts.iter().fold(self.end, |a, &b| a.min(b));
        crossing(first, self.end, ACCURACY * force, |travel| {
            let Sample { value, slope } = self.at(travel);
            let value = value - force;
            Sample { value, slope }
        })
    }
}

/// The error names a force that is not a positive number.
pub(super) fn check_force(force: f64) -> Result<()> {
    if force.is_finite() && force > 0.0 {
        return Ok(());
    }
    Err(Error::input(
        "touch force",
        format!("{force} N"),
        "a finite positive number",
    ))
}

/// The error of a force that cannot be reached; `where_to`: what happens at the largest one.
pub(super) fn too_much(force: f64, largest: f64, where_to: &str) -> Error {
    Error::input(
        "touch force",
        format!("{force} N"),
        format!("up to {largest:.6} N, where {where_to}"),
    )
}

/// A height in the patch frame that no object reaches beyond, metres.
fn top(scene: &Scene, patch_from_objects: &[Pose]) -> f64 {
    let tops = scene.objects.iter().zip(patch_from_objects);
    let tops = tops.map(|(object, pose)| {
        let bounds = object.bounds();
        pose.transform_point(bounds.center()).z + 0.5 * bounds.size().length()
    });
    tops.fold(f64::NEG_INFINITY, f64::max)
}
