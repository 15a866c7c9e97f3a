//! Stability study: simulates all configurations and computes the result tables.

use crate::engine::work_items::pending::PendingItems;
use crate::engine::work_items::scale::{Scale, Stage};
use crate::engine::work_items::work_item::WorkItem;
use crate::error::Result;
use crate::inputs::units::millimetres;
use crate::studies::source::Source;
use crate::studies::stability::common::with_common;
use crate::studies::stability::configuration::measure;
use crate::studies::stability::peers::peer_rows;
use crate::studies::stability::plan::StabilityPlan;
use crate::studies::stability::rows::{
    Joints, Outcome, StabilityConfiguration, StabilityRow, StabilityScore, StabilitySummary,
    StabilityTime,
};
use crate::studies::stability::spec::{StabilityScene, StabilityStudySpec};
use crate::studies::study::{About, AnyFile, Facts, Findings, Resumes, Study, TableFiles};
use crate::studies::{found_and_cost, grouped};
use crate::table::{File, Table};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const CONFIGURATIONS: File<(StabilityConfiguration, StabilityScore)> =
    File::new("stability.csv", "Every configuration", "");
const SUMMARY: File<StabilitySummary> = File::new(
    "stability_summary.csv",
    "Scenes and methods",
    "Right: force balance and deflections within 1 %. Imbalance, deflection: largest relative errors of finished runs.",
)
.summary();
const TIMING: File<(StabilityConfiguration, StabilityTime)> =
    File::new("timing.csv", "Time of every configuration", "").of_times();
const JOINTS: File<Joints> = File::new(
    "joints.csv",
    "Taxels on joints",
    "Plungers on SkinSim's springs and dampers with an equal load per taxel on all arrays. The quasi-static method has no time steps; its time is for the whole solution.",
)
.summary()
.of_times();

/// Table files that every stability study writes.
const FILES: &[&dyn AnyFile] = &[&CONFIGURATIONS, &SUMMARY, &TIMING, &JOINTS];

impl Study for StabilityPlan {
    const ABOUT: About = About {
        table: "stability",
        words: "a study of where contact methods break",
        resumes: Resumes::ButFor(&["question", "expected", "stability.parts"]),
    };
    const TABLES: TableFiles = TableFiles {
        read: Some(read_tables),
        ..TableFiles::always(FILES)
    };

    type Spec = StabilityStudySpec;
    type Rows = Vec<StabilityRow>;

    fn load(source: &Source) -> Result<Self> {
        source.refuse_objects("a ball is what touches")?;
        source.refuse_seed("nothing is drawn at random")?;
        let spec = StabilityStudySpec::parse(&source.place, &source.text)?;
        Self::new(&source.place, &source.folder, spec)
    }

    fn facts(&self) -> Result<Facts> {
        Ok(Facts {
            notes: vec![(CONFIGURATIONS.name(), peer_rows(self)?.1)],
            ..Facts::new(&self.spec, BTreeMap::new())
        })
    }

    fn scale(&self) -> Scale {
        // Memory of a taxel: its state and its history; in an engine also its body, its joint and its contact.
        let taxel_bytes =
            |configuration: &StabilityConfiguration| match configuration.method.is_engine() {
                true => 2e4,
                false => 2e3,
            };
        let configurations = self
            .configurations
            .iter()
            .map(|(configuration, _)| configuration);
        let bytes = configurations
            .clone()
            .map(|one| taxel_bytes(one) * one.n_taxels() as f64);
        let most = configurations
            .map(StabilityConfiguration::n_taxels)
            .max()
            .unwrap_or(0);
        Scale {
            objects: "a ball and a plunger".to_owned(),
            touches: format!("one a configuration, on up to {most} taxels"),
            n_configurations: self.configurations.len(),
            stages: vec![Stage {
                bytes: 0.0,
                items: bytes.collect(),
            }],
            ..Scale::default()
        }
    }

    /// Returns all work items. Work items are named by their settings, because the list of configurations depends on the features of the build.
    fn work_items(&self) -> Vec<WorkItem> {
        let items = self.configurations.iter().enumerate();
        let items = items.map(|(group, (configuration, taxel))| {
            let settings = format!("{configuration:?}");
            let settings = settings.trim_start_matches("StabilityConfiguration ");
            let stroke_mm = millimetres(taxel.stroke);
            let name = format!("{settings} and a stroke of {stroke_mm} mm");
            WorkItem::new(name, group)
        });
        items.collect()
    }

