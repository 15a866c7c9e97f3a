//! Loading of objects from built-in sets, TOML files, and folders of meshes.

use crate::error::{Error, Result};
use crate::files::SetName;
use crate::inputs::content_hash::sha256;
use crate::inputs::objects_spec::{ModelSpec, ObjectsSpec};
use crate::inputs::packings::pack_within;
use crate::inputs::units::millimetres;
use crate::mesh::{
    LengthUnit, MeshFile, MeshFormat, Orientation, SizeLimits, Surface, TriangleMesh, Welded,
};
use crate::note::note;
use crate::objects::{
    Catalogue, Entry, MeshModel, Object, SphereUnion, read_spheres, vertex_spheres,
};
use crate::packing::{Body, packing_error};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Number of points on a mesh at which the distance to its vertex spheres (one sphere per vertex) is measured. With a larger value, the measurement is slower;
/// with a smaller value, the largest distance may be missed.
const N_ERROR_POINTS: usize = 2000;

/// Mesh of a study, with its name and path.
#[derive(Clone, Debug)]
pub struct NamedMesh {
    /// Name of the mesh file without extension.
    pub name: String,
    /// Path of the mesh file, for error messages.
    pub place: String,
    /// Triangle mesh, in metres.
    pub mesh: TriangleMesh,
}

/// Builds all objects of a study: first the objects of the sets in order, then the meshes sorted by file name. If the folder `packings` is given, packed meshes
/// are read from it or written to it.
///
/// # Errors
/// If a set, name or file does not exist, an object is given twice, a mesh cannot be packed, or the selection is empty.
pub fn load_objects(spec: &ObjectsSpec, packings: Option<&Path>) -> Result<Vec<Object>> {
    let tolerance = spec.surface_error();
    let mut objects = Vec::new();
    for set in &spec.sets {
        let entries = set_entries(set, spec.names.as_deref())?;
        let built = entries.par_iter().map(|entry| entry.build(tolerance));
        objects.extend(built.collect::<Result<Vec<_>>>()?);
    }
    if let Some(folder) = &spec.meshes {
        objects.extend(load_meshes(folder, spec, packings)?);
    }
    check_names(objects.iter().map(|object| object.name.as_str()), spec)?;
    Ok(objects)
}

/// Reads a TOML file of objects as a set; the set has the name of the file.
///
/// # Errors
/// If the file cannot be read or does not describe objects.
pub fn load_catalogue(path: &Path) -> Result<Catalogue> {
    let place = path.display().to_string();
    let text = crate::files::read_to_string(path).map_err(|e| {
        let given = format!("cannot be read ({e})");
        Error::input(&place, given, "a TOML file of objects")
    })?;
    Catalogue::parse(&place, &place, &text)
}

/// Returns the SHA-256 hash of each object's source (mesh file or parts of the solid), by object name.
///
/// # Errors
/// Returns the errors of [`load_objects`].
pub fn objects_content(spec: &ObjectsSpec) -> Result<BTreeMap<String, String>> {
    let mut content = BTreeMap::new();
    for set in &spec.sets {
        for entry in set_entries(set, spec.names.as_deref())? {
            content.insert(entry.name.clone(), solid_content(&entry));
        }
    }
    if let Some(folder) = &spec.meshes {
        for path in mesh_paths(folder, spec)? {
            content.insert(stem(&path), file_content(&path)?);
        }
    }
    Ok(content)
}

/// Returns the SHA-256 hash of a solid. Other versions of the program may compute another hash.
fn solid_content(entry: &Entry) -> String {
    sha256(format!("{:?}", entry.solid))
}

/// Returns whether an object with this name and SHA-256 hash is a built-in object of this version of the program.
///
/// # Errors
/// If the built-in catalogue cannot be read.
pub fn is_built_in(name: &str, hash: &str) -> Result<bool> {
    let builtin = Catalogue::builtin()?;
    let mut entries = builtin.entries().iter();
    Ok(entries.any(|entry| entry.name == name && solid_content(entry) == hash))
}

