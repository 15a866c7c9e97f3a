//! Arrays of taxels that a study presses on objects.

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

/// Number of picture cells per taxel pitch, for layouts other than the grid. With a smaller value, the offset of staggered rows is not visible.
const PICTURE_CELLS: f64 = 3.0;

/// Array of taxels: its layout, the quantity that its taxels read, and its slide along the object. Every layout has the density and size of a square grid.
#[derive(Clone)]
pub struct TaxelArray {
    grid: Grid,
    taxel: Taxel,
    layout: ArrayLayout,
    /// Radius of curvature of the layout, metres; 0 if the layout is flat.
    radius: f64,
    sensed: Sensed,
    slide: DVec2,
    /// Whether the positions of the taxels are known. If the positions are unknown, the taxels are treated as a single row.
    is_placed: bool,
    patch: Arc<Patch>,
}

impl TaxelArray {
    /// Creates an array with a layout of the density and size of `grid`. `radius` is the radius of curvature, metres; flat layouts ignore it.
    ///
    /// # Errors
    /// If the grid or the taxel is invalid, or the layout does not fit the radius.
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

    /// Sets the quantity that the taxels read, and the distances that the pressed array slides along its x and y axes, metres.
    ///
    /// # Errors
    /// If the shear springs are invalid.
    pub fn reading(mut self, sensed: Sensed, slide: DVec2) -> Result<Self> {
        if let Sensed::Shear(shear) = &sensed {
            shear.check()?;
        }
        (self.sensed, self.slide) = (sensed, slide);
        Ok(self)
    }

    /// Returns the array with unknown taxel positions, for recorded skins without a layout.
    pub fn without_places(mut self) -> Self {
        self.is_placed = false;
        self
    }

    /// Returns whether the positions of the array's taxels are known.
    pub fn is_placed(&self) -> bool {
        self.is_placed
    }

    /// Returns the patch that consists of the array's taxels.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// Returns the square grid of the array. For another layout, returns the grid that defines its density and size.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the layout of the array's taxels.
    pub fn layout(&self) -> ArrayLayout {
        self.layout
    }

    /// Returns the position of the taxel that belongs to a frame value, along x and y of the array, mm; `None` if the positions are unknown.
    pub fn place_mm(&self, value: usize) -> Option<[f64; 2]> {
        let center = self.patch.layout().centers()[value % self.n_taxels()];
        self.is_placed
            .then(|| [center.x, center.y].map(millimetres))
    }

    /// Returns the quantity that the taxels read.
    pub fn sensed(&self) -> &Sensed {
        &self.sensed
    }

    /// Returns whether the array is a square grid that reads one normal quantity and does not slide.
    pub fn is_plain(&self) -> bool {
        self.layout == ArrayLayout::Grid
            && self.sensed.n_channels() == 1
            && self.slide == DVec2::ZERO
    }

    /// Returns whether the taxels form straight rows and columns with a distance of one pitch along the surface.
    pub fn is_image(&self) -> bool {
        self.layout.is_image()
    }

    /// Returns the numbers of rows and columns of the array's images, and the side length of a pixel, metres. An image is a square around all taxels.
    pub fn image(&self) -> ((usize, usize), f64) {
        let (n, pitch) = (self.grid.nx, self.pitch());
        if self.is_image() {
            return ((self.grid.ny, n), pitch);
        }
        let farthest = |far: f64, place: DVec2| far.max(place.abs().max_element());
        let half = self.chart_places().into_iter().fold(0.0, farthest);
        // Positions are centres of taxels. A pixel is the distance between the outermost centres plus one pitch, divided by the number of pixels.
        ((n, n), (2.0 * half + pitch) / n as f64)
    }

    /// Returns the mapping from taxels to image pixels; `None` if each taxel is one pixel.
    pub fn chart(&self) -> Option<Chart> {
        let spacing = (self.pitch(), self.layout.widest_pitches());
        let chart = || Chart::with_gaps(&self.chart_places(), spacing, self.image());
        (!self.is_image()).then(chart)
    }

    /// Returns the positions of the taxels after projection onto a plane, metres. On a sphere, distance along the surface and direction from the middle are
    /// preserved (azimuthal equidistant projection).
    fn chart_places(&self) -> Vec<DVec2> {
        let place = |center: &DVec3| self.layout.place_on_plane(*center, self.radius);
        self.patch.layout().centers().iter().map(place).collect()
    }

