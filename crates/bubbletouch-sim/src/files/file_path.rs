//! Paths in study and scene files. A relative path is relative to the folder of its file; resolved files contain absolute paths.

use crate::error::Error;
use crate::text::note::note;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::cell::RefCell;
use std::ops::Deref;
use std::path::{Path, PathBuf};

thread_local! {
    /// Folder of the file that this thread is parsing; `None` if paths are kept as written.
    static FOLDER: RefCell<Option<PathBuf>> = const { RefCell::new(None) };
    /// Folder of the file whose specification this thread converts to absolute paths ([`with_absolute_paths`]).
    static FOLDER_OF_COPY: RefCell<Option<PathBuf>> = const { RefCell::new(None) };
}

/// Path of a file or a folder in a study file.
///
/// A relative path is relative to the folder of the study file ([`with_folder`]). If the path exists only relative to the current folder, this file is used,
/// with a note on standard error. Serialization writes an absolute path, so that a resolved study runs from any folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FilePath {
    written: PathBuf,
    resolved: PathBuf,
}

/// Runs `parse` with paths relative to `folder`; with `None`, paths are kept as written.
pub fn with_folder<T>(folder: impl Into<Option<PathBuf>>, parse: impl FnOnce() -> T) -> T {
    /// Guard that restores the previously set folder, even if parsing panics.
    struct Before(Option<PathBuf>);
    impl Drop for Before {
        fn drop(&mut self) {
            FOLDER.set(self.0.take());
        }
    }
    let _before = Before(FOLDER.replace(folder.into()));
    parse()
}

impl FilePath {
    /// Returns the path as written in the study file.
    pub fn as_written(&self) -> &Path {
        &self.written
    }

    /// Returns the resolved path. If the study file was parsed without a folder, a relative path is resolved relative to `folder`.
    pub fn within(&self, folder: &Path) -> PathBuf {
        match self.resolved == self.written {
            true => folder.join(&self.written),
            false => self.resolved.clone(),
        }
    }

    fn resolve(written: PathBuf) -> Self {
        let folder = FOLDER.with_borrow(Option::clone);
        let resolved = folder.map_or_else(|| written.clone(), |folder| folder.join(&written));
        if resolved != written && !resolved.exists() && written.exists() {
            note(format_args!(
                "{} is relative to the current folder; the next version looks for it as {}, relative to the study file",
                written.display(),
                resolved.display()
            ));
            // The path is made absolute, so that no folder is prepended to it.
            let resolved = std::path::absolute(&written).unwrap_or_else(|_| written.clone());
            return Self { written, resolved };
        }
        Self { written, resolved }
    }

    /// Returns the absolute path, with symbolic links to folders resolved if the path exists. A link to a file keeps its name and its folder, because the ending
    /// of the name determines the format, and other files are relative to the folder.
    fn absolute(&self) -> PathBuf {
        let path = std::path::absolute(&self.resolved).unwrap_or_else(|_| self.resolved.clone());
        let canonical = match (path.is_file(), path.parent(), path.file_name()) {
            (true, Some(folder), Some(name)) => folder.canonicalize().map(|it| it.join(name)),
            _ => path.canonicalize(),
        };
        canonical.unwrap_or(path)
    }
}

impl<P: Into<PathBuf>> From<P> for FilePath {
    fn from(path: P) -> Self {
        let path = path.into();
        Self {
            written: path.clone(),
            resolved: path,
        }
    }
}

impl Deref for FilePath {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.resolved
    }
}

impl AsRef<Path> for FilePath {
    fn as_ref(&self) -> &Path {
        self
    }
}

impl<'de> Deserialize<'de> for FilePath {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        PathBuf::deserialize(deserializer).map(Self::resolve)
    }
}

impl Serialize for FilePath {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        FOLDER_OF_COPY.with_borrow(|folder| match folder {
            Some(folder) => {
                let path = folder.join(&self.resolved);
                std::path::absolute(&path)
                    .unwrap_or(path)
                    .serialize(serializer)
            }
            None => self.absolute().serialize(serializer),
        })
    }
}

/// Returns a copy of a specification in which every [`FilePath`] is absolute; relative paths are resolved relative to `folder`. The copy is made by
/// serialization to TOML and parsing. Each path is resolved during serialization, so no key can be missed.
///
/// # Errors
/// If the specification of `place` cannot be represented in TOML, for example because of an integer above 2⁶³ − 1.
pub fn with_absolute_paths<T: Serialize + DeserializeOwned>(
    place: &str,
    spec: &T,
    folder: &Path,
) -> crate::Result<T> {
    FOLDER_OF_COPY.set(Some(folder.to_owned()));
    let written = toml::Value::try_from(spec);
    FOLDER_OF_COPY.set(None);
    let copied = written
        .map_err(|error| error.to_string())
        .and_then(|written| {
            let read: Result<T, _> = written.try_into();
            read.map_err(|error| error.to_string())
        });
    copied.map_err(|error| Error::input(place, error, "what TOML can hold"))
}

