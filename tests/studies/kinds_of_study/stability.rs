//! Stability study: the limits of contact simulation methods.

use crate::command::{Case, says};
use crate::study::changed;
use bubbletouch::kinds::stability::rows::{
    Joints, StabilityConfiguration, StabilityScore, StabilitySummary,
};
use bubbletouch::kinds::stability::{ContactMethod, Outcome, StabilityScene, TOLERANCE};

const QUICK: &str = include_str!("../../fixtures/texts/stability_quick.toml");

#[test]
fn ours_is_right_everywhere_and_the_others_break_where_they_must() {
    let case = Case::with("study.toml", QUICK);
    let (said, _) = case.succeeds("run study.toml --out 1");
    says(&said, &["quasi-static"]);
    let configurations: Vec<StabilityConfiguration> = case.rows("1/stability.csv");
    let scores: Vec<StabilityScore> = case.rows("1/stability.csv");
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
                let is_right = score.outcome == Outcome::Right;
                assert!(!(is_beyond && is_press && is_right), "{about}");
            }
        }
        let is_right = score.outcome == Outcome::Right;
        let errors = [score.force_imbalance, score.deflection_error];
        let is_small = |error: &Option<f64>| error.unwrap() <= TOLERANCE;
        assert!(!is_right || errors.iter().all(is_small), "{about}");
    }
    let explicit = scores.iter().zip(&configurations);
    let explicit = explicit.filter(|(_, of)| of.method == ContactMethod::SemiImplicit);
    let outcomes: Vec<Outcome> = explicit.map(|(score, _)| score.outcome).collect();
    let n = |is_it: fn(&&Outcome) -> bool| outcomes.iter().filter(is_it).count();
    assert!(n(|outcome| **outcome == Outcome::Right) >= 2);
    assert!(n(|outcome| **outcome >= Outcome::MissedContact) >= 8);
    let summary: Vec<StabilitySummary> = case.rows("1/stability_summary.csv");
    assert_eq!(summary.len(), 3 * 3);
    for row in summary {
        let n_wrong = row.n_missed_contact + row.n_energy_growth + row.n_not_finite;
        let n = row.n_correct + row.n_inaccurate + n_wrong;
        assert_eq!(n, row.n_configurations);
    }
    for chart in ["stability_rest_time", "stability_rest"] {
        let svg = case.read(&format!("1/{chart}.svg"));
        let is_time = chart.ends_with("time");
        assert_eq!(svg.contains("Right of the same"), is_time, "{chart}");
        assert_eq!(svg.contains("time step, taxel mass"), !is_time, "{chart}");
    }
}

/// Parts with stacked balls.
const STACKS: &str = include_str!("../../fixtures/texts/stability_stacks.toml");

#[test]
fn stacked_balls_come_to_rest_with_the_weight_of_all_on_the_skin() {
    let case = Case::with("study.toml", STACKS);
    case.succeeds("run study.toml --out out");
    let configurations: Vec<StabilityConfiguration> = case.rows("out/stability.csv");
    let scores: Vec<StabilityScore> = case.rows("out/stability.csv");
    for (configuration, score) in configurations.iter().zip(&scores) {
        let about = format!("{configuration:?} {score:?}");
        let exact = [ContactMethod::QuasiStatic, ContactMethod::ImplicitEuler];
        let is_exact = exact.contains(&configuration.method);
        assert!(!is_exact || score.outcome == Outcome::Right, "{about}");
        if configuration.method == ContactMethod::QuasiStatic {
            assert!(score.force_imbalance.unwrap() <= 1e-6, "{about}");
            // The lightest balls deflect the stiffest taxels by 1e-8 m, and touch the walls by 1e-13 m.
            assert!(score.deflection_error.unwrap() <= 1e-4, "{about}");
        }
    }
    let n_engines = if cfg!(feature = "rapier") { 24 } else { 0 };
    assert_eq!(configurations.len(), 2 * 24 + n_engines + 3 * 12);
    let broken = configurations.iter().zip(&scores).filter(|(of, score)| {
        of.method == ContactMethod::SemiImplicit && score.outcome != Outcome::Right
    });
    assert!(broken.count() >= 4, "explicit springs break");
    let svg = case.read("out/stability_stack_of_four.svg");
    assert!(svg.contains("four balls in a stack"));
}

/// Parts with plungers whose taxels carry equal loads on all arrays.
const JOINTS: &str = include_str!("../../fixtures/texts/stability_joints.toml");

#[test]
fn a_ladder_of_joints_carries_the_same_on_each_and_is_charted() {
    let case = Case::with("study.toml", JOINTS);
    case.succeeds("run study.toml --out out");
    let configurations: Vec<StabilityConfiguration> = case.rows("out/stability.csv");
    let scores: Vec<StabilityScore> = case.rows("out/stability.csv");
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
    let ladder: Vec<Joints> = case.rows("out/joints.csv");
    assert_eq!(ladder.len(), configurations.len());
    for ((row, configuration), score) in ladder.iter().zip(&configurations).zip(&scores) {
        assert_eq!(row.method, configuration.method);
        assert_eq!(row.outcome, score.outcome);
        assert_eq!(row.joints, configuration.n_taxels());
        assert_eq!(row.load_kg, 3.5e-3);
    }
    let svg = case.read("out/stability_joints.svg");
    let mass = "taxel mass 10⁻⁵ kg";
    says(&svg, &["unstable near 280", mass, "real time", "not right"]);
}

