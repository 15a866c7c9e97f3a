//! Press kernel for any layout: each taxel moves along its own axis, and only taxels within reach of a sphere are evaluated.

use super::held_parts::push_held;
use super::near_spheres::{gather, needed_of_leaf};
use crate::contact::instructions::for_instructions;
use crate::contact::law::saturation_limit;
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::mesh::{LeafStops, SearchStack, stop_leaf};
use crate::contact::object_at::ObjectAt;
use crate::contact::taxel_contact::TaxelContact;
use crate::contact::{Contact, Record, Workspace};
use crate::geometry::Pose;
use crate::mesh::Triangle;
use crate::objects::{MeshModel, Model, Sphere, SphereUnion};
use crate::world::{LEAF, Patch, TaxelTree};
use glam::DVec3;

/// Raises the deflections of the taxels of a tree. The function ignores object parts that are marked as held by `Workspace::hold`.
pub(super) fn push_tree(
    taxels: &TaxelTree,
    n_taxels: usize,
    (objects, patch_from_objects): (&[Model], &[Pose]),
    workspace: &mut Workspace,
) {
    assert_eq!(
        objects.len(),
        patch_from_objects.len(),
        "one pose an object"
    );
    workspace.clear(n_taxels);
    for (number, (object, pose)) in objects.iter().zip(patch_from_objects).enumerate() {
        match object {
            Model::Spheres(union) => {
                let placed = PlacedUnion {
                    number: number as u32,
                    union,
                    // The leaves of the tree contain the radii of the taxels.
                    object: ObjectAt::new(pose, 0.0),
                };
                push_by_spheres(workspace.instructions(), taxels, &placed, workspace);
            }
            Model::Mesh(mesh) => push_by_mesh(taxels, number, mesh, pose, workspace),
        }
    }
}

/// Union of spheres at a pose.
struct PlacedUnion<'a> {
    /// Index of the object.
    number: u32,
    union: &'a SphereUnion,
    object: ObjectAt,
}

for_instructions! {
    /// Raises the deflections of the taxels by the spheres of an object.
    fn push_by_spheres(
        taxels: &TaxelTree,
        placed: &PlacedUnion,
        workspace: &mut Workspace,
    ) = push_by_each
}

#[inline(always)]
fn push_by_each(taxels: &TaxelTree, placed: &PlacedUnion, workspace: &mut Workspace) {
    let PlacedUnion { union, object, .. } = placed;
    let mut near = std::mem::take(&mut workspace.near);
    let search = &mut workspace.clusters;
    gather(taxels, (*object, union.clusters()), search, &mut near);
    for &number in &near {
        let sphere = object.sphere(union.spheres()[number as usize]);
        let deciding = [placed.number, number];
        taxels.each_leaf(
            |node| node.is_near(sphere.center, sphere.reach),
            |leaf| {
                let needed = needed_of_leaf(leaf, &sphere);
                let pushes = |k: usize| needed[k] > 0.0;
                if (0..LEAF).fold(false, |any, k| any | pushes(k)) {
                    for k in (0..LEAF).filter(|&k| pushes(k)) {
                        workspace.push(leaf.numbers[k], needed[k], deciding);
                    }
                }
            },
        );
    }
    workspace.near = near;
}

fn push_by_mesh(
    taxels: &TaxelTree,
    object: usize,
    mesh: &MeshModel,
    pose: &Pose,
    workspace: &mut Workspace,
) {
    let mesh = MeshAt::new(mesh, pose);
    let mut stack = SearchStack::new();
    let instructions = workspace.instructions();
    taxels.each_leaf(
        |node| mesh.is_near(node),
        |leaf| {
            let mut stops = LeafStops::below_rest();
            stop_leaf(instructions, &mesh, leaf, &mut stops, &mut stack);
            for k in 0..LEAF {
                if let Some(triangle) = stops.triangles[k] {
                    let deciding = [object as u32, triangle];
                    workspace.push(leaf.numbers[k], -stops.heights[k], deciding);
                }
            }
        },
    );
}

/// Presses a patch on objects at their given poses.
pub(crate) fn press(
    patch: &Patch,
    placed: (&[Model], &[Pose]),
    record: Record,
    workspace: &mut Workspace,
) -> Contact {
    push_tree(patch.tree(), patch.n_taxels(), placed, workspace);
    push_held(patch, placed, workspace);
    limit(patch, placed, record, workspace)
}

/// Limits the deflections of the touched taxels to their strokes and, if they are recorded, computes the contacts of these taxels.
pub(super) fn limit(
    patch: &Patch,
    placed: (&[Model], &[Pose]),
    record: Record,
    workspace: &mut Workspace,
) -> Contact {
    match record {
        Record::Deflections => stop(patch, workspace),
        Record::Contacts => meet(patch, placed, workspace),
    }
}

/// Limits the deflections of the touched taxels to their strokes.
fn stop(patch: &Patch, workspace: &mut Workspace) -> Contact {
    let mut counts = Contact::default();
    for &taxel in &workspace.touched {
        let deflection = &mut workspace.deflections[taxel as usize];
        let stroke = patch.taxels().at(taxel as usize).stroke;
        counts.n_touched += 1;
        counts.n_saturated += usize::from(*deflection > saturation_limit(stroke));
        *deflection = deflection.min(stroke);
    }
    counts
}

/// Limits the deflections of the touched taxels to their strokes, and records the contacts of these taxels.
fn meet(
    patch: &Patch,
    (objects, patch_from_objects): (&[Model], &[Pose]),
    workspace: &mut Workspace,
) -> Contact {
    workspace.touched.sort_unstable();
    let mut counts = Contact::default();
    for &number in &workspace.touched {
        let taxel = number as usize;
        let [object, part] = workspace.deciding[taxel].map(|number| number as usize);
        let (center, axis) = (
            patch.layout().centers()[taxel],
            patch.layout().axes()[taxel],
        );
        let properties = patch.taxels().at(taxel);
        let needed = workspace.deflections[taxel];
        let pushed = center - needed * axis;
        let pose = &patch_from_objects[object];
        let (point, normal) = nearest_point(&objects[object], part, pose, pushed);
        let normal = normal.normalize_or(-axis);
        let contact = TaxelContact {
            taxel,
            object,
            part,
            deflection: needed.min(properties.stroke),
            needed,
            normal,
            cosine: (-normal.dot(axis)).max(0.0),
            point,
        };
        workspace.deflections[taxel] = contact.deflection;
        counts.n_touched += 1;
        counts.n_saturated += usize::from(contact.is_saturated(properties));
        workspace.contacts.push(contact);
    }
    counts
}

/// Returns the point of an object's part (sphere or triangle) nearest to `place`, and the direction from this point to `place`; in the patch frame.
fn nearest_point(object: &Model, part: usize, pose: &Pose, place: DVec3) -> (DVec3, DVec3) {
    match object {
        Model::Spheres(union) => {
            let Sphere { center, radius } = union.spheres()[part];
            let center = pose.transform_point(center);
            let away = place - center;
            (center + radius * away.normalize_or_zero(), away)
        }
        Model::Mesh(mesh) => {
            let corners = mesh.mesh().triangle(part).0;
            let triangle = Triangle(corners.map(|corner| pose.transform_point(corner)));
            let (point, _) = triangle.closest(place);
            let away = place - point;
            (point + mesh.rounding() * away.normalize_or_zero(), away)
        }
    }
}
