//! Parametric solids with real dimensions: what the catalogue's objects are made of.

use super::block::Block;
use super::lathe::Lathe;
use super::outline::polygon_fault;
use super::prism::Prism;
use super::strand::Strand;
use super::torus::Torus;
use super::{Sphere, SphereUnion};
use crate::error::{Error, Result};
use crate::geometry::{Aabb, Pose};
use glam::{DVec2, DVec3};

/// A shape in its own frame. All lengths are metres and positive; each shape is centred on the origin unless said.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A ball.
    Ball {
        /// Its diameter.
        diameter: f64,
    },
    /// A box.
    Box {
        /// Edge lengths along x, y, z.
        size: DVec3,
        /// Radius of edges and corners: 0 (sharp) to half the smallest edge length.
        rounding: f64,
    },
    /// A cylinder about z.
    Cylinder {
        /// Its diameter.
        diameter: f64,
        /// Along z.
        height: f64,
    },
    /// A cylinder about z with a half ball on each end.
    Capsule {
        /// Its diameter.
        diameter: f64,
        /// Along z, both half balls included: at least the diameter.
        length: f64,
    },
    /// A cone about z with its tip cut off; one of the diameters may be 0.
    ConeFrustum {
        /// Diameter of the lower end.
        bottom_diameter: f64,
        /// Diameter of the upper end.
        top_diameter: f64,
        /// Along z.
        height: f64,
    },
    /// A torus about z.
    Torus {
        /// Diameter of the circle in the middle of the tube: at least the tube's.
        ring_diameter: f64,
        /// Diameter of the tube.
        tube_diameter: f64,
    },
    /// A cylinder about z with a hole along it.
    Tube {
        /// Diameter of the outside.
        outer_diameter: f64,
        /// Diameter of the hole.
        inner_diameter: f64,
        /// Along z.
        height: f64,
    },
    /// A polygon turned about z: cups, bowls, bottles.
    Lathe {
        /// Corners (distance from the axis, height z), either way round; the outline closes itself.
        profile: Vec<DVec2>,
    },
    /// A polygon in the plane z = 0, thickened both ways: blades, jaws.
    Prism {
        /// Corners (x, y), either way round; the outline closes itself.
        outline: Vec<DVec2>,
        /// Along z.
        thickness: f64,
    },
    /// A ball swept along a broken line, its diameter changing evenly from point to point: handles, rings, bananas.
    Strand {
        /// Where the line goes; closed when the last ball is the first.
        points: Vec<DVec3>,
        /// The ball's diameter at each point.
        diameters: Vec<f64>,
    },
}

/// A shape that is placed in the object's frame.
#[derive(Clone, Debug)]
pub struct Part {
    shape: Shape,
    kernel: Kernel,
    /// Object from part.
    pose: Pose,
}

/// A union of parts. Invariant: at least one.
#[derive(Clone, Debug)]
pub struct Solid {
    parts: Vec<Part>,
}

/// The five forms that all shapes come down to.
#[derive(Clone, Debug)]
enum Kernel {
    Block(Block),
    Lathe(Lathe),
    Prism(Prism),
    Torus(Torus),
    Strand(Strand),
}

impl Part {
    /// The error names the first dimension that is out of its range.
    pub fn new(shape: Shape, pose: Pose) -> Result<Self> {
        check(&shape)?;
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
            Kernel::Strand(strand) => strand.distance(point),
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
            Kernel::Strand(strand) => strand.support(inside),
        };
        support + self.pose.translation.dot(direction)
    }

    /// Spheres whose union is the part to the tolerance (metres, positive).
    pub(super) fn pack(&self, tolerance: f64) -> Vec<Sphere> {
        let mut spheres = Vec::new();
        match &self.kernel {
            Kernel::Block(block) => block.pack(tolerance, &mut spheres),
            Kernel::Lathe(lathe) => lathe.pack(tolerance, &mut spheres),
            Kernel::Prism(prism) => prism.pack(tolerance, &mut spheres),
            Kernel::Torus(torus) => torus.pack(tolerance, &mut spheres),
            Kernel::Strand(strand) => strand.pack(tolerance, &mut spheres),
        }
        for sphere in &mut spheres {
            sphere.center = self.pose.transform_point(sphere.center);
        }
        spheres
    }

    /// Points of the part's surface, at most about `spacing` apart, corners and edges among them.
    fn surface_points(&self, spacing: f64) -> Vec<DVec3> {
        let mut points = Vec::new();
        match &self.kernel {
            Kernel::Block(block) => block.surface_points(spacing, &mut points),
            Kernel::Lathe(lathe) => lathe.surface_points(spacing, &mut points),
            Kernel::Prism(prism) => prism.surface_points(spacing, &mut points),
            Kernel::Torus(torus) => torus.surface_points(spacing, &mut points),
            Kernel::Strand(strand) => strand.surface_points(spacing, &mut points),
        }
        for point in &mut points {
            *point = self.pose.transform_point(*point);
        }
        points
    }
}

impl Solid {
    /// An error for no parts.
    pub fn new(parts: Vec<Part>) -> Result<Self> {
        if parts.is_empty() {
            return Err(Error::input("solid", "no parts", "at least one part"));
        }
        Ok(Self { parts })
    }

