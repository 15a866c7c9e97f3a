//! Arrays of taxels that a study presses on objects.

use crate::signal::{Chain, SignalStep};
use crate::studies::prelude::*;
use crate::studies::recognition::plan::{
    ListedTaxels, PlacedSensor, Sensed, SensorImage, of_channel,
};
use crate::world::{ArrayLayout, Grid, Patch, Taxels};
use bubbletouch_sim::features::Chart;
use glam::{DVec2, DVec3};
use ndarray::Array2;
use serde::Serializer;
use std::sync::Arc;

/// Number of picture cells per taxel pitch, for layouts other than the grid. With a smaller value, the offset of staggered rows is not visible.
const PICTURE_CELLS: f64 = 3.0;

/// Array of taxels: its layout, the quantity that its taxels read, and its slide along the object. Every layout has the density and size of a square grid.
#[derive(Clone, Debug)]
pub struct TaxelArray {
    /// Keys of `[skin]` that act, without those that `grid` contains. Arrays that differ in other keys share their touches.
    skin: Arc<SkinSpec>,
    grid: Grid,
    taxel: Taxel,
    layout: ArrayLayout,
    sensed: Sensed,
    slide: DVec2,
    /// Whether the positions of the taxels are known. If the positions are unknown, the taxels are treated as a single row.
    is_placed: bool,
    /// Taxels at listed positions; `None` if `layout` defines the positions.
    listed: Option<Arc<ListedTaxels>>,
    patch: Arc<Patch>,
}

impl TaxelArray {
    /// Creates an array of a skin, with a layout of the density and size of `grid`.
    ///
    /// # Errors
    /// If the grid, the taxel or a spring is invalid, or the layout does not fit the radius of curvature.
    pub fn new(skin: &SkinSpec, (grid, taxel): (Grid, Taxel)) -> Result<Self> {
        let layout = skin.layout.unwrap_or_default();
        let radius = radius(skin);
        let patch = match layout {
            ArrayLayout::Grid => Patch::grid(grid, taxel)?,
            _ => {
                let places = layout.taxels(&grid, radius)?;
                Patch::new(layout.words(), places, Taxels::Equal(taxel))?
            }
        };
        Self::of_patch(skin, (grid, taxel), patch)
    }

    /// Creates the array of sensors whose taxels have listed positions. `pitch` is the side of the square area per taxel, metres.
    ///
    /// # Errors
    /// If a sensor or the taxel is invalid.
    pub fn listed(
        skin: &SkinSpec,
        sensors: &[PlacedSensor],
        taxel: Taxel,
        pitch: f64,
    ) -> Result<Self> {
        let (listed, layout) = ListedTaxels::new(sensors)?;
        let side = (layout.n_taxels() as f64).sqrt().round() as usize;
        let (nx, ny) = (side, side);
        let patch = Patch::new("recorded", layout, Taxels::Equal(taxel))?;
        let of_grid = (Grid { nx, ny, pitch }, taxel);
        Ok(Self {
            listed: Some(Arc::new(listed)),
            ..Self::of_patch(skin, of_grid, patch)?
        })
    }

    /// Returns the array of a patch that does not slide.
    fn of_patch(skin: &SkinSpec, (grid, taxel): (Grid, Taxel), patch: Patch) -> Result<Self> {
        let sensed = skin.sensed();
        if let Sensed::Shear(shear) = &sensed {
            shear.check()?;
        }
        let layout = skin.layout.unwrap_or_default();
        let reads_shear = matches!(sensed, Sensed::Shear(_));
        Ok(Self {
            skin: Arc::new(SkinSpec {
                size_mm: None,
                taxels: None,
                curvature_radius_mm: skin.curvature_radius_mm.filter(|_| layout.is_curved()),
                friction: skin.friction.filter(|_| reads_shear),
                shear_stiffness_n_per_m: skin.shear_stiffness_n_per_m.filter(|_| reads_shear),
                ..skin.clone()
            }),
            grid,
            taxel,
            layout,
            sensed,
            slide: DVec2::ZERO,
            is_placed: true,
            listed: None,
            patch: Arc::new(patch),
        })
    }

