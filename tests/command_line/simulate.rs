//! `bubbletouch simulate`: from the shipped scenes to the output files.
#![cfg(unix)]

use crate::command::{Case, says};
use bubbletouch::scene::{Frame, ScenePlan, Simulation, Stepping};
use std::fs;
use std::path::{Path, PathBuf};

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments/scenes");
    let paths = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "toml");
    let mut paths: Vec<PathBuf> = paths.filter(is_scene).collect();
    paths.sort();
    assert!(paths.len() >= 5);
    paths
}

#[test]
fn every_shipped_scene_says_what_it_asks_and_runs() {
    let case = Case::new();
    for scene in scenes() {
        let text = fs::read_to_string(&scene).unwrap();
        for key in ["# Question ", "# Source ", "# Expected ", "# Run time "] {
            let line = text.lines().find(|line| line.starts_with(key));
            let said = line.map_or("", |line| line[key.len()..].trim());
            assert!(!said.is_empty(), "{}: {key}", scene.display());
        }
        let stem = scene.file_stem().unwrap().to_str().unwrap();
        let scene = scene.to_str().unwrap();
        let (said, _) = case.succeeds(&format!("simulate {scene} --out {stem} --until-s 0.3"));
        says(&said, &["deepest (mm)", "at the end"]);
        let files = case.names_in(stem).join(" ");
        assert_eq!(files, "manifest.json recording.npz scene.toml wrenches.csv");
    }
}

#[test]
fn the_files_hold_what_the_library_computes() {
    let case = Case::new();
    let scene = &scenes()[0];
    assert!(scene.ends_with("arm_sweep.toml"));
    let scene_name = scene.to_str().unwrap();
    let (said, _) = case.succeeds(&format!("simulate {scene_name} --out o --quiet"));
    assert_eq!(said, "");
    let frames_of = |scene: &Path| {
        let plan = ScenePlan::read(scene).unwrap();
        let mut frames: Vec<Frame> = Vec::new();
        let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
        simulation.run(&mut [&mut frames]).unwrap();
        frames
    };
    let frames = frames_of(scene);
    let recording = crate::stored::read_recording(&case.path("o/recording.npz")).unwrap();
    assert_eq!(recording.time.len(), frames.len());
    for (number, frame) in frames.iter().enumerate() {
        for (stored, reading) in recording.patches.iter().zip(&frame.patches) {
            let stored = stored.deflection.row(number).mapv(|d| d as f32).to_vec();
            let expected = reading.deflection.iter().map(|&d| d as f32);
            assert_eq!(stored, expected.collect::<Vec<_>>());
        }
    }
    let table = case.read("o/wrenches.csv");
    let mut lines = table.lines();
    let header = lines.next().unwrap();
    assert!(header.starts_with("time_s,patch,n_touched,n_saturated,fx_n"));
    let readings = frames.iter().flat_map(|frame| &frame.patches);
    for (line, reading) in lines.clone().zip(readings) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells[2].parse(), Ok(reading.n_touched));
        assert_eq!(cells[6].parse(), Ok(reading.wrench.force.z));
    }
    assert_eq!(lines.count(), 3 * frames.len());
    // The resolved scene equals the original scene from any folder.
    assert_eq!(frames, frames_of(&case.path("o/scene.toml")));
}
