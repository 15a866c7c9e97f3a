//! Averages over blocks of neighbouring taxels.

use super::ensemble::{EnsembleAbout, Operator};
use crate::world::ImageShape;
use ndarray::{Array1, Array2, ArrayView2, ArrayViewMut2, s};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

/// Rectangular block of taxels in a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Block {
    /// Range of grid rows, along patch y.
    pub rows: Range<usize>,
    /// Range of grid columns, along patch x.
    pub columns: Range<usize>,
}

impl Block {
    pub(super) fn area(&self) -> usize {
        self.rows.len() * self.columns.len()
    }

    /// Returns the range of taxel indices of each row of the block, in an array with nx columns.
    pub(super) fn lines(&self, nx: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        let columns = &self.columns;
        let line = move |row: usize| row * nx + columns.start..row * nx + columns.end;
        self.rows.clone().map(line)
    }

    /// Returns the two halves of a block along its longer side (along rows if the sides are equal); the first half is not smaller.
    pub(super) fn halves(self) -> [Self; 2] {
        let half = |range: &Range<usize>| range.start + range.len().div_ceil(2);
        if self.rows.len() >= self.columns.len() {
            let middle = half(&self.rows);
            let columns = self.columns.clone();
            [(self.rows.start..middle), (middle..self.rows.end)].map(|rows| Self {
                rows,
                columns: columns.clone(),
            })
        } else {
            let middle = half(&self.columns);
            let rows = self.rows.clone();
            [(self.columns.start..middle), (middle..self.columns.end)].map(|columns| Self {
                rows: rows.clone(),
                columns,
            })
        }
    }
}

/// Divides an ny × nx array into m blocks, ordered row by row by the first taxel of each block.
fn blocks(grid: ImageShape, m: usize) -> Vec<Block> {
    let equal = equal_squares(grid, m).or_else(|| equal_halves(grid, m));
    let mut blocks = equal.unwrap_or_else(|| rows_of_blocks(grid, m));
    blocks.sort_by_key(|block| (block.rows.start, block.columns.start));
    blocks
}

/// Returns m squares of equal size that tile the array; `None` if no such tiling exists.
fn equal_squares(ImageShape { ny, nx }: ImageShape, m: usize) -> Option<Vec<Block>> {
    let side = (ny * nx / m).isqrt();
    let tiles = side * side * m == ny * nx && ny % side == 0 && nx % side == 0;
    let range = |tile: usize| tile * side..(tile + 1) * side;
    tiles.then(|| {
        (0..ny / side)
            .flat_map(|row| (0..nx / side).map(move |column| (row, column)))
            .map(|(row, column)| Block {
                rows: range(row),
                columns: range(column),
            })
            .collect()
    })
}

/// Returns m blocks of equal size, obtained by repeated halving of the array; `None` if the blocks would differ in size.
fn equal_halves(grid: ImageShape, m: usize) -> Option<Vec<Block>> {
    let blocks = split_blocks(grid, m);
    let area = blocks[0].area();
    let is_equal = blocks.iter().all(|block| block.area() == area);
    is_equal.then_some(blocks)
}

/// Divides the array into m nearly square blocks, arranged in rows with about equally many blocks.
fn rows_of_blocks(ImageShape { ny, nx }: ImageShape, m: usize) -> Vec<Block> {
    let square = (m as f64 * ny as f64 / nx as f64).sqrt().round() as usize;
    let n_rows = square.clamp(m.div_ceil(nx), ny.min(m));
    // The k-th of n parts of a length.
    let part = |k: usize, n: usize, length: usize| k * length / n..(k + 1) * length / n;
    let rows = (0..n_rows).flat_map(|row| {
        let n_columns = part(row, n_rows, m).len();
        (0..n_columns).map(move |column| Block {
            rows: part(row, n_rows, ny),
            columns: part(column, n_columns, nx),
        })
    });
    rows.collect()
}

/// Divides the array into m blocks by repeated halving of the largest block (the oldest among equally large blocks).
pub(super) fn split_blocks(ImageShape { ny, nx }: ImageShape, m: usize) -> Vec<Block> {
    let whole = Block {
        rows: 0..ny,
        columns: 0..nx,
    };
    let mut blocks = vec![whole];
    let mut largest_first = BinaryHeap::from([(ny * nx, Reverse(0), 0)]);
    let mut age = 0;
    while blocks.len() < m {
        let Some((_, _, index)) = largest_first.pop() else {
            break;
        };
        let [first, second] = blocks[index].clone().halves();
        let other = blocks.len();
        for (block, index) in [(&first, index), (&second, other)] {
            age += 1;
            largest_first.push((block.area(), Reverse(age), index));
        }
        blocks[index] = first;
        blocks.push(second);
    }
    blocks
}

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    is_prefix_nested: false,
    needs_rows: true,
    ..EnsembleAbout::new("block average", |grid, m, _| {
        Box::new(Blocks(blocks(grid, m)))
    })
};

/// Blocks of taxels whose means are the measurements, one block per measurement.
#[derive(Debug)]
struct Blocks(Vec<Block>);

