//! Models behind the estimators of `bubbletouch.learning`: soft-margin SVMs trained on features and labels 0, 1, …

use crate::arrays::{Matrix, Object, Vector, array, to_column, whole_numbers};
use crate::errors::{exception, guarded, one_of};
use crate::threads::{aside, in_pool};
use bubbletouch::random::Seed;
use bubbletouch::recognition::classifiers::class_model::ClassModel;
use bubbletouch::recognition::classifiers::linear_svm::{LinearSvm, LinearSvmParams};
use bubbletouch::recognition::data::dataset::{Dataset, dataset};
use bubbletouch::recognition::data::split::Split;
use bubbletouch::recognition::svm::class_weight::ClassWeight;
use bubbletouch::recognition::svm::cross_validation::choice::{Candidates, choose};
use bubbletouch::recognition::svm::kernel::{Gamma, Kernel};
use bubbletouch::recognition::svm::predict::svm_model::SvmModel;
use bubbletouch::recognition::svm::{Multiclass, SvmParams};
use ndarray::{Array1, Array2, ArrayView2, Axis, concatenate};
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use rayon::prelude::*;
use std::sync::Arc;

/// Reads feature rows as an array of numbers.
fn rows_of(given: &Object) -> PyResult<Array2<f64>> {
    let is_shape = |shape: &[usize]| shape.len() == 2;
    let rows = array("features", given, "(n_rows, n_features)", is_shape)?;
    Ok(rows.matrix())
}

/// Block size of predictions in the library, rows.
const BLOCK_ROWS: usize = 256;

/// Predicts parts of the rows on the threads of the pool. The number of rows of a part is a multiple of the library's block size, so the results are bitwise
/// equal to a single call.
///
/// # Errors
/// Returns the error of predicting all rows together, which names the correct row.
fn in_parts<T: Send>(
    features: &Array2<f64>,
    predict: impl Fn(ArrayView2<f64>) -> bubbletouch::Result<T> + Sync,
) -> bubbletouch::Result<Vec<T>> {
    let n_blocks = features.nrows().div_ceil(BLOCK_ROWS).max(1);
    let rows = n_blocks.div_ceil(rayon::current_num_threads()) * BLOCK_ROWS;
    let parts: Vec<ArrayView2<f64>> = features.axis_chunks_iter(Axis(0), rows).collect();
    if parts.len() < 2 {
        return Ok(vec![predict(features.view())?]);
    }
    let predicted: bubbletouch::Result<Vec<T>> = parts.into_par_iter().map(&predict).collect();
    predicted.or_else(|_| Ok(vec![predict(features.view())?]))
}

/// Reads an array of integers that are at least 0, such as row numbers.
fn whole(place: &str, given: &Object) -> PyResult<Vec<usize>> {
    let array = array(place, given, "(n,)", |shape| shape.len() == 1)?;
    whole_numbers(place, array.values(), "whole numbers from 0")
}

/// Predicts rows on the threads of the pool, while other Python threads may run.
fn predicted<T: Send>(
    features: &Object,
    predict: impl FnOnce(&Array2<f64>) -> bubbletouch::Result<T> + Send,
) -> PyResult<T> {
    let rows = rows_of(features)?;
    in_pool(features.py(), || predict(&rows))?.map_err(exception)
}

/// Training data and parameters of a model. Pickling stores them, and unpickling trains again.
struct Training {
    data: Arc<Dataset>,
    params: Py<PyDict>,
}

impl Training {
    /// Trains a model. Returns the model and its training.
    fn run<T: Send + 'static>(
        (features, labels): (&Object, &Object),
        params: &Bound<PyDict>,
        train: impl FnOnce(&Dataset) -> bubbletouch::Result<T> + Send + 'static,
    ) -> PyResult<(T, Self)> {
        let data = Arc::new(data_of(features, labels)?);
        let rows = Arc::clone(&data);
        let model = aside(features.py(), move |_| train(&rows))?;
        let params = params.copy()?.unbind();
        Ok((model.map_err(exception)?, Self { data, params }))
    }

    /// Returns the call of `class.train` that trains the model again.
    fn call<'py>(&self, class: Bound<'py, PyType>) -> PyResult<(Object<'py>, Bound<'py, PyTuple>)> {
        let py = class.py();
        let features = self.data.records.clone().into_pyarray(py);
        let labels = to_integers(py, &self.data.targets);
        let arguments = (features, labels, self.params.bind(py)).into_pyobject(py)?;
        Ok((class.getattr("train")?, arguments))
    }
}

fn data_of(features: &Object, labels: &Object) -> PyResult<Dataset> {
    let labels = Array1::from(whole("labels", labels)?);
    dataset(rows_of(features)?, labels).map_err(|error| exception(error.into()))
}

/// Kernel and penalty C of a Python call, with the names that Python uses.
#[derive(Clone, FromPyObject)]
#[pyo3(from_item_all)]
struct SvmArguments {
    kernel: String,
    /// Kernel parameter γ; `None` means the default 'scale'.
    gamma: Option<f64>,
    coef0: f64,
    degree: u32,
    c: f64,
    tolerance: f64,
    multiclass: String,
    is_balanced: bool,
    memory_bytes: usize,
}

