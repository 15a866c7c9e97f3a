//! Overhead of the study engine per configuration, without drawing and learning: `cargo bench --bench study`.
//!
//! 1. **Items**: 10,000 work items that only return a row, with a journal on disk. The study then runs again with all items finished.
//! 2. **Configurations**: a recognition study of 12,000 configurations on one thread, with a journal on disk. Touches, measurements and fits report their
//!    times. The engine uses the remaining time for enumeration, journal and tables.

use bubbletouch::Result;
use bubbletouch::kinds::Study;
use bubbletouch::kinds::recognition::{RecognitionRows, RecognitionStudy};
use bubbletouch::random::Seed;
use bubbletouch::study::journal::{Identity, JOURNAL_FILE, Journal};
use bubbletouch::study::progress::Silent;
use bubbletouch::study::work_items::{ItemRows, Part, PendingItems, RunOptions, WorkItem};
use bubbletouch::study::{Plan, StudySpec, draw_touches, load_objects};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;

const N_ITEMS: usize = 10_000;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Row {
    number: usize,
    value: f64,
    text: String,
}

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Rows {
    rows: Vec<(Row, Row)>,
}

impl ItemRows for Rows {
    fn append(&mut self, next: Self) {
        self.rows.extend(next.rows);
    }
}

fn name(number: usize) -> String {
    format!("item number {number} of a study that does nothing")
}

/// Lists the work items.
fn nothing_items() -> Vec<WorkItem> {
    let item = |n| WorkItem::of(name(n), n, &());
    (0..N_ITEMS).map(item).collect()
}

/// Computes the pending work items.
fn measure_nothing(pending: &PendingItems<Rows>) -> Result<()> {
    (0..N_ITEMS).into_par_iter().try_for_each(|number| {
        pending.finish(number, || {
            let row = Row {
                number,
                value: (number as f64).sqrt(),
                text: "as long as words in tables are".to_owned(),
            };
            let rows = vec![(row.clone(), row)];
            Ok(Rows { rows })
        })
    })
}

/// Study of two objects on an array of 64 taxels, with 12,000 configurations.
const STUDY: &str = r#"
question = "What does the engine cost?"
trials = 1

[objects]
sets = ["cans"]
names = ["can_54x57.2", "can_157.2x109.5"]
surface_error_mm = 4.0

[skin]
pitch_mm = 8.0
taxels = 8
stroke_mm = 5.0

[touches]
per_object = 8
offset_x_mm = { uniform = [-5.0, 5.0] }
depth_mm = 3.0

[signal]
noise_std_full_scale = [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1, 0.11, 0.12, 0.13, 0.14, 0.15, 0.16, 0.17, 0.18, 0.19, 0.2]
smoothing_mm = [0.0, 4.0, 8.0, 12.0, 16.0]

[sensing]
ensemble = ["gaussian", "sbhe", "sparse", "subsample"]
measurements = [2, 3, 4, 5, 6]

[recognition]
classifier = ["naive_bayes", "k_nearest", "linear_svm"]
n_neighbours = 1
features = ["raw", "unit_norm"]
test_fraction = 0.5
"#;

/// Prints an aligned line with the microseconds per item.
fn say(what: &str, seconds: f64, n: usize) {
    println!("{what:<58} {:>8.1} µs", 1e6 * seconds / n as f64);
}

fn journal(folder: &Path, name: &str) -> Result<Journal> {
    let identity = Identity::new(name.to_owned(), Default::default(), Default::default());
    Journal::open(&folder.join(format!("{name}_{JOURNAL_FILE}")), &identity)
}

fn n_pending<R: ItemRows>(items: &[WorkItem], journal: &Journal) -> usize {
    let options = RunOptions {
        journal,
        ..RunOptions::whole(&Silent)
    };
    PendingItems::<R>::new(items, &options).n()
}

fn time_items(folder: &Path) -> Result<()> {
    for what in ["done and kept", "read and put into rows"] {
        let start = Instant::now();
        let journal = journal(folder, "items")?;
        let options = RunOptions {
            journal: &journal,
            fail_fast: false,
            retries: true,
            part: Part::All,
            progress: &Silent,
        };
        let items = nothing_items();
        let pending = PendingItems::new(&items, &options);
        if pending.n() > 0 {
            measure_nothing(&pending)?;
        }
        let (rows, _) = pending.into_rows(|_, _| (), name);
        journal.sync()?;
        assert_eq!(rows.rows.len(), N_ITEMS);
        let seconds = start.elapsed().as_secs_f64();
        say(&format!("an item, {what}"), seconds, N_ITEMS);
    }
    let journal = journal(folder, "items")?;
    let start = Instant::now();
    assert_eq!(n_pending::<Rows>(&nothing_items(), &journal), 0);
    let seconds = start.elapsed().as_secs_f64();
    say("an item, seen to be done", seconds, N_ITEMS);
    Ok(())
}

fn time_cells(folder: &Path) -> Result<()> {
    let start = Instant::now();
    let plan = Plan::new("study", StudySpec::parse("study", STUDY)?)?;
    let objects = load_objects(&plan.spec.objects, None)?;
    let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed))?;
    let study = RecognitionStudy::new(plan, Box::new(touched))?;
    let n_configurations = study.n_configurations();
    println!(
        "{n_configurations} cells of {} classes",
        study.first().touched.class_names().len()
    );
    let n_items = study.work_items().len();
    println!("{n_items} work items");
    say(
        "a cell, planned",
        start.elapsed().as_secs_f64(),
        n_configurations,
    );
    for what in ["done and kept", "read and tabulated"] {
        say(
            &format!("a cell, {what}"),
            time_run(folder, &study)?,
            n_configurations,
        );
    }
    let journal = journal(folder, "cells")?;
    let start = Instant::now();
    assert_eq!(
        n_pending::<RecognitionRows>(&study.work_items(), &journal),
        0
    );
    say(
        "a cell, seen to be done",
        start.elapsed().as_secs_f64(),
        n_configurations,
    );
    Ok(())
}

/// Returns the duration of a run on this thread, s.
fn time_run(folder: &Path, study: &RecognitionStudy) -> Result<f64> {
    let start = Instant::now();
    let journal = journal(folder, "cells")?;
    let options = RunOptions {
        journal: &journal,
        fail_fast: false,
        retries: true,
        part: Part::All,
        progress: &Silent,
    };
    let items = study.work_items();
    let pending = PendingItems::new(&items, &options);
    if pending.n() > 0 {
        study.measure(&pending)?;
    }
    let (rows, failures) = pending.into_rows(
        |number, rows| study.place(number, rows),
        |number| study.item_words(number, &items[number]),
    );
    assert!(failures.is_empty(), "{:?}", failures[0]);
    let outcome = study.outcome(rows)?;
    journal.sync()?;
    assert_eq!(outcome.summary.len(), study.n_configurations());
    Ok(start.elapsed().as_secs_f64())
}

fn main() -> Result<()> {
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let alone = alone.expect("a thread can be had");
    let folder = tempfile::tempdir().expect("a folder can be made");
    alone.install(|| {
        time_items(folder.path())?;
        time_cells(folder.path())
    })
}