/// Returns the SHA-256 hash of a file's content.
///
/// # Errors
/// If the file cannot be read.
pub fn file_content(path: &Path) -> Result<String> {
    let bytes = crate::files::read(path).map_err(|e| Error::io(path, "read", e))?;
    Ok(sha256(bytes))
}

/// Reads a mesh file, and converts it to metres. Without a unit, the numbers are metres or in the unit that the file contains, and the size must be within
/// `sizes`.
///
/// # Errors
/// If the file cannot be read, has an unknown extension, or contains no such mesh.
pub fn read_mesh_file(
    path: &Path,
    unit: Option<LengthUnit>,
    sizes: &SizeLimits,
) -> Result<MeshFile> {
    let format = MeshFormat::from_path(path)?;
    check_regular(path)?;
    let place = path.display().to_string();
    format.read(&place, unit, sizes, open(path, "a mesh")?)
}

/// Reads spheres from a CSV file with columns x, y, z, r. Without a unit, the numbers are metres, and the size must be within `sizes`.
///
/// # Errors
/// If the file cannot be read or contains no such spheres.
pub fn load_spheres(
    path: &Path,
    unit: Option<LengthUnit>,
    sizes: &SizeLimits,
) -> Result<SphereUnion> {
    let place = path.display().to_string();
    read_spheres(&place, unit, sizes, open(path, "a CSV of spheres")?)
}

fn open(path: &Path, allowed: &str) -> Result<BufReader<File>> {
    let file = crate::files::open(path).map_err(|error| {
        let given = format!("cannot be opened ({error})");
        Error::input(path.display(), given, allowed)
    })?;
    Ok(BufReader::new(file))
}

/// Returns an error if a mesh path is a folder, a pipe or a device, because reading might not end.
fn check_regular(path: &Path) -> Result<()> {
    let given = match std::fs::metadata(path) {
        Ok(meta) if meta.is_dir() => "a folder",
        Ok(meta) if !meta.is_file() => "a pipe, a socket or a device",
        // Other errors are reported when the file is opened.
        _ => return Ok(()),
    };
    let allowed = format!("a {} file", MeshFormat::ENDINGS);
    Err(Error::input(path.display(), given, allowed))
}

/// Builds an object from a mesh file as `spec` requires; the name of the object is the file name without extension. If the folder `packings` is given, packings
/// are read from it or written to it. If vertex spheres are far from the mesh, a note is printed on standard error.
///
/// # Errors
/// If the file cannot be read, the size is outside the allowed range, or the mesh cannot be converted to the requested model.
pub fn load_mesh(path: &Path, spec: &ObjectsSpec, packings: Option<&Path>) -> Result<Object> {
    let built = build_mesh(path, spec, packings)?;
    note_vertex_spheres(std::slice::from_ref(&built), spec);
    Ok(built.object)
}

/// Object that was built from a mesh file.
struct BuiltMesh {
    object: Object,
    /// Maximum distance between a mesh and the spheres around its vertices, metres; `None` for other models and for meshes without faces.
    vertex_error: Option<f64>,
}

fn build_mesh(path: &Path, spec: &ObjectsSpec, packings: Option<&Path>) -> Result<BuiltMesh> {
    let place = path.display().to_string();
    let mesh = read_mesh_file(path, spec.unit, &spec.sizes())?;
    let closed = |file| outward_mesh(file, &place, spec.close_holes()).map(|(mesh, _)| mesh);
    let mut vertex_error = None;
    let model = match spec.model.unwrap_or_default() {
        ModelSpec::VertexSpheres => {
            let spheres = vertex_spheres(&place, mesh.vertices())?;
            if spec.pitch.is_some() {
                vertex_error = vertex_sphere_error(mesh, &spheres);
            }
            spheres.into()
        }
        ModelSpec::Mesh => MeshModel::new(closed(mesh)?).into(),
        ModelSpec::Packed => {
            let surface = Surface::new(closed(mesh)?);
            let packed = pack_within(&place, &surface, spec.surface_error(), packings)?;
            packed.spheres.into()
        }
    };
    Ok(BuiltMesh {
        object: Object::of_one_part(stem(path), model),
        vertex_error,
    })
}

