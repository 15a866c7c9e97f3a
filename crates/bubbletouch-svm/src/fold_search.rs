//! Search for a division of groups into parts (folds, or training and test), so that every part contains every class.
//!
//! Groups are assigned one after the other, each to the part with the lowest cost of those that it may still be in. A class that has as many unassigned groups
//! as parts without the class is *tight*: each of these groups must be in a part without the class. A part for which a class has a single group left gets this
//! group. If no part is left for a group, the last choice is undone. The weight of a class counts its contradictions; groups of heavy classes with few possible
//! parts are assigned first [Boussemart et al. 2004]. After some contradictions, the search restarts with the weights that it has learned.
//!
//! The search is complete: it finds a division if one exists, or proves that there is none, unless it reaches [`MAX_CONTRADICTIONS`].

/// Number of contradictions before the first restart; each restart allows half as many again. With a smaller value, large searches restart before they are
/// complete; with a larger value, an unlucky first choice costs more time.
const FIRST_RESTART: usize = 50;

/// Maximum number of contradictions of a search. Random divisions of 800 groups need less than a thousand. With a larger value, a hopeless search takes minutes.
const MAX_CONTRADICTIONS: usize = 100_000;

/// Reason why a search returns no division.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoDivision {
    /// No division exists.
    Impossible,
    /// The search reached its limit.
    NotFound,
}

/// State of the search: a partial division of groups into parts.
pub(crate) struct FoldSearch {
    n_parts: usize,
    /// Classes of each group, each with its number of rows in the group.
    classes_of: Vec<Vec<(usize, usize)>>,
    /// Groups of each class.
    groups_of: Vec<Vec<usize>>,
    /// Part of each group; `None` if the group is unassigned.
    part_of: Vec<Option<usize>>,
    /// Whether each group may be in each part, shape n_groups × n_parts.
    is_allowed: Vec<bool>,
    n_allowed: Vec<usize>,
    /// Number of rows of each class in each part, shape n_classes × n_parts.
    n_rows: Vec<usize>,
    /// Number of unassigned groups of each class that may be in each part, shape n_classes × n_parts.
    n_choices: Vec<usize>,
    n_unassigned: Vec<usize>,
    /// Number of parts without each class.
    n_missing: Vec<usize>,
    weights: Vec<usize>,
    /// Changes since the start of the search, in order.
    trail: Vec<Change>,
}

enum Change {
    Assigned(usize, usize),
    Removed(usize, usize),
}

/// Choice of a part for a group, with the parts that are still to be tried.
struct Choice {
    group: usize,
    /// Parts in descending order of their cost.
    parts: Vec<usize>,
    /// Length of the trail before the choice.
    n_changes: usize,
}

impl FoldSearch {
    /// Creates a search, given the classes of each group (each with its number of rows, at least 1) in the order in which groups are assigned.
    pub(crate) fn new(
        classes_of: Vec<Vec<(usize, usize)>>,
        n_classes: usize,
        n_parts: usize,
    ) -> Self {
        let mut groups_of = vec![Vec::new(); n_classes];
        for (group, classes) in classes_of.iter().enumerate() {
            classes
                .iter()
                .for_each(|(class, _)| groups_of[*class].push(group));
        }
        let counts: Vec<usize> = groups_of.iter().map(Vec::len).collect();
        let n_groups = classes_of.len();
        Self {
            n_parts,
            part_of: vec![None; n_groups],
            is_allowed: vec![true; n_groups * n_parts],
            n_allowed: vec![n_parts; n_groups],
            n_rows: vec![0; n_classes * n_parts],
            n_choices: counts.iter().flat_map(|&n| vec![n; n_parts]).collect(),
            n_unassigned: counts,
            n_missing: vec![n_parts; n_classes],
            weights: vec![0; n_classes],
            trail: Vec::new(),
            classes_of,
            groups_of,
        }
    }

    /// Returns the number of rows of a class in a part.
    pub(crate) fn n_rows(&self, class: usize, part: usize) -> usize {
        self.n_rows[class * self.n_parts + part]
    }

