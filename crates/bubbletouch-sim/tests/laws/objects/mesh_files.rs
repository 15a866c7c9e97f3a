//! Meshes from files of three formats in four units, and the messages of their readers.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{
    LengthUnit, MeshFormat, MeshReport, SizeLimits, Surface, TriangleMesh, read_obj, read_stl,
};
use glam::DVec3;
use std::fmt::Write;
use std::path::Path;

use crate::cases::cases;
use crate::mesh_shapes::{corners, cuboid, icosphere, joined, with_triangles};

fn obj(mesh: &TriangleMesh) -> String {
    let mut text = String::from("# a mesh\nmtllib none.mtl\no thing\n");
    for v in mesh.vertices() {
        writeln!(text, "v {} {} {} 0.5 0.5 0.5", v.x, v.y, v.z).unwrap();
    }
    text.push_str("vt 0 0\nvn 0 0 1\nusemtl none\ns off\n");
    for (index, [a, b, c]) in mesh.triangles().iter().enumerate() {
        if index == mesh.n_triangles() / 2 {
            text.push_str("g second half\n");
        }
        writeln!(text, "f {}/1/1 {}//1 {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn ascii_stl(mesh: &TriangleMesh) -> String {
    let mut text = String::from("solid thing of mine\n");
    for t in 0..mesh.n_triangles() {
        text.push_str("facet normal 0 0 0\nouter loop\n");
        for v in mesh.triangle(t).0 {
            writeln!(text, "  vertex {} {} {}", v.x, v.y, v.z).unwrap();
        }
        text.push_str("endloop\nendfacet\n");
    }
    text + "endsolid thing of mine\n"
}

fn binary_stl(mesh: &TriangleMesh, header: &[u8]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend((mesh.n_triangles() as u32).to_le_bytes());
    for t in 0..mesh.n_triangles() {
        bytes.extend([0; 12]);
        for v in mesh.triangle(t).0 {
            bytes.extend(v.to_array().map(|x| (x as f32).to_le_bytes()).concat());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn an_obj_gives_the_mesh_that_it_describes() {
    let ball = icosphere(0.03, 2);
    let file = read_obj("ball.obj", obj(&ball).as_bytes()).unwrap();
    let [n, expected] = [file.vertices(), ball.vertices()].map(<[DVec3]>::len);
    assert_eq!(n, expected, "texture makes no seams");
    let mesh = file.into_mesh("ball.obj").unwrap();
    assert_eq!(corners(&mesh), corners(&ball));
    // A square divided into two triangles, with indices that count from the end.
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf -4 -3 -2 -1\n";
    let square = read(MeshFormat::Obj, square.as_bytes());
    assert_eq!(square.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(square.area(), 1.0);
}

#[test]
fn both_kinds_of_stl_give_the_mesh_with_its_corners_merged() {
    let ball = icosphere(0.03, 2);
    let ascii = read_stl("ball.stl", ascii_stl(&ball).as_bytes()).unwrap();
    assert_eq!(ascii.vertices().len(), ball.vertices().len());
    let ascii = ascii.into_mesh("ball.stl").unwrap();
    assert_eq!(corners(&ascii), corners(&ball), "every digit counts");
    // Some programs begin a binary file with the first word of an ASCII file.
    for header in [&b"made by hand"[..], b"solid ball"] {
        let binary = read_stl("ball.stl", &binary_stl(&ball, header)[..]).unwrap();
        let binary = binary.into_mesh("ball.stl").unwrap();
        let rounded = corners(&ball).into_iter().map(|v| v.as_vec3().as_dvec3());
        assert!(rounded.eq(corners(&binary)));
        assert!(Surface::new(binary).is_closed());
    }
    let nameless = ascii_stl(&ball).replace(" thing of mine", "");
    assert_eq!(read(MeshFormat::Stl, nameless.as_bytes()), ascii);
    assert!(Surface::new(ascii).is_closed());
}

#[test]
fn files_that_are_no_meshes_say_why() {
    let stl_error = |bytes: &[u8]| read_stl("m.stl", bytes).unwrap_err().to_string();
    let obj_error = |text: &str| match read_obj("m.obj", text.as_bytes()) {
        Ok(file) => file.into_mesh("m.obj").unwrap_err().to_string(),
        Err(error) => error.to_string(),
    };
    let cube = cuboid(DVec3::ONE);
    let text = ascii_stl(&cube);
    let changed = |old: &str, new: &str| stl_error(text.replacen(old, new, 1).as_bytes());
    let stl_cases = [
        (stl_error(b""), "m.stl: an empty file"),
        (stl_error(b"ply\n"), "m.stl: not an STL file"),
        (
            stl_error(&binary_stl(&cube, b"x")[..400]),
            "m.stl: not an STL file, or cut off",
        ),
        (
            stl_error(text.rsplit_once("endloop").unwrap().0.as_bytes()),
            "m.stl: cut off",
        ),
        (
            changed("vertex -1", "vertex one"),
            "m.stl, line 4: coordinate `one`",
        ),
        (
            changed("vertex -1", "vertex NaN"),
            "m.stl, line 4: coordinate `NaN`; a finite number",
        ),
        (
            stl_error(b"solid empty\nendsolid empty\n"),
            "m.stl: no vertices",
        ),
    ];
    // Lines of OBJ files, and the beginnings of their errors.
    let obj_cases = " | m.obj: no faces
        v 0 0 0, v 1 0 0, v 0 1 0 | m.obj: no faces
        v 0 0 0, v 1 0 0, v 0 1 0, f 1 2 4 | m.obj, line 4: vertex index 4; 1 to 3
        v 0 0 0, v 1 0 0, v 0 1 0, f 1 2 0 | m.obj, line 4: vertex index `0`
        v 0 0 0, v 1 0 0, v 0 1 0, f 1 2 -4 | m.obj, line 4: vertex index `-4`
        v 0 0 0, v 1 0 0, v 0 1 0, f 1 2 | m.obj, line 4: a face with 2 corners; three corners or more
        v 0 0 0, v 1 0 0, v 0 1 0, f, f 1 2 3 | m.obj, line 4: a face with 0 corners
        v 0 0 zero, f 1 1 1 | m.obj, line 1: coordinate `zero`
        v 0 0 nan, v 1 0 0, v 0 1 0, f 1 2 3 | m.obj, line 1: coordinate `nan`; a finite number
        v 0 0 0, v 2 0 0, v 0.1 0.1 0, v 0 2 0, f 4 1 2 3 | m.obj: face 1: 4 corners that are not convex";
    let obj_cases = cases(obj_cases).into_iter();
    let obj_cases =
        obj_cases.map(|[lines, expected]| (obj_error(&lines.replace(", ", "\n")), expected));
    let stl_cases = stl_cases.map(|(error, expected)| (error, expected.to_owned()));
    for (error, expected) in stl_cases.into_iter().chain(obj_cases) {
        assert!(error.starts_with(&expected), "{error} | {expected}");
        assert!(!error.contains('\n'), "one line: {error}");
    }
}

#[test]
fn cut_or_garbled_files_never_panic() {
    let mesh = cuboid(DVec3::ONE);
    let files = [
        obj(&mesh).into_bytes(),
        ascii_stl(&mesh).into_bytes(),
        binary_stl(&mesh, b"x"),
    ];
    let formats = [MeshFormat::Obj, MeshFormat::Stl, MeshFormat::Stl];
    for (format, whole) in formats.iter().zip(&files) {
        for length in 0..whole.len() {
            let mut garbled = whole.clone();
            garbled[length] = garbled[length].wrapping_mul(7).wrapping_add(length as u8);
            for bytes in [&whole[..length], &garbled] {
                let _ = format.read("m", None, &SizeLimits::ANY, bytes);
            }
        }
    }
}

/// Returns the mesh of a valid file.
fn read(format: MeshFormat, bytes: &[u8]) -> TriangleMesh {
    let file = format.read("m", None, &SizeLimits::ANY, bytes);
    file.unwrap().into_mesh("m").unwrap()
}

#[test]
fn byte_order_marks_line_ends_and_comments_change_nothing() {
    let mark = b"\xEF\xBB\xBF".to_vec();
    let cube = cuboid(DVec3::new(0.1, 0.2, 0.3));
    let header = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n\
                  element face 12\nproperty list uchar int vertex_indices\nend_header\n";
    let mut ply = header.to_owned();
    for v in cube.vertices() {
        writeln!(ply, "{} {} {}", v.x, v.y, v.z).unwrap();
    }
    for [a, b, c] in cube.triangles() {
        writeln!(ply, "3 {a} {b} {c}").unwrap();
    }
    // The last vertex is unused, so that the loss of the first vertex would leave valid indices.
    let first_vertex_first = obj(&cube)
        .lines()
        .skip(3)
        .map(|line| format!("{line} # x\n"))
        .collect::<String>();
    let obj_text = first_vertex_first.replacen("vt 0 0", "v 9 9 9\nvt 0 0", 1);
    for (format, text) in [
        (MeshFormat::Obj, obj_text),
        (MeshFormat::Stl, ascii_stl(&cube)),
        (MeshFormat::Ply, ply),
    ] {
        let marked = [&mark, text.as_bytes()].concat();
        let windows = [&mark, text.replace('\n', "\r\n").as_bytes()].concat();
        for (bytes, what) in [
            (text.as_bytes(), ""),
            (&marked[..], "marked"),
            (&windows[..], "CR LF"),
        ] {
            assert_eq!(
                corners(&read(format, bytes)),
                corners(&cube),
                "{format:?}, {what}"
            );
        }
    }
    let classic = obj(&cube).replace('\n', "\r").into_bytes();
    let continued = obj(&cube).replace("/1/1 ", "/1/1 \\\n  ").into_bytes();
    let latin = [b"# Pr\xFCfk\xF6rper\n", obj(&cube).as_bytes()].concat();
    for bytes in [classic, continued, latin] {
        assert_eq!(corners(&read(MeshFormat::Obj, &bytes)), corners(&cube));
    }
}

#[test]
fn all_objects_of_a_file_are_read() {
    let near = cuboid(DVec3::splat(0.01));
    let far = near.moved(&Pose::from_translation(DVec3::X));
    let both = [corners(&near), corners(&far)].concat();
    let stl = ascii_stl(&near) + &ascii_stl(&far);
    let upper = stl.to_uppercase().replace("SOLID THING OF MINE", "SOLID");
    let with_blank_lines = stl.replace("endsolid thing of mine\n", "endsolid\n\n");
    for text in [stl, upper, with_blank_lines] {
        assert_eq!(corners(&read(MeshFormat::Stl, text.as_bytes())), both);
    }
    // Indices continue across objects, counted from the start or from the last vertex read.
    let square = "v 0 0 Z\nv 1 0 Z\nv 1 1 Z\nv 0 1 Z\n";
    let object = |number: usize, face: &str| {
        let square = square.replace('Z', &number.to_string());
        format!("o part{number}\ng a b\n{square}f {face}\n")
    };
    for second in ["5 6 7 8", "-4 -3 -2 -1", "5/1 6/1 7/1 8/1"] {
        let text = object(0, "1 2 3 4") + &object(1, second);
        let mesh = read(MeshFormat::Obj, text.as_bytes());
        assert_eq!((mesh.n_triangles(), mesh.area()), (4, 2.0), "{second}");
        assert_eq!(mesh.bounds().max, DVec3::ONE);
    }
    // A face may precede its vertices.
    let text = format!("f 1 2 3 4\n{}", square.replace('Z', "0"));
    assert_eq!(read(MeshFormat::Obj, text.as_bytes()).area(), 1.0);
}

#[test]
fn ascii_coordinates_keep_all_their_digits() {
    let x = 1.234_567_890_123_45;
    assert_ne!(f64::from(x as f32), x);
    let obj = format!("v {x} 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n");
    let facet = format!(
        "facet normal 0 0 1\nouter loop\nvertex {x} 0 0\nvertex 2 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    );
    let stl = format!("solid\n{facet}endsolid\n");
    assert_eq!(read(MeshFormat::Obj, obj.as_bytes()).vertices()[0].x, x);
    assert_eq!(read(MeshFormat::Stl, stl.as_bytes()).vertices()[0].x, x);
    for wrong in [
        stl.replacen("vertex 0 1 0\n", "", 1),
        stl.replacen("vertex 0 1 0\n", "vertex 0 1 0\nvertex 1 1 1\n", 1),
        stl.replacen("vertex 0 1 0", "vertex 0 1", 1),
        stl.replacen("endfacet\n", "", 1),
        stl.replacen("solid\n", "solid\nfacets\n", 1),
        stl.clone() + &facet,
    ] {
        let error = read_stl("m.stl", wrong.as_bytes()).unwrap_err().to_string();
        assert!(error.starts_with("m.stl, line "), "{error}");
    }
}

#[test]
fn a_unit_is_what_it_says_and_a_name_says_the_format() {
    let text = obj(&cuboid(DVec3::ONE));
    for (name, metres) in [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)] {
        let unit: LengthUnit = name.parse().unwrap();
        let file = MeshFormat::Obj.read("b", Some(unit), &SizeLimits::ANY, text.as_bytes());
        let bounds = file.unwrap().into_mesh("b").unwrap().bounds();
        assert_eq!(bounds.max, DVec3::splat(metres));
    }
    let error = "ft".parse::<LengthUnit>().unwrap_err();
    assert_eq!(error, "expected one of m, cm, mm, in");
    let format = |path: &str| MeshFormat::from_path(Path::new(path));
    assert_eq!(format("a/b.PLY").unwrap(), MeshFormat::Ply);
    let error = format("a/b.step").unwrap_err().to_string();
    let allowed = "a name that ends in .ply, .obj, .stl, .dae, .glb or .gltf";
    assert_eq!(
        error,
        format!("a/b.step: not a mesh by its name; {allowed}")
    );
}

#[test]
fn a_box_is_a_solid_without_faults() {
    let report = MeshReport::new(&cuboid(DVec3::new(0.05, 0.02, 0.01)));
    assert!(report.is_solid() && report.faults().is_empty());
    let counts = [report.n_vertices, report.n_edges, report.n_triangles];
    assert_eq!(counts, [8, 18, 12]);
    assert!((report.volume - 8e-5).abs() < 1e-18);
    assert!((report.area - 0.0136).abs() < 1e-15);
    let expected = "size        100.0 × 40.0 × 20.0 mm\n\
                    from        -50.0, -20.0, -10.0 mm\n\
                    to          50.0, 20.0, 10.0 mm\n\
                    triangles   12\n\
                    vertices    8\n\
                    components  1\n\
                    area        136.00 cm²\n\
                    volume      80.00 cm³\n\
                    watertight  yes\n\
                    solid       yes\n\
                    faults      none";
    assert_eq!(report.to_string(), expected);
}

/// Returns the report of a box of 1 m half sides whose triangles were changed.
fn changed(change: impl Fn(&mut Vec<[u32; 3]>)) -> MeshReport {
    let whole = cuboid(DVec3::ONE);
    let mut triangles = whole.triangles().to_vec();
    change(&mut triangles);
    MeshReport::new(&with_triangles(&whole, triangles))
}

#[test]
fn every_fault_is_found_and_counted() {
    let hole = changed(|t| drop(t.drain(..2)));
    assert!(!hole.is_watertight());
    assert_eq!(hole.holes, [8.0]);
    assert_eq!(hole.faults(), ["1 hole (longest border 8000.0 mm)"]);
    let two_holes = changed(|t| {
        t.remove(0);
        t.remove(2);
    });
    assert_eq!(two_holes.holes.len(), 2);

    let flipped = changed(|t| t[0].swap(0, 1));
    assert!(flipped.is_watertight() && !flipped.is_solid());
    assert_eq!(flipped.n_flipped_edges, 3);
    let inwards = changed(|t| t.iter_mut().for_each(|t| t.swap(0, 1)));
    assert!(inwards.volume < 0.0 && !inwards.is_solid());
    assert_eq!(inwards.faults(), ["faces that face inwards"]);

    let twice = changed(|t| t.push([t[0][1], t[0][0], t[0][2]]));
    assert_eq!((twice.n_duplicates, twice.n_crowded_edges), (1, 3));
    let collapsed = changed(|t| t.push([3, 3, 4]));
    assert_eq!((collapsed.n_collapsed, collapsed.n_slivers), (1, 0));
    assert!(collapsed.is_solid(), "a line takes nothing away");

    let corners = vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
    let line = TriangleMesh::new("line", corners, vec![[0, 1, 2]]).unwrap();
    assert_eq!(MeshReport::new(&line).n_slivers, 1);
}

#[test]
fn parts_that_touch_at_a_corner_are_one_component_with_a_pinch() {
    let near = cuboid(DVec3::ONE);
    let both = |shift: DVec3| {
        let far = near.moved(&Pose::from_translation(shift));
        MeshReport::new(&joined(&[near.clone(), far]))
    };
    let apart = both(DVec3::splat(3.0));
    assert_eq!((apart.n_components, apart.n_pinched_vertices), (2, 0));
    assert!(apart.is_solid());
    let touching = both(DVec3::splat(2.0));
    assert_eq!((touching.n_components, touching.n_pinched_vertices), (1, 1));
    assert_eq!(touching.n_vertices, 15);
}

#[test]
fn a_polygon_that_is_bent_a_little_is_still_a_fan() {
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let bent = format!("{header}0 0 0\n1 0 0\n1 1 0.1\n0 1 0\n4 0 1 2 3\n");
    let mesh = read(MeshFormat::Ply, bent.as_bytes());
    assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
}
