//! Quasi-static simulation of tactile robot skin.
//!
//! | module | input → output |
//! |---|---|
//! | [`mesh`] | a file of triangles → a surface: distances, inside and outside |
//! | [`objects`] | a solid, a mesh or spheres → a model of spheres or triangles |
//! | [`packing`] | a mesh and a tolerance → few spheres |
//! | [`world`] | taxels, layouts, resting poses → touches; robots and their motion → poses |
//! | [`contact`] | a scene and poses → deflections and forces; free objects → poses at rest |
//! | [`dynamics`] | a scene with masses → motion over time: a reference for the quasi-static model |
//! | [`skin`] | patches and bodies of a simulator: poses or contact forces → deflections and wrenches |
//! | [`whole_body`] | millions of taxels, objects and poses → the taxels that are touched |
//! | [`signal`] | deflections → frames, as the electronics report them |
//! | [`calibration`] | recorded frames → the parameters of the signal chain |
//! | [`sensing`] | frames → compressed measurements, and reconstructed frames |
//! | [`features`] | frames → features that are invariant to place, turn or pressure |
//! | [`raster`] | spheres or another surface → shaded pictures |
//!
//! A stage imports only from stages above it in this table and from the shared modules:
//!
//! | module | contents |
//! |---|---|
//! | [`geometry`], [`random`], [`error`] | poses and boxes; named random streams; errors |
//! | [`statistics`], `linalg` | quantiles, confidence intervals; factorisations of matrices |
//!
//! # A touch
//!
//! ```
//! use bubbletouch_sim::contact::{Press, Until, Workspace};
//! use bubbletouch_sim::objects::Catalogue;
//! use bubbletouch_sim::random::Seed;
//! use bubbletouch_sim::signal::{Chain, Noise, NoiseUnit, SignalWorkspace, SignalStep};
//! use bubbletouch_sim::world::{Grid, Patch, Placement, RestPoses, Spread, Taxel, touches};
//!
//! // A mug of real size, as spheres that are within half a millimetre of its surface.
//! let mug = Catalogue::builtin()?.object("mug")?.build(0.5e-3)?;
//!
//! // A patch of 32 × 32 taxels, 4 mm apart.
//! let taxel = Taxel { radius: 2e-3, stiffness: 100.0, damping: 0.0, stroke: 5e-3 };
//! let patch = Patch::grid(Grid { nx: 32, ny: 32, pitch: 4e-3 }, taxel)?;
//!
//! // One touch: the mug stands upright below the middle of the patch, which goes 3 mm past first contact.
//! let zero = || Spread::Values(vec![0.0]);
//! let placement = Placement {
//!     rest: RestPoses::AsModelled,
//!     offset_x: zero(),
//!     offset_y: zero(),
//!     yaw: zero(),
//!     tilt_x: zero(),
//!     tilt_y: zero(),
//!     depth: Spread::Values(vec![3e-3]),
//!     per_object: None,
//! };
//! let rests = placement.rest.poses(&mug.model);
//! let seed = Seed::new(2018);
//! let touch = touches(&placement, &rests, &seed)?.remove(0);
//! let pose = touch.patch_from_object(&rests[touch.rest]);
//! let mut workspace = Workspace::new();
//! let contact = Press::new(&patch, &[mug.model], &[pose], Until::Depth(touch.depth)).run(&mut workspace)?;
//! assert!(contact.is_some_and(|contact| contact.n_saturated == 0));
//! let mut frame = workspace.deflections().to_vec();
//! let deepest = frame.iter().fold(0.0_f64, |a, &b| a.max(b));
//! assert!((deepest - 3e-3).abs() < 1e-12);
//!
//! // The electronics: noise of 5 % of full scale, then smoothing.
//! let noise = Noise { std: 0.05, unit: NoiseUnit::FullScale };
//! let steps = [SignalStep::Noise(noise), SignalStep::Smoothing { width: 4e-3 }];
//! Chain::new(&steps, &patch)?.apply(&mut frame, None, &seed.named("noise"), &mut SignalWorkspace::default());
//! # Ok::<(), bubbletouch_sim::Error>(())
//! ```
//!
//! # Glossary
//!
//! | word | meaning |
//! |---|---|
//! | **taxel** | one sensing element (tactile pixel): a sphere on a spring and damper that slides along one axis |
//! | **patch** | a rigid substrate with taxels in a **layout**; an **array** is a patch in a study |
//! | **stroke** | the largest deflection of a taxel, metres; a taxel at its stroke is **saturated** |
//! | **object** | a rigid body: a union of spheres (its **packing** if it was a mesh or a solid), or a triangle mesh |
//! | **scene** | robots, patches and objects that move |
//! | **touch** | one contact experiment: a pose of the object, and a depth past first contact |
//! | **press** | the computation of the deflections of one patch at one touch or pose |
//! | **deflection** | displacement of a taxel along its axis from rest, metres, 0 ≤ δ ≤ stroke |
//! | **equilibrium** | poses of free objects at which all forces and torques balance |
//! | **frame** | the values of all taxels of a patch at one instant: one number per taxel, or three with shear |
//! | **signal chain** | the steps that turn deflections into frames; a **sensor error** is a step with a strength |
//! | **measurement** | one number of a compressed frame, `y = Φx`; **ratio** is taxels per measurement, n / m |
//! | **ensemble** | a distribution of the matrix Φ; a **projection** is one draw of it |
//! | **feature** | a number that is computed from a frame for a classifier |
//! | **seed** | the root, or a named node, of the tree of random numbers; a **stream** is the numbers of one node |
//! | **workspace** | reusable memory of a computation; results do not depend on its content |
#![warn(missing_docs)]
#![warn(clippy::missing_errors_doc)]
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

#[doc(hidden)]
pub mod audit;
pub mod calibration;
pub mod contact;
#[doc(hidden)]
pub mod disjoint_sets;
pub mod dynamics;
pub mod error;
pub mod features;
#[doc(hidden)]
pub mod files;
#[doc(hidden)]
pub mod frame_coding;
pub mod geometry;
mod linalg;
pub mod mesh;
pub mod objects;
pub mod own;
pub mod packing;
pub mod random;
pub mod raster;
pub mod sensing;
pub mod signal;
pub mod skin;
pub mod statistics;
#[doc(hidden)]
pub mod text;
pub mod whole_body;
pub mod world;

pub use error::{Error, Result};
