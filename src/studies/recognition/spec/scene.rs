//! Specification of the touched scene: the tables `[objects]`, `[skin]` and `[touches]`, and `[human_touch]`, which replaces `[objects]` and `[touches]`.

use crate::inputs::params::{empty_table, named, variants};
use crate::inputs::range::Range::Finite;
use crate::inputs::range::SIDE;
use crate::inputs::toml_value::table_of;
use crate::inputs::units::MAX_FRAMES;
use crate::studies::prelude::*;
use crate::studies::recognition::spec::SLIDE;
use crate::table::Scale::{Linear, Log};
use crate::world::{ArrayLayout, RestPoses, TouchKind};

named!(ArrayLayout, RestPoses);

/// Default stiffness of a taxel, N/m.
pub(crate) const STIFFNESS: f64 = 100.0;

params! {
    /// Keys of `[skin]`: the arrays of taxels.
    pub struct SkinSpec {
        /// Axis: side of the square area per taxel, mm, positive. In a grid, the side is the distance between neighbours. In a hexagonal lattice (`hexagonal`,
        /// `disc`) the distance between neighbours is 1.0746 times as large.
        pitch_mm: f64 => Positive, Choice, Table, scale: Linear, gives_way: 3;
        /// Axis: side length of the square array, mm, positive, a multiple of the pitch.
        size_mm: Option<f64> => Positive, Choice, Table, title: "array size", scale: Linear, gives_way: 2;
        /// Axis: number of taxels along a side of the square array, at least 1. Replaces `size_mm`.
        taxels: Option<usize> => SIDE, Choice, Table, scale: Linear;
        /// Layout of the taxels: `grid` (default), `foveated` (closer in the middle, farther apart at the edge), `hexagonal`, `disc`, `cylinder` or `cap`. All
        /// layouts have the same area and about the same number of taxels.
        layout: Option<ArrayLayout> => Any, Choice, Axes, usual: || "grid".into();
        /// Radius of curvature of the layouts `cylinder` and `cap`, from the axis or centre to the rest centres of the taxels, mm, positive.
        curvature_radius_mm: Option<f64> => Positive, Choice, Axes;
        /// Quantity that each taxel reads: `deflection` (default), `force` along its axis, or `shear` (the force along its axis and two forces across it).
        sensed: Option<SensedSpec> => Any, Choice, Axes, title: "sensed quantity", usual: || "deflection".into();
        /// Friction coefficient μ ≥ 0 between taxels and object, with `sensed = "shear"`. Friction acts only if taxels move along the object, in a slide or on a
        /// curved layout. The taxels of a flat array that is pressed straight on do not slip. Default: 0.
        friction: Option<f64> => NotNegative, Condition, Axes;
        /// Tangential stiffness k_t of a taxel, N/m, positive; used with `friction`. Default: the stiffness along the axis.
        shear_stiffness_n_per_m: Option<f64> => Positive, Choice, Axes;
        /// Radius ρ of a taxel, mm, ρ > 0. Default: half the pitch.
        taxel_radius_mm: Option<f64> => Positive, Choice, Axes;
        /// Stroke s of a taxel, mm, positive: its maximum deflection.
        stroke_mm: f64 => Positive, Choice, Axes;
        /// Stiffness k of a taxel along its axis, N/m, positive. Default: 100.
        stiffness_n_per_m: f64 = STIFFNESS => Positive, Choice, Axes;
        /// Damping coefficient c of a taxel along its axis, N·s/m, c ≥ 0. Default: 0.
        damping_n_s_per_m: f64 = 0.0 => NotNegative, Choice, Axes;
    }
}

params! {
    /// Keys of `[touches]`: poses and depths at which the array touches objects.
    pub struct TouchesSpec {
        /// Poses in which the object lies on the table: `as_modelled` (default), or `stable` (all stable resting poses).
        rest: RestPoses = RestPoses::default() => Any, Condition, Axes;
        /// Number of touches per object, at least 1. Default: one touch per combination of the listed values.
        per_object: Option<usize> => TOUCHES, Choice, Axes;
        /// Offset of the patch's centre from the object's centre along the table's x axis, mm. Default: 0.
        offset_x_mm: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes;
        /// Offset of the patch's centre from the object's centre along the table's y axis, mm. Default: 0.
        offset_y_mm: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes;
        /// Rotation of the object about the vertical axis, degrees. Default: 0.
        yaw_deg: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes;
        /// Tilt of the patch about its x axis, degrees. Default: 0.
        tilt_x_deg: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes;
        /// Tilt of the patch about its y axis, degrees. Default: 0.
        tilt_y_deg: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes;
        /// Travel of the patch past first contact, mm, positive. Beyond the stroke, taxels stay saturated.
        depth_mm: SpreadSpec = SpreadSpec::List(Vec::new()) => Positive, Choice, Axes;
        /// Distance that the pressed patch slides along the object, mm, at least 0. Default: no slide.
        slide_mm: Option<f64> => SLIDE, Choice, Axes, usual: || 0.0.into();
        /// Direction of the slide, degrees from the patch's x axis towards its y axis; used with `slide_mm`. Default: 0.
        slide_deg: Option<f64> => Finite, Choice, Axes, usual: || 0.0.into();
        /// Axis: number F of frames per touch, at least 1. Default: 1. The frames are read at the depths d/F, 2d/F, …, d, where d is the depth of the touch; each
        /// has its own noise. The measurements of all frames are the features of the touch.
        frames: Axis<usize> = Axis::One(1) => Count(1, MAX_FRAMES), Choice, Table, title: "frames a touch", scale: Log, gives_way: 11;
        /// Speed of the patch towards the object when it is read, mm/s, at least 0; the speed affects the damper force. Default: 0.
        speed_mm_per_s: f64 = 0.0 => NotNegative, Choice, Axes;
    }
}

