//! A study within a ceiling of memory, and touches that are kept from one run to the next.

use crate::command::Case;
use crate::study::Study;
use bubbletouch::study::memory::{AtOnce, MemoryPlan};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::{
    FrameStorage, Manner, Outcome, Part, TouchCache, journal::Journal, run_with,
};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// Touches that remember the one before, so that frames are read out of their order too.
const SMALL: &str = r#"
question = "?"
trials = 2
seed = 5

[objects]
sets = ["balls"]

[skin]
pitch_mm = [2.0, 4.0]
size_mm = 64.0
stroke_mm = 5.0

[touches]
per_object = 12
frames = [1, 3]
offset_x_mm = { uniform = [-6.0, 6.0] }
offset_y_mm = { uniform = [-6.0, 6.0] }
depth_mm = { uniform = [1.0, 3.0] }

[signal]
noise_std_full_scale = [0.0, 0.05]
hysteresis_full_scale = 0.1
steps = ["hysteresis", "noise"]

[sensing]
ensemble = ["sbhe", "gaussian"]
ratio = [8, 32]

[recognition]
classifier = ["linear_svm", "k_nearest"]
c = [0.1, 1.0]
"#;

/// 4,800 touches of 16,384 taxels, which would take 310 MB if all taxels were kept.
const LARGE: &str = r#"
question = "?"
trials = 1

[objects]
sets = ["balls"]

[skin]
pitch_mm = 1.0
taxels = 128
stroke_mm = 5.0

[touches]
per_object = 300
offset_x_mm = { uniform = [-20.0, 20.0] }
offset_y_mm = { uniform = [-20.0, 20.0] }
depth_mm = { uniform = [1.0, 3.0] }

[sensing]
ensemble = "sbhe"
ratio = [256, 512, 1024]

[recognition]
classifier = "linear_svm"
train_touches = 30
solver_memory_gib = 0.01
"#;

fn run_in(study: &Study, storage: &FrameStorage, at_once: AtOnce) -> Outcome {
    let manner = Manner {
        journal: &Journal::none(),
        fail_fast: true,
        retries: false,
        part: Part::All,
        storage,
        at_once,
    };
    run_with(&study.plan, &study.sweep, &study.touched, &Silent, manner).unwrap()
}

#[test]
fn frames_in_files_and_one_piece_at_a_time_give_the_same_tables() {
    let study = Study::new(SMALL);
    let usual = study.run();
    let folder = tempfile::tempdir().unwrap();
    for (limit, n_kept) in [(u64::MAX, 4), (0, 0)] {
        let cache = TouchCache::new(folder.path().join(limit.to_string()), limit);
        let storage = FrameStorage::new(cache.clone(), 0);
        for (jobs, families) in [(1, 1), (3, 2)] {
            let outcome = run_in(&study, &storage, AtOnce { jobs, families });
            assert_eq!(outcome.tables.accuracy, usual.tables.accuracy);
            assert_eq!(outcome.tables.confusion, usual.tables.confusion);
            assert_eq!(outcome.arrays, usual.arrays);
            assert_eq!(cache.list().unwrap().len(), n_kept, "limit {limit}");
        }
    }
}

#[test]
fn touches_that_are_kept_are_not_made_again_and_others_are() {
    let folder = tempfile::tempdir().unwrap();
    let cache = TouchCache::new(folder.path(), u64::MAX);
    let storage = FrameStorage::new(cache.clone(), 0);
    let seconds = |text: &str| -> Vec<u64> {
        let outcome = run_in(&Study::new(text), &storage, AtOnce::ALL);
        let stages = outcome.tables.stages.iter();
        let made = stages.filter(|stage| stage.stage.starts_with("simulate"));
        made.map(|stage| stage.cpu_s.to_bits()).collect()
    };
    let first = seconds(SMALL);
    // A clock that ran twice would not show the same nanosecond.
    assert_eq!(seconds(SMALL), first);
    assert_eq!(seconds(&SMALL.replace("trials = 2", "trials = 1")), first);
    assert_eq!(cache.list().unwrap().len(), 4);
    for change in [
        ("seed = 5", "seed = 6"),
        ("[1.0, 3.0]", "[1.0, 3.5]"),
        ("stroke_mm = 5.0", "stroke_mm = 9.0"),
    ] {
        let before = cache.list().unwrap().len();
        seconds(&SMALL.replace(change.0, change.1));
        assert_eq!(cache.list().unwrap().len(), before + 4, "{change:?}");
    }
    let facts = cache.list().unwrap()[0].facts().unwrap();
    let (n_objects, n_taxels) = (Study::new(SMALL).touched.len(), facts.n_taxels);
    assert!(n_taxels == 1024 || n_taxels == 256, "{n_taxels}");
    assert!(
        facts
            .what
            .starts_with(&format!("{} touches", 12 * n_objects))
    );
}

