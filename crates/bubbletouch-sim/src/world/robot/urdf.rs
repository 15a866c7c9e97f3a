//! URDF reader \[URDF\], which converts the text of a robot file to links and joints. Each error contains its line.
//!
//! The reader uses the elements that move links and the shapes that skin can cover. Inertia, colours, transmissions and elements of other tools are
//! ignored. Faults that do not affect poses of links are omitted with a note.

use super::link::read_link;
use super::mimic::{Drive, drives};
use super::tactile::{TactileSensor, read_tactile_sensors};
use super::text::{parsed, repaired, unreadable};
use super::tree::Tree;
use super::xml::{Element, Lines};
use super::{Joint, JointKind, Limits, Link, Mimic, Robot};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::spelling::nearest_names;
use glam::DVec3;
use roxmltree::Node;
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
    let lines = Lines::new(place, text);
    let text = repaired(place, text, &lines);
    let document = parsed(&text).map_err(|e| unreadable(place, &text, &e, "URDF"))?;
    let root = Element {
        node: document.root_element(),
        lines: &lines,
    };
    // Missing parts may be parts that xacro would have created.
    let not_expanded = not_expanded(root);
    let (name, links, joints, tree, drives) =
        read_parts(root).map_err(|error| match &not_expanded {
            Some(element) => xacro_error(*element),
            None => error,
        })?;
    if let Some(element) = not_expanded {
        lines.note(format!("{}: it is passed over", xacro_error(element)));
    }
    let sensors = read_tactile_sensors(root);
    let notes = lines.into_notes();
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
    if root.node.tag_name().name() != "robot" {
        return Err(root.refuse(
            format!("{} as the root", root.called()),
            "URDF: a <robot>, or MJCF: a <mujoco>",
        ));
    }
    root.check_tags(&["link", "joint", "material", "transmission", "gazebo"])?;
    let elements = distinct(root, "link", |_| String::new())?;
    let mut links = elements.iter().map(read_link).collect::<Result<Vec<_>>>()?;
    if links.is_empty() {
        return Err(root.refuse("a robot without a <link>", "at least one"));
    }
    let names = elements.iter().map(Element::name);
    let names = names.collect::<Result<Vec<_>>>()?;
    let mut link_of = index_of_each("link", names.into_iter(), &elements)?;
    add_missing_parent(root, &mut links, &mut link_of);
    let (mut joints, mut elements) = read_joints(root, &links, &link_of)?;
    join_roots(root, &links, &mut joints, &mut elements);
    drop_mimics_of_several(&mut joints, &elements);
    let tree = Tree::new(&links, &joints, &elements)?;
    let drives = drives(&joints, &elements)?;
    let name = root.or_note(root.name(), "robot", "the robot is called `robot`");
    Ok((name.to_owned(), links, joints, tree, drives))
}

/// Returns the elements with a tag, without repeated elements, which have the name and the `meaning` of an earlier element. Repeated elements become notes.
fn distinct<'a>(
    root: Element<'a>,
    tag: &'a str,
    meaning: impl Fn(&Element) -> String,
) -> Result<Vec<Element<'a>>> {
    let mut first: HashMap<(&str, String), usize> = HashMap::new();
    let mut all = Vec::new();
    for element in root.children(tag) {
        let line = element.line();
        match first.entry((element.name()?, meaning(&element))) {
            Entry::Vacant(place) => {
                place.insert(line);
                all.push(element);
            }
            Entry::Occupied(place) => {
                let given = format!(
                    "a second {tag} `{}` (the first is on line {})",
                    place.key().0,
                    place.get()
                );
                let repeated = Err(element.refuse(given, "a name of its own"));
                element.or_note(repeated, (), "it is passed over");
            }
        }
    }
    Ok(all)
}

