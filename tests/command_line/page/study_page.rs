//! The page of a study of any kind: its charts come from the renderer, its marks and tables are the rows of the files.

use crate::browser::{ARROW_DOWN, ARROW_RIGHT, Browser, ENTER};
use crate::chart_tables::{charts, tables};
use crate::command::says;
use bubbletouch::report::chart::{draw, places};
use bubbletouch::report::folder::write_files;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::study_folder::{Beyond, Found, files_with};
use bubbletouch::table::{ChartSpec, Table};
use serde_json::json;
use std::path::PathBuf;
use tempfile::TempDir;

fn written(tables: &[Table], charts: &[ChartSpec]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let about = StudyAbout {
        name: "synthetic <study>".to_owned(),
        question: "What holds for every kind?".to_owned(),
        command: "bubbletouch run synthetic.toml".to_owned(),
        program: "bubbletouch 0".to_owned(),
        wall_s: 3.0,
        ..StudyAbout::default()
    };
    let answers = [
        "The first is best & largest.".to_owned(),
        "Others follow.".to_owned(),
    ];
    let found = Found {
        tables,
        charts,
        answers: &answers,
    };
    let files = files_with(&about, &found, || Ok(Beyond::default())).unwrap();
    write_files(folder.path(), files).unwrap();
    let page = folder.path().join("report.html");
    (folder, page)
}

fn opened(tables: &[Table], charts: &[ChartSpec]) -> Option<(TempDir, Browser)> {
    let (folder, page) = written(tables, charts);
    let browser = Browser::start()?;
    browser.resize(1200, 900);
    browser.open(&page);
    Some((folder, browser))
}

fn scores(tables: &[Table]) -> &Table {
    tables
        .iter()
        .find(|table| table.file == "scores.csv")
        .unwrap()
}

/// Returns the values of an attribute in the order of the text.
fn attributes<'t>(text: &'t str, name: &str) -> Vec<&'t str> {
    let start = format!(" {name}=\"");
    let parts = text.split(&start[..]).skip(1);
    parts.filter_map(|part| part.split('"').next()).collect()
}

#[test]
fn every_mark_of_a_chart_in_the_page_holds_its_row_and_values() {
    let tables = tables();
    let (folder, page) = written(&tables, &charts());
    let page = std::fs::read_to_string(page).unwrap();
    for spec in charts() {
        let drawing = draw(&spec, &tables).unwrap();
        let svg = drawing.svg_with_data(&spec.title);
        assert!(page.contains(svg.trim()), "{} is in the page", spec.name);
        // The file contains the same elements without groups.
        let file = std::fs::read_to_string(folder.path().join(format!("{}.svg", spec.name)));
        let plain = without_groups(&svg);
        assert_eq!(file.unwrap(), plain, "{}", spec.name);
        let table = tables.iter().find(|table| table.file == spec.table);
        let table = table.unwrap();
        let places = places(&spec, &tables).unwrap();
        let mut rows: Vec<usize> = places.iter().map(|place| place.row).collect();
        if spec.name == "heat" {
            // A tile without a value is not drawn.
            let accuracy = table.numbers("accuracy").unwrap();
            rows.retain(|&row| !accuracy[row].is_nan());
        }
        rows.sort_unstable();
        let marks: Vec<&str> = svg.split("<g data-row").skip(1).collect();
        let mut marked: Vec<usize> = Vec::new();
        for mark in marks {
            let mark = format!("<g data-row{}", mark.split('>').next().unwrap());
            let of = |name: &str| attributes(&mark, name).first().map(|v| (*v).to_owned());
            let row: usize = of("data-row").unwrap().parse().unwrap();
            assert_eq!(of("data-y"), Some(table.words(&spec.y, row)), "{mark}");
            let (column, _) = table.column(&spec.y).unwrap();
            let interval = table.interval(column, row);
            let interval = interval.map(|ends| ends.map(|end| column.tick(end)).join(" to "));
            assert_eq!(of("data-interval"), interval, "{mark}");
            if spec.name != "words" {
                assert_eq!(of("data-x"), Some(table.words(&spec.x, row)), "{mark}");
            }
            marked.push(row);
        }
        marked.sort_unstable();
        assert_eq!(marked, rows, "{}", spec.name);
    }
}

/// Returns an SVG without the tags of its groups.
fn without_groups(svg: &str) -> String {
    let mut parts = svg.split("<g ");
    let first = parts.next().unwrap().to_owned();
    let inner = parts.map(|part| part.split_once('>').unwrap().1);
    inner
        .fold(first, |all, part| all + part)
        .replace("</g>", "")
}

#[test]
fn one_sentence_and_two_charts_side_by_side_are_on_the_first_screen() {
    let mut shown = charts();
    shown.retain(|chart| ["lines", "front"].contains(&&chart.name[..]));
    assert_eq!(shown.len(), 2);
    let (_folder, page) = written(&tables(), &shown);
    let html = std::fs::read_to_string(&page).unwrap();
    let place = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text}"));
    assert!(place("The first is best") < place("<figure"));
    assert!(html.rfind("</figure>").unwrap() < place("Others follow."));
    let Some(browser) = Browser::start() else {
        return;
    };
    browser.resize(1400, 900);
    browser.open(&page);
    let of_figure = |number: usize, what: &str| {
        browser.count(&format!(
            "return Math.round(document.querySelectorAll('#charts figure')[{number}].getBoundingClientRect().{what})"
        ))
    };
    assert_eq!(of_figure(0, "top"), of_figure(1, "top"));
    assert!(of_figure(0, "right") <= of_figure(1, "left"));
    assert!(of_figure(0, "bottom") <= 900 && of_figure(1, "bottom") <= 900);
    // On a narrow screen they stand one below the other.
    browser.resize(900, 900);
    assert!(of_figure(0, "bottom") <= of_figure(1, "top"));
}

