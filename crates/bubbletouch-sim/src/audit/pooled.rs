//! Reduced representation of a touch for a cheap classifier: means over blocks of taxels and spans of frames.

use crate::random::Seed;
use ndarray::{Array2, ArrayView2, s};
use rand::Rng;

/// Maximum number of spans into which the frames of a touch are divided.
const MAX_SPANS: usize = 8;

/// Averages the frames of each touch over at most eight spans of time and over blocks of taxels. Returns an array of shape (n_touches, n_values) with n_values
/// ≤ `max_values`. Blocks are squares on a grid of taxels. Many taxels without a grid are projected by random signs, which keeps distances.
///
/// # Panics
/// If the number of frames is no multiple of `n_frames`, or a frame has other taxels than the grid.
pub fn pooled(
    frames: ArrayView2<f64>,
    n_frames: usize,
    grid: Option<(usize, usize)>,
    max_values: usize,
) -> Array2<f64> {
    let n_spans = n_frames.min(MAX_SPANS).min(max_values);
    let spans = spans(frames, n_frames, n_spans);
    let n_taxels = frames.ncols();
    let max_blocks = (max_values / n_spans).max(1);
    let blocks = match grid {
        _ if n_taxels <= max_blocks => spans,
        Some(grid) => means_of_blocks(&spans, grid, max_blocks),
        None => spans.dot(&signs(n_taxels, max_blocks)),
    };
    let width = n_spans * blocks.ncols();
    let shape = (frames.nrows() / n_frames, width);
    let rows = blocks.into_shape_with_order(shape);
    rows.expect("whole touches")
}

/// Returns the means of `n_spans` spans of the frames of each touch, one span per row.
pub fn spans(frames: ArrayView2<f64>, n_frames: usize, n_spans: usize) -> Array2<f64> {
    if n_spans == n_frames {
        return frames.to_owned();
    }
    let n_touches = frames.nrows() / n_frames;
    let mut spans = Array2::zeros((n_touches * n_spans, frames.ncols()));
    for touch in 0..n_touches {
        for span in 0..n_spans {
            let bound = |span: usize| touch * n_frames + span * n_frames / n_spans;
            let own = bound(span)..bound(span + 1);
            let factor = 1.0 / own.len() as f64;
            let mut mean = spans.row_mut(touch * n_spans + span);
            for frame in own {
                mean.scaled_add(factor, &frames.row(frame));
            }
        }
    }
    spans
}

/// Returns the sides (rows, columns) and the edge of the smallest square blocks of a grid of which there are at most `max_blocks`.
fn blocks_of((rows, columns): (usize, usize), max_blocks: usize) -> ((usize, usize), usize) {
    let sides = |edge: usize| (rows.div_ceil(edge), columns.div_ceil(edge));
    let is_small = |edge: &usize| sides(*edge).0 * sides(*edge).1 <= max_blocks;
    let edge = (1..=rows.max(columns)).find(is_small).unwrap_or(1);
    (sides(edge), edge)
}

fn means_of_blocks(
    frames: &Array2<f64>,
    (rows, columns): (usize, usize),
    max_blocks: usize,
) -> Array2<f64> {
    let ((n_down, n_across), edge) = blocks_of((rows, columns), max_blocks);
    let mut means = Array2::zeros((frames.nrows(), n_down * n_across));
    let end = |block: usize, side: usize| ((block + 1) * edge).min(side);
    for (frame, mut means) in frames.rows().into_iter().zip(means.rows_mut()) {
        for down in 0..n_down {
            for y in down * edge..end(down, rows) {
                let row = frame.slice(s![y * columns..(y + 1) * columns]);
                for across in 0..n_across {
                    let taxels = row.slice(s![across * edge..end(across, columns)]);
                    means[down * n_across + across] += taxels.sum();
                }
            }
            for across in 0..n_across {
                let n_down = end(down, rows) - down * edge;
                let n_taxels = n_down * (end(across, columns) - across * edge);
                means[down * n_across + across] /= n_taxels as f64;
            }
        }
    }
    means
}

/// Returns a matrix of random signs divided by the root of the number of rows.
fn signs(n_taxels: usize, n_values: usize) -> Array2<f64> {
    let mut rng = Seed::new(0).named("audit signs").rng();
    let one = 1.0 / (n_taxels as f64).sqrt();
    Array2::from_shape_simple_fn((n_taxels, n_values), || {
        if rng.r#gen::<bool>() { one } else { -one }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_and_spans_are_means() {
        let frames = Array2::from_shape_fn((6, 12), |(frame, taxel)| (100 * frame + taxel) as f64);
        // Two touches of three frames of 3 × 4 taxels; blocks of 2 × 2, of which the lower ones have a single row.
        let found = pooled(frames.view(), 3, Some((3, 4)), 12);
        assert_eq!(found.dim(), (2, 12));
        assert_eq!(found[(0, 0)], (1 + 4 + 5) as f64 / 4.0);
        assert_eq!(found[(0, 3)], 10.5);
        assert_eq!(found[(1, 4)], 400.0 + 2.5);
        let spans = spans(frames.view(), 3, 2);
        assert_eq!(spans.row(0), frames.row(0));
        assert_eq!(spans[(1, 0)], 150.0);
        assert_eq!(pooled(frames.view(), 1, None, 5).dim(), (6, 5));
    }
}
