//! Arguments that describe the layout and the taxels of a patch.

use crate::arrays::{Object, array, each, points, whole_number, whole_numbers};
use crate::errors::{bad_input, exception, one_of};
use bubbletouch::geometry::Aabb;
use bubbletouch::world::{DrapeRegion, Layout, MissingTaxels, Taxel};
use pyo3::prelude::*;

/// Default stiffness of a taxel, N/m. The value equals the command's default, and signatures state it for `help()`.
const STIFFNESS: f64 = 100.0;

/// Returns the layout with the shape of its frames: (ny, nx) or (n_taxels,).
pub fn with_shape(layout: Layout, shape: Option<Vec<i64>>) -> PyResult<Layout> {
    let n_taxels = layout.n_taxels();
    match shape.as_deref() {
        None => Ok(layout),
        Some(&[n]) if usize::try_from(n) == Ok(n_taxels) => Ok(layout),
        Some(&[ny, nx]) => {
            let sides = [side("shape", ny)?, side("shape", nx)?];
            layout.with_sides(sides).map_err(exception)
        }
        Some(other) => {
            let allowed = format!("({n_taxels},), or (ny, nx) with this product");
            Err(bad_input("shape", format!("{other:?}"), allowed))
        }
    }
}

/// Reads the row and the column of each of n taxels in an image.
pub fn pixels_of(given: &Object, n: usize) -> PyResult<Vec<[usize; 2]>> {
    let array = array("pixels", given, &format!("({n}, 2)"), |shape| {
        shape == [n, 2]
    })?;
    let pixels: Vec<u32> = whole_numbers("pixels", array.values(), "integers from 0")?;
    let pixels = pixels.as_chunks::<2>().0.iter();
    Ok(pixels
        .map(|pixel| pixel.map(|side| side as usize))
        .collect())
}

/// Converts a number of rows or columns; the library checks that it is at least 1.
pub fn side(place: &str, given: i64) -> PyResult<usize> {
    usize::try_from(given).map_err(|_| bad_input(place, given, "at least 1"))
}

/// Returns the parameters that all taxels of a patch have in common. If no radius is given, it is half the pitch.
pub fn taxel(
    pitch: f64,
    stroke: f64,
    (radius, stiffness, damping): (Option<f64>, f64, f64),
) -> Taxel {
    Taxel {
        radius: radius.unwrap_or(0.5 * pitch),
        stiffness,
        damping,
        stroke,
    }
}

/// Returns the parameters of n taxels, each given as an array or as one number for all taxels.
pub fn each_taxel(
    n: usize,
    (stroke, radius): (&Object, &Object),
    (stiffness, damping): (Option<&Object>, Option<&Object>),
) -> PyResult<Vec<Taxel>> {
    let or = |place: &str, given: Option<&Object>, default: f64| match given {
        Some(given) => each(place, given, n),
        None => Ok(vec![default; n]),
    };
    let stroke = each("stroke", stroke, n)?;
    let radius = each("taxel_radius", radius, n)?;
    let stiffness = or("stiffness", stiffness, STIFFNESS)?;
    let damping = or("damping", damping, 0.0)?;
    let taxel = |taxel: usize| Taxel {
        radius: radius[taxel],
        stiffness: stiffness[taxel],
        damping: damping[taxel],
        stroke: stroke[taxel],
    };
    Ok((0..n).map(taxel).collect())
}

/// Returns the region of a mesh that satisfies the given conditions.
pub fn drape_region(
    bounds: Option<&Object>,
    plane: Option<&Object>,
    triangles: Option<Vec<i128>>,
) -> PyResult<DrapeRegion> {
    let two = |place: &str, given: &Object| match points(place, given)?[..] {
        [first, second] => Ok((first, second)),
        ref several => {
            let given = format!("shape ({}, 3)", several.len());
            Err(bad_input(place, given, "(2, 3)"))
        }
    };
    let number = |n| whole_number("triangles", n);
    let numbers = |all: Vec<i128>| all.into_iter().map(number).collect();
    let triangles: Option<Vec<usize>> = triangles.map(numbers).transpose()?;
    let corners = bounds.map(|given| two("bounds", given)).transpose()?;
    Ok(DrapeRegion {
        bounds: corners.map(|(min, max)| Aabb { min, max }),
        beyond: plane.map(|given| two("plane", given)).transpose()?,
        triangles,
    })
}

/// Converts the argument `missing`, which states what happens to taxels that meet no outer face.
pub fn missing_taxels(given: &str) -> PyResult<MissingTaxels> {
    let known = [
        ("error", MissingTaxels::Refuse),
        ("drop", MissingTaxels::Drop),
    ];
    one_of("missing", given, &known)
}