#[test]
fn series_are_hidden_by_mouse_and_keyboard_and_marks_are_read_by_arrow_keys() {
    let Some((_folder, browser)) = opened(&tables(), &charts()) else {
        return;
    };
    let chart = "document.querySelector('.chart')";
    let n_shown = || {
        browser.count(&format!(
            "return [...{chart}.querySelectorAll('[data-row]')].filter((mark) => !mark.closest('[display=none]')).length"
        ))
    };
    // Three noises, three classifiers and four ratios, except one without a value.
    assert_eq!(n_shown(), 33);
    browser.click(".chart [data-toggle='RBF SVM']");
    assert_eq!(n_shown(), 24);
    let pressed = format!(
        "return {chart}.querySelector('[data-toggle=\"RBF SVM\"]').getAttribute('aria-pressed')"
    );
    assert_eq!(browser.text(&pressed), "false");
    browser.run(&format!("{chart}.querySelector('svg').focus()"));
    let spoken = "return document.querySelector('[aria-live]').textContent";
    browser.press(ARROW_RIGHT);
    assert!(browser.text(spoken).contains("linear SVM"));
    browser.press(ARROW_DOWN);
    let said = browser.text(spoken);
    says(&said, &["k nearest", "accuracy (share recognised) 0."]);
    browser.run(&format!(
        "{chart}.querySelector('[data-toggle=\"RBF SVM\"]').focus()"
    ));
    browser.press(ENTER);
    assert_eq!((n_shown(), &browser.text(&pressed)[..]), (33, "true"));
    browser.check_quiet();
}

#[test]
fn every_table_sorts_is_searched_and_is_saved_with_the_bytes_of_its_file() {
    let tables = tables();
    let Some((_folder, browser)) = opened(&tables, &charts()) else {
        return;
    };
    // Receives the saved content; a click on a link would start a download.
    browser.run("URL.createObjectURL = (blob) => { blob.text().then((text) => { window.saved = text }); return 'blob:x' }; HTMLAnchorElement.prototype.click = () => {}");
    let saved = |host: &str| {
        browser.run("window.saved = null");
        browser.run(&format!(
            "document.querySelector('{host}').parentNode.nextElementSibling.querySelector('button').click()"
        ));
        loop {
            let saved = browser.run("return window.saved");
            if let Some(text) = saved.as_str() {
                break text.to_owned();
            }
        }
    };
    for table in &tables {
        let host = format!("table[data-table=\"{}\"]", table.file);
        assert_eq!(saved(&host).into_bytes(), table.csv, "{}", table.file);
    }
    let host = "table[data-table=\"scores.csv\"]";
    let first = format!("return document.querySelector('{host} tbody tr').dataset.row");
    let accuracies = scores(&tables).numbers("accuracy").unwrap();
    let best =
        (0..accuracies.len()).reduce(|a, b| if accuracies[b] > accuracies[a] { b } else { a });
    let accuracy = format!("{host} th[title=accuracy]");
    browser.click(&format!("{accuracy} button"));
    assert_eq!(
        browser.text(&first),
        best.unwrap().to_string(),
        "the most accurate first"
    );
    let order = format!("return document.querySelector('{accuracy}').getAttribute('aria-sort')");
    assert_eq!(browser.text(&order), "descending");
    browser.run(&format!(
        "const search = document.querySelector('{host}').parentNode.nextElementSibling.querySelector('input'); search.value = 'rbf 64:1'; search.dispatchEvent(new Event('input'))"
    ));
    let found = saved(host);
    let mut lines = found.lines();
    let file = String::from_utf8(scores(&tables).csv.clone()).unwrap();
    assert_eq!(lines.next(), file.lines().next());
    assert_eq!(lines.clone().count(), scores(&tables).n_rows / 12);
    assert!(lines.all(|line| line.contains(",rbf_svm,") && file.lines().any(|row| row == line)));
    browser.check_quiet();
}

#[test]
fn the_page_is_one_file_that_stands_without_script() {
    let (_folder, page) = written(&tables(), &charts());
    let html = std::fs::read_to_string(&page).unwrap();
    let without_names = html.replace("http://www.w3.org/2000/svg", "");
    assert!(!without_names.contains("http://") && !without_names.contains("https://"));
    assert!(!html.contains(" src=\"http") && !html.contains("{{") && !html.contains("<study>"));
    let Some(browser) = Browser::start() else {
        return;
    };
    browser.devtools(
        "Emulation.setScriptExecutionDisabled",
        json!({ "value": true }),
    );
    browser.open(&page);
    assert_eq!(
        browser.count("return document.querySelectorAll('#charts figure svg').length"),
        charts().len() as u64
    );
    let n_rows: usize = tables().iter().map(|table| table.n_rows).sum();
    assert_eq!(
        browser.count("return document.querySelectorAll('#tables tbody tr').length"),
        n_rows as u64
    );
    assert_eq!(
        browser.count("return document.querySelectorAll('button').length"),
        0
    );
}
