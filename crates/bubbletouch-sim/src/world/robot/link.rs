//! Links: rigid bodies, with the shapes that skin can cover.

use super::origin::origin_of;
use crate::error::Result;
use crate::geometry::Pose;
use crate::text::xml::{Element, LENGTHS, NOT_ZERO};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Rigid body of a `Robot`.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Name of the link, unique in its robot.
    pub name: String,
    /// Visual and collision shapes of the link, in the order of the file; shapes that cannot be read are omitted.
    pub shapes: Vec<LinkShape>,
}

/// Shape of a link, for drawing or for collisions.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkShape {
    /// Purpose of the shape.
    pub role: ShapeRole,
    /// Form and size of the shape.
    pub geometry: LinkGeometry,
    /// Pose `link_from_shape` of the shape on the link.
    pub origin: Pose,
}

/// Purpose of a shape on a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShapeRole {
    /// Shape for visualisation.
    Visual,
    /// Shape for collisions.
    Collision,
}

/// Geometry of a shape, centred on its own origin, with axes along z; lengths in metres, zero or positive. A shape with a length of zero has no volume, and no
/// skin can cover it.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkGeometry {
    /// Box with edges along the axes.
    Box {
        /// Edge lengths of the box, metres.
        size: DVec3,
    },
    /// Cylinder with flat ends.
    Cylinder {
        /// Radius of the cylinder, metres.
        radius: f64,
        /// Length of the cylinder, between its ends, metres.
        length: f64,
    },
    /// Cylinder with hemispheres on its ends (URDF 1.2).
    Capsule {
        /// Radius of the cylinder and of the hemispheres, metres.
        radius: f64,
        /// Length of the cylinder, without the hemispheres, metres.
        length: f64,
    },
    /// Sphere around the origin.
    Sphere {
        /// Radius of the sphere, metres.
        radius: f64,
    },
    /// Ellipsoid around the origin (MJCF).
    Ellipsoid {
        /// Semi-axes of the ellipsoid along x, y and z, metres.
        semi_axes: DVec3,
    },
    /// Triangle mesh in a separate file.
    Mesh {
        /// Name of the mesh file as written: a path relative to the robot's file, or a `file://` or `package://` address. The file is opened only for skin
        /// that is draped over the link.
        file: String,
        /// Motion of the mesh before it is scaled; the identity in URDF, the inverse of `refpos` and `refquat` in MJCF.
        mesh_from_file: Pose,
        /// Metres per unit of the mesh file along each axis; not zero, negative for mirrored axes.
        scale: DVec3,
    },
}

impl LinkGeometry {
    /// Returns whether the shape encloses a volume; always true for a mesh.
    pub fn has_volume(&self) -> bool {
        match self {
            Self::Box { size } => size.min_element() > 0.0,
            Self::Cylinder { radius, length } => *radius > 0.0 && *length > 0.0,
            // A capsule of length zero is a sphere.
            Self::Capsule { radius, .. } | Self::Sphere { radius } => *radius > 0.0,
            Self::Ellipsoid { semi_axes } => semi_axes.min_element() > 0.0,
            Self::Mesh { .. } => true,
        }
    }
}

impl Link {
    /// Creates a link without shapes.
    pub(super) fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            shapes: Vec::new(),
        }
    }

    /// Returns the link's collision shapes with a volume, which skin can cover.
    pub(crate) fn solids(&self) -> impl Iterator<Item = &LinkShape> {
        let is_solid =
            |shape: &&LinkShape| shape.role == ShapeRole::Collision && shape.geometry.has_volume();
        self.shapes.iter().filter(is_solid)
    }
}

/// Reads a `<link>` element.
pub(super) fn read_link(element: &Element) -> Result<Link> {
    let mut link = Link::new(element.name()?);
    let slips = element.check_tags("visual collision inertial");
    element.or_note(slips, (), "the element is passed over");
    for shape in element.elements() {
        let role = match shape.tag() {
            "visual" => ShapeRole::Visual,
            "collision" => ShapeRole::Collision,
            _ => continue,
        };
        // Shapes do not determine poses of links, so unreadable shapes are omitted.
        let read = read_shape(shape, role).map(Some);
        link.shapes
            .extend(shape.or_note(read, None, "this shape is left out"));
    }
    Ok(link)
}

fn read_shape(element: Element, role: ShapeRole) -> Result<LinkShape> {
    element.check_tags("origin geometry material name verbose")?;
    Ok(LinkShape {
        role,
        geometry: read_geometry(element.needed_child("geometry")?)?,
        origin: origin_of(element)?,
    })
}

fn read_geometry(element: Element) -> Result<LinkGeometry> {
    let mut forms = Vec::new();
    for tag in ["box", "cylinder", "capsule", "sphere", "mesh"] {
        forms.extend(element.child(tag)?);
    }
    let &[form] = forms.as_slice() else {
        let given = format!("<geometry> with {} forms", forms.len());
        let allowed = "exactly one of box, cylinder, capsule, sphere, mesh";
        return Err(element.refuse(given, allowed));
    };
    let length = |attribute| {
        let number = form.needed_in(attribute, &LENGTHS);
        number.map(|[length]| length)
    };
    Ok(match form.tag() {
        "box" => LinkGeometry::Box {
            size: DVec3::from(form.needed_in("size", &LENGTHS)?),
        },
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

fn read_mesh(form: Element) -> Result<LinkGeometry> {
    form.check_attributes("filename scale")?;
    let file = form.text("filename")?.trim().to_owned();
    if file.is_empty() {
        return Err(form.refuse("an empty `filename`", "the path of a mesh"));
    }
    let scale = form.numbers_in("scale", &NOT_ZERO)?;
    Ok(LinkGeometry::Mesh {
        file,
        mesh_from_file: Pose::IDENTITY,
        scale: scale.map_or(DVec3::ONE, DVec3::from),
    })
}
