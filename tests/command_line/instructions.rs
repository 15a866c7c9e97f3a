//! Test of all vector instruction sets on one machine: the program runs on emulated processors. There is no emulator of AVX-512; it is tested if the machine
//! supports it.

use crate::command::Case;
use crate::reference_data::folder;
use bubbletouch::contact::Instructions;
use bubbletouch::report::csv_tables::read_rows;
use bubbletouch::study::table::TrialScore;
use ndarray::Array1;
use ndarray_npy::read_npy;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Study with SVMs of every kernel that choose C by folds, and with frames that are projected by matrix products.
const STUDY: &str = include_str!("../fixtures/texts/instructions.toml");

/// Runs the command on this machine or on an emulated processor, and asserts success.
fn succeeds(case: &Case, emulated: Option<(&Path, &str)>, line: &str) -> String {
    let command = env!("CARGO_BIN_EXE_bubbletouch");
    let mut process = match emulated {
        None => Command::new(command),
        Some((emulator, processor)) => {
            let mut process = Command::new(emulator);
            process.args(["-cpu", processor, command]);
            process
        }
    };
    let output = process
        .args(line.split(' '))
        .current_dir(case.folder())
        .output();
    let output = output.unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{emulated:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// Results of a run on one emulated processor.
struct Found {
    /// Vector instructions that the processor supports.
    instructions: Instructions,
    /// Scores of the study, with γ, which depends on the scale of the features.
    scores: Vec<TrialScore>,
    gammas: Vec<f64>,
    /// Dual objectives of the SVMs, and their labels of test rows.
    duals: Vec<f64>,
    labels: Vec<Array1<i64>>,
}

fn found(case: &Case, emulated: Option<(&Path, &str)>) -> Found {
    let out = emulated.map_or("here", |(_, processor)| processor);
    let run = format!("run study.toml --threads 1 --out {out}");
    succeeds(case, emulated, &run);
    let file = |name: &str| case.path(out).join(name);
    let manifest = fs::read(file("manifest.json")).unwrap();
    let manifest: Value = serde_json::from_slice(&manifest).unwrap();
    let mut scores: Vec<TrialScore> = read_rows(&file("accuracy.csv")).unwrap();
    let gammas = scores.iter_mut();
    let gammas = gammas.filter_map(|score| score.gamma_used.take()).collect();
    let (mut duals, mut labels) = (Vec::new(), Vec::new());
    for classifier in ["linear_svm", "rbf_svm", "polynomial_svm"] {
        let train = format!("classify features --classifier {classifier} --json");
        let train = train + " --threads 1 --predictions labels.npy";
        let said = succeeds(case, emulated, &train);
        let said: Value = serde_json::from_str(&said).unwrap();
        duals.push(said["svm"]["dual_objective"].as_f64().unwrap());
        labels.push(read_npy(case.path("labels.npy")).unwrap());
    }
    Found {
        instructions: serde_json::from_value(manifest["instructions"].clone()).unwrap(),
        scores,
        gammas,
        duals,
        labels,
    }
}

#[test]
fn avx2_and_plain_code_find_what_this_machine_finds() {
    let Some(folder) = folder("BUBBLETOUCH_QEMU") else {
        return;
    };
    let case = Case::new();
    case.file("study.toml", STUDY);
    case.succeeds("features study.toml --out features");
    let emulator = folder.join("qemu-x86_64");
    let ours = found(&case, None);
    for (processor, instructions) in [
        ("Haswell", Instructions::Avx2),
        ("Nehalem", Instructions::Baseline),
    ] {
        let theirs = found(&case, Some((&emulator, processor)));
        assert_eq!(theirs.instructions, instructions);
        let numbers = |found: &Found| [&found.gammas[..], &found.duals].concat();
        assert_eq!(numbers(&ours).len(), numbers(&theirs).len());
        for (ours, theirs) in numbers(&ours).iter().zip(numbers(&theirs)) {
            // Sums of some hundred terms are rounded in another order: 1e-16 per term, and the resulting steps.
            let off = (ours / theirs - 1.0).abs();
            assert!(off < 1e-12, "{processor}: {theirs} in place of {ours}");
        }
        assert_eq!(theirs.labels, ours.labels, "{processor}");
        assert_eq!(theirs.scores, ours.scores, "{processor}");
    }
}