impl Blocks {
    /// Returns the number of columns of the array that the blocks tile.
    fn width(&self) -> usize {
        self.0.iter().map(|b| b.columns.end).max().unwrap_or(1)
    }

    /// Returns the squared norm of each row of the averaging matrix; the rows are orthogonal.
    fn row_squares(&self) -> Array1<f64> {
        let squares = self.0.iter().map(|block| 1.0 / block.area() as f64);
        squares.collect()
    }
}

impl Operator for Blocks {
    fn measure(&self, frames: ArrayView2<f64>, mut out: ArrayViewMut2<f64>) {
        let nx = self.width();
        for (frame, mut row) in frames.outer_iter().zip(out.outer_iter_mut()) {
            for (y, block) in row.iter_mut().zip(&self.0) {
                let mut sum = 0.0;
                for taxels in block.lines(nx) {
                    sum += match frame.as_slice() {
                        Some(frame) => frame[taxels].iter().sum::<f64>(),
                        None => frame.slice(s![taxels]).iter().sum::<f64>(),
                    };
                }
                *y = sum / block.area() as f64;
            }
        }
    }

    fn each_entry(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let nx = self.width();
        for (measurement, block) in self.0.iter().enumerate() {
            for taxel in block.lines(nx).flatten() {
                visit(measurement, taxel, 1.0 / block.area() as f64);
            }
        }
    }

    fn row_norm(&self) -> f64 {
        self.row_squares().mean().unwrap_or(1.0).sqrt()
    }

    fn known_gram(&self) -> Option<Array2<f64>> {
        Some(Array2::from_diag(&self.row_squares()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_blocks_covers_every_taxel_once() {
        for grid in [(1, 1), (1, 9), (7, 3), (8, 8), (5, 12)].map(|(ny, nx)| ImageShape { ny, nx })
        {
            for m in 1..=grid.n_values() {
                let blocks = blocks(grid, m);
                assert_eq!(blocks.len(), m);
                let taxels = blocks
                    .iter()
                    .flat_map(|block| block.lines(grid.nx).flatten());
                let mut taxels: Vec<usize> = taxels.collect();
                taxels.sort_unstable();
                assert!(taxels.into_iter().eq(0..grid.n_values()), "{grid:?}, {m}");
            }
        }
    }

    #[test]
    fn blocks_are_equal_squares_where_the_array_allows() {
        for (grid, m, side) in [
            (ImageShape { ny: 64, nx: 64 }, 1024, 2),
            (ImageShape { ny: 64, nx: 64 }, 256, 4),
            (ImageShape { ny: 64, nx: 64 }, 64, 8),
            (ImageShape { ny: 40, nx: 40 }, 100, 4),
            (ImageShape { ny: 32, nx: 64 }, 128, 4),
            (ImageShape { ny: 9, nx: 6 }, 6, 3),
            (ImageShape { ny: 5, nx: 5 }, 25, 1),
        ] {
            for block in blocks(grid, m) {
                assert_eq!((block.rows.len(), block.columns.len()), (side, side));
            }
        }
    }

    #[test]
    fn blocks_are_nearly_square_where_they_cannot_be_equal() {
        for (grid, m) in [
            (ImageShape { ny: 28, nx: 50 }, 88),
            (ImageShape { ny: 28, nx: 50 }, 22),
            (ImageShape { ny: 31, nx: 31 }, 100),
            (ImageShape { ny: 10, nx: 60 }, 37),
        ] {
            let side = (grid.ny as f64 * grid.nx as f64 / m as f64).sqrt();
            for block in blocks(grid, m) {
                let sides = [block.rows.len(), block.columns.len()].map(|n| n as f64 / side);
                assert!(
                    sides.iter().all(|ratio| (0.6..1.6).contains(ratio)),
                    "{grid:?}, {m}: {block:?}"
                );
            }
        }
    }

    #[test]
    fn splitting_meets_the_equal_squares_of_powers_of_two() {
        for m in [1, 4, 16, 64, 256] {
            let mut split = split_blocks(ImageShape { ny: 16, nx: 16 }, m);
            split.sort_by_key(|block| (block.rows.start, block.columns.start));
            assert_eq!(Some(split), equal_squares(ImageShape { ny: 16, nx: 16 }, m));
        }
    }

    #[test]
    fn a_smaller_number_of_blocks_is_a_coarsening_of_a_larger() {
        let inside = |inner: &Block, outer: &Block| {
            outer.rows.start <= inner.rows.start
                && inner.rows.end <= outer.rows.end
                && outer.columns.start <= inner.columns.start
                && inner.columns.end <= outer.columns.end
        };
        for (coarse, fine) in [(1, 5), (5, 6), (6, 17), (17, 64), (30, 31)] {
            let coarse = split_blocks(ImageShape { ny: 11, nx: 7 }, coarse);
            for cell in split_blocks(ImageShape { ny: 11, nx: 7 }, fine) {
                assert_eq!(coarse.iter().filter(|c| inside(&cell, c)).count(), 1);
            }
        }
    }
}
