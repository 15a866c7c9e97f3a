//! Constraints `<equality><joint>`: a joint that follows another joint.

use super::bodies::Bodies;
use super::placed::Placed;
use crate::error::Result;
use crate::text::xml::Element;
use crate::world::robot::Mimic;
use std::collections::HashMap;

/// Consequence of a constraint that a mimicking joint cannot represent, in the words of a note.
const INDEPENDENT: &str = "the joint has a position of its own";

impl Bodies {
    /// Makes mimicking joints of the active constraints of a model between two hinges or slides. `part` is the model's root, or the attached part of it, and
    /// `first` the index of its first joint. MuJoCo's constraint is `q₁ − r₁ = a₀ + a₁ (q₂ − r₂)`, with the reference positions r. Constraints of a higher
    /// degree or without a second joint become notes. If `is_part`, constraints of other joints are ignored.
    ///
    /// Copies of joints are coupled as their originals, if both joints are copied.
    ///
    /// # Errors
    /// If a constraint names a joint that does not exist, or an attribute is invalid.
    pub fn couple(&mut self, part: &Placed, first: usize, is_part: bool) -> Result<()> {
        let joints = self.joints[first..self.origins.len()].iter();
        let at: HashMap<String, usize> = joints.map(|it| it.name.clone()).zip(first..).collect();
        let sections = part.model.root.children("equality");
        for element in sections.flat_map(|section| section.children("joint")) {
            if element.attribute("active") == Some("false") {
                continue;
            }
            let unknown = |bodies: &Self, attribute: &str| {
                let own = bodies.origins[first..].iter();
                let own = own.filter(|origin| origin.naming == part.naming);
                element.unknown(attribute, "joint", own.map(|origin| &*origin.name))
            };
            let name = element.text("joint1")?;
            let followers = (first..self.origins.len()).filter(|&k| self.origins[k].name == name);
            let followers: Vec<usize> = followers.collect();
            if followers.is_empty() && !is_part {
                return Err(unknown(self, "joint1"));
            }
            for follower in followers {
                let naming = self.origins[follower].naming.clone();
                let is_copy = naming != part.naming;
                let followed = element.attribute("joint2").map(|name| naming.full(name));
                let joint = followed.as_ref().and_then(|name| at.get(name)).copied();
                if followed.is_some() && joint.is_none() {
                    match is_part || is_copy {
                        true => continue,
                        false => return Err(unknown(self, "joint2")),
                    }
                }
                match self.mimic(element, follower, joint) {
                    Ok(mimic) => self.joints[follower].mimic = Some(mimic),
                    Err(_) if is_copy => {}
                    Err(fault) => element.or_note(Err(fault), (), INDEPENDENT),
                }
            }
        }
        Ok(())
    }

    fn mimic(&self, element: Element, follower: usize, followed: Option<usize>) -> Result<Mimic> {
        let joints = &self.joints;
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
}
