//! Parts of objects as written in object files, in millimetres and degrees.

use super::shape::Wording;
use super::{Part, Shape, Solid};
use crate::error::{Error, Result};
use crate::geometry::{Pose, rotation_from_rpy};
use glam::{DVec2, DVec3};
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;

/// Part `[[object.part]]` or subtracted shape `[[object.subtract]]` of an object file: the name of a shape, its position, and its lengths.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WrittenPart {
    shape: Spanned<ShapeName>,
    /// Position of the shape's origin in the object's frame, mm.
    position_mm: Option<Spanned<[f64; 3]>>,
    /// Rotation in degrees, applied before the position: about the object's fixed x axis, then y, then z (URDF's roll, pitch, yaw).
    rotation_deg: Option<Spanned<[f64; 3]>>,
    size_mm: Option<Spanned<[f64; 3]>>,
    diameter_mm: Option<Spanned<f64>>,
    height_mm: Option<Spanned<f64>>,
    length_mm: Option<Spanned<f64>>,
    bottom_diameter_mm: Option<Spanned<f64>>,
    top_diameter_mm: Option<Spanned<f64>>,
    ring_diameter_mm: Option<Spanned<f64>>,
    tube_diameter_mm: Option<Spanned<f64>>,
    outer_diameter_mm: Option<Spanned<f64>>,
    inner_diameter_mm: Option<Spanned<f64>>,
    across_flats_mm: Option<Spanned<f64>>,
    thickness_mm: Option<Spanned<f64>>,
    rounding_mm: Option<Spanned<f64>>,
    /// Corners (diameter, height) of the profile of a turned part, as in a technical drawing, mm.
    profile_mm: Option<Spanned<Vec<[f64; 2]>>>,
    outline_mm: Option<Spanned<Vec<[f64; 2]>>>,
    points_mm: Option<Spanned<Vec<[f64; 3]>>>,
    diameters_mm: Option<Spanned<Vec<f64>>>,
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
    HexagonalPrism,
    #[serde(rename = "strand")]
    SphereSweep,
}

impl Solid {
    /// Reads a solid from the text of `[[part]]` tables, which have the keys of a [catalogue](super::Catalogue) file. The parts keep their written positions.
    ///
    /// # Errors
    /// If the text is invalid; errors begin with `place`.
    pub fn parse_parts(place: &str, text: &str) -> Result<Self> {
        #[derive(Deserialize)]
        struct Written {
            part: Vec<WrittenPart>,
        }
        let allowed = "parts with a shape, and lengths in mm and degrees";
        let written: Written = toml::from_str(text)
            .map_err(|error| Error::input(place, error.message().replace('\n', ", "), allowed))?;
        let numbered = written.part.into_iter().enumerate();
        let parts = numbered.map(|(index, part)| {
            let which = format!("{place}, part {} ({})", index + 1, part.name());
            part.part()
                .map_err(|error| of_part(error, |_| which.clone()))
        });
        let solid = Self::new(parts.collect::<Result<_>>()?);
        solid.map_err(|error| error.under(format!("{place}: ")))
    }
}

/// Converts an error about a part to an error with the position of the part's key in the file.
pub(super) fn of_part(error: Error, place: impl Fn(&str) -> String) -> Error {
    match error {
        Error::Input {
            place: key,
            given,
            allowed,
        } => {
            let given = match given.parse::<f64>() {
                Ok(_) => format!("{key} = {given}"),
                Err(_) => format!("{key}: {given}"),
            };
            Error::input(place(&key), given, allowed)
        }
        other => other,
    }
}

impl WrittenPart {
    /// Converts the part from millimetres to metres and checks it. The location of an error is a key.
    pub fn part(mut self) -> Result<Part> {
        let moved = |value: &mut Option<Spanned<[f64; 3]>>, key: &str| {
            let value = value.take().map_or([0.0; 3], Spanned::into_inner);
            if value.iter().all(|number| number.is_finite()) {
                return Ok(value);
            }
            Err(Error::input(
                key,
                format!("{value:?}"),
                "three finite numbers",
            ))
        };
        let position = moved(&mut self.position_mm, "position_mm")?;
        let rotation = moved(&mut self.rotation_deg, "rotation_deg")?;
        let shape = self.take_shape()?;
        if let Some((key, _)) = self.keys().into_iter().find(|(_, place)| place.is_some()) {
            return Err(Error::input(
                key,
                format!("given for a {}", self.name()),
                "only the lengths that the shape has",
            ));
        }
        shape.check_worded(Wording::MillimetreKeys)?;
        let rotation = rotation_from_rpy(rotation.map(f64::to_radians).into());
        Part::new(shape, Pose::new(rotation, metres3(position)))
    }

