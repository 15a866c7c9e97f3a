//! Charts and settings as a reader meets them.

use super::points::{ChartKind, ChartPoint, SCANS};
use crate::report::axis::{classifier_name, ensemble_name};
use crate::study::advice::cost_in_words;
use crate::study::speed_accuracy::table::{ChainCell, ContactCell, ContactWay, Touched};

impl ChartKind {
    /// File name without ending.
    pub fn name(self) -> &'static str {
        match self {
            Self::Contact => "speed_accuracy_contact",
            Self::Decision => "speed_accuracy_decision",
            Self::Training => "speed_accuracy_training",
            Self::Resolution => "speed_accuracy_resolution",
        }
    }

    /// What the chart is read as.
    pub fn title(self) -> &'static str {
        match self {
            Self::Contact => "Contact: error of the deflections against the time of a touch",
            Self::Decision => "Recognition: accuracy against the time of a decision",
            Self::Training => "Recognition: accuracy against the time of a training",
            Self::Resolution => "Studies: what can be told apart against the time that it takes",
        }
    }

    /// What all of its points have in common.
    pub(super) fn settings(self) -> &'static str {
        match self {
            Self::Contact => {
                "64 × 64 taxels unless the study says otherwise; medians over objects, on the front with quartiles"
            }
            Self::Decision => {
                "press, noise, compression and answer of one touch, one thread; tested on the exact objects; on the front with 95 % intervals"
            }
            Self::Training => {
                "one thread; tested on the exact objects; on the front with 95 % intervals"
            }
            Self::Resolution => {
                "half the width of 95 % intervals: of an accuracy at one trial's test touches, and of a difference by the corrected t-test"
            }
        }
    }

    /// What runs along x, and along y.
    pub(super) fn axes(self) -> (&'static str, &'static str) {
        match self {
            Self::Contact => (
                "time of a touch, one thread (median)",
                "mean deflection error, mm",
            ),
            Self::Decision => ("time of a decision", "accuracy"),
            Self::Training => ("time of a training", "accuracy"),
            Self::Resolution => ("processor time of the study", "half width of the interval"),
        }
    }

    /// What a value is, at the head of a column.
    pub(super) fn value_name(self) -> &'static str {
        match self {
            Self::Contact => "error, mm",
            Self::Decision | Self::Training => "accuracy",
            Self::Resolution => "half width",
        }
    }
}

impl ChartKind {
    /// A value in words: `0.08 mm`, `0.81 (0.79 to 0.83)`.
    pub(super) fn value_words(self, point: &ChartPoint) -> String {
        match self {
            Self::Contact if point.value == 0.0 => "no error".to_owned(),
            Self::Contact => format!("{} mm", to_two_digits(point.value)),
            Self::Resolution => format!("± {:.4}", point.value),
            _ => format!(
                "{:.3} ({:.3} to {:.3})",
                point.value, point.value_low, point.value_high
            ),
        }
    }

    /// `0.08 mm at 7.1 µs`.
    pub(super) fn at_cost(self, point: &ChartPoint) -> String {
        let time = cost_in_words(point.cost_us);
        format!("{} at {time}", self.value_words(point))
    }
}

/// Millimetres with two digits that say something.
fn to_two_digits(value: f64) -> String {
    let digits = (1.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

/// A way to evaluate contact: what has one colour in the chart.
pub(super) fn way_name(way: ContactWay) -> &'static str {
    match way {
        ContactWay::PackedSpheres => "packed spheres",
        ContactWay::VertexSpheres => "a sphere a vertex",
        ContactWay::ExactMesh => "mesh, exact",
        ContactWay::SolidMarching => "solid, exact",
        ContactWay::TimeSteps => "quasi-static, stepped",
        ContactWay::SemiImplicit => "semi-implicit Euler",
        ContactWay::ImplicitEuler => "implicit Euler",
        ContactWay::Rapier => "rapier, tuned",
        ContactWay::RowsInDoubles => "flat rows in doubles, pose given",
        ContactWay::RowsInSingles => "flat rows in singles, pose given",
    }
}

/// `packed spheres within 0.2 mm`, `packed spheres, scans within 0.2 mm`, `implicit Euler, steps of 1 ms`.
pub(super) fn contact_setting(cell: &ContactCell) -> String {
    let way = way_name(cell.way);
    let scan = match cell.touched {
        Touched::Object => "",
        Touched::Scan => SCANS,
    };
    match (cell.tolerance_mm, cell.dt_ms) {
        (_, Some(dt)) => format!("{way}{scan}, steps of {dt} ms"),
        (Some(mm), None) => format!("{way}{scan} within {mm} mm"),
        (None, None) => format!("{way}{scan}"),
    }
}

/// `RBF SVM, SBHE, m = 64, pitch 2 mm, spheres within 0.2 mm`.
pub(in crate::report) fn chain_setting(cell: &ChainCell) -> String {
    format!(
        "{}, {}, m = {}, pitch {} mm, spheres within {} mm",
        classifier_name(cell.classifier),
        ensemble_name(cell.ensemble),
        cell.measurements,
        cell.pitch_mm,
        cell.tolerance_mm
    )
}
