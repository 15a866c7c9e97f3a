//! Checks of an audit, one file each.
//!
//! A check is a constant `ABOUT` of type [`CheckAbout`] in its file. To add one, write the file and add its name to the list below.

use crate::audit::check::{CheckAbout, Source};

macro_rules! checks {
    ($($file:ident)*) => {
        $(pub(super) mod $file;)*

        /// All checks, in the order of the page.
        pub const CHECKS: &[CheckAbout] = &[$($file::ABOUT),*];
    };
}

checks! {
    near_duplicates
    accuracy_by_split
    method_order
    before_contact
    untouched_taxels
    mean_reading
    row_order
    session_labels
    random_labels
    sample_size
    label_noise
    class_balance
    missing_readings
    saturation
    dead_taxels
    hot_taxels
    drift
    quantisation
}

/// Sources whose readability is tested.
pub const SOURCES: &[Source] = &[
    before_contact::SOURCE,
    before_contact::QUIETEST,
    before_contact::ONSET,
    before_contact::AT_REST,
    before_contact::PADDING,
    before_contact::NOISE,
    untouched_taxels::SOURCE,
    untouched_taxels::NOISE,
    mean_reading::MEAN,
    mean_reading::SHAPE,
    mean_reading::INVARIANT_SHAPE,
    row_order::SOURCE,
    session_labels::SOURCE,
    session_labels::GROUPS,
];
