//! Recognition study as a kind of study.

use crate::report::page::Section;
use crate::report::pictures::snapshots::snapshots;
use crate::studies::prelude::*;
use crate::studies::recognition::charts;
use crate::studies::recognition::frames::Samples;
use crate::studies::recognition::spec::{GroupSpec, PoseSplit, recognition_keys};
use crate::studies::recognition::study::{RecognitionRows, RecognitionStudy, distinct, load_study};
use crate::studies::recognition::sweep::StudyPart;
use crate::studies::recognition::training::FamilyInputs;
use crate::studies::study::settings_words;
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::Path;

/// Names of the tables and columns that contain the intervals of accuracies.
const ACCURACIES: &str = "accuracy.csv, summary.csv: accuracy_low, accuracy_high";
/// Statistical method of the accuracy intervals when single test rows are held out: the table columns and the description.
const BY_ROWS: (&str, &str) = (
    ACCURACIES,
    "Wilson score interval of the counts of all trials, at the test rows of one trial",
);
const BY_FOLDS: (&str, &str) = (
    ACCURACIES,
    "Wilson score interval of the counts of all trials; accuracy.csv: at the test rows of the trial; summary.csv: at those of all folds, each touch once",
);
const BY_GROUPS: (&str, &str) = (
    ACCURACIES,
    "score interval of the groups that are held out: Wilson's of the test rows divided by the design effect (Rao, Scott 1992), Student's t of groups - 1",
);

/// Statistical methods of all intervals and p-values except accuracy intervals: the table columns and the description. All intervals have a confidence of 95 %.
const METHODS: [(&str, &str); 5] = [
    (
        "summary.csv: bootstrap_low, bootstrap_high",
        "bootstrap of the mean over trials, expanded percentiles; with projections_per_split, splits and projections drawn apart",
    ),
    (
        "comparison.csv: difference_low, difference_high, p_value, p_holm",
        "corrected resampled t-test against the best configuration (Nadeau, Bengio 2003); p_holm: corrected for the number of configurations by Holm's method",
    ),
    (
        "variance.csv: accuracy_std_low, accuracy_std_high, p_value",
        "crossed random effects by the method of moments; modified large samples (of the rest chi-squared); F test",
    ),
    (
        "robustness.csv: half_accuracy_at_low, half_accuracy_at_high",
        "the place found again in 1,000 draws of all accuracies from Beta(correct + 1/2, wrong + 1/2), at the test rows that the interval of each accuracy is worth",
    ),
    (
        "bubbletouch compare: p_holm",
        "corrected resampled t-tests, corrected for the number of configurations by Holm's method",
    ),
];

impl Study for RecognitionStudy {
    const ABOUT: About = About {
        table: "recognition",
        words: "a study that recognises objects",
    };

    const TABLES: TableFiles = TableFiles {
        always: charts::TABLES,
        of_parts: charts::TABLES_OF_PARTS,
    };
    type Spec = StudySpec;
    type Rows = RecognitionRows;

    fn keys() -> Vec<KeyAbout> {
        recognition_keys().to_vec()
    }

    fn load(source: &Source) -> Result<Self> {
        load_study(source)
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.first().plan.spec;
        let is_grouped = |part: &StudyPart| {
            let trial = part.sweep.trial(&part.plan, 0);
            trial.is_ok_and(|trial| trial.test_groups(&[]).is_some())
        };
        let accuracies = match self.parts().iter().any(is_grouped) {
            true => BY_GROUPS,
            false if spec.recognition.folds.is_some() => BY_FOLDS,
            false => BY_ROWS,
        };
        Ok(Facts {
            methods: [&[accuracies], &METHODS[..]].concat(),
            ..Facts::of_toml(spec.to_toml(), self.content()?)
        })
    }

    fn scale(&self) -> Scale {
        self.scale.clone()
    }

    /// Returns all work items, ordered by trial and family of configurations. The items for the touches of each array follow.
    fn work_items(&self) -> Vec<WorkItem> {
        let families = 0..self.families.len();
        let of_family = |family: usize| {
            let (part, configurations) = self.family(family);
            let placed = &self.families[family];
            let touches = [placed.touches, placed.tested];
            let touches = touches.map(|touches| &self.touch_sets[touches].content);
            // The measurements are those that the family alone needs.
            let measured = self.group(family).1.inputs_of(&part.plan, configurations);
            let inputs = FamilyInputs::new(&part.plan, &part.sweep, configurations);
            identity(&(touches, measured, inputs))
        };
        let families: Vec<String> = families.into_par_iter().map(of_family).collect();
        let last = self.families.iter().map(|family| family.measurement).max();
        let n_measurements = last.map_or(0, |last| last + 1);
        let mut items = Vec::with_capacity(self.n_trials() * families.len());
        for trial in 0..self.n_trials() {
            let of_part = |StudyPart { plan, sweep, .. }: &StudyPart| {
                identity(&sweep.trial(plan, trial).expect("a trial of the study"))
            };
            let trials: Vec<String> = self.parts().iter().map(of_part).collect();
            for (family, inputs) in self.families.iter().zip(&families) {
                items.push(WorkItem {
                    name: format!("trial {trial}"),
                    inputs: format!("{inputs} {}", trials[family.part]),
                    group: trial * n_measurements + family.measurement,
                    is_result: true,
                });
            }
        }
        for (number, touches) in self.touch_sets.iter().enumerate() {
            let (_, array, n_frames) = self.on(number);
            let (ImageShape { ny, nx }, pitch) = (array.shape(), array.pitch());
            let name = format!("touches of {n_frames} frames on {nx}x{ny} taxels at {pitch} m");
            items.push(WorkItem {
                is_result: false,
                ..WorkItem::of(name, touches.measurement, &touches.content)
            });
        }
        items
    }

