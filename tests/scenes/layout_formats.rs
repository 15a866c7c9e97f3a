//! Laws of all formats of layout files. A layout that is written and read again is unchanged. The error for a damaged file contains the row.

use crate::command::says;
use bubbletouch::inputs::layout_file::{LayoutFile, LayoutFormat, LayoutOptions};
use bubbletouch::mesh::TriangleMesh;
use bubbletouch::random::Seed;
use bubbletouch::scene::ScenePlan;
use bubbletouch::world::Layout;
use glam::DVec3;
use ndarray::{Array1, Array2, Array3};
use ndarray_npy::NpzWriter;
use rand::Rng;
use std::fs::{self, File};
use std::path::Path;

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

fn read(path: &Path) -> bubbletouch::Result<LayoutFile> {
    LayoutFile::read(path, LayoutOptions::default())
}

/// Returns layouts of several kinds: curved, random with radii and pixels, an image, and a single taxel.
fn layouts() -> Vec<LayoutFile> {
    let mut rng = Seed::new(4).named("layouts").rng();
    let file = |layout: Layout| LayoutFile {
        layout,
        radii: None,
        pixels: None,
        link: None,
        notes: Vec::new(),
    };
    let mut vector = |size: f64| -> DVec3 {
        let mut random = || rng.gen_range(-size..size);
        DVec3::new(random(), random(), random())
    };
    let centers: Vec<DVec3> = (0..300).map(|_| vector(0.03)).collect();
    let axes: Vec<DVec3> = (0..300).map(|_| vector(1.0).normalize()).collect();
    let random = Layout::new(centers, axes).unwrap();
    let pitch = 1.7e-3;
    let grid = bubbletouch::world::Grid {
        nx: 5,
        ny: 4,
        pitch,
    };
    vec![
        file(Layout::sphere_cap(9.3e-3, 2.6, pitch).unwrap()),
        LayoutFile {
            radii: Some(
                (0..300)
                    .map(|taxel| 1e-3 + 1e-6 * f64::from(taxel))
                    .collect(),
            ),
            pixels: Some(
                (0..300)
                    .map(|taxel| [taxel % 20, 40 - taxel / 20])
                    .collect(),
            ),
            ..file(random)
        },
        file(Layout::grid(&grid).unwrap()),
        file(Layout::new(vec![DVec3::ZERO], vec![DVec3::NEG_Z]).unwrap()),
    ]
}

#[test]
fn a_layout_that_is_written_is_read_as_the_same_layout() {
    let folder = tempfile::tempdir().unwrap();
    for (number, original) in layouts().iter().enumerate() {
        for (format, ending, is_exact) in FORMATS {
            let path = folder.path().join(format!("skin.{ending}"));
            let notes = original.write(&path, Some(format)).unwrap();
            let again = read(&path).unwrap();
            let name = format!("{number} {format:?}: {notes:?}");
            assert!(again.notes.is_empty(), "{name} {:?}", again.notes);
            match is_exact {
                true => assert_eq!(again.layout, original.layout, "{name}"),
                false => {
                    let pairs = |of: fn(&Layout) -> &[DVec3]| {
                        let (one, other) = (of(&original.layout), of(&again.layout));
                        assert_eq!(one.len(), other.len(), "{name}");
                        let both = one.iter().zip(other);
                        both.map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
                    };
                    assert!(pairs(Layout::centers) < 1e-17, "{name}");
                    assert!(pairs(Layout::axes) < 1e-15, "{name}");
                }
            }
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
                    assert_eq!(again.layout.sides(), original.layout.sides(), "{name}");
                }
                (Some(_), false) => assert!(has_note("has no image"), "{name}"),
                (None, _) => assert_eq!(again.pixels, None, "{name}"),
            }
            // Writing and reading again changes no bit.
            let twice = folder.path().join(format!("twice.{ending}"));
            again.write(&twice, Some(format)).unwrap();
            let twice = read(&twice).unwrap();
            if is_exact {
                assert_eq!(twice.layout, again.layout, "{name}");
            }
        }
    }
}