    /// Returns the byte range of the value of `key` in the file, or the range of the whole shape if the key is missing.
    pub fn place(&self, key: &str) -> Range<usize> {
        let keys = self.keys().into_iter();
        let mut named = keys.filter_map(|(name, place)| (name == key).then_some(place));
        named.next().flatten().unwrap_or(self.shape.span())
    }

    /// Returns the name of the shape, as written in the file.
    pub fn name(&self) -> &'static str {
        match self.shape.get_ref() {
            ShapeName::Ball => "ball",
            ShapeName::Box => "box",
            ShapeName::Cylinder => "cylinder",
            ShapeName::Capsule => "capsule",
            ShapeName::ConeFrustum => "cone_frustum",
            ShapeName::Torus => "torus",
            ShapeName::Tube => "tube",
            ShapeName::Lathe => "lathe",
            ShapeName::Prism => "prism",
            ShapeName::HexagonalPrism => "hexagonal_prism",
            ShapeName::SphereSweep => "strand",
        }
    }

    fn take_shape(&mut self) -> Result<Shape> {
        Ok(match self.shape.get_ref() {
            ShapeName::Ball => Shape::Ball {
                diameter: metres(&mut self.diameter_mm, "diameter_mm")?,
            },
            ShapeName::Box => Shape::Box {
                size: metres3(taken(&mut self.size_mm, "size_mm")?),
                rounding: self.rounding_mm.take().map_or(0.0, Spanned::into_inner) * MM,
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
            ShapeName::HexagonalPrism => Shape::HexagonalPrism {
                across_flats: metres(&mut self.across_flats_mm, "across_flats_mm")?,
                height: metres(&mut self.height_mm, "height_mm")?,
            },
            ShapeName::SphereSweep => {
                let points = taken(&mut self.points_mm, "points_mm")?.into_iter();
                let diameters = taken(&mut self.diameters_mm, "diameters_mm")?.into_iter();
                Shape::SphereSweep {
                    points: points.map(metres3).collect(),
                    diameters: diameters.map(|d| d * MM).collect(),
                }
            }
        })
    }

    /// Returns every key that the table of a shape may have, with the position of its value in the file.
    fn keys(&self) -> Vec<(&'static str, Option<Range<usize>>)> {
        fn place<T>(value: &Option<Spanned<T>>) -> Option<Range<usize>> {
            value.as_ref().map(Spanned::span)
        }
        vec![
            ("position_mm", place(&self.position_mm)),
            ("rotation_deg", place(&self.rotation_deg)),
            ("size_mm", place(&self.size_mm)),
            ("diameter_mm", place(&self.diameter_mm)),
            ("height_mm", place(&self.height_mm)),
            ("length_mm", place(&self.length_mm)),
            ("bottom_diameter_mm", place(&self.bottom_diameter_mm)),
            ("top_diameter_mm", place(&self.top_diameter_mm)),
            ("ring_diameter_mm", place(&self.ring_diameter_mm)),
            ("tube_diameter_mm", place(&self.tube_diameter_mm)),
            ("outer_diameter_mm", place(&self.outer_diameter_mm)),
            ("inner_diameter_mm", place(&self.inner_diameter_mm)),
            ("across_flats_mm", place(&self.across_flats_mm)),
            ("thickness_mm", place(&self.thickness_mm)),
            ("rounding_mm", place(&self.rounding_mm)),
            ("profile_mm", place(&self.profile_mm)),
            ("outline_mm", place(&self.outline_mm)),
            ("points_mm", place(&self.points_mm)),
            ("diameters_mm", place(&self.diameters_mm)),
        ]
    }
}

/// Length of one millimetre, metres.
const MM: f64 = 1e-3;

fn metres(value: &mut Option<Spanned<f64>>, key: &str) -> Result<f64> {
    Ok(taken(value, key)? * MM)
}

fn metres3(millimetres: [f64; 3]) -> DVec3 {
    DVec3::from(millimetres) * MM
}

fn taken<T>(value: &mut Option<Spanned<T>>, key: &str) -> Result<T> {
    value
        .take()
        .map(Spanned::into_inner)
        .ok_or_else(|| Error::input(key, "missing", "a value for each length of the shape"))
}
