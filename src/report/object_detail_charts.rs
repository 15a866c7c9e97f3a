//! Charts of a study of object detail: what spheres buy, and what they cost.

use super::legend::{
    Heading, LEFT, LegendEntry, MARKER_RADIUS, Mark, RIGHT, dashes, line_colour, line_entries,
    line_stroke,
};
use super::log_scale::{LogScale, axis_titles, draw_axes};
use super::object_detail_recognition::draw_recognition;
use crate::quantile::quantile;
use crate::report::colours::INK;
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::study::object_detail::DetailMethod;
use crate::study::object_detail::table::{DetailCell, DetailSummary, ObjectDetailTables};

const PANEL: (f64, f64) = (360.0, 300.0);
/// Room for a panel's tick labels.
const GAP: f64 = 56.0;

/// Lower quartile, median and upper quartile over objects.
type Quartiles = [f64; 3];

/// One method at one level.
struct Place {
    x: f64,
    y: Quartiles,
}

/// A quantity of a summary row and what a panel says of it.
struct Panel {
    title: &'static str,
    y: fn(&DetailSummary) -> Quartiles,
}

/// A chart of two panels.
struct Chart<'a> {
    title: &'static str,
    /// Along x, and along y.
    axes: (&'static str, &'static str),
    panels: [Panel; 2],
    x: &'a dyn Fn(&DetailSummary) -> f64,
    /// Where the exact mesh stands along x, if it does; its error is zero.
    mesh: Option<f64>,
}

const AFTER_OFFSET: &str = "after the best constant offset";
const DEFLECTION_ERROR: &str = "mean deflection error, mm";

fn error(row: &DetailSummary) -> Quartiles {
    [row.error_q1_mm, row.error_median_mm, row.error_q3_mm]
}

fn error_after_offset(row: &DetailSummary) -> Quartiles {
    [
        row.error_after_offset_q1_mm,
        row.error_after_offset_median_mm,
        row.error_after_offset_q3_mm,
    ]
}

fn surface_error(row: &DetailSummary) -> Quartiles {
    [
        row.surface_error_q1_mm,
        row.surface_error_median_mm,
        row.surface_error_q3_mm,
    ]
}

fn surface_error_max(row: &DetailSummary) -> Quartiles {
    [
        row.surface_error_max_q1_mm,
        row.surface_error_max_median_mm,
        row.surface_error_max_q3_mm,
    ]
}

/// All charts: file name without ending, title, drawing.
pub fn draw_object_detail_charts(tables: &ObjectDetailTables) -> Vec<(String, String, Drawing)> {
    let spheres = |row: &DetailSummary| row.n_spheres_median;
    let times = |row: &DetailSummary| median_time_us(tables, row.method, row.tolerance_mm);
    let deflection = || {
        [
            Panel {
                title: "as it is",
                y: error,
            },
            Panel {
                title: AFTER_OFFSET,
                y: error_after_offset,
            },
        ]
    };
    let surface = Chart {
        title: "Distance between spheres and mesh by number of spheres",
        axes: ("spheres an object", "distance of the surfaces, mm"),
        panels: [
            Panel {
                title: "mean over the surface",
                y: surface_error,
            },
            Panel {
                title: "largest",
                y: surface_error_max,
            },
        ],
        x: &spheres,
        mesh: None,
    };
    let felt = Chart {
        title: "Error of what the skin feels by number of spheres",
        axes: ("spheres an object", DEFLECTION_ERROR),
        panels: deflection(),
        x: &spheres,
        mesh: None,
    };
    let time = Chart {
        title: "Error of what the skin feels by time of a touch",
        axes: ("time of a touch, one thread, µs", DEFLECTION_ERROR),
        panels: deflection(),
        x: &times,
        mesh: Some(median_time_us(tables, DetailMethod::Mesh, None)),
    };
    [
        ("surface_error_by_spheres", surface),
        ("deflection_error_by_spheres", felt),
        ("deflection_error_by_time", time),
    ]
    .into_iter()
    .map(|(name, chart)| {
        let drawing = chart.draw(&tables.summary);
        (name.to_owned(), chart.title.to_owned(), drawing)
    })
    .chain(draw_recognition(tables))
    .collect()
}

/// The sphere models among these, each once; packing first, whatever their order: its colour is the same in every chart.
pub(super) fn methods(found: impl IntoIterator<Item = DetailMethod>) -> Vec<DetailMethod> {
    let mut methods: Vec<DetailMethod> = Vec::new();
    for method in found {
        if method != DetailMethod::Mesh && !methods.contains(&method) {
            methods.push(method);
        }
    }
    methods.sort_by_key(|method| *method != DetailMethod::Packing);
    methods
}

/// A method in words.
pub(super) fn method_name(method: DetailMethod) -> &'static str {
    match method {
        DetailMethod::Mesh => "exact mesh",
        DetailMethod::Packing => "packing",
        DetailMethod::VertexSpheres => "vertex spheres",
        DetailMethod::DecimatedVertexSpheres => "decimated vertex spheres",
        DetailMethod::MedialSpheres => "medial spheres",
    }
}

