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
//! Beside a valley the face continues behind its neighbour, so that a corner in a valley touches both faces. A point inside the solid touches the
//! nearest face only, and faces that it would still penetrate when moved out of the nearest one. Ridges touch where their nearest points are inside both and
//! the normal lies between the normals of the faces, outwards of both solids.
//!
//! With w the displacement of the body relative to its counterpart at p, and θ the rotation of the mesh that has the face, the penetration of a point changes by
//! `−m·w − θ·(m × w)` up to second order, and by the curvature of edges and corners.

use super::mesh_reach::cross_matrix;
use super::pair::Curvature;
use super::rigid_shape::RigidShape;
use crate::geometry::{Aabb, Pose};
use crate::mesh::{Edge, MeshFeatures};
use crate::objects::MeshModel;
use glam::{DMat3, DVec3};

/// Depth, relative to the largest depth that is searched, below which a second face of a penetrated solid is always a contact. Behind a valley, [`VALLEY`] gives
/// this depth. If larger, the back of a thin wall can count; if smaller, corners in a valley can lose one of their two faces during the search.
const SHALLOW: f64 = 1e-2;
/// Distance behind a valley up to which its faces continue, relative to the largest depth that is searched. If smaller, corners that penetrate a valley lose its
/// faces.
const VALLEY: f64 = 0.1;
/// Largest distance by which visited parts may miss their contact, relative to the largest depth that is searched.
const MISS: f64 = 1e-3;
/// Sine of the angle between two ridges below which they are parallel and their common normal is uncertain; corners then touch faces.
const PARALLEL: f64 = 1e-2;
/// Angle by which the normal of two ridges may be beyond the normals of their faces, radians. A ridge that lies on a face crosses both ridges of the face with the
/// face's normal; if smaller, rounding decides which of the two crossings counts.
const BEYOND: f64 = 1e-2;

/// Rigid shape at its pose in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'a> {
    pub shape: RigidShape<'a>,
    pub pose: Pose,
}

/// Range of penetrations of interest, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    /// Largest gap between two shapes.
    pub gap: f64,
    /// Largest penetration of two shapes.
    pub deep: f64,
}

/// Contact of two shapes; vectors are in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Numbers of the touching parts of both shapes.
    pub parts: [u32; 2],
    pub penetration: f64,
    /// Distance by which the parts miss the contact, metres, at most [`MISS`] times the largest depth: the foot is beside the face, or the nearest points are
    /// beside the ridges. At most 0 for a contact.
    pub beyond: f64,
    /// Point at which the displacement of both shapes is measured, metres.
    pub point: DVec3,
    /// Derivatives of the penetration with respect to the motion of the first shape relative to the second.
    pub curvature: Curvature,
    /// Distance of the contact point from `point`, along the normal towards the second shape, metres.
    pub inset: f64,
}

/// Visits all contacts of two shapes of which at least one is a mesh, and all parts that miss a contact by a small distance (`beyond`).
pub(super) fn each_contact(
    one: &Placed,
    other: &Placed,
    range: Range,
    mut visit: impl FnMut(Found),
) {
    // Contacts that a multiplier loads stay in the list while the shapes are apart by rounding or by the last step.
    let range = Range {
        gap: range.gap.max(SHALLOW * range.deep),
        ..range
    };
    let mut points = Points::default();
    if let RigidShape::Mesh(mesh) = other.shape {
        points.each((one, false), (mesh, &other.pose), range, &mut visit);
    }
    if let RigidShape::Mesh(mesh) = one.shape {
        points.each((other, true), (mesh, &one.pose), range, &mut visit);
    }
    if let (RigidShape::Mesh(a), RigidShape::Mesh(b)) = (one.shape, other.shape) {
        each_crossing((a, &one.pose), (b, &other.pose), range, &mut visit);
    }
}

/// Contact of a point with a mesh, in the frame of the mesh.
struct OnMesh {
    part: u32,
    beyond: f64,
    /// Distance of the point from the triangles, metres; negative inside the solid.
    distance: f64,
    normal: DVec3,
    /// Second derivative of the distance, 1/m.
    bending: DMat3,
}

/// Scratch memory for the contacts of points with meshes.
#[derive(Default)]
struct Points {
    faces: Vec<(usize, DVec3, f64)>,
    found: Vec<OnMesh>,
}

