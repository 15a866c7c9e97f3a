//! Contact \[BT\]: computes the taxels' deflections from a [`Patch`](crate::world::Patch), objects and poses.
//!
//! For taxel i (rest centre p, axis n, radius ρ) and sphere j (centre c, radius R): `S = ρ + R`, `h = (c − p)·n`, `b² = |c − p|² − h²`. If `b < S`, contact
//! with the sphere requires the deflection `δ_ij = √(S² − b²) − h`. The contact deflection is
//!
//! ```text
//! δ*_i = min(s, max(0, max_j δ_ij))
//! ```
//!
//! On a mesh the taxel stays on its substrate's side of every triangle swept by a ball of radius ρ. The module `law::triangle` has the
//! equations for faces, edges and corners.
//!
//! **Behind the substrate.** A press to a depth, a travel or a force approaches from the front, and all spheres count at any depth. The deflection of a
//! taxel of a flat patch therefore never decreases with the depth. At a pose without a path ([`Until::Pose`]) and for free objects,
//! a sphere or a mesh counts until it is wholly behind the substrate. The rule is applied to each taxel separately. The obstacle is behind if a
//! taxel resting on its far side would be behind the substrate, `h + √(S² − b²) < −s − ρ` (module `law`). A ball that moves through a skin therefore leaves
//! it taxel by taxel. In a time loop and along a press, an object that pushed a taxel in the previous step continues to push this taxel (module
//! `tree::held_parts`).
//!
//! A taxel that an object would push further than its stroke s is saturated; [`Contact`] counts such taxels.
//!
//! A **press** ([`Press`]) moves a patch along a direction until a condition is met ([`Until`]), and can then [slide](Press::slide) it sideways. On a flat
//! patch the law is evaluated at the final pose only. In a time loop, [`DamperState`] adds the damper: a free taxel relaxes, `k δ + c δ̇ = 0`. Without a
//! damper both agree exactly, so a scene without dampers needs no loop.
//!
//! On a flat grid with equal radii and substrate heights, the kernel works along rows, and rasterises the triangles of meshes. On any other layout, a search
//! tree finds the taxels near each sphere, and eight neighbouring taxels together search the triangles of a mesh. A press [with contacts](Press::with_contacts) also records which part of which object determines each deflection ([`TaxelContact`]).
//! From the contacts, [`pose_jacobian`] computes the derivatives of the deflections with respect to the objects' poses.
//! [`spring_load`] sums the forces of the springs.
//!
//! A free object rests where its weight and the forces of the taxels balance: [`equilibrium`].
//!
//! A press to a force ends where the springs carry Σ k δ = F together. [`MovedObject`] presses one object among others to a force.
//!
//! **Friction** is optional. With [`Shear`](crate::world::Shear) springs the objects drag the taxels sideways until they slip. With friction each taxel
//! measures a three-axis force ([`FrictionState`] has the equations). Without friction, and also with μ = 0, the forces are bitwise equal to `spring_load`.

mod damper;
pub mod equilibrium;
mod force_goal;
mod friction;
mod grid;
mod hold_force;
mod instructions;
pub(crate) mod lanes;
pub(crate) mod law;
mod mesh;
pub(crate) mod object_at;
mod pose_jacobian;
mod press;
mod press_summary;
mod root_search;
mod spring_load;
mod taxel_contact;
mod tree;
mod workspace;
mod wrench;

pub(crate) use damper::Relaxation;
pub use damper::{DamperState, relaxation_factor};
pub use friction::{ContactMode, ContactModeCounts, FrictionLoad, FrictionState, NormalForce};
#[doc(hidden)]
pub use grid::Lines;
pub use grid::Row;
pub use hold_force::{HeldForce, MovedObject};
pub use instructions::Instructions;
pub(crate) use instructions::for_instructions;
pub use law::saturation_limit;
#[doc(hidden)]
pub use law::triangle::stopping_height;
pub use object_at::OUT_OF_REACH;
pub use pose_jacobian::{POSE_PARAMETERS, pose_jacobian};
pub use press::{Press, Record, Until};
pub use press_summary::Contact;
pub(crate) use root_search::{Sample, crossing};
pub use spring_load::{AxialLoad, SpringLoad, axial_load, spring_load};
pub use taxel_contact::{GRAZING, TaxelContact};
pub(crate) use tree::press;
pub use workspace::Workspace;
pub use wrench::Wrench;
