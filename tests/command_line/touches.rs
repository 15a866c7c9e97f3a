//! `bubbletouch touches`: the files of a data set agree with each other and with the library, and are written with little memory.

use crate::command::{Case, CommandLine, filled, says, skip};
use crate::study::{Study, laid_out};
use bubbletouch::contact::{Press, Until, Workspace};
use bubbletouch::geometry::Pose;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::simulate_array;
use glam::{DQuat, DVec3};
use ndarray::{Array1, Array2, Array3, Array4};
use ndarray_npy::read_npy;
use std::process::Stdio;

/// Study with two arrays; some touches miss the object, some saturate a taxel.
const STUDY: &str = include_str!("../fixtures/texts/touches.toml");

/// Row of `touches.csv`.
#[derive(serde::Deserialize)]
struct TouchRow {
    touch: usize,
    label: usize,
    object: String,
    rest: usize,
    offset_x_mm: f64,
    offset_y_mm: f64,
    yaw_deg: f64,
    tilt_x_deg: f64,
    tilt_y_deg: f64,
    depth_mm: f64,
    n_touched: usize,
    n_saturated: usize,
}

/// Row of `objects.csv`.
#[derive(serde::Deserialize)]
struct ObjectRow {
    label: usize,
    object: String,
    n_spheres: usize,
    n_touches: usize,
}

/// Files of one array. Reading them fails if the type of an array is not the documented one.
struct Files {
    frames: Array3<f32>,
    labels: Array1<i64>,
    poses: Array2<f64>,
    depths: Array1<f64>,
    touches: Vec<TouchRow>,
    objects: Vec<ObjectRow>,
}

fn files(case: &Case, folder: &str) -> Files {
    let path = |name: &str| case.path(&format!("{folder}/{name}.npy"));
    Files {
        frames: read_npy(path("frames")).unwrap(),
        labels: read_npy(path("labels")).unwrap(),
        poses: read_npy(path("poses")).unwrap(),
        depths: read_npy(path("depths")).unwrap(),
        touches: case.rows(&format!("{folder}/touches.csv")),
        objects: case.rows(&format!("{folder}/objects.csv")),
    }
}

fn written() -> Case {
    let case = Case::with("study.toml", STUDY);
    let (said, _) = case.succeeds("touches study.toml --out data");
    assert_eq!(said, "");
    case
}

/// Folders of the study's arrays, in order.
const FOLDERS: [&str; 2] = ["data/12x12_at_4_mm", "data/24x24_at_2_mm"];

#[test]
fn the_frames_are_the_librarys_one_folder_an_array() {
    let case = written();
    let study = Study::new(STUDY);
    let parts = laid_out(STUDY).unwrap();
    let arrays = parts.parts().iter().map(|part| &part.plan.array);
    for (folder, array) in FOLDERS.iter().zip(arrays) {
        let files = files(&case, folder);
        let bubbletouch::world::ImageShape { ny, nx } = array.shape();
        assert_eq!(files.frames.dim(), (900, ny, nx));
        let expected = simulate_array(&study.touched, array, 1, &Silent);
        let flat = files.frames.to_shape((900, ny * nx)).unwrap();
        assert_eq!(flat.mapv(f64::from), expected.to_array());
        let n_missed = files.touches.iter().filter(|t| t.n_touched == 0).count();
        let n_saturated = files.touches.iter().filter(|t| t.n_saturated > 0).count();
        assert!(n_missed > 0 && n_saturated > 0);
        assert_eq!(
            (n_missed, n_saturated),
            (expected.facts.n_missed, expected.facts.n_saturated)
        );
    }
    // Plus the manifest.
    assert_eq!(case.names_in("data").len(), 2 + 1);
}

#[test]
fn frames_of_a_cell_are_what_its_identity_measures_and_the_rest_is_the_same() {
    let case = Case::new();
    let study = STUDY
        .replace("per_object = 300", "per_object = 30")
        .replace("400.0]", "9.0]")
        .replace("ratio = 4", "ensemble = \"identity\"\nratio = 1")
        .replace(
            "[sensing]",
            "[signal]\nsteps = [\"noise\", \"smoothing\"]\nnoise_std_full_scale = [0.0, 0.1]\nsmoothing_mm = 4.0\n[sensing]",
        );
    case.file("study.toml", study);
    let (_, said) = case.succeeds("touches study.toml --out clean");
    says(&said, &["without noise"]);
    // Array 1 (24 × 24) with noise of 10 % is configuration 3.
    let configuration = "study.toml --configuration 3 --trial 0";
    let (_, said) = case.succeeds(&format!("touches {configuration} --out read"));
    says(&said, &["as configuration 3 reads them"]);
    case.succeeds(&format!("features {configuration} --out features"));
    let features: Array2<f64> = read_npy(case.path("features/features.npy")).unwrap();
    let (clean, read) = (files(&case, "clean/24x24_at_2_mm"), files(&case, "read"));
    let flat = read.frames.to_shape(features.dim()).unwrap();
    assert_eq!(
        flat.mapv(f64::from),
        features.mapv(|value| f64::from(value as f32))
    );
    assert!(read.frames != clean.frames, "noise is in them");
    let names = "labels.npy poses.npy depths.npy touches.csv objects.csv";
    case.same_files(["clean/24x24_at_2_mm", "read"], &names.words());
    case.refuses("touches study.toml --out x --configuration 99");
}