/// Adds the missing parent link of a joint, if the link is `world` or the only base of the robot. Some tools define `world` implicitly, and files of grippers
/// name the link of the arm to which they are attached.
fn add_missing_parent<'a>(
    root: Element<'a>,
    links: &mut Vec<Link>,
    link_of: &mut HashMap<&'a str, usize>,
) {
    const WORLD: &str = "world";
    let joints: Vec<Element> = root.children("joint").collect();
    let ends = |tag| {
        let all = joints.iter().flat_map(move |joint| joint.children(tag));
        all.filter_map(|end| Some((end, end.node.attribute("link")?)))
    };
    let children: HashSet<&str> = ends("child").map(|(_, name)| name).collect();
    let mut missing = ends("parent").filter(|(_, name)| !link_of.contains_key(name));
    let Some((parent, name)) = missing.next() else {
        return;
    };
    let is_only_base = missing.all(|(_, other)| other == name)
        && links
            .iter()
            .all(|link| children.contains(link.name.as_str()));
    if name != WORLD && !is_only_base {
        return;
    }
    let given = format!("parent `{name}`, which is no link");
    let missing = Err(parent.refuse(given, "a <link> of that name"));
    parent.or_note(missing, (), "it is the base of the robot");
    link_of.insert(name, links.len());
    links.push(Link {
        name: name.to_owned(),
        shapes: Vec::new(),
    });
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
        let several = Err(root.refuse(given, "one of them"));
        root.or_note(several, (), &format!("`{name}` is fixed to `{base_name}`"));
        joints.push(Joint {
            name: format!("{name}_fixed"),
            kind: JointKind::Fixed,
            parent: base,
            child: other,
            origin: Pose::IDENTITY,
            axis: DVec3::X,
            anchor: DVec3::ZERO,
            reference: 0.0,
            limits: None,
            mimic: None,
        });
        elements.push(root);
    }
}

/// Returns the joints with their elements, in the order of the file.
fn read_joints<'a>(
    root: Element<'a>,
    links: &[Link],
    link_of: &HashMap<&str, usize>,
) -> Result<(Vec<Joint>, Vec<Element<'a>>)> {
    let ends = |joint: &Element| {
        let tags = ["parent", "child"].into_iter();
        let ends = tags.flat_map(|tag| joint.children(tag));
        ends.filter_map(|end| end.node.attribute("link"))
            .collect::<Vec<_>>()
            .join("\0")
    };
    let elements = distinct(root, "joint", ends)?;
    let names = elements.iter().map(Element::name);
    let names = names.collect::<Result<Vec<_>>>()?;
    let joint_of = index_of_each("joint", names.iter().copied(), &elements)?;
    let parents = elements.iter().filter_map(|joint| {
        let mut parents = joint.children("parent");
        parents.next()?.node.attribute("link")
    });
    let ends = Ends {
        links,
        link_of,
        parents: parents.collect(),
    };
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
    let (kind, axis) = match element.or_note(read_kind(&element, name), JointKind::Fixed, FIXED) {
        // Fixed, floating and spherical joints have no axis; an `<axis>` in the file is ignored.
        kind @ (JointKind::Fixed | JointKind::Floating | JointKind::Ball) => (kind, DVec3::X),
        kind => {
            let read = read_axis(element, name).map(|axis| (kind, axis));
            element.or_note(read, (JointKind::Fixed, DVec3::X), FIXED)
        }
    };
    let mimic = read_mimic(element, name, kind, joint_of);
    let [parent, child] = ["parent", "child"].map(|tag| ends.read(element, name, tag));
    let (parent, child) = (parent?, child?);
    let slip = element.check_origin();
    match kind == JointKind::Fixed && ends.is_frame(child) {
        // A pose that only a frame without shapes has; all readers of URDF ignore unknown attributes.
        true => element.or_note(slip, (), "the attribute is ignored"),
        false => slip?,
    }
    Ok(Joint {
        name: name.to_owned(),
        kind,
        parent,
        child,
        origin: element.origin_ignoring_slips()?,
        axis,
        anchor: DVec3::ZERO,
        reference: 0.0,
        limits: read_limits(element, name, kind),
        mimic: element.or_note(mimic, None, ALONE),
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
        let wrong: Result<()> = Err(elements[index].refuse(
            format!(
                "joint `{name}` mimics `{}`, which has several coordinates",
                followed.name
            ),
            "a revolute, continuous or prismatic joint to follow",
        ));
        elements[index].or_note(wrong, (), ALONE);
        joints[index].mimic = None;
    }
}

/// Links that a joint can connect, by their names.
struct Ends<'a> {
    links: &'a [Link],
    link_of: &'a HashMap<&'a str, usize>,
    /// Names of the links that joints have as parents.
    parents: HashSet<&'a str>,
}

