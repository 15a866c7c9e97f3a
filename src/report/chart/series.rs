//! Series of a chart: points with markers and confidence intervals, optionally joined by lines.

use super::front::{self, Front};
use super::layout::{CAPTION, END_GAP, END_LABEL, Layout, WIDEST};
use super::legend::{FRONT, Heading, LEFT, LegendEntry, MARKER_RADIUS, line_stroke};
use super::rules;
use super::view::{Place, View};
use crate::error::Result;
use crate::report::pictures::{Area, Drawing, INK, MUTED, Point, Rgb, Stroke, TextStyle};
use crate::report::text_width::{shorten, text_width, wrap};

/// Number of points in a chart above which all markers are small.
const MANY: usize = 400;
/// Number of series of one point in a chart with a Pareto front up to which all points have labels, also those behind the front.
const FEW: usize = 12;
/// Number of points in a panel above which a label that would cover a point is omitted.
const CROWD: usize = 60;

/// Width and height of the panel of a small chart, pixels.
const PART: (f64, f64) = (158.0, 100.0);
/// Width and height that a small chart takes with its title and labels, pixels.
const PART_PITCH: (f64, f64) = (212.0, 172.0);
/// Maximum number of small charts side by side.
const PARTS_ACROSS: usize = 6;

/// Draws a chart in which each series of data is a line or a set of points.
pub(super) fn draw(view: &View) -> Result<Drawing> {
    if !view.spec.parts.is_empty() {
        return draw_parts(view);
    }
    // Two charts of up to two columns fit side by side on the page.
    let (columns, width, height) = match view.titles.len() {
        1 => (1, 540.0, 320.0),
        2 | 4 => (2, 275.0, 270.0),
        _ => (3, 176.0, 220.0),
    };
    let height = match view.y.is_words {
        true if view.spec.label.is_some() => 36.0 * view.y.levels.len() as f64,
        true => 22.0 * view.y.levels.len() as f64,
        false if view.spec.square => width,
        false => height,
    };
    let layout = Layout::new(view, legend(view), columns, (width, height));
    let mut drawing = Drawing::new(layout.width, layout.bottom());
    layout.draw_titles(&mut drawing, view);
    draw_panels(&mut drawing, view, &layout);
    Ok(drawing)
}

fn draw_panels(drawing: &mut Drawing, view: &View, layout: &Layout) {
    let front = &Front::new(view);
    for panel in 0..view.titles.len() {
        layout.draw_axes(drawing, view, panel);
        let frame = layout.frame(panel);
        rules::draw(drawing, view, panel, frame);
        let panel = Panel {
            view,
            panel,
            frame,
            front,
        };
        panel.draw(drawing);
    }
}

/// Draws a chart of small charts: the shared heading, and below it the small charts, each with its title and its note above its panel.
fn draw_parts(view: &View) -> Result<Drawing> {
    let parts = &view.spec.parts;
    let inner = PARTS_ACROSS as f64 * PART_PITCH.0;
    let settings = wrap(&view.constants(), CAPTION, inner);
    let heading = Heading::new(&view.spec.title, settings, legend(view), inner);
    let below = PART_PITCH.1 * parts.len().div_ceil(PARTS_ACROSS) as f64;
    let mut drawing = Drawing::new(LEFT + inner, heading.height() + below + 10.0);
    heading.draw(&mut drawing);
    let quiet = TextStyle::new(CAPTION as u32).colour(MUTED);
    for (number, part) in parts.iter().enumerate() {
        let (row, column) = (number / PARTS_ACROSS, number % PARTS_ACROSS);
        let x = LEFT + column as f64 * PART_PITCH.0;
        let y = heading.height() + 40.0 + row as f64 * PART_PITCH.1;
        let view = View::new(part, std::slice::from_ref(view.table))?;
        let title = shorten(&part.title, 1.12 * CAPTION, PART_PITCH.0 - 10.0);
        drawing.bold_text((x, y - 23.0), &title, TextStyle::new(CAPTION as u32));
        drawing.text((x, y - 7.0), &part.note, quiet);
        draw_panels(&mut drawing, &view, &Layout::of_part(&view, (x, y), PART));
    }
    Ok(drawing)
}

/// Returns whether the label of each point names its series, as in a chart of few series of one point.
fn is_labelled(view: &View) -> bool {
    let n = view.places.len();
    view.spec.front && n <= FEW && n == view.lines.names.len()
}

