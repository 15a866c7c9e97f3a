//! Model of one MJCF file: what the elements of the file refer to.

use super::classes::{Classes, Item};
use super::compiler::Compiler;
use super::geom::{Meshes, read_meshes};
use crate::error::Result;
use crate::files::spellings;
use crate::text::encoding::decoded;
use crate::text::xml::Element;
use crate::world::robot::source::{MJCF, Source};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Settings, default classes, meshes and other models to which the elements of a file refer.
pub(super) struct Model<'a> {
    pub root: Element<'a>,
    pub classes: Classes<'a>,
    pub compiler: Compiler,
    pub meshes: Meshes,
    /// Path of each model that `<attach>` can add, by its name.
    pub others: BTreeMap<String, PathBuf>,
    /// Number of models that contain this one.
    pub depth: usize,
}

impl<'a> Model<'a> {
    /// Reads the settings, classes and assets of the file at `path`.
    ///
    /// # Errors
    /// If the root is another element than `<mujoco>`, or a part is invalid.
    pub fn read(root: Element<'a>, path: &Path, depth: usize) -> Result<Self> {
        if root.tag() != "mujoco" {
            return Err(root.refuse(format!("{} as the root", root.called()), "MJCF: a <mujoco>"));
        }
        root.check_tags("compiler default asset worldbody equality include")?;
        let compiler = Compiler::read(root)?;
        let classes = Classes::read(root)?;
        // Names of meshes in an attached model are relative to another folder than the names in the whole model.
        let folder = path.parent().filter(|_| depth > 0);
        Ok(Self {
            root,
            meshes: read_meshes(root, &classes, &compiler, folder)?,
            classes,
            compiler,
            others: read_others(root, path)?,
            depth,
        })
    }

    /// Returns an element with its defaults: of its attribute `class`, otherwise of the class with the index `class`.
    ///
    /// # Errors
    /// If the element names a class that does not exist.
    pub fn item(&self, element: Element<'a>, class: usize) -> Result<Item<'_>> {
        let layers = self.classes.layers(element, class)?;
        Ok(Item::new(layers, &self.compiler))
    }

    /// Returns the `<body>` or `<frame>` that an attribute of `element` names, and the index of its default class. The attribute is called as the tag of the
    /// part.
    ///
    /// # Errors
    /// If there is no such part; the error has the line of `element`.
    pub fn part(&self, element: Element, tag: &str, name: &str) -> Result<(Element<'a>, usize)> {
        let parts = || self.root.whole_document().filter(|part| part.tag() == tag);
        let Some(part) = parts().find(|part| part.attribute("name") == Some(name)) else {
            let known = parts().filter_map(|part| part.attribute("name"));
            return Err(element.unknown(tag, &format!("{tag} of the model"), known));
        };
        for around in part.around() {
            if let Some(class) = self.classes.class_of(around, "childclass")? {
                return Ok((part, class));
            }
        }
        Ok((part, 0))
    }
}

/// Reads the elements `<asset><model name file/></asset>` of the file at `path`. The default name is the name in `<mujoco model="…">` of the other file, or the
/// name of the file.
fn read_others(root: Element, path: &Path) -> Result<BTreeMap<String, PathBuf>> {
    let mut others = BTreeMap::new();
    let assets = root.children("asset");
    for element in assets.flat_map(|asset| asset.children("model")) {
        let file = element.text("file")?;
        let tried = spellings(file)
            .into_iter()
            .map(|it| path.with_file_name(it));
        let tried: Vec<PathBuf> = tried.collect();
        let found = tried.iter().find(|path| path.is_file());
        let path = found.unwrap_or(&tried[0]).clone();
        let name = element.attribute("name").map(str::to_owned);
        let stem = || Some(path.file_stem()?.to_str()?.to_owned());
        let name = name.or_else(|| model_name(&path)).or_else(stem);
        others.insert(name.unwrap_or_else(|| file.to_owned()), path);
    }
    Ok(others)
}

/// Returns the name in `<mujoco model="…">` of a file; `None` if the file cannot be read or has no name.
fn model_name(path: &Path) -> Option<String> {
    let place = path.display().to_string();
    let (text, _) = decoded(&place, &crate::files::read(path).ok()?);
    let source = Source::one_file(MJCF, &place, &text);
    let document = source.document().ok()?;
    let name = document.root_element().attribute("model")?;
    Some(name.to_owned())
}
