//! Laws of all formats of layout files. A layout that is written and read again is unchanged; a damaged file is refused by its name.

use crate::arrays::npz;
use crate::command::{Case, says};
use crate::layout_files::{ICUB, XELA, read, robot};
use bubbletouch::inputs::layout_file::{LayoutFile, LayoutFormat};
use bubbletouch::random::Seed;
use bubbletouch::world::{Grid, Layout};
use glam::DVec3;
use ndarray::{Array1, Array2, Array3};
use rand::Rng;

/// Formats, each with the extension of its files and whether the reader returns bitwise equal layouts.
const FORMATS: [(LayoutFormat, &str, bool); 7] = [
    (LayoutFormat::Csv, "csv", true),
    (LayoutFormat::Npz, "npz", true),
    (LayoutFormat::Dex01, "npz", true),
    (LayoutFormat::Icub, "txt", true),
    (LayoutFormat::Icub, "ini", true),
    (LayoutFormat::Paxini, "json", false),
    (LayoutFormat::Urdf, "urdf", false),
];

/// Returns a file of a layout alone.
fn file(layout: Layout) -> LayoutFile {
    LayoutFile {
        layout,
        radii: None,
        pixels: None,
        link: None,
        notes: Vec::new(),
    }
}

/// Returns layouts of several kinds: curved, random with radii and pixels, an image, and a single taxel.
fn layouts() -> [LayoutFile; 4] {
    let mut rng = Seed::new(4).named("layouts").rng();
    let mut vector = |size: f64| -> DVec3 {
        let mut random = || rng.gen_range(-size..size);
        DVec3::new(random(), random(), random())
    };
    let centers: Vec<DVec3> = (0..300).map(|_| vector(0.03)).collect();
    let axes: Vec<DVec3> = (0..300).map(|_| vector(1.0).normalize()).collect();
    let radii = (0..300).map(|taxel| 1e-3 + 1e-6 * f64::from(taxel));
    let pixels = (0..300).map(|taxel| [taxel % 20, 40 - taxel / 20]);
    let pitch = 1.7e-3;
    let grid = Grid {
        nx: 5,
        ny: 4,
        pitch,
    };
    [
        file(Layout::sphere_cap(9.3e-3, 2.6, pitch).unwrap()),
        LayoutFile {
            radii: Some(radii.collect()),
            pixels: Some(pixels.collect()),
            ..file(Layout::new(centers, axes).unwrap())
        },
        file(Layout::grid(&grid).unwrap()),
        file(Layout::new(vec![DVec3::ZERO], vec![DVec3::NEG_Z]).unwrap()),
    ]
}

/// Returns the largest distance between vectors of two layouts.
fn largest_distance(one: &[DVec3], other: &[DVec3]) -> f64 {
    assert_eq!(one.len(), other.len());
    let pairs = one.iter().zip(other);
    pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
}

#[test]
fn a_layout_that_is_written_is_read_as_the_same_layout() {
    let case = Case::new();
    for (number, original) in layouts().iter().enumerate() {
        for (format, ending, is_exact) in FORMATS {
            let path = case.path(&format!("skin.{ending}"));
            let notes = original.write(&path, Some(format)).unwrap();
            let again = read(&path).unwrap();
            let name = format!("{number} {format:?}: {notes:?}");
            assert!(again.notes.is_empty(), "{name} {:?}", again.notes);
            let (one, other) = (&original.layout, &again.layout);
            if is_exact {
                assert_eq!(one, other, "{name}");
            }
            assert!(
                largest_distance(one.centers(), other.centers()) < 1e-17,
                "{name}"
            );
            assert!(largest_distance(one.axes(), other.axes()) < 1e-15, "{name}");
            let (carries_radii, carries_pixels) = match format {
                LayoutFormat::Csv | LayoutFormat::Npz | LayoutFormat::Dex01 => (true, true),
                LayoutFormat::Urdf => (true, false),
                LayoutFormat::Icub | LayoutFormat::Paxini => (false, false),
            };
            let has_note = |word: &str| notes.iter().any(|note| note.contains(word));
            match (&original.radii, carries_radii) {
                (Some(radii), true) => assert_eq!(again.radii.as_ref(), Some(radii), "{name}"),
                (Some(_), false) => assert!(has_note("has no radii"), "{name}"),
                (None, _) => assert!(!has_note("radii"), "{name}"),
            }
            match (original.image(), carries_pixels) {
                (Some(image), true) => {
                    assert_eq!(again.pixels, Some(image), "{name}");
                    assert_eq!(one.sides(), other.sides(), "{name}");
                }
                (Some(_), false) => assert!(has_note("has no image"), "{name}"),
                (None, _) => assert_eq!(again.pixels, None, "{name}"),
            }
        }
    }
}

#[test]
fn a_file_is_written_in_the_format_of_its_name_only() {
    let case = Case::new();
    let [layout, ..] = layouts();
    let other = "another file; a layout in .csv";
    let urdf = "the format urdf; the format of this extension";
    let dex = "the format dex-01; the format of this extension";
    for (name, format, expected) in [
        ("a.step", None, other),
        ("a", Some(LayoutFormat::Csv), other),
        ("a.csv", Some(LayoutFormat::Urdf), urdf),
        ("a.json", Some(LayoutFormat::Dex01), dex),
        ("b/a.csv", None, "there is no folder"),
    ] {
        let error = layout.write(&case.path(name), format).unwrap_err();
        says(&error.to_string(), &[expected]);
        assert_eq!((error.exit_code(), case.path(name).exists()), (2, false));
    }
}

