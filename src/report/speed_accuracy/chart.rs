//! A chart of costs and values, its front numbered, and named below.

use super::points::{ChartKind, ChartPoint};
use crate::report::chart;
use crate::report::chart::{draw_steps, paler};
use crate::report::colours::{INK, PAPER};
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::report::legend::{
    Heading, LEFT, LegendEntry, MARKER_RADIUS, Mark, RIGHT, dashes, point_colour,
};
use crate::report::log_scale::{LogScale, draw_y_ticks};
use crate::report::time_scale::{TimeScale, time_label};

const WIDTH: f64 = 820.0;
const HEIGHT: f64 = 380.0;
/// Pixels of a line of the list below.
const LINE: f64 = 17.0;

/// Pixels of the shelf below a logarithmic axis, on which points without error stand.
const SHELF: f64 = 34.0;

/// Values up the chart.
enum YScale {
    /// With the place of zero, if there is one.
    Log(LogScale, Option<f64>),
    Share(Area),
}

impl YScale {
    fn of(kind: ChartKind, points: &[&ChartPoint], frame: Area) -> Self {
        if kind.more_is_better() {
            return Self::Share(frame);
        }
        let values = points.iter().map(|point| point.value);
        let has_shelf = values.clone().any(|value| value == 0.0);
        let bottom = frame.y + frame.height;
        let (low, shelf) = match has_shelf {
            true => (bottom - SHELF, Some(bottom - 0.5 * SHELF)),
            false => (bottom, None),
        };
        Self::Log(LogScale::over(values, low, frame.y), shelf)
    }

    fn place(&self, value: f64) -> f64 {
        match self {
            Self::Log(scale, shelf) => match (value == 0.0, shelf) {
                (true, Some(place)) => *place,
                _ => scale.place(value),
            },
            Self::Share(frame) => chart::y_at(*frame, value),
        }
    }
}

/// Draws the points of one kind among all; `None` if there are none.
pub fn draw_front_chart(kind: ChartKind, points: &[ChartPoint]) -> Option<Drawing> {
    let points: Vec<&ChartPoint> = points.iter().filter(|point| point.chart == kind).collect();
    if points.is_empty() {
        return None;
    }
    let mut groups: Vec<&str> = Vec::new();
    for point in &points {
        if !groups.contains(&point.group.as_str()) {
            groups.push(&point.group);
        }
    }
    let mut front: Vec<&ChartPoint> = points.iter().filter(|p| p.on_front).copied().collect();
    front.sort_by(|a, b| a.cost_us.total_cmp(&b.cost_us));
    let chart = FrontChart {
        kind,
        points,
        groups,
        front,
    };
    Some(chart.draw())
}

struct FrontChart<'a> {
    kind: ChartKind,
    points: Vec<&'a ChartPoint>,
    groups: Vec<&'a str>,
    /// Cheapest first.
    front: Vec<&'a ChartPoint>,
}

