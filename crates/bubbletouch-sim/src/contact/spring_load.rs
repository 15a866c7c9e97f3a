//! What the springs of a skin patch carry: forces, torques, and where.

use super::root_search::Sample;
use super::taxel_contact::TaxelContact;
use super::wrench::Wrench;
use crate::world::Patch;
use glam::DVec3;

/// What the springs of some contacts carry together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLoad {
    /// On the objects: Σ k δ n_c / (n_c·n) at the points where they touch, without friction.
    pub on_object: Wrench,
    /// Σ k δ, N: what the taxels read together.
    pub spring_force: f64,
    /// The mean rest centre of the touched taxels, weighted by k δ; metres, in the patch frame. `None` if none is touched.
    pub center_of_pressure: Option<DVec3>,
    /// The share of the spring force that saturated taxels carry, 0 to 1. Their stops carry more, which is not counted.
    pub saturated_share: f64,
}

impl SpringLoad {
    /// On the patch: exactly the opposite of what is on the objects.
    pub fn on_patch(&self) -> Wrench {
        -self.on_object
    }
}

/// What forces along the axes of some contacts are together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialLoad {
    /// On the objects, without friction: Σ f n_c / (n_c·n) at the points where they touch.
    pub on_object: Wrench,
    /// Σ f, N.
    pub force: f64,
    /// The mean rest centre of the touched taxels, weighted by f; metres, in the patch frame. `None` if there is no force.
    pub center_of_pressure: Option<DVec3>,
}

/// Adds up forces along the axes (newtons, `force_of` each contact) from a press of this patch.
///
/// # Panics
/// If a contact has a taxel that the patch does not have.
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

/// Adds up the springs of contacts from a press of this patch: of all, or of those with one object.
///
/// The force on an object is −∇ Σ ½ k δ² for its motion in the patch frame, but for saturated taxels (whose energy is at its
/// end) and grazing ones (whose gradient is bounded). \[BT\]
///
/// # Panics
/// If a contact has a taxel that the patch does not have.
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

/// Σ k δ of contacts in N, and its slope in N/m as those objects whose number is `moved` go along a direction (unit, in the patch frame).
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
