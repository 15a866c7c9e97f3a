//! Recognition study with its work items and result tables.

use crate::studies::prelude::*;
use crate::studies::recognition::frames::{Samples, TouchSet};
use crate::studies::recognition::rows::{Prediction, Predictions, StageTime, Tables};
use crate::studies::recognition::spec::ConfusionMatrices;
use crate::studies::recognition::study::{RecognitionRows, TouchRow, set_content};
use crate::studies::recognition::sweep::{StudyPart, Sweep, TrainingRows};
use crate::studies::recognition::tables::published::{check_published, compare_with_published};
use crate::studies::recognition::tables::tabulate::tabulate;
use crate::studies::recognition::training::Evaluation;
use crate::studies::study::run_whole;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::Arc;

/// Part of the study to add: a combination of the values in `[axes]`, its plan, its training touches and its test touches.
pub type StudyVariant = (AxisValues, Plan, [Arc<dyn TouchSet + Send>; 2]);

/// Recognition study with its list of work items.
pub struct RecognitionStudy {
    /// Parts of the study, one for each combination of the values in `[axes]`; a single part if there are no axes.
    parts: Vec<StudyPart>,
    /// Size of the study: numbers of work items, memory and disk space.
    pub(crate) scale: Scale,
    /// Sample touches for pictures, computed at the first use.
    samples: Shared<Samples>,
    /// All distinct sets of touches that are simulated.
    pub(crate) touch_sets: Vec<Touches>,
    /// Families of configurations of all parts, ordered by part.
    pub(crate) families: Vec<Family>,
}

/// Set of touches to simulate on one array, with a fixed number of frames per touch.
pub(crate) struct Touches {
    /// Index of the part of the study that has these touches.
    pub part: usize,
    /// Number of frames per touch.
    pub n_frames: usize,
    /// Whether the touches serve only as test touches.
    is_tested: bool,
    /// Number of the first measurement of these touches.
    pub measurement: usize,
    /// Hash of all inputs that determine the touches, except the files of objects.
    pub content: String,
}

/// Family of configurations that use the same rows of features, with its position in the study.
pub(crate) struct Family {
    /// Index of the part of the study that contains the family.
    pub part: usize,
    /// Index of the family's group of configurations within the part.
    group: usize,
    /// Index range of the configurations in the group.
    configurations: Range<usize>,
    /// Training rows to which the measurements of the family are fitted.
    pub rows: TrainingRows,
    /// Number m of measurements per frame that are computed for the family.
    pub n_measurements: usize,
    /// Index of the training touches in the list of all sets of touches.
    pub touches: usize,
    /// Index of the test touches in the list of all sets of touches; equal to `touches` if the study has no table `[test]`.
    pub tested: usize,
    /// Number of the measurement, from 0. Families with equal numbers are evaluated on the same measurements.
    pub measurement: usize,
}

impl RecognitionStudy {
    /// Creates a study from one plan and its touches.
    ///
    /// # Errors
    /// If there are too few objects or touches, or a sample object does not exist.
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

    /// Creates a study from all combinations of axis values in `[axes]`, each with training and test touches.
    ///
    /// # Errors
    /// If there are too few objects or touches, or a sample object does not exist.
    pub fn of_variants(variants: Vec<StudyVariant>) -> Result<Self> {
        let mut study = Self {
            parts: Vec::with_capacity(variants.len()),
            scale: Scale::default(),
            samples: Shared::default(),
            touch_sets: Vec::new(),
            families: Vec::new(),
        };
        let mut n_configurations = 0;
        for (variant, plan, [touched, tested]) in variants {
            check_counterparts(touched.as_ref(), tested.as_ref())?;
            let mut sweep = Sweep::new(&plan, touched.as_ref())?;
            sweep.place(n_configurations, &variant);
            n_configurations += sweep.n_configurations();
            study.parts.push(StudyPart {
                plan,
                touched,
                tested,
                sweep,
            });
        }
        let configurations: Vec<&Configuration> = study.all_cells().collect();
        let report = &study.first().plan.spec.report;
        check_published(&report.published, &configurations)?;
        // Confusion matrices give the chance level of each configuration.
        let n_objects = |part: &StudyPart| part.touched.class_names().len();
        let n_first = n_objects(study.first());
        let differ = study.parts.iter().any(|part| n_objects(part) != n_first);
        if differ && report.confusion == ConfusionMatrices::Best {
            let allowed = "all, because configurations differ in their number of objects";
            return Err(Error::input("key report.confusion", "best", allowed));
        }
        study.place_families();
        Ok(study)
    }

