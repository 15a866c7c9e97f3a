//! The pure stages of bubbletouch, from a mesh to a recognised object: no files (but a robot's, if it is asked for by its path), no
//! clock, no printing, no global state.
//!
//! Users name the crate `bubbletouch`, which has all of this under the same names, and studies, reports and a command on top. What is
//! here is a crate of its own so that nothing in it can reach for those, and so that a change of a chart builds no kernel again.
#![warn(missing_docs)]
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

pub mod contact;
pub mod dynamics;
pub mod error;
pub mod geometry;
pub mod mesh;
pub mod numbers_csv;
pub mod objects;
pub mod packing;
pub mod quantile;
pub mod random;
pub mod recognition;
pub mod sensing;
pub mod signal;
pub mod spelling;
pub mod toml_text;
pub mod whole_body;
pub mod world;

pub use error::{Error, Result};
