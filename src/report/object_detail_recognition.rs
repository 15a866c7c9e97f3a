//! Chart of a study of object detail: what an object's errors cost a classifier that has learned from it.

use super::chart::{draw_axes, draw_y_labels, y_at};
use super::legend::{
    Heading, LegendEntry, MARKER_RADIUS, Mark, dashes, line_colour, line_entries, line_stroke,
};
use super::log_scale::{LogScale, draw_x_ticks};
use super::object_detail_charts::{method_name, methods};
use super::panels::Panels;
use crate::recognition::ClassifierKind;
use crate::report::axis::classifier_name;
use crate::report::drawing::{Align, Area, Drawing, Point, Stroke, TextStyle};
use crate::study::object_detail::DetailMethod;
use crate::study::object_detail::table::{DetailRecognition, ObjectDetailTables};

/// What the chart is read as.
const TITLE: &str =
    "Accuracy on the exact meshes by the error of the models that were learned from";

/// File name without ending, title, drawing; none where nothing was learned.
pub(super) fn draw_recognition(tables: &ObjectDetailTables) -> Option<(String, String, Drawing)> {
    let rows = &tables.recognition;
    let first = rows.first()?;
    let mut kinds: Vec<ClassifierKind> = Vec::new();
    for row in rows {
        if !kinds.contains(&row.classifier) {
            kinds.push(row.classifier);
        }
    }
    let methods = methods(rows.iter().map(|row| row.method));
    let panels = Panels::new(kinds.len(), kinds.len().min(2), 24.0, 26.0);
    let settings = format!(
        "{} objects, {} training and {} test touches of each, {} measurements; solid: tested on the exact meshes, with 95 % \
         intervals; dotted: on the models themselves",
        first.n_objects,
        first.n_training / first.n_objects,
        first.n_test / first.n_objects,
        first.n_measurements
    );
    let mut legend = line_entries(methods.iter().map(|&method| method_name(method)));
    let exact = "learned from the exact meshes".to_owned();
    legend.push(LegendEntry::new(exact, Mark::Dashes));
    let heading = Heading::of(TITLE, &settings, legend, panels.width());
    let top = heading.height();
    let mut drawing = Drawing::new(panels.width(), panels.bottom(top));
    heading.draw(&mut drawing);
    for (panel, &kind) in kinds.iter().enumerate() {
        let frame = panels.frame(panel, top);
        let of_kind = rows.iter().filter(|row| row.classifier == kind);
        draw_panel(
            &mut drawing,
            frame,
            kind,
            &methods,
            &of_kind.collect::<Vec<_>>(),
        );
        if panels.is_first_in_row(panel) {
            draw_y_labels(&mut drawing, frame);
        }
        if panels.is_last_in_column(panel) {
            let below = (frame.x + frame.width / 2.0, frame.y + frame.height + 40.0);
            let style = TextStyle::new(13).align(Align::Middle);
            drawing.text(below, "median deflection error past own contact, mm", style);
        }
    }
    Some((
        "recognition_by_deflection_error".to_owned(),
        TITLE.to_owned(),
        drawing,
    ))
}

fn draw_panel(
    drawing: &mut Drawing,
    frame: Area,
    kind: ClassifierKind,
    methods: &[DetailMethod],
    rows: &[&DetailRecognition],
) {
    drawing.bold_text(
        (frame.x, frame.y - 8.0),
        classifier_name(kind),
        TextStyle::new(13),
    );
    draw_axes(drawing, frame);
    let errors = rows.iter().map(|row| row.error_own_contact_median_mm);
    let scale = LogScale::over(errors, frame.x, frame.x + frame.width);
    draw_x_ticks(drawing, frame, scale, &scale.ticks());
    if let Some(exact) = rows.iter().find(|row| row.method == DetailMethod::Mesh) {
        let y = y_at(frame, exact.accuracy_on_mesh);
        drawing.line((frame.x, y), (frame.x + frame.width, y), dashes(1.2));
    }
    for (line, &method) in methods.iter().enumerate() {
        let mut of_method: Vec<_> = rows.iter().filter(|row| row.method == method).collect();
        of_method.sort_by(|a, b| {
            a.error_own_contact_median_mm
                .total_cmp(&b.error_own_contact_median_mm)
        });
        let x = |row: &DetailRecognition| scale.place(row.error_own_contact_median_mm);
        let at = |value: fn(&DetailRecognition) -> f64| -> Vec<Point> {
            let points = of_method
                .iter()
                .map(|row| (x(row), y_at(frame, value(row))));
            points.collect()
        };
        let on_itself = Stroke {
            dash: Some((2, 3)),
            width: 1.4,
            ..line_stroke(line)
        };
        drawing.polyline(&at(|row| row.accuracy_on_itself), on_itself);
        drawing.polyline(&at(|row| row.accuracy_on_mesh), line_stroke(line));
        for row in of_method {
            let ends =
                [row.accuracy_on_mesh_low, row.accuracy_on_mesh_high].map(|end| y_at(frame, end));
            let colour = line_colour(line);
            drawing.line(
                (x(row), ends[0]),
                (x(row), ends[1]),
                Stroke::new(colour, 1.5),
            );
            drawing.marker(
                line,
                (x(row), y_at(frame, row.accuracy_on_mesh)),
                MARKER_RADIUS,
                colour,
            );
        }
    }
}
