//! Series of a chart: points with markers and confidence intervals, optionally joined by lines.

use super::front::{self, Front};
use super::layout::Layout;
use super::legend::{FRONT, LegendEntry, MARKER_RADIUS, line_stroke};
use super::rules;
use super::view::{Place, View};
use crate::report::pictures::colours::{INK, MUTED, Rgb};
use crate::report::pictures::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};

/// Number of points in a chart above which all markers are small.
const MANY: usize = 400;
/// Line height in the list of Pareto-front points below a chart, pixels.
const LINE: f64 = 17.0;

/// Draws a chart in which each series of data is a line or a set of points.
pub(super) fn draw(view: &View) -> Drawing {
    let (columns, width, height) = match view.titles.len() {
        1 => (1, 660.0, 340.0),
        2 | 4 => (2, 385.0, 300.0),
        _ => (3, 272.0, 240.0),
    };
    let height = match view.y.is_words {
        true => 22.0 * view.y.n_levels as f64,
        false => height,
    };
    let layout = Layout::new(view, legend(view), columns, (width, height));
    let front = Front::new(view);
    let list = front.list();
    let below = if list.is_empty() { 0.0 } else { 16.0 };
    let height = layout.bottom() + LINE * list.len() as f64 + below;
    let mut drawing = Drawing::new(layout.width, height);
    layout.draw_titles(&mut drawing, view);
    for panel in 0..view.titles.len() {
        layout.draw_axes(&mut drawing, view, panel);
        let frame = layout.frame(panel);
        rules::draw(&mut drawing, view, panel, frame);
        let panel = Panel {
            view,
            panel,
            frame,
            front: &front,
        };
        panel.draw(&mut drawing);
    }
    let left = layout.frame(0).x;
    let style = TextStyle::new(12);
    for (number, text) in list.iter().enumerate() {
        let y = layout.bottom() + 12.0 + LINE * number as f64;
        let number = (number + 1).to_string();
        drawing.bold_text((left - 8.0, y), &number, style.align(Align::End));
        drawing.text((left, y), text, style);
    }
    drawing
}

fn legend(view: &View) -> Vec<LegendEntry> {
    let mut entries = Vec::new();
    if !view.spec.lines.is_empty() {
        entries.push(LegendEntry::title(format!("{}:", view.lines.heading)));
        let is_joined = view.is_joined;
        entries.extend(view.lines.names.iter().enumerate().map(|(line, name)| {
            LegendEntry::series(name.clone(), move |drawing, area| {
                let stroke = line_stroke(line);
                if is_joined {
                    drawing.line(area.at(0.0, 0.5), area.at(1.0, 0.5), stroke);
                }
                drawing.marker(line, area.at(0.5, 0.5), MARKER_RADIUS, stroke.colour);
            })
        }));
    }
    if let (Some(words), true) = (view.interval_words(), view.has_interval()) {
        let has_bands = view.has_bands();
        entries.push(LegendEntry::new(
            words,
            move |drawing, area| match has_bands {
                true => {
                    let corners = [(0.0, 0.1), (1.0, 0.1), (1.0, 0.9), (0.0, 0.9)];
                    drawing.polygon(&corners.map(|(x, y)| area.at(x, y)), MUTED, 0.25);
                }
                false => {
                    let bar = Stroke::new(MUTED, 1.5);
                    drawing.line(area.at(0.5, 0.0), area.at(0.5, 1.0), bar);
                }
            },
        ));
    }
    if view.spec.front {
        entries.push(LegendEntry::new(front::words(view), |drawing, area| {
            let steps = [(0.0, 0.2), (0.5, 0.2), (0.5, 0.8), (1.0, 0.8)];
            drawing.polyline(&steps.map(|(x, y)| area.at(x, y)), FRONT);
        }));
    }
    entries.extend(rules::entries(view));
    entries
}

struct Panel<'a> {
    view: &'a View<'a>,
    panel: usize,
    frame: Area,
    front: &'a Front<'a>,
}

