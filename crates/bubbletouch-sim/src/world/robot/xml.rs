//! XML elements with their line numbers: typed access to their parts, and error messages.

use crate::error::{Error, Result};
use crate::geometry::{Pose, rotation_from_rpy, written_rotation};
use crate::text::spelling::{nearest_names, slip_of};
use glam::{DQuat, DVec3};
use roxmltree::Node;
use std::cell::RefCell;
use std::ops::Range;
use std::str::FromStr;

/// Line starts of a text that is composed of one or more files, and notes collected while the text is read.
#[derive(Default)]
pub(super) struct Lines {
    /// Names of the files, for messages.
    places: Vec<String>,
    /// Lines and parts of lines, ordered by their position in the text.
    starts: Vec<LineStart>,
    notes: RefCell<Vec<String>>,
}

/// Start of a line, or of a part of a line of another file.
struct LineStart {
    /// Byte position in the text.
    offset: usize,
    /// Index of the file.
    place: usize,
    /// Number of the line in its file, from 1.
    line: usize,
}

impl Lines {
    /// Creates the table of line starts of one file; `place` is the file's name.
    pub fn new(place: &str, text: &str) -> Self {
        let mut lines = Self::default();
        let place = lines.add_place(place);
        lines.add(place, 0, text, 0..text.len());
        lines
    }

    /// Adds a file without text, and returns its index.
    pub fn add_place(&mut self, place: &str) -> usize {
        self.places.push(place.to_owned());
        self.places.len() - 1
    }

    /// Adds the start positions of the lines in a byte range of the file's `text`. `offset` is the byte position of this range in the whole text.
    pub fn add(&mut self, place: usize, offset: usize, text: &str, range: Range<usize>) {
        let first = 1 + text[..range.start].matches('\n').count();
        let ends = text[range].match_indices('\n').map(|(end, _)| end + 1);
        let starts = std::iter::once(0).chain(ends).zip(first..);
        self.starts.extend(starts.map(|(start, line)| LineStart {
            offset: offset + start,
            place,
            line,
        }));
    }

    /// Adds a note, which is a sentence about the file, preceded by the file's name.
    pub fn note(&self, note: String) {
        self.notes.borrow_mut().push(note);
    }

    /// Returns the notes added so far, in their order.
    pub fn into_notes(self) -> Vec<String> {
        self.notes.into_inner()
    }

    fn at(&self, offset: usize) -> &LineStart {
        let next = self.starts.partition_point(|start| start.offset <= offset);
        &self.starts[next - 1]
    }
}

/// Element of an XML file.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    pub node: Node<'a, 'a>,
    pub lines: &'a Lines,
}

impl<'a> Element<'a> {
    /// Returns the line number of the element, from 1.
    pub fn line(&self) -> usize {
        self.lines.at(self.node.range().start).line
    }

    /// Returns an input error that names the file and the line of this element.
    pub fn refuse(&self, given: impl ToString, allowed: impl ToString) -> Error {
        let start = self.lines.at(self.node.range().start);
        let place = format!("{}, line {}", self.lines.places[start.place], start.line);
        Error::input(place, given, allowed)
    }

    /// Returns the value of an optional part of the file. If the part is invalid, the error becomes a note that ends with `consequence`, and `instead` is
    /// returned.
    pub fn or_note<T>(&self, part: Result<T>, instead: T, consequence: &str) -> T {
        part.unwrap_or_else(|error| {
            self.lines.note(format!("{error}: {consequence}"));
            instead
        })
    }

    /// Returns the child elements with this tag.
    pub fn children(self, tag: &'a str) -> impl Iterator<Item = Self> {
        let is_it = move |node: &Node| is_own(node) && node.tag_name().name() == tag;
        let children = self.node.children().filter(is_it);
        children.map(move |node| Self { node, ..self })
    }

    /// Returns the only child element with this tag, or `None`; returns an error if there are several.
    pub fn child(self, tag: &'a str) -> Result<Option<Self>> {
        let mut all = self.children(tag);
        let first = all.next();
        match all.next() {
            Some(second) => Err(second.refuse(format!("a second <{tag}>"), "at most one here")),
            None => Ok(first),
        }
    }

    /// Returns the only child element with this tag, or an error if it is missing.
    pub fn needed_child(self, tag: &'a str) -> Result<Self> {
        self.child(tag)?
            .ok_or_else(|| self.refuse(format!("{} without <{tag}>", self.called()), "exactly one"))
    }

