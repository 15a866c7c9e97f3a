//! Simulated touch for robot skin.
//!
//! Source keys: `[BT]` Hollis, Patterson, Cui, Trinkle, *BubbleTouch: a quasi-static tactile skin simulator*, 2018
//! (arXiv 1809.09153). `[CL]` Hollis, Patterson, Trinkle, *Compressed learning for tactile object recognition*, RA-L 2018.
//! `[SBHE]` Gan, Do, Tran, *Fast compressive imaging using scrambled block Hadamard ensemble*, 2008.
#![warn(missing_docs)]

pub mod contact;
pub mod error;
pub mod files;
pub mod geometry;
pub mod objects;
pub mod random;
pub mod recognition;
pub mod report;
pub mod sensing;
pub mod signal;
pub mod study;
pub mod world;

pub use error::{Error, Result};