impl Points {
    /// Visits the contacts of all points of a shape with a mesh. If `is_second`, the mesh is the first shape of the contact, and the points are of the second.
    fn each(
        &mut self,
        (points, is_second): (&Placed, bool),
        (mesh, pose): (&MeshModel, &Pose),
        range: Range,
        visit: &mut impl FnMut(Found),
    ) {
        let mesh_from_points = points.pose.seen_from(pose);
        let turn = DMat3::from_quat(mesh_from_points.rotation);
        let to_world = DMat3::from_quat(pose.rotation);
        let mut look = |number: usize, point: DVec3, radius: f64| {
            let place = turn * point + mesh_from_points.translation;
            let reach = radius + mesh.rounding();
            let within = reach + range.gap.max(range.deep);
            if mesh.bvh().bounds().distance_squared(place) >= within * within {
                return;
            }
            self.touch(mesh, place, reach, range);
            for on in &self.found {
                // The normal points to the first shape.
                let outward = to_world * on.normal;
                let (parts, normal, inset, turning) = match is_second {
                    false => {
                        let turning = [DMat3::ZERO, -cross_matrix(outward)];
                        ([number as u32, on.part], outward, radius, turning)
                    }
                    true => {
                        let turning = [cross_matrix(outward), DMat3::ZERO];
                        ([on.part, number as u32], -outward, -radius, turning)
                    }
                };
                visit(Found {
                    parts,
                    penetration: reach - on.distance,
                    beyond: on.beyond,
                    point: pose.translation + to_world * place,
                    curvature: Curvature {
                        gradient: -normal,
                        bending: -(to_world * on.bending * to_world.transpose()),
                        turning,
                    },
                    inset,
                });
            }
        };
        match points.shape {
            RigidShape::Spheres(union) => {
                for (number, sphere) in union.spheres().iter().enumerate() {
                    look(number, sphere.center, sphere.radius);
                }
            }
            RigidShape::Mesh(of) => {
                for (number, corner) in of.features().corners().iter().enumerate() {
                    look(number, *corner, of.rounding());
                }
            }
        }
    }

    /// Finds the contacts of one point with a mesh. The point touches the mesh at a distance of `reach` metres.
    fn touch(&mut self, mesh: &MeshModel, place: DVec3, reach: f64, range: Range) {
        let features = mesh.features();
        let within = reach + range.gap.max(range.deep);
        self.found.clear();
        let valley = VALLEY * range.deep;
        let miss = MISS * range.deep;
        let nearest = self.look_at_faces(mesh, place, within, [valley, miss]);
        let (mut outside, mut allowed) = (place, SHALLOW * range.deep);
        let is_inside = nearest.is_some_and(|(_, height)| height < 0.0);
        if let (true, Some((normal, height))) = (is_inside, nearest) {
            outside += (1e-7 * within - height) * normal;
            allowed = allowed.max(-4.0 * height);
            if -height > range.deep {
                return;
            }
        }
        if nearest.is_some_and(|nearest| self.is_past_valley(mesh, place, nearest, within)) {
            allowed = allowed.max(2.0 * valley);
        }
        for &(triangle, normal, height) in &self.faces {
            let face = features.face(triangle);
            let above = normal.dot(outside - face.corners[0]);
            let is_nearest = nearest.is_some_and(|(_, least)| height == least);
            let foot = outside - above * normal;
            if height >= reach + range.gap || !is_nearest && above <= -allowed {
                continue;
            }
            let beyond = face.beyond(foot, normal, valley) - 1e-9 * within;
            if beyond <= miss {
                self.found.push(OnMesh {
                    part: features.face_number(triangle),
                    beyond: if is_nearest { 0.0 } else { beyond },
                    distance: height,
                    normal,
                    bending: DMat3::ZERO,
                });
            }
        }
        if reach > 0.0 && !is_inside {
            self.touch_edges(mesh, place, reach + range.gap);
        }
    }

    /// Returns whether the foot of a point on its nearest face, given by normal and height, is on the part of the face that continues behind a valley. The point
    /// is then behind the face that rises there, by up to the length of this part.
    fn is_past_valley(
        &self,
        mesh: &MeshModel,
        place: DVec3,
        (normal, height): (DVec3, f64),
        within: f64,
    ) -> bool {
        let foot = place - height * normal;
        let mut nearest = self.faces.iter().filter(|face| face.2 == height);
        let past = |triangle| {
            let face = mesh.features().face(triangle);
            face.beyond(foot, normal, 0.0) > 1e-9 * within
        };
        nearest.all(|&(triangle, ..)| past(triangle))
    }

