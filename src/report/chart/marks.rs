//! Lines, steps and points.

use super::front::{self, Front};
use super::layout::Layout;
use super::rules;
use super::view::{Place, View};
use crate::report::colours::INK;
use crate::report::colours::Rgb;
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::report::legend::{
    FRONT, LegendEntry, MARKER_RADIUS, Mark, line_colour, line_stroke, point_colour,
};
use crate::table::Mark as TableMark;

/// Points beyond which each is small.
const MANY: usize = 400;
/// Pixels of a line of the list of a front.
const LINE: f64 = 17.0;

pub(super) fn draw(view: &View) -> Drawing {
    let n_panels = view.panels.names.len();
    let columns = match n_panels {
        1 | 2 => n_panels,
        4 => 2,
        _ => 3,
    };
    let (width, height) = match columns {
        1 => (660.0, 340.0),
        2 => (385.0, 300.0),
        _ => (272.0, 240.0),
    };
    let height = match view.y.is_words() {
        true => 22.0 * view.y.n_levels() as f64,
        false => height,
    };
    let above = if n_panels > 1 { 26.0 } else { 8.0 };
    let layout = Layout::of(
        view,
        legend(view),
        (n_panels, columns),
        (width, height),
        above,
    );
    let front = Front::of(view);
    let list = front.list();
    let height =
        layout.bottom() + LINE * list.len() as f64 + if list.is_empty() { 0.0 } else { 16.0 };
    let mut drawing = Drawing::new(layout.width(), height);
    layout.draw_heading(&mut drawing);
    for panel in 0..n_panels {
        layout.draw_axes(&mut drawing, view, panel, true);
        if n_panels > 1 {
            layout.draw_title(&mut drawing, panel, &view.panel_title(panel), 8.0);
        }
        let panel = Panel {
            view,
            panel,
            frame: layout.frame(panel),
            front: &front,
        };
        panel.draw(&mut drawing);
    }
    let left = layout.frame(0).x;
    for (number, text) in list.iter().enumerate() {
        let y = layout.bottom() + 12.0 + LINE * number as f64;
        let style = TextStyle::new(12);
        drawing.bold_text(
            (left - 8.0, y),
            &format!("{}", number + 1),
            style.align(Align::End),
        );
        drawing.text((left, y), text, style);
    }
    drawing
}

