//! Meshes from Collada and glTF files: units, transforms of nodes, instances, mirrored nodes, and wrong files.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{LengthUnit, MeshFormat, SizeLimits, TriangleMesh};
use glam::{DQuat, DVec3};
use serde_json::{Value, json};
use std::fmt::Write;

use crate::cases::{cases, each_change};
use crate::mesh_shapes::{corners, cuboid};

const SIDES: DVec3 = DVec3::new(0.25, 0.5, 1.0);

fn read(format: MeshFormat, bytes: &[u8]) -> bubbletouch_sim::Result<TriangleMesh> {
    format
        .read("m", None, &SizeLimits::ANY, bytes)?
        .into_mesh("m")
}

#[track_caller]
fn assert_same(mesh: &TriangleMesh, expected: &[DVec3]) {
    let own = corners(mesh);
    assert_eq!(own.len(), expected.len());
    for (own, expected) in own.iter().zip(expected) {
        assert!((own - expected).length() < 1e-15, "{own}, {expected}");
    }
}

/// Returns a Collada file of a cuboid; `primitives` are its faces, `unit` an element of `<asset>`, and `nodes` the nodes of the scene.
fn collada(unit: &str, primitives: &str, nodes: &str) -> String {
    let cube = cuboid(SIDES);
    let points: String = cube.vertices().iter().fold(String::new(), |mut text, v| {
        write!(text, "{} {} {} ", v.x, v.y, v.z).unwrap();
        text
    });
    let count = cube.vertices().len();
    format!(
        r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{unit}<up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="box"><mesh>
<source id="points"><float_array id="numbers" count="{n}">{points}</float_array>
<technique_common><accessor source="#numbers" count="{count}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<source id="normals"><float_array id="other" count="3">0 0 1</float_array></source>
<vertices id="vertices"><input semantic="POSITION" source="#points"/></vertices>
{primitives}
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##,
        n = 3 * count
    )
}

/// Returns the faces of the cuboid as `<triangles>` with an index of a normal beside each vertex.
fn triangles() -> String {
    let cube = cuboid(SIDES);
    let corners = cube.triangles().iter().flatten();
    let corners: String = corners.fold(String::new(), |mut text, corner| {
        write!(text, "{corner} 0 ").unwrap();
        text
    });
    format!(
        r##"<triangles count="{}"><input semantic="VERTEX" source="#vertices" offset="0"/><input semantic="NORMAL" source="#normals" offset="1"/><p>{corners}</p></triangles>"##,
        cube.n_triangles()
    )
}

const NODE: &str = r##"<node><instance_geometry url="#box"/></node>"##;

#[test]
fn collada_files_have_their_unit_and_keep_their_axes() {
    let cube = corners(&cuboid(SIDES));
    for (unit, metres) in [("", 1.0), (r#"<unit name="inch" meter="0.0254"/>"#, 0.0254)] {
        let text = collada(unit, &triangles(), NODE);
        let expected: Vec<DVec3> = cube.iter().map(|corner| *corner * metres).collect();
        assert_same(
            &read(MeshFormat::Collada, text.as_bytes()).unwrap(),
            &expected,
        );
        // A unit from the user replaces the unit of the file.
        let unit = Some(LengthUnit::Millimetre);
        let file = MeshFormat::Collada.read("m", unit, &SizeLimits::ANY, text.as_bytes());
        let expected: Vec<DVec3> = cube.iter().map(|corner| *corner * 1e-3).collect();
        assert_same(&file.unwrap().into_mesh("m").unwrap(), &expected);
    }
}

#[test]
fn collada_polygons_of_all_kinds_are_one_mesh() {
    let input = r##"<input semantic="VERTEX" source="#vertices" offset="0"/>"##;
    let quads = "0 4 6 2, 1 3 7 5, 0 1 5 4, 2 6 7 3, 0 2 3 1, 4 5 7 6";
    let all: Vec<&str> = quads.split(", ").collect();
    let lists: String = all.iter().map(|quad| format!("<p>{quad}</p>")).collect();
    let quad_list = format!(
        "<polylist count=\"6\">{input}<vcount>4 4 4 4 4 4</vcount><p>{}</p></polylist>",
        all.join(" ")
    );
    let fans =
        format!("<lines count=\"1\">{input}<p>0 1</p></lines><trifans>{input}{lists}</trifans>");
    // The last two corners of a strip have the opposite order: the characters are `a b c d`.
    let strip = |quad: &&str| format!("<p>{} {} {}</p>", &quad[..3], &quad[6..], &quad[4..5]);
    let strips: String = all.iter().map(strip).collect();
    for primitives in [
        quad_list,
        fans,
        format!("<polygons count=\"6\">{input}{lists}</polygons>"),
        format!("<tristrips count=\"6\">{input}{strips}</tristrips>"),
    ] {
        let text = collada("", &primitives, NODE);
        let mesh = read(MeshFormat::Collada, text.as_bytes()).unwrap();
        assert_eq!(mesh.n_triangles(), 12);
        let (volume, _) = mesh.volume_and_centroid();
        assert!((volume - 1.0).abs() < 1e-14, "{primitives}: {volume}");
    }
}

/// Transform of two nodes inside each other: moved by (1, 2, 3), turned by a quarter about z, mirrored along x, and scaled along z.
fn placed(corner: DVec3) -> DVec3 {
    let turned =
        DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2) * (corner * DVec3::new(-1.0, 1.0, 2.0));
    turned + DVec3::new(1.0, 2.0, 3.0)
}

