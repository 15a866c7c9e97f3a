//! URDF reader \[URDF\], which converts the text of a robot file to links and joints. Each error contains its line.
//!
//! The reader uses the elements that move links and the shapes that skin can cover. Inertia, colours, transmissions and elements of other tools are
//! ignored. Faults that do not affect poses of links are omitted with a note.

use super::link::read_link;
use super::mimic::{Drive, drives};
use super::origin::{check_origin, origin_ignoring_slips};
use super::source::{Source, URDF};
use super::tactile::{TactileSensor, read_tactile_sensors};
use super::tree::Tree;
use super::{Joint, JointKind, Limits, Link, Mimic, Robot};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::spelling::nearest_names;
use crate::text::xml::{Element, NOT_NEGATIVE, unit_direction};
use glam::DVec3;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

/// Part of the XML namespace address that all versions of xacro use.
const XACRO: &str = "xacro";

/// Consequence of a limit that cannot be read, in the words of a note.
const UNLIMITED: &str = "it does not limit the joint";
const FIXED: &str = "the joint is fixed";
const ALONE: &str = "the joint mimics none";

/// Reads a robot, and all tactile sensors by name, from the text of a URDF file; errors begin with `place`, the file's name. An unreadable sensor is an error in
/// the list, and the robot does not have it.
pub(super) fn read_urdf(place: &str, text: &str) -> Result<(Robot, Vec<NamedSensor>)> {
    let source = Source::one_file(URDF, place, text);
    let document = source.document()?;
    let root = Element::root(&document, &source.lines);
    // Missing parts may be parts that xacro would have created.
    let not_expanded = root.whole_document().find(is_of_xacro);
    let parts = read_parts(root).map_err(|error| match &not_expanded {
        Some(element) => xacro_error(*element),
        None => error,
    });
    let (name, links, joints, tree, drives) = parts?;
    if let Some(element) = not_expanded {
        root.or_note(Err(xacro_error(element)), (), "it is passed over");
    }
    let sensors = read_tactile_sensors(root);
    let notes = source.lines.take_notes();
    let robot = Robot::assembled((name, place), links, joints, tree, drives, notes)?;
    let readable = sensors
        .iter()
        .filter_map(|(_, sensor)| sensor.as_ref().ok());
    let robot = robot.with_tactile_sensors(readable.cloned().collect());
    Ok((robot, sensors))
}

/// Name of a tactile sensor, and its content or fault.
pub(super) type NamedSensor = (String, Result<TactileSensor>);

type Parts = (String, Vec<Link>, Vec<Joint>, Tree, Vec<Drive>);

fn read_parts(root: Element) -> Result<Parts> {
    if root.tag() != "robot" {
        let given = format!("{} as the root", root.called());
        let allowed = "URDF: a <robot>, or MJCF: a <mujoco>";
        return Err(root.refuse(given, allowed));
    }
    root.check_tags("link joint material transmission gazebo")?;
    let mut names = Named::read(root, "link", |_| String::new())?;
    let links = names.elements.iter().map(read_link);
    let mut links = links.collect::<Result<Vec<_>>>()?;
    if links.is_empty() {
        return Err(root.refuse("a robot without a <link>", "at least one"));
    }
    add_missing_parent(root, &mut links, &mut names.index_of);
    let (mut joints, mut elements) = read_joints(root, &links, &names.index_of)?;
    join_roots(root, &links, &mut joints, &mut elements);
    drop_mimics_of_several(&mut joints, &elements);
    let place = |joint: usize| elements[joint].place();
    let tree = Tree::new(&links, &joints, place)?;
    let drives = drives(&joints, place)?;
    let name = root.or_note(root.name(), "robot", "the robot is called `robot`");
    Ok((name.to_owned(), links, joints, tree, drives))
}

/// Elements with a tag, and their indices by name.
struct Named<'a> {
    elements: Vec<Element<'a>>,
    index_of: HashMap<&'a str, usize>,
}

