//! Poses `patch_from_object`, each given as seven numbers or a 4 × 4 matrix.

use crate::arrays::{numbers, shape_of};
use crate::errors::bad_input;
use bubbletouch::geometry::Pose;
use glam::{DMat3, DQuat, DVec3};
use ndarray::ArrayView1;
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// Tolerance for each entry of R Rᵀ − 1, where R is a rotation matrix, and for the deviation of a quaternion's length from 1. The tolerance accepts poses
/// written with few digits or rounded to float32.
const ROUNDING: f64 = 1e-3;
const ALLOWED: &str = "(n, 7) of x, y, z, qw, qx, qy, qz, or (n, 4, 4); without n for one";

/// Poses of an argument, with a flag that states whether the argument was a single pose.
pub struct Poses {
    /// Poses of the object in the patch frame, `patch_from_object`.
    pub poses: Vec<Pose>,
    /// Whether the argument was a single pose, without the first axis n.
    pub is_one: bool,
}

impl Poses {
    /// Reads poses from an array of shape (n, 7), (7,), (n, 4, 4) or (4, 4).
    ///
    /// # Errors
    /// If the shape is wrong, or a pose is not finite or contains no rotation; the error names the pose's number, from 0.
    pub fn from_argument(place: &str, given: &Bound<PyAny>) -> PyResult<Self> {
        let array = numbers(place, given)?;
        let (n_numbers, is_one) = match array.shape() {
            [7] => (7, true),
            [4, 4] => (16, true),
            [_, 7] => (7, false),
            [_, 4, 4] => (16, false),
            other => return Err(bad_input(place, shape_of(other), ALLOWED)),
        };
        let array = array
            .try_readonly()
            .map_err(|error| bad_input(place, error, "an array that nobody writes to meanwhile"))?;
        let values = array.as_slice()?;
        let of = |(number, values): (usize, &[f64])| {
            let pose = match values.len() {
                7 => from_seven(values),
                _ => from_matrix(values),
            };
            pose.map_err(|allowed| {
                let place = if is_one {
                    place.to_owned()
                } else {
                    format!("{place}[{number}]")
                };
                bad_input(place, ArrayView1::from(values), allowed)
            })
        };
        let poses = values.chunks_exact(n_numbers).enumerate().map(of);
        Ok(Self {
            poses: poses.collect::<PyResult<_>>()?,
            is_one,
        })
    }
}

fn from_seven(values: &[f64]) -> Result<Pose, &'static str> {
    let at = DVec3::new(values[0], values[1], values[2]);
    let turn = DQuat::from_xyzw(values[4], values[5], values[6], values[3]);
    let length = turn.length();
    // The check also fails for NaN.
    if at.is_finite() && (length - 1.0).abs() <= ROUNDING {
        return Ok(Pose::new(turn.normalize(), at));
    }
    Err("finite x, y, z and a quaternion qw, qx, qy, qz of length one")
}

fn from_matrix(values: &[f64]) -> Result<Pose, &'static str> {
    const ALLOWED: &str = "a rotation and a translation, with a last row 0, 0, 0, 1";
    let row = |k: usize| DVec3::new(values[4 * k], values[4 * k + 1], values[4 * k + 2]);
    let rotation = DMat3::from_cols(row(0), row(1), row(2)).transpose();
    let at = DVec3::new(values[3], values[7], values[11]);
    let is_rotation = (rotation * rotation.transpose()).abs_diff_eq(DMat3::IDENTITY, ROUNDING)
        && rotation.determinant() > 0.0;
    if !(is_rotation && at.is_finite() && values[12..] == [0.0, 0.0, 0.0, 1.0]) {
        return Err(ALLOWED);
    }
    Ok(Pose::new(DQuat::from_mat3(&rotation).normalize(), at))
}
