//! The tables of a study of breaking points: one plain struct a row, one field a column.

use super::spec::DrivenTouches;
use crate::columns;
use crate::kinds::names::CLASSIFIERS;
use crate::recognition::ClassifierKind;
use serde::{Deserialize, Serialize};

/// A classifier at a value of a way: a row of `accuracy.csv`, of `summary.csv` and of `timing.csv` begins with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WayCell {
    /// The way's name.
    pub way: String,
    /// Which touches have the value.
    pub touches: DrivenTouches,
    /// The value, in the unit of the way's keys.
    pub value: f64,
    /// Which classifier.
    pub classifier: ClassifierKind,
}

columns! { WayCell {
    way: Subject "setting";
    touches: Subject "touches that have it";
    value: Condition: Log;
    classifier: Choice named CLASSIFIERS;
} }

/// Where a way breaks a classifier, going one way from its best: a row of `breaking_points.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BreakingPoint {
    /// The way's name.
    pub way: String,
    /// Which classifier.
    pub classifier: ClassifierKind,
    /// To larger or to smaller values than the best.
    pub side: Side,
    /// The highest mean accuracy (the first of equals).
    pub best: f64,
    /// Lower end of its 95 % Wilson interval at one trial's test rows.
    pub best_low: f64,
    /// Upper end of the same interval.
    pub best_high: f64,
    /// The value that it is at.
    pub best_at: f64,
    /// Half of the best.
    pub half: f64,
    /// One in the number of objects.
    pub chance: f64,
    /// Whether the accuracy falls to half of the best.
    pub is_reached: bool,
    /// The value at which it does; empty if it does not.
    pub breaks_at: Option<f64>,
    /// Lower end of its 95 % interval; empty if that is beyond the last value.
    pub breaks_at_low: Option<f64>,
    /// Upper end of the same interval; empty if that is beyond the last value.
    pub breaks_at_high: Option<f64>,
    /// The last value on this side.
    pub end: f64,
    /// The mean accuracy there.
    pub accuracy_at_end: f64,
}

columns! { BreakingPoint {
    way: Subject "setting";
    classifier: Choice named CLASSIFIERS;
    side: Subject "to values that are";
    best: Value(More) "best accuracy": Share between [best_low, best_high];
    best_low: Note "95 % interval of the best, lower end": Share;
    best_high: Note "95 % interval of the best, upper end": Share;
    best_at: Note "best at": Log;
    half: Note "half of the best": Share;
    chance: Note: Share;
    is_reached: Outcome "half is reached";
    breaks_at: Value(Neither) "half of the best at": Log between [breaks_at_low, breaks_at_high];
    breaks_at_low: Note "95 % interval of the place, lower end": Log;
    breaks_at_high: Note "95 % interval of the place, upper end": Log;
    end: Note "last value": Log;
    accuracy_at_end: Value(More) "accuracy at the last value": Share;
} }

/// Which way from the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// To smaller values.
    Smaller,
    /// To larger values.
    Larger,
}

pub use crate::study::table::{CellScore, TrialScore, TrialTime};
