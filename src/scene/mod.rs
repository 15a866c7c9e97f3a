//! Scenes: a TOML file describes robots, skin and moving objects. A simulation computes frames over time.
//!
//! A [`SceneSpec`] (keys as written) is checked and converted to a [`ScenePlan`] (SI units, files read). A [`Simulation`] steps the plan and passes each
//! [`Frame`] to the [`FrameSink`]s as soon as it is computed. Only the current state is stored.
//!
//! Each step performs these computations in order:
//!
//! 1. Robots and imposed objects move to the poses of their trajectories. Patches move with their links.
//! 2. Pressed objects ([`PressSpec`]) move along their lines until the spring force Σ k δ of their patches reaches the target. The speed limits the travel in a
//!    step ([`MovedObject`](crate::contact::MovedObject)). Without dampers, the recorded force equals the target. With dampers it is larger while deflections
//!    grow, smaller while they shrink, and equal at rest. If a target cannot be reached, the object stops at its maximum travel without an error; each frame
//!    contains the actual force.
//! 3. Free objects move to a common equilibrium on skin, planes ([`PlaneSpec`]), imposed objects and one another ([`balance`](crate::contact::equilibrium)).
//!    Each starts at its last pose. Skin carries them by its springs, the dampers' forces within the step, and the reactions of rigid stops at the end of
//!    the stroke. The equilibrium determines these reactions.
//! 4. Each patch computes its contacts, unless no object is within its reach. Taxels without contact relax ([`DamperState`](crate::contact::DamperState)). On
//!    a patch with friction, the ends of the tangential springs move with the contacting objects ([`FrictionState`](crate::contact::FrictionState)), whether
//!    the patch or the object moves.
//!
//! A scene starts in the steady state of its poses at t = 0. A scene without dampers, friction, free objects and pressed objects has no memory. A scene without
//! memory is evaluated only at its frames, with equal results.
//!
//! The model has these limits:
//!
//! - Planes and objects hold free objects without friction.
//! - Skin has friction with a free object only at contacts that exist at the start of a step or when the object is placed.
//! - Imposed objects touch free objects and skin, but not each other or planes.
//! - Free objects neither swing nor bounce (\[BT\] is quasi-static).
//! - An object that has escaped has no contacts.
//!
//! ```
//! use bubbletouch::scene::{ScenePlan, SceneSpec, Simulation, Stepping};
//!
//! let spec = SceneSpec::parse("ball.toml", r#"
//! title = "A tennis ball comes down on a palm and goes again"
//! output_hz = 10.0
//!
//! [[patches]]
//! name = "palm"
//! layout = { grid = { nx = 16, ny = 16, pitch_mm = 4.0 } }
//! stroke_mm = 5.0
//!
//! [[objects]]
//! name = "ball"
//! object = "tennis"
//! at = { position_mm = [0.0, 0.0, 3.0] }
//! motion = { phases = [
//!     { duration_s = 1.0, linear_mm_per_s = [0.0, 0.0, -5.0] },
//!     { duration_s = 1.0, linear_mm_per_s = [0.0, 0.0, 5.0] },
//! ] }
//! "#)?;
//! let plan = ScenePlan::new("ball.toml", std::path::Path::new(""), spec)?;
//! let mut frames = Vec::new();
//! Simulation::new(&plan, Stepping::AsNeeded).run(&mut [&mut frames])?;
//! assert_eq!(frames.len(), 21);
//! let [first, middle, last] = [0, 10, 20].map(|k| frames[k].patches[0].n_touched);
//! assert!(first == 0 && middle > 20 && last == 0);
//! # Ok::<(), bubbletouch::Error>(())
//! ```

mod by_hand;
mod frame;
mod free_objects;
mod link_surface;
mod overlap;
mod plan;
mod plan_object;
mod plan_patch;
mod plan_robot;
mod plan_signal;
mod plan_taxels;
mod planned;
mod pressed_objects;
mod reader;
mod robot_state;
mod simulation;
mod skin_state;
pub(crate) mod spec;
pub(crate) mod spec_motion;
mod spec_patch;

pub use frame::{
    Frame, FrameSink, FrictionReading, ObjectReading, ObjectSummary, PatchPeaks, PatchReading,
    PoseControl, Summary,
};
pub use link_surface::{LinkSurface, link_surface};
pub use plan::ScenePlan;
pub use plan_object::{Movement, PlannedObject, PlannedPress};
pub use planned::{Carrier, PlannedPatch, PlannedRobot, PlannedSignal};
pub(crate) use reader::Reader;
pub use simulation::{Simulation, Stepping};
pub use spec::*;
