//! Contact forces of an engine: arrays as arguments.

use super::parts::SkinPatch;
use crate::arrays::{points, view};
use crate::errors::bad_input;
use bubbletouch::contact::{
    AssignedLoads, LoadPart, LoadRange, LoadedPatch, PointLoad, assign_loads,
};
use bubbletouch::geometry::Pose;
use glam::DVec3;
use pyo3::prelude::*;

/// Contact forces of an engine on the bodies that carry patches, in the world.
pub struct ContactLoads {
    /// Carrier of the touched patch, and object that touches it.
    pairs: Vec<[usize; 2]>,
    loads: Vec<PointLoad>,
    /// Whether friction and torques act, too.
    pub part: LoadPart,
}

impl ContactLoads {
    /// Reads the argument `loads`: pairs (m, 2) of carrier and object, points, normal forces and, optionally, friction forces and torques, (m, 3).
    ///
    /// # Errors
    /// If the argument is not a tuple of 3 or 5 arrays, a number is not finite, or an index is out of its range.
    pub fn read(given: &Bound<PyAny>, n_carriers: usize, n_objects: usize) -> PyResult<Self> {
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
        let limits = [n_carriers, n_objects];
        let pairs = view(
            "loads, pairs",
            pairs,
            "(m, 2)",
            |is| matches!(is, [_, 2]),
            |array| {
                let rows = array.rows().into_iter().map(|row| {
                    let row = [row[0], row[1]];
                    let fits = |k: usize| {
                        row[k] >= 0.0 && row[k] < limits[k] as f64 && row[k].fract() == 0.0
                    };
                    match fits(0) && fits(1) {
                        true => Ok(row.map(|index| index as usize)),
                        false => {
                            let allowed = format!(
                                "a carrier below {n_carriers} and an object below {n_objects}"
                            );
                            Err(bad_input("loads, pairs", format!("{row:?}"), allowed))
                        }
                    }
                });
                rows.collect::<PyResult<Vec<_>>>()
            },
        )?;
        let vectors = vectors.iter().map(|array| points("loads", array));
        let vectors: Vec<Vec<DVec3>> = vectors.collect::<PyResult<_>>()?;
        for vectors in &vectors {
            if vectors.len() != pairs.len() {
                let allowed = format!("{}, as pairs", pairs.len());
                return Err(bad_input(
                    "loads",
                    format!("{} rows", vectors.len()),
                    allowed,
                ));
            }
            if let Some(row) = vectors.iter().position(|vector| !vector.is_finite()) {
                let given = format!("{} in row {row}", vectors[row]);
                return Err(bad_input("loads", given, "finite numbers"));
            }
        }
        let at = |array: usize, row: usize| vectors.get(array).map_or(DVec3::ZERO, |it| it[row]);
        let loads = (0..pairs.len()).map(|row| PointLoad {
            point: at(0, row),
            normal: at(1, row),
            friction: at(2, row),
            torque: at(3, row),
        });
        Ok(Self {
            loads: loads.collect(),
            pairs,
            part,
        })
    }

    /// Assigns the contacts to the patches of their carriers.
    pub fn by_patch(
        &self,
        parts: &[SkinPatch],
        carriers: &[usize],
        poses: &[Pose],
        reach: Option<f64>,
    ) -> AssignedLoads {
        let patches = parts.iter().zip(carriers).zip(poses);
        let patches = patches.map(|((part, carrier), pose)| LoadedPatch {
            patch: &part.patch,
            range: LoadRange {
                reach: reach.unwrap_or(0.0).max(part.range.reach),
                ..part.range
            },
            carrier: *carrier,
            pose: *pose,
        });
        let contacts = self.pairs.iter().zip(&self.loads);
        let contacts = contacts.map(|([carrier, object], load)| (*carrier, *object, *load));
        assign_loads(&patches.collect::<Vec<_>>(), contacts)
    }
}
