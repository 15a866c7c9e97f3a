//! Contact of a taxel with a mesh: the height at which the mesh stops the taxel as it moves up along its axis.

use crate::contact::law::{stop_in_front, triangle::stopping_height};
use crate::contact::object_at::ObjectAt;
use crate::geometry::Pose;
use crate::mesh::Triangle;
use crate::objects::MeshModel;
use crate::objects::mesh_blocks::{LANES, vector};
use crate::world::{Node, PlacedTaxel};
use glam::{DMat3, DVec2, DVec3, Vec3, Vec3Swizzles};

/// Mesh at a pose, in the patch frame.
pub(crate) struct MeshAt<'a> {
    pub mesh: &'a MeshModel,
    /// Pose of the mesh, enlarged by its rounding.
    pub object: ObjectAt,
    /// Centre of the mesh's bounding box in the patch frame, and half of its sizes in its own frame, metres.
    center: DVec3,
    half: DVec3,
}

/// Height at which a mesh stops a taxel, and the triangle that stops the taxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stop {
    /// Height of the taxel's centre along its axis, relative to the centre of the undeflected taxel, metres; negative.
    pub height: f64,
    /// Index of the triangle in the mesh.
    pub triangle: usize,
}

/// Distance from the taxel's axis, in radii of the taxel, of the ray that tests whether the substrate is inside a mesh. Diagonals of boxes often lie on the
/// axes of grids, and a ray along an edge hits both of its triangles or none.
const BESIDE: DVec2 = DVec2::new(0.011, 0.007);

impl<'a> MeshAt<'a> {
    pub fn new(mesh: &'a MeshModel, pose: &Pose) -> Self {
        let object = ObjectAt::new(pose, mesh.rounding());
        let bounds = mesh.bounds();
        Self {
            mesh,
            object,
            center: object.place(bounds.center()),
            half: 0.5 * bounds.size(),
        }
    }

    /// Returns whether the mesh may push one of the taxels of a node. The condition is that the bounding box of the mesh overlaps the box around the taxels
    /// along each axis of both boxes.
    #[inline]
    pub fn is_near(&self, node: &Node) -> bool {
        let (away, reach) = (self.center - node.bounds.center(), node.reach());
        let half = 0.5 * node.bounds.size();
        let rotation = &self.object.rotation;
        let absolute = rotation.abs();
        let along_patch = half + absolute * self.half + reach;
        let along_mesh = self.half + absolute.transpose() * half + reach;
        let in_mesh = rotation.transpose() * away;
        away.abs().cmple(along_patch).all() && in_mesh.abs().cmple(along_mesh).all()
    }

    /// Returns a corner of the mesh that is among the lowest along a direction (unit vector), in the patch frame, metres. The corner is not always the lowest: the
    /// search follows the lowest bounding box of each level.
    pub fn low_corner(&self, direction: DVec3) -> DVec3 {
        let blocks = self.mesh.blocks();
        let along = (self.object.rotation.transpose() * direction).as_vec3();
        let used = |used: u32| (0..LANES).filter(move |k| used >> k & 1 == 1);
        let lowest = |a: (f32, u32), b: (f32, u32)| if b.0 < a.0 { b } else { a };
        let mut child = 0;
        while child % 2 == 0 {
            let node = &blocks.nodes[(child / 2) as usize];
            let bottoms = used(node.used).map(|k| {
                let half = vector(&node.half, k).dot(along.abs());
                (vector(&node.center, k).dot(along) - half, node.children[k])
            });
            (_, child) = bottoms.fold((f32::INFINITY, 1), lowest);
        }
        let block = &blocks.blocks[(child / 2) as usize];
        let corners = used(block.used).flat_map(|k| block.corners.map(|corner| vector(&corner, k)));
        let low = |a: Vec3, b: Vec3| if b.dot(along) < a.dot(along) { b } else { a };
        let corner = corners.reduce(low).unwrap_or(Vec3::ZERO);
        self.object.place(corner.as_dvec3() + blocks.center)
    }

    /// Returns the height at which one triangle stops a taxel, metres. Returns `None` if the triangle misses the taxel, or if a taxel on its far side would be
    /// behind the taxel's substrate.
    pub fn stop_in_front(&self, taxel: &PlacedTaxel, triangle: usize) -> Option<f64> {
        let seen = self.triangle_seen_by(taxel, triangle);
        stop_in_front(&seen, self.reach(taxel), DVec2::ZERO, taxel.behind)
    }

    /// Returns the height at which one triangle stops a taxel, metres, even if the triangle is behind the taxel's substrate. Returns `None` if the triangle
    /// misses the taxel.
    pub fn stop_by(&self, taxel: &PlacedTaxel, triangle: usize) -> Option<f64> {
        let seen = self.triangle_seen_by(taxel, triangle);
        stopping_height(&seen, self.reach(taxel), DVec2::ZERO)
    }

