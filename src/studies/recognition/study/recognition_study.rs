//! A study that recognises objects: its work items, and the tables of what they found.

use crate::engine::axes::AxisValues;
use crate::engine::progress::Progress;
use crate::engine::work_items::scale::Scale;
use crate::engine::work_items::shared::Shared;
use crate::error::{Error, Result};
use crate::inputs::content_hash::short_hash;
use crate::inputs::object_files::objects_content;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::inputs::units::millimetres;
use crate::studies::recognition::frames::touch_set::{Samples, TouchSet};
use crate::studies::recognition::plan::group::Group;
use crate::studies::recognition::plan::study_plan::Plan;
use crate::studies::recognition::plan::taxel_array::TaxelArray;
use crate::studies::recognition::rows::cell::Cell;
use crate::studies::recognition::rows::table_rows::{StageTime, Tables};
use crate::studies::recognition::spec::recorded::RecordedSpec;
use crate::studies::recognition::spec::study::ConfusionMatrices;
use crate::studies::recognition::study::rows::{RecognitionRows, TouchRow};
use crate::studies::recognition::study::touch_inputs::TouchInputs;
use crate::studies::recognition::sweep::configurations::{StudyPart, Sweep};
use crate::studies::recognition::tables::published::{check_published, compare_with_published};
use crate::studies::recognition::tables::tabulate::tabulate;
use crate::studies::study::run_whole;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// A combination of a study's own axes: their values, the plan, and the touches that are learned and those that are tested.
pub type StudyVariant = (AxisValues, Plan, [Arc<dyn TouchSet + Send>; 2]);

/// A recognition study that is laid out.
pub struct RecognitionStudy {
    /// One for each combination of the study's own axes; one alone where it has none.
    parts: Vec<StudyPart>,
    /// How large it is.
    pub(crate) scale: Scale,
    /// A few touches for the eye, once something showed them.
    samples: Shared<Samples>,
    /// All touches that are made, those of the same content once.
    pub(crate) touch_sets: Vec<Touches>,
    /// All groups, part by part.
    pub(crate) groups: Vec<PlacedGroup>,
    /// All families, group by group.
    pub(crate) families: Vec<Family>,
}

/// Touches of an array that are made, with so many frames each.
pub(crate) struct Touches {
    /// The first group that reads them.
    pub group: usize,
    /// Whether that group reads them as test touches only.
    is_tested: bool,
    /// Hash of all that they are made of, beside the files of objects.
    pub content: String,
}

/// A group of a part.
pub(crate) struct PlacedGroup {
    /// Its part.
    pub part: usize,
    /// Its place in the part's sweep.
    place: usize,
    /// Its touches.
    pub touches: usize,
    /// Its test touches; the same number unless the study has `[test]`.
    pub tested: usize,
    /// The first group that reads and measures the same.
    pub measured_as: usize,
}

/// A [family](Group::families) of cells: its group, and which cells of that.
pub(crate) struct Family {
    pub group: usize,
    pub cells: Range<usize>,
}

impl RecognitionStudy {
    /// Lays out a plan and its touches.
    ///
    /// # Errors
    /// Objects or touches that are too few, or are shown without being there.
    pub fn new(plan: Plan, touched: Box<dyn TouchSet + Send>) -> Result<Self> {
        if plan.tested.is_some() {
            let allowed = "RecognitionStudy::load, which draws test touches too";
            return Err(Error::input(
                "key test",
                "touches of training alone",
                allowed,
            ));
        }
        let touched: Arc<dyn TouchSet + Send> = touched.into();
        let touched = [touched.clone(), touched];
        Self::of_variants(vec![(AxisValues::default(), plan, touched)])
    }

