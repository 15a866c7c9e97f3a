//! Quantisation: an analogue-to-digital converter with b bits over the full scale.
//!
//! The operation is x ← q round(min(max(x, 0), X) / q) with q = X / (2ᵇ − 1). There are 2ᵇ codes from 0 to the full scale X, both included, or from −X to X if
//! values have a sign. Values outside the range are clipped to its nearest end.

use super::sensor_error::{Effect, ErrorAbout, Strength};
use super::taxel_effect::TaxelEffect;

/// Maximum number of bits of an analogue-to-digital converter. A finer step would be smaller than any effect of a touch.
const MAX_BITS: u32 = 24;

/// Model of an analogue-to-digital converter, for frames whose values lie in one range.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Quantisation {
    least: f64,
    span: f64,
    /// Largest code of the converter, 2ᵇ − 1 for b bits.
    last: f64,
}

impl Quantisation {
    /// Prepares a converter of 1 to 24 bits. `least` and `largest` are the limits of the input range, in the unit of the frames.
    fn new(bits: u32, [least, largest]: [f64; 2]) -> Self {
        Self {
            least,
            span: largest - least,
            last: f64::from((1u32 << bits) - 1),
        }
    }

    /// Clips each value to the range of the converter and rounds it to the nearest code.
    fn convert(&self, frame: &mut [f64]) {
        for value in frame {
            let share = (*value - self.least) / self.span;
            let code = (share.clamp(0.0, 1.0) * self.last).round();
            *value = self.least + code / self.last * self.span;
        }
    }
}

pub(super) const ABOUT: ErrorAbout = ErrorAbout {
    by_taxel: Some(|&[bits, _], full_scale, _| {
        let converter = Quantisation::new(bits as u32, [0.0, full_scale]);
        TaxelEffect::new(move |_, _, values| converter.convert(values))
    }),
    ..ErrorAbout::new(
        "quantisation",
        &[Strength {
            key: "adc_bits",
            words: "converter",
            unit: "bits",
            is_whole: true,
            range: [0.0, MAX_BITS as f64],
            allowed: "a whole number of bits, 1 to 24, or 0 for no converter",
            names: &[("0", "none")],
        }],
        |&[bits, _], skin| {
            let range = [skin.least, skin.full_scale];
            Ok(Box::new(Quantisation::new(bits as u32, range)))
        },
    )
};

impl Effect for Quantisation {
    fn apply_to_frame(&self, frame: &mut [f64], _: &mut [f64]) {
        self.convert(frame);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn converted(bits: u32, frame: &[f64]) -> Vec<f64> {
        let mut out = frame.to_vec();
        let converter = Quantisation::new(bits, [0.0, 5e-3]);
        converter.convert(&mut out);
        out
    }

    #[test]
    fn values_are_at_most_half_a_step_off_and_clipped_to_the_range() {
        let frame: Vec<f64> = (-200..=1200).map(|i| f64::from(i) * 5e-6).collect();
        for bits in [1, 2, 4, 8, 12, 24] {
            let half = 0.5 * 5e-3 / (f64::from(bits).exp2() - 1.0);
            for (out, value) in converted(bits, &frame).iter().zip(&frame) {
                let inside = value.clamp(0.0, 5e-3);
                assert!((out - inside).abs() <= half * (1.0 + 1e-9), "{bits} bits");
                assert!((0.0..=5e-3).contains(out));
            }
        }
    }

    #[test]
    fn a_converter_of_so_many_bits_has_all_its_codes_and_no_more() {
        let frame: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 5e-6).collect();
        for bits in [1, 2, 3, 6] {
            let mut codes = converted(bits, &frame);
            // A second conversion changes nothing, and codes increase with the value.
            assert_eq!(converted(bits, &codes), codes);
            assert!(codes.windows(2).all(|w| w[1] >= w[0]));
            codes.dedup();
            assert_eq!(codes.len(), 1 << bits);
            assert_eq!((codes[0], codes[codes.len() - 1]), (0.0, 5e-3));
        }
    }

    #[test]
    fn values_with_a_sign_have_as_many_codes_over_twice_the_range() {
        let mut frame: Vec<f64> = (-120..=120).map(|i| f64::from(i) * 1e-2).collect();
        let felt = frame.clone();
        Quantisation::new(4, [-1.0, 1.0]).convert(&mut frame);
        for (out, value) in frame.iter().zip(&felt) {
            assert!((out - value.clamp(-1.0, 1.0)).abs() <= 1.0 / 15.0 + 1e-12);
        }
        frame.dedup();
        assert_eq!((frame[0], frame[15], frame.len()), (-1.0, 1.0, 16));
    }
}
