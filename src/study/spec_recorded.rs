//! Recorded frames as they are written: `[recorded]`, in place of `[objects]` and `[touches]`.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// `[recorded]`: what a skin has read, in NumPy's files. `[skin]` says how far apart its taxels are and what their full scale is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedSpec {
    /// n × rows × columns, or n × F × rows × columns of touches of F frames; any type of float or integer of up to 32 bits. Rows and columns are
    /// those of the array.
    pub frames: PathBuf,
    /// n: the class of every touch, 0, 1 … .
    pub labels: PathBuf,
    /// n: touches that share a number are never on both sides of a split, those of a grasp or of a day, say.
    pub groups: Option<PathBuf>,
    /// What the classes are called, by their labels.
    pub names: Option<Vec<String>>,
    /// The reading of a taxel that nothing touches; 0 when left out.
    #[serde(default)]
    pub zero: f64,
    /// The reading of a taxel at its full scale, which is its stroke; the largest of the frames when left out.
    pub full_scale: Option<f64>,
}
