//! The page of a study of any kind in a browser: its script draws what the renderer draws, and its tables are those of the files.

use crate::browser::{ARROW_RIGHT, Browser};
use crate::chart_tables::{charts, tables};
use bubbletouch::report::chart::places;
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
    if let Ok(kept) = std::env::var("BUBBLETOUCH_PICTURES") {
        std::fs::copy(&page, format!("{kept}/study_page.html")).unwrap();
    }
    (folder, page)
}

fn opened(tables: &[Table], charts: &[ChartSpec]) -> Option<(TempDir, Browser)> {
    let (folder, page) = written(tables, charts);
    let browser = Browser::start()?;
    browser.resize(1200, 900);
    browser.open(&page);
    Some((folder, browser))
}

/// Draws every chart, also those that are far below.
fn draw_all(browser: &Browser) {
    browser.run("dispatchEvent(new Event('beforeprint')); dispatchEvent(new Event('afterprint'))");
}

fn scores(tables: &[Table]) -> &Table {
    tables
        .iter()
        .find(|table| table.file == "scores.csv")
        .unwrap()
}

#[test]
fn the_script_puts_every_point_where_the_renderer_puts_it() {
    let tables = tables();
    let charts = charts();
    let Some((_folder, browser)) = opened(&tables, &charts) else {
        return;
    };
    draw_all(&browser);
    for (number, spec) in charts.iter().enumerate() {
        let drawn = browser.run(&format!(
            "return [...document.querySelectorAll('[data-chart=\"{number}\"] [data-x]')].map((p) => ['row', 'panel', 'line', 'x', 'y'].map((n) => Number(p.dataset[n])))"
        ));
        let mut drawn: Vec<Vec<f64>> = serde_json::from_value(drawn).unwrap();
        drawn.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut places = places(spec, &tables).unwrap();
        places.sort_by_key(|place| place.row);
        // A tile without a value is not drawn.
        if spec.name != "heat" {
            assert_eq!(drawn.len(), places.len(), "{}", spec.name);
        }
        for drawn in drawn {
            let place = places
                .iter()
                .find(|place| place.row as f64 == drawn[0])
                .unwrap();
            assert_eq!(
                [place.panel as f64, place.line as f64],
                [drawn[1], drawn[2]],
                "{}",
                spec.name
            );
            let apart = (place.x - drawn[3]).abs().max((place.y - drawn[4]).abs());
            assert!(apart < 2e-5, "{}: {place:?} and {drawn:?}", spec.name);
        }
    }
    browser.check_quiet();
}

#[test]
fn every_chart_can_be_arranged_and_filtered() {
    let Some((_folder, browser)) = opened(&tables(), &charts()) else {
        return;
    };
    draw_all(&browser);
    let markers = "return document.querySelectorAll('[data-chart=\"0\"] [data-x]').length";
    // Three noises, three classifiers, four ratios but for one that has no value.
    assert_eq!(browser.count(markers), 33);
    browser.click("[data-chart='0'] summary");
    browser.click("[data-chart='0'] [aria-label='classifier'] .chip:nth-of-type(2)");
    assert_eq!(browser.count(markers), 24);
    let state = "return document.querySelector('[data-chart=\"0\"] .state').textContent";
    assert!(
        browser
            .text(state)
            .contains("classifier linear SVM, k nearest"),
        "{}",
        browser.text(state)
    );
    browser.click("[data-chart='0'] .filter > .plain");
    // Along crosstalk, and no panels: noise and ensemble keep one value, since several rows would stand at one point.
    browser.choose("[data-chart='0'] label:nth-of-type(1) select", "crosstalk");
    browser.choose("[data-chart='0'] label:nth-of-type(4) select", "none");
    assert_eq!(browser.count(markers), 12, "{}", browser.text(state));
    assert!(
        browser.text(state).contains("noise 0 %"),
        "{}",
        browser.text(state)
    );
    // By keyboard.
    browser.run("document.querySelector('[data-chart=\"0\"] .panels svg').focus()");
    browser.press(ARROW_RIGHT);
    browser.press(ARROW_RIGHT);
    let said = browser.text("return document.querySelector('[aria-live]').textContent");
    assert!(
        said.contains("crosstalk 0.1 %") && said.contains("accuracy (share recognised) 0."),
        "{said}"
    );
    browser.check_quiet();
}

