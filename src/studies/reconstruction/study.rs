//! Reconstruction study: simulates touches and computes dictionaries once, then reconstructs frames with every configuration. Its memory is estimated before.

use crate::inputs::sensor_errors::NOISES;
use crate::sensing::{PCA_ATOMS, Solver};
use crate::studies::prelude::*;
use crate::studies::recognition::spec::keys::keys_without_axes;
use crate::studies::recognition::tables::table_files::set_noise_unit;
use crate::studies::reconstruction::charts::{CHARTS, answers};
use crate::studies::reconstruction::measured::measure_cells;
use crate::studies::reconstruction::plan::*;
use crate::studies::reconstruction::rows::*;
use crate::studies::reconstruction::touches::{Touches, pareto};
use crate::studies::shared_steps::found_and_cost;
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

impl Study for ReconstructionStudy {
    const ABOUT: About = About {
        table: "reconstruction",
        words: "a study that reconstructs frames",
    };
    const TABLES: TableFiles = TableFiles::always(&[&CONFIGURATIONS, &ISOMETRY, &TIMING, &PARETO]);

    const CHARTS: &'static [Chart] = CHARTS;

    type Spec = ReconstructionStudySpec;
    type Rows = ReconstructionRows;

    fn keys() -> Vec<KeyAbout> {
        let noise = NOISES.map(|(key, _)| format!("signal.{key}"));
        let lists = noise.iter().map(String::as_str);
        let lists: Vec<&str> = lists.chain(["sensing", "reconstruction"]).collect();
        keys_without_axes(keys_of::<ReconstructionStudySpec>(), &lists)
    }

    fn load(source: &Source) -> Result<Self> {
        let mut spec = ReconstructionStudySpec::of(source)?;
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
        let shared = shared_inputs(&self.plan.spec, &Self::keys());
        let sizes = &self.plan.spec.reconstruction.isometry_sparsity;
        let mut items = Vec::new();
        for (group, configurations) in on_measured(&self.plan.configurations()).enumerate() {
            for &basis in &self.plan.dictionaries {
                let name = configurations[0].isometry_name(basis);
                let of = &configurations[0];
                let inputs = (&shared, of.ensemble, of.measurements, basis, sizes);
                items.push(WorkItem::of(name, group, &inputs));
            }
            for configuration in configurations {
                let unnumbered = ReconstructionConfiguration {
                    configuration: 0,
                    ..configuration.clone()
                };
                let inputs = (&shared, unnumbered);
                items.push(WorkItem::of(configuration.name(), group, &inputs));
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

    fn place(&self, number: usize, (rows, _): &mut ReconstructionRows) {
        // In each group, the isometry items of all dictionaries come before the configurations.
        let n_dictionaries = self.plan.dictionaries.len();
        let n_solvers = self.plan.spec.reconstruction.solver.values().len();
        let n_in_group = n_dictionaries * (1 + self.plan.noise.len() * n_solvers);
        let n_isometries = (number / n_in_group + 1) * n_dictionaries;
        for (configuration, ..) in rows {
            configuration.configuration = number - n_isometries;
        }
    }

    fn tables(&self, (rows, statistics): ReconstructionRows) -> Result<Vec<Table>> {
        let pareto = pareto(&rows, &self.plan.noise);
        let [configurations, timing] = found_and_cost(&CONFIGURATIONS, &TIMING, &rows)?;
        let ensembles = ISOMETRY.table(&statistics)?;
        let pareto = PARETO.table(&pareto)?;
        Ok(with_both(
            [configurations, ensembles, timing, pareto].into(),
        ))
    }

    fn read_tables(folder: &Path) -> Result<Vec<Table>> {
        Self::TABLES.read(folder).map(with_both)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers(tables)
    }

    fn beyond(&self, tables: &[Table]) -> Result<Beyond> {
        Ok(Beyond {
            pictures: self.sample_frames(tables)?,
            ..Beyond::default()
        })
    }
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

/// Memory of the charts and of the picture of sample frames, bytes.
const PICTURE_BYTES: f64 = 1.4e8;

/// Returns the memory of the frames of a study with `n_touches` touches, bytes, which the whole run keeps, and the memory of its stages.
pub(super) fn memory(plan: &ReconstructionPlan, n_touches: usize) -> (f64, Vec<Stage>) {
    let wanted = &plan.spec.reconstruction;
    let n = plan.array.n_taxels() as f64;
    let n_test = (n_touches as f64 * wanted.test_fraction).ceil();
    let n_train = n_touches as f64 - n_test;
    let atoms = |basis: &Basis| {
        let asked = wanted.atoms.map(|k| k as f64);
        match basis {
            Basis::Pca => asked.unwrap_or(PCA_ATOMS as f64).min(n).min(n_train),
            _ => asked.unwrap_or(n).min(n),
        }
    };
    let is_stored = |basis: &&Basis| **basis == Basis::Pca;
    let stored = plan.dictionaries.iter().filter(is_stored);
    let stored: f64 = stored.map(|basis| atoms(basis) * n).sum();
    // Test frames are kept without noise and at each noise level.
    let frames = n_train + n_test * (1.0 + plan.noise.len() as f64);
    let kept = 8.0 * (n * frames + stored);
    let is_linear = wanted.solver.values().contains(&Solver::Lmmse);
    let ensembles = plan.spec.sensing.ensemble.values().into_iter();
    let matrices = ensembles.flat_map(|ensemble| {
        let counts = plan.measurement_counts(ensemble).into_iter();
        counts.map(move |m| (ensemble, m as f64))
    });
    let matrices = matrices.map(|(ensemble, m)| {
        // Measured atoms and their Gram matrix, of each dictionary.
        let atoms = || plan.dictionaries.iter().map(atoms);
        let sensed: f64 = atoms().map(|k| k * m + k * k).sum();
        // The linear estimate needs the covariances of the measurements and of their noise, and its maps to coefficients and to frames.
        let linear = atoms().map(|k| {
            let map = if k * (m + n) < m * n { k * n } else { m * n };
            2.0 * k * m + 2.0 * m * m + map
        });
        let linear = match is_linear {
            true => linear.fold(0.0, f64::max),
            false => 0.0,
        };
        (ensemble.about().bytes)(m, n) + 8.0 * (sensed + linear + n_test * m)
    });
    let stages = [matrices.fold(0.0, f64::max), PICTURE_BYTES];
    (kept, stages.map(Stage::of_bytes).to_vec())
}
