//! No file content makes a reader panic, hang or exhaust the memory.

use crate::faults::crc32;
use crate::fuzzing::Target;
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
use bubbletouch::studies::recognition::charts::read_tables;
use bubbletouch::study::journal::{Identity, Journal};
use bubbletouch::study::{Plan, StudySpec, write_npy};
use bubbletouch::world::{Interpolation, PoseTrajectory, Robot};
use bubbletouch::{Error, Result};
use ndarray::Array3;
use std::fs;
use std::path::{Path, PathBuf};

const PLACE: &str = "input";

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Returns the files of a folder with an extension and a maximum length.
fn files(name: &str, ending: &str, longest: usize) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder(name)).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let is_it = |path: &PathBuf| path.extension().is_some_and(|e| e == ending);
    paths.retain(is_it);
    let contents = paths.iter().map(|path| fs::read(path).unwrap());
    let mut found: Vec<Vec<u8>> = contents.collect();
    found.retain(|content| content.len() <= longest);
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
    Target::new("study", seeds, &read_study).run();
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
        _ => Plan::variants(PLACE, StudySpec::parse(PLACE, text)?).map(drop),
    }
}

#[test]
fn scenes() {
    let scenes = folder("experiments/scenes");
    let seeds = files("experiments/scenes", "toml", 12_000);
    let read = |input: &[u8]| {
        let spec = SceneSpec::parse(PLACE, text_of(input)?)?;
        ScenePlan::new(PLACE, &scenes, spec).map(drop)
    };
    Target::new("scene", seeds, &read).run();
}

#[test]
fn objects() {
    let lollipop = include_str!("../fixtures/texts/fuzz_lollipop.toml");
    let mut seeds = files("objects", "toml", 60_000);
    let lollipops = std::iter::repeat_n(lollipop.as_bytes().to_vec(), seeds.len());
    seeds.extend(lollipops);
    let read = |input: &[u8]| Catalogue::parse("set", PLACE, text_of(input)?).map(drop);
    Target::new("object", seeds, &read).run();
}

/// Tests the reader of a format of meshes; the stored samples together use all features of the format.
fn mesh(name: &'static str, format: MeshFormat) {
    let read = |input: &[u8]| {
        let file = format.read(PLACE, Some(LengthUnit::Millimetre), &SizeLimits::ANY, input)?;
        file.into_mesh(PLACE).map(drop)
    };
    Target::new(name, Vec::new(), &read).run();
}

#[test]
fn meshes_in_ply() {
    mesh("ply", MeshFormat::Ply);
}

#[test]
fn meshes_in_obj() {
    mesh("obj", MeshFormat::Obj);
}

#[test]
fn meshes_in_stl() {
    mesh("stl", MeshFormat::Stl);
}

#[test]
fn meshes_in_collada() {
    mesh("collada", MeshFormat::Collada);
}

#[test]
fn meshes_in_gltf() {
    mesh("gltf", MeshFormat::Gltf);
}

#[test]
fn models_of_mujoco() {
    let seeds = files("objects/robots", "xml", 20_000);
    let read = |input: &[u8]| {
        let robot = Robot::from_mjcf(PLACE, text_of(input)?)?;
        let rest = robot.rest_positions();
        robot.forward(&Pose::IDENTITY, &rest).map(drop)
    };
    Target::new("mjcf", seeds, &read).run();
}

#[test]
fn robots() {
    let mut seeds = files("crates/bubbletouch-sim/tests/robots", "urdf", 20_000);
    seeds.extend(files("objects/robots", "urdf", 20_000));
    let read = |input: &[u8]| {
        let robot = Robot::from_urdf(PLACE, text_of(input)?)?;
        let zero = vec![0.0; robot.n_positions()];
        robot.forward(&Pose::IDENTITY, &zero).map(drop)
    };
    Target::new("urdf", seeds, &read).run();
}

#[test]
fn spheres() {
    let read = |input: &[u8]| read_spheres(PLACE, None, &SizeLimits::ANY, input).map(drop);
    Target::new("spheres", Vec::new(), &read).run();
}

#[test]
fn way_points() {
    let read = |input: &[u8]| {
        let trajectory = PoseTrajectory::read_csv(PLACE, input, Interpolation::default())?;
        let pose = trajectory.pose_at(0.5 * trajectory.end());
        assert!(pose.translation.is_finite());
        Ok(())
    };
    Target::new("way_points", Vec::new(), &read).run();
}

#[test]
fn tables_of_results() {
    // The times in stored tables are the same in every test run.
    let stored = folder("results/foveated");
    let tables = read_tables(&stored).unwrap();
    let at = folder_in_memory();
    fs::copy(stored.join("study.toml"), at.path().join("study.toml")).unwrap();
    write_files(at.path(), table_files(&tables)).unwrap();
    // The first byte of an input selects the table.
    let files = tables.iter().filter(|table| !table.csv.is_empty());
    let names: Vec<&str> = files.map(|table| table.file).collect();
    let seeds = names.iter().enumerate().map(|(number, name)| {
        let content = fs::read(at.path().join(name)).unwrap();
        [vec![number as u8], content].concat()
    });
    let read = |input: &[u8]| {
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
        let comparison = Comparison::new([&tables, &read], (found, None))?;
        comparison.text(80);
        Ok(())
    };
    Target::new("table", seeds.collect(), &read).run();
}

#[test]
fn journals() {
    let at = folder_in_memory();
    let path = at.path().join("journal.jsonl");
    let study = "seed = 1\n[skin]\npitch_mm = 2.0\n".to_owned();
    let identity = Identity::new(study, Default::default(), Default::default());
    let journal = Journal::open(&path, &identity).unwrap();
    journal.keep("cell 0, trial 0", &vec![0.5, 1.5]).unwrap();
    journal.keep("cell 1, trial 0", &"failed: \"so\"").unwrap();
    drop(journal);
    let read = |content: &[u8]| {
        fs::write(&path, content).unwrap();
        if let Some((_, journal)) = Journal::read(&path)? {
            let _: Option<Vec<f64>> = journal.get("cell 0, trial 0");
        }
        Journal::open(&path, &identity).map(drop)
    };
    // A correct checksum makes the rest of a line reachable.
    let read_both = |input: &[u8]| {
        let as_it_is = read(input);
        read(&with_checksums(input)).and(as_it_is)
    };
    Target::new("journal", vec![fs::read(&path).unwrap()], &read_both).run();
}

/// Replaces the checksum of every line by the correct one; later lines continue the checksum of the first line.
fn with_checksums(input: &[u8]) -> Vec<u8> {
    let mut first = None;
    let line = |line: &[u8]| -> Vec<u8> {
        let json = line.splitn(2, |&byte| byte == b' ').nth(1);
        let json = json.unwrap_or_default();
        let whole = json.strip_suffix(b"\n").unwrap_or(json);
        let sum = crc32(first.unwrap_or(0), whole);
        first.get_or_insert(sum);
        [format!("{sum:08x} ").as_bytes(), json].concat()
    };
    let lines = input.split_inclusive(|&byte| byte == b'\n');
    lines.flat_map(line).collect()
}

/// Creates a folder in memory if the system has one.
fn folder_in_memory() -> tempfile::TempDir {
    let memory = Path::new("/dev/shm");
    match memory.is_dir() {
        true => tempfile::tempdir_in(memory).unwrap(),
        false => tempfile::tempdir().unwrap(),
    }
}
