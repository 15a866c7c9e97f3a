//! No file content makes a reader panic, hang or exhaust the memory.

use crate::fuzzing::{SOON, Target};
use bubbletouch::geometry::Pose;
use bubbletouch::kinds;
use bubbletouch::kinds::object_detail::{ObjectDetailPlan, ObjectDetailStudySpec};
use bubbletouch::kinds::reconstruction::{ReconstructionPlan, ReconstructionStudySpec};
use bubbletouch::kinds::stability::{StabilityPlan, StabilityStudySpec};
use bubbletouch::kinds::whole_body::{WholeBodyPlan, WholeBodyStudySpec};
use bubbletouch::mesh::{LengthUnit, MeshFormat, SizeLimits};
use bubbletouch::objects::{Catalogue, read_spheres};
use bubbletouch::report::advice::{AdviceQuery, Candidates, Requirement};
use bubbletouch::report::comparison::compared::Comparison;
use bubbletouch::report::comparison::differences::differences;
use bubbletouch::report::folder::{table_files, write_files};
use bubbletouch::scene::{ScenePlan, SceneSpec};
use bubbletouch::studies::recognition::charts::{read_tables, tables_of};
use bubbletouch::study::journal::{Identity, Journal};
use bubbletouch::study::{Plan, StudySpec, write_npy};
use bubbletouch::table::Table;
use bubbletouch::world::{Interpolation, PoseTrajectory, Robot};
use bubbletouch::{Error, Result};
use ndarray::Array3;
use std::fs;
use std::path::{Path, PathBuf};

const PLACE: &str = "input";

/// TOML and XML are read as trees. A node takes up to 1.1 kB, because a TOML table has space for eleven entries from its first one. In `a.a.a.a = 1`, a node
/// takes two characters of text, which is 550 bytes per character.
const TREE: usize = 600;

/// The end of each field of a CSV row takes eight bytes, twice while the list grows, and one character of text: `,,,,,`.
const FIELDS: usize = 64;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Returns the files of a folder with an extension and a maximum length.
fn files(name: &str, ending: &str, longest: usize) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder(name)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let is_it = |path: &PathBuf| path.extension().is_some_and(|e| e == ending);
    let contents = paths
        .into_iter()
        .filter(is_it)
        .map(|path| fs::read(path).unwrap());
    let found: Vec<_> = contents
        .filter(|content| content.len() <= longest)
        .collect();
    assert!(!found.is_empty(), "{name}");
    found
}

fn text_of(input: &[u8]) -> Result<&str> {
    std::str::from_utf8(input).map_err(|e| Error::input(PLACE, e, "a text file"))
}

#[test]
fn studies() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames.npy");
    write_npy(&frames, &Array3::<f32>::zeros((44, 28, 50))).unwrap();
    let frames = frames.display().to_string();
    // A plan of recorded frames reads their shape. There are frames of one sensor, and no test set.
    let is_planned = |seed: &Vec<u8>| {
        let text = String::from_utf8_lossy(seed);
        !text.contains("[[recorded.sensors]]") && !text.contains("frames_test")
    };
    let with_frames = |seed: Vec<u8>| {
        let text = String::from_utf8(seed).unwrap();
        text.replace("frames.npy\"\n", &format!("{frames}\"\n"))
            .into_bytes()
    };
    let seeds = files("experiments", "toml", 12_000).into_iter();
    let seeds: Vec<Vec<u8>> = seeds.filter(is_planned).map(with_frames).collect();
    assert!(seeds.len() > 10);
    Target {
        name: "study",
        seeds,
        words: &[
            "[recognition]\n",
            "[whole_body]\n",
            "[stability]\n",
            "[object_detail]\n",
            "[reconstruction]\n",
            "[human_touch]\n",
            "[recorded]\n",
            "[signal]\n",
            "taxels",
            "size_mm",
            "uniform",
            "grid",
            "folds",
            "trials",
            "projections_per_split",
            "linear_svm",
            "[]",
            "[[]]",
            "{}",
            "= [1,2,3]\n",
            "1979-05-27T07:32:00Z",
            "true",
            "\"\"\"",
        ],
        n_inputs: 2000,
        // A plan lists its values, such as { grid = [-10, 10, 1000] }, which is a short text.
        most_bytes: (TREE, 8 << 20),
        least_s: SOON,
        read: &read_study,
    }
    .run();
}

