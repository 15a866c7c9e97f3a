//! Stability study: the limits of contact simulation methods.

use crate::command::{Case, says};
use bubbletouch::kinds::stability::rows::{
    Joints, StabilityConfiguration, StabilityScore, StabilitySummary,
};
use bubbletouch::kinds::stability::{ContactMethod, Outcome, StabilityScene, TOLERANCE};
use bubbletouch::report::csv_tables::read_rows;
use std::fs;

const QUICK: &str = include_str!("../../fixtures/texts/stability_quick.toml");

#[test]
fn ours_is_right_everywhere_and_the_others_break_where_they_must() {
    let case = Case::new();
    case.file("study.toml", QUICK);
    let (said, _) = case.succeeds(&["run", "study.toml", "--out", "1"]);
    says(&said, &["quasi-static"]);
    let path = case.path("1/stability.csv");
    let configurations: Vec<StabilityConfiguration> = read_rows(&path).unwrap();
    let scores: Vec<StabilityScore> = read_rows(&path).unwrap();
    assert_eq!(configurations.len(), 3 * (16 + 4 + 4));
    for (configuration, score) in configurations.iter().zip(&scores) {
        let about = format!("{configuration:?} {score:?}");
        match configuration.method {
            ContactMethod::QuasiStatic => {
                assert_eq!(score.outcome, Outcome::Right, "{about}");
                assert!(score.force_imbalance.unwrap() <= 1e-6, "{about}");
                assert!(score.deflection_error.unwrap() <= 1e-6, "{about}");
            }
            ContactMethod::ImplicitEuler => assert_eq!(score.outcome, Outcome::Right, "{about}"),
            _ => {
                let is_beyond = configuration.dt_s > 10.0 * score.explicit_limit_s;
                let is_press = configuration.scene == StabilityScene::Press;
                assert!(
                    !(is_beyond && is_press && score.outcome == Outcome::Right),
                    "{about}"
                );
            }
        }
        let is_right = score.outcome == Outcome::Right;
        let errors = [score.force_imbalance, score.deflection_error];
        assert!(
            !is_right || errors.iter().all(|e| e.unwrap() <= TOLERANCE),
            "{about}"
        );
    }
    let explicit = scores.iter().zip(&configurations);
    let explicit =
        explicit.filter(|(_, configuration)| configuration.method == ContactMethod::SemiImplicit);
    let right = explicit
        .clone()
        .filter(|(score, _)| score.outcome == Outcome::Right);
    assert!(right.count() >= 2, "it is no straw man");
    let broken = explicit.filter(|(score, _)| score.outcome >= Outcome::MissedContact);
    assert!(broken.count() >= 8);
    let summary: Vec<StabilitySummary> = read_rows(&case.path("1/stability_summary.csv")).unwrap();
    assert_eq!(summary.len(), 3 * 3);
    for row in summary {
        let kinds = [
            row.n_correct,
            row.n_inaccurate,
            row.n_missed_contact,
            row.n_energy_growth,
            row.n_not_finite,
        ];
        assert_eq!(kinds.iter().sum::<usize>(), row.n_configurations);
    }
    for chart in ["stability_rest_time", "stability_rest"] {
        let svg = fs::read_to_string(case.path(&format!("1/{chart}.svg"))).unwrap();
        let is_time = chart.ends_with("time");
        assert_eq!(svg.contains("right of the same"), is_time, "{chart}");
        assert_eq!(svg.contains("time step, taxel mass"), !is_time, "{chart}");
    }
}

/// Parts with stacked balls.
const STACKS: &str = include_str!("../../fixtures/texts/stability_stacks.toml");

