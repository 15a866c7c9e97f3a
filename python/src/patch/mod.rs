//! Patches of taxels from Python: the class `Patch` and the arguments of its constructors.

mod arguments;
mod patch_class;

pub use arguments::side;
pub use patch_class::{Patch, frame_shape};
