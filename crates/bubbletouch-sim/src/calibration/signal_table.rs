//! Table `[signal]` of a calibration, in the format of a study.

use super::smoothing::narrow;
use super::{Calibration, Estimate, Measured};
use crate::text::numbers::short_literal;

/// Limit below which values are written as zero: half of the last written digit.
const NONE: f64 = 5e-5;

impl Calibration {
    /// Returns TOML for a skin with this pitch (millimetres): each key with its interval. Parameters that are not identifiable, or whose interval is wide,
    /// are comments with the reason.
    pub fn signal_table(&self, pitch_mm: f64) -> String {
        let smoothing = self.smoothing.clone().and_then(narrow);
        let smoothing = smoothing.map(|width| width.map(|pitches| pitches * pitch_mm));
        let [dead, stuck, converter] = [&self.dead, &self.stuck, &self.converter]
            .map(|estimate| estimate.clone().and_then(Measured::resolved));
        let parameters: [(&str, &str, &Estimate); 8] = [
            ("crosstalk", "crosstalk", &self.crosstalk),
            ("gain", "gain_std", &self.gain),
            ("drift", "drift_std_full_scale", &self.drift),
            ("noise", "noise_std_full_scale", &self.noise),
            ("smoothing", "smoothing_mm", &smoothing),
            ("faults", "dead_fraction", &dead),
            ("faults", "stuck_fraction", &stuck),
            ("quantisation", "adc_bits", &converter),
        ];
        let mut steps = Vec::new();
        let mut keys = String::new();
        for (step, key, estimate) in parameters {
            keys += &line(key, estimate);
            if estimate.is_ok() {
                steps.push(format!("\"{step}\""));
            }
        }
        steps.dedup();
        format!("[signal]\nsteps = [{}]\n{keys}", steps.join(", "))
    }

    /// Returns the line with the stiffness for the `[skin]` table of a study.
    pub fn stiffness_line(&self) -> String {
        line("stiffness_n_per_m", &self.stiffness)
    }
}

fn line(key: &str, estimate: &Estimate) -> String {
    match estimate {
        Ok(Measured {
            value,
            interval: [low, high],
        }) => {
            let shown = |number: f64| match number.abs() < NONE {
                true => "0".to_owned(),
                false => short_literal(number),
            };
            let [value, low, high] = [*value, *low, *high].map(shown);
            format!("{key} = {value}  # 95 % interval {low} to {high}\n")
        }
        Err(why) => format!("# {key}: {why}\n"),
    }
}
