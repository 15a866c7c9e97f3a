//! Paths in files: relative to the folder of the file that contains them, until they are made absolute by their type.

use crate::error::{Error, Result};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize, Serializer};
use std::cell::RefCell;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A path that a file contains, as it is written. [`with_absolute_paths`] finds every value of this type in a specification.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(transparent)]
pub struct FilePath(PathBuf);

thread_local! {
    /// While a specification is copied by [`with_absolute_paths`]: the folder that its paths are relative to.
    static FOLDER: RefCell<Option<PathBuf>> = const { RefCell::new(None) };
}

impl Deref for FilePath {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

impl<P: Into<PathBuf>> From<P> for FilePath {
    fn from(path: P) -> Self {
        Self(path.into())
    }
}

impl Serialize for FilePath {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        FOLDER.with_borrow(|folder| match folder {
            Some(folder) => {
                let path = folder.join(&self.0);
                std::path::absolute(&path)
                    .unwrap_or(path)
                    .serialize(serializer)
            }
            None => self.0.serialize(serializer),
        })
    }
}

/// Returns the same specification with every [`FilePath`] in it absolute; relative ones are taken from `folder`. A key of that type cannot
/// be forgotten: the specification is copied through TOML, and each path is joined as it is written.
///
/// # Errors
/// If the specification of `place` has no form in TOML, such as a whole number above 2⁶³ − 1.
pub fn with_absolute_paths<T: Serialize + DeserializeOwned>(
    place: &str,
    spec: &T,
    folder: &Path,
) -> Result<T> {
    FOLDER.set(Some(folder.to_owned()));
    let written = toml::Value::try_from(spec);
    FOLDER.set(None);
    let copied = written
        .map_err(|error| error.to_string())
        .and_then(|written| {
            let read: std::result::Result<T, _> = written.try_into();
            read.map_err(|error| error.to_string())
        });
    copied.map_err(|error| Error::input(place, error, "what TOML can hold"))
}

#[cfg(test)]
mod tests {
    use super::*;

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