impl Ends<'_> {
    /// Returns whether a link is only a coordinate frame: a link without shapes that moves no other link.
    fn is_frame(&self, link: usize) -> bool {
        let Link { name, shapes } = &self.links[link];
        shapes.is_empty() && !self.parents.contains(name.as_str())
    }

    /// Returns the index of the link that a joint's `<parent>` or `<child>` element names.
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

/// Returns the unit axis of a joint; the x axis if the file does not contain an axis.
fn read_axis(element: Element, joint: &str) -> Result<DVec3> {
    let Some(axis) = element.child("axis")? else {
        return Ok(DVec3::X);
    };
    axis.check_attributes(&["xyz"])?;
    let xyz = DVec3::from(axis.numbers("xyz")?.unwrap_or([1.0, 0.0, 0.0]));
    // Scaled first, so that no square overflows or underflows.
    let largest = xyz.abs().max_element();
    (xyz / largest).try_normalize().ok_or_else(|| {
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
            let missing = Err(element.refuse(given, "lower and upper"));
            element.or_note(missing, (), "its position is not limited");
        }
        return None;
    };
    let slips = limit.check_attributes(&[
        "lower",
        "upper",
        "velocity",
        "effort",
        "acceleration",
        "deceleration",
        "jerk",
    ]);
    limit.or_note(slips, (), UNLIMITED);
    let endless = (f64::NEG_INFINITY, f64::INFINITY);
    let (lower, upper) = match has_ends {
        true => limit.or_note(read_ends(limit, joint), endless, UNLIMITED),
        false => endless,
    };
    let not_negative = |attribute: &str| {
        let value = limit.number(attribute)?.unwrap_or(f64::INFINITY);
        if value >= 0.0 {
            return Ok(value);
        }
        let given = format!("joint `{joint}` with `{attribute}` {value}");
        Err(limit.refuse(given, "zero or a positive number"))
    };
    let most = |attribute| limit.or_note(not_negative(attribute), f64::INFINITY, UNLIMITED);
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

/// Returns the names sorted by their index, because the order of a hash map varies between runs.
fn in_order<'n>(index_of: &HashMap<&'n str, usize>) -> Vec<&'n str> {
    let mut names: Vec<(usize, &str)> = index_of
        .iter()
        .map(|(name, index)| (*index, *name))
        .collect();
    names.sort_unstable();
    names.into_iter().map(|(_, name)| name).collect()
}

/// Returns a map from names of elements to their indices. If two names are equal, the error shows the second element.
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

/// Returns the first xacro element, or the first element with a xacro expression in an attribute; `None` if there is none. The elements that xacro would
/// generate are missing from the file.
fn not_expanded(root: Element) -> Option<Element> {
    let is_xacro = |node: &Node| {
        let space = node.tag_name().namespace();
        space.is_some_and(|space| space.contains(XACRO))
            || node.attributes().any(|attribute| {
                let value = attribute.value();
                value.contains("${") || value.contains("$(")
            })
    };
    let found = root.node.descendants().find(is_xacro)?;
    Some(Element {
        node: found,
        ..root
    })
}

fn xacro_error(element: Element) -> Error {
    element.refuse(
        format!("{} of xacro", element.called()),
        "plain URDF: expand it first (xacro robot.urdf.xacro > robot.urdf)",
    )
}
