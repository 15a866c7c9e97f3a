//! Maximum of several deflections, smoothed for Newton's method; the smoothing vanishes at convergence.
//!
//! A taxel between two spheres touches both, and the distribution of its force among them is unknown. The maximum is
//! `max over w in the simplex of w·δ`; its augmented Lagrangian about the present shares w⁰,
//!
//! ```text
//! ψ = max over w of  w·δ − (μ/2) |w − w⁰|²        (about no shares: − (μ/2) (|w|² − 1))
//! ```
//!
//! has the gradient w. Replacing w⁰ by w and repeating makes ψ converge to the maximum itself \[RW\].

/// Smoothed maximum of several deflections, and the number of deflections with a nonzero share in this maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TiedMax {
    pub value: f64,
    /// Number of deflections with a share above zero.
    pub n_sharing: usize,
}

/// Returns the smoothed maximum of `deflections` and writes the share of each deflection to `shares`. `known` contains earlier shares of the deflections, and
/// their sum of squares over all spheres, including omitted ones. `None` means that no shares are known.
pub(super) fn tied_max(
    deflections: &[f64],
    known: Option<(&[f64], f64)>,
    smoothing: f64,
    shares: &mut Vec<f64>,
) -> TiedMax {
    let about = |j: usize| known.map_or(0.0, |(known, _)| known[j]);
    shares.clear();
    if let ([alone], None) = (deflections, known) {
        shares.push(1.0);
        return TiedMax {
            value: *alone,
            n_sharing: 1,
        };
    }
    let at = |j: usize| about(j) + deflections[j] / smoothing;
    let highest = (0..deflections.len())
        .map(at)
        .fold(f64::NEG_INFINITY, f64::max);
    // Only values within the smoothing width of the largest can have a share.
    let mut near: Vec<f64> = (0..deflections.len())
        .map(at)
        .filter(|v| *v > highest - 1.0)
        .collect();
    near.sort_by(|a, b| b.total_cmp(a));
    let (mut sum, mut level) = (0.0, highest - 1.0);
    for (n, v) in near.iter().enumerate() {
        sum += v;
        let candidate = (sum - 1.0) / (n + 1) as f64;
        if *v > candidate {
            level = candidate;
        }
    }
    shares.extend((0..deflections.len()).map(|j| (at(j) - level).max(0.0)));
    // Part of |w − w⁰|² that does not depend on the list: Σ w⁰² if shares are known. Otherwise 1, so that a unique maximum keeps its exact value.
    let mut value = 0.5 * smoothing * known.map_or(1.0, |(_, squares)| -squares);
    for (j, share) in shares.iter().enumerate() {
        value += share * deflections[j] - 0.5 * smoothing * share * (share - 2.0 * about(j));
    }
    TiedMax {
        value,
        n_sharing: shares.iter().filter(|&&w| w > 0.0).count(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clear_maximum_is_itself_and_has_all_the_share() {
        let mut shares = Vec::new();
        let max = tied_max(&[1e-3, 2e-3, 1.9e-3], None, 1e-5, &mut shares);
        assert!((max.value - 2e-3).abs() < 1e-18);
        assert_eq!(
            (shares.as_slice(), max.n_sharing),
            (&[0.0, 1.0, 0.0][..], 1)
        );
    }

    #[test]
    fn its_gradient_is_the_shares_and_they_sum_to_one() {
        let known = [0.3, 0.0, 0.7, 0.0];
        let deflections = [1.00e-3, 0.999e-3, 1.002e-3, 0.9e-3];
        let (mut shares, mut others) = (Vec::new(), Vec::new());
        for known in [Some((&known[..], 0.58)), None] {
            tied_max(&deflections, known, 1e-5, &mut shares);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for j in 0..4 {
                let mut moved = |by: f64| {
                    let mut moved = deflections;
                    moved[j] += by;
                    tied_max(&moved, known, 1e-5, &mut others).value
                };
                let slope = (moved(1e-9) - moved(-1e-9)) / 2e-9;
                assert!(
                    (slope - shares[j]).abs() < 1e-4,
                    "{slope} against {shares:?}"
                );
            }
        }
    }

    #[test]
    fn about_the_right_shares_it_is_the_maximum() {
        let mut shares = Vec::new();
        let known = (&[0.2, 0.8, 0.0][..], 0.68);
        let max = tied_max(&[1e-3, 1e-3, 0.5e-3], Some(known), 1e-5, &mut shares);
        assert!((max.value - 1e-3).abs() < 1e-18);
        assert!((shares[0] - 0.2).abs() < 1e-12 && (shares[1] - 0.8).abs() < 1e-12);
    }

    #[test]
    fn a_sphere_that_leaves_the_list_takes_no_value_with_it() {
        let (mut shares, deflections) = (Vec::new(), [2e-3, 1e-3]);
        let all = tied_max(&deflections, Some((&[0.4, 0.6], 0.52)), 1e-5, &mut shares);
        let left = tied_max(&deflections[..1], Some((&[0.4], 0.52)), 1e-5, &mut shares);
        assert!((all.value - left.value).abs() < 1e-18);
    }
}
