//! Law: recorded frames of simulated touches give the tables of the simulated study, for any skin, signal and learning method. The names of the files do not
//! matter.

use super::generator::{GeneratedStudy, Generator, n_studies};
use super::outcome::{Tables, rows, run, without_times};
use crate::command::Case;
use rand::Rng;
use std::fs;
use std::path::Path;
use toml::{Table, Value};

/// Axes that a study of recorded frames also accepts in their own tables.
const AXES: &[&str] = &[
    "signal.noise_std_full_scale",
    "sensing.ratio",
    "recognition.features",
    "recognition.classifier",
    "recognition.temporal_features",
    "recognition.touches_per_decision",
    "recognition.train_touches",
];

/// Returns the study with human touches instead of touches of objects.
fn of_human_touches(study: &GeneratedStudy) -> GeneratedStudy {
    let mut study = study.clone();
    study.table.remove("objects");
    study.table.remove("touches");
    let kinds = ["tap", "stroke", "grab"].map(Value::from);
    study
        .without_all("skin.damping_n_s_per_m skin.sensed skin.friction")
        .with("skin.pitch_mm", 12.0)
        .with("skin.stroke_mm", 6.0)
        .with("human_touch.kinds", kinds.to_vec())
        .with("human_touch.per_kind", 12)
        .with("human_touch.frames_hz", 10.0)
        .with("human_touch.duration_s", 2.5)
}

/// Returns the study with touches that move while a frame is read.
fn scanned(study: &GeneratedStudy, scan_time: Value) -> GeneratedStudy {
    let steps = study.get("signal.steps").and_then(Value::as_array);
    let mut steps = steps.cloned().unwrap_or_default();
    if !steps.contains(&"scan".into()) {
        steps.insert(0, "scan".into());
    }
    study
        .with("signal.steps", steps)
        .with("signal.scan_time_ms", scan_time)
        .with("touches.frames", 3)
        .with("touches.speed_mm_per_s", 20.0)
        .with("touches.depth_mm", 1.5)
}

/// Returns the study of the touches in a folder, with the tables that were written beside them.
fn of_folder(study: &GeneratedStudy, folder: &Path) -> GeneratedStudy {
    let mut study = study.clone();
    for table in ["objects", "touches", "human_touch"] {
        study.table.remove(table);
    }
    let text = fs::read_to_string(folder.join("recorded.toml")).unwrap();
    let mut tables: Table = toml::from_str(&text).unwrap();
    let recorded = tables["recorded"].as_table_mut().unwrap();
    for (_, value) in recorded.iter_mut() {
        if let Some(name) = value.as_str().filter(|name| name.ends_with(".npy")) {
            *value = folder.join(name).display().to_string().into();
        }
    }
    study.table.extend(tables);
    study
}

/// Returns the tables without times, and only those limits that recorded and simulated touches share.
fn found(study: &GeneratedStudy) -> Option<Tables> {
    let mut tables = without_times(run(&study.load().ok()?).ok()?);
    let limits = rows(&tables["limits.csv"]).into_iter();
    let counts = limits.map(|row| format!("{} {} {}\n", row["limit"], row["count"], row["total"]));
    let counts: String = counts.collect();
    tables.insert("limits.csv".to_owned(), counts.into());
    Some(tables)
}

/// Renames the files of a folder, also in `recorded.toml`.
fn rename(folder: &Path) {
    let tables = folder.join("recorded.toml");
    let mut text = fs::read_to_string(&tables).unwrap();
    for name in ["frames", "labels", "shear", "depths"] {
        let (old, new) = (format!("{name}.npy"), format!("of_{name}_2.npy"));
        if text.contains(&format!("\"{old}\"")) {
            text = text.replace(&format!("\"{old}\""), &format!("\"{new}\""));
            fs::rename(folder.join(old), folder.join(new)).unwrap();
        }
    }
    fs::write(tables, text).unwrap();
}

/// Asserts that the exported touches of a study give its tables, also under other names of files. Returns false if the study cannot be run.
pub fn is_recorded_as_simulated(study: &GeneratedStudy) -> bool {
    let Some(simulated) = found(study) else {
        return false;
    };
    let case = Case::with("study.toml", study.text());
    case.succeeds("touches study.toml --out touches");
    let recorded = of_folder(study, &case.path("touches"));
    let told = |name: &str| format!("{name} of\n{}\n{}", study.text(), recorded.text());
    let again = found(&recorded).unwrap_or_else(|| {
        let error = recorded.load().map(|loaded| run(&loaded).map(drop));
        panic!("{:?}: {}", error.map(drop), told("refused"))
    });
    for (name, table) in &simulated {
        let text = |table: &[u8]| String::from_utf8(table.to_vec()).unwrap();
        assert_eq!(text(&again[name]), text(table), "{}", told(name));
    }
    assert_eq!(again.len(), simulated.len());
    rename(&case.path("touches"));
    let renamed = found(&of_folder(study, &case.path("touches")));
    assert!(renamed == Some(again), "{}", told("renamed"));
    true
}

#[test]
fn recorded_touches_give_the_tables_of_the_simulated_ones() {
    let mut n_compared = 0;
    for number in 0..n_studies() {
        let mut generator = Generator::new("recorded touches", number);
        let is_human = number % 5 == 4;
        let scan_time = generator.values("signal.scan_time_ms").swap_remove(0);
        let touched = |study: &GeneratedStudy| match is_human {
            true => of_human_touches(study),
            // A taxel that is pushed by exactly its stroke is not saturated, but its reading equals the reading of a taxel that is pushed further. The press
            // continues while a frame is read.
            false if number % 5 == 3 => scanned(study, scan_time.clone()),
            false if study.get("touches.depth_mm") == study.get("skin.stroke_mm") => {
                study.with("touches.depth_mm", 1.5)
            }
            false => study.clone(),
        };
        let mut study = touched(&generator.study(|study| touched(study).load().is_ok()));
        for key in AXES {
            let mut values = generator.values(key);
            values.truncate(2);
            let swept = study.with(key, values);
            let is_chosen = study.get(key).is_some() && generator.rng.gen_bool(0.3);
            if is_chosen && swept.load().is_ok() {
                study = swept;
            }
        }
        n_compared += u64::from(is_recorded_as_simulated(&study));
    }
    assert!(2 * n_compared >= n_studies(), "{n_compared}");
}