#[test]
fn stacked_balls_come_to_rest_with_the_weight_of_all_on_the_skin() {
    let case = Case::new();
    case.file("study.toml", STACKS);
    case.succeeds(&["run", "study.toml", "--out", "out"]);
    let path = case.path("out/stability.csv");
    let configurations: Vec<StabilityConfiguration> = read_rows(&path).unwrap();
    let scores: Vec<StabilityScore> = read_rows(&path).unwrap();
    for (configuration, score) in configurations.iter().zip(&scores) {
        let about = format!("{configuration:?} {score:?}");
        let is_exact = matches!(
            configuration.method,
            ContactMethod::QuasiStatic | ContactMethod::ImplicitEuler
        );
        assert!(!is_exact || score.outcome == Outcome::Right, "{about}");
        if configuration.method == ContactMethod::QuasiStatic {
            assert!(score.force_imbalance.unwrap() <= 1e-6, "{about}");
            // The lightest balls deflect the stiffest taxels by 1e-8 m, and touch the walls by 1e-13 m.
            assert!(score.deflection_error.unwrap() <= 1e-4, "{about}");
        }
    }
    let n_engines = if cfg!(feature = "rapier") { 24 } else { 0 };
    assert_eq!(configurations.len(), 2 * 24 + n_engines + 3 * 12);
    let broken = configurations
        .iter()
        .zip(&scores)
        .filter(|(configuration, score)| {
            configuration.method == ContactMethod::SemiImplicit && score.outcome != Outcome::Right
        });
    assert!(
        broken.count() >= 4,
        "explicit springs break under stacks too"
    );
    let svg = fs::read_to_string(case.path("out/stability_stack_of_four.svg")).unwrap();
    assert!(svg.contains("Four balls, one upon the other"));
}

/// Parts with plungers whose taxels carry equal loads on all arrays.
const JOINTS: &str = include_str!("../../fixtures/texts/stability_joints.toml");

