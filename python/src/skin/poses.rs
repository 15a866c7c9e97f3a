//! Poses of several patches or bodies as arguments: one set, or n sets.

use crate::arrays::{Object, numbers, shape_of};
use crate::errors::bad_input;
use crate::poses::{element, from_parts, read_poses};
use bubbletouch::geometry::Pose;
use ndarray::ArrayView1;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

const ALLOWED: &str = "(…, k, 7) of x, y, z, qw, qx, qy, qz; (…, k, 4, 4); or a pair of positions (…, k, 3) and rotations (…, k, 4), (…, k, 9) or (…, k, 3, 3)";

/// Number of sets of poses in an argument, and whether the argument has an axis of sets.
#[derive(Clone, Copy, Debug)]
pub struct PoseSets {
    n: usize,
    /// False if the shape allows both, such as (1, 7) for a single body.
    has_axis: bool,
}

impl PoseSets {
    /// Reads poses of `n_each` patches or bodies into `poses`.
    ///
    /// # Errors
    /// If the shape is wrong, or a pose is not finite or contains no rotation.
    pub fn read(
        place: &str,
        given: &Object,
        n_each: usize,
        poses: &mut Vec<Pose>,
    ) -> PyResult<Self> {
        let allowed = format!("k = {n_each} poses; {ALLOWED}");
        let axes_of = |leading: &[usize]| match *leading {
            [] if n_each == 1 => Some(vec![1]),
            [n] if n == n_each || n_each == 1 => Some(vec![n]),
            [n, k] if k == n_each => Some(vec![n, k]),
            _ => None,
        };
        let axes = match pair_of(given)? {
            None => read_poses((place, given), &allowed, axes_of, poses)?,
            Some(pair) => read_pairs((place, pair), &allowed, axes_of, poses)?,
        };
        let is_one = axes == [n_each];
        Ok(Self {
            n: if is_one { 1 } else { axes[0] },
            has_axis: !is_one,
        })
    }

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
        Ok((patches.has_axis || bodies.has_axis).then_some(n))
    }
}

/// Reads poses from a pair of positions and rotations, as [`read_poses`] does from one array.
fn read_pairs(
    (place, [positions, rotations]): (&str, [Object; 2]),
    allowed: &str,
    axes_of: impl Fn(&[usize]) -> Option<Vec<usize>>,
    poses: &mut Vec<Pose>,
) -> PyResult<Vec<usize>> {
    let (positions, rotations) = (numbers(place, &positions)?, numbers(place, &rotations)?);
    let refuse = |shape: &[usize]| bad_input(place, shape_of(shape), allowed);
    let shape = positions.shape();
    let leading = shape.strip_suffix(&[3]);
    let leading = leading.ok_or_else(|| refuse(shape))?;
    let axes = axes_of(leading).ok_or_else(|| refuse(shape))?;
    let width = match rotations.shape() {
        [of @ .., 4] if of == leading => 4,
        [of @ .., 9] | [of @ .., 3, 3] if of == leading => 9,
        other => return Err(refuse(other)),
    };
    poses.clear();
    let each = positions.values().chunks_exact(3);
    let each = each.zip(rotations.values().chunks_exact(width));
    for (number, (position, rotation)) in each.enumerate() {
        let read = from_parts(position, rotation).ok_or_else(|| {
            let [position, rotation] = [position, rotation].map(ArrayView1::from);
            let given = format!("position {position}, rotation {rotation}");
            let allowed = match width {
                4 => "a finite position, and a quaternion w, x, y, z of length one",
                _ => "a finite position, and a right-handed rotation matrix by rows",
            };
            bad_input(element(place, number, &axes), given, allowed)
        });
        poses.push(read?);
    }
    Ok(axes)
}

/// Returns the two parts of a pair of positions and rotations: a tuple, or a list of two arrays of different shapes. Returns `None` for other arguments.
fn pair_of<'py>(given: &Object<'py>) -> PyResult<Option<[Object<'py>; 2]>> {
    let is_tuple = given.is_instance_of::<PyTuple>();
    if !(is_tuple || given.is_instance_of::<PyList>()) || given.len()? != 2 {
        return Ok(None);
    }
    let pair = [given.get_item(0)?, given.get_item(1)?];
    let are_pair = || {
        let shape = |part: &Object| Some(numbers("", part).ok()?.shape().to_vec());
        let [first, second] = pair.each_ref().map(shape);
        first.is_some() && first != second
    };
    Ok((is_tuple || are_pair()).then_some(pair))
}
