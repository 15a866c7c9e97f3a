//! Tree of the bodies of an MJCF model and of the models that it attaches, and its conversion to a robot.

use super::geom::{extent, read_geom};
use super::joint::{read_joint, rest_of};
use super::limits::{BODIES, MODEL_DEPTH, MODELS};
use super::model::Model;
use super::placed::{Naming, Placed};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::xml::Element;
use crate::world::robot::mimic::drives;
use crate::world::robot::source::{Source, file_text};
use crate::world::robot::tree::Tree;
use crate::world::robot::{Joint, JointKind, Link, Robot};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::Path;

/// Name of the body that contains all others.
const WORLD: &str = "world";

/// Reads a robot from the text of an MJCF file; `place` is the path of the file.
pub(in crate::world::robot) fn read_mjcf(place: &str, text: &str) -> Result<Robot> {
    let source = Source::mjcf(place, text)?;
    let document = source.document()?;
    let root = Element::root(&document, &source.lines);
    let model = Model::read(root, Path::new(place), 0)?;
    let mut bodies = Bodies::new(root);
    let world = Placed::root(&model);
    bodies.add_world(&world, 0)?;
    bodies.ignore_sections(root);
    bodies.add_sites(root)?;
    bodies.couple(&world, 0, false)?;
    if !bodies.ignored.is_empty() {
        let ignored = bodies.ignored.iter();
        let kinds: Vec<String> = ignored.map(|(tag, n)| format!("{tag} ({n})")).collect();
        root.lines.note(format!(
            "{place}: elements that determine neither poses nor shapes are ignored: {}",
            kinds.join(", ")
        ));
    }
    let joints = bodies.joints;
    let drives = drives(&joints, |joint| bodies.origins[joint].place.clone())?;
    let tree = Tree {
        root: 0,
        outward: (0..joints.len()).collect(),
    };
    let name = root.attribute("model").unwrap_or("MuJoCo Model").to_owned();
    let notes = source.lines.take_notes();
    let robot = Robot::assembled((name, place), bodies.links, joints, tree, drives, notes)?;
    Ok(robot.with_rest(|joint| rest_of(joint, &bodies.body_poses)))
}

/// Bodies, joints and sites of a model and of the models that it attaches.
pub(super) struct Bodies {
    links: Vec<Link>,
    /// Pose of each body in its parent, as the model contains it.
    body_poses: Vec<Pose>,
    pub joints: Vec<Joint>,
    /// Origin of each joint in the files, except of the joints that fix sites.
    pub origins: Vec<JointOrigin>,
    sites: Vec<Site>,
    /// Line of each name of a body, joint or site, by kind and name.
    names: HashMap<(&'static str, String), usize>,
    /// Number of ignored elements by their tag.
    ignored: BTreeMap<String, usize>,
    /// Number of copies that `<replicate>` and `<attach>` have made.
    pub n_copies: usize,
    /// Number of models that have been attached.
    n_models: usize,
}

/// Element of a joint, or of the body that a fixed joint moves.
pub(super) struct JointOrigin {
    /// File and line of the element.
    pub place: String,
    /// Name of the joint in the file.
    pub name: String,
    /// Naming of the copy, by which the joint is named in the robot.
    pub naming: Naming,
}

/// Site with a name.
struct Site {
    /// File and line of the site.
    place: String,
    name: String,
    body: usize,
    body_from_site: Pose,
}

impl Bodies {
    fn new(root: Element) -> Self {
        Self {
            links: vec![Link::new(WORLD)],
            body_poses: vec![Pose::IDENTITY],
            joints: Vec::new(),
            origins: Vec::new(),
            sites: Vec::new(),
            names: HashMap::from([(("body", WORLD.to_owned()), root.line())]),
            ignored: BTreeMap::new(),
            n_copies: 0,
            n_models: 0,
        }
    }

    /// Adds the bodies, sites and geoms in the world of a model, whose root is `placed`, to the body `index`.
    fn add_world(&mut self, placed: &Placed, index: usize) -> Result<()> {
        for element in placed.element.children("worldbody") {
            let world = Placed {
                element,
                ..placed.clone()
            };
            let children = self.children_of(&world)?;
            self.add_all(children, index)?;
        }
        Ok(())
    }

