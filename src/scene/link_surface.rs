//! Surface of a robot's link, over which skin can be draped. The shapes of the link form one triangle mesh in the link's frame, metres.
//!
//! Boxes are exact. Round shapes are divided into facets with their corners on the shape; taxels are then at most [`SAGITTA`] pitches inside the shape.

use super::plan_robot::PlannedRobot;
use super::reader::Reader;
use crate::error::{Error, Result};
use crate::inputs::object_files::read_mesh;
use crate::mesh::{SizeLimits, TriangleMesh};
use crate::world::{Link, LinkGeometry, LinkShape, ShapeRole};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::{Path, PathBuf};

/// Maximum distance between a facet and the round shape that it approximates, relative to the taxel pitch. With a larger value, taxels lie deeper; with a
/// smaller value, more triangles are needed.
const SAGITTA: f64 = 0.02;
/// Minimum and maximum number of facets that approximate a circle of a round shape. More facets would need memory without moving taxels noticeably.
const N_FACETS: [f64; 2] = [16.0, 720.0];

/// Shapes of a robot link that are selected as a surface.
pub(super) struct LinkSurface<'a> {
    /// Name of the robot link.
    pub link: &'a str,
    /// Role of the shapes that are selected from the link: visual or collision. If `None`, the collision shapes are selected if the link has any, otherwise the
    /// visual shapes.
    pub role: Option<ShapeRole>,
}

impl Reader<'_> {
    /// Returns the surface of the shapes of a robot link as a mesh. Round shapes are divided into facets that are fine enough for taxels at this pitch
    /// (metres).
    ///
    /// # Errors
    /// If the robot has no such link, the link has no such shapes, or the mesh of a shape cannot be read.
    pub(super) fn link_surface(
        &self,
        key: &str,
        robot: &PlannedRobot,
        surface: &LinkSurface,
        pitch: f64,
    ) -> Result<TriangleMesh> {
        let index = self.under(key, robot.robot.link(surface.link))?;
        let links = robot.robot.links();
        let link = &links[index];
        let shapes = solids(link, surface.role);
        if shapes.is_empty() {
            let others = links
                .iter()
                .filter(|link| !solids(link, surface.role).is_empty());
            let others: Vec<String> = others.map(|link| format!("`{}`", link.name)).collect();
            let (kind, allowed) = (kind(surface.role), others.join(", "));
            let given = format!(
                "`{}`, a link without {kind}shapes that have a volume",
                link.name
            );
            let allowed = match others.len() {
                0 => format!("no link of robot `{}` has any", robot.name),
                _ => format!("a link with such shapes: {allowed}"),
            };
            return Err(self.check.error(key, given, allowed));
        }
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for shape in shapes {
            let mesh = match &shape.geometry {
                LinkGeometry::Mesh { file, scale } => {
                    self.under(key, read_link_mesh(file, *scale, robot.folder.as_deref()))?
                }
                round_or_box => self.under(key, facets(round_or_box, pitch))?,
            };
            let first = vertices.len() as u32;
            let mesh = mesh.moved(&shape.origin);
            vertices.extend_from_slice(mesh.vertices());
            let corners = mesh.triangles().iter();
            triangles.extend(corners.map(|corners| corners.map(|corner| first + corner)));
        }
        self.under(key, TriangleMesh::new(&link.name, vertices, triangles))
    }
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

/// Reads a mesh file named in a URDF file in `folder`, and multiplies the coordinates by `scale`.
fn read_link_mesh(file: &str, scale: DVec3, folder: Option<&Path>) -> Result<TriangleMesh> {
    let Some(path) = find_mesh(file, folder.unwrap_or(Path::new(""))) else {
        let allowed =
            "a file beside the robot's, or in a folder above it that contains the package";
        return Err(Error::input(file, "a mesh that is not found", allowed));
    };
    let (mesh, orientation) = read_mesh(&path, None, &SizeLimits::ANY, None)?;
    let place = path.display().to_string();
    orientation.require(&place)?;
    let vertices = mesh.vertices().iter().map(|&vertex| scale * vertex);
    let mirrored = scale.to_array().iter().product::<f64>() < 0.0;
    let corners = |&[a, b, c]: &[u32; 3]| match mirrored {
        true => [a, c, b],
        false => [a, b, c],
    };
    let triangles = mesh.triangles().iter().map(corners);
    TriangleMesh::new(&place, vertices.collect(), triangles.collect())
}

