//! Set cover: few sets that cover all rows, by a greedy choice and a local search with row weights \[RWLS\].
//!
//! Whenever all rows are covered, the search removes a set. Single exchanges follow until all rows are covered again. Each exchange removes the set whose loss
//! uncovers the least weight. Then the search adds the set of most weight that contains a randomly chosen
//! uncovered row. The weights of rows that stay uncovered increase, which lets the search leave local minima.

use rand::RngCore;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

/// Lists of numbers, stored one after another in one array.
pub(super) struct Lists {
    starts: Vec<usize>,
    items: Vec<u32>,
}

impl Lists {
    pub fn new() -> Self {
        Self {
            starts: vec![0],
            items: Vec::new(),
        }
    }

    pub fn push(&mut self, list: impl IntoIterator<Item = u32>) {
        self.items.extend(list);
        self.starts.push(self.items.len());
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn list(&self, list: usize) -> &[u32] {
        &self.items[self.starts[list]..self.starts[list + 1]]
    }

    /// Returns the transposed relation: for each of `n` numbers, the indices of the lists that contain it, ascending.
    pub fn transposed(&self, n: usize) -> Self {
        let mut starts = vec![0; n + 1];
        for &item in &self.items {
            starts[item as usize + 1] += 1;
        }
        for item in 0..n {
            starts[item + 1] += starts[item];
        }
        let mut next = starts.clone();
        let mut items = vec![0; self.items.len()];
        for list in 0..self.len() {
            for &item in self.list(list) {
                items[next[item as usize]] = list as u32;
                next[item as usize] += 1;
            }
        }
        Self { starts, items }
    }
}

/// Set of numbers from 0 to n − 1; every operation takes constant time.
struct Members {
    members: Vec<u32>,
    places: Vec<u32>,
}

const NOWHERE: u32 = u32::MAX;

impl Members {
    fn none_of(n: usize) -> Self {
        Self {
            members: Vec::new(),
            places: vec![NOWHERE; n],
        }
    }

    fn contains(&self, number: usize) -> bool {
        self.places[number] != NOWHERE
    }

    fn insert(&mut self, number: usize) {
        self.places[number] = self.members.len() as u32;
        self.members.push(number as u32);
    }

    fn remove(&mut self, number: usize) {
        let place = self.places[number] as usize;
        self.members.swap_remove(place);
        if let Some(&moved) = self.members.get(place) {
            self.places[moved as usize] = place as u32;
        }
        self.places[number] = NOWHERE;
    }
}

/// Partial set cover: the sets chosen so far, and the scores of all sets for the next exchange.
pub(super) struct Cover<'a> {
    rows_of: &'a Lists,
    sets_of: Lists,
    chosen: Members,
    uncovered: Members,
    /// Weight of each row (element to be covered).
    weights: Vec<i32>,
    /// Number of chosen sets that contain each row.
    counts: Vec<u32>,
    /// For each row, the exclusive or (XOR) of the indices of the chosen sets that contain the row. If only one chosen set contains the row, the value is the
    /// index of this set.
    holders: Vec<u32>,
    /// Score of each set for the next exchange. For a set that is not chosen: the weight of the rows that it would cover. For a chosen set: minus the weight
    /// of the rows that only this set covers.
    scores: Vec<i32>,
    /// Search step at which each set was last added or removed.
    moved_at: Vec<u32>,
}

/// Number of randomly drawn chosen sets among which the next set to remove is selected. If larger, the search is greedier and slower.
const TRIED: usize = 64;

impl<'a> Cover<'a> {
    /// Creates a set cover without chosen sets. `rows_of` lists the rows of each set; rows that no set contains are ignored.
    pub fn new(rows_of: &'a Lists, n_rows: usize) -> Self {
        let sets_of = rows_of.transposed(n_rows);
        let mut uncovered = Members::none_of(n_rows);
        for row in (0..n_rows).filter(|&row| !sets_of.list(row).is_empty()) {
            uncovered.insert(row);
        }
        let n_sets = rows_of.len();
        Self {
            scores: (0..n_sets).map(|s| rows_of.list(s).len() as i32).collect(),
            rows_of,
            sets_of,
            chosen: Members::none_of(n_sets),
            uncovered,
            weights: vec![1; n_rows],
            counts: vec![0; n_rows],
            holders: vec![0; n_rows],
            moved_at: vec![0; n_sets],
        }
    }