fn read_study(input: &[u8]) -> Result<()> {
    let text = text_of(input)?;
    match kinds::about(text).map(|about| about.table) {
        Some("object_detail") => {
            let spec = ObjectDetailStudySpec::parse(PLACE, text)?;
            ObjectDetailPlan::new(PLACE, spec).map(drop)
        }
        Some("reconstruction") => {
            let spec = ReconstructionStudySpec::parse(PLACE, text)?;
            ReconstructionPlan::new(PLACE, spec).map(drop)
        }
        Some("whole_body") => {
            let spec = WholeBodyStudySpec::parse(PLACE, text)?;
            WholeBodyPlan::new(PLACE, &folder("experiments"), spec).map(drop)
        }
        Some("stability") => {
            let spec = StabilityStudySpec::parse(PLACE, text)?;
            StabilityPlan::new(PLACE, Path::new(""), spec).map(drop)
        }
        _ => Plan::new(PLACE, StudySpec::parse(PLACE, text)?).map(drop),
    }
}

#[test]
fn scenes() {
    let scenes = folder("experiments/scenes");
    Target {
        name: "scene",
        seeds: files("experiments/scenes", "toml", 12_000),
        words: &[
            "[[object]]\n",
            "[[patch]]\n",
            "[[robot]]\n",
            "motion",
            "phases",
            "way_points",
            "grid",
            "cylinder",
            "rotation_deg",
            "position_mm",
            "csv",
            "mesh",
            "[]",
            "{}",
            "= [1,2,3]\n",
            "true",
        ],
        n_inputs: 300,
        // Files named in a scene are also read: a robot, packed objects, and the taxels of its skin (at most four million of 200 bytes).
        most_bytes: (TREE, 900 << 20),
        // A patch may have four million taxels, which take about a microsecond each.
        least_s: 10.0,
        read: &|input| {
            ScenePlan::new(PLACE, &scenes, SceneSpec::parse(PLACE, text_of(input)?)?).map(drop)
        },
    }
    .run();
}

#[test]
fn objects() {
    let lollipop = include_str!("../fixtures/texts/fuzz_lollipop.toml");
    let mut seeds = files("objects", "toml", 60_000);
    seeds.extend(std::iter::repeat_n(
        lollipop.as_bytes().to_vec(),
        seeds.len(),
    ));
    Target {
        name: "object",
        seeds,
        words: &[
            "[[object]]\n",
            "[[object.part]]\n",
            "shape",
            "ball",
            "cylinder",
            "block",
            "lathe",
            "prism",
            "torus",
            "profile_mm",
            "outline_mm",
            "diameter_mm",
            "height_mm",
            "rotation_deg",
            "[]",
            "[[0,0],[1,1]]",
            "{}",
        ],
        n_inputs: 1000,
        most_bytes: (TREE, 1 << 18),
        least_s: SOON,
        read: &|input| Catalogue::parse("set", PLACE, text_of(input)?).map(drop),
    }
    .run();
}

/// Tetrahedron; the three samples together use all features of the three formats.
const PLY: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n\
    property double z\nproperty uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 255\n1 0 0 0\n0 1 0 7\n0 0 1 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

fn binary_ply(order: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar uint vertex_index\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    let is_little = order == "little";
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    for number in corners {
        bytes.extend(if is_little {
            number.to_le_bytes()
        } else {
            number.to_be_bytes()
        });
    }
    bytes.push(3);
    for index in 0..3_u32 {
        bytes.extend(if is_little {
            index.to_le_bytes()
        } else {
            index.to_be_bytes()
        });
    }
    bytes
}

const OBJ: &str = "# a square\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nusemtl red\n\
    f 1/1/1 2/1/1 3/1/1 4//1\nf -4 -3 -2\nl 1 2\np 1\n";

const STL: &str = "solid thing\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-3 0\nendloop\nendfacet\n\
    facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid thing\n";

fn binary_stl(n_triangles: u32) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(n_triangles.to_le_bytes());
    for triangle in 0..n_triangles {
        let corner = |k: u32| [(triangle + k) as f32, (k % 2) as f32, (k / 2) as f32];
        let numbers = [[0.0; 3], corner(0), corner(1), corner(2)];
        bytes.extend(
            numbers
                .iter()
                .flatten()
                .flat_map(|number| number.to_le_bytes()),
        );
        bytes.extend([0, 0]);
    }
    bytes
}