    /// Returns the value of a required attribute.
    pub fn text(&self, attribute: &str) -> Result<&'a str> {
        self.node.attribute(attribute).ok_or_else(|| {
            let given = format!("{} without `{attribute}`", self.called());
            self.refuse(given, format!("the attribute `{attribute}`"))
        })
    }

    /// Returns the attribute `name`, which must not be empty.
    pub fn name(&self) -> Result<&'a str> {
        let name = self.text("name")?;
        if name.trim().is_empty() {
            return Err(self.refuse(format!("{} with an empty name", self.called()), "a name"));
        }
        Ok(name)
    }

    /// Returns the N finite numbers in the value of an attribute, or `None` if the attribute is missing.
    pub fn numbers<const N: usize>(&self, attribute: &str) -> Result<Option<[f64; N]>> {
        let Some(text) = self.node.attribute(attribute) else {
            return Ok(None);
        };
        let numbers = finite_numbers(text).and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        let allowed = || match N {
            1 => "a finite number".to_owned(),
            _ => format!("{N} finite numbers with spaces between"),
        };
        match numbers {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.refuse(format!("`{attribute}` \"{}\"", shortened(text)), allowed())),
        }
    }

    /// Returns the numbers in the value of an attribute, which are at most `n` finite numbers; none if the attribute is missing.
    pub fn up_to(&self, n: usize, attribute: &str) -> Result<Vec<f64>> {
        let text = self.node.attribute(attribute).unwrap_or_default();
        let numbers = finite_numbers(text).filter(|numbers| numbers.len() <= n);
        numbers.ok_or_else(|| {
            let given = format!("`{attribute}` \"{}\"", shortened(text));
            self.refuse(given, format!("at most {n} finite numbers"))
        })
    }

    /// Returns the value that belongs to the word of an attribute, or `None` if the attribute is missing.
    pub fn one_of<T: Copy>(&self, attribute: &str, words: &[(&str, T)]) -> Result<Option<T>> {
        let Some(given) = self.node.attribute(attribute) else {
            return Ok(None);
        };
        match words.iter().find(|(word, _)| *word == given) {
            Some((_, value)) => Ok(Some(*value)),
            None => {
                let names = words.iter().map(|(word, _)| *word);
                let given = format!("`{attribute}` \"{}\"", shortened(given));
                Err(self.refuse(given, nearest_names("", names)))
            }
        }
    }

    /// Returns the N finite numbers in the value of a required attribute.
    pub fn needed_numbers<const N: usize>(&self, attribute: &str) -> Result<[f64; N]> {
        self.text(attribute)?;
        Ok(self.numbers(attribute)?.expect("the attribute is there"))
    }

    /// Returns the finite number in the value of an attribute, or `None` if the attribute is missing.
    pub fn number(&self, attribute: &str) -> Result<Option<f64>> {
        Ok(self.numbers::<1>(attribute)?.map(|[number]| number))
    }

    /// Returns the pose in the child element `<origin>`; the identity if there is none. The attribute `rpy` rotates about the fixed axes x, y, z in this
    /// order; `quat_xyzw` (URDF 1.1) replaces this attribute.
    pub fn origin(self) -> Result<Pose> {
        self.check_origin()?;
        self.origin_ignoring_slips()
    }

    /// Returns an error if an attribute of `<origin>` is a misspelling.
    pub fn check_origin(self) -> Result<()> {
        let origin = self.child("origin")?;
        origin.map_or(Ok(()), |origin| {
            origin.check_attributes(&["xyz", "rpy", "quat_xyzw"])
        })
    }

    /// Returns the pose as [`origin`](Self::origin) does, but ignores misspelt attributes.
    pub fn origin_ignoring_slips(self) -> Result<Pose> {
        let Some(origin) = self.child("origin")? else {
            return Ok(Pose::IDENTITY);
        };
        let xyz = origin.numbers("xyz")?.unwrap_or([0.0; 3]);
        let rotation = match (origin.numbers("rpy")?, origin.numbers("quat_xyzw")?) {
            (Some(_), Some(_)) => {
                return Err(origin.refuse("both `rpy` and `quat_xyzw`", "one of them"));
            }
            (None, Some(xyzw)) => {
                let quaternion = DQuat::from_array(xyzw);
                written_rotation(quaternion).ok_or_else(|| {
                    let given = format!("a quaternion of length {}", quaternion.length());
                    origin.refuse(given, "length 1")
                })?
            }
            (rpy, None) => rotation_from_rpy(DVec3::from(rpy.unwrap_or([0.0; 3]))),
        };
        Ok(Pose::new(rotation, DVec3::from(xyz)))
    }

    /// Returns an error if the tag of a child element is a misspelling of a known tag. Unknown elements are ignored, because every simulator adds its own.
    pub fn check_tags(&self, known: &[&str]) -> Result<()> {
        for node in self.node.children().filter(is_own) {
            let tag = node.tag_name().name();
            if !known.contains(&tag)
                && let Some(meant) = slip_of(tag, known)
            {
                let child = Self { node, ..*self };
                return Err(child.refuse(format!("<{tag}>"), format!("perhaps <{meant}>")));
            }
        }
        Ok(())
    }

    /// Returns an error if the name of an attribute is a misspelling of a known name.
    pub fn check_attributes(&self, known: &[&str]) -> Result<()> {
        for attribute in self.node.attributes() {
            let name = attribute.name();
            if !known.contains(&name)
                && let Some(meant) = slip_of(name, known)
            {
                let given = format!("`{name}` in {}", self.called());
                return Err(self.refuse(given, format!("perhaps `{meant}`")));
            }
        }
        Ok(())
    }

    /// Returns the tag of the element, and its name if it has one, for error messages.
    pub fn called(&self) -> String {
        let tag = self.node.tag_name().name();
        match self.node.attribute("name") {
            Some(name) => format!("<{tag}> `{name}`"),
            None => format!("<{tag}>"),
        }
    }
}

/// Returns whether a node is an element of URDF. Elements in another namespace than the root's namespace belong to other tools.
fn is_own(node: &Node) -> bool {
    let root = node.document().root_element();
    node.is_element() && node.tag_name().namespace() == root.tag_name().namespace()
}

/// Returns the numbers of a text; `None` if a word is not a finite number.
fn finite_numbers(text: &str) -> Option<Vec<f64>> {
    // Some exporters write "1, 2, 3".
    let words = text.split(|c: char| c == ',' || c.is_whitespace());
    words.filter(|word| !word.is_empty()).map(finite).collect()
}

fn finite(word: &str) -> Option<f64> {
    let number = f64::from_str(word).ok()?;
    number.is_finite().then_some(number)
}

/// Returns the beginning of a long text, for messages.
fn shortened(text: &str) -> String {
    const LETTERS: usize = 60;
    let mut short: String = text.chars().take(LETTERS).collect();
    if text.chars().count() > LETTERS {
        short.push('…');
    }
    short
}
