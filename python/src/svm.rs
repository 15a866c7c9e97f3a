//! Models behind the estimators of `bubbletouch.learning`: soft-margin SVMs trained on features and labels 0, 1, …

use crate::arrays::{Matrix, Object, Vector, array, to_column, whole_numbers};
use crate::errors::{bad_input, exception, guarded, one_of};
use crate::threads::{aside, pool};
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
use pyo3::types::{PyDict, PyTuple};
use rayon::prelude::*;
use std::sync::Arc;

/// Reads feature rows as an array of numbers.
fn rows_of(given: &Object) -> PyResult<Array2<f64>> {
    let is_shape = |shape: &[usize]| shape.len() == 2;
    let rows = array("features", given, "(n_rows, n_features)", is_shape)?;
    let shape = (rows.shape()[0], rows.shape()[1]);
    let rows = Array2::from_shape_vec(shape, rows.values().to_vec());
    Ok(rows.expect("as many numbers as the shape"))
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
    let (py, features, pool) = (features.py(), rows_of(features)?, pool()?);
    let predicted = py.detach(|| pool.install(|| predict(&features)));
    predicted.map_err(exception)
}

/// Trains a model; returns it together with its training data as Python objects. Models are pickled as their training data.
fn trained<T: Send + 'static>(
    features: &Object,
    labels: &Object,
    train: impl FnOnce(&Dataset) -> bubbletouch::Result<T> + Send + 'static,
) -> PyResult<(T, Arc<Dataset>)> {
    let data = Arc::new(data_of(features, labels)?);
    let rows = Arc::clone(&data);
    let model = aside(features.py(), move |_| train(&rows))?;
    Ok((model.map_err(exception)?, data))
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
    /// Arguments of the training: pickling stores them, and unpickling trains again with them.
    asked: Py<PyDict>,
    data: Arc<Dataset>,
}

#[pymethods]
impl KernelSvm {
    /// Trains an SVM on features (n, m) and labels (n,). Raises ValueError if an argument is invalid.
    #[staticmethod]
    fn train(features: &Object, labels: &Object, params: Bound<PyDict>) -> PyResult<Self> {
        guarded(|| {
            let asked = params.extract::<SvmArguments>()?.params()?;
            let (model, data) = trained(features, labels, move |rows| Ok(asked.train(rows)?))?;
            let asked = params.copy()?.unbind();
            Ok(Self { model, asked, data })
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
        let train = py.get_type::<Self>().getattr("train")?;
        let (features, labels) = arrays_of(py, &self.data);
        Ok((
            train,
            (features, labels, self.asked.bind(py)).into_pyobject(py)?,
        ))
    }
}

/// Trained linear SVM without a kernel matrix for labels 0, 1, …, used by bubbletouch.learning.LinearSVC. Pickling stores its training rows;
/// unpickling trains it again.
#[pyclass(frozen, module = "bubbletouch._core")]
pub struct LinearModel {
    svm: LinearSvm,
    asked: (f64, bool, f64, usize, u64),
    data: Arc<Dataset>,
}

#[pymethods]
impl LinearModel {
    /// Trains a linear SVM on features (n, m) and labels (n,). Raises ValueError if an argument is invalid.
    #[staticmethod]
    fn train(
        features: &Object,
        labels: &Object,
        c: f64,
        is_balanced: bool,
        tolerance: f64,
        max_passes: i64,
        seed: u64,
    ) -> PyResult<Self> {
        guarded(|| {
            let max_passes = usize::try_from(max_passes)
                .map_err(|_| bad_input("max_iter", max_passes, "at least 1"))?;
            let params = LinearSvmParams {
                c,
                class_weight: class_weight(is_balanced),
                tolerance,
                max_passes,
            };
            let seeded = Seed::new(seed);
            let (svm, data) = trained(features, labels, move |rows| {
                Ok(params.train(rows, &seeded)?)
            })?;
            let asked = (c, is_balanced, tolerance, max_passes, seed);
            Ok(Self { svm, asked, data })
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
        let train = py.get_type::<Self>().getattr("train")?;
        let (features, labels) = arrays_of(py, &self.data);
        let (c, is_balanced, tolerance, max_passes, seed) = &self.asked;
        let given = (
            features,
            labels,
            c,
            is_balanced,
            tolerance,
            max_passes,
            seed,
        );
        Ok((train, given.into_pyobject(py)?))
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

fn arrays_of<'py>(py: Python<'py>, data: &Dataset) -> (Matrix<'py>, Vector<'py, i64>) {
    let features = data.records.clone().into_pyarray(py);
    (features, to_integers(py, &data.targets))
}

fn to_integers<'py, 'a>(
    py: Python<'py>,
    numbers: impl IntoIterator<Item = &'a usize>,
) -> Vector<'py, i64> {
    to_column(py, numbers.into_iter().map(|number| *number as i64))
}
