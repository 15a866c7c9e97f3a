//! Groups of Wavefront OBJ files.

use super::text_lines::each_line;
use crate::error::{Error, Result};
use crate::text::spelling::nearest_names;
use std::collections::BTreeMap;
use std::io::BufRead;

/// Returns the indices of the triangles of a group (`g`) or object (`o`) in an OBJ file. The indices refer to the mesh that `read_obj` and
/// `into_mesh` create. A face belongs to the most recent groups and the most recent object before it.
///
/// # Errors
/// If the file cannot be read, or has no face in a group or object with this name.
pub fn obj_group(place: &str, source: impl BufRead, name: &str) -> Result<Vec<usize>> {
    let mut names: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    let (mut groups, mut object): (Vec<String>, Option<String>) = (Vec::new(), None);
    let mut n_triangles = 0;
    each_line(place, source, |_, line| {
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_whitespace();
        match words.next() {
            Some("g") => groups = words.map(str::to_owned).collect(),
            // A name may contain spaces.
            Some("o") => object = Some(words.collect::<Vec<_>>().join(" ")),
            Some("f") => {
                let n = words.count().saturating_sub(2);
                for name in groups.iter().chain(&object) {
                    let triangles = names.entry(name.clone()).or_default();
                    triangles.extend(n_triangles..n_triangles + n);
                }
                n_triangles += n;
            }
            _ => {}
        }
        Ok(())
    })?;
    if let Some(mut triangles) = names.remove(name) {
        triangles.dedup();
        return Ok(triangles);
    }
    let allowed = match names.is_empty() {
        true => "a name after `g` or `o`, of which the file has none".to_owned(),
        false => nearest_names(name, names.keys().map(String::as_str)),
    };
    Err(Error::input(place, format!("group `{name}`"), allowed))
}
