//! Arrays of taxels that a study touches with.

use super::plan::millimetres;
use crate::contact::{Approach, Contact, SkinWorkspace, Workspace, press_to_depth};
use crate::error::Result;
use crate::geometry::Pose;
use crate::objects::Model;
use crate::signal::ReadSkin;
use crate::world::{ArrayLayout, Patch, Scene, SkinPatch, Taxel, Taxels};
use glam::{DVec2, DVec3};
use ndarray::Array2;
use std::sync::Arc;

/// Cells of a picture in a pitch: staggered rows are seen as such.
const PICTURE_CELLS: f64 = 3.0;

/// A square grid of taxels, or a layout that is made as dense and as large.
#[derive(Clone, Debug)]
pub struct TaxelArray {
    square: Patch,
    other: Option<OtherLayout>,
}

/// A layout that is no square grid.
#[derive(Clone, Debug)]
struct OtherLayout {
    layout: ArrayLayout,
    /// Of curvature, metres; 0 of a flat one.
    radius: f64,
    skin: Arc<SkinPatch>,
}

/// What a thread touches in.
#[derive(Debug, Default)]
pub struct ArrayWorkspace {
    grid: Workspace,
    skin: SkinWorkspace,
}

/// An array that is brought to one object.
pub enum ArrayPress<'a> {
    /// A square grid and the object.
    Grid(Scene),
    /// Another layout and the object.
    Skin(Box<Approach<'a>>, [Model; 1]),
}

impl From<Patch> for TaxelArray {
    fn from(square: Patch) -> Self {
        Self {
            square,
            other: None,
        }
    }
}

impl<'a> From<&'a TaxelArray> for ReadSkin<'a> {
    fn from(array: &'a TaxelArray) -> Self {
        match array.skin() {
            None => (&array.square).into(),
            Some(skin) => skin.into(),
        }
    }
}

impl TaxelArray {
    /// A layout in place of a square grid's; `radius`: of curvature, metres, of no use to a flat one.
    ///
    /// # Errors
    /// A radius around which it does not fit.
    pub fn new(layout: ArrayLayout, square: Patch, radius: f64) -> Result<Self> {
        let other = match layout {
            ArrayLayout::Grid => None,
            layout => {
                let taxels = layout.taxels(&square.grid, radius)?;
                let skin = SkinPatch::new(layout.words(), taxels, Taxels::Equal(square.taxel))?;
                Some(OtherLayout {
                    layout,
                    radius: if layout.is_curved() { radius } else { 0.0 },
                    skin: Arc::new(skin),
                })
            }
        };
        Ok(Self { square, other })
    }

    /// The square grid: that it is, or that the layout is as dense and as large as.
    pub fn square(&self) -> &Patch {
        &self.square
    }

    /// How its taxels lie.
    pub fn layout(&self) -> ArrayLayout {
        self.other
            .as_ref()
            .map_or(ArrayLayout::Grid, |other| other.layout)
    }

    /// What each of its taxels is.
    pub fn taxel(&self) -> &Taxel {
        &self.square.taxel
    }

