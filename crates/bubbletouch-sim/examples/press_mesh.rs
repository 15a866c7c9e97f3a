//! A triangle mesh that is pressed at many poses, on all threads.
//!
//! `cargo run --release --example press_mesh`

use bubbletouch_sim::Error;
use bubbletouch_sim::contact::{Press, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::TriangleMesh;
use bubbletouch_sim::objects::{MeshModel, Model};
use bubbletouch_sim::world::{Grid, Patch, Taxel};
use glam::{DQuat, DVec3};
use rayon::prelude::*;
use std::time::Instant;

fn main() -> Result<(), Error> {
    // A box of 40 × 20 × 10 mm with sharp edges.
    let mesh = TriangleMesh::cuboid("box", DVec3::new(0.04, 0.02, 0.01))?;
    let object = [Model::from(MeshModel::new(mesh))];
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    let grid = Grid {
        nx: 32,
        ny: 32,
        pitch: 2e-3,
    };
    let patch = Patch::grid(grid, taxel)?;
    let start = Instant::now();
    // One workspace per thread; a pose gives the same bits on every thread.
    let touched = (0..1000)
        .into_par_iter()
        .map_init(Workspace::new, |workspace, pose| {
            let turn = DQuat::from_rotation_z(f64::from(pose) * std::f64::consts::TAU / 1000.0);
            let pose = Pose::new(turn, DVec3::new(0.0, 0.0, -0.05));
            let contact =
                Press::new(&patch, &object, &[pose], Until::Depth(1e-3)).run(workspace)?;
            Ok::<_, Error>(contact.map_or(0, |contact| contact.n_touched))
        });
    let touched: Vec<usize> = touched.collect::<Result<_, _>>()?;
    let mean = touched.iter().sum::<usize>() as f64 / touched.len() as f64;
    println!(
        "{} presses in {:.2?}; {mean:.1} of {} taxels are touched",
        touched.len(),
        start.elapsed(),
        patch.n_taxels()
    );
    Ok(())
}
