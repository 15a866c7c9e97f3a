//! Classifiers from outside of this crate. A study trains and tests such classifiers like the kinds of this crate.
//!
//! A [`Foreign`] is the identity of such a classifier: a name and a version. The code behind it is a [`ForeignClassifier`], which a program
//! [provides](Foreign::provide) while it runs a study. [`LinfaClassifier`] adapts any classifier that implements linfa's traits.

use crate::class_model::{ClassModel, log_vote_shares};
use crate::classifiers::ClassifierKind;
use crate::classifiers::classifier_about::ClassifierAbout;
use crate::dataset::{Dataset, check_width, checked_classes};
use crate::streams::Streams;
use crate::{Error, Result};
use linfa::traits::{Fit, PredictInplace};
use ndarray::{Array1, Array2, ArrayView2, s};
use rand::RngCore;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};
use std::cell::RefCell;
use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::marker::PhantomData;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Maximum number of letters of a name or a version. Longer texts do not fit into a column of a table.
const MAX_LETTERS: usize = 64;

/// Values of parameters of a classifier from outside of this crate, by name.
pub type ForeignParameters = Map<String, Value>;

/// Classifier from outside of this crate. Several threads may train it at the same time.
pub trait ForeignClassifier: Send + Sync {
    /// Trains a model on scaled rows (n_rows × m) with one label per row. Random draws depend on `seed` alone, so that equal rows and seeds give equal models.
    ///
    /// # Errors
    /// If the classifier cannot be trained.
    fn fit(&self, rows: &Dataset, seed: u32) -> Result<Box<dyn ForeignModel>>;

    /// Trains a model as [`fit`](Self::fit) does; `groups` contains the group of each row. By default, groups are not used.
    ///
    /// # Errors
    /// If the classifier cannot be trained.
    fn fit_groups(
        &self,
        rows: &Dataset,
        groups: &[usize],
        seed: u32,
    ) -> Result<Box<dyn ForeignModel>> {
        let _ = groups;
        self.fit(rows, seed)
    }

    /// Returns the classifier with other values of some of its parameters. By default, a classifier has no parameters.
    ///
    /// # Errors
    /// If the classifier does not have one of the parameters or does not allow its value.
    fn with(&self, parameters: &ForeignParameters) -> Result<Arc<dyn ForeignClassifier>> {
        Err(no_parameters(parameters))
    }

    /// Checks whether the classifier can be trained, before any row is known.
    ///
    /// # Errors
    /// If something that every training needs is missing, such as a program.
    fn check(&self) -> Result<()> {
        Ok(())
    }

    /// Returns whether another machine may have what [`check`](Self::check) misses on this machine.
    fn may_be_elsewhere(&self) -> bool {
        false
    }
}

fn no_parameters(given: &ForeignParameters) -> Error {
    let names: Vec<&str> = given.keys().map(String::as_str).collect();
    Error::input("parameters", names.join(", "), "none for this classifier")
}

/// Trained model of a [`ForeignClassifier`].
pub trait ForeignModel: Send + Sync {
    /// Returns the predicted label of each scaled row (n_rows × m). Each label is one of the training labels.
    ///
    /// # Errors
    /// If the model cannot predict.
    fn predict(&self, rows: ArrayView2<f64>) -> Result<Vec<usize>>;

    /// Returns whether each call that predicts also trains. The time of such a call is training time, too.
    fn trains_in_predictions(&self) -> bool {
        false
    }

    /// Returns the log-probability of each class given the row, shape (n_rows, n_classes), in ascending order of the labels. A decision on
    /// several touches adds these values; the prior that they contain counts once for each touch. Returns `None` if the model predicts labels alone; a decision
    /// on several touches then counts the labels as votes.
    ///
    /// # Errors
    /// If the model cannot predict.
    fn log_probabilities(&self, rows: ArrayView2<f64>) -> Result<Option<Array2<f64>>> {
        let _ = rows;
        Ok(None)
    }
}

