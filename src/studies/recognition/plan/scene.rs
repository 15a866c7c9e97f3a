//! Checks of `[objects]`, `[skin]`, `[touches]` and `[human_touch]`, and conversion of their keys to SI units.

use crate::inputs::check::MAX_VALUES;
use crate::inputs::units::{MAX_FRAMES, MAX_SIDE};
use crate::mesh::SizeLimits;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::{HumanTouchSpec, RangeSpec, SpreadSpec};
use crate::world::{Grid, Layout, Patch, Spread, Taxels};

/// Returns the smallest pitch of all arrays, metres.
fn finest_pitch(arrays: &[TaxelArray]) -> f64 {
    let pitches = arrays.iter().map(TaxelArray::pitch);
    pitches.fold(f64::INFINITY, f64::min)
}

impl ObjectsSpec {
    /// Sets the defaults that depend on the arrays: the contact model of meshes and the maximum surface error of packed spheres.
    pub fn settle_surface_error(&mut self, arrays: &[TaxelArray]) {
        if self.meshes.is_some() {
            // The default is stored in the specification, so that the results record which model was used.
            self.model.get_or_insert_default();
        }
        let finest = finest_pitch(arrays);
        let model = self.model.unwrap_or_default();
        let default = || model.default_surface_error_mm(finest / MM);
        self.pitch = Some(finest);
        self.surface_error_mm = Some(self.surface_error_mm.unwrap_or_else(default));
        self.settle_sizes(arrays);
    }

    /// Sets the range of allowed sizes of objects whose files do not state a unit of length.
    pub(crate) fn settle_sizes(&mut self, arrays: &[TaxelArray]) {
        let feels = |array: &TaxelArray| {
            let grid = array.grid();
            let n = grid.nx.max(grid.ny);
            (n as f64 * grid.pitch, array.taxel().radius)
        };
        self.sizes = Some(SizeLimits::of_arrays(arrays.iter().map(feels)));
    }
}

impl SkinSpec {
    /// Returns the parameters of the taxels in an array with the given pitch, mm.
    pub(crate) fn taxel(&self, pitch_mm: f64) -> Taxel {
        Taxel {
            radius: self.taxel_radius_mm.unwrap_or(0.5 * pitch_mm) * MM,
            stiffness: self.stiffness_n_per_m,
            damping: self.damping_n_s_per_m,
            stroke: self.stroke_mm * MM,
        }
    }
}

