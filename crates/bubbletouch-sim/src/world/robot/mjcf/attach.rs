//! Models in other files that `<attach>` adds to a body: `<asset><model name file/></asset>` and `<attach model body prefix/>` or `<attach model frame prefix/>`.

use super::equality::{copy_equalities, read_equalities};
use super::frames::Placed;
use super::model::Parts;
use super::source::Source;
use super::submodels::SubModels;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::text::encoding::decoded;
use crate::text::spelling::nearest_names;
use crate::world::robot::text::{parsed, unreadable};
use crate::world::robot::xml::Element;
use crate::world::robot::{Joint, JointKind, Link, LinkGeometry};
use std::path::Path;

/// Maximum nesting depth of attached models. A file that attaches itself exceeds this depth.
const MAX_DEPTH: usize = 20;
/// Largest number of models that are attached to a model and to each other. With a larger value, a few small files can take minutes.
const MAX_MODELS: usize = 1_000;

/// Bodies of a model that is attached, with the indices that they have in that model. The first body is the world.
struct Attached {
    links: Vec<Link>,
    body_poses: Vec<Pose>,
    joints: Vec<Joint>,
    sites: Vec<(String, usize, Pose)>,
}

impl<'a> Parts<'a> {
    /// Adds a body of another model, or the whole content of its world, to the body `index`, in the frame of `<attach>`.
    ///
    /// # Errors
    /// If the model or the body does not exist, or a name is taken.
    pub fn attach(&mut self, attach: &Placed<'a>, index: usize) -> Result<()> {
        let element = attach.element;
        element.check_attributes(&["model", "body", "frame", "prefix"])?;
        let name = element.text("model")?;
        let Some(path) = self.models.paths.get(name).cloned() else {
            let known = self.models.paths.keys().map(String::as_str);
            let given = format!("`model` \"{name}\", which is no <model> of <asset>");
            return Err(element.refuse(given, nearest_names(name, known)));
        };
        if self.models.depth > MAX_DEPTH {
            let given = format!("models that attach each other, {MAX_DEPTH} deep");
            return Err(element.refuse(given, "a file that does not attach itself"));
        }
        self.models.n_read.set(self.models.n_read.get() + 1);
        if self.models.n_read.get() > MAX_MODELS {
            let given = format!("more than {MAX_MODELS} attached models");
            return Err(element.refuse(given, "fewer"));
        }
        let (body, frame) = (
            element.node.attribute("body"),
            element.node.attribute("frame"),
        );
        if body.is_some() && frame.is_some() {
            return Err(element.refuse("`body` and `frame`", "one of them"));
        }
        let mut other = read_model((element, frame), &path, &self.models)?;
        let start = match body {
            None => 0,
            Some(body) => {
                let mut names = other.links.iter().map(|link| link.name.as_str());
                names.clone().position(|name| name == body).ok_or_else(|| {
                    let given =
                        format!("`body` \"{body}\", which is no body of the model `{name}`");
                    element.refuse(given, nearest_names(body, names.by_ref()))
                })?
            }
        };
        let prefix = element.node.attribute("prefix").unwrap_or_default();
        let renamed = |name: &str| format!("{}{prefix}{name}{}", attach.prefix, attach.suffix);
        // Index of each body in this model; `None` for bodies that are not attached.
        let mut at: Vec<Option<usize>> = vec![None; other.links.len()];
        if start == 0 {
            at[0] = Some(index);
            for shape in std::mem::take(&mut other.links[0].shapes) {
                let origin = attach.frame.compose(&shape.origin);
                let shape = crate::world::robot::LinkShape { origin, ..shape };
                self.links[index].shapes.push(shape);
            }
        }
        // Joint of each body to its parent; further joints of the body have the body itself as their parent.
        let parent_of = |body: usize| {
            let moving = other
                .joints
                .iter()
                .find(|joint| joint.child == body && joint.parent != body);
            moving.map_or(0, |joint| joint.parent)
        };
        let parents: Vec<usize> = (0..other.links.len()).map(parent_of).collect();
        for (body, link) in other.links.into_iter().enumerate().skip(1) {
            let is_first = body == start || (start == 0 && parents[body] == 0);
            if !is_first && (parents[body] == 0 || at[parents[body]].is_none()) {
                continue;
            }
            at[body] = Some(self.links.len());
            let name = self.taken_name("body", element, renamed(&link.name))?;
            self.links.push(Link { name, ..link });
            let pose = other.body_poses[body];
            self.body_poses.push(match is_first {
                true => attach.frame.compose(&pose),
                false => pose,
            });
        }
        let mut joint_at: Vec<Option<usize>> = vec![None; other.joints.len()];
        for (number, joint) in other.joints.iter().enumerate() {
            let Some(child) = at[joint.child] else {
                continue;
            };
            joint_at[number] = Some(self.joints.len());
            let is_first = joint.parent != joint.child
                && (joint.child == start || (start == 0 && joint.parent == 0));
            let is_free = joint.kind == JointKind::Floating;
            if is_free && is_first && index != 0 {
                let given = format!("the free joint `{}`", joint.name);
                return Err(element.refuse(given, "a free joint of a body in <worldbody>"));
            }
            let name = self.taken_name("joint", element, renamed(&joint.name))?;
            self.joints.push(Joint {
                name,
                parent: if is_first {
                    index
                } else {
                    at[joint.parent].unwrap_or(index)
                },
                child,
                origin: match is_first && !is_free {
                    true => attach.frame.compose(&joint.origin),
                    false => joint.origin,
                },
                ..joint.clone()
            });
            self.elements.push(element);
        }
        for (old, new) in joint_at.iter().enumerate() {
            let Some(new) = *new else { continue };
            self.joints[new].mimic = other.joints[old].mimic.and_then(|mimic| {
                let joint = joint_at[mimic.joint]?;
                Some(crate::world::robot::Mimic { joint, ..mimic })
            });
        }
        for (name, body, pose) in other.sites {
            if let Some(body_index) = at[body] {
                let pose = match body == 0 {
                    true => attach.frame.compose(&pose),
                    false => pose,
                };
                let name = self.taken_name("site", element, renamed(&name))?;
                self.add_attached_site(element, name, (body_index, pose));
            }
        }
        Ok(())
    }
}

