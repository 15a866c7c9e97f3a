//! Studies that recognise objects, as a kind.

use crate::engine::work_items::scale::Scale;
use crate::error::Result;
use crate::report::page::Section;
use crate::report::pictures::snapshots::{Snapshots, snapshots};
use crate::report::study_content::NamedPicture;
use crate::studies::kind::{About, Facts, Findings, Kind};
use crate::studies::recognition::charts;
use crate::studies::recognition::frames::touch_set::Samples;
use crate::studies::recognition::spec::pose_split::{GroupSpec, PoseSplit};
use crate::studies::recognition::spec::study::StudySpec;
use crate::studies::recognition::study::load::load_study;
use crate::studies::recognition::study::study::RecognitionStudy;
use crate::studies::recognition::sweep::sweep::StudyPart;
use crate::studies::source::Source;
use crate::table::{ChartSpec, Table};
use std::path::Path;

/// Where the intervals of accuracies stand.
const ACCURACIES: &str = "accuracy.csv, summary.csv: accuracy_low, accuracy_high";
/// How they are made where test rows are held out one by one, and where whole groups are.
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

/// How other intervals and p-values are made, by table and columns. Everything is at 95 %.
const METHODS: [(&str, &str); 5] = [
    (
        "summary.csv: bootstrap_low, bootstrap_high",
        "bootstrap of the mean over trials, expanded percentiles; with projections_per_split, splits and projections drawn apart",
    ),
    (
        "comparison.csv: difference_low, difference_high, p_value, p_holm",
        "corrected resampled t-test against the best cell (Nadeau, Bengio 2003); p_holm: corrected for the number of cells by Holm's method",
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
        "corrected resampled t-tests, corrected for the number of cells by Holm's method",
    ),
];

impl Kind for RecognitionStudy {
    const ABOUT: About = About {
        table: "recognition",
        words: "a study that recognises objects",
        may_change: crate::studies::recognition::spec::study::MAY_CHANGE,
    };

    fn table_names() -> Vec<&'static str> {
        charts::TABLE_NAMES.to_vec()
    }

    fn load(source: &Source) -> Result<Self> {
        load_study(source)
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.first().plan.spec;
        let is_grouped = |part: &StudyPart| part.sweep.test_groups(&part.plan, 0, &[]).is_some();
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

    fn read(folder: &Path) -> Result<Vec<Table>> {
        charts::read_tables(folder)
    }
}

impl Findings for RecognitionStudy {
    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts::charts(tables, self.first().plan.spec.report.pareto)
    }

    fn pictures(&self, _tables: &[Table]) -> Result<Vec<NamedPicture>> {
        let shown = &self.samples()?.shown;
        let picture = snapshots(shown)?;
        Ok(vec![NamedPicture {
            name: "snapshots".to_owned(),
            title: shown.caption.clone(),
            png: picture.png()?,
            size: (picture.width / 2, picture.height / 2),
        }])
    }

    fn sections(&self, tables: &[Table]) -> Result<Vec<Section>> {
        let row = |name: &str, value: String| (name.to_owned(), value);
        let first = self.first();
        let spec = &first.plan.spec;
        let mut settings = first.touched.settings();
        settings.extend([
            row("Touches", first.sweep.labels.len().to_string()),
            row("Stroke", format!("{} mm", spec.skin.stroke_mm)),
            row("Split", split_words(spec)),
            row("Trials", spec.trials.to_string()),
            row("Seed", spec.seed.to_string()),
        ]);
        charts::sections(&settings, &gallery(self.samples()?), tables)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        charts::answers(tables)
    }

    fn summary(&self, tables: &[Table], width: usize) -> String {
        charts::words(tables, width)
    }
}

/// What the test touches have in common with those that are learned from.
fn split_words(spec: &StudySpec) -> String {
    let held_out = match spec.recognition.keep_together {
        _ if let Some(recorded) = &spec.recorded => {
            if recorded.has_test_set() {
                return "given test set".to_owned();
            }
            return match recorded.file_of("groups") {
                Some(_) => "recorded groups that are never learned".to_owned(),
                None => "random touches, whatever was recorded together".to_owned(),
            };
        }
        _ if spec.axes.has("recognition.keep_together") || spec.axes.has("recognition.split") => {
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

/// Every object; before them what the picture shows, if that is something else.
fn gallery(Samples { shown, each }: &Samples) -> Vec<Snapshots> {
    let is_like = |each: &Snapshots| each.caption == shown.caption;
    let shown = Some(shown).filter(|_| !each.as_ref().is_some_and(is_like));
    shown.into_iter().chain(each).cloned().collect()
}
