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

/// Part of a solid: a shape at a pose in the frame of the object.
#[derive(Clone, Debug)]
pub struct Part {
    shape: Shape,
    kernel: Kernel,
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

/// Basic form that represents a shape; five basic forms represent all shapes.
#[derive(Clone, Debug)]
pub(super) enum Kernel {
    Block(Block),
    Lathe(Lathe),
    Prism(Prism),
    Torus(Torus),
    SphereSweep(SphereSweep),
}

/// Smallest gap that a packing of a solid of revolution may leave, relative to its size. Intervals on its edges have an accuracy of 1e-9 of an edge. The rim
/// of a sharp edge reaches the limit of spheres long before. If larger, fine packings are rejected; if smaller, edges count as covered although no sphere
/// covers them.
const MIN_REACH: f64 = 1e-8;

impl Part {
    /// Creates a part from a shape and its pose.
    ///
    /// # Errors
    /// If a dimension is out of range; the error names the first one.
    pub fn new(shape: Shape, pose: Pose) -> Result<Self> {
        shape.check()?;
        if !(pose.translation.is_finite() && pose.rotation.is_finite()) {
            return Err(Error::input(
                "position and rotation",
                format!("{} and {}", pose.translation, pose.rotation),
                "finite numbers",
            ));
        }
        let kernel = kernel(&shape);
        Ok(Self {
            shape,
            kernel,
            pose,
        })
    }

    /// Returns the shape of the part.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Returns the basic form of the part.
    pub(super) fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    /// Returns the pose of the part in the frame of the object.
    pub(super) fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Returns the part with another shape at the same pose.
    pub(super) fn reshaped(&self, shape: Shape) -> Self {
        Self {
            kernel: kernel(&shape),
            shape,
            pose: self.pose,
        }
    }

    /// Returns the signed distance from a point in the object's frame to the part's surface, metres, negative inside.
    pub fn distance(&self, point: DVec3) -> f64 {
        let point = self.pose.inverse().transform_point(point);
        match &self.kernel {
            Kernel::Block(block) => block.distance(point),
            Kernel::Lathe(lathe) => lathe.distance(point),
            Kernel::Prism(prism) => prism.distance(point),
            Kernel::Torus(torus) => torus.distance(point),
            Kernel::SphereSweep(sweep) => sweep.distance(point),
        }
    }

    /// Returns the support function of the part in the object's frame: the largest p·direction over its points p, metres.
    fn support(&self, direction: DVec3) -> f64 {
        let inside = self.pose.rotation.conjugate() * direction;
        let support = match &self.kernel {
            Kernel::Block(block) => block.support(inside),
            Kernel::Lathe(lathe) => lathe.support(inside),
            Kernel::Prism(prism) => prism.support(inside),
            Kernel::Torus(torus) => torus.support(inside),
            Kernel::SphereSweep(sweep) => sweep.support(inside),
        };
        support + self.pose.translation.dot(direction)
    }

