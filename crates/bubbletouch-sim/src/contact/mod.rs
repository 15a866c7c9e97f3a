//! Contact: a [`Patch`](crate::world::Patch), objects and poses → deflections \[BT\].
//!
//! For taxel i (rest centre p, axis n, radius ρ) and sphere j (centre c, radius R): `S = ρ + R`, `h = (c − p)·n`,
//! `b² = |c − p|² − h²`. If `b < S`, the sphere needs `δ_ij = √(S² − b²) − h`. The contact deflection is
//!
//! ```text
//! δ*_i = min(s, max(0, max_j δ_ij))
//! ```
//!
//! On a mesh the taxel stays on its substrate's side of every triangle swept by a ball of radius ρ: `swept_triangle` has the
//! equations of its faces, edges and corners.
//!
//! **Behind the substrate.** A press comes from the front and stays there: to a depth, a travel or a force all counts, however deep,
//! so that no taxel of a flat patch is deflected less the deeper it is pressed. At a pose without such a way ([`press_at_pose`],
//! [`press_with_contacts`]) and to free objects a sphere or a mesh counts until it is wholly behind the substrate, as far as that taxel can
//! tell: a taxel that rests on its far side would be further back than the substrate is, `h + √(S² − b²) < −s − ρ` (the module `law` has this
//! predicate). So a ball that goes through a skin leaves it taxel by taxel. In a time loop, and on the way of a press, what pushed a taxel in the step before
//! goes on pushing it.
//!
//! A taxel that would have to go further than its stroke s is saturated: counted in [`Contact`], never hidden.
//!
//! A **direct press** ([`press_to_depth`], [`press_to_travel`], [`press_to_force`]; along other directions than z, and on from there
//! sideways: [`Approach`]) evaluates this at the final pose. A **time loop** ([`simulate()`], [`DamperState`]) adds the damper: a taxel
//! that nothing pushes relaxes, `k δ + c δ̇ = 0`. Without a damper both agree exactly, so a scene that has none needs no loop.
//!
//! On a flat grid of taxels that go equally deep the kernel goes along rows; on any other layout it finds the taxels near each sphere in a
//! tree. [`press_with_contacts`] also says which part of which object decides each taxel ([`TaxelContact`]); [`spring_load`] adds up
//! what the springs carry.
//!
//! A free object rests where its weight and the forces of the taxels balance: [`equilibrium`].
//!
//! A **touch to a force** goes on until the springs carry Σ k δ = F together: exactly the press at the travel that it finds.
//! [`MovedObject`] holds a force by one object among others.
//!
//! **Friction** is an option: with [`Shear`](crate::world::Shear) springs the tips of the taxels are dragged along and slip, and each
//! taxel feels a force in three dimensions ([`FrictionState`], which has the equations). Without it, and with μ = 0 to the bit, the forces
//! are those of `spring_load`.

mod damper;
pub mod equilibrium;
mod force_goal;
mod friction;
mod grid;
mod hold_force;
mod instructions;
mod lanes_below;
pub(crate) mod law;
mod mesh;
mod press;
mod press_summary;
mod root_search;
mod simulate;
mod spring_load;
mod taxel_contact;
mod tree;
mod workspace;
mod wrench;

pub use damper::{DamperState, Relaxation, relaxation_factor};
pub use friction::{ContactMode, ContactModeCounts, FrictionLoad, FrictionState, NormalForce};
pub use grid::{Lines, Row};
pub use hold_force::{HeldForce, MovedObject};
pub use instructions::Instructions;
pub(crate) use instructions::for_instructions;
pub use lanes_below::LanesBelow;
pub use law::saturation_limit;
pub use mesh::stopping_height;
pub use press::{
    Goal, first_contact, press, press_at_pose, press_into, press_onto_zeros, press_to_depth,
    press_to_force, press_to_travel,
};
pub use press_summary::Contact;
pub(crate) use root_search::{Sample, crossing};
pub use simulate::{Recording, simulate};
pub use spring_load::{AxialLoad, SpringLoad, axial_load, spring_load};
pub use taxel_contact::{GRAZING, TaxelContact};
pub use tree::{Approach, press_with_contacts};
pub use workspace::Workspace;
pub use wrench::Wrench;
