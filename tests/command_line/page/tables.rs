//! Table files: what is read equals what was written, equal tables give equal bytes, and no file is incomplete.

use crate::command::says;
use crate::report_synthetic::{
    ReportPage, about, add_headlines, configuration, each, noise_cells, quickstart_cells, tables,
    write_all, write_tables,
};
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::study_folder::{ChartFormat, MAX_CHARTS};
use bubbletouch::sensing::Ensemble;
use bubbletouch::studies::recognition::charts::{read_tables, tables_of};
use bubbletouch::study::table::{Comparison, Configuration, PStatus, Tables};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn contents(dir: &Path) -> BTreeMap<String, Vec<u8>> {
    let file = |entry: std::io::Result<fs::DirEntry>| {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        (name, fs::read(entry.path()).unwrap())
    };
    fs::read_dir(dir).unwrap().map(file).collect()
}

/// Files of a recognition study in the order of writing.
const FILES: &str = "accuracy.csv summary.csv confusion.csv comparison.csv timing.csv pareto.csv stages.csv confused.csv published.csv limits.csv \
                     robustness.csv accuracy_by_noise.svg pareto_prediction.svg confusion.svg report.html";

/// Asserts that a folder's tables have the columns and bytes from which they were made.
fn assert_reads_as(folder: &Path, made: &Tables) {
    let (read, made) = (read_tables(folder).unwrap(), tables_of(made).unwrap());
    for (read, made) in read.iter().zip(&made) {
        assert_eq!(read.columns, made.columns, "{}", made.file);
        assert!(read.csv == made.csv, "{}", made.file);
    }
    assert_eq!(read.len(), made.len());
}

#[test]
fn tables_read_back_as_they_were_written() {
    let dir = tempfile::tempdir().unwrap();
    let mut written = tables(quickstart_cells(), 3, 24);
    // C chosen by validation, and numbers that only the shortest round-trip form preserves.
    written.accuracy[0].0.c = None;
    written.accuracy[1].1.accuracy = 0.1 + 0.2;
    written.accuracy[2].1.c_used = Some(f64::MIN_POSITIVE);
    written.accuracy[3].1.c_used = None;
    written.timing[0].1.fit_s = 5e-324;
    written.confusion[0].object = "box, \"large\"\n2".to_owned();
    add_headlines(&mut written);
    write_tables(dir.path(), &written);
    assert_reads_as(dir.path(), &written);
    // One configuration with one trial has no interval of a difference.
    let single = tables(vec![configuration()], 1, 2);
    write_tables(dir.path(), &single);
    assert_reads_as(dir.path(), &single);
    write_tables(dir.path(), &Tables::default());
    assert_reads_as(dir.path(), &Tables::default());
}

/// Returns the content of a file.
fn csv_of(tables: &Tables, file: &str) -> String {
    let made = tables_of(tables).unwrap();
    let table = made.into_iter().find(|table| table.file == file).unwrap();
    String::from_utf8(table.csv).unwrap()
}

#[test]
fn a_row_is_the_cell_then_the_score_and_nothing_stands_for_absent() {
    let mut one = tables(vec![configuration()], 1, 2);
    one.summary[0].0.c = None;
    let score = &mut one.summary[0].1;
    (score.accuracy_low, score.accuracy_high) = (0.5625, 1e-7);
    one.comparison = vec![Comparison {
        configuration: 3,
        best_configuration: 1,
        n_trials: 1,
        difference: -0.25,
        difference_low: None,
        difference_high: None,
        p_value: None,
        p_holm: None,
        p_status: PStatus::TooFewTrials,
        n_trials_needed: Some(4),
    }];
    assert_eq!(
        csv_of(&one, "summary.csv"),
        "configuration,pitch_mm,nx,ny,size_mm,noise_std,noise_unit,smoothing_mm,ensemble,measurements,ratio,frames,features,\
         classifier,c,train_touches,touches_per_decision,n_trials,n_test,accuracy,accuracy_std,accuracy_low,accuracy_high,\
         bootstrap_low,bootstrap_high,macro_f1,n_capped\n\
         0,2.0,64,64,128.0,0.05,full_scale,0.0,gaussian,256,16.0,1,raw,linear_svm,,75,1,1,50,0.7,0.0,0.5625,\
         1e-7,,,0.696,0\n"
    );
    assert_eq!(
        csv_of(&one, "comparison.csv"),
        "configuration,best_configuration,n_trials,difference,difference_low,difference_high,p_value,p_holm,p_status,\
         n_trials_needed\n3,1,1,-0.25,,,,,too_few_trials,4\n"
    );
}

