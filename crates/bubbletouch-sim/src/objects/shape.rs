//! Parametric shapes with real dimensions.

use super::outline::polygon_fault;
use crate::error::{Error, Result};
use glam::{DVec2, DVec3};
use serde::Deserialize;
use std::fmt::Display;

/// Shape in its own frame. All lengths are in metres, at least one nanometre; shapes are centred on the origin unless stated otherwise.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case")]
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
        /// Radius of edges and corners: 0 (sharp), or up to half the smallest edge length.
        #[serde(default)]
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
    #[serde(rename = "strand")]
    SphereSweep {
        /// Points of the polyline; the sweep is closed if the last ball equals the first.
        points: Vec<DVec3>,
        /// Diameter of the ball at each point.
        diameters: Vec<f64>,
    },
}

/// Names and units of lengths in error messages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wording {
    /// End of the name of a length.
    suffix: &'static str,
    /// Text after a number.
    unit: &'static str,
    /// Shortest length: one nanometre, in the unit of the lengths. If shorter, rounding errors of coordinates are as large as the length, and squares of
    /// lengths may be zero; if longer, thin layers are refused.
    shortest: f64,
}

impl Wording {
    /// Messages with field names and lengths in metres, such as `height: -0.002 m`.
    const METRES: Self = Self {
        suffix: "",
        unit: " m",
        shortest: 1e-9,
    };
    /// Messages with keys of object files and lengths in millimetres, such as `height_mm: -2`.
    pub const MILLIMETRE_KEYS: Self = Self {
        suffix: "_mm",
        unit: "",
        shortest: 1e-6,
    };

    fn refuse<T>(self, name: &str, given: impl Display, allowed: impl Display) -> Result<T> {
        Err(Error::input(
            format!("{name}{}", self.suffix),
            given,
            allowed,
        ))
    }

    /// Returns the shortest length as text, such as `1e-9 m`.
    fn shortest(self) -> String {
        format!("{:e}{}", self.shortest, self.unit)
    }

    /// Returns an error unless all lengths, given with their names, are at least the shortest length.
    fn lengths<const N: usize>(self, lengths: [(&str, f64); N]) -> Result<()> {
        let mut lengths = lengths.into_iter();
        lengths.try_for_each(|(name, length)| self.length(name, length, ""))
    }

    /// Returns an error unless the length `name` is zero or at least the shortest length.
    fn zero_or_length(self, name: &str, length: f64) -> Result<()> {
        match length == 0.0 {
            true => Ok(()),
            false => self.length(name, length, "zero, or "),
        }
    }

    fn length(self, name: &str, length: f64, or: &str) -> Result<()> {
        if length.is_finite() && length >= self.shortest {
            return Ok(());
        }
        // Few digits also for a length such as 1e-320.
        let digits = match length.abs() < self.shortest && length != 0.0 {
            true => format!("{length:e}"),
            false => length.to_string(),
        };
        let given = format_args!("{digits}{}", self.unit);
        let allowed = format_args!("{or}a finite length of at least {}", self.shortest());
        self.refuse(name, given, allowed)
    }

    /// Returns an error unless low ≤ length ≤ high for the length `name`; `high` may be infinite.
    fn between(self, name: &str, length: f64, low: f64, high: f64) -> Result<()> {
        if length.is_finite() && (low..=high).contains(&length) {
            return Ok(());
        }
        let unit = self.unit;
        let allowed = match high.is_infinite() {
            true => format!("{low}{unit} or more"),
            false => format!("{low}{unit} to {high}{unit}"),
        };
        self.refuse(name, format_args!("{length}{unit}"), allowed)
    }

    fn polygon(self, name: &str, corners: &[DVec2]) -> Result<()> {
        let infinite = corners.iter().position(|corner| !corner.is_finite());
        let infinite = infinite.map(|at| format!("corner {}, which is not finite", at + 1));
        match infinite.or_else(|| polygon_fault(corners, self.shortest)) {
            Some(given) => {
                let shortest = self.shortest();
                let allowed = format!(
                    "at least three corners, {shortest} or more apart, of a polygon that does not cross itself"
                );
                self.refuse(name, given, allowed)
            }
            None => Ok(()),
        }
    }

