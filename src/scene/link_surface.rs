//! Surface of a robot's link, over which skin can be draped. The shapes of the link form one triangle mesh in the link's frame, metres.
//!
//! Boxes are exact. Round shapes are divided into facets with their corners on the shape; taxels are then at most [`SAGITTA`] pitches inside the shape.

use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::inputs::object_files::read_surface;
use crate::mesh::{LengthUnit, SizeLimits, TriangleMesh};
use crate::world::{Link, LinkGeometry, LinkShape, MeshFolders, Robot, ShapeRole};
use glam::DVec3;
use std::path::Path;

/// Maximum distance between a facet and the round shape that it approximates, relative to the taxel pitch. With a larger value, taxels lie deeper; with a
/// smaller value, more triangles are needed.
const SAGITTA: f64 = 0.02;
/// Minimum distance between a facet and the round shape, relative to the radius of the shape. With a smaller value, the facets need more memory, although
/// taxels hardly move.
const FINEST: f64 = 1e-5;

/// Shapes of a robot link that are selected as a surface.
pub struct LinkSurface<'a> {
    /// Name of the robot link.
    pub link: &'a str,
    /// Role of the shapes that are selected from the link: visual or collision. If `None`, the collision shapes are selected if the link has any, otherwise the
    /// visual shapes.
    pub role: Option<ShapeRole>,
}

/// Returns the surface of the shapes of a robot link as a mesh in the link's frame. Round shapes are divided into facets that are fine enough for taxels at
/// this pitch (metres).
///
/// # Errors
/// If the robot has no such link, the link has no such shapes, or the mesh of a shape cannot be read.
pub fn link_surface(
    robot: &Robot,
    folders: &MeshFolders,
    surface: &LinkSurface,
    pitch: f64,
) -> Result<TriangleMesh> {
    let links = robot.links();
    let link = &links[robot.link(surface.link)?];
    let shapes = solids(link, surface.role);
    if shapes.is_empty() {
        let others = links
            .iter()
            .filter(|link| !solids(link, surface.role).is_empty());
        let others: Vec<String> = others.map(|link| format!("`{}`", link.name)).collect();
        let kind = kind(surface.role);
        let given = format!("a link without {kind}shapes that have a volume");
        let allowed = match others.len() {
            0 => format!("no link of robot `{}` has any", robot.name()),
            _ => format!("a link with such shapes: {}", others.join(", ")),
        };
        return Err(Error::input(format!("`{}`", link.name), given, allowed));
    }
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for shape in shapes {
        let mesh = match &shape.geometry {
            LinkGeometry::Mesh {
                file,
                mesh_from_file,
                scale,
            } => read_link_mesh(&folders.find(file)?, mesh_from_file, *scale)?,
            round_or_box => facets(round_or_box, pitch)?,
        };
        let first = vertices.len() as u32;
        let mesh = mesh.moved(&shape.origin);
        vertices.extend_from_slice(mesh.vertices());
        let corners = mesh.triangles().iter();
        triangles.extend(corners.map(|corners| corners.map(|corner| first + corner)));
    }
    TriangleMesh::in_unit(&link.name, LengthUnit::Metre, vertices, triangles)
}

/// Returns all shapes of a link that have the given role and a volume. Without a role, returns the collision shapes, or the visual shapes if there are none.
fn solids(link: &Link, role: Option<ShapeRole>) -> Vec<&LinkShape> {
    let of = |role: ShapeRole| -> Vec<&LinkShape> {
        let shapes = link.shapes.iter();
        shapes
            .filter(|shape| shape.role == role && shape.geometry.has_volume())
            .collect()
    };
    match role {
        Some(role) => of(role),
        None => Some(of(ShapeRole::Collision))
            .filter(|shapes| !shapes.is_empty())
            .unwrap_or_else(|| of(ShapeRole::Visual)),
    }
}

fn kind(role: Option<ShapeRole>) -> &'static str {
    match role {
        None => "",
        Some(ShapeRole::Collision) => "collision ",
        Some(ShapeRole::Visual) => "visual ",
    }
}

/// Reads a mesh file of a link, moves it by `mesh_from_file`, and multiplies the coordinates by `scale`. If the scale mirrors the mesh, its triangles are
/// turned, so that they still face outwards.
///
/// # Errors
/// If the mesh cannot be read, or its size is not plausible after scaling.
fn read_link_mesh(path: &Path, mesh_from_file: &Pose, scale: DVec3) -> Result<TriangleMesh> {
    // The scale of a file in millimetres is 0.001, so the size is known after scaling.
    let mesh = read_surface(path, None, &SizeLimits::UNLIMITED)?;
    let place = path.display().to_string();
    let mesh = mesh.moved(mesh_from_file).scaled(&place, scale)?;
    let SizeLimits {
        smallest, largest, ..
    } = SizeLimits::ANY;
    let length = mesh.bounds().size().max_element();
    if (smallest..=largest).contains(&length) {
        return Ok(mesh);
    }
    let given = format!("{length} m wide with the scale {scale}");
    let allowed = format!(
        "{smallest} m to {largest} m; the robot's file gives a mesh in millimetres the scale 0.001 0.001 0.001"
    );
    Err(Error::input(place, given, allowed))
}

/// Returns the facets of a primitive shape (such as a box, cylinder or ball) in the frame of the shape.
fn facets(geometry: &LinkGeometry, pitch: f64) -> Result<TriangleMesh> {
    const PLACE: &str = "shape";
    let tolerance = |radius: f64| (SAGITTA * pitch).max(FINEST * radius);
    match *geometry {
        LinkGeometry::Box { size } => TriangleMesh::cuboid(PLACE, size),
        LinkGeometry::Cylinder { radius, length } => {
            TriangleMesh::cylinder(PLACE, radius, length, tolerance(radius))
        }
        LinkGeometry::Capsule { radius, length } => {
            TriangleMesh::capsule(PLACE, radius, length, tolerance(radius))
        }
        LinkGeometry::Sphere { radius } => {
            TriangleMesh::capsule(PLACE, radius, 0.0, tolerance(radius))
        }
        LinkGeometry::Ellipsoid { semi_axes } => {
            TriangleMesh::ellipsoid(PLACE, semi_axes, tolerance(semi_axes.max_element()))
        }
        LinkGeometry::Mesh { ref file, .. } => {
            Err(Error::input(file, "a mesh", "a primitive shape"))
        }
    }
}
