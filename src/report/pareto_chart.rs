//! Accuracy against time, with the Pareto front: which cells are worth what they cost.

use crate::report::axis::Axis;
use crate::report::chart::{draw_axes, draw_y_labels, n_classes, y_at};
use crate::report::colours::{INK, Rgb};
use crate::report::drawing::{Align, Area, Drawing, Point, TextStyle};
use crate::report::legend::{
    CHANCE, FRONT, Heading, LegendEntry, MARKER_RADIUS, Mark, line_colour,
};
use crate::report::panels::Panels;
use crate::report::text_width::text_width;
use crate::report::time_scale::TimeScale;
use crate::report::varying::{Levels, Settings, unbroken_parts};
use crate::study::table::{Cell, Pareto, Tables};

/// Classifiers from which on a study is about choosing one.
const MANY_CLASSIFIERS: usize = 3;
const LABEL: u32 = 13;
/// Letters of the names on the front.
const NAME: u32 = 11;

/// Whose time runs along x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Seconds to fit.
    Training,
    /// Time to decide once.
    Prediction,
}

impl Cost {
    /// File name without ending.
    pub fn name(self) -> &'static str {
        match self {
            Self::Training => "pareto_training",
            Self::Prediction => "pareto_prediction",
        }
    }

    /// What the chart is read as.
    pub fn title(self) -> &'static str {
        match self {
            Self::Training => "Accuracy against the time to train",
            Self::Prediction => "Accuracy against the time to decide on an object",
        }
    }

    fn axis_title(self) -> &'static str {
        match self {
            Self::Training => "time of one fit, all training touches (mean of the trials)",
            Self::Prediction => "time of one decision, its touches measured (mean of the trials)",
        }
    }

    fn seconds(self, row: &Pareto) -> f64 {
        let seconds = match self {
            Self::Training => row.fit_s,
            Self::Prediction => 1e-6 * row.predict_us_per_decision,
        };
        // A clock that saw no time pass cannot stand on a logarithmic axis.
        seconds.max(1e-9)
    }

    fn is_on_front(self, row: &Pareto) -> bool {
        match self {
            Self::Training => row.on_training_front,
            Self::Prediction => row.on_prediction_front,
        }
    }
}

/// Whether a study of these cells gets charts of accuracy against time: as it asks, else if it sweeps three classifiers or more.
pub fn is_wanted(cells: &[&Cell], asked: Option<bool>) -> bool {
    let n_kinds = Levels::of(Axis::Classifier, cells).values.len();
    !cells.is_empty() && asked.unwrap_or(n_kinds >= MANY_CLASSIFIERS)
}

/// Draws accuracy against time: one panel for each noise, one colour for each classifier (or, with one classifier, for each
/// value of the first other setting that varies); cells on the front are ringed and joined by steps,
/// and named where there is room.
pub fn draw_pareto(tables: &Tables, cost: Cost) -> Drawing {
    let cells: Vec<&Cell> = tables.pareto.iter().map(|(cell, _)| cell).collect();
    let settings = Settings::of(&cells);
    let is_shown = |axis: Axis| settings.varying.iter().find(|levels| levels.axis == axis);
    let others = settings.varying.iter().find(|l| l.axis != Axis::Noise);
    let n_classes = n_classes(tables);
    let chart = Chart {
        rows: &tables.pareto,
        cost,
        colours: is_shown(Axis::Classifier).or(others).cloned(),
        panels: is_shown(Axis::Noise).cloned(),
        named_by: settings
            .varying
            .iter()
            .map(|levels| levels.axis)
            .filter(|&axis| axis != Axis::Noise)
            .collect(),
        chance: (n_classes > 0).then(|| 1.0 / n_classes as f64),
    };
    let constants: Vec<String> = settings.fixed.iter().map(Levels::sentence).collect();
    chart.draw(&unbroken_parts(&constants))
}

struct Chart<'a> {
    rows: &'a [(Cell, Pareto)],
    cost: Cost,
    colours: Option<Levels>,
    panels: Option<Levels>,
    /// The settings that tell two cells of a panel apart.
    named_by: Vec<Axis>,
    chance: Option<f64>,
}

