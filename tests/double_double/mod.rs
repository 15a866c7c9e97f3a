//! Numbers of twice the digits of f64 (Dekker 1971; Hida, Li and Bailey 2001): sums and products without their rounding.

use std::ops::{Add, Mul, Neg, Sub};

/// `high + low`, |low| at most half of the last bit of `high`: about 31 decimal digits.
#[derive(Clone, Copy, Debug)]
pub struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// The root of a number that is not negative: one step of Newton's doubles the digits of f64's.
    pub fn sqrt(self) -> Self {
        let near = self.high.sqrt();
        if near == 0.0 {
            return Self::from(0.0);
        }
        let left = self - Self::from(near) * Self::from(near);
        sum(near, left.high / (2.0 * near))
    }

    /// The nearest f64.
    pub fn round(self) -> f64 {
        self.high + self.low
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

fn sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let of_b = high - a;
    let low = (a - (high - of_b)) + (b - of_b);
    Double { high, low }
}

impl Add for Double {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (heads, tails) = (sum(self.high, other.high), sum(self.low, other.low));
        let middle = sum(heads.high, heads.low + tails.high);
        sum(middle.high, middle.low + tails.low)
    }
}

impl Neg for Double {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Double {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let rest = self.high.mul_add(other.high, -high);
        sum(high, rest + (self.high * other.low + self.low * other.high))
    }
}
