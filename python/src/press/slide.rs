//! Batches of presses with a slide on skins with friction: deflections and three-axis forces.

use crate::arrays::{Object, Rows, each, shape_of};
use crate::batch::{Spare, for_each, n_threads};
use crate::errors::{bad_input, exception};
use crate::press::goal::{Goal, Presses};
use bubbletouch::contact::{ContactMode, FrictionState, Workspace};
use bubbletouch::world::{self, Shear, Shears};
use glam::{DVec2, DVec3};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Arguments of `Patch.press_and_slide` that describe the motion and the friction.
pub struct Motion<'a, 'py> {
    /// Depth past first contact, metres: one number, or one per press.
    pub depth: &'a Object<'py>,
    /// Motion of the patch along its x and y axes after the press, metres: (2,) or (n, 2).
    pub slide: &'a Object<'py>,
    /// Coefficient of friction: one number, or one per taxel.
    pub friction: &'a Object<'py>,
    /// Stiffness of the shear springs, N/m: one number, or one per taxel. If `None`, the stiffness along the axes is used.
    pub shear_stiffness: Option<&'a Object<'py>>,
}

/// Result of one press with a slide.
#[derive(Clone)]
struct Slid {
    /// Deflections of the taxels, metres.
    deflection: Vec<f64>,
    /// Forces on the taxels, three numbers each, newtons.
    force3: Vec<f64>,
    is_slipping: Vec<bool>,
    /// Force and torque on the patch, newtons and newton metres.
    wrench: [f64; 6],
    /// Travel of the patch, metres; NaN if the path misses all objects.
    travel: f64,
}

/// Presses a patch on objects and slides it, at all poses. Returns a dict of arrays.
///
/// # Errors
/// If an argument is invalid, or Ctrl-C was pressed.
pub fn press_and_slide<'py>(
    py: Python<'py>,
    (patch, sides): (&world::Patch, &[usize]),
    (object, poses): (&Object<'py>, &Object<'py>),
    motion: &Motion<'_, 'py>,
    threads: Option<i64>,
) -> PyResult<Bound<'py, PyDict>> {
    let depth = Goal::from_arguments(Some(motion.depth), None, None)?;
    let presses = Presses::new(object, poses, depth)?;
    let n = presses.n();
    let slides = Rows::<2>::read("slide", motion.slide)?;
    if let Some(given) = slides.n().filter(|given| *given != n) {
        let allowed = format!("(2,), or ({n}, 2)");
        return Err(bad_input("slide", shape_of(&[given, 2]), allowed));
    }
    let shears = shears(patch, motion)?;
    let at_rest = || FrictionState::at_rest(patch, shears.clone());
    at_rest().map_err(exception)?;
    let n_taxels = patch.n_taxels();
    let missed = Slid {
        deflection: vec![0.0; n_taxels],
        force3: vec![0.0; 3 * n_taxels],
        is_slipping: vec![false; n_taxels],
        wrench: [0.0; 6],
        travel: f64::NAN,
    };
    let mut slid = vec![missed; n];
    let work = |number: usize, slid: &mut Slid, scratch: &mut (Workspace, FrictionState)| {
        let (workspace, friction) = scratch;
        let press = presses.press(number, patch);
        let way = DVec2::from(slides.at(number)).extend(0.0);
        let pressed = press.slide(way, Some(&mut *friction), workspace);
        let pressed = pressed.map_err(|error| presses.exception(number, error))?;
        let Some(contact) = pressed else {
            return Ok(());
        };
        slid.travel = contact.travel;
        slid.deflection.copy_from_slice(workspace.deflections());
        for contact in workspace.contacts() {
            let taxel = contact.taxel;
            let [x, y, z] = friction.force3()[taxel].to_array();
            // The z component of a taxel's reading is the force against the axis of the taxel.
            let force = patch.layout().frame(taxel) * DVec3::new(x, y, -z);
            slid.force3[3 * taxel..][..3].copy_from_slice(&force.to_array());
            slid.is_slipping[taxel] = friction.contact_modes()[taxel] == ContactMode::Slip;
        }
        let on_patch = -friction.load(patch, workspace.contacts()).on_object;
        let [x, y, z] = on_patch.force.to_array();
        let [about_x, about_y, about_z] = on_patch.torque.to_array();
        slid.wrench = [x, y, z, about_x, about_y, about_z];
        Ok(())
    };
    let scratch = || (Workspace::new(), at_rest().expect("checked shear springs"));
    let threads = n_threads(threads)?;
    let items = slid.iter_mut().collect();
    for_each(py, items, threads, &Spare::new(), scratch, work)?;
    let results = PyDict::new(py);
    let leading: &[usize] = if presses.is_one { &[] } else { &[n] };
    let shape = |sides: &[usize]| [leading, sides].concat();
    let set = |key, sides: &[usize], of: fn(&Slid) -> &[f64]| {
        let values: Vec<f64> = slid.iter().flat_map(of).copied().collect();
        results.set_item(key, values.into_pyarray(py).reshape(shape(sides))?)
    };
    set("deflection", sides, |slid| &slid.deflection)?;
    set("force3", &[n_taxels, 3], |slid| &slid.force3)?;
    let is_slipping: Vec<bool> = slid
        .iter()
        .flat_map(|slid| slid.is_slipping.clone())
        .collect();
    let is_slipping = is_slipping.into_pyarray(py).reshape(shape(sides))?;
    results.set_item("is_slipping", is_slipping)?;
    set("wrench", &[6], |slid| &slid.wrench)?;
    set("travel", &[], |slid| std::slice::from_ref(&slid.travel))?;
    Ok(results)
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
