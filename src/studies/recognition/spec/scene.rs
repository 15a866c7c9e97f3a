//! Specification of the touched scene: the tables `[objects]`, `[skin]` and `[touches]`, and `[human_touch]`, which replaces `[objects]` and `[touches]`.

use crate::inputs::keys::Acts;
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

const OF_FORCE: &str = "skin.sensed = \"force\" or \"force\" among signal.steps beside it";
const OF_FRAMES: &str = "no such key: rows and columns are those of the recorded frames";

/// Conditions of the keys that act with `sensed = "shear"` and friction.
const OF_SHEAR: &[Acts] = acts![
    Plan: |plan| plan.spec.reads_shear() => "the skin reads no shear", "skin.sensed = \"shear\" beside it, or no such key";
    Plan: |plan| plan.spec.recorded.is_some() || plan.spec.rubs()
        => "tips stay where they first touch", "a touches.slide_mm above 0 or a curved skin.layout beside it";
];

/// Skin and touches of a study of another kind than recognition, in which one array touches all objects.
pub(crate) struct OneArray {
    pub skin: SkinSpec,
    pub touches: TouchesSpec,
    /// Description of what is allowed if the study reads no force; `None` if it reads forces.
    pub without_force: Option<&'static str>,
}

params! {
    /// Keys of `[skin]`: the arrays of taxels.
    pub struct SkinSpec {
        /// Axis: side of the square area per taxel, mm, positive. In a grid, the side is the distance between neighbours. In a hexagonal lattice (`hexagonal`,
        /// `disc`) the distance between neighbours is 1.0746 times as large.
        pitch_mm: f64 => Positive, Choice, Table, scale: Linear, gives_way: 3, of_all_kinds: true;
        /// Axis: side length of the square array, mm, positive, a multiple of the pitch.
        size_mm: Option<f64> => Positive, Choice, Table, title: "array size", scale: Linear, gives_way: 2, of_all_kinds: true,
            acts: acts![StudySpec: |spec| spec.sets_taxels() => "", OF_FRAMES];
        /// Axis: number of taxels along a side of the square array, at least 1. Replaces `size_mm`.
        taxels: Option<usize> => SIDE, Choice, Table, scale: Linear, replaces: "size_mm", of_all_kinds: true,
            acts: acts![StudySpec: |spec| spec.sets_taxels() => "", OF_FRAMES];
        /// Layout of the taxels: `grid` (default), `foveated` (closer in the middle, farther apart at the edge), `hexagonal`, `disc`, `cylinder` or `cap`. All
        /// layouts have the same area and about the same number of taxels.
        layout: Option<ArrayLayout> => Any, Choice, Axes, usual: || "grid".into();
        /// Radius of curvature of the layouts `cylinder` and `cap`, from the axis or centre to the rest centres of the taxels, mm, positive.
        curvature_radius_mm: Option<f64> => Positive, Choice, Axes,
            acts: acts![Plan: |plan| plan.spec.is_curved() => "the layout is flat", "no such key, or a curved skin.layout beside it"];
        /// Quantity that each taxel reads: `deflection` (default), `force` along its axis, or `shear` (the force along its axis and two forces across it).
        sensed: Option<SensedSpec> => Any, Choice, Axes, title: "sensed quantity", usual: || "deflection".into(),
            acts: acts![HumanTouchSpec: |_human| false => "", "no such key in a study of human touches"];
        /// Friction coefficient μ ≥ 0 between taxels and object, with `sensed = "shear"`. Friction acts only if taxels move along the object, in a slide or on a
        /// curved layout. The taxels of a flat array that is pressed straight on do not slip. Default: 0.
        friction: Option<f64> => NotNegative, Condition, Axes, acts: OF_SHEAR;
        /// Tangential stiffness k_t of a taxel, N/m, positive; used with `friction`. Default: the stiffness along the axis.
        shear_stiffness_n_per_m: Option<f64> => Positive, Choice, Axes, acts: OF_SHEAR;
        /// Radius ρ of a taxel, mm, ρ > 0. Default: half the pitch.
        taxel_radius_mm: Option<f64> => Positive, Choice, Axes, of_all_kinds: true;
        /// Stroke s of a taxel, mm, positive: its maximum deflection.
        stroke_mm: f64 => Positive, Choice, Axes, of_all_kinds: true;
        /// Stiffness k of a taxel along its axis, N/m, positive. Default: 100.
        stiffness_n_per_m: f64 = STIFFNESS => Positive, Choice, Axes, of_all_kinds: true, acts: acts![
            Plan: |plan| plan.spec.recorded.is_some() || plan.spec.reads_force() => "no force is read", OF_FORCE;
            OneArray: |of| of.without_force.is_none() => "no force is read", of.without_force.unwrap_or_default();
        ];
        /// Damping coefficient c of a taxel along its axis, N·s/m, c ≥ 0. Default: 0.
        damping_n_s_per_m: f64 = 0.0 => NotNegative, Choice, Axes, of_all_kinds: true, acts: acts![
            HumanTouchSpec: |_human| false => "", "0: the skin of human touches has no damper";
            Plan: |plan| plan.spec.reads_force() => "no force is read", OF_FORCE;
            Plan: |plan| plan.speed > 0.0 => "every touch is read at rest", "a touches.speed_mm_per_s above 0 beside it";
            OneArray: |of| of.without_force.is_none() => "no force is read", of.without_force.unwrap_or_default();
            OneArray: |of| of.touches.speed_mm_per_s > 0.0 => "every touch is read at rest", "a touches.speed_mm_per_s above 0 beside it";
        ];
    }
}