impl TouchesSpec {
    /// Returns a text that names the keys of `[touches]` with several values, which users may mistake for an axis of the study. Returns `None` if there is no
    /// such key.
    pub fn mixed_values(&self) -> Option<String> {
        let table = table_of(self);
        let lists = table.iter().filter_map(|(key, spread)| {
            let is_list = spread.as_array().is_some_and(|values| values.len() > 1);
            (is_list && key != "frames").then(|| format!("{key} = {spread}"))
        });
        let lists: Vec<String> = lists.collect();
        (!lists.is_empty()).then(|| {
            format!(
                "each configuration mixes touches of {}: a list in [touches] is spread over the touches of an object, not an axis. \
                 To compare its values, run a study for each (of depths, frames = F reads a touch at F of them); to mix them without \
                 this note, write {{ grid = [first, last, count] }} or {{ uniform = [low, high] }}",
                lists.join(" and ")
            )
        })
    }
}

/// Creates a specification without touches, for studies that do not press objects.
impl Default for TouchesSpec {
    fn default() -> Self {
        empty_table()
    }
}

words! {
    /// Quantity that each taxel reads.
    pub enum SensedSpec = Deflection {
        /// Deflection, metres.
        Deflection = "deflection",
        /// Force along the taxel's axis, newtons.
        Force = "force",
        /// Forces along and across the taxel's axis, newtons.
        Shear = "shear",
    }
}

variants! {
    /// Distribution of a pose parameter over the touches of an object.
    #[serde(expecting = "expected a number, a list, { grid = [first, last, count] }, { uniform = [low, high] } or { within = half_width }")]
    pub untagged enum SpreadSpec titled "number, list, `{ grid = [first, last, count] }`, `{ uniform = [low, high] }` or `{ within = half_width }`", Deserialize {
        /// Single value of the pose parameter for all touches, such as `yaw_deg = 30.0`.
        One(f64),
        /// List of values of the pose parameter, such as `yaw_deg = [0.0, 10.0, 20.0]`. Every configuration contains all values, so the list is not an axis.
        List(Vec<f64>),
        /// Grid or interval of values of the pose parameter, such as `{ grid = [0.0, 50.0, 6] }`, `{ uniform = [0.0, 360.0] }` or `{ within = 15.0 }`.
        Range(RangeSpec),
    }
}

variants! {
    /// Values of a pose parameter, given as a grid or an interval.
    pub enum RangeSpec {
        /// Evenly spaced values, given by the first value, the last value and the number of values.
        Grid = "grid"((f64, f64, usize)),
        /// Values drawn uniformly between a lower and an upper bound.
        Uniform = "uniform"((f64, f64)),
        /// Values drawn uniformly between −w and w, for a given half width w ≥ 0.
        Within = "within"(f64),
    }
}

named!(TouchKind);

params! {
    /// Keys of `[human_touch]`: recognition of kinds of human touch on a forearm. The columns of the array are bent around the arm; its rows run along the arm.
    pub struct HumanTouchSpec {
        /// Kinds of human touch that the classifier distinguishes. Default: all six.
        kinds: Vec<TouchKind> = crate::world::TOUCH_KINDS.to_vec() => Any, Condition, Axes;
        /// Number of human touches of each kind, at least 1.
        per_kind: usize => TOUCHES, Choice, Axes;
        /// Distance from the axis of the arm to the outside of its skin, mm, positive. Default: 43.
        arm_radius_mm: f64 = 43.0 => Positive, Choice, Axes;
        /// Frame rate of the skin, Hz, positive.
        frames_hz: f64 => Positive, Choice, Axes;
        /// Duration of the recording of each touch, s. The touch begins at a random time such that it ends within the recording.
        duration_s: f64 => Positive, Choice, Axes;
    }
}