    /// Returns the part of each group. The function `cost(search, group, part)` orders the parts of a group; of equal costs, the first part is taken.
    ///
    /// # Errors
    /// If no division exists, or none was found.
    pub(crate) fn divide<C: PartialOrd>(
        mut self,
        cost: impl Fn(&Self, usize, usize) -> C,
    ) -> Result<Vec<usize>, NoDivision> {
        let (mut n_contradictions, mut limit) = (0, FIRST_RESTART);
        if (0..self.groups_of.len()).any(|class| self.n_unassigned[class] < self.n_parts) {
            return Err(NoDivision::Impossible);
        }
        let mut choices: Vec<Choice> = Vec::new();
        while let Some(group) = self.next_group() {
            choices.push(Choice {
                group,
                parts: self.ordered_parts(group, &cost),
                n_changes: self.trail.len(),
            });
            // The next part of the last choice that has one.
            loop {
                let Some(choice) = choices.last_mut() else {
                    return Err(NoDivision::Impossible);
                };
                let (group, n_changes) = (choice.group, choice.n_changes);
                self.undo(n_changes);
                let Some(part) = choice.parts.pop() else {
                    choices.pop();
                    continue;
                };
                let Err(class) = self.assign(group, part) else {
                    break;
                };
                self.weights[class] += 1;
                n_contradictions += 1;
                if n_contradictions >= MAX_CONTRADICTIONS {
                    return Err(NoDivision::NotFound);
                }
                if n_contradictions >= limit {
                    limit += limit / 2;
                    choices.clear();
                    self.undo(0);
                    break;
                }
            }
        }
        Ok(self.part_of.into_iter().flatten().collect())
    }

    /// Returns the unassigned group with the largest weight of its classes per allowed part; the first group if several are equal.
    fn next_group(&self) -> Option<usize> {
        let mut unassigned = (0..self.part_of.len()).filter(|&group| self.part_of[group].is_none());
        if self.weights.iter().all(|weight| *weight == 0) {
            return unassigned.next();
        }
        let weight = |group: usize| {
            let classes = self.classes_of[group].iter();
            let weight: usize = classes.map(|(class, _)| self.weights[*class]).sum();
            weight as f64 / self.n_allowed[group] as f64
        };
        let weighted = unassigned.map(|group| (group, weight(group)));
        let first = weighted.reduce(|best, next| if next.1 > best.1 { next } else { best });
        first.map(|(group, _)| group)
    }

    /// Returns the parts that a group may be in, in descending order of their cost. Empty parts are equivalent, so only one of them is returned.
    fn ordered_parts<C: PartialOrd>(
        &self,
        group: usize,
        cost: impl Fn(&Self, usize, usize) -> C,
    ) -> Vec<usize> {
        let is_empty =
            |part: usize| (0..self.groups_of.len()).all(|class| self.n_rows(class, part) == 0);
        let allowed = (0..self.n_parts).filter(|part| self.is_allowed[group * self.n_parts + part]);
        let mut parts: Vec<(C, usize)> = allowed
            .map(|part| (cost(self, group, part), part))
            .collect();
        parts.sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
        let mut n_empty = 0;
        let mut parts: Vec<usize> = parts.into_iter().map(|(_, part)| part).collect();
        parts.retain(|&part| {
            n_empty += usize::from(is_empty(part));
            n_empty < 2 || !is_empty(part)
        });
        parts.reverse();
        parts
    }

    /// Assigns a group to a part, and applies all consequences. Returns a class that has a contradiction as an error.
    fn assign(&mut self, group: usize, part: usize) -> Result<(), usize> {
        let mut forced = vec![(group, part)];
        while let Some((group, part)) = forced.pop() {
            match self.part_of[group] {
                Some(other) if other == part => continue,
                Some(_) => return Err(self.classes_of[group][0].0),
                None => (),
            }
            for other in (0..self.n_parts).filter(|other| *other != part) {
                self.remove(group, other, &mut forced)?;
            }
            if !self.is_allowed[group * self.n_parts + part] {
                return Err(self.classes_of[group][0].0);
            }
            self.set(group, part);
            for place in 0..self.classes_of[group].len() {
                let class = self.classes_of[group][place].0;
                if self.n_unassigned[class] < self.n_missing[class] {
                    return Err(class);
                }
                if self.n_unassigned[class] == self.n_missing[class] {
                    self.tighten(class, &mut forced)?;
                }
            }
        }
        Ok(())
    }

