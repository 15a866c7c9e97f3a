//! Property of the taxels of a patch: one value for all taxels, or one value per taxel.

use super::taxel::Taxel;
use crate::error::{Error, Result};

/// Property of the taxels of a patch: one value for all taxels, or one value per taxel.
#[derive(Clone, Debug, PartialEq)]
pub enum PerTaxel<T> {
    /// One value for all taxels.
    Equal(T),
    /// One value per taxel, in the order of the layout.
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
    /// Returns the value of the taxel with the given index.
    ///
    /// # Panics
    /// If the taxel does not exist.
    pub fn at(&self, taxel: usize) -> &T {
        match self {
            Self::Equal(equal) => equal,
            Self::Each(each) => &each[taxel],
        }
    }

    /// Returns an error unless there is one value, or one per taxel of the patch, and each value is valid. Errors contain the patch's name, and also the
    /// taxel (from 1) if there is one value per taxel.
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

    /// Returns the stored values: a single value, or one per taxel.
    pub fn all(&self) -> &[T] {
        match self {
            Self::Equal(equal) => std::slice::from_ref(equal),
            Self::Each(each) => each,
        }
    }
}
