//! Tree of the bodies of an MJCF model, and its conversion to a robot.

use super::classes::Classes;
use super::compiler::Compiler;
use super::equality::{copy_equalities, read_equalities};
use super::frames::{Placed, children_of, named_part};
use super::geom::{Meshes, extent, read_geom, read_meshes};
use super::joint::{JointPlace, read_joint, rest_of};
use super::orientation::pose_of;
use super::source::Source;
use super::submodels::SubModels;
use crate::error::Result;
use crate::geometry::Pose;
use crate::world::robot::mimic::drives;
use crate::world::robot::text::{parsed, unreadable};
use crate::world::robot::tree::Tree;
use crate::world::robot::xml::Element;
use crate::world::robot::{Joint, JointKind, Link, Robot};
use glam::DVec3;
use std::cell::Cell;
use std::collections::{BTreeMap, HashMap, HashSet};

/// Name of the body that contains all others.
const WORLD: &str = "world";
/// Largest number of bodies of a model. With a larger value, a small file with copies can fill the memory.
const MAX_BODIES: usize = 100_000;
/// Elements that add bodies or shapes but are not supported by the reader.
const ADDING: [&str; 2] = ["composite", "flexcomp"];

/// Reads a robot from the text of an MJCF file; `place` is the path of the file.
pub(in crate::world::robot) fn read_mjcf(place: &str, text: &str) -> Result<Robot> {
    let source = Source::new(place, text)?;
    let document = parsed(&source.text).map_err(|e| unreadable(place, &source.text, &e, "MJCF"))?;
    let root = Element {
        node: document.root_element(),
        lines: &source.lines,
    };
    let parts = Parts::read(root, place, (&SubModels::default(), None))?;
    let Parts {
        mut links,
        mut joints,
        mut elements,
        sites,
        body_poses,
        ignored,
        ..
    } = parts;
    add_sites(root, sites, &mut links, &mut joints, &mut elements)?;
    read_equalities(root, &mut joints, false)?;
    copy_equalities(root, &mut joints, &elements);
    let drives = drives(&joints, &elements)?;
    if !ignored.is_empty() {
        let kinds: Vec<String> = ignored
            .iter()
            .map(|(tag, n)| format!("{tag} ({n})"))
            .collect();
        root.lines.note(format!(
            "{place}: elements that determine neither poses nor shapes are ignored: {}",
            kinds.join(", ")
        ));
    }
    let tree = Tree {
        root: 0,
        outward: (0..joints.len()).collect(),
    };
    let name = root.node.attribute("model").unwrap_or("MuJoCo Model");
    let robot = Robot::assembled(
        (name.to_owned(), place),
        links,
        joints,
        tree,
        drives,
        Vec::new(),
    )?;
    let mut robot = robot.with_rest(|joint| rest_of(joint, &body_poses));
    robot.notes = source.lines.into_notes();
    Ok(robot)
}

/// Bodies, joints and sites of a model.
pub(super) struct Parts<'a> {
    classes: Classes<'a>,
    compiler: Compiler,
    meshes: Meshes,
    /// Models that `<attach>` can add.
    pub models: SubModels,
    pub links: Vec<Link>,
    /// Pose of each body in its parent, as the model contains it.
    pub body_poses: Vec<Pose>,
    pub joints: Vec<Joint>,
    /// Element of each joint; for a fixed joint, the element of its body.
    pub elements: Vec<Element<'a>>,
    sites: Vec<Site<'a>>,
    /// Line of each name of a body, joint or site, by kind and name.
    names: HashMap<(&'static str, String), usize>,
    /// Number of ignored elements by their tag.
    ignored: BTreeMap<&'a str, usize>,
    /// Number of copies that `<replicate>` has made.
    n_copies: Cell<usize>,
}

/// Site with a name.
struct Site<'a> {
    element: Element<'a>,
    name: String,
    body: usize,
    body_from_site: Pose,
}

