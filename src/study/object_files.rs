//! Objects from where a study finds them: built-in sets, TOML files, folders of meshes.

use super::spec::{ModelSpec, ObjectsSpec};
use crate::error::{Error, Result};
use crate::mesh::{LengthUnit, MeshFile, MeshFormat};
use crate::objects::{Catalogue, Entry, MeshModel, Object, vertex_spheres};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Builds the objects of a study: sets first, in their order, then meshes by file name.
///
/// The error names a set, name or file that is not there, an object that two sources share, or an empty selection.
pub fn load_objects(spec: &ObjectsSpec) -> Result<Vec<Object>> {
    let tolerance = spec.surface_error_mm * 1e-3;
    let mut objects = Vec::new();
    for set in &spec.sets {
        objects.extend(load_set(set, spec.names.as_deref(), tolerance)?);
    }
    if let Some(folder) = &spec.meshes {
        objects.extend(load_meshes(folder, spec)?);
    }
    check_names(&objects, spec)?;
    Ok(objects)
}

/// The built-in catalogue, or that of a TOML file, by the set's name.
fn entries(set: &str) -> Result<Vec<Entry>> {
    if !set.ends_with(".toml") {
        let builtin = Catalogue::builtin()?;
        return Ok(builtin.set(set)?.into_iter().cloned().collect());
    }
    let text = std::fs::read_to_string(set)
        .map_err(|e| Error::input(set, format!("cannot be read ({e})"), "a file of objects"))?;
    Ok(Catalogue::parse(set, set, &text)?.entries().to_vec())
}

/// What a PLY, OBJ or STL file holds, in metres.
pub fn read_mesh_file(path: &Path, unit: LengthUnit) -> Result<MeshFile> {
    let format = MeshFormat::of(path)?;
    let place = path.display().to_string();
    let file = File::open(path)
        .map_err(|e| Error::input(&place, format!("cannot be opened ({e})"), "a mesh"))?;
    format.read(&place, unit, BufReader::new(file))
}

/// A mesh file as an object; its name is the file's without the ending.
pub fn load_mesh(path: &Path, unit: LengthUnit, model: ModelSpec) -> Result<Object> {
    let place = path.display().to_string();
    let mesh = read_mesh_file(path, unit)?;
    let name = path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    Ok(Object {
        name,
        model: match model {
            ModelSpec::VertexSpheres => vertex_spheres(&place, mesh.vertices())?.into(),
            ModelSpec::Mesh => MeshModel::new(mesh.into_mesh(&place)?).into(),
        },
        n_parts: 1,
    })
}

fn load_set(set: &str, names: Option<&[String]>, tolerance: f64) -> Result<Vec<Object>> {
    entries(set)?
        .par_iter()
        .filter(|entry| is_wanted(&entry.name, names))
        .map(|entry| entry.build(tolerance))
        .collect()
}

fn load_meshes(folder: &Path, spec: &ObjectsSpec) -> Result<Vec<Object>> {
    let listing = std::fs::read_dir(folder).map_err(|e| {
        Error::input(
            folder.display(),
            format!("cannot be read ({e})"),
            "a folder of meshes",
        )
    })?;
    let mut paths: Vec<PathBuf> = Vec::new();
    for entry in listing {
        let path = entry.map_err(|e| Error::io(folder, "read", e))?.path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        if MeshFormat::of(&path).is_ok() && is_wanted(&stem, spec.names.as_deref()) {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        return Err(Error::input(
            folder.display(),
            "no meshes",
            "at least two .ply, .obj or .stl files",
        ));
    }
    paths.sort();
    let unit = spec
        .mesh_unit
        .map_or_else(LengthUnit::default, LengthUnit::from);
    let model = spec.model.unwrap_or_default();
    paths
        .par_iter()
        .map(|path| load_mesh(path, unit, model))
        .collect()
}

fn is_wanted(name: &str, names: Option<&[String]>) -> bool {
    names.is_none_or(|names| names.iter().any(|wanted| wanted == name))
}

fn check_names(objects: &[Object], spec: &ObjectsSpec) -> Result<()> {
    let mut seen = BTreeSet::new();
    for object in objects {
        if !seen.insert(object.name.as_str()) {
            return Err(Error::input(
                "key objects",
                format!("two objects named {}", object.name),
                "each name once over all sets and meshes",
            ));
        }
    }
    for name in spec.names.iter().flatten() {
        if !seen.contains(name.as_str()) {
            return Err(Error::input(
                "key objects.names",
                name,
                "a name in the sets and meshes (bubbletouch objects lists them)",
            ));
        }
    }
    if objects.is_empty() {
        return Err(Error::input("key objects", "no objects", "at least two"));
    }
    Ok(())
}
