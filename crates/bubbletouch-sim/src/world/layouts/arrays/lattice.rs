//! Hexagonal lattices with one taxel per square of side pitch.

use crate::world::ImageShape;

/// Distance between neighbouring taxels in a hexagonal lattice with one taxel per unit area: √(2/√3).
pub const NEIGHBOUR: f64 = 1.074_569_931_823_542;

/// Distance between rows of a hexagonal lattice with one taxel per unit area: [`NEIGHBOUR`] · √3/2.
const ROWS: f64 = 0.930_604_859_102_1;

/// Returns the numbers of rows and columns of a hexagonal lattice on the area of n × n pitches.
pub fn sides(n: usize) -> ImageShape {
    let side = |step: f64| (n as f64 / step).round().max(1.0) as usize;
    ImageShape {
        ny: side(ROWS),
        nx: side(NEIGHBOUR),
    }
}
