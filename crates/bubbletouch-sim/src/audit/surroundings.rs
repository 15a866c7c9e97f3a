//! Taxels around each taxel: by rows and columns, or by the correlation of their readings.
//!
//! Contact covers several taxels, so that the readings of neighbouring taxels are correlated. In a list without rows and columns, the taxels with the largest
//! correlations therefore stand for the neighbours. Taxels without such a correlation, such as taxels that nothing touches, have no neighbours.

use ndarray::{Array2, ArrayView2, Axis, s};

/// Minimum correlation of neighbours in a list. If smaller, taxels that are rarely touched together count as neighbours; if larger, small contacts are missed.
const MIN_CORRELATION: f64 = 0.5;
/// Number of neighbours in a list, and the number of them that enclose a taxel if all of them are touched.
const N_AROUND: usize = 6;
const N_ENCLOSING: usize = 3;
/// Maximum number of frames from which correlations are computed. Their standard error is then 0.04.
const MAX_FRAMES: usize = 500;
/// Number of taxels whose correlations are computed together.
const BLOCK: usize = 256;

/// Taxels around each taxel.
#[derive(Clone, Debug, PartialEq)]
pub struct Surroundings {
    /// Neighbours of each taxel: up to eight on a grid, up to six in a list.
    pub around: Vec<Vec<usize>>,
    /// Sets of taxels that enclose each taxel: left and right, below and above, or the three most correlated taxels of a list. If all taxels of one set are
    /// touched, the taxel between them is usually touched, too.
    pub enclosing: Vec<Vec<Vec<usize>>>,
}

impl Surroundings {
    /// Returns the taxels around each taxel of a grid.
    pub fn of_grid((rows, columns): (usize, usize)) -> Self {
        let around = |at: usize, n: usize| at.saturating_sub(1)..(at + 2).min(n);
        let places = (0..rows * columns).map(|taxel| (taxel / columns, taxel % columns));
        let near = places.clone().map(|(y, x)| {
            let near = around(y, rows).flat_map(|y| around(x, columns).map(move |x| (y, x)));
            let near = near.filter(|&near| near != (y, x));
            near.map(|(y, x)| y * columns + x).collect()
        });
        let enclosing = places.map(|(y, x)| {
            let taxel = y * columns + x;
            let pairs = [
                (x > 0 && x + 1 < columns).then(|| vec![taxel - 1, taxel + 1]),
                (y > 0 && y + 1 < rows).then(|| vec![taxel - columns, taxel + columns]),
            ];
            pairs.into_iter().flatten().collect()
        });
        Self {
            around: near.collect(),
            enclosing: enclosing.collect(),
        }
    }

    /// Returns the taxels around each taxel of a list by the correlations of their readings; frames are rows.
    pub fn of_list(frames: ArrayView2<f64>) -> Self {
        let step = frames.nrows().div_ceil(MAX_FRAMES).max(1);
        let mut rows: Array2<f64> = frames.slice(s![..;step, ..]).to_owned();
        for mut readings in rows.columns_mut() {
            let mean = readings.mean().unwrap_or(0.0);
            readings -= mean;
            let norm = readings.dot(&readings).sqrt();
            readings.mapv_inplace(|x| if norm > 0.0 { x / norm } else { 0.0 });
        }
        let n_taxels = rows.ncols();
        let mut around = Vec::with_capacity(n_taxels);
        for start in (0..n_taxels).step_by(BLOCK) {
            let block = rows.slice(s![.., start..(start + BLOCK).min(n_taxels)]);
            let correlations: Array2<f64> = block.t().dot(&rows);
            for (place, correlations) in correlations.axis_iter(Axis(0)).enumerate() {
                let is_near = |&other: &usize| {
                    other != start + place && correlations[other] >= MIN_CORRELATION
                };
                let mut near: Vec<usize> = (0..n_taxels).filter(is_near).collect();
                near.sort_by(|&a, &b| correlations[b].total_cmp(&correlations[a]).then(a.cmp(&b)));
                near.truncate(N_AROUND);
                around.push(near);
            }
        }
        let enclosing = around.iter().map(|near: &Vec<usize>| {
            let first = near.get(..N_ENCLOSING).map(<[usize]>::to_vec);
            first.into_iter().collect()
        });
        Self {
            enclosing: enclosing.collect(),
            around,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;
    use rand::seq::SliceRandom;

    #[test]
    fn neighbours_of_a_shuffled_list_are_those_of_its_places() {
        assert_eq!(
            Surroundings::of_grid((3, 3)).around[4],
            [0, 1, 2, 3, 5, 6, 7, 8]
        );
        assert_eq!(Surroundings::of_grid((3, 3)).enclosing[4], [[3, 5], [1, 7]]);
        let mut rng = Seed::new(8).named("list").rng();
        let mut places: Vec<usize> = (0..30).collect();
        places.shuffle(&mut rng);
        let centres: Vec<f64> = (0..300).map(|_| rng.gen_range(0.0..29.0)).collect();
        let frames = Array2::from_shape_fn((300, 30), |(frame, taxel)| {
            (1.0 - (places[taxel] as f64 - centres[frame]).abs() / 4.0).max(0.0)
        });
        let found = Surroundings::of_list(frames.view());
        for (taxel, near) in found.around.iter().enumerate() {
            let away = |&other: &usize| places[other].abs_diff(places[taxel]);
            assert!(
                near.iter().take(2).all(|other| away(other) <= 2),
                "{near:?}"
            );
        }
        let still = Array2::zeros((40, 3));
        assert!(Surroundings::of_list(still.view()).around[0].is_empty());
    }
}
