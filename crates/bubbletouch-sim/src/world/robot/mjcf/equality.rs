//! Constraints `<equality><joint>`: a joint that follows another joint.

use crate::error::Result;
use crate::text::spelling::nearest_names;
use crate::world::robot::xml::Element;
use crate::world::robot::{Joint, Mimic};
use roxmltree::Node;
use std::collections::HashMap;

/// Consequence of a constraint that a mimicking joint cannot represent, in the words of a note.
const INDEPENDENT: &str = "the joint has a position of its own";

/// Makes mimicking joints of the active constraints between two hinges or slides. MuJoCo's constraint is `q₁ − r₁ = a₀ + a₁ (q₂ − r₂)`, with the reference
/// positions r. Constraints of a higher degree or without a second joint become notes. `is_part` states that the joints are a part of the model; constraints of
/// other joints are then ignored.
///
/// # Errors
/// If a constraint names a joint that does not exist, or an attribute is invalid.
pub(super) fn read_equalities(root: Element, joints: &mut [Joint], is_part: bool) -> Result<()> {
    let equalities = root.children("equality");
    for element in equalities.flat_map(|equality| equality.children("joint")) {
        if element.node.attribute("active") == Some("false") {
            continue;
        }
        let named = ["joint1", "joint2"].map(|key| element.node.attribute(key));
        let is_here = |name: &str| joints.iter().any(|joint| joint.name == name);
        if is_part && !named.into_iter().flatten().all(is_here) {
            continue;
        }
        let follower = index_of(element, "joint1", joints)?;
        let followed = match element.node.attribute("joint2") {
            Some(_) => Some(index_of(element, "joint2", joints)?),
            None => None,
        };
        let mimic = mimic(element, follower, followed, joints);
        if let Some(mimic) = element.or_note(mimic.map(Some), None, INDEPENDENT) {
            joints[follower].mimic = Some(mimic);
        }
    }
    Ok(())
}

fn mimic(
    element: Element,
    follower: usize,
    followed: Option<usize>,
    joints: &[Joint],
) -> Result<Mimic> {
    let numbers = element.up_to(5, "polycoef")?;
    let mut polynomial = [0.0, 1.0, 0.0, 0.0, 0.0];
    polynomial[..numbers.len()].copy_from_slice(&numbers);
    let [constant, factor, higher @ ..] = polynomial;
    let name = &joints[follower].name;
    let refuse = |given: &str, allowed: &str| {
        let given = format!("joint `{name}` in <equality> {given}");
        Err(element.refuse(given, allowed))
    };
    let Some(joint) = followed else {
        return refuse("without `joint2`", "two joints");
    };
    if higher != [0.0; 3] {
        return refuse("with a polynomial of degree 2 or more", "a linear relation");
    }
    let is_one = |joint: usize| joints[joint].kind.has_one_coordinate();
    if !is_one(follower) || !is_one(joint) {
        return refuse("with a ball or free joint", "two hinges or slides");
    }
    if joints[follower].mimic.is_some() {
        return refuse("a second time", "one constraint for each joint");
    }
    let mut end = Some(joint);
    while let Some(index) = end {
        if index == follower {
            return refuse("in a circle", "a chain that ends in a joint of its own");
        }
        end = joints[index].mimic.map(|mimic| mimic.joint);
    }
    Ok(Mimic {
        joint,
        multiplier: factor,
        offset: joints[follower].reference + constant - factor * joints[joint].reference,
    })
}

fn index_of(element: Element, attribute: &str, joints: &[Joint]) -> Result<usize> {
    let name = element.text(attribute)?;
    let found = joints.iter().position(|joint| joint.name == name);
    found.ok_or_else(|| {
        let names = joints.iter().map(|joint| joint.name.as_str());
        let given = format!("`{attribute}` \"{name}\", which is no joint");
        element.refuse(given, nearest_names(name, names))
    })
}

/// Couples the copies of joints that `<attach>` makes within a model as their originals are coupled, if both joints are copied. `elements` contains the XML
/// element of each joint; a copy has the element of its original.
pub(super) fn copy_equalities(root: Element, joints: &mut [Joint], elements: &[Element]) {
    let all = root.node.descendants();
    let is_copy =
        |node: &Node| node.tag_name().name() == "attach" && node.attribute("model").is_none();
    let prefixes: Vec<&str> = all
        .filter(is_copy)
        .filter_map(|node| node.attribute("prefix"))
        .collect();
    let names = joints.iter().map(|joint| joint.name.clone());
    let at: HashMap<String, usize> = names.zip(0..).collect();
    let coupled: Vec<(usize, Mimic)> = joints
        .iter()
        .enumerate()
        .filter_map(|(number, joint)| Some((number, joint.mimic?)))
        .collect();
    for prefix in prefixes {
        for copy in 0..joints.len() {
            let of_copy = |(original, _): &&(usize, Mimic)| {
                *original != copy && elements[*original].node == elements[copy].node
            };
            let Some((original, mimic)) = coupled.iter().find(of_copy) else {
                continue;
            };
            let suffix = joints[copy].name.strip_prefix(prefix);
            let suffix = suffix.and_then(|name| name.strip_prefix(&*joints[*original].name));
            let followed = suffix.and_then(|suffix| {
                let followed = &joints[mimic.joint].name;
                at.get(&format!("{prefix}{followed}{suffix}"))
            });
            if let Some(joint) = followed.copied() {
                joints[copy].mimic.get_or_insert(Mimic { joint, ..*mimic });
            }
        }
    }
}
