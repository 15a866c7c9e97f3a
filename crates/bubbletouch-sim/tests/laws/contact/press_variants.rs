//! Presses of a grid give equal bits with all vector instructions that the machine has.

use bubbletouch_sim::contact::{Instructions, Press, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Sphere, SphereUnion};
use bubbletouch_sim::world::{Grid, Patch};
use glam::DVec3;
use rand::Rng;

use crate::random_scenes::{Scene, TAXEL, random_pose, rng};

/// Returns a grid with some unions of spheres of any size around it.
fn random_scene(rng: &mut impl Rng) -> (Scene, Vec<Pose>) {
    let poses: Vec<Pose> = (0..2)
        .map(|_| {
            let distance = rng.gen_range(0.0..0.03);
            random_pose(rng, distance)
        })
        .collect();
    let mut union = || {
        let spheres = (0..rng.gen_range(1..200)).map(|_| Sphere {
            center: DVec3::from_array([0; 3].map(|_| rng.gen_range(-0.03..0.03))),
            radius: 10f64.powf(rng.gen_range(-4.0..-1.0)),
        });
        SphereUnion::new(spheres.collect()).unwrap()
    };
    let objects = poses.iter().map(|_| union().into()).collect();
    let grid = Grid {
        nx: rng.gen_range(1..50),
        ny: rng.gen_range(1..50),
        pitch: rng.gen_range(5e-4..4e-3),
    };
    let patch = Patch::grid(grid, TAXEL).unwrap();
    (Scene { patch, objects }, poses)
}

#[test]
fn vector_instructions_change_no_bit() {
    let mut rng = rng("instructions", 0);
    let mut n_touched = 0;
    for case in 0..300 {
        let (scene, poses) = random_scene(&mut rng);
        let depth = rng.gen_range(1e-4..2e-2);
        let press = |instructions: Instructions| {
            let mut workspace = Workspace::with(instructions);
            let contact = Press::new(&scene.patch, &scene.objects, &poses, Until::Depth(depth))
                .run(&mut workspace)
                .unwrap();
            let deflections = workspace.deflections().iter();
            (
                contact,
                deflections.map(|d| d.to_bits()).collect::<Vec<_>>(),
            )
        };
        let expected = press(Instructions::Baseline);
        for &instructions in Instructions::here() {
            assert!(
                press(instructions) == expected,
                "case {case}, {instructions:?}"
            );
        }
        assert!(press(Instructions::Best) == expected, "case {case}");
        n_touched += expected.0.map_or(0, |contact| contact.n_touched);
    }
    assert!(n_touched > 10_000, "{n_touched}");
}