fn mesh(
    name: &'static str,
    format: MeshFormat,
    seeds: Vec<Vec<u8>>,
    words: &'static [&'static str],
) {
    Target {
        name,
        seeds,
        words,
        n_inputs: 3000,
        // A PLY header may claim any number of elements; the reader allocates memory for the first 65,536.
        most_bytes: (20, 4 << 20),
        least_s: SOON,
        read: &|input| {
            let file = format.read(PLACE, Some(LengthUnit::Millimetre), &SizeLimits::ANY, input)?;
            file.into_mesh(PLACE).map(drop)
        },
    }
    .run();
}

#[test]
fn meshes_in_ply() {
    let seeds = vec![
        PLY.as_bytes().to_vec(),
        binary_ply("little"),
        binary_ply("big"),
    ];
    let words: &[&str] = &[
        "element vertex 4000000000\n",
        "element face 3\n",
        "element other 9\n",
        "property list uint uint vertex_indices\n",
        "property float x\n",
        "property list float float vertex_index\n",
        "end_header\n",
        "comment",
        "obj_info",
        "format ascii 1.0\n",
        "format binary_little_endian 1.0\n",
    ];
    mesh("ply", MeshFormat::Ply, seeds, words);
}

#[test]
fn meshes_in_obj() {
    let words: &[&str] = &[
        "v ",
        "f ",
        "vn ",
        "g ",
        "s off\n",
        "/",
        "//",
        "-1",
        "\\\n",
        "f 1 2 3 4 5 6 7 8 9\n",
    ];
    mesh("obj", MeshFormat::Obj, vec![OBJ.as_bytes().to_vec()], words);
}

#[test]
fn meshes_in_stl() {
    let seeds = vec![STL.as_bytes().to_vec(), binary_stl(2), binary_stl(40)];
    let words: &[&str] = &[
        "solid",
        "facet normal ",
        "outer loop\n",
        "vertex ",
        "endloop\n",
        "endfacet\n",
        "endsolid\n",
    ];
    mesh("stl", MeshFormat::Stl, seeds, words);
}

const COLLADA: &str = r##"<COLLADA><asset><unit meter="0.01"/></asset><library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="f" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source="#f" count="3" stride="3"><param name="X"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>3</vcount><p>0 1 2</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="c"><node id="n"><translate>1 0 0</translate><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#c"/></scene></COLLADA>"##;

#[test]
fn meshes_in_collada() {
    let words: &[&str] = &[
        "<node>",
        "</node>",
        "<instance_node url=\"#n\"/>",
        "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>",
        "<scale>-1 1 1</scale>",
        "<trifans>",
        "count=\"4000000000\"",
        "stride=\"0\"",
        "offset=\"99999999999\"",
        "nan",
        "-1",
    ];
    let seeds = vec![COLLADA.as_bytes().to_vec()];
    mesh("collada", MeshFormat::Collada, seeds, words);
}

const GLTF: &str = r#"{"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1]},{"scale":[-1,1,1],"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":4}]}],
"accessors":[{"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":12}],"buffers":[{"byteLength":12,"uri":"data:;base64,AAAAfwAAAH8AAAAA"}]}"#;

#[test]
fn meshes_in_gltf() {
    let mut binary = b"glTF".to_vec();
    let json = GLTF.as_bytes();
    for number in [2, 20 + json.len() as u32, json.len() as u32] {
        binary.extend(number.to_le_bytes());
    }
    binary.extend(b"JSON");
    binary.extend(json);
    let words: &[&str] = &[
        "\"indices\":0,",
        "\"sparse\":{},",
        "\"byteStride\":3,",
        "\"byteOffset\":18446744073709551615,",
        "\"count\":4000000000,",
        "\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],",
        "[0,0,1]",
        "5126",
        "1e999",
    ];
    let seeds = vec![json.to_vec(), binary];
    mesh("gltf", MeshFormat::Gltf, seeds, words);
}