fn legend(view: &View) -> Vec<LegendEntry> {
    let mut entries = Vec::new();
    if !view.spec.lines.is_empty() {
        entries.push(LegendEntry::new(
            format!("{}:", view.lines.heading),
            Mark::None,
        ));
        let names = view.lines.names.iter().enumerate();
        entries.extend(names.map(|(line, name)| {
            let mark = match view.is_joined {
                true => Mark::Line(line),
                false => Mark::Point(line),
            };
            LegendEntry::new(name.clone(), mark)
        }));
    }
    if let (Some(words), true) = (
        view.interval_words(),
        view.has_bands() || view.has_whiskers(),
    ) {
        let mark = if view.has_bands() {
            Mark::Band
        } else {
            Mark::Whisker
        };
        entries.push(LegendEntry::new(words, mark));
    }
    if view.spec.front {
        entries.push(LegendEntry::new(front::words(view), Mark::Front));
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
        let lines: Vec<Vec<&Place>> = (0..self.view.lines.names.len())
            .map(|line| self.view.line(self.panel, line))
            .collect();
        for (line, places) in lines.iter().enumerate() {
            if self.view.has_bands() && places.len() > 1 {
                self.draw_band(drawing, places, line_colour(line));
            } else if self.view.has_bands() || self.view.has_whiskers() {
                self.draw_whiskers(drawing, places, self.colour(line));
            }
        }
        self.draw_fronts(drawing);
        for (line, places) in lines.iter().enumerate() {
            if self.view.is_joined && places.len() > 1 {
                drawing.polyline(&self.path(places), line_stroke(line));
            }
            let is_on_front = |place: &&&Place| self.front.has(place.row);
            let (ahead, behind): (Vec<_>, Vec<_>) = places.iter().partition(is_on_front);
            for place in behind {
                let (radius, colour) = self.look(line);
                drawing.marker(line, self.at(place), radius, colour);
            }
            for place in ahead {
                drawing.marker(line, self.at(place), MARKER_RADIUS + 2.4, INK);
                drawing.marker(line, self.at(place), MARKER_RADIUS, self.colour(line));
            }
        }
        self.draw_numbers(drawing);
    }

    fn at(&self, place: &Place) -> Point {
        self.point(place.x, place.y)
    }

    fn point(&self, x: f64, y: f64) -> Point {
        (
            self.frame.x + x * self.frame.width,
            self.frame.y + (1.0 - y) * self.frame.height,
        )
    }

    fn colour(&self, line: usize) -> Rgb {
        match self.view.is_joined {
            true => line_colour(line),
            false => point_colour(line),
        }
    }

    /// What is behind a front is paler, and of very many small.
    fn look(&self, line: usize) -> (f64, Rgb) {
        let radius = match self.view.places.len() > MANY {
            true => 0.55 * MARKER_RADIUS,
            false => MARKER_RADIUS,
        };
        match self.view.spec.front {
            true => (0.8 * radius, paler(self.colour(line))),
            false => (radius, self.colour(line)),
        }
    }

    fn path(&self, places: &[&Place]) -> Vec<Point> {
        let mut path: Vec<Point> = Vec::new();
        for place in places {
            let at = self.at(place);
            if let (TableMark::Step, Some(&last)) = (&self.view.spec.mark, path.last()) {
                path.push((at.0, last.1));
            }
            path.push(at);
        }
        path
    }

    fn draw_band(&self, drawing: &mut Drawing, places: &[&Place], fill: Rgb) {
        let bounded = || {
            places
                .iter()
                .filter_map(|place| Some((place.x, place.interval?)))
        };
        let low = bounded().map(|(x, [low, _])| self.point(x, low));
        let high = bounded().rev().map(|(x, [_, high])| self.point(x, high));
        let corners: Vec<Point> = low.chain(high).collect();
        if corners.len() > 2 {
            drawing.polygon(&corners, fill, 0.18);
        }
    }

    fn draw_whiskers(&self, drawing: &mut Drawing, places: &[&Place], colour: Rgb) {
        for place in places {
            if let Some(ends) = place.interval {
                let [low, high] = ends.map(|end| self.point(place.x, end));
                drawing.line(low, high, Stroke::new(colour, 1.5));
            }
        }
    }

    /// What a budget buys: level until the next point of the front.
    fn draw_fronts(&self, drawing: &mut Drawing) {
        for front in self.front.of_panel(self.panel) {
            let mut steps: Vec<Point> = Vec::new();
            for place in front {
                let at = self.at(place);
                if let Some(&last) = steps.last() {
                    steps.push((at.0, last.1));
                }
                steps.push(at);
            }
            if let Some(&last) = steps.last() {
                steps.push((self.frame.x + self.frame.width, last.1));
                drawing.polyline(&steps, FRONT);
            }
        }
    }

    /// Each on the side where no point can be; of those that would touch, the later are left out.
    fn draw_numbers(&self, drawing: &mut Drawing) {
        let up = if front::is_more_better(self.view) {
            -8.0
        } else {
            17.0
        };
        let mut last = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for (number, place) in self.front.numbered() {
            if place.panel != self.panel {
                continue;
            }
            let at = self.at(place);
            let at = (
                (at.0 - 7.0).max(self.frame.x + 14.0),
                (at.1 + up).max(self.frame.y + 11.0),
            );
            if (at.0 - last.0).abs() < 16.0 && (at.1 - last.1).abs() < 12.0 {
                continue;
            }
            drawing.bold_text(
                at,
                &format!("{number}"),
                TextStyle::new(12).align(Align::End),
            );
            last = at;
        }
    }
}

fn paler(colour: Rgb) -> Rgb {
    colour.map(|channel| channel + (f64::from(255 - channel) * 0.45) as u8)
}