    /// Returns the chosen sets, in no particular order.
    pub fn chosen(&self) -> &[u32] {
        &self.chosen.members
    }

    /// Returns the chosen sets, ascending.
    pub fn sorted(self) -> Vec<usize> {
        let chosen = self.chosen.members.into_iter();
        let mut sets: Vec<usize> = chosen.map(|set| set as usize).collect();
        sets.sort_unstable();
        sets
    }

    /// Adds a set to the chosen sets.
    pub fn add(&mut self, set: usize) {
        self.chosen.insert(set);
        self.scores[set] = -self.scores[set];
        for &row in self.rows_of.list(set) {
            let row = row as usize;
            match self.counts[row] {
                0 => {
                    self.uncovered.remove(row);
                    self.raise_all_but(set, row, -self.weights[row]);
                }
                1 => self.scores[self.holders[row] as usize] += self.weights[row],
                _ => {}
            }
            self.counts[row] += 1;
            self.holders[row] ^= set as u32;
        }
    }

    fn remove(&mut self, set: usize) {
        self.chosen.remove(set);
        self.scores[set] = -self.scores[set];
        for &row in self.rows_of.list(set) {
            let row = row as usize;
            self.counts[row] -= 1;
            self.holders[row] ^= set as u32;
            match self.counts[row] {
                0 => {
                    self.uncovered.insert(row);
                    self.raise_all_but(set, row, self.weights[row]);
                }
                1 => self.scores[self.holders[row] as usize] -= self.weights[row],
                _ => {}
            }
        }
    }

    /// Adds `by` to the scores of all sets, except `set`, that contain a row.
    fn raise_all_but(&mut self, set: usize, row: usize, by: i32) {
        for &other in self.sets_of.list(row) {
            if other as usize != set {
                self.scores[other as usize] += by;
            }
        }
    }

    /// Completes the cover greedily. The function adds the set that covers the most weight until all rows are covered, and then removes redundant sets.
    pub fn complete(&mut self) {
        let candidates = (0..self.rows_of.len()).filter(|&set| !self.chosen.contains(set));
        let entry = |set: usize, score: i32| (score, Reverse(set));
        let mut heap: BinaryHeap<_> = candidates.map(|s| entry(s, self.scores[s])).collect();
        while !self.uncovered.members.is_empty() {
            let Some((score, Reverse(set))) = heap.pop() else {
                break;
            };
            // Scores only decrease, so a current score at the top is the highest.
            if self.scores[set] == score {
                self.add(set);
            } else {
                heap.push(entry(set, self.scores[set]));
            }
        }
        for set in self.chosen.members.clone() {
            if self.scores[set as usize] == 0 {
                self.remove(set as usize);
            }
        }
    }

    /// Searches for a cover with fewer sets in `n_steps` exchanges of sets. All rows must be covered before, and are covered afterwards.
    pub fn improve(&mut self, n_steps: usize, rng: &mut impl RngCore) {
        let mut best = self.chosen.members.clone();
        let mut just_added = None;
        for step in 1..=n_steps as u32 {
            while self.uncovered.members.is_empty() {
                best.clone_from(&self.chosen.members);
                let all = self.chosen.members.iter().copied();
                let Some(cheapest) = all.max_by_key(|&set| self.merit(set)) else {
                    return;
                };
                self.remove(cheapest as usize);
                self.moved_at[cheapest as usize] = step;
            }
            let Some(out) = self.cheapest_of_sample(just_added, rng) else {
                break;
            };
            self.remove(out as usize);
            self.moved_at[out as usize] = step;
            let row = self.uncovered.members[uniform_below(self.uncovered.members.len(), rng)];
            let holders = self.sets_of.list(row as usize).iter().copied();
            let others = holders.filter(|&set| set != out);
            let into = others.max_by_key(|&set| self.merit(set)).unwrap_or(out);
            self.add(into as usize);
            self.moved_at[into as usize] = step;
            just_added = Some(into);
            self.raise_uncovered();
        }
        if !self.uncovered.members.is_empty() {
            self.return_to(&best);
        }
    }

