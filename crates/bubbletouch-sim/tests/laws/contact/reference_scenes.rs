//! Comparison of every reference scene, frame by frame, with the results of the original BubbleTouch.
//!
//! The environment variable BUBBLETOUCH_REFERENCE contains the folder of the scenes; without it the test prints a note and is skipped.

use bubbletouch_sim::contact::{Press, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Sphere, SphereUnion};
use bubbletouch_sim::world::{Grid, Patch, Taxel};
use glam::{DMat3, DVec3};
use serde_json::Value;
use std::path::Path;

#[test]
fn every_reference_scene_agrees_within_a_picometre() {
    let Some(folder) = crate::reference_data::folder("BUBBLETOUCH_REFERENCE") else {
        return;
    };
    let mut n_frames = 0;
    let mut n_scenes = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let scene = entry.unwrap().path();
        if scene.join("scene.json").exists() {
            n_frames += check_scene(&scene);
            n_scenes += 1;
        }
    }
    println!("{n_scenes} scenes, {n_frames} frames");
    assert!(
        n_scenes >= 21 && n_frames > n_scenes,
        "{n_scenes} scenes, {n_frames} frames"
    );
}

/// Checks all recorded frames of a scene; returns their number.
fn check_scene(folder: &Path) -> usize {
    let text = std::fs::read_to_string(folder.join("scene.json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    let spheres = numbers(&folder.join("spheres.csv"));
    let frames = json["frames"].as_array().unwrap();
    let patch = patch(&json["sensor"]);
    let finals = numbers(&folder.join("displacement_final.csv")).concat();
    let last = deflections(&json, frames.last().unwrap(), &spheres, &patch);
    assert_same(&last, &finals, folder, frames.len() - 1);
    let every = folder.join("displacement_frames.csv");
    if !every.exists() {
        return 1;
    }
    let recorded = numbers(&every);
    assert_eq!(recorded.len(), frames.len() - 1);
    for (index, row) in recorded.iter().enumerate() {
        let computed = deflections(&json, &frames[index + 1], &spheres, &patch);
        assert_same(&computed, row, folder, index + 1);
    }
    1 + recorded.len()
}

fn patch(sensor: &Value) -> Patch {
    let number = |key: &str| sensor[key].as_f64().unwrap();
    let grid = Grid {
        nx: number("nx") as usize,
        ny: number("ny") as usize,
        pitch: number("pitch"),
    };
    let taxel = Taxel {
        radius: number("radius"),
        stiffness: 1.0,
        damping: 0.0,
        stroke: number("maxz") - number("minz"),
    };
    Patch::grid(grid, taxel).unwrap()
}

/// Returns the deflections of a recorded frame. The recorded orientation is not always a rotation, so the spheres are transformed to the patch frame here.
fn deflections(json: &Value, frame: &Value, spheres: &[Vec<f64>], patch: &Patch) -> Vec<f64> {
    let rows: Vec<DVec3> = frame["orientation"]
        .as_array()
        .unwrap()
        .iter()
        .map(vector)
        .collect();
    // The glam crate takes columns; the recorded rows are the columns of the required transpose.
    let patch_from_world = DMat3::from_cols(rows[0], rows[1], rows[2]);
    let position = vector(&frame["position"]);
    let rest = DVec3::Z * json["sensor"]["maxz"].as_f64().unwrap();
    let mut objects = Vec::new();
    for (index, object) in json["objects"].as_array().unwrap().iter().enumerate() {
        let first = object["first_sphere"].as_u64().unwrap() as usize;
        let count = object["sphere_count"].as_u64().unwrap() as usize;
        let shift = vector(&frame["object_shift"][index]);
        let placed = spheres[first..first + count].iter().map(|row| Sphere {
            center: patch_from_world * (DVec3::new(row[0], row[1], row[2]) + shift - position)
                - rest,
            radius: row[3],
        });
        objects.push(SphereUnion::new(placed.collect()).unwrap().into());
    }
    let poses = vec![Pose::IDENTITY; objects.len()];
    let mut workspace = Workspace::new();
    Press::new(patch, &objects, &poses, Until::Pose)
        .run(&mut workspace)
        .unwrap();
    workspace.deflections().to_vec()
}

fn vector(value: &Value) -> DVec3 {
    let at = |i: usize| value[i].as_f64().unwrap();
    DVec3::new(at(0), at(1), at(2))
}

fn numbers(path: &Path) -> Vec<Vec<f64>> {
    csv::ReaderBuilder::new()
        .has_headers(false)
        .from_path(path)
        .unwrap()
        .deserialize()
        .map(|row| row.unwrap())
        .collect()
}

fn assert_same(computed: &[f64], recorded: &[f64], folder: &Path, frame: usize) {
    assert_eq!(computed.len(), recorded.len());
    for (taxel, (a, b)) in computed.iter().zip(recorded).enumerate() {
        assert!(
            (a - b).abs() <= 1e-12,
            "{} frame {frame} taxel {taxel}: {a} and {b}",
            folder.display()
        );
    }
}
