//! Final state of a free object that can move only along the taxels' axis.

use super::system::{Drive, System};
use crate::contact::{Sample, crossing};

/// Final state of a free object that lies motionless on the taxels.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// Travel of the object, metres.
    pub travel: f64,
    /// Deflections of the taxels, metres, shape (n_taxels,).
    pub deflection: Vec<f64>,
    /// Force, newtons, that taxels at the end of their stroke carry in addition to their springs.
    pub stops: f64,
}

/// Returns the state in which the springs carry the weight of the object and of the balls on it. Taxels at the end of their stroke carry the remaining
/// weight. The travel is accurate to the last bit, as a reference for the integrators.
///
/// Returns `None` if the motion of the object is given in advance, or if the object meets no taxel.
pub fn rest(system: &System) -> Option<Rest> {
    let Drive::Free { mass, gravity, .. } = system.drive else {
        return None;
    };
    let floor = system.floor();
    if !floor.is_finite() {
        return None;
    }
    let pushed = |travel: f64| system.starts().iter().map(move |a| (travel - a).max(0.0));
    let carried = |travel: f64| {
        let mut carried = Sample {
            value: 0.0,
            slope: 0.0,
        };
        for (taxel, deflection) in pushed(travel).enumerate() {
            let stiffness = system.patch.taxels().at(taxel).stiffness;
            carried.value += stiffness * deflection;
            carried.slope += if deflection > 0.0 { stiffness } else { 0.0 };
        }
        carried
    };
    let weight = (mass + system.riders().iter().sum::<f64>()) * gravity;
    let first = system
        .starts()
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let travel = match carried(floor).value <= weight {
        true => floor,
        false => crossing([first, floor], (weight, -1.0), carried),
    };
    Some(Rest {
        travel,
        deflection: pushed(travel).collect(),
        stops: (weight - carried(travel).value).max(0.0),
    })
}
