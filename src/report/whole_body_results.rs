//! The folder of a study of a whole body: tables, charts, a picture, the page; and what a run prints at its end.

use crate::error::Result;
use crate::report::folder::Folder;
use crate::report::page::plain::{charts, plain_page};
use crate::report::page::{Picture, Section, StudyAbout, figure};
use crate::report::study_tables::{StudyTables, TableFiles, table_file};
use crate::report::whole_body_charts::draw_whole_body_charts;
use crate::report::whole_body_picture::whole_body_picture;
use crate::report::whole_body_text::{bars_table, recognition_table, scenes_table};
use crate::study::whole_body::BodyPicture;
use crate::study::whole_body::table::WholeBodyTables;
use std::path::Path;

/// File names of the tables, in the order in which they are written.
pub const WHOLE_BODY_FILES: [&str; 5] = [
    "bars.csv",
    "whole_body.csv",
    "recognition.csv",
    "sensed.csv",
    "timing.csv",
];

impl StudyTables for WholeBodyTables {
    const OF_PIECES: &'static [&'static str] = &["whole_body.csv", "recognition.csv", "sensed.csv"];
    const OF_ALL: &'static [&'static str] = &[];

    fn files(&self) -> Result<TableFiles> {
        Ok(vec![
            table_file(WHOLE_BODY_FILES[0], &self.bars)?,
            table_file(WHOLE_BODY_FILES[1], &self.cases)?,
            table_file(WHOLE_BODY_FILES[2], &self.recognition)?,
            table_file(WHOLE_BODY_FILES[3], &self.sensed)?,
            table_file(WHOLE_BODY_FILES[4], &self.timing)?,
        ])
    }
}

/// Tables, charts, a picture and the page, tables first, for the folder `dir`: nothing is written yet.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn whole_body_folder<'a>(
    dir: &'a Path,
    (tables, picture): (&WholeBodyTables, Option<&BodyPicture>),
    about: &StudyAbout,
) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    folder.add_files(tables.files()?);
    let mut found: Vec<Section> = Vec::new();
    found.extend(bars_table(tables).map(|table| table.section("bars")));
    if let Some(scene) = picture {
        let drawn = whole_body_picture(scene)?;
        let png = drawn.png()?;
        let title = format!("The scene {}, and the pressure on each patch", scene.scene);
        let shown = figure(&Picture::of_png(&png, (drawn.width, drawn.height), &title));
        found.push(Section::new("touched", "What is touched", shown));
        folder.add("touched.png", png);
    }
    found.extend(scenes_table(tables).map(|table| table.section("scenes")));
    let drawn = draw_whole_body_charts(tables);
    for (name, title, drawing) in &drawn {
        folder.add_chart(name, title, drawing);
    }
    found.push(charts(&drawn));
    found.extend(recognition_table(tables).map(|table| table.section("recognition")));
    folder.add("report.html", plain_page(about, found, &WHOLE_BODY_FILES));
    Ok(folder)
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
