//! The checks of `[signal]`, and the conditions that its axes make.

use super::check::{Check, not_negative};
use super::plan::{MM, Plan, millimetres};
use super::sensor_errors::{Strengths, TestedOn, all_strengths};
use super::spec::{CombineSpec, SignalSpec, StepSpec, TouchesSpec};
use crate::error::Result;
use crate::signal::{NoiseUnit, SENSOR_ERRORS, Strength};

/// One value for each axis of the signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Noise standard deviation, in the plan's unit.
    pub noise: f64,
    /// Standard deviation of the smoothing, metres.
    pub smoothing: f64,
    /// What the skin and its reader do.
    pub strengths: Strengths,
}

impl Check<'_> {
    /// The noise axis and its unit.
    pub fn noise(&self, signal: &SignalSpec) -> Result<(NoiseUnit, Vec<f64>)> {
        let given: Vec<_> = [
            (
                "signal.noise_std_full_scale",
                &signal.noise_std_full_scale,
                NoiseUnit::FullScale,
            ),
            ("signal.noise_std_mm", &signal.noise_std_mm, NoiseUnit::Mm),
            ("signal.noise_std_n", &signal.noise_std_n, NoiseUnit::N),
        ]
        .into_iter()
        .filter_map(|(key, axis, unit)| axis.as_ref().map(|axis| (key, axis, unit)))
        .collect();
        let (key, axis, unit) = match given[..] {
            [] => return Ok((NoiseUnit::FullScale, vec![0.0])),
            [one] => one,
            [(first, ..), (second, ..), ..] => {
                return Err(self.error(
                    second,
                    format!("given beside {first}"),
                    "one unit of noise a study",
                ));
            }
        };
        let force = signal.steps.iter().position(|s| *s == StepSpec::Force);
        let noise = signal.steps.iter().position(|s| *s == StepSpec::Noise);
        let of_force = force.is_some() && force < noise;
        match unit {
            NoiseUnit::Mm if of_force => {
                return Err(self.error(
                    key,
                    "millimetres of noise on a force",
                    "noise_std_n or noise_std_full_scale, or noise before force in signal.steps",
                ));
            }
            NoiseUnit::N if !of_force => {
                return Err(self.error(
                    key,
                    "newtons of noise on a deflection",
                    "noise_std_mm or noise_std_full_scale, or force before noise in signal.steps",
                ));
            }
            _ => {}
        }
        let values = self.axis(key, axis, not_negative, "zero or a positive number")?;
        Ok((unit, values))
    }

    /// The smoothing axis, metres.
    pub fn smoothing(&self, signal: &SignalSpec) -> Result<Vec<f64>> {
        let Some(axis) = &signal.smoothing_mm else {
            return Ok(vec![0.0]);
        };
        let allowed = "zero or a positive number of millimetres";
        let widths = self.axis("signal.smoothing_mm", axis, not_negative, allowed)?;
        // Two that tables show alike would be taken for one.
        let shown = widths.iter().map(|&mm| millimetres(mm * MM)).collect();
        self.list("signal.smoothing_mm", shown)?;
        Ok(widths.iter().map(|width| width * MM).collect())
    }

    /// The axes of the sensor errors that a study has, in the units of their keys.
    pub fn sensor_errors(
        &self,
        signal: &SignalSpec,
        touches: &TouchesSpec,
    ) -> Result<Vec<(&'static Strength, Vec<f64>)>> {
        let mut axes = Vec::new();
        for (strength, axis) in signal.errors.given() {
            let values = self.axis(&key(strength), axis, strength.is_allowed, strength.allowed)?;
            axes.push((*strength, values));
        }
        let largest = |strength: &Strength| {
            let axis = axes.iter().find(|(known, _)| *known == strength);
            let values = axis.map_or(&[][..], |(_, values)| values);
            values.iter().copied().fold(0.0, f64::max)
        };
        for error in SENSOR_ERRORS {
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
        Ok(axes)
    }

    /// The press moves while frames are read.
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

    /// The axis of test skins; another one shows only if something belongs to a skin.
    pub fn tested_on(&self, signal: &SignalSpec) -> Result<Vec<TestedOn>> {
        let Some(axis) = &signal.tested_on else {
            return Ok(vec![TestedOn::SameSkin]);
        };
        let is_of_skin =
            |step: &StepSpec| matches!(step, StepSpec::Error(error) if error.about().is_of_skin);
        if !signal.steps.iter().any(is_of_skin) {
            let all = SENSOR_ERRORS.iter().map(|error| error.about());
            let of_skin: Vec<&str> = all.filter(|e| e.is_of_skin).map(|e| e.step).collect();
            let allowed = format!("{} among signal.steps beside it", of_skin.join(" or "));
            return Err(self.error(
                "signal.tested_on",
                "given for skins without a difference",
                allowed,
            ));
        }
        self.list("signal.tested_on", axis.values())
    }

    /// Each step at most once, and none whose axis is set but which is not listed, nor the other way round if it does
    /// nothing without: it would be silently ignored.
    pub fn steps(&self, signal: &SignalSpec) -> Result<()> {
        for (index, step) in signal.steps.iter().enumerate() {
            if signal.steps[..index].contains(step) {
                return Err(self.error(
                    "signal.steps",
                    format!("{} twice", step.word()),
                    "each step at most once",
                ));
            }
        }
        let has_noise = signal.noise_std_full_scale.is_some()
            || signal.noise_std_mm.is_some()
            || signal.noise_std_n.is_some();
        let mut set = vec![
            (has_noise, StepSpec::Noise),
            (signal.smoothing_mm.is_some(), StepSpec::Smoothing),
        ];
        set.extend(all_strengths().map(|(error, strength)| {
            let is_set = signal.errors.of(strength.key).is_some();
            (is_set, StepSpec::Error(error))
        }));
        for &(is_set, step) in &set {
            let word = step.word();
            if is_set && !signal.steps.contains(&step) {
                return Err(self.error(
                    "signal.steps",
                    format!("no \"{word}\""),
                    format!("\"{word}\" among the steps, since its axis is set"),
                ));
            }
        }
        for step in &signal.steps {
            if let StepSpec::Error(error) = step
                && !set.contains(&(true, *step))
            {
                let keys: Vec<String> = error.about().strengths.iter().map(key).collect();
                let given = format!("\"{}\" without a strength", step.word());
                let allowed = format!("{} beside it", keys.join(" or "));
                return Err(self.error("signal.steps", given, allowed));
            }
        }
        Ok(())
    }
}

