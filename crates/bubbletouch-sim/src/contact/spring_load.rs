//! Loads of the springs of a skin patch: forces, torques, and centre of pressure.

use super::root_search::Sample;
use super::taxel_contact::TaxelContact;
use super::wrench::Wrench;
use crate::world::Patch;
use glam::DVec3;

/// Sum of the spring forces at some contacts, and their centre of pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLoad {
    /// Load on the objects without friction: Σ k δ n_c / (n_c·n) at the contact points.
    pub on_object: Wrench,
    /// Sum of the taxels' readings, Σ k δ, N.
    pub spring_force: f64,
    /// Mean rest centre of the touched taxels, weighted by k δ; metres, in the patch frame. `None` if none is touched.
    pub center_of_pressure: Option<DVec3>,
    /// Fraction of the spring force that saturated taxels carry, 0 to 1. The additional force of their stops is not counted.
    pub saturated_share: f64,
}

impl SpringLoad {
    /// Returns the load on the patch, exactly opposite to the load on the objects.
    pub fn on_patch(&self) -> Wrench {
        -self.on_object
    }
}

/// Sum of forces along the taxels' axes at some contacts, and their centre of pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialLoad {
    /// Load on the objects without friction: Σ f n_c / (n_c·n) at the contact points.
    pub on_object: Wrench,
    /// Sum of the forces Σ f, N.
    pub force: f64,
    /// Mean rest centre of the touched taxels, weighted by f; metres, in the patch frame. `None` if the force is zero.
    pub center_of_pressure: Option<DVec3>,
}

/// Sums forces along the taxels' axes over the contacts of a press; `force_of` returns the force of a contact, newtons.
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

/// Sums the spring forces over the given contacts of a press: all contacts, or those with one object.
///
/// The force on an object is −∇ Σ ½ k δ² with respect to the object's position in the patch frame. Exceptions are saturated taxels, whose energy no longer
/// changes, and grazing contacts, whose gradient is bounded. \[BT\]
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

/// Returns the force Σ k δ, N, and its derivative, N/m, while the objects selected by `moved` move along a direction (unit vector in the patch frame).
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
