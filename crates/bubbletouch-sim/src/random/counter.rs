//! Counter-based random numbers: functions of a name and of indices, for large sets of items of which only a few are needed.
//!
//! A random stream must be drawn from its start. Here the draws of group g at index t are functions of the counter (g, t) and a key, in any order and on
//! any thread. Philox4x32-10 \[PX\] converts the counter to four words w of 32 bits. Each word belongs to one of the items 4 g to 4 g + 3 of the group. The
//! words are converted to
//!
//! - uniform numbers, (w + ½) / 2³²;
//! - normal numbers in pairs by Box and Muller, √(−2 ln u₀) (cos, sin)(2π u₁). Their magnitude is at most 6.77, which a normal number exceeds
//!   once in 10¹¹ draws.
//!
//! Logarithm, sine and cosine consist of additions and products only. The bits are therefore equal on any machine, and many groups can be
//! computed at a time.

use super::Seed;
use std::f64::consts::{FRAC_PI_2, LN_2, SQRT_2};

/// Number of items (such as taxels) that share a counter.
pub const GROUP: usize = 4;

/// Constants of the generator Philox4x32 \[PX\]: two multipliers, the increments of the two halves of the key per round, and the number of rounds.
const MULTIPLIERS: [u64; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const N_ROUNDS: usize = 10;

/// Mask of the lower half of a 64-bit word.
const LOW: u64 = 0xFFFF_FFFF;
/// Bits of the float 2⁵². If an integer n below 2⁵² is stored in the mantissa, the bits represent 2⁵² + n.
const TWO_52: u64 = 0x4330_0000_0000_0000;
/// Bits of the float 1.0, and the mask of the mantissa.
const ONE: u64 = 0x3FF0_0000_0000_0000;
const MANTISSA: u64 = 0x000F_FFFF_FFFF_FFFF;

/// Divisors in the power series of artanh s / s, sin a / a and cos a, in powers of s² and −a², the highest power first. The remainders are below 1e-11.
const ARTANH: [f64; 7] = [13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0];
const SIN: [f64; 6] = [39_916_800.0, 362_880.0, 5_040.0, 120.0, 6.0, 1.0];
const COS: [f64; 7] = [479_001_600.0, 3_628_800.0, 40_320.0, 720.0, 24.0, 2.0, 1.0];

/// Key of counter-based random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CounterKey([u32; 2]);

impl Seed {
    /// Returns the key of the counter-based random numbers that belong to this seed.
    pub fn counter_key(&self) -> CounterKey {
        let half = |at: usize| u32::from_le_bytes([at, at + 1, at + 2, at + 3].map(|k| self.0[k]));
        CounterKey([half(0), half(4)])
    }
}

impl CounterKey {
    /// Returns four uniform numbers in (0, 1), one per item, for each of N groups of items. `index` selects the draw; shape (GROUP, N).
    #[inline(always)]
    pub fn uniforms<const N: usize>(self, groups: &[u64; N], index: u64) -> [[f64; N]; GROUP] {
        let words = self.words(groups, index);
        let mut uniforms = [[0.0; N]; GROUP];
        for item in 0..GROUP {
            for k in 0..N {
                uniforms[item][k] = (whole(words[item][k]) + 0.5) * (1.0 / 4_294_967_296.0);
            }
        }
        uniforms
    }

    /// Returns four normal numbers of mean 0 and variance 1, one per item, for each of N groups of items. `index` selects the draw; shape (GROUP, N).
    #[inline(always)]
    pub fn normals<const N: usize>(self, groups: &[u64; N], index: u64) -> [[f64; N]; GROUP] {
        let [first, second, third, fourth] = self.words(groups, index);
        let ([a, b], [c, d]) = (box_muller(&first, &second), box_muller(&third, &fourth));
        [a, b, c, d]
    }

    /// Returns the 32-bit words of Philox4x32-10 for the counters (group, lower half of the index, upper half of the index, 0).
    #[inline(always)]
    fn words<const N: usize>(self, groups: &[u64; N], index: u64) -> [[u64; N]; 4] {
        self.mixed([*groups, [index & LOW; N], [index >> 32; N], [0; N]])
    }

    #[inline(always)]
    fn mixed<const N: usize>(self, counter: [[u64; N]; 4]) -> [[u64; N]; 4] {
        let ([mut a, mut b, mut c, mut d], [mut key_a, mut key_b]) = (counter, self.0);
        for _ in 0..N_ROUNDS {
            for k in 0..N {
                let (p, q) = ((a[k] & LOW) * MULTIPLIERS[0], (c[k] & LOW) * MULTIPLIERS[1]);
                a[k] = (q >> 32) ^ b[k] ^ u64::from(key_a);
                b[k] = q & LOW;
                c[k] = (p >> 32) ^ d[k] ^ u64::from(key_b);
                d[k] = p & LOW;
            }
            key_a = key_a.wrapping_add(WEYL[0]);
            key_b = key_b.wrapping_add(WEYL[1]);
        }
        [a, b, c, d]
    }
}

/// Converts an integer below 2⁵² to a float.
#[inline(always)]
fn whole(bits: u64) -> f64 {
    f64::from_bits(TWO_52 | bits) - f64::from_bits(TWO_52)
}

/// Returns two normal numbers for each pair of uniform random words, by the Box–Muller transform.
#[inline(always)]
fn box_muller<const N: usize>(first: &[u64; N], second: &[u64; N]) -> [[f64; N]; 2] {
    let [mut x, mut y] = [[0.0; N]; 2];
    for k in 0..N {
        let uniform = (whole(first[k]) + 0.5) * (1.0 / 4_294_967_296.0);
        let radius = (-2.0 * logarithm(uniform)).sqrt();
        // The upper two bits select a quarter turn; the rest gives an angle within ±π/4.
        let rest = whole(second[k] & 0x3FFF_FFFF) - 536_870_911.5;
        let (sin, cos) = sin_cos(rest * (FRAC_PI_2 / 1_073_741_824.0));
        let quarter = second[k] >> 30;
        let is_odd = quarter & 1 == 1;
        let (along, across) = if is_odd { (sin, cos) } else { (cos, sin) };
        let signs = [((quarter + 1) & 2) << 62, (quarter & 2) << 62];
        x[k] = radius * f64::from_bits(along.to_bits() ^ signs[0]);
        y[k] = radius * f64::from_bits(across.to_bits() ^ signs[1]);
    }
    [x, y]
}

/// Returns the natural logarithm of a normal float u above zero. With u = 2ᵉ m and m within a factor √2 of 1, the logarithm is e ln 2 + 2 artanh((m − 1) / (m
/// + 1)).
#[inline(always)]
fn logarithm(u: f64) -> f64 {
    let bits = u.to_bits();
    let mantissa = f64::from_bits(bits & MANTISSA | ONE);
    let exponent = whole(bits >> 52) - 1023.0;
    let is_large = mantissa > SQRT_2;
    let m = if is_large { 0.5 * mantissa } else { mantissa };
    let e = if is_large { exponent + 1.0 } else { exponent };
    let s = (m - 1.0) / (m + 1.0);
    e * LN_2 + 2.0 * s * series(&ARTANH, s * s)
}

/// Returns the sine and cosine of an angle within ±π/4.
#[inline(always)]
fn sin_cos(angle: f64) -> (f64, f64) {
    let q = -angle * angle;
    (angle * series(&SIN, q), series(&COS, q))
}

/// Returns the power series Σ qⁿ / dₙ with the divisors d; the divisor of the highest power comes first.
#[inline(always)]
fn series<const N: usize>(divisors: &[f64; N], q: f64) -> f64 {
    let mut sum = 1.0 / divisors[0];
    for divisor in &divisors[1..] {
        sum = sum * q + 1.0 / divisor;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_published_generator() {
        // Known answers of Philox4x32-10 from the authors' library: counter, key, words.
        let known: [([u64; 4], [u32; 2], [u64; 4]); 3] = [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [0xffff_ffff; 4],
                [0xffff_ffff; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, words) in known {
            let counter = counter.map(|word| [word; 3]);
            assert_eq!(CounterKey(key).mixed(counter), words.map(|word| [word; 3]));
        }
    }

    #[test]
    fn normals_are_box_and_mullers_of_the_words() {
        let key = Seed::new(3).counter_key();
        for group in 0..20_000 {
            let index = group * 0x1_0000_0003;
            let words = key.words(&[group], index).map(|[word]| word as f64);
            let normals = key.normals(&[group], index).map(|[normal]| normal);
            for pair in [0, 2] {
                let [u, w] = [0, 1].map(|k| (words[pair + k] + 0.5) / 2f64.powi(32));
                let radius = (-2.0 * u.ln()).sqrt();
                // The angles of `box_muller` start an eighth of a turn later.
                let (sin, cos) = (std::f64::consts::TAU * (w - 0.125)).sin_cos();
                assert!((normals[pair] - radius * cos).abs() < 1e-10);
                assert!((normals[pair + 1] - radius * sin).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn a_group_has_the_same_draws_whoever_is_drawn_beside_it() {
        let key = Seed::new(4).named("noise").counter_key();
        let groups = [9, 0, 77, 1 << 31, 5, 6, 7, (1 << 32) - 1];
        let (normals, uniforms) = (key.normals(&groups, 12), key.uniforms(&groups, 12));
        for (lane, &group) in groups.iter().enumerate() {
            let alone = (key.normals(&[group], 12), key.uniforms(&[group], 12));
            assert_eq!(normals.map(|of| [of[lane]]), alone.0);
            assert_eq!(uniforms.map(|of| [of[lane]]), alone.1);
        }
    }
}
