//! Descriptors of the kinds of classifiers: names, parameters, and training functions.

use crate::class_model::ClassModel;
use crate::classifiers::ClassifierKind;
use crate::classifiers::classifier::Classifier;
use crate::classifiers::parameters::{GAMMA, Parameter, Parameters};
use crate::dataset::Dataset;
use crate::error::Result;
use crate::kernel::Kernel;
use crate::streams::Streams;
use std::fmt;
use std::sync::Arc;

/// Descriptor of a kind of classifier: its name in words, its parameters and its training function.
pub struct ClassifierAbout {
    /// Common name of the kind of classifier, for example in tables and charts.
    pub words: &'static str,
    /// Whether the classifier has a soft-margin penalty C.
    pub has_c: bool,
    /// Whether the training supports [class weights](crate::class_weight).
    pub has_class_weights: bool,
    /// Parameters that the kind of classifier declares. Classifiers with an equal key share its declaration.
    pub parameters: &'static [Parameter],
    /// Kernel of a kernel SVM; `None` for other kinds. Kernel SVMs solve several values of C together and keep kernel values in memory.
    pub kernel: Option<fn(&Parameters) -> Kernel>,
    /// Function that trains the classifier on rows with scaled features. C is ignored if the kind of classifier has none; random draws use the given seed.
    pub train: Train,
}

/// Type of functions that train a classifier without a kernel matrix, given scaled rows, a penalty C and a random seed.
pub type Train = fn(&Classifier, &Dataset, f64, &dyn Streams) -> Result<Arc<dyn ClassModel>>;

impl ClassifierAbout {
    /// Creates the descriptor of a classifier that has neither a penalty C nor parameters.
    pub(crate) const fn new(words: &'static str, train: Train) -> Self {
        Self {
            words,
            has_c: false,
            has_class_weights: false,
            parameters: &[],
            kernel: None,
            train,
        }
    }

    /// Creates the descriptor of an SVM with a kernel and the parameters of the kernel.
    pub(crate) const fn svm(
        words: &'static str,
        parameters: &'static [Parameter],
        kernel: fn(&Parameters) -> Kernel,
    ) -> Self {
        Self {
            has_c: true,
            has_class_weights: true,
            parameters,
            kernel: Some(kernel),
            ..Self::new(words, |classifier, scaled, c, seed| {
                classifier.train_kernel_free(scaled, c, seed)
            })
        }
    }
}

impl fmt::Debug for ClassifierAbout {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.words)
    }
}

impl ClassifierKind {
    /// Returns whether the kind of classifier has a penalty C (soft-margin SVMs and logistic regression). Other kinds ignore C.
    pub fn has_c(self) -> bool {
        self.about().has_c
    }

    /// Returns whether the kind of classifier is a kernel SVM of this crate.
    pub fn is_kernel_svm(self) -> bool {
        self.about().kernel.is_some()
    }

    /// Returns whether the kind of classifier has a kernel with a parameter γ.
    pub fn has_gamma(self) -> bool {
        self.uses(GAMMA.key)
    }
}

/// Declares the kinds of classifiers. Each line contains a variant, the file that describes it, and its documentation. The name of the file is the name of the
/// classifier in a study.
macro_rules! classifiers {
    ($($(#[$cfg:meta])? $name:ident $file:ident $doc:literal;)*) => {
        $($(#[$cfg])? pub mod $file;)*

        /// Kind of classifier, for example a linear SVM; studies may compare several kinds.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
        #[serde(rename_all = "snake_case")]
        #[non_exhaustive]
        pub enum ClassifierKind {
            $($(#[$cfg])? #[doc = $doc] $name,)*
            /// Classifier from outside of this crate; see [foreign].
            #[serde(untagged)]
            Foreign(foreign::Foreign),
        }

        /// Deserialises a kind of classifier from its name in [`NAMES`](ClassifierKind::NAMES).
        impl<'de> Deserialize<'de> for ClassifierKind {
            fn deserialize<D: serde::Deserializer<'de>>(names: D) -> Result<Self, D::Error> {
                use serde::de::Error;
                match &*String::deserialize(names)? {
                    $($(#[$cfg])? stringify!($file) => Ok(Self::$name),)*
                    "decision_tree" => Err(D::Error::custom(
                        "`decision_tree` exists no more; random_forest (n_trees = 1 grows one tree)",
                    )),
                    other => Err(D::Error::unknown_variant(other, &[$($(#[$cfg])? stringify!($file)),*])),
                }
            }
        }

        impl ClassifierKind {
            /// All kinds of classifiers of this crate, in the order of their declaration.
            pub const ALL: &[Self] = &[$($(#[$cfg])? Self::$name),*];

            /// Names of all kinds of classifiers of this crate: the name in a study file and the common name in words.
            pub const NAMES: &[(&str, &str)] = &[$($(#[$cfg])? (stringify!($file), $file::ABOUT.words)),*];

            /// Returns the descriptor of the kind of classifier.
            pub const fn about(self) -> &'static ClassifierAbout {
                match self {
                    $($(#[$cfg])? Self::$name => &$file::ABOUT,)*
                    Self::Foreign(foreign) => foreign.about(),
                }
            }
        }
    };
}