    /// Collects the faces whose planes are within a distance of a point and that contain the foot of the point, or miss it by at most `miss` metres. Beside a
    /// valley, faces are longer by `valley` metres. Returns the normal of the nearest face that contains the foot, and the height of the point above this face.
    fn look_at_faces(
        &mut self,
        mesh: &MeshModel,
        place: DVec3,
        within: f64,
        [valley, miss]: [f64; 2],
    ) -> Option<(DVec3, f64)> {
        self.faces.clear();
        let mut nearest: Option<(DVec3, f64)> = None;
        mesh.bvh().search(
            within * within,
            |bounds| bounds.distance_squared(place),
            |triangle, _, limit| {
                let face = mesh.features().face(triangle);
                let Some(normal) = face.normal else {
                    return limit;
                };
                let height = normal.dot(place - face.corners[0]);
                let foot = place - height * normal;
                if height.abs() >= within {
                    return limit;
                }
                let beyond = face.beyond(foot, normal, valley) - 1e-9 * within;
                if beyond <= miss {
                    self.faces.push((triangle, normal, height));
                }
                if beyond <= 0.0 && nearest.is_none_or(|(_, least)| height.abs() < least.abs()) {
                    nearest = Some((normal, height));
                }
                limit
            },
        );
        nearest
    }

    /// Adds the edges and corners of a mesh that are nearer to a point than their faces, and nearer than `within` metres.
    fn touch_edges(&mut self, mesh: &MeshModel, place: DVec3, within: f64) {
        let features = mesh.features();
        let along = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        mesh.bvh().search(
            within * within,
            |bounds| bounds.distance_squared(place),
            |triangle, _, limit| {
                for number in features.own_edges(triangle) {
                    let edge = &features.edges()[number];
                    let at = edge.direction.dot(place - edge.from);
                    let away = place - edge.from - at * edge.direction;
                    let distance = away.length();
                    if !edge.range().contains(&at) || distance >= within || distance == 0.0 {
                        continue;
                    }
                    let normal = away / distance;
                    if features.edge_is_nearest(number, normal) {
                        let flat = along(normal) + along(edge.direction);
                        self.found.push(OnMesh {
                            part: features.edge_number(number),
                            beyond: 0.0,
                            distance,
                            normal,
                            bending: (DMat3::IDENTITY - flat) * (1.0 / distance),
                        });
                    }
                }
                for number in features.own_corners(triangle) {
                    let away = place - features.corners()[number];
                    let distance = away.length();
                    if distance >= within || distance == 0.0 {
                        continue;
                    }
                    let normal = away / distance;
                    if features.corner_is_nearest(number, normal) {
                        self.found.push(OnMesh {
                            part: number as u32,
                            beyond: 0.0,
                            distance,
                            normal,
                            bending: (DMat3::IDENTITY - along(normal)) * (1.0 / distance),
                        });
                    }
                }
                limit
            },
        );
    }
}

/// Visits the contacts of the ridges of two meshes.
fn each_crossing(
    (one, pose): (&MeshModel, &Pose),
    (other, other_pose): (&MeshModel, &Pose),
    range: Range,
    visit: &mut impl FnMut(Found),
) {
    let (features, others) = (one.features(), other.features());
    let reach = one.rounding() + other.rounding();
    let margin = reach + range.gap.max(range.deep);
    let other_from_one = pose.seen_from(other_pose);
    let turn = DMat3::from_quat(other_from_one.rotation);
    let to_world = DMat3::from_quat(other_pose.rotation);
    let around = other.bvh().bounds().widened(margin);
    let mut scratch = Points::default();
    for (number, edge) in features.edges().iter().enumerate() {
        if !edge.is_ridge {
            continue;
        }
        let placed = edge.moved(&turn, other_from_one.translation);
        let end = placed.from + placed.length * placed.direction;
        let region = Aabb {
            min: placed.from.min(end) - margin,
            max: placed.from.max(end) + margin,
        };
        if region.min.cmpgt(around.max).any() || around.min.cmpgt(region.max).any() {
            continue;
        }
        other.bvh().each_in_box(&region, |triangle, _| {
            for other_number in others.own_edges(triangle) {
                let other_edge = &others.edges()[other_number];
                if !other_edge.is_ridge {
                    continue;
                }
                let is_outward = |normal: DVec3| {
                    let own_normal = -(turn.transpose() * normal);
                    others.edge_points_along(other_number, normal, BEYOND)
                        && features.edge_points_along(number, own_normal, BEYOND)
                };
                let miss = MISS * range.deep;
                let Some(crossing) = Crossing::new(&placed, other_edge, miss, is_outward) else {
                    continue;
                };
                let penetration = reach - crossing.gap;
                if penetration <= -range.gap || penetration > range.deep {
                    continue;
                }
                // Ridges that cross without a rounding touch only if one is inside the other solid.
                if crossing.gap < 0.0 {
                    let middle = crossing.point - 0.5 * crossing.gap * crossing.normal;
                    let nearest = scratch.look_at_faces(other, middle, margin, [0.0; 2]);
                    if nearest.is_none_or(|(_, height)| height > 0.0) {
                        continue;
                    }
                }
                visit(Found {
                    parts: [
                        features.edge_number(number),
                        others.edge_number(other_number),
                    ],
                    penetration,
                    beyond: crossing.beyond,
                    point: other_pose.translation + to_world * crossing.point,
                    curvature: crossing.curvature().turned(&to_world),
                    inset: one.rounding(),
                });
            }
        });
    }
}

