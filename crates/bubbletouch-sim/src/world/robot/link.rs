//! Links: rigid bodies, with the shapes that skin can be draped on.

use super::xml::Element;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A rigid body of a [`Robot`](super::Robot).
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Unique among the robot's links.
    pub name: String,
    /// Its visual and collision shapes, in the order of the file, without those that could not be read.
    pub shapes: Vec<LinkShape>,
}

/// A shape on a link.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkShape {
    /// What it is for.
    pub role: ShapeRole,
    /// Its form and size.
    pub geometry: LinkGeometry,
    /// `link_from_shape`
    pub origin: Pose,
}

/// What a shape on a link is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeRole {
    /// What is seen.
    Visual,
    /// What touches.
    Collision,
}

/// The form of a shape, centred on its own origin; axes along z; lengths in metres, zero or positive. A shape with a length of zero
/// has no volume, and no skin can lie on it.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkGeometry {
    /// A box.
    Box {
        /// Edge lengths.
        size: DVec3,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Of the cylinder.
        radius: f64,
        /// From end to end.
        length: f64,
    },
    /// A cylinder with half balls on its ends (URDF 1.2).
    Capsule {
        /// Of the cylinder and of the half balls.
        radius: f64,
        /// Of the cylinder, without the half balls.
        length: f64,
    },
    /// A ball.
    Sphere {
        /// Of the ball.
        radius: f64,
    },
    /// Triangles in a file of their own.
    Mesh {
        /// As it is written: a path beside the URDF's, `file://…` or `package://…`. It is opened only for skin that is draped over the link.
        file: String,
        /// Metres per unit of the mesh file along each axis; not zero, negative where it is mirrored.
        scale: DVec3,
    },
}

impl LinkGeometry {
    /// Whether the form encloses a volume; a mesh is taken to.
    pub fn has_volume(&self) -> bool {
        match self {
            Self::Box { size } => size.min_element() > 0.0,
            Self::Cylinder { radius, length } => *radius > 0.0 && *length > 0.0,
            // A capsule of length zero is a ball.
            Self::Capsule { radius, .. } | Self::Sphere { radius } => *radius > 0.0,
            Self::Mesh { .. } => true,
        }
    }
}

impl Link {
    /// Collision shapes that have a volume: what touches, and what skin can lie on.
    pub(crate) fn solids(&self) -> impl Iterator<Item = &LinkShape> {
        let is_solid =
            |shape: &&LinkShape| shape.role == ShapeRole::Collision && shape.geometry.has_volume();
        self.shapes.iter().filter(is_solid)
    }
}

/// Reads a `<link>` element.
pub(super) fn read_link(element: &Element) -> Result<Link> {
    let name = element.name()?.to_owned();
    let slips = element.check_tags(&["visual", "collision", "inertial"]);
    element.or_note(slips, (), "the element is passed over");
    let visual = element.children("visual").map(|it| (it, ShapeRole::Visual));
    let collision = element
        .children("collision")
        .map(|it| (it, ShapeRole::Collision));
    let mut written: Vec<_> = visual.chain(collision).collect();
    written.sort_by_key(|(shape, _)| shape.node.range().start);
    // A shape does not decide where links are: one that cannot be read is left out.
    let shapes = written.iter().filter_map(|(shape, role)| {
        let read = read_shape(shape, *role).map(Some);
        shape.or_note(read, None, "this shape is left out")
    });
    let shapes = shapes.collect();
    Ok(Link { name, shapes })
}

fn read_shape(element: &Element, role: ShapeRole) -> Result<LinkShape> {
    element.check_tags(&["origin", "geometry", "material", "name", "verbose"])?;
    let geometry = element.needed_child("geometry")?;
    Ok(LinkShape {
        role,
        geometry: read_geometry(&geometry)?,
        origin: element.origin()?,
    })
}

fn read_geometry(element: &Element) -> Result<LinkGeometry> {
    let mut forms = Vec::new();
    for tag in ["box", "cylinder", "capsule", "sphere", "mesh"] {
        forms.extend(element.child(tag)?.map(|form| (tag, form)));
    }
    let [(tag, form)] = forms.as_slice() else {
        return Err(element.refuse(
            format!("<geometry> with {} forms", forms.len()),
            "exactly one of box, cylinder, capsule, sphere, mesh",
        ));
    };
    let length = |attribute| length_of(form, attribute);
    Ok(match *tag {
        "box" => {
            let size = DVec3::from(form.needed_numbers::<3>("size")?);
            if size.min_element() < 0.0 {
                return Err(negative(form, "size", size));
            }
            LinkGeometry::Box { size }
        }
        "cylinder" => LinkGeometry::Cylinder {
            radius: length("radius")?,
            length: length("length")?,
        },
        "capsule" => LinkGeometry::Capsule {
            radius: length("radius")?,
            length: length("length")?,
        },
        "sphere" => LinkGeometry::Sphere {
            radius: length("radius")?,
        },
        _ => read_mesh(form)?,
    })
}

fn read_mesh(form: &Element) -> Result<LinkGeometry> {
    form.check_attributes(&["filename", "scale"])?;
    let file = form.text("filename")?.trim().to_owned();
    if file.is_empty() {
        return Err(form.refuse("an empty `filename`", "the path of a mesh"));
    }
    let scale = DVec3::from(form.numbers("scale")?.unwrap_or([1.0; 3]));
    if scale.to_array().contains(&0.0) {
        return Err(form.refuse(format!("`scale` {scale}"), "three numbers other than zero"));
    }
    Ok(LinkGeometry::Mesh { file, scale })
}

fn length_of(form: &Element, attribute: &str) -> Result<f64> {
    let [value] = form.needed_numbers(attribute)?;
    if value >= 0.0 {
        return Ok(value);
    }
    Err(negative(form, attribute, value))
}

fn negative(form: &Element, attribute: &str, value: impl std::fmt::Display) -> Error {
    form.refuse(
        format!("`{attribute}` {value}"),
        "lengths in metres, zero or positive",
    )
}
