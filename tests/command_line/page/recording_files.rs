//! Recording files: what is read equals what was written, memory is bounded, and a file is complete or missing.

use crate::command::skip;
use crate::stored::{frame, normal, read_recording, vectors};
use bubbletouch::geometry::Pose;
use bubbletouch::report::recording::{
    ForceKind, RecordedPatch, RecordingFile, RecordingHeader, RecordingWriter,
};
use bubbletouch::signal::Quantity;
use bubbletouch::world::Grid;
use glam::{DQuat, DVec3};
use ndarray::{Array2, Axis};
use ndarray_npy::NpzReader;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::path::Path;

const GRID: Grid = Grid {
    nx: 4,
    ny: 3,
    pitch: 2e-3,
};

/// Returns a header with a grid with normal forces, five taxels on a fingertip with force vectors, and two objects.
fn header() -> RecordingHeader {
    let axes: Vec<DVec3> = (0..5)
        .map(|i| DVec3::new(0.2 * f64::from(i), 0.1, 1.0).normalize())
        .collect();
    let tip = RecordedPatch {
        name: "finger tip".to_owned(),
        centers: axes.iter().map(|axis| 8e-3 * axis).collect(),
        axes,
        grid: None,
        force: ForceKind::Vector,
        signal: None,
    };
    RecordingHeader {
        patches: vec![RecordedPatch::of_grid("palm", GRID, ForceKind::Normal), tip],
        objects: vec!["mug".to_owned(), "Füße ☕".to_owned()],
        about: serde_json::json!({"seed": 7, "note": "a \"quoted\" µ"}),
    }
}

/// Contents of one frame, with buffers of its own.
struct Pushed {
    time: f64,
    palm: Vec<f64>,
    palm_force: Vec<f64>,
    tip: Vec<f64>,
    tip_force: Vec<DVec3>,
    poses: [Pose; 4],
}

fn pushed(n_frames: usize) -> Vec<Pushed> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut numbers = |n: usize| -> Vec<f64> { (0..n).map(|_| random.r#gen::<f64>()).collect() };
    let mut frames = Vec::new();
    for frame in 0..n_frames {
        let poses = [0; 4].map(|_| {
            let n = numbers(7);
            let rotation = DQuat::from_xyzw(n[0], n[1], n[2], n[3]).normalize();
            Pose::new(rotation, DVec3::new(n[4], n[5], n[6]))
        });
        frames.push(Pushed {
            time: 1e-3 * (frame + 1) as f64,
            palm: numbers(12),
            palm_force: numbers(12),
            tip: numbers(5),
            tip_force: numbers(15).chunks(3).map(DVec3::from_slice).collect(),
            poses,
        });
    }
    frames
}

fn push(writer: &mut RecordingWriter, pushed: &Pushed) -> bubbletouch::Result<()> {
    let palm = normal(&pushed.palm, &pushed.palm_force, pushed.poses[0]);
    let tip = vectors(&pushed.tip, &pushed.tip_force, pushed.poses[1]);
    writer.push(&frame(pushed.time, vec![palm, tip], &pushed.poses[2..]))
}

fn write(path: &Path, frames: &[Pushed]) {
    let mut writer = RecordingWriter::create(path, header()).unwrap();
    for frame in frames {
        push(&mut writer, frame).unwrap();
    }
    assert_eq!(writer.finish().unwrap(), frames.len());
}

fn rounded(value: f64) -> f64 {
    f64::from(value as f32)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// The arrays are read with ndarray-npy, which is independent of the project's reader.
#[test]
fn what_is_read_back_is_what_was_written_rounded_to_f32() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("touch.npz");
    for n_frames in [0, 1, 300] {
        let frames = pushed(n_frames);
        write(&path, &frames);
        let read = read_recording(&path).unwrap();
        assert_eq!(read.header, header());
        assert_eq!(read.time.len(), n_frames);
        let [palm, tip] = &read.patches[..] else {
            panic!("two patches")
        };
        assert_eq!(palm.deflection.dim(), (n_frames, 12));
        assert_eq!(palm.force.dim(), (n_frames, 12, 1));
        assert_eq!(tip.force.dim(), (n_frames, 5, 3));
        for (k, frame) in frames.iter().enumerate() {
            let tip_force = frame.tip_force.iter().flat_map(|f| f.to_array());
            let written = [&frame.palm[..], &frame.palm_force, &frame.tip].concat();
            let written = written.into_iter().chain(tip_force).map(rounded);
            let forces = [palm, tip].map(|patch| patch.force.index_axis(Axis(0), k));
            let row = palm.deflection.row(k).into_iter().chain(forces[0].iter());
            let row = row.chain(tip.deflection.row(k)).chain(forces[1].iter());
            assert!(row.copied().eq(written), "frame {k}");
            assert_eq!(read.time[k], frame.time);
            let objects = read.objects.iter().map(|poses| poses[k]);
            let poses = [palm.pose[k], tip.pose[k]].into_iter().chain(objects);
            assert!(poses.eq(frame.poses), "frame {k}");
        }
    }
    assert_eq!(names(folder.path()), ["touch.npz"]);
    let mut npz = NpzReader::new(fs::File::open(&path).unwrap()).unwrap();
    let members = "meta, palm/centers, palm/axes, finger tip/centers, finger tip/axes, time, \
                   palm/deflection, palm/force, palm/pose, finger tip/deflection, finger tip/force, \
                   finger tip/pose, mug/pose, Füße ☕/pose";
    assert_eq!(npz.names().unwrap().join(", "), members);
    let centers: Array2<f64> = npz.by_name("palm/centers").unwrap();
    assert_eq!(centers.dim(), (12, 3));
    assert_eq!([centers[[7, 0]], centers[[7, 1]]], [GRID.x(3), GRID.y(1)]);
}

#[test]
fn single_rows_are_those_of_the_whole_and_vectors_have_lengths() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("touch.npz");
    let frames = pushed(40);
    write(&path, &frames);
    let mut file = RecordingFile::open(&path).unwrap();
    let mut visited = Vec::new();
    file.each_frame(1, Quantity::Force, |_, values| {
        visited.push(values.to_vec())
    })
    .unwrap();
    for k in [39, 0, 17] {
        let palm: Vec<f64> = frames[k].palm.iter().copied().map(rounded).collect();
        assert_eq!(file.frame(0, Quantity::Deflection, k).unwrap(), palm);
        let length = |force: &DVec3| DVec3::from(force.to_array().map(rounded)).length();
        let lengths: Vec<f64> = frames[k].tip_force.iter().map(length).collect();
        assert_eq!(file.frame(1, Quantity::Force, k).unwrap(), lengths);
        assert_eq!(visited[k], lengths);
    }
    let said = file.frame(0, Quantity::Force, 40).unwrap_err().to_string();
    assert!(said.ends_with("touch.npz: frame 40; 0 to 39"), "{said}");
}

