//! Parts as a person writes them: millimetres and degrees.

use super::{Part, Shape};
use crate::error::{Error, Result};
use crate::geometry::{Pose, rotation_from_rpy};
use glam::{DVec2, DVec3};
use serde::Deserialize;

/// One `[[object.part]]`: a shape's name, where it is, and the lengths that this shape has and no others.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenPart {
    shape: ShapeName,
    /// Where the shape's origin goes.
    #[serde(default)]
    position_mm: [f64; 3],
    /// Before that the shape turns about the object's fixed x axis, then y, then z (URDF's roll, pitch, yaw).
    #[serde(default)]
    rotation_deg: [f64; 3],
    size_mm: Option<[f64; 3]>,
    diameter_mm: Option<f64>,
    height_mm: Option<f64>,
    length_mm: Option<f64>,
    bottom_diameter_mm: Option<f64>,
    top_diameter_mm: Option<f64>,
    ring_diameter_mm: Option<f64>,
    tube_diameter_mm: Option<f64>,
    outer_diameter_mm: Option<f64>,
    inner_diameter_mm: Option<f64>,
    thickness_mm: Option<f64>,
    rounding_mm: Option<f64>,
    /// Corners (diameter, height) of a turned part, as its drawing gives them.
    profile_mm: Option<Vec<[f64; 2]>>,
    outline_mm: Option<Vec<[f64; 2]>>,
    points_mm: Option<Vec<[f64; 3]>>,
    diameters_mm: Option<Vec<f64>>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ShapeName {
    Ball,
    Box,
    Cylinder,
    Capsule,
    ConeFrustum,
    Torus,
    Tube,
    Lathe,
    Prism,
    Strand,
}

impl WrittenPart {
    /// The same in metres, checked. The error's place is a key.
    pub fn part(mut self) -> Result<Part> {
        let shape = self.take_shape()?;
        if let Some(key) = self.first_key_left() {
            return Err(Error::input(
                key,
                format!("given for a {}", self.name()),
                "only the lengths that the shape has",
            ));
        }
        let rotation = rotation_from_rpy(self.rotation_deg.map(f64::to_radians).into());
        Part::new(shape, Pose::new(rotation, metres3(self.position_mm)))
    }

    /// The shape's name as it is written.
    pub fn name(&self) -> &'static str {
        match self.shape {
            ShapeName::Ball => "ball",
            ShapeName::Box => "box",
            ShapeName::Cylinder => "cylinder",
            ShapeName::Capsule => "capsule",
            ShapeName::ConeFrustum => "cone_frustum",
            ShapeName::Torus => "torus",
            ShapeName::Tube => "tube",
            ShapeName::Lathe => "lathe",
            ShapeName::Prism => "prism",
            ShapeName::Strand => "strand",
        }
    }

    fn take_shape(&mut self) -> Result<Shape> {
        Ok(match self.shape {
            ShapeName::Ball => Shape::Ball {
                diameter: metres(&mut self.diameter_mm, "diameter_mm")?,
            },
            ShapeName::Box => Shape::Box {
                size: metres3(taken(&mut self.size_mm, "size_mm")?),
                rounding: self.rounding_mm.take().unwrap_or(0.0) * MM,
            },
            ShapeName::Cylinder => Shape::Cylinder {
                diameter: metres(&mut self.diameter_mm, "diameter_mm")?,
                height: metres(&mut self.height_mm, "height_mm")?,
            },
            ShapeName::Capsule => Shape::Capsule {
                diameter: metres(&mut self.diameter_mm, "diameter_mm")?,
                length: metres(&mut self.length_mm, "length_mm")?,
            },
            ShapeName::ConeFrustum => Shape::ConeFrustum {
                bottom_diameter: metres(&mut self.bottom_diameter_mm, "bottom_diameter_mm")?,
                top_diameter: metres(&mut self.top_diameter_mm, "top_diameter_mm")?,
                height: metres(&mut self.height_mm, "height_mm")?,
            },
            ShapeName::Torus => Shape::Torus {
                ring_diameter: metres(&mut self.ring_diameter_mm, "ring_diameter_mm")?,
                tube_diameter: metres(&mut self.tube_diameter_mm, "tube_diameter_mm")?,
            },
            ShapeName::Tube => Shape::Tube {
                outer_diameter: metres(&mut self.outer_diameter_mm, "outer_diameter_mm")?,
                inner_diameter: metres(&mut self.inner_diameter_mm, "inner_diameter_mm")?,
                height: metres(&mut self.height_mm, "height_mm")?,
            },
            ShapeName::Lathe => {
                let profile = taken(&mut self.profile_mm, "profile_mm")?.into_iter();
                let corner = |[diameter, z]: [f64; 2]| DVec2::new(0.5 * diameter, z) * MM;
                Shape::Lathe {
                    profile: profile.map(corner).collect(),
                }
            }
            ShapeName::Prism => {
                let outline = taken(&mut self.outline_mm, "outline_mm")?.into_iter();
                Shape::Prism {
                    outline: outline.map(|corner| DVec2::from(corner) * MM).collect(),
                    thickness: metres(&mut self.thickness_mm, "thickness_mm")?,
                }
            }
            ShapeName::Strand => {
                let points = taken(&mut self.points_mm, "points_mm")?.into_iter();
                let diameters = taken(&mut self.diameters_mm, "diameters_mm")?.into_iter();
                Shape::Strand {
                    points: points.map(metres3).collect(),
                    diameters: diameters.map(|d| d * MM).collect(),
                }
            }
        })
    }

    fn first_key_left(&self) -> Option<&'static str> {
        let keys = [
            (self.size_mm.is_some(), "size_mm"),
            (self.diameter_mm.is_some(), "diameter_mm"),
            (self.height_mm.is_some(), "height_mm"),
            (self.length_mm.is_some(), "length_mm"),
            (self.bottom_diameter_mm.is_some(), "bottom_diameter_mm"),
            (self.top_diameter_mm.is_some(), "top_diameter_mm"),
            (self.ring_diameter_mm.is_some(), "ring_diameter_mm"),
            (self.tube_diameter_mm.is_some(), "tube_diameter_mm"),
            (self.outer_diameter_mm.is_some(), "outer_diameter_mm"),
            (self.inner_diameter_mm.is_some(), "inner_diameter_mm"),
            (self.thickness_mm.is_some(), "thickness_mm"),
            (self.rounding_mm.is_some(), "rounding_mm"),
            (self.profile_mm.is_some(), "profile_mm"),
            (self.outline_mm.is_some(), "outline_mm"),
            (self.points_mm.is_some(), "points_mm"),
            (self.diameters_mm.is_some(), "diameters_mm"),
        ];
        keys.into_iter().find(|(left, _)| *left).map(|(_, key)| key)
    }
}

/// Metres in a millimetre.
const MM: f64 = 1e-3;

fn metres(value: &mut Option<f64>, key: &str) -> Result<f64> {
    Ok(taken(value, key)? * MM)
}

fn metres3(millimetres: [f64; 3]) -> DVec3 {
    DVec3::from(millimetres) * MM
}

fn taken<T>(value: &mut Option<T>, key: &str) -> Result<T> {
    value
        .take()
        .ok_or_else(|| Error::input(key, "missing", "a length that the shape needs"))
}