    /// Its taxels, of a layout that is no square grid.
    pub fn skin(&self) -> Option<&SkinPatch> {
        self.other.as_ref().map(|other| other.skin.as_ref())
    }

    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        match self.skin() {
            None => self.square.grid.n_taxels(),
            Some(skin) => skin.n_taxels(),
        }
    }

    /// Rows and columns; `None` where a layout has none.
    pub fn sides(&self) -> Option<(usize, usize)> {
        self.layout().sides(&self.square.grid)
    }

    /// Rows and columns; one row of all taxels where a layout has none.
    pub fn shape(&self) -> (usize, usize) {
        self.sides().unwrap_or((1, self.n_taxels()))
    }

    /// Metres between taxels of the square grid.
    pub fn pitch(&self) -> f64 {
        self.square.grid.pitch
    }

    /// In words: `64×64 at 2 mm`.
    pub fn describe(&self) -> String {
        self.say("×", "")
    }

    /// The same with its taxels named: `64 × 64 taxels at 2 mm`.
    pub fn describe_taxels(&self) -> String {
        self.say(" × ", " taxels")
    }

    fn say(&self, times: &str, taxels: &str) -> String {
        let count = match self.sides() {
            Some((rows, columns)) => format!("{columns}{times}{rows}"),
            None => self.n_taxels().to_string(),
        };
        let count = format!("{count}{taxels} at {} mm", millimetres(self.pitch()));
        match self.layout() {
            ArrayLayout::Grid => count,
            other => format!("{count}, {}", other.words()),
        }
    }

    /// The cells of its pictures and the taxel that each shows: rows and columns; of a layout that is drawn otherwise the nearest taxel to each
    /// of three cells a pitch, seen along the axis in the middle, and none where none is near.
    pub fn picture_cells(&self) -> Array2<Option<usize>> {
        let (ny, nx) = self.shape();
        let Some(skin) = self.skin().filter(|_| self.is_drawn()) else {
            return Array2::from_shape_fn((ny, nx), |(row, column)| Some(row * nx + column));
        };
        let centers = skin.layout().centers();
        let widest = centers.iter().map(|c| c.x.abs().max(c.y.abs()));
        let half = widest.fold(0.0, f64::max) + 0.5 * self.pitch();
        let cell = self.pitch() / PICTURE_CELLS;
        let n = (2.0 * half / cell).ceil() as usize;
        Array2::from_shape_fn((n, n), |(row, column)| {
            let [x, y] = [column, row].map(|k| (k as f64 + 0.5) * cell - 0.5 * n as f64 * cell);
            let away = |taxel: usize| {
                let center = centers[taxel].truncate();
                (center - DVec2::new(x, y)).length_squared()
            };
            let nearest = (0..centers.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
            nearest.filter(|&taxel| away(taxel) < (0.75 * self.pitch()).powi(2))
        })
    }

    /// Millimetres between the cells of a picture.
    pub fn picture_pitch_mm(&self) -> f64 {
        match self.is_drawn() {
            true => 1e3 * self.pitch() / PICTURE_CELLS,
            false => millimetres(self.pitch()),
        }
    }

    /// Whether its pictures show other cells than rows and columns.
    fn is_drawn(&self) -> bool {
        !matches!(self.layout(), ArrayLayout::Grid | ArrayLayout::Cylinder)
    }

    /// All that its touches depend on.
    pub fn content(&self) -> String {
        match &self.other {
            None => format!("{:?}", self.square),
            Some(other) => format!("{:?} {:?} {}", self.square, other.layout, other.radius),
        }
    }

    /// Brings it to one object.
    pub fn press<'a>(&'a self, object: &Model) -> ArrayPress<'a> {
        match self.skin() {
            None => ArrayPress::Grid(Scene::of_one(&self.square, object)),
            Some(skin) => {
                let approach = Approach::new(skin, DVec3::Z);
                let approach = approach.expect("an axis has length one");
                ArrayPress::Skin(Box::new(approach), [object.clone()])
            }
        }
    }
}

impl ArrayPress<'_> {
    /// Presses to a depth (metres) past first contact; `None` where the way misses the object.
    pub fn to_depth(
        &self,
        pose: Pose,
        depth: f64,
        workspace: &mut ArrayWorkspace,
    ) -> Option<Contact> {
        match self {
            Self::Grid(scene) => press_to_depth(scene, &[pose], depth, &mut workspace.grid),
            Self::Skin(approach, object) => {
                let touch = approach.press_to_depth(object, &[pose], depth, &mut workspace.skin)?;
                Some(Contact {
                    travel: touch.travel,
                    n_touched: touch.counts.n_touched,
                    n_saturated: touch.counts.n_saturated,
                })
            }
        }
    }

    /// Deflections of the last press: n_taxels, metres.
    pub fn deflections<'w>(&self, workspace: &'w ArrayWorkspace) -> &'w [f64] {
        match self {
            Self::Grid(_) => workspace.grid.deflections(),
            Self::Skin(..) => workspace.skin.deflections(),
        }
    }
}
