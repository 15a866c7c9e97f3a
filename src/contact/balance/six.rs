//! Vectors and symmetric matrices of the six ways a body can move, and the best step of a quadratic model in a ball.

/// Three translations, three rotations.
pub(super) type Six = [f64; 6];
/// Symmetric.
pub(super) type SixBySix = [[f64; 6]; 6];

pub(super) fn dot(a: &Six, b: &Six) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

pub(super) fn norm(a: &Six) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn times(m: &SixBySix, v: &Six) -> Six {
    std::array::from_fn(|i| dot(&m[i], v))
}

/// Adds `factor · a bᵀ`.
pub(super) fn add_outer(m: &mut SixBySix, factor: f64, a: &Six, b: &Six) {
    for (row, x) in m.iter_mut().zip(a) {
        for (entry, y) in row.iter_mut().zip(b) {
            *entry += factor * x * y;
        }
    }
}

/// Eigenvalues and eigenvectors (row k belongs to value k) of a symmetric matrix, by Jacobi's rotations.
pub(super) fn eigen(matrix: &SixBySix) -> (Six, SixBySix) {
    /// Sweeps at most; six to eight are usual.
    const MAX_SWEEPS: usize = 50;
    let mut m = *matrix;
    let mut vectors: SixBySix = std::array::from_fn(unit);
    let size: f64 = m.iter().flatten().map(|x| x * x).sum();
    for _ in 0..MAX_SWEEPS {
        let off: f64 = (0..6)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| m[i][j].powi(2))
            .sum();
        if off <= 1e-34 * size {
            break;
        }
        for p in 0..5 {
            for q in p + 1..6 {
                rotate(&mut m, &mut vectors, p, q);
            }
        }
    }
    (std::array::from_fn(|i| m[i][i]), vectors)
}

fn unit(i: usize) -> Six {
    std::array::from_fn(|j| f64::from(u8::from(i == j)))
}

/// One rotation that makes entry (p, q) zero.
fn rotate(m: &mut SixBySix, vectors: &mut SixBySix, p: usize, q: usize) {
    if m[p][q] == 0.0 {
        return;
    }
    let half = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
    let tan = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
    let cos = 1.0 / (tan * tan + 1.0).sqrt();
    let sin = tan * cos;
    for row in m.iter_mut() {
        (row[p], row[q]) = (cos * row[p] - sin * row[q], sin * row[p] + cos * row[q]);
    }
    let turned = |rows: &mut SixBySix| {
        let (head, tail) = rows.split_at_mut(q);
        for (a, b) in head[p].iter_mut().zip(&mut tail[0]) {
            (*a, *b) = (cos * *a - sin * *b, sin * *a + cos * *b);
        }
    };
    turned(m);
    turned(vectors);
}

/// The step d with |d| ≤ `reach` that minimises `g·d + ½ dᵀHd`, and how much that is below zero; also where H has negative
/// curvature. \[MS\]
///
/// Where g has no part along the lowest eigenvector of an indefinite H (the hard case), that vector is added up to the edge
/// of the ball.
pub(super) fn best_step(
    gradient: &Six,
    (values, vectors): &(Six, SixBySix),
    reach: f64,
) -> (Six, f64) {
    let g: Six = std::array::from_fn(|k| dot(gradient, &vectors[k]));
    let lowest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let length = |shift: f64| -> f64 {
        let part = |k: usize| match g[k] {
            0.0 => 0.0,
            along => (along / (values[k] + shift)).powi(2),
        };
        (0..6).map(part).sum::<f64>().sqrt()
    };
    let flat = 1e-14 * largest.max(norm(&g) / reach);
    let mut low = (-lowest).max(0.0);
    let shift = if lowest > flat && length(0.0) <= reach {
        0.0
    } else {
        // The length falls with the shift; below this one it is certainly within reach.
        let mut high = low + norm(&g) / reach + flat;
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if length(middle) > reach {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    };
    let mut along: Six = std::array::from_fn(|k| match g[k] {
        0.0 => 0.0,
        g => -g / (values[k] + shift),
    });
    let left = reach * reach - dot(&along, &along);
    if lowest < -flat && left > 1e-6 * reach * reach {
        let k = (0..6).find(|&k| values[k] == lowest).unwrap_or(0);
        let sign = if along[k] < 0.0 { -1.0 } else { 1.0 };
        along[k] = sign * (along[k] * along[k] + left).sqrt();
    }
    let gain: f64 = (0..6)
        .map(|k| -(g[k] + 0.5 * values[k] * along[k]) * along[k])
        .sum();
    let step = std::array::from_fn(|i| (0..6).map(|k| along[k] * vectors[k][i]).sum());
    (step, gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    fn random_case(seed: u64) -> (Six, SixBySix) {
        let mut rng = Seed::new(seed).named("six").rng();
        let half: SixBySix = std::array::from_fn(|_| {
            std::array::from_fn(|_| rng.gen_range(-1.0..1.0) * 10f64.powi(rng.gen_range(-2..3)))
        });
        let m = std::array::from_fn(|i| std::array::from_fn(|j| half[i][j] + half[j][i]));
        (std::array::from_fn(|_| rng.gen_range(-1.0..1.0)), m)
    }

    #[test]
    fn eigenvectors_are_stretched_by_their_values() {
        for seed in 0..200 {
            let (_, m) = random_case(seed);
            let (values, vectors) = eigen(&m);
            for k in 0..6 {
                let stretched = times(&m, &vectors[k]);
                for i in 0..6 {
                    assert!((stretched[i] - values[k] * vectors[k][i]).abs() < 1e-10);
                }
                assert!((norm(&vectors[k]) - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn no_step_within_reach_is_better() {
        let model = |g: &Six, m: &SixBySix, d: &Six| dot(g, d) + 0.5 * dot(&times(m, d), d);
        for seed in 0..200 {
            let (mut g, m) = random_case(seed);
            let parts = eigen(&m);
            if seed % 4 == 0 {
                // The hard case: nothing along the lowest direction.
                let lowest = (0..6)
                    .min_by(|&a, &b| parts.0[a].total_cmp(&parts.0[b]))
                    .unwrap();
                let along = dot(&g, &parts.1[lowest]);
                g = std::array::from_fn(|i| g[i] - along * parts.1[lowest][i]);
            }
            let mut rng = Seed::new(seed).named("others").rng();
            let reach = 10f64.powf(rng.gen_range(-3.0..1.0));
            let (step, gain) = best_step(&g, &parts, reach);
            assert!(norm(&step) <= reach * (1.0 + 1e-9));
            assert!((model(&g, &m, &step) + gain).abs() <= 1e-9 * (1.0 + gain.abs()));
            for _ in 0..200 {
                let other: Six =
                    std::array::from_fn(|i| step[i] + reach * rng.gen_range(-0.3..0.3));
                let size = norm(&other).max(reach);
                let other = other.map(|x| x * reach / size);
                assert!(
                    model(&g, &m, &other) >= -gain - 1e-7 * (1.0 + gain.abs()),
                    "seed {seed}"
                );
            }
        }
    }
}