#[test]
fn a_file_is_written_in_the_format_of_its_name_only() {
    let folder = tempfile::tempdir().unwrap();
    let layout = &layouts()[0];
    for (name, format, expected) in [
        ("a.step", None, "another file; a layout in .csv"),
        (
            "a",
            Some(LayoutFormat::Csv),
            "another file; a layout in .csv",
        ),
        (
            "a.csv",
            Some(LayoutFormat::Urdf),
            "the format urdf; the format of this extension",
        ),
        (
            "a.json",
            Some(LayoutFormat::Dex01),
            "the format dex-01; the format of this extension",
        ),
        ("b/a.csv", None, "there is no folder"),
    ] {
        let path = folder.path().join(name);
        let error = layout.write(&path, format).unwrap_err();
        assert!(error.to_string().contains(expected), "{name}: {error}");
        assert_eq!((error.exit_code(), path.exists()), (2, false));
    }
    let error = "obj".parse::<LayoutFormat>().unwrap_err().to_string();
    let expected = "layout format: `obj`; csv, npz, dex-01, icub, paxini, urdf";
    assert_eq!(error, expected);
}

/// Taxels of a valid file: three on a plane, with unit frames.
const N: usize = 3;

/// Kind of damage to a layout file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Damage {
    Truncated,
    WrongCounts,
    NotANumber,
    ZeroNormal,
    LeftHanded,
}

/// Numbers of three taxels: centres in metres and rotations by columns.
struct Numbers {
    centers: [[f64; 3]; N],
    frames: [[f64; 9]; N],
}

fn numbers(damage: Option<Damage>) -> Numbers {
    let unit = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let mut numbers = Numbers {
        centers: [[0.0, 0.0, 1e-3], [2e-3, 0.0, 1e-3], [4e-3, 0.0, 1e-3]],
        frames: [unit; N],
    };
    match damage {
        Some(Damage::NotANumber) => numbers.centers[1][0] = f64::NAN,
        Some(Damage::ZeroNormal) => numbers.frames[1][6..].fill(0.0),
        Some(Damage::LeftHanded) => numbers.frames[1][0] = -1.0,
        _ => {}
    }
    numbers
}

fn spaced(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    words.join(" ")
}

fn csv(damage: Option<Damage>) -> Vec<u8> {
    let Numbers { centers, frames } = numbers(damage);
    let mut text = "x_mm,y_mm,z_mm,nx,ny,nz\n".to_owned();
    for (center, frame) in centers.iter().zip(&frames) {
        let row = [&center.map(|m| 1e3 * m)[..], &frame[6..]].concat();
        text += &(spaced(&row).replace(' ', ",") + "\n");
    }
    if damage == Some(Damage::WrongCounts) {
        text = text.replacen("2,0,1,0,0,1", "2,0,1,0,0,1,7", 1);
    }
    text.into_bytes()
}

fn icub(damage: Option<Damage>) -> Vec<u8> {
    let Numbers { centers, frames } = numbers(damage);
    let mut text = "name palm\ntaxel2Repr ( 0 1 2 )\n[calibration]\n".to_owned();
    for (center, frame) in centers.iter().zip(&frames) {
        text += &(spaced(&[&center[..], &frame[6..]].concat()) + "\n");
    }
    if damage == Some(Damage::WrongCounts) {
        text = text.replacen("0.002 0", "0.002 0 0", 1);
    }
    text.into_bytes()
}

