//! Links: rigid bodies, with the shapes that skin can be draped on.

use super::xml::Element;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use glam::DVec3;

/// A rigid body of a [`Robot`](super::Robot).
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Unique among the robot's links.
    pub name: String,
    /// Its visual and collision shapes, in the order of the file.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeRole {
    /// What is seen.
    Visual,
    /// What touches.
    Collision,
}

/// The form of a shape, centred on its own origin; axes along z; metres.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkGeometry {
    /// A box.
    Box {
        /// Edge lengths, positive.
        size: DVec3,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Positive.
        radius: f64,
        /// From end to end, positive.
        length: f64,
    },
    /// A cylinder with half balls on its ends (URDF 1.2).
    Capsule {
        /// Positive.
        radius: f64,
        /// Of the cylinder, without the half balls; positive.
        length: f64,
    },
    /// A ball.
    Sphere {
        /// Positive.
        radius: f64,
    },
    /// Triangles in a file of their own.
    Mesh {
        /// As it is written: a path beside the URDF's, `file://…` or `package://…`. It is not opened: skin lies on the other forms.
        file: String,
        /// Metres per unit of the mesh file along each axis; not zero, negative where it is mirrored.
        scale: DVec3,
    },
}

/// The link of a `<link>` element.
pub(super) fn read_link(element: &Element) -> Result<Link> {
    let name = element.name()?.to_owned();
    element.check_tags(&["visual", "collision", "inertial"])?;
    let visual = element.children("visual").map(|it| (it, ShapeRole::Visual));
    let collision = element
        .children("collision")
        .map(|it| (it, ShapeRole::Collision));
    let mut written: Vec<_> = visual.chain(collision).collect();
    written.sort_by_key(|(shape, _)| shape.node.range().start);
    let shapes = written.iter().map(|(shape, role)| read_shape(shape, *role));
    let shapes = shapes.collect::<Result<_>>()?;
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
    let length = |attribute| positive(form, attribute);
    Ok(match *tag {
        "box" => {
            let size = DVec3::from(form.needed_numbers::<3>("size")?);
            if size.min_element() <= 0.0 {
                return Err(not_positive(form, "size", size));
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

fn positive(form: &Element, attribute: &str) -> Result<f64> {
    let [value] = form.needed_numbers(attribute)?;
    if value > 0.0 {
        return Ok(value);
    }
    Err(not_positive(form, attribute, value))
}

fn not_positive(form: &Element, attribute: &str, value: impl std::fmt::Display) -> Error {
    form.refuse(
        format!("`{attribute}` {value}"),
        "positive lengths in metres",
    )
}