/// Identity of a classifier from outside of this crate: its name and its version. Results of equal identities are interchangeable.
#[derive(Clone, Copy)]
pub struct Foreign(&'static ForeignAbout);

struct ForeignAbout {
    name: String,
    version: String,
    about: ClassifierAbout,
    /// Classifier of which this one is a copy with other values of parameters, and these values; `None` for a classifier that a program provides.
    parameters: Option<(Foreign, ForeignParameters)>,
    provided: Mutex<Vec<Arc<dyn ForeignClassifier>>>,
}

/// All identities that this process has used. Identities are never removed, because every configuration of a study refers to its identity.
static KNOWN: Mutex<Vec<Foreign>> = Mutex::new(Vec::new());

thread_local! {
    /// Identities that this thread provides, in the order of their provision.
    static GIVEN: RefCell<Vec<Foreign>> = const { RefCell::new(Vec::new()) };
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Foreign {
    /// Returns the identity with this name and version.
    ///
    /// # Errors
    /// If a kind of this crate has the name. If the name or the version does not consist of 1 to 64 letters (A–Z, a–z), digits, `_`, `-` and `.`.
    pub fn new(name: &str, version: &str) -> Result<Self> {
        let is_letter = |letter: char| letter.is_ascii_alphanumeric() || "_-.".contains(letter);
        let is_word =
            |text: &str| (1..=MAX_LETTERS).contains(&text.len()) && text.chars().all(is_letter);
        let is_taken = ClassifierKind::NAMES
            .iter()
            .any(|(known, _)| *known == name);
        if !is_word(name) || !is_word(version) || is_taken {
            let given = format!("{name:?}, version {version:?}");
            let allowed = "a name that no other classifier has, and 1 to 64 letters, digits, _, - and . in name and version";
            return Err(Error::input("classifier", given, allowed));
        }
        Ok(Self::known(name, version, None))
    }

    /// Returns the identity of this classifier with other values of its parameters. The version contains the values.
    #[must_use]
    pub fn with(self, parameters: &ForeignParameters) -> Self {
        if parameters.is_empty() {
            return self;
        }
        let values = Value::Object(parameters.clone());
        let version = format!("{} {values}", self.version());
        Self::known(self.name(), &version, Some((self, parameters.clone())))
    }

    /// Returns the identity with this name and version, which the first call creates.
    fn known(name: &str, version: &str, parameters: Option<(Self, ForeignParameters)>) -> Self {
        let mut known = lock(&KNOWN);
        let found = known
            .iter()
            .find(|one| one.name() == name && one.version() == version);
        if let Some(found) = found {
            return *found;
        }
        let words: &'static str = Box::leak(name.to_owned().into_boxed_str());
        let new = Self(Box::leak(Box::new(ForeignAbout {
            name: name.to_owned(),
            version: version.to_owned(),
            about: ClassifierAbout::new(words, |classifier, scaled, _, seed| {
                match classifier.kind {
                    ClassifierKind::Foreign(foreign) => {
                        foreign.train(scaled, classifier.groups.as_deref(), seed)
                    }
                    _ => unreachable!("this descriptor belongs to foreign classifiers"),
                }
            }),
            parameters,
            provided: Mutex::default(),
        })));
        known.push(new);
        new
    }

    /// Returns the identity that a study names: `name@version`, or the name of a classifier that this thread provides. Returns `None` for other texts.
    pub fn named(text: &str) -> Option<Self> {
        if let Some((name, version)) = text.split_once('@') {
            return Self::new(name, version).ok();
        }
        Self::given()
            .into_iter()
            .rev()
            .find(|one| one.name() == text)
    }

    /// Returns the identities that this thread provides.
    pub fn given() -> Vec<Self> {
        GIVEN.with_borrow(Clone::clone)
    }

    /// Provides the code of this classifier until the returned value is dropped. Studies that this thread loads meanwhile may use the name alone.
    #[must_use = "the classifier is provided until the value is dropped"]
    pub fn provide(self, classifier: Arc<dyn ForeignClassifier>) -> CodeGuard {
        lock(&self.0.provided).push(classifier.clone());
        GIVEN.with_borrow_mut(|given| given.push(self));
        CodeGuard {
            foreign: self,
            classifier,
            of_thread: PhantomData,
        }
    }

    /// Provides the code of this classifier until the process ends. The code of an earlier call is replaced.
    pub fn install(self, classifier: Arc<dyn ForeignClassifier>) {
        *lock(&self.0.provided) = vec![classifier];
    }

    /// Returns whether a program provides the code of this classifier.
    pub fn is_provided(self) -> bool {
        match &self.0.parameters {
            Some((of, _)) => of.is_provided(),
            None => !lock(&self.0.provided).is_empty(),
        }
    }

    /// Name of the classifier in tables and charts.
    pub fn name(&self) -> &'static str {
        &self.0.name
    }

    /// Version of the classifier. Results of different versions are kept apart.
    pub fn version(&self) -> &'static str {
        &self.0.version
    }

    pub(crate) const fn about(self) -> &'static ClassifierAbout {
        &self.0.about
    }

    /// Checks whether the classifier has the parameters of this identity. Without the code of the classifier, nothing is checked.
    ///
    /// # Errors
    /// If [`ForeignClassifier::with`] fails.
    pub fn check_parameters(self) -> Result<()> {
        match self.is_provided() {
            true => self.code().map(drop),
            false => Ok(()),
        }
    }

    /// Returns an error if no program provides the code of this classifier, or the code cannot train.
    ///
    /// # Errors
    /// If no program provides the code, or [`ForeignClassifier::check`] fails.
    pub fn check_provided(self) -> Result<()> {
        self.code()?.check()
    }

    /// Returns whether the code of this classifier is provided, and another machine may have what its check misses on this machine.
    pub fn may_be_elsewhere(self) -> bool {
        self.code().is_ok_and(|code| code.may_be_elsewhere())
    }

    fn code(self) -> Result<Arc<dyn ForeignClassifier>> {
        if let Some((of, parameters)) = &self.0.parameters {
            return of.code()?.with(parameters);
        }
        let code = lock(&self.0.provided).last().cloned();
        code.ok_or_else(|| {
            let allowed = "the program that provides it, such as bubbletouch.run(…, classifiers={…}) in Python";
            Error::input(self.place(), format!("no code for version {}", self.version()), allowed)
        })
    }

    fn place(self) -> String {
        format!("classifier {}", self.name())
    }

    fn train(
        self,
        scaled: &Dataset,
        groups: Option<&[usize]>,
        seed: &dyn Streams,
    ) -> Result<Arc<dyn ClassModel>> {
        let classes = checked_classes(scaled)?;
        // Seeds of NumPy and scikit-learn have 32 bits.
        let seed = seed.named("foreign").rng().next_u32();
        let model = match groups {
            Some(groups) => self.code()?.fit_groups(scaled, groups, seed)?,
            None => self.code()?.fit(scaled, seed)?,
        };
        let first = scaled.records.slice(s![..1, ..]);
        let has_probabilities = model.log_probabilities(first)?.is_some();
        Ok(Arc::new(ForeignClassModel {
            foreign: self,
            n_features: scaled.records.ncols(),
            has_probabilities,
            classes,
            model,
        }))
    }
}

