//! XML documents and their elements with line numbers: typed access to the parts of an element, and error messages.

use crate::error::{Error, Result};
use crate::text::numbers::finite_number;
use crate::text::spelling::{nearest_names, slip_of};
use glam::DVec3;
use roxmltree::{Document, Node, ParsingOptions};
use std::cell::RefCell;
use std::ops::Range;

/// Line starts of a text that is composed of one or more files, and notes collected while the text is read.
#[derive(Default)]
pub(crate) struct Lines {
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

    /// Returns the notes added so far, in their order, and forgets them.
    pub fn take_notes(&self) -> Vec<String> {
        self.notes.take()
    }

    fn at(&self, offset: usize) -> &LineStart {
        let next = self.starts.partition_point(|start| start.offset <= offset);
        &self.starts[next - 1]
    }
}

/// Format of an XML file.
#[derive(Clone, Copy)]
pub(crate) struct Format {
    /// Name of the format, for messages.
    pub name: &'static str,
    /// Name of the root element.
    pub root: &'static str,
}

/// Parses the XML text; document type declarations are ignored.
pub(crate) fn parsed(text: &str) -> std::result::Result<Document<'_>, roxmltree::Error> {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options)
}

/// Parses the XML text of the file `place`.
///
/// # Errors
/// If the text is not well-formed XML; the error contains the line.
pub(crate) fn document<'t>(format: Format, place: &str, text: &'t str) -> Result<Document<'t>> {
    let Format { name, root } = format;
    parsed(text).map_err(|error| {
        if text.trim().is_empty() {
            return Error::input(place, "an empty file", format!("{name}: a <{root}>"));
        }
        let said = error.to_string().replace('\n', " ");
        // The XML reader appends its own position; here the position precedes the message.
        let given = said
            .rsplit_once(" at ")
            .map_or(said.as_str(), |(given, _)| given);
        // The XML reader has no position for the end of the text.
        let line = match error {
            roxmltree::Error::UnexpectedEndOfStream | roxmltree::Error::UnclosedRootNode => {
                text.lines().count() as u32
            }
            _ => error.pos().row,
        };
        let place = format!("{place}, line {line}");
        Error::input(place, given, format!("{name}: well-formed XML"))
    })
}

/// Element of an XML file.
#[derive(Clone, Copy)]
pub(crate) struct Element<'a> {
    pub node: Node<'a, 'a>,
    pub lines: &'a Lines,
}