#[test]
fn equal_recordings_are_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["one.npz", "two.npz"].map(|name| folder.path().join(name));
    write(&one, &pushed(30));
    write(&two, &pushed(30));
    assert!(fs::read(one).unwrap() == fs::read(two).unwrap());
}

#[test]
fn a_writer_dropped_half_way_leaves_what_was_there_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("touch.npz");
    let mut writer = RecordingWriter::create(&path, header()).unwrap();
    for frame in &pushed(10) {
        push(&mut writer, frame).unwrap();
    }
    assert_eq!(names(folder.path()).len(), 1);
    drop(writer);
    assert_eq!(names(folder.path()).len(), 0);
    fs::write(&path, "old").unwrap();
    drop(RecordingWriter::create(&path, header()).unwrap());
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["touch.npz"]);
}

#[test]
fn a_place_that_cannot_be_written_is_an_error_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for (path, said) in [
        ("file/touch.npz", "file/touch.npz: there is no folder "),
        ("no/touch.npz", "no/touch.npz: there is no folder "),
        ("", ""),
    ] {
        let error = RecordingWriter::create(&folder.path().join(path), header()).err();
        let error = error.expect(path);
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains(said), "{error}");
    }
    assert_eq!(names(folder.path()), ["file"]);
}

#[test]
fn a_full_disk_is_an_error() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        skip("this system has no /dev/full");
        return;
    }
    let mut writer = RecordingWriter::create(full, header()).unwrap();
    for frame in &pushed(500) {
        push(&mut writer, frame).unwrap();
    }
    let error = writer.finish().unwrap_err();
    assert_eq!(error.exit_code(), 1);
    let error = error.to_string();
    assert!(error.starts_with("/dev/full: write failed: "), "{error}");
    let mut beside = names(Path::new("/dev")).into_iter();
    assert!(!beside.any(|name| name.starts_with("full.")));
}

