//! Parts from outside of this crate: descriptions of sensor errors and ensembles that a program registers before it reads a study, and features that it provides
//! while it runs a study. Such a part is used like a part of this crate.

use crate::error::{Error, Result};
use serde::{Serialize, Serializer};
use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Maximum number of letters of a name or a version. Longer texts do not fit into a column of a table.
const MAX_LETTERS: usize = 64;

/// Returns whether a text is a name or a version of a part from outside of this crate: 1 to 64 letters (A–Z, a–z), digits, `_`, `-` and `.`.
pub(crate) fn is_word(text: &str) -> bool {
    let is_letter = |letter: char| letter.is_ascii_alphanumeric() || "_-.".contains(letter);
    (1..=MAX_LETTERS).contains(&text.len()) && text.chars().all(is_letter)
}

/// Part with its name, its version and its description of the type `A`. Results of equal names and versions are interchangeable.
pub struct Own<A: 'static>(&'static Part<A>);

struct Part<A> {
    name: &'static str,
    version: &'static str,
    about: A,
}

/// List of the registered parts of one type. The list is complete as soon as it is read for the first time.
pub struct Registry<A: 'static> {
    /// Type of the parts in error messages, such as `ensemble`.
    what: &'static str,
    registered: Mutex<Vec<Own<A>>>,
    complete: OnceLock<Vec<Own<A>>>,
}

impl<A: Send + Sync> Registry<A> {
    /// Creates an empty list; `what` names the type of the parts, such as `ensemble`.
    pub const fn new(what: &'static str) -> Self {
        Self {
            what,
            registered: Mutex::new(Vec::new()),
            complete: OnceLock::new(),
        }
    }

    /// Adds a part. `is_taken` states whether a built-in part has its name.
    ///
    /// # Errors
    /// If the name is taken, the name or the version does not consist of 1 to 64 letters (A–Z, a–z), digits, `_`, `-` and `.`, or the list was read before.
    pub fn register(
        &self,
        name: &'static str,
        version: &'static str,
        about: A,
        is_taken: bool,
    ) -> Result<Own<A>> {
        let mut registered = self
            .registered
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let is_known = registered.iter().any(|one| one.name() == name);
        let place = format!("{} {name:?}, version {version:?}", self.what);
        if !is_word(name) || !is_word(version) || is_taken || is_known {
            let allowed = "a name that no other part has, and 1 to 64 letters, digits, _, - and . in name and version";
            return Err(Error::input(place, "registered", allowed));
        }
        if self.complete.get().is_some() {
            let allowed = "a registration before the first study is read";
            return Err(Error::input(place, "registered too late", allowed));
        }
        let own = Own::leak(name, version, about);
        registered.push(own);
        Ok(own)
    }

    /// Returns the parts that are registered so far. Later registrations are possible.
    pub(crate) fn registered(&self) -> Vec<Own<A>> {
        let registered = self.registered.lock();
        registered.unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns all registered parts, in the order of their registration. Later registrations are refused.
    pub fn all(&self) -> &[Own<A>] {
        self.complete.get_or_init(|| self.registered())
    }

    /// Returns the part that a study names: its name, or `name@version`. Returns `None` for other texts, such as another version.
    pub fn named(&self, text: &str) -> Option<Own<A>> {
        let mut all = self.all().iter();
        all.find(|own| own.name() == text || own.to_string() == text)
            .copied()
    }
}

impl<A> Own<A> {
    /// Creates a part that is never removed.
    pub(crate) fn leak(name: &'static str, version: &'static str, about: A) -> Self {
        Self(Box::leak(Box::new(Part {
            name,
            version,
            about,
        })))
    }

    /// Name of the part in studies.
    pub const fn name(&self) -> &'static str {
        self.0.name
    }

    /// Version of the part. Results of different versions are kept apart.
    pub const fn version(&self) -> &'static str {
        self.0.version
    }

    /// Returns the description of the part.
    pub const fn about(&self) -> &'static A {
        &self.0.about
    }
}

impl<A> Clone for Own<A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A> Copy for Own<A> {}

impl<A> PartialEq for Own<A> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl<A> Eq for Own<A> {}

impl<A> Hash for Own<A> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.name(), self.version()).hash(state);
    }
}

impl<A> Ord for Own<A> {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.name(), self.version()).cmp(&(other.name(), other.version()))
    }
}

impl<A> PartialOrd for Own<A> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Writes the name and the version, as in the names of work items.
impl<A> fmt::Debug for Own<A> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Writes the name and the version: `mine@1`.
impl<A> fmt::Display for Own<A> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}@{}", self.name(), self.version())
    }
}

/// Serialises the name and the version.
impl<A> Serialize for Own<A> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::Registry;

    #[test]
    fn a_part_is_found_by_its_name_and_its_version_and_a_late_or_second_one_is_refused() {
        static PARTS: Registry<u8> = Registry::new("part");
        let part = PARTS.register("mine", "1", 7, false).unwrap();
        let refused = |name, version, is_taken| {
            let error = PARTS.register(name, version, 0, is_taken).unwrap_err();
            error.to_string()
        };
        for (name, version, is_taken) in [
            ("mine", "2", false),
            ("b@1", "1", false),
            ("b", "", false),
            ("b", "1", true),
        ] {
            let said = refused(name, version, is_taken);
            assert!(said.contains("a name that no other part has"), "{said}");
        }
        assert_eq!(PARTS.all(), [part]);
        assert_eq!(PARTS.named("mine").map(|own| *own.about()), Some(7));
        assert_eq!(PARTS.named("mine@1"), Some(part));
        assert_eq!(PARTS.named("mine@2"), None);
        assert_eq!(serde_json::to_string(&part).unwrap(), "\"mine@1\"");
        let said = refused("b", "1", false);
        assert!(said.ends_with("before the first study is read"), "{said}");
    }
}
