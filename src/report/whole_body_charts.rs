//! Charts of a study of a whole body: what a step costs by skin and by touch, and where the time of a scene goes.

use super::legend::{
    Heading, LEFT, LegendEntry, MARKER_RADIUS, Mark, RIGHT, dashes, line_colour, line_entries,
    line_stroke,
};
use super::log_scale::{LogScale, axis_titles, draw_axes, draw_x_ticks};
use crate::report::axis::short_number;
use crate::report::colours::INK;
use crate::report::drawing::{Align, Area, Drawing, Stroke, TextStyle};
use crate::study::whole_body::table::{
    BodyCase, BodyCount, BodyTime, Series, Stage, WholeBodyTables,
};

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 340.0;
/// Room for a scene's name.
const NAMES: f64 = 150.0;
/// Down for each row of the chart of stages.
const ROW: f64 = 22.0;

/// A rung: where it stands along x, and the time of its step.
struct Rung<'a> {
    x: f64,
    time: &'a BodyTime,
}

/// A ladder: its name and its rungs.
struct Ladder<'a> {
    name: String,
    rungs: Vec<Rung<'a>>,
}

/// All charts: file name without ending, title, drawing.
pub fn draw_whole_body_charts(tables: &WholeBodyTables) -> Vec<(String, String, Drawing)> {
    let skins = skin_ladders(tables);
    let touches = touch_ladders(tables);
    let by_skin = "Time of a step by the size of the skin, the touch the same";
    let by_touch = "Time of a step by the size of the touch, the skin the same";
    let by_stage = "From touch to answer: where the time of a step goes";
    let mut charts = Vec::new();
    if !skins.is_empty() {
        let drawing = draw_ladders(by_skin, "taxels of the body", &skins);
        charts.push(("time_by_taxels".to_owned(), by_skin.to_owned(), drawing));
    }
    if !touches.is_empty() {
        let drawing = draw_ladders(by_touch, "touched taxels", &touches);
        charts.push(("time_by_touched".to_owned(), by_touch.to_owned(), drawing));
    }
    let drawing = draw_stages(by_stage, tables);
    charts.push(("time_by_stage".to_owned(), by_stage.to_owned(), drawing));
    charts
}

/// Cases of a series with the time of their press.
fn pressed(
    tables: &WholeBodyTables,
    series: Series,
) -> impl Iterator<Item = (&BodyCase, &BodyCount, &BodyTime)> {
    let cases = tables
        .cases
        .iter()
        .filter(move |(case, _)| case.series == series);
    cases.filter_map(|(case, count)| {
        let is_it = |(of, time): &&(BodyCase, BodyTime)| of == case && time.stage == Stage::Press;
        let (_, time) = tables.timing.iter().find(is_it)?;
        Some((case, count, time))
    })
}

/// A ladder begins where the skin is smaller again.
fn skin_ladders(tables: &WholeBodyTables) -> Vec<Ladder<'_>> {
    let mut ladders: Vec<Ladder> = Vec::new();
    let mut last = usize::MAX;
    for (case, count, time) in pressed(tables, Series::Skin) {
        if case.n_taxels <= last {
            ladders.push(Ladder {
                name: format!("{} touched", short_number(round_to_two(count.touched_mean))),
                rungs: Vec::new(),
            });
        }
        last = case.n_taxels;
        if let Some(ladder) = ladders.last_mut() {
            let x = case.n_taxels as f64;
            ladder.rungs.push(Rung { x, time });
        }
    }
    ladders
}

fn touch_ladders(tables: &WholeBodyTables) -> Vec<Ladder<'_>> {
    let rungs: Vec<Rung> = pressed(tables, Series::Touch)
        .map(|(_, count, time)| Rung {
            x: count.touched_mean,
            time,
        })
        .collect();
    let Some((case, ..)) = pressed(tables, Series::Touch).next() else {
        return Vec::new();
    };
    let name = format!("{} taxels, {} spheres", case.n_taxels, case.n_spheres);
    vec![Ladder { name, rungs }]
}

/// To two digits: a touch of 10,008 taxels is one of 10,000.
fn round_to_two(value: f64) -> f64 {
    let unit = 10f64.powf(value.max(1.0).log10().floor() - 1.0);
    (value / unit).round() * unit
}

