//! Re-exports of the types of recognition studies under short paths. The code of the types is in the modules `engine`, `inputs` and `studies`.

pub use crate::engine::axis::Axis;
pub use crate::engine::shard::Shard;
pub use crate::engine::{axes, journal, progress, provenance, work_items};
pub use crate::inputs::arrays::whole_numbers::KeyValue;
pub use crate::inputs::content_hash::sha256;
pub use crate::inputs::memory;
pub use crate::inputs::npy::{write_integers, write_npy, write_texts};
pub use crate::inputs::object_files::{
    NamedMesh, file_content, is_built_in, load_catalogue, load_mesh, load_named_meshes,
    load_objects, load_spheres, objects_content, read_mesh, read_mesh_file,
};
pub use crate::inputs::objects_spec::{ModelSpec, ObjectsSpec};
pub use crate::inputs::packings::{Packed, pack_with, pack_within, packing_path};
pub use crate::inputs::sensor_errors::{Strengths, TestSensor, all_strengths, strength_columns};
pub use crate::inputs::units::millimetres;
pub use crate::report::pictures::snapshots::Snapshots;
pub use crate::statistics::p_status::CONFIDENCE;
pub use crate::studies::recognition::exports::feature_files::{
    FEATURE_FILES, FeatureSet, NewRows, read_features, read_new_rows,
};
pub use crate::studies::recognition::exports::touch_files::{
    ReadFrames, TOUCH_FILES, touch_units, write_human_touches, write_touches,
};
pub use crate::studies::recognition::frames::frame_store::{FrameFacts, Frames};
pub use crate::studies::recognition::frames::human_touches::{
    HumanTouches, RecordedTouch, record_touch,
};
pub use crate::studies::recognition::frames::pressed_objects::simulate_array;
pub use crate::studies::recognition::frames::pressed_objects::{ArrayPress, ArrayWorkspace};
pub use crate::studies::recognition::frames::recorded_frames::RecordedFrames;
pub use crate::studies::recognition::frames::recorded_skin::{RecordedSkinFiles, UntouchedFrames};
pub use crate::studies::recognition::frames::samples::sample_frames;
pub use crate::studies::recognition::frames::shear_ripple::ShearRipple;
pub use crate::studies::recognition::frames::touch_set::{Samples, TouchSet};
pub use crate::studies::recognition::plan::pose_groups::KeepTogether;
pub use crate::studies::recognition::plan::sensed::Sensed;
pub use crate::studies::recognition::plan::signal::Condition;
pub use crate::studies::recognition::plan::study_plan::MeasurementGroup;
pub use crate::studies::recognition::plan::study_plan::Plan;
pub use crate::studies::recognition::plan::taxel_array;
pub use crate::studies::recognition::spec::*;
pub use crate::studies::recognition::sweep::configurations::{StudyPart, Sweep};
pub use crate::studies::recognition::touches::{TouchedObject, draw_touches};

/// Row types of the result tables of recognition studies.
pub mod table {
    pub use crate::statistics::p_status::PStatus;
    pub use crate::studies::recognition::rows::configuration::Configuration;
    pub use crate::studies::recognition::rows::table_rows::*;
}
