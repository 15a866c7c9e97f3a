//! Parameters of classifiers. A classifier's file declares the numbers that it needs; studies and `bubbletouch classify` read all declared parameters.

use crate::classifiers::ClassifierKind;
use crate::kernel::Gamma;
use crate::{Error, Result};
use std::collections::BTreeMap;

/// Largest allowed value of integer parameters. Larger counts exceed memory or take too long.
#[doc(hidden)]
pub const MAX_COUNT: f64 = 1e8;

/// Declaration of a numeric parameter of a classifier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Key in `[recognition]`. The option of `bubbletouch classify` has hyphens instead of underscores.
    pub key: &'static str,
    /// Meaning of the parameter in words, such as `constant c₀ of the polynomial kernel`.
    pub words: &'static str,
    /// Whether the parameter allows only integers.
    pub is_integer: bool,
    /// Smallest and largest value that the parameter allows.
    pub range: [f64; 2],
    /// Default value of the parameter, used if no value is given.
    pub default: DefaultValue,
    /// Whether a study file with all default values contains the parameter even if no classifier of the study uses it.
    pub is_always_written: bool,
    /// Whether the value must not exceed the number of training rows.
    pub is_at_most_rows: bool,
}

/// Default value of a classifier's parameter: a number, or a rule that computes the value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DefaultValue {
    /// A number.
    Number(f64),
    /// Rule of the classifier instead of a number: the name of the rule in files, and its meaning in words.
    Rule(&'static str, &'static str),
}

/// Declaration of the width parameter γ of a kernel. At the upper bound, a polynomial kernel of degree 20 over 10,000 features is finite in f64.
pub(crate) const GAMMA: Parameter = Parameter::real(
    "gamma",
    "kernel parameter γ (RBF, polynomial)",
    [1e-12, 1e9],
    DefaultValue::Rule("scale", "1 / (m · variance) of m scaled features"),
);

impl Parameter {
    /// Declares a parameter that is an integer between two bounds, including both.
    pub(crate) const fn integer(
        key: &'static str,
        words: &'static str,
        range: [f64; 2],
        default: DefaultValue,
    ) -> Self {
        Self {
            is_integer: true,
            ..Self::real(key, words, range, default)
        }
    }

    /// Declares a parameter that is a real number between two bounds, including both.
    pub(crate) const fn real(
        key: &'static str,
        words: &'static str,
        range: [f64; 2],
        default: DefaultValue,
    ) -> Self {
        Self {
            key,
            words,
            is_integer: false,
            range,
            default,
            is_always_written: false,
            is_at_most_rows: false,
        }
    }

    /// Declares that a study file with all default values always contains this parameter.
    pub(crate) const fn always_written(self) -> Self {
        Self {
            is_always_written: true,
            ..self
        }
    }

    /// Declares that the value must not exceed the number of training rows.
    pub(crate) const fn at_most_rows(self) -> Self {
        Self {
            is_at_most_rows: true,
            ..self
        }
    }

    /// Returns the default value of the parameter; `None` if the default is a rule.
    pub fn default_number(&self) -> Option<f64> {
        match self.default {
            DefaultValue::Number(number) => Some(number),
            DefaultValue::Rule(..) => None,
        }
    }

    /// Returns whether the parameter allows a value.
    pub fn allows(&self, value: f64) -> bool {
        let [min, max] = self.range;
        (min..=max).contains(&value) && (!self.is_integer || value.fract() == 0.0)
    }

    /// Returns the allowed values in words, such as `at least 1 and at most 20` or `0 to 1e6`.
    pub fn allowed(&self) -> String {
        let [min, max] = self.range;
        match self.is_integer {
            true => format!("at least {min} and at most {max}"),
            false => format!("{} to {}", short(min), short(max)),
        }
    }

    /// Returns the value of an integer parameter whose default is a fixed number.
    pub(crate) fn count(&self, parameters: &Parameters) -> usize {
        self.number(parameters) as usize
    }

    /// Returns the value of a parameter whose default is a number.
    pub(crate) fn number(&self, parameters: &Parameters) -> f64 {
        let value = self.value(parameters);
        value.expect("the default of the parameter is a number")
    }

    /// Returns the value of this parameter, or `None` if the classifier computes the value by its default rule.
    pub(crate) fn value(&self, parameters: &Parameters) -> Option<f64> {
        let given = parameters.get(self.key);
        given.or(self.default_number())
    }
}

/// Formats a number, in exponential notation if it would have many zeros.
fn short(number: f64) -> String {
    match number == 0.0 || (1e-3..1e4).contains(&number.abs()) {
        true => format!("{number}"),
        false => format!("{number:e}"),
    }
}

/// Values of the parameters that a classifier declares.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Parameters(BTreeMap<&'static str, f64>);

impl Parameters {
    /// Returns the default values of all parameters that a kind of classifier declares.
    pub fn new(kind: ClassifierKind) -> Self {
        let declared = kind.about().parameters.iter();
        let numbers = declared.filter_map(|one| Some((one.key, one.default_number()?)));
        Self(numbers.collect())
    }

