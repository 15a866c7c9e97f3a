//! The experiments of the repository: each states its question and can run.

use crate::public_sets::write_recording;
use bubbletouch::Result;
use bubbletouch::kinds::object_detail::{ObjectDetailPlan, ObjectDetailStudySpec};
use bubbletouch::kinds::recognition::{load_study, read_plans};
use bubbletouch::kinds::reconstruction::{ReconstructionPlan, ReconstructionStudySpec};
use bubbletouch::kinds::stability::{StabilityPlan, StabilityStudySpec};
use bubbletouch::kinds::whole_body::{WholeBodyPlan, WholeBodyStudySpec};
use bubbletouch::kinds::{self, Source};
use bubbletouch::report::comparison::rank_agreement::rank_agreement;
use std::fs;
use std::path::{Path, PathBuf};
use toml::Table;

/// Required parts of a header, in this order.
const HEADER: [&str; 4] = ["# Question", "# Source", "# Expected", "# Run time"];

fn experiments() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    let entries = fs::read_dir(folder).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    assert!(paths.len() >= 10, "{paths:?}");
    paths
}

#[test]
fn every_experiment_says_what_it_asks_from_where_what_to_expect_and_how_long_it_takes() {
    for path in experiments() {
        let text = fs::read_to_string(&path).unwrap();
        let header: Vec<&str> = text.lines().take_while(|l| l.starts_with('#')).collect();
        let part = |line: &&str| {
            let mut keys = HEADER.into_iter();
            keys.find_map(|key| Some((key, !line.strip_prefix(key)?.trim().is_empty())))
        };
        let parts: Vec<(&str, bool)> = header.iter().filter_map(part).collect();
        assert_eq!(parts, HEADER.map(|key| (key, true)), "{}", path.display());
    }
}

/// Returns the number of methods, scenes or configurations that a study compares; `None` if it needs meshes, which are not part of the crate.
fn n_compared(path: &Path, text: &str, study: &Table) -> Result<Option<usize>> {
    let (place, folder) = (path.display().to_string(), path.parent().unwrap());
    Ok(Some(match kinds::about(text).map(|about| about.table) {
        Some("object_detail") => {
            let spec = ObjectDetailStudySpec::parse(&place, text)?;
            let plan = ObjectDetailPlan::new(&place, spec)?;
            plan.spec.object_detail.methods.len()
        }
        Some("whole_body") => {
            let spec = WholeBodyStudySpec::parse(&place, text)?;
            WholeBodyPlan::new(&place, folder, spec)?.scenes.len()
        }
        Some("reconstruction") => {
            let spec = ReconstructionStudySpec::parse(&place, text)?;
            let plan = ReconstructionPlan::new(&place, spec)?;
            plan.configurations().len()
        }
        Some("stability") => {
            let spec = StabilityStudySpec::parse(&place, text)?;
            let plan = StabilityPlan::new(&place, folder, spec)?;
            plan.configurations.len()
        }
        _ => {
            let files = tempfile::tempdir().unwrap();
            let mut source = Source {
                folder: folder.to_owned(),
                ..Source::of_text(&place, text)
            };
            if study.contains_key("recorded") {
                // Files of the recording, also those in [axes], are in this folder.
                let name = path.file_stem().unwrap().to_string_lossy();
                write_recording(&name, files.path());
                source.folder = files.path().to_owned();
            }
            let objects = study.get("objects");
            if objects.is_some_and(|objects| objects.get("meshes").is_some()) {
                read_plans(&source)?;
                return Ok(None);
            }
            let study = load_study(&source)?;
            study.all_cells().count()
        }
    }))
}

#[test]
fn every_experiment_can_run() {
    for path in experiments() {
        let place = path.display();
        let text = fs::read_to_string(&path).unwrap();
        let study: Table = text.parse().unwrap();
        for key in ["question", "expected"] {
            let said = study[key].as_str();
            assert!(said.is_some_and(|said| !said.is_empty()), "{place}: {key}");
        }
        match n_compared(&path, &text, &study).unwrap() {
            Some(n) => assert!(n > 1, "{place} compares something"),
            None => println!("{place}: planned; its meshes are not part of the crate"),
        }
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