impl Chart<'_> {
    fn draw(&self, constants: &str) -> Drawing {
        let n_panels = self.panels.as_ref().map_or(1, |p| p.values.len());
        let above = if n_panels > 1 { 24.0 } else { 6.0 };
        let panels = Panels::new(n_panels, n_panels.min(2), above, 26.0);
        let heading = Heading::of(self.cost.title(), constants, self.legend(), panels.width());
        let top = heading.height();
        let mut drawing = Drawing::new(panels.width(), panels.bottom(top));
        heading.draw(&mut drawing);
        let scale = TimeScale::of(self.rows.iter().map(|(_, row)| self.cost.seconds(row)));
        for panel in 0..n_panels {
            let frame = panels.frame(panel, top);
            if let Some(levels) = &self.panels {
                let text = format!("{} {}", levels.axis.name(), levels.values[panel].label);
                drawing.bold_text((frame.x, frame.y - 8.0), &text, TextStyle::new(LABEL));
            }
            self.draw_panel(&mut drawing, panel, frame, &scale);
            if panels.is_first_in_row(panel) {
                draw_y_labels(&mut drawing, frame);
            }
            if panels.is_last_in_column(panel) {
                let below = (frame.x + frame.width / 2.0, frame.y + frame.height + 40.0);
                let style = TextStyle::new(LABEL).align(Align::Middle);
                drawing.text(below, self.cost.axis_title(), style);
            }
        }
        drawing
    }

    fn draw_panel(&self, drawing: &mut Drawing, panel: usize, frame: Area, scale: &TimeScale) {
        draw_axes(drawing, frame);
        scale.draw_ticks(drawing, frame);
        if let Some(chance) = self.chance {
            let y = y_at(frame, chance);
            drawing.line((frame.x, y), (frame.x + frame.width, y), CHANCE);
        }
        let is_here = |cell: &Cell| match &self.panels {
            Some(levels) => levels.axis.value(cell) == levels.values[panel],
            None => true,
        };
        let mut front: Vec<(Point, &Cell)> = Vec::new();
        for (cell, row) in self.rows.iter().filter(|(cell, _)| is_here(cell)) {
            let at = (
                scale.x(self.cost.seconds(row), frame),
                y_at(frame, row.accuracy),
            );
            match self.cost.is_on_front(row) {
                true => front.push((at, cell)),
                false => {
                    let colour = self.colour_of(cell);
                    drawing.marker(colour, at, 0.8 * MARKER_RADIUS, paler(line_colour(colour)));
                }
            }
        }
        front.sort_by(|(a, _), (b, _)| a.0.total_cmp(&b.0));
        let places: Vec<Point> = front.iter().map(|(at, _)| *at).collect();
        draw_steps(drawing, &places, frame);
        for (at, cell) in &front {
            let colour = self.colour_of(cell);
            drawing.marker(colour, *at, MARKER_RADIUS + 2.4, INK);
            drawing.marker(colour, *at, MARKER_RADIUS, line_colour(colour));
        }
        let names: Vec<String> = front.iter().map(|(_, cell)| self.name(cell)).collect();
        for (place, name) in name_places(&places, &names, frame).iter().zip(&names) {
            if let Some(place) = place {
                drawing.text(*place, name, TextStyle::new(NAME));
            }
        }
    }

    /// `RBF SVM, 64:1`, `RBF SVM, m = 64`.
    fn name(&self, cell: &Cell) -> String {
        let words = self.named_by.iter().map(|axis| match axis {
            Axis::Ratio | Axis::Classifier | Axis::Ensemble | Axis::OverTime | Axis::Features => {
                axis.value(cell).label
            }
            _ => axis.phrase(cell),
        });
        words.collect::<Vec<_>>().join(", ")
    }

    fn colour_of(&self, cell: &Cell) -> usize {
        let Some(levels) = &self.colours else {
            return 0;
        };
        let value = levels.axis.value(cell);
        levels.values.iter().position(|v| *v == value).unwrap_or(0)
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let mut entries = Vec::new();
        if let Some(levels) = &self.colours {
            let name = format!("{}:", levels.heading());
            entries.push(LegendEntry::new(name, Mark::None));
            for (number, value) in levels.values.iter().enumerate() {
                entries.push(LegendEntry::new(value.label.clone(), Mark::Point(number)));
            }
        }
        let front = "Pareto front: nothing is both faster and as accurate";
        entries.push(LegendEntry::new(front.to_owned(), Mark::Front));
        if let Some(chance) = self.chance {
            let text = format!("chance (1 in {:.0})", 1.0 / chance);
            entries.push(LegendEntry::new(text, Mark::Dashes));
        }
        entries
    }
}