#[test]
fn frames_that_do_not_fit_are_refused_and_are_not_in_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("touch.npz");
    let frames = pushed(3);
    let mut writer = RecordingWriter::create(&path, header()).unwrap();
    push(&mut writer, &frames[0]).unwrap();
    let said = push(&mut writer, &frames[0]).unwrap_err().to_string();
    let times = "recording, frame 1: 0.001 s after 0.001 s; finite times that increase";
    assert_eq!(said, times);
    let poses = [Pose::IDENTITY; 2];
    let tip = vectors(&frames[1].tip, &frames[1].tip_force, poses[0]);
    let palm = normal(&frames[1].palm[1..], &frames[1].palm, poses[0]);
    let broken = frame(0.5, vec![palm, tip.clone()], &poses);
    let rows = "recording, frame 1: rows of [1, 11, 12, 7, 5, 15, 7, 7, 7] numbers; rows of [1, 12, 12, 7, 5, 15, 7, 7, 7] numbers";
    assert_eq!(writer.push(&broken).unwrap_err().to_string(), rows);
    let palm = normal(&frames[1].palm, &frames[1].palm, poses[0]);
    for broken in [
        frame(0.5, vec![palm.clone(), palm.clone()], &poses),
        frame(0.5, vec![palm.clone()], &poses),
        frame(0.5, vec![palm, tip], &poses[..1]),
    ] {
        assert!(writer.push(&broken).is_err());
    }
    push(&mut writer, &frames[1]).unwrap();
    assert_eq!(writer.finish().unwrap(), 2);
    let read = read_recording(&path).unwrap();
    let palm: Vec<f64> = frames[1].palm.iter().copied().map(rounded).collect();
    assert_eq!(read.patches[0].deflection.row(1).to_vec(), palm);
}

#[test]
fn names_that_cannot_be_members_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (name, said) in [
        ("", "the name \"\""),
        ("a/b", "the name \"a/b\""),
        ("..", "the name \"..\""),
        ("mug", "two patches or objects called mug"),
    ] {
        let mut header = header();
        header.patches[0].name = name.to_owned();
        let error = RecordingWriter::create(&folder.path().join("touch.npz"), header).err();
        let error = error.expect(name).to_string();
        assert!(error.contains(said), "{error}");
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_changed_byte_is_an_error_or_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("touch.npz");
    write(&path, &pushed(2));
    let (good, expected) = (fs::read(&path).unwrap(), read_recording(&path).unwrap());
    let broken = folder.path().join("broken.npz");
    let mut n_errors = 0;
    // Every fifth byte is changed. All bit positions occur, because 5 and 8 have no common divisor.
    for place in (0..good.len()).step_by(5) {
        let mut bytes = good.clone();
        bytes[place] ^= 1 << (place % 8);
        fs::write(&broken, &bytes).unwrap();
        match read_recording(&broken) {
            Ok(read) => assert!(read == expected, "byte {place}"),
            Err(error) => {
                assert!(error.to_string().contains("broken.npz"), "{error}");
                n_errors += 1;
            }
        }
    }
    // Time stamps, attributes and padding may change without an error; data may not.
    assert!(10 * n_errors > good.len(), "{n_errors} of {}", good.len());
    for length in (0..good.len()).step_by(101) {
        fs::write(&broken, &good[..length]).unwrap();
        assert_eq!(RecordingFile::open(&broken).err().unwrap().exit_code(), 2);
    }
}

/// Returns the header of a 64 × 64 patch.
fn array() -> RecordingHeader {
    let grid = Grid {
        nx: 64,
        ny: 64,
        pitch: 2e-3,
    };
    RecordingHeader {
        patches: vec![RecordedPatch::of_grid("palm", grid, ForceKind::Normal)],
        ..RecordingHeader::default()
    }
}

/// Writes frames of a 64 × 64 patch, alternating between two buffers.
fn stream(mut writer: RecordingWriter, n_frames: usize) {
    let mut deflection = vec![1e-3; 4096];
    let force = vec![0.1; 4096];
    for k in 0..n_frames {
        deflection[k % 4096] += 1e-4;
        let palm = normal(&deflection, &force, Pose::IDENTITY);
        let now = frame(1e-3 * k as f64, vec![palm], &[]);
        writer.push(&now).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn two_thousand_frames_stream_in_the_memory_of_five_hundred() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("touch.npz");
    let write = |n| stream(RecordingWriter::create(&path, array()).unwrap(), n);
    let few = crate::counting::peak_bytes(|| write(500));
    let many = crate::counting::peak_bytes(|| write(2000));
    println!("{few} bytes for 500 frames, {many} for 2,000");
    assert!(many < few + 4096 && many < 10 << 20, "{few}, {many}");
    let read = crate::counting::peak_bytes(|| {
        let mut file = RecordingFile::open(&path).unwrap();
        let mut sum = 0.0;
        file.each_frame(0, Quantity::Deflection, |_, values| sum += values[5])
            .unwrap();
        assert!(sum > 2.0);
    });
    println!("{read} bytes to read them row by row");
    assert!(read < 5 << 20, "{read}");
}
