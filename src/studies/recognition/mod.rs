//! Recognition studies, in which classifiers recognise objects from touches.
//!
//! Data flow: each stage is a folder, and a stage imports only from stages above it in this table. A stage is imported from its folder: `plan::Plan`. Names that
//! most stages use come from the prelude of all kinds of studies.
//!
//! | stage | in → out |
//! |---|---|
//! | [`rows`] | the rows of all result tables |
//! | [`spec`] | TOML → keys as written |
//! | [`plan`] | keys → checked values in SI units, arrays of taxels |
//! | [`touches`] | placements → drawn touches |
//! | [`frames`] | touches → deflections of all taxels, and frames after the signal chain |
//! | [`sweep`] | touches → splits and configurations |
//! | [`measurements`] | frames → measurements and features |
//! | [`training`] | features → classifiers and scores |
//! | [`tables`] | scores → rows of tables |
//! | [`exports`] | frames and features → arrays in files |
//! | [`charts`] | tables → charts, answers, sections of the page |
//! | [`study`] | the whole study as work items |

pub mod charts;
pub mod exports;
pub mod frames;
pub mod measurements;
pub mod plan;
pub mod rows;
pub mod spec;
pub mod study;
pub mod sweep;
pub mod tables;
pub mod touches;
pub mod training;