    /// Lists all families of configurations, and determines those with equal touches or measurements. If smaller sets of measurements are prefixes of larger
    /// ones, a group is measured once for all its families. Otherwise, each number m of measurements is measured separately. So are training rows to which
    /// something is fitted.
    fn place_families(&mut self) {
        let mut known_touches: HashMap<String, usize> = HashMap::new();
        let mut measurements: HashMap<String, usize> = HashMap::new();
        for (part, of_part) in self.parts.iter().enumerate() {
            let StudyPart { plan, sweep, .. } = of_part;
            let plans = [plan, plan.tested.as_deref().unwrap_or(plan)];
            let sets = [&of_part.touched, &of_part.tested];
            let contents = [0, 1].map(|of| set_content(plans[of], sets[of].as_ref()));
            for (number, group) in sweep.groups.iter().enumerate() {
                let mut place_touches = |of: usize| {
                    let array = &plans[of].array;
                    let content = identity(&(&contents[of], array, group.frames));
                    *known_touches.entry(content.clone()).or_insert_with(|| {
                        self.touch_sets.push(Touches {
                            part,
                            n_frames: group.frames,
                            is_tested: of > 0,
                            measurement: measurements.len(),
                            content,
                        });
                        self.touch_sets.len() - 1
                    })
                };
                let [touches, tested] = [0, 1].map(&mut place_touches);
                let inputs = group.inputs(plan);
                let trials = (0..plan.spec.trials).map(|trial| inputs.trial(sweep, trial));
                let splits = trials.map_while(|trial| Some((trial.split?, trial.group_keys)));
                let splits: Vec<_> = splits.collect();
                let content = identity(&(touches, tested, &inputs, splits));
                let mut start = 0;
                for family in group.families() {
                    let configurations = start..start + family.len();
                    start = configurations.end;
                    let rows = inputs.fitted_rows(plan, group, &family[0]);
                    let n_measurements = match group.ensemble.is_prefix_nested() {
                        true => inputs.projected[0],
                        false => family[0].measurements,
                    };
                    let next = measurements.len();
                    let measured = identity(&(&content, rows, n_measurements));
                    self.families.push(Family {
                        part,
                        group: number,
                        configurations,
                        rows,
                        n_measurements,
                        touches,
                        tested,
                        measurement: *measurements.entry(measured).or_insert(next),
                    });
                }
            }
        }
    }

    /// Returns the part of the study that belongs to the first combination of the values in `[axes]`.
    pub fn first(&self) -> &StudyPart {
        &self.parts[0]
    }

    /// Returns the parts of the study, one for each combination of the values in `[axes]`.
    pub fn parts(&self) -> &[StudyPart] {
        &self.parts
    }

    /// Returns the parts of the study with the same values of the table `[axes]` as a part.
    pub(crate) fn alike(&self, part: usize) -> &[StudyPart] {
        let n_alike = self.first().plan.spec.axes.n_of_tables();
        let first = part - part % n_alike;
        &self.parts[first..self.parts.len().min(first + n_alike)]
    }

    /// Returns the distinct values of a property of the study's parts as text; see [`distinct`].
    pub(crate) fn of_parts(&self, value: impl Fn(&StudyPart) -> String) -> String {
        distinct(self.parts.iter().map(value))
    }

    /// Returns the keys of the table `[test]` with their values as text, without the keys that are axes; empty if there are none.
    pub(crate) fn test_keys(&self) -> String {
        let spec = &self.first().plan.spec;
        let mut keys = Vec::new();
        leaves("test", &spec.test, &mut keys);
        keys.retain(|(key, _)| !spec.axes.has(key));
        let keys: Vec<String> = keys
            .iter()
            .map(|(key, value)| format!("{key} = {value}"))
            .collect();
        keys.join(", ")
    }

    /// Returns the part of the study that contains the configuration with this number; the first part if no part contains it.
    pub fn part_of(&self, configuration: usize) -> &StudyPart {
        let mut cells = self.all_cells();
        let found = cells.find(|known| known.configuration == configuration);
        found.map_or(self.first(), |known| &self.parts[known.variant.number])
    }

    /// Returns all configurations of the study in the order of their numbers.
    pub fn all_cells(&self) -> impl Iterator<Item = &Configuration> {
        let parts = self.parts.iter();
        parts.flat_map(|part| part.sweep.configurations())
    }

    /// Returns the number of configurations of the study.
    pub fn n_configurations(&self) -> usize {
        self.all_cells().count()
    }

    /// Returns the number of different arrays on which touches are simulated.
    pub fn n_arrays(&self) -> usize {
        let sets = self.touch_sets.iter();
        let arrays = sets.map(|set| identity(&self.parts[set.part].plan.array));
        arrays.collect::<HashSet<_>>().len()
    }