    /// Lays out all combinations of a study's own axes, each with the touches that are learned and those that are tested.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn of_variants(variants: Vec<StudyVariant>) -> Result<Self> {
        let mut study = Self {
            parts: Vec::with_capacity(variants.len()),
            scale: Scale::default(),
            samples: Shared::default(),
            touch_sets: Vec::new(),
            groups: Vec::new(),
            families: Vec::new(),
        };
        let mut n_cells = 0;
        for (variant, plan, [touched, tested]) in variants {
            check_counterparts(touched.as_ref(), tested.as_ref())?;
            let mut sweep = Sweep::new(&plan, touched.as_ref())?;
            sweep.place(n_cells, &variant);
            n_cells += sweep.n_cells();
            study.parts.push(StudyPart {
                plan,
                touched,
                tested,
                sweep,
            });
        }
        let cells: Vec<&Cell> = study.all_cells().collect();
        let report = &study.first().plan.spec.report;
        check_published(&report.published, &cells)?;
        // The matrices tell the chance of a guess in each cell.
        let n_objects = |part: &StudyPart| part.touched.class_names().len();
        let n_first = n_objects(study.first());
        let differ = study.parts.iter().any(|part| n_objects(part) != n_first);
        if differ && report.confusion == ConfusionMatrices::Best {
            let allowed = "all, because configurations differ in their number of objects";
            return Err(Error::input("key report.confusion", "best", allowed));
        }
        study.place_groups();
        Ok(study)
    }

    /// Lists groups and families, and finds which groups have the same touches and measurements.
    fn place_groups(&mut self) {
        let mut known_touches: HashMap<String, usize> = HashMap::new();
        let mut known_groups: HashMap<String, usize> = HashMap::new();
        for (part, StudyPart { plan, sweep, .. }) in self.parts.iter().enumerate() {
            let touched = [plan, plan.tested.as_deref().unwrap_or(plan)];
            let touched = touched.map(|plan| (plan, TouchInputs::of(plan).content()));
            for (place, group) in sweep.groups.iter().enumerate() {
                let number = self.groups.len();
                let mut place_touches = |of: usize| {
                    let (plan, touched) = &touched[of];
                    let array = &plan.arrays[group.array];
                    let content = format!("{touched} {array:?} {}", group.frames);
                    let content = short_hash(content, DIGITS);
                    *known_touches.entry(content.clone()).or_insert_with(|| {
                        self.touch_sets.push(Touches {
                            group: number,
                            is_tested: of > 0,
                            content,
                        });
                        self.touch_sets.len() - 1
                    })
                };
                let [touches, tested] = [0, 1].map(&mut place_touches);
                let inputs = group.inputs(plan);
                let trials = (0..plan.spec.trials).map(|trial| inputs.trial(sweep, trial));
                let splits: Vec<_> = trials.map_while(|trial| trial.split).collect();
                let content = format!("{touches} {tested} {} {splits:?}", inputs.key());
                self.groups.push(PlacedGroup {
                    part,
                    place,
                    touches,
                    tested,
                    measured_as: *known_groups.entry(content).or_insert(number),
                });
                let mut start = 0;
                self.families.extend(group.families().map(|family| {
                    let cells = start..start + family.len();
                    start = cells.end;
                    Family {
                        group: number,
                        cells,
                    }
                }));
            }
        }
    }

    /// The first combination of the study's own axes: all of a study without any.
    pub fn first(&self) -> &StudyPart {
        &self.parts[0]
    }

    /// All combinations.
    pub fn parts(&self) -> &[StudyPart] {
        &self.parts
    }

    /// The combination that a cell is of, by its number; the last for a cell that the study does not have.
    pub fn part_of(&self, cell: usize) -> &StudyPart {
        let has_it = |part: &&StudyPart| part.sweep.cells().any(|known| known.cell == cell);
        self.parts
            .iter()
            .find(has_it)
            .unwrap_or_else(|| self.first())
    }

    /// All cells, in the order of their numbers.
    pub fn all_cells(&self) -> impl Iterator<Item = &Cell> {
        self.parts.iter().flat_map(|part| part.sweep.cells())
    }

    /// How many.
    pub fn n_cells(&self) -> usize {
        self.parts.iter().map(|part| part.sweep.n_cells()).sum()
    }

    /// Arrays on which touches are made.
    pub fn n_arrays(&self) -> usize {
        let made = (0..self.touch_sets.len()).map(|touches| self.made_on(touches));
        let arrays = made.map(|(part, array, _)| (part, array));
        arrays.collect::<HashSet<_>>().len()
    }

    /// SHA-256 of what each object is made of, by its name and, where combinations of the study's own axes differ in it, by those.
    ///
    /// # Errors
    /// A file of an object cannot be read.
    pub fn content(&self) -> Result<BTreeMap<String, String>> {
        let mut all = BTreeMap::new();
        let plans = self.parts.iter().map(|part| &part.plan);
        let specs =
            plans.flat_map(|plan| [Some(&plan.spec), plan.tested.as_ref().map(|t| &t.spec)]);
        let specs = specs.flatten();
        let mut made_of: Vec<(&ObjectsSpec, &Option<RecordedSpec>)> =
            specs.map(|spec| (&spec.objects, &spec.recorded)).collect();
        made_of.dedup();
        for (objects, recorded) in made_of {
            let recorded = recorded.as_ref().map(RecordedSpec::content).transpose()?;
            let content = objects_content(objects)?.into_iter();
            for (name, hash) in content.chain(recorded.into_iter().flatten()) {
                let known = all.entry(name.clone()).or_insert_with(|| hash.clone());
                if *known != hash {
                    all.insert(format!("{name} of {}", &hash[..12]), hash);
                }
            }
        }
        Ok(all)
    }

    /// Trials of each cell.
    pub(crate) fn n_trials(&self) -> usize {
        self.first().plan.spec.trials
    }

    /// A group with its part.
    pub(crate) fn group(&self, number: usize) -> (&StudyPart, &Group) {
        let PlacedGroup { part, place, .. } = self.groups[number];
        let part = &self.parts[part];
        (part, &part.sweep.groups[place])
    }

    /// The cells of a family, with their part.
    pub(crate) fn family(&self, family: usize) -> (&StudyPart, &[Cell]) {
        let Family { group, cells } = &self.families[family];
        let (part, group) = self.group(*group);
        (part, &group.cells[cells.clone()])
    }

    /// The number of a family in a trial as a work item.
    pub(crate) fn family_item(&self, trial: usize, family: usize) -> usize {
        trial * self.families.len() + family
    }

    /// The number of touches as a work item.
    pub(crate) fn touches_item(&self, touches: usize) -> usize {
        self.family_item(self.n_trials(), 0) + touches
    }

    /// The part and the array, by their numbers, that touches are made on, and their frames.
    pub(crate) fn made_on(&self, touches: usize) -> (usize, usize, usize) {
        let group = self.touch_sets[touches].group;
        let (_, Group { array, frames, .. }) = self.group(group);
        (self.groups[group].part, *array, *frames)
    }

    /// Returns what is touched, on what array, and the number of frames.
    pub(crate) fn on(&self, touches: usize) -> (&dyn TouchSet, &TaxelArray, usize) {
        let Touches {
            group, is_tested, ..
        } = self.touch_sets[touches];
        let (part, group) = self.group(group);
        let (plan, touched) = match (&part.plan.tested, is_tested) {
            (Some(tested), true) => (tested.as_ref(), part.tested.as_ref()),
            _ => (&part.plan, part.touched.as_ref()),
        };
        (touched, &plan.arrays[group.array], group.frames)
    }

    /// Returns the number of frames that the first values of the axes of some touches have.
    pub(crate) fn first_frames(&self, touches: usize) -> usize {
        self.group(self.touch_sets[touches].group).0.plan.frames[0]
    }

    /// What it took to make and to measure touches.
    fn stages(&self, rows: &[TouchRow]) -> Vec<StageTime> {
        let mut stages = Vec::new();
        for on in 0..self.touch_sets.len() {
            let (_, array, n_frames) = self.on(on);
            let (ny, nx) = array.shape();
            for (stage, is_made) in [("simulate", true), ("measure", false)] {
                let rows = rows.iter().filter(|row| row.on == on);
                let rows: Vec<&TouchRow> = rows.filter(|row| row.is_made == is_made).collect();
                if rows.is_empty() {
                    continue;
                }
                let n_touches = rows.iter().map(|row| row.n_touches).sum();
                let cpu_s: f64 = rows.iter().map(|row| row.cpu_s).sum();
                stages.push(StageTime {
                    stage: in_frames(stage, n_frames),
                    pitch_mm: millimetres(array.pitch()),
                    nx,
                    ny,
                    n_touches,
                    cpu_s,
                    us_per_touch: 1e6 * cpu_s / n_touches as f64,
                });
            }
        }
        stages
    }
}

