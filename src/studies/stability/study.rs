//! Stability study: simulates all configurations, reads the results of other programs for these configurations, and computes the result tables.

use crate::report::csv_tables::read_rows;
use crate::studies::prelude::*;
use crate::studies::shared_steps::{found_and_cost, grouped};
use crate::studies::stability::charts::{answers, charts, with_common};
use crate::studies::stability::configuration::measure;
use crate::studies::stability::plan::*;
use crate::studies::stability::rows::*;
use crate::studies::stability::spec::*;
use crate::table::csv_place;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

impl Study for StabilityPlan {
    const ABOUT: About = About {
        table: "stability",
        words: "a study of where contact methods break",
    };
    const TABLES: TableFiles = TableFiles::always(&[&CONFIGURATIONS, &SUMMARY, &TIMING, &JOINTS]);

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
        let bytes = |(configuration, _): &(StabilityConfiguration, Taxel)| {
            let of_taxel = match configuration.method.is_engine() {
                true => 2e4,
                false => 2e3,
            };
            of_taxel * configuration.n_taxels() as f64
        };
        let configurations = self.configurations.iter();
        let n_taxels = configurations.clone().map(|(of, _)| of.n_taxels());
        let most = n_taxels.max().unwrap_or(0);
        Scale {
            objects: "a ball and a plunger".to_owned(),
            touches: format!("one a configuration, on up to {most} taxels"),
            n_configurations: self.configurations.len(),
            stages: vec![Stage {
                bytes: 0.0,
                items: configurations.map(bytes).collect(),
            }],
            ..Scale::default()
        }
    }

    fn work_items(&self) -> Vec<WorkItem> {
        let configurations = self.configurations.iter();
        let configurations = configurations.map(|(of, taxel)| (of, taxel.stroke));
        work_items_of::<Self, _, _>(&self.spec, configurations)
    }

    fn measure(&self, left: &PendingItems<Self::Rows>) -> Result<()> {
        left.each(
            "stability",
            &self.configurations,
            |(configuration, undamped)| {
                let (score, time) = measure(configuration, *undamped)?;
                Ok(vec![(configuration.clone(), score, time)])
            },
        )
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

    fn read_tables(folder: &Path) -> Result<Vec<Table>> {
        with_common(Self::TABLES.read(folder)?)
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts(tables)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers(self, tables)
    }
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

/// Returns the results of other programs for the configurations of the plan, and their source, such as `MuJoCo 4.0.0, 2026-11-22`. Each row stands in the
/// first part of the study that contains its scene. The result is empty if there is no file.
///
/// # Errors
/// If the file is not a table of such rows, or a row belongs to no scene of the study or repeats another row; the error names the file and the line.
pub(super) fn peer_rows(plan: &StabilityPlan) -> Result<(Vec<StabilityRow>, String)> {
    let Some(path) = plan.peers.as_ref().filter(|path| path.exists()) else {
        return Ok(Default::default());
    };
    // Each line is read once for each struct, because serde's flattening reads an empty field as an empty text.
    let configurations = read_rows::<StabilityConfiguration>(path)?.into_iter();
    let found = configurations.zip(read_rows(path)?).zip(read_rows(path)?);
    let found = found.zip(read_rows::<PeerColumns>(path)?);
    let mut sources: Vec<String> = Vec::new();
    let mut rows: Vec<StabilityRow> = Vec::new();
    for (line, (((configuration, score), time), peer)) in (2..).zip(found) {
        let configuration = placed(plan, configuration, &peer)
            .ok_or("a scene and a method that the study lacks")
            .and_then(|one| match rows.iter().any(|(known, ..)| *known == one) {
                true => Err("a configuration of an earlier line"),
                false => Ok(one),
            })
            .map_err(|given| refuse(path, line, given))?;
        rows.push((configuration, score, time));
        let source = format!("{} {}, {}", peer.program, peer.version, peer.date);
        if !sources.contains(&source) {
            sources.push(source);
        }
    }
    Ok((rows, sources.join("; ")))
}

/// Returns a configuration of another program's method as it stands in the plan: in the first part that contains its scene. Returns `None` if no part does.
/// Scenes are equal if all their parameters are equal; the part and the method do not belong to a scene.
fn placed(
    plan: &StabilityPlan,
    configuration: StabilityConfiguration,
    peer: &PeerColumns,
) -> Option<StabilityConfiguration> {
    let (radius, stroke) = (0.5 * peer.pitch_mm * MM, peer.stroke_mm * MM);
    let mut others = plan.all_methods.iter();
    let part = others.find_map(|(other, taxel)| {
        let of_scene = StabilityConfiguration {
            part: configuration.part,
            method: configuration.method,
            solver_iterations: configuration.solver_iterations,
            ..other.clone()
        };
        let is_equal =
            of_scene == configuration && (taxel.radius, taxel.stroke) == (radius, stroke);
        is_equal.then_some(other.part)
    })?;
    let is_peer = configuration.method.is_peer();
    is_peer.then_some(StabilityConfiguration {
        part,
        ..configuration
    })
}

fn refuse(path: &Path, line: u64, given: &str) -> Error {
    let allowed =
        "rows of the study's own scenes, each once, as benches/peers/stability.py writes them";
    Error::input(csv_place(path, Some(line)), given, allowed)
}