/// Nearest points of two ridges.
struct Crossing {
    /// Nearest point of the first ridge, metres.
    point: DVec3,
    /// Distance of the first ridge from the second one along the normal, metres; negative if they penetrate.
    gap: f64,
    /// Unit normal of both ridges, towards the first one.
    normal: DVec3,
    /// Unit vectors along the ridges; `normal` has the direction of their cross product.
    along: [DVec3; 2],
    /// Sine of the angle between the ridges.
    sine: f64,
    /// Distance of the nearest points beyond the ends of the ridges, metres; at most 0 if both are on their ridges.
    beyond: f64,
}

impl Crossing {
    /// Returns the crossing of two ridges; `None` if their nearest points are more than `miss` metres beside them, or if no normal satisfies `is_outward`.
    fn new(a: &Edge, b: &Edge, miss: f64, is_outward: impl Fn(DVec3) -> bool) -> Option<Self> {
        let (t, u) = (a.direction, b.direction);
        let cross = t.cross(u);
        let sine = cross.length();
        if sine < PARALLEL {
            return None;
        }
        let m = cross / sine;
        let between = a.from - b.from;
        let at = -between.dot(u.cross(m)) / sine;
        let other_at = -between.dot(t.cross(m)) / sine;
        let past = |edge: &Edge, at: f64| (-at).max(at - edge.length) - 1e-12 * edge.length;
        let beyond = past(a, at).max(past(b, other_at));
        if beyond > miss {
            return None;
        }
        let gap = m.dot(between);
        let both = if gap >= 0.0 { [1.0, -1.0] } else { [-1.0, 1.0] };
        let sign = both.into_iter().find(|sign| is_outward(*sign * m))?;
        Some(Self {
            point: a.from + at * t,
            gap: sign * gap,
            normal: sign * m,
            along: [t, sign * u],
            sine,
            beyond,
        })
    }

    /// Returns the derivatives of the penetration. A rotation of the first ridge relative to the second one turns the normal about the second ridge.
    fn curvature(&self) -> Curvature {
        let (m, [t, u]) = (self.normal, self.along);
        let (axis, way) = (t.cross(m) / self.sine, m.cross(u));
        let turn = DMat3::from_cols(axis * way.x, axis * way.y, axis * way.z);
        Curvature {
            gradient: -m,
            bending: DMat3::ZERO,
            turning: [-turn, turn - cross_matrix(m)],
        }
    }
}

/// Returns the depth, metres, by which two shapes at their poses overlap; 0 if they do not overlap or if both are unions of spheres. The depth is the largest
/// distance of a corner or sphere of one shape behind the surface of the other.
pub fn overlap(one: (RigidShape, &Pose), other: (RigidShape, &Pose)) -> f64 {
    /// Depth up to which ridges and edges are searched, relative to the smaller shape; deeper shapes have corners inside each other.
    const RIDGES: f64 = 0.05;
    let size = |shape: &RigidShape| 0.5 * shape.bounds().size().length();
    let smaller = size(&one.0).min(size(&other.0));
    let [one, other] = [one, other].map(|(shape, pose)| Placed { shape, pose: *pose });
    let range = Range {
        gap: 0.0,
        deep: RIDGES * smaller,
    };
    let mut deepest = 0.0_f64;
    each_contact(&one, &other, range, |found| {
        if found.beyond <= 0.0 {
            deepest = deepest.max(found.penetration);
        }
    });
    let mut points = Points::default();
    for (of, mesh) in [(&one, &other), (&other, &one)] {
        let RigidShape::Mesh(model) = mesh.shape else {
            continue;
        };
        let mesh_from_points = of.pose.seen_from(&mesh.pose);
        let mut look = |point: DVec3, radius: f64| {
            let place = mesh_from_points.transform_point(point);
            if model.bvh().bounds().distance_squared(place) > 0.0 {
                return;
            }
            if let Some((_, height)) = points.look_at_faces(model, place, smaller, [0.0; 2])
                && height < 0.0
            {
                deepest = deepest.max(radius - height);
            }
        };
        for sphere in of.shape.spheres() {
            look(sphere.center, sphere.radius);
        }
        if let RigidShape::Mesh(of) = of.shape {
            let corners = of.features().corners().iter();
            corners.for_each(|corner| look(*corner, of.rounding()));
        }
    }
    deepest
}

/// Visits the penetrations of the corners of a mesh into the half-space below a plane with the unit normal `normal` at `height` metres: number of the corner,
/// penetration, and position of the corner in the world.
pub(super) fn each_below_plane(
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
