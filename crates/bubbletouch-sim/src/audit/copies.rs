//! Copies: two or three rows that are far nearer to each other than to the next rows.
//!
//! Near a row, the volume V within the distance d of its neighbours grows as dᴰ, where D is the dimension of the data. For independent rows V₁/V₂ is uniform, and
//! V₂/V₃ has the distribution function x². The probability that a pair is as isolated by chance is therefore (d_in/d_out)ᴰ, and that of a triple the square of
//! this, where d_in is the largest distance within the set and d_out the smallest distance to another row.

use crate::statistics::quantile::quantile;

/// Largest dimension with which distances are converted to probabilities. With more, two touches of one pose that each have noise count as copies; with less,
/// copies with noise are not found.
const MAX_DIMENSION: f64 = 8.0;
/// Number of nearest rows that the search needs; the dimension follows from the fourth and the last of them.
pub const N_NEAREST: usize = 10;
/// Place of the first neighbour from which the dimension follows: the first one outside sets of three copies.
const FIRST: usize = 3;

/// Two or three rows that may be copies.
#[derive(Clone, Debug, PartialEq)]
pub struct CopySet {
    /// Rows, in ascending order.
    pub rows: Vec<usize>,
    /// Probability that independent rows are as isolated, times the number of examined sets (Bonferroni).
    pub p_value: f64,
}

/// Finds isolated sets of two or three rows. `neighbours` and `distances` are those of the 10 nearest rows of each row, nearest first. `sizes` contains the
/// distance of each row from a touch without contact; rows that are about as near to each other as to this touch are no copies. `step` is the smallest
/// distance that the resolution of the readings allows.
pub fn copy_sets(
    neighbours: &[Vec<usize>],
    distances: &[Vec<f64>],
    sizes: &[f64],
    step: f64,
) -> Vec<CopySet> {
    let n = neighbours.len();
    if n < 2 * N_NEAREST || distances.iter().any(|own| own.len() < N_NEAREST) {
        return Vec::new();
    }
    // The number of rows within a distance grows from 4 to 10 between these neighbours.
    let growth = (N_NEAREST as f64 / (FIRST + 1) as f64).ln();
    let of_row = |own: &Vec<f64>| growth / (own[N_NEAREST - 1] / own[FIRST]).ln();
    let dimensions = distances.iter().map(of_row).filter(|d| d.is_finite());
    let dimension = quantile(&mut dimensions.collect::<Vec<_>>(), 0.5).clamp(1.0, MAX_DIMENSION);
    let mut sets = Vec::new();
    for row in 0..n {
        for n_others in [1, 2] {
            let mut rows = neighbours[row][..n_others].to_vec();
            rows.push(row);
            rows.sort_unstable();
            // Each set is examined from its first row, and all of its rows must name the same set.
            let is_mutual = rows[0] == row
                && rows.iter().all(|&own| {
                    neighbours[own][..n_others]
                        .iter()
                        .all(|other| rows.contains(other))
                });
            if !is_mutual {
                continue;
            }
            let inner = rows.iter().map(|&own| distances[own][n_others - 1]);
            let inner = inner.fold(0.0, f64::max) + step;
            let outer = rows.iter().map(|&own| distances[own][n_others]);
            let outer = outer.fold(f64::INFINITY, f64::min);
            if outer <= inner || rows.iter().any(|&own| sizes[own] < 4.0 * inner) {
                continue;
            }
            let p_value = (inner / outer).powf(dimension * n_others as f64);
            sets.push(CopySet {
                rows,
                p_value: (2.0 * n as f64 * p_value).min(1.0),
            });
        }
    }
    // A pair within a triple belongs to the triple if both are isolated.
    sets.sort_by(|a, b| b.rows.len().cmp(&a.rows.len()).then(a.rows.cmp(&b.rows)));
    sets
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;
    use rand_distr::StandardNormal;

    /// Returns the sets that are isolated at the level 0.01, of 200 normal rows of `d` numbers of which the first `n` are copied `times` times with noise.
    fn found(d: usize, (n, times): (usize, usize), noise: f64) -> Vec<CopySet> {
        let mut rng = Seed::new(4).named("copies").rng();
        let mut normal = || rng.sample::<f64, _>(StandardNormal);
        let mut rows: Vec<Vec<f64>> = (0..200)
            .map(|_| (0..d).map(|_| normal()).collect())
            .collect();
        for row in 0..n * times {
            let copy = rows[row % n].iter().map(|x| x + noise * normal()).collect();
            rows.push(copy);
        }
        let distance = |a: &[f64], b: &[f64]| {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
            squares.sum::<f64>().sqrt()
        };
        let nearest = rows.iter().enumerate().map(|(row, own)| {
            let others = rows.iter().enumerate().filter(|(other, _)| *other != row);
            let mut near: Vec<(f64, usize)> = others
                .map(|(other, of)| (distance(own, of), other))
                .collect();
            near.sort_by(|a, b| a.0.total_cmp(&b.0));
            near.truncate(N_NEAREST);
            near
        });
        let nearest: Vec<_> = nearest.collect();
        let neighbours: Vec<Vec<usize>> = nearest
            .iter()
            .map(|near| near.iter().map(|near| near.1).collect())
            .collect();
        let distances: Vec<Vec<f64>> = nearest
            .iter()
            .map(|near| near.iter().map(|near| near.0).collect())
            .collect();
        let sizes = vec![100.0; rows.len()];
        let mut sets = copy_sets(&neighbours, &distances, &sizes, 0.0);
        sets.retain(|set| set.p_value <= 0.01);
        sets
    }

    #[test]
    fn copies_are_found_as_sets_of_two_or_three_and_independent_rows_are_none() {
        for d in [3, 8, 40] {
            assert_eq!(found(d, (0, 0), 0.0), []);
            for times in [1, 2] {
                let sets = found(d, (12, times), 1e-3);
                let whole: Vec<&CopySet> = sets
                    .iter()
                    .filter(|set| set.rows.len() == times + 1)
                    .collect();
                assert_eq!(whole.len(), 12, "{d} {times}");
                let origin = |row: usize| if row < 200 { row } else { (row - 200) % 12 };
                for set in whole {
                    assert!(set.rows.iter().all(|&row| origin(row) == set.rows[0]));
                }
            }
            // All rows are copied.
            assert!(found(d, (200, 1), 1e-3).len() > 190, "{d}");
        }
    }
}