#[test]
fn transforms_of_collada_nodes_are_applied_and_mirrored_faces_stay_outward() {
    let inner = r##"<node><scale>-1 1 2</scale><instance_geometry url="#box"/></node>"##;
    let by_parts =
        format!("<node><translate>1 2 3</translate><rotate>0 0 2 90</rotate>{inner}</node>");
    let by_matrix =
        format!("<node><matrix>0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1</matrix>{inner}</node>");
    for nodes in [by_parts.clone(), by_matrix] {
        let text = collada("", &triangles(), &nodes);
        check_placed(&read(MeshFormat::Collada, text.as_bytes()).unwrap());
    }
    // Two instances of one geometry, one of them through another node.
    let twice = format!(
        "{by_parts}<node id=\"n\"><instance_geometry url=\"#box\"/></node><node><translate>5 0 0</translate><instance_node url=\"#n\"/></node>"
    );
    let text = collada("", &triangles(), &twice);
    let mesh = read(MeshFormat::Collada, text.as_bytes()).unwrap();
    assert_eq!(mesh.n_triangles(), 36);
    let last = mesh.moved(&Pose::from_translation(DVec3::new(-5.0, 0.0, 0.0)));
    assert_eq!(corners(&last)[72..], corners(&cuboid(SIDES)));
}

/// Checks the places of the corners, and that the triangles of the mirrored cuboid face outwards.
fn check_placed(mesh: &TriangleMesh) {
    let mut own = corners(mesh);
    let mut expected: Vec<DVec3> = corners(&cuboid(SIDES)).into_iter().map(placed).collect();
    let by_place = |a: &DVec3, b: &DVec3| a.to_array().partial_cmp(&b.to_array()).unwrap();
    let rounded = |all: &mut Vec<DVec3>| {
        all.iter_mut()
            .for_each(|corner| *corner = (*corner * 1e9).round());
        all.sort_by(by_place);
    };
    let center = DVec3::new(1.0, 2.0, 3.0);
    for t in 0..mesh.n_triangles() {
        let [a, b, c] = mesh.triangle(t).0;
        assert!(
            (b - a).cross(c - a).dot(a - center) > 0.0,
            "{t} faces inwards"
        );
    }
    rounded(&mut own);
    rounded(&mut expected);
    assert_eq!(own, expected);
}

#[test]
fn comments_and_byte_order_marks_of_scene_files_change_nothing() {
    let good = collada("", &triangles(), NODE);
    let commented = good.replacen("-0.25 ", "<!-- x --> -0.25 <!-- y --> ", 1);
    let (description, buffer) = gltf();
    let mut inside = description.clone();
    inside["buffers"][0]["uri"] =
        format!("data:application/octet-stream;base64,{}", base64(&buffer)).into();
    check_placed(&read(MeshFormat::Gltf, format!("\u{feff}{inside}").as_bytes()).unwrap());
    let marked = format!("\u{feff}{commented}");
    let wide = marked.encode_utf16().flat_map(u16::to_le_bytes);
    for bytes in [marked.clone().into_bytes(), wide.collect()] {
        let mesh = read(MeshFormat::Collada, &bytes).unwrap();
        assert_same(&mesh, &corners(&cuboid(SIDES)));
    }
}

