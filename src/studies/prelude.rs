//! Names that most kinds of studies use, also kinds from outside of this crate.

pub(crate) use crate::engine::axes::AxisValues;
pub use crate::engine::axis::Axis;
pub(crate) use crate::engine::progress::{Progress, Silent};
pub use crate::engine::work_items::{PendingItems, Scale, Shared, Stage, WorkItem};
pub use crate::error::{Error, Result};
pub(crate) use crate::geometry::Pose;
pub use crate::inputs::check::Check;
pub(crate) use crate::inputs::content_hash::identity;
pub use crate::inputs::keys::KeyAbout;
pub use crate::inputs::object_files::{load_objects, objects_content};
pub use crate::inputs::objects_spec::ObjectsSpec;
pub use crate::inputs::params::keys_of;
pub use crate::inputs::range::Range::{Any, Count, NotNegative, Part, Positive, Unchecked};
pub use crate::inputs::range::{COUNT, SURFACE_ERROR, TOUCHES};
pub(crate) use crate::inputs::sensor_errors::TestSensor;
pub(crate) use crate::inputs::units::{MM, millimetres};
pub(crate) use crate::learning::classifiers::ClassifierKind;
pub(crate) use crate::objects::{Model, Object};
pub(crate) use crate::quantile::quantile;
pub use crate::random::Seed;
pub use crate::report::chart::Chart;
pub(crate) use crate::report::study_folder::{Beyond, NamedPicture};
pub(crate) use crate::sensing::{Basis, Ensemble, Projection, Selection};
pub(crate) use crate::signal::NoiseUnit;
pub use crate::studies::recognition::plan::TaxelArray;
pub(crate) use crate::studies::recognition::plan::{MeasurementGroup, Plan};
pub(crate) use crate::studies::recognition::rows::Configuration;
pub(crate) use crate::studies::recognition::spec::{RecordedSpec, SensedSpec, StepSpec, StudySpec};
pub use crate::studies::recognition::spec::{SkinSpec, TouchesSpec};
pub(crate) use crate::studies::recognition::sweep::configurations::nested;
pub use crate::studies::recognition::touches::{TouchedObject, draw_touches};
pub use crate::studies::source::Source;
pub use crate::studies::study::{
    About, AnyFile, Facts, Study, TableFiles, shared_inputs, work_items_of,
};
pub use crate::table::{ChartSpec, File, Mark, Table};
pub(crate) use crate::world::{ImageShape, Placement, Taxel, Touch, TouchAxis};
pub use crate::{acts, params, row, study_file, words};
pub(crate) use bubbletouch_svm::split::Split;
pub(crate) use serde::{Deserialize, Serialize};