    /// A solid of one shape in its own frame.
    pub fn of(shape: Shape) -> Result<Self> {
        Self::new(vec![Part::new(shape, Pose::IDENTITY)?])
    }

    /// In the order in which they were given.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Metres from a point to the surface, negative inside.
    ///
    /// Exact outside; inside exact for one part of any shape but a strand, else never deeper than the truth.
    pub fn distance(&self, point: DVec3) -> f64 {
        let distances = self.parts.iter().map(|part| part.distance(point));
        distances.fold(f64::INFINITY, f64::min)
    }

    /// The exact box around the solid, metres.
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
        let mut parts = self.parts.clone();
        for part in &mut parts {
            part.pose = motion.compose(&part.pose);
        }
        Self { parts }
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
        let inside = -1e-9 * self.bounds().size().length();
        let points = self.parts.iter().flat_map(|p| p.surface_points(spacing));
        points.filter(|&p| self.distance(p) >= inside).collect()
    }

    /// [`super::pack`] as a method.
    pub fn pack(&self, tolerance: f64) -> Result<SphereUnion> {
        super::pack::pack(self, tolerance)
    }
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
        Shape::Prism {
            ref outline,
            thickness,
        } => Kernel::Prism(Prism::new(outline, thickness)),
        Shape::Strand {
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
    Kernel::Strand(Strand {
        balls: balls.collect(),
    })
}

fn check(shape: &Shape) -> Result<()> {
    match shape {
        Shape::Ball { diameter } => positive("diameter", *diameter),
        Shape::Box { size, rounding } => {
            positive("size x", size.x)?;
            positive("size y", size.y)?;
            positive("size z", size.z)?;
            between("rounding", *rounding, 0.0, 0.5 * size.min_element())
        }
        Shape::Cylinder { diameter, height } => {
            positive("diameter", *diameter)?;
            positive("height", *height)
        }
        Shape::Capsule { diameter, length } => {
            positive("diameter", *diameter)?;
            between("length", *length, *diameter, f64::MAX)
        }
        Shape::ConeFrustum {
            bottom_diameter,
            top_diameter,
            height,
        } => {
            between("bottom_diameter", *bottom_diameter, 0.0, f64::MAX)?;
            between("top_diameter", *top_diameter, 0.0, f64::MAX)?;
            positive("larger diameter", bottom_diameter.max(*top_diameter))?;
            positive("height", *height)
        }
        Shape::Torus {
            ring_diameter,
            tube_diameter,
        } => {
            positive("tube_diameter", *tube_diameter)?;
            between("ring_diameter", *ring_diameter, *tube_diameter, f64::MAX)
        }
        Shape::Tube {
            outer_diameter,
            inner_diameter,
            height,
        } => {
            positive("inner_diameter", *inner_diameter)?;
            positive("wall", outer_diameter - inner_diameter)?;
            positive("outer_diameter", *outer_diameter)?;
            positive("height", *height)
        }
        Shape::Lathe { profile } => {
            check_polygon("profile", profile)?;
            match profile.iter().find(|corner| corner.x < 0.0) {
                Some(corner) => Err(Error::input(
                    "profile",
                    format!("corner {corner} m left of the axis"),
                    "distances from the axis of zero or more",
                )),
                None => Ok(()),
            }
        }
        Shape::Prism { outline, thickness } => {
            check_polygon("outline", outline)?;
            positive("thickness", *thickness)
        }
        Shape::Strand { points, diameters } => check_strand(points, diameters),
    }
}

fn check_polygon(place: &str, corners: &[DVec2]) -> Result<()> {
    let fault = match corners.iter().find(|corner| !corner.is_finite()) {
        Some(corner) => Some(format!("corner {corner}")),
        None => polygon_fault(corners),
    };
    match fault {
        Some(given) => Err(Error::input(
            place,
            given,
            "at least three corners of a polygon that does not cross itself",
        )),
        None => Ok(()),
    }
}

fn check_strand(points: &[DVec3], diameters: &[f64]) -> Result<()> {
    if points.is_empty() || points.len() != diameters.len() {
        return Err(Error::input(
            "strand",
            format!("{} points and {} diameters", points.len(), diameters.len()),
            "one diameter for each of at least one points",
        ));
    }
    for &diameter in diameters {
        positive("diameters", diameter)?;
    }
    if let Some(point) = points.iter().find(|point| !point.is_finite()) {
        return Err(Error::input("points", point, "finite coordinates"));
    }
    match points.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(Error::input(
            "points",
            format!("{} m twice in a row", pair[0]),
            "neighbouring points that differ",
        )),
        None => Ok(()),
    }
}

fn positive(name: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::input(
        name,
        format!("{value} m"),
        "a finite positive length",
    ))
}

fn between(name: &str, value: f64, low: f64, high: f64) -> Result<()> {
    if value.is_finite() && (low..=high).contains(&value) {
        return Ok(());
    }
    let allowed = if high == f64::MAX {
        format!("{low} m or more")
    } else {
        format!("{low} to {high} m")
    };
    Err(Error::input(name, format!("{value} m"), allowed))
}