impl<'a> Named<'a> {
    /// Reads the elements with a tag, without repeated elements, which have the name and the `meaning` of an earlier element. Repeated elements become notes.
    ///
    /// # Errors
    /// If an element has no name, or the name of an element of another meaning.
    fn read(
        root: Element<'a>,
        tag: &'a str,
        meaning: impl Fn(Element<'a>) -> String,
    ) -> Result<Self> {
        let (mut elements, mut index_of) = (Vec::new(), HashMap::new());
        for element in root.children(tag) {
            let name = element.name()?;
            match index_of.entry(name) {
                Entry::Vacant(place) => {
                    place.insert(elements.len());
                    elements.push(element);
                }
                Entry::Occupied(place) => {
                    let first: Element = elements[*place.get()];
                    let line = first.line();
                    let given = format!("a second {tag} `{name}` (the first is on line {line})");
                    let allowed = "a name of its own";
                    if meaning(first) != meaning(element) {
                        return Err(element.refuse(given, allowed));
                    }
                    element.note(given, allowed, "it is passed over");
                }
            }
        }
        Ok(Self { elements, index_of })
    }
}

/// Adds the missing parent link of a joint, if the link is `world` or the only base of the robot. Some tools define `world` implicitly, and files of grippers
/// name the link of the arm to which they are attached.
fn add_missing_parent<'a>(
    root: Element<'a>,
    links: &mut Vec<Link>,
    link_of: &mut HashMap<&'a str, usize>,
) {
    const WORLD: &str = "world";
    let ends = |tag| {
        let all = root.children("joint").flat_map(move |it| it.children(tag));
        all.filter_map(|end| Some((end, end.attribute("link")?)))
    };
    let children: HashSet<&str> = ends("child").map(|(_, name)| name).collect();
    let mut missing = ends("parent").filter(|(_, name)| !link_of.contains_key(name));
    let Some((parent, name)) = missing.next() else {
        return;
    };
    let is_moved = |link: &Link| children.contains(link.name.as_str());
    let is_only_base = missing.all(|(_, other)| other == name) && links.iter().all(is_moved);
    if name != WORLD && !is_only_base {
        return;
    }
    let given = format!("parent `{name}`, which is no link");
    let consequence = "it is the base of the robot";
    parent.note(given, "a <link> of that name", consequence);
    link_of.insert(name, links.len());
    links.push(Link::new(name));
}

/// Adds a fixed joint without offset from the first link without a joint to each further link without a joint, as MuJoCo does.
fn join_roots<'a>(
    root: Element<'a>,
    links: &[Link],
    joints: &mut Vec<Joint>,
    elements: &mut Vec<Element<'a>>,
) {
    let is_moved: HashSet<usize> = joints.iter().map(|joint| joint.child).collect();
    let mut roots = (0..links.len()).filter(|link| !is_moved.contains(link));
    let Some(base) = roots.next() else {
        return;
    };
    for other in roots {
        let (name, base_name) = (&links[other].name, &links[base].name);
        let given = format!("links `{base_name}` and `{name}`, which no joint moves");
        let consequence = format!("`{name}` is fixed to `{base_name}`");
        root.note(given, "one of them", &consequence);
        joints.push(Joint::fixed(name, base, other, Pose::IDENTITY));
        elements.push(root);
    }
}

/// Returns the joints with their elements, in the order of the file.
fn read_joints<'a>(
    root: Element<'a>,
    links: &[Link],
    link_of: &HashMap<&str, usize>,
) -> Result<(Vec<Joint>, Vec<Element<'a>>)> {
    let end = |joint: Element<'a>, tag| {
        let mut ends = joint.children(tag);
        ends.next()?.attribute("link")
    };
    let ends = |joint| ["parent", "child"].map(|tag| end(joint, tag).unwrap_or_default());
    let Named { elements, index_of } = Named::read(root, "joint", |joint| ends(joint).join("\0"))?;
    let parents = elements.iter().filter_map(|joint| end(*joint, "parent"));
    let known = Known {
        links,
        link_of,
        joint_of: &index_of,
        parents: parents.collect(),
    };
    let joints = elements.iter().map(|element| read_joint(*element, &known));
    Ok((joints.collect::<Result<_>>()?, elements))
}

fn read_joint(element: Element, known: &Known) -> Result<Joint> {
    let name = element.name()?;
    element.check_tags(
        "origin parent child axis limit mimic dynamics calibration safety_controller",
    )?;
    let (kind, axis) = match element.or_note(read_kind(&element, name), JointKind::Fixed, FIXED) {
        // Fixed, floating and spherical joints have no axis; an `<axis>` in the file is ignored.
        kind @ (JointKind::Fixed | JointKind::Floating | JointKind::Ball) => (kind, DVec3::X),
        kind => {
            let read = read_axis(element, name).map(|axis| (kind, axis));
            element.or_note(read, (JointKind::Fixed, DVec3::X), FIXED)
        }
    };
    let mimic = read_mimic(element, kind, known);
    let [parent, child] = ["parent", "child"].map(|tag| known.end(element, tag));
    let (parent, child) = (parent?, child?);
    let slip = check_origin(element);
    match kind == JointKind::Fixed && known.is_frame(child) {
        // A pose that only a frame without shapes has; all readers of URDF ignore unknown attributes.
        true => element.or_note(slip, (), "the attribute is ignored"),
        false => slip?,
    }
    Ok(Joint {
        kind,
        axis,
        limits: read_limits(element, name, kind),
        mimic: element.or_note(mimic, None, ALONE),
        name: name.to_owned(),
        ..Joint::fixed(name, parent, child, origin_ignoring_slips(element)?)
    })
}

/// Removes `<mimic>` from joints that follow a joint of several coordinates.
fn drop_mimics_of_several(joints: &mut [Joint], elements: &[Element]) {
    for index in 0..joints.len() {
        let Some(mimic) = joints[index].mimic else {
            continue;
        };
        let (name, followed) = (&joints[index].name, &joints[mimic.joint]);
        if followed.kind.coordinates().len() < 2 {
            continue;
        }
        let other = &followed.name;
        let given = format!("joint `{name}` mimics `{other}`, which has several coordinates");
        let allowed = "a revolute, continuous or prismatic joint to follow";
        elements[index].note(given, allowed, ALONE);
        joints[index].mimic = None;
    }
}