    /// Returns whether rounding errors are small compared with the gaps that a packing with the tolerances `fit` may leave.
    pub(super) fn resolves(&self, fit: Fit) -> bool {
        let along = |axis: DVec3| self.support(axis) + self.support(-axis);
        let size = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)).length();
        !matches!(self.kernel, Kernel::Lathe(_)) || fit.reach() >= MIN_REACH * size
    }

    /// Returns spheres whose union approximates the part within the tolerances `fit`.
    pub(super) fn pack(&self, fit: Fit) -> Vec<Sphere> {
        let mut spheres = Vec::new();
        match &self.kernel {
            Kernel::Block(block) => block.pack(fit, &mut spheres),
            Kernel::Lathe(lathe) => lathe.pack(fit, &mut spheres),
            Kernel::Prism(prism) => prism.pack(fit, &mut spheres),
            Kernel::Torus(torus) => torus.pack(fit, &mut spheres),
            Kernel::SphereSweep(sweep) => sweep.pack(fit, &mut spheres),
        }
        for sphere in &mut spheres {
            sphere.center = self.pose.transform_point(sphere.center);
        }
        spheres
    }

    /// Returns patches that cover the whole surface of the part, in the object's frame.
    pub(super) fn patches(&self) -> Vec<SurfacePatch> {
        let patches = match &self.kernel {
            Kernel::Block(block) => block.patches(),
            Kernel::Lathe(lathe) => lathe.patches(),
            Kernel::Prism(prism) => prism.patches(),
            Kernel::Torus(torus) => torus.patches(),
            Kernel::SphereSweep(sweep) => sweep.patches(),
        };
        let moved = patches.into_iter().map(|patch| patch.moved(&self.pose));
        moved.collect()
    }

    /// Returns points on the part's surface, including its corners and edges, at most about `spacing` (metres) apart.
    fn surface_points(&self, spacing: f64) -> Vec<DVec3> {
        let mut points = Vec::new();
        match &self.kernel {
            Kernel::Block(block) => block.surface_points(spacing, &mut points),
            Kernel::Lathe(lathe) => lathe.surface_points(spacing, &mut points),
            Kernel::Prism(prism) => prism.surface_points(spacing, &mut points),
            Kernel::Torus(torus) => torus.surface_points(spacing, &mut points),
            Kernel::SphereSweep(sweep) => sweep.surface_points(spacing, &mut points),
        }
        for point in &mut points {
            *point = self.pose.transform_point(*point);
        }
        points
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
        if solid
            .surface_points(1e-2 * solid.bounds().size().length())
            .is_empty()
        {
            let given = "shapes that take away all parts";
            return Err(Error::input(
                "subtract",
                given,
                "shapes that leave something",
            ));
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
        let support = |direction: DVec3| {
            let supports = self.parts.iter().map(|part| part.support(direction));
            supports.fold(f64::NEG_INFINITY, f64::max)
        };
        Aabb {
            min: -DVec3::new(
                support(DVec3::NEG_X),
                support(DVec3::NEG_Y),
                support(DVec3::NEG_Z),
            ),
            max: DVec3::new(support(DVec3::X), support(DVec3::Y), support(DVec3::Z)),
        }
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
        // A point of a part's surface inside another part, or inside its own sphere sweep, is not on the surface.
        let rounding = 1e-9 * self.bounds().size().length();
        let points = self.parts.iter().flat_map(|p| p.surface_points(spacing));
        let of_parts = points
            .filter(|&p| nearest(&self.parts, p) >= -rounding && nearest(&self.cuts, p) > rounding);
        let points = self.cuts.iter().flat_map(|p| p.surface_points(spacing));
        let of_cuts = points.filter(|&p| {
            nearest(&self.cuts, p) >= -rounding && nearest(&self.parts, p) < -rounding
        });
        of_parts.chain(of_cuts).collect()
    }
}

/// Returns the signed distance to the nearest of several parts, metres, negative inside a part; infinite if there are no parts.
fn nearest(parts: &[Part], point: DVec3) -> f64 {
    let distances = parts.iter().map(|part| part.distance(point));
    distances.fold(f64::INFINITY, f64::min)
}

fn kernel(shape: &Shape) -> Kernel {
    match *shape {
        Shape::Ball { diameter } => capsule_chain(&[DVec3::ZERO], &[diameter]),
        Shape::Box { size, rounding } => Kernel::Block(Block {
            half: 0.5 * size,
            rounding,
        }),
        Shape::Cylinder { diameter, height } => frustum(diameter, diameter, height),
        Shape::Capsule { diameter, length } => {
            let end = DVec3::Z * 0.5 * (length - diameter);
            if end == DVec3::ZERO {
                return capsule_chain(&[end], &[diameter]);
            }
            capsule_chain(&[-end, end], &[diameter, diameter])
        }
        Shape::ConeFrustum {
            bottom_diameter,
            top_diameter,
            height,
        } => frustum(bottom_diameter, top_diameter, height),
        Shape::Torus {
            ring_diameter,
            tube_diameter,
        } => Kernel::Torus(Torus {
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
            Kernel::Lathe(Lathe::new(&corners.map(DVec2::from)))
        }
        Shape::Lathe { ref profile } => Kernel::Lathe(Lathe::new(profile)),
        Shape::HexagonalPrism {
            across_flats,
            height,
        } => {
            let corner = across_flats / 3f64.sqrt();
            let corners = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
                .map(|k| corner * DVec2::from_angle(k * std::f64::consts::FRAC_PI_3));
            Kernel::Prism(Prism::new(&corners, height))
        }
        Shape::Prism {
            ref outline,
            thickness,
        } => Kernel::Prism(Prism::new(outline, thickness)),
        Shape::SphereSweep {
            ref points,
            ref diameters,
        } => capsule_chain(points, diameters),
    }
}

fn frustum(bottom_diameter: f64, top_diameter: f64, height: f64) -> Kernel {
    let (bottom, top, z) = (0.5 * bottom_diameter, 0.5 * top_diameter, 0.5 * height);
    let mut corners = vec![DVec2::new(0.0, -z)];
    if bottom > 0.0 {
        corners.push(DVec2::new(bottom, -z));
    }
    if top > 0.0 {
        corners.push(DVec2::new(top, z));
    }
    corners.push(DVec2::new(0.0, z));
    Kernel::Lathe(Lathe::new(&corners))
}

fn capsule_chain(points: &[DVec3], diameters: &[f64]) -> Kernel {
    let balls = points.iter().zip(diameters).map(|(&center, &diameter)| {
        let radius = 0.5 * diameter;
        Sphere { center, radius }
    });
    Kernel::SphereSweep(SphereSweep {
        balls: balls.collect(),
    })
}