    fn measure(&self, left: &PendingItems<Self::Rows>) -> Result<()> {
        left.progress.stage("stability", left.n() as u64);
        let configurations = self.configurations.par_iter().enumerate();
        // Work items are distributed one by one, because their times range from microseconds to a minute.
        let configurations = configurations.with_max_len(1);
        configurations.try_for_each(|(number, (configuration, undamped))| {
            left.finish(number, || {
                let (score, time) = measure(configuration, *undamped)?;
                Ok(vec![(configuration.clone(), score, time)])
            })
        })
    }

    fn tables(&self, mut rows: Self::Rows) -> Result<Vec<Table>> {
        let (peers, _) = peer_rows(self)?;
        // Rows of other programs follow the rows of the parts that contain their configuration.
        for row in peers {
            let behind =
                rows.partition_point(|(configuration, ..)| configuration.part <= row.0.part);
            rows.insert(behind, row);
        }
        let [configurations, timing] = found_and_cost(&CONFIGURATIONS, &TIMING, &rows)?;
        let summary = SUMMARY.table(&summary(&rows))?;
        let joints = JOINTS.table(&joints(&rows))?;
        with_common(vec![configurations, summary, timing, joints])
    }

    fn findings(&self, tables: &[Table]) -> Findings {
        let charts = self.charts(tables);
        Findings {
            answers: self.answers(&charts),
            charts,
        }
    }
}

/// Reads all tables of a result folder.
fn read_tables(folder: &Path) -> Result<Vec<Table>> {
    TableFiles::always(FILES).read(folder).and_then(with_common)
}

/// Returns one row for each scene, method and number of iterations, with counts of the outcomes, in the order of first occurrence.
fn summary(rows: &[StabilityRow]) -> Vec<StabilitySummary> {
    let settings = grouped(rows, |(configuration, ..)| {
        (
            configuration.scene,
            configuration.method,
            configuration.solver_iterations,
        )
    });
    let summarise = |((scene, method, solver_iterations), rows): (_, Vec<&StabilityRow>)| {
        let scores: Vec<&StabilityScore> = rows.iter().map(|(_, score, _)| score).collect();
        let count = |outcome| scores.iter().filter(|s| s.outcome == outcome).count();
        let worst = |error: fn(&StabilityScore) -> Option<f64>| {
            let errors = scores.iter().filter_map(|score| error(score));
            errors.reduce(f64::max)
        };
        StabilitySummary {
            scene,
            method,
            solver_iterations,
            n_configurations: scores.len(),
            n_correct: count(Outcome::Right),
            n_inaccurate: count(Outcome::Inaccurate),
            n_missed_contact: count(Outcome::MissedContact),
            n_energy_growth: count(Outcome::EnergyGrowth),
            n_not_finite: count(Outcome::NotFinite),
            worst_force_imbalance: worst(|score| score.force_imbalance),
            worst_deflection_error: worst(|score| score.deflection_error),
        }
    };
    settings.into_iter().map(summarise).collect()
}

/// Minimum number of array sizes, with equal load per taxel, in a series of growing arrays.
const MIN_ARRAY_SIZES: usize = 3;

/// Returns the results of the plunger scene for the load per taxel that was simulated on the most array sizes. Returns no rows if fewer than three array sizes
/// share a load.
fn joints(rows: &[StabilityRow]) -> Vec<Joints> {
    let plungers = rows.iter();
    let plungers =
        plungers.filter(|(configuration, ..)| configuration.scene == StabilityScene::Plunger);
    let mut all: Vec<Joints> = plungers
        .map(|(configuration, score, time)| Joints {
            method: configuration.method,
            solver_iterations: configuration.solver_iterations,
            taxel_mass_kg: configuration.taxel_mass_kg,
            dt_s: configuration.dt_s,
            joints: configuration.n_taxels(),
            load_kg: carried(configuration),
            outcome: score.outcome,
            time_s: time.per_simulated_s.unwrap_or(time.wall_s),
        })
        .collect();
    let n_sizes = |load: f64| {
        let of_load = all.iter().filter(|row| row.load_kg == load);
        of_load.map(|row| row.joints).collect::<BTreeSet<_>>().len()
    };
    let loads = all.iter().map(|row| row.load_kg);
    let most = loads.max_by_key(|&load| n_sizes(load));
    let most = most.filter(|&load| n_sizes(load) >= MIN_ARRAY_SIZES);
    all.retain(|row| most == Some(row.load_kg));
    all
}

/// Returns the ball's mass divided by the number of taxels, kg, rounded so that equal loads compare equal.
fn carried(configuration: &StabilityConfiguration) -> f64 {
    let load = configuration.object_mass_kg.unwrap_or(0.0) / configuration.n_taxels() as f64;
    let digits = format!("{load:.9e}");
    digits.parse().expect("a number is written as one")
}
