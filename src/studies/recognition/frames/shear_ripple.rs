//! Error in shear readings on a flat face that is approximated by packed spheres.
//!
//! On an exactly flat face, every taxel has the same shear reading. Packed spheres bulge by up to half the surface error. The bulges tilt the contact normals,
//! so the shear readings ripple; a classifier can learn this ripple.

use crate::geometry::Pose;
use crate::mesh::TriangleMesh;
use crate::note::note;
use crate::objects::{MeshModel, Model, Object, Part, Shape, Solid};
use crate::studies::prelude::*;
use crate::studies::recognition::frames::ArrayWorkspace;
use crate::studies::recognition::plan::Sensed;
use crate::world::Spread;
use glam::DVec3;

/// Edge lengths of the box that is used to measure the shear error, metres.
const BOX: DVec3 = DVec3::new(0.04, 0.04, 0.02);

/// Statistics of the error in shear forces that occurs where packed spheres approximate a flat face. The shear error of a taxel is its shear reading along x
/// minus the reading on an exactly flat face, newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearRipple {
    /// Mean shear error over the taxels under the face, newtons.
    pub mean: f64,
    /// Standard deviation of the shear error over the taxels under the face, newtons.
    pub std: f64,
}

impl ShearRipple {
    /// Presses an array on a packed box, slides it, and measures the shear error. The box is packed within `surface_error` and pressed to `depth`, both in
    /// metres. Returns `None` if the array does not read shear, or if no taxel lies under the face.
    ///
    /// # Errors
    /// If the box cannot be packed within that error.
    pub fn measure(array: &TaxelArray, surface_error: f64, depth: f64) -> Result<Option<Self>> {
        if !matches!(array.sensed(), Sensed::Shear(_)) {
            return Ok(None);
        }
        let shape = Shape::Box {
            size: BOX,
            rounding: 0.0,
        };
        let solid = Solid::new(vec![Part::new(shape, Pose::IDENTITY)?])?;
        let Some(packed) = shear_along_x(array, &solid.pack(surface_error)?.into(), depth) else {
            return Ok(None);
        };
        let Some(exact) = shear_along_x(array, &exact_box()?, depth) else {
            return Ok(None);
        };
        let margin = array.taxel().radius + array.slide().length();
        let half = 0.5 * BOX.truncate() - margin;
        let centers = array.patch().layout().centers().iter();
        let readings = centers.zip(packed.iter().zip(&exact));
        let under = readings.filter(|(center, _)| center.truncate().abs().cmple(half).all());
        let errors: Vec<f64> = under.map(|(_, (packed, exact))| packed - exact).collect();
        if errors.is_empty() {
            return Ok(None);
        }
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<f64>() / count;
        let square = errors
            .iter()
            .map(|error| (error - mean).powi(2))
            .sum::<f64>();
        Ok(Some(Self {
            mean,
            std: (square / count).sqrt(),
        }))
    }
}

/// Presses the array on an object and slides it along x; returns the shear reading of each taxel along x, newtons. Returns `None` if the press touches nothing.
fn shear_along_x(array: &TaxelArray, object: &Model, depth: f64) -> Option<Vec<f64>> {
    let mut workspace = ArrayWorkspace::default();
    let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 0.1));
    let press = array.press(object);
    press.touch(pose, (depth, 1.0), &mut workspace)?;
    let forces = workspace.shear_forces().iter();
    Some(forces.map(|force| force.x).collect())
}

/// Returns the box with exact flat faces as a triangle mesh.
fn exact_box() -> Result<Model> {
    let mesh = TriangleMesh::cuboid("box", BOX)?;
    Ok(MeshModel::new(mesh).into())
}

/// Prints the error of shear forces on standard error if a study simulates shear on objects packed with spheres. Returns whether it printed a note.
///
/// # Errors
/// If an object cannot be packed.
pub(crate) fn note_shear_ripple(plan: &Plan, objects: &[Object]) -> Result<bool> {
    let packed = objects
        .iter()
        .filter(|object| object.model.n_spheres() > 1)
        .count();
    let spec = &plan.spec.objects;
    if packed == 0 {
        return Ok(false);
    }
    let depth = match &plan.placement.depth {
        Spread::Values(values) => values.iter().copied().fold(0.0, f64::max),
        Spread::Uniform { high, .. } => *high,
    };
    let Some(ripple) = ShearRipple::measure(&plan.array, spec.surface_error(), depth)? else {
        return Ok(false);
    };
    note(format_args!(
        "{packed} of {} objects are spheres within {} mm: on a flat face a taxel of the {} mm array reads {:.3} ± {:.3} N of shear \
         that no exact face has; meshes with model = \"mesh\" have none",
        objects.len(),
        spec.surface_error() / MM,
        crate::inputs::units::millimetres(plan.array.pitch()),
        ripple.mean,
        ripple.std
    ));
    Ok(true)
}