fn legend(view: &View) -> Vec<LegendEntry> {
    let mut entries = Vec::new();
    if !view.spec.lines.is_empty() && !is_labelled(view) && !view.has_end_labels() {
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
    if let Some(right) = &view.spec.right {
        let words = format!("not {}", right.value);
        entries.push(LegendEntry::new(words, |drawing, area| {
            draw_cross(drawing, area.at(0.5, 0.5), INK);
        }));
    }
    if view.spec.front {
        entries.push(LegendEntry::new(front::words(view), |drawing, area| {
            let steps = [(0.0, 0.2), (0.5, 0.2), (0.5, 0.8), (1.0, 0.8)];
            drawing.polyline(&steps.map(|(x, y)| area.at(x, y)), FRONT);
        }));
    }
    entries.extend(rules::entries(view));
    if !view.spec.parts.is_empty() {
        let words = "half of the accuracy above chance is lost".to_owned();
        entries.push(LegendEntry::new(words, |drawing, area| {
            drawing.marker(0, area.at(0.5, 0.5), MARKER_RADIUS, INK);
        }));
    }
    entries
}

/// Draws the marker of a row whose result is not right.
fn draw_cross(drawing: &mut Drawing, (x, y): Point, colour: Rgb) {
    let r = MARKER_RADIUS;
    for slope in [-r, r] {
        drawing.line(
            (x - r, y - slope),
            (x + r, y + slope),
            Stroke::new(colour, 2.4),
        );
    }
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
            view.here(self.panel)
                .filter(move |place| place.line == line)
        };
        let lines = (0..view.lines.names.len()).map(|line| of_line(line).collect());
        let lines: Vec<Vec<&Place>> = lines.collect();
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
        for dot in &view.spec.dots {
            let line = view.lines.of[dot.row];
            if let (Some(x), Some(y)) = (view.x.place(dot.at.0), view.y.place(dot.at.1)) {
                let colour = line_stroke(line).colour;
                drawing.marker(0, self.frame.at(x, y), MARKER_RADIUS, colour);
            }
        }
        self.draw_labels(drawing);
        if view.has_end_labels() && self.frame.width > PART.0 {
            self.draw_ends(drawing, &lines);
        }
    }

    /// Writes the name of each line beside its last point, right of the panel, and the heading of the names. Names that would overlap are moved apart.
    fn draw_ends(&self, drawing: &mut Drawing, lines: &[Vec<&Place>]) {
        let step = END_LABEL + 4.0;
        let ends = lines.iter().enumerate();
        let ends = ends.filter_map(|(line, places)| Some((line, self.at(places.last()?))));
        let mut ends: Vec<(usize, Point)> = ends.collect();
        ends.sort_by(|(_, a), (_, b)| a.1.total_cmp(&b.1));
        let (x, bottom) = self.frame.at(1.0, 0.0);
        let style = TextStyle::new(END_LABEL as u32);
        // What the names are stands above the first one.
        let mut top = self.frame.y + step;
        for (place, &(line, end)) in ends.iter().enumerate() {
            let n_below = ends.len() - 1 - place;
            let y = end.1.max(top).min(bottom - step * n_below as f64);
            top = y + step;
            if place == 0 {
                let at = (x + 8.0, y + 4.0 - step);
                drawing.text(at, &self.view.lines.heading, style.colour(MUTED));
            }
            let colour = line_stroke(line).colour;
            let name = &self.view.lines.names[line];
            let text = shorten(name, END_LABEL, WIDEST);
            drawing.line(end, (x + 10.0, y), Stroke::new(colour, 0.8));
            drawing.group([("toggle", name.clone())], |drawing| {
                drawing.marker(line, (x + 12.0, y), 0.8 * MARKER_RADIUS, colour);
                let at = (x + END_GAP - 4.0, y + 4.0);
                drawing.text(at, &text, style);
            });
        }
    }

    /// Draws a part of a line in an SVG group with the name of the line; a chart with a single line has no group.
    fn draw_series(&self, drawing: &mut Drawing, line: usize, draw: impl FnOnce(&mut Drawing)) {
        match &self.view.lines.names[line][..] {
            "" => draw(drawing),
            name => drawing.group([("series", name.to_owned())], draw),
        }
    }

    /// Draws the confidence intervals of a line (series) as a band or as error bars.
    fn draw_intervals(&self, drawing: &mut Drawing, line: usize, places: &[&Place]) {
        let colour = line_stroke(line).colour;
        if self.view.has_bands() && places.len() > 1 {
            self.draw_band(drawing, places, colour);
        } else if self.view.has_interval() {
            let is_clear = |p: &&&Place| !self.view.spec.front || self.front.has(p.row);
            let clear = places.iter().filter(is_clear);
            for (x, ends) in clear.filter_map(|p| Some((p.x, p.interval?))) {
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
            drawing.polyline(&points, line_stroke(line));
        }
        let is_on_front = |place: &&Place| self.front.has(place.row);
        let (ahead, behind): (Vec<&Place>, Vec<&Place>) =
            places.iter().copied().partition(is_on_front);
        let colour = line_stroke(line).colour;
        let (radius, pale) = self.behind(colour);
        for place in behind {
            view.draw_mark(drawing, place, |drawing| match view.is_right(place.row) {
                true => drawing.marker(line, self.at(place), radius, pale),
                false => draw_cross(drawing, self.at(place), pale),
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

    /// Returns the radius and colour of markers that are not on the Pareto front. They are paler if a front is drawn, and smaller if there are many points or if
    /// the panel is small.
    fn behind(&self, colour: Rgb) -> (f64, Rgb) {
        let radius = match self.view.places.len() > MANY {
            _ if self.frame.width <= PART.0 && self.view.is_joined => 0.35 * MARKER_RADIUS,
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

    /// Returns the labelled points of the panel and their labels, the most important one first: the points on Pareto fronts, all of few points, or the points
    /// of a labelled chart from both ends.
    fn labels(&self) -> Vec<(&Place, String)> {
        let view = self.view;
        let here = view.here(self.panel);
        if let Some(label) = view.label {
            let named = here.filter(|place| label.data.value(place.row).is_some());
            let labels = named.map(|place| (place, label.label(place.row)));
            let mut labels: Vec<(&Place, String)> = labels.collect();
            labels.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x));
            return labels;
        }
        let fronts = self.front.fronts.iter();
        let of_panel = fronts.filter(|(panel, _)| *panel == self.panel);
        let on_front = of_panel.flat_map(|(_, front)| front.iter().rev().copied());
        let is_behind = |place: &&Place| is_labelled(view) && !self.front.has(place.row);
        let points = on_front.chain(here.filter(is_behind));
        points
            .map(|place| (place, self.front.label(place)))
            .collect()
    }

    /// Writes the labels of points: above a point of a labelled chart; otherwise on the outer side of the front, or else on its inner side. A label without
    /// space is omitted.
    fn draw_labels(&self, drawing: &mut Drawing) {
        let labels = self.labels();
        let marker = 2.0 * MARKER_RADIUS;
        let around = |(place, _): &(&Place, String)| Area::around(self.at(place), (marker, marker));
        let mut taken: Vec<Area> = labels.iter().map(around).collect();
        let here = self.view.here(self.panel);
        let points = here.map(|place| Area::around(self.at(place), (marker, marker)));
        let points: Vec<Area> = points.collect();
        let (over, under) = (-8.0, 14.0);
        let (outer, inner) = match front::is_more_better(self.view) {
            true => (over, under),
            false => (under, over),
        };
        let size = END_LABEL;
        let frame = self.frame;
        // The title of a panel is above its frame.
        let top = match self.view.spec.panels {
            Some(_) => frame.y,
            None => f64::NEG_INFINITY,
        };
        for (place, text) in labels {
            let text = shorten(&text, size, 0.9 * frame.width);
            let (width, (x, y)) = (text_width(&text, size), self.at(place));
            let left = (x - 8.0 - width).max(frame.x + 3.0);
            let spots = match self.view.spec.label {
                Some(_) => vec![(x - 0.5 * width, y + over)],
                None => vec![
                    (x - 8.0 - width, y + outer),
                    (x + 9.0, y + inner),
                    (x - 8.0 - width, y + inner),
                    (x + 9.0, y + outer),
                    (left, y + outer),
                    (left, y + 2.6 * outer),
                ],
            };
            let area = |&(x, y): &Point| Area::new((x, y - size), (width, size + 1.0));
            let is_free = |at: &Point| {
                let is_inside = at.0 > frame.x
                    && at.0 + width < frame.x + frame.width
                    && at.1 - size >= top
                    && at.1 < frame.y + frame.height;
                is_inside && !taken.iter().any(|other| other.overlaps(&area(at)))
            };
            // A place that covers no other point is preferred.
            let is_clear = |at: &&Point| !points.iter().any(|point| point.overlaps(&area(at)));
            let free: Vec<Point> = spots.into_iter().filter(is_free).collect();
            let covering = free.first().filter(|_| points.len() <= CROWD);
            if let Some(&at) = free.iter().find(is_clear).or(covering) {
                taken.push(area(&at));
                drawing.text(at, &text, TextStyle::new(END_LABEL as u32));
            }
        }
    }
}
