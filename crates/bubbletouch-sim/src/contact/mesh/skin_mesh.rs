//! Contact of a taxel with a mesh: the height at which the mesh stops the taxel as it moves up along its axis.

use crate::contact::law::{stop_in_front, triangle::stopping_height};
use crate::geometry::Pose;
use crate::mesh::Triangle;
use crate::objects::MeshModel;
use crate::objects::mesh_blocks::{LANES, vector};
use crate::world::{Node, PlacedTaxel};
use glam::{DMat3, DVec2, DVec3, Vec3};

/// Mesh at a pose, in the patch frame.
pub(crate) struct MeshAt<'a> {
    mesh: &'a MeshModel,
    pose: &'a Pose,
    rotation: DMat3,
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
    pub fn new(mesh: &'a MeshModel, pose: &'a Pose) -> Self {
        let rotation = DMat3::from_quat(pose.rotation);
        let bounds = mesh.bounds();
        Self {
            mesh,
            pose,
            rotation,
            center: pose.transform_point(bounds.center()),
            half: 0.5 * bounds.size(),
        }
    }

    /// Returns whether the mesh may push one of the taxels of a node. The condition is that the bounding box of the mesh overlaps the box around the taxels
    /// along each axis of both boxes.
    #[inline]
    pub fn is_near(&self, node: &Node) -> bool {
        let (away, reach) = (self.center - node.bounds.center(), node.reach());
        let half = 0.5 * node.bounds.size();
        let absolute = DMat3::from_cols(
            self.rotation.x_axis.abs(),
            self.rotation.y_axis.abs(),
            self.rotation.z_axis.abs(),
        );
        let along_patch = half + absolute * self.half + reach;
        let along_mesh = self.half + absolute.transpose() * half + reach;
        let in_mesh = self.rotation.transpose() * away;
        away.abs().cmple(along_patch).all() && in_mesh.abs().cmple(along_mesh).all()
    }

    /// Returns the mesh.
    #[inline(always)]
    pub fn model(&self) -> &'a MeshModel {
        self.mesh
    }

    /// Returns the rotation of the pose.
    #[inline(always)]
    pub fn rotation(&self) -> &DMat3 {
        &self.rotation
    }

    /// Returns the translation of the pose, metres.
    #[inline(always)]
    pub fn translation(&self) -> DVec3 {
        self.pose.translation
    }

    /// Returns a corner of the mesh that is among the lowest along a direction (unit vector), in the patch frame, metres. The corner is not always the lowest: the
    /// search follows the lowest bounding box of each level.
    pub fn low_corner(&self, direction: DVec3) -> DVec3 {
        let blocks = self.mesh.blocks();
        let along = (self.rotation.transpose() * direction).as_vec3();
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
        self.pose.transform_point(corner.as_dvec3() + blocks.center)
    }

    /// Returns the height at which one triangle stops a taxel, metres. Returns `None` if the triangle misses the taxel, or if a taxel on its far side would be
    /// behind the taxel's substrate.
    pub fn stop_in_front(&self, taxel: &PlacedTaxel, triangle: usize) -> Option<f64> {
        AxisView::new(self, taxel).stop(&self.mesh.mesh().triangle(triangle))
    }

    /// Returns the height at which one triangle stops a taxel, even if the triangle is behind the taxel's substrate. Returns `None` if the triangle misses
    /// the taxel.
    pub fn stop_by(&self, taxel: &PlacedTaxel, triangle: usize) -> Option<Stop> {
        let view = AxisView::new(self, taxel);
        let turned = view.turned(&self.mesh.mesh().triangle(triangle));
        let height = stopping_height(&turned, view.reach, DVec2::ZERO)?;
        Some(Stop { height, triangle })
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
        let view = AxisView::new(self, taxel);
        let beside = view.taxel.radius * BESIDE;
        let place = view.to_mesh(beside.extend(view.taxel.behind));
        let bounds = self.mesh.bvh().bounds();
        if place.cmplt(bounds.min).any() || place.cmpgt(bounds.max).any() {
            return None;
        }
        let up = view.up_in_mesh();
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
        let height = stopping_height(&view.turned(&triangle), view.reach, DVec2::ZERO)?;
        Some(Stop {
            height,
            triangle: number,
        })
    }
}

/// Transform from a mesh's frame to a taxel's frame: z along the taxel's axis, origin at the centre of the undeflected taxel.
struct AxisView<'a> {
    taxel: &'a PlacedTaxel,
    /// Sum of the taxel's radius and the rounding of the mesh, metres.
    reach: f64,
    rotation: DMat3,
    translation: DVec3,
}

impl<'a> AxisView<'a> {
    fn new(mesh: &MeshAt, taxel: &'a PlacedTaxel) -> Self {
        let [x, y] = taxel.across;
        let taxel_from_patch = DMat3::from_cols(x, y, taxel.axis).transpose();
        let rotation = taxel_from_patch * mesh.rotation;
        Self {
            taxel,
            reach: taxel.radius + mesh.mesh.rounding(),
            rotation,
            translation: taxel_from_patch * (mesh.pose.translation - taxel.center),
        }
    }

    fn turned(&self, triangle: &Triangle) -> Triangle {
        let place = |corner: DVec3| self.rotation * corner + self.translation;
        Triangle(triangle.0.map(place))
    }

    fn to_mesh(&self, place: DVec3) -> DVec3 {
        self.rotation.transpose() * (place - self.translation)
    }

    /// Returns the direction of the taxel's axis in the mesh's frame.
    fn up_in_mesh(&self) -> DVec3 {
        self.rotation.transpose() * DVec3::Z
    }

    /// Returns the height at which a triangle stops the taxel; `None` if the triangle misses the taxel or touches it only behind the substrate.
    fn stop(&self, triangle: &Triangle) -> Option<f64> {
        let turned = self.turned(triangle);
        stop_in_front(&turned, self.reach, DVec2::ZERO, self.taxel.behind)
    }
}
