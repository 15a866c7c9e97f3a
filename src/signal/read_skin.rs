//! Whose signal a chain is: a grid of equal taxels, or a skin of any layout whose taxels read alike.

use crate::error::{Error, Result};
use crate::world::{Grid, Patch, SkinPatch, Taxel};

/// The skin that a chain reads.
#[derive(Clone, Copy, Debug)]
pub enum ReadSkin<'a> {
    /// A grid.
    Grid(&'a Patch),
    /// Any layout; a grid of equal taxels is read as one.
    Skin(&'a SkinPatch),
}

/// Where the taxels of a skin are.
#[derive(Clone, Copy, Debug)]
pub enum Shape<'a> {
    /// In rows and columns.
    Grid(Grid),
    /// Anywhere on a surface.
    Surface(&'a SkinPatch),
}

impl<'a> From<&'a Patch> for ReadSkin<'a> {
    fn from(patch: &'a Patch) -> Self {
        Self::Grid(patch)
    }
}

impl<'a> From<&'a SkinPatch> for ReadSkin<'a> {
    fn from(skin: &'a SkinPatch) -> Self {
        Self::Skin(skin)
    }
}

impl ReadSkin<'_> {
    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        match self {
            Self::Grid(patch) => patch.grid.n_taxels(),
            Self::Skin(skin) => skin.n_taxels(),
        }
    }

    /// Its grid, or the skin itself where it is none.
    pub fn shape(&self) -> Shape<'_> {
        match self {
            Self::Grid(patch) => Shape::Grid(patch.grid),
            Self::Skin(skin) => match skin.layout().as_grid() {
                Some(grid) => Shape::Grid(*grid),
                None => Shape::Surface(skin),
            },
        }
    }

    /// What every taxel is, but for its radius.
    ///
    /// # Errors
    /// Taxels that differ in stroke, stiffness or damping: a share of the full scale would be another one of each.
    pub fn taxel(&self) -> Result<Taxel> {
        let skin = match self {
            Self::Grid(patch) => return Ok(patch.taxel),
            Self::Skin(skin) => skin,
        };
        let reads = |taxel: &Taxel| (taxel.stroke, taxel.stiffness, taxel.damping);
        let first = *skin.taxels().at(0);
        let mut others = skin.taxels().all().iter();
        match others.all(|other| reads(other) == reads(&first)) {
            true => Ok(first),
            false => Err(Error::input(
                format!("signal of skin patch {}", skin.name()),
                "taxels of unlike stroke, stiffness or damping",
                "taxels that read alike",
            )),
        }
    }
}
