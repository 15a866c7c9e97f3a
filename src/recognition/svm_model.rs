//! A trained SVM: decision values and labels, by matrix products.
//!
//! linfa-svm evaluates a kernel decision one support vector at a time; here a block of rows meets all support vectors
//! of a class in one matrix product, and their coefficients for all binary problems in a second one.

use linfa::traits::PredictInplace;
use ndarray::{Array1, Array2, ArrayBase, ArrayView2, Axis, Data, Ix2, s};

use crate::Result;
use crate::recognition::dataset::{Dataset, check_width};
use crate::recognition::kernel::KernelFunction;
use crate::recognition::svm::{BinaryProblem, Multiclass};

/// Rows whose decision values are computed at once: a kernel block of 512 × 1,000 support vectors is 4 MB. Larger
/// leaves the processor's cache, smaller makes the products inefficient.
const BLOCK_ROWS: usize = 512;

/// A trained SVM. Implements linfa's [`PredictInplace`] and so its `Predict`.
#[derive(Clone, Debug)]
pub struct SvmModel {
    classes: Vec<usize>,
    multiclass: Multiclass,
    /// For every problem, the positions in `classes` of its positive and its negative class.
    sides: Vec<(usize, Option<usize>)>,
    problems: Vec<BinaryProblem>,
    rho: Array1<f64>,
    n_features: usize,
    decision: Decision,
}

/// `Σ y a K(x_i, x)` for all problems at once.
#[derive(Clone, Debug)]
enum Decision {
    /// The hyperplanes' normals, n_problems × m.
    Hyperplanes(Array2<f64>),
    /// Support vectors, class by class.
    SupportVectors {
        kernel: KernelFunction,
        /// Subtracted from support vectors and from test rows: RBF distances keep their digits. Zero for others.
        centre: Array1<f64>,
        classes: Vec<ClassSupport>,
    },
}

/// The support vectors of one class and their coefficients in the problems that the class takes part in.
#[derive(Clone, Debug)]
struct ClassSupport {
    /// n_support × m.
    vectors: Array2<f64>,
    /// The problems, ascending.
    problems: Vec<usize>,
    /// n_support × problems.len().
    coefficients: Array2<f64>,
}

impl SvmModel {
    pub(crate) fn new(
        data: &Dataset,
        classes: Vec<usize>,
        kernel: KernelFunction,
        multiclass: Multiclass,
        problems: Vec<BinaryProblem>,
    ) -> Self {
        let position = |class: usize| classes.partition_point(|&other| other < class);
        let sides = problems
            .iter()
            .map(|problem| (position(problem.positive), problem.negative.map(position)))
            .collect();
        let decision = match kernel {
            KernelFunction::Linear => Decision::Hyperplanes(hyperplanes(data, &problems)),
            _ => support_vectors(data, &classes, kernel, &problems),
        };
        Self {
            rho: problems
                .iter()
                .map(|problem| problem.solution.rho)
                .collect(),
            n_features: data.records.ncols(),
            classes,
            multiclass,
            sides,
            problems,
            decision,
        }
    }

    /// The classes of the training rows, ascending: what can be predicted.
    pub fn classes(&self) -> &[usize] {
        &self.classes
    }

    /// The binary problems and their solutions, in the order of the decision values' columns.
    pub fn problems(&self) -> &[BinaryProblem] {
        &self.problems
    }

    /// How many binary problems stopped at the solver's iteration cap, short of its tolerance.
    pub fn n_capped(&self) -> usize {
        let is_capped = |problem: &&BinaryProblem| problem.solution.is_capped;
        self.problems.iter().filter(is_capped).count()
    }

    /// Decision values (n_rows × n_problems): above 0 speaks for a problem's positive class.
    ///
    /// # Errors
    /// Another number of columns than in training, or a NaN or infinite feature.
    pub fn decision_values(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        check_width(&features, self.n_features)?;
        let mut values = Array2::zeros((features.nrows(), self.problems.len()));
        for (block, mut values) in features
            .axis_chunks_iter(Axis(0), BLOCK_ROWS)
            .zip(values.axis_chunks_iter_mut(Axis(0), BLOCK_ROWS))
        {
            values.assign(&self.weighted_sums(block));
            values -= &self.rho;
        }
        Ok(values)
    }

