//! Studies within a memory limit.

use crate::command::{Case, says};
use crate::study::Study;
use bubbletouch::kinds::recognition::recognition_scale;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Study whose touches depend on the preceding touch, so that frames are not read in order.
const SMALL: &str = include_str!("../fixtures/texts/memory_small.toml");

/// Study of 3,200 touches with 16,384 taxels; all taxels together would take 210 MB.
const LARGE: &str = include_str!("../fixtures/texts/memory_large.toml");

/// Returns the minimum memory limit of a study, as stated in the error message.
fn least_gib(case: &Case, study: &str) -> String {
    let said = case.refuses(&["plan", study, "--memory-gib", "0.01"]);
    let (_, after) = said.split_once("at least ").expect("how much it takes");
    let (least, _) = after.split_once(" GiB").expect("a unit");
    // The number is rounded to hundredths.
    format!("{:.2}", least.parse::<f64>().unwrap() + 0.01)
}

#[test]
fn a_study_stays_below_its_ceiling_and_finds_the_same() {
    let case = Case::with("large.toml", LARGE);
    let least = least_gib(&case, "large.toml");
    let ceiling = least.parse::<f64>().unwrap() * f64::from(1 << 30);
    assert!(ceiling < 0.5e9, "{least} GiB");
    case.succeeds("run large.toml --out free --quiet");
    let out = [
        "run",
        "large.toml",
        "--out",
        "below",
        "--quiet",
        "--memory-gib",
    ];
    case.succeeds(&[&out[..], &[least.as_str()]].concat());
    for table in ["accuracy.csv", "confusion.csv", "summary.csv"] {
        let read = |folder: &str| case.bytes(&format!("{folder}/{table}"));
        assert_eq!(read("free"), read("below"), "{table}");
    }
    let Some(peak) = peak(&case.path("below")) else {
        println!("SKIPPED: this system does not tell how much memory a process took");
        return;
    };
    assert!((peak as f64) < ceiling, "{peak} bytes, ceiling {ceiling}");
}