#[test]
fn a_ladder_of_joints_carries_the_same_on_each_and_is_charted() {
    let case = Case::new();
    case.file("study.toml", JOINTS);
    case.succeeds(&["run", "study.toml", "--out", "out"]);
    let path = case.path("out/stability.csv");
    let configurations: Vec<StabilityConfiguration> = read_rows(&path).unwrap();
    let scores: Vec<StabilityScore> = read_rows(&path).unwrap();
    for (configuration, score) in configurations.iter().zip(&scores) {
        let about = format!("{configuration:?} {score:?}");
        let carried = configuration.object_mass_kg.unwrap()
            / (configuration.taxels * configuration.taxels) as f64;
        assert!((carried / 3.5e-3 - 1.0).abs() < 1e-12, "{about}");
        let is_right = score.outcome == Outcome::Right;
        match configuration.method {
            ContactMethod::QuasiStatic | ContactMethod::ImplicitEuler => {
                assert!(is_right, "{about}");
            }
            // Dampers as forces gain energy beyond Δt = 2 m / c = 0.15 ms of the lighter taxels, for any solver.
            ContactMethod::RapierSkinSim if configuration.taxel_mass_kg == 1e-5 => {
                assert!(!is_right, "{about}");
            }
            _ => {}
        }
    }
    let n_methods = if cfg!(feature = "rapier") { 4 } else { 2 };
    assert_eq!(configurations.len(), n_methods * 3 * 2);
    let ladder: Vec<Joints> = read_rows(&case.path("out/joints.csv")).unwrap();
    assert_eq!(ladder.len(), configurations.len());
    for ((row, configuration), score) in ladder.iter().zip(&configurations).zip(&scores) {
        assert_eq!(
            (row.method, row.outcome),
            (configuration.method, score.outcome)
        );
        assert_eq!(
            (row.joints, row.load_kg),
            (configuration.n_taxels(), 3.5e-3)
        );
    }
    let svg = fs::read_to_string(case.path("out/stability_joints.svg")).unwrap();
    for text in [
        "unstable near 280",
        "taxel mass 10⁻⁵ kg",
        "real time",
        "not right",
    ] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn rows_of_other_programs_stand_in_the_parts_that_contain_their_scenes_and_other_rows_are_refused()
{
    let case = Case::new();
    let study = QUICK.replacen(
        "question = \"What breaks?\"",
        "question = \"What breaks?\"\n[stability]\npeers = \"peers.csv\"",
        1,
    );
    case.file("study.toml", &study);
    let (without, _) = case.succeeds(&["run", "study.toml", "--out", "without"]);
    assert!(!without.contains("MuJoCo"), "no file, no rows: {without}");
    let said = "No rows of other programs: peers.csv does not exist.";
    assert!(without.contains(said), "{without}");
    let header = "part,scene,method,solver_iterations,taxels,stiffness_n_per_m,taxel_mass_kg,object_mass_kg,dt_s,mass_ratio,\
                  explicit_limit_s,damping_n_s_per_m,contact_stiffness_n_per_m,outcome,force_imbalance,deflection_error,n_steps,\
                  simulated_s,wall_s,per_simulated_s,pitch_mm,stroke_mm,program,version,date\n";
    let asked = "1,rest,mujoco_discrete,,8,10,1e-7,1e-3,1e-3,1e4,2e-4,0.1,,right,1e-9,2e-5,500,0.5,1.0,2.0,4,2,MuJoCo,4.0.0,2026-11-22\n";
    case.file("peers.csv", format!("{header}{asked}"));
    case.succeeds(&["run", "study.toml", "--out", "with"]);
    let configurations: Vec<StabilityConfiguration> =
        read_rows(&case.path("with/stability.csv")).unwrap();
    let peers = configurations
        .iter()
        .filter(|configuration| configuration.method.is_peer());
    assert_eq!(peers.count(), 1, "only configurations that the study has");
    // A program with few scenes is not compared with the others, one with all scenes is.
    let few = fs::read_to_string(case.path("with/stability_rest.svg")).unwrap();
    assert!(!few.contains("MuJoCo"));
    let ours = fs::read_to_string(case.path("without/stability.csv")).unwrap();
    let ours = ours
        .lines()
        .filter(|line| line.contains(",rest,quasi_static,"));
    let all = ours.map(|line| {
        let line = line.replace("quasi_static", "mujoco_discrete");
        format!("{line},1.0,2.0,4,2,MuJoCo,4.0.0,2026-11-22\n")
    });
    case.file("peers.csv", format!("{header}{}", all.collect::<String>()));
    case.succeeds(&["run", "study.toml", "--out", "whole"]);
    let svg = fs::read_to_string(case.path("whole/stability_rest.svg")).unwrap();
    assert!(
        svg.contains("2026-11-22"),
        "the version and the date of the program"
    );
    let press = fs::read_to_string(case.path("whole/stability_press.svg")).unwrap();
    assert!(!press.contains("MuJoCo"));
    case.file("peers.csv", format!("{header}{asked}"));
    // A row belongs to a scene, in whichever part it stands.
    let (before, parts) = study.split_once("[[stability.parts]]").unwrap();
    let inserted = "[[stability.parts]]\nscene = \"press\"\nmethods = [\"quasi_static\"]\ntaxels = 4\nstiffness_n_per_m = 5.0\n\
                    taxel_mass_kg = 1e-3\ndt_s = 1e-2\n\n";
    let inserted = format!("{before}{inserted}[[stability.parts]]{parts}");
    case.file("inserted.toml", inserted);
    case.succeeds(&["run", "inserted.toml", "--out", "inserted"]);
    let read = |folder: &str| -> Vec<StabilityConfiguration> {
        read_rows(&case.path(folder).join("stability.csv")).unwrap()
    };
    let mut moved = read("inserted");
    moved.retain(|one| one.method.is_peer());
    assert_eq!((moved.len(), moved[0].part), (1, 2));
    let refused = |study: &str, rows: &str, line: &str| {
        case.file("study.toml", study);
        case.file("peers.csv", format!("{header}{rows}"));
        let output = case.run(&["run", "study.toml", "--out", "broken"]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{rows}: {error}");
        assert!(
            error.contains("peers.csv: ") && error.contains(line),
            "{rows}: {error}"
        );
    };
    refused(&study, &asked.replace("right", "fine"), "line 2");
    for (old, new) in [
        ("8,10,", "8,77,"),
        ("2.0,4,2,", "2.0,5,2,"),
        ("2.0,4,2,", "2.0,4,3,"),
        ("1e-7,1e-3,1e-3", "1e-7,1e-3,1.1e-3"),
        ("mujoco_discrete", "quasi_static"),
    ] {
        assert!(asked.contains(old));
        refused(
            &study,
            &format!("{asked}{}", asked.replace(old, new)),
            "line 3",
        );
    }
    refused(&study, &format!("{asked}{asked}"), "line 3");
    let deeper = study.replacen("scene = \"rest\"", "scene = \"rest\"\nstroke_mm = 3.0", 1);
    refused(&deeper, asked, "line 2");
    let coarser = study.replacen("peers =", "pitch_mm = 5.0\npeers =", 1);
    refused(&coarser, asked, "line 2");
    let study = QUICK.replacen("\"semi_implicit\"", "\"mujoco_euler\"", 1);
    case.file("study.toml", &study);
    let output = case.run(&["run", "study.toml"]);
    let error = String::from_utf8(output.stderr).unwrap();
    says(&error, &["key stability.parts[1].methods"]);
}
