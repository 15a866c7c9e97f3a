//! Reconstruction study: simulates touches and computes dictionaries once, then reconstructs frames with every configuration.

use crate::engine::progress::Progress;
use crate::engine::work_items::pending::PendingItems;
use crate::engine::work_items::scale::Scale;
use crate::engine::work_items::shared::Shared;
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use crate::inputs::keys::KeyAbout;
use crate::inputs::object_files::{load_objects, objects_content};
use crate::random::Seed;
use crate::report::study_content::Beyond;
use crate::studies::found_and_cost;
use crate::studies::recognition::tables::table_files::set_noise_unit;
use crate::studies::recognition::touches::drawn_touches::{TouchedObject, draw_touches};
use crate::studies::reconstruction::measured::measure_cells;
use crate::studies::reconstruction::memory::memory;
use crate::studies::reconstruction::plan::ReconstructionPlan;
use crate::studies::reconstruction::plan::reconstruction_keys;
use crate::studies::reconstruction::rows::{
    EnsembleStatistics, ReconstructionConfiguration, ReconstructionPareto, ReconstructionRows,
    ReconstructionScore, ReconstructionTime,
};
use crate::studies::reconstruction::score::pareto;
use crate::studies::reconstruction::spec::ReconstructionStudySpec;
use crate::studies::reconstruction::touches::Touches;
use crate::studies::source::Source;
use crate::studies::study::{About, AnyFile, Facts, Findings, Resumes, Study, TableFiles};
use crate::table::{File, Table};
use std::collections::BTreeMap;
use std::path::Path;

/// Reconstruction study: its plan, its objects and their touches.
pub struct ReconstructionStudy {
    /// Plan of the study: the checked values of its keys, in SI units.
    pub plan: ReconstructionPlan,
    /// Objects of the study with their touches.
    pub touched: Vec<TouchedObject>,
    /// Frames of all touches, simulated when they are first needed.
    frames: Shared<Touches>,
}

const CONFIGURATIONS: File<(ReconstructionConfiguration, ReconstructionScore)> = File::new(
    "reconstruction.csv",
    "Every configuration",
    "Errors are relative to the clean frames: 0 is perfect, 1 is as wrong as an empty frame.",
);
const ENSEMBLES: File<EnsembleStatistics> = File::new(
    "ensembles.csv",
    "Isometry of ensembles and dictionaries",
    "Squared singular values of supports drawn at random, whose columns have a mean square norm of 1.",
);
const TIMING: File<(ReconstructionConfiguration, ReconstructionTime)> =
    File::new("timing.csv", "Time of every configuration", "").of_times();
const PARETO: File<(ReconstructionConfiguration, ReconstructionPareto)> = File::new(
    "pareto.csv",
    "Error and time of every configuration",
    "One core, frames in blocks of 64.",
)
.summary()
.of_times();

/// Table files that every reconstruction study writes.
const FILES: &[&dyn AnyFile] = &[&CONFIGURATIONS, &ENSEMBLES, &TIMING, &PARETO];
/// Name of the table of errors and times, which is not written to a file.
pub(super) const BOTH: &str = "configurations.csv";

impl Study for ReconstructionStudy {
    const ABOUT: About = About {
        table: "reconstruction",
        words: "a study that reconstructs frames",
        resumes: Resumes::ButFor(&[
            "question",
            "expected",
            "signal.noise_std_full_scale",
            "signal.noise_std_mm",
            "signal.noise_std_n",
            "sensing.ensemble",
            "sensing.ratio",
            "sensing.measurements",
            "reconstruction.solver",
            "reconstruction.dictionary",
        ]),
    };
    const TABLES: TableFiles = TableFiles {
        read: Some(read_tables),
        ..TableFiles::always(FILES)
    };

    type Spec = ReconstructionStudySpec;
    type Rows = ReconstructionRows;

    fn keys() -> Vec<KeyAbout> {
        reconstruction_keys()
    }