fn peak(folder: &Path) -> Option<u64> {
    let manifest = fs::read_to_string(folder.join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
    manifest["peak_memory_bytes"].as_u64()
}

/// Reconstruction study of 40 touches with 4,096 taxels.
const RECONSTRUCTION: &str = include_str!("../fixtures/texts/memory_reconstruction.toml");

/// Returns the memory that a plan on two threads states, MiB.
fn planned_mib(case: &Case, study: &str) -> f64 {
    let (said, _) = case.succeeds(&["plan", study, "--threads", "2"]);
    let (_, after) = said.split_once("memory   about ").unwrap();
    let (planned, unit) = after.split_once(' ').unwrap();
    let unit = if unit.starts_with("GiB") { 1024.0 } else { 1.0 };
    unit * planned.parse::<f64>().unwrap()
}

fn changed(text: &str, changes: &[(&str, &str)]) -> String {
    let mut text = text.to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    text
}

#[test]
fn a_plan_states_the_memory_of_a_run_within_a_fifth() {
    let case = Case::new();
    let large = LARGE.replace("solver_memory_gib = 0.01\n", "");
    let coarser = [
        ("pitch_mm = 1.0", "pitch_mm = 2.0"),
        ("taxels = 128", "taxels = 64"),
        ("per_object = 200", "per_object = 60"),
        ("train_touches = 30", "train_touches = 20"),
    ];
    // Principal components of shifted copies of training frames.
    let fitted = [
        (
            "ensemble = \"sbhe\"\nratio = [256, 512, 1024]",
            "ensemble = \"adaptive_learned\"\nmeasurements = 16",
        ),
        (
            "classifier = \"linear_svm\"",
            "features = \"descriptors\"\nclassifier = \"k_nearest\"",
        ),
    ];
    // Several readings of each touch, of which only features of images are kept.
    let read = [
        (
            "[sensing]",
            "[signal]\nnoise_std_full_scale = 0.1\n\n[sensing]",
        ),
        (
            "ensemble = \"sbhe\"\nratio = [256, 512, 1024]",
            "ensemble = \"identity\"",
        ),
        (
            "classifier = \"linear_svm\"",
            "features = \"descriptors\"\nreadings_per_touch = 6\nclassifier = \"rbf_svm\"\nc_grid = [1.0, 10.0]\ncv_folds = 2\ncv_touches = 10",
        ),
    ];
    // All taxels of all touches, in two trials at the same time.
    let whole = [
        (
            "ensemble = \"sbhe\"\nratio = [256, 512, 1024]",
            "ensemble = \"identity\"",
        ),
        ("trials = 1", "trials = 3"),
        ("per_object = 60", "per_object = 150"),
        ("train_touches = 20", "train_touches = 50"),
    ];
    let coarse = changed(&large, &coarser);
    let reconstruction = changed(
        RECONSTRUCTION,
        &[
            ("[reconstruction]", "[reconstruction]\natoms = 256"),
            ("ensemble = \"identity\"", "ensemble = \"sbhe\""),
            ("per_object = 10", "per_object = 400"),
        ],
    );
    for (name, study) in [
        ("many readings", changed(&coarse, &read)),
        ("fitted", changed(&coarse, &fitted)),
        ("all taxels", changed(&coarse, &whole)),
        ("many touches", large),
        ("reconstruction", reconstruction),
    ] {
        case.file("study.toml", &study);
        let planned = planned_mib(&case, "study.toml");
        let out = format!("of {name}");
        // Large frames are freed while a reconstruction goes on. If freed memory does not return at once, its peak depends on the load of the machine.
        let arguments = [
            "run",
            "study.toml",
            "--threads",
            "2",
            "--quiet",
            "--out",
            &out,
        ];
        let mut run = case.command(&arguments);
        if name == "reconstruction" {
            run.env("MIMALLOC_PURGE_DELAY", "0");
        }
        let output = run.output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let Some(peak) = peak(&case.path(&out)) else {
            println!("SKIPPED: this system does not tell how much memory a process took");
            return;
        };
        let peak = peak as f64 / f64::from(1 << 20);
        println!("{name}: {planned:.0} MiB planned, {peak:.0} MiB taken");
        assert!(
            (planned / peak - 1.0).abs() < 0.2,
            "{name}: {planned:.0} MiB for {peak:.0}"
        );
    }
    case.file("study.toml", RECONSTRUCTION);
    // The full dictionary takes minutes; its peak was measured once (/usr/bin/time -v).
    let planned = planned_mib(&case, "study.toml");
    assert!((planned / 969.0 - 1.0).abs() < 0.2, "{planned} MiB");
    let output = case.run("run study.toml --memory-gib 0.5");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_ceiling_too_low_is_refused_with_what_it_takes() {
    let study = Study::new(SMALL).of_items();
    let free = recognition_scale(&study);
    let n_threads = rayon::current_num_threads();
    let (mut most, mut n_before) = (free.least_bytes(), n_threads);
    while free.n_at_once(most) != Some(n_threads) {
        most *= 1.01;
    }
    // The lower the limit, the fewer work items are computed together.
    for share in [0.99, 0.97, 0.95] {
        let n = free.n_at_once(share * most).unwrap_or(0);
        assert!(n <= n_before, "{n} items at once at {share}");
        n_before = n;
    }
    assert_eq!(free.n_at_once(1e6), None);
    let case = Case::with("small.toml", SMALL);
    let output = case.run("run small.toml --memory-gib 0.001");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    says(&said, &["at least 0."]);
    for bad in ["0", "-1", "nan", "inf"] {
        case.refuses(&["run", "small.toml", &format!("--memory-gib={bad}")]);
    }
    assert!(!case.path("results").exists());
}

/// Study of kinds of human touch, with few frames and few taxels.
const HUMAN: &str = include_str!("../fixtures/texts/memory_human.toml");

/// Asserts that the command fails as quickly as a plan, with exit code 2 and the given text.
fn assert_refused_at_once(case: &Case, arguments: &[&str], said: &[&str]) {
    let start = Instant::now();
    let error = case.refuses(arguments);
    assert!(start.elapsed() < Duration::from_secs(10), "{arguments:?}");
    for words in said {
        assert!(error.contains(words), "{arguments:?}: {error}");
    }
}

#[test]
fn touches_that_memory_cannot_hold_are_refused_before_any_is_drawn() {
    let case = Case::with("fits.toml", HUMAN);
    case.succeeds("plan fits.toml");
    let human = |n: &str| HUMAN.replace("per_kind = 8", &format!("per_kind = {n}"));
    case.file("huge.toml", human("99999999999"));
    case.file("many.toml", human("9000000"));
    let objects = SMALL.replace("per_object = 12", "per_object = 9000000");
    case.file("objects.toml", objects);
    let commands: [&[&str]; 2] = [&["plan"], &["run", "--out", "out"]];
    for command in commands {
        let with = |file: &'static str| [command, &[file, "--memory-gib", "3"][..]].concat();
        let key = "key human_touch.per_kind: ";
        let huge = [key, "99999999999", "at most 10000000"];
        assert_refused_at_once(&case, &with("huge.toml"), &huge);
        let many = [key, "9000000", "54000000 touches", "GiB", "3.0 GiB"];
        assert_refused_at_once(&case, &with("many.toml"), &many);
        let objects = [
            "key touches.per_object: 9000000",
            "144000000 touches",
            "3.0 GiB",
        ];
        assert_refused_at_once(&case, &with("objects.toml"), &objects);
    }
}

/// Returns a study with this many values on each of three axes; the groups are the combinations of two of them.
fn configurations(values: [usize; 3]) -> String {
    let [noise, smoothing, ratio] = values.map(|n| {
        let values: Vec<String> = (1..=n)
            .map(|k| format!("{}", 1.0 + k as f64 / 64.0))
            .collect();
        format!("[{}]", values.join(", "))
    });
    let study = HUMAN.replace("ratio = 4", &format!("ratio = {ratio}"));
    study.replace(
        "[sensing]",
        &format!("[signal]\nnoise_std_mm = {noise}\nsmoothing_mm = {smoothing}\n\n[sensing]"),
    )
}

#[test]
fn a_study_is_planned_in_time_that_grows_as_its_cells_do_and_more_than_a_million_are_refused() {
    let case = Case::new();
    // Ratios near 1 give few different m for 64 taxels.
    case.file("large.toml", configurations([250, 200, 1]));
    let start = Instant::now();
    let (said, _) = case.succeeds("plan large.toml");
    says(&said, &["50001, of 50000 configurations"]);
    // If every group counted all configurations before it, this would take minutes.
    assert!(start.elapsed() < Duration::from_secs(20));
    case.file("huge.toml", configurations([1000, 1001, 1]));
    case.file("endless.toml", configurations([10_000, 10_000, 30]));
    for command in ["plan", "run"] {
        let huge = ["huge.toml: 1001000 configurations", "at most 1000000"];
        assert_refused_at_once(&case, &[command, "huge.toml"], &huge);
        let endless = ["configurations", "at most 1000000"];
        assert_refused_at_once(&case, &[command, "endless.toml"], &endless);
    }
}