    /// The predicted label of each row.
    ///
    /// # Errors
    /// Another number of columns than in training, or a NaN or infinite feature.
    pub fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        Ok(self.labels_of_values(self.decision_values(features)?.view()))
    }

    /// The label that each row of decision values (n_rows × n_problems) speaks for. The rows may be sums over several
    /// touches of one object.
    pub fn labels_of_values(&self, values: ArrayView2<f64>) -> Array1<usize> {
        values
            .rows()
            .into_iter()
            .map(|values| {
                let winner = match self.multiclass {
                    Multiclass::OneVsOne => first_maximum(&self.votes(values.iter())),
                    _ => first_maximum(&values.to_vec()),
                };
                self.classes[winner]
            })
            .collect()
    }

    /// Votes per class, as LIBSVM counts them: a value above 0 is for the positive class, any other for the negative.
    fn votes<'a>(&self, values: impl Iterator<Item = &'a f64>) -> Vec<f64> {
        let mut votes = vec![0.0; self.classes.len()];
        for (&value, &(positive, negative)) in values.zip(&self.sides) {
            votes[if value > 0.0 {
                positive
            } else {
                negative.unwrap_or(positive)
            }] += 1.0;
        }
        votes
    }

    fn weighted_sums(&self, features: ArrayView2<f64>) -> Array2<f64> {
        match &self.decision {
            Decision::Hyperplanes(normals) => features.dot(&normals.t()),
            Decision::SupportVectors {
                kernel,
                centre,
                classes,
            } => {
                let centred = &features - centre;
                let mut sums = Array2::zeros((features.nrows(), self.problems.len()));
                for class in classes {
                    let matrix = kernel.matrix(centred.view(), class.vectors.view());
                    let part = matrix.dot(&class.coefficients);
                    for (column, &problem) in part.columns().into_iter().zip(&class.problems) {
                        let mut sum = sums.slice_mut(s![.., problem]);
                        sum += &column;
                    }
                }
                sums
            }
        }
    }
}

/// The position of the largest value; the first of equals.
fn first_maximum(values: &[f64]) -> usize {
    let mut best = 0;
    for (i, &value) in values.iter().enumerate() {
        if value > values[best] {
            best = i;
        }
    }
    best
}

/// `w = Σ y_i a_i x_i` per problem: n_problems × m.
fn hyperplanes(data: &Dataset, problems: &[BinaryProblem]) -> Array2<f64> {
    let mut normals = Array2::zeros((problems.len(), data.records.ncols()));
    for (mut normal, problem) in normals.rows_mut().into_iter().zip(problems) {
        for (&row, &coefficient) in problem.rows.iter().zip(&problem.solution.coefficients) {
            if coefficient != 0.0 {
                normal.scaled_add(coefficient, &data.records.row(row));
            }
        }
    }
    normals
}

fn support_vectors(
    data: &Dataset,
    classes: &[usize],
    kernel: KernelFunction,
    problems: &[BinaryProblem],
) -> Decision {
    let centre = match kernel {
        KernelFunction::Rbf { .. } => data.records.sum_axis(Axis(0)) / data.records.nrows() as f64,
        _ => Array1::zeros(data.records.ncols()),
    };
    let classes = classes
        .iter()
        .map(|&class| class_support(data, class, &centre, problems))
        .collect();
    Decision::SupportVectors {
        kernel,
        centre,
        classes,
    }
}

fn class_support(
    data: &Dataset,
    class: usize,
    centre: &Array1<f64>,
    problems: &[BinaryProblem],
) -> ClassSupport {
    let takes_part = |problem: &BinaryProblem| match problem.negative {
        Some(negative) => problem.positive == class || negative == class,
        None => true,
    };
    let of_class: Vec<usize> = (0..problems.len())
        .filter(|&problem| takes_part(&problems[problem]))
        .collect();
    // Coefficients by training row, one column per problem; then only rows that support some problem are kept.
    let mut dense = Array2::<f64>::zeros((data.targets.len(), of_class.len()));
    for (column, &problem) in of_class.iter().enumerate() {
        let BinaryProblem { rows, solution, .. } = &problems[problem];
        for (&row, &coefficient) in rows.iter().zip(&solution.coefficients) {
            if data.targets[row] == class {
                dense[[row, column]] = coefficient;
            }
        }
    }
    let support: Vec<usize> = (0..data.targets.len())
        .filter(|&row| dense.row(row).iter().any(|&coefficient| coefficient != 0.0))
        .collect();
    ClassSupport {
        vectors: data.records.select(Axis(0), &support) - centre,
        coefficients: dense.select(Axis(0), &support),
        problems: of_class,
    }
}

impl<D: Data<Elem = f64>> PredictInplace<ArrayBase<D, Ix2>, Array1<usize>> for SvmModel {
    /// Writes the predicted labels into `targets`.
    ///
    /// # Panics
    /// If `features` has another number of columns than in training or a value that is not finite, or `targets`
    /// another length: linfa's trait has no way to return an error. [`SvmModel::labels`] has.
    fn predict_inplace(&self, features: &ArrayBase<D, Ix2>, targets: &mut Array1<usize>) {
        match self.labels(features.view()) {
            Ok(labels) => targets.assign(&labels),
            Err(error) => panic!("{error}"),
        }
    }

    fn default_target(&self, features: &ArrayBase<D, Ix2>) -> Array1<usize> {
        Array1::zeros(features.nrows())
    }
}
