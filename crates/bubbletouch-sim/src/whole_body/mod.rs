//! Whole body: skins with millions of taxels, most of them untouched. The cost of a step depends on the contact area.
//!
//! Equations and results agree with [`contact`](crate::contact) to 1e-12 m. With dampers the tolerance is [`AT_REST`], below which a relaxing taxel counts as
//! at rest. The search has three stages:
//!
//! 1. **Patches** ([`BodyPatch`]): those whose ball is near an object's, and those with relaxing taxels.
//! 2. **Spheres** ([`SphereClusters`]): clusters of neighbours, of which only those near a bundle of the patch's columns are opened.
//! 3. **Taxels**, depending on the surface:
//!
//! On an [`Extrusion`](crate::world::Extrusion), a row of taxels is repeated along a line. Let b be the distance of a sphere beside the axis of a column
//! and h its height above the column, equal for all rows. Let d be its distance from a row along the line. The deflection is `δ = √(S² − b² − d²) − h`.
//! The first terms are computed once per column and sphere, the root once per covered taxel.
//!
//! On a sphere of radius R around the origin ([`Dome`](crate::world::Dome)) taxels lie in rings, and δ depends on a taxel's axis n
//! only through t = c·n. The deflection is `δ = √(t² − |c|² + S²) − (t − R)`, so a sphere covers an interval of each ring.
//!
//! On other surfaces taxels have their own axes and are evaluated in tiles of eight.
//!
//! A patch stores which columns of which rows it has touched. Only these are cleared, relaxed and read
//! ([`BodyState::touched`], [`BodyState::forces`]); [`WholeBody::frame`] converts them to a dense frame.
//!
//! ```
//! use bubbletouch_sim::geometry::Pose;
//! use bubbletouch_sim::objects::{Sphere, SphereUnion};
//! use bubbletouch_sim::whole_body::{BodyState, SphereClusters, WholeBody};
//! use bubbletouch_sim::world::{Extrusion, Patch, Taxel};
//! use glam::DVec3;
//!
//! // Two forearms with a diameter of 8 cm and a taxel every 2 mm, 30 cm apart.
//! let taxel = Taxel { radius: 1e-3, stiffness: 100.0, damping: 0.0, stroke: 2e-3 };
//! let sleeve = Extrusion::cylinder(0.04, 0.25, 3.0, 2e-3)?;
//! let patches = ["left", "right"].map(|name| Patch::new(name, sleeve.clone(), taxel));
//! let body = WholeBody::new(&patches.into_iter().collect::<Result<Vec<_>, _>>()?)?;
//! let mut state = BodyState::at_rest(&body);
//! state.place(&body, &[-0.15, 0.15].map(|y| Pose::from_translation(y * DVec3::Y)))?;
//!
//! // A ball is pressed one millimetre into the right forearm.
//! let ball = Sphere { center: DVec3::ZERO, radius: 0.03 };
//! let ball = SphereClusters::new(&SphereUnion::new(vec![ball])?);
//! let at = Pose::from_translation(DVec3::new(0.07, 0.15, 0.0));
//! let contact = state.press(&body, &[ball], &[at], 1e-3)?;
//! assert!(contact.n_touched > 10 && contact.n_patches == 1);
//! let (first, _) = state.touched(&body).next().unwrap();
//! assert!(first >= body.patches()[0].n_taxels(), "it is on the second patch");
//! # Ok::<(), bubbletouch_sim::Error>(())
//! ```

mod body_patch;
mod body_state;
mod cover;
mod dome_patch;
mod dome_press;
mod draped_patch;
mod draped_press;
mod flat_ends;
mod half_balls;
mod lanes;
mod object_press;
mod patch_state;
mod row_patch;
mod row_press;

pub use crate::contact::Instructions;
pub use crate::objects::SphereClusters;
pub use body_patch::{BodyPatch, WholeBody};
pub use body_state::{BodyContact, BodyState, WORTH_THREADS};
pub use cover::CoveredRobot;
pub use patch_state::AT_REST;
