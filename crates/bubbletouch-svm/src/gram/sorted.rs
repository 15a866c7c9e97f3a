//! Training rows sorted by class and centred.

use std::ops::Range;

use ndarray::{Array1, ArrayView1, ArrayView2};

use crate::binary_problem::BinaryProblem;
use crate::class_weight::ClassWeight;
use crate::dataset::LabelledRows;
use crate::gram::centered_rows::CenteredRows;
use crate::kernel::KernelFunction;
use crate::linalg::scalar::Scalar;

/// Returns all pairs of classes `(a, b)` with a < b, where a is in the first range and b in the second. The ranges may be equal.
pub(crate) fn pairs(
    own: Range<usize>,
    other: Range<usize>,
) -> impl Iterator<Item = (usize, usize)> {
    own.flat_map(move |a| other.clone().filter(move |&b| b > a).map(move |b| (a, b)))
}

/// Training rows sorted by class and centred.
#[derive(Clone)]
pub(crate) struct Sorted<T> {
    /// Centred rows, sorted by class.
    pub points: CenteredRows<T>,
    /// Original row number of each row in sorted order.
    pub order: Vec<usize>,
    /// Position of each original row in the sorted order.
    pub place: Vec<usize>,
    /// Range of each class's rows in the sorted order.
    pub ranges: Vec<Range<usize>>,
    /// Weight of each sorted row in training.
    pub weights: Vec<f64>,
    /// Kernel function that all binary problems use.
    pub kernel: KernelFunction,
    /// Centre that was subtracted from every row (m values).
    pub centre: Array1<f64>,
    /// Largest squared distance between a row and the centre.
    farthest: f64,
    /// Product `(x − c)·c` of each sorted row x with the centre c, for a linear kernel. The product converts the offset ρ of decision functions about the
    /// centre to an offset about the origin. The list is empty for other kernels.
    centre_products: Vec<f64>,
}

impl<T: Scalar> Sorted<T> {
    /// Sorts rows by class and by the given key within each class, and subtracts the centre. `classes` contains the labels of the classes, ascending.
    pub fn new(
        LabelledRows {
            features, labels, ..
        }: LabelledRows,
        classes: &[usize],
        kernel: KernelFunction,
        centre: ArrayView1<f64>,
        key: impl Fn(usize) -> usize,
    ) -> Self {
        let mut order: Vec<usize> = (0..labels.len()).collect();
        order.sort_by_key(|&row| (labels[row], key(row)));
        let start = |class: usize| order.partition_point(|&row| labels[row] < class);
        let ranges = classes
            .iter()
            .map(|&class| start(class)..start(class + 1))
            .collect();
        let mut place = vec![0; order.len()];
        for (at, &row) in order.iter().enumerate() {
            place[row] = at;
        }
        let rows = order.iter().map(|&row| features.row(row));
        let (mut centre_products, mut farthest) = (Vec::new(), 0.0_f64);
        let points = CenteredRows::of_rows_and(rows, centre, |moved| {
            farthest = farthest.max(moved.norm);
            if kernel == KernelFunction::Linear {
                centre_products.push(moved.along_centre);
            }
        });
        Self {
            points,
            farthest,
            weights: vec![1.0; order.len()],
            order,
            place,
            ranges,
            kernel,
            centre: centre.to_owned(),
            centre_products,
        }
    }

    /// Sets the weights of the rows in training: the weight of the class times the weight of the row, in the order of the data. Without row weights, the list is
    /// empty.
    pub fn weighted(self, class_weight: ClassWeight, row_weights: &[f32]) -> Self {
        let of_class = class_weight.of_sizes(self.ranges.iter().map(Range::len));
        let mut weights = vec![1.0; self.order.len()];
        for (range, weight) in self.ranges.iter().zip(of_class) {
            weights[range.clone()].fill(weight);
        }
        if !row_weights.is_empty() {
            let own = self.order.iter().map(|&row| f64::from(row_weights[row]));
            weights
                .iter_mut()
                .zip(own)
                .for_each(|(weight, own)| *weight *= own);
        }
        Self { weights, ..self }
    }

    /// Returns the sorted rows projected onto k directions (k × m).
    pub fn along(&self, directions: ArrayView2<T>) -> Self {
        Self {
            points: self.points.along(directions),
            order: self.order.clone(),
            place: self.place.clone(),
            ranges: self.ranges.clone(),
            weights: self.weights.clone(),
            kernel: self.kernel,
            centre: Array1::zeros(directions.nrows()),
            farthest: self.farthest,
            centre_products: Vec::new(),
        }
    }

    /// Returns the largest squared distance between a row and the centre, and the largest weight of a row in training.
    pub fn farthest_and_heaviest(&self) -> (f64, f64) {
        let weights = self.weights.iter().copied();
        (self.farthest, weights.fold(0.0, f64::max))
    }

    /// Returns the offset ρ of a binary problem's decision function for centred rows.
    pub fn rho_about_centre(&self, problem: &BinaryProblem) -> f64 {
        problem.solution.rho
            - self.moved(
                problem.rows.iter().map(|&row| self.place[row]),
                &problem.solution.coefficients,
            )
    }

    /// Returns the change of the offset ρ due to centring the rows, given the coefficients of some rows. The change is 0 unless the kernel is linear.
    pub fn moved(&self, rows: impl Iterator<Item = usize>, coefficients: &[f64]) -> f64 {
        if self.centre_products.is_empty() {
            return 0.0;
        }
        rows.zip(coefficients)
            .map(|(row, beta)| beta * self.centre_products[row])
            .sum()
    }

    /// Returns whether rows of one class have different weights.
    pub fn has_row_weights(&self) -> bool {
        let mut classes = self.ranges.iter().map(|range| &self.weights[range.clone()]);
        classes.any(|weights| weights.iter().any(|weight| *weight != weights[0]))
    }

    /// Returns the range of all rows of several consecutive classes.
    pub fn rows_of(&self, classes: &Range<usize>) -> Range<usize> {
        self.ranges[classes.start].start..self.ranges[classes.end - 1].end
    }

    /// Returns all pairs of classes by their positions: (0, 1), (0, 2), …, (1, 2), ….
    pub fn all_pairs(&self) -> impl Iterator<Item = (usize, usize)> + use<T> {
        let all = 0..self.ranges.len();
        pairs(all.clone(), all)
    }

    /// Returns the sorted positions of the rows of two classes.
    pub fn pair_rows(&self, a: usize, b: usize) -> Vec<usize> {
        self.ranges[a]
            .clone()
            .chain(self.ranges[b].clone())
            .collect()
    }
}
