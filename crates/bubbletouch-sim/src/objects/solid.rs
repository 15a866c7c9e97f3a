//! Solids: unions of shapes with poses, minus other shapes. The objects of the catalogue are solids.

use super::block::Block;
use super::fit::Fit;
use super::lathe::Lathe;
use super::prism::Prism;
use super::sphere_sweep::SphereSweep;
use super::surface_patch::SurfacePatch;
use super::torus::Torus;
use super::{Shape, Sphere};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, Pose};
use glam::{DVec2, DVec3};
use std::fmt::Debug;
use std::sync::Arc;

/// Part of a solid: a shape at a pose in the frame of the object.
#[derive(Clone, Debug)]
pub struct Part {
    shape: Shape,
    form: Arc<dyn Form>,
    /// Pose of the part in the frame of the object.
    pose: Pose,
}

/// Union of parts (shapes) minus other shapes. Invariant: there is at least one part.
#[derive(Clone, Debug)]
pub struct Solid {
    parts: Vec<Part>,
    /// Shapes that are subtracted from all parts.
    cuts: Vec<Part>,
    /// Distance by which the subtracted shapes are enlarged, metres.
    seam: f64,
}

/// Enlargement of the subtracted shapes, relative to the diagonal of the box around the parts. The enlargement removes membranes of zero thickness where a
/// subtracted shape ends in a part's surface. If smaller, rounding leaves such membranes; if larger, walls beside subtracted shapes become thinner.
const SEAM: f64 = 4e-6;

/// Basic form that represents a shape, in the frame of the shape; five basic forms represent all shapes.
pub(super) trait Form: Debug + Send + Sync {
    /// Returns the signed distance from a point to the surface, metres, negative inside. Inside, a lower bound of the depth may be returned.
    fn distance(&self, point: DVec3) -> f64;

    /// Returns the support function of the form: the largest p·direction over its points p, metres.
    fn support(&self, direction: DVec3) -> f64;

    /// Returns the volume of the form, m³, and its centroid, metres.
    fn volume_and_center(&self) -> (f64, DVec3);

    /// Adds spheres whose union approximates the form within the tolerances `fit`.
    fn pack(&self, fit: Fit, spheres: &mut Vec<Sphere>);

    /// Returns patches that cover the whole surface. Parts of patches may lie inside or outside the form.
    fn patches(&self) -> Vec<SurfacePatch>;

    /// Returns the smallest gap that a packing may leave, relative to the size of the form; with smaller gaps, rounding errors decide.
    fn min_reach(&self) -> f64 {
        0.0
    }
}

impl Part {
    /// Creates a part from a shape and its pose.
    ///
    /// # Errors
    /// If a dimension is out of range; the error names the first one.
    pub fn new(shape: Shape, pose: Pose) -> Result<Self> {
        shape.check()?;
        if !(pose.translation.is_finite() && pose.rotation.is_finite()) {
            let given = format!("{} and {}", pose.translation, pose.rotation);
            return Err(Error::input(
                "position and rotation",
                given,
                "finite numbers",
            ));
        }
        Ok(Self {
            form: form(&shape),
            shape,
            pose,
        })
    }

    /// Returns the shape of the part.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Returns the part with another shape at the same pose.
    pub(super) fn reshaped(&self, shape: Shape) -> Self {
        Self {
            form: form(&shape),
            shape,
            pose: self.pose,
        }
    }

