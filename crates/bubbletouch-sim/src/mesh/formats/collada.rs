//! Meshes from Collada files (`.dae`), version 1.4 or 1.5. Positions, polygons and the tree of nodes are read; materials, normals, texture and animations are
//! ignored. Skins are read in their bind pose.

use super::joined_parts::{
    JoinedParts, affine, check_depth, triangles_of_fan, triangles_of_list, triangles_of_strip,
};
use super::text_lines::all_bytes;
use crate::error::{Error, Result};
use crate::mesh::MeshFile;
use crate::text::encoding::utf8_or_latin1;
use glam::{DAffine3, DMat4, DQuat, DVec3};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::io::BufRead;
use std::str::FromStr;

/// Reads the mesh in a Collada file, in the unit of the file. Also returns the length of this unit in metres (1 if the file does not contain it). All
/// geometries of the scene form one mesh.
///
/// # Errors
/// If the file is not Collada, has no faces, or contains wrong counts, indices that do not exist or numbers that are not finite. The error begins with `place`
/// and the line.
pub fn read_collada(place: &str, source: impl BufRead) -> Result<(MeshFile, f64)> {
    let text = utf8_or_latin1(&all_bytes(place, source)?);
    let text = text.trim_start_matches('\u{feff}');
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let said = error.to_string();
        let given = said
            .rsplit_once(" at ")
            .map_or(said.as_str(), |(given, _)| given);
        let place = format!("{place}, line {}", error.pos().row);
        Error::input(place, given, "Collada: well-formed XML")
    })?;
    let root = document.root_element();
    let nodes = root.descendants();
    let file = Collada {
        place,
        by_id: nodes
            .filter_map(|node| Some((node.attribute("id")?, node)))
            .collect(),
    };
    if tag(root) != "COLLADA" {
        let given = format!("<{}> as the root", tag(root));
        return Err(file.refuse(root, given, "a <COLLADA>"));
    }
    let mut reading = Reading {
        file: &file,
        positions: HashMap::new(),
        parts: JoinedParts::default(),
    };
    match file.visual_scene(root)? {
        Some(scene) => reading.add_node(scene, &DAffine3::IDENTITY, 0)?,
        None => {
            let geometries = root.descendants().filter(|node| is(*node, "geometry"));
            for geometry in geometries {
                reading.add_geometry(geometry, &DAffine3::IDENTITY)?;
            }
        }
    }
    Ok((reading.parts.into_file(place)?, file.unit(root)?))
}

/// Collada file with its elements by their names.
struct Collada<'a> {
    place: &'a str,
    by_id: HashMap<&'a str, Node<'a, 'a>>,
}

impl<'a> Collada<'a> {
    /// Returns the location of an element, with its line.
    fn place_of(&self, node: Node) -> String {
        let line = node.document().text_pos_at(node.range().start).row;
        format!("{}, line {line}", self.place)
    }

    fn refuse(&self, node: Node, given: impl ToString, allowed: impl ToString) -> Error {
        Error::input(self.place_of(node), given, allowed)
    }

    /// Returns a part of an element, or an error if the element is without it.
    fn required<T>(&self, node: Node, part: Option<T>, what: &str) -> Result<T> {
        part.ok_or_else(|| {
            let given = format!("<{}> without {what}", tag(node));
            self.refuse(node, given, "one")
        })
    }

    /// Returns the length of the file's unit, metres.
    fn unit(&self, root: Node) -> Result<f64> {
        let unit = child(root, "asset").and_then(|asset| child(asset, "unit"));
        let text = unit.and_then(|unit| unit.attribute("meter"));
        let (Some(unit), Some(text)) = (unit, text) else {
            return Ok(1.0);
        };
        let metres = f64::from_str(text.trim()).ok();
        let metres = metres.filter(|metres| *metres > 0.0 && metres.is_finite());
        metres.ok_or_else(|| {
            let given = format!("`meter` \"{text}\"");
            self.refuse(unit, given, "a positive number of metres")
        })
    }

    /// Returns the visual scene that the file shows; its first one if the file does not name one.
    fn visual_scene(&self, root: Node<'a, 'a>) -> Result<Option<Node<'a, 'a>>> {
        let shown = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
        match shown {
            Some(shown) => self.target(shown, "url").map(Some),
            None => Ok(root.descendants().find(|node| is(*node, "visual_scene"))),
        }
    }

    /// Returns the element that an attribute refers to. An id is searched in the mesh around the element first, because some files repeat ids in each mesh.
    fn target(&self, node: Node<'a, 'a>, attribute: &str) -> Result<Node<'a, 'a>> {
        let address = node.attribute(attribute).unwrap_or_default();
        let found = address.strip_prefix('#').and_then(|id| {
            let mesh = node.ancestors().find(|node| is(*node, "mesh"));
            let mut near = mesh.into_iter().flat_map(|mesh| mesh.descendants());
            let near = near.find(|node| node.attribute("id") == Some(id));
            near.or(self.by_id.get(id).copied())
        });
        found.ok_or_else(|| {
            let given = format!("<{}> with `{attribute}` \"{address}\"", tag(node));
            self.refuse(node, given, "# and the id of an element of the file")
        })
    }

