//! Limits of counts in a model. With larger values, a small file can fill the memory, take minutes, or overflow the stack.

use crate::error::Result;
use crate::text::xml::Element;

/// Largest number of things of a kind, and the words for these things.
pub(super) struct Limit(usize, &'static str);

/// Bodies of a model.
pub(super) const BODIES: Limit = Limit(100_000, "bodies");
/// Children of one body.
pub(super) const CHILDREN: Limit = Limit(1_000_000, "children of one body");
/// Copies that all `<replicate>`s and `<attach>`s make together; they can be inside each other.
pub(super) const COPIES: Limit = Limit(100_000, "copies of all <replicate> and <attach>");
/// Depth of elements, as in MuJoCo's XML reader.
pub(super) const DEPTH: Limit = Limit(500, "elements inside each other");
/// Depth of `<default>` classes.
pub(super) const CLASS_DEPTH: Limit = Limit(100, "classes inside each other");
/// Models that are attached to a model and to each other.
pub(super) const MODELS: Limit = Limit(1_000, "attached models");
/// Depth of attached models. A file that attaches itself exceeds this depth.
pub(super) const MODEL_DEPTH: Limit = Limit(20, "models inside each other");

/// Largest number of copies of one `<replicate>`. A larger number indicates a mistake in the file.
pub(super) const MAX_COPIES_OF_ONE: usize = 10_000;

impl Limit {
    /// Returns an error with the line of `element` if there are more than the allowed number of things.
    pub fn check(&self, n: usize, element: Element) -> Result<()> {
        let &Self(most, things) = self;
        match n > most {
            true => Err(element.refuse(format!("too many {things}"), format!("at most {most}"))),
            false => Ok(()),
        }
    }
}