/// Returns the largest distance between points on a mesh and the spheres around its vertices, metres. Returns `None` if the file has no faces, or faces that
/// are not convex.
fn vertex_sphere_error(file: MeshFile, spheres: &SphereUnion) -> Option<f64> {
    let (mesh, _) = file.into_mesh("").ok()?.turned_outwards();
    let is_closed = Welded::new(&mesh).n_unbalanced() == 0;
    let body = if is_closed { Body::Solid } else { Body::Sheet };
    let error = packing_error(&Surface::new(mesh), body, spheres, N_ERROR_POINTS);
    Some(error.protrusion.max.max(error.gap.max))
}

/// Prints a note on standard error if the vertex spheres of an object are farther than half a pitch from its mesh.
fn note_vertex_spheres(built: &[BuiltMesh], spec: &ObjectsSpec) {
    let Some(pitch) = spec.pitch else { return };
    let errors = built
        .iter()
        .filter_map(|b| Some((b.vertex_error?, &b.object.name)));
    let far: Vec<_> = errors.filter(|(error, _)| *error > 0.5 * pitch).collect();
    let Some((largest, name)) = far.iter().max_by(|(a, _), (b, _)| a.total_cmp(b)) else {
        return;
    };
    let meshes = match built.len() {
        1 => String::new(),
        n => format!(" in {} of {n} meshes", far.len()),
    };
    note(format_args!(
        "vertex spheres are up to {:.2} mm from the surface ({name}), more than half the pitch of {} mm{meshes}; \
         model = \"mesh\" touches meshes exactly",
        1e3 * largest,
        millimetres(pitch)
    ));
}

/// Reads the triangles of a mesh file, and orients the faces of closed parts outwards. Returns the mesh and its orientation. Holes of up to `close_holes`
/// metres are closed first. Changes are reported on standard error.
///
/// # Errors
/// If [`read_mesh_file`] fails, a face is not convex, or the width is negative.
pub fn read_mesh(
    path: &Path,
    unit: Option<LengthUnit>,
    sizes: &SizeLimits,
    close_holes: Option<f64>,
) -> Result<(TriangleMesh, Orientation)> {
    let place = path.display().to_string();
    outward_mesh(read_mesh_file(path, unit, sizes)?, &place, close_holes)
}

/// Reads a mesh file whose faces have a known outer side.
///
/// # Errors
/// If [`read_mesh`] fails, or the faces of an open part do not agree on the outer side.
pub fn read_surface(
    path: &Path,
    unit: Option<LengthUnit>,
    sizes: &SizeLimits,
) -> Result<TriangleMesh> {
    let (mesh, orientation) = read_mesh(path, unit, sizes, None)?;
    orientation.require(&path.display().to_string())?;
    Ok(mesh)
}

/// Converts a mesh file to triangles with outward normals, as [`read_mesh`] does.
fn outward_mesh(
    file: MeshFile,
    place: &str,
    close_holes: Option<f64>,
) -> Result<(TriangleMesh, Orientation)> {
    let note = |text: &dyn Display| note(format_args!("{place}: {text}"));
    let (mut mesh, mut orientation) = file.into_mesh(place)?.turned_outwards();
    if orientation.is_turned() {
        note(&orientation);
    }
    if let Some(widest) = close_holes {
        let closed = mesh.with_holes_closed(widest)?;
        if !closed.widths.is_empty() {
            note(&closed);
        }
        (mesh, orientation) = closed.mesh.turned_outwards();
        if orientation.is_turned() {
            note(&orientation);
        }
    }
    Ok((mesh, orientation))
}

/// Reads all meshes of a study as triangle meshes, ordered by file name.
///
/// # Errors
/// If a mesh cannot be read.
pub fn load_named_meshes(folder: &Path, spec: &ObjectsSpec) -> Result<Vec<NamedMesh>> {
    let paths = mesh_paths(folder, spec)?;
    let meshes = paths.par_iter().map(|path| {
        let place = path.display().to_string();
        let (mesh, _) = read_mesh(path, spec.unit, &spec.sizes(), spec.close_holes())?;
        Ok(NamedMesh {
            name: stem(path),
            place,
            mesh,
        })
    });
    let meshes = meshes.collect::<Result<Vec<_>>>()?;
    check_names(meshes.iter().map(|mesh| mesh.name.as_str()), spec)?;
    Ok(meshes)
}

