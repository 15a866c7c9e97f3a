//! A body: patches of skin as it keeps them, with few bytes a taxel.

use super::dome_patch::DomePatch;
use super::draped_patch::{self, DrapedPatch};
use super::row_patch::RowPatch;
use crate::error::{Error, Result};
use crate::objects::Sphere;
use crate::world::{Extrusion, Layout, Patch, Rule, Taxel, Taxels};

/// A patch as a body keeps it, with few bytes a taxel.
#[derive(Clone, Debug)]
pub struct BodyPatch {
    name: String,
    taxel: Taxel,
    n_taxels: usize,
    surface: Surface,
}

/// How the taxels of a patch lie.
#[derive(Clone, Debug)]
pub(super) enum Surface {
    /// One row repeated along a line.
    Rows(RowPatch),
    /// Rings on a sphere.
    Dome(DomePatch),
    /// Anywhere, each with an axis of its own.
    Draped(DrapedPatch),
}

impl BodyPatch {
    /// # Errors
    /// Those of [`WholeBody::new`].
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

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Every taxel's place and axis, in the patch frame.
    pub fn layout(&self) -> Layout {
        match &self.surface {
            Surface::Rows(rows) => rows.extrusion().clone().into(),
            Surface::Dome(dome) => dome.dome().clone().into(),
            Surface::Draped(draped) => draped.layout(),
        }
    }

    /// What each of the taxels is.
    pub fn taxel(&self) -> &Taxel {
        &self.taxel
    }

    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }

    /// A ball in the patch frame that every sphere comes near to that pushes a taxel: nearer than the sum of the radii and ρ.
    pub fn ball(&self) -> Sphere {
        match &self.surface {
            Surface::Rows(rows) => rows.ball(),
            Surface::Dome(dome) => dome.ball,
            Surface::Draped(draped) => draped.ball,
        }
    }

    /// How the taxels lie.
    pub(super) fn surface(&self) -> &Surface {
        &self.surface
    }

    /// How many rows, rings, or blocks of tiles.
    pub(super) fn n_rows(&self) -> usize {
        match &self.surface {
            Surface::Rows(rows) => rows.extrusion().rows().len(),
            Surface::Dome(dome) => dome.dome().rings().len(),
            Surface::Draped(_) => self.n_taxels.div_ceil(draped_patch::BLOCK),
        }
    }

    /// The number of the first taxel of a row.
    #[inline(always)]
    pub(super) fn row_start(&self, row: u32) -> u32 {
        match &self.surface {
            Surface::Rows(rows) => row * rows.extrusion().places().len() as u32,
            Surface::Dome(dome) => dome.dome().rings()[row as usize].first as u32,
            Surface::Draped(_) => row * draped_patch::BLOCK as u32,
        }
    }
}

/// All patches of a body.
///
/// Taxels are numbered patch by patch, each in the order of its [layout](BodyPatch::layout).
#[derive(Clone, Debug)]
pub struct WholeBody {
    patches: Vec<BodyPatch>,
    /// The number of each patch's first taxel.
    firsts: Vec<usize>,
    n_taxels: usize,
}

impl WholeBody {
    /// A body of patches, each of equal taxels. One that is no grid, [`Extrusion`] or [`Dome`](crate::world::Dome) is fast if neighbours
    /// have near numbers: see [`Layout::with_neighbours_together`].
    ///
    /// # Errors
    /// A patch that has the name of another one, or taxels of more than one kind; a dome smaller than their depth.
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

    /// The patches, in the order in which their taxels are numbered.
    pub fn patches(&self) -> &[BodyPatch] {
        &self.patches
    }

    /// The number of the first taxel of each patch.
    pub fn firsts(&self) -> &[usize] {
        &self.firsts
    }

    /// The patch of a taxel, and its number there.
    ///
    /// # Panics
    /// If there is no such taxel.
    pub fn place_of(&self, taxel: usize) -> (usize, usize) {
        assert!(taxel < self.n_taxels, "a taxel of this body");
        let patch = self.firsts.partition_point(|&first| first <= taxel) - 1;
        (patch, taxel - self.firsts[patch])
    }

    /// How many taxels all patches have.
    pub fn n_taxels(&self) -> usize {
        self.n_taxels
    }
    /// Bytes that it holds; what touches it has its own ([`BodyState::n_bytes`](super::BodyState::n_bytes)).
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

    /// A frame of the whole body, n_taxels, that is zero but for some taxels: touched ones with their deflections or forces.
    ///
    /// # Panics
    /// If there is no such taxel.
    pub fn frame(&self, touched: impl IntoIterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut frame = vec![0.0; self.n_taxels];
        for (taxel, value) in touched {
            frame[taxel] = value;
        }
        frame
    }
}
