//! Taxel positions of PaXini's tactile sensors as JSON, mm: `{"units": "mm", "taxels_mm": [[x, y, z], …]}`, or a list of positions. The files have no normals.

use super::LayoutFile;
use super::normals::surface_normals;
use crate::error::{Error, Result};
use crate::mesh::TriangleMesh;
use glam::DVec3;
use serde_json::Value;

const ALLOWED: &str = "points [x, y, z] in mm: a list, or the member taxels_mm, taxels or points";
const MM: f64 = 1e-3;

/// Reads a layout of taxels from the text of a PaXini JSON file. The normals are computed from the mesh.
pub(super) fn read(place: &str, text: &str, mesh: Option<&TriangleMesh>) -> Result<LayoutFile> {
    let json: Value = serde_json::from_str(text).map_err(|e| Error::input(place, e, ALLOWED))?;
    if let Some(units) = json.get("units").or_else(|| json.get("unit"))
        && units != "mm"
    {
        return Err(Error::input(place, format!("units {units}"), "\"mm\""));
    }
    let members = ["taxels_mm", "taxels", "points"];
    let points = members.iter().find_map(|name| json.get(name));
    let points = points.unwrap_or(&json).as_array();
    let points = points.ok_or_else(|| Error::input(place, "no list of points", ALLOWED))?;
    let point = |(row, point): (usize, &Value)| {
        let numbers = point.as_array().map(|numbers| {
            let numbers = numbers.iter().map(Value::as_f64);
            numbers.collect::<Option<Vec<f64>>>()
        });
        match numbers.flatten().as_deref() {
            Some(&[x, y, z]) => Ok(DVec3::new(x, y, z) * MM),
            _ => {
                let place = format!("{place}, row {}", row + 1);
                Err(Error::input(
                    place,
                    format!("`{point}`"),
                    "three numbers: x, y, z",
                ))
            }
        }
    };
    let points = points.iter().enumerate().map(point);
    let points = points.collect::<Result<Vec<_>>>()?;
    let Some(mesh) = mesh else {
        let allowed = "a mesh beside it, whose surface gives the normals";
        return Err(Error::input(place, "points without normals", allowed));
    };
    let normals = surface_normals(place, &points, mesh)?;
    LayoutFile::in_order(place, points.into_iter().zip(normals).collect())
}
