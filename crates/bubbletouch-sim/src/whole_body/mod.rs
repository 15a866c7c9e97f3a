//! Whole body: millions of taxels that are mostly not touched → the touched ones, at a cost that follows the contact.
//!
//! The equations are those of [`contact`](crate::contact), and so are the results, to 1e-12 m; with dampers to
//! [`AT_REST`], below which a taxel that relaxes counts as at rest. What differs is what is looked at:
//!
//! 1. **patches** ([`BodyPatch`]): those whose ball is near an object's, and those on which something still relaxes;
//! 2. **spheres** ([`SphereClusters`]): a cluster of neighbours at a time, only those near a bundle of the patch's columns;
//! 3. **taxels**: a patch is a row of taxels repeated along a line ([`Extrusion`](crate::world::Extrusion)). Across the line a
//!    sphere is `b` beside the axis of a column and `h` above it, the same in all rows; along it, `d` from a row. So
//!    `δ = √(S² − b² − d²) − h`, with the first part once a column and sphere, the root once a taxel that it covers.
//!    On a sphere of radius R around the origin ([`Dome`](crate::world::Dome)) taxels lie in rings, and all that a taxel's axis n
//!    decides is t = c·n: `δ = √(t² − |c|² + S²) − (t − R)`, so that a sphere covers an interval of each ring. On any other surface
//!    taxels have their own axes, and are looked at by tiles of eight.
//!
//! A patch remembers which columns of which rows it has touched: only these are wiped, relaxed and read
//! ([`BodyState::touched`], [`BodyState::forces`]); [`WholeBody::frame`] makes a dense frame of them.
//!
//! ```
//! use bubbletouch_sim::geometry::Pose;
//! use bubbletouch_sim::objects::{Sphere, SphereUnion};
//! use bubbletouch_sim::whole_body::{BodyState, SphereClusters, WholeBody};
//! use bubbletouch_sim::world::{Extrusion, Patch, Taxel};
//! use glam::DVec3;
//!
//! // Two forearms of 8 cm across, with a taxel every 2 mm, 30 cm apart.
//! let taxel = Taxel { radius: 1e-3, stiffness: 100.0, damping: 0.0, stroke: 2e-3 };
//! let sleeve = Extrusion::cylinder(0.04, 0.25, 3.0, 2e-3)?;
//! let patches = ["left", "right"].map(|name| Patch::new(name, sleeve.clone(), taxel));
//! let body = WholeBody::new(&patches.into_iter().collect::<Result<Vec<_>, _>>()?)?;
//! let mut state = BodyState::at_rest(&body);
//! state.place(&body, &[-0.15, 0.15].map(|y| Pose::from_translation(y * DVec3::Y)));
//!
//! // A ball comes a millimetre too near to the right one.
//! let ball = Sphere { center: DVec3::ZERO, radius: 0.03 };
//! let ball = SphereClusters::new(&SphereUnion::new(vec![ball])?);
//! let at = Pose::from_translation(DVec3::new(0.07, 0.15, 0.0));
//! let contact = state.press(&body, &[ball], &[at], 1e-3);
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
