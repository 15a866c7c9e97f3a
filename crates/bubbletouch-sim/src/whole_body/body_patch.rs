//! Body of a robot as patches of skin, stored with few bytes per taxel.

use super::dome_patch::DomePatch;
use super::draped_patch::{self, DrapedPatch};
use super::row_patch::RowPatch;
use crate::error::{Error, Result};
use crate::objects::Sphere;
use crate::world::{Extrusion, Layout, Patch, Rule, Taxel, Taxels};

/// Patch of taxels of a whole body, stored with few bytes per taxel.
#[derive(Clone, Debug)]
pub struct BodyPatch {
    name: String,
    taxel: Taxel,
    n_taxels: usize,
    surface: Surface,
}

/// Arrangement of the taxels of a patch.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    /// One row of taxels repeated along a line.
    Rows(RowPatch),
    /// Rings of taxels on a part of a sphere.
    Dome(DomePatch),
    /// Taxels at arbitrary positions, each with its own axis.
    Draped(DrapedPatch),
}

impl BodyPatch {
    /// Converts a patch to the form that a whole body stores.
    ///
    /// # Errors
    /// If the patch is not suitable for a whole body.
    fn new(patch: &Patch) -> Result<Self> {
        let name = patch.name().to_owned();
        let refuse = |what: &str, given: String, allowed: String| {
            Err(Error::input(
                format!("body patch {name}, {what}"),
                given,
                allowed,
            ))
        };
        let Taxels::Equal(taxel) = *patch.taxels() else {
            let allowed = "one taxel for all places".to_owned();
            return refuse("taxels", "one each".to_owned(), allowed);
        };
        let behind = taxel.substrate();
        let surface = match patch.layout().rule() {
            Rule::Grid(grid) => Surface::Rows(RowPatch::new(Extrusion::grid(grid)?, behind)),
            Rule::Rows(rows) => Surface::Rows(RowPatch::new(rows.clone(), behind)),
            Rule::Dome(dome) if dome.radius() < -behind => {
                let allowed = format!("at least {} m, a taxel's stroke and radius", -behind);
                return refuse("dome radius", format!("{} m", dome.radius()), allowed);
            }
            Rule::Dome(dome) => Surface::Dome(DomePatch::new(dome.clone(), behind)),
            Rule::None => Surface::Draped(DrapedPatch::new(patch.layout(), behind)),
        };
        Ok(Self {
            name,
            taxel,
            n_taxels: patch.n_taxels(),
            surface,
        })
    }

    /// Returns the name of the patch.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the centre (at rest) and the axis of every taxel, in the patch frame.
    pub fn layout(&self) -> Layout {
        match &self.surface {
            Surface::Rows(rows) => rows.extrusion.clone().into(),
            Surface::Dome(dome) => dome.dome.clone().into(),
            Surface::Draped(draped) => draped.layout(),
        }
    }

    /// Returns the properties that all taxels of the patch share.
    pub fn taxel(&self) -> &Taxel {
        &self.taxel
    }

    /// Returns the number of taxels of the patch.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// Returns the patch's bounding ball in the patch frame. A sphere can push a taxel only if its distance from the ball's centre is less than the sum of
    /// the three radii.
    pub fn ball(&self) -> Sphere {
        match &self.surface {
            Surface::Rows(rows) => rows.ball(),
            Surface::Dome(dome) => dome.ball,
            Surface::Draped(draped) => draped.ball,
        }
    }

    /// Returns the arrangement of the taxels.
    pub(super) fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Returns the number of rows, rings, or blocks of tiles, depending on the arrangement of the taxels.
    pub(super) fn n_rows(&self) -> usize {
        match &self.surface {
            Surface::Rows(rows) => rows.extrusion.rows().len(),
            Surface::Dome(dome) => dome.dome.rings().len(),
            Surface::Draped(_) => self.n_taxels.div_ceil(draped_patch::BLOCK),
        }
    }

    /// Returns the index of the first taxel of a row, ring, or block of tiles.
    #[inline(always)]
    pub(super) fn row_start(&self, row: u32) -> u32 {
        match &self.surface {
            Surface::Rows(rows) => row * rows.extrusion.places().len() as u32,
            Surface::Dome(dome) => dome.dome.rings()[row as usize].first as u32,
            Surface::Draped(_) => row * draped_patch::BLOCK as u32,
        }
    }
}

/// Whole body: all skin patches of a robot.
///
/// Taxels are numbered patch by patch, each patch in the order of its layout.
#[derive(Clone, Debug)]
pub struct WholeBody {
    patches: Vec<BodyPatch>,
    /// Index of each patch's first taxel.
    firsts: Vec<usize>,
    n_taxels: usize,
}

impl WholeBody {
    /// Creates a body from patches whose taxels are equal within each patch. Patches other than grids, extrusions and domes are fast only if neighbouring
    /// taxels have close indices, which `with_neighbours_together` ensures.
    ///
    /// # Errors
    /// If two patches have equal names, a patch has unequal taxels, or a dome is smaller than the depth of its taxels.
    pub fn new(patches: &[Patch]) -> Result<Self> {
        let patches = patches.iter().map(BodyPatch::new);
        let patches = patches.collect::<Result<Vec<_>>>()?;
        let mut names: Vec<&str> = patches.iter().map(BodyPatch::name).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            let given = format!("two patches called `{}`", pair[0]);
            return Err(Error::input("body", given, "a name of its own for each"));
        }
        let mut n_taxels = 0;
        let firsts = patches.iter().map(|patch| {
            let first = n_taxels;
            n_taxels += patch.n_taxels();
            first
        });
        Ok(Self {
            firsts: firsts.collect(),
            n_taxels,
            patches,
        })
    }

    /// Returns the patches, in the order in which their taxels are numbered.
    pub fn patches(&self) -> &[BodyPatch] {
        &self.patches
    }

    /// Returns the index of the first taxel of each patch.
    pub fn firsts(&self) -> &[usize] {
        &self.firsts
    }

    /// Returns the index of the patch that contains a taxel, and the index of the taxel in this patch.
    ///
    /// # Panics
    /// If the taxel does not exist.
    pub fn place_of(&self, taxel: usize) -> (usize, usize) {
        assert!(taxel < self.n_taxels, "a taxel of this body");
        let patch = self.firsts.partition_point(|&first| first <= taxel) - 1;
        (patch, taxel - self.firsts[patch])
    }

    /// Returns the number of taxels of all patches together.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }
    /// Returns the memory that the body uses in bytes, excluding its `BodyState`.
    pub fn n_bytes(&self) -> usize {
        let patch = |patch: &BodyPatch| {
            let surface = match &patch.surface {
                Surface::Rows(rows) => rows.n_bytes(),
                Surface::Dome(dome) => dome.n_bytes(),
                Surface::Draped(draped) => draped.n_bytes(),
            };
            size_of::<BodyPatch>() + patch.name.len() + surface
        };
        self.patches.iter().map(patch).sum::<usize>() + size_of_val(&self.firsts[..])
    }

    /// Returns a dense frame of the whole body, shape (n_taxels,), from the values of some taxels; all other values are zero.
    ///
    /// # Panics
    /// If a taxel does not exist.
    pub fn frame(&self, touched: impl IntoIterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut frame = vec![0.0; self.n_taxels];
        for (taxel, value) in touched {
            frame[taxel] = value;
        }
        frame
    }
}