#[test]
fn files_that_are_cut_anywhere_never_panic_and_name_the_file() {
    let case = Case::new();
    let layout = file(Layout::new(vec![DVec3::ZERO, 2e-3 * DVec3::X], vec![DVec3::Z; 2]).unwrap());
    let array = robot("<array rows='2' cols='2' size='0.003 0.003'/>");
    let mut files = vec![
        ("icub.txt", ICUB.into()),
        ("uskin.urdf", XELA.into()),
        ("array.urdf", array.into_bytes()),
    ];
    let names = [
        "a.csv", "a.npz", "dex.npz", "a.txt", "a.ini", "a.json", "a.urdf",
    ];
    for (name, (format, ..)) in names.into_iter().zip(FORMATS) {
        layout.write(&case.path(name), Some(format)).unwrap();
        files.push((name, case.bytes(name)));
    }
    for (name, whole) in files {
        for length in 0..whole.len() {
            // A text that is cut between two rows may be a valid, shorter file.
            if let Err(error) = read(&case.file(name, &whole[..length])) {
                let message = error.to_string();
                assert!(message.contains(name), "{name}, {length} bytes: {message}");
                assert_eq!(error.exit_code(), 2, "{name}, {length} bytes: {message}");
            }
        }
    }
}

#[test]
fn each_fault_of_an_archive_is_refused_with_its_row() {
    let case = Case::new();
    let (unit, nan) = ([0.0, 0.0, 1.0], f64::NAN);
    let positions = |x: f64| [[0.0, 0.0, 1e-3], [x, 0.0, 1e-3], [4e-3, 0.0, 1e-3]].concat();
    let own = |x: f64, normals: &[[f64; 3]]| {
        npz(|npz| {
            let rows = |rows: Vec<f64>| Array2::from_shape_vec((rows.len() / 3, 3), rows).unwrap();
            npz.add_array("positions", &rows(positions(x))).unwrap();
            npz.add_array("normals", &rows(normals.concat())).unwrap();
        })
    };
    // Rows of the pose of the second taxel; the others are at rest.
    let pose = |x: f64, last: f64, place: f64| {
        [
            [x, 0.0, 0.0, place],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, last, 0.0],
        ]
    };
    let dex = |second: [[f64; 4]; 3], pixels: &[[i64; 2]]| {
        let rest = pose(1.0, 1.0, 0.0);
        let poses = [rest, second, rest].concat().concat();
        let poses = Array3::from_shape_vec((3, 3, 4), poses).unwrap();
        let pixels = Array2::from(pixels.to_vec());
        npz(|npz| {
            npz.add_array("poses", &poses).unwrap();
            npz.add_array("taxel2pixel", &pixels).unwrap();
            npz.add_array("radii", &Array1::from_elem(3, 1e-3)).unwrap();
        })
    };
    let (zero, at_zero) = ([unit, [0.0; 3], unit], [[0, 0]; 3]);
    let array = |name: &str, shape: (usize, usize)| {
        npz(|npz| npz.add_array(name, &Array2::<f64>::ones(shape)).unwrap())
    };
    let not_finite = "row 2: a number that is not finite";
    let normals = "normals: an array of shape [2, 3]; 3 × 3";
    let pixels = "taxel2pixel: an array of shape [2, 2]; 3 × 2";
    let negative = "taxel2pixel, row 2: -1; integers from 0";
    let missing = "no array normals (the arrays positions); positions and normals, or poses";
    let flat = "poses, row 2: a matrix that is no rotation";
    let mirrored = "poses, row 2: a left-handed frame";
    for (bytes, expected) in [
        (own(2e-3, &[unit; 2]), normals),
        (own(nan, &[unit; 3]), not_finite),
        (own(2e-3, &zero), "row 2: normal [0, 0, 0] of length 0"),
        (dex(pose(1.0, 1.0, 2e-3), &[[0, 0]; 2]), pixels),
        (
            dex(pose(1.0, 1.0, 2e-3), &[[0, 0], [0, -1], [0, 0]]),
            negative,
        ),
        (dex(pose(1.0, 1.0, nan), &at_zero), not_finite),
        (dex(pose(1.0, 0.0, 2e-3), &at_zero), flat),
        (dex(pose(-1.0, 1.0, 2e-3), &at_zero), mirrored),
        (array("other", (3, 1)), "positions and normals, or poses"),
        (array("positions", (2, 3)), missing),
    ] {
        let error = read(&case.file("skin.npz", bytes)).unwrap_err();
        says(&error.to_string(), &["skin.npz", expected]);
        assert_eq!(error.exit_code(), 2);
    }
    for bytes in [own(2e-3, &[unit; 3]), dex(pose(1.0, 1.0, 2e-3), &at_zero)] {
        let file = read(&case.file("skin.npz", bytes)).unwrap();
        assert_eq!(file.layout.n_taxels(), 3);
    }
}

#[test]
fn every_changed_byte_of_an_archives_numbers_is_refused() {
    let case = Case::new();
    let path = case.path("skin.npz");
    layouts()[2].write(&path, None).unwrap();
    let whole = case.bytes("skin.npz");
    let original = read(&path).unwrap();
    for changed in (0..whole.len()).step_by(5) {
        let mut bytes = whole.clone();
        bytes[changed] ^= 0x55;
        case.file("skin.npz", &bytes);
        if let Ok(again) = read(&path) {
            assert_eq!(again.layout, original.layout, "byte {changed}");
        }
    }
}
