//! The page of some tables in a browser.

use super::Browser;
use bubbletouch::report::answer::Answer;
use bubbletouch::report::confusion_picture::confusion_picture;
use bubbletouch::report::page::{Picture, Pictures, ReportPage, page};
use bubbletouch::report::results::draw_charts;
use bubbletouch::study::table::Tables;
use std::path::PathBuf;

/// A browser that shows the page of some tables.
pub struct Shown {
    pub browser: Browser,
    pub page: PathBuf,
}

/// Opens the page of some tables, with its charts for readers without script.
pub fn show(made: &Tables, about: &ReportPage) -> Option<Shown> {
    let browser = Browser::start()?;
    browser.resize(1200, 900);
    let file = browser.folder().join("report.html");
    std::fs::write(&file, page(about, made, &pictures(made)).unwrap()).unwrap();
    browser.open(&file);
    Some(Shown {
        browser,
        page: file,
    })
}

/// What stands in the page of some tables without script; drawing it as PNG too, as a run does, would take most of the time.
pub fn pictures(made: &Tables) -> Pictures {
    let charts = draw_charts(made);
    let charts = charts.iter().take(4);
    let best = Answer::of(made).map(|answer| answer.best.0.cell);
    let confusion = best.and_then(|cell| confusion_picture(made, cell));
    Pictures {
        charts: charts
            .map(|(_, title, drawing)| Picture::of(drawing, title))
            .collect(),
        confusion: confusion.map(|drawing| Picture::of(&drawing, "Confusion matrix")),
        ..Pictures::default()
    }
}
