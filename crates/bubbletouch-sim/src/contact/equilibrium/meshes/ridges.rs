//! Contacts of the ridges of two meshes.
//!
//! Ridges touch where their nearest points are inside both, and the normal lies between the normals of the faces, outwards of both solids.

use super::super::algebra::{cross_matrix, outer};
use super::super::curvature::Curvature;
use super::found::{Found, MISS, Range};
use crate::geometry::{Aabb, Pose};
use crate::mesh::Edge;
use crate::objects::MeshModel;
use glam::{DMat3, DVec3};

/// Sine of the angle between two ridges below which they are parallel and their common normal is uncertain; corners then touch faces.
const PARALLEL: f64 = 1e-2;
/// Angle by which the normal of two ridges may be beyond the normals of their faces, radians. A ridge that lies on a face crosses both ridges of the face with the
/// face's normal; if smaller, rounding decides which of the two crossings counts.
const BEYOND: f64 = 1e-2;

/// Visits the contacts of `ridges` of the first mesh with the ridges of the second one.
pub(super) fn each_crossing(
    [(one, pose), (other, other_pose)]: [(&MeshModel, &Pose); 2],
    ridges: &[usize],
    range: Range,
    visit: &mut impl FnMut(Found),
) {
    let (features, others) = (one.features(), other.features());
    let reach = one.rounding() + other.rounding();
    let margin = reach + range.reach();
    let other_from_one = pose.seen_from(other_pose);
    let turn = DMat3::from_quat(other_from_one.rotation);
    let to_world = DMat3::from_quat(other_pose.rotation);
    for &number in ridges {
        let edge = &features.edges()[number];
        let placed = edge.moved(&turn, other_from_one.translation);
        let end = placed.from + placed.length * placed.direction;
        let region = Aabb {
            min: placed.from.min(end) - margin,
            max: placed.from.max(end) + margin,
        };
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
                let miss = MISS * range.depth.largest;
                let Some(crossing) = Crossing::new(&placed, other_edge, miss, is_outward) else {
                    continue;
                };
                let penetration = reach - crossing.gap;
                if penetration <= -range.gap || penetration > range.depth.searched {
                    continue;
                }
                // Ridges that cross without a rounding touch only if the way between them is inside both solids.
                if crossing.gap < 0.0 {
                    let middle = crossing.point - 0.5 * crossing.gap * crossing.normal;
                    let own_middle = turn.transpose() * (middle - other_from_one.translation);
                    if !is_inside(other, middle, margin) || !is_inside(one, own_middle, margin) {
                        continue;
                    }
                }
                let parts = [
                    features.edge_number(number),
                    others.edge_number(other_number),
                ];
                visit(Found {
                    parts,
                    identity: parts,
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
        let turn = outer(t.cross(m) / self.sine, m.cross(u));
        Curvature {
            gradient: -m,
            bending: DMat3::ZERO,
            turning: [-turn, turn - cross_matrix(m)],
        }
    }
}

/// Returns whether a point is inside the solid of a mesh and less than `within` metres from its surface.
fn is_inside(mesh: &MeshModel, place: DVec3, within: f64) -> bool {
    let nearest = mesh.bvh().closest(place, within);
    nearest.is_some_and(|nearest| mesh.features().is_inside(mesh.bvh(), place, &nearest))
}
