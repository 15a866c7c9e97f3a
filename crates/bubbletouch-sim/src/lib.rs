//! Quasi-static simulation of tactile robot skin.
//!
//! | module | input → output |
//! |---|---|
//! | [`mesh`] | a file of triangles → a surface: distances, inside and outside |
//! | [`objects`] | a solid, a mesh or spheres → a model of spheres or triangles |
//! | [`packing`] | a mesh and a tolerance → few spheres |
//! | [`world`] | taxels, layouts, resting poses → touches; robots and their motion → poses |
//! | [`contact`] | a scene and poses → deflections and forces; free objects → poses at rest |
//! | [`dynamics`] | the same with mass, in time: what the quasi-static model is compared with |
//! | [`whole_body`] | millions of taxels, objects and poses → the taxels that are touched |
//! | [`signal`] | deflections → frames, as the electronics report them |
//! | [`calibration`] | recorded frames → the parameters of the signal chain that makes such frames |
//! | [`sensing`] | frames → compressed measurements, and back |
//! | [`features`] | frames → features that do not change with place, turn or pressure |
#![warn(missing_docs)]
#![warn(clippy::missing_errors_doc)]
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

pub mod calibration;
pub mod contact;
pub mod dynamics;
pub mod error;
pub mod features;
pub mod files;
pub mod frame_coding;
pub mod geometry;
pub mod in_range;
pub mod interval;
pub mod mesh;
pub mod note;
pub mod numbers;
pub mod numbers_csv;
pub mod objects;
pub mod packing;
pub mod quantile;
pub mod random;
pub mod sensing;
pub mod signal;
pub mod spelling;
pub mod standard_errors;
pub mod toml_numbers;
pub mod toml_text;
pub mod whole_body;
pub mod world;

pub use error::{Error, Result};