fn paxini(damage: Option<Damage>) -> Vec<u8> {
    let Numbers { centers, frames } = numbers(damage);
    let rows = |rows: Vec<String>| rows.join(", ");
    let row = |numbers: &[f64]| format!("[{}]", spaced(numbers).replace(' ', ", "));
    let points = rows(centers.iter().map(|m| row(&m.map(|m| 1e3 * m))).collect());
    let mut frames: Vec<String> = frames.iter().map(|frame| row(frame)).collect();
    if damage == Some(Damage::WrongCounts) {
        frames.pop();
    }
    let frames = rows(frames);
    format!("{{\"units\": \"mm\", \"taxels_mm\": [{points}], \"rotation\": [{frames}]}}").into()
}

fn urdf(damage: Option<Damage>) -> Vec<u8> {
    let taxels = match damage {
        Some(Damage::NotANumber) => {
            "<taxel idx='0' xyz='0 0 0' rpy='0 0 0'/>\n<taxel idx='1' xyz='nan 0 0' rpy='0 0 0'/>"
        }
        Some(Damage::WrongCounts) => {
            "<taxel idx='0' xyz='0 0 0' rpy='0 0 0'/>\n<taxel idx='1' xyz='0 0' rpy='0 0 0'/>"
        }
        _ => {
            "<taxel idx='0' xyz='0 0 0' rpy='0 0 0'/>\n<taxel idx='1' xyz='0.002 0 0' rpy='0 0 0'/>"
        }
    };
    format!("<robot name='r'><link name='l'/><sensor name='s'><parent link='l'/><tactile>\n{taxels}\n</tactile></sensor></robot>").into()
}

fn array(damage: Option<Damage>) -> Vec<u8> {
    let (rows, size) = match damage {
        Some(Damage::NotANumber) => ("2", "nan 0.003"),
        Some(Damage::WrongCounts) => ("2.5", "0.003 0.003"),
        _ => ("2", "0.003 0.003"),
    };
    format!("<robot name='r'><link name='l'/><sensor name='s'><parent link='l'/><tactile>\n<array rows='{rows}' cols='2' size='{size}'/>\n</tactile></sensor></robot>").into()
}

/// Returns a file with three prismatic joints for each of two taxels.
fn xela(damage: Option<Damage>) -> Vec<u8> {
    let mut text = "<robot name='u'><link name='tip'/>\n".to_owned();
    for taxel in 0..2 {
        let is_damaged = taxel == 1;
        let mut parent = "tip".to_owned();
        for (axis, name) in ["1 0 0", "0 1 0", "0 0 1"].into_iter().zip(["x", "y", "z"]) {
            let axis = match (damage, is_damaged && name == "z") {
                (Some(Damage::ZeroNormal), true) => "0 0 0",
                (Some(Damage::LeftHanded), true) => "0 0 -1",
                (Some(Damage::WrongCounts), true) => "0 1",
                (Some(Damage::NotANumber), true) => "0 nan 1",
                _ => axis,
            };
            let child = format!("t{taxel}{name}");
            text += &format!(
                "<link name='{child}'/><joint name='j{taxel}{name}' type='prismatic'><parent link='{parent}'/><child link='{child}'/>\
                 <axis xyz='{axis}'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\n"
            );
            parent = child;
        }
    }
    (text + "</robot>\n").into_bytes()
}

fn npz(write: impl FnOnce(&mut NpzWriter<File>)) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    let mut npz = NpzWriter::new(File::create(&path).unwrap());
    write(&mut npz);
    npz.finish().unwrap();
    fs::read(path).unwrap()
}

fn rows(numbers: &[f64], width: usize) -> Array2<f64> {
    Array2::from_shape_vec((numbers.len() / width, width), numbers.to_vec()).unwrap()
}

fn own_npz(damage: Option<Damage>) -> Vec<u8> {
    let Numbers { centers, frames } = numbers(damage);
    let mut normals: Vec<f64> = frames
        .iter()
        .flat_map(|frame| frame[6..].to_vec())
        .collect();
    if damage == Some(Damage::WrongCounts) {
        normals.truncate(6);
    }
    npz(|npz| {
        npz.add_array("positions", &rows(&centers.concat(), 3))
            .unwrap();
        npz.add_array("normals", &rows(&normals, 3)).unwrap();
    })
}

