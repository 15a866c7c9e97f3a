//! Pictures: every cell is drawn, every frame is readable, names are only names.

use crate::report_synthetic::{cell, many_cells, noise_cells, press, quickstart_cells, tables};
use bubbletouch::report::confusion_picture::{ConfusionMatrix, confusion_picture};
use bubbletouch::report::drawing::Drawing;
use bubbletouch::report::frame_files::{frame_csv, write_frame};
use bubbletouch::report::pressure_map::{pressure_picture, pressure_text};
use bubbletouch::report::results::draw_charts;
use bubbletouch::report::snapshots::snapshots;
use bubbletouch::report::terminal::Ink;
use bubbletouch::signal::Quantity;
use bubbletouch::study::table::Tables;
use bubbletouch::world::Grid;
use ndarray::{Array1, Array2, array};
use std::fs;

fn pixels(bytes: &[u8]) -> (u32, u32, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut data).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgb);
    (info.width, info.height, data.as_chunks().0.to_vec())
}

/// Markers of the lines lie on a white rim of their own: a circle of radius 5.2, or a path.
fn count(svg: &str, what: &str) -> usize {
    svg.matches(what).count()
}

#[test]
fn every_cell_is_a_marker_in_exactly_one_of_the_main_charts() {
    for (cells, n_exchanged) in [
        (quickstart_cells(), 1),
        (noise_cells(), 1),
        (many_cells(), 0),
        (vec![cell()], 0),
    ] {
        let n_cells = cells.len();
        let made = tables(cells, 2, 4);
        let charts = draw_charts(&made);
        let mut markers = 0;
        for (name, title, drawing) in &charts {
            if name.contains("_per_") {
                continue;
            }
            let svg = drawing.svg(title);
            let rims = count(&svg, r##"" r="5.2" fill="#ffffff""##)
                + count(
                    &svg,
                    r##"Z" stroke="none" stroke-width="0" fill="#ffffff""##,
                );
            // The legend draws each line's marker once.
            let legend = made_lines(&svg);
            markers += rims - legend;
        }
        assert_eq!(markers, n_cells);
        assert_eq!(
            charts
                .iter()
                .filter(|(name, ..)| name.contains("_per_"))
                .count(),
            n_exchanged
        );
    }
}

/// Lines of the legend: drawn 28 pixels long with the lines' width.
fn made_lines(svg: &str) -> usize {
    let lines = svg
        .match_indices("<line ")
        .map(|(at, _)| &svg[at..at + svg[at..].find("/>").unwrap()]);
    lines
        .filter(|line| line.contains(r#"stroke-width="2""#))
        .count()
}

#[test]
fn a_chart_has_its_ticks_at_the_ratios_of_the_study() {
    let charts = draw_charts(&tables(quickstart_cells(), 1, 24));
    let (name, title, drawing) = &charts[0];
    assert_eq!(name, "accuracy_by_ratio");
    assert_eq!(
        title,
        "Accuracy by compression, for each pitch and array size"
    );
    let svg = drawing.svg(title);
    for text in [
        "4:1",
        "16:1",
        "64:1",
        "256:1",
        "2 mm",
        "4 mm",
        "array size 128 mm",
        "chance (1 in 24)",
    ] {
        assert!(svg.contains(&format!(">{text}<")), "{text}");
    }
    assert!(svg.starts_with("<svg ") && svg.contains(r#"viewBox="0 0 "#));
}

#[test]
fn pictures_are_png_files_with_two_elements_a_pixel() {
    let made = tables(quickstart_cells(), 1, 43);
    let (_, _, chart) = draw_charts(&made).swap_remove(0);
    let matrix = confusion_picture(&made, 0).unwrap();
    let map = pressure_picture(&press(64, 64, 0, 0.0), 2.0, Quantity::Force).unwrap();
    for drawing in [chart, matrix, map] {
        let (width, height, elements) = pixels(&drawing.png().unwrap());
        assert_eq!(
            (f64::from(width), f64::from(height)),
            (2.0 * drawing.width(), 2.0 * drawing.height())
        );
        let inked = elements
            .iter()
            .filter(|element| **element != [255; 3])
            .count();
        assert!(inked * 50 > elements.len(), "{inked} of {}", elements.len());
    }
}

#[test]
fn a_confusion_matrix_holds_every_test_row() {
    let made = tables(quickstart_cells(), 3, 24);
    let matrix = ConfusionMatrix::of(&made.confusion, 5);
    assert_eq!(matrix.names.len(), 24);
    assert_eq!(matrix.counts.sum(), 3 * 25 * 24);
    for row in 0..24 {
        let shares: f64 = (0..24).map(|column| matrix.share(row, column)).sum();
        assert!((shares - 1.0).abs() < 1e-12);
    }
    assert!(confusion_picture(&made, 99).is_none());
    assert!(confusion_picture(&Tables::default(), 0).is_none());
}

#[test]
fn a_name_is_drawn_letter_by_letter_whatever_it_holds() {
    let name = "<i>&\"$x^2$\u{1}";
    let frames = [(name.to_owned(), press(8, 8, 0, 0.0))];
    let svg = snapshots(&frames, 2.0, Quantity::Deflection, name)
        .unwrap()
        .svg(name);
    assert!(svg.contains("&lt;i&gt;&amp;&quot;$x^2$ <"), "{svg}");
    assert!(!svg.contains("<i>") && !svg.contains('\u{1}'));
    let mut empty = Drawing::new(10.0, 10.0);
    empty.text(
        (1.0, 9.0),
        "$\\alpha$",
        bubbletouch::report::drawing::TextStyle::new(9),
    );
    assert!(empty.svg("").contains("$\\alpha$"));
}

#[test]
fn snapshots_refuse_what_cannot_be_shown() {
    assert!(snapshots(&[], 2.0, Quantity::Deflection, "").is_err());
    let broken = [("a".to_owned(), array![[f64::INFINITY]])];
    assert!(snapshots(&broken, 2.0, Quantity::Deflection, "").is_err());
}

#[test]
fn a_pressure_map_in_plain_letters() {
    let frame = Array2::from_shape_fn((6, 12), |(row, column)| {
        let (x, y) = (column as f64 - 7.0, row as f64 - 3.5);
        (0.004 - 0.0004 * (x * x + 2.0 * y * y)).max(0.0)
    });
    let drawn = pressure_text(&frame, 2.0, Quantity::Deflection, Ink::Plain, 80).unwrap();
    let expected = "\
+------------------------+
|          ..==++==..    |
|        ..++%%@@%%++..  |
|        ..++%%@@%%++..  |
|          ..==++==..    |
|                        |
|                        |
+------------------------+
";
    assert!(drawn.starts_with(expected), "{drawn}");
    assert!(
        drawn.contains(
            "12 × 6 taxels, pitch 2 mm; peak deflection 3.8 mm at x 3 mm, y 1 mm; 24 of 72"
        ),
        "{drawn}"
    );
}

#[test]
fn a_drawing_in_the_terminal_keeps_to_its_width_and_shows_the_peak() {
    for (nx, ny) in [
        (1, 1),
        (39, 5),
        (40, 5),
        (64, 64),
        (79, 3),
        (500, 20),
        (3, 200),
    ] {
        let mut frame = Array2::zeros((ny, nx));
        frame[(ny - 1, nx - 1)] = 0.003;
        let plain = pressure_text(&frame, 1.0, Quantity::Deflection, Ink::Plain, 80).unwrap();
        let picture: Vec<&str> = plain
            .lines()
            .filter(|line| line.starts_with(['|', '+']))
            .collect();
        assert!(
            picture.iter().all(|line| line.chars().count() <= 80),
            "{plain}"
        );
        assert!(picture[1].trim_end_matches('|').ends_with('@'), "{plain}");
        assert!(plain.contains("peak deflection 3 mm"));
        assert_eq!(plain.contains("largest of"), nx > 78);
        assert!(!plain.contains('\u{1b}'));
        let coloured =
            pressure_text(&frame, 1.0, Quantity::Deflection, Ink::TrueColour, 80).unwrap();
        assert!(coloured.contains("\u{1b}[38;2;") && coloured.contains('▀'));
    }
    let nothing =
        pressure_text(&Array2::zeros((4, 4)), 1.0, Quantity::Force, Ink::Plain, 80).unwrap();
    assert!(nothing.contains("no taxel is touched"));
}

#[test]
fn a_frame_file_holds_the_same_bits() {
    let dir = tempfile::tempdir().unwrap();
    let grid = Grid {
        nx: 5,
        ny: 3,
        pitch: 0.002,
    };
    let frame = Array2::from_shape_fn((3, 5), |(row, column)| {
        (row as f64 + 0.1) / (column as f64 + 3.0) * 1e-3
    });
    let csv = dir.path().join("frame.CSV");
    write_frame(&csv, &frame, &grid).unwrap();
    let text = fs::read_to_string(&csv).unwrap();
    assert_eq!(text, frame_csv(&frame));
    assert!(text.starts_with("3.3333333333333335e-5,"), "{text}");
    let read: Vec<f64> = text
        .split([',', '\n'])
        .filter(|t| !t.is_empty())
        .map(|t| t.parse().unwrap())
        .collect();
    assert_eq!(Array2::from_shape_vec((3, 5), read).unwrap(), frame);

    let npz = dir.path().join("frame.npz");
    write_frame(&npz, &frame, &grid).unwrap();
    let mut archive = ndarray_npy::NpzReader::new(fs::File::open(&npz).unwrap()).unwrap();
    let deflection: Array2<f64> = archive.by_name("deflection").unwrap();
    let (x, y): (Array1<f64>, Array1<f64>) =
        (archive.by_name("x").unwrap(), archive.by_name("y").unwrap());
    assert_eq!(deflection, frame);
    assert_eq!(x, array![-0.004, -0.002, 0.0, 0.002, 0.004]);
    assert_eq!(y, array![-0.002, 0.0, 0.002]);
    let first = fs::read(&npz).unwrap();
    write_frame(&npz, &frame, &grid).unwrap();
    assert_eq!(fs::read(&npz).unwrap(), first);

    let png = dir.path().join("frame.png");
    write_frame(&png, &frame, &grid).unwrap();
    assert!(pixels(&fs::read(&png).unwrap()).0 > 400);
}

#[test]
fn a_frame_file_of_another_kind_is_refused_before_anything_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let grid = Grid {
        nx: 2,
        ny: 1,
        pitch: 0.002,
    };
    for name in ["frame.jpg", "frame", "csv"] {
        let path = dir.path().join(name);
        let said = write_frame(&path, &array![[0.0, 0.0]], &grid).unwrap_err();
        assert_eq!(said.exit_code(), 2);
        assert!(
            said.to_string()
                .ends_with("a name that ends in .csv, .npz or .png"),
            "{said}"
        );
    }
    assert!(write_frame(&dir.path().join("a.png"), &array![[0.0, f64::NAN]], &grid).is_err());
    assert!(write_frame(&dir.path().join("a.csv"), &array![[0.0], [0.0]], &grid).is_err());
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn between_words_nothing_is_drawn_and_many_lines_have_whiskers() {
    let ensembles = many_cells().into_iter().filter(|cell| {
        cell.pitch_mm == 2.0 && cell.size_mm == 64.0 && cell.noise_std == 0.0 && cell.ratio == 4.0
    });
    let charts = draw_charts(&tables(ensembles.collect(), 1, 4));
    assert_eq!(charts[0].0, "accuracy_by_ensemble");
    let svg = charts[0].2.svg("");
    assert_eq!(count(&svg, r#"stroke-width="1.5""#), 5 + 1);
    assert_eq!(count(&svg, r#"fill="none""#), 0);
    assert!(!svg.contains("fill-opacity"));
    // Five lines over ratios: five polylines, a whisker a point, one in the legend.
    let over_ratios = many_cells()
        .into_iter()
        .filter(|cell| cell.pitch_mm == 2.0 && cell.size_mm == 64.0 && cell.noise_std == 0.0);
    let svg = draw_charts(&tables(over_ratios.collect(), 1, 4))[0]
        .2
        .svg("");
    assert_eq!(count(&svg, r#"stroke-width="1.5""#), 25 + 1);
    assert_eq!(count(&svg, r#"fill="none""#), 5);
}