    /// Counts the elements outside the world that the reader does not use as ignored.
    fn ignore_sections(&mut self, root: Element) {
        for section in root.elements() {
            match section.tag() {
                "worldbody" | "compiler" | "default" => {}
                "asset" | "equality" => {
                    let tags = section.elements().map(|element| element.tag());
                    let unused = tags.filter(|tag| !["mesh", "joint", "model"].contains(tag));
                    unused.for_each(|tag| self.ignore(tag, 1));
                }
                tag => self.ignore(tag, section.elements().count().max(1)),
            }
        }
    }

    fn ignore(&mut self, kind: &str, n: usize) {
        *self.ignored.entry(kind.to_owned()).or_default() += n;
    }

    /// Adds bodies, sites and geoms to the body `index`.
    fn add_all(&mut self, children: Vec<Placed>, index: usize) -> Result<()> {
        for child in children {
            let element = child.element;
            match element.tag() {
                "body" => self.add_body(&child, index)?,
                "site" => self.add_site(&child, index)?,
                "geom" => self.add_geom(&child, index)?,
                "joint" | "freejoint" => {
                    return Err(element.refuse("a joint of the world", "joints in a <body>"));
                }
                "attach" => self.attach(&child, index)?,
                "composite" | "flexcomp" => {
                    let allowed = "bodies and geoms as elements";
                    element.note(element.called(), allowed, "what it adds is missing");
                }
                tag => self.ignore(tag, 1),
            }
        }
        Ok(())
    }

    fn add_body(&mut self, body: &Placed, parent: usize) -> Result<()> {
        let element = body.element;
        element.check_attributes(
            "name childclass pos quat axisangle xyaxes zaxis euler mocap gravcomp sleep simple user",
        )?;
        let index = self.links.len();
        let name = body.name().unwrap_or_else(|| format!("body{index}"));
        self.take_name("body", element, &name)?;
        self.links.push(Link::new(&name));
        self.body_poses.push(body.frame.compose(&body.own_pose()?));
        let children = self.children_of(&body.around(Pose::IDENTITY)?)?;
        let is_joint = |child: &Placed| matches!(child.element.tag(), "joint" | "freejoint");
        let (joints, others) = children.into_iter().partition(is_joint);
        self.add_joints(body, joints, (parent, index))?;
        self.add_all(others, index)
    }

    /// Adds the joints between a body and its parent, or a fixed joint if there are none.
    fn add_joints(
        &mut self,
        body: &Placed,
        joints: Vec<Placed>,
        (parent, index): (usize, usize),
    ) -> Result<()> {
        let (n_joints, origin) = (joints.len(), self.body_poses[index]);
        let body_name = self.links[index].name.clone();
        if n_joints == 0 {
            let joint = Joint::fixed(&body_name, parent, index, origin);
            self.add_origin(body, &joint.name);
            self.joints.push(joint);
        }
        for (number, joint) in joints.iter().enumerate() {
            let default = || match n_joints {
                1 => format!("{body_name}_joint"),
                _ => format!("{body_name}_joint{number}"),
            };
            let name = joint.name().unwrap_or_else(default);
            self.take_name("joint", joint.element, &name)?;
            self.add_origin(joint, &name);
            // Each further joint moves the body relative to its pose after the preceding joint.
            let (parent_of_joint, origin) = match number {
                0 => (parent, origin),
                _ => (index, Pose::IDENTITY),
            };
            let placed = Joint {
                name,
                axis: DVec3::Z,
                ..Joint::fixed("", parent_of_joint, index, origin)
            };
            let read = read_joint(&joint.item()?, &joint.frame, placed)?;
            if read.kind == JointKind::Floating && (n_joints > 1 || parent != 0) {
                let given = format!("the free joint `{}`", read.name);
                let allowed = "the only joint of a body in <worldbody>";
                return Err(joint.element.refuse(given, allowed));
            }
            self.joints.push(read);
        }
        Ok(())
    }

    /// Adds the origin of a joint; `name` is the name of a joint without a name in the file.
    fn add_origin(&mut self, placed: &Placed, name: &str) {
        let is_joint = placed.element.tag() != "body";
        let written = placed.element.attribute("name").filter(|_| is_joint);
        self.origins.push(JointOrigin {
            place: placed.element.place(),
            name: written.unwrap_or(name).to_owned(),
            naming: written.map_or(Naming::default(), |_| placed.naming.clone()),
        });
    }

