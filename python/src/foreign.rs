//! Classifiers and features of a study whose code is in Python.
//!
//! The objects come from `bubbletouch/_foreign.py`. A trainer has the methods `fit(rows, labels, seed, groups)`, `predict(model, rows)` and
//! `log_probabilities(model, rows)`. A function has the method `compute(frames)`. Both have `with_parameters(json)`, which returns a copy.

use bubbletouch::recognition::classifiers::foreign as classifiers;
use bubbletouch::recognition::data::dataset::Dataset;
use bubbletouch::recognition::features::foreign as features;
use bubbletouch::recognition::svm;
use bubbletouch::{Error, Result};
use ndarray::{Array2, ArrayView2};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex};

/// Name, version and object of a classifier or of features.
pub type Given = (String, String, Py<PyAny>);

/// First exception of the Python code of a study: of a classifier, of features or of the callback.
#[derive(Clone, Default)]
pub struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    /// Stores an exception unless there is one.
    pub fn keep(&self, error: PyErr) {
        if let Ok(mut raised) = self.0.lock() {
            raised.get_or_insert(error);
        }
    }

    /// Returns the stored exception, and forgets it.
    pub fn take(&self) -> Option<PyErr> {
        self.0.lock().ok()?.take()
    }
}

/// Classifiers and features that are provided while the value exists.
pub struct Provided {
    _classifiers: Vec<classifiers::CodeGuard>,
    _features: Vec<features::CodeGuard>,
}

/// Python object with its name for error messages.
struct Object {
    place: String,
    object: Py<PyAny>,
    raised: Raised,
}

impl Object {
    /// Calls the Python object. Converts an exception to an error that names the object.
    fn call<T>(
        &self,
        allowed: &str,
        call: impl FnOnce(&Bound<PyAny>) -> PyResult<T>,
    ) -> svm::Result<T> {
        Python::attach(|py| {
            call(self.object.bind(py)).map_err(|error| {
                let given = error.to_string();
                self.raised.keep(error);
                svm::Error::input(&self.place, given, allowed)
            })
        })
    }

    /// Returns the object with other values of its parameters.
    fn with(&self, parameters: &classifiers::ForeignParameters) -> svm::Result<Self> {
        let values = serde_json::Value::Object(parameters.clone()).to_string();
        let object = self.call("parameters that it has", |object| {
            Ok(object.call_method1("with_parameters", (values,))?.unbind())
        })?;
        Ok(Self {
            place: self.place.clone(),
            object,
            raised: self.raised.clone(),
        })
    }
}

const FIT: &str = "a fit without an exception";
const PREDICT: &str = "one whole-numbered label of training for each row";

struct Trainer(Arc<Object>);

struct Model {
    trainer: Arc<Object>,
    model: Py<PyAny>,
}

impl Trainer {
    fn train(
        &self,
        rows: &Dataset,
        groups: Option<&[usize]>,
        seed: u32,
    ) -> svm::Result<Box<dyn classifiers::ForeignModel>> {
        let groups: Option<Vec<i64>> =
            groups.map(|groups| groups.iter().map(|&group| group as i64).collect());
        let model = self.0.call(FIT, |object| {
            let py = object.py();
            let labels = rows.targets.mapv(|label| label as i64);
            let groups = groups.map(|groups| groups.to_pyarray(py));
            let given = (
                rows.records.to_pyarray(py),
                labels.to_pyarray(py),
                seed,
                groups,
            );
            Ok(object.call_method1("fit", given)?.unbind())
        })?;
        let trainer = self.0.clone();
        Ok(Box::new(Model { trainer, model }))
    }
}

impl classifiers::ForeignClassifier for Trainer {
    fn with(
        &self,
        parameters: &classifiers::ForeignParameters,
    ) -> svm::Result<Arc<dyn classifiers::ForeignClassifier>> {
        Ok(Arc::new(Self(Arc::new(self.0.with(parameters)?))))
    }

    fn fit(&self, rows: &Dataset, seed: u32) -> svm::Result<Box<dyn classifiers::ForeignModel>> {
        self.train(rows, None, seed)
    }

    fn fit_groups(
        &self,
        rows: &Dataset,
        groups: &[usize],
        seed: u32,
    ) -> svm::Result<Box<dyn classifiers::ForeignModel>> {
        self.train(rows, Some(groups), seed)
    }
}

impl classifiers::ForeignModel for Model {
    fn predict(&self, rows: ArrayView2<f64>) -> svm::Result<Vec<usize>> {
        self.trainer.call(PREDICT, |object| {
            let py = object.py();
            let given = (self.model.bind(py), rows.to_pyarray(py));
            let labels = object.call_method1("predict", given)?;
            let labels = labels.cast_into::<PyArray1<i64>>()?.readonly();
            // A negative label is replaced by a label that no training row has.
            let label = |&label: &i64| usize::try_from(label).unwrap_or(usize::MAX);
            Ok(labels.as_array().iter().map(label).collect())
        })
    }

    fn log_probabilities(&self, rows: ArrayView2<f64>) -> svm::Result<Option<Array2<f64>>> {
        self.trainer
            .call("log-probabilities of all classes", |object| {
                let py = object.py();
                let given = (self.model.bind(py), rows.to_pyarray(py));
                let found = object.call_method1("log_probabilities", given)?;
                let found: Option<PyReadonlyArray2<f64>> = found.extract()?;
                Ok(found.map(|found| found.as_array().to_owned()))
            })
    }
}

struct Function(Object);

impl features::ForeignFeatures for Function {
    fn with(
        &self,
        parameters: &features::ForeignParameters,
    ) -> Result<Arc<dyn features::ForeignFeatures>> {
        Ok(Arc::new(Self(self.0.with(parameters)?)))
    }

    fn compute(&self, frames: ArrayView2<f64>) -> Result<Array2<f64>> {
        let computed = self.0.call("a function without an exception", |object| {
            let made = object.call_method1("compute", (frames.to_pyarray(object.py()),))?;
            let made = made.cast_into::<PyArray2<f64>>()?.readonly();
            Ok(made.as_array().to_owned())
        });
        computed.map_err(Error::from)
    }
}

/// Provides the classifiers and features of a call of `bubbletouch.run`.
///
/// # Errors
/// If a name or a version is invalid.
pub fn provide(
    [of_classifiers, of_features]: [Vec<Given>; 2],
    raised: &Raised,
) -> Result<Provided> {
    let object = |what: &str, name: &str, object| Object {
        place: format!("{what} {name}"),
        object,
        raised: raised.clone(),
    };
    let of_classifiers = of_classifiers.into_iter().map(|(name, version, given)| {
        let trainer = Trainer(Arc::new(object("classifier", &name, given)));
        Ok(classifiers::Foreign::new(&name, &version)?.provide(Arc::new(trainer)))
    });
    let of_features = of_features.into_iter().map(|(name, version, given)| {
        let function = Function(object("features", &name, given));
        Ok(features::Foreign::new(&name, &version)?.provide(Arc::new(function)))
    });
    Ok(Provided {
        _classifiers: of_classifiers.collect::<Result<_>>()?,
        _features: of_features.collect::<Result<_>>()?,
    })
}
