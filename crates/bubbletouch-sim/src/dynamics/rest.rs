//! Where a free object on its guide must end.

use super::system::{Drive, System};
use crate::contact::{Sample, crossing};

/// An object at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// x, metres.
    pub travel: f64,
    /// n_taxels, metres.
    pub deflection: Vec<f64>,
    /// What stops carry beside the springs, newtons.
    pub stops: f64,
}

/// Where the springs carry the weight of the object and of what is stacked on it, or the stops what they do not: found to the last bit, as a check of everything else.
///
/// `None` for an imposed motion, and where no taxel is in the way.
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
