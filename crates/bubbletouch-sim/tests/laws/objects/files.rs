//! Meshes and spheres from files: the contents that are read, and the messages of invalid files.

use bubbletouch_sim::mesh::{LengthUnit, SizeLimits, read_ply};
use bubbletouch_sim::objects::{read_spheres, vertex_spheres, write_spheres};
use glam::DVec3;
use std::fmt::Write as _;
use std::fs::File;
use std::io::BufReader;

use crate::cases::{cases, each_change};

const HEADER: &str = "ply
format FORMAT 1.0
comment a pyramid with a square base
element vertex 5
property float x
property double y
property uchar red
property short z
element edge 1
property int vertex1
property list uchar float weights
element face 5
property uchar flags
property list uchar int vertex_indices
end_header
";

const CORNERS: &str = "0 0 0, 1 0 0, 1 1 0, 0 1 0, 0.5 0.5 7";
const FACES: &str = "3 2 1 0, 0 1 4, 1 2 4, 2 3 4, 3 0 4";
const TRIANGLES: &str = "3 2 1, 3 1 0, 0 1 4, 1 2 4, 2 3 4, 3 0 4";

/// Returns lists of numbers in a text.
fn lists<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> Vec<Vec<T>> {
    let list = |list: &str| list.split(' ').map(|word| word.parse().unwrap()).collect();
    text.split(", ").map(list).collect()
}

fn ascii() -> String {
    let mut text = HEADER.replace("FORMAT", "ascii");
    for corner in CORNERS.split(", ") {
        let (xy, z) = corner.rsplit_once(' ').unwrap();
        writeln!(text, "{xy} 255 {z}").unwrap();
    }
    writeln!(text, "3 2 0.5 1.5").unwrap();
    for face in FACES.split(", ") {
        writeln!(text, "9 {} {face}", face.split(' ').count()).unwrap();
    }
    text
}

macro_rules! binary {
    ($order:ident, $format:literal) => {{
        let mut bytes = HEADER.replace("FORMAT", $format).into_bytes();
        for corner in lists::<f64>(CORNERS) {
            bytes.extend((corner[0] as f32).$order());
            bytes.extend(corner[1].$order());
            bytes.push(255);
            bytes.extend((corner[2] as i16).$order());
        }
        bytes.extend(3i32.$order());
        bytes.push(2);
        bytes.extend(0.5f32.$order());
        bytes.extend(1.5f32.$order());
        for face in lists::<i32>(FACES) {
            bytes.extend([9, face.len() as u8]);
            for index in face {
                bytes.extend(index.$order());
            }
        }
        bytes
    }};
}

fn little_endian() -> Vec<u8> {
    binary!(to_le_bytes, "binary_little_endian")
}

fn ply_error(bytes: &[u8]) -> String {
    let error = read_ply("cup.ply", bytes).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    let text = error.to_string();
    assert!(text.starts_with("cup.ply"), "{text}");
    assert!(!text.contains('\n'), "one line: {text}");
    text
}

#[test]
fn the_three_encodings_of_a_ply_give_the_same_mesh() {
    let mesh = read_ply("p", ascii().as_bytes()).unwrap();
    let corners = lists::<f64>(CORNERS).into_iter();
    assert!(
        corners
            .map(|corner| DVec3::from_slice(&corner))
            .eq(mesh.vertices().to_vec())
    );
    let triangles = mesh.clone().into_mesh("p").unwrap().triangles().to_vec();
    assert_eq!(lists::<u32>(TRIANGLES), triangles);
    assert_eq!(read_ply("p", &little_endian()[..]).unwrap(), mesh);
    let big = binary!(to_be_bytes, "binary_big_endian");
    assert_eq!(read_ply("p", &big[..]).unwrap(), mesh);
    let windows = ascii().replace('\n', "\r\n");
    assert_eq!(read_ply("p", windows.as_bytes()).unwrap(), mesh);
    for whole in [ascii().into_bytes(), little_endian()] {
        let comment = whole.windows(9).position(|word| word == b"a pyramid");
        let mut latin = whole;
        latin[comment.unwrap()] = 0xE4;
        assert_eq!(read_ply("p", &latin[..]).unwrap(), mesh);
    }
}

#[test]
fn a_ply_cut_off_anywhere_is_an_error() {
    for whole in [ascii().into_bytes(), little_endian()] {
        // An ASCII file may lack its last line break.
        for length in 0..whole.len() - 1 {
            let result = read_ply("cup.ply", &whole[..length]);
            // ASCII numbers can be truncated to shorter numbers, but only in the last line.
            let n = whole.len();
            assert!(result.is_err() || length > n - 3, "{length} of {n} bytes");
        }
    }
    assert!(ply_error(&little_endian()[..400]).contains("cut off"));
}