impl FrontChart<'_> {
    fn draw(&self) -> Drawing {
        let heading = Heading::of(
            self.kind.title(),
            self.kind.settings(),
            self.legend(),
            WIDTH,
        );
        let frame = Area {
            x: LEFT + 6.0,
            y: heading.height() + 8.0,
            width: WIDTH - LEFT - RIGHT - 6.0,
            height: HEIGHT,
        };
        let bottom = frame.y + frame.height;
        let list = bottom + 64.0;
        let height = list + LINE * self.front.len() as f64 + 8.0;
        let mut drawing = Drawing::new(WIDTH, height);
        heading.draw(&mut drawing);
        let x = TimeScale::of(
            self.points
                .iter()
                .map(|point| 1e-6 * point.cost_us.max(1e-3)),
        );
        let y = YScale::of(self.kind, &self.points, frame);
        self.draw_axes(&mut drawing, frame, (&x, &y));
        let at = |point: &ChartPoint| {
            let seconds = 1e-6 * point.cost_us.max(1e-3);
            (x.x(seconds, frame), y.place(point.value))
        };
        for point in self.points.iter().filter(|point| !point.on_front) {
            let colour = self.colour_of(point);
            let pale = paler(point_colour(colour));
            drawing.marker(colour, at(point), 0.8 * MARKER_RADIUS, pale);
            draw_inside(&mut drawing, point, (colour, at(point)));
        }
        let places: Vec<Point> = self.front.iter().map(|point| at(point)).collect();
        let mut fronts: Vec<_> = self.front.iter().map(|point| point.front()).collect();
        fronts.sort_by(|a, b| a.1.cmp(&b.1));
        fronts.dedup();
        for front in &fronts {
            let of_it = self.front.iter().filter(|point| point.front() == *front);
            let steps: Vec<Point> = of_it.map(|point| at(point)).collect();
            draw_steps(&mut drawing, &steps, frame);
        }
        for (point, &place) in self.front.iter().zip(&places) {
            self.draw_on_front(&mut drawing, point, (place, &y));
        }
        self.draw_numbers(&mut drawing, &places);
        for point in &self.points {
            let (title, lines) = self.said_of(point);
            drawing.ask(at(point), self.colour_of(point), title, lines);
        }
        for (number, point) in self.front.iter().enumerate() {
            let y = list + LINE * number as f64;
            let number = format!("{}", number + 1);
            drawing.bold_text(
                (LEFT - 8.0, y),
                &number,
                TextStyle::new(12).align(Align::End),
            );
            drawing.text((LEFT + 6.0, y), &self.line_of(point), TextStyle::new(12));
        }
        drawing
    }

    fn draw_axes(&self, drawing: &mut Drawing, frame: Area, (x, y): (&TimeScale, &YScale)) {
        let (along_x, along_y) = self.kind.axes();
        match y {
            YScale::Share(_) => {
                chart::draw_axes(drawing, frame);
                chart::draw_y_labels(drawing, frame);
            }
            YScale::Log(scale, shelf) => {
                draw_y_ticks(drawing, frame, *scale, &scale.ticks());
                if let Some(place) = shelf {
                    let edge = place - 0.5 * SHELF;
                    drawing.line((frame.x, edge), (frame.x + frame.width, edge), dashes(1.0));
                    let style = TextStyle::new(12).align(Align::End);
                    drawing.text((frame.x - 9.0, place + 4.5), "exact", style);
                }
                let ink = Stroke::new(INK, 1.0);
                let bottom = frame.y + frame.height;
                drawing.line((frame.x, bottom), (frame.x + frame.width, bottom), ink);
                drawing.line((frame.x, frame.y), (frame.x, bottom), ink);
                let beside = (frame.x - 54.0, frame.y + frame.height / 2.0);
                let style = TextStyle::new(13).align(Align::Middle).angle(-90.0);
                drawing.text(beside, along_y, style);
            }
        }
        x.draw_ticks(drawing, frame);
        let below = (frame.x + frame.width / 2.0, frame.y + frame.height + 40.0);
        drawing.text(below, along_x, TextStyle::new(13).align(Align::Middle));
    }

    /// A ringed marker with the spread of its value.
    fn draw_on_front(&self, drawing: &mut Drawing, point: &ChartPoint, (at, y): (Point, &YScale)) {
        let colour = self.colour_of(point);
        let ends = [point.value_low, point.value_high].map(|value| (at.0, y.place(value)));
        drawing.line(ends[0], ends[1], Stroke::new(point_colour(colour), 1.5));
        drawing.marker(colour, at, MARKER_RADIUS + 2.4, INK);
        drawing.marker(colour, at, MARKER_RADIUS, point_colour(colour));
        draw_inside(drawing, point, (colour, at));
    }

    /// Each on the side where no point can be, of those that would touch, the later are left out.
    fn draw_numbers(&self, drawing: &mut Drawing, places: &[Point]) {
        let mut last = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (number, place) in places.iter().enumerate() {
            let up = match self.kind.more_is_better() {
                true => -8.0,
                false => 17.0,
            };
            let at = (place.0 - 7.0, place.1 + up);
            if (at.0 - last.0).abs() < 14.0 && (at.1 - last.1).abs() < 12.0 {
                continue;
            }
            let style = TextStyle::new(12).align(Align::End);
            drawing.bold_text(at, &format!("{}", number + 1), style);
            last = at;
        }
    }

    /// `linear SVM …: 0.81 (0.79 to 0.83) at 45 µs`.
    fn line_of(&self, point: &ChartPoint) -> String {
        let said = self.kind.at_cost(point);
        format!("{}{}: {said}", point.setting, source_of(point))
    }

    /// What a page says of a point: its setting, and a line each of value, time, and what it is.
    fn said_of(&self, point: &ChartPoint) -> (String, Vec<String>) {
        let mut lines = vec![self.kind.at_cost(point)];
        if point.on_front {
            lines.push("on the front: nothing is both faster and as good".to_owned());
        }
        (format!("{}{}", point.setting, source_of(point)), lines)
    }

    fn colour_of(&self, point: &ChartPoint) -> usize {
        let place = self.groups.iter().position(|group| *group == point.group);
        place.unwrap_or(0)
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let groups = self.groups.iter().enumerate();
        let mut entries: Vec<LegendEntry> = groups
            .map(|(number, group)| LegendEntry::new((*group).to_owned(), Mark::Point(number)))
            .collect();
        if self.points.iter().any(|point| point.is_of_scans()) {
            let text = "hollow: on scans, with a front of their own".to_owned();
            entries.push(LegendEntry::new(text, Mark::Hollow));
        }
        let front = "Pareto front: nothing is both faster and as good";
        entries.push(LegendEntry::new(front.to_owned(), Mark::Front));
        entries
    }
}

/// Nothing, where scans were touched.
fn draw_inside(drawing: &mut Drawing, point: &ChartPoint, (colour, at): (usize, Point)) {
    if point.is_of_scans() {
        drawing.marker(colour, at, 0.35 * MARKER_RADIUS, PAPER);
    }
}

/// Who measured a point, if it was not this run.
fn source_of(point: &ChartPoint) -> String {
    match point.source.as_str() {
        "this run" => String::new(),
        source => format!(" ({source})"),
    }
}

/// The ends of the x axis, for a summary in words.
pub(super) fn from_to(points: &[&ChartPoint]) -> Option<String> {
    let costs = points.iter().map(|point| 1e-6 * point.cost_us);
    let low = costs.clone().reduce(f64::min)?;
    let high = costs.reduce(f64::max)?;
    Some(format!("{} to {}", time_label(low), time_label(high)))
}
