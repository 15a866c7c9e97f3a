//! What a study asks about: recognition, reconstruction, the objects themselves, a whole body, contact itself, where recognition
//! breaks, or what accuracy costs.

/// The kinds of studies, told apart by a table that only one of them has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StudyKind {
    /// Which object was touched? Every file that is none of the others.
    Recognition,
    /// How well does a frame come back? A file with a `[reconstruction]` table.
    Reconstruction,
    /// How detailed must an object be? A file with an `[object_detail]` table.
    ObjectDetail,
    /// What does a whole body of skin cost? A file with a `[whole_body]` table.
    WholeBody,
    /// Where does each way to simulate contact break? A file with a `[stability]` table.
    Stability,
    /// How far can each setting be driven before recognition breaks? A file with `[[breaking_points]]` tables.
    BreakingPoints,
    /// What does accuracy cost? A file with a `[speed_accuracy]` table.
    SpeedAccuracy,
}

impl StudyKind {
    /// Of a study's text; text that is not TOML is told so by whoever reads the study.
    pub fn of(text: &str) -> Self {
        let table = crate::toml_text::table(text).unwrap_or_default();
        match () {
            () if table.contains_key("reconstruction") => Self::Reconstruction,
            () if table.contains_key("object_detail") => Self::ObjectDetail,
            () if table.contains_key("whole_body") => Self::WholeBody,
            () if table.contains_key("stability") => Self::Stability,
            () if table.contains_key("breaking_points") => Self::BreakingPoints,
            () if table.contains_key("speed_accuracy") => Self::SpeedAccuracy,
            () => Self::Recognition,
        }
    }

    /// Keys, with all below them, that may change while finished work is kept: they are words, or they say which work there is and
    /// not what comes of any of it, since each piece of work goes by all that it depends on.
    pub fn may_change(self) -> &'static [&'static str] {
        match self {
            Self::Recognition => &[
                "question",
                "expected",
                "report",
                "axes",
                "trials",
                "skin.pitch_mm",
                "skin.size_mm",
                "skin.taxels",
                "touches.frames",
                "signal.steps",
                "signal.combine",
                "signal.noise_std_full_scale",
                "signal.noise_std_mm",
                "signal.noise_std_n",
                "signal.smoothing_mm",
                "signal.hysteresis_full_scale",
                "signal.crosstalk",
                "signal.gain_std",
                "signal.drift_std_full_scale",
                "signal.dead_fraction",
                "signal.stuck_fraction",
                "signal.scan_time_ms",
                "signal.adc_bits",
                "signal.tested_on",
                "sensing.ensemble",
                "sensing.ratio",
                "sensing.measurements",
                "recognition.features",
                "recognition.over_time",
                "recognition.classifier",
                "recognition.c",
                "recognition.train_touches",
                "recognition.mislabelled_fraction",
                "recognition.class_imbalance",
                "recognition.fused_touches",
            ],
            Self::Reconstruction => &[
                "question",
                "expected",
                "signal.noise_std_full_scale",
                "signal.noise_std_mm",
                "signal.noise_std_n",
                "sensing.ensemble",
                "sensing.ratio",
                "sensing.measurements",
                "reconstruction.solver",
                "reconstruction.dictionary",
            ],
            Self::ObjectDetail => &[
                "question",
                "expected",
                "object_detail.recognition.classifiers",
            ],
            Self::WholeBody => &[
                "question",
                "expected",
                "whole_body.scenes",
                "whole_body.ladders.taxels",
                "whole_body.ladders.touched_at_taxels",
                "whole_body.ladders.touched",
                "whole_body.ladders.spheres",
            ],
            Self::Stability => &["question", "expected", "stability.parts"],
            Self::BreakingPoints => &["question", "expected", "breaking_points"],
            Self::SpeedAccuracy => &[
                "question",
                "expected",
                "speed_accuracy.contact.dt_ms",
                "speed_accuracy.recognition.pitch_mm",
                "speed_accuracy.recognition.tolerances_mm",
                "speed_accuracy.recognition.ensemble",
                "speed_accuracy.recognition.ratio",
                "speed_accuracy.recognition.classifier",
                "speed_accuracy.resolution.touches",
            ],
        }
    }

    /// In words: `a study that …`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Recognition => "a study that recognises objects",
            Self::Reconstruction => "a study that reconstructs frames",
            Self::ObjectDetail => "a study of how detailed objects are",
            Self::WholeBody => "a study of a whole body of skin",
            Self::Stability => "a study of where contact methods break",
            Self::BreakingPoints => "a study of where recognition breaks",
            Self::SpeedAccuracy => "a study of what accuracy costs",
        }
    }
}
