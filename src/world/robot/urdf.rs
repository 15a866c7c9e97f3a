//! URDF \[URDF\]: the text of a robot → its links and joints, each error with its line.
//!
//! Read is what moves links and what skin can lie on; inertia, colours, transmissions and other tools' elements are passed
//! over.

use super::link::read_link;
use super::mimic::drives;
use super::tree::Tree;
use super::xml::{Element, Lines};
use super::{Joint, JointKind, Limits, Link, Mimic, Robot};
use crate::error::{Error, Result};
use crate::spelling::nearest_names;
use glam::DVec3;
use roxmltree::{Document, Node};
use std::collections::HashMap;

/// Part of the address of the namespace of xacro's elements, in all its versions.
const XACRO: &str = "xacro";

/// A robot from the text of a URDF file; errors begin with `place`, the file's name.
pub(super) fn read_urdf(place: &str, text: &str) -> Result<Robot> {
    let lines = Lines::new(place, text);
    let document = Document::parse(text).map_err(|e| unreadable(place, text, &e))?;
    check_expanded(&document, &lines)?;
    let root = Element {
        node: document.root_element(),
        lines: &lines,
    };
    if root.node.tag_name().name() != "robot" {
        return Err(root.refuse(format!("{} as the root", root.called()), "URDF: a <robot>"));
    }
    root.check_tags(&["link", "joint", "material", "transmission", "gazebo"])?;
    let elements: Vec<Element> = root.children("link").collect();
    let links = elements.iter().map(read_link).collect::<Result<Vec<_>>>()?;
    if links.is_empty() {
        return Err(root.refuse("a robot without a <link>", "at least one"));
    }
    let names = links.iter().map(|link| link.name.as_str());
    let link_of = index_of_each("link", names, &elements)?;
    let (joints, elements) = read_joints(root, &links, &link_of)?;
    let tree = Tree::of(&links, &joints, root, &elements)?;
    let drives = drives(&joints, &elements)?;
    Robot::assembled(root.name()?.to_owned(), place, links, joints, tree, drives)
}

/// The joints with their elements, in the order of the file.
fn read_joints<'a>(
    root: Element<'a>,
    links: &[Link],
    link_of: &HashMap<&str, usize>,
) -> Result<(Vec<Joint>, Vec<Element<'a>>)> {
    let elements: Vec<Element> = root.children("joint").collect();
    let names = elements.iter().map(Element::name);
    let names = names.collect::<Result<Vec<_>>>()?;
    let joint_of = index_of_each("joint", names.iter().copied(), &elements)?;
    let ends = Ends { links, link_of };
    let joints = elements.iter().zip(names);
    let joints = joints.map(|(element, name)| read_joint(*element, name, &ends, &joint_of));
    Ok((joints.collect::<Result<_>>()?, elements))
}

fn read_joint(
    element: Element,
    name: &str,
    ends: &Ends,
    joint_of: &HashMap<&str, usize>,
) -> Result<Joint> {
    element.check_tags(&[
        "origin",
        "parent",
        "child",
        "axis",
        "limit",
        "mimic",
        "dynamics",
        "calibration",
        "safety_controller",
    ])?;
    let kind = read_kind(&element, name)?;
    Ok(Joint {
        name: name.to_owned(),
        kind,
        parent: ends.read(element, name, "parent")?,
        child: ends.read(element, name, "child")?,
        origin: element.origin()?,
        axis: read_axis(element, name)?,
        limits: read_limits(element, name, kind)?,
        mimic: read_mimic(element, name, kind, joint_of)?,
    })
}

/// The links that a joint can join.
struct Ends<'a> {
    links: &'a [Link],
    link_of: &'a HashMap<&'a str, usize>,
}

impl Ends<'_> {
    /// Index of the link that `<parent>` or `<child>` names.
    fn read(&self, joint: Element, name: &str, tag: &'static str) -> Result<usize> {
        let end = joint.needed_child(tag)?;
        let wanted = end.text("link")?;
        self.link_of.get(wanted).copied().ok_or_else(|| {
            let known = self.links.iter().map(|link| link.name.as_str());
            end.refuse(
                format!("joint `{name}` with {tag} `{wanted}`, which is no link"),
                nearest_names(wanted, known),
            )
        })
    }
}

fn read_kind(element: &Element, joint: &str) -> Result<JointKind> {
    let word = element.text("type")?;
    let found = JointKind::ALL.iter().find(|(known, _)| *known == word);
    found.map(|&(_, kind)| kind).ok_or_else(|| {
        element.refuse(
            format!("joint `{joint}` of type `{word}`"),
            nearest_names(word, JointKind::ALL.map(|(known, _)| known)),
        )
    })
}

/// The unit axis; along x where none is written.
fn read_axis(element: Element, joint: &str) -> Result<DVec3> {
    let Some(axis) = element.child("axis")? else {
        return Ok(DVec3::X);
    };
    axis.check_attributes(&["xyz"])?;
    let xyz = DVec3::from(axis.numbers("xyz")?.unwrap_or([1.0, 0.0, 0.0]));
    // Divided first, so that the square of no length is too large or too small.
    let largest = xyz.abs().max_element();
    (xyz / largest).try_normalize().ok_or_else(|| {
        let given = format!("joint `{joint}` with an axis of length zero");
        axis.refuse(given, "a direction")
    })
}