    /// Returns the SHA-256 hash of each object's content, by the object's name, and of each file of a recording, by its key. If several parts of the study have
    /// different objects of one name, the hash is added to the name.
    ///
    /// # Errors
    /// If a file of an object cannot be read.
    pub fn content(&self) -> Result<BTreeMap<String, String>> {
        let mut all = BTreeMap::new();
        let plans = self.parts.iter().map(|part| &part.plan);
        let specs =
            plans.flat_map(|plan| [Some(&plan.spec), plan.tested.as_ref().map(|t| &t.spec)]);
        let specs = specs.flatten();
        let mut made_of: Vec<&ObjectsSpec> = specs.map(|spec| &spec.objects).collect();
        made_of.dedup();
        let mut content: Vec<(String, String)> = Vec::new();
        for objects in made_of {
            content.extend(objects_content(objects)?);
        }
        let sets = self
            .parts
            .iter()
            .flat_map(|part| [&part.touched, &part.tested]);
        let recorded = sets.filter_map(|set| set.recorded_content());
        content.extend(recorded.flat_map(|of| of.hashes.clone()));
        for (name, hash) in content {
            let known = all.entry(name.clone()).or_insert_with(|| hash.clone());
            if *known != hash {
                all.insert(format!("{name} of {}", &hash[..12]), hash);
            }
        }
        Ok(all)
    }

    /// Returns the number of trials per configuration.
    pub(crate) fn n_trials(&self) -> usize {
        self.first().plan.spec.trials
    }

    /// Returns the part of the study that contains a family, and the family's group of configurations.
    pub(crate) fn group(&self, family: usize) -> (&StudyPart, &MeasurementGroup) {
        let Family { part, group, .. } = self.families[family];
        let part = &self.parts[part];
        (part, &part.sweep.groups[group])
    }

    /// Returns the part of the study that contains a family, and the configurations of the family.
    pub(crate) fn family(&self, family: usize) -> (&StudyPart, &[Configuration]) {
        let (part, group) = self.group(family);
        let configurations = self.families[family].configurations.clone();
        (part, &group.configurations[configurations])
    }

    /// Returns the number of the work item that computes a family of configurations in a trial.
    pub(crate) fn family_item(&self, trial: usize, family: usize) -> usize {
        trial * self.families.len() + family
    }

    /// Returns the number of the work item that simulates and measures a set of touches.
    pub(crate) fn touches_item(&self, touches: usize) -> usize {
        self.family_item(self.n_trials(), 0) + touches
    }

    /// Returns the set of touches with this index, its array, and its number of frames per touch.
    pub(crate) fn on(&self, touches: usize) -> (&dyn TouchSet, &TaxelArray, usize) {
        let set = &self.touch_sets[touches];
        let part = &self.parts[set.part];
        let (plan, touched) = match (&part.plan.tested, set.is_tested) {
            (Some(tested), true) => (tested.as_ref(), part.tested.as_ref()),
            _ => (&part.plan, part.touched.as_ref()),
        };
        (touched, &plan.array, set.n_frames)
    }

