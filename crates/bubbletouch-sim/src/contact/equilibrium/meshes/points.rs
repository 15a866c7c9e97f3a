//! Contacts of the corners of a mesh, and of spheres, with another mesh.
//!
//! A point touches a face if its foot is inside the face. Beside a valley the face continues behind its neighbour, so that a corner in a valley touches both
//! faces. Let q be the point of the mesh nearest to the point p, and h = ± |p − q| its signed distance, negative inside the solid. With the outward normal n of
//! a face through a, and its height g = n·(p − a), the face is a contact if one of two conditions holds:
//!
//! | point | face | excluded |
//! |---|---|---|
//! | in front of the face, g > 0 | g ≥ h | parts of a face that its neighbours cover |
//! | behind the face, g ≤ 0, and inside the solid | n·(q − a) ≥ 0: the way to q leads out of this face, too | the far sides of the solid |
//!
//! If q is on an edge or at a corner, a point inside the solid also touches the faces of this edge or corner. A point outside touches the farthest of these faces,
//! if all of them belong to one smooth patch.
//!
//! The contacts of one point with a smooth patch ([`MeshFeatures::smooth_patch`]) are one group, whose penetration is the largest one. No face is deeper than
//! −h, and the nearest one is as deep. The penetration is thus −h where q is on a face, and continuous when the point slides over the patch. The faces of
//! a valley share the force. A floor and a wall are two patches and two contacts.

use super::super::algebra::{cross_matrix, outer};
use super::super::curvature::Curvature;
use super::super::rigid_shape::RigidShape;
use super::found::{Found, MISS, Placed, Range};
use crate::geometry::Pose;
use crate::mesh::{CREASE, Closest, MeshFeature, MeshFeatures};
use crate::objects::MeshModel;
use glam::{DMat3, DVec3};

/// Distance behind a valley up to which its faces continue in front of the point, relative to the largest penetration of a descent. If smaller, a step meets a face
/// that it did not know; if larger, more faces are collected.
const VALLEY: f64 = 0.1;
/// Distance behind a valley up to which its faces continue, relative to the depth d of a point behind them. At a crease of the angle φ, the point is on the plane of
/// the second face if its foot is d / sin φ behind the valley.
fn below() -> f64 {
    1.01 / CREASE.sin()
}

/// Largest difference of the normals of two faces that count as one plane. If larger, the lateral force in a flat valley is lost; if smaller, rounding decides.
const ONE_PLANE: f64 = 1e-7;

/// Contact of a point with a mesh, in the frame of the mesh.
struct OnMesh {
    part: u32,
    /// Number of the smooth patch of the part.
    patch: u32,
    beyond: f64,
    /// Distance of the point from the triangles, metres; negative inside the solid.
    distance: f64,
    normal: DVec3,
    /// Second derivative of the distance, 1/m.
    bending: DMat3,
}

/// Scratch memory for the contacts of points with meshes.
#[derive(Default)]
pub(super) struct Points {
    found: Vec<OnMesh>,
}