fn read_limits(element: Element, joint: &str, kind: JointKind) -> Result<Option<Limits>> {
    if !kind.has_one_coordinate() {
        return Ok(None);
    }
    let has_ends = kind != JointKind::Continuous;
    let Some(limit) = element.child("limit")? else {
        if has_ends {
            let given = format!("joint `{joint}` without <limit>");
            return Err(element.refuse(given, "lower, upper, velocity and effort"));
        }
        return Ok(None);
    };
    limit.check_attributes(&[
        "lower",
        "upper",
        "velocity",
        "effort",
        "acceleration",
        "deceleration",
        "jerk",
    ])?;
    let (lower, upper) = match (limit.number("lower")?, limit.number("upper")?) {
        _ if !has_ends => (f64::NEG_INFINITY, f64::INFINITY),
        (None, None) => {
            let given = format!("joint `{joint}` with a <limit> without `lower` and `upper`");
            return Err(limit.refuse(given, "at least one of them; the other is 0"));
        }
        (lower, upper) => (lower.unwrap_or(0.0), upper.unwrap_or(0.0)),
    };
    if lower > upper {
        let given = format!("joint `{joint}` with lower limit {lower} above upper limit {upper}");
        return Err(limit.refuse(given, "lower ≤ upper"));
    }
    let not_negative = |attribute: &str| {
        let [value] = limit.needed_numbers(attribute)?;
        if value >= 0.0 {
            return Ok(value);
        }
        let given = format!("joint `{joint}` with `{attribute}` {value}");
        Err(limit.refuse(given, "zero or a positive number"))
    };
    Ok(Some(Limits {
        lower,
        upper,
        velocity: not_negative("velocity")?,
        effort: not_negative("effort")?,
    }))
}

fn read_mimic(
    element: Element,
    joint: &str,
    kind: JointKind,
    joint_of: &HashMap<&str, usize>,
) -> Result<Option<Mimic>> {
    let Some(mimic) = element.child("mimic")? else {
        return Ok(None);
    };
    mimic.check_attributes(&["joint", "multiplier", "offset"])?;
    if !kind.has_one_coordinate() {
        let given = format!("<mimic> in the {kind:?} joint `{joint}`").to_lowercase();
        return Err(mimic.refuse(given, "a revolute, continuous or prismatic joint"));
    }
    let followed = mimic.text("joint")?;
    let Some(&index) = joint_of.get(followed) else {
        return Err(mimic.refuse(
            format!("joint `{joint}` mimics `{followed}`, which is no joint"),
            nearest_names(followed, in_order(joint_of)),
        ));
    };
    Ok(Some(Mimic {
        joint: index,
        multiplier: mimic.number("multiplier")?.unwrap_or(1.0),
        offset: mimic.number("offset")?.unwrap_or(0.0),
    }))
}

/// The names by their index: the order of a map is another in each run.
fn in_order<'n>(index_of: &HashMap<&'n str, usize>) -> Vec<&'n str> {
    let mut names: Vec<(usize, &str)> = index_of
        .iter()
        .map(|(name, index)| (*index, *name))
        .collect();
    names.sort_unstable();
    names.into_iter().map(|(_, name)| name).collect()
}

/// Name → index; the error shows the second of two.
fn index_of_each<'n>(
    what: &str,
    names: impl Iterator<Item = &'n str>,
    elements: &[Element],
) -> Result<HashMap<&'n str, usize>> {
    let mut index_of: HashMap<&str, usize> = HashMap::new();
    for (index, name) in names.enumerate() {
        if let Some(first) = index_of.insert(name, index) {
            let first = elements[first].line();
            return Err(elements[index].refuse(
                format!("a second {what} `{name}` (the first is on line {first})"),
                "a name of its own",
            ));
        }
    }
    Ok(index_of)
}

/// Refuses a xacro file: its macros and `${…}` make the numbers.
fn check_expanded(document: &Document, lines: &Lines) -> Result<()> {
    let is_xacro = |node: &Node| {
        let space = node.tag_name().namespace();
        space.is_some_and(|space| space.contains(XACRO))
            || node
                .attributes()
                .any(|attribute| attribute.value().contains("${"))
    };
    match document.descendants().find(is_xacro) {
        Some(node) => {
            let element = Element { node, lines };
            let (given, allowed) = NOT_EXPANDED;
            Err(element.refuse(format!("{} {given}", element.called()), allowed))
        }
        None => Ok(()),
    }
}

const NOT_EXPANDED: (&str, &str) = (
    "of xacro",
    "plain URDF: expand it first (xacro robot.urdf.xacro > robot.urdf)",
);

/// What the XML reader says, with its line.
fn unreadable(place: &str, text: &str, error: &roxmltree::Error) -> Error {
    let (given, allowed) = NOT_EXPANDED;
    match error {
        // An `xmlns:xacro` that is missing or commented out.
        roxmltree::Error::UnknownNamespace(prefix, at) if prefix == XACRO => Error::input(
            format!("{place}, line {}", at.row),
            format!("an element {given}"),
            allowed,
        ),
        _ if text.trim().is_empty() => Error::input(place, "an empty file", "URDF: a <robot>"),
        _ => {
            let said = error.to_string();
            // The reader appends its own place; ours stands in front.
            let given = said
                .rsplit_once(" at ")
                .map_or(said.as_str(), |(given, _)| given);
            let place = format!("{place}, line {}", error.pos().row);
            Error::input(place, given, "URDF: well-formed XML")
        }
    }
}
