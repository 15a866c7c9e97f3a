//! The meshes of a scene: which of them count, and where they stop the taxels.

use super::envelope::{Envelope, Limit};
use super::grid_lines::GridLines;
use super::indentation::Goal;
use crate::geometry::Pose;
use crate::objects::{MeshModel, Model};
use crate::world::Scene;
use glam::DVec3;

impl Envelope {
    /// Looks where the meshes of a scene that count stop the taxels, up to the goal; whether it has any mesh. `first`: the travel at
    /// which the spheres touch.
    pub fn look(
        &mut self,
        scene: &Scene,
        patch_from_objects: &[Pose],
        lines: &GridLines,
        (goal, first): (Goal, f64),
    ) -> bool {
        let mut meshes = meshes(scene, patch_from_objects).enumerate().peekable();
        let has_meshes = meshes.peek().is_some();
        let n_taxels = scene.patch.grid.n_taxels();
        self.clear(if has_meshes { n_taxels } else { 0 });
        let taxel = &scene.patch.taxel;
        let limit = match goal {
            Goal::Travel(travel) => Limit::Travel(travel),
            Goal::Depth(depth) => Limit::Past { depth, first },
            Goal::Pose | Goal::Step => Limit::Travel(0.0),
        };
        for (number, (mesh, pose)) in meshes {
            let is_behind = || is_behind(mesh, pose, -taxel.stroke - taxel.radius);
            let counts = match goal {
                Goal::Travel(_) | Goal::Depth(_) => true,
                Goal::Pose => !is_behind(),
                Goal::Step => self.has_counted(number) || !is_behind(),
            };
            let can_press = counts && self.lower(mesh, pose, taxel.radius, lines, limit);
            if matches!(goal, Goal::Step) {
                self.count(number, can_press);
            }
        }
        has_meshes
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
