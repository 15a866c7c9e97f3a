//! Arrays of taxels that a study touches with.

use crate::error::Result;
use crate::inputs::units::millimetres;
use crate::random::Seed;
use crate::signal::{Chain, SignalStep};
use crate::studies::recognition::plan::sensed::{Sensed, of_channel};
use crate::world::{ArrayLayout, Grid, Patch, Taxel, Taxels};
use bubbletouch_sim::features::Chart;
use glam::{DVec2, DVec3};
use ndarray::Array2;
use std::fmt;
use std::sync::Arc;

/// Cells of a picture in a pitch: staggered rows are seen as such.
const PICTURE_CELLS: f64 = 3.0;

/// A square grid of taxels, or a layout that is made as dense and as large; what they read; and how they are drawn along what they touch.
#[derive(Clone)]
pub struct TaxelArray {
    grid: Grid,
    taxel: Taxel,
    layout: ArrayLayout,
    /// Of curvature, metres; 0 of a flat layout.
    radius: f64,
    sensed: Sensed,
    slide: DVec2,
    /// Whether it is known where its taxels are; otherwise the grid is a row of them.
    is_placed: bool,
    patch: Arc<Patch>,
}

impl TaxelArray {
    /// A layout in place of a square grid's; `radius`: of curvature, metres, of no use to a flat one.
    ///
    /// # Errors
    /// A grid or a taxel that cannot be; a radius around which it does not fit.
    pub fn new(layout: ArrayLayout, (grid, taxel): (Grid, Taxel), radius: f64) -> Result<Self> {
        let patch = match layout {
            ArrayLayout::Grid => Patch::grid(grid, taxel)?,
            _ => {
                let places = layout.taxels(&grid, radius)?;
                Patch::new(layout.words(), places, Taxels::Equal(taxel))?
            }
        };
        Ok(Self {
            grid,
            taxel,
            layout,
            radius: if layout.is_curved() { radius } else { 0.0 },
            sensed: Sensed::Deflection,
            slide: DVec2::ZERO,
            is_placed: true,
            patch: Arc::new(patch),
        })
    }

    /// The same that reads something else, and slides along its own x and y (metres) once it is pressed.
    ///
    /// # Errors
    /// Shear springs that cannot be.
    pub fn reading(mut self, sensed: Sensed, slide: DVec2) -> Result<Self> {
        if let Sensed::Shear(shear) = &sensed {
            shear.check()?;
        }
        (self.sensed, self.slide) = (sensed, slide);
        Ok(self)
    }

    /// The same of taxels of which nothing says where they are.
    pub fn without_places(mut self) -> Self {
        self.is_placed = false;
        self
    }

    /// Whether it is known where its taxels are.
    pub fn is_placed(&self) -> bool {
        self.is_placed
    }

    /// Its taxels.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The square grid: that it is, or that the layout is as dense and as large as.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How its taxels lie.
    pub fn layout(&self) -> ArrayLayout {
        self.layout
    }

    /// What its taxels read.
    pub fn sensed(&self) -> &Sensed {
        &self.sensed
    }

    /// Whether it is a square grid that reads what pushes it in and does not slide.
    pub fn is_plain(&self) -> bool {
        self.layout == ArrayLayout::Grid
            && self.sensed.n_channels() == 1
            && self.slide == DVec2::ZERO
    }

    /// Whether its taxels lie in straight rows and columns, one pitch apart along the surface.
    pub fn is_image(&self) -> bool {
        self.layout.is_image()
    }

    /// Rows and columns of its images, and their pixels' size, metres: a square around all taxels.
    pub fn image(&self) -> ((usize, usize), f64) {
        let (n, pitch) = (self.grid.nx, self.pitch());
        if self.is_image() {
            return ((self.grid.ny, n), pitch);
        }
        let farthest = |far: f64, place: DVec2| far.max(place.abs().max_element());
        let half = self.chart_places().into_iter().fold(0.0, farthest);
        // Places are centres: a pixel's side is between the outermost two of a row and what they feel.
        ((n, n), (2.0 * half + pitch) / n as f64)
    }

    /// How its taxels make images; `None` where they are pixels.
    pub fn chart(&self) -> Option<Chart> {
        let chart = || Chart::new(&self.chart_places(), self.pitch(), self.image());
        (!self.is_image()).then(chart)
    }

