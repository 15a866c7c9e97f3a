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
pub(crate) use order::split_across;
pub use plane::nearest_distances;
pub use projected::{MissingTaxels, Projected};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::fixtures::grid;
    use glam::DVec3;

    #[test]
    fn what_cannot_be_a_layout_is_refused_with_its_name_or_taxel() {
        let listed =
            |centers: &[DVec3], axes: &[DVec3]| Layout::new(centers.to_vec(), axes.to_vec());
        let dome =
            |radius, polar, arc, pitch| Dome::new(radius, polar, arc, pitch).map(Layout::from);
        let grid = Layout::grid(&grid(1 << 12, 1 << 12, 1e-3));
        let (cylinder, cap) = (Layout::cylinder, Layout::sphere_cap);
        let (hexagonal, disc, annulus) = (Layout::hexagonal, Layout::disc, Layout::annulus);
        let (zero, up) = (DVec3::ZERO, DVec3::Z);
        let nowhere = DVec3::new(f64::NAN, 0.0, 0.0);
        for (layout, start) in [
            (
                cylinder(-1.0, 1.0, 1.0, 0.1),
                "cylinder radius: -1 m; a finite positive number",
            ),
            (
                cylinder(1.0, f64::INFINITY, 1.0, 0.1),
                "cylinder length: inf m; zero or a positive",
            ),
            (
                cylinder(1.0, 1.0, 7.0, 0.1),
                "cylinder arc: 7 rad; above 0 to 6.28",
            ),
            (cylinder(1.0, 1.0, 1.0, 1e-5), "cylinder layout: 1000020"),
            (cap(1.0, 0.0, 0.1), "cap half angle: 0 rad; above 0 to 3.14"),
            (cap(1.0, f64::NAN, 0.1), "cap half angle: NaN rad; "),
            (hexagonal(0, 3, 1e-3), "hexagonal layout: 0 taxels; 1 to "),
            (
                hexagonal(3, 3, 0.0),
                "taxel pitch: 0 m; a finite positive number",
            ),
            (
                disc(f64::NAN, 1e-3),
                "disc radius: NaN m; a finite positive number",
            ),
            (disc(1.0, 1e-6), "disc layout: 3627598735724 taxels; 1 to "),
            (
                annulus(2.0, 1.0, 0.1),
                "annulus layout: inner radius 2 m, outer radius 1 m; ",
            ),
            (annulus(0.0, 1.0, 0.1), "annulus inner radius: 0 m; "),
            (dome(0.0, 1.0, 1.0, 1e-3), "dome radius: 0 m; "),
            (dome(1.0, 4.0, 1.0, 1e-3), "dome polar angle: 4 rad; "),
            (dome(1.0, 1.0, -1.0, 1e-3), "dome arc: -1 rad; "),
            (dome(1.0, 1.0, 1.0, 1e-5), "dome layout: "),
            (
                listed(&[zero], &[]),
                "layout: 1 places with 0 axes; one axis a taxel",
            ),
            (listed(&[], &[]), "layout: 0 taxels; 1 to 4194304"),
            (
                listed(&[zero; 2], &[up, 2.0 * up]),
                "layout, taxel 2: axis [0, 0, 2] of length 2; a vector of",
            ),
            (
                listed(&[nowhere], &[up]),
                "layout, taxel 1: centre [NaN, 0, 0]; finite coordinates",
            ),
            (grid, "taxel grid: 16777216 taxels; 1 to 4194304"),
        ] {
            let error = layout.unwrap_err().to_string();
            assert!(error.starts_with(start), "{error}");
        }
    }
}