fn dex(damage: Option<Damage>) -> Vec<u8> {
    let Numbers { centers, frames } = numbers(damage);
    let pose = |(center, f): (&[f64; 3], &[f64; 9])| {
        (0..3)
            .flat_map(|row| [f[row], f[3 + row], f[6 + row], center[row]])
            .collect::<Vec<f64>>()
    };
    let poses: Vec<f64> = centers.iter().zip(&frames).flat_map(pose).collect();
    let pixels = if damage == Some(Damage::WrongCounts) {
        2
    } else {
        N
    };
    npz(|npz| {
        npz.add_array("poses", &Array3::from_shape_vec((N, 3, 4), poses).unwrap())
            .unwrap();
        npz.add_array("taxel2pixel", &Array2::<i64>::zeros((pixels, 2)))
            .unwrap();
        npz.add_array("radii", &Array1::from_elem(N, 1e-3)).unwrap();
    })
}

/// Kinds of files: name, writer, and the expected part of the message for each damage (`None` if the format cannot have it).
type Kind = (
    &'static str,
    fn(Option<Damage>) -> Vec<u8>,
    [Option<&'static str>; 5],
);

const KINDS: [Kind; 8] = [
    (
        "palm.csv",
        csv,
        [
            Some("line 4: 4 columns; 6 columns"),
            Some("line 3: 7 columns; 6 columns"),
            Some("line 3, column x_mm: `NaN`; a finite number"),
            Some("row 2: normal [0, 0, 0] of length 0"),
            None,
        ],
    ),
    (
        "palm.txt",
        icub,
        [
            Some("row 6: 4 numbers; six numbers"),
            Some("row 5: 7 numbers; six numbers"),
            Some("row 5: a number that is not finite"),
            Some("row 5: normal [0, 0, 0] of length 0"),
            None,
        ],
    ),
    (
        "tip.json",
        paxini,
        [
            Some("EOF"),
            Some("rotation: 2 matrices for 3 taxels; one matrix a taxel"),
            Some("row 2: `[\"NaN\""),
            Some("rotation, row 2: a matrix that is no rotation"),
            Some("rotation, row 2: a left-handed frame"),
        ],
    ),
    (
        "own.npz",
        own_npz,
        [
            Some(""),
            Some("normals: an array of shape [2, 3]; 3 × 3"),
            Some("row 2: a number that is not finite"),
            Some("row 2: normal [0, 0, 0] of length 0"),
            None,
        ],
    ),
    (
        "dex.npz",
        dex,
        [
            Some(""),
            Some("taxel2pixel: an array of shape [2, 2]; 3 × 2"),
            Some("row 2: a number that is not finite"),
            Some("poses, row 2: a matrix that is no rotation"),
            Some("poses, row 2: a left-handed frame"),
        ],
    ),
    (
        "pad.urdf",
        urdf,
        [
            Some("line "),
            Some("line 3: `xyz` \"0 0\"; 3 finite numbers"),
            Some("line 3: `xyz` \"nan 0 0\"; 3 finite numbers"),
            None,
            None,
        ],
    ),
    (
        "array.urdf",
        array,
        [
            Some("line "),
            Some("line 2: `rows` 2.5; an integer from 1"),
            Some("line 2: `size` \"nan 0.003\"; 2 finite numbers"),
            None,
            None,
        ],
    ),
    (
        "uskin.urdf",
        xela,
        [
            Some("line "),
            Some("joint `j1x`: a chain of 2 prismatic joints; three"),
            Some("joint `j1x`: a chain of 2 prismatic joints; three"),
            Some("joint `j1x`: a chain of 2 prismatic joints; three"),
            Some("joint `j1x`: a left-handed frame"),
        ],
    ),
];

const DAMAGES: [Damage; 5] = [
    Damage::Truncated,
    Damage::WrongCounts,
    Damage::NotANumber,
    Damage::ZeroNormal,
    Damage::LeftHanded,
];

#[test]
fn each_damage_of_each_format_is_refused_with_file_and_row() {
    let folder = tempfile::tempdir().unwrap();
    let mut n_refused = 0;
    for (name, write, expected) in KINDS {
        let path = folder.path().join(name);
        fs::write(&path, write(None)).unwrap();
        let valid = read(&path).unwrap();
        assert!(valid.layout.n_taxels() >= 2, "{name}");
        for (damage, expected) in DAMAGES.into_iter().zip(expected) {
            let Some(expected) = expected else { continue };
            let bytes = match damage {
                Damage::Truncated => {
                    let whole = write(None);
                    whole[..whole.len() - whole.len().min(5)].to_vec()
                }
                _ => write(Some(damage)),
            };
            fs::write(&path, &bytes).unwrap();
            let error = read(&path).expect_err(name);
            let message = error.to_string();
            let starts = message.starts_with(&path.display().to_string());
            assert!(starts, "{name}, {damage:?}: {message}");
            assert!(message.contains(expected), "{name}, {damage:?}: {message}");
            assert_eq!(error.exit_code(), 2, "{name}, {damage:?}");
            // A scene with this file gives an equal error message.
            let scene = format!(
                "title = \"t\"\n[[patches]]\nname = \"p\"\nstroke_mm = 2.0\nlayout = {{ file = \"{name}\" }}\n"
            );
            let scene_path = folder.path().join("scene.toml");
            fs::write(&scene_path, scene).unwrap();
            let error = ScenePlan::read(&scene_path).unwrap_err();
            assert!(
                error.to_string().contains(expected),
                "{name}, {damage:?}: {error}"
            );
            assert_eq!(error.exit_code(), 2, "{name}, {damage:?}");
            n_refused += 1;
        }
    }
    assert_eq!(n_refused, 33);
}

#[test]
fn files_that_are_cut_anywhere_never_panic_and_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    for (name, write, _) in KINDS {
        let path = folder.path().join(name);
        let whole = write(None);
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            // A text that is cut between two rows may be a valid, shorter file.
            if let Err(error) = read(&path) {
                let message = error.to_string();
                assert!(message.contains(name), "{name}, {length} bytes: {message}");
                assert_eq!(error.exit_code(), 2, "{name}, {length} bytes: {message}");
            }
        }
    }
}

