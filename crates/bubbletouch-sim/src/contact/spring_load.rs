//! Loads of the springs of a skin patch: forces, torques, and centre of pressure.

use super::root_search::Sample;
use super::taxel_contact::TaxelContact;
use super::wrench::Wrench;
use crate::world::Patch;
use glam::DVec3;

/// Sum of the spring forces at some contacts, and the centre of pressure of these forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLoad {
    /// Force and torque of the taxels on the objects without friction. The force is Σ f n_c / (n_c·n) at the contact points, with spring force f, contact
    /// normal n_c and taxel axis n.
    pub on_object: Wrench,
    /// Sum of the spring forces (stiffness times deflection), N.
    pub spring_force: f64,
    /// Mean of the centres of the touched taxels (undeflected), weighted by the spring force; metres, in the patch frame. `None` if no taxel is touched.
    pub center_of_pressure: Option<DVec3>,
    /// Fraction of the spring force that saturated taxels carry, 0 to 1. The additional force at the end of their stroke is not counted.
    pub saturated_share: f64,
}

impl SpringLoad {
    /// Returns the force and torque on the patch, exactly opposite to the load on the objects.
    pub fn on_patch(&self) -> Wrench {
        -self.on_object
    }
}

/// Sum of the forces along the taxels' axes at some contacts, and the centre of pressure of these forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialLoad {
    /// Force and torque of the taxels on the objects without friction. The force is Σ f n_c / (n_c·n) at the contact points, with force f, contact normal n_c
    /// and taxel axis n.
    pub on_object: Wrench,
    /// Sum of the forces along the taxels' axes, N.
    pub force: f64,
    /// Mean of the centres of the touched taxels (undeflected), weighted by the force; metres, in the patch frame. `None` if the force is zero.
    pub center_of_pressure: Option<DVec3>,
}

/// Sums the forces along the taxels' axes over the contacts of a press; `force_of` returns the force of a contact, newtons.
///
/// # Panics
/// If the taxel of a contact does not exist in the patch.
pub fn axial_load<'a>(
    patch: &Patch,
    contacts: impl IntoIterator<Item = &'a TaxelContact>,
    mut force_of: impl FnMut(&TaxelContact) -> f64,
) -> AxialLoad {
    let mut on_object = Wrench::default();
    let (mut all, mut moment) = (0.0, DVec3::ZERO);
    for contact in contacts {
        let force = force_of(contact);
        on_object = on_object + contact.push(force);
        all += force;
        moment += force * patch.layout().centers()[contact.taxel];
    }
    AxialLoad {
        on_object,
        force: all,
        center_of_pressure: (all > 0.0).then(|| moment / all),
    }
}

/// Sums the spring forces over the given contacts of a press: all contacts, or the contacts of one object.
///
/// The force on an object is the negative gradient of the springs' energy Σ ½ k δ² with respect to the object's position in the patch frame. Exceptions are
/// saturated taxels, whose energy no longer changes, and grazing contacts, whose gradient is bounded. \[BT\]
///
/// # Panics
/// If the taxel of a contact does not exist in the patch.
pub fn spring_load<'a>(
    patch: &Patch,
    contacts: impl IntoIterator<Item = &'a TaxelContact>,
) -> SpringLoad {
    let mut saturated = 0.0;
    let load = axial_load(patch, contacts, |contact| {
        let taxel = patch.taxels().at(contact.taxel);
        let force = taxel.stiffness * contact.deflection;
        if contact.is_saturated(taxel) {
            saturated += force;
        }
        force
    });
    SpringLoad {
        on_object: load.on_object,
        spring_force: load.force,
        center_of_pressure: load.center_of_pressure,
        saturated_share: if load.force > 0.0 {
            saturated / load.force
        } else {
            0.0
        },
    }
}

/// Returns the total spring force, N, and its derivative, N/m, for a motion of some objects along `direction` (unit vector, patch frame). `moved` returns
/// whether an object moves.
pub(super) fn sample(
    patch: &Patch,
    contacts: &[TaxelContact],
    direction: DVec3,
    moved: impl Fn(usize) -> bool,
) -> Sample {
    let moved = contacts.iter().filter(|contact| moved(contact.object));
    let slopes = moved.map(|contact| {
        let taxel = patch.taxels().at(contact.taxel);
        match contact.is_saturated(taxel) {
            true => 0.0,
            false => taxel.stiffness * contact.gradient().dot(direction),
        }
    });
    Sample {
        slope: slopes.sum(),
        value: spring_load(patch, contacts).spring_force,
    }
}
