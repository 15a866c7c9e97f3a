//! The contact law \[BT\]: how far a sphere deflects a taxel, and which spheres can push a taxel.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | S | ρ + R, radii of taxel and sphere | m |
//! | h | height of the sphere's centre above the taxel's rest centre, along the taxel's axis | m |
//! | b | distance of the sphere's centre from the taxel's axis | m |
//! | q | S² − b² | m² |
//! | B | −s − ρ, height of the substrate ([`Taxel::substrate`](crate::world::Taxel::substrate)) | m |
//!
//! Contact with a sphere requires the deflection `δ = √q − h` ([`deflection`]) where q > 0, unless the sphere is behind the substrate. A taxel that rests on
//! the far side of the sphere has its centre at `h + √q`; the sphere counts if that is above B. Without a root this is
//!
//! ```text
//! q > max(B − h, 0)²
//! ```
//!
//! ([`is_in_front`]). A press from the front has B = −∞: all spheres with q > 0 count.
//!
//! Every layout finds the pairs of taxels and spheres with q > 0 in its own way, and shares q and h among taxels: `placed_sphere` (rows of a flat grid),
//! `near_spheres` (leaves of the taxel tree), and `reach` (with derivatives). In `whole_body` these are `row_press` (extrusions), `dome_press` (rings) and
//! `draped_press` (tiles). For a mesh the rule is applied to the heights at which a triangle stops a taxel ([`reaches_front`]).
//!
//! | file | content |
//! |---|---|
//! | `sphere` | deflection by a sphere, for one taxel and for lanes of taxels |
//! | `triangle` | height at which a triangle stops a taxel, for one taxel and for lanes of pairs |
//! | `behind` | obstacles behind the substrate |

mod behind;
mod sphere;
pub(super) mod triangle;

pub(crate) use behind::{far_side, is_in_front, reaches_front, squares_in_front, stop_in_front};
pub(crate) use sphere::{beats, deflection, indent, needed};

/// Returns the deflection, metres, above which a taxel with this stroke (metres) is saturated: the stroke times 1 + 1e-12. The tolerance ensures that a press
/// to a depth of exactly the stroke saturates no taxel.
pub fn saturation_limit(stroke: f64) -> f64 {
    stroke * (1.0 + 1e-12)
}
