//! Classes, groups, splits and depths of recorded touches.

use crate::inputs::arrays::whole_numbers::note_spellings;
use crate::inputs::arrays::{ClassLabels, KeyValue, OneForEach, group_keys, is_member, read_rows};
use crate::learning::data::split::Side;
use crate::studies::prelude::*;
use crate::studies::recognition::frames::touch_of;
use ndarray::Array1;
use std::collections::HashSet;

/// Classes of a recording, in the order of their labels.
pub struct RecordedClasses {
    /// Name of each class.
    pub names: Vec<String>,
    /// Text from which the seeds of the random numbers of each class are derived.
    pub streams: Vec<String>,
    /// Number of touches of each class.
    pub counts: Vec<usize>,
}

/// Groups of a recording.
pub struct RecordedGroups {
    /// Number of the group of every touch.
    pub keys: Vec<usize>,
    /// Names of the groups by their numbers; empty if the numbers are the names.
    pub names: Vec<String>,
}

impl RecordedGroups {
    fn new(values: &[KeyValue]) -> Self {
        let classes = ClassLabels::new(values).classes.into_iter();
        let names = classes.filter(KeyValue::is_text);
        Self {
            keys: group_keys(values),
            names: names.map(|name| name.to_string()).collect(),
        }
    }
}

impl RecordedSpec {
    /// Reads the classes (`labels`) or the groups (`groups`) of the touches of both sets, given their numbers of touches. Returns `None` for a set without
    /// touches or without such a file.
    ///
    /// # Errors
    /// If a file cannot be read or does not contain one value for each touch.
    pub fn values_of_sets(&self, name: &str, n: [usize; 2]) -> Result<[Option<Vec<KeyValue>>; 2]> {
        let read = |end: &str, n: usize| {
            let key = format!("{name}{end}");
            let Some(path) = self.file_of(&key).filter(|_| n > 0) else {
                return Ok(None);
            };
            let each = touch_of(self.frames_file(&format!("frames{end}")));
            let of_touches = OneForEach::new(path, &key, n, each);
            match name {
                "labels" => of_touches.classes().map(Some),
                _ => of_touches.groups().map(Some),
            }
        };
        Ok([read("", n[0])?, read("_test", n[1])?])
    }

    /// Returns the class labels of all touches; the separate test set comes last.
    pub(super) fn class_labels(&self, n: [usize; 2]) -> Result<ClassLabels> {
        let [train, test] = self.values_of_sets("labels", n)?;
        let first_is_text = |values: &[KeyValue]| values[0].is_text();
        let are_texts = [&train, &test].map(|set| set.as_deref().map(first_is_text));
        let place = self.file_of("labels").unwrap_or(&self.labels).display();
        if let ([Some(train), Some(test)], Some(path)) = (are_texts, self.file_of("labels_test"))
            && train != test
        {
            let allowed = format!("texts or numbers in both, as in {place}");
            let given = "numbers in one array of labels and texts in the other";
            return Err(Error::input(path.display(), given, allowed));
        }
        let values: Vec<KeyValue> = [train, test].into_iter().flatten().flatten().collect();
        let labels = ClassLabels::new(&values);
        let (Some(names), Some(KeyValue::Text(_))) = (&self.names, values.first()) else {
            return Ok(labels);
        };
        // Texts are numbered in the order of `names`.
        let known: Vec<KeyValue> = names.iter().cloned().map(KeyValue::Text).collect();
        let number = |value: &KeyValue| {
            let number = known.iter().position(|name| name == value);
            number.ok_or_else(|| {
                let given = format!("no name {:?}", value.to_string());
                let allowed = format!("each text of {place} once");
                Error::input("key recorded.names", given, allowed)
            })
        };
        Ok(ClassLabels {
            labels: values.iter().map(number).collect::<Result<_>>()?,
            classes: known,
        })
    }

    /// Returns the classes of the labels. Their names are those of the study, the texts of the labels, or the numbers of the labels.
    ///
    /// # Errors
    /// If a class has no touch, or the names do not fit the classes.
    pub fn classes(&self, labels: &ClassLabels) -> Result<RecordedClasses> {
        let n_classes = labels.classes.len();
        let mut counts = vec![0; n_classes];
        for &label in &labels.labels {
            counts[label] += 1;
        }
        let file = self.file_of("labels").unwrap_or(&self.labels).display();
        if let Some(label) = counts.iter().position(|&count| count == 0) {
            let given = format!("no touch of class {}", labels.classes[label]);
            return Err(Error::input(file, given, "touches of each class"));
        }
        let classes = labels.classes.iter().enumerate();
        let (names, streams): (Vec<String>, Vec<String>) = match &self.names {
            None => classes
                .map(|(number, class)| match class {
                    KeyValue::Integer(value) => {
                        (format!("class {value}"), format!("class {number}"))
                    }
                    KeyValue::Text(text) => (text.clone(), text.clone()),
                })
                .unzip(),
            Some(names) if names.len() == n_classes => (names.clone(), names.clone()),
            Some(names) => {
                let given = format!("{} names", names.len());
                let allowed = format!("{n_classes}, one a class of {file}");
                return Err(Error::input("key recorded.names", given, allowed));
            }
        };
        if let Some(name) = (1..names.len()).find(|&k| names[..k].contains(&names[k])) {
            let given = format!("{:?} twice", names[name]);
            return Err(Error::input("key recorded.names", given, "each name once"));
        }
        note_spellings("labels", names.iter().map(String::as_str));
        Ok(RecordedClasses {
            names,
            streams,
            counts,
        })
    }