impl<'a> Parts<'a> {
    /// Reads the bodies of the model in the file `place`, or of a frame of this model. `around` contains the models of the file that attaches this model.
    pub fn read(
        root: Element<'a>,
        place: &str,
        (around, frame): (&SubModels, Option<&str>),
    ) -> Result<Self> {
        if root.node.tag_name().name() != "mujoco" {
            return Err(root.refuse(format!("{} as the root", root.called()), "MJCF: a <mujoco>"));
        }
        root.check_tags(&[
            "compiler",
            "default",
            "asset",
            "worldbody",
            "equality",
            "include",
        ])?;
        let compiler = Compiler::read(root)?;
        let classes = Classes::read(root)?;
        let meshes = read_meshes(root, &classes, &compiler)?;
        let mut parts = Self {
            classes,
            compiler,
            meshes,
            models: SubModels::read(root, place, around)?,
            links: vec![link(WORLD)],
            body_poses: vec![Pose::IDENTITY],
            joints: Vec::new(),
            elements: Vec::new(),
            sites: Vec::new(),
            names: HashMap::from([(("body", WORLD.to_owned()), root.line())]),
            ignored: BTreeMap::new(),
            n_copies: Cell::new(0),
        };
        if let Some(name) = frame {
            let (element, class) = named_part(root, &parts.classes, ("frame", name))?;
            let item = parts.classes.item(element, 0)?;
            let frame = pose_of(&item, &parts.compiler)?;
            let own_class = parts.classes.class_of(element, "childclass")?;
            let class = own_class.unwrap_or(class);
            let inside = Placed {
                frame,
                class,
                ..Placed::new(element)
            };
            parts.add_children(&inside, 0)?;
            return Ok(parts);
        }
        let sections = root.node.children().filter(|node| node.is_element());
        for node in sections {
            match node.tag_name().name() {
                "worldbody" => {
                    let world = Element { node, ..root };
                    parts.add_children(&Placed::new(world), 0)?;
                }
                "compiler" | "default" => {}
                "asset" | "equality" => parts.ignore_children(node, &["mesh", "joint", "model"]),
                tag => {
                    let n_inside = node.children().filter(|node| node.is_element()).count();
                    *parts.ignored.entry(tag).or_default() += n_inside.max(1);
                }
            }
        }
        Ok(parts)
    }

    /// Counts the children of a section as ignored, except children with one of the tags in `used`.
    fn ignore_children(&mut self, section: roxmltree::Node<'a, 'a>, used: &[&str]) {
        let tags = section.children().filter(|node| node.is_element());
        for tag in tags.map(|node| node.tag_name().name()) {
            if !used.contains(&tag) {
                *self.ignored.entry(tag).or_default() += 1;
            }
        }
    }

    /// Adds the bodies, sites and geoms in a body. The body's joints must have been added.
    fn add_children(&mut self, body: &Placed<'a>, index: usize) -> Result<()> {
        for child in children_of(body, &self.classes, &self.compiler, &self.n_copies)? {
            match child.tag() {
                "body" => self.add_body(&child, index)?,
                "site" => self.add_site(&child, index)?,
                "geom" => {
                    let item = self.classes.item(child.element, child.class)?;
                    if let Some(kind @ ("plane" | "hfield")) = item.text("type") {
                        *self.ignored.entry(kind).or_default() += 1;
                        continue;
                    }
                    let shapes = read_geom(&item, &child.frame, &self.meshes, &self.compiler);
                    let shapes = child
                        .element
                        .or_note(shapes, Vec::new(), "the shape is left out");
                    self.links[index].shapes.extend(shapes);
                }
                "joint" | "freejoint" if index == 0 => {
                    return Err(child
                        .element
                        .refuse("a joint of the world", "joints in a <body>"));
                }
                "joint" | "freejoint" => {}
                "attach" => self.attach(&child, index)?,
                tag if ADDING.contains(&tag) => {
                    let given = child.element.called();
                    let unread = Err(child.element.refuse(given, "bodies and geoms as elements"));
                    child.element.or_note(unread, (), "what it adds is missing");
                }
                tag => *self.ignored.entry(tag).or_default() += 1,
            }
        }
        Ok(())
    }

    fn add_body(&mut self, body: &Placed<'a>, parent: usize) -> Result<()> {
        let element = body.element;
        element.check_attributes(&[
            "name",
            "childclass",
            "pos",
            "quat",
            "axisangle",
            "xyaxes",
            "zaxis",
            "euler",
            "mocap",
            "gravcomp",
            "sleep",
            "simple",
            "user",
        ])?;
        let index = self.links.len();
        let name = self.name("body", body, || format!("body{index}"))?;
        self.links.push(link(&name));
        // No default class has attributes of bodies.
        let item = self.classes.item(element, 0)?;
        let parent_from_body = body.frame.compose(&pose_of(&item, &self.compiler)?);
        self.body_poses.push(parent_from_body);
        let class = self.classes.class_of(element, "childclass")?;
        let inside = Placed {
            frame: Pose::IDENTITY,
            class: class.unwrap_or(body.class),
            ..body.clone()
        };
        self.add_joints(&inside, (parent, index), &name)?;
        self.add_children(&inside, index)
    }

