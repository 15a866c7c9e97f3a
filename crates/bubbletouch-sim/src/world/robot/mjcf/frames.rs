//! Children of a body, in the frames of `<frame>` and `<replicate>`.

use super::classes::Classes;
use super::compiler::Compiler;
use super::orientation::{from_euler, pose_of};
use crate::error::Result;
use crate::geometry::Pose;
use crate::text::spelling::nearest_names;
use crate::world::robot::xml::Element;
use glam::DVec3;
use roxmltree::Node;
use std::cell::Cell;

/// Largest number of copies of one `<replicate>`. A larger number indicates a mistake in the file.
const MAX_COPIES: f64 = 10_000.0;
/// Largest number of copies of all `<replicate>`s together, which can be inside each other. With a larger value, a small file can take minutes.
const MAX_ALL_COPIES: usize = 100_000;
/// Largest number of children of one body. With a larger value, a small file can fill the memory.
const MAX_CHILDREN: usize = 1_000_000;
/// Largest depth of elements inside each other, as in MuJoCo's XML reader. With a larger value, the stack can overflow.
const MAX_DEPTH: usize = 500;

/// Child element of a body, with the frame around it.
#[derive(Clone)]
pub(super) struct Placed<'a> {
    /// The element, which is neither `<frame>` nor `<replicate>`.
    pub element: Element<'a>,
    /// Pose `body_from_frame` of the frames around the element.
    pub frame: Pose,
    /// Index of the default class of the element, unless the element names another.
    pub class: usize,
    /// Text before the names of elements that `<attach>` copies within the model.
    pub prefix: String,
    /// Text that `<replicate>` appends to the names of its copies.
    pub suffix: String,
    /// Number of elements around the element.
    pub depth: usize,
}

impl<'a> Placed<'a> {
    /// Creates an element in the frame of the body around it.
    pub fn new(element: Element<'a>) -> Self {
        Self {
            element,
            frame: Pose::IDENTITY,
            class: 0,
            prefix: String::new(),
            suffix: String::new(),
            depth: 0,
        }
    }

    /// Returns the tag of the element.
    pub fn tag(&self) -> &'a str {
        self.element.node.tag_name().name()
    }

    /// Returns the name of the element with the prefix and the suffix of its copy; `None` if the element has no name.
    pub fn name(&self) -> Option<String> {
        let name = self.element.node.attribute("name")?;
        Some(format!("{}{name}{}", self.prefix, self.suffix))
    }
}

/// Returns the children of a body and of all frames and copies in the body. `n_copies` counts the copies of the model.
///
/// # Errors
/// If a frame or a number of copies is invalid.
pub(super) fn children_of<'a>(
    body: &Placed<'a>,
    classes: &Classes<'a>,
    compiler: &Compiler,
    n_copies: &Cell<usize>,
) -> Result<Vec<Placed<'a>>> {
    body.element.check_tags(&[
        "body",
        "joint",
        "freejoint",
        "geom",
        "site",
        "frame",
        "replicate",
        "inertial",
        "camera",
        "light",
        "attach",
        "composite",
        "flexcomp",
        "plugin",
    ])?;
    if body.depth > MAX_DEPTH {
        let given = format!("elements inside each other, {MAX_DEPTH} deep");
        return Err(body.element.refuse(given, "a flatter model"));
    }
    let mut all = Vec::new();
    let children = body
        .element
        .node
        .children()
        .filter(|node| node.is_element());
    for node in children {
        let child = Placed {
            element: Element {
                node,
                ..body.element
            },
            depth: body.depth + 1,
            ..body.clone()
        };
        let child = match (child.tag(), node.attribute("model")) {
            ("attach", None) => copied_within_model(&child, classes, n_copies)?,
            _ => child,
        };
        match child.tag() {
            "frame" => {
                let class = classes.class_of(child.element, "childclass")?;
                let item = classes.item(child.element, 0)?;
                let inner = Placed {
                    frame: child.frame.compose(&pose_of(&item, compiler)?),
                    class: class.unwrap_or(child.class),
                    ..child
                };
                all.extend(children_of(&inner, classes, compiler, n_copies)?);
            }
            "replicate" => {
                let class = classes.class_of(child.element, "childclass")?;
                for copy in copies(&child, compiler, n_copies)? {
                    let inner = Placed {
                        class: class.unwrap_or(child.class),
                        ..copy
                    };
                    all.extend(children_of(&inner, classes, compiler, n_copies)?);
                }
            }
            _ => all.push(child),
        }
        if all.len() > MAX_CHILDREN {
            let given = format!("{} with too many children", body.element.called());
            return Err(body
                .element
                .refuse(given, format!("at most {MAX_CHILDREN}")));
        }
    }
    Ok(all)
}

