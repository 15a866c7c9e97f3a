//! Contacts of meshes with planes, spheres and other meshes.
//!
//! Two sharp solids touch at a corner of one and a face of the other, or at two ridges. The penetration is measured along the unit normal m:
//!
//! | contact | normal m | penetration |
//! |---|---|---|
//! | point p of radius R on a face through a | outward normal of the face | R − m·(p − a) |
//! | point p of radius R on an edge or a corner, q nearest | (p − q) / \|p − q\| | R − \|p − q\| |
//! | ridges through a and b along t and u | ± t × u / \|t × u\|, outwards of both | −m·(a − b) |
//!
//! A point is a corner of a mesh (R = 0, or the rounding of the mesh) or the centre of a sphere. A point touches a face if its foot is inside the face.
//! Beside a valley the face continues behind its neighbour, so that a corner in a valley touches both faces. Whether a point is inside the solid follows from the
//! nearest part of the mesh (`points`). Ridges touch where their nearest points are inside both and
//! the normal lies between the normals of the faces, outwards of both solids.
//!
//! With w the displacement of the body relative to its counterpart at p, and θ the rotation of the mesh that has the face, the penetration of a point changes by
//! `−m·w − θ·(m × w)` up to second order, and by the curvature of edges and corners.

use super::super::rigid_shape::RigidShape;
use super::found::{Found, Placed, Range};
use super::near::Near;
use super::points::Points;
use super::ridges::each_crossing;
use crate::geometry::Pose;
use crate::mesh::MeshFeatures;
use crate::objects::MeshModel;
use glam::{DMat3, DVec3};

/// Least gap up to which contacts are collected, relative to the largest penetration of a descent. Contacts that a multiplier loads stay in the list while the
/// shapes are apart by rounding or by the last step.
const LEAST_GAP: f64 = 1e-2;

/// Visits all contacts of two shapes of which at least one is a mesh, and all parts that miss a contact by a small distance (`beyond`).
pub(in crate::contact::equilibrium) fn each_contact(
    one: &Placed,
    other: &Placed,
    range: Range,
    mut visit: impl FnMut(Found),
) {
    let range = Range {
        gap: range.gap.max(LEAST_GAP * range.depth.largest),
        ..range
    };
    let (mut own, mut others) = (Near::default(), Near::default());
    if let (RigidShape::Mesh(a), RigidShape::Mesh(b)) = (one.shape, other.shape) {
        let margin = a.rounding() + b.rounding() + range.reach();
        own = Near::new((a, &one.pose), (b, &other.pose), margin);
        others = Near::new((b, &other.pose), (a, &one.pose), margin);
        let placed = [(a, &one.pose), (b, &other.pose)];
        each_crossing(placed, &own.ridges, range, &mut visit);
    }
    let mut points = Points::default();
    if let RigidShape::Mesh(mesh) = other.shape {
        let points_of = (one, &own.corners[..], false);
        points.each(points_of, (mesh, &other.pose), range, &mut visit);
    }
    if let RigidShape::Mesh(mesh) = one.shape {
        let points_of = (other, &others.corners[..], true);
        points.each(points_of, (mesh, &one.pose), range, &mut visit);
    }
}

/// Visits the penetrations of the corners of a mesh into the half-space below a plane with the unit normal `normal` at `height` metres: number of the corner,
/// penetration, and position of the corner in the world.
pub(in crate::contact::equilibrium) fn each_below_plane(
    (mesh, pose): (&MeshModel, &Pose),
    (normal, height): (DVec3, f64),
    gap: f64,
    mut visit: impl FnMut(u32, f64, DVec3),
) {
    let features: &MeshFeatures = mesh.features();
    let rotation = DMat3::from_quat(pose.rotation);
    for (corner, number) in features.corners().iter().zip(0..) {
        let place = rotation * *corner + pose.translation;
        let penetration = mesh.rounding() + height - place.dot(normal);
        if penetration > -gap {
            visit(number, penetration, place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::found::Depth;
    use super::*;
    use crate::mesh::TriangleMesh;
    use crate::random::Seed;
    use glam::DQuat;
    use rand::Rng;
    use std::collections::BTreeMap;

    /// Compares the derivatives of all contacts of two ellipsoids with finite differences of the penetration, at random poses: translations up to second order, and
    /// rotations about the centre of the first shape up to first order.
    #[test]
    fn derivatives_of_contacts_are_differences_of_the_penetration() {
        let egg = |x: f64, y: f64, z: f64| {
            let mesh = TriangleMesh::ellipsoid("egg", DVec3::new(x, y, z), 3e-4).unwrap();
            MeshModel::new(mesh)
        };
        let (one, other) = (egg(9e-3, 7e-3, 5e-3), egg(12e-3, 6e-3, 8e-3));
        let mut rng = Seed::new(3).named("contacts").rng();
        let mut vector = || DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0)));
        let range = Range {
            gap: 5e-5,
            depth: Depth::up_to(5e-4),
        };
        let fixed = Placed {
            shape: (&other).into(),
            pose: Pose::from_rotation(DQuat::from_scaled_axis(vector())),
        };
        let find = |pose: &Pose| {
            let moved = Placed {
                shape: (&one).into(),
                pose: *pose,
            };
            let mut all = BTreeMap::new();
            each_contact(&moved, &fixed, range, |found| {
                all.insert(found.parts, found);
            });
            all
        };
        let mut n_contacts = 0;
        for _ in 0..60 {
            let turn = DQuat::from_scaled_axis(3.0 * vector());
            let way = vector().normalize();
            let at = |height: f64| Pose::new(turn, height * way);
            let (mut low, mut high) = (0.0, 0.05);
            for _ in 0..30 {
                let middle = 0.5 * (low + high);
                match find(&at(middle))
                    .values()
                    .any(|found| found.penetration > 0.0)
                    || middle < 0.011
                {
                    true => low = middle,
                    false => high = middle,
                }
            }
            let pose = at(low - 2e-5);
            let (shift, axis) = (vector().normalize(), vector().normalize());
            let h = 1e-8;
            let moved = |v: f64, angle: f64| {
                let turned = DQuat::from_scaled_axis(angle * axis) * pose.rotation;
                find(&Pose::new(turned, pose.translation + v * shift))
            };
            let [back, forth] = [-h, h].map(|v| moved(v, 0.0));
            let [left, right] = [-1e-7, 1e-7].map(|angle| moved(0.0, angle));
            for (parts, found) in find(&pose) {
                let gradient = found.curvature.gradient;
                let of = |all: &BTreeMap<[u32; 2], Found>| Some(all.get(&parts)?.penetration);
                if let (Some(back), Some(forth)) = (of(&back), of(&forth)) {
                    let slope = (forth - back) / (2.0 * h);
                    let expected = gradient.dot(shift);
                    assert!(
                        (slope - expected).abs() < 1e-5,
                        "{found:?}: {slope} {expected}"
                    );
                }
                if let (Some(left), Some(right)) = (of(&left), of(&right)) {
                    let slope = (right - left) / 2e-7;
                    let expected = gradient.dot(axis.cross(found.point - pose.translation));
                    assert!(
                        (slope - expected).abs() < 1e-7,
                        "{found:?}: {slope} {expected}"
                    );
                }
                n_contacts += 1;
            }
        }
        assert!(n_contacts > 50, "{n_contacts}");
    }
}