#[test]
fn ids_that_meshes_repeat_mean_those_of_the_own_mesh() {
    let good = collada("", &triangles(), NODE);
    let (start, end) = (
        good.find("<geometry").unwrap(),
        good.find("</library_geometries>").unwrap(),
    );
    // A smaller geometry with the same ids before the one of the scene.
    let other = good[start..end]
        .replacen("id=\"box\"", "id=\"other\"", 1)
        .replace("0.25", "0.125");
    let both = [&good[..start], &other, &good[start..]].concat();
    let mesh = read(MeshFormat::Collada, both.as_bytes()).unwrap();
    assert_same(&mesh, &corners(&cuboid(SIDES)));
}

#[test]
fn wrong_collada_files_are_refused_with_the_line() {
    let good = collada("", &triangles(), NODE);
    let circle = r##"<node id="a"><node><instance_node url="#a"/></node></node>"##;
    let refuse = |text: &str, said: &str| {
        let error = read(MeshFormat::Collada, text.as_bytes()).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        let error = error.to_string();
        assert!(
            error.starts_with('m') && error.contains(said),
            "{said}: {error}"
        );
    };
    refuse(&good[..good.len() / 2], "well-formed XML");
    refuse("", "m: an empty file; Collada: a <COLLADA>");
    refuse("<mujoco/>", "<mujoco> as the root; a <COLLADA>");
    refuse(
        &collada("", &triangles(), circle),
        "nodes inside each other",
    );
    let doubled = |n: usize| {
        let next = format!("<instance_node url=\"#n{}\"/>", n + 1);
        format!("<node id=\"n{n}\">{next}{next}</node>")
    };
    let doubled: String = (0..60).map(doubled).collect();
    let doubled = doubled + "<node id=\"n60\"/>";
    refuse(
        &collada("", &triangles(), &doubled),
        "more than 1000000 nodes",
    );
    let unit = collada("<unit meter=\"0\"/>", &triangles(), NODE);
    refuse(&unit, "`meter` 0; positive lengths in metres");
    refuse(&collada("", "", NODE), "no faces");
    // A text of the file, what replaces it, and a part of the error.
    let changes = r##"count="24" | count="30" | line 4: <float_array> with `count` 30, but 24 numbers
        count="8" | count="9" | 9 points with `stride` 3, but 24 numbers
        -0.25 | nan | line 4: <float_array>, number 1: "nan"; finite numbers
        -0.25 | 1e999 | finite numbers
        <p>0 0 4 | <p>0 0 99 | face 1: vertex indices [0, 99, 
        <p>0 0 4 | <p>0 0 -4 | number 3: "-4"; whole numbers from 0
        <p>0 0 4 0 | <p>0 0 4 | indices for 2 inputs
        <triangles count="12" | <triangles count="11" | `count` 11, but 12 faces
        semantic="VERTEX" | semantic="NORMAL" | without an <input semantic="VERTEX">
        semantic="POSITION" | semantic="NORMAL" | <vertices> without an <input semantic="POSITION">
        url="#box" | url="#bx" | `url` "#bx"
        <node> | <node><matrix>1 0 0</matrix> | <matrix> with 3 numbers
        <node> | <node><rotate>0 0 0 90</rotate> | axis of length zero
        <node> | <node><skew>0 0 0 0 0 0 0</skew> | <skew>"##;
    each_change(&good, changes, refuse);
}

/// Returns the description and the buffer of a glTF file of the cuboid: positions as f32 and indices as u16.
fn gltf() -> (Value, Vec<u8>) {
    let cube = cuboid(SIDES);
    let mut buffer = Vec::new();
    for v in cube.vertices() {
        buffer.extend(v.to_array().map(|x| (x as f32).to_le_bytes()).concat());
    }
    let n_bytes = buffer.len();
    for corner in cube.triangles().iter().flatten() {
        buffer.extend((*corner as u16).to_le_bytes());
    }
    let description = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "translation": [1.0, 2.0, 3.0], "rotation": [0.0, 0.0, 0.5f64.sqrt(), 0.5f64.sqrt()], "children": [1] },
            { "scale": [-1.0, 1.0, 2.0], "mesh": 0 },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 7 }, "indices": 1, "mode": 4 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": n_bytes },
            { "buffer": 0, "byteOffset": n_bytes, "byteLength": buffer.len() - n_bytes },
        ],
        "buffers": [{ "byteLength": buffer.len() }],
    });
    (description, buffer)
}

