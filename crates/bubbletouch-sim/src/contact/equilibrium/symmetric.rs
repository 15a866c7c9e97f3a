//! Symmetric matrices over the motions of several bodies, and the minimum of a quadratic model in a ball (trust region).

/// Motion of one body, or a derivative with respect to this motion: three translations and three rotations.
pub(super) type Six = [f64; 6];

/// Returns the dot product of two slices, with independent partial sums that vector instructions add in parallel.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (a, rest_of_a) = a[..n].as_chunks::<4>();
    let (b, rest_of_b) = b[..n].as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a.iter().zip(b) {
        for k in 0..4 {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = rest_of_a.iter().zip(rest_of_b).map(|(x, y)| x * y).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Symmetric matrix with n rows and columns.
#[derive(Clone, Debug, Default)]
pub(super) struct Symmetric {
    n: usize,
    entries: Vec<f64>,
}

/// Cholesky factor L of a symmetric matrix `L Lᵀ`: lower triangular, stored row by row.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    n: usize,
    rows: Vec<f64>,
}

impl Symmetric {
    /// Resizes the matrix to n rows and columns of zeros.
    pub fn clear(&mut self, n: usize) {
        self.n = n;
        self.entries.clear();
        self.entries.resize(n * n, 0.0);
    }

    pub fn n(&self) -> usize {
        self.n
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.n..][..self.n]
    }

    /// Returns the stored entries of row `i`, beginning at column `first`.
    pub fn part_mut(&mut self, i: usize, first: usize) -> &mut [f64] {
        &mut self.entries[i * self.n..][first..self.n]
    }

    /// Adds `factor · x yᵀ` to the 6 × 6 block with the rows of body `a` and the columns of body `b`.
    pub fn add_block(&mut self, [a, b]: [usize; 2], factor: f64, x: &Six, y: &Six) {
        for (i, x) in x.iter().enumerate() {
            let row = &mut self.part_mut(6 * a + i, 6 * b)[..6];
            for (entry, y) in row.iter_mut().zip(y) {
                *entry += factor * x * y;
            }
        }
    }

    /// Returns whether all eigenvalues of the matrix are above 0, to rounding accuracy.
    pub fn is_convex(&self) -> bool {
        self.factor(1e-9 * self.size()).is_some()
    }

    pub fn times(&self, v: &[f64]) -> Vec<f64> {
        (0..self.n).map(|i| dot(self.row(i), v)).collect()
    }

    /// Returns an upper bound of the absolute eigenvalues of the matrix.
    pub fn size(&self) -> f64 {
        let rows = (0..self.n).map(|i| self.row(i).iter().map(|x| x.abs()).sum());
        rows.fold(0.0, f64::max)
    }

    /// Returns the Cholesky factor of the matrix with `shift` added to the diagonal; `None` if the shifted matrix is not positive definite. Leading zeros of
    /// a row are preserved and skipped, so bodies that do not touch cost nothing.
    pub fn factor(&self, shift: f64) -> Option<Factor> {
        let n = self.n;
        let mut rows = self.entries.clone();
        let mut first = vec![0; n];
        for i in 0..n {
            let (above, row) = rows.split_at_mut(i * n);
            let mut from = 0;
            while from < i && row[from] == 0.0 {
                from += 1;
            }
            first[i] = from;
            for j in from..i {
                let other = &above[j * n..][..n];
                let both = from.max(first[j]).min(j);
                row[j] = (row[j] - dot(&row[both..j], &other[both..j])) / other[j];
            }
            let left = row[i] + shift - dot(&row[from..i], &row[from..i]);
            // The condition is also false for NaN.
            if !(left > 0.0 && left.is_finite()) {
                return None;
            }
            row[i] = left.sqrt();
        }
        Some(Factor { n, rows })
    }
}

impl Factor {
    fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.n..][..self.n]
    }

    /// Returns the solution z of `L z = b`, where L is this Cholesky factor.
    fn forward(&self, b: &[f64]) -> Vec<f64> {
        let mut z = b.to_vec();
        for i in 0..self.n {
            let row = self.row(i);
            z[i] = (z[i] - dot(&row[..i], &z[..i])) / row[i];
        }
        z
    }

    /// Returns the solution x of `L Lᵀ x = b`, where L is this Cholesky factor.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = self.forward(b);
        for i in (0..self.n).rev() {
            let row = self.row(i);
            x[i] /= row[i];
            for j in 0..i {
                x[j] -= row[j] * x[i];
            }
        }
        x
    }

    /// Returns an approximate eigenvector of length 1 for the lowest eigenvalue of the factorised matrix, by inverse iteration.
    fn weakest(&self) -> Vec<f64> {
        /// Number of inverse iterations. The shift is within a hundredth of the eigenvalue, so each iteration gains two digits; if two eigenvalues nearly
        /// agree, either eigenvector is valid.
        const N_ITERATIONS: usize = 6;
        let mut vector: Vec<f64> = (0..self.n).map(|i| 1.0 + 0.1 * (i % 7) as f64).collect();
        for _ in 0..N_ITERATIONS {
            vector = self.solve(&vector);
            let length = norm(&vector);
            vector.iter_mut().for_each(|x| *x /= length);
        }
        vector
    }
}

