//! A study's folder: everything that people open after a run.

use crate::error::Result;
use crate::report::answer::Answer;
use crate::report::chart::{chart_title, draw_chart};
use crate::report::chart_plan::{ChartPlan, plan_charts};
use crate::report::confusion_picture::confusion_picture;
use crate::report::csv_tables::{LIMITS_FILE, add_tables};
use crate::report::drawing::Drawing;
use crate::report::folder::Folder;
use crate::report::page::{Picture, Pictures, ReportPage, page};
use crate::report::pareto_chart::{Cost, draw_pareto, is_wanted};
use crate::report::snapshots::snapshots;
use crate::study::table::{Cell, Tables};
use std::path::{Path, PathBuf};

/// Static charts that are drawn, unless all are asked for; of all, those in the page (for readers without script) and as PNG. More: a page
/// too heavy for a phone, and minutes for what the page shows anyway when it is asked.
pub const MOST_CHARTS: usize = 24;

/// Writes tables, charts, pictures and the page into `dir` (created if missing); returns the paths in the order of
/// writing, tables first.
///
/// Everything is drawn before the first file is written, and each file is whole or not there. Files of other names in the
/// folder are left alone.
pub fn write_all(dir: &Path, tables: &Tables, about: &ReportPage) -> Result<Vec<PathBuf>> {
    all_files(dir, tables, about)?.write()
}

/// What [`write_all`] writes, before it is written.
///
/// # Errors
/// What cannot be drawn, or written as a table.
pub fn all_files<'a>(dir: &'a Path, tables: &Tables, about: &ReportPage) -> Result<Folder<'a>> {
    let mut folder = Folder::new(dir);
    add_tables(&mut folder, tables)?;
    folder.add_table(LIMITS_FILE, &about.limits)?;
    add_page(&mut folder, tables, about)?;
    Ok(folder)
}

/// Writes charts, pictures and the page into a folder that has the tables; as [`write_all`].
pub fn write_page(dir: &Path, tables: &Tables, about: &ReportPage) -> Result<Vec<PathBuf>> {
    let mut folder = Folder::new(dir);
    add_page(&mut folder, tables, about)?;
    folder.write()
}

fn add_page(folder: &mut Folder, tables: &Tables, about: &ReportPage) -> Result<()> {
    let mut pictures = Pictures::default();
    for (name, title, drawing) in draw_pareto_charts(tables, about.pareto) {
        pictures.times.push(light_picture(&drawing, &title)?);
        folder.add_chart(&name, &title, &drawing);
    }
    let mut plans = plans(tables);
    let n_drawn = match about.all_charts {
        true => plans.len(),
        false => MOST_CHARTS.min(plans.len()),
    };
    let left_out = plans.split_off(n_drawn).into_iter();
    pictures.left_out = left_out.map(|plan| plan.name).collect();
    for plan in &plans {
        let (name, title, drawing) = draw(plan, tables);
        if pictures.charts.len() < MOST_CHARTS {
            pictures.charts.push(Picture::of(&drawing, &title));
            folder.add_chart(&name, &title, &drawing);
        } else {
            pictures.n_more_charts += 1;
            folder.add(format!("{name}.svg"), drawing.svg(&title));
        }
    }
    if let Some(answer) = Answer::of(tables)
        && let Some(drawing) = confusion_picture(tables, answer.best.0.cell)
    {
        let picture = Picture::of(&drawing, "Confusion matrix of the best cell");
        folder.add_png("confusion.png", &drawing);
        folder.add("confusion.svg", picture.element.clone());
        pictures.confusion = Some(picture);
    }
    if let Some(set) = &about.snapshots {
        let drawing = snapshots(&set.frames, set.pitch_mm, set.quantity, &set.caption)?;
        // As SVG, ten thousand noisy taxels would be a megabyte.
        folder.add_png("snapshots.png", &drawing);
    }
    folder.add("report.html", page(about, tables, &pictures)?);
    Ok(())
}

/// Letters of a picture that stays an SVG in the page: a point a cell of ten thousand is megabytes.
const LIGHT: usize = 500_000;

/// A drawing for the page, as SVG if that is light.
fn light_picture(drawing: &Drawing, title: &str) -> Result<Picture> {
    let picture = Picture::of(drawing, title);
    if picture.element.len() <= LIGHT {
        return Ok(picture);
    }
    let size = (drawing.width() as usize, drawing.height() as usize);
    Ok(Picture::of_png(&drawing.png()?, size, title))
}

/// What accuracy is charted against.
const COSTS: [Cost; 2] = [Cost::Training, Cost::Prediction];

/// Every chart of a study: file name without ending, title, drawing.
pub fn draw_charts(tables: &Tables) -> Vec<(String, String, Drawing)> {
    let plans = plans(tables);
    plans.iter().map(|plan| draw(plan, tables)).collect()
}

fn plans(tables: &Tables) -> Vec<ChartPlan> {
    let cells: Vec<&Cell> = tables.summary.iter().map(|(cell, _)| cell).collect();
    plan_charts(&cells)
}

fn draw(plan: &ChartPlan, tables: &Tables) -> (String, String, Drawing) {
    let drawing = draw_chart(plan, tables);
    (plan.name.clone(), chart_title(plan), drawing)
}

/// Accuracy against the time to train and to decide, for a study that asks for it or compares classifiers: as
/// [`draw_charts`].
pub fn draw_pareto_charts(tables: &Tables, asked: Option<bool>) -> Vec<(String, String, Drawing)> {
    let cells: Vec<&Cell> = tables.pareto.iter().map(|(cell, _)| cell).collect();
    if !is_wanted(&cells, asked) {
        return Vec::new();
    }
    let draw = |cost: Cost| {
        let drawing = draw_pareto(tables, cost);
        (cost.name().to_owned(), cost.title().to_owned(), drawing)
    };
    COSTS.map(draw).into()
}