    /// Removes the parts that contain a tight class from its unassigned groups.
    fn tighten(&mut self, class: usize, forced: &mut Vec<(usize, usize)>) -> Result<(), usize> {
        for place in 0..self.groups_of[class].len() {
            let group = self.groups_of[class][place];
            for part in 0..self.n_parts {
                if self.part_of[group].is_none() && self.n_rows(class, part) > 0 {
                    self.remove(group, part, forced)?;
                }
            }
        }
        Ok(())
    }

    /// Removes a part from an unassigned group, and adds the assignments that follow to `forced`.
    fn remove(
        &mut self,
        group: usize,
        part: usize,
        forced: &mut Vec<(usize, usize)>,
    ) -> Result<(), usize> {
        let place = group * self.n_parts + part;
        if !std::mem::replace(&mut self.is_allowed[place], false) {
            return Ok(());
        }
        self.trail.push(Change::Removed(group, part));
        self.n_allowed[group] -= 1;
        for place in 0..self.classes_of[group].len() {
            let class = self.classes_of[group][place].0;
            self.n_choices[class * self.n_parts + part] -= 1;
        }
        for place in 0..self.classes_of[group].len() {
            let class = self.classes_of[group][place].0;
            if self.n_rows(class, part) > 0 {
                continue;
            }
            match self.n_choices[class * self.n_parts + part] {
                0 => return Err(class),
                1 => {
                    let mut groups = self.groups_of[class].iter();
                    let is_last = |group: &&usize| {
                        self.part_of[**group].is_none()
                            && self.is_allowed[**group * self.n_parts + part]
                    };
                    forced.extend(groups.find(is_last).map(|last| (*last, part)));
                }
                _ => (),
            }
        }
        match self.n_allowed[group] {
            0 => Err(self.classes_of[group][0].0),
            1 => {
                let mut parts = 0..self.n_parts;
                let last = parts.find(|last| self.is_allowed[group * self.n_parts + last]);
                forced.extend(last.map(|last| (group, last)));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn set(&mut self, group: usize, part: usize) {
        self.part_of[group] = Some(part);
        self.trail.push(Change::Assigned(group, part));
        for &(class, n_rows) in &self.classes_of[group] {
            let place = class * self.n_parts + part;
            self.n_missing[class] -= usize::from(self.n_rows[place] == 0);
            self.n_rows[place] += n_rows;
            self.n_choices[place] -= 1;
            self.n_unassigned[class] -= 1;
        }
    }

    /// Undoes all changes but the first `n_changes`.
    fn undo(&mut self, n_changes: usize) {
        for change in self.trail.drain(n_changes..).rev() {
            match change {
                Change::Removed(group, part) => {
                    self.is_allowed[group * self.n_parts + part] = true;
                    self.n_allowed[group] += 1;
                    for (class, _) in &self.classes_of[group] {
                        self.n_choices[class * self.n_parts + part] += 1;
                    }
                }
                Change::Assigned(group, part) => {
                    self.part_of[group] = None;
                    for &(class, n_rows) in &self.classes_of[group] {
                        let place = class * self.n_parts + part;
                        self.n_rows[place] -= n_rows;
                        self.n_missing[class] += usize::from(self.n_rows[place] == 0);
                        self.n_choices[place] += 1;
                        self.n_unassigned[class] += 1;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    type Table = Vec<Vec<(usize, usize)>>;

    fn divide(table: &Table, n_classes: usize, n_parts: usize) -> Result<Vec<usize>, NoDivision> {
        let search = FoldSearch::new(table.clone(), n_classes, n_parts);
        search.divide(|search, group, part| {
            let classes = table[group].iter();
            classes
                .map(|&(class, _)| search.n_rows(class, part))
                .sum::<usize>()
        })
    }

    fn is_valid(table: &Table, n_classes: usize, n_parts: usize, part_of: &[usize]) -> bool {
        let mut is_in = vec![false; n_classes * n_parts];
        for (classes, part) in table.iter().zip(part_of) {
            classes
                .iter()
                .for_each(|(class, _)| is_in[class * n_parts + part] = true);
        }
        is_in.iter().all(|is_in| *is_in)
    }

    /// Returns whether any division is valid, by trying all of them.
    fn exists(table: &Table, n_classes: usize, n_parts: usize) -> bool {
        let n = n_parts.pow(table.len() as u32);
        (0..n).any(|number| {
            let part = |group: usize| number / n_parts.pow(group as u32) % n_parts;
            let parts: Vec<usize> = (0..table.len()).map(part).collect();
            is_valid(table, n_classes, n_parts, &parts)
        })
    }

    /// Returns groups of one to three classes, each class in at least `least` groups.
    fn table(rng: &mut ChaCha8Rng, n_classes: usize, least: usize) -> Table {
        let mut table: Table = Vec::new();
        let n_most = rng.gen_range(1..=3.min(n_classes));
        let mut n_groups = vec![0; n_classes];
        while let Some(class) = (0..n_classes).find(|class| n_groups[*class] < least) {
            let mut classes = vec![class];
            for _ in 1..rng.gen_range(1..=n_most) {
                classes.push(rng.gen_range(0..n_classes));
            }
            classes.sort_unstable();
            classes.dedup();
            classes.iter().for_each(|class| n_groups[*class] += 1);
            table.push(
                classes
                    .into_iter()
                    .map(|class| (class, rng.gen_range(1..5)))
                    .collect(),
            );
        }
        table
    }

    #[test]
    fn a_division_of_a_small_table_is_found_exactly_if_one_exists() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut n_found = 0;
        let mut n_tables = 0;
        while n_tables < 1000 {
            let (n_classes, n_parts) = (rng.gen_range(2..=6), rng.gen_range(2..=4));
            let least = rng.gen_range(n_parts..=n_parts + 1);
            let table = table(&mut rng, n_classes, least);
            if n_parts.pow(table.len() as u32) > 70_000 {
                continue;
            }
            n_tables += 1;
            match divide(&table, n_classes, n_parts) {
                Ok(parts) => {
                    n_found += 1;
                    assert!(is_valid(&table, n_classes, n_parts, &parts));
                }
                Err(reason) => {
                    assert_eq!(reason, NoDivision::Impossible);
                    assert!(!exists(&table, n_classes, n_parts), "{table:?} {n_parts}");
                }
            }
        }
        assert!((100..1000).contains(&n_found), "{n_found}");
    }

    #[test]
    fn a_division_that_is_known_to_exist_is_found() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for _ in 0..1000 {
            let n_classes = rng.gen_range(2..=40);
            let n_parts = rng.gen_range(2..=10);
            let n_spare = rng.gen_range(0..=2);
            let mut table: Table = Vec::new();
            // Every part contains each class once, in groups of one to three classes; then some groups more.
            for part in 0..n_parts + n_spare {
                let mut classes: Vec<usize> = (0..n_classes).collect();
                if part >= n_parts {
                    classes.retain(|_| rng.gen_bool(0.5));
                }
                while !classes.is_empty() {
                    let n = rng.gen_range(1..=3.min(classes.len()));
                    let taken =
                        (0..n).map(|_| classes.swap_remove(rng.gen_range(0..classes.len())));
                    table.push(taken.map(|class| (class, 1)).collect());
                }
            }
            use rand::seq::SliceRandom;
            table.shuffle(&mut rng);
            let parts = divide(&table, n_classes, n_parts);
            let parts =
                parts.unwrap_or_else(|_| panic!("{n_classes} classes, {n_parts} parts: {table:?}"));
            assert!(is_valid(&table, n_classes, n_parts, &parts));
        }
    }

    #[test]
    fn groups_of_single_classes_are_dealt_evenly() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..100 {
            let (n_classes, n_parts) = (rng.gen_range(2..=40), rng.gen_range(2..=10));
            let n_groups: Vec<usize> = (0..n_classes)
                .map(|_| rng.gen_range(n_parts..=20))
                .collect();
            let table = n_groups.iter().enumerate();
            let table: Table = table
                .flat_map(|(class, n)| vec![vec![(class, 3)]; *n])
                .collect();
            let parts = divide(&table, n_classes, n_parts).unwrap();
            for (class, n) in n_groups.iter().enumerate() {
                for part in 0..n_parts {
                    let groups = table.iter().zip(&parts);
                    let here = groups
                        .filter(|(of, at)| of[0].0 == class && **at == part)
                        .count();
                    assert!((n / n_parts..=n.div_ceil(n_parts)).contains(&here));
                }
            }
        }
    }
}