fn key(strength: &Strength) -> String {
    format!("signal.{}", strength.key)
}

impl Plan {
    /// How many conditions of the signal there are.
    pub(super) fn n_conditions(&self) -> f64 {
        let errors = self.sensor_errors.iter().map(|(_, values)| values.len());
        let axes = [self.noise.len(), self.smoothing.len()].into_iter();
        let lengths = axes.chain(errors).map(|n| n as f64);
        match self.combine {
            CombineSpec::All => lengths.product(),
            CombineSpec::OneAtATime => 1.0 + lengths.map(|n| n - 1.0).sum::<f64>(),
        }
    }

    /// Every condition of the signal that the study asks for: all combinations of its axes, or each axis alone.
    pub fn conditions(&self) -> Vec<Condition> {
        let first = Condition {
            noise: self.noise[0],
            smoothing: self.smoothing[0],
            strengths: self
                .sensor_errors
                .iter()
                .fold(Strengths::default(), |strengths, (strength, values)| {
                    strengths.with(strength.key, Some(values[0]))
                }),
        };
        let mut conditions = vec![first];
        for axis in 0..2 + self.sensor_errors.len() {
            let n_values = match axis {
                0 => self.noise.len(),
                1 => self.smoothing.len(),
                _ => self.sensor_errors[axis - 2].1.len(),
            };
            match self.combine {
                CombineSpec::OneAtATime => {
                    conditions.extend((1..n_values).map(|value| self.at(first, axis, value)));
                }
                // The first axis changes slowest.
                CombineSpec::All => {
                    let all = conditions.iter();
                    let longer = all.flat_map(|&condition| {
                        (0..n_values).map(move |value| self.at(condition, axis, value))
                    });
                    conditions = longer.collect();
                }
            }
        }
        conditions
    }

    /// A condition with another value on one axis: noise, smoothing, sensor error after sensor error.
    fn at(&self, mut condition: Condition, axis: usize, value: usize) -> Condition {
        match axis {
            0 => condition.noise = self.noise[value],
            1 => condition.smoothing = self.smoothing[value],
            _ => {
                let (strength, values) = &self.sensor_errors[axis - 2];
                condition.strengths = condition.strengths.with(strength.key, Some(values[value]));
            }
        }
        condition
    }
}
