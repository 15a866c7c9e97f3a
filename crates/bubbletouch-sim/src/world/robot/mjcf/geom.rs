//! Geoms: shapes of links for drawing and for contacts, and the mesh files that they use.

use super::classes::{Classes, Item};
use super::compiler::Compiler;
use super::orientation::{from_z_to, pose_of, quaternion_of};
use crate::error::Result;
use crate::geometry::Pose;
use crate::text::spelling::nearest_names;
use crate::text::xml::{Element, NOT_ZERO};
use crate::world::robot::{LinkGeometry, LinkShape, ShapeRole};
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;

/// Largest group of geoms that MuJoCo's viewer shows unless its settings change.
const LAST_SHOWN_GROUP: f64 = 2.0;

/// Mesh assets of a model by their names. A mesh without a file, whose vertices are in the model, is `None`.
pub(super) type Meshes = BTreeMap<String, Option<LinkGeometry>>;

/// Reads the elements `<asset><mesh>`. Names of files become absolute paths if they are relative to `folder`.
///
/// # Errors
/// If an attribute is invalid, or a mesh has neither a name nor a file.
pub(super) fn read_meshes<'a>(
    root: Element<'a>,
    classes: &Classes<'a>,
    compiler: &Compiler,
    folder: Option<&Path>,
) -> Result<Meshes> {
    let mut meshes = Meshes::new();
    let assets = root.children("asset");
    for element in assets.flat_map(|asset| asset.children("mesh")) {
        let item = Item::new(classes.layers(element, 0)?, compiler);
        let file = element.attribute("file");
        let stem = file.and_then(|file| Path::new(file).file_stem()?.to_str());
        let Some(name) = element.attribute("name").or(stem) else {
            return Err(element.refuse("<mesh> without a name and a file", "a name or a file"));
        };
        let scale = item.layer(&["scale"]).numbers_in("scale", &NOT_ZERO)?;
        let file_from_mesh = Pose::new(
            quaternion_of(&item, "refquat")?,
            item.vector("refpos", DVec3::ZERO)?,
        );
        let absolute = |file: String| match folder {
            Some(folder) if !file.contains("://") => {
                let path = folder.join(file);
                let path = std::path::absolute(&path).unwrap_or(path);
                path.display().to_string()
            }
            _ => file,
        };
        let mesh = file.map(|file| LinkGeometry::Mesh {
            file: absolute(compiler.mesh_path(file)),
            mesh_from_file: file_from_mesh.inverse(),
            scale: scale.map_or(DVec3::ONE, DVec3::from),
        });
        meshes.insert(name.to_owned(), mesh);
    }
    Ok(meshes)
}

/// Reads a `<geom>`. A geom that can touch others (`contype` or `conaffinity` is not zero) is a collision shape. A geom that cannot, or that MuJoCo's viewer
/// shows (group 0 to 2), is a visual shape. A geom can have both roles.
///
/// # Errors
/// If an attribute is invalid, or the geom is not a shape that a link can have.
pub(super) fn read_geom(
    item: &Item,
    body_from_frame: &Pose,
    meshes: &Meshes,
) -> Result<Vec<LinkShape>> {
    let own = item.own();
    own.check_attributes(
        "name class type contype conaffinity condim group priority size material friction mass density shellinertia solmix solref solimp margin gap \
         surfacevel adhesion fromto pos quat axisangle xyaxes zaxis euler hfield mesh fitscale rgba fluidshape fluidcoef user",
    )?;
    let (frame_from_shape, length) = extent(item)?;
    let geometry = geometry(item, length, meshes)?;
    let can_touch = item.number("contype", 1.0)? != 0.0 || item.number("conaffinity", 1.0)? != 0.0;
    let is_shown = item.number("group", 0.0)? <= LAST_SHOWN_GROUP;
    let roles = [
        (ShapeRole::Visual, is_shown || !can_touch),
        (ShapeRole::Collision, can_touch),
    ];
    let roles = roles.into_iter().filter(|(_, has_role)| *has_role);
    let shapes = roles.map(|(role, _)| LinkShape {
        role,
        geometry: geometry.clone(),
        origin: body_from_frame.compose(&frame_from_shape),
    });
    Ok(shapes.collect())
}

/// Returns the pose of a geom or site, and half its length if `fromto` gives the ends of its z axis.
///
/// # Errors
/// If an attribute is invalid, or both ends are the same point.
pub(super) fn extent(item: &Item) -> Result<(Pose, Option<f64>)> {
    let Some([a, b, c, d, e, f]) = item.numbers("fromto")? else {
        return Ok((pose_of(item)?, None));
    };
    let (from, to) = (DVec3::new(a, b, c), DVec3::new(d, e, f));
    let Some(direction) = (from - to).try_normalize() else {
        let given = format!("{} with `fromto` of length zero", item.own().called());
        return Err(item.own().refuse(given, "two different points"));
    };
    let pose = Pose::new(from_z_to(direction), 0.5 * (from + to));
    Ok((pose, Some(0.5 * from.distance(to))))
}

fn geometry(item: &Item, half_length: Option<f64>, meshes: &Meshes) -> Result<LinkGeometry> {
    let own = item.own();
    let kind = item.text("type").unwrap_or("sphere");
    let mesh = item.text("mesh");
    if let (Some(mesh), true) = (mesh, kind != "mesh" && kind != "sdf") {
        let given = format!("a {kind} fitted to mesh `{mesh}`");
        return Err(own.refuse(given, "type \"mesh\", or a size instead of the mesh"));
    }
    let [first, second, third] = item.first_numbers("size", [0.0; 3])?;
    if [first, second, third].iter().any(|size| *size < 0.0) {
        let given = format!("{} with a negative size", own.called());
        return Err(own.refuse(given, "positive sizes"));
    }
    // With `fromto`, the length replaces the number of `size` along z.
    let half = half_length.unwrap_or(second);
    let sides = half_length.map_or(DVec3::new(first, second, third), |half| {
        DVec3::new(first, first, half)
    });
    Ok(match kind {
        "sphere" => LinkGeometry::Sphere { radius: first },
        "capsule" => LinkGeometry::Capsule {
            radius: first,
            length: 2.0 * half,
        },
        "cylinder" => LinkGeometry::Cylinder {
            radius: first,
            length: 2.0 * half,
        },
        "ellipsoid" => LinkGeometry::Ellipsoid { semi_axes: sides },
        "box" => LinkGeometry::Box { size: 2.0 * sides },
        "mesh" | "sdf" => {
            let Some(name) = mesh else {
                return Err(own.refuse(format!("{} without `mesh`", own.called()), "a mesh asset"));
            };
            let Some(mesh) = meshes.get(name) else {
                let names = meshes.keys().map(String::as_str);
                return Err(item.layer(&["mesh"]).unknown("mesh", "mesh asset", names));
            };
            mesh.clone().ok_or_else(|| {
                let given = format!("mesh `{name}` with vertices in the model");
                own.refuse(given, "a mesh with a file")
            })?
        }
        other => {
            let known = "sphere capsule cylinder ellipsoid box mesh sdf plane hfield";
            let known = nearest_names(other, known.split(' '));
            return Err(own.refuse(format!("`type` \"{other}\""), known));
        }
    })
}
