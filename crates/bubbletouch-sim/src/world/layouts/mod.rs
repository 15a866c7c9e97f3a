//! Layouts: the positions and axes of the taxels of a patch.
//!
//! | file | layout |
//! |---|---|
//! | `layout` | any places and axes ([`Layout`]) |
//! | `flat` | hexagonal, rings, staggered rows in a plane |
//! | `extrusion` | a row repeated along a line ([`Extrusion`]): grids, cylinders |
//! | `dome`, `curved` | on spheres ([`Dome`]) and other curved surfaces |
//! | `draped`, `drape_region` | on a mesh, or on a part of a mesh |
//! | `projected` | a flat grid, projected onto a mesh ([`Projected`]) |
//! | `arrays` | arrays of equal area and density that can be compared ([`ArrayLayout`]) |
//! | `plane` | positions on a plane, distances of neighbours, layouts that are grids |
//! | `order` | the order in which taxels are numbered |
//! | `ring`, `limits` | rings around an axis, and the checks that all layouts share |

mod arrays;
mod curved;
mod dome;
mod drape_region;
mod draped;
mod extrusion;
mod flat;
mod layout;
mod limits;
mod order;
mod plane;
mod projected;
mod ring;

pub use arrays::ArrayLayout;
pub use dome::{Dome, DomeRing};
pub use drape_region::DrapeRegion;
pub use extrusion::Extrusion;
pub(crate) use layout::Rule;
pub use layout::{Layout, unit_axis};
pub use limits::MAX_TAXELS;
pub use plane::nearest_distances;
pub use projected::{MissingTaxels, Projected};
