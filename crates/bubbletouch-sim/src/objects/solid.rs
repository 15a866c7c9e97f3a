//! Unions of posed shapes, less other shapes: what the catalogue's objects are.

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

/// A shape that is placed in the object's frame.
#[derive(Clone, Debug)]
pub struct Part {
    shape: Shape,
    kernel: Kernel,
    /// Object from part.
    pose: Pose,
}

/// A union of parts, less other shapes. Invariant: at least one part.
#[derive(Clone, Debug)]
pub struct Solid {
    parts: Vec<Part>,
    /// What is subtracted from all parts together.
    cuts: Vec<Part>,
    /// How much larger the cuts are taken, metres.
    seam: f64,
}

/// How much larger cuts are taken, in diagonals of the box around the parts: where one ends in a part's surface no membrane without
/// thickness is left. Smaller: rounding leaves one; larger: walls beside cuts are thinner.
const SEAM: f64 = 4e-6;

/// The five forms that all shapes come down to.
#[derive(Clone, Debug)]
enum Kernel {
    Block(Block),
    Lathe(Lathe),
    Prism(Prism),
    Torus(Torus),
    SphereSweep(SphereSweep),
}

/// Smallest gap of a turned polygon, as a share of its size: intervals on its edges are known to 1e-9 of an edge. The rim of a sharp
/// edge takes more spheres than are allowed long before. Larger: refuses fine packings; smaller: edges count as covered that no sphere
/// reaches.
const MIN_REACH: f64 = 1e-8;

impl Part {
    /// A shape at a pose.
    ///
    /// # Errors
    /// The first dimension that is out of its range.
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

    /// What was given.
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// Metres from a point of the object's frame to the part's surface, negative inside.
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

    /// Largest p·direction over the part, in the object's frame.
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

    /// Whether rounding is small beside the gaps that a packing may leave.
    pub(super) fn resolves(&self, fit: Fit) -> bool {
        let along = |axis: DVec3| self.support(axis) + self.support(-axis);
        let size = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)).length();
        !matches!(self.kernel, Kernel::Lathe(_)) || fit.reach() >= MIN_REACH * size
    }

    /// Spheres whose union is the part.
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

    /// All of the part's surface, in the object's frame.
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

    /// Points of the part's surface, at most about `spacing` apart, corners and edges among them.
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
    /// A solid of parts.
    ///
    /// # Errors
    /// No parts.
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

    /// What these shapes leave of the solid.
    ///
    /// # Errors
    /// They leave nothing of one of its parts' surfaces, as far as points a hundredth of its size apart can tell.
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

    /// A solid of one shape in its own frame.
    ///
    /// # Errors
    /// Those of [`Part::new`].
    pub fn of(shape: Shape) -> Result<Self> {
        Self::new(vec![Part::new(shape, Pose::IDENTITY)?])
    }

    /// In the order in which they were given.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What is subtracted, in the order in which it was given.
    pub fn cuts(&self) -> &[Part] {
        &self.cuts
    }

    /// Metres from a point to the surface, negative inside.
    ///
    /// Exact outside if nothing is subtracted, else never farther than the truth; inside exact for one part of any shape but a
    /// strand, else never deeper than the truth. What is subtracted is taken larger by 4 millionths of the diagonal of the box.
    pub fn distance(&self, point: DVec3) -> f64 {
        nearest(&self.parts, point).max(self.seam - nearest(&self.cuts, point))
    }

    /// Minus the distance where all that is subtracted is larger by `growth` (metres).
    pub(super) fn depth_with_cuts_grown(&self, point: DVec3, growth: f64) -> f64 {
        (-nearest(&self.parts, point)).min(nearest(&self.cuts, point) - growth)
    }

    /// The exact box around the parts, whatever is subtracted from them, metres.
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

    /// The same solid after a rigid motion.
    pub fn moved(&self, motion: &Pose) -> Self {
        let mut solid = self.clone();
        for part in solid.parts.iter_mut().chain(&mut solid.cuts) {
            part.pose = motion.compose(&part.pose);
        }
        solid
    }

    /// The same solid resting on z = 0, the middle of its box on the z axis.
    pub fn resting(&self) -> Self {
        let bounds = self.bounds();
        let middle = bounds.center().truncate();
        self.moved(&Pose::from_translation(-middle.extend(bounds.min.z)))
    }

    /// Points of the union's surface, at most about `spacing` (metres) apart.
    pub fn surface_points(&self, spacing: f64) -> Vec<DVec3> {
        // A point of a part's surface that lies inside another part, or inside its own strand, is not surface.
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

/// Metres to the nearest of these shapes, negative inside one; infinite without any.
fn nearest(parts: &[Part], point: DVec3) -> f64 {
    let distances = parts.iter().map(|part| part.distance(point));
    distances.fold(f64::INFINITY, f64::min)
}

fn kernel(shape: &Shape) -> Kernel {
    match *shape {
        Shape::Ball { diameter } => strand(&[DVec3::ZERO], &[diameter]),
        Shape::Box { size, rounding } => Kernel::Block(Block {
            half: 0.5 * size,
            rounding,
        }),
        Shape::Cylinder { diameter, height } => frustum(diameter, diameter, height),
        Shape::Capsule { diameter, length } => {
            let end = DVec3::Z * 0.5 * (length - diameter);
            if end == DVec3::ZERO {
                return strand(&[end], &[diameter]);
            }
            strand(&[-end, end], &[diameter, diameter])
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
        } => strand(points, diameters),
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

fn strand(points: &[DVec3], diameters: &[f64]) -> Kernel {
    let balls = points.iter().zip(diameters).map(|(&center, &diameter)| {
        let radius = 0.5 * diameter;
        Sphere { center, radius }
    });
    Kernel::SphereSweep(SphereSweep {
        balls: balls.collect(),
    })
}
