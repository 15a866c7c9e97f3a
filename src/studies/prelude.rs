//! Names that most kinds of studies use, also kinds from outside of this crate.

pub use crate::engine::axis::Axis;
pub use crate::engine::work_items::{PendingItems, Scale, Shared, WorkItem};
pub use crate::error::{Error, Result};
pub use crate::inputs::check::Check;
pub use crate::inputs::keys::KeyAbout;
pub use crate::inputs::object_files::{load_objects, objects_content};
pub use crate::inputs::objects_spec::ObjectsSpec;
pub use crate::inputs::params::keys_of;
pub use crate::random::Seed;
pub use crate::studies::recognition::plan::taxel_array::TaxelArray;
pub use crate::studies::recognition::spec::scene::{SkinSpec, TouchesSpec};
pub(crate) use crate::studies::recognition::sweep::configurations::nested;
pub use crate::studies::recognition::touches::drawn_touches::{TouchedObject, draw_touches};
pub use crate::studies::source::Source;
pub use crate::studies::study::{
    About, AnyFile, Facts, Study, TableFiles, shared_inputs, work_items_of,
};
pub use crate::table::{ChartSpec, File, Mark, Table};
pub use crate::{params, row, study_file, words};
