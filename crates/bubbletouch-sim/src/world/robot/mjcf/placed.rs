//! Elements of a body in the frames of `<frame>`, `<replicate>` and `<attach>` around them.

use super::bodies::Bodies;
use super::classes::Item;
use super::limits::{CHILDREN, COPIES, DEPTH, MAX_COPIES_OF_ONE};
use super::model::Model;
use super::orientation::{from_euler, pose_of};
use crate::error::Result;
use crate::geometry::Pose;
use crate::text::xml::Element;
use glam::DVec3;

/// Names of the copies of elements: text before and after the name in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Naming {
    /// Text that `<attach>` puts before names.
    pub prefix: String,
    /// Text that `<replicate>` appends to names.
    pub suffix: String,
}

impl Naming {
    /// Returns the name of the copy of an element.
    pub fn full(&self, name: &str) -> String {
        format!("{}{name}{}", self.prefix, self.suffix)
    }
}

/// Element of a model, with the frame around it.
#[derive(Clone)]
pub(super) struct Placed<'a> {
    pub element: Element<'a>,
    /// Model of the element's file.
    pub model: &'a Model<'a>,
    /// Pose `body_from_frame` of the frames around the element.
    pub frame: Pose,
    /// Index of the default class of the element, unless the element names another.
    pub class: usize,
    pub naming: Naming,
    /// Number of elements around the element.
    pub depth: usize,
}

impl<'a> Placed<'a> {
    /// Places the root of a model in the world.
    pub fn root(model: &'a Model<'a>) -> Self {
        Self {
            element: model.root,
            model,
            frame: Pose::IDENTITY,
            class: 0,
            naming: Naming::default(),
            depth: 0,
        }
    }

    /// Returns the name of the element's copy; `None` if the element has no name.
    pub fn name(&self) -> Option<String> {
        let name = self.element.attribute("name")?;
        Some(self.naming.full(name))
    }

    /// Returns the element with its defaults.
    pub fn item(&self) -> Result<Item<'a>> {
        self.model.item(self.element, self.class)
    }

    /// Returns the pose in the attributes of an element of a kind that has no defaults: a body or a frame.
    pub fn own_pose(&self) -> Result<Pose> {
        pose_of(&self.model.item(self.element, 0)?)
    }

    /// Returns the element as the surroundings of its children, with another frame and the default class for them.
    pub fn around(&self, frame: Pose) -> Result<Self> {
        let class = self.model.classes.class_of(self.element, "childclass")?;
        Ok(Self {
            frame,
            class: class.unwrap_or(self.class),
            ..self.clone()
        })
    }

    /// Places a child element.
    fn child(&self, element: Element<'a>) -> Self {
        Self {
            element,
            depth: self.depth + 1,
            ..self.clone()
        }
    }

    /// Returns what this `<attach>` adds of a model, in the frame of `<attach>`: a body, a frame, or else the root of the model.
    ///
    /// # Errors
    /// If the model has no such part.
    pub fn attached<'m>(&self, model: &'m Model<'m>) -> Result<Placed<'m>> {
        let element = self.element;
        let (part, class) = match (element.attribute("body"), element.attribute("frame")) {
            (Some(_), Some(_)) => return Err(element.refuse("`body` and `frame`", "one of them")),
            (Some(name), None) => model.part(element, "body", name)?,
            (None, Some(name)) => model.part(element, "frame", name)?,
            (None, None) => (model.root, 0),
        };
        let prefix = element.attribute("prefix").unwrap_or_default();
        Ok(Placed {
            element: part,
            model,
            frame: self.frame,
            class,
            naming: Naming {
                prefix: self.naming.prefix.clone() + prefix,
                suffix: self.naming.suffix.clone(),
            },
            depth: self.depth,
        })
    }
}

impl Bodies {
    /// Returns the children of a body and of all frames and copies in the body.
    ///
    /// # Errors
    /// If a frame or a number of copies is invalid.
    pub fn children_of<'a>(&mut self, body: &Placed<'a>) -> Result<Vec<Placed<'a>>> {
        body.element.check_tags(
            "body joint freejoint geom site frame replicate inertial camera light attach composite flexcomp plugin",
        )?;
        DEPTH.check(body.depth, body.element)?;
        let mut all = Vec::new();
        for element in body.element.elements() {
            all.extend(self.expanded(body.child(element))?);
            CHILDREN.check(all.len(), body.element)?;
        }
        Ok(all)
    }

    /// Returns an element, or the elements inside it if it is a frame, a copy within the model, or contains copies.
    pub fn expanded<'a>(&mut self, child: Placed<'a>) -> Result<Vec<Placed<'a>>> {
        let element = child.element;
        match element.tag() {
            "attach" if element.attribute("model").is_none() => {
                element.check_attributes("body frame prefix")?;
                if element.attribute("body").is_some() == element.attribute("frame").is_some() {
                    let allowed = "the attribute `model`, or one of `body` and `frame`";
                    return Err(element.refuse("<attach> without `model`", allowed));
                }
                self.n_copies += 1;
                COPIES.check(self.n_copies, element)?;
                self.expanded(child.attached(child.model)?)
            }
            "frame" => {
                let frame = child.frame.compose(&child.own_pose()?);
                self.children_of(&child.around(frame)?)
            }
            "replicate" => {
                let mut all = Vec::new();
                for copy in self.copies(&child)? {
                    all.extend(self.children_of(&copy.around(copy.frame)?)?);
                }
                Ok(all)
            }
            _ => Ok(vec![child]),
        }
    }

    /// Returns the frames of the copies of `<replicate count euler offset sep>`. The i-th copy is rotated by i times the angles. Each copy is shifted from the
    /// preceding copy by the offset, in the frame of the preceding copy.
    fn copies<'a>(&mut self, replicate: &Placed<'a>) -> Result<Vec<Placed<'a>>> {
        let element = replicate.element;
        let count = element.needed_integer("count", 0, MAX_COPIES_OF_ONE)?;
        self.n_copies += count;
        COPIES.check(self.n_copies, element)?;
        let euler = element.numbers::<3>("euler")?.unwrap_or([0.0; 3]);
        let offset = element.vector("offset", DVec3::ZERO)?;
        let separator = element.attribute("sep").unwrap_or_default();
        let n_digits = count.to_string().len();
        let mut position = DVec3::ZERO;
        let copies = (0..count).map(|index| {
            let angles = euler.map(|angle| index as f64 * angle);
            let rotation = from_euler(angles, &replicate.model.compiler);
            let frame = replicate.frame.compose(&Pose::new(rotation, position));
            position += rotation * offset;
            let number = format!("{separator}{index:0n_digits$}");
            let mut copy = replicate.clone();
            copy.frame = frame;
            copy.naming.suffix.insert_str(0, &number);
            copy
        });
        Ok(copies.collect())
    }
}
