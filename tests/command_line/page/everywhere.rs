//! The page in a browser: on a phone, in dark mode, on paper, with a screen reader, without script, and with ten thousand configurations.

use crate::browser::Browser;
use crate::report_synthetic::{
    about, add_headlines, many_cells, quickstart_cells, tables, ten_thousand_cells,
};
use crate::shown::{Shown, html, show};
use bubbletouch::study::table::Tables;
use serde_json::json;
use std::io::Write;
use std::time::Instant;

#[test]
fn a_phone_needs_no_sideways_scrolling_and_the_dark_is_dark() {
    let mut made = tables(many_cells(), 3, 24);
    add_headlines(&mut made);
    let Some(Shown { browser, page, .. }) = show(&made, &about()) else {
        return;
    };
    for width in [360, 412, 768, 1600] {
        browser.resize(width, 740);
        browser.open(&page);
        let wide = "return document.documentElement.scrollWidth";
        assert_eq!(browser.count(wide), width as u64);
    }
    // Relative luminance of background and text: their contrast satisfies level AAA of WCAG.
    let contrast = "const light = (colour) => { const [r, g, b] = colour.match(/[0-9.]+/g).slice(0, 3).map((c) => { const s = c / 255; return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4 }); return 0.2126 * r + 0.7152 * g + 0.0722 * b };
         const style = getComputedStyle(document.querySelector('section'));
         const [ink, ground] = [light(style.color), light(style.backgroundColor)];
         return [ground, (Math.max(ink, ground) + 0.05) / (Math.min(ink, ground) + 0.05)]";
    for (scheme, is_dark) in [("light", false), ("dark", true)] {
        let features = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        browser.devtools("Emulation.setEmulatedMedia", features);
        let found = browser.run(contrast);
        let (ground, contrast) = (found[0].as_f64().unwrap(), found[1].as_f64().unwrap());
        assert_eq!(ground < 0.1, is_dark, "{scheme}: {ground}");
        assert!(contrast > 7.0, "{scheme}: {contrast}");
    }
    browser.check_quiet();
}

#[test]
fn a_confusion_matrix_of_forty_objects_fits_on_a_page_of_1280_pixels() {
    let mut made = tables(quickstart_cells(), 10, 40);
    for row in &mut made.confusion {
        for object in [&mut row.object, &mut row.predicted] {
            *object = format!("{object} with a long name");
        }
        row.count += 1000;
    }
    let Some(Shown { browser, page, .. }) = show(&made, &about()) else {
        return;
    };
    browser.resize(1280, 800);
    browser.open(&page);
    let wide = "return [...document.querySelectorAll('.chart')].filter((one) => one.scrollWidth > one.clientWidth).length";
    assert_eq!(browser.count(wide), 0);
    assert!(browser.count("return document.querySelectorAll('.tiles [data-row]').length") > 40);
    browser.check_quiet();
}

#[test]
fn the_page_prints_and_is_named_for_those_who_listen() {
    let Some(Shown { browser, .. }) = show(&tables(quickstart_cells(), 3, 24), &about()) else {
        return;
    };
    let printed = browser.devtools("Page.printToPDF", json!({ "preferCSSPageSize": true }));
    let pdf = printed["data"].as_str().unwrap();
    assert!(pdf.starts_with("JVBERi0"), "a PDF");
    assert!(pdf.len() > 40_000, "{}", pdf.len());
    // Every focusable element has a name, every section is a region with a heading, and the page has its landmarks.
    let tree = browser.devtools("Accessibility.getFullAXTree", json!({}));
    let nodes = tree["nodes"].as_array().unwrap();
    let role = |node: &serde_json::Value| node["role"]["value"].as_str().unwrap_or("").to_owned();
    let nameless: Vec<String> = nodes
        .iter()
        .filter(|node| {
            let properties = node["properties"].as_array();
            let takes_focus = properties.is_some_and(|list| {
                let is_focusable =
                    |p: &serde_json::Value| p["name"] == "focusable" && p["value"]["value"] == true;
                list.iter().any(is_focusable)
            });
            let has_name = node["name"]["value"]
                .as_str()
                .is_some_and(|name| !name.trim().is_empty());
            // An empty field of the matrix is read aloud with its row and column.
            takes_focus
                && !has_name
                && !["gridcell", "cell", "RootWebArea"].contains(&&role(node)[..])
        })
        .map(role)
        .collect();
    assert_eq!(nameless, Vec::<String>::new());
    let roles: Vec<String> = nodes.iter().map(role).collect();
    for landmark in ["main", "navigation", "banner", "contentinfo"] {
        assert_eq!(
            roles.iter().filter(|r| *r == landmark).count(),
            1,
            "{landmark}"
        );
    }
    let headless = "return [...document.querySelectorAll('main > section')].filter((s) => !document.getElementById(s.getAttribute('aria-labelledby'))).length";
    assert_eq!(browser.count(headless), 0);
}

#[test]
fn ten_thousand_cells_are_a_light_page() {
    let made = tables(ten_thousand_cells(), 1, 3);
    let start = Instant::now();
    let html = html(&made, &about());
    let seconds = start.elapsed().as_secs_f64();
    let bytes = html.len();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("report.html"), html).unwrap();
    assert_eq!(made.summary.len(), 10_000);
    assert!(bytes < 3_000_000, "{bytes} bytes");
    let Some(browser) = Browser::start() else {
        return;
    };
    browser.resize(1200, 900);
    // The shortest of three times, because other tests also use the processor.
    let opened = (0..3).map(|_| browser.open(&folder.path().join("report.html")));
    let ms = opened.fold(f64::INFINITY, f64::min);
    assert_eq!(
        browser.count(
            "return document.querySelectorAll('[data-table=\"configurations.csv\"] tbody tr').length"
        ),
        100
    );
    assert!(ms < 2000.0, "{ms} ms");
    browser.check_quiet();
    writeln!(
        std::io::stderr(),
        "10,000 cells: report.html made in {seconds:.2} s, {:.2} MB, open in {ms:.0} ms",
        1e-6 * bytes as f64
    )
    .unwrap();
}

#[test]
fn a_study_of_one_cell_or_of_none_has_a_page_without_faults() {
    for made in [
        tables(vec![crate::report_synthetic::configuration()], 1, 24),
        Tables::default(),
    ] {
        let Some(Shown { browser, .. }) = show(&made, &about()) else {
            return;
        };
        browser.check_quiet();
    }
}
