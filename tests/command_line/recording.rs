//! `bubbletouch recording`: the contents of a file as a table, a picture and an animation. NumPy can open the file.

use crate::command::{Case, says, skip};
use crate::stored::{frame, normal, vectors};
use bubbletouch::geometry::Pose;
use bubbletouch::report::recording::{ForceKind, RecordedPatch, RecordingHeader, RecordingWriter};
use bubbletouch::world::Grid;
use glam::DVec3;
use std::process::Command;

/// Writes 30 frames of a grid of 4 × 3 taxels and of a ring of 20 taxels, with one object.
fn recorded() -> Case {
    let case = Case::new();
    let grid = Grid {
        nx: 4,
        ny: 3,
        pitch: 2e-3,
    };
    let axis = |i: i32| DVec3::new((0.3 * f64::from(i)).cos(), (0.3 * f64::from(i)).sin(), 0.0);
    let axes: Vec<DVec3> = (0..20).map(axis).collect();
    let finger = RecordedPatch {
        name: "finger".to_owned(),
        centers: axes.iter().map(|axis| 0.01 * axis).collect(),
        axes,
        grid: None,
        force: ForceKind::Vector,
        signal: None,
    };
    let palm = RecordedPatch::of_grid("palm", grid, ForceKind::Normal);
    let header = RecordingHeader {
        patches: vec![palm, finger],
        objects: vec!["mug".to_owned()],
        about: serde_json::json!({"seed": 2018}),
    };
    let mut writer = RecordingWriter::create(&case.path("touch.npz"), header).unwrap();
    for k in 0..30 {
        let mut palm = [0.0; 12];
        palm[k % 12] = 1e-4 * k as f64;
        let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 0.01 * k as f64));
        let finger = vectors(&[0.0; 20], &[DVec3::ZERO; 20], Pose::IDENTITY);
        let patches = vec![normal(&palm, &palm, pose), finger];
        let now = frame(0.02 * k as f64, patches, &[Pose::IDENTITY]);
        writer.push(&now).unwrap();
    }
    writer.finish().unwrap();
    case
}

#[test]
fn the_table_says_what_is_in_the_file() {
    let case = recorded();
    let (said, error) = case.succeeds("recording touch.npz");
    assert_eq!(error, "");
    let times = "30 frames from 0 s to 0.58 s, one every 20 ms\n";
    assert!(said.starts_with(times), "{said}");
    let spaced = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let palm = "palm 12 4 × 3 at 2 mm normal 1 2.9 29 0.0029";
    says(&spaced, &[palm, "finger 20 free vector 0 – – –"]);
    says(&said, &["objects: mug\n", "\"seed\": 2018"]);
}

#[test]
fn frames_become_pictures_and_grids_are_drawn_here() {
    let case = recorded();
    let (said, error) = case.succeeds("recording touch.npz --patch=palm --frame=7");
    says(&said, &["peak deflection 0.7 mm"]);
    says(&error, &["palm: t = 0.14 s, frame 7 of 0–29"]);
    for patch in ["palm", "finger"] {
        let options = format!("--patch {patch} --frame=3 --quantity=force --out {patch}.png");
        let (said, _) = case.succeeds(&format!("recording touch.npz {options}"));
        assert_eq!(said, "");
        assert!(case.bytes(&format!("{patch}.png")).starts_with(b"\x89PNG"));
    }
    let options = "--patch=palm --animate=film.png --fps=10 --speed=0.5";
    let (said, error) = case.succeeds(&format!("recording touch.npz {options}"));
    let line = "13 of 30 frames in 1.2 s, at 0.5 × the speed of the recording\n";
    assert_eq!((&said[..], &error[..]), ("", line));
    let film = case.bytes("film.png");
    assert!(film.windows(4).any(|chunk| chunk == b"acTL"));
}

const NUMPY: &str = r#"
import json, numpy
archive = numpy.load("touch.npz", allow_pickle=False)
meta = json.loads(archive["meta"].item())
assert meta["about"]["seed"] == 2018 and meta["objects"] == ["mug"]
assert meta["patches"][0] == {"name": "palm", "n_taxels": 12, "force": "normal",
                              "grid": {"nx": 4, "ny": 3, "pitch_m": 0.002}}
assert archive["time"].dtype == "<f8" and archive["time"].shape == (30,) and archive["time"][29] == 0.58
palm = archive["palm/deflection"]
assert palm.dtype == "<f4" and palm.shape == (30, 12) and palm[29, 5] == numpy.float32(29e-4)
assert (archive["palm/force"] == palm).all()
assert archive["finger/force"].shape == (30, 20, 3)
assert archive["palm/pose"].shape == (30, 7)
assert (archive["palm/pose"][3] == [0, 0, 0.03, 1, 0, 0, 0]).all()
assert archive["finger/axes"].shape == (20, 3) and archive["mug/pose"].shape == (30, 7)
numpy.savez("again.npz", **archive)
print("opened")
"#;

#[test]
fn numpy_opens_it_without_pickle_and_what_numpy_saves_is_read() {
    let case = recorded();
    let mut python = Command::new("python3");
    let has_numpy = python.args(["-c", "import numpy"]).output();
    if !has_numpy.is_ok_and(|output| output.status.success()) {
        skip("no python3 with numpy here");
        return;
    }
    let mut python = Command::new("python3");
    let python = python.args(["-c", NUMPY]).current_dir(case.folder());
    let output = python.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    let [ours, theirs] =
        ["touch.npz", "again.npz"].map(|name| case.succeeds(&format!("recording {name}")).0);
    assert_eq!(ours, theirs);
}