#[test]
fn labels_depths_and_tables_agree_and_are_the_touches_of_the_study() {
    let case = written();
    let study = Study::new(STUDY);
    for folder in FOLDERS {
        let files = files(&case, folder);
        let mut rows = files.touches.iter();
        assert_eq!(files.objects.len(), study.touched.len());
        for (label, (object, row)) in study.touched.iter().zip(&files.objects).enumerate() {
            assert_eq!((row.label, &row.object), (label, &object.object.name));
            assert_eq!(row.n_spheres, object.object.model.n_spheres());
            assert_eq!(row.n_touches, object.touches.len());
            for touch in &object.touches {
                let row = rows.next().unwrap();
                let index = row.touch;
                assert_eq!(files.labels[index], label as i64);
                assert_eq!((row.label, &row.object), (label, &object.object.name));
                assert_eq!(files.depths[index], touch.depth);
                assert_eq!(row.rest, touch.rest);
                for (given, expected) in [
                    (row.offset_x_mm, 1e3 * touch.offset[0]),
                    (row.offset_y_mm, 1e3 * touch.offset[1]),
                    (row.yaw_deg, touch.yaw.to_degrees()),
                    (row.tilt_x_deg, touch.tilt[0].to_degrees()),
                    (row.tilt_y_deg, touch.tilt[1].to_degrees()),
                    (row.depth_mm, 1e3 * touch.depth),
                ] {
                    assert!((given - expected).abs() < 1e-12, "{given}, {expected}");
                }
            }
        }
        assert!(rows.next().is_none());
        let numbers: Vec<usize> = files.touches.iter().map(|row| row.touch).collect();
        assert_eq!(numbers, (0..900).collect::<Vec<_>>());
    }
}

#[test]
fn pressing_at_the_recorded_pose_reproduces_the_frame() {
    let case = written();
    let study = Study::new(STUDY);
    let parts = laid_out(STUDY).unwrap();
    let arrays = parts.parts().iter().map(|part| &part.plan.array);
    for (folder, array) in FOLDERS.iter().zip(arrays) {
        let files = files(&case, folder);
        let mut workspace = Workspace::new();
        for (touch, pose) in files.poses.outer_iter().enumerate() {
            let rotation = DQuat::from_xyzw(pose[4], pose[5], pose[6], pose[3]);
            assert!((rotation.length() - 1.0).abs() < 1e-12);
            let pose = Pose::new(rotation, DVec3::new(pose[0], pose[1], pose[2]));
            let spheres = &study.touched[files.labels[touch] as usize].object.model;
            let objects = [spheres.clone()];
            let contact = Press::new(array.patch(), &objects, &[pose], Until::Pose)
                .run(&mut workspace)
                .unwrap()
                .unwrap_or_default();
            let row = &files.touches[touch];
            let frame = files.frames.index_axis(ndarray::Axis(0), touch);
            if row.n_touched == 0 {
                assert!(frame.iter().all(|&d| d == 0.0));
                continue;
            }
            for (&written, &pressed) in frame.iter().zip(workspace.deflections()) {
                // Half a unit in the last place of f32 at the stroke of 3 mm is 1.2e-10.
                assert!((f64::from(written) - pressed).abs() < 2e-10);
            }
            // A taxel that is deflected by less than the rounding error of a pose may be counted or not.
            assert!(contact.n_touched.abs_diff(row.n_touched) <= 1);
            assert_eq!(contact.n_saturated, row.n_saturated);
        }
    }
}

#[test]
fn one_array_needs_no_folder_of_its_own_and_threads_change_no_byte() {
    let case = Case::new();
    case.file("study.toml", STUDY.replace("[4.0, 2.0]", "4.0"));
    for n in [1, 3] {
        case.succeeds(&format!("touches study.toml --threads {n} --out {n}"));
    }
    let names = "depths.npy frames.npy labels.npy manifest.json objects.csv poses.npy recorded.toml touches.csv";
    assert_eq!(case.names_in("1").join(" "), names);
    case.same_files(["1", "3"], &names.words());
}

/// Returns a study of touches of two balls on 16 × 16 taxels.
fn balls(per_object: usize) -> String {
    filled(
        include_str!("../fixtures/texts/touches_balls.toml"),
        &[("per_object", &per_object)],
    )
}

