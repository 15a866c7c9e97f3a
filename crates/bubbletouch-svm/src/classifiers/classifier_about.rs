//! Descriptors of the kinds of classifiers.

use crate::class_model::ClassModel;
use crate::classifiers::ClassifierKind;
use crate::classifiers::classifier::Classifier;
use crate::dataset::Dataset;
use crate::error::Result;
use crate::kernel::Kernel;
use crate::streams::Streams;
use std::fmt;
use std::sync::Arc;

/// Descriptor of a kind of classifier.
pub struct ClassifierAbout {
    /// Common name in words.
    pub words: &'static str,
    /// Whether it has a soft-margin penalty C.
    pub has_c: bool,
    /// Whether it has a kernel with a γ.
    pub has_gamma: bool,
    /// Whether its kernel has a degree and a constant.
    pub has_degree: bool,
    /// Whether the number of neighbours is a parameter.
    pub has_neighbours: bool,
    /// Whether the number of trees is a parameter.
    pub has_trees: bool,
    /// Whether the maximum depth of the trees is a parameter.
    pub has_depth: bool,
    /// Kernel of a kernel SVM. Kernel SVMs solve several C together and hold kernel values in memory.
    pub kernel: Option<fn(&Classifier) -> Kernel>,
    /// Trains on scaled rows, with C if the kind has one; random draws come from the seed.
    pub train: Train,
}

/// Function that trains a classifier without a kernel matrix.
pub type Train = fn(&Classifier, &Dataset, f64, &dyn Streams) -> Result<Arc<dyn ClassModel>>;

impl ClassifierAbout {
    /// Describes a classifier without parameters.
    pub(crate) const fn new(words: &'static str, train: Train) -> Self {
        Self {
            words,
            has_c: false,
            has_gamma: false,
            has_degree: false,
            has_neighbours: false,
            has_trees: false,
            has_depth: false,
            kernel: None,
            train,
        }
    }

    /// Describes an SVM with the given kernel.
    pub(crate) const fn svm(words: &'static str, kernel: fn(&Classifier) -> Kernel) -> Self {
        Self {
            has_c: true,
            has_gamma: true,
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
    /// Returns whether the kind has a C: soft-margin SVMs and logistic regression. The training of other kinds ignores C.
    pub fn has_c(self) -> bool {
        self.about().has_c
    }

    /// Returns whether the kind has a kernel with a γ.
    pub fn has_gamma(self) -> bool {
        self.about().has_gamma
    }
}

/// Declares the kinds of classifiers. Each line contains the variant, the file that describes it, and its documentation; the file's name is the name in a
/// study.
macro_rules! classifiers {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(pub mod $file;)*

        /// A classifier that a study can sweep.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum ClassifierKind {
            $(#[doc = $doc] $name,)*
        }

        /// Deserialises a name of [`NAMES`](ClassifierKind::NAMES).
        impl<'de> Deserialize<'de> for ClassifierKind {
            fn deserialize<D: serde::Deserializer<'de>>(names: D) -> Result<Self, D::Error> {
                use serde::de::Error;
                match &*String::deserialize(names)? {
                    $(stringify!($file) => Ok(Self::$name),)*
                    "decision_tree" => Err(D::Error::custom(
                        "`decision_tree` exists no more; random_forest (n_trees = 1 grows one tree)",
                    )),
                    other => Err(D::Error::unknown_variant(other, &[$(stringify!($file)),*])),
                }
            }
        }

        impl ClassifierKind {
            /// All kinds of classifiers.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// For each kind, its name in a study and its common name in words.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// Returns the descriptor of the kind.
            pub const fn about(self) -> &'static ClassifierAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}
