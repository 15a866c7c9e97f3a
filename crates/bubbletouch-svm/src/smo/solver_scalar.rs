//! Pairwise steps in f32 and f64, with the vector instructions that the processor supports.

use super::iterations::{Search, Stop, run_plain};
#[cfg(target_arch = "x86_64")]
use super::passes_512;
use super::variables::Variables;
use crate::gram::matrix::Gram;
use crate::linalg::scalar::Scalar;

/// Floating-point type of Gram matrices that the solver supports.
pub(crate) trait SolverScalar: Scalar {
    /// Runs the [pairwise steps](run_plain) of the solver in this precision.
    fn run(
        gram: &mut Gram<Self>,
        variables: &mut Variables<Self>,
        search: &mut Search,
        first_look: u64,
    ) -> Stop {
        run_plain(gram, variables, search, first_look)
    }
}

impl SolverScalar for f64 {}

impl SolverScalar for f32 {
    #[cfg(target_arch = "x86_64")]
    fn run(
        gram: &mut Gram<Self>,
        variables: &mut Variables<Self>,
        search: &mut Search,
        first_look: u64,
    ) -> Stop {
        run_f32(gram, variables, search, first_look)
    }
}

#[cfg(target_arch = "x86_64")]
#[multiversion::multiversion(targets("x86_64+avx512f"))]
fn run_f32(
    gram: &mut Gram<f32>,
    variables: &mut Variables<f32>,
    search: &mut Search,
    first_look: u64,
) -> Stop {
    multiversion::target::match_target! {
        "x86_64+avx512f" => passes_512::run(gram, variables, search, first_look),
        _ => run_plain(gram, variables, search, first_look),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;

    #[test]
    fn the_passes_of_the_processor_go_the_same_way_to_the_bit() {
        let n = 150;
        let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
        let at = |i: usize| (i as f64 * 1.7).sin() + 0.2 * sign(i);
        let y: Vec<f64> = (0..n).map(sign).collect();
        for (gamma, c) in [(0.1, 1.0), (3.0, 10.0), (300.0, 0.1)] {
            let kernel = |(i, j): (usize, usize)| (-gamma * (at(i) - at(j)).powi(2)).exp() as f32;
            let mut gram = Gram::whole(Array2::from_shape_fn((n, n), kernel).view());
            let start = Variables::<f32>::new(&vec![0.0; n], &y, &y, c);
            let (mut found, mut expected) = (start.clone(), start);
            let (mut search, mut plain) = (Search::new(100_000, 1e-4), Search::new(100_000, 1e-4));
            f32::run(&mut gram, &mut found, &mut search, 1);
            run_plain(&mut gram, &mut expected, &mut plain, 1);
            assert!(search.n_iterations > 10);
            assert_eq!(search.n_iterations, plain.n_iterations);
            assert_eq!(found.beta, expected.beta);
            assert_eq!(found.f, expected.f);
        }
    }
}