/// Links and joints to which a joint can refer, by their names.
struct Known<'a> {
    links: &'a [Link],
    link_of: &'a HashMap<&'a str, usize>,
    joint_of: &'a HashMap<&'a str, usize>,
    /// Names of the links that joints have as parents.
    parents: HashSet<&'a str>,
}

impl Known<'_> {
    /// Returns whether a link is only a coordinate frame: a link without shapes that moves no other link.
    fn is_frame(&self, link: usize) -> bool {
        let Link { name, shapes } = &self.links[link];
        shapes.is_empty() && !self.parents.contains(name.as_str())
    }

    /// Returns the index of the link that a joint's `<parent>` or `<child>` element names.
    fn end(&self, joint: Element, tag: &'static str) -> Result<usize> {
        let end = joint.needed_child(tag)?;
        let found = self.link_of.get(end.text("link")?).copied();
        let names = self.links.iter().map(|link| link.name.as_str());
        found.ok_or_else(|| end.unknown("link", "link", names))
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

/// Returns the unit axis of a joint; the x axis if the file does not contain an axis.
fn read_axis(element: Element, joint: &str) -> Result<DVec3> {
    let Some(axis) = element.child("axis")? else {
        return Ok(DVec3::X);
    };
    axis.check_attributes("xyz")?;
    unit_direction(axis.vector("xyz", DVec3::X)?).ok_or_else(|| {
        let given = format!("joint `{joint}` with an axis of length zero");
        axis.refuse(given, "a direction")
    })
}

/// Reads the limits of a joint of one coordinate. Missing or invalid limits are infinite.
fn read_limits(element: Element, joint: &str, kind: JointKind) -> Option<Limits> {
    if !kind.has_one_coordinate() {
        return None;
    }
    let has_ends = kind != JointKind::Continuous;
    let limit = element.or_note(element.child("limit"), None, UNLIMITED);
    let Some(limit) = limit else {
        if has_ends {
            let given = format!("joint `{joint}` without <limit>");
            element.note(given, "lower and upper", "its position is not limited");
        }
        return None;
    };
    let slips =
        limit.check_attributes("lower upper velocity effort acceleration deceleration jerk");
    limit.or_note(slips, (), UNLIMITED);
    let endless = (f64::NEG_INFINITY, f64::INFINITY);
    let (lower, upper) = match has_ends {
        true => limit.or_note(read_ends(limit, joint), endless, UNLIMITED),
        false => endless,
    };
    let most = |attribute| {
        let most = limit.numbers_in(attribute, &NOT_NEGATIVE);
        let most = limit.or_note(most, None, UNLIMITED);
        most.map_or(f64::INFINITY, |[most]| most)
    };
    Some(Limits {
        lower,
        upper,
        velocity: most("velocity"),
        effort: most("effort"),
    })
}

fn read_ends(limit: Element, joint: &str) -> Result<(f64, f64)> {
    let (lower, upper) = match (limit.number("lower")?, limit.number("upper")?) {
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
    Ok((lower, upper))
}

fn read_mimic(element: Element, kind: JointKind, known: &Known) -> Result<Option<Mimic>> {
    let Some(mimic) = element.child("mimic")? else {
        return Ok(None);
    };
    mimic.check_attributes("joint multiplier offset")?;
    if !kind.has_one_coordinate() {
        let joint = element.name()?;
        let given = format!("<mimic> in the {kind:?} joint `{joint}`").to_lowercase();
        return Err(mimic.refuse(given, "a revolute, continuous or prismatic joint"));
    }
    let Some(&joint) = known.joint_of.get(mimic.text("joint")?) else {
        // The order of a hash map varies between runs.
        let mut names: Vec<(&usize, &str)> = known.joint_of.iter().map(|(n, k)| (k, *n)).collect();
        names.sort_unstable();
        return Err(mimic.unknown("joint", "joint", names.into_iter().map(|(_, name)| name)));
    };
    Ok(Some(Mimic {
        joint,
        multiplier: mimic.number("multiplier")?.unwrap_or(1.0),
        offset: mimic.number("offset")?.unwrap_or(0.0),
    }))
}

/// Returns whether an element belongs to xacro or has a xacro expression in an attribute. The elements that xacro would generate are missing from the file.
fn is_of_xacro(element: &Element) -> bool {
    let space = element.node.tag_name().namespace();
    let mut values = element.node.attributes().map(|attribute| attribute.value());
    space.is_some_and(|space| space.contains(XACRO))
        || values.any(|value| value.contains("${") || value.contains("$("))
}

fn xacro_error(element: Element) -> Error {
    element.refuse(
        format!("{} of xacro", element.called()),
        "plain URDF: expand it first (xacro robot.urdf.xacro > robot.urdf)",
    )
}
