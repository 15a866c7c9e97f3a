//! Pictures: every configuration is drawn, every frame is readable, and names are only text.

use crate::command::says;
use crate::report_synthetic::{configuration, many_cells, noise_cells, quickstart_cells, tables};
use bubbletouch::report::chart::{draw, places};
use bubbletouch::report::colours::heat;
use bubbletouch::report::drawing::{Drawing, TextStyle};
use bubbletouch::report::frame_files::{frame_csv, write_frame};
use bubbletouch::report::pressure_map::pressure_text;
use bubbletouch::report::snapshots::snapshots;
use bubbletouch::report::terminal::Ink;
use bubbletouch::signal::Quantity;
use bubbletouch::studies::recognition::charts::{charts, tables_of};
use bubbletouch::study::Snapshots;
use bubbletouch::study::table::{Configuration, Tables};
use bubbletouch::table::{ChartSpec, Table};
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

/// Returns the charts of accuracy except those that exchange lines and panels.
fn main_charts(made: &[Table]) -> Vec<ChartSpec> {
    let mut specs = charts(made, Some(false));
    specs.retain(|spec| spec.y == "accuracy" && !spec.name.contains("_per_"));
    specs
}

#[test]
fn every_cell_is_a_point_in_exactly_one_of_the_main_charts() {
    for (configurations, n_charts) in [
        (quickstart_cells(), 1),
        (noise_cells(), 1),
        (many_cells(), 4),
        (vec![configuration()], 1),
    ] {
        let n_configurations = configurations.len();
        let made = tables_of(&tables(configurations, 2, 4)).unwrap();
        let specs = main_charts(&made);
        assert_eq!(specs.len(), n_charts);
        let mut rows: Vec<usize> = Vec::new();
        for spec in &specs {
            rows.extend(places(spec, &made).unwrap().iter().map(|place| place.row));
        }
        rows.sort_unstable();
        assert_eq!(rows, (0..n_configurations).collect::<Vec<_>>());
    }
}

