//! How deflections change with the pose of the object, from the contact normals.
//!
//! A motion of the object in the frame of the patch, dx of its origin o and a turn dω about it, changes the deflection that contact i needs by
//! `g·dx + ((p − o) × g)·dω`: p where they touch, g = −n_c / (n_c·n). What the patch travels to its goal changes too:
//!
//! - at a pose or to a travel it does not;
//! - to a depth past first contact, on a flat patch, the deepest taxel d keeps its deflection, so its change is subtracted: `J_i − J_d`;
//! - to a force Σ k δ it changes by `dT = −Σ k J / Σ k r`, r = −g_z what a travel adds to a deflection: `J_i + r_i dT`.
//!
//! A saturated taxel, and one that nothing touches, does not change.

use crate::errors::bad_input;
use bubbletouch::contact::{Goal, TaxelContact};
use bubbletouch::world::Patch;
use glam::DVec3;
use pyo3::prelude::*;

/// Numbers that a pose has: translation x, y, z and a turn about x, y, z.
pub const N: usize = 6;

/// Whether all axes of a patch are z.
fn is_flat(patch: &Patch) -> bool {
    patch.layout().as_grid().is_some() || patch.layout().axes().iter().all(|axis| *axis == DVec3::Z)
}

/// That the derivative to a goal is known.
///
/// # Errors
/// It is not: a depth on a patch that is not flat.
pub fn check(goal: Goal, patch: &Patch) -> PyResult<()> {
    if !matches!(goal, Goal::Depth(_)) || is_flat(patch) {
        return Ok(());
    }
    let given = "with a depth, on a patch that is not flat";
    Err(bad_input(
        "jacobian",
        given,
        "a travel, a force, or none of them there",
    ))
}

/// Writes the changes of all taxels (n_taxels × 6, zero before), from the contacts of a press; `origin`: of the object, where the press left it.
pub fn fill(
    changes: &mut [f64],
    goal: Goal,
    patch: &Patch,
    (contacts, origin): (&[TaxelContact], DVec3),
) {
    let change = |contact: &TaxelContact| {
        let gradient = contact.gradient();
        let turn = (contact.point - origin).cross(gradient);
        [gradient.x, gradient.y, gradient.z, turn.x, turn.y, turn.z]
    };
    let taxel = |contact: &TaxelContact| patch.taxels().at(contact.taxel);
    let moving = || {
        contacts
            .iter()
            .filter(|contact| !contact.is_saturated(taxel(contact)))
    };
    let rise = |contact: &TaxelContact| -contact.gradient().z;
    let travel = match goal {
        Goal::Pose | Goal::Travel(_) => [0.0; N],
        Goal::Depth(_) => {
            let deepest = contacts.iter().max_by(|a, b| a.needed.total_cmp(&b.needed));
            deepest.map_or([0.0; N], |deepest| change(deepest).map(|change| -change))
        }
        Goal::Force(_) => {
            let (mut sum, mut rises) = ([0.0; N], 0.0);
            for contact in moving() {
                let stiffness = taxel(contact).stiffness;
                rises += stiffness * rise(contact);
                for (sum, change) in sum.iter_mut().zip(change(contact)) {
                    *sum += stiffness * change;
                }
            }
            sum.map(|sum| if rises > 0.0 { -sum / rises } else { 0.0 })
        }
    };
    for contact in moving() {
        let rise = rise(contact);
        let row = &mut changes[contact.taxel * N..][..N];
        for ((to, change), travel) in row.iter_mut().zip(change(contact)).zip(travel) {
            *to = change + rise * travel;
        }
    }
}
