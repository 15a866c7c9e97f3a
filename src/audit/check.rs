//! Description of a check of an audit, and of a source from which labels may be readable.

pub use crate::audit::context::Context;
pub use crate::audit::finding::Finding;
pub use crate::error::Result;
use ndarray::Array2;

/// Description of a check: its name, its title, and the function that runs it.
pub struct CheckAbout {
    /// Name in tables, such as `near_duplicates`.
    pub name: &'static str,
    /// Title on the page.
    pub title: &'static str,
    /// Function that returns the findings of the check.
    pub run: fn(&Context) -> Result<Vec<Finding>>,
}

/// Source other than the contact from which labels may be readable.
pub struct Source {
    /// Name in tables, such as `untouched_taxels`.
    pub name: &'static str,
    /// Function that returns the features of the sampled touches, shape (n_sample, m); `None` if the data have no such source.
    pub rows: fn(&Context) -> Option<Array2<f64>>,
    /// Whether the label of a touch is read from the touches of other groups.
    pub holds_out_groups: bool,
    /// Whether the p-value decides about a finding. Otherwise the source is a comparison, with few permutations and without a p-value.
    pub is_tested: bool,
}

/// Reason for an omitted check that needs labels.
pub const NO_LABELS: &str = "There are no labels of two classes or more.";