    /// Returns the rows of `stages.csv`: the times to simulate and to measure the touches of each array.
    fn stages(&self, rows: &[TouchRow]) -> Vec<StageTime> {
        let mut stages = Vec::new();
        for on in 0..self.touch_sets.len() {
            let (_, array, n_frames) = self.on(on);
            let ImageShape { ny, nx } = array.shape();
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

/// Returns an error if test touches and training touches do not correspond one-to-one.
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

impl RecognitionStudy {
    /// Runs the whole study without a journal; the first failed work item ends the run.
    ///
    /// # Errors
    /// If an item fails.
    pub fn run(&self, progress: &dyn Progress) -> Result<Tables> {
        self.outcome(run_whole(self, progress)?)
    }

    /// Computes all result tables from the rows of the work items.
    ///
    /// # Errors
    /// If the trials of a configuration have no rows, or a file cannot be read.
    pub fn outcome(&self, (configurations, touches): RecognitionRows) -> Result<Tables> {
        let mut tables = Tables::default();
        let selected = configurations.iter();
        let selected = selected.filter(|row| !row.evaluation.selected.is_empty());
        let arrays = selected.map(|row| {
            let (part, configurations) = self.family(row.at.0);
            let number = configurations[row.at.1].configuration;
            (number, &part.plan.array)
        });
        let arrays: HashMap<usize, &TaxelArray> = arrays.collect();
        let place = |configuration: &Configuration, taxel: usize| {
            arrays.get(&configuration.configuration)?.place_mm(taxel)
        };
        let scored = configurations.into_iter().map(|row| {
            let configuration = &self.family(row.at.0).1[row.at.1];
            (configuration.clone(), row.evaluation)
        });
        let mut scored: Vec<(Configuration, Evaluation)> = scored.collect();
        tables.predictions = self.predictions(&mut scored);
        let names: Vec<Vec<&str>> = self.parts.iter().map(|p| p.touched.class_names()).collect();
        let name = |configuration: &Configuration, label: usize| {
            names[configuration.variant.number][label].to_owned()
        };
        let n_folds = |configuration: &Configuration| {
            let spec = &self.parts[configuration.variant.number].plan.spec;
            spec.recognition.folds.unwrap_or(1)
        };
        let report = &self.first().plan.spec.report;
        tabulate(&mut tables, scored, name, place, n_folds, report)?;
        tables.published = compare_with_published(&report.published, &tables.summary)?;
        tables.has_folds = self.first().plan.spec.recognition.folds.is_some();
        tables.stages = self.stages(&touches);
        tables.limits = self.limits(&tables.accuracy, &touches);
        Ok(tables)
    }

    /// Moves the decisions out of the evaluations and returns them as rows, ordered by configuration and trial.
    fn predictions(&self, scored: &mut [(Configuration, Evaluation)]) -> Predictions {
        let mut made = Predictions::default();
        if !self.first().plan.spec.report.predictions {
            return made;
        }
        let classes: Vec<Vec<&str>> = self.parts.iter().map(|p| p.touched.class_names()).collect();
        let touches: Vec<Vec<String>> = self.parts.iter().map(|p| p.tested.touch_names()).collect();
        let mut places: HashMap<&str, usize> = HashMap::new();
        for &class in classes.iter().flatten() {
            places.entry(class).or_insert_with(|| {
                made.classes.push(class.to_owned());
                made.classes.len() - 1
            });
        }
        scored.sort_by_key(|(configuration, evaluation)| {
            (configuration.configuration, evaluation.score.trial)
        });
        for (configuration, evaluation) in scored {
            let part = configuration.variant.number;
            let (classes, touches) = (&classes[part], &touches[part]);
            for one in evaluation.decided.drain(..) {
                let mut scores = vec![f64::NAN; made.classes.len()];
                for (class, score) in classes.iter().zip(&one.scores) {
                    scores[places[class]] = score.unwrap_or(f64::NAN);
                }
                let names = one.touches.iter().map(|&touch| &touches[touch][..]);
                let names_of = self.parts[part].tested.group_names();
                let name = |group: &usize| {
                    names_of
                        .get(*group)
                        .map_or_else(|| group.to_string(), String::clone)
                };
                let groups: Vec<String> = one.groups.iter().map(name).collect();
                let row = Prediction {
                    configuration: configuration.configuration,
                    trial: evaluation.score.trial,
                    touch: names.collect::<Vec<_>>().join(" "),
                    group: groups.join(" "),
                    truth: classes[one.truth].to_owned(),
                    answer: classes[one.answer].to_owned(),
                };
                made.rows.push((row, scores));
            }
        }
        made
    }

    /// Returns the sample touches for pictures, from the first combination of the values in `[axes]`.
    pub(crate) fn samples(&self) -> Result<&Samples> {
        let alike = self.alike(0);
        self.samples.get(|| {
            let parts = alike
                .iter()
                .map(|part| (&part.plan, &part.sweep.groups[..]));
            let mut samples = self.first().touched.samples(&parts.collect::<Vec<_>>())?;
            if self.parts.len() > alike.len() {
                let pictures = std::iter::once(&mut samples.shown).chain(&mut samples.each);
                pictures.for_each(|one| one.caption += ", at the first value of each axis");
            }
            Ok(samples)
        })
    }
}

/// Returns the distinct texts in the order of their first occurrence. Of more than eight texts, only the first and the last are listed.
pub(crate) fn distinct(texts: impl Iterator<Item = String>) -> String {
    let mut known = HashSet::new();
    let texts: Vec<String> = texts.filter(|text| known.insert(text.clone())).collect();
    match &texts[..] {
        [first, .., last] if texts.len() > 8 => {
            format!("{} values from {first} to {last}", texts.len())
        }
        _ => texts.join("; "),
    }
}

/// Appends the values of a TOML table and of its subtables, each with its path below `prefix`.
fn leaves<'t>(prefix: &str, table: &'t toml::Table, found: &mut Vec<(String, &'t toml::Value)>) {
    for (name, value) in table {
        let path = format!("{prefix}.{name}");
        match value {
            toml::Value::Table(inner) => leaves(&path, inner, found),
            value => found.push((path, value)),
        }
    }
}

/// Returns the name of a stage, as it is written in the table of stages. If touches have several frames, the number of frames per touch is added.
pub(crate) fn in_frames(stage: &str, n_frames: usize) -> String {
    match n_frames {
        1 => stage.to_owned(),
        n => format!("{stage}, {n} frames a touch"),
    }
}
