//! What a thread presses in.

use super::grid::{GridLines, GridPress};
use super::instructions::Instructions;
use super::taxel_contact::TaxelContact;
use crate::geometry::Pose;

/// Scratch of one thread, and what the last press left; it is reused, so a press allocates nothing once the largest patch has been seen.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    instructions: Instructions,
    /// Of flat grids pressed along their axis.
    grid: GridPress,
    /// Whether that was the last press.
    is_on_grid: bool,
    /// n_taxels, metres.
    pub(super) deflections: Vec<f64>,
    /// n_taxels: object and part; of untouched taxels whatever was there.
    pub(super) deciding: Vec<[u32; 2]>,
    /// The touched taxels, ascending at the end of a press.
    pub(super) touched: Vec<u32>,
    /// Spheres of an object that are near.
    pub(super) near: Vec<u32>,
    /// Of the last even grid.
    pub(super) lines: GridLines,
    /// Of the touched taxels, in the same order.
    pub(super) contacts: Vec<TaxelContact>,
    /// What goes on pushing its taxel, behind the substrate too; see [`hold`](Self::hold).
    pub(super) held: Vec<Held>,
    /// Of the objects on their way.
    pub(super) poses: Vec<Pose>,
}

/// A taxel that is held, and what it is held by: object and part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub taxel: u32,
    pub by: [u32; 2],
}

impl Workspace {
    /// An empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty workspace for some other than the best instructions, to compare them.
    pub fn with(instructions: Instructions) -> Self {
        Self {
            instructions,
            ..Self::default()
        }
    }

    pub(super) fn instructions(&self) -> Instructions {
        self.instructions
    }

    /// Deflections of the last press: n_taxels, metres, in the order of the layout.
    pub fn deflections(&self) -> &[f64] {
        match self.is_on_grid {
            true => self.grid.deflections(),
            false => &self.deflections,
        }
    }

    /// Whether the last press was of a flat grid along its axis.
    pub(super) fn is_on_grid(&self) -> bool {
        self.is_on_grid
    }

    /// The touched taxels of the last press, ascending; none if it was a [press](super::press_at_pose) that does not say what touches what.
    pub fn contacts(&self) -> &[TaxelContact] {
        &self.contacts
    }

    /// From now on each of these parts pushes its taxel behind the substrate too, until other parts are held: on its way through the
    /// front of a patch an object goes on pressing what it has pressed.
    pub fn hold<'a>(&mut self, contacts: impl IntoIterator<Item = &'a TaxelContact>) {
        self.held.clear();
        self.held.extend(contacts.into_iter().map(|contact| Held {
            taxel: contact.taxel as u32,
            by: [contact.object, contact.part].map(|number| number as u32),
        }));
    }

    /// Holds what pushes the taxels of the last press.
    pub(super) fn hold_touched(&mut self) {
        let deciding = &self.deciding;
        self.held.clear();
        self.held.extend(self.touched.iter().map(|&taxel| Held {
            taxel,
            by: deciding[taxel as usize],
        }));
    }

    /// Whether any part is held.
    pub fn holds_any(&self) -> bool {
        !self.held.is_empty()
    }

    /// For the next press, which is of a flat grid along its axis.
    pub(super) fn on_grid(&mut self) -> &mut GridPress {
        self.is_on_grid = true;
        self.contacts.clear();
        self.grid.instructions = self.instructions;
        &mut self.grid
    }

    /// Makes room for a patch; only what the last press touched is wiped.
    pub(super) fn clear(&mut self, n_taxels: usize) {
        self.is_on_grid = false;
        for &taxel in &self.touched {
            self.deflections[taxel as usize] = 0.0;
        }
        self.touched.clear();
        self.touched.reserve(n_taxels);
        self.contacts.clear();
        self.contacts.reserve(n_taxels);
        self.deflections.resize(n_taxels, 0.0);
        self.deciding.resize(n_taxels, [0; 2]);
    }

    /// Pushes a taxel as far as a part of an object needs; of parts that need the same the first counts.
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
