//! Shard of a study: the part of the work items that one process computes, independently of other processes.

use crate::error::{Error, Result};
use std::fmt::{self, Display};
use std::str::FromStr;

/// Shard of a study: part number `index` of `count` parts that are computed separately, written `3/8`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of this shard, from 1 to `count`.
    index: usize,
    /// Total number of shards, at least 1.
    count: usize,
}

impl Shard {
    /// Returns all `count` shards of a study, from first to last.
    pub fn all(count: usize) -> impl Iterator<Item = Self> {
        (1..=count).map(move |index| Self { index, count })
    }

    /// Returns the number of this shard, from 1.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Returns whether this shard computes a work item, given its group (index, number of groups) and its index `piece`.
    ///
    /// Items of a group share preparatory work. If there are at least as many groups as shards, each group is therefore assigned to a single shard.
    pub fn takes(&self, (group, n_groups): (usize, usize), piece: usize) -> bool {
        let number = match n_groups >= self.count {
            true => group,
            false => piece,
        };
        number % self.count == self.index - 1
    }

    /// Returns the name of this shard's file, given the file name without shards: `journal.jsonl` becomes `journal.3-of-8.jsonl`.
    pub fn file_name(&self, whole: &str) -> String {
        let (stem, ending) = whole.rsplit_once('.').unwrap_or((whole, ""));
        format!("{stem}.{}-of-{}.{ending}", self.index, self.count)
    }
}

impl Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let numbers = text.split_once('/').and_then(|(index, count)| {
            let shard = Self {
                index: index.parse().ok()?,
                count: count.parse().ok()?,
            };
            (1..=shard.count).contains(&shard.index).then_some(shard)
        });
        let allowed = "I/N with whole numbers, I from 1 to N: 3/8";
        numbers.ok_or_else(|| Error::input("--shard", text, allowed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_is_in_one_shard_whether_there_are_many_groups_or_few() {
        for (n_groups, per_group) in [(20, 3), (2, 9), (1, 1), (8, 8)] {
            for count in [1, 2, 3, 8, 50] {
                for piece in 0..n_groups * per_group {
                    let group = (piece / per_group, n_groups);
                    let takes =
                        (1..=count).filter(|&index| Shard { index, count }.takes(group, piece));
                    assert_eq!(takes.count(), 1, "{n_groups} {per_group} {count} {piece}");
                }
            }
        }
    }

    #[test]
    fn a_shard_is_written_as_its_number_and_how_many_there_are() {
        let shard: Shard = "3/8".parse().unwrap();
        assert_eq!(shard.to_string(), "3/8");
        assert_eq!(shard.file_name("journal.jsonl"), "journal.3-of-8.jsonl");
        for wrong in ["", "3", "0/8", "9/8", "3/0", "-1/2", "1/2/3", "a/b"] {
            assert_eq!(
                wrong.parse::<Shard>().unwrap_err().exit_code(),
                2,
                "{wrong}"
            );
        }
    }
}