/// Returns the peak memory of the command while it writes the touches of a study, KiB; `None` if the system does not report it.
fn peak_memory(text: &str) -> Option<u64> {
    let case = Case::new();
    case.file("study.toml", text);
    let mut child = case
        .command("touches study.toml --threads 2 --out data")
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = None;
    loop {
        // The peak only increases; the last value is the final one, up to a millisecond.
        peak = high_water_mark(&status).max(peak);
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success());
            return peak;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
}

fn high_water_mark(status: &str) -> Option<u64> {
    let text = std::fs::read_to_string(status).ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

#[test]
fn fifty_thousand_touches_need_no_more_memory_than_five_hundred() {
    let (few, many) = (balls(250), balls(25_000));
    let (Some(small), Some(large)) = (peak_memory(&few), peak_memory(&many)) else {
        skip("this system has no /proc/<pid>/status with VmHWM");
        return;
    };
    let grown = large.saturating_sub(small);
    println!("{small} KiB for 500 touches, {large} KiB for 50,000");
    // The frames take 50,000 KiB and a list of them would take 8,000. Buffers and the late reading of the peak take a few hundred.
    assert!(grown < 4 * 1024, "{grown} KiB more");
}

/// Study of small frames with axes of its own.
const AXES: &str = include_str!("../fixtures/texts/touches_axes.toml");

#[test]
fn a_study_with_axes_of_its_own_writes_one_folder_for_each_touched_array() {
    let case = Case::with("study.toml", AXES);
    case.succeeds("touches study.toml --out data");
    let alone = |depth: &str| {
        let (study, _) = AXES.split_once("[axes]").unwrap();
        let touches = format!("per_object = 20\ndepth_mm = {depth}");
        let study = study.replace("per_object = 20", &touches);
        case.file("alone.toml", study);
        let out = format!("alone_{depth}");
        case.succeeds(&format!("touches alone.toml --out {out}"));
        files(&case, &out).frames
    };
    for (folder, depth) in [("data/depth_mm_1", "1.0"), ("data/depth_mm_4", "4.0")] {
        let files = files(&case, folder);
        assert!(files.frames == alone(depth), "{folder}");
        let depth: f64 = depth.parse().unwrap();
        assert!(files.depths.iter().all(|&d| (1e3 * d - depth).abs() < 1e-9));
    }
    let names = case.names_in("data").len();
    assert_eq!(names, 3, "two arrays and the manifest");
    // An axis that changes no touch gives no further folders.
    let noise = "\"signal.noise_std_full_scale\" = [0.0, 0.1]";
    let same = AXES.replace("\"touches.depth_mm\" = [1.0, 4.0]", noise);
    let same = same.replace("per_object = 20", "per_object = 20\ndepth_mm = 3.0");
    case.file("same.toml", same);
    case.succeeds("touches same.toml --out same");
    assert_eq!(files(&case, "same").frames.dim(), (40, 8, 8));
    // Several arrays together with an axis.
    let both = AXES.replace("pitch_mm = 4.0", "pitch_mm = [4.0, 8.0]");
    case.file("both.toml", both);
    case.succeeds("touches both.toml --out both");
    for folder in ["8x8_at_4_mm_depth_mm_1", "8x8_at_8_mm_depth_mm_4"] {
        let files = files(&case, &format!("both/{folder}"));
        assert_eq!(files.frames.dim(), (40, 8, 8));
    }
    assert_eq!(case.names_in("both").len(), 5);
}

#[test]
fn the_manifest_has_the_units_of_all_channels() {
    let case = Case::new();
    let (study, _) = AXES.split_once("[axes]").unwrap();
    let study = study.replace("per_object = 20", "per_object = 20\ndepth_mm = 3.0");
    let skin = "stroke_mm = 5.0\nsensed = \"shear\"";
    case.file("shear.toml", study.replace("stroke_mm = 5.0", skin));
    let units = |folder: &str, name: &str| {
        let text = std::fs::read_to_string(case.path(folder).join("manifest.json")).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        json["files"][name]["unit"].clone()
    };
    case.succeeds("touches shear.toml --out shear");
    assert_eq!(units("shear", "frames.npy"), serde_json::json!(["m"]));
    assert_eq!(units("shear", "shear.npy"), serde_json::json!(["N", "N"]));
    let frames: Array3<f32> = read_npy(case.path("shear/frames.npy")).unwrap();
    let across: Array4<f32> = read_npy(case.path("shear/shear.npy")).unwrap();
    assert_eq!((frames.dim(), across.dim()), ((40, 8, 8), (40, 2, 8, 8)));
    // Values in metres are within the stroke; values in newtons exceed it.
    assert!(frames.iter().all(|&d| (0.0..=5e-3).contains(&d)));
    assert!(across.iter().any(|&force| force.abs() > 5e-3));
    case.succeeds("touches shear.toml --out configuration --configuration 0");
    let three = serde_json::json!(["N", "N", "N"]);
    assert_eq!(units("configuration", "frames.npy"), three);
    assert!(!case.path("configuration/shear.npy").exists());
}
