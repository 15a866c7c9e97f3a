//! Derivatives of deflections with respect to the object's pose, computed from the contact normals.
//!
//! A motion of the object in the patch frame consists of a translation dx of its origin o and a rotation dω about o. The motion changes the deflection of
//! contact i by `g·dx + ((p − o) × g)·dω`, where p is the contact point and g = −n_c / (n_c·n). The change of the travel of the patch depends on the goal:
//!
//! - pose or travel: the travel is constant;
//! - depth past first contact, on a flat patch: the deflection of the deepest taxel d is constant, so the derivative is `J_i − J_d`;
//! - force Σ k δ: the derivative is `J_i + r_i dT`, where the travel changes by `dT = −Σ k J / Σ k r` and r = −g_z is the change of a deflection per travel.
//!
//! The derivative of a saturated or untouched taxel is 0. If there are several objects, each contact moves with its
//! own object, and the travel changes with all of them.

use crate::errors::bad_input;
use bubbletouch::contact::{TaxelContact, Until};
use bubbletouch::world::Patch;
use glam::DVec3;
use pyo3::prelude::*;

/// Number of pose parameters: translation along x, y, z and rotation about x, y, z.
pub const N: usize = 6;

/// Returns whether the axes of all taxels of a patch are +z.
pub fn is_flat(patch: &Patch) -> bool {
    patch.layout().as_grid().is_some() || patch.layout().axes().iter().all(|axis| *axis == DVec3::Z)
}

/// Returns an error if the derivative for a kind of goal is not implemented.
///
/// # Errors
/// If the goal is a depth and the patch is not flat.
pub fn check(goal: Until, patch: &Patch) -> PyResult<()> {
    if !matches!(goal, Until::Depth(_)) || is_flat(patch) {
        return Ok(());
    }
    let given = "with a depth, on a patch that is not flat";
    Err(bad_input(
        "jacobian",
        given,
        "a travel, a force, or none of them there",
    ))
}

/// Writes the derivatives of all deflections with respect to the poses of k objects (n_taxels × k × 6, initially 0), from the contacts of a press. `origins`
/// are the positions of the objects after the press.
pub fn fill(
    changes: &mut [f64],
    goal: Until,
    patch: &Patch,
    (contacts, origins): (&[TaxelContact], &[DVec3]),
) {
    let change = |contact: &TaxelContact| {
        let gradient = contact.gradient();
        let turn = (contact.point - origins[contact.object]).cross(gradient);
        [gradient.x, gradient.y, gradient.z, turn.x, turn.y, turn.z]
    };
    let taxel = |contact: &TaxelContact| patch.taxels().at(contact.taxel);
    let moving = || {
        contacts
            .iter()
            .filter(|contact| !contact.is_saturated(taxel(contact)))
    };
    let rise = |contact: &TaxelContact| -contact.gradient().z;
    let mut travels = vec![[0.0; N]; origins.len()];
    match goal {
        Until::Pose | Until::Travel(_) => {}
        Until::Depth(_) => {
            let deepest = contacts.iter().max_by(|a, b| a.needed.total_cmp(&b.needed));
            if let Some(deepest) = deepest {
                travels[deepest.object] = change(deepest).map(|change| -change);
            }
        }
        Until::Force(_) => {
            let mut rises = 0.0;
            for contact in moving() {
                let stiffness = taxel(contact).stiffness;
                rises += stiffness * rise(contact);
                let sums = &mut travels[contact.object];
                for (sum, change) in sums.iter_mut().zip(change(contact)) {
                    *sum += stiffness * change;
                }
            }
            for sum in travels.as_flattened_mut() {
                *sum = if rises > 0.0 { -*sum / rises } else { 0.0 };
            }
        }
    }
    let width = N * origins.len();
    for contact in moving() {
        let rise = rise(contact);
        let row = &mut changes[contact.taxel * width..][..width];
        for (object, travel) in travels.iter().enumerate() {
            let own = match object == contact.object {
                true => change(contact),
                false => [0.0; N],
            };
            let row = &mut row[object * N..][..N];
            for ((to, change), travel) in row.iter_mut().zip(own).zip(travel) {
                *to = change + rise * travel;
            }
        }
    }
}
