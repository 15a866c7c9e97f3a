//! A body: patches of skin whose taxels need no bytes of their own.

use crate::contact::Lines;
use crate::error::{Error, Result};
use crate::objects::Sphere;
use crate::world::{Extrusion, Taxel};
use glam::DVec2;
use std::ops::Range;

/// Columns in a bundle. More: columns are looked at in vain; fewer: bundles are.
pub(super) const BUNDLE: usize = 8;
/// What rounding may add to a reach, far above 1e-16 and far below what is felt.
const ROUNDING: f64 = 1.0 + 1e-9;

/// A patch of a body: equal taxels in a row that is repeated along a line.
#[derive(Clone, Debug)]
pub struct BodyPatch {
    name: String,
    extrusion: Extrusion,
    taxel: Taxel,
    /// Of each bundle of columns, in their order.
    circles: Vec<Circle>,
    lines: Lines,
    /// Around all taxels from their rest centres back to the substrate, in the patch frame.
    ball: Sphere,
}

/// A circle in the plane across the rows.
#[derive(Clone, Copy, Debug)]
struct Circle {
    center: DVec2,
    radius: f64,
}

impl BodyPatch {
    /// The error names the patch and the property of its taxels that is out of its range.
    pub fn new(name: impl Into<String>, extrusion: Extrusion, taxel: Taxel) -> Result<Self> {
        let name = name.into();
        taxel
            .check()
            .map_err(|error| error.under(format!("body patch {name}, ")))?;
        let depth = taxel.stroke + taxel.radius;
        let columns: Vec<_> = extrusion.places().iter().zip(extrusion.axes()).collect();
        let ends = |column: &(&DVec2, &DVec2)| [*column.0, *column.0 - depth * *column.1];
        let circle = |columns: &[(&DVec2, &DVec2)]| Circle::around(columns.iter().flat_map(ends));
        let lines = Lines::at(extrusion.rows());
        let whole = circle(&columns);
        let (first, last) = (
            lines.positions[0],
            lines.positions[lines.positions.len() - 1],
        );
        let center = whole.center.extend(0.5 * (first + last));
        Ok(Self {
            ball: Sphere {
                center: extrusion.uvw_from_patch().transpose() * center,
                radius: whole.radius.hypot(0.5 * (last - first)),
            },
            circles: columns.chunks(BUNDLE).map(circle).collect(),
            name,
            extrusion,
            taxel,
            lines,
        })
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where the taxels rest.
    pub fn extrusion(&self) -> &Extrusion {
        &self.extrusion
    }

    /// What each of the taxels is.
    pub fn taxel(&self) -> &Taxel {
        &self.taxel
    }

    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        self.extrusion.n_taxels()
    }

    /// A ball in the patch frame that every sphere comes near to that pushes a taxel: nearer than the sum of the radii and ρ.
    pub fn ball(&self) -> Sphere {
        self.ball
    }

    /// The rows.
    pub(super) fn lines(&self) -> &Lines {
        &self.lines
    }

    /// Runs of neighbouring bundles that a circle of radius `reach` (with ρ in it) comes near; ranges of columns.
    #[inline(always)]
    pub(super) fn each_run_near(
        &self,
        center: DVec2,
        reach: f64,
        mut visit: impl FnMut(Range<usize>),
    ) {
        let n_columns = self.extrusion.places().len();
        let mut start = None;
        for (bundle, circle) in self.circles.iter().enumerate() {
            match (circle.is_near(center, reach), start) {
                (true, None) => start = Some(bundle * BUNDLE),
                (false, Some(from)) => {
                    visit(from..bundle * BUNDLE);
                    start = None;
                }
                _ => {}
            }
        }
        if let Some(from) = start {
            visit(from..n_columns);
        }
    }

    /// Whether a circle of radius `reach` (with ρ in it) comes near any bundle.
    #[inline(always)]
    pub(super) fn is_near(&self, center: DVec2, reach: f64) -> bool {
        let mut circles = self.circles.iter();
        circles.any(|circle| circle.is_near(center, reach))
    }
}

impl Circle {
    fn around(points: impl Iterator<Item = DVec2> + Clone) -> Self {
        let center = points.clone().sum::<DVec2>() / points.clone().count() as f64;
        let distances = points.map(|point| point.distance(center));
        Self {
            center,
            radius: distances.fold(0.0, f64::max),
        }
    }

    #[inline(always)]
    fn is_near(&self, center: DVec2, reach: f64) -> bool {
        let reach = (self.radius + reach) * ROUNDING;
        self.center.distance_squared(center) <= reach * reach
    }
}

/// All patches of a body.
///
/// Taxels are numbered patch by patch, each in the order of its [`Extrusion`].
#[derive(Clone, Debug)]
pub struct WholeBody {
    patches: Vec<BodyPatch>,
    /// The number of each patch's first taxel.
    firsts: Vec<usize>,
    n_taxels: usize,
}

impl WholeBody {
    /// The error names a patch that has the name of another one.
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
}
