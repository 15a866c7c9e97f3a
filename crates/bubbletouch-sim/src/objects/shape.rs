//! Parametric shapes with real dimensions.

use super::outline::polygon_fault;
use crate::error::{Error, Result};
use glam::{DVec2, DVec3};

/// Shape in its own frame. All lengths are positive, in metres; shapes are centred on the origin unless stated otherwise.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Ball, given by its diameter.
    Ball {
        /// Diameter of the ball.
        diameter: f64,
    },
    /// Box with sharp or rounded edges.
    Box {
        /// Edge lengths along x, y, z.
        size: DVec3,
        /// Radius of edges and corners: 0 (sharp) to half the smallest edge length.
        rounding: f64,
    },
    /// Cylinder about the z axis.
    Cylinder {
        /// Diameter of the cylinder.
        diameter: f64,
        /// Height of the cylinder along z.
        height: f64,
    },
    /// Cylinder about z with a half ball at either end.
    Capsule {
        /// Diameter of the cylinder and of the half balls.
        diameter: f64,
        /// Length along z including both half balls: at least the diameter.
        length: f64,
    },
    /// Truncated cone about z; one of the diameters may be 0.
    ConeFrustum {
        /// Diameter of the lower end.
        bottom_diameter: f64,
        /// Diameter of the upper end.
        top_diameter: f64,
        /// Height of the cone frustum along z.
        height: f64,
    },
    /// Torus about the z axis.
    Torus {
        /// Diameter of the circle in the middle of the tube, at least the tube diameter.
        ring_diameter: f64,
        /// Diameter of the tube.
        tube_diameter: f64,
    },
    /// Cylinder about z with a hole along its axis.
    Tube {
        /// Outer diameter of the tube.
        outer_diameter: f64,
        /// Diameter of the hole.
        inner_diameter: f64,
        /// Height of the tube along z.
        height: f64,
    },
    /// Solid of revolution of a polygon about z, such as a cup, a bowl or a bottle.
    Lathe {
        /// Corners (distance from the axis, height z) in either direction; the outline is closed automatically.
        profile: Vec<DVec2>,
    },
    /// Prism of a polygon in the plane z = 0, centred on this plane, such as a blade or a jaw.
    Prism {
        /// Corners (x, y) in either direction; the outline is closed automatically.
        outline: Vec<DVec2>,
        /// Thickness of the prism along z.
        thickness: f64,
    },
    /// Hexagonal bar along z with two corners on the x axis, such as a nut, a bolt head or a pencil.
    HexagonalPrism {
        /// Distance between opposite sides (the spanner size).
        across_flats: f64,
        /// Height of the bar along z.
        height: f64,
    },
    /// Ball swept along a polyline with a diameter that changes linearly between points, such as a handle, a ring or a banana.
    SphereSweep {
        /// Points of the polyline; the sweep is closed if the last ball equals the first.
        points: Vec<DVec3>,
        /// Diameter of the ball at each point.
        diameters: Vec<f64>,
    },
}

/// Names and units of dimensions in error messages.
#[derive(Clone, Copy, Debug)]
pub(super) enum Wording {
    /// Messages with field names and lengths in metres, such as `height: -0.002 m`.
    Metres,
    /// Messages with keys of object files and lengths in millimetres, such as `height_mm: -2`.
    MillimetreKeys,
}

impl Wording {
    fn name(self, length: &str) -> String {
        match self {
            Self::Metres => length.to_owned(),
            Self::MillimetreKeys => format!("{length}_mm"),
        }
    }

    /// Formats a length, given in metres, for an error message.
    fn length(self, metres: f64) -> String {
        match self {
            Self::Metres => format!("{metres} m"),
            // The value as written, without the rounding errors of the conversion to metres and back.
            Self::MillimetreKeys => format!("{}", (metres * 1e12).round() / 1e9),
        }
    }

    fn positive(self, name: &str, metres: f64) -> Result<()> {
        if metres.is_finite() && metres > 0.0 {
            return Ok(());
        }
        let allowed = "a finite positive length";
        Err(Error::input(self.name(name), self.length(metres), allowed))
    }

    /// Returns an error unless low ≤ metres ≤ high for the dimension `name`; `high` may be infinite.
    fn between(self, name: &str, metres: f64, low: f64, high: f64) -> Result<()> {
        if metres.is_finite() && (low..=high).contains(&metres) {
            return Ok(());
        }
        let low = self.length(low);
        let allowed = if high.is_infinite() {
            format!("{low} or more")
        } else {
            format!("{low} to {}", self.length(high))
        };
        Err(Error::input(self.name(name), self.length(metres), allowed))
    }

