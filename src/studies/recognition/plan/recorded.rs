//! Checks of the table `[recorded]`, and creation of the array that recorded the frames.

use crate::inputs::layout_file::{LayoutFile, LayoutOptions};
use crate::studies::prelude::*;
use crate::studies::recognition::plan::PlacedSensor;
use crate::studies::recognition::spec::ZeroSpec;
use crate::world::{ArrayLayout, Grid};

impl RecordedSpec {
    /// Sets the number of values per taxel in the recorded frames, which depends on the quantity that the skin reads.
    pub(crate) fn settle_values(&mut self, skin: &SkinSpec) {
        self.n_values = match skin.sensed.unwrap_or_default() {
            SensedSpec::Shear => 3,
            SensedSpec::Deflection | SensedSpec::Force => 1,
        };
    }

    /// Returns keys of `[touches]` that describe the recording: the number of frames and, if time passes between frames, a speed.
    ///
    /// # Errors
    /// If the file of the frames does not exist or has other axes.
    pub(crate) fn as_touches(&self) -> Result<TouchesSpec> {
        let moves =
            self.frame_interval_s.is_some() || self.speed_mm_per_s > 0.0 && self.depths.is_some();
        let sensors = self.used_sensors();
        let (_, first) = sensors.first().expect("the sensors are checked");
        let n_frames = match self.resampled_frames {
            Some(n_frames) => n_frames,
            None => first.shape_of("frames")?.n_frames,
        };
        Ok(TouchesSpec {
            frames: Axis::One(n_frames),
            speed_mm_per_s: if moves { 1.0 } else { 0.0 },
            ..TouchesSpec::default()
        })
    }
}