    /// Returns the distances that the pressed array slides along its x and y axes, metres.
    pub fn slide(&self) -> DVec2 {
        self.slide
    }

    /// Returns the parameters of the array's taxels.
    pub fn taxel(&self) -> &Taxel {
        &self.taxel
    }

    /// Returns the number of taxels of the array.
    pub fn n_taxels(&self) -> usize {
        self.patch.n_taxels()
    }

    /// Returns the number of values per frame: one or more per taxel, ordered by channel (quantity that a taxel reads).
    pub fn n_values(&self) -> usize {
        self.sensed.n_channels() * self.n_taxels()
    }

    /// Returns the numbers of rows and columns of taxels; `None` if the layout has no rows and columns.
    pub fn sides(&self) -> Option<(usize, usize)> {
        self.layout.sides(&self.grid).filter(|_| self.is_placed)
    }

    /// Returns the numbers of rows and columns of the array. A layout without rows and columns counts as one row.
    pub fn shape(&self) -> (usize, usize) {
        self.sides().unwrap_or((1, self.n_taxels()))
    }

    /// Returns the numbers of rows and columns of a frame. If a taxel has several channels, they are stacked vertically.
    pub fn frame_shape(&self) -> (usize, usize) {
        let (rows, columns) = self.shape();
        (self.sensed.n_channels() * rows, columns)
    }

    /// Returns the pitch of the square grid, metres.
    pub fn pitch(&self) -> f64 {
        self.grid.pitch
    }

    /// Returns a short description of the array, such as `64×64 at 2 mm`.
    pub fn describe(&self) -> String {
        self.say("×", "")
    }

    /// Returns a description of the array that contains the word "taxels", such as `64 × 64 taxels at 2 mm`.
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

    /// Returns the taxel that each cell of a picture shows, shape (rows, columns). A grid has one cell per taxel. Other layouts are projected along the axis of
    /// the middle, with three cells per pitch. Each cell shows the nearest taxel, or none if all taxels are far away.
    pub fn picture_cells(&self) -> Array2<Option<usize>> {
        let (ny, nx) = self.shape();
        if self.is_image() {
            return Array2::from_shape_fn((ny, nx), |(row, column)| Some(row * nx + column));
        }
        let centers = self.patch.layout().centers();
        let widest = centers.iter().map(|c| c.x.abs().max(c.y.abs()));
        let half = widest.fold(0.0, f64::max) + 0.5 * self.pitch();
        let configuration = self.pitch() / PICTURE_CELLS;
        let n = (2.0 * half / configuration).ceil() as usize;
        Array2::from_shape_fn((n, n), |(row, column)| {
            let [x, y] = [column, row]
                .map(|k| (k as f64 + 0.5) * configuration - 0.5 * n as f64 * configuration);
            let away = |taxel: usize| {
                let center = centers[taxel].truncate();
                (center - DVec2::new(x, y)).length_squared()
            };
            let nearest = (0..centers.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
            nearest.filter(|&taxel| away(taxel) < (0.75 * self.pitch()).powi(2))
        })
    }

    /// Returns the distance between the centres of neighbouring picture cells, mm.
    pub fn picture_pitch_mm(&self) -> f64 {
        match self.is_image() {
            true => millimetres(self.pitch()),
            false => 1e3 * self.pitch() / PICTURE_CELLS,
        }
    }
}

/// Writes all inputs that determine the frames of the array; the patch is omitted because it is derived from them.
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

/// Returns the random seed for the sensor errors of an array's skin. The seed is equal in all touches and trials.
pub(crate) fn skin(study: &Seed, array: &TaxelArray) -> Seed {
    let (ny, nx) = array.shape();
    let sides = study.named("skin").numbered(nx as u64);
    let sides = sides.numbered(ny as u64);
    sides.numbered(array.pitch().to_bits())
}

impl TaxelArray {
    /// Returns a signal chain for each channel (quantity that a taxel reads). For the seed of a channel, `steps` returns the steps of its chain. Each channel
    /// has its own converter, and therefore its own seed and noise; the first channel has the seed of the skin.
    ///
    /// # Errors
    /// If a step is invalid for the array.
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
