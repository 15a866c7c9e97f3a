//! A touch by rows of a flat patch, in doubles and in singles: what singles would gain, and what they cost beside the error of the model.

use super::flat_press::{press_f32, press_f64};
use super::rows::ContactWay;
use crate::geometry::Pose;
use crate::objects::Sphere;
use crate::world::Patch;
use glam::DMat3;

/// Taxels that the wider of both takes at once.
const BLOCK: usize = 16;

/// A flat square patch, its places, and scratch; reused from touch to touch.
pub(super) struct FlatRows<'a> {
    patch: &'a Patch,
    places: Vec<f64>,
    singles: Vec<f32>,
    /// x, y, h, S of those that could press.
    spheres: Vec<[f64; 4]>,
    deflections: Vec<f64>,
    rounded: Vec<f32>,
}

impl<'a> FlatRows<'a> {
    /// Of a square patch with a whole number of blocks a side; of others there is none.
    pub fn new(patch: &'a Patch) -> Option<Self> {
        let grid = patch.layout().as_grid()?;
        if grid.nx != grid.ny || !grid.nx.is_multiple_of(BLOCK) {
            return None;
        }
        let places: Vec<f64> = (0..grid.nx).map(|column| grid.x(column)).collect();
        Some(Self {
            patch,
            singles: places.iter().map(|&place| place as f32).collect(),
            places,
            spheres: Vec::new(),
            deflections: vec![0.0; grid.n_taxels()],
            rounded: vec![0.0; grid.n_taxels()],
        })
    }

    /// Presses spheres at a pose (`patch_from_object`), in singles or in doubles.
    pub fn press(&mut self, way: ContactWay, spheres: &[Sphere], pose: &Pose) {
        self.gather(spheres, pose);
        match way {
            ContactWay::RowsInSingles => press_f32(&self.spheres, &self.singles, &mut self.rounded),
            _ => press_f64(&self.spheres, &self.places, &mut self.deflections),
        }
    }

    /// δ of the last press in this way, n_taxels, metres.
    pub fn deflections(&self, way: ContactWay) -> Vec<f64> {
        let stroke = self.patch.taxels().at(0).stroke;
        let (doubles, singles) = (&self.deflections, &self.rounded);
        match way {
            ContactWay::RowsInSingles => {
                singles.iter().map(|&d| f64::from(d).min(stroke)).collect()
            }
            _ => doubles.iter().map(|d| d.min(stroke)).collect(),
        }
    }

    /// Those that reach the plane of the taxels, over the patch, and are not behind it.
    fn gather(&mut self, spheres: &[Sphere], pose: &Pose) {
        let taxel = self.patch.taxels().at(0);
        let rotation = DMat3::from_quat(pose.rotation);
        let edge = self.places[self.places.len() - 1];
        let behind = -taxel.stroke - taxel.radius;
        self.spheres.clear();
        for sphere in spheres {
            let center = rotation * sphere.center + pose.translation;
            let reach = sphere.radius + taxel.radius;
            let is_over = center.x.abs() < edge + reach && center.y.abs() < edge + reach;
            if is_over && center.z < reach && center.z >= behind {
                self.spheres.push([center.x, center.y, center.z, reach]);
            }
        }
    }
}
