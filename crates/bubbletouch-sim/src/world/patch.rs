//! Skin patch with any layout of taxels.

use super::taxel_tree::TaxelTree;
use super::{Grid, Layout, Taxel, Taxels};
use crate::error::Result;
use glam::DVec3;
use std::sync::OnceLock;

/// Rigid substrate with taxels in any layout. The properties of the taxels are equal or individual.
///
/// Invariant: there is one set of taxel properties for all taxels, or one per taxel. The search trees are built from the layout and the taxel properties.
#[derive(Clone, Debug)]
pub struct Patch {
    name: String,
    layout: Layout,
    taxels: Taxels,
    /// Whether each taxel is absent; empty if none is.
    is_absent: Vec<bool>,
    even_grid: Option<EvenGrid>,
    /// Search tree over the taxels, created on first use.
    tree: OnceLock<TaxelTree>,
    ahead: OnceLock<Travelling>,
}

/// Flat grid of taxels with equal radius and stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EvenGrid {
    pub grid: Grid,
    /// Radius of each taxel, metres.
    pub radius: f64,
    /// Stroke of each taxel, metres.
    pub stroke: f64,
    /// Height of the substrate relative to the taxels' centres at rest, metres: minus the sum of stroke and radius.
    pub behind: f64,
}

/// Copy of a patch's taxels whose axes are replaced by a direction of travel.
#[derive(Clone, Debug)]
pub(crate) struct Travelling {
    pub taxels: TaxelTree,
    /// Largest coordinate of a taxel's surface along the direction of travel, metres.
    pub front: f64,
    /// Whether the taxels' own axes equal the direction of travel. If so, each deflection equals the travel past first contact of the taxel.
    pub is_flat: bool,
}

impl Travelling {
    /// Creates a copy of the patch's taxels whose axes are replaced by the unit vector `direction`.
    pub fn new(patch: &Patch, direction: DVec3) -> Self {
        let (layout, taxels) = (&patch.layout, &patch.taxels);
        let places = layout.centers().iter().enumerate();
        let fronts = places.map(|(taxel, center)| center.dot(direction) + taxels.at(taxel).radius);
        Self {
            front: fronts.fold(f64::NEG_INFINITY, f64::max),
            is_flat: layout.axes().iter().all(|axis| *axis == direction),
            taxels: TaxelTree::travelling(layout, taxels, direction),
        }
    }
}

impl Patch {
    /// Creates a patch and checks the properties of its taxels. The search tree is built at the first press, which takes about a microsecond per taxel.
    ///
    /// # Errors
    /// If a property of a taxel is out of its range, or the numbers of taxel properties and rest centres differ. The message begins with the patch's name and
    /// contains the taxel (from 1).
    pub fn new(
        name: impl Into<String>,
        layout: impl Into<Layout>,
        taxels: impl Into<Taxels>,
    ) -> Result<Self> {
        let (name, layout, taxels) = (name.into(), layout.into(), taxels.into());
        taxels.check(&name, layout.n_taxels(), Taxel::check)?;
        Ok(Self::of_checked(name, layout, taxels))
    }

    /// Creates a flat rectangular grid of equal taxels with the name `patch`.
    ///
    /// # Errors
    /// If the grid or the taxel is invalid, or there are too many taxels.
    pub fn grid(grid: Grid, taxel: Taxel) -> Result<Self> {
        let layout = Layout::grid(&grid)?;
        taxel.check()?;
        Ok(Self::of_checked(
            "patch".to_owned(),
            layout,
            Taxels::Equal(taxel),
        ))
    }

    fn of_checked(name: String, layout: Layout, taxels: Taxels) -> Self {
        Self {
            even_grid: EvenGrid::new(&layout, &taxels),
            tree: OnceLock::new(),
            ahead: OnceLock::new(),
            name,
            layout,
            taxels,
            is_absent: Vec::new(),
        }
    }

