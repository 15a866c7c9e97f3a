//! The folder of a study of a whole body: tables, charts, a picture, the page; and what a run prints at its end.

use crate::error::Result;
use crate::report::axis::short_number;
use crate::report::drawing::escape;
use crate::report::folder::Folder;
use crate::report::headlines::TextTable;
use crate::report::html::{Picture, STYLE, figure, fill};
use crate::report::whole_body_charts::draw_whole_body_charts;
use crate::report::whole_body_picture::whole_body_picture;
use crate::report::whole_body_text::{bars_table, recognition_table, scenes_table};
use crate::study::whole_body::table::WholeBodyTables;
use crate::study::whole_body::{BodyOutcome, BodyPicture};
use std::path::{Path, PathBuf};

const TEMPLATE: &str = include_str!("whole_body.html");

/// What a study of a whole body says of itself, beside its tables.
#[derive(Clone, Debug, Default)]
pub struct WholeBodyAbout {
    /// The study's name.
    pub name: String,
    /// What it asks.
    pub question: String,
    /// What was expected before it ran; may be empty.
    pub expected: String,
    /// Seconds from start to end.
    pub wall_s: f64,
    /// The command that makes the folder again.
    pub command: String,
    /// Program and version: `bubbletouch 0.1.0`.
    pub program: String,
}

/// File names of the tables, in the order in which they are written.
pub const WHOLE_BODY_FILES: [&str; 5] = [
    "bars.csv",
    "whole_body.csv",
    "recognition.csv",
    "sensed.csv",
    "timing.csv",
];

/// Writes tables, charts, a picture and the page into `dir` (created if missing); returns the paths, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there.
pub fn write_whole_body(
    dir: &Path,
    outcome: &BodyOutcome,
    about: &WholeBodyAbout,
) -> Result<Vec<PathBuf>> {
    let tables = &outcome.tables;
    let mut folder = Folder::new(dir);
    let [bars, cases, recognition, sensed, timing] = WHOLE_BODY_FILES;
    folder.add_table(bars, &tables.bars)?;
    folder.add_table(cases, &tables.cases)?;
    folder.add_table(recognition, &tables.recognition)?;
    folder.add_table(sensed, &tables.sensed)?;
    folder.add_table(timing, &tables.timing)?;
    let mut charts = String::new();
    for (name, title, drawing) in draw_whole_body_charts(tables) {
        charts += &figure(&Picture::of(&drawing, &title));
        folder.add_chart(&name, &title, &drawing)?;
    }
    let mut picture = String::new();
    if let Some(scene) = most_touched(outcome) {
        let drawn = whole_body_picture(scene)?;
        let png = drawn.png()?;
        let title = format!("The scene {}, and the pressure on each patch", scene.scene);
        let size = (drawn.width as f64, drawn.height as f64);
        let shown = figure(&Picture::of_png(&png, size, &title));
        picture = format!("<section><h2>What is touched</h2>{shown}</section>");
        folder.add("touched.png", png);
    }
    let html = |table: Option<_>| table.map_or(String::new(), |table: TextTable| table.html());
    let page = fill(TEMPLATE, |name| match name {
        "style" => STYLE.to_owned(),
        "name" => escape(&about.name),
        "question" => escape(&about.question),
        "expected" if about.expected.is_empty() => String::new(),
        "expected" => format!(
            "<p class=\"quiet\">Expected: {}</p>",
            escape(&about.expected)
        ),
        "bars" => html(bars_table(tables)),
        "picture" => picture.clone(),
        "scenes" => html(scenes_table(tables)),
        "charts" => charts.clone(),
        "recognition" => html(recognition_table(tables)),
        "wall" => short_number(about.wall_s.round()),
        "command" => escape(&about.command),
        "program" => escape(&about.program),
        "files" => WHOLE_BODY_FILES.join(", "),
        other => format!("(no value for {other})"),
    });
    folder.add("report.html", page);
    folder.write()
}

/// Scenes, recognition and bars as text; lines are at most about `width` letters long.
pub fn whole_body_summary(tables: &WholeBodyTables, width: usize) -> String {
    let all = [
        scenes_table(tables),
        recognition_table(tables),
        bars_table(tables),
    ];
    all.iter()
        .flatten()
        .map(|table| table.text(width))
        .collect()
}

fn most_touched(outcome: &BodyOutcome) -> Option<&BodyPicture> {
    outcome.pictures.iter().max_by_key(|scene| scene.n_patches)
}
