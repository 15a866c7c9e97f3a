//! Checks of `[signal]`, and the signal conditions that result from its axes.

use crate::engine::axes::CombineSpec;
use crate::inputs::sensor_errors::{NOISES, Strengths};
use crate::signal::{SensorError, Strength};
use crate::studies::prelude::*;
use crate::studies::recognition::spec::{SignalAxis, SignalSpec};

/// Signal condition: one strength of noise, smoothing and each sensor error, that is, one value for each axis of `[signal]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Condition {
    /// Noise standard deviation of a reading, in the noise unit of the plan.
    pub noise: f64,
    /// Standard deviation of the Gaussian filter that smooths the readings over the array, metres.
    pub smoothing: f64,
    /// Strengths of the sensor errors, such as gain errors and drift.
    pub strengths: Strengths,
}

impl Check<'_> {
    /// Returns the unit and the values of the noise standard deviation, for the quantity that the taxels measure.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn noise(
        &self,
        signal: &SignalSpec,
        sensed: Option<SensedSpec>,
    ) -> Result<(NoiseUnit, Vec<f64>)> {
        self.table("signal", signal)?;
        let axis = |(key, unit)| Some((key, unit, signal.axes.get(key)?));
        let mut given = NOISES.into_iter().filter_map(axis);
        let Some((name, unit, axis)) = given.next() else {
            return Ok((NoiseUnit::FullScale, vec![0.0]));
        };
        let key = format!("signal.{name}");
        if let Some((second, ..)) = given.next() {
            let (second, given) = (format!("signal.{second}"), format!("given beside {key}"));
            return Err(self.error(&second, given, "one unit of noise a study"));
        }
        let place = |wanted| signal.steps.iter().position(|step| *step == wanted);
        let force = place(StepSpec::Force);
        let is_read = sensed.unwrap_or_default() != SensedSpec::Deflection;
        let of_force = is_read || force.is_some() && force < place(StepSpec::Noise);
        let (given, allowed) = match (unit, of_force) {
            (NoiseUnit::Mm, true) => (
                "millimetres of noise on a force",
                "noise_std_n or noise_std_full_scale, or noise before force in signal.steps",
            ),
            (NoiseUnit::N, false) => (
                "newtons of noise on a deflection",
                "noise_std_mm or noise_std_full_scale, or force before noise in signal.steps",
            ),
            _ => return Ok((unit, axis.values())),
        };
        Err(self.error(&key, given, allowed))
    }

    /// Checks the strengths of the sensor errors in `[signal]`. Errors that act only during motion require that the press moves while frames are read.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn sensor_errors(&self, signal: &SignalSpec, touches: &TouchesSpec) -> Result<()> {
        let largest = |strength: &Strength| {
            let axis = signal.axes.get(strength.key).into_iter();
            axis.flat_map(Axis::values).fold(0.0, f64::max)
        };
        for error in SensorError::all() {
            let about = error.about();
            if let [first, second] = about.strengths
                && largest(first) + largest(second) > 1.0
            {
                let (least, most) = (largest(first), largest(second));
                let given = format!("up to {most}, with up to {least} of {}", first.words);
                return Err(self.error(&key(second), given, "at most 1 together"));
            }
            if about.needs_motion && about.strengths.iter().any(|s| largest(s) > 0.0) {
                self.moves(&key(&about.strengths[0]), touches)?;
            }
        }
        Ok(())
    }

    /// Returns an error that names `key` if the array does not move while frames are read.
    fn moves(&self, key: &str, touches: &TouchesSpec) -> Result<()> {
        if touches.frames.values().iter().all(|&frames| frames < 2) {
            let given = "given, but every touch is read once, at rest";
            return Err(self.error(key, given, "touches.frames of 2 or more beside it"));
        }
        if touches.speed_mm_per_s == 0.0 {
            let given = "given, but the press waits while it is read";
            return Err(self.error(key, given, "a touches.speed_mm_per_s above 0 beside it"));
        }
        Ok(())
    }

    /// Checks the steps of the signal chain. Each step occurs at most once. A step whose axis is set is listed. A listed sensor error has at least one
    /// strength. Without the check, a key could be ignored silently.
    ///
    /// # Errors
    /// If the check fails; the error names the file, the key and the allowed values.
    pub fn steps(&self, signal: &SignalSpec) -> Result<()> {
        const KEY: &str = "signal.steps";
        if !signal.steps.is_empty() {
            self.list(KEY, signal.steps.iter().map(|step| step.word()).collect())?;
        }
        // A strength of 0 is the default.
        let is_set = |axis: &Axis<f64>| axis.values().iter().any(|&strength| strength != 0.0);
        let mut set = signal.axes.given().filter(|(.., axis)| is_set(axis));
        if let Some((key, step, _)) = set.find(|(_, step, _)| !signal.steps.contains(step)) {
            let word = step.word();
            let given = format!("no \"{word}\", but signal.{key} is given");
            let allowed = format!("\"{word}\" among the steps, or no such strength");
            return Err(self.error(KEY, given, allowed));
        }
        for step in &signal.steps {
            let mut given = signal.axes.given();
            if let StepSpec::Error(error) = step
                && !given.any(|(_, given, _)| given == step)
            {
                let keys: Vec<String> = error.about().strengths.iter().map(key).collect();
                let given = format!("\"{}\" without a strength", step.word());
                let allowed = format!("{} beside it", keys.join(" or "));
                return Err(self.error(KEY, given, allowed));
            }
        }
        Ok(())
    }
}

