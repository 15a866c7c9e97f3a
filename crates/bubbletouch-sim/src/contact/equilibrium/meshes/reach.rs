//! Deflection of one taxel by the faces, edges and corners of a mesh, with derivatives with respect to the motion of the mesh.
//!
//! The ball of a taxel stops with its centre c on a part of the mesh at the distance r (radius of the taxel plus rounding of the mesh). Let d be the unit
//! vector from the touched point to c, and n the axis of the taxel. A rigid motion of the mesh moves its material point at c by w, and turns the mesh by θ.
//! With `g = −d / (d·n)` and `P = 1 + n gᵀ`, the deflection changes by
//!
//! ```text
//! g·w + ½ g·(θ × (θ × a)) + θ·(g × P w) − ½ (P w)ᵀ K (P w) / |d·n|
//! ```
//!
//! up to second order, where a is the vector from the centre of mass to c. K is the second derivative of the distance from the part: zero for a face, and
//! `(1 − d dᵀ − t tᵀ) / r` for an edge along t. A corner is a sphere without radius ([`Reach`]).

use super::super::algebra::{cross_matrix, outer};
use super::super::curvature::Curvature;
use super::super::reach::Reach;
use crate::contact::law;
use crate::contact::mesh::skin_mesh::MeshAt;
use crate::contact::taxel_contact::GRAZING;
use crate::geometry::Pose;
use crate::mesh::{Edge, Face, MeshFeatures, Triangle};
use crate::objects::MeshModel;
use crate::world::PlacedTaxel;
use glam::{DMat3, DVec2, DVec3};

/// Relative allowance for rounding in the test whether the touched point is inside a face or on an edge. If smaller, a point on the border of two parts can
/// belong to neither.
const ROUNDING: f64 = 1e-9;

/// Deflection of one taxel by one part of a mesh; vectors are in the patch frame.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact::equilibrium) struct MeshReach {
    /// Number of the part among the parts of the mesh.
    pub part: u32,
    /// Deflection that contact with the part requires, metres; negative if the part does not touch the taxel yet.
    pub deflection: f64,
    /// Centre of the stopped taxel, or the corner that stops it, metres.
    pub center: DVec3,
    /// Derivatives of the deflection.
    pub curvature: Curvature,
    pub is_grazing: bool,
    /// Whether the part is behind the taxel's substrate.
    pub is_behind: bool,
}

/// Mesh at a pose in the frame of a patch.
pub(in crate::contact::equilibrium) struct MeshOnSkin<'a> {
    mesh: MeshAt<'a>,
    features: &'a MeshFeatures,
}

/// Taxel in the frame of a mesh.
struct Probe {
    taxel: PlacedTaxel,
    /// Distance of the stopped taxel's centre from the triangles, metres.
    reach: f64,
    /// Height along the axis below which a part is behind the substrate, metres.
    floor: f64,
    /// Distance that the parts of the mesh may move, metres.
    motion: f64,
}

/// Part of a mesh that stops a taxel; vectors are in the frame of the mesh.
struct Stop {
    deflection: f64,
    center: DVec3,
    curvature: Curvature,
    is_grazing: bool,
}

impl<'a> MeshOnSkin<'a> {
    pub fn new(model: &'a MeshModel, pose: &Pose) -> Self {
        Self {
            mesh: MeshAt::new(model, pose),
            features: model.features(),
        }
    }

    /// Visits the parts that push a taxel or can push it after a motion of `motion` metres. Parts whose deflections are less than the largest one by more than
    /// `window` metres may be omitted.
    pub fn each(
        &self,
        taxel: &PlacedTaxel,
        (motion, window): (f64, f64),
        mut visit: impl FnMut(&MeshReach),
    ) {
        let probe = self.probe(taxel, motion);
        let (p, n) = (probe.taxel.center, probe.taxel.axis);
        let margin = probe.reach + motion - GRAZING * probe.taxel.behind;
        let lowest = probe.floor - probe.reach - motion;
        let limit = motion * (1.0 + 1.0 / GRAZING);
        self.mesh.mesh.bvh().search(
            limit,
            |bounds| bounds.widened(margin).entry(p, n, lowest),
            |triangle, _, mut limit| {
                self.each_part(triangle, &probe, |part, stop| {
                    let height = -stop.deflection;
                    if height >= limit {
                        return;
                    }
                    let is_behind = height < probe.floor && self.is_behind(triangle, &probe);
                    if !is_behind {
                        limit = limit.min(height + window);
                    }
                    visit(&self.in_patch(part, &stop, is_behind));
                });
                limit
            },
        );
    }

    fn probe(&self, taxel: &PlacedTaxel, motion: f64) -> Probe {
        let MeshAt { mesh, object, .. } = &self.mesh;
        let back = object.rotation.transpose();
        let placed = PlacedTaxel {
            center: back * (taxel.center - object.translation),
            across: taxel.across.map(|across| back * across),
            axis: back * taxel.axis,
            ..*taxel
        };
        // A taxel whose substrate is inside the mesh is pushed by the surface through which its axis enters.
        let substrate = placed.center + taxel.behind * placed.axis;
        let may_be_inside = mesh.bounds().distance_squared(substrate) == 0.0;
        let entered = match may_be_inside {
            true => self.mesh.entered(taxel),
            false => None,
        };
        let reach = taxel.radius + object.reach;
        Probe {
            taxel: placed,
            reach,
            floor: entered.map_or(taxel.behind, |stop| stop.height - 1e-6 * reach),
            motion,
        }
    }

