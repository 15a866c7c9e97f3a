//! The tables of a study of breaking points: one plain struct a row, one field a column.

use crate::learning::classifiers::ClassifierKind;
use crate::row;
use crate::studies::breaking_points::spec::DrivenTouches;
use serde::{Deserialize, Serialize};

row! {
/// A classifier at a value of a way: a row of `accuracy.csv`, of `summary.csv` and of `timing.csv` begins with it.
pub struct WayCell {
    /// The way's name.
    way: String => Subject "setting";
    /// Which touches have the value.
    touches: DrivenTouches => Subject "touches that have it";
    /// The value, in the unit of the way's keys.
    value: f64 => Condition: Log;
    /// Which classifier.
    classifier: ClassifierKind => Choice named ClassifierKind::NAMES;
} }

row! {
/// Where a way breaks a classifier, going one way from its best: a row of `breaking_points.csv`.
pub struct BreakingPoint {
    /// The way's name.
    way: String => Subject "setting";
    /// Which classifier.
    classifier: ClassifierKind => Choice named ClassifierKind::NAMES;
    /// To larger or to smaller values than the best.
    side: Side => Subject "to values that are";
    /// The highest mean accuracy (the first of equals).
    best: f64 => Value(More) "best accuracy": Share between [best_low, best_high];
    /// Lower end of its 95 % Wilson interval, at one trial's test rows or those of all folds.
    best_low: f64 => Note "95 % interval of the best, lower end": Share;
    /// Upper end of the same interval.
    best_high: f64 => Note "95 % interval of the best, upper end": Share;
    /// The value that it is at.
    best_at: f64 => Note "best at": Log;
    /// Half of the best.
    half: f64 => Note "half of the best": Share;
    /// One in the number of objects.
    chance: f64 => Note: Share;
    /// Whether the accuracy falls to half of the best.
    is_reached: bool => Outcome "half is reached";
    /// The value at which it does; empty if it does not.
    breaks_at: Option<f64> => Value(Neither) "half of the best at": Log between [breaks_at_low, breaks_at_high];
    /// Lower end of its 95 % interval; empty if that is beyond the last value.
    breaks_at_low: Option<f64> => Note "95 % interval of the place, lower end": Log;
    /// Upper end of the same interval; empty if that is beyond the last value.
    breaks_at_high: Option<f64> => Note "95 % interval of the place, upper end": Log;
    /// The last value on this side.
    end: f64 => Note "last value": Log;
    /// The mean accuracy there.
    accuracy_at_end: f64 => Value(More) "accuracy at the last value": Share;
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

pub use crate::studies::recognition::rows::table_rows::{CellScore, TrialScore, TrialTime};