    /// Returns the signed distance from a point in the object's frame to the part's surface, metres, negative inside.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.form
            .distance(self.pose.inverse().transform_point(point))
    }

    /// Returns the support function of the part in the object's frame: the largest p·direction over its points p, metres.
    fn support(&self, direction: DVec3) -> f64 {
        let inside = self.pose.rotation.conjugate() * direction;
        self.form.support(inside) + self.pose.translation.dot(direction)
    }

    /// Returns the exact bounding box of the part in the object's frame, metres.
    fn bounds(&self) -> Aabb {
        Aabb {
            min: -DVec3::from_array(DVec3::AXES.map(|axis| self.support(-axis))),
            max: DVec3::from_array(DVec3::AXES.map(|axis| self.support(axis))),
        }
    }

    /// Returns the volume of the part, m³, and its centroid in the object's frame, metres.
    pub(super) fn volume_and_center(&self) -> (f64, DVec3) {
        let (volume, center) = self.form.volume_and_center();
        (volume, self.pose.transform_point(center))
    }

    /// Returns whether rounding errors are small compared with the gaps that a packing with the tolerances `fit` may leave.
    pub(super) fn resolves(&self, fit: Fit) -> bool {
        fit.reach() >= self.form.min_reach() * self.bounds().size().length()
    }

    /// Returns spheres whose union approximates the part within the tolerances `fit`.
    pub(super) fn pack(&self, fit: Fit) -> Vec<Sphere> {
        let mut spheres = Vec::new();
        self.form.pack(fit, &mut spheres);
        for sphere in &mut spheres {
            sphere.center = self.pose.transform_point(sphere.center);
        }
        spheres
    }

    /// Returns patches that cover the whole surface of the part, in the object's frame.
    pub(super) fn patches(&self) -> Vec<SurfacePatch> {
        let patches = self.form.patches().into_iter();
        patches.map(|patch| patch.moved(&self.pose)).collect()
    }

    /// Returns points on the patches of the part's surface, including its corners and edges, at most about `spacing` (metres) apart.
    fn patch_points(&self, spacing: f64) -> Vec<DVec3> {
        let patches = self.patches().into_iter();
        patches.flat_map(|patch| patch.points(spacing)).collect()
    }
}

impl Solid {
    /// Creates a solid as the union of parts.
    ///
    /// # Errors
    /// If there are no parts.
    pub fn new(parts: Vec<Part>) -> Result<Self> {
        if parts.is_empty() {
            return Err(Error::input("solid", "no parts", "at least one part"));
        }
        Ok(Self {
            parts,
            cuts: Vec::new(),
            seam: 0.0,
        })
    }

    /// Returns this solid without the volume of the shapes `cuts`.
    ///
    /// # Errors
    /// If the cuts remove the whole surface of a part, as tested at points a hundredth of the part's size apart.
    pub fn less(self, cuts: Vec<Part>) -> Result<Self> {
        let seam = SEAM * self.bounds().size().length();
        let solid = Self { cuts, seam, ..self };
        let spacing = 1e-2 * solid.bounds().size().length();
        if solid.surface_points(spacing).is_empty() {
            let given = "shapes that take away all parts";
            let allowed = "shapes that leave something";
            return Err(Error::input("subtract", given, allowed));
        }
        Ok(solid)
    }

    /// Creates a solid of one shape in its own frame.
    ///
    /// # Errors
    /// If a dimension of the shape is out of range.
    pub fn from_shape(shape: Shape) -> Result<Self> {
        Self::new(vec![Part::new(shape, Pose::IDENTITY)?])
    }

    /// Returns the parts of the solid in the order in which they were given.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the subtracted shapes in the order in which they were given.
    pub fn cuts(&self) -> &[Part] {
        &self.cuts
    }

    /// Returns the signed distance from a point to the surface of the solid, metres, negative inside.
    ///
    /// Outside the solid, the distance is exact if no shapes are subtracted, otherwise a lower bound. Inside the solid, the depth is exact for a single part
    /// of any shape except a sphere sweep, otherwise a lower bound. Subtracted shapes are enlarged by 4 millionths of the diagonal of the bounding box.
    pub fn distance(&self, point: DVec3) -> f64 {
        nearest(&self.parts, point).max(self.seam - nearest(&self.cuts, point))
    }

    /// Returns the depth of a point (minus the signed distance), metres, with all subtracted shapes enlarged by `growth` (metres).
    pub(super) fn depth_with_cuts_grown(&self, point: DVec3, growth: f64) -> f64 {
        (-nearest(&self.parts, point)).min(nearest(&self.cuts, point) - growth)
    }

    /// Returns the exact bounding box of the parts, metres; subtracted shapes are ignored.
    pub fn bounds(&self) -> Aabb {
        let bounds = Aabb::around(self.parts.iter().map(Part::bounds));
        bounds.expect("a solid has at least one part")
    }

