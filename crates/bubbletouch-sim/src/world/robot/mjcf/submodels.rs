//! Models in other files that a model can attach: `<asset><model name file/></asset>`.

use crate::error::Result;
use crate::text::encoding::decoded;
use crate::world::robot::mesh_folders::spellings;
use crate::world::robot::text::{parsed, repaired};
use crate::world::robot::xml::{Element, Lines};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Files of the models that can be attached, and the files around them.
#[derive(Clone, Debug, Default)]
pub(super) struct SubModels {
    /// Path of each model by its name.
    pub paths: BTreeMap<String, PathBuf>,
    /// Nesting depth: the number of models that contain this one.
    pub depth: usize,
    /// Number of models that have been read.
    pub n_read: Rc<Cell<usize>>,
}

impl SubModels {
    /// Reads the elements `<asset><model>` of the model whose file is `place`.
    ///
    /// # Errors
    /// If a model has no file.
    pub fn read(root: Element, place: &str, around: &Self) -> Result<Self> {
        let folder = Path::new(place).parent().unwrap_or(Path::new(""));
        let mut paths = BTreeMap::new();
        let assets = root.children("asset");
        for element in assets.flat_map(|asset| asset.children("model")) {
            let file = element.text("file")?;
            let tried: Vec<PathBuf> = spellings(file)
                .iter()
                .map(|file| folder.join(file))
                .collect();
            let found = tried.iter().find(|path| path.is_file());
            let path = found.unwrap_or(&tried[0]).clone();
            let name = element.node.attribute("name").map(str::to_owned);
            let stem = || Some(path.file_stem()?.to_str()?.to_owned());
            let name = name.or_else(|| model_name(&path)).or_else(stem);
            paths.insert(name.unwrap_or_else(|| file.to_owned()), path);
        }
        Ok(Self {
            paths,
            depth: around.depth + 1,
            n_read: around.n_read.clone(),
        })
    }
}

/// Returns the name in `<mujoco model="…">` of a file; `None` if the file cannot be read or has no name.
fn model_name(path: &Path) -> Option<String> {
    let place = path.display().to_string();
    let (text, _) = decoded(&place, &crate::files::read(path).ok()?);
    let text = repaired(&place, &text, &Lines::new(&place, &text));
    let document = parsed(&text).ok()?;
    let name = document.root_element().attribute("model")?;
    Some(name.to_owned())
}
