//! Statistics of recorded frames for an audit of a data set.
//!
//! | module | question |
//! |---|---|
//! | [`missing`] | Which readings are missing, and what replaces them? |
//! | [`taxels`] | What does each taxel read; which taxels are constant, stuck for some time or equal to another; which number stands for a missing reading? |
//! | [`pooled`] | Which numbers represent a touch for a cheap classifier? |
//! | [`spectrum`] | Which numbers represent a vibration? |
//! | [`copies`] | Which touches are two or three copies of each other? |
//! | [`dependence`] | How many independent rows are rows worth that follow each other or belong to groups? |
//!
//! Rows are touches in the order of recording.

pub mod copies;
pub mod dependence;
pub mod missing;
pub mod pooled;
pub mod spectrum;
pub mod taxels;