impl Check<'_> {
    /// Checks `[objects]`: the study names sets or meshes, and no key has no effect.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn objects(&self, objects: &ObjectsSpec) -> Result<()> {
        self.table("objects", objects)?;
        if objects.meshes.is_none() && objects.sets.is_empty() {
            let allowed = "sets = [...] or meshes = \"FOLDER\" (or --objects FOLDER)";
            return Err(self.error("objects", "neither sets nor meshes", allowed));
        }
        Ok(())
    }

    /// Checks `[skin]` and returns the array.
    pub(crate) fn array(&self, skin: &SkinSpec) -> Result<TaxelArray> {
        self.table("skin", skin)?;
        let n = self.taxels_a_side(skin)?;
        let grid = Grid {
            nx: n,
            ny: n,
            pitch: skin.pitch_mm * MM,
        };
        let taxel = skin.taxel(skin.pitch_mm);
        grid.check()?;
        taxel.check()?;
        let array = TaxelArray::new(skin, (grid, taxel));
        let place = || format!("{}, key skin.curvature_radius_mm, ", self.place);
        array.map_err(|error| error.under(place()))
    }

    /// Checks that the array is a square grid of taxels that read normal deflections or forces, and returns it. Any other key of `[skin]` is refused.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn grid(&self, skin: &SkinSpec) -> Result<TaxelArray> {
        let allowed = "no such key: only studies of recognition use it";
        self.of_all_kinds("skin", skin, allowed)?;
        self.array(skin)
    }

    fn taxels_a_side(&self, skin: &SkinSpec) -> Result<usize> {
        let pitch_mm = skin.pitch_mm;
        let size_mm = match (skin.size_mm, skin.taxels) {
            (Some(size_mm), _) => size_mm,
            (None, Some(n)) => return Ok(n),
            (None, None) => {
                return Err(self.error("skin", "neither size_mm nor taxels", "one of them"));
            }
        };
        let n = (size_mm / pitch_mm).round();
        let given = format!("{size_mm} mm at a pitch of {pitch_mm} mm");
        match (n * pitch_mm - size_mm).abs() > 1e-6 * pitch_mm || n < 1.0 {
            true => Err(self.error("skin.size_mm", given, "a whole number of pitches")),
            false => self.count("skin.size_mm", n as usize, MAX_SIDE),
        }
    }

    /// Returns the placement (distribution of touch poses). Any key of `[touches]` that does not describe poses or
    /// the press is refused.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn placement(&self, touches: &TouchesSpec) -> Result<Placement> {
        let allowed = "no such key: only studies of recognition and of breaking points use it";
        self.of_all_kinds("touches", touches, allowed)?;
        self.placed(touches)
    }

    /// Returns the placement (distribution of touch poses) in SI units.
    pub(crate) fn placed(&self, touches: &TouchesSpec) -> Result<Placement> {
        self.table("touches", touches)?;
        let degree = std::f64::consts::PI / 180.0;
        let spread = |axis: TouchAxis, spread, (ending, unit)| {
            let key = format!("touches.{}_{ending}", axis.name());
            self.spread((axis, &key), spread, unit)
        };
        let (mm, degree) = (("mm", MM), ("deg", degree));
        Ok(Placement {
            rest: touches.rest,
            offset_x: spread(TouchAxis::OffsetX, &touches.offset_x_mm, mm)?,
            offset_y: spread(TouchAxis::OffsetY, &touches.offset_y_mm, mm)?,
            yaw: spread(TouchAxis::Yaw, &touches.yaw_deg, degree)?,
            tilt_x: spread(TouchAxis::TiltX, &touches.tilt_x_deg, degree)?,
            tilt_y: spread(TouchAxis::TiltY, &touches.tilt_y_deg, degree)?,
            depth: spread(TouchAxis::Depth, &touches.depth_mm, mm)?,
            per_object: touches.per_object,
        })
    }

    /// Converts the values of a pose parameter to SI units. Depths must be positive, all other values finite. Values that describe the same pose are merged.
    fn spread(
        &self,
        (axis, key): (TouchAxis, &str),
        spread: &SpreadSpec,
        unit: f64,
    ) -> Result<Spread> {
        let values = match *spread {
            SpreadSpec::Range(RangeSpec::Within(0.0)) => vec![0.0],
            SpreadSpec::Range(RangeSpec::Within(half_width)) => {
                if !(half_width.is_finite() && half_width >= 0.0) {
                    return Err(self.error(key, half_width, "within zero or more"));
                }
                vec![-half_width, half_width]
            }
            SpreadSpec::Range(RangeSpec::Uniform((low, high))) => vec![low, high],
            SpreadSpec::Range(RangeSpec::Grid((first, last, count))) => {
                self.count(key, count, MAX_VALUES)?;
                let step = (last - first) / (count - 1).max(1) as f64;
                (0..count).map(|k| first + k as f64 * step).collect()
            }
            SpreadSpec::List(ref values) => values.clone(),
            SpreadSpec::One(value) => vec![value],
        };
        for &value in &values {
            self.number(key, value)?;
        }
        let ends = match *spread {
            SpreadSpec::Range(RangeSpec::Uniform((low, high))) => Some((low, high)),
            SpreadSpec::Range(RangeSpec::Within(half_width)) if half_width > 0.0 => {
                Some((-half_width, half_width))
            }
            _ => None,
        };
        if let Some((low, high)) = ends {
            if low >= high {
                let given = format!("uniform from {low} to {high}");
                return Err(self.error(key, given, "low below high"));
            }
            let (low, high) = (low * unit, high * unit);
            return Ok(Spread::Uniform { low, high });
        }
        let values = self.list(key, values)?;
        Ok(axis.listed(values.iter().map(|v| v * unit).collect()))
    }
}

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
    pub(crate) fn human_touch(&self, spec: &StudySpec, array: &TaxelArray) -> Result<()> {
        let Some(human) = &spec.human_touch else {
            return Ok(());
        };
        self.table("human_touch", human)?;
        self.grid(&spec.skin)?;
        let n_frames = (human.duration_s * human.frames_hz).round() + 1.0;
        if !(2.0..=MAX_FRAMES as f64).contains(&n_frames) {
            let allowed = format!("2 to {MAX_FRAMES} frames in duration_s at frames_hz");
            return Err(self.error("human_touch", format!("{n_frames} frames a touch"), allowed));
        }
        self.fits_around(human, array)
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
