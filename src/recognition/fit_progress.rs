//! How much of a fit is done, told while it goes on: how hard classes are to part shows only then.

use std::fmt;

/// Who is told how a fit gets on, if anybody; a part of a fit tells its share of the whole.
#[derive(Clone, Copy, Default)]
pub(crate) struct FitProgress<'a> {
    told: Option<&'a dyn Fn(f64)>,
    /// Of the whole fit, 0 to 1.
    share: f64,
}

impl<'a> FitProgress<'a> {
    /// Tells this listener what further share of the fit is done, each time some problems are solved; all add up to 1 at most.
    pub fn to(told: &'a dyn Fn(f64)) -> Self {
        Self {
            told: Some(told),
            share: 1.0,
        }
    }

    /// For a part that is this share of what this is for.
    pub fn part(self, share: f64) -> Self {
        Self {
            share: self.share * share,
            ..self
        }
    }

    /// A further `n` of `n_all` equal steps are done.
    pub fn done(self, n: usize, n_all: usize) {
        if let Some(told) = self.told {
            told(self.share * n as f64 / n_all.max(1) as f64);
        }
    }
}

impl fmt::Debug for FitProgress<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let mut fields = f.debug_struct("FitProgress");
        fields.field("is_told", &self.told.is_some());
        fields.field("share", &self.share).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::dataset::{Dataset, dataset};
    use crate::recognition::svm::{Multiclass, SvmParams};
    use ndarray::{Array1, Array2};
    use std::cell::Cell;

    const N_CLASSES: usize = 18;

    /// So many rows a class, of waves that overlap.
    fn waves(n_rows: usize, n_features: usize) -> Dataset {
        let value = |(i, j): (usize, usize)| {
            let class = (i % N_CLASSES) as f64;
            (class + 0.1 * j as f64).cos() + (1.7 * (7 * i + 13 * j) as f64).sin()
        };
        let features = Array2::from_shape_fn((n_rows * N_CLASSES, n_features), value);
        let labels = (0..n_rows * N_CLASSES).map(|i| i % N_CLASSES);
        dataset(features, Array1::from_iter(labels)).unwrap()
    }

    #[test]
    fn parts_of_parts_tell_their_share_of_the_whole() {
        let sum = Cell::new(0.0);
        let add = |share: f64| sum.set(sum.get() + share);
        let whole = FitProgress::to(&add);
        let choice = whole.part(0.5);
        (0..4).for_each(|_| choice.part(0.25).done(3, 3));
        assert_eq!(sum.get(), 0.5);
        whole.part(0.5).done(1, 4);
        assert_eq!(sum.get(), 0.625);
        FitProgress::default().part(0.5).done(1, 1);
        assert_eq!(sum.get(), 0.625);
    }

    #[test]
    fn every_way_to_solve_many_problems_tells_bit_by_bit_until_all_is_done() {
        let usual = SvmParams::default();
        let against_rest = SvmParams {
            multiclass: Multiclass::OneVsRest,
            ..usual
        };
        let with_little_memory = |params: SvmParams| SvmParams {
            memory_bytes: 20_000,
            ..params
        };
        // Near margins, from blocks, from rows; against the rest from a whole matrix and from rows.
        let fits = [
            (usual, waves(64, 128)),
            (usual, waves(48, 3)),
            (with_little_memory(usual), waves(12, 3)),
            (against_rest, waves(12, 3)),
            (with_little_memory(against_rest), waves(12, 3)),
        ];
        for (number, (params, data)) in fits.iter().enumerate() {
            let told = Cell::new((0, 0.0));
            let add = |share: f64| {
                let (n, sum) = told.get();
                told.set((n + 1, sum + share));
            };
            let path = [0.1, 1.0];
            let progress = FitProgress::to(&add);
            let models = params.train_path_telling(data, &path, progress).unwrap();
            assert_eq!(models.len(), path.len());
            let (n, sum) = told.get();
            assert!(n >= 3 && (sum - 1.0).abs() < 1e-9, "{number}: {n} {sum}");
        }
    }
}
