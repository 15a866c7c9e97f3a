//! Presses of an object on a patch: clusters of spheres, then spheres, then the taxels of the surface.

use super::SphereClusters;
use super::body_patch::{BodyPatch, Surface};
use super::lanes::{LANES, View};
use super::patch_state::PatchState;
use crate::contact::lanes::SelectedLanes;
use crate::contact::{Instructions, for_instructions};
use crate::geometry::Pose;
use glam::{DMat3, DVec3};

/// Surface with taxels that spheres push. A trait is used because closures would be compiled without vector instructions.
pub(super) trait Pushed {
    /// Returns whether a ball comes near any taxel. `center` is in the frame of the surface. `reach` is the radius of the ball plus the taxels' radius,
    /// metres.
    fn is_near(&self, center: DVec3, reach: f64) -> bool;

    /// Raises the deflections of the taxels by a sphere. `center` is in the frame of the surface. `reach` is the sum of the radii of sphere and taxel,
    /// metres.
    fn push(&self, state: &mut PatchState, center: DVec3, reach: f64);
}

impl PatchState {
    /// Relaxes the deflected taxels of a patch for `dt` seconds, then raises the deflections by objects at poses in the patch frame.
    pub fn step<'a>(
        &mut self,
        patch: &BodyPatch,
        objects: impl Iterator<Item = (&'a SphereClusters, Pose)>,
        dt: f64,
        instructions: Instructions,
    ) {
        self.begin_step(patch, dt);
        for (object, pose) in objects {
            push_object(instructions, self, patch, object, &pose);
        }
        self.end_step(patch);
    }
}

for_instructions! {
    /// Raises the deflections of a patch's taxels by one object at the pose `patch_from_object`.
    fn push_object(
        state: &mut PatchState,
        patch: &BodyPatch,
        object: &SphereClusters,
        patch_from_object: &Pose,
    ) = push_surface
}

#[inline(always)]
fn push_surface(
    state: &mut PatchState,
    patch: &BodyPatch,
    object: &SphereClusters,
    patch_from_object: &Pose,
) {
    let rotation = DMat3::from_quat(patch_from_object.rotation);
    let (origin, radius) = (patch_from_object.translation, patch.taxel().radius);
    match patch.surface() {
        Surface::Rows(rows) => {
            let uvw = rows.extrusion().uvw_from_patch();
            let view = View::new(uvw * rotation, uvw * origin, radius, rows.ball_in_uvw());
            push_each(state, rows, object, &view);
        }
        Surface::Dome(dome) => {
            let view = View::new(rotation, origin, radius, dome.ball);
            push_each(state, dome, object, &view);
        }
        Surface::Draped(draped) => {
            let view = View::new(rotation, origin, radius, draped.ball);
            push_each(state, draped, object, &view);
        }
    }
}

#[inline(always)]
fn push_each(state: &mut PatchState, surface: &impl Pushed, object: &SphereClusters, view: &View) {
    let bounds = object.bounds();
    let mut gaps = std::mem::take(&mut state.gaps);
    gaps.clear();
    gaps.resize(bounds.len().next_multiple_of(LANES), f64::INFINITY);
    view.lay_gaps(bounds, &mut gaps[..bounds.len()]);
    let mut n_evaluated = 0;
    for (look, gaps) in gaps.as_chunks::<LANES>().0.iter().enumerate() {
        for k in SelectedLanes::below(gaps, 0.0) {
            let cluster = look * LANES + k;
            let (center, reach) = view.ball(bounds, cluster);
            if !surface.is_near(center, reach) {
                continue;
            }
            let spheres = view.spheres(object, cluster);
            for k in spheres.near() {
                let (center, reach) = spheres.at(k);
                surface.push(state, center, reach);
                n_evaluated += 1;
            }
        }
    }
    state.gaps = gaps;
    state.n_evaluated += n_evaluated;
    state.n_rejected += object.n_spheres() - n_evaluated;
}
