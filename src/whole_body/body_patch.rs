//! A body: patches of skin whose taxels need few bytes of their own.

use super::dome_patch::DomePatch;
use super::draped_patch::{self, DrapedPatch};
use super::row_patch::RowPatch;
use crate::error::{Error, Result};
use crate::objects::Sphere;
use crate::world::{Dome, Extrusion, Layout, Taxel};

/// A patch of a body: equal taxels, in rows or anywhere.
#[derive(Clone, Debug)]
pub struct BodyPatch {
    name: String,
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
    /// A flat patch or a part of a cylinder.
    ///
    /// # Errors
    /// The error names the patch and the property of its taxels that is out of its range.
    pub fn new(name: impl Into<String>, extrusion: Extrusion, taxel: Taxel) -> Result<Self> {
        let name = name.into();
        check_taxel(&name, &taxel)?;
        let surface = Surface::Rows(RowPatch::new(extrusion, taxel));
        Ok(Self { name, surface })
    }

    /// A part of a sphere.
    ///
    /// # Errors
    /// The error names the patch and the property of its taxels that is out of its range, or a sphere too small for their stroke.
    pub fn dome(name: impl Into<String>, dome: Dome, taxel: Taxel) -> Result<Self> {
        let name = name.into();
        check_taxel(&name, &taxel)?;
        let depth = taxel.stroke + taxel.radius;
        if dome.radius() < depth {
            return Err(Error::input(
                format!("body patch {name}, dome radius"),
                format!("{} m", dome.radius()),
                format!("at least {depth} m, a taxel's stroke and radius"),
            ));
        }
        let surface = Surface::Dome(DomePatch::new(dome, taxel));
        Ok(Self { name, surface })
    }

    /// Taxels anywhere, such as on a mesh ([`Layout::draped`]), numbered as in the layout.
    ///
    /// It is fast if neighbours have near numbers: see [`Layout::with_neighbours_together`].
    ///
    /// # Errors
    /// The error names the patch and the property of its taxels that is out of its range.
    pub fn draped(name: impl Into<String>, layout: &Layout, taxel: Taxel) -> Result<Self> {
        let name = name.into();
        check_taxel(&name, &taxel)?;
        let surface = Surface::Draped(DrapedPatch::new(layout, taxel));
        Ok(Self { name, surface })
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Every taxel's place and axis, in the patch frame; 48 bytes a taxel.
    pub fn layout(&self) -> Layout {
        match &self.surface {
            Surface::Rows(rows) => rows.extrusion().into(),
            Surface::Dome(dome) => dome.dome().into(),
            Surface::Draped(draped) => draped.layout(),
        }
    }

    /// What each of the taxels is.
    pub fn taxel(&self) -> &Taxel {
        match &self.surface {
            Surface::Rows(rows) => rows.taxel(),
            Surface::Dome(dome) => dome.taxel(),
            Surface::Draped(draped) => draped.taxel(),
        }
    }

    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        match &self.surface {
            Surface::Rows(rows) => rows.extrusion().n_taxels(),
            Surface::Dome(dome) => dome.dome().n_taxels(),
            Surface::Draped(draped) => draped.n_taxels(),
        }
    }

    /// A ball in the patch frame that every sphere comes near to that pushes a taxel: nearer than the sum of the radii and ρ.
    pub fn ball(&self) -> Sphere {
        match &self.surface {
            Surface::Rows(rows) => rows.ball(),
            Surface::Dome(dome) => dome.ball(),
            Surface::Draped(draped) => draped.ball(),
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
            Surface::Draped(draped) => draped.n_taxels().div_ceil(draped_patch::BLOCK),
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

fn check_taxel(patch: &str, taxel: &Taxel) -> Result<()> {
    let place = |error: Error| error.under(format!("body patch {patch}, "));
    taxel.check().map_err(place)
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
    /// A body of patches.
    ///
    /// # Errors
    /// A patch that has the name of another one.
    pub fn new(patches: Vec<BodyPatch>) -> Result<Self> {
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