/// Refuses test touches that are not one for one those of the study.
fn check_counterparts(touched: &dyn TouchSet, tested: &dyn TouchSet) -> Result<()> {
    let (learned, shown) = (touched.classes(), tested.classes());
    if learned == shown {
        return Ok(());
    }
    let said = |classes: &[(&str, usize)]| {
        let said = classes.iter().map(|(name, n)| format!("{n} of {name}"));
        said.collect::<Vec<_>>().join(", ")
    };
    let allowed = format!(
        "as many of each object as the study has: {}",
        said(&learned)
    );
    Err(Error::input(
        "key test",
        format!("touches: {}", said(&shown)),
        allowed,
    ))
}

/// Hexadecimal digits of the hash of touches. Fewer: two sets of touches may be taken for each other.
const DIGITS: usize = 24;

impl RecognitionStudy {
    /// Runs all of it at once, keeps nothing, and ends at the first work item that fails.
    ///
    /// # Errors
    /// What an item fails of.
    pub fn run(&self, progress: &dyn Progress) -> Result<Tables> {
        self.outcome(run_whole(self, progress)?)
    }

    /// The tables of all rows, typed.
    ///
    /// # Errors
    /// Those of [`Study::tables`](crate::studies::study::Study::tables).
    pub fn outcome(&self, (cells, touches): RecognitionRows) -> Result<Tables> {
        let mut tables = Tables::default();
        let scored = cells.into_iter().map(|row| {
            let cell = &self.group(row.at.0).1.cells[row.at.1];
            (cell.clone(), row.evaluation)
        });
        let names: Vec<Vec<&str>> = self.parts.iter().map(|p| p.touched.class_names()).collect();
        let name = |cell: &Cell, label: usize| names[cell.variant.number][label].to_owned();
        let n_folds = |cell: &Cell| {
            let spec = &self.parts[cell.variant.number].plan.spec;
            spec.recognition.folds.unwrap_or(1)
        };
        let report = &self.first().plan.spec.report;
        tabulate(
            &mut tables,
            scored.collect(),
            name,
            n_folds,
            report.confusion,
        )?;
        tables.published = compare_with_published(&report.published, &tables.summary)?;
        tables.has_folds = self.first().plan.spec.recognition.folds.is_some();
        tables.stages = self.stages(&touches);
        tables.limits = self.limits(&tables.accuracy, &touches);
        Ok(tables)
    }

    /// A few touches for the eye, of the first combination of the study's own axes.
    pub(crate) fn samples(&self) -> Result<&Samples> {
        let first = self.first();
        let make = || first.touched.samples(&first.plan, &first.sweep.groups);
        self.samples.get(make)
    }
}

/// A stage's name, with the number of frames a touch where it is not one.
pub(crate) fn in_frames(stage: &str, n_frames: usize) -> String {
    match n_frames {
        1 => stage.to_owned(),
        n => format!("{stage}, {n} frames a touch"),
    }
}
