//! Quantity that a frame contains: deflections or forces.

use crate::errors::one_of;
use bubbletouch::contact::Row;
use bubbletouch::world::{Patch, Taxels};
use numpy::Element;
use pyo3::prelude::*;

/// Quantity that a frame contains: deflections, metres, or forces along the axes of the taxels, newtons.
#[derive(Clone, Copy, PartialEq)]
pub enum Output {
    /// Deflections of the taxels, metres.
    Deflection,
    /// Forces of the springs along the axes of the taxels, newtons: stiffness times deflection.
    Force,
}

impl Output {
    /// Reads the argument `output` of a method.
    ///
    /// # Errors
    /// If the word is neither `deflection` nor `force`.
    pub fn from_argument(output: &str) -> PyResult<Self> {
        let known = [("deflection", Self::Deflection), ("force", Self::Force)];
        one_of("output", output, &known)
    }

    /// Converts deflections to the quantity of the output. `values` contains equally many numbers for each taxel; zeros are not written.
    pub fn convert<T: Real>(self, patch: &Patch, values: &mut [T]) {
        if self == Self::Deflection {
            return;
        }
        let scale = |values: &mut [T], stiffness: f64| {
            for value in values.iter_mut().filter(|value| **value != T::default()) {
                *value = value.scaled(stiffness);
            }
        };
        match patch.taxels() {
            Taxels::Equal(taxel) => scale(values, taxel.stiffness),
            Taxels::Each(taxels) => {
                let n_each = values.len() / taxels.len();
                for (taxel, values) in taxels.iter().zip(values.chunks_exact_mut(n_each)) {
                    scale(values, taxel.stiffness);
                }
            }
        }
    }
}

/// Type of the numbers in a frame: float32 or float64.
pub trait Real: Element + Copy + Default + PartialEq {
    /// Name of the type with its article, for error messages.
    const NAME: &str;

    /// Returns the number times a factor, rounded once.
    fn scaled(self, factor: f64) -> Self;

    /// Returns a frame as the target of a press.
    fn row(frame: &mut [Self]) -> Row<'_>;
}

impl Real for f64 {
    const NAME: &str = "a float64";

    fn scaled(self, factor: f64) -> Self {
        self * factor
    }

    fn row(frame: &mut [Self]) -> Row<'_> {
        Row::Double(frame)
    }
}

impl Real for f32 {
    const NAME: &str = "a float32";

    fn scaled(self, factor: f64) -> Self {
        (f64::from(self) * factor) as Self
    }

    fn row(frame: &mut [Self]) -> Row<'_> {
        Row::Single(frame)
    }
}