    /// Returns the value of the parameter with this key. Returns `None` if a rule of the classifier determines it, or if the classifier has no such parameter.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.0.get(key).copied()
    }

    /// Sets the value of a parameter that the given kind of classifier declares.
    ///
    /// # Errors
    /// If the kind declares no parameter with this key, or if the value is not allowed.
    pub(crate) fn set(&mut self, kind: ClassifierKind, key: &str, value: f64) -> Result<()> {
        let mut declared = kind.about().parameters.iter();
        let Some(parameter) = declared.find(|one| one.key == key) else {
            let users = users(key);
            let given = format!("{key} of {}", kind.about().words);
            return Err(Error::input(
                "classifier",
                given,
                format!("{users} uses it"),
            ));
        };
        if !parameter.allows(value) {
            return Err(Error::input(key, value, parameter.allowed()));
        }
        self.0.insert(parameter.key, value);
        Ok(())
    }

    /// Returns the width parameter γ of the kernel.
    pub(crate) fn gamma(&self) -> Gamma {
        GAMMA.value(self).map_or(Gamma::Scale, Gamma::Value)
    }

    /// Sets the width parameter γ of the kernel. Multiples of 'scale' may be outside of the range of given values.
    pub(crate) fn set_gamma(&mut self, gamma: Gamma) {
        match gamma {
            Gamma::Scale => self.0.remove(GAMMA.key),
            Gamma::Value(gamma) => self.0.insert(GAMMA.key, gamma),
        };
    }
}

/// Function that returns whether a kind of classifier uses a key.
type Uses = fn(ClassifierKind) -> bool;

/// Keys of `[recognition]` that several kinds of classifiers share.
const SHARED: [(&str, Uses); 8] = [
    ("class_weight", |kind| kind.about().has_class_weights),
    ("tolerance", ClassifierKind::has_c),
    ("c", ClassifierKind::has_c),
    ("c_grid", ClassifierKind::has_c),
    ("gamma_grid", |kind| {
        kind.is_kernel_svm() && kind.has_gamma()
    }),
    ("multiclass", ClassifierKind::is_kernel_svm),
    ("solver", ClassifierKind::is_kernel_svm),
    ("solver_memory_gib", ClassifierKind::is_kernel_svm),
];

/// Returns all parameters that classifiers declare, without repetitions, in the order of the classifiers.
#[doc(hidden)]
pub fn declared() -> impl Iterator<Item = &'static Parameter> {
    let of = |kind: &ClassifierKind| kind.about().parameters.iter();
    let all = move || ClassifierKind::ALL.iter().flat_map(of);
    let all = all().enumerate().filter(move |(place, parameter)| {
        let mut before = all().take(*place);
        !before.any(|other| other.key == parameter.key)
    });
    all.map(|(_, parameter)| parameter)
}

/// Returns the keys of `[recognition]` that only some classifiers use. A study or a command with such a key needs one of these classifiers.
#[doc(hidden)]
pub fn keys() -> impl Iterator<Item = &'static str> {
    let shared = SHARED.iter().map(|(key, _)| *key);
    shared.chain(declared().map(|parameter| parameter.key))
}

impl ClassifierKind {
    /// Returns whether the training of this kind of classifier depends on the given key (see [`keys`]).
    pub fn uses(self, key: &str) -> bool {
        let mut shared = SHARED.iter().filter(|(shared, _)| *shared == key);
        let mut declared = self.about().parameters.iter();
        shared.any(|(_, is_used)| is_used(self)) || declared.any(|one| one.key == key)
    }
}

/// Returns a list of the classifiers that use a key, by their names in studies, such as `linear_svm or rbf_svm`.
#[doc(hidden)]
pub fn users(key: &str) -> String {
    let all = ClassifierKind::ALL.iter().zip(ClassifierKind::NAMES);
    let users = all.filter(|(kind, _)| kind.uses(key));
    let names: Vec<&str> = users.map(|(_, (name, _))| *name).collect();
    names.join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_has_users_and_one_declaration() {
        for key in keys() {
            assert!(!users(key).is_empty(), "{key}");
            assert_eq!(keys().filter(|other| *other == key).count(), 1, "{key}");
        }
        assert_eq!(users("degree"), "polynomial_svm");
        assert_eq!(users("max_depth"), "random_forest");
        assert!(users("gamma").starts_with("rbf_svm or polynomial_svm"));
        for kind in ClassifierKind::ALL {
            for parameter in kind.about().parameters {
                let mut all = declared();
                let first = all.find(|one| one.key == parameter.key);
                assert_eq!(
                    first,
                    Some(parameter),
                    "{kind:?}: two declarations of a key"
                );
            }
        }
    }

    #[test]
    fn defaults_are_allowed_and_values_outside_of_the_range_are_not() {
        for kind in ClassifierKind::ALL {
            for parameter in kind.about().parameters {
                let mut parameters = Parameters::new(*kind);
                assert_eq!(parameters.get(parameter.key), parameter.default_number());
                assert!(
                    parameter
                        .default_number()
                        .is_none_or(|n| parameter.allows(n))
                );
                let [min, max] = parameter.range;
                for value in [min, max] {
                    parameters.set(*kind, parameter.key, value).unwrap();
                    assert_eq!(parameters.get(parameter.key), Some(value));
                }
                for value in [min - 1.0, 2.0 * max, f64::NAN] {
                    let error = parameters.set(*kind, parameter.key, value).unwrap_err();
                    let error = error.to_string();
                    assert!(error.contains(&parameter.allowed()), "{error}");
                }
                let half = parameters.set(*kind, parameter.key, 1.5);
                assert_eq!(half.is_err(), parameter.is_integer, "{}", parameter.key);
            }
        }
        let mut parameters = Parameters::new(ClassifierKind::LinearSvm);
        let error = parameters.set(ClassifierKind::LinearSvm, "n_trees", 3.0);
        assert!(error.unwrap_err().to_string().contains("random_forest"));
    }
}