    /// Adds the joints between a body and its parent, or a fixed joint if there are none.
    fn add_joints(
        &mut self,
        body: &Placed<'a>,
        (parent, index): (usize, usize),
        name: &str,
    ) -> Result<()> {
        let children = children_of(body, &self.classes, &self.compiler, &self.n_copies)?;
        let is_joint = |child: &Placed| matches!(child.tag(), "joint" | "freejoint");
        let own: Vec<Placed> = children.into_iter().filter(is_joint).collect();
        let n_joints = own.len();
        let origin = self.body_poses[index];
        for (number, joint) in own.into_iter().enumerate() {
            let default = || match n_joints {
                1 => format!("{name}_joint"),
                _ => format!("{name}_joint{number}"),
            };
            let place = JointPlace {
                name: self.name("joint", &joint, default)?,
                // Each further joint moves the body relative to its pose after the preceding joint.
                parent: if number == 0 { parent } else { index },
                child: index,
                origin: if number == 0 { origin } else { Pose::IDENTITY },
                frame: joint.frame,
                is_alone_in_world: n_joints == 1 && parent == 0,
            };
            let item = self.classes.item(joint.element, joint.class)?;
            self.joints.push(read_joint(&item, place, &self.compiler)?);
            self.elements.push(joint.element);
        }
        if n_joints == 0 {
            self.joints.push(fixed(name, (parent, index), origin));
            self.elements.push(body.element);
        }
        Ok(())
    }

    fn add_site(&mut self, site: &Placed<'a>, body: usize) -> Result<()> {
        if site.name().is_none() {
            *self.ignored.entry("site without a name").or_default() += 1;
            return Ok(());
        }
        let name = self.name("site", site, String::new)?;
        let item = self.classes.item(site.element, site.class)?;
        let (frame_from_site, _) = extent(&item, &self.compiler)?;
        self.sites.push(Site {
            element: site.element,
            name,
            body,
            body_from_site: site.frame.compose(&frame_from_site),
        });
        Ok(())
    }

    /// Returns the name of an element. If the element has no name, `unnamed` creates a name.
    fn name(
        &mut self,
        kind: &'static str,
        placed: &Placed,
        unnamed: impl Fn() -> String,
    ) -> Result<String> {
        let name = placed.name().unwrap_or_else(unnamed);
        self.taken_name(kind, placed.element, name)
    }

    /// Returns the sites with their names, bodies and poses.
    pub fn named_sites(&self) -> Vec<(String, usize, Pose)> {
        let of = |site: &Site| (site.name.clone(), site.body, site.body_from_site);
        self.sites.iter().map(of).collect()
    }

    /// Adds a site of an attached model, given its body and its pose on the body.
    pub fn add_attached_site(&mut self, element: Element<'a>, name: String, place: (usize, Pose)) {
        let (body, body_from_site) = place;
        self.sites.push(Site {
            element,
            name,
            body,
            body_from_site,
        });
    }

    /// Returns the name, which is taken from now on. A second element of a kind with an equal name is an error.
    pub fn taken_name(
        &mut self,
        kind: &'static str,
        element: Element,
        name: String,
    ) -> Result<String> {
        if self.links.len() > MAX_BODIES {
            return Err(element.refuse("too many bodies", format!("at most {MAX_BODIES}")));
        }
        match self.names.insert((kind, name.clone()), element.line()) {
            None => Ok(name),
            Some(first) => {
                let given = format!("a second {kind} `{name}` (the first is on line {first})");
                Err(element.refuse(given, "a name of its own"))
            }
        }
    }
}

/// Adds each site as a link that is fixed to its body. A site with the name of a body is called `NAME_site`.
fn add_sites<'a>(
    root: Element<'a>,
    sites: Vec<Site<'a>>,
    links: &mut Vec<Link>,
    joints: &mut Vec<Joint>,
    elements: &mut Vec<Element<'a>>,
) -> Result<()> {
    let mut taken: HashSet<String> = links.iter().map(|link| link.name.clone()).collect();
    for site in sites {
        let mut name = site.name.clone();
        if taken.contains(&name) {
            name += "_site";
            let same: Result<()> = Err(site.element.refuse(
                format!("site `{}`, the name of a body", site.name),
                "a name of its own",
            ));
            if taken.contains(&name) {
                return same;
            }
            root.or_note(same, (), &format!("its link is called `{name}`"));
        }
        taken.insert(name.clone());
        joints.push(fixed(&name, (site.body, links.len()), site.body_from_site));
        elements.push(site.element);
        links.push(link(&name));
    }
    Ok(())
}

fn link(name: &str) -> Link {
    Link {
        name: name.to_owned(),
        shapes: Vec::new(),
    }
}

/// Returns the joint that fixes a body or a site to its parent.
fn fixed(child_name: &str, (parent, child): (usize, usize), origin: Pose) -> Joint {
    Joint {
        name: format!("{child_name}_fixed"),
        kind: JointKind::Fixed,
        parent,
        child,
        origin,
        axis: DVec3::X,
        anchor: DVec3::ZERO,
        reference: 0.0,
        limits: None,
        mimic: None,
    }
}
