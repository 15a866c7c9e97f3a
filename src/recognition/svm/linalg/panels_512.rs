//! Products with [packed rows](crate::recognition::svm::linalg::panels), sixteen values at a time.

use std::arch::x86_64::{_mm512_fmadd_ps, _mm512_set1_ps, _mm512_setzero_ps};

use super::panels::{DEPTH, LANES, PANEL_LANES, PANEL_ROWS, Panels, Wanted};
use crate::recognition::svm::linalg::vector_registers::{load, store};

/// Rows of a tile. With [`PANEL_LANES`], its sums fill 24 of 32 vector registers.
const TILE_ROWS: usize = 8;
/// Panels that the tiles of all rows meet before the next, times their features: 600 kB.
const PANEL_FEATURES_AT_ONCE: usize = 3 * DEPTH;

/// The products of so many rows with the rows of a panel.
type Tile<const ROWS: usize, const WIDTH: usize> = [[[f32; LANES]; WIDTH]; ROWS];

/// See [`Panels::multiply`].
#[target_feature(enable = "avx512f")]
pub(crate) fn multiply(panels: &Panels, left: &[&[f32]], wanted: Wanted, to: &mut [&mut [f32]]) {
    if panels.n_features == 0 {
        to.iter_mut().for_each(|row| row.fill(0.0));
    }
    let n_panels = panels.n_rows.div_ceil(PANEL_ROWS);
    for piece in panels.pieces() {
        let at_once = PANEL_FEATURES_AT_ONCE / piece.1;
        for first_panel in (0..n_panels).step_by(at_once) {
            for first in (0..to.len()).step_by(TILE_ROWS) {
                let n = TILE_ROWS.min(to.len() - first);
                let last_panel = match wanted {
                    Wanted::All => n_panels,
                    Wanted::UpToOwn => (first + n - 1) / PANEL_ROWS + 1,
                };
                let mut rows: [&[f32]; TILE_ROWS] = [&[]; TILE_ROWS];
                for at in 0..TILE_ROWS {
                    rows[at] = &left[first + at.min(n - 1)][piece.0..][..piece.1];
                }
                let to = &mut to[first..first + n];
                for panel in first_panel..last_panel.min(first_panel + at_once) {
                    let (start, width) = panels.place(panel, piece);
                    let values = &panels.values[start..][..width * piece.1];
                    let columns = (panel * PANEL_ROWS, piece.0 == 0);
                    // The last rows are few: less is computed for nothing.
                    match n {
                        1..=2 => write_tile::<2>(&rows, (values, width), to, columns),
                        3..=4 => write_tile::<4>(&rows, (values, width), to, columns),
                        _ => write_tile::<TILE_ROWS>(&rows, (values, width), to, columns),
                    }
                }
            }
        }
    }
}

/// Writes the products of a piece of a tile's first rows with a panel.
#[target_feature(enable = "avx512f")]
fn write_tile<const ROWS: usize>(
    rows: &[&[f32]; TILE_ROWS],
    (panel, width): (&[[f32; LANES]], usize),
    to: &mut [&mut [f32]],
    columns: (usize, bool),
) {
    match width {
        PANEL_LANES => put(tile::<ROWS, PANEL_LANES>(rows, panel), to, columns),
        2 => put(tile::<ROWS, 2>(rows, panel), to, columns),
        _ => put(tile::<ROWS, 1>(rows, panel), to, columns),
    }
}

/// The products of a piece of a tile's first rows with a panel that is so many registers wide.
///
/// Loops, not closures: a function of the standard library that calls a closure has not got its vector instructions.
#[target_feature(enable = "avx512f")]
fn tile<const ROWS: usize, const WIDTH: usize>(
    rows: &[&[f32]; TILE_ROWS],
    panel: &[[f32; LANES]],
) -> Tile<ROWS, WIDTH> {
    let panel = panel.as_chunks::<WIDTH>().0;
    let n = panel.len();
    let mut values: [&[f32]; ROWS] = [&[]; ROWS];
    for i in 0..ROWS {
        values[i] = &rows[i][..n];
    }
    let mut sums = [[_mm512_setzero_ps(); WIDTH]; ROWS];
    for at in 0..n {
        let mut own = [_mm512_setzero_ps(); WIDTH];
        for j in 0..WIDTH {
            own[j] = load(&panel[at][j]);
        }
        for i in 0..ROWS {
            let value = _mm512_set1_ps(values[i][at]);
            for j in 0..WIDTH {
                sums[i][j] = _mm512_fmadd_ps(value, own[j], sums[i][j]);
            }
        }
    }
    let mut tile = [[[0.0; LANES]; WIDTH]; ROWS];
    for i in 0..ROWS {
        for j in 0..WIDTH {
            tile[i][j] = store(sums[i][j]);
        }
    }
    tile
}

/// Writes a tile's products from a column on if they are the first piece's, else adds them.
#[target_feature(enable = "avx512f")]
fn put<const ROWS: usize, const WIDTH: usize>(
    tile: Tile<ROWS, WIDTH>,
    to: &mut [&mut [f32]],
    (column, is_first): (usize, bool),
) {
    for (to, tile) in to.iter_mut().zip(&tile) {
        let to = &mut to[column..];
        let n = to.len().min(WIDTH * LANES);
        let (to, from) = (&mut to[..n], &tile.as_flattened()[..n]);
        if is_first {
            to.copy_from_slice(from);
        } else {
            for at in 0..n {
                to[at] += from[at];
            }
        }
    }
}
