//! Scene: a TOML file → robots, skin and objects that move → frames over time.
//!
//! [`SceneSpec`] (as written) → [`ScenePlan`] (checked, SI, files read) → [`Simulation`] (steps) → [`Frame`]s, each handed to
//! [`FrameSink`]s as it is made. Nothing is kept but the current state.
//!
//! At each step, in this order:
//!
//! 1. robots and imposed objects go where their motions say; patches go with their links;
//! 2. objects that are pushed for a force ([`PressSpec`]) go on along their lines until their patches feel it, as far as their
//!    speed lets them in a step ([`MovedObject`](crate::contact::MovedObject)): the springs together, Σ k δ. So without dampers the force
//!    that is recorded is the one that is wanted; with them it is more while taxels go in, less while they come out, and
//!    the same when all rest. A force that is not reached is no error: the object waits at the end of its travel, and each frame
//!    says what it carries;
//! 3. free objects go to rest on the skin that is there, on planes ([`PlaneSpec`]), on imposed objects and on one another, all together and each from
//!    where it was ([`balance`](crate::contact::equilibrium)). What carries them on skin is its springs, with what dampers add to them
//!    within the step, and, at the end of a stroke, the reaction of the rigid stop, which
//!    follows from the balance and counts in the forces of the patch;
//! 4. each patch is pressed, unless no object is within its reach: what nothing pushes relaxes
//!    ([`DamperState`](crate::contact::DamperState)), and the tips of a patch with friction are dragged along
//!    ([`FrictionState`](crate::contact::FrictionState)), whatever moves, patch or object.
//!
//! A scene begins as if it had stood as it does at t = 0 for long. One without dampers, friction, free and pushed objects remembers
//! nothing, so it is evaluated at its frames only, with the same result.
//!
//! What is not modelled: planes and objects hold free ones without friction, and so does skin that a free object meets only on its way to rest
//! (what it touched when a step began, or where it was put, holds it); imposed objects touch free ones and skin, not each other or planes; free objects neither swing nor bounce (\[BT\] is quasi-static); an
//! object that has escaped touches nothing any more.
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
mod mount;
mod numbers;
mod overlap;
mod plan;
mod plan_object;
mod plan_patch;
mod plan_press;
mod plan_robot;
mod plan_signal;
mod plan_taxels;
mod pressed_objects;
mod reader;
mod robot_state;
mod simulation;
mod skin_state;
mod spec;
pub(crate) mod spec_motion;
mod spec_object;
mod spec_patch;
mod summary;

pub use frame::{Frame, FrameSink, FrictionReading, Held, ObjectReading, PatchReading};
pub use mount::Mount;
pub use plan::ScenePlan;
pub use plan_object::{Movement, PlannedObject};
pub use plan_patch::PlannedPatch;
pub use plan_press::PlannedPress;
pub use plan_robot::PlannedRobot;
pub use plan_signal::PlannedSignal;
pub use simulation::{Simulation, Stepping};
pub use spec::*;
pub use summary::{ObjectSummary, PatchPeaks, Summary};
