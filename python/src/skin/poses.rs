//! Poses of several patches or bodies as arguments: one set, or n sets.

use crate::arrays::{numbers, shape_of};
use crate::errors::bad_input;
use crate::poses::{from_numbers, from_parts};
use bubbletouch::geometry::Pose;
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

const ALLOWED: &str = "(…, k, 7) of x, y, z, qw, qx, qy, qz; (…, k, 4, 4); or a pair of positions (…, k, 3) and rotations (…, k, 4), (…, k, 9) or (…, k, 3, 3)";

/// Reads poses of `n_each` patches or bodies into `poses`. Returns the number of sets of poses; returns `None` if the argument has no axis of sets.
pub fn read_poses(
    place: &str,
    given: &Bound<PyAny>,
    n_each: usize,
    poses: &mut Vec<Pose>,
) -> PyResult<Option<usize>> {
    poses.clear();
    let pair = given.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
    let Some(pair) = pair else {
        let array = numbers(place, given)?;
        let shape = array.shape().to_vec();
        let width = match shape[..] {
            [.., 4, 4] => 2,
            [.., 7] => 1,
            _ => return Err(bad_input(place, shape_of(&shape), ALLOWED)),
        };
        let sets = n_sets(place, &shape, &shape[..shape.len() - width], n_each)?;
        let array = array
            .try_readonly()
            .map_err(|e| bad_input(place, e, ALLOWED))?;
        let numbers = array.as_slice()?;
        for (number, pose) in numbers
            .chunks_exact(if width == 1 { 7 } else { 16 })
            .enumerate()
        {
            let read = from_numbers(pose);
            poses.push(read.map_err(|_| invalid(place, number))?);
        }
        return Ok(sets);
    };
    let positions = numbers(place, &pair.get_item(0)?)?;
    let rotations = numbers(place, &pair.get_item(1)?)?;
    let shape = positions.shape().to_vec();
    let [leading @ .., 3] = &shape[..] else {
        return Err(bad_input(place, shape_of(&shape), ALLOWED));
    };
    let sets = n_sets(place, &shape, leading, n_each)?;
    let n = sets.unwrap_or(1) * n_each;
    let width = match rotations.shape() {
        [of @ .., 4 | 9] | [of @ .., 3, 3] if of == leading => rotations.len() / n.max(1),
        other => return Err(bad_input(place, shape_of(other), ALLOWED)),
    };
    let positions = positions
        .try_readonly()
        .map_err(|e| bad_input(place, e, ALLOWED))?;
    let rotations = rotations
        .try_readonly()
        .map_err(|e| bad_input(place, e, ALLOWED))?;
    let each = positions.as_slice()?.chunks_exact(3);
    let each = each.zip(rotations.as_slice()?.chunks_exact(width.max(1)));
    for (number, (position, rotation)) in each.enumerate() {
        let read = from_parts(position, rotation);
        poses.push(read.ok_or_else(|| invalid(place, number))?);
    }
    Ok(sets)
}

fn invalid(place: &str, number: usize) -> PyErr {
    let place = format!("{place}[{number}]");
    let allowed = "finite numbers, and a quaternion of length one or a rotation matrix";
    bad_input(place, "no pose", allowed)
}

/// Returns the number of sets of poses in an array with this shape; returns `None` if the shape has no axis of sets.
fn n_sets(
    place: &str,
    shape: &[usize],
    leading: &[usize],
    n_each: usize,
) -> PyResult<Option<usize>> {
    match leading {
        [] if n_each == 1 => Ok(None),
        [k] if *k == n_each => Ok(None),
        [n, k] if *k == n_each => Ok(Some(*n)),
        _ => {
            let allowed = format!("k = {n_each} poses; {ALLOWED}");
            Err(bad_input(place, shape_of(shape), allowed))
        }
    }
}
