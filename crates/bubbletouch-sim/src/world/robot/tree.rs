//! Tree of links and joints: one root, and exactly one joint that moves each other link.

use super::xml::Element;
use super::{Joint, Link};
use crate::error::{Error, Result};

/// Root of a robot's tree, and the joints ordered from the root outwards.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    /// Index of the link that no joint moves.
    pub root: usize,
    /// Indices of all joints, each after the joint that moves its parent link.
    pub outward: Vec<usize>,
}

impl Tree {
    /// Checks that the joints connect the links to one tree. `elements` (one per joint) give the location in error messages.
    pub fn new(links: &[Link], joints: &[Joint], elements: &[Element]) -> Result<Self> {
        let moved_by = moved_by(links, joints, elements)?;
        let is_root = |link: &usize| moved_by[*link].is_none();
        let roots: Vec<usize> = (0..links.len()).filter(is_root).collect();
        let Some(&root) = roots.first() else {
            return Err(circle(0, links, joints, &moved_by, elements));
        };
        let outward = outward(root, links.len(), joints);
        let mut is_reached = vec![false; links.len()];
        is_reached[root] = true;
        for &joint in &outward {
            is_reached[joints[joint].child] = true;
        }
        match is_reached.iter().position(|reached| !reached) {
            // No link in this chain can be reached from the root, so the chain is a cycle.
            Some(link) => Err(circle(link, links, joints, &moved_by, elements)),
            None => Ok(Self { root, outward }),
        }
    }
}

/// Returns the index of the joint that moves each link, if any. Returns an error if two joints move one link.
fn moved_by(links: &[Link], joints: &[Joint], elements: &[Element]) -> Result<Vec<Option<usize>>> {
    let mut moved_by: Vec<Option<usize>> = vec![None; links.len()];
    for (index, joint) in joints.iter().enumerate() {
        if let Some(first) = moved_by[joint.child].replace(index) {
            let (link, first) = (&links[joint.child].name, &joints[first].name);
            return Err(elements[index].refuse(
                format!(
                    "link `{link}` is the child of `{first}` and of `{}`",
                    joint.name
                ),
                "one joint that moves a link: a tree",
            ));
        }
    }
    Ok(moved_by)
}

/// Returns the indices of the joints reached from the root, parents first; joints of one link keep the order of the file.
fn outward(root: usize, n_links: usize, joints: &[Joint]) -> Vec<usize> {
    let mut carried: Vec<Vec<usize>> = vec![Vec::new(); n_links];
    for (index, joint) in joints.iter().enumerate() {
        carried[joint.parent].push(index);
    }
    let mut order: Vec<usize> = carried[root].clone();
    let mut next = 0;
    while let Some(&joint) = order.get(next) {
        order.extend_from_slice(&carried[joints[joint].child]);
        next += 1;
    }
    order
}

/// Returns the error for a cycle of links, found from a link that leads into the cycle.
fn circle(
    start: usize,
    links: &[Link],
    joints: &[Joint],
    moved_by: &[Option<usize>],
    elements: &[Element],
) -> Error {
    let inward = |link: usize| moved_by[link].map_or(link, |joint| joints[joint].parent);
    // After as many steps as there are links, the search is inside the cycle.
    let inside = (0..links.len()).fold(start, |link, _| inward(link));
    let mut round = vec![inside];
    while inward(round[round.len() - 1]) != inside {
        round.push(inward(round[round.len() - 1]));
    }
    round.push(inside);
    let names: Vec<String> = round
        .iter()
        .rev()
        .map(|&link| format!("`{}`", links[link].name))
        .collect();
    let joint = moved_by[inside].unwrap_or(0);
    elements[joint].refuse(
        format!("links in a circle: {}", names.join(" → ")),
        "a tree: no link carries itself",
    )
}
