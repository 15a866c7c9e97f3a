//! Presses of an object on a patch: clusters of spheres, then spheres, then the taxels of the surface.

use super::SphereClusters;
use super::body_patch::{BodyPatch, Surface};
use super::patch_state::PatchState;
use crate::contact::lanes::SelectedLanes;
use crate::contact::object_at::{LOOK, ObjectAt, PlacedSphere};
use crate::contact::{Instructions, for_instructions};
use crate::geometry::Pose;
use crate::objects::Sphere;

/// Surface with taxels that spheres push. Spheres are in the frame of the surface, enlarged by the radius of the taxels. A trait is used because closures would
/// be compiled without vector instructions.
pub(super) trait Pushed {
    /// Returns whether a ball comes near any taxel.
    fn is_near(&self, ball: &PlacedSphere) -> bool;

    /// Raises the deflections of the taxels by a sphere.
    fn push(&self, state: &mut PatchState, sphere: &PlacedSphere);
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
    let at = ObjectAt::new(patch_from_object, patch.taxel().radius);
    match patch.surface() {
        Surface::Rows(rows) => {
            let uvw = rows.extrusion.uvw_from_patch();
            let at = ObjectAt {
                rotation: uvw * at.rotation,
                translation: uvw * at.translation,
                ..at
            };
            push_each(state, (rows, &rows.ball_in_uvw), object, at);
        }
        Surface::Dome(dome) => push_each(state, (dome, &dome.ball), object, at),
        Surface::Draped(draped) => push_each(state, (draped, &draped.ball), object, at),
    }
}

/// Raises the deflections of the taxels of a surface, all of which are inside a ball.
#[inline(always)]
fn push_each(
    state: &mut PatchState,
    (surface, around): (&impl Pushed, &Sphere),
    object: &SphereClusters,
    at: ObjectAt,
) {
    let mut search = std::mem::take(&mut state.clusters);
    search.lay(at, object, around);
    let mut n_evaluated = 0;
    for (look, gaps) in search.looks().iter().enumerate() {
        for k in SelectedLanes::below(gaps, 0.0) {
            let cluster = look * LOOK + k;
            if !surface.is_near(&at.sphere(object.bounds().ball(cluster))) {
                continue;
            }
            let cluster = object.cluster(cluster);
            for k in at.spheres_below(&cluster, around, 0.0) {
                surface.push(state, &at.sphere(cluster.at(k)));
                n_evaluated += 1;
            }
        }
    }
    state.clusters = search;
    state.n_evaluated += n_evaluated;
    state.n_rejected += object.n_spheres() - n_evaluated;
}
