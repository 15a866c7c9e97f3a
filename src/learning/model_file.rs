//! File of a trained classifier, which `bubbletouch classify` writes and applies to new touches.

use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::inputs::arrays::whole_numbers::KeyValue;
use crate::inputs::content_hash::sha256;
use bubbletouch_svm::classifiers::ClassifierKind;
use bubbletouch_svm::classifiers::trained_classifier::TrainedClassifier;
use bubbletouch_svm::saved::VERSION;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::path::Path;

/// Name of the format, the first field of each file.
const FORMAT: &str = "bubbletouch classifier";

/// Trained classifier, with the values of its labels.
#[derive(Clone, Debug)]
pub struct ModelFile {
    /// Kind of the classifier, such as `rbf_svm`.
    pub kind: ClassifierKind,
    /// Value of each label from 0, as in the label file of the training rows.
    pub classes: Vec<KeyValue>,
    /// Names of the features of the training rows; `None` if they have no names.
    pub columns: Option<Vec<String>>,
    /// Trained classifier, including the scaling of its features.
    pub classifier: TrainedClassifier,
}

/// Content of a file: a JSON object. The hash is that of all other fields that affect predictions.
#[derive(Serialize, Deserialize)]
struct Content {
    format: String,
    version: u32,
    program: String,
    classifier: ClassifierKind,
    sha256: String,
    classes: Box<RawValue>,
    columns: Option<Vec<String>>,
    model: Box<RawValue>,
}

impl Content {
    fn hash(&self) -> String {
        let Self {
            version,
            classes,
            columns,
            model,
            ..
        } = self;
        match columns {
            None => sha256(format!("{version} {classes} {model}")),
            Some(columns) => sha256(format!("{version} {classes} {columns:?} {model}")),
        }
    }
}

impl ModelFile {
    /// Writes the classifier to a file.
    ///
    /// # Errors
    /// If the kind of classifier cannot be saved, or the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let raw = |json: serde_json::Result<Box<RawValue>>| {
            let allowed = "a kernel SVM, linear_svm, logistic_regression, naive_bayes, nearest_centroid, k_nearest or random_forest";
            let place = format!("classifier, {}", self.kind.about().words);
            json.map_err(|error| Error::input(place, error, allowed))
        };
        let mut content = Content {
            format: FORMAT.to_owned(),
            version: VERSION,
            program: concat!("bubbletouch ", env!("CARGO_PKG_VERSION")).to_owned(),
            classifier: self.kind,
            sha256: String::new(),
            classes: raw(serde_json::value::to_raw_value(&self.classes))?,
            columns: self.columns.clone(),
            model: raw(serde_json::value::to_raw_value(&self.classifier))?,
        };
        content.sha256 = content.hash();
        let json = serde_json::to_vec(&content).expect("texts and numbers have a JSON form");
        write_bytes(path, &json)
    }

    /// Reads a classifier that [`write`](Self::write) wrote. Its predictions equal those of the written classifier in all bits.
    ///
    /// # Errors
    /// If the file cannot be read, has another format or version, or was changed.
    pub fn read(path: &Path) -> Result<Self> {
        let allowed = "a file that bubbletouch classify --save wrote";
        let bytes = crate::files::read(path).map_err(|e| Error::unreadable(path, allowed, e))?;
        let refused = |given: String| Error::input(path.display(), given, allowed);
        let foreign = || refused("another format".to_owned());
        let content: Content = serde_json::from_slice(&bytes).map_err(|_| foreign())?;
        if content.format != FORMAT {
            return Err(foreign());
        }
        if content.version != VERSION {
            let given = format!("version {}", content.version);
            let allowed = format!("version {VERSION}, which this program writes");
            return Err(Error::input(path.display(), given, allowed));
        }
        if content.sha256 != content.hash() {
            return Err(refused("a content that was changed".to_owned()));
        }
        let damaged = |error: serde_json::Error| refused(error.to_string());
        Ok(Self {
            kind: content.classifier,
            classes: serde_json::from_str(content.classes.get()).map_err(damaged)?,
            columns: content.columns,
            classifier: serde_json::from_str(content.model.get()).map_err(damaged)?,
        })
    }
}
