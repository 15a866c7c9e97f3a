//! Poses `patch_from_object`, each given as seven numbers or a 4 × 4 matrix.

use crate::arrays::{numbers, shape_of};
use crate::errors::bad_input;
use bubbletouch::geometry::{Pose, written_rotation, written_rotation_matrix};
use glam::{DMat3, DQuat, DVec3};
use ndarray::ArrayView1;
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;

const ALLOWED: &str = "(n, 7) of x, y, z, qw, qx, qy, qz, or (n, 4, 4); without n for one";

/// Poses of an argument, with a flag that states whether the argument was a single pose, or a single pose of each of several objects.
pub struct Poses {
    /// Poses of the objects in the patch frame, `patch_from_object`: all objects of the first set of poses, then all objects of the next one.
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
        Self::of_objects(place, given, None)
    }

    /// Reads a single pose from an array of shape (7,), (1, 7), (4, 4) or (1, 4, 4).
    ///
    /// # Errors
    /// If the array contains several poses, or the pose is not finite or contains no rotation.
    pub fn single(place: &str, given: &Bound<PyAny>) -> PyResult<Pose> {
        let poses = Self::from_argument(place, given)?.poses;
        let [pose] = poses[..] else {
            let given = format!("{} poses", poses.len());
            return Err(bad_input(place, given, "one pose"));
        };
        Ok(pose)
    }

    /// Reads poses of k objects from an array of shape (n, k, 7), (k, 7), (n, k, 4, 4) or (k, 4, 4). If `n_objects` is `None`, the shapes have no axis k.
    ///
    /// # Errors
    /// If the shape is wrong, or a pose is not finite or contains no rotation; the error names the pose's number, from 0.
    pub fn of_objects(
        place: &str,
        given: &Bound<PyAny>,
        n_objects: Option<usize>,
    ) -> PyResult<Self> {
        let array = numbers(place, given)?;
        let k = n_objects.unwrap_or(1);
        let shape = array.shape();
        let (n_numbers, is_one) = match (n_objects, shape) {
            (None, [7]) => (7, true),
            (None, [4, 4]) => (16, true),
            (None, [_, 7]) => (7, false),
            (None, [_, 4, 4]) => (16, false),
            (Some(_), [n, 7]) if *n == k => (7, true),
            (Some(_), [n, 4, 4]) if *n == k => (16, true),
            (Some(_), [_, n, 7]) if *n == k => (7, false),
            (Some(_), [_, n, 4, 4]) if *n == k => (16, false),
            (None, other) => return Err(bad_input(place, shape_of(other), ALLOWED)),
            (Some(_), other) => {
                let allowed =
                    format!("(n, {k}, 7) or (n, {k}, 4, 4), one pose an object; without n for one");
                return Err(bad_input(place, shape_of(other), allowed));
            }
        };
        let array = array
            .try_readonly()
            .map_err(|error| bad_input(place, error, "an array that nobody writes to meanwhile"))?;
        let values = array.as_slice()?;
        let of = |(number, values): (usize, &[f64])| {
            from_numbers(values).map_err(|allowed| {
                let place = match (n_objects, is_one) {
                    (None, true) => place.to_owned(),
                    (None, false) | (Some(_), true) => format!("{place}[{number}]"),
                    (Some(_), false) => format!("{place}[{}, {}]", number / k, number % k),
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

/// Returns the pose of seven numbers x, y, z, qw, qx, qy, qz, or of the sixteen numbers of a 4 × 4 matrix by rows.
///
/// # Errors
/// If the numbers are no pose; the error states what is allowed.
pub fn from_numbers(values: &[f64]) -> Result<Pose, &'static str> {
    if let Some((position, quaternion)) = values.split_at_checked(3)
        && quaternion.len() == 4
    {
        let allowed = "finite x, y, z and a quaternion qw, qx, qy, qz of length one";
        return from_parts(position, quaternion).ok_or(allowed);
    }
    let [a, b, c, x, d, e, f, y, g, h, i, z, last @ ..] = values else {
        return Err(ALLOWED);
    };
    let pose = from_parts(&[*x, *y, *z], &[*a, *b, *c, *d, *e, *f, *g, *h, *i]);
    let pose = pose.filter(|_| last == [0.0, 0.0, 0.0, 1.0]);
    pose.ok_or("a rotation and a translation, with a last row 0, 0, 0, 1")
}

/// Returns the pose with a position, metres, and a rotation: a quaternion w, x, y, z, or a matrix by rows. Returns `None` if the numbers are no pose.
pub fn from_parts(position: &[f64], rotation: &[f64]) -> Option<Pose> {
    let position = DVec3::from_slice(position);
    let rotation = match *rotation {
        [w, x, y, z] => written_rotation(DQuat::from_xyzw(x, y, z, w)),
        _ => written_rotation_matrix(&DMat3::from_cols_slice(rotation).transpose()),
    };
    let rotation = rotation.filter(|_| position.is_finite())?;
    Some(Pose::new(rotation, position))
}
