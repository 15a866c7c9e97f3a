//! Disjoint sets of numbers (union-find with path halving).

use std::collections::BTreeMap;

/// Sets of the numbers from 0, each of which is in one set. The root of a set is one of its numbers.
#[derive(Clone, Debug)]
pub struct DisjointSets(Vec<usize>);

impl DisjointSets {
    /// Creates `n` sets of one number each.
    pub fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    /// Returns the root of the set that contains a number.
    pub fn root(&mut self, mut number: usize) -> usize {
        while self.0[number] != number {
            self.0[number] = self.0[self.0[number]];
            number = self.0[number];
        }
        number
    }

    /// Joins the sets of two numbers; the smaller root remains. A set that is only joined by this function has its smallest number as its root.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.put_below(a.min(b), a.max(b));
    }

    /// Joins the sets of two roots; the root `kept` remains.
    pub fn put_below(&mut self, kept: usize, other: usize) {
        self.0[other] = kept;
    }

    /// Returns the numbers of each set, ascending, and the index of the set of each number. The sets are in the order of their smallest numbers.
    pub fn groups(mut self) -> (Vec<Vec<usize>>, Vec<usize>) {
        let (mut groups, mut group_of_root) = (Vec::new(), BTreeMap::new());
        let mut group_of = Vec::with_capacity(self.0.len());
        for number in 0..self.0.len() {
            let group = *group_of_root
                .entry(self.root(number))
                .or_insert(groups.len());
            if group == groups.len() {
                groups.push(Vec::new());
            }
            groups[group].push(number);
            group_of.push(group);
        }
        (groups, group_of)
    }

    /// Returns the root of each number.
    pub fn roots(mut self) -> Vec<usize> {
        (0..self.0.len()).map(|number| self.root(number)).collect()
    }
}
