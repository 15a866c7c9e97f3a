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
//! A free object rests where its weight and the forces of the taxels balance: [`balance`].
//!
//! A **touch to a force** goes on until the springs carry Σ k δ = F together: exactly the press at the travel that it finds.
//! [`MovedObject`] holds a force by one object among others.
//!
//! **Friction** is an option: with [`Shear`](crate::world::Shear) springs the tips of the taxels are dragged along and slip, and each
//! taxel feels a force in three dimensions ([`FrictionState`], which has the equations). Without it, and with μ = 0 to the bit, the forces
//! are those of `spring_load`.

mod approach;
mod approach_force;
pub mod balance;
mod below;
mod coulomb;
mod crossing;
mod damper;
mod envelope;
mod friction;
mod grid_force;
mod grid_lines;
mod grid_press;
mod hold_force;
mod instructions;
pub(crate) mod law;
mod near_spheres;
mod placed_sphere;
mod press;
mod row;
mod sheet;
mod simulate;
mod skin_mesh;
mod sphere_search;
mod spring_load;
mod swept_triangle;
mod taxel_contact;
mod tree_press;
mod way;
mod workspace;

pub use approach::Approach;
pub use below::Below;
pub(crate) use crossing::{Sample, crossing};
pub use damper::Relaxation;
pub use damper::{DamperState, relaxation_factor};
pub use friction::{FrictionLoad, FrictionState, Grip, GripCounts, NormalForce};
pub use grid_lines::Lines;
pub use grid_press::saturation_limit;
pub use hold_force::{HeldForce, MovedObject};
pub use instructions::Instructions;
pub(crate) use instructions::for_instructions;
pub use press::{
    Contact, Goal, first_contact, press, press_at_pose, press_into, press_onto_zeros,
    press_to_depth, press_to_force, press_to_travel, press_with_contacts,
};
pub use row::Row;
pub use simulate::{Recording, simulate};
pub use spring_load::{AxialLoad, SpringLoad, Wrench, axial_load, spring_load};
pub use swept_triangle::stopping_height;
pub use taxel_contact::{GRAZING, TaxelContact};
pub use workspace::Workspace;