    fn add_site(&mut self, site: &Placed, body: usize) -> Result<()> {
        let Some(name) = site.name() else {
            self.ignore("site without a name", 1);
            return Ok(());
        };
        self.take_name("site", site.element, &name)?;
        let (frame_from_site, _) = extent(&site.item()?)?;
        self.sites.push(Site {
            place: site.element.place(),
            name,
            body,
            body_from_site: site.frame.compose(&frame_from_site),
        });
        Ok(())
    }

    fn add_geom(&mut self, geom: &Placed, body: usize) -> Result<()> {
        let item = geom.item()?;
        if let Some(kind @ ("plane" | "hfield")) = item.text("type") {
            self.ignore(kind, 1);
            return Ok(());
        }
        let shapes = read_geom(&item, &geom.frame, &geom.model.meshes);
        let shapes = item
            .own()
            .or_note(shapes, Vec::new(), "the shape is left out");
        self.links[body].shapes.extend(shapes);
        Ok(())
    }

    /// Adds a body or a frame of a model in another file, or the whole content of its world, to the body `index`, in the frame of `<attach>`.
    ///
    /// # Errors
    /// If the model or the part does not exist, or a name is taken.
    fn attach(&mut self, attach: &Placed, index: usize) -> Result<()> {
        let element = attach.element;
        element.check_attributes("model body frame prefix")?;
        let Some(path) = attach.model.others.get(element.text("model")?) else {
            let known = attach.model.others.keys().map(String::as_str);
            return Err(element.unknown("model", "<model> of <asset>", known));
        };
        MODEL_DEPTH.check(attach.model.depth + 1, element)?;
        self.n_models += 1;
        MODELS.check(self.n_models, element)?;
        let text = file_text(path, element, element.lines)?;
        let source = Source::mjcf(&path.display().to_string(), &text)?;
        let document = source.document()?;
        let root = Element::root(&document, &source.lines);
        let model = Model::read(root, path, attach.model.depth + 1)?;
        let part = attach.attached(&model)?;
        let is_whole = part.element.tag() == "mujoco";
        let (first, ignored) = (self.origins.len(), self.ignored.clone());
        let added = match is_whole {
            true => self.add_world(&part, index),
            false => {
                let elements = self.expanded(part.clone());
                elements.and_then(|elements| self.add_all(elements, index))
            }
        };
        // Names and free joints depend on the place to which the part is attached.
        added.map_err(|fault| match attach.model.depth {
            0 => fault.under(format!("{}: ", element.place())),
            _ => fault,
        })?;
        self.couple(&part, first, !is_whole)?;
        self.ignored = ignored;
        // The attaching model names the joints as its own.
        let Naming { prefix, suffix } = &attach.naming;
        for (origin, joint) in self.origins[first..].iter_mut().zip(&self.joints[first..]) {
            let name = joint.name.strip_prefix(prefix).unwrap_or(&joint.name);
            origin.name = name.strip_suffix(suffix).unwrap_or(name).to_owned();
            origin.naming = attach.naming.clone();
        }
        let notes = source.lines.take_notes();
        notes.into_iter().for_each(|note| element.lines.note(note));
        Ok(())
    }

    /// Takes a name. A second element of a kind with an equal name is an error.
    fn take_name(&mut self, kind: &'static str, element: Element, name: &str) -> Result<()> {
        BODIES.check(self.links.len(), element)?;
        match self.names.insert((kind, name.to_owned()), element.line()) {
            None => Ok(()),
            Some(first) => {
                let given = format!("a second {kind} `{name}` (the first is on line {first})");
                Err(element.refuse(given, "a name of its own"))
            }
        }
    }

    /// Adds each site as a link that is fixed to its body. A site with the name of a body is called `NAME_site`.
    fn add_sites(&mut self, root: Element) -> Result<()> {
        let links = self.links.iter();
        let mut taken: HashSet<String> = links.map(|link| link.name.clone()).collect();
        for site in &self.sites {
            let mut name = site.name.clone();
            if taken.contains(&name) {
                let given = format!("site `{name}`, the name of a body");
                let same = Err(Error::input(&site.place, given, "a name of its own"));
                name += "_site";
                if taken.contains(&name) {
                    return same;
                }
                root.or_note(same, (), &format!("its link is called `{name}`"));
            }
            taken.insert(name.clone());
            let (body, link) = (site.body, self.links.len());
            let joint = Joint::fixed(&name, body, link, site.body_from_site);
            self.joints.push(joint);
            self.links.push(Link::new(&name));
        }
        Ok(())
    }
}