/// Returns the path of a mesh file, given its name in a URDF file in `folder`: a path relative to the folder, `file://…`, or `package://NAME/…`. A package path
/// is searched in each parent folder, both as NAME/… and without NAME, because a copy of a package may have another name.
fn find_mesh(file: &str, folder: &Path) -> Option<PathBuf> {
    let in_package = ["package://", "model://"]
        .iter()
        .find_map(|start| file.strip_prefix(start));
    let Some(in_package) = in_package else {
        let path = folder.join(file.strip_prefix("file://").unwrap_or(file));
        return path.exists().then_some(path);
    };
    let inside = in_package
        .split_once('/')
        .map_or(in_package, |(_, inside)| inside);
    let folder = std::path::absolute(folder).ok()?;
    let mut found = folder
        .ancestors()
        .flat_map(|above| [above.join(in_package), above.join(inside)]);
    found.find(|path| path.is_file())
}

/// Returns the facets of a primitive shape (such as a box, cylinder or ball) in the frame of the shape.
fn facets(geometry: &LinkGeometry, pitch: f64) -> Result<TriangleMesh> {
    let (vertices, triangles) = match *geometry {
        LinkGeometry::Box { size } => return TriangleMesh::cuboid("shape", size),
        LinkGeometry::Cylinder { radius, length } => {
            let half = 0.5 * length;
            let profile = [(0.0, -half), (radius, -half), (radius, half), (0.0, half)];
            revolved(&profile, n_facets(radius, pitch))
        }
        LinkGeometry::Capsule { radius, length } => ball(radius, 0.5 * length, pitch),
        LinkGeometry::Sphere { radius } => ball(radius, 0.0, pitch),
        LinkGeometry::Mesh { .. } => (Vec::new(), Vec::new()),
    };
    TriangleMesh::new("shape", vertices, triangles)
}

type Facets = (Vec<DVec3>, Vec<[u32; 3]>);

/// Returns the facets of a ball, or of a capsule whose hemispheres are shifted by ±`half` along z.
fn ball(radius: f64, half: f64, pitch: f64) -> Facets {
    let n = n_facets(radius, pitch);
    let n_rings = n.div_ceil(4).max(2);
    let point = |ring: usize, sign: f64| {
        let (sin, cos) = (FRAC_PI_2 * ring as f64 / n_rings as f64).sin_cos();
        (radius * cos, sign * (half + radius * sin))
    };
    let pole = |sign: f64| (0.0, sign * (half + radius));
    let lower = (0..n_rings).rev().map(|ring| point(ring, -1.0));
    // A ball has only one equator ring.
    let upper = (usize::from(half == 0.0)..n_rings).map(|ring| point(ring, 1.0));
    let profile = std::iter::once(pole(-1.0)).chain(lower).chain(upper);
    let profile: Vec<(f64, f64)> = profile.chain([pole(1.0)]).collect();
    revolved(&profile, n)
}

/// Returns the number of facets of a circle for which the middle of each facet is at most [`SAGITTA`] times the pitch from the circle.
fn n_facets(radius: f64, pitch: f64) -> usize {
    let cos = (1.0 - SAGITTA * pitch / radius).max(0.0);
    (PI / cos.acos()).ceil().clamp(N_FACETS[0], N_FACETS[1]) as usize
}

/// Returns the surface of revolution of a profile about z, with n facets around each circle. The profile (r, z) starts at its lower end on the axis and ends at
/// its upper end.
fn revolved(profile: &[(f64, f64)], n: usize) -> Facets {
    let (lower, upper) = (profile[0].1, profile[profile.len() - 1].1);
    let rings = &profile[1..profile.len() - 1];
    let mut vertices = vec![DVec3::new(0.0, 0.0, lower), DVec3::new(0.0, 0.0, upper)];
    for &(r, z) in rings {
        vertices.extend((0..n).map(|facet| {
            let (sin, cos) = (TAU * facet as f64 / n as f64).sin_cos();
            DVec3::new(r * cos, r * sin, z)
        }));
    }
    let at = |ring: usize, facet: usize| (2 + ring * n + facet % n) as u32;
    let last = rings.len() - 1;
    let mut triangles = Vec::with_capacity(2 * n * rings.len());
    for facet in 0..n {
        triangles.push([0, at(0, facet + 1), at(0, facet)]);
        triangles.push([1, at(last, facet), at(last, facet + 1)]);
        for ring in 0..last {
            let [a, b] = [at(ring, facet), at(ring, facet + 1)];
            let [c, d] = [at(ring + 1, facet + 1), at(ring + 1, facet)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (vertices, triangles)
}
