//! Contact forces of an engine: arrays as arguments, and the patch on which each contact acts.

use super::parts::SkinPatch;
use crate::arrays::{points, view};
use crate::errors::bad_input;
use bubbletouch::contact::{LoadPart, PointLoad};
use bubbletouch::geometry::Pose;
use glam::DVec3;
use pyo3::prelude::*;

/// Least cosine between a normal force and the axis of the nearest taxel, reversed: contacts up to 60° off the axis act on the patch. If larger, contacts on
/// the rims of curved skins are lost; if smaller, contacts on the side of a finger act on its pad.
const FACING: f64 = 0.5;

/// Contact forces of an engine on the bodies that carry patches, in the world.
pub struct ContactLoads {
    /// Carrier of the touched patch, and object that touches it.
    pairs: Vec<[usize; 2]>,
    loads: Vec<PointLoad>,
    /// Whether friction and torques act, too.
    pub part: LoadPart,
}

/// Contact forces of an engine by the patch and the object between which they act.
#[derive(Default)]
pub struct PatchLoads {
    /// Patch, object and load in the patch frame, sorted by patch and object.
    pub loads: Vec<(usize, usize, PointLoad)>,
    /// Patch, object and normal force, newtons, of contacts beside all patches, at the nearest patch.
    pub beside: Vec<(usize, usize, f64)>,
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

    /// Assigns each contact to the patch of its carrier that it faces within reach, the nearest one if there are several. A contact that no patch of the carrier
    /// has within reach acts on no patch.
    pub fn by_patch(
        &self,
        parts: &[SkinPatch],
        carriers: &[usize],
        poses: &[Pose],
        reach: Option<f64>,
    ) -> PatchLoads {
        let mut found = PatchLoads::default();
        for (load, [carrier, object]) in self.loads.iter().zip(&self.pairs) {
            let own = carriers.iter().enumerate().filter(|(_, of)| *of == carrier);
            let places = own.map(|(patch, _)| {
                let local = in_frame(load, &poses[patch]);
                let (distance, acts) =
                    parts[patch].place(local.point, -local.normal, FACING, reach);
                (patch, local, distance, acts)
            });
            let nearest = places.min_by(|a, b| b.3.cmp(&a.3).then(a.2.total_cmp(&b.2)));
            match nearest {
                Some((patch, local, _, true)) => found.loads.push((patch, *object, local)),
                Some((patch, local, distance, false)) if distance <= parts[patch].size() => {
                    found.beside.push((patch, *object, local.normal.length()));
                }
                _ => {}
            }
        }
        found
            .loads
            .sort_by_key(|(patch, object, _)| (*patch, *object));
        found
    }
}

/// Returns a load of the world in the frame with a pose in the world.
fn in_frame(load: &PointLoad, pose: &Pose) -> PointLoad {
    let inverse = pose.inverse();
    let turned = |vector: DVec3| inverse.rotation * vector;
    PointLoad {
        point: inverse.transform_point(load.point),
        normal: turned(load.normal),
        friction: turned(load.friction),
        torque: turned(load.torque),
    }
}