fn glb(description: &Value, buffer: &[u8]) -> Vec<u8> {
    let mut json = serde_json::to_vec(description).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = buffer.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = 12 + 8 + json.len() + 8 + binary.len();
    let mut bytes = b"glTF".to_vec();
    for number in [2, length as u32, json.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((binary.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(binary);
    bytes
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let groups = bytes.chunks(3).map(|group| {
        let bits = group
            .iter()
            .fold(0, |bits, &byte| bits << 8 | u32::from(byte))
            << (8 * (3 - group.len()));
        let letters = (0..4).map(|at| match at <= group.len() {
            true => char::from(LETTERS[(bits >> (18 - 6 * at)) as usize & 63]),
            false => '=',
        });
        letters.collect::<String>()
    });
    groups.collect()
}

#[test]
fn gltf_files_are_read_with_buffers_inside_beside_and_in_the_address() {
    let (description, buffer) = gltf();
    check_placed(&read(MeshFormat::Gltf, &glb(&description, &buffer)).unwrap());
    let mut inside = description.clone();
    inside["buffers"][0]["uri"] =
        format!("data:application/octet-stream;base64,{}", base64(&buffer)).into();
    check_placed(&read(MeshFormat::Gltf, inside.to_string().as_bytes()).unwrap());
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my däta.bin"), &buffer).unwrap();
    let mut beside = description.clone();
    beside["buffers"][0]["uri"] = "my%20d%C3%A4ta.bin".into();
    let place = folder.path().join("m.gltf").display().to_string();
    let read_there = |description: &Value| {
        let text = description.to_string();
        MeshFormat::Gltf.read(&place, None, &SizeLimits::ANY, text.as_bytes())
    };
    check_placed(&read_there(&beside).unwrap().into_mesh("m").unwrap());
    beside["buffers"][0]["uri"] = "none.bin".into();
    let missing = read_there(&beside).unwrap_err();
    assert_eq!(missing.exit_code(), 2);
    assert!(missing.to_string().contains("buffer 0: "), "{missing}");
}

#[test]
fn wrong_gltf_files_are_refused_with_the_part() {
    let (description, buffer) = gltf();
    let whole = glb(&description, &buffer);
    for length in (0..whole.len()).step_by(7) {
        let error = read(MeshFormat::Gltf, &whole[..length]).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{length}: {error}");
    }
    let mut nan = buffer.clone();
    nan[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut far = buffer.clone();
    far[96..98].copy_from_slice(&999u16.to_le_bytes());
    let with = |pointer: &str, value: Value| {
        let mut changed = description.clone();
        *changed.pointer_mut(pointer).expect(pointer) = value;
        glb(&changed, &buffer)
    };
    let refuse = |bytes: &[u8], said: &str| {
        let error = read(MeshFormat::Gltf, bytes).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        let error = error.to_string();
        assert!(
            error.starts_with('m') && error.contains(said),
            "{said}: {error}"
        );
    };
    refuse(
        &glb(&description, &nan),
        "accessor 0: element 0: NaN; finite numbers",
    );
    let said = "mesh 0, primitive 0: face 1: vertex indices [999, ";
    refuse(&glb(&description, &far), said);
    // The place of a value in the description, another value, and a part of the error.
    let changes = r#"/accessors/0/count | 9 | accessor 0: 9 elements
        /accessors/0/count | 0 | accessor 0: 0 elements
        /accessors/0/count | 18446744073709551615 | accessor 0: 
        /accessors/1/count | 35 | 35 corners of triangles
        /accessors/0/type | "VEC2" | accessor 0: `type` VEC2; VEC3
        /accessors/1/componentType | 5126 | vertex indices with `componentType` 5126
        /accessors/0/componentType | 7 | `componentType` 7
        /bufferViews/1/byteOffset | 4000 | accessor 1: 36 elements
        /bufferViews/1/buffer | 3 | buffer 3; 0 to 0
        /buffers/0/byteLength | 4000 | buffer 0: 168 bytes; `byteLength` 4000
        /nodes/1/mesh | 1 | mesh 1; 0 to 0
        /nodes/1/scale | [1.0, 1.0] | invalid length
        /nodes/0/rotation | [0.0, 0.0, 0.0, 0.0] | node 0: a transform that is not affine
        /nodes/0/children | [0] | nodes inside each other
        /nodes/0/children | [7] | node 7; 0 to 1
        /scene | 2 | scene 2; 0 to 0
        /meshes/0/primitives/0/mode | 1 | no faces"#;
    for [pointer, value, said] in cases(changes) {
        let value = serde_json::from_str(&value).unwrap();
        refuse(&with(&pointer, value), &said);
    }
    let mut packed = description.clone();
    packed["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let error = read(MeshFormat::Gltf, &glb(&packed, &buffer))
        .unwrap_err()
        .to_string();
    assert!(error.contains("KHR_draco_mesh_compression"), "{error}");
}
