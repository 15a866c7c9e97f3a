//! Text of a robot's file. A model in MJCF has the text of each included file in place of its `<include>`.

use super::text::repaired;
use crate::error::Result;
use crate::files::spellings;
use crate::text::encoding::decoded;
use crate::text::xml::{Element, Format, Lines, document};
use roxmltree::Document;
use std::collections::HashSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Unified robot description format.
pub(super) const URDF: Format = Format {
    name: "URDF",
    root: "robot",
};
/// MuJoCo's format.
pub(super) const MJCF: Format = Format {
    name: "MJCF",
    root: "mujoco",
};

/// Text of a robot's file, with the file and the line of each part.
pub(super) struct Source {
    format: Format,
    place: String,
    text: String,
    /// Files and lines of the text.
    pub lines: Lines,
    included: HashSet<PathBuf>,
    /// Files of which each includes the next, without links and `..`.
    open: Vec<PathBuf>,
}

impl Source {
    /// Prepares the text of a file, whose path is `place`.
    pub fn one_file(format: Format, place: &str, text: &str) -> Self {
        let mut source = Self::empty(format, place);
        let text = repaired(place, text, &source.lines);
        let file = source.lines.add_place(place);
        source.push(file, &text, 0..text.len());
        source
    }

    /// Composes the text of an MJCF file, whose path is `place`, and of all files that it includes.
    ///
    /// # Errors
    /// If a file is not well-formed XML, cannot be read, or is included twice.
    pub fn mjcf(place: &str, text: &str) -> Result<Self> {
        let mut source = Self::empty(MJCF, place);
        source.included.insert(PathBuf::from(place));
        source.open.extend(Path::new(place).canonicalize().ok());
        source.add(place, text, Part::Whole)?;
        Ok(source)
    }

    fn empty(format: Format, place: &str) -> Self {
        Self {
            format,
            place: place.to_owned(),
            text: String::new(),
            lines: Lines::default(),
            included: HashSet::new(),
            open: Vec::new(),
        }
    }

    /// Returns the elements of the text.
    ///
    /// # Errors
    /// If the text is not well-formed XML.
    pub fn document(&self) -> Result<Document<'_>> {
        document(self.format, &self.place, &self.text)
    }

    /// Adds a file, or the children of its root element.
    fn add(&mut self, place: &str, text: &str, part: Part) -> Result<()> {
        let text = repaired(place, text, &self.lines);
        let document = document(self.format, place, &text)?;
        let own_lines = Lines::new(place, &text);
        let root = Element::root(&document, &own_lines);
        let node = root.node;
        let range = match (part, node.first_child(), node.last_child()) {
            (Part::Whole, _, _) => 0..text.len(),
            (Part::Children, Some(first), Some(last)) => first.range().start..last.range().end,
            (Part::Children, _, _) => 0..0,
        };
        let file = self.lines.add_place(place);
        let mut next = range.start;
        let includes = root.whole_document().skip(1);
        for include in includes.filter(|element| element.tag() == "include") {
            self.push(file, &text, next..include.range().start);
            self.include(include, Path::new(place))?;
            next = include.range().end;
        }
        self.push(file, &text, next..range.end);
        Ok(())
    }

    fn push(&mut self, file: usize, text: &str, range: Range<usize>) {
        self.lines.add(file, self.text.len(), text, range.clone());
        self.text += &text[range];
    }

    /// Adds the children of the root of a file that the file at `path` includes. The included file is searched in the folder of the model, then in the folder
    /// of the including file.
    fn include(&mut self, element: Element, path: &Path) -> Result<()> {
        let name = element.text("file")?;
        let mut tried = Vec::new();
        for name in spellings(name) {
            tried.push(Path::new(&self.place).with_file_name(&name));
            tried.push(path.with_file_name(&name));
        }
        tried.dedup();
        let Some(path) = tried.iter().find(|path| path.is_file()) else {
            let list = tried.iter().map(|path| path.display().to_string());
            let list: Vec<String> = list.collect();
            let given = format!("`{name}`, a file that is not found");
            return Err(element.refuse(given, format!("a file at {}", list.join(" or "))));
        };
        // A file may include itself by another path.
        let open = path.canonicalize().unwrap_or_else(|_| path.clone());
        if self.open.contains(&open) || !self.included.insert(path.clone()) {
            let given = format!("`{name}`, a file that is included twice");
            return Err(element.refuse(given, "each file once"));
        }
        let text = file_text(path, element, &self.lines)?;
        self.open.push(open);
        self.add(&path.display().to_string(), &text, Part::Children)?;
        self.open.pop();
        Ok(())
    }
}

/// Part of a file that is added to the text.
enum Part {
    /// The whole file.
    Whole,
    /// The children of the root element, as for an included file.
    Children,
}

/// Returns the text of an MJCF file to which an element refers. A note on its encoding is added to `lines`.
///
/// # Errors
/// If the file cannot be read.
pub(super) fn file_text(path: &Path, element: Element, lines: &Lines) -> Result<String> {
    let place = path.display();
    let bytes = crate::files::read(path).map_err(|error| {
        let given = format!("{place}: cannot be read ({error})");
        element.refuse(given, "an MJCF file")
    })?;
    let (text, note) = decoded(&place.to_string(), &bytes);
    note.into_iter().for_each(|note| lines.note(note));
    Ok(text)
}
