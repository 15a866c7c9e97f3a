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