/// Reads the bodies of a model, or of a frame of the model. Notes on the file are added to the notes of the attaching model.
fn read_model(
    (element, frame): (Element, Option<&str>),
    path: &Path,
    around: &SubModels,
) -> Result<Attached> {
    let place = path.display().to_string();
    let bytes = crate::files::read(path).map_err(|error| {
        let given = format!("{place}: cannot be read ({error})");
        element.refuse(given, "an MJCF file")
    })?;
    let (text, note) = decoded(&place, &bytes);
    let source = Source::new(&place, &text)?;
    let (links, body_poses, joints, sites) = {
        let document =
            parsed(&source.text).map_err(|e| unreadable(&place, &source.text, &e, "MJCF"))?;
        let root = Element {
            node: document.root_element(),
            lines: &source.lines,
        };
        let mut parts = Parts::read(root, &place, (around, frame))?;
        read_equalities(root, &mut parts.joints, frame.is_some())?;
        copy_equalities(root, &mut parts.joints, &parts.elements);
        let sites = parts.named_sites();
        (parts.links, parts.body_poses, parts.joints, sites)
    };
    for note in note.into_iter().chain(source.lines.into_notes()) {
        element.lines.note(note);
    }
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    Ok(Attached {
        links: links
            .into_iter()
            .map(|link| with_absolute_meshes(link, &folder))
            .collect::<Result<_>>()?,
        body_poses,
        joints,
        sites,
    })
}

/// Returns the link with absolute names of its mesh files, which are relative to the folder of another model.
fn with_absolute_meshes(mut link: Link, folder: &Path) -> Result<Link> {
    for shape in &mut link.shapes {
        if let LinkGeometry::Mesh { file, .. } = &mut shape.geometry
            && !file.contains("://")
        {
            let path = folder.join(&*file);
            let absolute =
                std::path::absolute(&path).map_err(|error| Error::io(&path, "find", error))?;
            *file = absolute.display().to_string();
        }
    }
    Ok(link)
}