    /// Returns the solid after a rigid motion.
    pub fn moved(&self, motion: &Pose) -> Self {
        let mut solid = self.clone();
        for part in solid.parts.iter_mut().chain(&mut solid.cuts) {
            part.pose = motion.compose(&part.pose);
        }
        solid
    }

    /// Returns the solid, moved so that it rests on z = 0 with the middle of its bounding box on the z axis.
    pub fn resting(&self) -> Self {
        let bounds = self.bounds();
        let middle = bounds.center().truncate();
        self.moved(&Pose::from_translation(-middle.extend(bounds.min.z)))
    }

    /// Returns points on the surface of the solid, at most about `spacing` (metres) apart.
    pub fn surface_points(&self, spacing: f64) -> Vec<DVec3> {
        let rounding = 1e-9 * self.bounds().size().length();
        // Parts of a patch that lie inside or outside the union are not on its surface.
        let is_on = |parts: &[Part], p: DVec3| nearest(parts, p).abs() <= rounding;
        let points = self.parts.iter().flat_map(|p| p.patch_points(spacing));
        let of_parts =
            points.filter(|&p| is_on(&self.parts, p) && nearest(&self.cuts, p) > rounding);
        let points = self.cuts.iter().flat_map(|p| p.patch_points(spacing));
        let of_cuts =
            points.filter(|&p| is_on(&self.cuts, p) && nearest(&self.parts, p) < -rounding);
        of_parts.chain(of_cuts).collect()
    }
}

/// Returns the signed distance to the nearest of several parts, metres, negative inside a part; infinite if there are no parts.
fn nearest(parts: &[Part], point: DVec3) -> f64 {
    let distances = parts.iter().map(|part| part.distance(point));
    distances.fold(f64::INFINITY, f64::min)
}

fn form(shape: &Shape) -> Arc<dyn Form> {
    match *shape {
        Shape::Ball { diameter } => Arc::new(SphereSweep::new(&[DVec3::ZERO], &[diameter])),
        Shape::Box { size, rounding } => Arc::new(Block {
            half: 0.5 * size,
            rounding,
        }),
        Shape::Cylinder { diameter, height } => {
            Arc::new(Lathe::frustum(diameter, diameter, height))
        }
        Shape::Capsule { diameter, length } => {
            let end = DVec3::Z * 0.5 * (length - diameter);
            Arc::new(match end == DVec3::ZERO {
                true => SphereSweep::new(&[end], &[diameter]),
                false => SphereSweep::new(&[-end, end], &[diameter, diameter]),
            })
        }
        Shape::ConeFrustum {
            bottom_diameter,
            top_diameter,
            height,
        } => Arc::new(Lathe::frustum(bottom_diameter, top_diameter, height)),
        Shape::Torus {
            ring_diameter,
            tube_diameter,
        } => Arc::new(Torus {
            ring: 0.5 * ring_diameter,
            tube: 0.5 * tube_diameter,
        }),
        Shape::Tube {
            outer_diameter,
            inner_diameter,
            height,
        } => {
            let (outer, inner, top) = (0.5 * outer_diameter, 0.5 * inner_diameter, 0.5 * height);
            let corners = [[inner, -top], [outer, -top], [outer, top], [inner, top]];
            Arc::new(Lathe::new(&corners.map(DVec2::from)))
        }
        Shape::Lathe { ref profile } => Arc::new(Lathe::new(profile)),
        Shape::HexagonalPrism {
            across_flats,
            height,
        } => {
            let corner = across_flats / 3f64.sqrt();
            let corners = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
                .map(|k| corner * DVec2::from_angle(k * std::f64::consts::FRAC_PI_3));
            Arc::new(Prism::new(&corners, height))
        }
        Shape::Prism {
            ref outline,
            thickness,
        } => Arc::new(Prism::new(outline, thickness)),
        Shape::SphereSweep {
            ref points,
            ref diameters,
        } => Arc::new(SphereSweep::new(points, diameters)),
    }
}