    /// Returns the words of an element's text as numbers.
    ///
    /// # Errors
    /// If `parse` returns `None` for a word; the error contains its place in the text.
    fn words<T>(
        &self,
        node: Node,
        parse: impl Fn(&str) -> Option<T>,
        allowed: &str,
    ) -> Result<Vec<T>> {
        let text = node.text().unwrap_or_default();
        let words = text.split_ascii_whitespace().enumerate();
        let numbers = words.map(|(index, word)| {
            parse(word).ok_or_else(|| {
                let given = format!("<{}>, number {}: \"{word}\"", tag(node), index + 1);
                self.refuse(node, given, allowed)
            })
        });
        numbers.collect()
    }

    fn numbers(&self, node: Node) -> Result<Vec<f64>> {
        let finite = |word: &str| f64::from_str(word).ok().filter(|number| number.is_finite());
        self.words(node, finite, "finite numbers")
    }

    fn indices(&self, node: Node) -> Result<Vec<u32>> {
        self.words(
            node,
            |word| u32::from_str(word).ok(),
            "whole numbers from 0",
        )
    }

    /// Returns the N numbers in an element's text.
    fn exactly<const N: usize>(&self, node: Node) -> Result<[f64; N]> {
        let numbers = self.numbers(node)?;
        let n = numbers.len();
        <[f64; N]>::try_from(numbers).map_err(|_| {
            let given = format!("<{}> with {n} numbers", tag(node));
            self.refuse(node, given, format!("{N} numbers"))
        })
    }

    /// Returns an attribute that contains a count, or `default` if it is missing.
    fn count(&self, node: Node, attribute: &str, default: Option<usize>) -> Result<usize> {
        let text = node.attribute(attribute);
        let given = text.and_then(|text| usize::from_str(text.trim()).ok());
        match (given, text, default) {
            (Some(count), _, _) | (None, None, Some(count)) => Ok(count),
            _ => {
                let text = text.unwrap_or("nothing");
                let given = format!("<{}> with `{attribute}` {text}", tag(node));
                Err(self.refuse(node, given, "a whole number from 0"))
            }
        }
    }

    /// Returns an error if an element's `count` differs from the number of its parts.
    fn check_count(&self, node: Node, n: usize, what: &str) -> Result<()> {
        let count = self.count(node, "count", Some(n))?;
        if count == n {
            return Ok(());
        }
        let given = format!("<{}> with `count` {count}, but {n} {what}", tag(node));
        Err(self.refuse(node, given, "the same number, or no `count`"))
    }

    /// Returns the points of a `<source>`.
    fn points(&self, source: Node<'a, 'a>) -> Result<Vec<DVec3>> {
        let accessor =
            child(source, "technique_common").and_then(|common| child(common, "accessor"));
        let accessor = self.required(source, accessor, "<accessor>")?;
        let array = self.target(accessor, "source")?;
        let numbers = self.numbers(array)?;
        self.check_count(array, numbers.len(), "numbers")?;
        let count = self.count(accessor, "count", None)?;
        let stride = self.count(accessor, "stride", Some(1))?;
        let offset = self.count(accessor, "offset", Some(0))?;
        let last = count.checked_mul(stride);
        let last = last.and_then(|n| n.checked_add(offset));
        if stride < 3 || last.is_none_or(|last| last > numbers.len()) {
            let given = format!(
                "{count} points with `stride` {stride}, but {} numbers",
                numbers.len()
            );
            return Err(self.refuse(accessor, given, "three or more numbers for each point"));
        }
        // A parameter without a name is skipped.
        let parameters = children(accessor, "param").enumerate().take(stride);
        let named = parameters.filter(|(_, parameter)| parameter.has_attribute("name"));
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
    fn polygons(&self, primitive: Node<'a, 'a>) -> Result<Option<(Vec<Vec<u32>>, Node<'a, 'a>)>> {
        let kind = tag(primitive);
        if !["triangles", "polylist", "polygons", "trifans", "tristrips"].contains(&kind) {
            return Ok(None);
        }
        let (mut stride, mut vertex) = (1, None);
        for input in children(primitive, "input") {
            let offset = self.count(input, "offset", Some(0))?;
            if offset > 100 {
                return Err(self.refuse(input, format!("`offset` {offset}"), "at most 100"));
            }
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = Some((offset, self.target(input, "source")?));
            }
        }
        let what = "an <input semantic=\"VERTEX\">";
        let (offset, vertices) = self.required(primitive, vertex, what)?;
        let position = children(vertices, "input")
            .find(|input| input.attribute("semantic") == Some("POSITION"));
        let position = self.required(vertices, position, "an <input semantic=\"POSITION\">")?;
        let source = self.target(position, "source")?;
        if let Some(hole) = child(primitive, "ph") {
            let allowed = "polygons without holes, or triangles";
            return Err(self.refuse(hole, "a polygon with holes", allowed));
        }
        let mut lists = Vec::new();
        for list in children(primitive, "p") {
            let indices = self.indices(list)?;
            if indices.len() % stride != 0 {
                let given = format!("{} indices for {stride} inputs", indices.len());
                return Err(self.refuse(list, given, "as many for each corner as inputs"));
            }
            let corners = indices.chunks_exact(stride).map(|corner| corner[offset]);
            lists.push(corners.collect::<Vec<u32>>());
        }
        let polygons = match kind {
            "triangles" => triangles_of_list(&self.place_of(primitive), &lists.concat())?,
            "polylist" => self.listed(primitive, &lists.concat())?,
            "polygons" => lists,
            // The count of fans and strips is not the number of their triangles.
            "trifans" => return Ok(Some((concat(&lists, triangles_of_fan), source))),
            _ => return Ok(Some((concat(&lists, triangles_of_strip), source))),
        };
        self.check_count(primitive, polygons.len(), "faces")?;
        Ok(Some((polygons, source)))
    }