#[test]
fn positions_of_icub_without_normals_take_the_normals_of_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nomesh.txt");
    let text = "[calibration]\n0 0 0 0 0 0\n0.001 0 0.005 0 0 0\n0.0051 0 0 0 0 0\n";
    fs::write(&path, text).unwrap();
    let error = read(&path).unwrap_err().to_string();
    says(
        &error,
        &["nomesh.txt: all 2 normals have length zero; rows with normals, or a mesh"],
    );
    let cube = TriangleMesh::cuboid("cube", DVec3::splat(0.01)).unwrap();
    let options = LayoutOptions {
        mesh: Some(&cube),
        ..LayoutOptions::default()
    };
    let file = LayoutFile::read(&path, options).unwrap();
    assert_eq!(file.layout.axes(), [DVec3::Z, DVec3::X]);
    fs::write(&path, text.replace("0.0051", "0.06")).unwrap();
    let error = LayoutFile::read(&path, options).unwrap_err().to_string();
    says(&error, &["row 4: a point 55.0 mm from the mesh"]);
    fs::write(&path, "[calibration]\n0 0 0.005 0 0 1\n").unwrap();
    let error = LayoutFile::read(&path, options).unwrap_err().to_string();
    says(&error, &["a mesh for normals; none"]);
}

#[test]
fn an_array_of_a_robots_file_is_an_image_and_listed_taxels_may_have_radii() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pad.urdf");
    let robot = |tactile: &str| {
        let text = format!(
            "<robot name='r'><link name='l'/><sensor name='s'><parent link='l'/><tactile>{tactile}</tactile></sensor></robot>"
        );
        fs::write(&path, text).unwrap();
        read(&path).unwrap()
    };
    let file = robot("<array rows='2' cols='3' size='0.003 0.003'/>");
    assert_eq!(file.layout.sides(), Some([2, 3]));
    assert_eq!(file.pixels.unwrap()[4], [1, 1]);
    let file = robot("<array rows='2' cols='3' order='col-major' size='0.003 0.003'/>");
    assert_eq!(file.layout.sides(), None);
    assert_eq!(file.pixels.unwrap()[..3], [[0, 0], [1, 0], [0, 1]]);
    let taxel = |index: usize, shape: &str| {
        format!("<taxel idx='{index}' xyz='0.00{index} 0 0'><geometry>{shape}</geometry></taxel>")
    };
    let ball = |radius: &str| format!("<sphere radius='{radius}'/>");
    let file = robot(&(taxel(1, &ball("0.002")) + &taxel(0, &ball("0.001"))));
    assert_eq!(file.radii, Some(vec![1e-3, 2e-3]));
    // Taxels are read, and an array beside them is not, as urdf_tactile does.
    let both = taxel(0, &ball("0.001"))
        + &taxel(1, "<box size='1 1 1'/>")
        + "<array rows='2' cols='3' size='1 1'/>";
    let file = robot(&both);
    assert_eq!(
        (file.layout.n_taxels(), file.radii, file.pixels),
        (2, None, None)
    );
}