fn draw_ladders(title: &str, along_x: &str, ladders: &[Ladder]) -> Drawing {
    let mut entries = line_entries(ladders.iter().map(|ladder| ladder.name.as_str()));
    entries.push(LegendEntry::new(
        "5th to 95th percentile".to_owned(),
        Mark::Whisker,
    ));
    entries.push(LegendEntry::new("a millisecond".to_owned(), Mark::Dashes));
    let settings =
        "medians over steps of a moving cushion of spheres, half of them on its far side";
    let heading = Heading::of(title, settings, entries, WIDTH);
    let area = Area {
        x: LEFT,
        y: heading.height() + 8.0,
        width: WIDTH - LEFT - RIGHT,
        height: HEIGHT,
    };
    let mut drawing = Drawing::new(WIDTH, area.y + HEIGHT + 58.0);
    heading.draw(&mut drawing);
    let rungs = || ladders.iter().flat_map(|ladder| &ladder.rungs);
    let (right, bottom) = (area.x + area.width, area.y + area.height);
    let x = LogScale::over(rungs().map(|rung| rung.x), area.x, right);
    let times = rungs().flat_map(|rung| [rung.time.us_p05, rung.time.us_p95]);
    let y = LogScale::over(times.chain([1000.0]), bottom, area.y);
    draw_axes(&mut drawing, area, (x, &x.ticks()), (y, &y.ticks()));
    axis_titles(&mut drawing, area, along_x, Some("time of a step, µs"));
    drawing.line(
        (area.x, y.place(1000.0)),
        (right, y.place(1000.0)),
        dashes(1.2),
    );
    for (line, ladder) in ladders.iter().enumerate() {
        let places: Vec<_> = ladder
            .rungs
            .iter()
            .map(|rung| (x.place(rung.x), y.place(rung.time.us_median)))
            .collect();
        if places.len() > 1 {
            drawing.polyline(&places, line_stroke(line));
        }
        for (rung, &place) in ladder.rungs.iter().zip(&places) {
            let ends = [rung.time.us_p05, rung.time.us_p95].map(|us| (place.0, y.place(us)));
            drawing.line(ends[0], ends[1], Stroke::new(line_colour(line), 1.5));
            drawing.marker(line, place, MARKER_RADIUS, line_colour(line));
        }
    }
    drawing
}

/// A row a scene and compression, a marker a stage.
fn draw_stages(title: &str, tables: &WholeBodyTables) -> Drawing {
    const STAGES: [(Stage, &str); 4] = [
        (Stage::Press, "press"),
        (Stage::Compress, "compress"),
        (Stage::Classify, "classify"),
        (Stage::Whole, "all three"),
    ];
    let rows: Vec<(&BodyCase, &BodyTime)> = tables
        .timing
        .iter()
        .filter(|(_, time)| time.stage == Stage::Whole)
        .map(|(case, time)| (case, time))
        .collect();
    let names = STAGES.iter().enumerate();
    let mut entries: Vec<LegendEntry> = names
        .map(|(number, (_, name))| LegendEntry::new((*name).to_owned(), Mark::Point(number)))
        .collect();
    entries.push(LegendEntry::new("a millisecond".to_owned(), Mark::Dashes));
    let settings = "medians over steps; in brackets the taxels touched";
    let heading = Heading::of(title, settings, entries, WIDTH);
    let area = Area {
        x: LEFT + NAMES,
        y: heading.height() + 8.0,
        width: WIDTH - LEFT - NAMES - RIGHT,
        height: ROW * rows.len() as f64,
    };
    let bottom = area.y + area.height;
    let mut drawing = Drawing::new(WIDTH, bottom + 58.0);
    heading.draw(&mut drawing);
    let of_scenes = tables
        .timing
        .iter()
        .filter(|(case, _)| case.series == Series::Scene);
    let times = of_scenes.map(|(_, time)| time.us_median).chain([1000.0]);
    let x = LogScale::over(times, area.x, area.x + area.width);
    draw_x_ticks(&mut drawing, area, x, &x.ticks());
    axis_titles(&mut drawing, area, "time of a step, µs", None);
    let ink = Stroke::new(INK, 1.0);
    drawing.line((area.x, bottom), (area.x + area.width, bottom), ink);
    drawing.line((area.x, area.y), (area.x, bottom), ink);
    let limit = x.place(1000.0);
    drawing.line((limit, area.y), (limit, bottom), dashes(1.2));
    let mut last = "";
    for (row, (case, whole)) in rows.iter().enumerate() {
        let y = area.y + (row as f64 + 0.5) * ROW;
        if case.name != last {
            let touched = tables.cases.iter().find(|(of, _)| of == *case);
            let touched = touched.map_or(0.0, |(_, count)| count.touched_mean);
            let name = format!("{} ({touched:.0})", case.name);
            drawing.bold_text((10.0, y + 4.5), &name, TextStyle::new(12));
            if row > 0 {
                let above = area.y + row as f64 * ROW;
                drawing.line((10.0, above), (area.x, above), Stroke::new(INK, 0.5));
            }
            last = &case.name;
        }
        let beside = (area.x - 9.0, y + 4.5);
        let style = TextStyle::new(12).align(Align::End);
        drawing.text(beside, &whole.compression, style);
        for (line, (stage, _)) in STAGES.into_iter().enumerate() {
            let is_it = |(of, time): &&(BodyCase, BodyTime)| {
                let compression = time.compression == whole.compression;
                of == *case && time.stage == stage && (compression || stage == Stage::Press)
            };
            if let Some((_, time)) = tables.timing.iter().find(is_it) {
                let place = (x.place(time.us_median), y);
                drawing.marker(line, place, MARKER_RADIUS, line_colour(line));
            }
        }
    }
    drawing
}