    fn load(source: &Source) -> Result<Self> {
        let mut spec = ReconstructionStudySpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed)?;
        source.replace_objects(&mut spec.objects);
        let plan = ReconstructionPlan::new(&source.place, spec)?;
        let objects = load_objects(&plan.spec.objects, source.packings.as_deref())?;
        let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed))?;
        Ok(Self {
            plan,
            touched,
            frames: Shared::default(),
        })
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.plan.spec;
        Ok(Facts::new(spec, objects_content(&spec.objects)?))
    }

    fn scale(&self) -> Scale {
        let n_touches: usize = self.touched.iter().map(|t| t.touches.len()).sum();
        let (bytes, stages) = memory(&self.plan, n_touches);
        Scale {
            objects: self.touched.len().to_string(),
            touches: format!("{n_touches} on one array"),
            n_configurations: self.plan.configurations().len(),
            bytes,
            stages,
        }
    }

    /// Returns all work items. For each ensemble and number of measurements, the items for isometry statistics come first, followed by the configurations.
    fn work_items(&self) -> Vec<WorkItem> {
        let mut items = Vec::new();
        for (group, configurations) in on_measured(&self.plan.configurations()).enumerate() {
            let mut add = |name| items.push(WorkItem::new(name, group));
            for &basis in &self.plan.dictionaries {
                add(configurations[0].isometry_name(basis));
            }
            for configuration in configurations {
                add(configuration.name());
            }
        }
        items
    }

    fn measure(&self, left: &PendingItems<ReconstructionRows>) -> Result<()> {
        let touches = self.frames(left.progress)?;
        left.progress.stage("reconstruct", left.n() as u64);
        let configurations = self.plan.configurations();
        let mut groups = on_measured(&configurations).enumerate();
        groups.try_for_each(|group| measure_cells((&self.plan, touches), group, left))
    }

    fn tables(&self, (mut rows, statistics): ReconstructionRows) -> Result<Vec<Table>> {
        // The configurations are renumbered, because the axes of an earlier run may have had other values.
        let numbers = self.plan.configurations().into_iter();
        let numbers: BTreeMap<String, usize> = numbers
            .map(|configuration| (configuration.name(), configuration.configuration))
            .collect();
        for (configuration, ..) in &mut rows {
            configuration.configuration = numbers[&configuration.name()];
        }
        let pareto = pareto(&rows, &self.plan.noise);
        let [configurations, timing] = found_and_cost(&CONFIGURATIONS, &TIMING, &rows)?;
        let ensembles = ENSEMBLES.table(&statistics)?;
        let pareto = PARETO.table(&pareto)?;
        Ok(with_both(
            [configurations, ensembles, timing, pareto].into(),
        ))
    }

    fn findings(&self, tables: &[Table]) -> Findings {
        Findings {
            charts: self.charts(tables),
            answers: self.answers(tables),
        }
    }

    fn beyond(&self, tables: &[Table]) -> Result<Beyond> {
        Ok(Beyond {
            pictures: self.pictures(tables)?,
            ..Beyond::default()
        })
    }
}

/// Reads all tables of a result folder.
fn read_tables(folder: &Path) -> Result<Vec<Table>> {
    TableFiles::always(FILES).read(folder).map(with_both)
}

/// Returns the tables in the order of their files, followed by a table of the error, its interval and the time of each configuration.
fn with_both(mut tables: Vec<Table>) -> Vec<Table> {
    tables.iter_mut().for_each(set_noise_unit);
    let (errors, pareto) = (&tables[0], &tables[3]);
    let time = errors.look_up(pareto, "configuration", "us_per_frame");
    let both = errors.with((BOTH, "Errors and times"), time);
    tables.push(both.noted(format!("{} {}", errors.note, pareto.note)));
    tables
}

/// Returns the configurations in groups; the configurations of a group reconstruct frames from equal measurements.
fn on_measured(
    configurations: &[ReconstructionConfiguration],
) -> impl Iterator<Item = &[ReconstructionConfiguration]> {
    configurations.chunk_by(|a, b| (a.ensemble, a.measurements) == (b.ensemble, b.measurements))
}

impl ReconstructionStudy {
    /// Returns the frames of all touches; simulates them at the first call.
    pub(super) fn frames(&self, progress: &dyn Progress) -> Result<&Touches> {
        let simulate = || Touches::simulate(&self.plan, &self.touched, progress);
        self.frames.get(simulate)
    }
}