#[test]
fn arrays_of_an_archive_may_have_other_usual_names() {
    let folder = tempfile::tempdir().unwrap();
    let place = |(row, axis): (usize, usize)| match axis {
        2 => 0.0,
        _ => 1e-3 * (row * 3 + axis) as f64,
    };
    let positions = Array2::from_shape_fn((6, 3), place);
    let normals = Array2::from_shape_fn((6, 3), |(_, axis)| f64::from(axis == 2));
    let archive = |names: &[(&str, &Array2<f64>)]| {
        let path = folder.path().join("skin.npz");
        let mut npz = NpzWriter::new(File::create(&path).unwrap());
        for (name, array) in names {
            npz.add_array(*name, *array).unwrap();
        }
        npz.finish().unwrap();
        read(&path)
    };
    let expected = archive(&[("positions", &positions), ("normals", &normals)]).unwrap();
    for (one, other) in [
        ("centers", "axes"),
        ("points", "normals"),
        ("xyz", "normal"),
    ] {
        let again = archive(&[(one, &positions), (other, &normals)]).unwrap();
        assert_eq!(again.layout, expected.layout, "{one} {other}");
    }
    let twice = [
        ("points", &positions),
        ("xyz", &positions),
        ("normals", &normals),
    ];
    let error = archive(&twice).unwrap_err().to_string();
    says(&error, &["the arrays points and xyz; one of them"]);
}

#[test]
fn every_changed_byte_of_an_archives_numbers_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("skin.npz");
    layouts()[2].write(&path, None).unwrap();
    let whole = fs::read(&path).unwrap();
    let original = read(&path).unwrap();
    for changed in (0..whole.len()).step_by(5) {
        let mut bytes = whole.clone();
        bytes[changed] ^= 0x55;
        fs::write(&path, &bytes).unwrap();
        if let Ok(again) = read(&path) {
            assert_eq!(again.layout, original.layout, "byte {changed}");
        }
    }
}