#[test]
fn models_of_mujoco() {
    let mut seeds = files("objects/robots", "xml", 20_000);
    seeds.push(
        br#"<mujoco><default><joint axis="1 0 0"/></default><worldbody><frame euler="1 2 3"><body><freejoint/></body></frame>
<replicate count="3" offset="1 0 0"><body name="b"><joint type="ball"/><joint/><geom fromto="0 0 0 1 1 1" type="capsule" size="1"/></body></replicate></worldbody></mujoco>"#
            .to_vec(),
    );
    Target {
        name: "mjcf",
        seeds,
        words: &[
            "<body name=\"a\">",
            "</body>",
            "<joint name=\"a\"/>",
            "<freejoint/>",
            "<include file=\"a.xml\"/>",
            "<replicate count=\"100\">",
            "</replicate>",
            "<frame zaxis=\"0 0 1\">",
            "</frame>",
            "childclass=\"a\"",
            "<default class=\"a\">",
            "</default>",
            "<equality><joint joint1=\"a\" joint2=\"a\"/></equality>",
            "<compiler eulerseq=\"XYZ\"/>",
            "type=\"ball\"",
            "nan",
            "1e999",
        ],
        n_inputs: 2000,
        most_bytes: (TREE, 1 << 28),
        least_s: SOON,
        read: &|input| {
            let robot = Robot::from_mjcf(PLACE, text_of(input)?)?;
            robot
                .forward(&Pose::IDENTITY, &robot.rest_positions())
                .map(drop)
        },
    }
    .run();
}

#[test]
fn robots() {
    let mut seeds = files("crates/bubbletouch-sim/tests/robots", "urdf", 20_000);
    seeds.extend(files("objects/robots", "urdf", 20_000));
    Target {
        name: "urdf",
        seeds,
        words: &[
            "<link name=\"a\"/>",
            "<joint name=\"a\" type=\"fixed\">",
            "</joint>",
            "<parent link=\"a\"/>",
            "<mimic joint=\"a\"/>",
            "<origin xyz=\"0 0 0\"/>",
            "revolute",
            "continuous",
            "planar",
            "floating",
            "<!-- ",
            " -->",
            "<![CDATA[",
            "]]>",
            "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]>",
            "&a;",
            "&b;",
            "&#0;",
            "&lt;",
            "xmlns:xacro=\"http://www.ros.org/wiki/xacro\"",
            "<sphere radius=\"1\"/>",
            "<mesh filename=\"a.stl\"/>",
        ],
        n_inputs: 2000,
        most_bytes: (TREE, 1 << 18),
        least_s: SOON,
        read: &|input| {
            let robot = Robot::from_urdf(PLACE, text_of(input)?)?;
            robot
                .forward(&Pose::IDENTITY, &vec![0.0; robot.n_positions()])
                .map(drop)
        },
    }
    .run();
}

#[test]
fn spheres() {
    Target {
        name: "spheres",
        seeds: vec![
            b"x,y,z,r\n0,0,0,0.01\n0.02,-1e-3,5,1\n".to_vec(),
            b"0,0,0,0.01\n0.02,-1e-3,5,1\n".to_vec(),
            b"name,r,z,y,x\n\"a \"\"b\"\"\", 0.1 ,0,0,0\n".to_vec(),
        ],
        words: &[",", "\"", "x", "r", "\n", ",,,,", "0.5"],
        n_inputs: 4000,
        most_bytes: (FIELDS, 1 << 18),
        least_s: SOON,
        read: &|input| read_spheres(PLACE, None, &SizeLimits::ANY, input).map(drop),
    }
    .run();
}

#[test]
fn way_points() {
    Target {
        name: "way_points",
        seeds: vec![
            b"time_s,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n0,0,0,0,0,0,0\n1,10,0,-5,0,0,90\n2,0,1,2,3,4,5\n".to_vec(),
            b"time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1.5,10,0,-5,0,0.6,0,0.8\n".to_vec(),
        ],
        words: &[",", "\"", "time_s", "x_mm", "qw", "\n", "yaw_deg"],
        n_inputs: 4000,
        most_bytes: (FIELDS, 1 << 18),
        least_s: SOON,
        read: &|input| {
            let trajectory = PoseTrajectory::read_csv(PLACE, input, Interpolation::default())?;
            let pose = trajectory.pose_at(0.5 * trajectory.end());
            assert!(pose.translation.is_finite());
            Ok(())
        },
    }
    .run();
}

/// Returns the tables of a study of two small configurations.
fn study_tables() -> Vec<Table> {
    const TEXT: &str = include_str!("../fixtures/texts/fuzz_text.toml");
    tables_of(&crate::study::Study::new(TEXT).run()).unwrap()
}

