//! Force control of pressed objects, with checked values.

use super::numbers::Numbers;
use super::plan_patch::PlannedPatch;
use super::reader::{MM, Reader};
use super::spec::PressSpec;
use crate::error::Result;
use crate::inputs::range::{not_negative, positive};
use glam::DVec3;

/// Control of the force with which an object is pressed onto a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedPress {
    /// Index of the patch whose force is controlled.
    pub patch: usize,
    /// Direction of the travel, a unit vector in the world frame.
    pub direction: DVec3,
    /// Times at which target forces are given, seconds, strictly increasing; at least one.
    pub times: Vec<f64>,
    /// Target of the patch's total spring force at each time, N, at least 0. Between the times, the target is interpolated linearly; outside, it is constant.
    pub forces: Vec<f64>,
    /// Maximum speed of the object along the direction of travel, m/s, positive.
    pub speed: f64,
    /// Maximum distance of the object from the pose of its imposed motion, metres, positive.
    pub travel: f64,
}

impl PlannedPress {
    /// Returns the target force at a time (seconds), N.
    pub fn force_at(&self, time: f64) -> f64 {
        let after = self.times.partition_point(|&t| t <= time);
        match (after.checked_sub(1), self.forces.get(after)) {
            (Some(before), Some(next)) => {
                let share = (time - self.times[before]) / (self.times[after] - self.times[before]);
                self.forces[before] + share * (next - self.forces[before])
            }
            (Some(last), None) => self.forces[last],
            (None, _) => self.forces[0],
        }
    }

    /// Returns the time of the last given target force, seconds.
    pub fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

impl Reader<'_> {
    /// Checks the keys of a pressed object and returns the control of its force.
    pub fn press(
        &self,
        key: &str,
        spec: &PressSpec,
        patches: &[PlannedPatch],
    ) -> Result<PlannedPress> {
        let key = &format!("{key}.press");
        let names = patches.iter().map(|patch| patch.skin.name());
        let patch = self.known(&format!("{key}.patch"), &spec.patch, names)?;
        let direction_key = format!("{key}.direction");
        let direction = self.vector(&direction_key, spec.direction, 1.0)?;
        if direction == DVec3::ZERO {
            let allowed = "a vector that is not zero";
            return Err(self.check.error(&direction_key, direction, allowed));
        }
        let (times, forces) = self.forces(key, spec)?;
        let above_zero = |name: &str, value: f64| {
            let key = format!("{key}.{name}");
            self.check.value(&key, value, positive, "a positive number")
        };
        Ok(PlannedPress {
            patch,
            direction: direction.normalize(),
            times,
            forces,
            speed: above_zero("speed_mm_per_s", spec.speed_mm_per_s)? * MM,
            travel: above_zero("travel_mm", spec.travel_mm)? * MM,
        })
    }

    fn forces(&self, key: &str, spec: &PressSpec) -> Result<(Vec<f64>, Vec<f64>)> {
        let (time_key, force_key) = (format!("{key}.time_s"), format!("{key}.force_n"));
        let forces = match &spec.force_n {
            Numbers::One(force) if spec.time_s.is_empty() => vec![*force],
            Numbers::One(_) => {
                let given = "one force beside time_s";
                let allowed = "a list, one a time; or no time_s";
                return Err(self.check.error(&force_key, given, allowed));
            }
            Numbers::Each(forces) => forces.clone(),
        };
        let times = match spec.force_n {
            Numbers::One(_) => vec![0.0],
            Numbers::Each(_) => spec.time_s.clone(),
        };
        if forces.is_empty() || forces.len() != times.len() {
            let given = format!("{} forces", forces.len());
            let allowed = format!("{}, one a time of time_s, and at least one", times.len());
            return Err(self.check.error(&force_key, given, allowed));
        }
        for &force in &forces {
            let allowed = "zero or a positive number of newtons";
            self.check.value(&force_key, force, not_negative, allowed)?;
        }
        for &time in &times {
            self.check
                .value(&time_key, time, f64::is_finite, "finite numbers")?;
        }
        if let Some(pair) = times.windows(2).find(|pair| pair[0] >= pair[1]) {
            let given = format!("{} s after {} s", pair[1], pair[0]);
            return Err(self
                .check
                .error(&time_key, given, "strictly ascending times"));
        }
        Ok((times, forces))
    }
}