    /// Returns the patch with places at which no taxel reads, such as the corners of a rectangle that contains a foot. An absent taxel is the neighbour of no taxel;
    /// contacts are not affected.
    ///
    /// # Panics
    /// If the list does not have one value for each taxel.
    pub fn without(mut self, is_absent: &[bool]) -> Self {
        assert_eq!(is_absent.len(), self.n_taxels(), "one value for each taxel");
        self.is_absent = match is_absent.contains(&true) {
            true => is_absent.to_vec(),
            false => Vec::new(),
        };
        self
    }

    /// Returns whether each taxel is absent; empty if none is.
    pub fn absent(&self) -> &[bool] {
        &self.is_absent
    }

    /// Returns whether a taxel is absent.
    pub fn is_absent(&self, taxel: usize) -> bool {
        self.is_absent.get(taxel) == Some(&true)
    }

    /// Returns the grid of the taxels, if they form one in which every taxel reads.
    pub fn whole_grid(&self) -> Option<&Grid> {
        self.layout.as_grid().filter(|_| self.is_absent.is_empty())
    }

    /// Returns the name of the patch.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the layout of the patch: centres (at rest) and axes of the taxels.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Returns whether the axes of all taxels are +z.
    pub fn is_flat(&self) -> bool {
        let axes = || self.layout.axes();
        self.layout.as_grid().is_some() || axes().iter().all(|axis| *axis == DVec3::Z)
    }

    /// Returns the properties of the taxels.
    pub fn taxels(&self) -> &Taxels {
        &self.taxels
    }

    /// Returns the number of taxels.
    pub fn n_taxels(&self) -> usize {
        self.layout.n_taxels()
    }

    /// Returns the search tree over the taxels, which finds the taxels near a ball.
    pub fn tree(&self) -> &TaxelTree {
        let make = || TaxelTree::new(&self.layout, &self.taxels);
        self.tree.get_or_init(make)
    }

    /// Returns the copy of the patch's taxels whose axes are replaced by z, for presses along z.
    pub(crate) fn ahead(&self) -> &Travelling {
        self.ahead.get_or_init(|| Travelling::new(self, DVec3::Z))
    }

    /// Returns the grid if the layout is a grid and all taxels have equal radius and stroke; otherwise `None`.
    pub(crate) fn even_grid(&self) -> Option<&EvenGrid> {
        self.even_grid.as_ref()
    }
}

impl EvenGrid {
    fn new(layout: &Layout, taxels: &Taxels) -> Option<Self> {
        let grid = *layout.as_grid()?;
        let (first, others) = taxels.all().split_first()?;
        let is_alike = |t: &Taxel| (t.radius, t.stroke) == (first.radius, first.stroke);
        others.iter().all(is_alike).then_some(Self {
            grid,
            radius: first.radius,
            stroke: first.stroke,
            behind: first.substrate(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::fixtures::{TAXEL, grid};

    #[test]
    fn a_patch_that_is_a_grid_knows_it() {
        let grid = grid(4, 3, 2e-3);
        let skin = Patch::grid(grid, TAXEL).unwrap();
        assert_eq!((skin.name(), skin.n_taxels()), ("patch", 12));
        assert_eq!(skin.layout().as_grid(), Some(&grid));
        assert_eq!(skin.taxels().at(11), &TAXEL);
    }

    #[test]
    fn bad_taxels_are_refused_with_the_patch_and_the_taxel() {
        let layout = || Layout::new(vec![DVec3::ZERO, DVec3::X], vec![DVec3::Z; 2]).unwrap();
        let stiff = Taxel {
            stiffness: -1.0,
            ..TAXEL
        };
        let range = "taxel stiffness: -1 N/m; a finite positive number";
        for (taxels, message) in [
            (
                Taxels::Each(vec![TAXEL]),
                ": 1 taxels for 2 places; one taxel a place, or one for all",
            ),
            (
                Taxels::Each(vec![TAXEL, stiff]),
                &format!(", taxel 2, {range}"),
            ),
            (Taxels::Equal(stiff), &format!(", {range}")),
        ] {
            let error = Patch::new("palm", layout(), taxels).unwrap_err();
            assert_eq!(error.to_string(), format!("skin patch palm{message}"));
        }
    }
}
