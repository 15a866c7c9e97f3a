//! Features from outside of this crate: a function of the measurements of a frame.
//!
//! A [`Foreign`] is the identity of such features: a name and a version. The code behind it is a [`ForeignFeatures`], which a program
//! [provides](Foreign::provide) while it runs a study.

use super::Features;
use crate::error::{Error, Result};
use crate::own::{Own, is_word};
use ndarray::{Array2, ArrayView2};
use serde_json::{Map, Value};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::marker::PhantomData;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Values of parameters of features from outside of this crate, by name.
pub type ForeignParameters = Map<String, Value>;

/// Features from outside of this crate. Several threads may compute them at the same time.
pub trait ForeignFeatures: Send + Sync {
    /// Returns the features (n × k) of n frames of m measurements (n × m). The number k depends on m alone, and each row depends on its frame alone.
    ///
    /// # Errors
    /// If the features cannot be computed.
    fn compute(&self, frames: ArrayView2<f64>) -> Result<Array2<f64>>;

    /// Returns the features with other values of some of their parameters. By default, features have no parameters.
    ///
    /// # Errors
    /// If the features do not have one of the parameters or do not allow its value.
    fn with(&self, parameters: &ForeignParameters) -> Result<Arc<dyn ForeignFeatures>> {
        let names: Vec<&str> = parameters.keys().map(String::as_str).collect();
        Err(Error::input(
            "parameters",
            names.join(", "),
            "none for these features",
        ))
    }
}

/// Identity of features from outside of this crate: their name in tables and charts, and their version. Results of equal identities are interchangeable.
pub type Foreign = Own<ForeignCode>;

/// Code of features from outside of this crate, while a program provides it.
pub struct ForeignCode {
    /// Features of which these are a copy with other values of parameters, and these values; `None` for features that a program provides.
    parameters: Option<(Foreign, ForeignParameters)>,
    provided: Mutex<Vec<Arc<dyn ForeignFeatures>>>,
    /// Number k of features for each number m of measurements for which it is known.
    n_values: Mutex<BTreeMap<usize, usize>>,
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
    /// If features of this crate have the name. If the name or the version does not consist of 1 to 64 letters (A–Z, a–z), digits, `_`, `-` and `.`.
    pub fn new(name: &str, version: &str) -> Result<Self> {
        if !is_word(name) || !is_word(version) || Features::is_own_name(name) {
            let given = format!("{name:?}, version {version:?}");
            let allowed = "a name that no other features have, and 1 to 64 letters, digits, _, - and . in name and version";
            return Err(Error::input("features", given, allowed));
        }
        Ok(Self::known(name, version, None))
    }

    /// Returns the identity of these features with other values of their parameters. The version contains the values.
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
        let code = ForeignCode {
            parameters,
            provided: Mutex::default(),
            n_values: Mutex::default(),
        };
        let new = Self::leak(name.to_owned().leak(), version.to_owned().leak(), code);
        known.push(new);
        new
    }

    /// Returns the identity that a study names: `name@version`, or the name of features that this thread provides. Returns `None` for other texts.
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

    /// Provides the code of these features until the returned value is dropped. Studies that this thread loads meanwhile may use the name alone.
    #[must_use = "the features are provided until the value is dropped"]
    pub fn provide(self, features: Arc<dyn ForeignFeatures>) -> CodeGuard {
        lock(&self.about().provided).push(features.clone());
        GIVEN.with_borrow_mut(|given| given.push(self));
        CodeGuard {
            foreign: self,
            features,
            of_thread: PhantomData,
        }
    }

    /// Returns the features (n × k) of n frames of m measurements (n × m).
    ///
    /// # Errors
    /// If no program provides the code, if the code fails, or if it returns another shape or a value that is not finite.
    pub fn compute(self, frames: ArrayView2<f64>) -> Result<Array2<f64>> {
        let place = format!("features {}", self.name());
        let Some(code) = self.code()? else {
            let given = format!("no code for version {}", self.version());
            let allowed = "the program that provides them, such as bubbletouch.run(…, features={…}) in Python";
            return Err(Error::input(place, given, allowed));
        };
        let made = code.compute(frames)?;
        let (n, k) = made.dim();
        let known = *lock(&self.about().n_values)
            .entry(frames.ncols())
            .or_insert(k);
        if n != frames.nrows() || k == 0 || k != known {
            let given = format!("shape ({n}, {k}) for {} frames", frames.nrows());
            let allowed = format!("({}, {})", frames.nrows(), known.max(1));
            return Err(Error::input(place, given, allowed));
        }
        match made.iter().position(|value| !value.is_finite()) {
            None => Ok(made),
            Some(at) => {
                let given = format!("a value that is not finite, in column {}", at % k);
                Err(Error::input(place, given, "finite numbers"))
            }
        }
    }

    /// Returns the code of these features; `None` if no program provides it.
    fn code(self) -> Result<Option<Arc<dyn ForeignFeatures>>> {
        match &self.about().parameters {
            None => Ok(lock(&self.about().provided).last().cloned()),
            Some((of, parameters)) => of.code()?.map(|code| code.with(parameters)).transpose(),
        }
    }

    /// Checks whether the features have the parameters of this identity. Without the code of the features, nothing is checked.
    ///
    /// # Errors
    /// If [`ForeignFeatures::with`] fails.
    pub fn check_parameters(self) -> Result<()> {
        self.code().map(drop)
    }

    /// Returns the number of features of a frame of m measurements. If the number is unknown, it is computed for a frame of zeros.
    ///
    /// # Errors
    /// If [`compute`](Self::compute) fails.
    pub fn n_values(self, m: usize) -> Result<usize> {
        if let Some(known) = lock(&self.about().n_values).get(&m) {
            return Ok(*known);
        }
        Ok(self.compute(Array2::zeros((1, m)).view())?.ncols())
    }
}

/// Guard that makes user-defined feature code available to studies until the guard is dropped.
pub struct CodeGuard {
    foreign: Foreign,
    features: Arc<dyn ForeignFeatures>,
    /// Marker that prevents the value from leaving the thread that created it.
    of_thread: PhantomData<*const ()>,
}

impl Drop for CodeGuard {
    fn drop(&mut self) {
        let mut provided = lock(&self.foreign.about().provided);
        let place = provided
            .iter()
            .rposition(|one| Arc::ptr_eq(one, &self.features));
        place.map(|place| provided.remove(place));
        GIVEN.with_borrow_mut(|given| {
            let place = given.iter().rposition(|one| *one == self.foreign);
            place.map(|place| given.remove(place));
        });
    }
}