/// Range of the numbers of an attribute: the test of a number, and the words of a message.
pub(crate) struct Allowed(fn(f64) -> bool, &'static str);

/// Lengths of shapes.
pub(crate) const LENGTHS: Allowed = Allowed(
    |number| number >= 0.0,
    "lengths in metres, zero or positive",
);
/// Lengths of shapes with a volume.
pub(crate) const POSITIVE: Allowed = Allowed(|number| number > 0.0, "positive lengths in metres");
/// Largest velocities and forces.
pub(crate) const NOT_NEGATIVE: Allowed =
    Allowed(|number| number >= 0.0, "zero or a positive number");
/// Scales of meshes.
pub(crate) const NOT_ZERO: Allowed =
    Allowed(|number| number != 0.0, "three numbers other than zero");

impl<'a> Element<'a> {
    /// Returns the root element of a document.
    pub fn root(document: &'a Document<'a>, lines: &'a Lines) -> Self {
        Self {
            node: document.root_element(),
            lines,
        }
    }

    /// Returns the name of the element's tag.
    pub fn tag(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Returns the text of an attribute, or `None` if it is missing.
    pub fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// Returns the byte range of the element in the text.
    pub fn range(&self) -> Range<usize> {
        self.node.range()
    }

    /// Returns the line number of the element, from 1.
    pub fn line(&self) -> usize {
        self.lines.at(self.range().start).line
    }

    /// Returns the file and the line of the element, for messages.
    pub fn place(&self) -> String {
        let start = self.lines.at(self.range().start);
        format!("{}, line {}", self.lines.places[start.place], start.line)
    }

    /// Returns an input error that names the file and the line of this element.
    pub fn refuse(&self, given: impl ToString, allowed: impl ToString) -> Error {
        Error::input(self.place(), given, allowed)
    }

    /// Returns the error of an attribute with the name of a thing that does not exist; `names` are the names of all things of its kind.
    pub fn unknown<'n>(
        &self,
        attribute: &str,
        kind: &str,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Error {
        let name = self.attribute(attribute).unwrap_or_default();
        let given = format!("`{attribute}` \"{name}\", which is no {kind}");
        self.refuse(given, nearest_names(name, names))
    }

    /// Adds a note about a fault that is no error; `consequence` is the end of the note.
    pub fn note(&self, given: impl ToString, allowed: impl ToString, consequence: &str) {
        self.or_note(Err(self.refuse(given, allowed)), (), consequence);
    }

    /// Returns the value of an optional part of the file. If the part is invalid, the error becomes a note that ends with `consequence`, and `instead` is
    /// returned.
    pub fn or_note<T>(&self, part: Result<T>, instead: T, consequence: &str) -> T {
        part.unwrap_or_else(|error| {
            self.lines.note(format!("{error}: {consequence}"));
            instead
        })
    }

    /// Returns the child elements. Elements in another namespace than the root's namespace belong to other tools and are left out; elements without a namespace
    /// are not.
    pub fn elements(self) -> impl Iterator<Item = Self> {
        let namespace = |node: &Node<'a, 'a>| node.tag_name().namespace();
        let own = namespace(&self.node.document().root_element());
        let is_own = move |node: &Node<'a, 'a>| {
            node.is_element() && namespace(node).is_none_or(|space| Some(space) == own)
        };
        let children = self.node.children().filter(is_own);
        children.map(move |node| Self { node, ..self })
    }

    /// Returns the child elements with this tag.
    pub fn children(self, tag: &'a str) -> impl Iterator<Item = Self> {
        self.elements().filter(move |child| child.tag() == tag)
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

    /// Returns this element and all elements in it, in the order of the file.
    pub fn descendants(self) -> impl Iterator<Item = Self> {
        let all = self.node.descendants().filter(Node::is_element);
        all.map(move |node| Self { node, ..self })
    }

    /// Returns all elements of the document, in the order of the file.
    pub fn whole_document(self) -> impl Iterator<Item = Self> {
        let node = self.node.document().root_element();
        Self { node, ..self }.descendants()
    }

    /// Returns the elements around this element, from the inside out.
    pub fn around(self) -> impl Iterator<Item = Self> {
        let all = self.node.ancestors().skip(1).filter(Node::is_element);
        all.map(move |node| Self { node, ..self })
    }

    /// Returns the value of a required attribute.
    pub fn text(&self, attribute: &str) -> Result<&'a str> {
        self.needed(attribute, self.attribute(attribute))
    }

    fn needed<T>(&self, attribute: &str, value: Option<T>) -> Result<T> {
        value.ok_or_else(|| {
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
        let Some(text) = self.attribute(attribute) else {
            return Ok(None);
        };
        let numbers = finite_numbers(text).and_then(|numbers| <[f64; N]>::try_from(numbers).ok());
        numbers.map(Some).ok_or_else(|| {
            let allowed = match N {
                1 => "a finite number".to_owned(),
                _ => format!("{N} finite numbers with spaces between"),
            };
            self.refuse(format!("`{attribute}` \"{}\"", shortened(text)), allowed)
        })
    }

    /// Returns the numbers of an attribute as `numbers` does, or an error if a number is out of range.
    pub fn numbers_in<const N: usize>(
        &self,
        attribute: &str,
        allowed: &Allowed,
    ) -> Result<Option<[f64; N]>> {
        let &Allowed(is_allowed, words) = allowed;
        match self.numbers(attribute)? {
            Some(numbers) if !numbers.into_iter().all(is_allowed) => {
                let text = self.attribute(attribute).unwrap_or_default();
                Err(self.refuse(format!("`{attribute}` {}", shortened(text)), words))
            }
            numbers => Ok(numbers),
        }
    }

    /// Returns the N finite numbers in the value of a required attribute.
    pub fn needed_numbers<const N: usize>(&self, attribute: &str) -> Result<[f64; N]> {
        self.needed(attribute, self.numbers(attribute)?)
    }

    /// Returns the N numbers of a required attribute, which must be in a range.
    pub fn needed_in<const N: usize>(
        &self,
        attribute: &str,
        allowed: &Allowed,
    ) -> Result<[f64; N]> {
        self.needed(attribute, self.numbers_in(attribute, allowed)?)
    }

    /// Returns the finite number in the value of an attribute, or `None` if the attribute is missing.
    pub fn number(&self, attribute: &str) -> Result<Option<f64>> {
        Ok(self.numbers::<1>(attribute)?.map(|[number]| number))
    }

    /// Returns the integer from `least` to `most` in the value of an attribute, or `None` if the attribute is missing.
    pub fn integer(&self, attribute: &str, least: usize, most: usize) -> Result<Option<usize>> {
        let Some(number) = self.number(attribute)? else {
            return Ok(None);
        };
        if (least as f64..=most as f64).contains(&number) && number.fract() == 0.0 {
            return Ok(Some(number as usize));
        }
        let given = format!("`{attribute}` {number}");
        Err(self.refuse(given, format!("an integer from {least} to {most}")))
    }

    /// Returns the integer of a required attribute as `integer` does.
    pub fn needed_integer(&self, attribute: &str, least: usize, most: usize) -> Result<usize> {
        self.needed(attribute, self.integer(attribute, least, most)?)
    }

    /// Returns the vector in the value of an attribute, or `default` if the attribute is missing.
    pub fn vector(&self, attribute: &str, default: DVec3) -> Result<DVec3> {
        Ok(self.numbers(attribute)?.map_or(default, DVec3::from))
    }

    /// Returns the numbers in the value of an attribute, which are at most `n` finite numbers; none if the attribute is missing.
    pub fn up_to(&self, n: usize, attribute: &str) -> Result<Vec<f64>> {
        let text = self.attribute(attribute).unwrap_or_default();
        let numbers = finite_numbers(text).filter(|numbers| numbers.len() <= n);
        numbers.ok_or_else(|| {
            let given = format!("`{attribute}` \"{}\"", shortened(text));
            self.refuse(given, format!("at most {n} finite numbers"))
        })
    }

    /// Returns the value that belongs to the word of an attribute, or `None` if the attribute is missing.
    pub fn one_of<T: Copy>(&self, attribute: &str, words: &[(&str, T)]) -> Result<Option<T>> {
        let Some(given) = self.attribute(attribute) else {
            return Ok(None);
        };
        let found = words.iter().find(|(word, _)| *word == given);
        found.map(|&(_, value)| Some(value)).ok_or_else(|| {
            let names = words.iter().map(|(word, _)| *word);
            let given = format!("`{attribute}` \"{}\"", shortened(given));
            self.refuse(given, nearest_names("", names))
        })
    }

    /// Returns an error if the tag of a child element is a misspelling of one of the `known` words. Unknown elements are ignored, because every simulator adds
    /// its own.
    pub fn check_tags(&self, known: &str) -> Result<()> {
        self.elements()
            .try_for_each(|child| match slip(child.tag(), known) {
                Some(meant) => {
                    let given = format!("<{}>", child.tag());
                    Err(child.refuse(given, format!("perhaps <{meant}>")))
                }
                None => Ok(()),
            })
    }

    /// Returns an error if the name of an attribute is a misspelling of one of the `known` words.
    pub fn check_attributes(&self, known: &str) -> Result<()> {
        let mut names = self.node.attributes().map(|attribute| attribute.name());
        names.try_for_each(|name| match slip(name, known) {
            Some(meant) => {
                let given = format!("`{name}` in {}", self.called());
                Err(self.refuse(given, format!("perhaps `{meant}`")))
            }
            None => Ok(()),
        })
    }

    /// Returns the tag of the element, and its name if it has one, for error messages.
    pub fn called(&self) -> String {
        let tag = self.tag();
        match self.attribute("name") {
            Some(name) => format!("<{tag}> `{name}`"),
            None => format!("<{tag}>"),
        }
    }
}

/// Returns the word of a list of words, separated by spaces, of which an unknown word is a misspelling; `None` for a known word.
fn slip<'k>(word: &str, known: &'k str) -> Option<&'k str> {
    let known = known.split(' ');
    match known.clone().any(|other| other == word) {
        true => None,
        false => slip_of(word, &known.collect::<Vec<_>>()),
    }
}

/// Returns the unit vector along a direction of any length; `None` if the length is zero.
pub(crate) fn unit_direction(direction: DVec3) -> Option<DVec3> {
    // Scaled first, so that no square overflows or underflows.
    (direction / direction.abs().max_element()).try_normalize()
}

/// Returns the numbers of a text; `None` if a word is not a finite number.
fn finite_numbers(text: &str) -> Option<Vec<f64>> {
    // Some exporters write "1, 2, 3".
    let words = text.split(|c: char| c == ',' || c.is_whitespace());
    let words = words.filter(|word| !word.is_empty());
    words.map(finite_number).collect()
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
