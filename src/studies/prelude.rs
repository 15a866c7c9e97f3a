//! Names that most kinds of studies use.

pub(crate) use crate::engine::axes::AxisValues;
pub(crate) use crate::engine::axis::Axis;
pub(crate) use crate::engine::progress::{Progress, Silent};
pub(crate) use crate::engine::work_items::{PendingItems, Scale, Shared, WorkItem};
pub(crate) use crate::error::{Error, Result};
pub(crate) use crate::inputs::check::Check;
pub(crate) use crate::inputs::content_hash::identity;
pub(crate) use crate::inputs::keys::KeyAbout;
pub(crate) use crate::inputs::object_files::{load_objects, objects_content};
pub(crate) use crate::inputs::objects_spec::ObjectsSpec;
pub(crate) use crate::inputs::params::{keys_of, params, words};
pub(crate) use crate::inputs::sensor_errors::TestSensor;
pub(crate) use crate::inputs::units::{MM, millimetres};
pub(crate) use crate::learning::classifiers::ClassifierKind;
pub(crate) use crate::random::Seed;
pub(crate) use crate::row;
pub(crate) use crate::sensing::{Ensemble, Selection};
pub(crate) use crate::studies::recognition::plan::{Plan, TaxelArray};
pub(crate) use crate::studies::recognition::spec::{
    RecordedSpec, SensedSpec, SkinSpec, StepSpec, StudySpec, TouchesSpec,
};
pub(crate) use crate::studies::recognition::sweep::configurations::nested;
pub(crate) use crate::studies::recognition::touches::{TouchedObject, draw_touches};
pub(crate) use crate::studies::source::Source;
pub(crate) use crate::studies::study::{
    About, AnyFile, Facts, Study, TableFiles, shared_inputs, work_items_of,
};
pub(crate) use crate::study_file::study_file;
pub(crate) use crate::table::{ChartSpec, File, Mark, Table};
pub(crate) use crate::world::{Touch, TouchAxis};
