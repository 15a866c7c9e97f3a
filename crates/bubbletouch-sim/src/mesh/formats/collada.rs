//! Meshes from Collada files (`.dae`), version 1.4 or 1.5. Positions, polygons and the tree of nodes are read; materials, normals, texture and animations are
//! ignored. Skins are read in their bind pose.

use super::joined_parts::{
    JoinedParts, affine, triangles_of_fan, triangles_of_list, triangles_of_strip,
};
use super::text_lines::all_bytes;
use crate::error::Result;
use crate::mesh::MeshFile;
use crate::text::encoding::decoded;
use crate::text::numbers::finite_number;
use crate::text::xml::{Element, Format, Lines, POSITIVE, document};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::io::BufRead;

const COLLADA: Format = Format {
    name: "Collada",
    root: "COLLADA",
};
/// Largest count of an attribute: the largest number of vertices that an index can count.
const MAX_COUNT: usize = u32::MAX as usize;
/// Largest number of indices for each corner of a polygon. A larger number indicates a mistake in the file.
const MAX_INPUTS: usize = 100;

/// Reads the mesh in a Collada file, in the unit of the file. Also returns the length of this unit in metres (1 if the file does not contain it). All
/// geometries of the scene form one mesh.
///
/// # Errors
/// If the file is not Collada, has no faces, or contains wrong counts, indices that do not exist or numbers that are not finite. The error begins with `place`
/// and the line.
pub fn read_collada(place: &str, source: impl BufRead) -> Result<(MeshFile, f64)> {
    let (text, _) = decoded(place, &all_bytes(place, source)?);
    let text = text.trim_start_matches('\u{feff}');
    let document = document(COLLADA, place, text)?;
    let lines = Lines::new(place, text);
    let root = Element::root(&document, &lines);
    if root.tag() != COLLADA.root {
        let given = format!("{} as the root", root.called());
        return Err(root.refuse(given, "a <COLLADA>"));
    }
    let elements = root.descendants();
    let file = Collada {
        by_id: elements
            .filter_map(|element| Some((element.attribute("id")?, element)))
            .collect(),
    };
    let mut reading = Reading {
        file: &file,
        positions: HashMap::new(),
        parts: JoinedParts::default(),
    };
    match file.visual_scene(root)? {
        Some(scene) => reading.add_node(scene, &DAffine3::IDENTITY, 0)?,
        None => {
            let geometries = root.descendants().filter(|it| it.tag() == "geometry");
            for geometry in geometries {
                reading.add_geometry(geometry, &DAffine3::IDENTITY)?;
            }
        }
    }
    Ok((reading.parts.into_file(place)?, unit(root)?))
}

/// Elements of a Collada file by their names.
struct Collada<'a> {
    by_id: HashMap<&'a str, Element<'a>>,
}