impl PartialEq for Foreign {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for Foreign {}

impl Hash for Foreign {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (self.name(), self.version()).hash(state);
    }
}

impl Ord for Foreign {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.name(), self.version()).cmp(&(other.name(), other.version()))
    }
}

impl PartialOrd for Foreign {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Writes the name and the version, as in the names of work items: `Foreign(mine@1)`.
impl fmt::Debug for Foreign {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Writes the name and the version, as in a study file: `mine@1`.
impl fmt::Display for Foreign {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}@{}", self.name(), self.version())
    }
}

/// Serialises the name, as tables contain it.
impl Serialize for Foreign {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Guard that makes a user-defined classifier's code available to studies until the guard is dropped.
pub struct CodeGuard {
    foreign: Foreign,
    classifier: Arc<dyn ForeignClassifier>,
    /// Marker that prevents the value from leaving the thread that created it.
    of_thread: PhantomData<*const ()>,
}

impl Drop for CodeGuard {
    fn drop(&mut self) {
        let mut provided = lock(&self.foreign.0.provided);
        let place = provided
            .iter()
            .rposition(|one| Arc::ptr_eq(one, &self.classifier));
        place.map(|place| provided.remove(place));
        GIVEN.with_borrow_mut(|given| {
            let place = given.iter().rposition(|one| *one == self.foreign);
            place.map(|place| given.remove(place));
        });
    }
}

/// Trained foreign model whose predictions are checked.
struct ForeignClassModel {
    foreign: Foreign,
    classes: Vec<usize>,
    n_features: usize,
    /// Whether the model returns log-probabilities; otherwise, it predicts labels alone.
    has_probabilities: bool,
    model: Box<dyn ForeignModel>,
}

impl fmt::Debug for ForeignClassModel {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", self.foreign)
    }
}

