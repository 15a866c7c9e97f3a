//! Skins: several patches beside several bodies, read at their poses in one call, for the loop of a simulator.
//!
//! A simulator of rigid bodies knows the poses of its bodies, and perhaps the contact forces between them. A [`Skin`] turns these into the deflections and
//! wrenches of its patches. [`Pressed`] states what decides how far a patch presses an object: the poses, a requested normal force of each pair, or the contact
//! forces of the simulator. [`ShearState`] adds shear springs with friction between successive reads.
//!
//! | file | content |
//! |---|---|
//! | `parts` | patches and bodies of a skin, and the broad phase |
//! | `skin` | [`Skin`]: patches, bodies and their relations |
//! | `reading` | [`SkinReading`]: results of a read, and its memory |
//! | `read` | reads at poses or to forces |
//! | `force_match` | the press of a patch on a rigid object to a given normal force |
//! | `read_loads` | reads under contact forces |
//! | `assigned_loads`, `point_loads` | the patch on which a contact force acts, and the deflections of a patch under such forces |
//! | `shear_state` | [`ShearState`]: shear springs between successive reads |

mod assigned_loads;
mod force_match;
mod parts;
mod point_loads;
mod read;
mod read_loads;
mod reading;
mod shear_state;
#[expect(clippy::module_inception, reason = "the file of the type `Skin`")]
mod skin;

pub use assigned_loads::BodyLoad;
pub use point_loads::{LoadPart, PointLoad};
pub use read::{Pressed, ReadOptions, SkinPoses};
pub use reading::{SkinReading, TouchCounts};
pub use shear_state::ShearState;
pub use skin::{Skin, SkinRelations};