impl Check<'_> {
    /// Checks the table `[recorded]` and returns the array with which the frames were recorded. Keys that describe simulated touches are not allowed.
    pub(crate) fn recorded(&self, recorded: &RecordedSpec, spec: &StudySpec) -> Result<TaxelArray> {
        if spec.objects != ObjectsSpec::default()
            || spec.touches != TouchesSpec::default()
            || spec.human_touch.is_some()
        {
            let given = "beside [objects], [touches] or [human_touch]";
            let allowed = "it alone: it is what the skin has read";
            return Err(self.error("recorded", given, allowed));
        }
        self.table("recorded", recorded)?;
        // Zeros from a file are compared with the full scale when the frames are read.
        if let (Some(full_scale), ZeroSpec::One(zero)) = (recorded.full_scale, &recorded.zero)
            && full_scale == *zero
        {
            let allowed = format!("a number other than recorded.zero, {zero}");
            return Err(self.error("recorded.full_scale", full_scale, allowed));
        }
        self.of_time(recorded, spec)?;
        let place = |error: Error| error.under(format!("{}, ", self.place));
        recorded.check_files().map_err(place)?;
        for key in ["skin.pitch_mm", "skin.size_mm", "skin.taxels"] {
            let n = spec.axes.n_values(key);
            if n > 1 {
                let allowed = "one, of the skin that read the frames";
                return Err(self.error(key, format!("{n} values"), allowed));
            }
        }
        let array = self.array_of(recorded, &spec.skin)?;
        let smoothings = spec.signal.axes.get("smoothing_mm").into_iter();
        let smooths = smoothings.flat_map(Axis::values).any(|width| width > 0.0);
        let needs_places =
            |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().needs_places);
        let needs_layout =
            |step: &&StepSpec| needs_places(step) || smooths && **step == StepSpec::Smoothing;
        let mut steps = spec.signal.steps.iter();
        if !array.is_placed()
            && let Some(step) = steps.clone().find(needs_layout)
        {
            let given = format!("\"{}\" of taxels without a layout", step.word());
            let allowed = "steps of each taxel by itself (recorded.layout gives positions; recorded.grid or recorded.order names rows and columns)";
            return Err(self.error("signal.steps", given, allowed));
        }
        if let Some(step) = steps.find(|step| needs_places(step))
            && array.couples_sensors()
        {
            let word = step.word();
            let given = format!("\"{word}\" of sensors of which one has a single row of taxels");
            let allowed = "sensors with rows and columns, or one sensor (recorded.sensor)";
            return Err(self.error("signal.steps", given, allowed));
        }
        Ok(array)
    }

    /// Checks the keys for the approach speed and for the time between frames.
    fn of_time(&self, recorded: &RecordedSpec, spec: &StudySpec) -> Result<()> {
        if spec.skin.damping_n_s_per_m == 0.0
            && recorded.speed_mm_per_s > 0.0
            && recorded.depths.is_none()
        {
            let allowed = "recorded.depths beside it (its time between frames), or a damper (skin.damping_n_s_per_m)";
            return Err(self.error("recorded.speed_mm_per_s", recorded.speed_mm_per_s, allowed));
        }
        if recorded.speed_mm_per_s > 0.0 && recorded.n_values > 1 {
            let allowed = "0 where skin.sensed is shear";
            return Err(self.error("recorded.speed_mm_per_s", recorded.speed_mm_per_s, allowed));
        }
        if let Some(interval) = recorded.frame_interval_s
            && recorded.speed_mm_per_s > 0.0
            && recorded.depths.is_some()
        {
            let allowed = "no such key: recorded.depths and recorded.speed_mm_per_s say how much time goes on between frames";
            return Err(self.error("recorded.frame_interval_s", interval, allowed));
        }
        Ok(())
    }

    fn array_of(&self, recorded: &RecordedSpec, skin: &SkinSpec) -> Result<TaxelArray> {
        self.table("skin", skin)?;
        let sensors = recorded.used_sensors();
        if skin.layout.unwrap_or_default() != ArrayLayout::Grid {
            return self.array_of_layout(&sensors, skin);
        }
        let pitch_mm = skin.pitch_mm;
        let (mut placed, mut n_taxels) = (Vec::new(), 0);
        for (name, sensor) in &sensors {
            let shape = sensor.shape_of("frames")?;
            n_taxels += shape.n_taxels;
            let pitch_mm = sensor.place.pitch_mm.unwrap_or(pitch_mm);
            placed.push(sensor.placed(name, pitch_mm * MM)?);
        }
        // The array of a single sensor has the pitch of the sensor.
        let pitch_mm = match &sensors[..] {
            [(_, sensor)] => sensor.place.pitch_mm.unwrap_or(pitch_mm),
            _ => pitch_mm,
        };
        let taxel = skin.taxel(pitch_mm);
        taxel.check()?;
        // If the positions of some taxels are unknown, all taxels form one list.
        let placed: Option<Vec<Vec<PlacedSensor>>> = placed.into_iter().collect();
        let placed = placed.map(|sensors| sensors.concat());
        let grid = match placed.as_deref() {
            Some([one]) => one.layout.as_grid().copied(),
            Some(_) => None,
            None => Some(Grid {
                nx: n_taxels,
                ny: 1,
                pitch: pitch_mm * MM,
            }),
        };
        match (grid, placed) {
            (Some(grid), placed) => {
                grid.check()?;
                let array = TaxelArray::new(skin, (grid, taxel))?;
                Ok(match placed {
                    Some(_) => array,
                    None => array.without_places(),
                })
            }
            (None, placed) => {
                let sensors = placed.unwrap_or_default();
                TaxelArray::listed(skin, &sensors, taxel, pitch_mm * MM)
            }
        }
    }

    /// Returns the array with the layout of `skin.layout`, which must have the taxels of the recording.
    fn array_of_layout(
        &self,
        sensors: &[(String, RecordedSpec)],
        skin: &SkinSpec,
    ) -> Result<TaxelArray> {
        let [(_, sensor)] = sensors else {
            let allowed = "no such key beside recorded.sensors: recorded.sensors[1].layout is the layout file of a sensor";
            return Err(self.error("skin.layout", "given", allowed));
        };
        if let Some(path) = &sensor.layout {
            let allowed = "no such key beside skin.layout";
            return Err(self.error(&sensor.place.key("layout"), path.display(), allowed));
        }
        let array = self.touching_array(skin, &TouchesSpec::default())?;
        let n_taxels = sensor.shape_of("frames")?.n_taxels;
        if array.n_taxels() != n_taxels {
            let given = format!("{} taxels", array.n_taxels());
            let allowed = format!("{n_taxels}, as {} has", sensor.frames.display());
            return Err(self.error("skin.layout", given, allowed));
        }
        Ok(array)
    }
}

impl RecordedSpec {
    /// Returns the sensor with the positions of its taxels: those of the layout file, or those of a grid. If several values are recorded at each position, the values of
    /// each kind form a sensor. Returns `None` if the positions are unknown. `pitch` is the side of the square area per taxel, metres.
    fn placed(&self, name: &str, pitch: f64) -> Result<Option<Vec<PlacedSensor>>> {
        let shape = self.shape_of("frames")?;
        let sides = shape.sides;
        let n_values = shape.n_taxels / shape.n_places;
        let of_values = |sensor: PlacedSensor| -> Vec<PlacedSensor> {
            let mut sensors = vec![sensor; n_values];
            for (value, sensor) in sensors.iter_mut().enumerate().filter(|_| n_values > 1) {
                sensor.name = format!("{name}, value {}", value + 1);
            }
            sensors
        };
        let Some(path) = &self.layout else {
            let sensor = |[ny, nx]: [usize; 2]| PlacedSensor::grid(name, &Grid { nx, ny, pitch });
            return Ok(sides.map(sensor).transpose()?.map(of_values));
        };
        let layout = LayoutFile::read(path, LayoutOptions::default())?.layout;
        let place = path.display().to_string();
        if layout.n_taxels() != shape.n_places {
            let given = format!("{} taxels", layout.n_taxels());
            let allowed = format!("{}, as {} has", shape.n_places, self.frames.display());
            return Err(Error::input(place, given, allowed));
        }
        let sensor = PlacedSensor::new(name, (&place, layout), pitch, sides)?;
        Ok(Some(of_values(sensor)))
    }
}