    /// Sets the distances that the pressed array slides along its x and y axes, metres.
    pub fn sliding(self, slide: DVec2) -> Self {
        Self { slide, ..self }
    }

    /// Returns the array with unknown taxel positions, for recorded skins without a layout.
    pub fn without_places(mut self) -> Self {
        self.is_placed = false;
        self
    }

    /// Returns the array with taxels that read nothing, given as one value for each taxel; see [`Patch::without`].
    pub fn without(mut self, is_absent: &[bool]) -> Self {
        self.patch = Arc::new(Patch::clone(&self.patch).without(is_absent));
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

    /// Returns the keys of `[skin]`, without the numbers of rows and columns.
    pub fn skin(&self) -> &SkinSpec {
        &self.skin
    }

    /// Returns the square grid of the array. For another layout, returns the grid that defines its density and size.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the layout of the array's taxels; `None` if the positions are listed or unknown.
    pub fn layout(&self) -> Option<ArrayLayout> {
        (self.is_placed && self.listed.is_none()).then_some(self.layout)
    }

    /// Returns whether taxels of different sensors are neighbours.
    pub fn couples_sensors(&self) -> bool {
        let listed = self.listed.as_ref();
        listed.is_some_and(|listed| listed.has_neighbours_across(&self.patch))
    }

    /// Returns words for the layout of the array's taxels, such as `a square grid`.
    pub fn layout_words(&self) -> String {
        match &self.listed {
            _ if !self.is_placed => "taxels without a layout".to_owned(),
            Some(listed) => listed.words(),
            None => format!("a {}", self.layout.words()),
        }
    }

    /// Returns the position of the taxel that belongs to a frame value, along x and y of the array, mm. Returns `None` if the positions are unknown.
    pub fn place_mm(&self, value: usize) -> Option<[f64; 2]> {
        let taxel = value % self.n_taxels();
        let place = match &self.listed {
            Some(listed) => listed.places()[taxel],
            None => self.patch.layout().centers()[taxel].truncate(),
        };
        self.is_placed.then(|| [place.x, place.y].map(millimetres))
    }

    /// Returns the quantity that the taxels read.
    pub fn sensed(&self) -> &Sensed {
        &self.sensed
    }

    /// Returns whether the array is a square grid that reads one normal quantity and does not slide.
    pub fn is_plain(&self) -> bool {
        self.layout() == Some(ArrayLayout::Grid)
            && self.sensed.n_channels() == 1
            && self.slide == DVec2::ZERO
    }

    /// Returns whether the taxels form straight rows and columns with a distance of one pitch along the surface.
    pub fn is_image(&self) -> bool {
        self.listed.is_none() && self.layout.is_image()
    }

    /// Returns the images of the array: one for each sensor.
    pub fn images(&self) -> Vec<SensorImage> {
        match &self.listed {
            Some(listed) => listed.images(),
            None => vec![SensorImage {
                taxels: 0..self.n_taxels(),
                shape: self.image().0,
                chart: self.chart(),
            }],
        }
    }

    /// Returns the numbers of rows and columns of the array's images, one for each sensor.
    pub fn image_shapes(&self) -> Vec<ImageShape> {
        match &self.listed {
            Some(listed) => listed.image_shapes(),
            None => vec![self.image().0],
        }
    }

    /// Returns the side length of a pixel of the array's images, metres.
    pub fn pixel(&self) -> f64 {
        match &self.listed {
            Some(listed) => listed.finest_pitch(),
            None => self.image().1,
        }
    }

    /// Returns the numbers of rows and columns of the array's images, and the side length of a pixel, metres. An image is a square around all taxels.
    fn image(&self) -> (ImageShape, f64) {
        let (n, pitch) = (self.grid.nx, self.pitch());
        if self.is_image() {
            return (self.grid.shape(), pitch);
        }
        let farthest = |far: f64, place: DVec2| far.max(place.abs().max_element());
        let half = self.chart_places().into_iter().fold(0.0, farthest);
        // Positions are centres of taxels. A pixel is the distance between the outermost centres plus one pitch, divided by the number of pixels.
        (ImageShape { ny: n, nx: n }, (2.0 * half + pitch) / n as f64)
    }

    /// Returns the mapping from taxels to image pixels; `None` if each taxel is one pixel.
    fn chart(&self) -> Option<Chart> {
        let spacing = (self.pitch(), self.layout.widest_pitches());
        let chart = || Chart::with_gaps(&self.chart_places(), spacing, self.image());
        (!self.is_image()).then(chart)
    }

    /// Returns the positions of the taxels after projection onto a plane, metres. On a sphere, distance along the surface and direction from the middle are
    /// preserved (azimuthal equidistant projection).
    fn chart_places(&self) -> Vec<DVec2> {
        let radius = radius(&self.skin);
        let place = |center: &DVec3| self.layout.place_on_plane(*center, radius);
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
    pub fn sides(&self) -> Option<ImageShape> {
        match &self.listed {
            Some(listed) => listed.sides(),
            None => self.layout.sides(&self.grid).filter(|_| self.is_placed),
        }
    }

    /// Returns the numbers of rows and columns of the array. A layout without rows and columns counts as one row.
    pub fn shape(&self) -> ImageShape {
        self.sides().unwrap_or(ImageShape::row(self.n_taxels()))
    }

    /// Returns the numbers of rows and columns of a frame. If a taxel has several channels, they are stacked vertically.
    pub fn frame_shape(&self) -> ImageShape {
        let ImageShape { ny, nx } = self.shape();
        ImageShape {
            ny: self.sensed.n_channels() * ny,
            nx,
        }
    }

    /// Returns the images of a frame that an ensemble of rows and columns measures one by one. The result contains their number, and the rows and columns
    /// of each. An image contains one kind of value of all taxels of a sensor. Returns `None` if a sensor has no rows and columns, or if sensors differ in
    /// them.
    pub fn equal_images(&self) -> Option<(usize, ImageShape)> {
        let (n_sensors, sides) = match &self.listed {
            Some(listed) => listed.equal_sides()?,
            None => (1, self.sides()?),
        };
        Some((n_sensors * self.sensed.n_channels(), sides))
    }

    /// Returns the images of a frame that an ensemble measures one by one. An ensemble that needs no rows and columns measures the frame as one image.
    pub fn measured_images(&self, ensemble: Ensemble) -> (usize, ImageShape) {
        let of_rows = ensemble.about().needs_rows;
        let images = of_rows.then(|| self.equal_images()).flatten();
        images.unwrap_or((1, self.frame_shape()))
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
            Some(ImageShape { ny, nx }) => format!("{nx}{times}{ny}"),
            None => self.n_taxels().to_string(),
        };
        let count = format!("{count}{taxels} at {} mm", millimetres(self.pitch()));
        let words = self.layout.words();
        match (self.layout, self.layout.neighbour_distance(self.pitch())) {
            _ if !self.is_placed => format!("{}{taxels} without a layout", self.n_taxels()),
            _ if let Some(listed) = &self.listed => match self.image_shapes().len() {
                1 => format!("{count}, {}", listed.words()),
                _ => format!("{}{taxels} of {}", self.n_taxels(), listed.words()),
            },
            (ArrayLayout::Grid, _) => count,
            (_, None) => format!("{count}, {words}"),
            (_, Some(distance)) => {
                format!("{count}, {words}, neighbours at {:.3} mm", 1e3 * distance)
            }
        }
    }

    /// Returns the taxel that each cell of a picture shows, shape (rows, columns). A grid has one cell per taxel. Other layouts are projected along the axis of
    /// the middle, with three cells per pitch. Each cell shows the nearest taxel, or none if all taxels are far away. Several sensors are side by side.
    pub fn picture_cells(&self) -> Array2<Option<usize>> {
        let ImageShape { ny, nx } = self.shape();
        if self.is_image() {
            return Array2::from_shape_fn((ny, nx), |(row, column)| Some(row * nx + column));
        }
        let centers = self.patch.layout().centers();
        let places: Vec<DVec2> = match &self.listed {
            Some(listed) => listed.places().to_vec(),
            None => centers.iter().map(|center| center.truncate()).collect(),
        };
        let pitch_at = |taxel| match &self.listed {
            Some(listed) => listed.pitch_at(taxel),
            None => self.pitch(),
        };
        let cell = self.picture_cell();
        let half = places
            .iter()
            .enumerate()
            .fold(DVec2::ZERO, |half, (taxel, place)| {
                half.max(place.abs() + 0.5 * pitch_at(taxel))
            });
        let half = match &self.listed {
            // A whole number of cells may be rounded up by a rounding error.
            Some(_) => half - 1e-6 * cell,
            None => DVec2::splat(half.max_element()),
        };
        let [ny, nx] = [half.y, half.x].map(|half| (2.0 * half / cell).ceil() as usize);
        let center_of = |k: usize, n: usize| (k as f64 + 0.5) * cell - 0.5 * n as f64 * cell;
        let mut nearest = Array2::from_elem((ny, nx), (f64::INFINITY, None));
        for (taxel, place) in places.iter().enumerate() {
            let reach = 0.75 * pitch_at(taxel);
            // Cells whose centres may be within reach.
            let range = |at: f64, n: usize| {
                let at = at / cell + 0.5 * n as f64;
                let low = (at - reach / cell - 1.0).max(0.0) as usize;
                low..((at + reach / cell + 1.0).ceil().max(0.0) as usize).min(n)
            };
            for row in range(place.y, ny) {
                for column in range(place.x, nx) {
                    let at = DVec2::new(center_of(column, nx), center_of(row, ny));
                    let away = (*place - at).length_squared();
                    if away < reach.powi(2) && away < nearest[[row, column]].0 {
                        nearest[[row, column]] = (away, Some(taxel));
                    }
                }
            }
        }
        nearest.mapv(|(_, taxel)| taxel)
    }

    /// Returns the distance between the centres of neighbouring picture cells of an array that is no grid, metres.
    fn picture_cell(&self) -> f64 {
        let pitch = match &self.listed {
            Some(listed) => listed.finest_pitch(),
            None => self.pitch(),
        };
        pitch / PICTURE_CELLS
    }

    /// Returns the distance between the centres of neighbouring picture cells, mm.
    pub fn picture_pitch_mm(&self) -> f64 {
        match self.is_image() {
            true => millimetres(self.pitch()),
            false => 1e3 * self.picture_cell(),
        }
    }
}

/// Writes all inputs that determine the frames of the array; of the patch, which is derived from them, only the absent taxels.
impl Serialize for TaxelArray {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let absent = self.patch.absent().iter().enumerate();
        let absent = absent.filter_map(|(taxel, is_absent)| is_absent.then_some(taxel));
        let absent: Vec<usize> = absent.collect();
        let of_skin = (&*self.skin, &self.grid, &self.taxel);
        let of_places = (self.is_placed, self.listed.as_deref(), absent);
        (of_skin, self.slide.to_array(), of_places).serialize(serializer)
    }
}

/// Returns the radius of curvature of a skin's layout, metres; 0 if it has none.
fn radius(skin: &SkinSpec) -> f64 {
    skin.curvature_radius_mm.unwrap_or(0.0) * MM
}

/// Returns the random seed for the sensor errors of an array's skin. The seed is equal in all touches and trials.
pub(crate) fn skin(study: &Seed, array: &TaxelArray) -> Seed {
    let ImageShape { ny, nx } = array.shape();
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
