//! Sensors of a recording that a study uses.

use crate::error::{Error, Result};
use crate::inputs::params::variants;
use crate::studies::recognition::spec::recorded::RecordedSpec;
use crate::studies::recognition::spec::recorded_sensor::{
    RecordedSensorSpec, SensorPlace, sensor_table,
};
use crate::studies::recognition::spec::zero::ZeroSpec;

/// Value of `recorded.sensor` that selects all sensors.
const ALL: &str = "all";
/// Character between the names of several sensors in a text.
const AND: char = '+';

variants! {
    /// Sensors whose readings a study uses, such as `"all"`, `"palm"`, `"palm+thumb"` or `["palm", "thumb"]`.
    #[serde(expecting = "expected the name of a sensor, names joined by `+`, a list of names, or `all`")]
    pub untagged enum SensorChoice, Deserialize {
        /// `all`, a name, or names joined by `+`.
        Text(String),
        /// List of names.
        Names(Vec<String>),
    }
}

impl SensorChoice {
    /// Returns the chosen names; `None` for all sensors. A text that is the name of a sensor is one name.
    fn names(&self, known: &[RecordedSensorSpec]) -> Option<Vec<&str>> {
        match self {
            Self::Text(text) if text == ALL => None,
            Self::Text(text) if known.iter().any(|sensor| sensor.name == *text) => Some(vec![text]),
            Self::Text(text) => Some(text.split(AND).map(str::trim).collect()),
            Self::Names(names) => Some(names.iter().map(String::as_str).collect()),
        }
    }

    /// Returns the value as in a study file.
    fn words(&self) -> String {
        match self {
            Self::Text(text) => format!("{text:?}"),
            Self::Names(names) => format!("{names:?}"),
        }
    }
}

impl RecordedSpec {
    /// Returns the name and the specification of each sensor that the study uses. A recording without `sensors` is one sensor with the name `skin`. The
    /// specification of a sensor contains its own files, and the labels and groups of the recording.
    pub fn used_sensors(&self) -> Vec<(String, Self)> {
        if self.sensors.is_empty() {
            return vec![("skin".to_owned(), self.clone())];
        }
        let chosen = self.chosen_sensors();
        let is_used = |sensor: &RecordedSensorSpec| match &chosen {
            None => true,
            Some(names) => names.contains(&&sensor.name[..]),
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
                columns: sensor.columns,
                layout: sensor.layout,
                lengths: sensor.lengths,
                lengths_test: sensor.lengths_test,
                zero: sensor.zero,
                full_scale: sensor.full_scale,
                sensors: Vec::new(),
                sensor: None,
                place: SensorPlace {
                    table: sensor_table(number),
                    pitch_mm: sensor.pitch_mm,
                    name: Some(sensor.name.clone()),
                    ..self.place.clone()
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
                Some(choice) => {
                    let allowed = "no such key without [[recorded.sensors]]";
                    refuse("sensor", choice.words(), allowed)
                }
                None => Ok(()),
            };
        }
        let of_each = [
            ("frames", !self.frames.as_os_str().is_empty()),
            ("frames_test", self.frames_test.is_some()),
            ("order", self.order.is_some()),
            ("grid", self.grid.is_some()),
            ("columns", self.columns.is_some()),
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
                && (!full_scale.is_finite() || full_scale == *zero)
            {
                let allowed = format!("a number other than the zero, {zero}");
                return refuse(&key("full_scale"), full_scale.to_string(), &allowed);
            }
        }
        let chosen = self.chosen_sensors().unwrap_or_default();
        let is_wrong = |(number, name): (usize, &&str)| {
            !names.contains(name) || chosen[..number].contains(name)
        };
        match &self.sensor {
            Some(choice) if chosen.iter().enumerate().any(is_wrong) => {
                let several = match &names[..] {
                    [one, other, ..] => {
                        format!(", or several names, each once: \"{one}{AND}{other}\"")
                    }
                    _ => String::new(),
                };
                let allowed = format!("{ALL}, {}{several}", names.join(", "));
                refuse("sensor", choice.words(), &allowed)
            }
            _ => Ok(()),
        }
    }

    /// Returns the names of the sensors that `recorded.sensor` chooses; `None` for all sensors.
    fn chosen_sensors(&self) -> Option<Vec<&str>> {
        self.sensor.as_ref()?.names(&self.sensors)
    }
}