/// Median over objects of the time of a touch, µs.
pub(super) fn median_time_us(
    tables: &ObjectDetailTables,
    method: DetailMethod,
    tolerance_mm: Option<f64>,
) -> f64 {
    let is_it = |cell: &DetailCell| cell.method == method && cell.tolerance_mm == tolerance_mm;
    let of_level = tables.timing.iter().filter(|(cell, _)| is_it(cell));
    let mut times: Vec<f64> = of_level.map(|(_, time)| time.us_per_touch).collect();
    quantile(&mut times, 0.5)
}

impl Chart<'_> {
    fn draw(&self, summary: &[DetailSummary]) -> Drawing {
        let rows: Vec<&DetailSummary> = summary
            .iter()
            .filter(|row| row.method != DetailMethod::Mesh)
            .collect();
        let methods = methods(rows.iter().map(|row| row.method));
        let width = LEFT + 2.0 * PANEL.0 + GAP + RIGHT;
        let heading = Heading::of(self.title, &settings(&rows), self.legend(&methods), width);
        let mut drawing = Drawing::new(width, heading.height() + 24.0 + PANEL.1 + 58.0);
        heading.draw(&mut drawing);
        let xs = rows.iter().map(|row| (self.x)(row)).chain(self.mesh);
        let xs: Vec<f64> = xs.collect();
        // One scale for both panels, so that they can be compared by eye.
        let ys: Vec<f64> = self
            .panels
            .iter()
            .flat_map(|panel| rows.iter().flat_map(|row| (panel.y)(row)))
            .collect();
        for (number, panel) in self.panels.iter().enumerate() {
            let area = Area {
                x: LEFT + number as f64 * (PANEL.0 + GAP),
                y: heading.height() + 24.0,
                width: PANEL.0,
                height: PANEL.1,
            };
            let x = LogScale::over(xs.iter().copied(), area.x, area.x + area.width);
            let y = LogScale::over(ys.iter().copied(), area.y + area.height, area.y);
            let above = (area.x + area.width / 2.0, area.y - 8.0);
            drawing.bold_text(above, panel.title, TextStyle::new(13).align(Align::Middle));
            draw_axes(&mut drawing, area, (x, &x.ticks()), (y, &y.ticks()));
            axis_titles(
                &mut drawing,
                area,
                self.axes.0,
                (number == 0).then_some(self.axes.1),
            );
            if let Some(time) = self.mesh {
                draw_mesh(&mut drawing, x.place(time), area);
            }
            for (line, &method) in methods.iter().enumerate() {
                let of_method = rows.iter().filter(|row| row.method == method);
                let places = of_method.map(|row| Place {
                    x: x.place((self.x)(row)),
                    y: (panel.y)(row).map(|value| y.place(value)),
                });
                draw_method(&mut drawing, line, places.collect());
            }
        }
        drawing
    }

    fn legend(&self, methods: &[DetailMethod]) -> Vec<LegendEntry> {
        let mut entries = line_entries(methods.iter().map(|&method| method_name(method)));
        entries.push(LegendEntry::new("quartiles".to_owned(), Mark::Band));
        if self.mesh.is_some() {
            let text = "exact mesh: no error".to_owned();
            entries.push(LegendEntry::new(text, Mark::Dashes));
        }
        entries
    }
}

fn settings(rows: &[&DetailSummary]) -> String {
    let mut levels: Vec<f64> = rows.iter().filter_map(|row| row.tolerance_mm).collect();
    levels.sort_by(|a, b| b.total_cmp(a));
    levels.dedup();
    let levels: Vec<String> = levels.iter().map(f64::to_string).collect();
    let n_objects = rows.first().map_or(0, |row| row.n_objects);
    let mut text = format!("median over {n_objects} objects, with the band of their quartiles");
    if !levels.is_empty() {
        text += &format!("; packed within {} mm", levels.join(", "));
    }
    text
}

/// The exact mesh: somewhere along x, below everything that a logarithmic axis can show.
fn draw_mesh(drawing: &mut Drawing, x: f64, area: Area) {
    let bottom = area.y + area.height;
    drawing.line((x, area.y), (x, bottom), dashes(1.2));
    drawing.marker(6, (x, bottom), MARKER_RADIUS, INK);
}

fn draw_method(drawing: &mut Drawing, line: usize, mut places: Vec<Place>) {
    places.sort_by(|a, b| a.x.total_cmp(&b.x));
    let at = |quartile: usize| places.iter().map(move |p| (p.x, p.y[quartile]));
    let colour = line_colour(line);
    if places.len() > 1 {
        let band: Vec<Point> = at(0).chain(at(2).rev()).collect();
        drawing.polygon(&band, colour, 0.18);
        drawing.polyline(&at(1).collect::<Vec<_>>(), line_stroke(line));
    }
    for place in &places {
        if places.len() == 1 {
            let (low, high) = ((place.x, place.y[0]), (place.x, place.y[2]));
            drawing.line(low, high, Stroke::new(colour, 1.5));
        }
        drawing.marker(line, (place.x, place.y[1]), MARKER_RADIUS, colour);
    }
}