/// Returns the step d with |d| ≤ `reach` that minimises the quadratic model `g·d + ½ dᵀHd`, and the decrease of the model. The Hessian H may have negative
/// eigenvalues. \[MS\]
///
/// The step solves `(H + σ) d = −g` with the least σ ≥ 0 for which H + σ is positive definite and |d| ≤ `reach`. Newton's method solves `1/|d| = 1/reach` for
/// σ. If g has no component along the lowest eigenvector of an indefinite H (the hard case), a multiple of this eigenvector is added so that |d| = `reach`.
pub(super) fn best_step(gradient: &[f64], h: &Symmetric, reach: f64) -> (Vec<f64>, f64) {
    /// Relative distance from the boundary of the trust region below which a step counts as on the boundary.
    const NEAR: f64 = 1e-9;
    /// First diagonal shift tried for an indefinite matrix H, relative to the largest shift; both larger and smaller values need more iterations.
    const FIRST: f64 = 1e-3;
    let (size, slope) = (h.size(), norm(gradient));
    let flat = 1e-14 * size.max(slope / reach);
    let against: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let (mut low, mut high) = (flat, size + slope / reach + 2.0 * flat);
    let mut sigma = flat;
    let mut inside: Option<(Factor, Vec<f64>)> = None;
    for _ in 0..200 {
        let mut next = f64::NAN;
        match h.factor(sigma) {
            None => {
                low = sigma;
                if sigma == flat {
                    next = FIRST * high;
                }
            }
            Some(factor) => {
                let step = factor.solve(&against);
                let length = norm(&step);
                let is_at_edge = (length - reach).abs() <= NEAR * reach;
                if is_at_edge || (length <= reach && sigma == flat) {
                    return with_gain(gradient, h, step);
                }
                let along = norm(&factor.forward(&step));
                next = sigma + (length / along).powi(2) * (length - reach) / reach;
                if length > reach {
                    low = sigma;
                } else {
                    high = sigma;
                    inside = Some((factor, step));
                }
            }
        }
        if high <= low * (1.0 + 1e-12) {
            break;
        }
        let is_between = next > low && next < high;
        sigma = if is_between {
            next
        } else {
            (low * high).sqrt()
        };
    }
    let Some((factor, mut step)) = inside else {
        return (vec![0.0; gradient.len()], 0.0);
    };
    let vector = factor.weakest();
    let along = dot(&step, &vector);
    let left = reach * reach - dot(&step, &step);
    let sign = if along < 0.0 { -1.0 } else { 1.0 };
    let part = sign * left / (along.abs() + (along * along + left).sqrt());
    for (step, way) in step.iter_mut().zip(&vector) {
        *step += part * way;
    }
    with_gain(gradient, h, step)
}

fn with_gain(gradient: &[f64], h: &Symmetric, step: Vec<f64>) -> (Vec<f64>, f64) {
    let gain = -dot(gradient, &step) - 0.5 * dot(&h.times(&step), &step);
    (step, gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    fn random_case(seed: u64, n: usize) -> (Vec<f64>, Symmetric) {
        let mut rng = Seed::new(seed).named("six").rng();
        let half: Vec<f64> = (0..n * n)
            .map(|_| rng.gen_range(-1.0..1.0) * 10f64.powi(rng.gen_range(-2..3)))
            .collect();
        let entries = (0..n * n).map(|k| half[k] + half[k % n * n + k / n]);
        let m = Symmetric {
            n,
            entries: entries.collect(),
        };
        ((0..n).map(|_| rng.gen_range(-1.0..1.0)).collect(), m)
    }

    /// Returns an approximate eigenvector of the lowest eigenvalue of a matrix, found by bisecting the least shift that makes the matrix positive definite.
    fn lowest(m: &Symmetric) -> Vec<f64> {
        let (mut low, mut high) = (0.0, 2.0 * m.size());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match m.factor(middle) {
                Some(_) => high = middle,
                None => low = middle,
            }
        }
        m.factor(high).unwrap().weakest()
    }

    #[test]
    fn a_factor_solves_its_equations() {
        for seed in 0..100 {
            let (b, m) = random_case(seed, 12);
            let shift = m.size();
            let x = m.factor(shift).unwrap().solve(&b);
            for (i, left) in m.times(&x).iter().enumerate() {
                assert!((left + shift * x[i] - b[i]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn no_step_within_reach_is_better() {
        let model = |g: &[f64], m: &Symmetric, d: &[f64]| dot(g, d) + 0.5 * dot(&m.times(d), d);
        for seed in 0..200 {
            let n = 6 * (1 + seed as usize % 3);
            let (mut g, m) = random_case(seed, n);
            if seed % 4 == 0 {
                // Hard case: the gradient has no component along the lowest eigenvector.
                if m.factor(0.0).is_none() {
                    let vector = lowest(&m);
                    let along = dot(&g, &vector);
                    g.iter_mut().zip(&vector).for_each(|(g, v)| *g -= along * v);
                }
            }
            let mut rng = Seed::new(seed).named("others").rng();
            let reach = 10f64.powf(rng.gen_range(-3.0..1.0));
            let (step, gain) = best_step(&g, &m, reach);
            assert!(norm(&step) <= reach * (1.0 + 1e-8));
            assert!((model(&g, &m, &step) + gain).abs() <= 1e-9 * (1.0 + gain.abs()));
            for _ in 0..200 {
                let other: Vec<f64> = (0..n)
                    .map(|i| step[i] + reach * rng.gen_range(-0.3..0.3))
                    .collect();
                let longer = norm(&other).max(reach) / reach;
                let other: Vec<f64> = other.iter().map(|x| x / longer).collect();
                assert!(
                    model(&g, &m, &other) >= -gain - 1e-7 * (1.0 + gain.abs()),
                    "seed {seed}"
                );
            }
        }
    }
}