    fn sphere_sweep(self, points: &[DVec3], diameters: &[f64]) -> Result<()> {
        let (n, n_diameters) = (points.len(), diameters.len());
        if n == 0 || n != n_diameters {
            let given = format_args!("{n} points and {n_diameters} diameters");
            let allowed = "one diameter for each of at least one points";
            return self.refuse("diameters", given, allowed);
        }
        for &diameter in diameters {
            self.lengths([("diameters", diameter)])?;
        }
        if let Some(at) = points.iter().position(|point| !point.is_finite()) {
            let given = format_args!("point {}, which is not finite", at + 1);
            return self.refuse("points", given, "finite coordinates");
        }
        let is_short = |pair: &[DVec3]| pair[0].distance(pair[1]) < self.shortest;
        match points.windows(2).position(is_short) {
            Some(at) => {
                let given = format_args!("point {} as the one before", at + 2);
                let allowed = format!("neighbouring points {} or more apart", self.shortest());
                self.refuse("points", given, allowed)
            }
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
        self.check_worded(Wording::METRES)
    }

    /// Returns an error if a dimension of the shape, in the unit of the wording, is out of range. The location of the error is the name of the dimension.
    pub(super) fn check_worded(&self, wording: Wording) -> Result<()> {
        let at_least = |name, length, low| wording.between(name, length, low, f64::INFINITY);
        match *self {
            Shape::Ball { diameter } => wording.lengths([("diameter", diameter)]),
            Shape::Box { size, rounding } => {
                wording.lengths(size.to_array().map(|side| ("size", side)))?;
                wording.between("rounding", rounding, 0.0, 0.5 * size.min_element())?;
                wording.zero_or_length("rounding", rounding)
            }
            Shape::Cylinder { diameter, height } => {
                wording.lengths([("diameter", diameter), ("height", height)])
            }
            Shape::Capsule { diameter, length } => {
                wording.lengths([("diameter", diameter)])?;
                at_least("length", length, diameter)
            }
            Shape::ConeFrustum {
                bottom_diameter: bottom,
                top_diameter: top,
                height,
            } => {
                wording.zero_or_length("bottom_diameter", bottom)?;
                if bottom == 0.0 || top != 0.0 {
                    wording.lengths([("top_diameter", top)])?;
                }
                wording.lengths([("height", height)])
            }
            Shape::Torus {
                ring_diameter: ring,
                tube_diameter: tube,
            } => {
                wording.lengths([("tube_diameter", tube)])?;
                at_least("ring_diameter", ring, tube)
            }
            Shape::Tube {
                outer_diameter: outer,
                inner_diameter: inner,
                height,
            } => {
                wording.lengths([("inner_diameter", inner), ("outer_diameter", outer)])?;
                if outer - inner < wording.shortest {
                    let (unit, shortest) = (wording.unit, wording.shortest());
                    let allowed = format_args!(
                        "less than the outer diameter of {outer}{unit}, by at least {shortest}"
                    );
                    return wording.refuse(
                        "inner_diameter",
                        format_args!("{inner}{unit}"),
                        allowed,
                    );
                }
                wording.lengths([("height", height)])
            }
            Shape::Lathe { ref profile } => {
                wording.polygon("profile", profile)?;
                match profile.iter().position(|corner| corner.x < 0.0) {
                    Some(at) => {
                        let given = format_args!("corner {} left of the axis", at + 1);
                        wording.refuse("profile", given, "distances from the axis of zero or more")
                    }
                    None => Ok(()),
                }
            }
            Shape::Prism {
                ref outline,
                thickness,
            } => {
                wording.polygon("outline", outline)?;
                wording.lengths([("thickness", thickness)])
            }
            Shape::HexagonalPrism {
                across_flats,
                height,
            } => wording.lengths([("across_flats", across_flats), ("height", height)]),
            Shape::SphereSweep {
                ref points,
                ref diameters,
            } => wording.sphere_sweep(points, diameters),
        }
    }
}
