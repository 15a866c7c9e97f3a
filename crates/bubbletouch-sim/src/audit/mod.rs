//! Statistics of recorded frames for an audit of a data set.
//!
//! | module | question |
//! |---|---|
//! | [`missing`] | Which readings are missing, and what replaces them? |
//! | [`placeholders`] | Which value stands for a missing reading, and which frames are repeated? |
//! | [`clipped`] | Which taxels read their largest value too often? |
//! | [`wrapped`] | Do integers wrap around? |
//! | [`frozen`] | Which taxels keep a reading for some time while the taxels around them change? |
//! | [`taxels`] | What does each taxel read, and which taxels are never touched? |
//! | [`pooled`] | Which numbers represent a touch for a cheap classifier? |
//! | [`duplicates`] | Which rows are nearer to another row than chance explains? |
//! | [`counts`] | How many levels do the readings of a taxel have, and are they counts of events? |
//! | [`dependence`] | Are rows that are neighbours in time, or members of a group, more alike than other rows of their class? |
//! | [`gain`] | Which gain has a row, compared with rows of equal shape? |
//! | [`surroundings`] | Which taxels are beside a taxel? |
//! | [`hot`] | Which taxels read a pressure or noise while the taxels around them are at rest? |
//!
//! Faults of taxels, saturation and converters are found by [`calibration`](crate::calibration). Rows are touches in the order of recording.

pub mod clipped;
pub mod counts;
pub mod dependence;
pub mod duplicates;
pub mod frozen;
pub mod gain;
pub mod hot;
pub mod missing;
pub mod placeholders;
pub mod pooled;
pub mod surroundings;
pub mod taxels;
pub mod wrapped;