    /// Returns the polygons of a `<polylist>`, whose `<vcount>` contains their numbers of corners.
    fn listed(&self, primitive: Node, corners: &[u32]) -> Result<Vec<Vec<u32>>> {
        let counts = child(primitive, "vcount").map(|counts| self.indices(counts));
        let counts = counts.transpose()?.unwrap_or_default();
        let n: usize = counts.iter().map(|count| *count as usize).sum();
        if n != corners.len() {
            let given = format!("<vcount> of {n} corners, but <p> with {}", corners.len());
            return Err(self.refuse(primitive, given, "the same number"));
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
    fn transform(&self, node: Node) -> Result<DAffine3> {
        let mut all = DAffine3::IDENTITY;
        for element in node.children().filter(Node::is_element) {
            all *= match tag(element) {
                "matrix" | "bind_shape_matrix" => self.matrix(element)?,
                "translate" => DAffine3::from_translation(DVec3::from(self.exactly(element)?)),
                "scale" => DAffine3::from_scale(DVec3::from(self.exactly(element)?)),
                "rotate" => {
                    let [x, y, z, degrees] = self.exactly(element)?;
                    let axis = DVec3::new(x, y, z).try_normalize().ok_or_else(|| {
                        let given = "<rotate> about an axis of length zero";
                        self.refuse(element, given, "a direction")
                    })?;
                    DAffine3::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()))
                }
                tag @ ("skew" | "lookat") => {
                    let allowed = "<matrix>, <translate>, <rotate> or <scale>";
                    return Err(self.refuse(element, format!("<{tag}>"), allowed));
                }
                _ => continue,
            };
        }
        Ok(all)
    }

    /// Returns the affine map of sixteen numbers, row by row.
    fn matrix(&self, element: Node) -> Result<DAffine3> {
        let rows = DMat4::from_cols_array(&self.exactly(element)?);
        affine(&rows.transpose()).ok_or_else(|| {
            let given = format!("a matrix with the last row {}", rows.w_axis);
            self.refuse(element, given, "0 0 0 1")
        })
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
    fn add_node(&mut self, node: Node<'a, 'a>, above: &DAffine3, depth: usize) -> Result<()> {
        let file = self.file;
        check_depth(&file.place_of(node), depth)?;
        let transform = *above * file.transform(node)?;
        for element in node.children().filter(Node::is_element) {
            match tag(element) {
                "node" => self.add_node(element, &transform, depth + 1)?,
                "instance_node" => {
                    self.add_node(file.target(element, "url")?, &transform, depth + 1)?;
                }
                "instance_geometry" => {
                    self.add_geometry(file.target(element, "url")?, &transform)?
                }
                "instance_controller" => {
                    let controller = file.target(element, "url")?;
                    let part = child(controller, "skin").or_else(|| child(controller, "morph"));
                    let part = file.required(controller, part, "<skin>")?;
                    let bound = transform * file.transform(part)?;
                    self.add_geometry(file.target(part, "source")?, &bound)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn add_geometry(&mut self, geometry: Node<'a, 'a>, transform: &DAffine3) -> Result<()> {
        let file = self.file;
        let Some(mesh) = child(geometry, "mesh") else {
            return Ok(());
        };
        for primitive in mesh.children().filter(Node::is_element) {
            let Some((polygons, source)) = file.polygons(primitive)? else {
                continue;
            };
            let key = source.range().start;
            let positions = match self.positions.entry(key) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => place.insert(file.points(source)?),
            };
            let place = file.place_of(primitive);
            self.parts.add(&place, transform, positions, polygons)?;
        }
        Ok(())
    }
}

/// Returns the triangles of all lists.
fn concat(lists: &[Vec<u32>], triangles: fn(&[u32]) -> Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    lists.iter().flat_map(|list| triangles(list)).collect()
}

fn tag<'a>(node: Node<'a, '_>) -> &'a str {
    node.tag_name().name()
}

fn is(node: Node, name: &str) -> bool {
    node.is_element() && tag(node) == name
}

fn children<'a>(node: Node<'a, 'a>, name: &str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |node| is(*node, name))
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    children(node, name).next()
}
