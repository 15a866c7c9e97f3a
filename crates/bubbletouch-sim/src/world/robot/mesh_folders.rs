//! Search for the mesh files that a robot's file names.

use crate::error::{Error, Result};
use crate::files::spellings;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folders in which mesh files of a robot are searched.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFolders {
    /// Folder of the robot's file.
    pub folder: PathBuf,
    /// Folders of packages by their names, for addresses such as `package://NAME/meshes/link.stl`.
    pub packages: BTreeMap<String, PathBuf>,
}

impl MeshFolders {
    /// Creates the search for meshes of the robot's file at `path`.
    pub fn beside(path: &Path, packages: BTreeMap<String, PathBuf>) -> Self {
        Self {
            folder: path.parent().unwrap_or(Path::new("")).to_owned(),
            packages,
        }
    }

    /// Returns the path of a mesh file, given its name in the robot's file. The name is a path relative to the robot's file, `file://…`, `package://NAME/…`,
    /// `model://NAME/…` or `$(find NAME)/…`. A package is searched in its folder in `packages`. A package that is not listed is searched in each folder above
    /// the robot's file. Paths with and without NAME are searched there, because a copy of a package may have another name.
    ///
    /// # Errors
    /// If there is no such file; the message lists what was tried.
    pub fn find(&self, file: &str) -> Result<PathBuf> {
        let tried = self.candidates(file);
        if let Some(found) = tried.iter().find(|path| path.is_file()) {
            return Ok(found.clone());
        }
        const SHOWN: usize = 4;
        let shown = tried.iter().take(SHOWN);
        let mut list: Vec<String> = shown.map(|path| path.display().to_string()).collect();
        if tried.len() > SHOWN {
            list.push(format!("{} more", tried.len() - SHOWN));
        }
        let hint = match package_of(file) {
            Some((name, _)) if !self.packages.contains_key(name) => {
                format!("packages = {{ {name} = \"FOLDER\" }}, or ")
            }
            _ => String::new(),
        };
        let allowed = format!(
            "{hint}a file at one of the paths tried: {}",
            list.join(", ")
        );
        Err(Error::input(file, "a mesh that is not found", allowed))
    }

    /// Returns the paths at which a mesh file is searched, in this order.
    fn candidates(&self, file: &str) -> Vec<PathBuf> {
        let Some((name, inside)) = package_of(file) else {
            let address = ["file://", "file:"];
            let path = address.iter().find_map(|scheme| file.strip_prefix(scheme));
            return spellings(path.unwrap_or(file))
                .into_iter()
                .map(|path| self.folder.join(path))
                .collect();
        };
        let inside = spellings(inside);
        if let Some(folder) = self.packages.get(name) {
            return inside.iter().map(|inside| folder.join(inside)).collect();
        }
        let folder = std::path::absolute(&self.folder).unwrap_or_else(|_| self.folder.clone());
        let above = folder.ancestors();
        above
            .flat_map(|above| {
                let of = |inside: &String| [above.join(name).join(inside), above.join(inside)];
                inside.iter().flat_map(of).collect::<Vec<_>>()
            })
            .collect()
    }
}

/// Returns the name of the package and the path inside the package, if the name of a mesh file is the address of a package.
fn package_of(file: &str) -> Option<(&str, &str)> {
    if let Some(rest) = file
        .strip_prefix("file://")
        .unwrap_or(file)
        .strip_prefix("$(find ")
    {
        let (name, inside) = rest.split_once(')')?;
        return Some((name.trim(), inside.trim_start_matches('/')));
    }
    let schemes = ["package://", "model://", "package:/"];
    let rest = schemes
        .iter()
        .find_map(|scheme| file.strip_prefix(scheme))?;
    rest.split_once('/')
}
