//! What a kind of classifier says of itself.

use crate::class_model::ClassModel;
use crate::classifiers::ClassifierKind;
use crate::classifiers::classifier::Classifier;
use crate::dataset::Dataset;
use crate::error::Result;
use crate::kernel::Kernel;
use crate::streams::DynStreams;
use std::fmt;
use std::sync::Arc;

/// A kind of classifier.
pub struct ClassifierAbout {
    /// What people call it.
    pub words: &'static str,
    /// Whether it has a soft-margin penalty C.
    pub has_c: bool,
    /// Whether it has a kernel with a γ.
    pub has_gamma: bool,
    /// Whether its kernel has a degree and a constant.
    pub has_degree: bool,
    /// Whether it has a number of neighbours.
    pub has_neighbours: bool,
    /// Whether it has a number of trees.
    pub has_trees: bool,
    /// Whether its trees have a largest depth.
    pub has_depth: bool,
    /// The kernel of a kernel SVM: several C are then solved together, and kernel values are held.
    pub kernel: Option<fn(&Classifier) -> Kernel>,
    /// Trains on scaled rows, with a C where it has one, and draws from the seed.
    pub train: Train,
}

/// What trains a classifier without a kernel.
pub type Train = fn(&Classifier, &Dataset, f64, &dyn DynStreams) -> Result<Arc<dyn ClassModel>>;

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

    /// An SVM of a kernel.
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
    /// Whether it has a C: the soft-margin SVMs and logistic regression. The others train the same whatever C is given.
    pub fn has_c(self) -> bool {
        self.about().has_c
    }

    /// Whether it has a kernel with a γ.
    pub fn has_gamma(self) -> bool {
        self.about().has_gamma
    }
}

/// Says of each classifier which file tells of it: its name in a study.
macro_rules! classifiers {
    ($($name:ident $file:ident $doc:literal;)*) => {
        $(pub mod $file;)*

        /// A classifier that a study can sweep.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum ClassifierKind {
            $(#[doc = $doc] $name,)*
        }

        /// A name of [`NAMES`](ClassifierKind::NAMES).
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
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// The name in a study, and what people call it.
            pub const NAMES: &[(&str, &str)] = &[$((stringify!($file), $file::ABOUT.words)),*];

            /// What it says of itself.
            pub const fn about(self) -> &'static ClassifierAbout {
                match self {
                    $(Self::$name => &$file::ABOUT,)*
                }
            }
        }
    };
}
