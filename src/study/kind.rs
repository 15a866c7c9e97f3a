//! What a study asks about, of those kinds that are no [`Kind`](crate::kinds::Kind) yet.

/// The kinds of studies, told apart by a table that only one of them has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StudyKind {
    /// Which object was touched? Every file that is none of the others.
    Recognition,
}

impl StudyKind {
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
                "signal",
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
        }
    }

    /// In words: `a study that …`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Recognition => "a study that recognises objects",
        }
    }
}
