//! A study of breaking points: every value of every way, on all threads.

use crate::engine::work_items::pending::PendingItems;
use crate::engine::work_items::scale::Scale;
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use crate::inputs::object_files::{load_objects, objects_content};
use crate::inputs::objects_spec::ObjectsSpec;
use crate::random::Seed;
use crate::statistics::grouped::{GroupCount, independent_rows};
use crate::statistics::p_status::CONFIDENCE;
use crate::studies::breaking_points::half::{ScoredCell, breaking_points};
use crate::studies::breaking_points::plan::{BreakingPointsPlan, PlannedValue, PlannedWay};
use crate::studies::breaking_points::rows::{BreakingPoint, WayCell};
use crate::studies::breaking_points::spec::BreakingPointsSpec;
use crate::studies::breaking_points::value::{ObjectSets, evaluate};
use crate::studies::recognition::plan::plan::Plan;
use crate::studies::recognition::rows::table_rows::{CellScore, TrialScore, TrialTime};
use crate::studies::recognition::sweep::sweep::Sweep;
use crate::studies::recognition::tables::summary::{grouped_tests, summarise};
use crate::studies::recognition::tables::tabulate::share_columns;
use crate::studies::recognition::touches::drawn_touches::draw_touches;
use crate::studies::source::Source;
use crate::studies::study::{About, Facts, Findings, Resumes, Study, TableFiles};
use crate::studies::{found_and_cost, grouped};
use crate::table::{File, Table};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A study of breaking points, and where packings are looked for and kept, if anywhere.
pub struct BreakingPointsStudy {
    /// What to run.
    pub plan: BreakingPointsPlan,
    /// The folder of packings.
    pub packings: Option<PathBuf>,
}

/// What was found at values of ways, trial by trial, with the groups that each trial tested, if any; and how many objects a way tells apart.
pub type DrivenRows = (
    Vec<(WayCell, TrialScore, TrialTime)>,
    Vec<Vec<GroupCount>>,
    Vec<(String, usize)>,
);

/// Tables.
const ACCURACY: File<(WayCell, TrialScore)> =
    File::new("accuracy.csv", "Accuracy of every trial", "");
const SUMMARY: File<(WayCell, CellScore)> = File::new("summary.csv", "Accuracy at every value", "");
const BREAKS: File<BreakingPoint> = File::new(
    "breaking_points.csv",
    "Breaking points",
    "Each setting alone is driven to its ends; the interval is that of the place where accuracy is half of its best.",
)
.summary();
const TIMING: File<(WayCell, TrialTime)> =
    File::new("timing.csv", "Time of every trial", "").of_times();

/// Objects that are not counted before they are loaded are as many as this, for estimates.
const N_OBJECTS: usize = 30;

impl BreakingPointsStudy {
    /// All values of all ways.
    fn values(&self) -> impl Iterator<Item = (&PlannedWay, &PlannedValue)> {
        let ways = self.plan.ways.iter();
        ways.flat_map(|way| way.values.iter().map(move |value| (way, value)))
    }

    /// What says which objects they touch, each once.
    fn objects(&self) -> Vec<&ObjectsSpec> {
        let mut specs: Vec<&ObjectsSpec> = Vec::new();
        for plan in self.values().flat_map(|(_, value)| value.plans()) {
            if !specs.contains(&&plan.spec.objects) {
                specs.push(&plan.spec.objects);
            }
        }
        specs
    }
}

/// What a value is called as a work item.
fn name((way, value): &(&PlannedWay, &PlannedValue)) -> String {
    format!("{} at {}", way.spec.name, value.value)
}

/// Numbers that a value reads of one object.
fn n_read(value: &PlannedValue) -> usize {
    let of_plan = |plan: &Plan| plan.arrays[0].n_taxels() * plan.placement.per_object.unwrap_or(1);
    value.plans().map(of_plan).sum()
}

/// Returns for each cell the number of independent test rows that its trials are worth: those of a trial, or what the groups of all trials say.
fn independent_rows_of_cells(
    scores: &[(WayCell, TrialScore)],
    mut groups: &[Vec<GroupCount>],
) -> Result<Vec<f64>> {
    let cells = scores.chunk_by(|a, b| a.0 == b.0).map(|trials| {
        let here = groups.split_off(..trials.len()).unwrap_or_default();
        let tested = grouped_tests(trials.iter().map(|(_, score)| score).zip(here));
        match tested.is_empty() {
            true => {
                let n_test = trials.iter().map(|(_, score)| score.n_test).min();
                Ok(n_test.unwrap_or(0) as f64)
            }
            false => independent_rows(&tested, CONFIDENCE),
        }
    });
    cells.collect()
}

impl Study for BreakingPointsStudy {
    const ABOUT: About = About {
        table: "breaking_points",
        words: "a study of where recognition breaks",
        resumes: Resumes::ButFor(&["question", "expected", "breaking_points"]),
    };
    const TABLES: TableFiles = TableFiles::always(&[&ACCURACY, &SUMMARY, &BREAKS, &TIMING]);