    fn polygon(self, name: &str, corners: &[DVec2]) -> Result<()> {
        let fault = match corners.iter().position(|corner| !corner.is_finite()) {
            Some(at) => Some(format!("corner {}, which is not finite", at + 1)),
            None => polygon_fault(corners),
        };
        match fault {
            Some(given) => Err(Error::input(
                self.name(name),
                given,
                "at least three corners of a polygon that does not cross itself",
            )),
            None => Ok(()),
        }
    }

    fn check_capsule_chain(self, points: &[DVec3], diameters: &[f64]) -> Result<()> {
        if points.is_empty() || points.len() != diameters.len() {
            return Err(Error::input(
                self.name("diameters"),
                format!("{} points and {} diameters", points.len(), diameters.len()),
                "one diameter for each of at least one points",
            ));
        }
        for &diameter in diameters {
            self.positive("diameters", diameter)?;
        }
        if let Some(at) = points.iter().position(|point| !point.is_finite()) {
            let given = format!("point {}, which is not finite", at + 1);
            return Err(Error::input(
                self.name("points"),
                given,
                "finite coordinates",
            ));
        }
        match points.windows(2).position(|pair| pair[0] == pair[1]) {
            Some(at) => Err(Error::input(
                self.name("points"),
                format!("point {} as the one before", at + 2),
                "neighbouring points that differ",
            )),
            None => Ok(()),
        }
    }
}

impl Shape {
    /// Returns an error if a dimension of the shape is out of range.
    ///
    /// # Errors
    /// If a dimension is out of range; the error names the first one.
    pub fn check(&self) -> Result<()> {
        self.check_worded(Wording::Metres)
    }

    /// Returns an error if a dimension of the shape is out of range. The location of the error is the name of the dimension.
    pub(super) fn check_worded(&self, wording: Wording) -> Result<()> {
        let positive = |name, metres| wording.positive(name, metres);
        let at_least = |name, metres, low| wording.between(name, metres, low, f64::INFINITY);
        match self {
            Shape::Ball { diameter } => positive("diameter", *diameter),
            Shape::Box { size, rounding } => {
                for length in size.to_array() {
                    positive("size", length)?;
                }
                wording.between("rounding", *rounding, 0.0, 0.5 * size.min_element())
            }
            Shape::Cylinder { diameter, height } => {
                positive("diameter", *diameter)?;
                positive("height", *height)
            }
            Shape::Capsule { diameter, length } => {
                positive("diameter", *diameter)?;
                at_least("length", *length, *diameter)
            }
            Shape::ConeFrustum {
                bottom_diameter,
                top_diameter,
                height,
            } => {
                at_least("bottom_diameter", *bottom_diameter, 0.0)?;
                at_least("top_diameter", *top_diameter, 0.0)?;
                if *bottom_diameter == 0.0 {
                    positive("top_diameter", *top_diameter)?;
                }
                positive("height", *height)
            }
            Shape::Torus {
                ring_diameter,
                tube_diameter,
            } => {
                positive("tube_diameter", *tube_diameter)?;
                at_least("ring_diameter", *ring_diameter, *tube_diameter)
            }
            Shape::Tube {
                outer_diameter,
                inner_diameter,
                height,
            } => {
                positive("inner_diameter", *inner_diameter)?;
                positive("outer_diameter", *outer_diameter)?;
                if inner_diameter >= outer_diameter {
                    return Err(Error::input(
                        wording.name("inner_diameter"),
                        wording.length(*inner_diameter),
                        format!(
                            "less than the outer diameter of {}",
                            wording.length(*outer_diameter)
                        ),
                    ));
                }
                positive("height", *height)
            }
            Shape::Lathe { profile } => {
                wording.polygon("profile", profile)?;
                match profile.iter().position(|corner| corner.x < 0.0) {
                    Some(at) => Err(Error::input(
                        wording.name("profile"),
                        format!("corner {} left of the axis", at + 1),
                        "distances from the axis of zero or more",
                    )),
                    None => Ok(()),
                }
            }
            Shape::Prism { outline, thickness } => {
                wording.polygon("outline", outline)?;
                positive("thickness", *thickness)
            }
            Shape::HexagonalPrism {
                across_flats,
                height,
            } => {
                positive("across_flats", *across_flats)?;
                positive("height", *height)
            }
            Shape::SphereSweep { points, diameters } => {
                wording.check_capsule_chain(points, diameters)
            }
        }
    }
}
