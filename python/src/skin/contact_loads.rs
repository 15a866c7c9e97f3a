//! Contact forces of an engine: arrays as arguments.

use crate::arrays::{Object, points, rows, whole_numbers};
use crate::errors::bad_input;
use bubbletouch::skin::{BodyLoad, LoadPart, PointLoad};
use glam::DVec3;
use pyo3::prelude::*;

/// Reads the argument `loads`: pairs (m, 2) of carrier and object, points, normal forces and, optionally, friction forces and torques, (m, 3).
///
/// # Errors
/// If the argument is not a tuple of 3 or 5 arrays, or an index is no whole number. The library checks the ranges of indices and vectors.
pub fn read(given: &Object) -> PyResult<(Vec<BodyLoad>, LoadPart)> {
    let arrays: Vec<Object> = given.extract().unwrap_or_default();
    let (pairs, vectors, part) = match &arrays[..] {
        [pairs, vectors @ ..] if vectors.len() == 2 => (pairs, vectors, LoadPart::Normal),
        [pairs, vectors @ ..] if vectors.len() == 4 => (pairs, vectors, LoadPart::Whole),
        _ => {
            let given = format!("{} arrays", arrays.len());
            let allowed =
                "pairs, points, normal forces and, for all forces, friction forces and torques";
            return Err(bad_input("loads", given, allowed));
        }
    };
    let pairs = rows::<2>("loads, pairs", pairs)?;
    let allowed = "indices of a carrier and an object, from 0";
    let pairs: Vec<usize> = whole_numbers("loads, pairs", pairs.as_flattened(), allowed)?;
    let pairs = pairs.as_chunks::<2>().0;
    let vectors = vectors.iter().map(|array| points("loads", array));
    let vectors: Vec<Vec<DVec3>> = vectors.collect::<PyResult<_>>()?;
    if let Some(wrong) = vectors.iter().find(|rows| rows.len() != pairs.len()) {
        let allowed = format!("{}, as pairs", pairs.len());
        return Err(bad_input("loads", format!("{} rows", wrong.len()), allowed));
    }
    let at = |array: usize, row: usize| vectors.get(array).map_or(DVec3::ZERO, |it| it[row]);
    let loads = pairs
        .iter()
        .enumerate()
        .map(|(row, &[carrier, object])| BodyLoad {
            carrier,
            object,
            load: PointLoad {
                point: at(0, row),
                normal: at(1, row),
                friction: at(2, row),
                torque: at(3, row),
            },
        });
    Ok((loads.collect(), part))
}