    /// Returns the sort key of a set: sets with the highest score come first, then sets that were moved least recently.
    fn merit(&self, set: u32) -> (i32, Reverse<u32>, u32) {
        let index = set as usize;
        (self.scores[index], Reverse(self.moved_at[index]), set)
    }

    fn cheapest_of_sample(&self, except: Option<u32>, rng: &mut impl RngCore) -> Option<u32> {
        let chosen = &self.chosen.members;
        let n = chosen.len();
        let tried = (0..TRIED.min(n)).map(|_| chosen[uniform_below(n, rng)]);
        tried
            .filter(|&set| Some(set) != except)
            .max_by_key(|&set| self.merit(set))
            .or_else(|| chosen.iter().copied().find(|&set| Some(set) != except))
    }

    fn raise_uncovered(&mut self) {
        for &row in &self.uncovered.members {
            self.weights[row as usize] += 1;
            for &set in self.sets_of.list(row as usize) {
                self.scores[set as usize] += 1;
            }
        }
    }

    fn return_to(&mut self, sets: &[u32]) {
        let kept: HashSet<u32> = sets.iter().copied().collect();
        for set in self.chosen.members.clone() {
            if !kept.contains(&set) {
                self.remove(set as usize);
            }
        }
        for &set in sets {
            if !self.chosen.contains(set as usize) {
                self.add(set as usize);
            }
        }
    }
}

/// Returns a random number below n, with a negligible bias.
fn uniform_below(n: usize, rng: &mut impl RngCore) -> usize {
    ((u64::from(rng.next_u32()) * n as u64) >> 32) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    /// Returns sets of random rows for tests; every row is in at least one set.
    fn random_sets(n_sets: usize, n_rows: usize, case: u64) -> Lists {
        let mut rng = Seed::new(case).named("sets").rng();
        let mut rows_of = Lists::new();
        for set in 0..n_sets {
            let has = |row: &usize| row % n_sets == set || rng.gen_bool(0.25);
            rows_of.push((0..n_rows).filter(has).map(|row| row as u32));
        }
        rows_of
    }

    fn covers(rows_of: &Lists, sets: &[u32], n_rows: usize) -> bool {
        let holds = |set: u32, row: u32| rows_of.list(set as usize).contains(&row);
        (0..n_rows as u32).all(|row| sets.iter().any(|&set| holds(set, row)))
    }

    #[test]
    fn the_search_finds_as_few_sets_as_trying_all_choices() {
        for case in 0..30 {
            let (n_sets, n_rows) = (10, 24);
            let rows_of = random_sets(n_sets, n_rows, case);
            let is_cover = |choice: &u32| {
                let sets = (0..n_sets as u32).filter(|set| choice >> set & 1 == 1);
                covers(&rows_of, &sets.collect::<Vec<_>>(), n_rows)
            };
            let choices = (0..1_u32 << n_sets).filter(is_cover);
            let fewest = choices.map(u32::count_ones).min();
            let mut cover = Cover::new(&rows_of, n_rows);
            cover.complete();
            assert!(covers(&rows_of, cover.chosen(), n_rows), "case {case}");
            cover.improve(2_000, &mut Seed::new(case).rng());
            assert!(covers(&rows_of, cover.chosen(), n_rows), "case {case}");
            assert_eq!(Some(cover.chosen().len() as u32), fewest, "case {case}");
        }
    }

    #[test]
    fn a_set_that_became_superfluous_is_dropped() {
        let mut rows_of = Lists::new();
        // The greedy choice takes the middle set first, then needs both end sets, which together cover the middle rows.
        rows_of.push([1, 2, 3, 4]);
        rows_of.push([0, 1, 2]);
        rows_of.push([3, 4, 5]);
        let mut cover = Cover::new(&rows_of, 6);
        cover.complete();
        assert_eq!(cover.sorted(), [1, 2]);
    }

    #[test]
    fn a_row_of_no_set_is_left_out() {
        let mut rows_of = Lists::new();
        rows_of.push([0, 2]);
        let mut cover = Cover::new(&rows_of, 3);
        cover.complete();
        assert_eq!(cover.chosen(), [0]);
    }
}
