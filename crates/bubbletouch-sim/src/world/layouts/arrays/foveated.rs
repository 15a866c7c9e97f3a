//! Foveated grid: rows and columns that are closest in the middle.
//!
//! Let u and v from −1 to 1 be the coordinates of a taxel in the square grid, divided by half the side. The taxel is at the same half side times
//! (u (1 + u²) / 2, v (1 + v²) / 2). Rows and columns are half a pitch apart in the middle and two pitches apart at the edge. The middle therefore has
//! four times the density of the grid. The number of taxels and the side equal the values of the grid.

use super::about::LayoutAbout;
use crate::world::Layout;
use glam::DVec3;

pub const ABOUT: LayoutAbout = LayoutAbout {
    sides: |grid| Some(grid.shape()),
    widest_pitches: 2.0,
    ..LayoutAbout::new("foveated grid", |grid, _| {
        let place = |index: usize, n: usize| {
            let u = (2 * index + 1) as f64 / n as f64 - 1.0;
            0.5 * n as f64 * grid.pitch * warped(u)
        };
        let row = |y: usize| (0..grid.nx).map(move |x| (x, y));
        let taxels = (0..grid.ny).flat_map(row).map(|(x, y)| {
            let center = DVec3::new(place(x, grid.nx), place(y, grid.ny), 0.0);
            (center, DVec3::Z)
        });
        Ok(Layout::of_taxels(taxels))
    })
};

/// Returns the coordinate in the foveated grid, −1 to 1, of a coordinate u in the square grid.
fn warped(u: f64) -> f64 {
    0.5 * u * (1.0 + u * u)
}

#[cfg(test)]
mod tests {
    use crate::world::ArrayLayout;
    use crate::world::fixtures::grid;

    #[test]
    fn columns_are_half_a_pitch_apart_in_the_middle_and_two_at_the_edge() {
        let (n, pitch) = (400, 2e-3);
        let grid = grid(n, n, pitch);
        let layout = ArrayLayout::Foveated.taxels(&grid, 0.0).unwrap();
        let x = |column: usize| layout.centers()[column].x;
        let step = |column: usize| (x(column + 1) - x(column)) / pitch;
        assert!((step(n / 2 - 1) - 0.5).abs() < 1e-4);
        assert!((step(n - 2) - 2.0).abs() < 0.02);
        assert!((1..n - 1).all(|column| (step(column) > step(column - 1)) == (column >= n / 2)));
        // The outermost columns are within the side of the grid, and the array is symmetric.
        assert!(x(n - 1) < 0.5 * n as f64 * pitch && (x(n - 1) + x(0)).abs() < 1e-12);
        // Rows are spaced as columns.
        assert_eq!(layout.centers()[n * 7].y, x(7));
    }
}
