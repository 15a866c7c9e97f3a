//! Hexagonal lattices with one taxel per square of a pitch.

/// Distance between neighbours in a lattice with one taxel per unit area: √(2/√3).
pub const NEIGHBOUR: f64 = 1.074_569_931_823_542;

/// Distance between rows of this lattice: [`NEIGHBOUR`] · √3/2.
const ROWS: f64 = 0.930_604_859_102_1;

/// Returns the numbers of rows and columns on the area of n × n pitches.
pub fn sides(n: usize) -> (usize, usize) {
    let side = |step: f64| (n as f64 / step).round().max(1.0) as usize;
    (side(ROWS), side(NEIGHBOUR))
}
