//! Studies within a memory limit.

use crate::command::{Case, says, skip};
use crate::study::{Study, changed};
use bubbletouch::kinds::recognition::recognition_scale;
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
    let limit = format!("--memory-gib {least}");
    case.succeeds(&format!("run large.toml --out below --quiet {limit}"));
    let tables = ["accuracy.csv", "confusion.csv", "summary.csv"];
    case.same_files(["free", "below"], &tables);
    let Some(peak) = peak(&case, "below") else {
        skip("this system does not tell how much memory a process took");
        return;
    };
    assert!((peak as f64) < ceiling, "{peak} bytes, ceiling {ceiling}");
}

/// Returns the largest memory of a run, bytes; `None` if the system does not tell.
fn peak(case: &Case, folder: &str) -> Option<u64> {
    let manifest = case.read(&format!("{folder}/manifest.json"));
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
    let sensing = "ensemble = \"sbhe\"\nratio = [256, 512, 1024]";
    let svm = "classifier = \"linear_svm\"";
    let learned = "ensemble = \"adaptive_learned\"\nmeasurements = 16";
    let neighbours = "features = \"descriptors\"\nclassifier = \"k_nearest\"";
    // Principal components of shifted copies of training frames.
    let fitted = [(sensing, learned), (svm, neighbours)];
    // Several readings of each touch, of which only features of images are kept.
    let noisy = "[signal]\nnoise_std_full_scale = 0.1\n\n[sensing]";
    let chosen = "features = \"descriptors\"\nreadings_per_touch = 6\nclassifier = \"rbf_svm\"\nc_grid = [1.0, 10.0]\ncv_folds = 2\ncv_touches = 10";
    let identity = "ensemble = \"identity\"";
    let read = [("[sensing]", noisy), (sensing, identity), (svm, chosen)];
    // All taxels of all touches, in two trials at the same time.
    let whole = [
        (sensing, identity),
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
        // Large frames are freed while a reconstruction goes on. If freed memory does not return at once, its peak depends on the load of the machine.
        let mut run = case.command("run study.toml --fresh --threads 2 --quiet --out out");
        if name == "reconstruction" {
            run.env("MIMALLOC_PURGE_DELAY", "0");
        }
        let output = run.output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let Some(peak) = peak(&case, "out") else {
            skip("this system does not tell how much memory a process took");
            return;
        };
        let peak = peak as f64 / f64::from(1 << 20);
        let error = planned / peak - 1.0;
        assert!(error.abs() < 0.2, "{name}: {planned:.0} MiB for {peak:.0}");
    }
    case.file("study.toml", RECONSTRUCTION);
    // The full dictionary takes minutes; its peak was measured once (/usr/bin/time -v).
    let planned = planned_mib(&case, "study.toml");
    assert!((planned / 969.0 - 1.0).abs() < 0.2, "{planned} MiB");
    case.refuses("run study.toml --memory-gib 0.5");
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
    let said = case.refuses("run small.toml --memory-gib 0.001");
    says(&said, &["at least 0."]);
    for bad in ["0", "-1", "nan", "inf"] {
        case.refuses(&["run", "small.toml", &format!("--memory-gib={bad}")]);
    }
    assert!(!case.path("results").exists());
}

/// Study of kinds of human touch, with few frames and few taxels.
const HUMAN: &str = include_str!("../fixtures/texts/memory_human.toml");

/// Asserts that the command fails as quickly as a plan, with the given text.
fn assert_refused_at_once(case: &Case, line: &str, said: &[&str]) {
    let start = Instant::now();
    says(&case.refuses(line), said);
    assert!(start.elapsed() < Duration::from_secs(10), "{line}");
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
    for command in ["plan", "run --out out"] {
        let refused = |file: &str, said: &[&str]| {
            assert_refused_at_once(&case, &format!("{command} {file} --memory-gib 3"), said);
        };
        let key = "key human_touch.per_kind: ";
        refused("huge.toml", &[key, "99999999999", "at most 10000000"]);
        refused(
            "many.toml",
            &[key, "9000000", "54000000 touches", "GiB", "3.0 GiB"],
        );
        let key = "key touches.per_object: 9000000";
        refused("objects.toml", &[key, "144000000 touches", "3.0 GiB"]);
    }
}

/// Returns a study with this many values on each of three axes; the groups are the combinations of two of them.
fn configurations(values: [usize; 3]) -> String {
    let [noise, smoothing, ratio] = values.map(|n| {
        let values = (1..=n).map(|k| 1.0 + k as f64 / 64.0);
        values.collect::<Vec<f64>>()
    });
    let signal = format!("[signal]\nnoise_std_mm = {noise:?}\nsmoothing_mm = {smoothing:?}\n");
    let study = HUMAN.replace("ratio = 4", &format!("ratio = {ratio:?}"));
    study.replace("[sensing]", &format!("{signal}\n[sensing]"))
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
        assert_refused_at_once(&case, &format!("{command} huge.toml"), &huge);
        let endless = ["configurations", "at most 1000000"];
        assert_refused_at_once(&case, &format!("{command} endless.toml"), &endless);
    }
}