#[test]
fn parts_that_are_left_out_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.urdf");
    let sensor = |inside: &str| {
        let text = format!(
            "<robot name='r'><link name='palm'/><sensor name='s'><parent link='palm'/>\
             <tactile>{inside}</tactile></sensor></robot>"
        );
        fs::write(&path, text).unwrap();
        read(&path).unwrap()
    };
    let taxels = "<taxel idx='0' xyz='0 0 0'/><taxel idx='3' xyz='1 0 0'/>";
    let file = sensor(taxels);
    assert!(
        file.notes[0].contains("2 taxels for 4 channels"),
        "{:?}",
        file.notes
    );
    let file = sensor(&format!("{taxels}<array rows='2' cols='2' size='1 1'/>"));
    assert!(
        file.notes[1].contains("<array> beside <taxel>s"),
        "{:?}",
        file.notes
    );
}

#[test]
fn rows_of_icub_without_a_section_and_points_with_named_coordinates_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        read(&path)
    };
    let icub = "name palm\nspatial_sampling taxel\ntaxel2Repr (0 1 2)\n0.001 0.002 0.003 0 0 1\n0 0 0 0 0 0\n-0.004 0.005 0.006 0 0 2\n";
    let read = file("palm.txt", icub).unwrap();
    assert_eq!(read.layout.centers()[1], DVec3::new(-4e-3, 5e-3, 6e-3));
    assert_eq!(read.layout.axes()[1], DVec3::Z);
    let error = file("cut.txt", &icub.replace(" 0 0 2", ""))
        .unwrap_err()
        .to_string();
    says(&error, &["row 6: 3 numbers; six numbers"]);
    let points = "[{\"x\": 1, \"y\": 2, \"z\": 3}, {\"z\": 6, \"y\": 5, \"x\": 4}]";
    let text = format!("{{\"points\": {points}, \"normals\": [[0, 0, 1], [0, 1, 0]]}}");
    let read = file("s.json", &text).unwrap();
    assert_eq!(read.layout.centers()[1], DVec3::new(4e-3, 5e-3, 6e-3));
}

/// Law: positions without normals take them from a mesh in every format, and positions of x and y alone are a flat skin.
#[test]
fn positions_alone_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let cube = TriangleMesh::cuboid("cube", DVec3::splat(0.01)).unwrap();
    let on_cube = LayoutOptions {
        mesh: Some(&cube),
        ..LayoutOptions::default()
    };
    let published = r#"{"units": "millimeters", "points": [{"id": 1, "x_mm": 1, "y_mm": 0, "z_mm": 5.0}, {"id": 2, "x_mm": 5.1, "y_mm": 0, "z_mm": 0}]}"#;
    for (name, text) in [
        ("p.csv", "x_mm,y_mm,z_mm\n1,0,5\n5.1,0,0\n"),
        ("p.json", published),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        let error = read(&path).unwrap_err().to_string();
        says(&error, &["a mesh beside it"]);
        let file = LayoutFile::read(&path, on_cube).unwrap();
        assert_eq!(file.layout.axes(), [DVec3::Z, DVec3::X], "{name}");
        assert_eq!(
            file.layout.centers(),
            [DVec3::new(1e-3, 0.0, 5e-3), DVec3::new(5.1e-3, 0.0, 0.0)]
        );
        let has_note = file.notes.iter().any(|note| note.contains("not used: id"));
        assert_eq!(has_note, name == "p.json", "{:?}", file.notes);
    }
    let path = folder.path().join("flat.npz");
    let mut npz = NpzWriter::new(File::create(&path).unwrap());
    let places = ndarray::array![[0.0, 1e-3], [2e-3, 3e-3]];
    npz.add_array("positions", &places).unwrap();
    npz.finish().unwrap();
    let table = folder.path().join("flat.csv");
    fs::write(&table, "x_mm,y_mm\n0,1\n2,3\n").unwrap();
    for path in [path, table] {
        let file = read(&path).unwrap();
        assert_eq!(
            file.layout.centers(),
            [DVec3::new(0.0, 1e-3, 0.0), DVec3::new(2e-3, 3e-3, 0.0)]
        );
        assert_eq!(file.layout.axes(), [DVec3::Z; 2]);
        assert!(file.notes[0].contains("flat skin"), "{:?}", file.notes);
    }
}
