//! Contact forces of an engine: arrays as arguments.

use crate::arrays::{points, view};
use crate::errors::bad_input;
use bubbletouch::skin::{BodyLoad, LoadPart, PointLoad};
use glam::DVec3;
use pyo3::prelude::*;

/// Reads the argument `loads`: pairs (m, 2) of carrier and object, points, normal forces and, optionally, friction forces and torques, (m, 3).
///
/// # Errors
/// If the argument is not a tuple of 3 or 5 arrays, or an index is no whole number. The library checks the ranges of indices and vectors.
pub fn read(given: &Bound<PyAny>) -> PyResult<(Vec<BodyLoad>, LoadPart)> {
    let arrays: Vec<Bound<PyAny>> = given.extract().unwrap_or_default();
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
    let is_pairs = |shape: &[usize]| matches!(shape, [_, 2]);
    let pairs = view("loads, pairs", pairs, "(m, 2)", is_pairs, |array| {
        let rows = array.rows().into_iter().map(|row| {
            let row = [row[0], row[1]];
            match row
                .iter()
                .all(|index| *index >= 0.0 && index.fract() == 0.0)
            {
                true => Ok(row.map(|index| index as usize)),
                false => {
                    let allowed = "indices of a carrier and an object, from 0";
                    Err(bad_input("loads, pairs", format!("{row:?}"), allowed))
                }
            }
        });
        rows.collect::<PyResult<Vec<_>>>()
    })?;
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