#[test]
fn what_was_used_longest_ago_goes_first() {
    let folder = tempfile::tempdir().unwrap();
    let all = TouchCache::new(folder.path(), u64::MAX);
    let study = Study::new(SMALL);
    run_in(&study, &FrameStorage::new(all.clone(), 0), AtOnce::ALL);
    let listed = all.list().unwrap();
    let sizes: Vec<u64> = listed.iter().map(|touches| touches.n_bytes).collect();
    let two: u64 = sizes[..2].iter().sum();
    let gone = all.prune(two).unwrap();
    assert_eq!(gone, listed[2..]);
    assert_eq!(all.list().unwrap(), listed[..2]);
    assert_eq!(all.prune(0).unwrap().len(), 2);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_damaged_file_is_named_and_made_again_with_the_same_bytes() {
    let case = Case::new();
    // Few cells, whose charts are soon drawn.
    let few = SMALL.replace("[\"sbhe\", \"gaussian\"]", "\"sbhe\"");
    let few = few.replace("[8, 32]", "8").replace("[0.0, 0.05]", "0.0");
    let few = few.replace(
        "[\"linear_svm\", \"k_nearest\"]\nc = [0.1, 1.0]",
        "\"k_nearest\"",
    );
    case.file("few.toml", &few);
    let cache = TouchCache::new(case.path("results/touches"), u64::MAX);
    run_in(
        &Study::new(&few),
        &FrameStorage::new(cache.clone(), 0),
        AtOnce::ALL,
    );
    let (said, _) = case.succeeds(&["cache", "list"]);
    assert!(
        said.contains("touches of 3 frames, 32×32 at 2 mm"),
        "{said}"
    );
    // The command reads what it did not make.
    let seconds = cache.list().unwrap()[3].facts().unwrap().cpu_s;
    case.succeeds(&["run", "few.toml", "--quiet"]);
    let stages = fs::read_to_string(case.path("results/few/stages.csv")).unwrap();
    assert!(
        stages.contains(&seconds.to_string()),
        "{seconds} s in {stages}"
    );
    let table = || fs::read(case.path("results/few/accuracy.csv")).unwrap();
    let fresh = table();
    let kept = cache.list().unwrap();
    let whole: Vec<Vec<u8>> = kept.iter().map(|k| fs::read(&k.path).unwrap()).collect();
    for (touches, bytes) in kept.iter().zip(&whole) {
        let mut bytes = bytes.clone();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
        fs::write(&touches.path, bytes).unwrap();
    }
    // A list reads what stands around frames only, unless it is asked to check them.
    let (said, _) = case.succeeds(&["cache", "list"]);
    assert!(!said.contains("damaged"), "{said}");
    let (said, _) = case.succeeds(&["cache", "list", "--check"]);
    assert_eq!(said.matches("damaged").count(), 4, "{said}");
    let again = || {
        let (_, said) = case.succeeds(&["run", "few.toml", "--quiet", "--fresh"]);
        assert!(said.contains(".touches is "), "{said}");
        assert!(said.contains("it is made again"), "{said}");
        assert!(!said.contains("cache prune"), "{said}");
        assert_eq!(table(), fresh);
    };
    again();
    // Too little work to be kept again. Cut, empty, of the form before, and a folder.
    assert_eq!(cache.list().unwrap().len(), 0);
    fs::write(&kept[0].path, &whole[0][..whole[0].len() / 2]).unwrap();
    fs::write(&kept[1].path, b"").unwrap();
    fs::write(&kept[2].path, [b"bubbletouch frm1", &whole[2][..]].concat()).unwrap();
    fs::create_dir(&kept[3].path).unwrap();
    again();
    assert!(!kept[3].path.is_dir());
    case.succeeds(&["cache", "prune"]);
    let (said, _) = case.succeeds(&["cache", "list"]);
    assert!(said.contains("no touches are kept"), "{said}");
}

/// The least ceiling of a study, as its refusal says it.
fn least_gib(case: &Case, study: &str) -> String {
    let output = case.run(&["plan", study, "--memory-gib", "0.01"]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    let (_, after) = said.split_once("at least ").expect("how much it takes");
    let (least, _) = after.split_once(" GiB").expect("a unit");
    // It is rounded to hundredths.
    format!("{:.2}", least.parse::<f64>().unwrap() + 0.01)
}

#[test]
fn a_study_stays_below_its_ceiling_and_finds_the_same() {
    let case = Case::new();
    case.file("large.toml", LARGE);
    let least = least_gib(&case, "large.toml");
    let ceiling = least.parse::<f64>().unwrap() * f64::from(1 << 30);
    assert!(ceiling < 0.4e9, "{least} GiB");
    case.succeeds(&["run", "large.toml", "--out", "free", "--quiet"]);
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
        let read = |folder: &str| fs::read(case.path(folder).join(table)).unwrap();
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

#[test]
fn a_ceiling_too_low_is_refused_with_what_it_takes() {
    let study = Study::new(SMALL);
    let plan = |ceiling| MemoryPlan::new(&study.plan, &study.sweep, study.touched.len(), ceiling);
    let error = plan(Some(1 << 20)).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("at least 0."), "{error}");
    let free = plan(None).unwrap();
    assert_eq!(free.at_once, AtOnce::ALL);
    let most = free.most_bytes as u64;
    assert_eq!(plan(Some(most + 1)).unwrap().at_once, AtOnce::ALL);
    let tight = plan(Some(most * 3 / 4));
    assert!(tight.is_err() || tight.unwrap().most_bytes <= most as f64 * 0.75);
    let case = Case::new();
    case.file("small.toml", SMALL);
    for bad in ["0", "-1", "nan", "inf"] {
        let output = case.run(&["run", "small.toml", &format!("--memory-gib={bad}")]);
        assert_eq!(output.status.code(), Some(2), "{bad}");
    }
    assert!(!case.path("results").exists());
}

/// Which kind of touch is it? In few frames on few taxels.
const HUMAN: &str = r#"
question = "?"

[human_touch]
per_kind = 8
frames_hz = 20.0
duration_s = 4.0

[skin]
pitch_mm = 8.0
taxels = 8
stroke_mm = 4.0

[sensing]
ratio = 4

[recognition]
classifier = "k_nearest"
"#;

/// Refused within the time that a plan takes, with exit code 2 and this.
fn assert_refused_at_once(case: &Case, arguments: &[&str], said: &[&str]) {
    let start = Instant::now();
    let output = case.run(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
    assert!(start.elapsed() < Duration::from_secs(10), "{arguments:?}");
    for words in said {
        assert!(error.contains(words), "{arguments:?}: {error}");
    }
}

#[test]
fn touches_that_memory_cannot_hold_are_refused_before_any_is_drawn() {
    let case = Case::new();
    case.file("fits.toml", HUMAN);
    case.succeeds(&["plan", "fits.toml"]);
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

/// Cells of so many values on each of three axes, in as many groups as cells of two of them.
fn cells(values: [usize; 3]) -> String {
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
    // Ratios near 1 name few different m of 64 taxels.
    case.file("large.toml", cells([500, 400, 1]));
    let start = Instant::now();
    let (said, _) = case.succeeds(&["plan", "large.toml"]);
    assert!(said.contains("200000 × 1 trial"), "{said}");
    // With every group counting all cells before it, minutes.
    assert!(start.elapsed() < Duration::from_secs(20));
    case.file("huge.toml", cells([1000, 1001, 1]));
    case.file("endless.toml", cells([10_000, 10_000, 30]));
    for command in ["plan", "run"] {
        let huge = ["huge.toml: 1001000 configurations", "at most 1000000"];
        assert_refused_at_once(&case, &[command, "huge.toml"], &huge);
        let endless = ["configurations", "at most 1000000"];
        assert_refused_at_once(&case, &[command, "endless.toml"], &endless);
    }
}