impl SvmArguments {
    fn params(&self) -> PyResult<SvmParams> {
        let gamma = self.gamma.map_or(Gamma::Scale, Gamma::Value);
        let polynomial = Kernel::Polynomial {
            gamma,
            coef0: self.coef0,
            degree: self.degree,
        };
        let kernels = [
            ("linear", Kernel::Linear),
            ("poly", polynomial),
            ("rbf", Kernel::Rbf { gamma }),
        ];
        let multiclass = [
            ("ovo", Multiclass::OneVsOne),
            ("ovr", Multiclass::OneVsRest),
        ];
        Ok(SvmParams {
            kernel: one_of("kernel", &self.kernel, &kernels)?,
            multiclass: one_of("multi_class", &self.multiclass, &multiclass)?,
            c: self.c,
            class_weight: class_weight(self.is_balanced),
            tolerance: self.tolerance,
            memory_bytes: self.memory_bytes,
        })
    }
}

fn class_weight(is_balanced: bool) -> ClassWeight {
    match is_balanced {
        true => ClassWeight::Balanced,
        false => ClassWeight::Uniform,
    }
}

/// Trained kernel SVM for labels 0, 1, …, used by bubbletouch.learning.SVC. Pickling stores its training rows; unpickling trains it again.
#[pyclass(frozen, module = "bubbletouch._core")]
pub struct KernelSvm {
    model: SvmModel,
    training: Training,
}

#[pymethods]
impl KernelSvm {
    /// Trains an SVM on features (n, m) and labels (n,). Raises ValueError if an argument is invalid.
    #[staticmethod]
    fn train(features: &Object, labels: &Object, params: Bound<PyDict>) -> PyResult<Self> {
        guarded(|| {
            let asked = params.extract::<SvmArguments>()?.params()?;
            let train = move |rows: &Dataset| Ok(asked.train(rows)?);
            let (model, training) = Training::run((features, labels), &params, train)?;
            Ok(Self { model, training })
        })
    }

    /// Returns the predicted labels (n,) of features (n, m). If several classes have the most votes, the lowest label is returned.
    fn labels<'py>(&self, features: &Object<'py>) -> PyResult<Vector<'py, i64>> {
        guarded(|| {
            let label = |rows: ArrayView2<f64>| Ok(self.model.labels(rows)?);
            let labels = predicted(features, |rows| in_parts(rows, label))?;
            Ok(to_integers(features.py(), labels.iter().flatten()))
        })
    }

    /// Returns the decision values (n, n_problems); positive values favour a problem's positive class.
    fn decision_values<'py>(&self, features: &Object<'py>) -> PyResult<Matrix<'py>> {
        guarded(|| {
            let value = |rows: ArrayView2<f64>| Ok(self.model.decision_values(rows)?);
            let values = predicted(features, |rows| in_parts(rows, value))?;
            let views: Vec<ArrayView2<f64>> = values.iter().map(|part| part.view()).collect();
            let values = concatenate(Axis(0), &views).expect("parts have the same columns");
            Ok(values.into_pyarray(features.py()))
        })
    }

    /// Returns the scores (n, n_classes) of decision values (n, n_problems). A score of one-vs-one is the number of votes plus a term between −1/3 and 1/3.
    fn class_scores<'py>(&self, py: Python<'py>, values: &Object<'py>) -> PyResult<Matrix<'py>> {
        guarded(|| {
            let n_problems = self.model.problems().len();
            let is_shape = |shape: &[usize]| matches!(shape, [_, n] if *n == n_problems);
            let values = array("values", values, "(n, n_problems)", is_shape)?;
            let scores = self.model.class_scores(values.matrix().view());
            Ok(scores.into_pyarray(py))
        })
    }

    /// Binary problems of the SVM, one dict each. A dict contains the classes, the training rows, the signed multipliers, ρ (negative bias), the objective,
    /// the number of iterations, and whether the solver stopped at the iteration cap.
    #[getter]
    fn problems<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let problem = |problem: &bubbletouch::recognition::svm::BinaryProblem| {
            let said = PyDict::new(py);
            let solution = &problem.solution;
            said.set_item("positive", problem.positive)?;
            said.set_item("negative", problem.negative)?;
            said.set_item("rows", to_integers(py, &problem.rows))?;
            said.set_item(
                "coefficients",
                solution.coefficients.clone().into_pyarray(py),
            )?;
            said.set_item("rho", solution.rho)?;
            said.set_item("objective", solution.objective)?;
            said.set_item("n_iterations", solution.n_iterations)?;
            said.set_item("is_capped", solution.is_capped)?;
            Ok(said)
        };
        self.model.problems().iter().map(problem).collect()
    }

    /// Number of binary problems whose training stopped at the iteration cap.
    #[getter]
    fn n_capped(&self) -> usize {
        self.model.n_capped()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Object<'py>, Bound<'py, PyTuple>)> {
        self.training.call(py.get_type::<Self>())
    }
}