#[test]
fn a_table_without_rows_has_the_header_of_one_with_rows_and_reads_as_none() {
    let full = tables(quickstart_cells(), 3, 24);
    let none = Tables::default();
    for file in FILES.split(' ').take(6) {
        let (full, none) = (csv_of(&full, file), csv_of(&none, file));
        assert_eq!(none.lines().count(), 1);
        assert_eq!(full.lines().next(), none.lines().next());
        assert!(none.ends_with('\n'), "{none:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    write_tables(folder.path(), &none);
    assert_reads_as(folder.path(), &none);
}

#[test]
fn the_first_charts_are_drawn_and_the_page_says_which_are_left_out() {
    // The ratio is along x, ensembles are lines and pitches are panels; the remaining settings give 27 charts.
    let ratios = [4.0, 16.0, 64.0, 256.0];
    let all = each(vec![configuration()], ratios, |one, ratio| {
        one.ratio = ratio
    });
    let ensembles = [Ensemble::Gaussian, Ensemble::Sbhe, Ensemble::Sparse];
    let all = each(all, ensembles, |one, ensemble| one.ensemble = ensemble);
    let all = each(all, [50, 51, 52], |one, touches| {
        one.train_touches = touches
    });
    let all = each(all, [0.0, 1.0, 2.0], |one, mm| one.smoothing_mm = mm);
    let all = each(all, [0.0, 0.05, 0.1], |one, std| one.noise_std = std);
    let configurations = each(all, [2.0, 3.0, 4.0], |one, mm| one.pitch_mm = mm);
    let made = tables(configurations, 1, 8);
    let dir = tempfile::tempdir().unwrap();
    let drawn = |name: &str, all_charts, chart_format| {
        let folder = dir.path().join(name);
        let page = ReportPage {
            about: StudyAbout {
                all_charts,
                chart_format,
                ..about().about
            },
            ..about()
        };
        write_all(&folder, &made, &page).unwrap();
        let names = contents(&folder);
        let of_ending = |ending: &str| {
            let charts = names.keys().filter(|name| name.starts_with("accuracy_by"));
            let charts = charts.filter(|name| name.ends_with(ending));
            charts.cloned().collect::<Vec<_>>()
        };
        let html = String::from_utf8(names["report.html"].clone()).unwrap();
        (of_ending(".svg"), of_ending(".png"), html)
    };
    let (first, png, html) = drawn("first", false, ChartFormat::Svg);
    // Two of the charts show the time of a decision and the confusions.
    let most = MAX_CHARTS - 2;
    assert_eq!((first.len(), png.len()), (most, 0));
    let (all, _, all_html) = drawn("all", true, ChartFormat::Svg);
    assert!(all.len() > most + 1 && first.iter().all(|name| all.contains(name)));
    let n_left_out = all.len() - most;
    let said = format!("{n_left_out} more, from accuracy_by_");
    says(&html, &[&said, "--all-charts"]);
    assert!(!all_html.contains("--all-charts"));
}

#[test]
fn notes_say_which_intervals_come_from_groups_and_which_hold_less_often_than_they_say() {
    let note = |made: &Tables, file: &str| {
        let mut made = tables_of(made).unwrap().into_iter();
        made.find(|table| table.file == file).unwrap().note
    };
    let made = |n_trials| tables(quickstart_cells(), n_trials, 3);
    let few = note(&made(5), "summary.csv");
    says(&few, &["Wilson", "about 92 % with 5 trials"]);
    for n_trials in [4, 15] {
        let enough = note(&made(n_trials), "summary.csv");
        assert!(!enough.contains("ootstrap"), "{enough}");
    }
    let mut grouped = made(10);
    for (configuration, score) in &mut grouped.summary {
        score.n_groups = Some(12 - configuration.configuration % 2);
    }
    let said = note(&grouped, "summary.csv");
    let all = "from the groups that are held out, not from single test decisions, at least 11.";
    assert!(said.contains(all) && !said.contains("Wilson"), "{said}");
    assert!(note(&grouped, "accuracy.csv").contains("Wilson"));
    grouped.summary[1].1.n_groups = Some(2);
    let said = note(&grouped, "summary.csv");
    says(&said, &["some come from 2: fewer than 5 groups say little"]);
}

#[test]
fn equal_tables_give_equal_bytes_in_every_file() {
    let dir = tempfile::tempdir().unwrap();
    let made = tables(noise_cells(), 3, 24);
    let (first, second) = (dir.path().join("a"), dir.path().join("b/deeper"));
    let paths = write_all(&first, &made, &about()).unwrap();
    // Other charts drawn in between must not change a byte.
    let other = tables(quickstart_cells(), 1, 3);
    write_all(&dir.path().join("c"), &other, &about()).unwrap();
    write_all(&second, &made, &about()).unwrap();
    assert_eq!(contents(&first), contents(&second));
    let name = |path: &PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
    let names: Vec<String> = paths.iter().map(name).collect();
    assert_eq!(names.join(" "), FILES);
    assert_eq!(contents(&first).len(), names.len());
}

#[test]
fn a_table_that_cannot_be_read_is_named_with_its_line() {
    let dir = tempfile::tempdir().unwrap();
    let two = [16.0, 4.0].map(|ratio| Configuration {
        ratio,
        ..configuration()
    });
    let made = tables(two.to_vec(), 2, 3);
    write_tables(dir.path(), &made);
    let path = dir.path().join("summary.csv");
    let whole = fs::read_to_string(&path).unwrap();
    let wrong = whole.replace("gaussian,256,4.0", "gaussian,many,4.0");
    let cut = whole[..whole.len() - 30].to_owned();
    for (text, words) in [
        (Some(wrong), "summary.csv: line 3"),
        (Some(cut), "summary.csv: line 3"),
        (None, "summary.csv: is missing"),
    ] {
        match text {
            Some(text) => fs::write(&path, text).unwrap(),
            None => fs::remove_file(&path).unwrap(),
        }
        let error = read_tables(dir.path()).unwrap_err();
        says(&error.to_string(), &[words]);
        assert_eq!(error.exit_code(), 2);
    }
}

#[test]
fn a_folder_that_cannot_be_written_stays_as_it_was() {
    let dir = tempfile::tempdir().unwrap();
    let made = tables(vec![configuration()], 1, 2);
    let taken = dir.path().join("taken");
    fs::write(&taken, "mine").unwrap();
    let said = write_all(&taken, &made, &ReportPage::default()).unwrap_err();
    assert_eq!(said.exit_code(), 2);
    assert!(said.to_string().contains("is not a folder"), "{said}");
    assert_eq!(fs::read_to_string(&taken).unwrap(), "mine");
    // A folder is in the place of the page: existing files are complete, and no partial file remains.
    let blocked = dir.path().join("blocked");
    fs::create_dir_all(blocked.join("report.html/inside")).unwrap();
    assert!(write_all(&blocked, &made, &ReportPage::default()).is_err());
    assert_reads_as(&blocked, &made);
    let mut entries = fs::read_dir(&blocked).unwrap();
    let is_partial = |name: std::ffi::OsString| name.to_string_lossy().contains("partial");
    assert!(!entries.any(|entry| is_partial(entry.unwrap().file_name())));
}
