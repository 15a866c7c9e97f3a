//! Parts of objects that continue to push their taxels, even from behind the substrate.
//!
//! A part that is held stops its taxel first, as do the triangles around a held triangle, because equal triangles meet in edges. If none of them meets the taxel
//! any more, the search begins at the nearest place of the part. The taxel is then pushed on by each part of the object that overlaps it, until it overlaps
//! none. An object that slides under a taxel thus hands the taxel from part to part, and the result does not depend on the sizes of the parts. Parts that are not
//! wholly behind the substrate have pushed the taxel already.

use super::near_spheres::needed_along;
use crate::contact::Workspace;
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::object_at::{ObjectAt, PlacedSphere};
use crate::contact::workspace::HeldTaxel;
use crate::geometry::Pose;
use crate::objects::{Model, Sphere, SphereUnion};
use crate::world::{Patch, PlacedTaxel};

/// Factor of the taxel's radius within which a part overlaps the taxel. The factor covers rounding, so that a taxel at its stop overlaps nothing.
const OVERLAP: f64 = 1.0 - 1e-10;

/// Raises deflections by the object parts that are marked as held, which push their taxels even from behind the substrate. Parts in front of the substrate
/// push their taxels in any case.
pub(super) fn push_held(
    patch: &Patch,
    (objects, patch_from_objects): (&[Model], &[Pose]),
    workspace: &mut Workspace,
) {
    if !workspace.holds_any() {
        return;
    }
    let placed = objects.iter().zip(patch_from_objects);
    let holders: Vec<_> = placed
        .map(|(object, pose)| Holder::new(object, pose))
        .collect();
    let held = std::mem::take(&mut workspace.held);
    for &HeldTaxel { taxel, by } in &held {
        let taxel = PlacedTaxel::new(patch.layout(), patch.taxels(), taxel as usize);
        let [object, part] = by;
        let pushed = holders[object as usize].push_on(&taxel, part);
        if let Some((height, part)) = pushed {
            workspace.push(taxel.number, -height, [object, part]);
        }
    }
    workspace.held = held;
}

/// Object that holds a taxel. Heights are those of a taxel's centre along its axis, relative to the taxel at rest, metres.
enum Holder<'a> {
    Spheres(&'a SphereUnion, ObjectAt),
    Mesh(MeshAt<'a>),
}

impl<'a> Holder<'a> {
    fn new(object: &'a Model, pose: &Pose) -> Self {
        match object {
            Model::Spheres(union) => Self::Spheres(union, ObjectAt::new(pose, 0.0)),
            Model::Mesh(mesh) => Self::Mesh(MeshAt::new(mesh, pose)),
        }
    }

    /// Returns the height to which an object that holds a taxel by a part pushes the taxel, and the part that stops it there. Returns `None` if no part behind
    /// the substrate pushes the taxel; parts in front of it have already done so.
    fn push_on(&self, taxel: &PlacedTaxel, part: u32) -> Option<(f64, u32)> {
        let around = match self {
            Self::Spheres(..) if self.is_in_front(taxel, part) => return None,
            Self::Spheres(..) => vec![part],
            Self::Mesh(mesh) if !mesh.may_be_behind(taxel) => return None,
            Self::Mesh(mesh) => mesh.around(part as usize),
        };
        let stops = around.into_iter();
        let stops: Vec<_> = stops
            .filter_map(|part| Some((self.stop(taxel, part)?, part)))
            .collect();
        let behind = stops
            .iter()
            .filter(|(_, part)| !self.is_in_front(taxel, *part));
        let mut starts: Vec<_> = behind.map(|&(height, part)| (height, Some(part))).collect();
        if stops.is_empty() {
            starts.push((self.nearest_height(taxel, part), None));
        }
        let pushed = starts.into_iter().filter_map(|(mut height, mut pushing)| {
            while height < taxel.behind {
                let Some((lower, part)) = self.stop_of_overlapping(taxel, height) else {
                    break;
                };
                (height, pushing) = (lower, Some(part));
            }
            Some((height, pushing?))
        });
        pushed.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Returns the height at which a part stops the taxel, at any distance behind the substrate. Returns `None` if the part does not push the taxel.
    fn stop(&self, taxel: &PlacedTaxel, part: u32) -> Option<f64> {
        let height = match self {
            Self::Spheres(union, object) => {
                -needed_by(&sphere_of(union, object, part), taxel, f64::NEG_INFINITY)
            }
            Self::Mesh(mesh) => mesh.stop_by(taxel, part as usize)?,
        };
        (height < 0.0).then_some(height)
    }

    /// Returns whether a part pushes the taxel and is not wholly behind the substrate.
    fn is_in_front(&self, taxel: &PlacedTaxel, part: u32) -> bool {
        match self {
            Self::Spheres(union, object) => {
                needed_by(&sphere_of(union, object, part), taxel, taxel.behind) > 0.0
            }
            Self::Mesh(mesh) => mesh.stop_in_front(taxel, part as usize).is_some(),
        }
    }

    /// Returns the height of a part that misses the taxel: of a sphere's centre, or of a triangle's point nearest to the taxel's axis.
    fn nearest_height(&self, taxel: &PlacedTaxel, part: u32) -> f64 {
        match self {
            Self::Spheres(union, object) => {
                let sphere = sphere_of(union, object, part);
                (sphere.center - taxel.center).dot(taxel.axis)
            }
            Self::Mesh(mesh) => mesh.nearest_height(taxel, part as usize),
        }
    }

    /// Returns a part that overlaps the taxel at a height and stops it below, with its stop.
    fn stop_of_overlapping(&self, taxel: &PlacedTaxel, height: f64) -> Option<(f64, u32)> {
        let lower = |part| Some((self.stop(taxel, part)?, part));
        let found = match self {
            Self::Spheres(union, object) => {
                let ball = Sphere {
                    center: object.unplace(taxel.center + height * taxel.axis),
                    radius: OVERLAP * taxel.radius,
                };
                let stops = overlapping(union, ball).filter_map(lower);
                stops.min_by(|a, b| a.0.total_cmp(&b.0))
            }
            Self::Mesh(mesh) => lower(mesh.overlapping(taxel, height, OVERLAP)? as u32),
        };
        found.filter(|&(stop, _)| stop < height)
    }
}

/// Returns a sphere of a union in the patch frame.
fn sphere_of(union: &SphereUnion, object: &ObjectAt, part: u32) -> PlacedSphere {
    object.sphere(union.spheres()[part as usize])
}

/// Returns the deflection that contact with a sphere requires of a taxel whose substrate has the height `behind`, metres.
fn needed_by(sphere: &PlacedSphere, taxel: &PlacedTaxel, behind: f64) -> f64 {
    let [across_x, across_y] = taxel.across;
    let frame = [across_x, across_y, taxel.axis];
    let reach = taxel.radius + sphere.reach;
    needed_along(taxel.center - sphere.center, frame, reach, behind)
}

/// Returns the indices of the spheres that a ball in the frame of their union meets.
fn overlapping(union: &SphereUnion, ball: Sphere) -> impl Iterator<Item = u32> {
    let clusters = union.clusters();
    let numbers = (0..clusters.bounds().len())
        .filter(move |&cluster| clusters.bounds().ball(cluster).meets(&ball))
        .flat_map(|cluster| clusters.numbers(cluster));
    let numbers = numbers.copied();
    numbers.filter(move |&number| union.spheres()[number as usize].meets(&ball))
}