fn key(strength: &Strength) -> String {
    format!("signal.{}", strength.key)
}

impl SignalSpec {
    /// Returns the number of signal conditions: combinations of noise, smoothing and sensor errors.
    pub(crate) fn n_conditions(&self) -> f64 {
        let axes = self.axes.given();
        let lengths = axes.map(|(.., axis)| axis.values().len() as f64);
        match self.combine {
            CombineSpec::All => lengths.product(),
            CombineSpec::OneAtATime => 1.0 + lengths.map(|n| n - 1.0).sum::<f64>(),
        }
    }
}

impl Plan {
    /// Returns all signal conditions, that is, all combinations of the axis values of `[signal]`. With `combine = "one_at_a_time"`, each axis varies alone.
    pub fn conditions(&self) -> Vec<Condition> {
        let signal = &self.spec.signal;
        let first = |condition: Condition, (key, step, axis): &SignalAxis| {
            condition.with((key, *step), axis.values()[0])
        };
        let first = signal.axes.given().fold(Condition::default(), first);
        let mut conditions = vec![first.clone()];
        for (key, step, axis) in signal.axes.given() {
            let values = axis.values();
            let with = |condition: Condition, values: &[f64]| -> Vec<Condition> {
                let with = |value: &f64| condition.clone().with((key, *step), *value);
                values.iter().map(with).collect()
            };
            match signal.combine {
                CombineSpec::OneAtATime => conditions.extend(with(first.clone(), &values[1..])),
                // The last axis changes fastest.
                CombineSpec::All => {
                    let all = conditions.into_iter();
                    conditions = all.flat_map(|condition| with(condition, &values)).collect();
                }
            }
        }
        conditions
    }
}

impl Condition {
    /// Returns whether two readings of the same touch differ by random noise.
    pub fn is_random_by_reading(&self) -> bool {
        let mut present = self.strengths.present();
        self.noise > 0.0 || present.any(|(error, ..)| error.about().is_random_by_reading)
    }

    /// Returns a copy of the signal condition with a different value of one strength, which is given by its key and step.
    pub(crate) fn with(mut self, (key, step): (&str, StepSpec), value: f64) -> Self {
        match step {
            StepSpec::Noise => self.noise = value,
            StepSpec::Smoothing => self.smoothing = value * MM,
            _ => self.strengths = self.strengths.with(key, Some(value)),
        }
        self
    }
}
