//! The experiments of the repository: each states its question and can run.

use crate::public_sets::write_recording;
use bubbletouch::files::with_folder;
use bubbletouch::kinds;
use bubbletouch::kinds::object_detail::{ObjectDetailPlan, ObjectDetailStudySpec};
use bubbletouch::kinds::reconstruction::{ReconstructionPlan, ReconstructionStudySpec};
use bubbletouch::kinds::stability::{StabilityPlan, StabilityStudySpec};
use bubbletouch::kinds::whole_body::{WholeBodyPlan, WholeBodyStudySpec};
use bubbletouch::random::Seed;
use bubbletouch::report::comparison::rank_agreement::rank_agreement;
use bubbletouch::study::{
    HumanTouches, Plan, RecordedFrames, StudySpec, Sweep, draw_touches, load_objects,
};
use std::fs;
use std::path::{Path, PathBuf};

/// Required parts of a header, in this order.
const HEADER: [&str; 4] = ["# Question", "# Source", "# Expected", "# Run time"];

fn experiments() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 10, "{paths:?}");
    paths
}

#[test]
fn every_experiment_says_what_it_asks_from_where_what_to_expect_and_how_long_it_takes() {
    for path in experiments() {
        let text = fs::read_to_string(&path).unwrap();
        let header: Vec<&str> = text.lines().take_while(|l| l.starts_with('#')).collect();
        let keys: Vec<&str> = header
            .iter()
            .filter_map(|line| HEADER.into_iter().find(|key| line.starts_with(key)))
            .collect();
        assert_eq!(keys, HEADER, "{}", path.display());
        for (line, key) in header.iter().filter_map(|line| {
            let key = HEADER.into_iter().find(|key| line.starts_with(key))?;
            Some((line, key))
        }) {
            let said = line[key.len()..].trim();
            assert!(!said.is_empty(), "{}: {key}", path.display());
        }
    }
}

#[test]
fn every_experiment_can_run() {
    for path in experiments() {
        let place = path.display().to_string();
        let text = fs::read_to_string(&path).unwrap();
        let table = kinds::about(&text).map(|about| about.table);
        if table == Some("object_detail") {
            let spec = ObjectDetailStudySpec::parse(&place, &text).unwrap();
            assert!(!spec.question.is_empty() && !spec.expected.is_empty());
            let plan = ObjectDetailPlan::new(&place, spec).unwrap();
            let n_methods = plan.spec.object_detail.methods.len();
            assert!(n_methods > 1, "{place} compares something");
            continue;
        }
        if table == Some("whole_body") {
            let spec = WholeBodyStudySpec::parse(&place, &text).unwrap();
            assert!(!spec.question.is_empty() && !spec.expected.is_empty());
            let plan = WholeBodyPlan::new(&place, path.parent().unwrap(), spec).unwrap();
            assert!(plan.scenes.len() > 1, "{place} compares something");
            continue;
        }
        if table == Some("reconstruction") {
            let spec = ReconstructionStudySpec::parse(&place, &text).unwrap();
            assert!(!spec.question.is_empty() && !spec.expected.is_empty());
            let plan = ReconstructionPlan::new(&place, spec).unwrap();
            assert!(
                plan.configurations().len() > 1,
                "{place} compares something"
            );
            continue;
        }
        if table == Some("stability") {
            let spec = StabilityStudySpec::parse(&place, &text).unwrap();
            assert!(!spec.question.is_empty() && !spec.expected.is_empty());
            let plan = StabilityPlan::new(&place, path.parent().unwrap(), spec).unwrap();
            assert!(plan.configurations.len() > 1, "{place} compares something");
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        if table == Some("recorded") || text.contains("[recorded]") {
            let name = path.file_stem().unwrap().to_string_lossy();
            write_recording(&name, folder.path());
            // Files of the recording, also those in [axes], are in this folder.
            let parse = || {
                let spec = StudySpec::parse(&place, &text)?;
                assert!(!spec.question.is_empty() && !spec.expected.is_empty());
                Plan::variants(&place, spec)
            };
            let plans = with_folder(folder.path().to_owned(), parse).unwrap();
            for (_, plan) in &plans {
                let recorded = plan.spec.recorded.as_ref().unwrap();
                let touches = RecordedFrames::read(recorded, None).unwrap();
                let sweep = Sweep::new(plan, &touches).unwrap();
                assert!(sweep.n_configurations() > 1, "{place} compares something");
            }
            continue;
        }
        let spec = StudySpec::parse(&place, &text).unwrap();
        assert!(
            !spec.question.is_empty() && !spec.expected.is_empty(),
            "{place}"
        );
        let plan = Plan::new(&place, spec).unwrap();
        if plan.spec.objects.meshes.is_some() {
            println!("{place}: planned; its meshes are not part of the crate");
            continue;
        }
        let seed = Seed::new(plan.spec.seed);
        if let Some(human) = &plan.spec.human_touch {
            let touches = HumanTouches::draw(human, &seed).unwrap();
            let sweep = Sweep::new(&plan, &touches).unwrap();
            assert!(sweep.n_configurations() > 1, "{place} compares something");
            continue;
        }
        let objects = load_objects(&plan.spec.objects, None).unwrap();
        let touched = draw_touches(objects, &plan.placement, &seed).unwrap();
        let sweep = Sweep::new(&plan, &touched).unwrap();
        assert!(sweep.n_configurations() > 1, "{place} compares something");
    }
}

/// Checks the output of `bubbletouch compare` for the committed results of a simulated skin and of the real skin to which it was calibrated.
#[test]
fn the_simulated_skin_ranks_designs_as_the_real_one_does() {
    let tables = ["simulated_skin", "real_skin"].map(|name| {
        let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
        kinds::read_tables(&results.join(name)).unwrap().1
    });
    let ranks = rank_agreement(&tables[0], &tables[1]).unwrap();
    assert_eq!(ranks.n_designs, 104);
    assert!(ranks.tau >= 0.8, "{ranks:?}");
}