#[test]
fn every_table_sorts_filters_and_is_saved_whole() {
    let tables = tables();
    let Some((_folder, browser)) = opened(&tables, &charts()) else {
        return;
    };
    for table in &tables {
        let host = format!("[data-table=\"{}\"]", table.file);
        let count = browser.text(&format!(
            "return document.querySelector('{host} [role=status]').textContent"
        ));
        assert!(count.contains(&table.n_rows.to_string()), "{count}");
    }
    let host = "[data-table=\"scores.csv\"]";
    let first = format!("return document.querySelector('{host} tbody tr').dataset.row");
    let accuracies = scores(&tables).numbers("accuracy").unwrap();
    let best =
        (0..accuracies.len()).reduce(|a, b| if accuracies[b] > accuracies[a] { b } else { a });
    browser.click(&format!("{host} th:nth-of-type(6) button"));
    assert_eq!(
        browser.text(&first),
        best.unwrap().to_string(),
        "the most accurate first"
    );
    let order = format!(
        "return document.querySelector('{host} th:nth-of-type(6)').getAttribute('aria-sort')"
    );
    assert_eq!(browser.text(&order), "descending");
    browser.click(&format!("{host} summary"));
    browser.click(&format!("{host} [aria-label='noise'] .chip:nth-of-type(1)"));
    browser.click(&format!("{host} [aria-label='noise'] .chip:nth-of-type(2)"));
    assert_eq!(
        browser.text(&format!(
            "return document.querySelector('{host} .state').textContent"
        )),
        "noise 20 %"
    );
    // What is saved is what is shown, with the columns of the file.
    browser.run("URL.createObjectURL = (blob) => { blob.text().then((text) => { window.saved = text }); return 'blob:x' }; HTMLAnchorElement.prototype.click = () => {}");
    browser.click(&format!("{host} .below button:last-of-type"));
    let saved = loop {
        let saved = browser.run("return window.saved ?? null");
        if !saved.is_null() {
            break saved.as_str().unwrap().to_owned();
        }
    };
    let mut lines = saved.lines();
    let header = String::from_utf8(scores(&tables).csv.clone()).unwrap();
    assert_eq!(lines.next(), header.lines().next());
    assert_eq!(lines.clone().count(), scores(&tables).n_rows / 3);
    assert!(lines.all(|line| line.starts_with("0.2,")));
    browser.check_quiet();
}

#[test]
fn advice_is_given_for_each_condition_at_the_least_cost() {
    let tables = tables();
    let Some((_folder, browser)) = opened(&tables, &charts()) else {
        return;
    };
    let wish = 0.8;
    browser.run(&format!("const wish = document.querySelector('.advice input'); wish.value = {wish}; wish.dispatchEvent(new Event('input'))"));
    let advised = browser.text("return document.querySelector('.advice').dataset.rows");
    let column = |name: &str| scores(&tables).numbers(name).unwrap();
    let (noise, crosstalk) = (column("noise"), column("crosstalk"));
    let (accuracy, cost) = (column("accuracy"), column("decide_us"));
    let mut wanted = Vec::new();
    for n in [0.0, 0.05, 0.2] {
        for c in [0.0, 0.001, 0.01, 0.1] {
            let of_it = (0..noise.len())
                .filter(|&row| noise[row] == n && crosstalk[row] == c && accuracy[row] >= wish);
            let cheapest = of_it.min_by(|&a, &b| {
                cost[a]
                    .total_cmp(&cost[b])
                    .then(accuracy[b].total_cmp(&accuracy[a]))
            });
            wanted.push(cheapest.map_or(String::new(), |row| row.to_string()));
        }
    }
    assert_eq!(advised, wanted.join(","));
    assert!(wanted.iter().any(|row| !row.is_empty()));
    let words = browser.text("return document.querySelector('.advice').innerText");
    assert!(
        words.contains("With noise 20 %, crosstalk 10 %:"),
        "{words}"
    );
    browser.choose(".advice select", "the best value within a budget");
    browser.run("const wish = document.querySelector('.advice input'); wish.value = 15; wish.dispatchEvent(new Event('input'))");
    let budget = browser.text("return document.querySelector('.advice').dataset.rows");
    let first: usize = budget.split(',').next().unwrap().parse().unwrap();
    let within = (0..noise.len()).filter(|&row| {
        noise[row] == 0.0 && crosstalk[row] == 0.0 && cost[row] <= 15.0 && !accuracy[row].is_nan()
    });
    let best = within.map(|row| accuracy[row]).fold(0.0, f64::max);
    assert_eq!(accuracy[first], best);
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
    assert!(browser.count("return document.querySelectorAll('#tables tbody tr').length") > 100);
    assert_eq!(
        browser.count("return document.querySelectorAll('select').length"),
        0
    );
}
