//! Scratch memory of a thread for presses.

use super::grid::{GridPress, GridScratch, GridValues};
use super::instructions::Instructions;
use super::object_at::ClusterSearch;
use super::taxel_contact::TaxelContact;
use crate::geometry::Pose;
use crate::world::EvenGrid;

/// Scratch memory of one thread for presses, and the result of the last press. Reuse avoids allocations once the largest patch has been pressed.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    instructions: Instructions,
    /// Scratch memory for flat grids pressed along their axis.
    grid: GridScratch,
    /// Deflections, metres, shape (n_taxels,). Above zero are only taxels of `touched`, or of the rectangle that a press of a flat grid has reached.
    pub(super) deflections: GridValues,
    /// Indices of the object and of its part (sphere or triangle) that determine each deflection, shape (n_taxels,); unspecified for untouched taxels.
    pub(super) deciding: Vec<[u32; 2]>,
    /// Indices of the touched taxels, ascending after a press; empty after a press of a flat grid along its axis.
    pub(super) touched: Vec<u32>,
    /// Indices of the spheres of an object near the patch.
    pub(super) near: Vec<u32>,
    /// Search for these spheres.
    pub(super) clusters: ClusterSearch,
    /// Contacts of the touched taxels, in the order of `touched`.
    pub(super) contacts: Vec<TaxelContact>,
    /// Parts of objects (spheres or triangles) that push their taxels even from behind the substrate, with these taxels.
    pub(super) held: Vec<HeldTaxel>,
    /// Poses of the objects along the path of a press.
    pub(super) poses: Vec<Pose>,
}

/// Taxel with a part of an object that continues to push it, even from behind the substrate.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldTaxel {
    pub taxel: u32,
    pub by: [u32; 2],
}

impl Workspace {
    /// Creates an empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates an empty workspace that uses the given vector instructions, for comparisons.
    pub fn with(instructions: Instructions) -> Self {
        Self {
            instructions,
            ..Self::default()
        }
    }

    pub(super) fn instructions(&self) -> Instructions {
        self.instructions
    }

    /// Returns the deflections of the last press, metres, shape (n_taxels,), in the order of the layout.
    pub fn deflections(&self) -> &[f64] {
        self.deflections.all()
    }

    /// Returns the contacts of the last press, ascending by taxel; empty after presses that do not record contacts.
    pub fn contacts(&self) -> &[TaxelContact] {
        &self.contacts
    }

    /// Sets the contacts whose object parts push their taxels even from behind the substrate, until the next call. An object that moves through the front of a
    /// patch thereby continues to press the taxels that it has pressed.
    pub fn hold<'a>(&mut self, contacts: impl IntoIterator<Item = &'a TaxelContact>) {
        self.held.clear();
        self.held
            .extend(contacts.into_iter().map(|contact| HeldTaxel {
                taxel: contact.taxel as u32,
                by: [contact.object, contact.part].map(|number| number as u32),
            }));
    }

    /// Marks the parts that determine the deflections of the last press as held, so that they push their taxels even from behind the substrate.
    pub(super) fn hold_touched(&mut self) {
        let deciding = &self.deciding;
        self.held.clear();
        self.held
            .extend(self.touched.iter().map(|&taxel| HeldTaxel {
                taxel,
                by: deciding[taxel as usize],
            }));
    }

    /// Returns whether any part of an object is marked as held, that is, pushes its taxel even from behind the substrate.
    pub fn holds_any(&self) -> bool {
        !self.held.is_empty()
    }

    /// Prepares a press of a flat grid along its axis.
    pub(super) fn on_grid<'a>(&'a mut self, grid: &'a EvenGrid) -> GridPress<'a> {
        self.untouch();
        GridPress {
            grid,
            instructions: self.instructions,
            scratch: &mut self.grid,
            deflections: &mut self.deflections,
        }
    }

    /// Resizes the buffers for `n_taxels` taxels and clears only the taxels that the last press touched.
    pub(super) fn clear(&mut self, n_taxels: usize) {
        self.untouch();
        self.touched.reserve(n_taxels);
        self.contacts.reserve(n_taxels);
        self.deflections.clear(n_taxels, 1, 0.0);
        self.deciding.resize(n_taxels, [0; 2]);
    }

    fn untouch(&mut self) {
        for &taxel in &self.touched {
            self.deflections[taxel as usize] = 0.0;
        }
        self.touched.clear();
        self.contacts.clear();
    }

    /// Raises the deflection of a taxel to `needed`, metres. If several object parts require equal deflections, the first part counts.
    #[inline(always)]
    pub(super) fn push(&mut self, taxel: u32, needed: f64, deciding: [u32; 2]) {
        let number = taxel as usize;
        let deflection = &mut self.deflections[number];
        if needed > *deflection {
            if *deflection == 0.0 {
                self.touched.push(taxel);
            }
            *deflection = needed;
            self.deciding[number] = deciding;
        }
    }
}