    fn each_part(&self, triangle: usize, probe: &Probe, mut visit: impl FnMut(u32, Stop)) {
        let features = self.features;
        let face = features.face(triangle);
        if let Some(stop) = probe.face(face) {
            visit(features.face_number(triangle), stop);
        }
        for edge in features.own_edges(triangle) {
            let is_nearest = |d| features.edge_is_nearest(edge, d);
            if let Some(stop) = probe.edge(&features.edges()[edge], is_nearest) {
                visit(features.edge_number(edge), stop);
            }
        }
        for corner in features.own_corners(triangle) {
            let is_nearest = |d| features.corner_is_nearest(corner, d);
            if let Some(stop) = probe.corner(features.corners()[corner], is_nearest) {
                visit(corner as u32, stop);
            }
        }
    }

    /// Returns whether a taxel on the far side of a triangle would be behind its substrate.
    fn is_behind(&self, triangle: usize, probe: &Probe) -> bool {
        let [x, y] = probe.taxel.across;
        let corners = self.features.face(triangle).corners.map(|corner| {
            let from = corner - probe.taxel.center;
            DVec3::new(from.dot(x), from.dot(y), from.dot(probe.taxel.axis))
        });
        let far_side = law::far_side(&Triangle(corners), probe.reach, DVec2::ZERO);
        !far_side.is_some_and(|far_side| law::reaches_front(far_side, probe.floor))
    }

    fn in_patch(&self, part: u32, stop: &Stop, is_behind: bool) -> MeshReach {
        MeshReach {
            part,
            deflection: stop.deflection,
            center: self.mesh.object.place(stop.center),
            curvature: stop.curvature.turned(&self.mesh.object.rotation),
            is_grazing: stop.is_grazing,
            is_behind,
        }
    }
}

impl Probe {
    fn face(&self, face: &Face) -> Option<Stop> {
        let PlacedTaxel { center, axis, .. } = self.taxel;
        let outward = face.normal?;
        let along = outward.dot(axis);
        // A steeper face is replaced by the flanks of its edges, whose slope is bounded.
        if along.abs() < GRAZING {
            return None;
        }
        let d = if along > 0.0 { -outward } else { outward };
        let height = (self.reach + d.dot(face.corners[0] - center)) / -along.abs();
        let stopped = center + height * axis;
        let foot = stopped - self.reach * d;
        let slack = ROUNDING * self.reach;
        (face.beyond(foot, outward, 0.0) <= slack)
            .then(|| self.stop(-height, stopped, d, DMat3::ZERO))?
    }

    fn edge(&self, edge: &Edge, is_nearest: impl Fn(DVec3) -> bool) -> Option<Stop> {
        let PlacedTaxel { center, axis, .. } = self.taxel;
        let (t, r) = (edge.direction, self.reach);
        let from = edge.from - center;
        let upward = axis - axis.dot(t) * t;
        let cosine = upward.length();
        // The axis is along the edge; the corner at the end stops the taxel.
        if cosine < GRAZING {
            return None;
        }
        let upward = upward / cosine;
        let from_line = from - from.dot(t) * t;
        let height = from_line.dot(upward);
        let beside = from_line - height * upward;
        let b = beside.length();
        let (q, least) = (r * r - b * b, GRAZING * r);
        let is_flank = q < least * least;
        let (up, d) = if is_flank {
            let border = r * (1.0 - GRAZING * GRAZING).sqrt();
            let up = least - (b - border) * border / least;
            (up, -(beside / b * border + least * upward) / r)
        } else {
            let up = q.sqrt();
            (up, -(beside + up * upward) / r)
        };
        let deflection = (up - height) / cosine;
        let place = -deflection * axis.dot(t) - from.dot(t);
        if !edge.range().contains(&place) || !is_nearest(d) {
            return None;
        }
        let bending = match is_flank {
            true => DMat3::ZERO,
            false => (DMat3::IDENTITY - outer(d, d) - outer(t, t)) * (1.0 / r),
        };
        let stopped = edge.from + place * t + r * d;
        let mut stop = self.stop(deflection, stopped, d, bending)?;
        stop.is_grazing |= is_flank;
        Some(stop)
    }

    fn corner(&self, corner: DVec3, is_nearest: impl Fn(DVec3) -> bool) -> Option<Stop> {
        let rounding = self.reach - self.taxel.radius;
        let reach = Reach::new(corner, rounding, &self.taxel, self.motion)?;
        let found = reach.derivatives();
        is_nearest(found.gradient.normalize()).then_some(Stop {
            deflection: reach.deflection,
            center: corner,
            curvature: found,
            is_grazing: reach.is_grazing(),
        })
    }

    /// Returns the stop at a face or an edge, whose distance from a point has the second derivative `bending`. Returns `None` if the part does not push the
    /// taxel and cannot push it after the allowed motion.
    fn stop(&self, deflection: f64, center: DVec3, d: DVec3, bending: DMat3) -> Option<Stop> {
        let axis = self.taxel.axis;
        let cosine = -d.dot(axis);
        if cosine <= 0.0 {
            return None;
        }
        let gradient = d / cosine;
        let slid = DMat3::IDENTITY + outer(axis, gradient);
        (deflection + self.motion * (1.0 + gradient.length()) > 0.0).then(|| Stop {
            deflection,
            center,
            curvature: Curvature {
                gradient,
                bending: slid.transpose() * bending * slid * (-1.0 / cosine),
                turning: [cross_matrix(gradient) * slid, DMat3::ZERO],
            },
            is_grazing: cosine < GRAZING,
        })
    }
}
