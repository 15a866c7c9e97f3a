//! Study: TOML → plan → table.
//!
//! [`StudySpec`] (as written) → [`Plan`] (checked, SI) → touches drawn → [`Sweep`] (splits and cells laid out) →
//! [`RecognitionStudy`](crate::kinds::recognition::RecognitionStudy) (simulate, measure, evaluate in [work items](pieces)) → [`table::Tables`].
//!
//! Threads live here. Whatever their number, a study's tables are the same bytes, times apart: every touch, split, noise and
//! projection is drawn from its own named stream, and sums are taken in a fixed order.

mod array_press;
mod arrays;
mod attempt;
pub mod axes;
pub(crate) mod axis;
mod cell;
pub(crate) mod cell_content;
pub(crate) mod check;
mod conditions;
pub(crate) mod content_hash;
pub(crate) mod defaults;
pub(crate) mod evaluation;
mod feature_files;
pub(crate) mod frames;
mod human_samples;
mod human_touches;
mod images;
pub mod journal;
pub(crate) mod measurement;
pub(crate) mod measurement_inputs;
pub mod memory;
mod next_touch;
pub(crate) mod npy;
pub(crate) mod object_files;
pub(crate) mod packings;
pub mod pieces;
pub(crate) mod plan;
mod plan_human;
mod plan_learning;
mod plan_recorded;
mod plan_scene;
mod plan_shear;
mod plan_signal;
mod pose_groups;
mod pose_splits;
pub mod progress;
pub mod provenance;
pub(crate) mod published;
mod recorded_frames;
mod recorded_skin;
pub(crate) mod repeats;
mod samples;
mod sensed;
mod sensor_errors;
mod shard;
pub(crate) mod shear_ripple;
pub(crate) mod simulation;
pub(crate) mod spec;
mod spec_human;
mod spec_recorded;
mod spec_scene;
mod spec_signal;
mod splits;
pub(crate) mod summary;
pub(crate) mod sweep;
pub mod table;
pub(crate) mod tabulate;
pub mod taxel_array;
mod tilted_copies;
mod touch_files;
pub(crate) mod touch_set;
mod training;
mod variance_table;

pub use array_press::{ArrayPress, ArrayWorkspace};
pub use arrays::KeyValue;
pub use axis::Axis;
pub(crate) use check::{Check, not_negative, positive};
pub(crate) use conditions::column_name;
pub use content_hash::sha256;
pub(crate) use content_hash::short_hash;
pub use evaluation::CONFIDENCE;
pub use feature_files::{FEATURE_FILES, FeatureSet, read_features};
pub use frames::{FrameFacts, Frames};
pub use human_touches::{HumanTouches, RecordedTouch, record_touch};
pub use npy::{write_integers, write_npy, write_texts};
pub use object_files::{
    NamedMesh, file_content, load_catalogue, load_mesh, load_named_meshes, load_objects,
    load_spheres, objects_content, read_mesh, read_mesh_file,
};
pub use packings::{Packed, pack_within, packing_path};
pub(crate) use plan::MM;
pub use plan::{Plan, millimetres};
pub use plan_signal::Condition;
pub use pose_groups::KeepTogether;
pub use pose_splits::PoseSplit;
pub use recorded_frames::RecordedFrames;
pub use recorded_skin::{RecordedSkinFiles, UntouchedFrames};
pub use samples::{Samples, Snapshots, sample_frames};
pub use sensed::Sensed;
pub use sensor_errors::{Strengths, TestedOn, all_strengths, strength_columns};
pub use shard::Shard;
pub use shear_ripple::ShearRipple;
pub use simulation::{TouchedObject, draw_touches, simulate_array};
pub(crate) use spec::default_seed;
pub use spec::*;
pub(crate) use spec_signal::NOISES;
pub use sweep::{Group, StudyPart, Sweep};
pub use touch_files::{ReadFrames, TOUCH_FILES, touch_units, write_human_touches, write_touches};
pub use touch_set::TouchSet;
