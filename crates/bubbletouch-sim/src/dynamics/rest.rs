//! Where a free object on its guide must end.

use super::system::{Drive, System};

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

/// Where the springs carry the weight of the object and of what is stacked on it, or the stops what they do not: found by halving, as a check of everything else.
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
    let carried = |travel: f64| -> f64 {
        let taxels = system.patch.taxels();
        let springs = pushed(travel).enumerate();
        springs
            .map(|(taxel, d)| taxels.at(taxel).stiffness * d)
            .sum()
    };
    let weight = (mass + system.riders().iter().sum::<f64>()) * gravity;
    let first = system
        .starts()
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    let (mut low, mut high) = (first, floor);
    if carried(floor) <= weight {
        low = floor;
    }
    // Until the middle is one of the ends: no two numbers are nearer.
    while low < 0.5 * (low + high) && 0.5 * (low + high) < high {
        let middle = 0.5 * (low + high);
        match carried(middle) < weight {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(Rest {
        travel: high,
        deflection: pushed(high).collect(),
        stops: (weight - carried(high)).max(0.0),
    })
}