impl<'a> Collada<'a> {
    /// Returns the visual scene that the file shows; its first one if the file does not name one.
    fn visual_scene(&self, root: Element<'a>) -> Result<Option<Element<'a>>> {
        let shown = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
        match shown {
            Some(shown) => self.target(shown, "url").map(Some),
            None => Ok(root.descendants().find(|it| it.tag() == "visual_scene")),
        }
    }

    /// Returns the element that an attribute refers to. An id is searched in the mesh around the element first, because some files repeat ids in each mesh.
    fn target(&self, element: Element<'a>, attribute: &str) -> Result<Element<'a>> {
        let address = element.attribute(attribute).unwrap_or_default();
        let found = address.strip_prefix('#').and_then(|id| {
            let mesh = element.around().find(|around| around.tag() == "mesh");
            let mut near = mesh.into_iter().flat_map(Element::descendants);
            let near = near.find(|near| near.attribute("id") == Some(id));
            near.or(self.by_id.get(id).copied())
        });
        found.ok_or_else(|| {
            let given = format!("<{}> with `{attribute}` \"{address}\"", element.tag());
            element.refuse(given, "# and the id of an element of the file")
        })
    }

    /// Returns the points of a `<source>`.
    fn points(&self, source: Element<'a>) -> Result<Vec<DVec3>> {
        let accessor =
            child(source, "technique_common").and_then(|common| child(common, "accessor"));
        let accessor = required(source, accessor, "<accessor>")?;
        let array = self.target(accessor, "source")?;
        let numbers = numbers(array)?;
        check_count(array, numbers.len(), "numbers")?;
        let count = accessor.needed_integer("count", 0, MAX_COUNT)?;
        let stride = accessor.integer("stride", 0, MAX_COUNT)?.unwrap_or(1);
        let offset = accessor.integer("offset", 0, MAX_COUNT)?.unwrap_or(0);
        let last = count.checked_mul(stride);
        let last = last.and_then(|n| n.checked_add(offset));
        if stride < 3 || last.is_none_or(|last| last > numbers.len()) {
            let given = format!(
                "{count} points with `stride` {stride}, but {} numbers",
                numbers.len()
            );
            return Err(accessor.refuse(given, "three or more numbers for each point"));
        }
        // A parameter without a name is skipped.
        let parameters = accessor.children("param").enumerate().take(stride);
        let named = parameters.filter(|(_, parameter)| parameter.attribute("name").is_some());
        let mut places: Vec<usize> = named.map(|(index, _)| index).collect();
        if places.len() < 3 {
            places = vec![0, 1, 2];
        }
        let points = numbers[offset..].chunks_exact(stride).take(count);
        Ok(points
            .map(|point| DVec3::new(point[places[0]], point[places[1]], point[places[2]]))
            .collect())
    }

    /// Returns the polygons of `<triangles>`, `<polylist>` and similar elements, and the source of their positions; `None` for other elements, such as lines.
    fn polygons(&self, primitive: Element<'a>) -> Result<Option<(Vec<Vec<u32>>, Element<'a>)>> {
        let kind = primitive.tag();
        if !["triangles", "polylist", "polygons", "trifans", "tristrips"].contains(&kind) {
            return Ok(None);
        }
        let (mut stride, mut vertex) = (1, None);
        for input in primitive.children("input") {
            let offset = input.integer("offset", 0, MAX_INPUTS)?.unwrap_or(0);
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = Some((offset, self.target(input, "source")?));
            }
        }
        let what = "an <input semantic=\"VERTEX\">";
        let (offset, vertices) = required(primitive, vertex, what)?;
        let mut inputs = vertices.children("input");
        let position = inputs.find(|input| input.attribute("semantic") == Some("POSITION"));
        let position = required(vertices, position, "an <input semantic=\"POSITION\">")?;
        let source = self.target(position, "source")?;
        if let Some(hole) = child(primitive, "ph") {
            let allowed = "polygons without holes, or triangles";
            return Err(hole.refuse("a polygon with holes", allowed));
        }
        let mut lists = Vec::new();
        for list in primitive.children("p") {
            let indices = indices(list)?;
            if indices.len() % stride != 0 {
                let given = format!("{} indices for {stride} inputs", indices.len());
                return Err(list.refuse(given, "as many for each corner as inputs"));
            }
            let corners = indices.chunks_exact(stride).map(|corner| corner[offset]);
            lists.push(corners.collect::<Vec<u32>>());
        }
        let polygons = match kind {
            "triangles" => triangles_of_list(&primitive.place(), &lists.concat())?,
            "polylist" => listed(primitive, &lists.concat())?,
            "polygons" => lists,
            // The count of fans and strips is not the number of their triangles.
            "trifans" => return Ok(Some((concat(&lists, triangles_of_fan), source))),
            _ => return Ok(Some((concat(&lists, triangles_of_strip), source))),
        };
        check_count(primitive, polygons.len(), "faces")?;
        Ok(Some((polygons, source)))
    }
}

/// Geometries that have been read so far.
struct Reading<'a, 'f> {
    file: &'f Collada<'a>,
    /// Points of each `<source>`, by the position of the element in the file.
    positions: HashMap<usize, Vec<DVec3>>,
    parts: JoinedParts,
}

impl<'a> Reading<'a, '_> {
    /// Adds the geometries of a node and of the nodes in it.
    fn add_node(&mut self, node: Element<'a>, above: &DAffine3, depth: usize) -> Result<()> {
        let file = self.file;
        self.parts.enter_node(&node.place(), depth)?;
        let inner = *above * transform(node)?;
        for element in node.elements() {
            match element.tag() {
                "node" => self.add_node(element, &inner, depth + 1)?,
                "instance_node" => {
                    self.add_node(file.target(element, "url")?, &inner, depth + 1)?;
                }
                "instance_geometry" => self.add_geometry(file.target(element, "url")?, &inner)?,
                "instance_controller" => {
                    let controller = file.target(element, "url")?;
                    let part = child(controller, "skin").or_else(|| child(controller, "morph"));
                    let part = required(controller, part, "<skin>")?;
                    let bound = inner * transform(part)?;
                    self.add_geometry(file.target(part, "source")?, &bound)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn add_geometry(&mut self, geometry: Element<'a>, transform: &DAffine3) -> Result<()> {
        let file = self.file;
        let Some(mesh) = child(geometry, "mesh") else {
            return Ok(());
        };
        for primitive in mesh.elements() {
            let Some((polygons, source)) = file.polygons(primitive)? else {
                continue;
            };
            let key = source.range().start;
            let positions = match self.positions.entry(key) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => place.insert(file.points(source)?),
            };
            self.parts
                .add(&primitive.place(), transform, positions, polygons)?;
        }
        Ok(())
    }
}

/// Returns the length of the file's unit, metres; 1 if the file does not contain it.
fn unit(root: Element) -> Result<f64> {
    let unit = child(root, "asset").and_then(|asset| child(asset, "unit"));
    let metres = unit.map(|unit| unit.numbers_in("meter", &POSITIVE));
    Ok(metres.transpose()?.flatten().map_or(1.0, |[metres]| metres))
}

/// Returns the polygons of a `<polylist>`, whose `<vcount>` contains their numbers of corners.
fn listed(primitive: Element, corners: &[u32]) -> Result<Vec<Vec<u32>>> {
    let counts = child(primitive, "vcount").map(indices);
    let counts = counts.transpose()?.unwrap_or_default();
    let n: usize = counts.iter().map(|count| *count as usize).sum();
    if n != corners.len() {
        let given = format!("<vcount> of {n} corners, but <p> with {}", corners.len());
        return Err(primitive.refuse(given, "the same number"));
    }
    let mut rest = corners;
    let polygons = counts.iter().map(|&count| {
        let (polygon, after) = rest.split_at(count as usize);
        rest = after;
        polygon.to_vec()
    });
    Ok(polygons.collect())
}

/// Returns the product of the transforms of a node, in their order.
fn transform(node: Element) -> Result<DAffine3> {
    let mut all = DAffine3::IDENTITY;
    for element in node.elements() {
        all *= match element.tag() {
            "matrix" | "bind_shape_matrix" => matrix(element)?,
            "translate" => DAffine3::from_translation(DVec3::from(exactly(element)?)),
            "scale" => DAffine3::from_scale(DVec3::from(exactly(element)?)),
            "rotate" => {
                let [x, y, z, degrees] = exactly(element)?;
                let axis = DVec3::new(x, y, z).try_normalize().ok_or_else(|| {
                    let given = "<rotate> about an axis of length zero";
                    element.refuse(given, "a direction")
                })?;
                DAffine3::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()))
            }
            tag @ ("skew" | "lookat") => {
                let allowed = "<matrix>, <translate>, <rotate> or <scale>";
                return Err(element.refuse(format!("<{tag}>"), allowed));
            }
            _ => continue,
        };
    }
    Ok(all)
}

/// Returns the affine map of sixteen numbers, row by row.
fn matrix(element: Element) -> Result<DAffine3> {
    let rows = DMat4::from_cols_array(&exactly(element)?);
    affine(&rows.transpose()).ok_or_else(|| {
        let given = format!("a matrix with the last row {}", rows.w_axis);
        element.refuse(given, "0 0 0 1")
    })
}

/// Returns the words of an element's text as numbers.
///
/// # Errors
/// If `parse` returns `None` for a word; the error contains its place in the text.
fn words<T>(element: Element, parse: impl Fn(&str) -> Option<T>, allowed: &str) -> Result<Vec<T>> {
    // Comments divide a text.
    let texts = element.node.children().filter(|part| part.is_text());
    let texts = texts.filter_map(|part| part.text());
    let words = texts.flat_map(str::split_ascii_whitespace).enumerate();
    let numbers = words.map(|(index, word)| {
        parse(word).ok_or_else(|| {
            let given = format!("<{}>, number {}: \"{word}\"", element.tag(), index + 1);
            element.refuse(given, allowed)
        })
    });
    numbers.collect()
}

fn numbers(element: Element) -> Result<Vec<f64>> {
    words(element, finite_number, "finite numbers")
}

fn indices(element: Element) -> Result<Vec<u32>> {
    let index = |word: &str| word.parse().ok();
    words(element, index, "whole numbers from 0")
}

/// Returns the N numbers in an element's text.
fn exactly<const N: usize>(element: Element) -> Result<[f64; N]> {
    let numbers = numbers(element)?;
    let n = numbers.len();
    <[f64; N]>::try_from(numbers).map_err(|_| {
        let given = format!("<{}> with {n} numbers", element.tag());
        element.refuse(given, format!("{N} numbers"))
    })
}

/// Returns an error if an element's `count` differs from the number of its parts.
fn check_count(element: Element, n: usize, what: &str) -> Result<()> {
    let count = element.integer("count", 0, MAX_COUNT)?.unwrap_or(n);
    if count == n {
        return Ok(());
    }
    let given = format!("<{}> with `count` {count}, but {n} {what}", element.tag());
    Err(element.refuse(given, "the same number, or no `count`"))
}

/// Returns a part of an element, or an error if the element is without it.
fn required<T>(element: Element, part: Option<T>, what: &str) -> Result<T> {
    part.ok_or_else(|| element.refuse(format!("<{}> without {what}", element.tag()), "one"))
}

/// Returns the first child element with this tag.
fn child<'a>(element: Element<'a>, tag: &'a str) -> Option<Element<'a>> {
    element.children(tag).next()
}

/// Returns the triangles of all lists.
fn concat(lists: &[Vec<u32>], triangles: fn(&[u32]) -> Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    lists.iter().flat_map(|list| triangles(list)).collect()
}