params! {
    /// Keys of `[touches]`: poses and depths at which the array touches objects.
    pub struct TouchesSpec {
        /// Poses in which the object lies on the table: `as_modelled` (default), or `stable` (all stable resting poses).
        rest: RestPoses = RestPoses::default() => Any, Condition, Axes, of_all_kinds: true;
        /// Number of touches per object, at least 1. Default: one touch per combination of the listed values.
        per_object: Option<usize> => TOUCHES, Choice, Axes, of_all_kinds: true, of_all_touches: true;
        /// Offset of the patch's centre from the object's centre along the table's x axis, mm. Default: 0.
        offset_x_mm: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes, of_all_kinds: true;
        /// Offset of the patch's centre from the object's centre along the table's y axis, mm. Default: 0.
        offset_y_mm: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes, of_all_kinds: true;
        /// Rotation of the object about the vertical axis, degrees. Default: 0.
        yaw_deg: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes, of_all_kinds: true;
        /// Tilt of the patch about its x axis, degrees. Default: 0.
        tilt_x_deg: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes, of_all_kinds: true;
        /// Tilt of the patch about its y axis, degrees. Default: 0.
        tilt_y_deg: SpreadSpec = SpreadSpec::One(0.0) => Finite, Condition, Axes, of_all_kinds: true;
        /// Travel of the patch past first contact, mm, positive. Beyond the stroke, taxels stay saturated.
        depth_mm: SpreadSpec = SpreadSpec::List(Vec::new()) => Positive, Choice, Axes, of_all_kinds: true;
        /// Distance that the pressed patch slides along the object, mm, at least 0. Default: no slide.
        slide_mm: Option<f64> => SLIDE, Choice, Axes, usual: || 0.0.into();
        /// Direction of the slide, degrees from the patch's x axis towards its y axis; used with `slide_mm`. Default: 0.
        slide_deg: Option<f64> => Finite, Choice, Axes, usual: || 0.0.into(),
            acts: acts![Plan: |plan| plan.spec.slides() => "touches do not slide", "touches.slide_mm above 0 beside it, or no such key"];
        /// Axis: number F of frames per touch, at least 1. Default: 1. The frames are read at the depths d/F, 2d/F, …, d, where d is the depth of the touch; each
        /// has its own noise. The measurements of all frames are the features of the touch.
        frames: Axis<usize> = Axis::One(1) => Count(1, MAX_FRAMES), Choice, Table, title: "frames a touch", scale: Log, gives_way: 11, of_all_touches: true;
        /// Speed of the patch towards the object when it is read, mm/s, at least 0; the speed affects the damper force. Default: 0.
        speed_mm_per_s: f64 = 0.0 => NotNegative, Choice, Axes, of_all_kinds: true, acts: acts![
            Plan: |plan| plan.spec.depends_on_speed()
                => "the skin has no damper and is not scanned", "a skin.damping_n_s_per_m above 0 or \"scan\" among signal.steps beside it";
            OneArray: |of| of.without_force.is_none() => "no force is read", of.without_force.unwrap_or_default();
            OneArray: |of| of.skin.damping_n_s_per_m > 0.0 => "the skin has no damper", "a skin.damping_n_s_per_m above 0 beside it";
        ];
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