/// Deserializes a path. If the file is parsed with a folder, the path becomes absolute.
///
/// # Errors
/// If the value is not a string.
pub fn file_path<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PathBuf, D::Error> {
    let path = FilePath::deserialize(deserializer)?;
    let has_folder =
        FOLDER.with_borrow(Option::is_some) && !path.as_written().as_os_str().is_empty();
    Ok(match has_folder {
        true => path.absolute(),
        false => path.written,
    })
}

/// Deserializes an optional path. If the file is parsed with a folder, the path becomes absolute.
///
/// # Errors
/// If the value is not a string.
pub fn optional_file_path<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<PathBuf>, D::Error> {
    file_path(deserializer).map(Some)
}

/// Name of a built-in set of objects, or path of a TOML file with objects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SetName {
    /// Name of a built-in object set.
    BuiltIn(String),
    /// Path of a TOML file with objects.
    File(FilePath),
}

impl From<&str> for SetName {
    fn from(name: &str) -> Self {
        match name.ends_with(".toml") {
            true => Self::File(name.into()),
            false => Self::BuiltIn(name.to_owned()),
        }
    }
}

impl<'de> Deserialize<'de> for SetName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Ok(match name.ends_with(".toml") {
            true => Self::File(FilePath::resolve(name.into())),
            false => Self::BuiltIn(name),
        })
    }
}

impl Serialize for SetName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::BuiltIn(name) => name.serialize(serializer),
            Self::File(path) => path.serialize(serializer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, Deserialize)]
    struct Spec {
        mesh: FilePath,
        sets: Vec<SetName>,
    }

    #[test]
    fn paths_are_relative_to_the_file_and_written_absolute() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        let text = "mesh = \"a/b.obj\"\nsets = [\"balls\", \"own.toml\"]";
        let spec: Spec = with_folder(root.clone(), || toml::from_str(text)).unwrap();
        assert_eq!(&*spec.mesh, root.join("a/b.obj"));
        assert_eq!(spec.mesh.as_written(), Path::new("a/b.obj"));
        let again: toml::Table = toml::to_string(&spec).unwrap().parse().unwrap();
        let expected = root.join("a/b.obj").display().to_string();
        assert_eq!(again["mesh"].as_str(), Some(&*expected));
        let own = root.join("own.toml").display().to_string();
        let sets = again["sets"].as_array().unwrap();
        assert_eq!(sets[0].as_str(), Some("balls"));
        assert_eq!(sets[1].as_str(), Some(&*own));
        // Outside `with_folder`, the folder is unknown.
        let spec: Spec = toml::from_str(text).unwrap();
        assert_eq!(&*spec.mesh, Path::new("a/b.obj"));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_file_keeps_its_name_and_its_folder() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        for name in ["real", "links"] {
            std::fs::create_dir(root.join(name)).unwrap();
        }
        std::fs::write(root.join("real/1f3a"), "").unwrap();
        symlink("../real/1f3a", root.join("links/b.obj")).unwrap();
        symlink("links", root.join("meshes")).unwrap();
        for (written, expected) in [
            ("meshes/../links/b.obj", "links/b.obj"),
            ("meshes/b.obj", "links/b.obj"),
            ("meshes", "links"),
        ] {
            let absolute = FilePath::from(root.join(written)).absolute();
            assert_eq!(absolute, root.join(expected));
        }
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Inner {
        number: f64,
        files: Vec<FilePath>,
    }

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Outer {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        path: Option<FilePath>,
        inner: Inner,
        word: String,
    }

    #[test]
    fn every_path_of_the_type_becomes_absolute_and_nothing_else_changes() {
        let spec = Outer {
            path: Some("a/b.toml".into()),
            inner: Inner {
                number: 0.1 + 0.2,
                files: vec!["c.ply".into(), "/d.ply".into()],
            },
            word: "e.ply".to_owned(),
        };
        let folder = Path::new("/of/the/file");
        let absolute = with_absolute_paths("s.toml", &spec, folder).unwrap();
        let expected = Outer {
            path: Some("/of/the/file/a/b.toml".into()),
            inner: Inner {
                number: 0.1 + 0.2,
                files: vec!["/of/the/file/c.ply".into(), "/d.ply".into()],
            },
            word: "e.ply".to_owned(),
        };
        assert_eq!(absolute, expected);
        let again = with_absolute_paths("s.toml", &absolute, Path::new("/elsewhere")).unwrap();
        assert_eq!(again, expected);
    }
}
