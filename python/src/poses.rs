//! Poses `patch_from_object`, each given as seven numbers or a 4 × 4 matrix.

use crate::arrays::{Object, numbers, shape_of};
use crate::errors::bad_input;
use bubbletouch::geometry::{Pose, written_rotation, written_rotation_matrix};
use glam::{DMat3, DQuat, DVec3};
use ndarray::ArrayView1;
use pyo3::prelude::*;
use std::borrow::Cow;

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
    pub fn from_argument(place: &str, given: &Object) -> PyResult<Self> {
        Self::of_objects(place, given, None)
    }

    /// Reads a single pose from an array of shape (7,), (1, 7), (4, 4) or (1, 4, 4).
    ///
    /// # Errors
    /// If the array contains several poses, or the pose is not finite or contains no rotation.
    pub fn single(place: &str, given: &Object) -> PyResult<Pose> {
        let poses = Self::from_argument(place, given)?.poses;
        let [pose] = poses[..] else {
            let given = format!("{} poses", poses.len());
            return Err(bad_input(place, given, "one pose, (7,) or (4, 4)"));
        };
        Ok(pose)
    }

    /// Reads poses of k objects from an array of shape (n, k, 7), (k, 7), (n, k, 4, 4) or (k, 4, 4). If `n_objects` is `None`, the shapes have no axis k.
    ///
    /// # Errors
    /// If the shape is wrong, or a pose is not finite or contains no rotation; the error names the pose's number, from 0.
    pub fn of_objects(place: &str, given: &Object, n_objects: Option<usize>) -> PyResult<Self> {
        let allowed = n_objects.map_or(Cow::Borrowed(ALLOWED), |k| {
            format!("(n, {k}, 7) or (n, {k}, 4, 4), one pose an object; without n for one").into()
        });
        let of_one: &[usize] = n_objects.as_slice();
        let axes_of = |leading: &[usize]| {
            let is_several = matches!(leading, [_, rest @ ..] if rest == of_one);
            (leading == of_one || is_several).then(|| leading.to_vec())
        };
        let mut poses = Vec::new();
        let axes = read_poses((place, given), &allowed, axes_of, &mut poses)?;
        let is_one = axes == of_one;
        Ok(Self { poses, is_one })
    }
}

/// Reads the poses of an array with the shape (…, 7) or (…, 4, 4) into `poses`. `axes_of` returns the axes by which errors name a pose, given the axes before
/// the last one or two; `None` if these axes are not allowed. Returns the axes.
///
/// # Errors
/// If the shape is not `allowed`, or a pose is not finite or contains no rotation.
pub fn read_poses(
    (place, given): (&str, &Object),
    allowed: &str,
    axes_of: impl Fn(&[usize]) -> Option<Vec<usize>>,
    poses: &mut Vec<Pose>,
) -> PyResult<Vec<usize>> {
    let array = numbers(place, given)?;
    let (leading, width) = match array.shape() {
        [leading @ .., 4, 4] => (Some(leading), 16),
        [leading @ .., 7] => (Some(leading), 7),
        _ => (None, 1),
    };
    let axes = leading.and_then(axes_of);
    let axes = axes.ok_or_else(|| bad_input(place, shape_of(array.shape()), allowed))?;
    poses.clear();
    for (number, values) in array.values().chunks_exact(width).enumerate() {
        let read = from_numbers(values).map_err(|allowed| {
            let place = element(place, number, &axes);
            bad_input(place, ArrayView1::from(values), allowed)
        });
        poses.push(read?);
    }
    Ok(axes)
}

/// Returns the place of an element of an array with the given axes, such as `poses[3, 0]`.
pub fn element(place: &str, number: usize, axes: &[usize]) -> String {
    match axes {
        [] => place.to_owned(),
        [_, k] => format!("{place}[{}, {}]", number / k, number % k),
        _ => format!("{place}[{number}]"),
    }
}

/// Returns the pose of seven numbers x, y, z, qw, qx, qy, qz, or of the sixteen numbers of a 4 × 4 matrix by rows.
///
/// # Errors
/// If the numbers are no pose; the error states what is allowed.
fn from_numbers(values: &[f64]) -> Result<Pose, &'static str> {
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