    /// Returns whether the mesh may have parts behind the substrate of a taxel. The test uses the bounding box of the mesh.
    pub fn may_be_behind(&self, taxel: &PlacedTaxel) -> bool {
        let height = (self.center - taxel.center).dot(taxel.axis);
        let axis = self.object.rotation.transpose() * taxel.axis;
        height - axis.abs().dot(self.half) < taxel.behind
    }

    /// Returns the triangles that have a corner in common with a triangle, which is one of them.
    pub fn around(&self, triangle: usize) -> Vec<u32> {
        let middle = self.mesh.mesh().triangle(triangle);
        let mut around = Vec::new();
        self.mesh
            .bvh()
            .each_in_box(&middle.bounds(), |number, other| {
                if other.0.iter().any(|corner| middle.0.contains(corner)) {
                    around.push(number as u32);
                }
            });
        around
    }

    /// Returns the height, metres, of the point of a triangle's edges that is nearest to a taxel's axis.
    pub fn nearest_height(&self, taxel: &PlacedTaxel, triangle: usize) -> f64 {
        let Triangle([a, b, c]) = self.triangle_seen_by(taxel, triangle);
        let nearest = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            let along = to.xy() - from.xy();
            let part = -from.xy().dot(along) / along.length_squared();
            from.lerp(to, part.clamp(0.0, 1.0))
        });
        let distance2 = |point: &DVec3| point.xy().length_squared();
        let nearest = nearest
            .into_iter()
            .min_by(|a, b| distance2(a).total_cmp(&distance2(b)));
        nearest.expect("a triangle has edges").z
    }

    /// Returns the triangle nearest to a taxel's centre at a height, metres, if the distance is less than `factor` times the distance of touch.
    pub fn overlapping(&self, taxel: &PlacedTaxel, height: f64, factor: f64) -> Option<usize> {
        let place = self.object.unplace(taxel.center + height * taxel.axis);
        let within = factor * self.reach(taxel);
        Some(self.mesh.bvh().closest(place, within)?.triangle)
    }

    /// Returns the height at which the mesh stops a taxel of a flat grid whose substrate is inside the solid mesh. Returns `None` if the substrate is
    /// outside. The taxel has its centre at `center`, and its substrate at height `behind`. All lengths are in metres.
    pub fn entered_on_grid(&self, center: DVec3, radius: f64, behind: f64) -> Option<f64> {
        let taxel = PlacedTaxel {
            number: 0,
            center,
            across: [DVec3::X, DVec3::Y],
            axis: DVec3::Z,
            radius,
            behind,
        };
        let stop = self.entered(&taxel)?;
        Some(stop.height)
    }

    /// Returns the triangle through which a taxel's axis enters the mesh, if the taxel's substrate is inside the solid mesh. In that case the nearest
    /// triangle behind the substrate faces outwards, and the nearest triangle ahead shows its inner side.
    pub fn entered(&self, taxel: &PlacedTaxel) -> Option<Stop> {
        let view = self.seen_by(taxel);
        let beside = taxel.radius * BESIDE;
        let place = view.unplace(beside.extend(taxel.behind));
        let bounds = self.mesh.bvh().bounds();
        if place.cmplt(bounds.min).any() || place.cmpgt(bounds.max).any() {
            return None;
        }
        let up = view.rotation.transpose() * DVec3::Z;
        let first = |direction| {
            let hit = self
                .mesh
                .bvh()
                .first_hit(place, direction, 0.0..f64::INFINITY)?;
            let triangle = self.mesh.mesh().triangle(hit.triangle);
            let rise = triangle.normal()?.dot(up);
            Some((hit.triangle, triangle, rise))
        };
        let (_, _, rise_ahead) = first(up)?;
        let (number, triangle, rise_behind) = first(-up)?;
        if rise_ahead <= 0.0 || rise_behind >= 0.0 {
            return None;
        }
        let height = stopping_height(&view.triangle(&triangle), self.reach(taxel), DVec2::ZERO)?;
        Some(Stop {
            height,
            triangle: number,
        })
    }

    /// Returns the distance of a taxel's centre from the triangles when the taxel touches the mesh, metres.
    fn reach(&self, taxel: &PlacedTaxel) -> f64 {
        taxel.radius + self.object.reach
    }

    /// Returns a triangle of the mesh in the frame of a taxel.
    fn triangle_seen_by(&self, taxel: &PlacedTaxel, triangle: usize) -> Triangle {
        let triangle = self.mesh.mesh().triangle(triangle);
        self.seen_by(taxel).triangle(&triangle)
    }

    /// Returns the mesh in the frame of a taxel: z along the taxel's axis, origin at the centre of the undeflected taxel.
    fn seen_by(&self, taxel: &PlacedTaxel) -> ObjectAt {
        let [x, y] = taxel.across;
        let taxel_from_patch = DMat3::from_cols(x, y, taxel.axis).transpose();
        ObjectAt {
            rotation: taxel_from_patch * self.object.rotation,
            translation: taxel_from_patch * (self.object.translation - taxel.center),
            reach: self.object.reach,
        }
    }
}
