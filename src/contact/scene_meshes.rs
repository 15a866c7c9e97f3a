//! The meshes of a scene: which of them count, and where they stop the taxels.

use super::envelope::{Envelope, Limit};
use super::grid_lines::GridLines;
use crate::geometry::Pose;
use crate::objects::{MeshModel, Model};
use crate::world::Scene;
use glam::DVec3;

impl Envelope {
    /// Looks where a scene's meshes stop the taxels, up to a limit; whether there are any.
    pub fn look(
        &mut self,
        scene: &Scene,
        patch_from_objects: &[Pose],
        lines: &GridLines,
        limit: Limit,
    ) -> bool {
        let mut meshes = meshes(scene, patch_from_objects).peekable();
        let has_meshes = meshes.peek().is_some();
        let n_taxels = scene.patch.grid.n_taxels();
        self.clear(if has_meshes { n_taxels } else { 0 });
        let taxel = &scene.patch.taxel;
        for (mesh, pose) in meshes {
            let is_passed = match limit {
                Limit::Travel(travel) => {
                    is_behind(mesh, pose, travel - taxel.stroke - taxel.radius)
                }
                Limit::Past { .. } => false,
            };
            if !is_passed {
                self.lower(mesh, pose, taxel.radius, lines, limit);
            }
        }
        has_meshes
    }

    /// Looks again without the meshes that a travel leaves behind the substrate, if there are any: a press far deeper than
    /// the stroke through something thin.
    pub fn leave_out_passed(
        &mut self,
        scene: &Scene,
        patch_from_objects: &[Pose],
        lines: &GridLines,
        travel: f64,
    ) {
        let behind = travel - scene.patch.taxel.stroke - scene.patch.taxel.radius;
        if meshes(scene, patch_from_objects).any(|(mesh, pose)| is_behind(mesh, pose, behind)) {
            self.look(scene, patch_from_objects, lines, Limit::Travel(travel));
        }
    }
}

/// The meshes of a scene, where they are.
fn meshes<'a>(
    scene: &'a Scene,
    patch_from_objects: &'a [Pose],
) -> impl Iterator<Item = (&'a MeshModel, &'a Pose)> {
    let pairs = scene.objects.iter().zip(patch_from_objects);
    pairs.filter_map(|(object, pose)| match object {
        Model::Mesh(mesh) => Some((mesh, pose)),
        Model::Spheres(_) => None,
    })
}

/// Whether all of a mesh is below a height in the patch frame.
fn is_behind(mesh: &MeshModel, pose: &Pose, height: f64) -> bool {
    let up = pose.rotation.conjugate() * DVec3::Z;
    let above = height - pose.translation.z;
    // A mesh meets all six sides of its box, so its top is at least as high as the lowest point of the highest side.
    let bounds = mesh.bounds();
    let rise = 0.5 * bounds.size() * up.abs();
    let top = up.dot(bounds.center()) + 2.0 * rise.max_element() - rise.element_sum();
    top < above && mesh.corners().all(|corner| up.dot(corner) < above)
}
