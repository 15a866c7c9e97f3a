//! A property of every taxel of a patch: one for all, or one each.

use super::taxel::Taxel;
use crate::error::{Error, Result};

/// What the taxels of a patch have, in the order of its layout.
#[derive(Clone, Debug, PartialEq)]
pub enum PerTaxel<T> {
    /// All the same.
    Equal(T),
    /// One each, in the order of the layout.
    Each(Vec<T>),
}

/// Properties of the taxels of a patch.
pub type Taxels = PerTaxel<Taxel>;

impl<T> From<T> for PerTaxel<T> {
    fn from(all: T) -> Self {
        Self::Equal(all)
    }
}

impl<T> PerTaxel<T> {
    /// That of one taxel.
    ///
    /// # Panics
    /// If there are not that many.
    pub fn at(&self, taxel: usize) -> &T {
        match self {
            Self::Equal(equal) => equal,
            Self::Each(each) => &each[taxel],
        }
    }

    /// Whether there are as many as a patch has places, or one, and each is allowed; errors name the patch, and a taxel (from 1) if there is
    /// one each.
    pub(super) fn check(
        &self,
        patch: &str,
        n_places: usize,
        check: impl Fn(&T) -> Result<()>,
    ) -> Result<()> {
        let is_one = matches!(self, Self::Equal(_));
        if !is_one && self.all().len() != n_places {
            let given = format!("{} taxels for {n_places} places", self.all().len());
            let allowed = "one taxel a place, or one for all";
            return Err(Error::input(format!("skin patch {patch}"), given, allowed));
        }
        for (index, one) in self.all().iter().enumerate() {
            let place = || match is_one {
                true => format!("skin patch {patch}, "),
                false => format!("skin patch {patch}, taxel {}, ", index + 1),
            };
            check(one).map_err(|error| error.under(place()))?;
        }
        Ok(())
    }

    /// Each value that there is: one, or as many as taxels.
    pub fn all(&self) -> &[T] {
        match self {
            Self::Equal(equal) => std::slice::from_ref(equal),
            Self::Each(each) => each,
        }
    }
}
