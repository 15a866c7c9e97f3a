//! Contact of a taxel with a mesh: the height at which the mesh stops the taxel as it moves up along its axis.

use super::swept_triangle::stopping_height;
use crate::contact::law;
use crate::geometry::{Aabb, Pose};
use crate::mesh::Triangle;
use crate::objects::MeshModel;
use crate::world::PlacedTaxel;
use glam::{DMat3, DVec2, DVec3};

/// Mesh at a pose, in the patch frame.
pub(crate) struct MeshAt<'a> {
    mesh: &'a MeshModel,
    pose: &'a Pose,
    rotation: DMat3,
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
        Self {
            mesh,
            pose,
            rotation,
        }
    }

    /// Returns a bounding ball of the mesh in the patch frame: centre and radius, metres.
    pub fn ball(&self) -> (DVec3, f64) {
        let bounds = self.mesh.bounds();
        let radius = 0.5 * bounds.size().length();
        (self.pose.transform_point(bounds.center()), radius)
    }

    /// Returns the height and the triangle at which the mesh stops a taxel; `None` if the mesh does not push the taxel.
    ///
    /// If several triangles stop the taxel at equal heights, the choice among them is arbitrary but reproducible.
    pub fn stop(&self, taxel: &PlacedTaxel) -> Option<Stop> {
        let view = AxisView::new(self, taxel);
        let mut found = None;
        self.mesh.bvh().search(
            0.0,
            |bounds| view.lowest(bounds),
            |number, triangle, limit| match view.stop(triangle) {
                Some(height) if height < limit => {
                    found = Some(Stop {
                        height,
                        triangle: number,
                    });
                    height
                }
                _ => limit,
            },
        );
        // A taxel at its stroke stays there, even if the mesh reaches further.
        match found {
            Some(stop) if stop.height < taxel.behind + taxel.radius => found,
            _ => self.entered(&view).or(found),
        }
    }

    /// Returns the height at which one triangle stops a taxel, even if the triangle is behind the taxel's substrate; `None` if the triangle misses the taxel.
    pub fn stop_by(&self, taxel: &PlacedTaxel, triangle: usize) -> Option<Stop> {
        let view = AxisView::new(self, taxel);
        let turned = view.turned(&self.mesh.mesh().triangle(triangle));
        let height = stopping_height(&turned, view.reach, DVec2::ZERO)?;
        Some(Stop { height, triangle })
    }

    /// Returns the height at which the mesh stops a taxel of a flat grid whose substrate is inside the solid mesh; `None` if the substrate is outside.
    /// The taxel has its centre at `center`, and its substrate at height `behind`. All lengths are in metres.
    pub fn entered_on_grid(&self, center: DVec3, radius: f64, behind: f64) -> Option<f64> {
        let taxel = PlacedTaxel {
            number: 0,
            center,
            across: [DVec3::X, DVec3::Y],
            axis: DVec3::Z,
            radius,
            behind,
        };
        let stop = self.entered(&AxisView::new(self, &taxel))?;
        Some(stop.height)
    }

    /// Returns where a taxel's axis enters the mesh, if the taxel's substrate is inside the solid mesh; otherwise `None`.
    pub fn entered_by(&self, taxel: &PlacedTaxel) -> Option<Stop> {
        self.entered(&AxisView::new(self, taxel))
    }

    /// Returns the triangle through which a taxel's axis enters the mesh, if the taxel's substrate is inside the solid mesh. In that case the nearest
    /// triangle behind the substrate faces outwards, and the nearest triangle ahead shows its inner side.
    fn entered(&self, view: &AxisView) -> Option<Stop> {
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
    /// Absolute values of the rotation matrix, which give the half-size of a rotated bounding box.
    absolute: DMat3,
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
            absolute: DMat3::from_cols(
                rotation.x_axis.abs(),
                rotation.y_axis.abs(),
                rotation.z_axis.abs(),
            ),
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

    /// Returns a lower bound of the heights at which a triangle in a bounding box stops the taxel. The bound is infinite if no triangle can stop it, or only
    /// triangles behind the substrate.
    fn lowest(&self, bounds: &Aabb) -> f64 {
        let center = self.rotation * bounds.center() + self.translation;
        let half = self.absolute * (0.5 * bounds.size()) + self.reach;
        let is_beside = center.x.abs() > half.x || center.y.abs() > half.y;
        if is_beside || center.z + half.z < self.taxel.behind {
            return f64::INFINITY;
        }
        center.z - half.z
    }

    /// Returns the height at which a triangle stops the taxel; `None` if the triangle misses the taxel or touches it only behind the substrate.
    fn stop(&self, triangle: &Triangle) -> Option<f64> {
        let turned = self.turned(triangle);
        stop_in_front(&turned, self.reach, DVec2::ZERO, self.taxel.behind)
    }
}

/// Returns the height at which a triangle stops a taxel with the radius `reach` at the position `at`, metres.
///
/// Returns `None` if the triangle misses the taxel, or if a taxel on its far side would be behind the substrate at height `behind`, metres.
pub(crate) fn stop_in_front(
    triangle: &Triangle,
    reach: f64,
    at: DVec2,
    behind: f64,
) -> Option<f64> {
    let height = stopping_height(triangle, reach, at)?;
    if law::reaches_front(height, behind) {
        return Some(height);
    }
    // Height of the far side: the highest place of contact for a taxel that moves down from above.
    let mirrored = Triangle(triangle.0.map(|v| DVec3::new(v.x, v.y, -v.z)));
    let highest = -stopping_height(&mirrored, reach, at)?;
    law::reaches_front(highest, behind).then_some(height)
}
