//! Poses of several patches or bodies as arguments: one set, or n sets.

use crate::arrays::{numbers, shape_of};
use crate::errors::bad_input;
use crate::poses::{from_numbers, from_parts};
use bubbletouch::geometry::Pose;
use ndarray::ArrayView1;
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

const ALLOWED: &str = "(…, k, 7) of x, y, z, qw, qx, qy, qz; (…, k, 4, 4); or a pair of positions (…, k, 3) and rotations (…, k, 4), (…, k, 9) or (…, k, 3, 3)";

/// Number of sets of poses in an argument, and whether the argument has an axis of sets.
#[derive(Clone, Copy, Debug)]
pub struct PoseSets {
    n: usize,
    /// `None` if the shape allows both, such as (1, 7) for a single body.
    has_axis: Option<bool>,
}

impl PoseSets {
    /// Returns the common number of sets of two arguments, or `None` if neither has an axis of sets. A single set is repeated for the other argument's sets.
    ///
    /// # Errors
    /// If the numbers of sets differ, and both are larger than one.
    pub fn joined(
        (patches, patch_poses): (Self, &mut Vec<Pose>),
        (bodies, body_poses): (Self, &mut Vec<Pose>),
    ) -> PyResult<Option<usize>> {
        if patches.n != bodies.n && patches.n != 1 && bodies.n != 1 {
            let given = format!(
                "{} sets of patch_poses, {} of body_poses",
                patches.n, bodies.n
            );
            let allowed = "the same number of sets, or one set of either";
            return Err(bad_input("poses", given, allowed));
        }
        let n = if patches.n == 1 { bodies.n } else { patches.n };
        for (sets, poses) in [(patches, patch_poses), (bodies, body_poses)] {
            if sets.n != n {
                *poses = poses.repeat(n);
            }
        }
        let has_axis = patches.has_axis == Some(true) || bodies.has_axis == Some(true);
        Ok(has_axis.then_some(n))
    }
}

/// Reads poses of `n_each` patches or bodies into `poses`. Returns the number of sets of poses.
pub fn read_poses(
    place: &str,
    given: &Bound<PyAny>,
    n_each: usize,
    poses: &mut Vec<Pose>,
) -> PyResult<PoseSets> {
    poses.clear();
    let Some((positions, rotations)) = pair_of(given)? else {
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
        let each = numbers.chunks_exact(if width == 1 { 7 } else { 16 });
        for (number, values) in each.enumerate() {
            let read = from_numbers(values).map_err(|allowed| {
                let place = pose_place(place, number, n_each, sets);
                bad_input(place, ArrayView1::from(values), allowed)
            });
            poses.push(read?);
        }
        return Ok(sets);
    };
    let positions = numbers(place, &positions)?;
    let rotations = numbers(place, &rotations)?;
    let shape = positions.shape().to_vec();
    let [leading @ .., 3] = &shape[..] else {
        return Err(bad_input(place, shape_of(&shape), ALLOWED));
    };
    let sets = n_sets(place, &shape, leading, n_each)?;
    let n = sets.n * n_each;
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
        let read = from_parts(position, rotation).ok_or_else(|| {
            let place = pose_place(place, number, n_each, sets);
            let [position, rotation] = [position, rotation].map(ArrayView1::from);
            let given = format!("position {position}, rotation {rotation}");
            let allowed = match width {
                4 => "a finite position, and a quaternion w, x, y, z of length one",
                _ => "a finite position, and a right-handed rotation matrix by rows",
            };
            bad_input(place, given, allowed)
        });
        poses.push(read?);
    }
    Ok(sets)
}

/// Returns the two parts of a pair of positions and rotations: a tuple, or a list of two arrays of different shapes. Returns `None` for other arguments.
fn pair_of<'py>(
    given: &Bound<'py, PyAny>,
) -> PyResult<Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>> {
    if let Ok(pair) = given.cast::<PyTuple>()
        && pair.len() == 2
    {
        return Ok(Some((pair.get_item(0)?, pair.get_item(1)?)));
    }
    if let Ok(pair) = given.cast::<PyList>()
        && pair.len() == 2
    {
        let (first, second) = (pair.get_item(0)?, pair.get_item(1)?);
        let shape = |part: &Bound<PyAny>| Some(numbers("", part).ok()?.shape().to_vec());
        if shape(&first).is_some_and(|first| Some(first) != shape(&second)) {
            return Ok(Some((first, second)));
        }
    }
    Ok(None)
}

/// Returns the place of a pose in an argument, such as `body_poses[3, 0]`. The indices are the number of the set, if there are several, and the number of
/// the patch or body.
fn pose_place(place: &str, number: usize, n_each: usize, sets: PoseSets) -> String {
    match sets.n {
        1 => format!("{place}[{number}]"),
        _ => format!("{place}[{}, {}]", number / n_each, number % n_each),
    }
}

/// Returns the number of sets of poses in an array with this shape.
fn n_sets(place: &str, shape: &[usize], leading: &[usize], n_each: usize) -> PyResult<PoseSets> {
    let sets = |n, has_axis| Ok(PoseSets { n, has_axis });
    match leading {
        [] if n_each == 1 => sets(1, Some(false)),
        [1] if n_each == 1 => sets(1, None),
        [n] if n_each == 1 => sets(*n, Some(true)),
        [k] if *k == n_each => sets(1, Some(false)),
        [n, k] if *k == n_each => sets(*n, Some(true)),
        _ => {
            let allowed = format!("k = {n_each} poses; {ALLOWED}");
            Err(bad_input(place, shape_of(shape), allowed))
        }
    }
}
