//! A patch of skin of any shape.

use super::taxel_tree::TaxelTree;
use super::{Grid, Layout, Taxel, Taxels};
use crate::error::Result;
use glam::DVec3;
use std::sync::OnceLock;

/// A rigid substrate with taxels of any layout, equal or not.
///
/// Invariant: one taxel for all or one each; the trees are those of the layout and the taxels.
#[derive(Clone, Debug)]
pub struct Patch {
    name: String,
    layout: Layout,
    taxels: Taxels,
    even_grid: Option<EvenGrid>,
    /// Made when they are asked for.
    tree: OnceLock<TaxelTree>,
    ahead: OnceLock<Travelling>,
}

/// A flat grid of taxels that objects push alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EvenGrid {
    pub grid: Grid,
    /// ρ of all, metres.
    pub radius: f64,
    /// s of all, metres.
    pub stroke: f64,
    /// Height of the substrate, metres: [`Taxel::substrate`].
    pub behind: f64,
}

/// The taxels of a patch as they travel along a direction.
#[derive(Clone, Debug)]
pub(crate) struct Travelling {
    pub taxels: TaxelTree,
    /// How far the foremost of them is along the direction, its radius included, metres.
    pub front: f64,
    /// Whether all their own axes are the direction: then each is pushed in as far as it travels past what it met.
    pub is_flat: bool,
}

impl Travelling {
    /// Along a unit vector.
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
    /// Checks the taxels. What presses need is made at the first of them: about a microsecond a taxel.
    ///
    /// # Errors
    /// The error names a property out of its range and its taxel (from 1), or the numbers of taxels and places if they
    /// differ; it begins with the patch's name.
    pub fn new(
        name: impl Into<String>,
        layout: impl Into<Layout>,
        taxels: impl Into<Taxels>,
    ) -> Result<Self> {
        let (name, layout, taxels) = (name.into(), layout.into(), taxels.into());
        taxels.check(&name, layout.n_taxels(), Taxel::check)?;
        Ok(Self::of_checked(name, layout, taxels))
    }

    /// A flat rectangular grid of equal taxels, called `patch`.
    ///
    /// # Errors
    /// Those of [`Grid::check`] and [`Taxel::check`]; too many taxels.
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
            even_grid: EvenGrid::of(&layout, &taxels),
            tree: OnceLock::new(),
            ahead: OnceLock::new(),
            name,
            layout,
            taxels,
        }
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the taxels rest.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// What the taxels are.
    pub fn taxels(&self) -> &Taxels {
        &self.taxels
    }

    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        self.layout.n_taxels()
    }

    /// Its taxels, so that those near a ball are found.
    pub fn tree(&self) -> &TaxelTree {
        let make = || TaxelTree::new(&self.layout, &self.taxels);
        self.tree.get_or_init(make)
    }

    /// Its taxels as they travel along z.
    pub(crate) fn ahead(&self) -> &Travelling {
        self.ahead.get_or_init(|| Travelling::new(self, DVec3::Z))
    }

    /// The grid that it is, if all its taxels are as large and go as deep.
    pub(crate) fn even_grid(&self) -> Option<&EvenGrid> {
        self.even_grid.as_ref()
    }
}

impl EvenGrid {
    fn of(layout: &Layout, taxels: &Taxels) -> Option<Self> {
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

    const TAXEL: Taxel = Taxel {
        radius: 1e-3,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 5e-3,
    };

    #[test]
    fn a_patch_that_is_a_grid_knows_it() {
        let grid = Grid {
            nx: 4,
            ny: 3,
            pitch: 2e-3,
        };
        let skin = Patch::grid(grid, TAXEL).unwrap();
        assert_eq!((skin.name(), skin.n_taxels()), ("patch", 12));
        assert_eq!(skin.layout().as_grid(), Some(&grid));
        assert_eq!(skin.taxels().at(11), &TAXEL);
    }

    #[test]
    fn bad_taxels_are_refused_with_the_patch_and_the_taxel() {
        let layout = || Layout::new(vec![DVec3::ZERO, DVec3::X], vec![DVec3::Z; 2]).unwrap();
        let message = |taxels| {
            let skin = Patch::new("palm", layout(), taxels);
            skin.unwrap_err().to_string()
        };
        assert_eq!(
            message(Taxels::Each(vec![TAXEL])),
            "skin patch palm: 1 taxels for 2 places; one taxel a place, or one for all"
        );
        let stiff = Taxel {
            stiffness: -1.0,
            ..TAXEL
        };
        assert_eq!(
            message(Taxels::Each(vec![TAXEL, stiff])),
            "skin patch palm, taxel 2, taxel stiffness: -1 N/m; a finite positive number"
        );
        assert_eq!(
            message(Taxels::Equal(stiff)),
            "skin patch palm, taxel stiffness: -1 N/m; a finite positive number"
        );
    }
}