    /// Returns the groups of all touches; the touches of the separate test set come last. Returns `None` if the recording defines no groups.
    pub(super) fn groups_of_sets(&self, n: [usize; 2]) -> Result<Option<RecordedGroups>> {
        let refuse = |given: String, allowed: &str| {
            Err(Error::input("key recorded.groups_test", given, allowed))
        };
        Ok(Some(match self.values_of_sets("groups", n)? {
            [None, None] => return Ok(None),
            [Some(_), None] if n[1] > 0 => {
                let allowed = "the groups of the test set beside groups, or neither of them";
                return refuse("no such key".to_owned(), allowed);
            }
            [Some(groups), None] => RecordedGroups::new(&groups),
            [None, Some(test)] => {
                // Each training touch is a group of its own.
                let RecordedGroups { keys, names } = RecordedGroups::new(&test);
                let first = keys.iter().max().map_or(0, |last| last + 1);
                let keys = (first..first + n[0]).chain(keys).collect();
                RecordedGroups { keys, names }
            }
            [Some(train), Some(test)] => {
                let known: HashSet<&KeyValue> = train.iter().collect();
                if let Some(both) = test.iter().find(|group| known.contains(group)) {
                    let allowed = "groups that either train or test";
                    return refuse(format!("group {both} in both sets"), allowed);
                }
                RecordedGroups::new(&[train, test].concat())
            }
        }))
    }

    /// Checks that each class has training touches and test touches, given the sides of the touches in the order `order`.
    pub(super) fn check_test_set(
        &self,
        names: &[String],
        order: &[usize],
        sides: &[Side],
        labels: &ClassLabels,
    ) -> Result<()> {
        let without = |side: Side| {
            let is_on =
                |(touch, own): (&usize, &Side)| (*own == side).then_some(labels.labels[*touch]);
            let found: HashSet<usize> = order.iter().zip(sides).filter_map(is_on).collect();
            (0..names.len()).find(|label| !found.contains(label))
        };
        let (given, allowed) = match (without(Side::Train), without(Side::Test)) {
            (Some(label), _) => (
                format!("{}, of which no touch trains", names[label]),
                "classes of recorded.labels",
            ),
            (None, Some(label)) => (
                format!("no touch of {}", names[label]),
                "touches of each class among those that train and in the test set",
            ),
            (None, None) => return Ok(()),
        };
        Err(Error::input("key recorded.labels_test", given, allowed))
    }

    /// Returns the side of each touch in each split of the file `splits`; the touches are in the order `order`. The list is empty without the file.
    pub(super) fn read_splits(
        &self,
        order: &[usize],
        groups: Option<&Array1<usize>>,
    ) -> Result<Vec<Vec<Side>>> {
        let mut splits = Vec::new();
        let Some(path) = &self.splits else {
            return Ok(splits);
        };
        let place = format!("{} (key recorded.splits)", path.display());
        let refuse = |given: String, allowed: &str| Err(Error::input(&place, given, allowed));
        while is_member(path, &format!("train_{}", splits.len())) {
            let number = splits.len();
            let arrays = format!("train_{number} and test_{number}");
            let mut of_touch = vec![Side::LeftOut; order.len()];
            for (name, side) in [("train", Side::Train), ("test", Side::Test)] {
                for touch in read_rows(path, &format!("{name}_{number}"), order.len())? {
                    if std::mem::replace(&mut of_touch[touch], side) != Side::LeftOut {
                        let given = format!("touch {touch} twice in {arrays}");
                        return refuse(given, "each touch once, or not at all");
                    }
                }
            }
            let sides: Vec<Side> = order.iter().map(|&touch| of_touch[touch]).collect();
            let groups_on = |wanted: Side| {
                let groups = groups.into_iter().flatten().zip(&sides);
                groups.filter_map(move |(group, side)| (*side == wanted).then_some(*group))
            };
            let trained: HashSet<usize> = groups_on(Side::Train).collect();
            if let Some(both) = groups_on(Side::Test).find(|group| trained.contains(group)) {
                let given = format!("group {both} in {arrays}");
                return refuse(given, "groups of recorded.groups that either train or test");
            }
            splits.push(sides);
        }
        match splits.is_empty() {
            true => refuse(
                "no array train_0".to_owned(),
                "an archive .npz of train_0, test_0, train_1, test_1, …",
            ),
            false => Ok(splits),
        }
    }

    /// Reads the press depth of each of `n` touches, metres; `None` without the file `depths`.
    pub(super) fn read_depths(&self, n: usize) -> Result<Option<Vec<f64>>> {
        let read = |path| {
            let of_touches = OneForEach::new(path, "depths", n, touch_of(self.first_frames()));
            let is_depth = |depth: f64| depth.is_finite() && depth > 0.0;
            of_touches.numbers(is_depth, "a positive number of metres")
        };
        self.depths.as_deref().map(read).transpose()
    }
}