impl Points {
    /// Visits the contacts of points of a shape with a mesh: the `corners` of a mesh, or all spheres. If `is_second`, the mesh is the first shape of the contact,
    /// and the points are of the second.
    pub fn each(
        &mut self,
        (points, corners, is_second): (&Placed, &[usize], bool),
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
            self.touch(mesh, place, reach, range);
            for on in &self.found {
                // The normal points to the first shape.
                let outward = to_world * on.normal;
                let (normal, inset, turning) = match is_second {
                    false => {
                        let turning = [DMat3::ZERO, -cross_matrix(outward)];
                        (outward, radius, turning)
                    }
                    true => {
                        let turning = [cross_matrix(outward), DMat3::ZERO];
                        (-outward, -radius, turning)
                    }
                };
                let ordered = |part: u32| match is_second {
                    false => [number as u32, part],
                    true => [part, number as u32],
                };
                visit(Found {
                    parts: ordered(on.part),
                    identity: ordered(on.patch),
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
                for &number in corners {
                    look(number, of.features().corners()[number], of.rounding());
                }
            }
        }
    }

    /// Finds the contacts of one point with a mesh. The point touches the mesh at a distance of `reach` metres.
    fn touch(&mut self, mesh: &MeshModel, place: DVec3, reach: f64, range: Range) {
        self.found.clear();
        let within = reach + range.reach();
        let Some(nearest) = mesh.bvh().closest(place, within) else {
            return;
        };
        let features = mesh.features();
        let is_inside = features.is_inside(mesh.bvh(), place, &nearest);
        if is_inside && nearest.distance > range.depth.searched {
            return;
        }
        // No part is nearer than the nearest one, so none is within the gap.
        if !is_inside && nearest.distance > 1.001 * (reach + range.gap) {
            return;
        }
        self.touch_faces(mesh, (place, &nearest, is_inside), reach, range);
        if reach > 0.0 && !is_inside {
            self.touch_edges(mesh, place, reach + range.gap);
        }
    }

    /// Adds the faces that a point touches. `nearest` is the nearest point of the mesh.
    fn touch_faces(
        &mut self,
        mesh: &MeshModel,
        (place, nearest, is_inside): (DVec3, &Closest, bool),
        reach: f64,
        range: Range,
    ) {
        let features: &MeshFeatures = mesh.features();
        let within = reach + range.reach();
        let (rounding, miss) = (1e-9 * within, MISS * range.depth.largest);
        let behind = below() * nearest.distance;
        let least = match is_inside {
            true => f64::NEG_INFINITY,
            false => nearest.distance,
        };
        let nearest_patch = features.smooth_patch(features.part_of(nearest));
        // Face of the nearest edge or corner from which a point outside is farthest.
        let mut farthest: Option<OnMesh> = None;
        mesh.bvh().search(
            within * within,
            |bounds| bounds.distance_squared(place),
            |triangle, _, limit| {
                let face = features.face(triangle);
                let Some(normal) = face.normal else {
                    return limit;
                };
                let height = normal.dot(place - face.corners[0]);
                if height >= reach + range.gap || height <= -within {
                    return limit;
                }
                let part = features.face_number(triangle);
                let mut on = OnMesh {
                    part,
                    patch: features.smooth_patch(part),
                    beyond: 0.0,
                    distance: height,
                    normal,
                    bending: DMat3::ZERO,
                };
                let is_nearest = features.has_nearest(triangle, nearest);
                if is_nearest && (is_inside || nearest.feature == MeshFeature::Face) {
                    self.found.push(on);
                    return limit;
                }
                if is_nearest && on.patch == nearest_patch {
                    if reach == 0.0 && farthest.as_ref().is_none_or(|far| far.distance < height) {
                        farthest = Some(on);
                    }
                    return limit;
                }
                let (counts, valley) = match height > 0.0 {
                    true => (height >= least - rounding, VALLEY * range.depth.largest),
                    false => {
                        let above = normal.dot(nearest.point - face.corners[0]);
                        (is_inside && above >= -rounding, behind)
                    }
                };
                if counts {
                    on.beyond = face.beyond(place - height * normal, normal, valley) - rounding;
                    if on.beyond <= miss {
                        self.found.push(on);
                    }
                }
                limit
            },
        );
        self.found.extend(farthest);
        self.merge_planes();
    }

    /// Removes all but the deepest of the contacts with faces of a smooth patch that lie in one plane. Their number would change the smoothed maximum. Faces that
    /// the point misses are removed first.
    fn merge_planes(&mut self) {
        let key = |on: &OnMesh| (on.patch, on.beyond > 0.0);
        self.found.sort_by(|a, b| {
            let by_key = key(a).cmp(&key(b));
            by_key.then(a.distance.total_cmp(&b.distance))
        });
        let mut n_kept = 0;
        for place in 0..self.found.len() {
            let on = &self.found[place];
            let is_same = |other: &OnMesh| {
                other.patch == on.patch && (other.normal - on.normal).length() <= ONE_PLANE
            };
            if !self.found[..n_kept].iter().any(is_same) {
                self.found.swap(n_kept, place);
                n_kept += 1;
            }
        }
        self.found.truncate(n_kept);
    }

    /// Adds the edges and corners of a mesh that are nearer to a point than their faces, and nearer than `within` metres.
    fn touch_edges(&mut self, mesh: &MeshModel, place: DVec3, within: f64) {
        let features = mesh.features();
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
                        let flat = outer(normal, normal) + outer(edge.direction, edge.direction);
                        let part = features.edge_number(number);
                        self.found.push(OnMesh {
                            part,
                            patch: features.smooth_patch(part),
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
                            patch: features.smooth_patch(number as u32),
                            beyond: 0.0,
                            distance,
                            normal,
                            bending: (DMat3::IDENTITY - outer(normal, normal)) * (1.0 / distance),
                        });
                    }
                }
                limit
            },
        );
    }
}