impl Panel<'_> {
    fn draw(&self, drawing: &mut Drawing) {
        let view = self.view;
        let of_line = |line: usize| {
            let places = view.places.iter();
            places.filter(move |place| place.panel == self.panel && place.line == line)
        };
        let lines: Vec<Vec<&Place>> = (0..view.lines.names.len())
            .map(|line| of_line(line).collect())
            .collect();
        for (line, places) in lines.iter().enumerate() {
            self.draw_series(drawing, line, |drawing| {
                self.draw_intervals(drawing, line, places);
            });
        }
        let fronts = self.front.fronts.iter();
        for (_, front) in fronts.filter(|(panel, _)| *panel == self.panel) {
            // A front is a step function: constant until its next point.
            let ends = front.iter().skip(1).map(|place| place.x).chain([1.0]);
            let steps = front
                .iter()
                .zip(ends)
                .flat_map(|(place, end)| [self.at(place), self.frame.at(end, place.y)]);
            drawing.polyline(&steps.collect::<Vec<_>>(), FRONT);
        }
        for (line, places) in lines.iter().enumerate() {
            self.draw_series(drawing, line, |drawing| {
                self.draw_points(drawing, line, places);
            });
        }
        self.draw_numbers(drawing);
    }

    /// Draws a part of a line in an SVG group with the name of the line; a chart with a single line has no group.
    fn draw_series(&self, drawing: &mut Drawing, line: usize, draw: impl FnOnce(&mut Drawing)) {
        match &self.view.lines.names[line][..] {
            "" => draw(drawing),
            name => drawing.group(&[("series", name)], draw),
        }
    }

    /// Draws the confidence intervals of a line (series) as a band or as error bars.
    fn draw_intervals(&self, drawing: &mut Drawing, line: usize, places: &[&Place]) {
        let colour = line_stroke(line).colour;
        if self.view.has_bands() && places.len() > 1 {
            self.draw_band(drawing, places, colour);
        } else if self.view.has_interval() {
            for (x, ends) in places.iter().filter_map(|p| Some((p.x, p.interval?))) {
                let [low, high] = ends.map(|end| self.frame.at(x, end));
                drawing.line(low, high, Stroke::new(colour, 1.5));
            }
        }
    }

    /// Draws a line and its markers; markers on the Pareto front are drawn last.
    fn draw_points(&self, drawing: &mut Drawing, line: usize, places: &[&Place]) {
        let view = self.view;
        if view.is_joined && places.len() > 1 {
            let points: Vec<Point> = places.iter().map(|place| self.at(place)).collect();
            let path = view.spec.mark.about().path;
            let path = path.map_or(Vec::new(), |path| path(&points));
            drawing.polyline(&path, line_stroke(line));
        }
        let is_on_front = |place: &&Place| self.front.has(place.row);
        let (ahead, behind): (Vec<&Place>, Vec<&Place>) =
            places.iter().copied().partition(is_on_front);
        let colour = line_stroke(line).colour;
        let (radius, pale) = self.behind(colour);
        for place in behind {
            view.draw_mark(drawing, place, |drawing| {
                drawing.marker(line, self.at(place), radius, pale);
            });
        }
        for place in ahead {
            view.draw_mark(drawing, place, |drawing| {
                drawing.marker(line, self.at(place), MARKER_RADIUS + 2.4, INK);
                drawing.marker(line, self.at(place), MARKER_RADIUS, colour);
            });
        }
    }

    fn at(&self, place: &Place) -> Point {
        self.frame.at(place.x, place.y)
    }

    /// Returns the radius and colour of markers that are not on the Pareto front. They are paler if a front is drawn, and smaller if there are many points.
    fn behind(&self, colour: Rgb) -> (f64, Rgb) {
        let radius = match self.view.places.len() > MANY {
            true => 0.55 * MARKER_RADIUS,
            false => MARKER_RADIUS,
        };
        let paler = |channel: u8| channel + (f64::from(255 - channel) * 0.45) as u8;
        match self.view.spec.front {
            true => (0.8 * radius, colour.map(paler)),
            false => (radius, colour),
        }
    }

    fn draw_band(&self, drawing: &mut Drawing, places: &[&Place], fill: Rgb) {
        let end = |end: usize| {
            let bounded = places.iter();
            bounded.filter_map(move |place| Some(self.frame.at(place.x, place.interval?[end])))
        };
        let corners: Vec<Point> = end(0).chain(end(1).rev()).collect();
        if corners.len() > 2 {
            drawing.polygon(&corners, fill, 0.18);
        }
    }

    /// Draws the numbers of the points on Pareto fronts, on the side where no other points are. If two numbers overlap, the later one is omitted.
    fn draw_numbers(&self, drawing: &mut Drawing) {
        let up = match front::is_more_better(self.view) {
            true => -8.0,
            false => 17.0,
        };
        let style = TextStyle::new(12).align(Align::End);
        let mut last = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        let here = self.front.numbered();
        for (number, place) in here.filter(|(_, place)| place.panel == self.panel) {
            let (x, y) = self.at(place);
            let at = (
                (x - 7.0).max(self.frame.x + 14.0),
                (y + up).max(self.frame.y + 11.0),
            );
            if (at.0 - last.0).abs() < 16.0 && (at.1 - last.1).abs() < 12.0 {
                continue;
            }
            drawing.bold_text(at, &number.to_string(), style);
            last = at;
        }
    }
}
