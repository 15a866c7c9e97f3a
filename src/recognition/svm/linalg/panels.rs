//! Products of f32 rows with many others that are packed into panels beforehand, near the processor's peak.
//!
//! A tile of products stays in vector registers while the features pass by [Goto, van de Geijn 2008]: a few rows with
//! one panel of the others. The features pass in pieces of [`DEPTH`], and a few panels at a time, so that those stay in the
//! second cache. A tile's rows are read where they lie: they pass in line, so the processor fetches them ahead.

#[cfg(target_arch = "x86_64")]
use crate::recognition::svm::linalg::panels_512;
use crate::recognition::svm::linalg::row_products::Rows;
use crate::recognition::svm::linalg::transposed::write_columns;

/// Values in a vector register.
pub(crate) const LANES: usize = 16;
/// Registers across a panel.
pub(crate) const PANEL_LANES: usize = 3;
/// Packed rows of a panel.
pub(crate) const PANEL_ROWS: usize = PANEL_LANES * LANES;
/// Features that pass at once.
pub(crate) const DEPTH: usize = 1024;

/// Which products of rows with packed rows are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wanted {
    /// All.
    All,
    /// Those of each row with the packed ones up to the same number. Some others are written, too.
    UpToOwn,
}

/// Rows packed into panels, for products with others.
#[derive(Clone, Debug)]
pub(crate) struct Panels {
    pub(crate) n_rows: usize,
    pub(crate) n_features: usize,
    /// For each piece of features, for each panel, for each feature: its values in all rows of the panel. The last panel is as
    /// wide as it must be; 0 stands for rows that it lacks.
    pub(crate) values: Vec<[f32; LANES]>,
}

impl Panels {
    /// Packs the first so many rows, if the processor has what products take.
    pub fn new(rows: Rows<f32>, n_rows: usize) -> Option<Self> {
        if !is_supported() {
            return None;
        }
        let mut panels = Self {
            n_rows,
            n_features: rows.n_features,
            values: vec![[0.0; LANES]; rows.n_features * n_rows.div_ceil(LANES)],
        };
        for piece in panels.pieces() {
            for first in (0..n_rows).step_by(LANES) {
                let (start, width) = panels.place(first / PANEL_ROWS, piece);
                let to = panels.values[start..][..width * piece.1].as_flattened_mut();
                let some = first..n_rows.min(first + LANES);
                let some: Vec<&[f32]> = some
                    .map(|row| &rows.row(row)[piece.0..][..piece.1])
                    .collect();
                write_columns(&some, &mut to[first % PANEL_ROWS..], width * LANES);
            }
        }
        Some(panels)
    }

    /// Bytes that so many packed rows take.
    pub fn bytes(n_rows: usize, n_features: usize) -> usize {
        n_rows.next_multiple_of(LANES) * n_features * size_of::<f32>()
    }

    /// The pieces that features pass in: the first of each, and how many.
    pub(crate) fn pieces(&self) -> Vec<(usize, usize)> {
        let starts = (0..self.n_features).step_by(DEPTH);
        starts
            .map(|start| (start, DEPTH.min(self.n_features - start)))
            .collect()
    }

    /// Where a panel's piece starts, and how many registers it is wide.
    pub(crate) fn place(&self, panel: usize, (feature, n): (usize, usize)) -> (usize, usize) {
        let lanes = self.n_rows.div_ceil(LANES);
        let before = panel * PANEL_LANES;
        (
            feature * lanes + before * n,
            PANEL_LANES.min(lanes - before),
        )
    }

    /// Products of `left` with the packed rows, row by row into `to`; `false`, and nothing written, without the instructions.
    pub fn multiply(&self, left: &[&[f32]], wanted: Wanted, to: &mut [&mut [f32]]) -> bool {
        multiply(self, left, wanted, to)
    }
}

#[cfg(target_arch = "x86_64")]
fn is_supported() -> bool {
    std::is_x86_feature_detected!("avx512f")
}

#[cfg(not(target_arch = "x86_64"))]
fn is_supported() -> bool {
    false
}

#[cfg(target_arch = "x86_64")]
#[multiversion::multiversion(targets("x86_64+avx512f"))]
fn multiply(panels: &Panels, left: &[&[f32]], wanted: Wanted, to: &mut [&mut [f32]]) -> bool {
    multiversion::target::match_target! {
        "x86_64+avx512f" => {
            panels_512::multiply(panels, left, wanted, to);
            true
        }
        _ => {
            let _ = (panels, left, wanted, to);
            false
        }
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn multiply(_: &Panels, _: &[&[f32]], _: Wanted, _: &mut [&mut [f32]]) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n rows of m values with no pattern.
    fn values(n: usize, m: usize, salt: f64) -> Vec<f32> {
        let value = |i: usize| (i as f64 * 1.7 + salt).sin() as f32;
        (0..n * m).map(value).collect()
    }

    fn product(left: &[f32], right: &[f32]) -> f64 {
        let both = left.iter().zip(right);
        both.map(|(&a, &b)| f64::from(a) * f64::from(b)).sum()
    }

    #[test]
    fn products_are_sums_of_products_whatever_the_numbers_of_rows_and_features() {
        for (n_left, n_right, m) in [
            (1, 1, 1),
            (8, 48, 16),
            (9, 49, 7),
            (3, 300, 513),
            (20, 65, 512),
            (50, 30, 1100),
            (4, 5, 0),
            (0, 3, 4),
        ] {
            let (left, right) = (values(n_left, m, 0.3), values(n_right, m, 2.0));
            let rows = |values| Rows {
                values,
                n_features: m,
            };
            let row = |values: &[f32], at: usize| values[at * m..][..m].to_vec();
            let Some(panels) = Panels::new(rows(&right), n_right) else {
                eprintln!("skipped: this processor has no AVX-512");
                return;
            };
            let mut to = vec![vec![7.0; n_right]; n_left];
            let mut slices: Vec<&mut [f32]> = to.iter_mut().map(Vec::as_mut_slice).collect();
            let left: Vec<&[f32]> = (0..n_left).map(|row| rows(&left).row(row)).collect();
            assert!(panels.multiply(&left, Wanted::All, &mut slices));
            for (i, found) in to.iter().enumerate() {
                for (j, &found) in found.iter().enumerate() {
                    let expected = product(left[i], &row(&right, j));
                    assert!(
                        (f64::from(found) - expected).abs() <= 1e-6 * m as f64,
                        "{n_left} {n_right} {m}: {i} {j}"
                    );
                }
            }
        }
    }

    #[test]
    fn products_up_to_a_rows_own_are_all_there() {
        let (n, m) = (130, 20);
        let all = values(n, m, 0.7);
        let rows = Rows {
            values: &all,
            n_features: m,
        };
        let Some(panels) = Panels::new(rows, n) else {
            eprintln!("skipped: this processor has no AVX-512");
            return;
        };
        let mut to = vec![vec![0.0; n]; n];
        let mut slices: Vec<&mut [f32]> = to.iter_mut().map(Vec::as_mut_slice).collect();
        let left: Vec<&[f32]> = (0..n).map(|row| rows.row(row)).collect();
        assert!(panels.multiply(&left, Wanted::UpToOwn, &mut slices));
        for (i, found) in to.iter().enumerate() {
            for (j, &found) in found.iter().enumerate().take(i + 1) {
                let expected = product(rows.row(i), rows.row(j));
                assert!((f64::from(found) - expected).abs() < 1e-5, "{i} {j}");
            }
        }
    }
}