#[test]
fn a_chart_has_its_ticks_at_the_ratios_of_the_study() {
    let made = tables_of(&tables(quickstart_cells(), 1, 24)).unwrap();
    let spec = charts(&made, None).swap_remove(0);
    assert_eq!(spec.name, "accuracy_by_ratio");
    assert_eq!(spec.title, "Accuracy by compression");
    let svg = draw(&spec, &made).unwrap().svg(&spec.title);
    let ticks = ["4:1", "16:1", "64:1", "256:1", "2 mm", "4 mm"];
    says(&svg, &ticks.map(|tick| format!(">{tick}<")));
    says(&svg, &[">array size 128 mm<", ">chance (1 in 24)<"]);
    assert!(svg.starts_with("<svg ") && svg.contains(r#"viewBox="0 0 "#));
}

#[test]
fn pictures_are_png_files_with_two_elements_a_pixel() {
    let made = tables_of(&tables(quickstart_cells(), 1, 43)).unwrap();
    let specs = charts(&made, None);
    let of =
        |name: &str| draw(specs.iter().find(|spec| spec.name == name).unwrap(), &made).unwrap();
    let (chart, matrix) = (of("accuracy_by_ratio"), of("confusion"));
    for drawing in [chart, matrix] {
        let (width, height, elements) = pixels(&drawing.png().unwrap());
        assert_eq!(f64::from(width), 2.0 * drawing.width);
        assert_eq!(f64::from(height), 2.0 * drawing.height);
        let inked = elements.iter().filter(|element| **element != [255; 3]);
        let (inked, n) = (inked.count(), elements.len());
        assert!(inked * 50 > n, "{inked} of {n}");
    }
}

#[test]
fn a_confusion_matrix_holds_every_count_of_the_best_cell() {
    let typed = tables(quickstart_cells(), 3, 24);
    let made = tables_of(&typed).unwrap();
    let mut specs = charts(&made, None).into_iter();
    let spec = specs.find(|spec| spec.name == "confusion").unwrap();
    let summary = typed.summary.iter();
    let best = summary.max_by(|a, b| a.1.accuracy.total_cmp(&b.1.accuracy));
    let best = best.unwrap().0.configuration;
    let mut rows: Vec<usize> = (0..typed.confusion.len()).collect();
    rows.retain(|&row| typed.confusion[row].configuration == best);
    let places = places(&spec, &made).unwrap();
    let mut shown: Vec<usize> = places.iter().map(|place| place.row).collect();
    shown.sort_unstable();
    assert_eq!(shown, rows);
    assert!(charts(&tables_of(&Tables::default()).unwrap(), None).is_empty());
}

#[test]
fn a_name_is_drawn_letter_by_letter_whatever_it_holds() {
    let name = "<i>&\"$x^2$\u{1}";
    let mut drawing = Drawing::new(10.0, 10.0);
    for text in [name, "$\\alpha$"] {
        drawing.text((1.0, 9.0), text, TextStyle::new(9));
        drawing.bold_text((1.0, 9.0), text, TextStyle::new(9));
    }
    let svg = drawing.svg(name);
    for escaped in ["&lt;i&gt;&amp;&quot;$x^2$ <", "$\\alpha$"] {
        assert_eq!(svg.matches(escaped).count(), 2, "{svg}");
    }
    assert!(!svg.contains("<i>") && !svg.contains('\u{1}'));
}

fn set_of(frames: Vec<(String, Array2<f64>)>) -> Snapshots {
    Snapshots {
        frames,
        pitch_mm: 2.0,
        quantity: Quantity::Deflection,
        caption: "a caption".to_owned(),
    }
}

#[test]
fn snapshots_show_every_frame_on_one_scale() {
    let touched = |n: usize| {
        let middle = |(row, column)| if row == 4 && column == 4 { 1e-3 } else { 0.0 };
        (1.0 + n as f64) * Array2::from_shape_fn((8, 8), middle)
    };
    let frames: Vec<_> = (0..5)
        .map(|n| (format!("object {n}"), touched(n)))
        .collect();
    let picture = snapshots(&set_of(frames)).unwrap();
    // Nothing touches the border of a frame (8 taxels of 24 pixels); rows of the picture cross four maps or one.
    let bare = heat(0.0);
    let is_bare = |pixel: &[u8]| pixel == bare;
    let n_maps = |row: &[u8]| {
        let pixels: Vec<bool> = row.chunks(3).map(is_bare).collect();
        let runs = pixels.chunk_by(|a, b| a == b);
        runs.filter(|run| run[0] && run.len() == 8 * 24 * 2).count()
    };
    let rows: Vec<usize> = picture.rgb.chunks(3 * picture.width).map(n_maps).collect();
    let crossed: Vec<usize> = rows.chunk_by(|a, b| a == b).map(|run| run[0]).collect();
    let maps: Vec<usize> = crossed.into_iter().filter(|&n| n > 0).collect();
    assert_eq!(maps, [4, 4, 1, 1], "above and below what is touched");
}

#[test]
fn snapshots_refuse_what_cannot_be_shown() {
    assert!(snapshots(&set_of(Vec::new())).is_err());
    let broken = vec![("a".to_owned(), array![[f64::INFINITY]])];
    assert!(snapshots(&set_of(broken)).is_err());
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
    let peak = "12 × 6 taxels, pitch 2 mm; peak deflection 3.8 mm at x 3 mm, y 1 mm; 24 of 72";
    says(&drawn, &[peak]);
}

#[test]
fn a_drawing_in_the_terminal_keeps_to_its_width_and_shows_the_peak() {
    let deflections = |frame: &Array2<f64>, ink| {
        pressure_text(frame, 1.0, Quantity::Deflection, ink, 80).unwrap()
    };
    let sizes = [
        [1, 1],
        [5, 39],
        [5, 40],
        [64, 64],
        [3, 79],
        [20, 500],
        [200, 3],
    ];
    for [ny, nx] in sizes {
        let mut frame = Array2::zeros((ny, nx));
        frame[(ny - 1, nx - 1)] = 0.003;
        let plain = deflections(&frame, Ink::Plain);
        let picture = plain.lines().filter(|line| line.starts_with(['|', '+']));
        let picture: Vec<&str> = picture.collect();
        assert!(
            picture.iter().all(|line| line.chars().count() <= 80),
            "{plain}"
        );
        assert!(picture[1].trim_end_matches('|').ends_with('@'), "{plain}");
        assert!(plain.contains("peak deflection 3 mm"));
        assert_eq!(plain.contains("largest of"), nx > 78);
        assert!(!plain.contains('\u{1b}'));
        let coloured = deflections(&frame, Ink::TrueColour);
        assert!(coloured.contains("\u{1b}[38;2;") && coloured.contains('▀'));
    }
    let none = Array2::zeros((4, 4));
    let nothing = pressure_text(&none, 1.0, Quantity::Force, Ink::Plain, 80);
    assert!(nothing.unwrap().contains("no taxel is touched"));
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
    let numbers = text.trim_end().split([',', '\n']);
    let read: Vec<f64> = numbers.map(|number| number.parse().unwrap()).collect();
    assert_eq!(Array2::from_shape_vec((3, 5), read).unwrap(), frame);

    let npz = dir.path().join("frame.npz");
    write_frame(&npz, &frame, &grid).unwrap();
    let mut archive = ndarray_npy::NpzReader::new(fs::File::open(&npz).unwrap()).unwrap();
    let deflection: Array2<f64> = archive.by_name("deflection").unwrap();
    let [x, y]: [Array1<f64>; 2] = ["x", "y"].map(|name| archive.by_name(name).unwrap());
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
    let refused = |name: &str, frame| {
        let error = write_frame(&dir.path().join(name), &frame, &grid).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    };
    for name in ["frame.jpg", "frame", "csv"] {
        let said = refused(name, array![[0.0, 0.0]]);
        let ending = "a name that ends in .csv, .npz or .png";
        assert!(said.ends_with(ending), "{said}");
    }
    refused("a.png", array![[0.0, f64::NAN]]);
    refused("a.csv", array![[0.0], [0.0]]);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn between_words_nothing_is_drawn_and_many_lines_have_whiskers() {
    let mut over_ratios = many_cells();
    over_ratios.retain(|one| [one.pitch_mm, one.size_mm, one.noise_std] == [2.0, 64.0, 0.0]);
    let mut ensembles = over_ratios.clone();
    ensembles.retain(|one| one.ratio == 4.0);
    let count = |svg: &str, what: &str| svg.matches(what).count();
    let first = |configurations: Vec<Configuration>| {
        let made = tables_of(&tables(configurations, 1, 4)).unwrap();
        let spec = charts(&made, None).swap_remove(0);
        let svg = draw(&spec, &made).unwrap().svg("");
        (spec.name, svg)
    };
    let (name, svg) = first(ensembles);
    assert_eq!(name, "accuracy_by_ensemble");
    assert_eq!(count(&svg, r#"stroke-width="1.5""#), 5 + 1);
    assert!(!svg.contains("fill-opacity"));
    // Five lines over ratios: five polylines, one error bar per point, and one in the legend.
    let (_, svg) = first(over_ratios);
    assert_eq!(count(&svg, r#"stroke-width="1.5""#), 25 + 1);
}