#[test]
fn rows_of_other_programs_stand_in_the_parts_that_contain_their_scenes_and_other_rows_are_refused()
{
    let case = Case::new();
    let question = "question = \"What breaks?\"";
    let peers = format!("{question}\n[stability]\npeers = \"peers.csv\"");
    let study = QUICK.replacen(question, &peers, 1);
    case.file("study.toml", &study);
    let (without, _) = case.succeeds("run study.toml --out without");
    assert!(!without.contains("MuJoCo"), "no file, no rows: {without}");
    let said = "No rows of other programs: peers.csv does not exist.";
    says(&without, &[said]);
    let header = "part,scene,method,solver_iterations,taxels,stiffness_n_per_m,taxel_mass_kg,object_mass_kg,dt_s,mass_ratio,\
                  explicit_limit_s,damping_n_s_per_m,contact_stiffness_n_per_m,outcome,force_imbalance,deflection_error,n_steps,\
                  simulated_s,wall_s,per_simulated_s,pitch_mm,stroke_mm,program,version,date\n";
    let asked = "1,rest,mujoco_discrete,,8,10,1e-7,1e-3,1e-3,1e4,2e-4,0.1,,right,1e-9,2e-5,500,0.5,1.0,2.0,4,2,MuJoCo,4.0.0,2026-11-22\n";
    case.file("peers.csv", format!("{header}{asked}"));
    case.succeeds("run study.toml --out with");
    let configurations: Vec<StabilityConfiguration> = case.rows("with/stability.csv");
    let peers = configurations.iter().filter(|of| of.method.is_peer());
    assert_eq!(peers.count(), 1, "only configurations that the study has");
    // A program with few scenes is not compared with the others, one with all scenes is.
    let few = case.read("with/stability_rest.svg");
    assert!(!few.contains("MuJoCo"));
    let ours = case.read("without/stability.csv");
    let ours = ours.lines();
    let ours = ours.filter(|line| line.contains(",rest,quasi_static,"));
    let all = ours.map(|line| {
        let line = line.replace("quasi_static", "mujoco_discrete");
        format!("{line},1.0,2.0,4,2,MuJoCo,4.0.0,2026-11-22\n")
    });
    case.file("peers.csv", format!("{header}{}", all.collect::<String>()));
    case.succeeds("run study.toml --out whole");
    let svg = case.read("whole/stability_rest.svg");
    // The version and the date of the program.
    says(&svg, &["2026-11-22"]);
    let press = case.read("whole/stability_press.svg");
    assert!(!press.contains("MuJoCo"));
    case.file("peers.csv", format!("{header}{asked}"));
    // A row belongs to a scene, in whichever part it stands.
    let (before, parts) = study.split_once("[[stability.parts]]").unwrap();
    let inserted = "[[stability.parts]]\nscene = \"press\"\nmethods = [\"quasi_static\"]\ntaxels = 4\nstiffness_n_per_m = 5.0\n\
                    taxel_mass_kg = 1e-3\ndt_s = 1e-2\n\n";
    let inserted = format!("{before}{inserted}[[stability.parts]]{parts}");
    case.file("inserted.toml", inserted);
    case.succeeds("run inserted.toml --out inserted");
    let mut moved: Vec<StabilityConfiguration> = case.rows("inserted/stability.csv");
    moved.retain(|one| one.method.is_peer());
    assert_eq!((moved.len(), moved[0].part), (1, 2));
    let refused = |study: &str, rows: &str, line: &str| {
        case.file("study.toml", study);
        case.file("peers.csv", format!("{header}{rows}"));
        let error = case.refuses("run study.toml --out broken");
        says(&error, &["peers.csv: ", line]);
    };
    refused(&study, &asked.replace("right", "fine"), "line 2");
    for (old, new) in [
        ("8,10,", "8,77,"),
        ("2.0,4,2,", "2.0,5,2,"),
        ("2.0,4,2,", "2.0,4,3,"),
        ("1e-7,1e-3,1e-3", "1e-7,1e-3,1.1e-3"),
        ("mujoco_discrete", "quasi_static"),
    ] {
        let other = changed(asked, &[(old, new)]);
        refused(&study, &format!("{asked}{other}"), "line 3");
    }
    refused(&study, &format!("{asked}{asked}"), "line 3");
    let deeper = study.replacen("scene = \"rest\"", "scene = \"rest\"\nstroke_mm = 3.0", 1);
    refused(&deeper, asked, "line 2");
    let coarser = study.replacen("peers =", "pitch_mm = 5.0\npeers =", 1);
    refused(&coarser, asked, "line 2");
    let study = QUICK.replacen("\"semi_implicit\"", "\"mujoco_euler\"", 1);
    case.file("study.toml", study);
    let error = case.refuses("run study.toml");
    says(&error, &["key stability.parts[1].methods"]);
}