#[test]
fn tables_of_results() {
    let tables = study_tables();
    let at = folder_in_memory();
    write_files(at.path(), table_files(&tables)).unwrap();
    // The first byte of an input selects the table.
    let files = tables.iter().filter(|table| !table.csv.is_empty());
    let names: Vec<&str> = files.map(|table| table.file).collect();
    let seeds = names.iter().enumerate().map(|(number, name)| {
        let content = fs::read(at.path().join(name)).unwrap();
        [vec![number as u8], content].concat()
    });
    Target {
        name: "table",
        seeds: seeds.collect(),
        words: &[
            ",",
            "\"",
            "\n",
            "configuration",
            "accuracy",
            "linear_svm",
            "rbf_svm",
            "gaussian",
            "split",
            "true",
            ",,",
        ],
        n_inputs: 800,
        most_bytes: (FIELDS, 1 << 20),
        least_s: SOON,
        read: &|input| {
            let Some((number, content)) = input.split_first() else {
                return Ok(());
            };
            let path = at.path().join(names[usize::from(*number) % names.len()]);
            let valid = fs::read(&path).unwrap();
            fs::write(&path, content).unwrap();
            let read = read_tables(at.path());
            fs::write(&path, valid).unwrap();
            let read = read?;
            let offers = Candidates::new(&read, &AdviceQuery::default())?;
            for choices in offers.by_condition() {
                let advice = offers.advise(&choices, Requirement::Budget(1.0));
                advice.map(|advice| offers.in_words(&advice.choice)).ok();
            }
            let found = differences(&tables, &read)?;
            let comparison = Comparison::new([&tables, &read], ["a", "b"], (found, None))?;
            comparison.text(80);
            Ok(())
        },
    }
    .run();
}

#[test]
fn journals() {
    let at = folder_in_memory();
    let path = at.path().join("journal.jsonl");
    let identity = Identity::new(
        "seed = 1\n[skin]\npitch_mm = 2.0\n".to_owned(),
        Default::default(),
        Default::default(),
    );
    let journal = Journal::open(&path, &identity).unwrap();
    journal.keep("cell 0, trial 0", &vec![0.5, 1.5]).unwrap();
    journal.keep("cell 1, trial 0", &"failed: \"so\"").unwrap();
    drop(journal);
    Target {
        name: "journal",
        seeds: vec![fs::read(&path).unwrap()],
        words: &[
            "{\"key\":\"study\",\"record\":",
            "}",
            "\n",
            "\\u0000",
            "\"",
            "null",
            "00000000 {}\n",
        ],
        n_inputs: 1200,
        // The study inside a journal is TOML.
        most_bytes: (TREE, 1 << 18),
        least_s: SOON,
        read: &|input| {
            let read = |content: &[u8]| {
                fs::write(&path, content).unwrap();
                let read = Journal::read(&path)?;
                if let Some((_, journal)) = read {
                    let _: Option<Vec<f64>> = journal.get("cell 0, trial 0");
                }
                Journal::open(&path, &identity).map(drop)
            };
            // A correct checksum makes the rest of a line reachable.
            let as_it_is = read(input);
            read(&with_checksums(input)).and(as_it_is)
        },
    }
    .run();
}

/// Replaces the checksum of every line by the correct one; later lines continue the checksum of the first line.
fn with_checksums(input: &[u8]) -> Vec<u8> {
    let mut first = None;
    let line = |line: &[u8]| -> Vec<u8> {
        let json = line
            .splitn(2, |&byte| byte == b' ')
            .nth(1)
            .unwrap_or_default();
        let whole = json.strip_suffix(b"\n").unwrap_or(json);
        let sum = crc32(first.unwrap_or(0), whole);
        first.get_or_insert(sum);
        [format!("{sum:08x} ").as_bytes(), json].concat()
    };
    input
        .split_inclusive(|&byte| byte == b'\n')
        .flat_map(line)
        .collect()
}

/// Returns the CRC-32 as in zip, computed bit by bit, of bytes that follow the bytes of another checksum; the checksum of no bytes is 0.
fn crc32(before: u32, bytes: &[u8]) -> u32 {
    let mut sum = !before;
    for byte in bytes {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = (sum >> 1) ^ (0xedb8_8320 & (sum & 1).wrapping_neg());
        }
    }
    !sum
}

/// Creates a folder in memory if the system has one.
fn folder_in_memory() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    match memory.is_dir() {
        true => tempfile::tempdir_in(memory).unwrap(),
        false => tempfile::tempdir().unwrap(),
    }
}
