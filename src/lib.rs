//! Tactile simulation for robot skin: simulates presses, sensor signals and object recognition.
//!
//! # Glossary
//!
//! `bubbletouch_sim` defines the words of the simulation (taxel, patch, touch, press, frame, measurement, feature, scene). `bubbletouch_svm` defines the words
//! of learning (row, split, group, fold, kernel). The words of studies are:
//!
//! | word | meaning |
//! |---|---|
//! | **study** | a TOML file with a question and the axes to sweep; its results are tables and charts |
//! | **kind** | the type of a study: recognition, reconstruction, object detail, whole body or stability |
//! | **axis** | a key with several values; a **choice** describes the design, a **condition** the world |
//! | **configuration** | one value of each axis; its number identifies it in all tables |
//! | **variant** | one value of each axis in `[axes]`, and of each list of a key with one value: a study with these values in place of its own |
//! | **trial** | one draw of split, projection and noise; all configurations have the same trials |
//! | **family** | configurations that differ only in C and in touches per decision; they are trained together |
//! | **decision** | the class of one touch, or of several touches of an object (`touches_per_decision`) whose scores are added |
//! | **work item** | the smallest part of a study that is computed, stored and resumed |
//! | **journal** | the file with the results of all finished work items |
//! | **shard** | one of N parts of the work items, for one of N processes |
//! | **table**, **row**, **column** | a CSV file of results; a column has a role: choice, condition, value, cost or note |
//! | **page** | the file `report.html` with charts and tables |
//!
//! # One touch, from the object to the picture
//!
//! ```
//! use bubbletouch::contact::{Press, Until, Workspace};
//! use bubbletouch::objects::Catalogue;
//! use bubbletouch::random::Seed;
//! use bubbletouch::report::pressure_map::pressure_text;
//! use bubbletouch::report::terminal::Ink;
//! use bubbletouch::sensing::{Ensemble, Projection};
//! use bubbletouch::signal::{Chain, Noise, NoiseUnit, Quantity, SignalWorkspace, SignalStep};
//! use bubbletouch::world::{Grid, Patch, Placement, RestPoses, Spread, Taxel, touches};
//! use ndarray::Array2;
//!
//! // An object: a mug of real size, as spheres that are within half a millimetre of its surface.
//! let mug = Catalogue::builtin()?.object("mug")?.build(0.5e-3)?;
//!
//! // A patch: 32 × 32 taxels, 4 mm apart.
//! let grid = Grid { nx: 32, ny: 32, pitch: 4e-3 };
//! let taxel = Taxel { radius: 2e-3, stiffness: 100.0, damping: 0.0, stroke: 5e-3 };
//! let patch = Patch::grid(grid, taxel)?;
//!
//! // Touches: the mug stands upright, 3 mm deep, at one of five offsets.
//! let zero = || Spread::Values(vec![0.0]);
//! let placement = Placement {
//!     rest: RestPoses::AsModelled,
//!     offset_x: Spread::Values(vec![-8e-3, -4e-3, 0.0, 4e-3, 8e-3]),
//!     offset_y: zero(),
//!     yaw: zero(),
//!     tilt_x: zero(),
//!     tilt_y: zero(),
//!     depth: Spread::Values(vec![3e-3]),
//!     per_object: None,
//! };
//! let rests = placement.rest.poses(&mug.model);
//! let seed = Seed::new(2018).named("mug");
//! let all = touches(&placement, &rests, &seed)?;
//! assert_eq!(all.len(), 5);
//!
//! // Press once: no time loop, because nothing in this scene needs one.
//! let touch = &all[2];
//! let pose = touch.patch_from_object(&rests[touch.rest]);
//! let mut workspace = Workspace::new();
//! let contact = Press::new(&patch, &[mug.model], &[pose], Until::Depth(touch.depth)).run(&mut workspace)?;
//! let contact = contact.expect("the mug is under the patch");
//! assert!(contact.n_touched > 50 && contact.n_saturated == 0);
//! let mut frame = workspace.deflections().to_vec();
//! let deepest = frame.iter().fold(0.0_f64, |a, &b| a.max(b));
//! assert!((deepest - 3e-3).abs() < 1e-12);
//!
//! // Sensor signal: noise of 5 % of full scale, then smoothing.
//! let noise = Noise { std: 0.05, unit: NoiseUnit::FullScale };
//! let steps = [SignalStep::Noise(noise), SignalStep::Smoothing { width: 4e-3 }];
//! let chain = Chain::new(&steps, &patch)?;
//! chain.apply(&mut frame, None, &seed.numbered(2), &mut SignalWorkspace::default());
//!
//! // 64 measurements instead of 1,024 numbers.
//! let projection = Projection::new(Ensemble::Gaussian, grid.shape(), 64, &seed)?;
//! let frame = Array2::from_shape_vec((1, 1024), frame).expect("one number a taxel");
//! assert_eq!(projection.measure(frame.view()).dim(), (1, 64));
//!
//! // Picture as text: a ring, the mug's rim.
//! let frame = frame.into_shape_with_order((32, 32)).expect("one number a taxel");
//! println!("{}", pressure_text(&frame, 4.0, Quantity::Deflection, Ink::Plain, 80)?);
//! # Ok::<(), bubbletouch::Error>(())
//! ```
//!
//! A [`study`] simulates all touches of all objects in this way, splits them into training and test rows, and trains the classifiers of [`recognition`].
//!
//! # The pipeline
//!
//! Each stage imports only from the stages before it; [`geometry`], [`random`], [`files`] and [`error`] serve all.
//!
//! | stage | in → out |
//! |---|---|
//! | [`mesh`] | a file of triangles → a surface: distances, inside and outside |
//! | [`objects`] | a shape, a mesh, or spheres → a model: spheres or triangles |
//! | [`packing`] | a mesh and a tolerance → few spheres |
//! | [`world`] | taxels, layouts, resting poses → touches; robots and hands and their motion → poses |
//! | [`contact`] | a scene and poses → deflections; free objects → poses at rest |
//! | [`dynamics`] | taxels and objects with mass, over time: the reference for the quasi-static model |
//! | [`skin`] | patches and bodies of a simulator: poses or contact forces → deflections and wrenches |
//! | [`whole_body`] | millions of taxels, objects and poses → the touched taxels and their deflections |
//! | [`signal`] | deflections → frames |
//! | [`sensing`] | frames → measurements, and back |
//! | [`calibration`] | recorded frames → the parameters of the signal chain that made them |
//! | [`learning`], [`statistics`] | labelled measurements → classifiers, scores, intervals |
//! | [`inputs`] | files of the user → objects, arrays, checked values of keys |
//! | [`engine`] | work items → rows: axes, journal, shards, provenance |
//! | [`scene`] | TOML → robots, skin and objects that move → frames over time |
//! | [`report`] | tables and frames → charts, pages, pictures, terminal output |
//! | [`schema`] | specifications of studies and scenes → JSON Schemas, reference pages |
//! | [`studies`] | TOML → plan → work items → tables, charts, page |
//! | [`audit`] | recorded frames with labels → findings about the data |
//! | [`command`] | a command line → the work of a subcommand |
//!
//! [`recognition`], [`study`] and [`kinds`] re-export names of these stages under shorter paths.
//!
//! The stages from `mesh` to `calibration` are pure: they use no files, clock, threads, printing or global state. Exceptions: a robot may be
//! read from its path; large touches in `whole_body` and chains of packings in `packing` use the threads of the pool. All other threads are started in
//! `studies` and `report`. Files are read and written in `studies`, `report`, `inputs`, `engine`, `scene` and the command.
//!
//! The [`guide`] has chapters for users of the command and of the library. The first ones are [first study](guide::first_study) and [study
//! file](guide::study_file). Others describe [objects](guide::objects), [statistics](guide::statistics), [long runs](guide::long_runs) and the
//! [limits](guide::limits) of every method.
//!
//! # Sources
//!
//! - `[BT]` Hollis, Patterson, Cui, Trinkle, *BubbleTouch: a quasi-static tactile skin simulator*, 2018 (arXiv 1809.09153).
//! - `[CL]` Hollis, Patterson, Trinkle, *Compressed learning for tactile object recognition*, RA-L 2018 (arXiv 1609.07542,
//!   1705.05247).
//! - `[PT]` Pang, Trinkle, Lo, *A complementarity approach to a quasistatic multi-rigid-body contact problem*, COAP 1996.
//! - `[SD]` Sánchez-Durán et al., *Influence of errors in tactile sensors on some high level parameters used for manipulation
//!   with robotic hands*, Sensors 2015.
//! - `[GPI]` Sánchez-Durán et al., *Hysteresis correction of tactile sensor response with a generalized Prandtl–Ishlinskii
//!   model*, Microsystem Technologies 2012.
//! - `[MT]` Möller, Trumbore, *Fast, minimum storage ray/triangle intersection*, J. Graphics Tools 1997.
//! - `[VS]` van Oosterom, Strackee, *The solid angle of a plane triangle*, IEEE Trans. Biomed. Eng. 1983.
//! - `[BA]` Bærentzen, Aanæs, *Signed distance computation using the angle weighted pseudonormal*, TVCG 2005.
//! - `[GWN]` Jacobson, Kavan, Sorkine-Hornung, *Robust inside-outside segmentation using generalized winding numbers*, 2013.
//! - `[FWN]` Barill et al., *Fast winding numbers for soups and clouds*, 2018.
//! - `[URDF]` The Unified Robot Description Format, XML specification, <https://wiki.ros.org/urdf/XML>.
//! - `[MJCF]` MuJoCo's XML reference, <https://mujoco.readthedocs.io/en/latest/XMLreference.html>.
//! - `[FC]` Fritsch, Carlson, *Monotone piecewise cubic interpolation*, SIAM J. Numer. Anal. 1980; the slopes are those of
//!   Fritsch, Butland, *A method for constructing local monotone piecewise cubic interpolants*, SISSC 1984.
//! - `[KKS]` Kim, Kim, Shin, *A general construction scheme for unit quaternion curves with simple high order derivatives*,
//!   SIGGRAPH 1995.
//! - `[BK]` Buryanov, Kotiuk, *Proportions of hand segments*, International Journal of Morphology 2010.
//! - `[CoST]` Jung, Poppe, Poel, Heylen, *Touching the void: introducing CoST, corpus of social touch*, ICMI 2014.
//! - `[FH]` Flash, Hogan, *The coordination of arm movements: an experimentally confirmed mathematical model*, J. Neuroscience 1985.
//! - `[PX]` Salmon, Moraes, Dror, Shaw, *Parallel random numbers: as easy as 1, 2, 3*, SC 2011.
//! - `[SBHE]` Gan, Do, Tran, *Fast compressive imaging using scrambled block Hadamard ensemble*, 2008.
//!
//! On learning, named by authors and year:
//!
//! - Breiman, Friedman, Olshen, Stone, *Classification and regression trees*, 1984.
//! - Breiman, *Random forests*, Machine Learning 2001.
//! - DeCoste, Wagstaff, *Alpha seeding for support vector machines*, KDD 2000.
//! - Fan, Chen, Lin, *Working set selection using second order information for training support vector machines*, JMLR 2005.
//! - Goto, van de Geijn, *Anatomy of high-performance matrix multiplication*, ACM TOMS 2008.
//! - Hager, Zhang, *A new conjugate gradient method with guaranteed descent and an efficient line search*, SIAM J. Optim. 2005.
//! - Joachims, *Making large-scale SVM learning practical*, Advances in Kernel Methods 1999.
//! - Scheinberg, *An efficient implementation of an active set method for SVMs*, JMLR 2006.
//! - Wen et al., *Improving efficiency of SVM k-fold cross-validation by alpha seeding*, AAAI 2017.
#![warn(missing_docs)]
#![warn(clippy::missing_errors_doc)]
// `println!` panics on a closed pipe; output goes through the command.
#![cfg_attr(not(test), deny(clippy::print_stdout, clippy::print_stderr))]

// Macros that other crates use too name their items by this path.
extern crate self as bubbletouch;

pub mod audit;
pub mod command;
pub mod engine;
pub mod guide;
pub mod inputs;
pub mod kinds;
pub mod learning;
pub mod recognition;
pub mod report;
pub mod scene;
pub mod schema;
pub mod shell_line;
pub mod statistics;
pub mod studies;
pub mod study;
mod study_file;
pub mod table;

#[doc(hidden)]
pub use bubbletouch_sim::text::toml_text;
#[doc(no_inline)]
pub use serde;
#[doc(hidden)]
pub use serde_json;

pub use bubbletouch_sim::statistics::quantile;
#[cfg(test)]
use bubbletouch_sim::statistics::standard_errors;
pub(crate) use bubbletouch_sim::text::{encoding, note, numbers_csv, spelling, toml_lines};
pub use bubbletouch_sim::{
    Error, Result, calibration, contact, dynamics, error, files, geometry, mesh, objects, packing,
    random, sensing, signal, skin, whole_body, world,
};
