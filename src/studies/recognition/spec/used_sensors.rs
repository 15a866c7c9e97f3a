//! Sensors of a recording that a study uses.

use crate::error::{Error, Result};
use crate::studies::recognition::spec::recorded::RecordedSpec;
use crate::studies::recognition::spec::recorded_sensor::{RecordedSensorSpec, SensorPlace};
use crate::studies::recognition::spec::zero::ZeroSpec;

/// Value of `recorded.sensor` that selects all sensors.
const ALL: &str = "all";

impl RecordedSpec {
    /// Returns the name and the specification of each sensor that the study uses. A recording without `sensors` is one sensor with the name `skin`. The
    /// specification of a sensor contains its own files, and the labels and groups of the recording.
    pub fn used_sensors(&self) -> Vec<(String, Self)> {
        if self.sensors.is_empty() {
            return vec![("skin".to_owned(), self.clone())];
        }
        let is_used = |sensor: &RecordedSensorSpec| match self.sensor.as_deref() {
            None | Some(ALL) => true,
            Some(name) => sensor.name == name,
        };
        let numbered = self.sensors.iter().enumerate();
        let used = numbered.filter(|(_, sensor)| is_used(sensor));
        let one = |(number, sensor): (usize, &RecordedSensorSpec)| {
            let sensor = sensor.clone();
            let spec = Self {
                frames: sensor.frames,
                frames_test: sensor.frames_test,
                order: sensor.order,
                grid: sensor.grid,
                layout: sensor.layout,
                lengths: sensor.lengths,
                lengths_test: sensor.lengths_test,
                zero: sensor.zero,
                full_scale: sensor.full_scale,
                sensors: Vec::new(),
                sensor: None,
                place: SensorPlace {
                    table: format!("recorded.sensors[{}]", number + 1),
                    pitch_mm: sensor.pitch_mm,
                    name: Some(sensor.name.clone()),
                },
                ..self.clone()
            };
            (sensor.name, spec)
        };
        used.map(one).collect()
    }

    /// Checks that the recording has either one array of frames or several sensors, and that the sensors have different names.
    ///
    /// # Errors
    /// If a key contradicts another one; the error contains the key.
    pub(super) fn check_sensors(&self) -> Result<()> {
        let refuse = |key: &str, given: String, allowed: &str| {
            Err(Error::input(format!("key recorded.{key}"), given, allowed))
        };
        if self.sensors.is_empty() {
            if self.frames.as_os_str().is_empty() {
                let allowed =
                    "frames = \"FILE\", or [[recorded.sensors]] with the frames of each sensor";
                return refuse("frames", "no such key".to_owned(), allowed);
            }
            return match &self.sensor {
                Some(name) => {
                    let allowed = "no such key without [[recorded.sensors]]";
                    refuse("sensor", format!("{name:?}"), allowed)
                }
                None => Ok(()),
            };
        }
        let of_each = [
            ("frames", !self.frames.as_os_str().is_empty()),
            ("frames_test", self.frames_test.is_some()),
            ("order", self.order.is_some()),
            ("grid", self.grid.is_some()),
            ("layout", self.layout.is_some()),
            ("lengths", self.lengths.is_some()),
            ("lengths_test", self.lengths_test.is_some()),
            ("zero", self.zero != ZeroSpec::default()),
            ("full_scale", self.full_scale.is_some()),
        ];
        if let Some((key, _)) = of_each.into_iter().find(|(_, is_given)| *is_given) {
            let allowed = "this key in each of [[recorded.sensors]]";
            return refuse(key, "given beside recorded.sensors".to_owned(), allowed);
        }
        if self.shear.is_some() || self.shear_test.is_some() || self.n_values > 1 {
            let allowed = "one value for each taxel: no shear and no skin.sensed = \"shear\"";
            return refuse("sensors", "sensors that read shear".to_owned(), allowed);
        }
        let names: Vec<&str> = self.sensors.iter().map(|s| &s.name[..]).collect();
        for (number, sensor) in self.sensors.iter().enumerate() {
            let key = |key: &str| format!("sensors[{}].{key}", number + 1);
            let name = &names[number];
            if name.is_empty() || *name == ALL || names[..number].contains(name) {
                let allowed = "a name that no other sensor has, and that is not `all`";
                return refuse(&key("name"), format!("{name:?}"), allowed);
            }
            if let Some(pitch) = sensor.pitch_mm
                && !(pitch.is_finite() && pitch > 0.0)
            {
                return refuse(&key("pitch_mm"), pitch.to_string(), "a positive number");
            }
            if let (Some(full_scale), ZeroSpec::One(zero)) = (sensor.full_scale, &sensor.zero)
                && (!full_scale.is_finite() || full_scale <= *zero)
            {
                let allowed = format!("a number above the zero, {zero}");
                return refuse(&key("full_scale"), full_scale.to_string(), &allowed);
            }
        }
        match self.sensor.as_deref() {
            None | Some(ALL) => Ok(()),
            Some(name) if names.contains(&name) => Ok(()),
            Some(name) => {
                let allowed = format!("{ALL}, {}", names.join(", "));
                refuse("sensor", format!("{name:?}"), &allowed)
            }
        }
    }
}
