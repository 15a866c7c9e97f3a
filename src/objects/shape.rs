//! Parametric shapes with real dimensions.

use super::outline::polygon_fault;
use crate::error::{Error, Result};
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

impl Shape {
    /// The error names the first dimension that is out of its range.
    pub fn check(&self) -> Result<()> {
        match self {
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
