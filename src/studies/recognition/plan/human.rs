//! Checks of `[human_touch]`, and conversion of its keys to SI units.

use crate::inputs::units::MAX_FRAMES;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::HumanTouchSpec;
use crate::world::{Layout, Patch, Taxels};

impl HumanTouchSpec {
    /// Returns the distance from the axis of the arm to the outer surface of the skin, metres.
    pub fn surface(&self) -> f64 {
        self.arm_radius_mm * MM
    }

    /// Returns the time between two frames of a recording, seconds.
    pub fn interval(&self) -> f64 {
        1.0 / self.frames_hz
    }

    /// Returns the number F of frames per touch.
    pub fn n_frames(&self) -> usize {
        (self.duration_s * self.frames_hz).round() as usize + 1
    }

    /// Returns the time between the first and the last frame of a recording, seconds.
    pub fn duration(&self) -> f64 {
        (self.n_frames() - 1) as f64 * self.interval()
    }

    /// Returns a patch with the array bent around the arm. The columns of the array form rings, its rows run along the arm, and its middle is at +x.
    ///
    /// # Errors
    /// If the array does not fit around the arm.
    pub fn skin(&self, array: &TaxelArray) -> Result<Patch> {
        let taxel = *array.taxel();
        let layout = Layout::bent_grid(array.grid(), self.surface() - taxel.radius)?;
        Patch::new("forearm", layout, Taxels::Equal(taxel))
    }
}

impl Check<'_> {
    /// Checks the table `[human_touch]` of a study: the array is a grid that fits around the arm.
    pub(crate) fn human_touch(&self, spec: &StudySpec, arrays: &[TaxelArray]) -> Result<()> {
        let Some(human) = &spec.human_touch else {
            return Ok(());
        };
        self.table("human_touch", human)?;
        self.grids(&spec.skin)?;
        let n_frames = (human.duration_s * human.frames_hz).round() + 1.0;
        if !(2.0..=MAX_FRAMES as f64).contains(&n_frames) {
            let allowed = format!("2 to {MAX_FRAMES} frames in duration_s at frames_hz");
            return Err(self.error("human_touch", format!("{n_frames} frames a touch"), allowed));
        }
        let mut arrays = arrays.iter();
        arrays.try_for_each(|array| self.fits_around(human, array))
    }

    /// Checks that the array leaves a gap of at least one pitch on the far side of the arm. Also checks that its layout has rows and columns.
    fn fits_around(&self, human: &HumanTouchSpec, array: &TaxelArray) -> Result<()> {
        let grid = array.grid();
        let radius = human.surface() - array.taxel().radius;
        let around = std::f64::consts::TAU * radius;
        let width = grid.nx as f64 * grid.pitch;
        if radius > 0.0 && width <= around && human.skin(array)?.n_taxels() == grid.n_taxels() {
            return Ok(());
        }
        let (pitch_mm, width_mm) = (millimetres(grid.pitch), width / MM);
        let columns = format!("{} columns at {pitch_mm} mm", grid.nx);
        let given = format!("{columns}, {width_mm:.1} mm together");
        let around_mm = around.max(0.0) / MM;
        let allowed = format!("at most {around_mm:.1} mm, once around the taxels' rest centres");
        Err(self.error("skin", given, allowed))
    }
}