/// Returns the objects of a built-in set or of a TOML file that have the given names; all objects if no names are given.
pub(crate) fn set_entries(set: &SetName, names: Option<&[String]>) -> Result<Vec<Entry>> {
    let mut entries: Vec<Entry> = match set {
        SetName::File(path) => load_catalogue(path)?.entries().to_vec(),
        SetName::BuiltIn(name) => {
            let builtin = Catalogue::builtin()?;
            builtin.set(name)?.into_iter().cloned().collect()
        }
    };
    entries.retain(|entry| is_wanted(&entry.name, names));
    Ok(entries)
}

fn load_meshes(folder: &Path, spec: &ObjectsSpec, packings: Option<&Path>) -> Result<Vec<Object>> {
    if spec.close_holes_mm.is_some() && spec.model.unwrap_or_default() == ModelSpec::VertexSpheres {
        let given = "a study whose meshes become spheres around their vertices";
        let allowed = "it only with model = \"packed\" or \"mesh\"";
        return Err(Error::input("key objects.close_holes_mm", given, allowed));
    }
    let paths = mesh_paths(folder, spec)?;
    let meshes = paths
        .par_iter()
        .map(|path| build_mesh(path, spec, packings));
    let meshes = meshes.collect::<Result<Vec<_>>>()?;
    note_vertex_spheres(&meshes, spec);
    Ok(meshes.into_iter().map(|built| built.object).collect())
}

fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Returns the paths of the mesh files in a folder that the specification selects, ordered by name.
fn mesh_paths(folder: &Path, spec: &ObjectsSpec) -> Result<Vec<PathBuf>> {
    let listing = std::fs::read_dir(folder).map_err(|e| {
        let given = format!("cannot be read ({e})");
        Error::input(folder.display(), given, "a folder of meshes")
    })?;
    let paths = listing.map(|entry| entry.map(|entry| entry.path()));
    let paths = paths.collect::<std::io::Result<Vec<_>>>();
    let mut paths = paths.map_err(|e| Error::io(folder, "read", e))?;
    paths.retain(|path| MeshFormat::from_path(path).is_ok());
    let n_meshes = paths.len();
    paths.retain(|path| is_wanted(&stem(path), spec.names.as_deref()));
    let (given, allowed) = match (paths.len(), n_meshes) {
        (0, 0) => (
            "no meshes".to_owned(),
            &*format!("at least two {} files", MeshFormat::ENDINGS),
        ),
        (0, n) => (
            format!("{n} meshes, none of them named in objects.names"),
            "no objects.names in the study, or names of these files without their endings",
        ),
        _ => {
            paths.sort();
            paths.iter().try_for_each(|path| check_regular(path))?;
            return Ok(paths);
        }
    };
    Err(Error::input(folder.display(), given, allowed))
}

fn is_wanted(name: &str, names: Option<&[String]>) -> bool {
    names.is_none_or(|names| names.iter().any(|wanted| wanted == name))
}

fn check_names<'a>(names: impl Iterator<Item = &'a str>, spec: &ObjectsSpec) -> Result<()> {
    let mut seen = BTreeSet::new();
    let key = "key objects";
    for name in names {
        if !seen.insert(name) {
            let given = format!("two objects named {name}");
            let allowed = "each name once over all sets and meshes";
            return Err(Error::input(key, given, allowed));
        }
    }
    let mut wanted = spec.names.iter().flatten();
    if let Some(name) = wanted.find(|name| !seen.contains(name.as_str())) {
        let allowed = "a name in the sets and meshes (bubbletouch objects lists them)";
        return Err(Error::input("key objects.names", name, allowed));
    }
    match seen.is_empty() {
        true => Err(Error::input(key, "no objects", "at least two")),
        false => Ok(()),
    }
}