    type Rows = DrivenRows;

    fn load(source: &Source) -> Result<Self> {
        let mut spec = BreakingPointsSpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed);
        source.replace_objects(&mut spec.objects);
        let plan = BreakingPointsPlan::new(&source.place, spec)?;
        let packings = source.packings.clone();
        // Touches that cannot be split before anything is driven are known before anything runs.
        let base = &plan.base;
        let objects = load_objects(&base.spec.objects, packings.as_deref())?;
        let seed = Seed::new(base.spec.seed);
        let touched = draw_touches(objects, &base.placement, &seed)?;
        let sweep = Sweep::new(base, &touched);
        sweep.map_err(|error| error.under(format!("{}, ", source.place)))?;
        Ok(Self { plan, packings })
    }

    fn facts(&self) -> Result<Facts> {
        let mut content = BTreeMap::new();
        for objects in self.objects() {
            content.extend(objects_content(objects)?);
        }
        Ok(Facts::of(&self.plan.spec, content))
    }

    fn scale(&self) -> Scale {
        let values = || self.values().map(|(_, value)| value);
        let touches = values().map(|value| value.learned.placement.per_object.unwrap_or(1));
        let touches = touches.max().unwrap_or(0);
        let n_cells =
            values().map(|value| value.learned.spec.recognition.classifier.values().len());
        let most_read = values().map(n_read).max().unwrap_or(0);
        Scale {
            objects: "those of each value".to_owned(),
            touches: format!("up to {touches} of each object at each value"),
            n_configurations: n_cells.sum(),
            // Frames in single precision.
            item_bytes: 4.0 * (N_OBJECTS * most_read) as f64,
            ..Scale::default()
        }
    }

    fn work_items(&self) -> Vec<WorkItem> {
        let items = self.values().enumerate();
        let items = items.map(|(group, value)| {
            // The study at this value is all that it depends on.
            let specs: Vec<_> = value.1.plans().map(|plan| &plan.spec).collect();
            WorkItem::new(name(&value), group).made_of(specs)
        });
        items.collect()
    }

    fn measure(&self, left: &PendingItems<DrivenRows>) -> Result<()> {
        let specs = self.objects();
        left.progress.stage("objects", specs.len() as u64);
        let sets = specs.into_iter().map(|spec| {
            let objects = load_objects(spec, self.packings.as_deref())?;
            left.progress.advance(1);
            Ok((spec.clone(), objects))
        });
        let sets: ObjectSets = sets.collect::<Result<_>>()?;
        let values = left.of(0, self.values());
        left.progress.stage("drive", values.len() as u64);
        values
            .par_iter()
            // One at a time: values of one way may all be slow.
            .with_max_len(1)
            .try_for_each(|(number, at)| {
                left.finish(*number, || {
                    let found = evaluate(at.0, at.1, &sets);
                    found.map_err(|error| error.under(format!("way {}, ", name(at))))
                })
            })
    }

    fn tables(&self, (mut rows, groups, n_objects): DrivenRows) -> Result<Vec<Table>> {
        share_columns(rows.iter_mut().map(|(_, score, _)| score).collect());
        let n_objects: BTreeMap<String, usize> = n_objects.into_iter().collect();
        let n_folds = self.plan.spec.recognition.folds.unwrap_or(1);
        let scores = rows.iter();
        let scores = scores.map(|(cell, score, _)| (cell.clone(), score.clone()));
        let scores: Vec<(WayCell, TrialScore)> = scores.collect();
        let summary = summarise(&scores, &groups, |_| n_folds)?;
        let n_rows = independent_rows_of_cells(&scores, &groups)?;
        let cells: Vec<ScoredCell> = summary.iter().zip(n_rows).collect();
        let mut breaks = Vec::new();
        for way in &self.plan.ways {
            let name = &way.spec.name;
            let n_objects = n_objects.get(name).copied().unwrap_or(0);
            let seed = Seed::new(self.plan.spec.seed).named("breaking points");
            let seed = seed.named(name);
            let of_way = cells.iter().filter(|((cell, _), _)| cell.way == *name);
            let curves = grouped(of_way, |((cell, _), _)| cell.classifier).into_iter();
            for (number, (_, curve)) in curves.enumerate() {
                let seed = seed.numbered(number as u64);
                breaks.extend(breaking_points(&curve, way.spec.scale, n_objects, &seed));
            }
        }
        let [accuracy, timing] = found_and_cost(&ACCURACY, &TIMING, &rows)?;
        let (summary, breaks) = (SUMMARY.of(&summary)?, BREAKS.of(&breaks)?);
        Ok(vec![accuracy, summary, breaks, timing])
    }

    fn findings(&self, tables: &[Table]) -> Result<Findings> {
        Ok(Findings {
            charts: self.charts(tables),
            answers: self.answers(tables),
            ..Findings::default()
        })
    }
}