/// Returns the body or the frame of the same model that `<attach body prefix/>` or `<attach frame prefix/>` copies, in the frame of `<attach>`.
fn copied_within_model<'a>(
    attach: &Placed<'a>,
    classes: &Classes<'a>,
    n_copies: &Cell<usize>,
) -> Result<Placed<'a>> {
    let element = attach.element;
    element.check_attributes(&["body", "frame", "prefix"])?;
    let (tag, name) = match (
        element.node.attribute("body"),
        element.node.attribute("frame"),
    ) {
        (Some(name), None) => ("body", name),
        (None, Some(name)) => ("frame", name),
        _ => {
            let allowed = "the attribute `model`, or one of `body` and `frame`";
            return Err(element.refuse("<attach> without `model`", allowed));
        }
    };
    n_copies.set(n_copies.get() + 1);
    if n_copies.get() > MAX_ALL_COPIES {
        let allowed = format!("at most {MAX_ALL_COPIES} copies in a model");
        return Err(element.refuse("too many copies of all <attach>", allowed));
    }
    let (copied, class) = named_part(element, classes, (tag, name))?;
    Ok(Placed {
        element: copied,
        class,
        prefix: attach.prefix.clone() + element.node.attribute("prefix").unwrap_or_default(),
        ..attach.clone()
    })
}

/// Returns the `<body>` or `<frame>` with a name in the model of `element`, and the index of its default class.
///
/// # Errors
/// If there is no such part; the error has the line of `element`.
pub(super) fn named_part<'a>(
    element: Element<'a>,
    classes: &Classes<'a>,
    (tag, name): (&str, &str),
) -> Result<(Element<'a>, usize)> {
    let all = element.node.document().root_element().descendants();
    let all: Vec<Node> = all.filter(|node| node.tag_name().name() == tag).collect();
    let is_it = |node: &&Node| node.attribute("name") == Some(name);
    let Some(node) = all.iter().find(is_it).copied() else {
        let known = all.iter().filter_map(|node| node.attribute("name"));
        let given = format!("`{tag}` \"{name}\", which is no {tag} of the model");
        return Err(element.refuse(given, nearest_names(name, known)));
    };
    let mut around = node.ancestors().skip(1).filter(|node| node.is_element());
    let class = around.try_fold(None, |class: Option<usize>, node| match class {
        Some(class) => Ok(Some(class)),
        None => classes.class_of(Element { node, ..element }, "childclass"),
    })?;
    Ok((Element { node, ..element }, class.unwrap_or(0)))
}

/// Returns the frames of the copies of `<replicate count euler offset sep>`. The i-th copy is rotated by i times the angles. Each copy is shifted from the
/// preceding copy by the offset, in the frame of the preceding copy.
fn copies<'a>(
    replicate: &Placed<'a>,
    compiler: &Compiler,
    n_copies: &Cell<usize>,
) -> Result<Vec<Placed<'a>>> {
    let element = replicate.element;
    let [count] = element.needed_numbers::<1>("count")?;
    if !(0.0..=MAX_COPIES).contains(&count) || count.fract() != 0.0 {
        let allowed = format!("an integer from 0 to {MAX_COPIES}");
        return Err(element.refuse(format!("`count` {count}"), allowed));
    }
    n_copies.set(n_copies.get() + count as usize);
    if n_copies.get() > MAX_ALL_COPIES {
        let allowed = format!("at most {MAX_ALL_COPIES} copies in a model");
        return Err(element.refuse("too many copies of all <replicate>", allowed));
    }
    let euler = element.numbers::<3>("euler")?.unwrap_or([0.0; 3]);
    let offset = DVec3::from(element.numbers::<3>("offset")?.unwrap_or([0.0; 3]));
    let separator = element.node.attribute("sep").unwrap_or_default();
    let n_digits = count.to_string().len();
    let mut position = DVec3::ZERO;
    let copies = (0..count as usize).map(|index| {
        let rotation = from_euler(euler.map(|angle| index as f64 * angle), compiler);
        let copy = Pose::new(rotation, position);
        position += rotation * offset;
        Placed {
            frame: replicate.frame.compose(&copy),
            suffix: format!("{separator}{index:0n_digits$}{}", replicate.suffix),
            ..replicate.clone()
        }
    });
    Ok(copies.collect())
}
