//! Trained classifiers as data of serde.
//!
//! A saved classifier predicts the same bits as the classifier itself. Arrays are written as a shape and the bits of their elements in hexadecimal digits,
//! because decimal numbers cannot represent NaN or infinity. Other numbers need a format that keeps all bits of an f64.

use std::sync::Arc;

use ndarray::{Array, ArrayD, Dimension, IxDyn};
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::class_model::ClassModel;
use crate::classifiers::k_nearest::KNearest;
use crate::classifiers::logistic_regression::Logistic;
use crate::classifiers::naive_bayes::NaiveBayes;
use crate::classifiers::nearest_centroid::NearestCentroid;
use crate::classifiers::random_forest::RandomForest;
use crate::linalg::scalar::Scalar;
use crate::linear_svm::LinearSvm;
use crate::predict::svm_model::SvmModel;

/// Version of the data. A change of the fields of a model needs another version, because older data cannot be read any more.
#[doc(hidden)]
pub const VERSION: u32 = 2;

/// Checks the version of data that were read.
///
/// # Errors
/// If the data have another version.
pub(crate) fn check_version(version: u32) -> crate::Result<()> {
    match version == VERSION {
        true => Ok(()),
        false => Err(crate::Error::input(
            "saved model",
            format!("version {version}"),
            format!("version {VERSION} is needed; train and save the model anew"),
        )),
    }
}

/// Returns the error of data whose parts do not fit each other.
pub(crate) fn damaged(place: &str) -> crate::Error {
    let allowed = "the data that serialisation wrote are needed";
    crate::Error::input(place, "parts of different sizes", allowed)
}

/// Model of each kind of classifier that can be saved.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SavedModel {
    /// Kernel SVM.
    Svm(Box<SvmModel>),
    /// Linear SVM of coordinate descent.
    LinearSvm(LinearSvm),
    /// Logistic regression.
    LogisticRegression(Logistic),
    /// Gaussian naive Bayes.
    NaiveBayes(NaiveBayes),
    /// Nearest centroid.
    NearestCentroid(NearestCentroid),
    /// k nearest neighbours.
    KNearest(KNearest),
    /// Random forest.
    RandomForest(RandomForest),
}

/// Writes a model of a kind that can be saved.
pub(crate) fn serialize_model<S: Serializer>(
    model: &Arc<dyn ClassModel>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let refused = || S::Error::custom("the kind of classifier cannot be saved");
    let saved = model.saved().ok_or_else(refused)?;
    saved.serialize(serializer)
}

/// Reads a model that [`serialize_model`] wrote.
pub(crate) fn deserialize_model<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Arc<dyn ClassModel>, D::Error> {
    Ok(match SavedModel::deserialize(deserializer)? {
        SavedModel::Svm(model) => Arc::new(*model),
        SavedModel::LinearSvm(model) => Arc::new(model),
        SavedModel::LogisticRegression(model) => Arc::new(model),
        SavedModel::NaiveBayes(model) => Arc::new(model),
        SavedModel::NearestCentroid(model) => Arc::new(model),
        SavedModel::KNearest(model) => Arc::new(model),
        SavedModel::RandomForest(model) => Arc::new(model),
    })
}

/// Number of hexadecimal digits of an element.
const DIGITS: usize = 16;

/// Writes an array as its shape and the bits of its elements.
pub(crate) fn serialize<T: Scalar, D: Dimension, S: Serializer>(
    array: &Array<T, D>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let bits = array
        .iter()
        .map(|value| format!("{:016x}", value.wide().to_bits()));
    (array.shape(), bits.collect::<String>()).serialize(serializer)
}

/// Reads an array that [`serialize`] wrote.
pub(crate) fn deserialize<'de, T: Scalar, D: Dimension, E: Deserializer<'de>>(
    deserializer: E,
) -> Result<Array<T, D>, E::Error> {
    let (shape, text) = <(Vec<usize>, String)>::deserialize(deserializer)?;
    let value = |digits: &[u8]| {
        let bits = u64::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()?;
        Some(T::from_f64(f64::from_bits(bits)))
    };
    let values: Option<Vec<T>> = text.as_bytes().chunks(DIGITS).map(value).collect();
    let array = values.and_then(|values| ArrayD::from_shape_vec(IxDyn(&shape), values).ok());
    let array = array.and_then(|array| array.into_dimensionality().ok());
    array.ok_or_else(|| E::Error::custom("the elements of an array do not fit its shape"))
}
