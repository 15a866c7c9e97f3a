//! Batches of presses with a slide on skins with friction: deflections and three-axis forces.

use crate::arrays::{each, numbers, shape_of};
use crate::batch::{Spare, for_each, n_threads};
use crate::errors::{bad_input, exception};
use crate::model::Objects;
use crate::poses::Poses;
use crate::press::goal::Goal;
use bubbletouch::contact::{ContactMode, FrictionState, Workspace};
use bubbletouch::world::{self, Shear, Shears};
use glam::DVec3;
use numpy::{IntoPyArray, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Arguments of `Patch.press_and_slide` that describe the motion and the friction.
pub struct Motion<'a, 'py> {
    /// Depth past first contact, metres: one number, or one per press.
    pub depth: &'a Bound<'py, PyAny>,
    /// Motion of the patch along its x and y axes after the press, metres: (2,) or (n, 2).
    pub slide: &'a Bound<'py, PyAny>,
    /// Coefficient of friction: one number, or one per taxel.
    pub friction: &'a Bound<'py, PyAny>,
    /// Stiffness of the shear springs, N/m: one number, or one per taxel. If `None`, the stiffness along the axes is used.
    pub shear_stiffness: Option<&'a Bound<'py, PyAny>>,
}

/// Output of one press: its rows of the result arrays.
struct Rows<'a> {
    deflection: &'a mut [f64],
    force3: &'a mut [f64],
    is_slipping: &'a mut [bool],
    wrench: &'a mut [f64],
    travel: &'a mut f64,
}

/// Presses a patch on objects and slides it, at all poses. Returns a dict of arrays.
///
/// # Errors
/// If an argument is invalid, or Ctrl-C was pressed.
pub fn press_and_slide<'py>(
    py: Python<'py>,
    (patch, sides): (&world::Patch, &[usize]),
    (object, poses): (&Bound<'py, PyAny>, &Bound<'py, PyAny>),
    motion: &Motion<'_, 'py>,
    threads: Option<i64>,
) -> PyResult<Bound<'py, PyDict>> {
    let objects = Objects::from_argument(object)?;
    let models = objects.models();
    let given = Poses::of_objects("poses", poses, objects.n_several())?;
    let n = given.poses.len() / models.len();
    let depth = Goal::from_arguments(Some(motion.depth), None, None)?;
    depth.check(n)?;
    let slides = slides(motion.slide, n)?;
    let shears = shears(patch, motion)?;
    let at_rest = || FrictionState::at_rest(patch, shears.clone());
    at_rest().map_err(exception)?;
    let n_taxels = patch.n_taxels();
    let mut deflection = vec![0.0; n * n_taxels];
    let mut force3 = vec![0.0; 3 * n * n_taxels];
    let mut is_slipping = vec![false; n * n_taxels];
    let mut wrench = vec![0.0; 6 * n];
    let mut travel = vec![f64::NAN; n];
    let rows = deflection
        .chunks_exact_mut(n_taxels)
        .zip(force3.chunks_exact_mut(3 * n_taxels))
        .zip(is_slipping.chunks_exact_mut(n_taxels))
        .zip(wrench.chunks_exact_mut(6))
        .zip(&mut travel);
    let rows = rows.map(
        |((((deflection, force3), is_slipping), wrench), travel)| Rows {
            deflection,
            force3,
            is_slipping,
            wrench,
            travel,
        },
    );
    let work = |number: usize, rows: Rows, scratch: &mut (Workspace, FrictionState)| {
        let (workspace, friction) = scratch;
        let poses = &given.poses[number * models.len()..][..models.len()];
        let press = depth.of_pose(number, patch, (models, poses));
        let pressed = press.slide(slides[number], Some(&mut *friction), workspace);
        let Some(contact) = pressed.map_err(exception)? else {
            return Ok(());
        };
        *rows.travel = contact.travel;
        rows.deflection.copy_from_slice(workspace.deflections());
        for contact in workspace.contacts() {
            let taxel = contact.taxel;
            let [x, y, z] = friction.force3()[taxel].to_array();
            // The z component of a taxel's reading is the force against the axis of the taxel.
            let force = patch.layout().frame(taxel) * DVec3::new(x, y, -z);
            rows.force3[3 * taxel..][..3].copy_from_slice(&force.to_array());
            rows.is_slipping[taxel] = friction.contact_modes()[taxel] == ContactMode::Slip;
        }
        let on_patch = -friction.load(patch, workspace.contacts()).on_object;
        rows.wrench[..3].copy_from_slice(&on_patch.force.to_array());
        rows.wrench[3..].copy_from_slice(&on_patch.torque.to_array());
        Ok(())
    };
    let scratch = || (Workspace::new(), at_rest().expect("checked shear springs"));
    let threads = n_threads(threads)?;
    for_each(py, rows.collect(), threads, &Spare::new(), scratch, work)?;
    let results = PyDict::new(py);
    let leading: &[usize] = if given.is_one { &[] } else { &[n] };
    let shape = |sides: &[usize]| [leading, sides].concat();
    let numbers = |values: Vec<f64>, sides: &[usize]| values.into_pyarray(py).reshape(shape(sides));
    results.set_item("deflection", numbers(deflection, sides)?)?;
    results.set_item("force3", numbers(force3, &[n_taxels, 3])?)?;
    let is_slipping = is_slipping.into_pyarray(py).reshape(shape(sides))?;
    results.set_item("is_slipping", is_slipping)?;
    results.set_item("wrench", numbers(wrench, &[6])?)?;
    results.set_item("travel", numbers(travel, &[])?)?;
    Ok(results)
}

/// Reads the slides of n presses, metres in the patch frame.
fn slides(given: &Bound<PyAny>, n: usize) -> PyResult<Vec<DVec3>> {
    const PLACE: &str = "slide";
    let array = numbers(PLACE, given)?;
    let is_one = match *array.shape() {
        [2] => true,
        [rows, 2] if rows == n => false,
        ref other => {
            let allowed = format!("(2,), or ({n}, 2)");
            return Err(bad_input(PLACE, shape_of(other), allowed));
        }
    };
    let array = array.try_readonly()?;
    let rows = array.as_slice()?.chunks_exact(2);
    let slides = rows.map(|row| {
        let slide = DVec3::new(row[0], row[1], 0.0);
        let place = || bad_input(PLACE, slide, "finite metres along x and y");
        slide.is_finite().then_some(slide).ok_or_else(place)
    });
    let slides: Vec<DVec3> = slides.collect::<PyResult<_>>()?;
    Ok(if is_one { vec![slides[0]; n] } else { slides })
}

/// Returns the shear springs of the taxels.
fn shears(patch: &world::Patch, motion: &Motion) -> PyResult<Shears> {
    let n = patch.n_taxels();
    let friction = each("friction", motion.friction, n)?;
    let stiffness = match motion.shear_stiffness {
        Some(given) => each("shear_stiffness", given, n)?,
        None => (0..n)
            .map(|taxel| patch.taxels().at(taxel).stiffness)
            .collect(),
    };
    let springs = stiffness.into_iter().zip(friction);
    let springs = springs.map(|(stiffness, friction)| Shear {
        stiffness,
        friction,
    });
    Ok(Shears::Each(springs.collect()))
}