    /// Where taxels are on a plane, metres: on a flat patch where they are, on a sphere as far along its surface from the middle, in the same direction
    /// (the azimuthal equidistant projection).
    fn chart_places(&self) -> Vec<DVec2> {
        let place = |center: &DVec3| self.layout.place_on_plane(*center, self.radius);
        self.patch.layout().centers().iter().map(place).collect()
    }

    /// How far it goes along its own x and y once it is pressed, metres.
    pub fn slide(&self) -> DVec2 {
        self.slide
    }

    /// What each of its taxels is.
    pub fn taxel(&self) -> &Taxel {
        &self.taxel
    }

    /// How many taxels.
    pub fn n_taxels(&self) -> usize {
        self.patch.n_taxels()
    }

    /// How many numbers a frame has: one or more a taxel, channel by channel.
    pub fn n_values(&self) -> usize {
        self.sensed.n_channels() * self.n_taxels()
    }

    /// Rows and columns; `None` where a layout has none.
    pub fn sides(&self) -> Option<(usize, usize)> {
        self.layout.sides(&self.grid).filter(|_| self.is_placed)
    }

    /// Rows and columns; one row of all taxels where a layout has none.
    pub fn shape(&self) -> (usize, usize) {
        self.sides().unwrap_or((1, self.n_taxels()))
    }

    /// Rows and columns of a frame: those of its channels below each other.
    pub fn frame_shape(&self) -> (usize, usize) {
        let (rows, columns) = self.shape();
        (self.sensed.n_channels() * rows, columns)
    }

    /// Metres between taxels of the square grid.
    pub fn pitch(&self) -> f64 {
        self.grid.pitch
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
        let words = self.layout.words();
        match (self.layout, self.layout.neighbour_distance(self.pitch())) {
            _ if !self.is_placed => format!("{}{taxels} without a layout", self.n_taxels()),
            (ArrayLayout::Grid, _) => count,
            (_, None) => format!("{count}, {words}"),
            (_, Some(distance)) => {
                format!("{count}, {words}, neighbours at {:.3} mm", 1e3 * distance)
            }
        }
    }

    /// The cells of its pictures and the taxel that each shows: rows and columns; of a layout that is drawn otherwise the nearest taxel to each
    /// of three cells a pitch, seen along the axis in the middle, and none where none is near.
    pub fn picture_cells(&self) -> Array2<Option<usize>> {
        let (ny, nx) = self.shape();
        if self.is_image() {
            return Array2::from_shape_fn((ny, nx), |(row, column)| Some(row * nx + column));
        }
        let centers = self.patch.layout().centers();
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
        match self.is_image() {
            true => millimetres(self.pitch()),
            false => 1e3 * self.pitch() / PICTURE_CELLS,
        }
    }
}

/// All that its frames depend on: the patch is made of the other fields.
impl fmt::Debug for TaxelArray {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            grid,
            taxel,
            layout,
            radius,
            sensed,
            slide,
            is_placed,
            patch: _,
        } = self;
        let places = if *is_placed { "" } else { " without places" };
        write!(
            f,
            "{grid:?} {taxel:?} {layout:?} {radius} {sensed:?} {slide}{places}"
        )
    }
}

/// The skin of a study's array: the same in each touch and trial.
pub(crate) fn skin(study: &Seed, array: &TaxelArray) -> Seed {
    let (ny, nx) = array.shape();
    let sides = study.named("skin").numbered(nx as u64);
    let sides = sides.numbered(ny as u64);
    sides.numbered(array.pitch().to_bits())
}

impl TaxelArray {
    /// The signal of each channel, with the steps that a skin of some name has: channels are read by converters of their own, so each has a name, and
    /// noise, of its own; the first has that of the skin.
    ///
    /// # Errors
    /// Those of [`Chain::new`].
    pub fn chains(
        &self,
        skin: &Seed,
        steps: impl Fn(&Seed) -> Vec<SignalStep>,
    ) -> Result<Vec<Chain>> {
        let channels = 0..self.sensed().n_channels();
        let chain = |channel| {
            let mut steps = steps(&of_channel(skin, channel));
            if *self.sensed() != Sensed::Deflection {
                steps.insert(0, SignalStep::Force);
            }
            match channel {
                0 => Chain::new(&steps, self.patch()),
                _ => Chain::of_shear(&steps, self.patch()),
            }
        };
        channels.map(chain).collect()
    }
}
