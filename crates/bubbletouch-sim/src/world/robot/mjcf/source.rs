//! Text of an MJCF model: the main file with the text of each included file in place of its `<include>`.

use crate::error::{Error, Result};
use crate::text::encoding::decoded;
use crate::world::robot::mesh_folders::spellings;
use crate::world::robot::text::{parsed, repaired, unreadable};
use crate::world::robot::xml::{Element, Lines};
use std::collections::HashSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Text of a model, with the file and the line of each part.
#[derive(Default)]
pub(super) struct Source {
    /// Text of the whole model.
    pub text: String,
    /// Files and lines of the text.
    pub lines: Lines,
    included: HashSet<PathBuf>,
}

impl Source {
    /// Composes the text of the main file, whose path is `place`, and of all files that it includes.
    ///
    /// # Errors
    /// If a file is not well-formed XML, cannot be read, or is included twice.
    pub fn new(place: &str, text: &str) -> Result<Self> {
        let mut source = Self::default();
        let folder = folder_of(Path::new(place));
        source.included.insert(PathBuf::from(place));
        source.add(place, text, &folder, Part::Whole)?;
        Ok(source)
    }

    /// Adds a file, or the children of its root element.
    fn add(&mut self, place: &str, text: &str, model_folder: &Path, part: Part) -> Result<()> {
        let text = repaired(place, text, &self.lines);
        let document = parsed(&text).map_err(|e| unreadable(place, &text, &e, "MJCF"))?;
        let root = document.root_element();
        let range = match (part, root.first_child(), root.last_child()) {
            (Part::Whole, _, _) => 0..text.len(),
            (Part::Children, Some(first), Some(last)) => first.range().start..last.range().end,
            (Part::Children, _, _) => 0..0,
        };
        let file = self.lines.add_place(place);
        let own_lines = Lines::new(place, &text);
        let mut next = range.start;
        let includes = root.descendants();
        for node in includes.filter(|node| node.tag_name().name() == "include") {
            let element = Element {
                node,
                lines: &own_lines,
            };
            self.push(file, &text, next..node.range().start);
            self.include(element, model_folder, &folder_of(Path::new(place)))?;
            next = node.range().end;
        }
        self.push(file, &text, next..range.end);
        Ok(())
    }

    fn push(&mut self, file: usize, text: &str, range: Range<usize>) {
        self.lines.add(file, self.text.len(), text, range.clone());
        self.text += &text[range];
    }

    /// Adds the children of the root of an included file. The file is searched in the folder of the model, then in the folder of the including file.
    fn include(&mut self, element: Element, model_folder: &Path, own_folder: &Path) -> Result<()> {
        let name = element.text("file")?;
        let mut tried = Vec::new();
        for name in spellings(name) {
            tried.push(model_folder.join(&name));
            if own_folder != model_folder {
                tried.push(own_folder.join(&name));
            }
        }
        let Some(path) = tried.iter().find(|path| path.is_file()) else {
            let list: Vec<String> = tried
                .iter()
                .map(|path| path.display().to_string())
                .collect();
            let given = format!("`{name}`, a file that is not found");
            return Err(element.refuse(given, format!("a file at {}", list.join(" or "))));
        };
        if !self.included.insert(path.clone()) {
            let given = format!("`{name}`, a file that is included twice");
            return Err(element.refuse(given, "each file once"));
        }
        let place = path.display().to_string();
        let bytes = crate::files::read(path)
            .map_err(|e| Error::input(&place, format!("cannot be read ({e})"), "an MJCF file"))?;
        let (text, note) = decoded(&place, &bytes);
        note.into_iter().for_each(|note| self.lines.note(note));
        self.add(&place, &text, model_folder, Part::Children)
    }
}

/// Part of a file that is added to the text.
enum Part {
    /// The whole file.
    Whole,
    /// The children of the root element, as for an included file.
    Children,
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}
