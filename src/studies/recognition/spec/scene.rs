//! What touches what, as it is written: `[objects]`, `[skin]` and `[touches]`.

use crate::engine::axis::{Axis, one_value};
use crate::inputs::defaults::number;
use crate::world::{ArrayLayout, RestPoses};
use serde::{Deserialize, Serialize};

/// `[skin]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkinSpec {
    /// Axis: side of the square that each taxel has for itself, mm: the distance between neighbours of a grid. In a hexagonal lattice
    /// (`hexagonal`, `disc`) neighbours are 1.0746 times as far apart.
    pub pitch_mm: Axis<f64>,
    /// Axis: side length of the square array, mm; a whole number of pitches.
    pub size_mm: Option<Axis<f64>>,
    /// Axis, instead of `size_mm`: taxels along a side.
    pub taxels: Option<Axis<usize>>,
    /// How the taxels lie, as many an area in every layout: `grid` (when left out), `hexagonal`, `disc`, `cylinder`, `cap`.
    pub layout: Option<ArrayLayout>,
    /// Radius to which `cylinder` and `cap` are bent, to the taxels' rest centres, mm.
    pub curvature_radius_mm: Option<f64>,
    /// What each taxel reads: `deflection` (when left out), `force` along its axis, or `shear`, which is this and the two forces across it.
    pub sensed: Option<SensedSpec>,
    /// μ between the taxels' tips and what they touch, beside `sensed = "shear"`, if tips go along the object: in a slide, or on a curved layout. A tip
    /// of a flat array that is pressed straight on stays where it first touches.
    pub friction: Option<f64>,
    /// k_t, N/m: how stiff the tips are across their axes, beside `friction`; as stiff as along them when left out.
    pub shear_stiffness_n_per_m: Option<f64>,
    /// ρ, mm; half the pitch when left out.
    pub taxel_radius_mm: Option<f64>,
    /// s, mm.
    pub stroke_mm: f64,
    /// k, N/m.
    #[serde(default = "number::<100>")]
    pub stiffness_n_per_m: f64,
    /// c, N·s/m.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
}

/// `[touches]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TouchesSpec {
    /// How the object lies on the table.
    pub rest: RestPoses,
    /// Touches an object; all combinations when left out.
    pub per_object: Option<usize>,
    /// Where the patch's centre is over the object's, along table x, mm.
    pub offset_x_mm: SpreadSpec,
    /// The same along table y, mm.
    pub offset_y_mm: SpreadSpec,
    /// How the object is turned about the vertical, degrees.
    pub yaw_deg: SpreadSpec,
    /// How the patch is tilted about its x axis, degrees.
    pub tilt_x_deg: SpreadSpec,
    /// The same about its y axis, degrees.
    pub tilt_y_deg: SpreadSpec,
    /// How far the patch goes past first contact, mm; beyond the stroke taxels stay saturated.
    pub depth_mm: SpreadSpec,
    /// How far the patch goes along what it touches once it is pressed, mm; not at all when left out.
    pub slide_mm: Option<f64>,
    /// In which direction, degrees from the patch's x towards its y, beside `slide_mm`; along x when left out.
    pub slide_deg: Option<f64>,
    /// Axis: F, frames a touch: it is read at the depths d/F, 2d/F … d, each frame with noise of its own, and the measurements
    /// of all of them are its features.
    pub frames: Axis<usize>,
    /// Approach speed at the moment of reading, mm/s: what the damper feels.
    pub speed_mm_per_s: f64,
}

impl TouchesSpec {
    /// Says which keys have a list of values, which looks like an axis and is none; `None` where no key has.
    pub fn mixed_values(&self) -> Option<String> {
        let table = toml::Table::try_from(self).expect("every field of a study has a TOML form");
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

/// No touches: those of a study that does not press objects.
impl Default for TouchesSpec {
    fn default() -> Self {
        Self {
            rest: RestPoses::default(),
            per_object: None,
            offset_x_mm: zero(),
            offset_y_mm: zero(),
            yaw_deg: zero(),
            tilt_x_deg: zero(),
            tilt_y_deg: zero(),
            depth_mm: SpreadSpec::List(Vec::new()),
            slide_mm: None,
            slide_deg: None,
            frames: one_value(),
            speed_mm_per_s: 0.0,
        }
    }
}

/// What a taxel reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SensedSpec {
    /// How far it is pushed in.
    #[default]
    Deflection,
    /// The force along its axis.
    Force,
    /// The forces along and across its axis.
    Shear,
}

/// How a touch parameter is spread over touches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected a number, a list, { grid = [first, last, count] }, { uniform = [low, high] } or { within = half_width }"
)]
pub enum SpreadSpec {
    /// `yaw_deg = 30.0`
    One(f64),
    /// `yaw_deg = [0.0, 10.0, 20.0]`: all of them in each configuration, as no axis.
    List(Vec<f64>),
    /// `yaw_deg = { grid = [0.0, 50.0, 6] }`, `{ uniform = [0.0, 360.0] }` or `{ within = 15.0 }`
    Range(RangeSpec),
}

/// A grid or an interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RangeSpec {
    /// First value, last value, how many.
    Grid(f64, f64, usize),
    /// Drawn uniformly between two values.
    Uniform(f64, f64),
    /// Drawn uniformly between a value below zero and as much above; 0: always zero.
    Within(f64),
}

fn zero() -> SpreadSpec {
    SpreadSpec::One(0.0)
}
