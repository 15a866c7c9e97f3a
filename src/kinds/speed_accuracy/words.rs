//! Settings as a reader meets them.

use super::rows::{ChainCell, ContactPoint, ContactWay, Touched};
use crate::report::axis::{classifier_name, ensemble_name};

impl ContactWay {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::PackedSpheres => "packed spheres",
            Self::VertexSpheres => "a sphere a vertex",
            Self::ExactMesh => "mesh, exact",
            Self::SolidMarching => "solid, exact",
            Self::TimeSteps => "quasi-static, stepped",
            Self::SemiImplicit => "semi-implicit Euler",
            Self::ImplicitEuler => "implicit Euler",
            Self::Rapier => "rapier, tuned",
            Self::RowsInDoubles => "flat rows in doubles, pose given",
            Self::RowsInSingles => "flat rows in singles, pose given",
        }
    }
}

impl ContactPoint {
    /// `packed spheres within 0.2 mm`, `implicit Euler, steps of 1 ms`.
    pub fn words(&self) -> String {
        let scans = match self.touched {
            Touched::Object => "",
            Touched::Scan => ", scans",
        };
        let setting = match (&self.setting, self.tolerance_mm, self.dt_ms) {
            (Some(setting), ..) => format!(", {setting}"),
            (_, _, Some(dt)) => format!(", steps of {dt} ms"),
            (_, Some(mm), None) => format!(" within {mm} mm"),
            (None, None, None) => String::new(),
        };
        format!("{}{scans}{setting}", self.way)
    }
}

impl ChainCell {
    /// `RBF SVM, SBHE, m = 64, pitch 2 mm, spheres within 0.2 mm`.
    pub fn words(&self) -> String {
        format!(
            "{}, {}, m = {}, pitch {} mm, spheres within {} mm",
            classifier_name(self.classifier),
            ensemble_name(self.ensemble),
            self.measurements,
            self.pitch_mm,
            self.tolerance_mm
        )
    }
}