impl ForeignClassModel {
    /// Returns the index of each predicted label in the list of classes.
    fn places(&self, features: ArrayView2<f64>) -> Result<Vec<usize>> {
        check_width(&features, self.n_features)?;
        let labels = self.model.predict(features)?;
        let error =
            |given: String, allowed| Err(Error::input(self.foreign.place(), given, allowed));
        if labels.len() != features.nrows() {
            let given = format!("{} labels for {} rows", labels.len(), features.nrows());
            return error(given, "one label a row");
        }
        let places = labels
            .iter()
            .map(|label| self.classes.binary_search(label).map_err(|_| *label));
        match places.collect() {
            Ok(places) => Ok(places),
            Err(label) => error(format!("label {label}"), "labels of the training rows"),
        }
    }
}

impl ClassModel for ForeignClassModel {
    fn trains_in_predictions(&self) -> bool {
        self.model.trains_in_predictions()
    }

    fn classes(&self) -> &[usize] {
        &self.classes
    }

    fn scores(&self, features: ArrayView2<f64>) -> Result<Array2<f64>> {
        let shape = (features.nrows(), self.classes.len());
        check_width(&features, self.n_features)?;
        if self.has_probabilities
            && let Some(scores) = self.model.log_probabilities(features)?
        {
            if scores.dim() == shape && !scores.iter().any(|score| score.is_nan()) {
                // −∞ would exclude a class in all further touches.
                return Ok(scores.mapv(|score| score.max(f64::MIN_POSITIVE.ln())));
            }
            let given = format!("log-probabilities of shape {:?}", scores.dim());
            let allowed = format!("{shape:?}, without NaN");
            return Err(Error::input(self.foreign.place(), given, allowed));
        }
        let mut votes = Array2::zeros(shape);
        for (row, place) in self.places(features)?.into_iter().enumerate() {
            votes[[row, place]] = 1.0;
        }
        Ok(log_vote_shares(votes))
    }

    fn has_own_labels(&self) -> bool {
        self.has_probabilities
    }

    fn labels(&self, features: ArrayView2<f64>) -> Result<Array1<usize>> {
        let places = self.places(features)?;
        Ok(places
            .into_iter()
            .map(|place| self.classes[place])
            .collect())
    }
}

/// Function that creates linfa's parameters from values in a study.
type MakeParams<P> = dyn Fn(&ForeignParameters) -> Result<P> + Send + Sync;

/// [`ForeignClassifier`] for parameters that implement linfa's `Fit` and whose models implement `PredictInplace`. The parameters contain their own seed.
pub struct LinfaClassifier<P, E> {
    params: P,
    make: Option<Arc<MakeParams<P>>>,
    error: PhantomData<fn() -> E>,
}

impl<P, E> LinfaClassifier<P, E> {
    /// Creates a classifier from parameters that implement linfa's `Fit`.
    pub fn new(params: P) -> Self {
        Self {
            params,
            make: None,
            error: PhantomData,
        }
    }

    /// Returns a classifier whose parameters a study may set. `make` creates linfa's parameters from the values in the study; it refuses unknown names.
    #[must_use]
    pub fn with_parameters(
        self,
        make: impl Fn(&ForeignParameters) -> Result<P> + Send + Sync + 'static,
    ) -> Self {
        Self {
            make: Some(Arc::new(make)),
            ..self
        }
    }
}

impl<P, E> ForeignClassifier for LinfaClassifier<P, E>
where
    P: Fit<Array2<f64>, Array1<usize>, E> + Send + Sync + 'static,
    P::Object: PredictInplace<Array2<f64>, Array1<usize>> + Send + Sync + 'static,
    E: std::error::Error + From<linfa::Error> + 'static,
{
    fn with(&self, parameters: &ForeignParameters) -> Result<Arc<dyn ForeignClassifier>> {
        let make = self.make.as_ref();
        let params =
            make.map_or_else(|| Err(no_parameters(parameters)), |make| make(parameters))?;
        Ok(Arc::new(Self::new(params)))
    }

    fn fit(&self, rows: &Dataset, _: u32) -> Result<Box<dyn ForeignModel>> {
        let fitted = self.params.fit(rows);
        let model =
            fitted.map_err(|error| Error::input("classifier", error, "see its documentation"))?;
        Ok(Box::new(LinfaModel(model)))
    }
}

struct LinfaModel<M>(M);

impl<M: PredictInplace<Array2<f64>, Array1<usize>> + Send + Sync> ForeignModel for LinfaModel<M> {
    fn predict(&self, rows: ArrayView2<f64>) -> Result<Vec<usize>> {
        let rows = rows.to_owned();
        let mut labels = self.0.default_target(&rows);
        self.0.predict_inplace(&rows, &mut labels);
        Ok(labels.to_vec())
    }
}
