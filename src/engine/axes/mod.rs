//! Table `[axes]` of a study: keys with lists of values, from which all combinations are formed.
//!
//! ```toml
//! [axes]
//! "touches.depth_mm" = [1.0, 2.0, 4.0]
//! "skin.stiffness_n_per_m" = [500.0, 2000.0]
//! ```
//! A key in `[axes]` replaces the same key in its own table. Each combination of values is a study of its own and is checked as any other study. A key that
//! accepts a list in its own table is also an axis there, and may be written in either place. Such axes change fastest, in the order of the declarations of
//! their keys. `"touches.offset_{x,y}_mm"` sets two keys together.
//!
//! With `combine = "one_at_a_time"`, the first configuration has the values of the study's own tables. In each further configuration, one axis alone takes
//! another value. The keys may then also have values in their own tables.

mod reader;
mod study_axes;
mod study_axis;

pub use reader::{read, to_toml};
pub use study_axes::{AxisValue, AxisValues, CombineSpec, StudyAxes};
pub use study_axis::StudyAxis;
