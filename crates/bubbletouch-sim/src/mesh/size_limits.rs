//! Plausible sizes of objects, to detect files in another unit.

use super::LengthUnit;
use crate::error::{Error, Result};
use glam::DVec3;

/// Plausible range for the longest side of an object's bounding box, used if the unit of its file is not given; metres.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SizeLimits {
    /// Lower limit of the longest side, metres.
    pub smallest: f64,
    /// Upper limit of the longest side, metres.
    pub largest: f64,
    /// Command-line option for the unit of the file, which errors name.
    pub option: &'static str,
}

/// Usual option for the unit of a mesh file.
const UNIT_OPTION: &str = "--unit";

/// Maximum length of an object, in multiples of the side of the sensor array. A touch on a longer object covers less than a hundredth of a face.
const MAX_SIDES: f64 = 10.0;
/// Length of an object that is always allowed, because small arrays also touch furniture or a person's arm; metres.
const ALWAYS_ALLOWED: f64 = 1.0;

impl SizeLimits {
    /// Size limits for an unknown array. The lower limit, 0.1 mm, is below the pitch of every tactile sensor. The upper limit, 10 m, is ten sides of an array
    /// of one square metre.
    pub const ANY: Self = Self {
        smallest: 1e-4,
        largest: 10.0,
        option: UNIT_OPTION,
    };

    /// No limits, for meshes whose size is known only after they are scaled.
    pub const UNLIMITED: Self = Self {
        smallest: 0.0,
        largest: f64::INFINITY,
        option: UNIT_OPTION,
    };

    /// Returns the size limits for arrays given by (longest side, taxel radius), metres. An object smaller than the smallest taxel radius has no detectable
    /// shape. An object longer than ten sides of the largest array, and than one metre, is a plane.
    pub fn of_arrays(arrays: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let none = Self {
            smallest: f64::INFINITY,
            largest: ALWAYS_ALLOWED,
            option: UNIT_OPTION,
        };
        arrays
            .into_iter()
            .fold(none, |limits, (side, radius)| Self {
                smallest: limits.smallest.min(radius),
                largest: limits.largest.max(MAX_SIDES * side),
                ..limits
            })
    }

    /// Returns an error if the size of an object (metres) is not plausible. Its file was read in metres because no unit was given.
    ///
    /// # Errors
    /// If the size is outside the limits; the error begins with `place` and suggests the likely unit.
    pub fn check(&self, place: &str, size: DVec3) -> Result<()> {
        let length = size.max_element();
        if (self.smallest..=self.largest).contains(&length) {
            return Ok(());
        }
        let likely = [
            LengthUnit::Millimetre,
            LengthUnit::Centimetre,
            LengthUnit::Inch,
        ];
        let is_likely = |unit: &&LengthUnit| (5e-3..=1.0).contains(&(length * unit.metres()));
        let option = self.option;
        let advice = match likely.iter().find(is_likely) {
            Some(unit) => {
                let (name, size) = (unit.name(), in_words(length * unit.metres()));
                format!("in {name} it would be {size}: give unit = \"{name}\" ({option} {name})")
            }
            None => format!("give unit = \"m\" ({option} m) if it is as large as that"),
        };
        let [smallest, largest] = [self.smallest, self.largest].map(in_words);
        let given = format!("{} wide, if its unit is the metre", in_words(length));
        let allowed = format!("{smallest} to {largest} where no unit is given; {advice}");
        Err(Error::input(place, given, allowed))
    }
}

/// Formats a length with three digits, such as `17 m` or `17 mm`.
fn in_words(metres: f64) -> String {
    if metres >= 1e6 {
        return format!("{metres:.2e} m");
    }
    let is_long = metres >= 1.0;
    let (value, unit) = if is_long {
        (metres, "m")
    } else {
        (metres * 1e3, "mm")
    };
    let digits = (2 - value.abs().max(1e-9).log10().floor() as i32).clamp(0, 9);
    let rounded = format!("{value:.*}", digits as usize);
    let shown = match rounded.contains('.') {
        true => rounded.trim_end_matches('0').trim_end_matches('.'),
        false => &rounded,
    };
    format!("{shown} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(limits: SizeLimits, length: f64) -> String {
        let error = limits.check("die.obj", DVec3::new(0.1 * length, length, 0.0));
        error.unwrap_err().to_string()
    }

    #[test]
    fn the_likely_unit_is_named() {
        assert_eq!(
            said(SizeLimits::ANY, 17.0),
            "die.obj: 17 m wide, if its unit is the metre; 0.1 mm to 10 m where no unit is given; in mm it would be 17 mm: give \
             unit = \"mm\" (--unit mm)"
        );
        let array = SizeLimits::of_arrays([(0.064, 0.5e-3), (0.128, 1e-3)]);
        assert_eq!((array.smallest, array.largest), (0.5e-3, 1.28));
        assert!(said(array, 1.7).contains("in cm it would be 17 mm"));
        assert!(said(array, 0.02e-3).contains("0.02 mm wide"));
        assert!(said(array, 5e4).contains("give unit = \"m\""));
        assert!(said(array, 1e200).starts_with("die.obj: 1.00e200 m wide"));
    }

    #[test]
    fn what_an_array_can_feel_is_allowed() {
        let small = SizeLimits::of_arrays([(0.016, 1e-3)]);
        for length in [1e-3, 17e-3, 0.3, 1.0] {
            small.check("cup", DVec3::splat(length)).unwrap();
        }
        assert!(small.check("cup", DVec3::splat(1.01)).is_err());
    }
}