/// Parameters of a linear SVM of a Python call, with the names that Python uses.
#[derive(Clone, FromPyObject)]
#[pyo3(from_item_all)]
struct LinearArguments {
    c: f64,
    tolerance: f64,
    is_balanced: bool,
    max_passes: usize,
    seed: u64,
}

/// Trained linear SVM without a kernel matrix for labels 0, 1, …, used by bubbletouch.learning.LinearSVC. Pickling stores its training rows;
/// unpickling trains it again.
#[pyclass(frozen, module = "bubbletouch._core")]
pub struct LinearModel {
    svm: LinearSvm,
    training: Training,
}

#[pymethods]
impl LinearModel {
    /// Trains a linear SVM on features (n, m) and labels (n,). Raises ValueError if an argument is invalid.
    #[staticmethod]
    fn train(features: &Object, labels: &Object, params: Bound<PyDict>) -> PyResult<Self> {
        guarded(|| {
            let asked: LinearArguments = params.extract()?;
            let train = move |rows: &Dataset| {
                let params = LinearSvmParams {
                    c: asked.c,
                    class_weight: class_weight(asked.is_balanced),
                    tolerance: asked.tolerance,
                    max_passes: asked.max_passes,
                };
                Ok(params.train(rows, &Seed::new(asked.seed))?)
            };
            let (svm, training) = Training::run((features, labels), &params, train)?;
            Ok(Self { svm, training })
        })
    }

    /// Returns the predicted labels (n,) of features (n, m).
    fn labels<'py>(&self, features: &Object<'py>) -> PyResult<Vector<'py, i64>> {
        guarded(|| {
            let labels = predicted(features, |rows| Ok(self.svm.labels(rows.view())?))?;
            Ok(to_integers(features.py(), &labels))
        })
    }

    /// Returns the scores (n, n_classes); the class with the largest score is predicted.
    fn scores<'py>(&self, features: &Object<'py>) -> PyResult<Matrix<'py>> {
        guarded(|| {
            let scores = predicted(features, |rows| Ok(self.svm.scores(rows.view())?))?;
            Ok(scores.into_pyarray(features.py()))
        })
    }

    /// Weights of the linear model (n_classes, m).
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.svm.model().weights.clone().into_pyarray(py)
    }

    /// Biases of the linear model (n_classes,).
    #[getter]
    fn bias<'py>(&self, py: Python<'py>) -> Vector<'py> {
        self.svm.model().bias.clone().into_pyarray(py)
    }

    /// Number of passes over the training rows: the largest number of any binary problem.
    #[getter]
    fn n_passes(&self) -> usize {
        let passes = self.svm.convergence().iter().map(|end| end.n_passes);
        passes.max().unwrap_or(0)
    }

    /// Number of binary problems that stopped at max_passes.
    #[getter]
    fn n_capped(&self) -> usize {
        self.svm.n_capped()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Object<'py>, Bound<'py, PyTuple>)> {
        self.training.call(py.get_type::<Self>())
    }
}

/// Evaluates all pairs of C and γ by cross-validation; all pairs share one matrix of inner products.
///
/// gamma_scales: values of γ as multiples of 'scale'; if empty, γ is unchanged.
///
/// Returns a dict with the best C, gamma and accuracy, with `tried` (tuples of C, γ and accuracy) and with n_capped.
#[pyfunction]
pub fn choose_svm<'py>(
    py: Python<'py>,
    features: &Object<'py>,
    labels: &Object<'py>,
    params: Bound<'py, PyDict>,
    folds: Vec<(Object<'py>, Object<'py>)>,
    c: Vec<f64>,
    gamma_scales: Vec<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    guarded(|| {
        let params = params.extract::<SvmArguments>()?.params()?;
        let data = data_of(features, labels)?;
        let fold = |(train, test): &(Object, Object)| {
            Ok(Split {
                train: whole("folds", train)?,
                test: whole("folds", test)?,
            })
        };
        let folds: Vec<Split> = folds.iter().map(fold).collect::<PyResult<_>>()?;
        // Multiples of 'scale', independent of the estimator's γ.
        let params = match gamma_scales.is_empty() {
            true => params,
            false => SvmParams {
                kernel: params.kernel.with_gamma(Gamma::Scale),
                ..params
            },
        };
        let candidates = Candidates { c, gamma_scales };
        let chosen = aside(py, move |_| choose(&params, &data, &folds, &candidates))?;
        let chosen = chosen.map_err(|error| exception(error.into()))?;
        let said = PyDict::new(py);
        let tried = chosen
            .tried
            .iter()
            .map(|one| (one.c, one.gamma, one.accuracy));
        said.set_item("C", chosen.best.c)?;
        said.set_item("gamma", chosen.best.gamma)?;
        said.set_item("accuracy", chosen.best.accuracy)?;
        said.set_item("tried", tried.collect::<Vec<_>>())?;
        said.set_item("n_capped", chosen.n_capped)?;
        Ok(said)
    })
}

fn to_integers<'py, 'a>(
    py: Python<'py>,
    numbers: impl IntoIterator<Item = &'a usize>,
) -> Vector<'py, i64> {
    to_column(py, numbers.into_iter().map(|number| *number as i64))
}
