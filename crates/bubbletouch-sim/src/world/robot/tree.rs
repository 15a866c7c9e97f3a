//! Tree of links and joints: one root, and exactly one joint that moves each other link.

use super::{Joint, Link};
use crate::error::{Error, Result};
use std::collections::HashSet;

/// Root of a robot's tree, and the joints ordered from the root outwards.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    /// Index of the link that no joint moves.
    pub root: usize,
    /// Indices of all joints, each after the joint that moves its parent link.
    pub outward: Vec<usize>,
}

impl Tree {
    /// Checks that the joints connect the links, at least one, to one tree. `place` returns the location of a joint for messages.
    pub fn new(links: &[Link], joints: &[Joint], place: impl Fn(usize) -> String) -> Result<Self> {
        let mut moved_by: Vec<Option<usize>> = vec![None; links.len()];
        let mut carried: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
        for (index, joint) in joints.iter().enumerate() {
            carried[joint.parent].push(index);
            if let Some(first) = moved_by[joint.child].replace(index) {
                let (link, first) = (&links[joint.child].name, &joints[first].name);
                let second = &joint.name;
                let given = format!("link `{link}` is the child of `{first}` and of `{second}`");
                let allowed = "one joint that moves a link: a tree";
                return Err(Error::input(place(index), given, allowed));
            }
        }
        let root = moved_by.iter().position(Option::is_none);
        let mut outward = root.map_or(Vec::new(), |root| carried[root].clone());
        let mut next = 0;
        while let Some(&joint) = outward.get(next) {
            outward.extend_from_slice(&carried[joints[joint].child]);
            next += 1;
        }
        let children = outward.iter().map(|&joint| joints[joint].child);
        let reached: HashSet<usize> = children.chain(root).collect();
        let Some(lost) = (0..links.len()).find(|link| !reached.contains(link)) else {
            let root = root.expect("a link that is reached");
            return Ok(Self { root, outward });
        };
        // No joint from the root leads to this link, so the joints towards it form a cycle.
        let joint_to = |link: usize| moved_by[link].expect("a joint moves each link of a cycle");
        let mut round = cycle(lost, |link| joints[joint_to(link)].parent);
        round.reverse();
        let names = chain_words(&round, |link| &links[link].name);
        let given = format!("links in a circle: {names}");
        let place = place(joint_to(round[0]));
        Err(Error::input(place, given, "a tree: no link carries itself"))
    }
}

/// Returns the cycle that a walk from `start` enters: its first node, the nodes after it, and its first node again.
pub(super) fn cycle(start: usize, next: impl Fn(usize) -> usize) -> Vec<usize> {
    let (mut path, mut node) = (Vec::new(), start);
    let mut seen = HashSet::new();
    while seen.insert(node) {
        path.push(node);
        node = next(node);
    }
    path.push(node);
    path.into_iter()
        .skip_while(|&other| other != node)
        .collect()
}

/// Returns the names of the nodes of a chain, for messages.
pub(super) fn chain_words<'n>(chain: &[usize], name: impl Fn(usize) -> &'n String) -> String {
    let names: Vec<String> = chain.iter().map(|&k| format!("`{}`", name(k))).collect();
    names.join(" → ")
}