/// What accuracy a budget of time buys: level until the next cell of the front.
pub(super) fn draw_steps(drawing: &mut Drawing, front: &[Point], frame: Area) {
    let Some(&last) = front.last() else {
        return;
    };
    let mut steps = Vec::new();
    for pair in front.windows(2) {
        steps.extend([pair[0], (pair[1].0, pair[0].1)]);
    }
    steps.extend([last, (frame.x + frame.width, last.1)]);
    drawing.polyline(&steps, FRONT);
}

/// Where the names of the points of a front begin: above each point and to its left, where no cell can be, since it would be
/// faster and more accurate. A name that would lie on another one, on the
/// next step, or beyond the frame, has no place; the more accurate
/// cells come first.
fn name_places(front: &[Point], names: &[String], frame: Area) -> Vec<Option<Point>> {
    let line = f64::from(NAME) + 2.0;
    let mut taken: Vec<(Point, f64)> = Vec::new();
    let mut places = vec![None; front.len()];
    for (index, &(x, y)) in front.iter().enumerate().rev() {
        let width = text_width(&names[index], f64::from(NAME));
        let start = (x + MARKER_RADIUS - width).max(frame.x + 4.0);
        // Pushed right by the frame's edge, a name can reach the step up to the next point.
        let next_step = front.get(index + 1).map_or(f64::INFINITY, |next| next.0);
        let end = (frame.x + frame.width).min(next_step);
        let is_free = |at: &Point| {
            let is_apart = |((left, base), wide): &(Point, f64)| {
                (base - at.1).abs() >= line || at.0 > left + wide || *left > at.0 + width
            };
            at.1 - line > frame.y && start + width < end && taken.iter().all(is_apart)
        };
        let above = y - MARKER_RADIUS - 7.0;
        places[index] = [(start, above), (start, above - line)]
            .into_iter()
            .find(is_free);
        taken.extend(places[index].map(|at| (at, width)));
    }
    places
}

pub(super) fn paler(colour: Rgb) -> Rgb {
    colour.map(|channel| channel + ((255 - channel) as f64 * 0.45) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_on_a_front_never_lie_on_each_other_and_the_most_accurate_cell_has_one() {
        let frame = Area {
            x: 60.0,
            y: 20.0,
            width: 400.0,
            height: 300.0,
        };
        let front: Vec<Point> = (0..30)
            .map(|i| (70.0 + 12.0 * f64::from(i), 310.0 - 6.0 * f64::from(i)))
            .collect();
        let names: Vec<String> = (0..30).map(|i| format!("random forest, {i}:1")).collect();
        let places = name_places(&front, &names, frame);
        assert!(places[29].is_some());
        let placed: Vec<(Point, f64)> = places
            .iter()
            .zip(&names)
            .filter_map(|(at, name)| at.map(|at| (at, text_width(name, f64::from(NAME)))))
            .collect();
        assert!(placed.len() > 5 && placed.len() < 30, "{}", placed.len());
        for (number, ((x, y), width)) in placed.iter().enumerate() {
            assert!(*x >= frame.x && x + width <= frame.x + frame.width);
            for ((other_x, other_y), other_width) in &placed[..number] {
                let beside = x + width < *other_x || other_x + other_width < *x;
                assert!(beside || (y - other_y).abs() >= f64::from(NAME));
            }
        }
    }
}