#[test]
fn a_ply_that_cannot_be_used_says_why() {
    let text = ascii();
    let refuse = |text: &str, expected: &str| {
        let error = ply_error(text.as_bytes());
        assert!(
            error.contains(expected),
            "expected `{expected}` in: {error}"
        );
    };
    refuse("", "an empty file");
    refuse("solid cup\n", "not a PLY file");
    let xyz = "property float x\nproperty float y\nproperty float z";
    let empty = format!("ply\nformat ascii 1.0\nelement vertex 0\n{xyz}\nend_header\n");
    refuse(&empty, "no vertices; at least one vertex");
    let junk = text.replace("element edge 1", "element junk 1\nelement edge 1");
    refuse(&junk, "element `junk` without");
    refuse(&text.replace("end_header\n", ""), "not readable as PLY");
    // A text of the file, what replaces it, and a part of the error.
    let changes = "ascii | asciii | not readable as PLY: Line 2
        element vertex 5 | element point 5 | no element `vertex`
        double y | double w | vertices without a number `y`
        1 0 255 0 | 1 NaN 255 0 | not readable as PLY: Line 17
        1 0 255 0 | 1 inf 255 0 | not readable as PLY: Line 17
        1 0 255 0 | 1 255 0 | not readable as PLY: Line 17
        9 3 0 1 4 | 9 3 0 1 5 | face 2: vertex indices [0, 1, 5]; 0 to 4
        9 3 0 1 4 | 9 3 0 1 -1 | face 2: vertex index -1
        9 3 0 1 4 | 9 2 0 1 | face 2: 2 corners
        int vertex_indices | float vertex_indices | faces without a list
        element vertex 5 | element vertex 99999999999 | not readable as PLY";
    each_change(&text, changes, refuse);
}

#[test]
fn a_binary_nan_is_named_by_its_vertex() {
    let mut bytes = little_endian();
    let header = bytes.windows(11).position(|w| w == b"end_header\n");
    let second_x = header.unwrap() + 11 + 15;
    bytes[second_x..second_x + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(ply_error(&bytes).starts_with("cup.ply: vertex 2: "));
}

#[test]
fn spheres_survive_csv_to_the_last_bit() {
    let text = "0.1,0.2,-0.3,0.004\n1e-300,12345.678901234567,-0,0.3333333333333333\n";
    let metres = Some(LengthUnit::Metre);
    let read = |text: &[u8]| read_spheres("s.csv", metres, &SizeLimits::ANY, text).unwrap();
    let union = read(text.as_bytes());
    let mut written = Vec::new();
    write_spheres(&union, &mut written).unwrap();
    assert!(written.starts_with(b"x,y,z,r\n1.0000000000000001e-1,"));
    assert_eq!(read(&written), union);
}

#[test]
fn a_header_may_order_the_columns() {
    let plain = read_spheres("a", None, &SizeLimits::ANY, "1,2,3,4\n".as_bytes()).unwrap();
    let named = "\u{feff}name, R ,z,Y,X\nfirst,4,3, 2,1\n";
    let named = read_spheres("b", None, &SizeLimits::ANY, named.as_bytes()).unwrap();
    assert_eq!(named, plain);
}

#[test]
fn spheres_that_cannot_be_used_say_why() {
    let refuse = |bytes: &[u8]| {
        let error = read_spheres("s.csv", None, &SizeLimits::ANY, bytes).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    };
    refuse(b"x,y,z,r\n0,0,0,\xb5\n");
    // Rows of the file, and the beginning of the error.
    let rows = " | s.csv: no spheres
        x,y,z,r | s.csv: no spheres
        x,y,r 1,2,3 | s.csv, line 1: header `x,y,r` without a column z
        1,2,3 | s.csv, line 1: 3 columns; 4
        1,2,3,4 1,2,3,4,5 | s.csv, line 2: 5 columns; 4
        x,y,z,r 0,0,0,1 0,nan,0,1 | s.csv, line 3, column y: `nan`
        NaN,NaN,NaN,NaN | s.csv, line 1, column x: `NaN`
        0,0,inf,1 | s.csv, line 1, column z: `inf`
        0,0,0,-1 | s.csv, line 1, column r: -1; a positive
        0,0,0,0 | s.csv, line 1, column r: 0; a positive
        0,0,0,\"t\\nn\" | s.csv, line 1, column r: `t n`
        0,0,0,ten | s.csv, line 1, column r: `ten`
        0,0,,1 | s.csv, line 1, column z: ``";
    for [rows, expected] in cases(rows) {
        let error = refuse(rows.replace(' ', "\n").as_bytes());
        assert!(error.starts_with(&expected), "{expected}: {error}");
    }
}

#[test]
fn the_scanned_objects_are_read_and_get_spheres_of_millimetres() {
    let Some(folder) = crate::reference_data::folder("BUBBLETOUCH_YCB") else {
        return;
    };
    let mut n_meshes = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_none_or(|e| e != "ply") {
            continue;
        }
        let place = path.display().to_string();
        let mesh = read_ply(&place, BufReader::new(File::open(&path).unwrap())).unwrap();
        assert!((8_000..8_200).contains(&mesh.vertices().len()), "{place}");
        let union = vertex_spheres(&place, mesh.vertices()).unwrap();
        let radius = union.spheres()[0].radius;
        // Range from the dice to the pitcher; the median is 2.3 mm.
        assert!((0.6e-3..5.2e-3).contains(&radius), "{place}: {radius}");
        n_meshes += 1;
    }
    assert_eq!(n_meshes, 43);
}