    fn check(&self, pending: &PendingItems<RecognitionRows>) -> Result<Vec<Error>> {
        self.check_all_provided(pending)
    }

    fn measure(&self, left: &PendingItems<RecognitionRows>) -> Result<()> {
        self.measure_all(left)
    }

    fn place(&self, number: usize, (rows, touch_rows): &mut RecognitionRows) {
        let touches = match number.checked_sub(self.touches_item(0)) {
            Some(touches) => touches,
            None => {
                let family = number % self.families.len();
                for (place, row) in rows.iter_mut().enumerate() {
                    row.at = (family, place);
                }
                self.families[family].touches
            }
        };
        for row in touch_rows {
            row.on = touches;
        }
    }

    /// Returns a description of a family of configurations: the settings of its first configuration.
    fn item_words(&self, number: usize, item: &WorkItem) -> String {
        if number >= self.touches_item(0) {
            return item.name.clone();
        }
        let (trial, family) = (number / self.families.len(), number % self.families.len());
        let settings = settings_words(&self.family(family).1[0]);
        format!("{settings}, trial = {trial}")
    }

    fn tables(&self, rows: RecognitionRows) -> Result<Vec<Table>> {
        charts::tables_of(&self.outcome(rows)?)
    }

    fn read_tables(folder: &Path) -> Result<Vec<Table>> {
        charts::read_tables(folder)
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts::charts(tables, self.first().plan.spec.report.pareto)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        charts::answers(tables)
    }

    fn summary(&self, tables: &[Table], width: usize) -> String {
        charts::words(tables, width)
    }

    fn beyond(&self, tables: &[Table]) -> Result<Beyond> {
        Ok(Beyond {
            pictures: self.pictures(tables)?,
            sections: self.sections(tables),
            ..Beyond::default()
        })
    }
}

impl RecognitionStudy {
    pub(crate) fn pictures(&self, _tables: &[Table]) -> Result<Vec<NamedPicture>> {
        let Samples { shown, each } = self.samples()?;
        let each = each
            .as_ref()
            .filter(|each| each.frames.len() > shown.frames.len());
        let sets = [("snapshots", Some(shown)), ("touches", each)];
        let sets = sets
            .into_iter()
            .filter_map(|(name, set)| Some((name, set?)));
        let pictures = sets.map(|(name, set)| {
            let picture = snapshots(set)?;
            let size = (picture.width / 2, picture.height / 2);
            Ok(NamedPicture {
                name: name.to_owned(),
                title: set.caption.clone(),
                png: picture.small_png()?,
                size,
            })
        });
        pictures.collect()
    }

    pub(crate) fn sections(&self, tables: &[Table]) -> Vec<Section> {
        let mut settings: Vec<(String, String)> = Vec::new();
        let mut add = |name: &str, value: String| settings.push((name.to_owned(), value));
        let of_touches: Vec<_> = self
            .parts()
            .iter()
            .map(|part| part.touched.settings())
            .collect();
        let mut names: Vec<&String> = of_touches.iter().flatten().map(|(name, _)| name).collect();
        let mut known = HashSet::new();
        names.retain(|name| known.insert(*name));
        for name in names {
            let value = |settings: &Vec<(String, String)>| {
                let own = settings.iter().find(|(other, _)| other == name);
                own.map_or("none".to_owned(), |(_, value)| value.clone())
            };
            add(name, distinct(of_touches.iter().map(value)));
        }
        let of_spec =
            |value: fn(&StudySpec) -> String| self.of_parts(|part| value(&part.plan.spec));
        add(
            "Touches",
            self.of_parts(|part| part.sweep.labels.len().to_string()),
        );
        add(
            "Stroke",
            of_spec(|spec| format!("{} mm", spec.skin.stroke_mm)),
        );
        add("Split", of_spec(split_words));
        match self.test_keys() {
            keys if keys.is_empty() => {}
            keys => add("Test touches differ in", keys),
        }
        add("Trials", self.n_trials().to_string());
        add("Seed", of_spec(|spec| spec.seed.to_string()));
        charts::sections(&settings, tables)
    }
}

/// Returns a text that describes how the split selects test touches in relation to training touches.
fn split_words(spec: &StudySpec) -> String {
    let held_out = match spec.recognition.group_by {
        _ if let Some(recorded) = &spec.recorded => {
            if spec.axes.has("recorded.groups") {
                return "recorded groups that are never learned, as each row says".to_owned();
            }
            if recorded.has_test_set() {
                return "given test set".to_owned();
            }
            if recorded.splits.is_some() {
                return "given splits".to_owned();
            }
            return match recorded.file_of("groups") {
                Some(_) => "recorded groups that are never learned".to_owned(),
                None => "random touches, whatever was recorded together".to_owned(),
            };
        }
        _ if spec.axes.has("recognition.group_by") || spec.axes.has("recognition.split") => {
            return "as each row says".to_owned();
        }
        _ if spec.recognition.split != PoseSplit::Random => {
            return spec.recognition.split.words().to_owned();
        }
        None => {
            return "random touches: most have neighbours in the pose that are learned".to_owned();
        }
        Some(GroupSpec::Pose) => "whole poses, whose neighbours are learned",
        Some(GroupSpec::Offset) => "offsets that are never learned",
        Some(GroupSpec::Yaw) => "yaws that are never learned",
        Some(GroupSpec::Tilt) => "tilts that are never learned",
        Some(GroupSpec::Rest) => "resting poses that are never learned",
        Some(GroupSpec::Depth) => "depths that are never learned",
    };
    held_out.to_owned()
}
