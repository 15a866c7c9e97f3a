//! Laws of consecutive presses of one grid on meshes with flat faces, in one workspace: comparison with all triangles one by one.

use super::mesh_at_pose::by_every_triangle;
use crate::mesh_shapes::{cuboid, prism, refined, sheet};
use crate::random_scenes::{TAXEL, random_pose, rng};
use bubbletouch_sim::contact::{Press, Until, Workspace, stopping_height};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Surface, TriangleMesh};
use bubbletouch_sim::objects::{MeshModel, Model};
use bubbletouch_sim::world::{Grid, Patch};
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;

/// Returns a box, a thin plate, a prism, a wedge or an open sheet, coarse or fine, and whether the mesh is closed.
fn random_mesh(rng: &mut impl Rng) -> (TriangleMesh, bool) {
    let size = 10f64.powf(rng.gen_range(-2.7..-1.5));
    let mut share = |low: f64| size * rng.gen_range(low..1.0);
    let (a, b, c) = (share(0.1), share(0.1), share(0.1));
    let kind = rng.gen_range(0..5);
    let coarse = match kind {
        0 => cuboid(DVec3::new(a, b, c)),
        1 => cuboid(DVec3::new(a, b, 10f64.powf(rng.gen_range(-5.0..-3.0)))),
        2 => {
            let n = rng.gen_range(3..9);
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
            let base: Vec<DVec2> = (0..n).map(|k| a * DVec2::from_angle(angle(k))).collect();
            prism(&base, DVec3::new(rng.gen_range(-b..b), 0.0, c))
        }
        3 => {
            let edge = [DVec2::ZERO, DVec2::new(a, 0.0), DVec2::new(a, 0.05 * b)];
            prism(&edge, 2.0 * c * DVec3::Z)
        }
        _ => {
            let roughness = size * 10f64.powf(rng.gen_range(-4.0..-0.5));
            let n = rng.gen_range(1..5);
            sheet(n, size, || rng.gen_range(-roughness..roughness))
        }
    };
    // At most two hundred triangles.
    let most = (200.0 / coarse.n_triangles() as f64).log(4.0) as usize;
    (refined(&coarse, rng.gen_range(0..=most)), kind < 4)
}

/// Returns an upright rotation, a rotation tilted by 30 to 90 degrees about a random horizontal axis, or any rotation.
fn random_rotation(rng: &mut impl Rng) -> DQuat {
    let turn = DQuat::from_rotation_z(rng.gen_range(0.0..6.0));
    match rng.gen_range(0..4) {
        0 => DQuat::IDENTITY,
        1 => {
            DQuat::from_rotation_x(rng.gen_range(30..=90) as f64 * std::f64::consts::PI / 180.0)
                * turn
        }
        2 => {
            turn * DQuat::from_rotation_y(rng.gen_range(0.5..1.6)) * random_pose(rng, 0.0).rotation
        }
        _ => random_pose(rng, 0.0).rotation,
    }
}

/// Returns the travel at which each taxel is stopped by the triangles of a placed mesh, metres, computed triangle by triangle.
fn starts(mesh: &TriangleMesh, patch: &Patch) -> Vec<f64> {
    let reach = patch.taxels().at(0).radius;
    let mut starts = vec![f64::INFINITY; patch.n_taxels()];
    for triangle in (0..mesh.n_triangles()).map(|number| mesh.triangle(number)) {
        let bounds = triangle.bounds();
        for (start, center) in starts.iter_mut().zip(patch.layout().centers()) {
            let beside = (bounds.min - *center).max(*center - bounds.max).truncate();
            if beside.max_element() < reach
                && let Some(height) = stopping_height(&triangle, reach, center.truncate())
            {
                *start = start.min(height);
            }
        }
    }
    starts
}

#[test]
fn presses_in_one_workspace_equal_all_triangles_one_by_one() {
    let (mut n_touched, mut n_cases) = ([0; 3], 0);
    for sequence in 0..400 {
        let mut rng = rng("mesh sequence", sequence);
        // Only an unchanged grid keeps the memory of the press before.
        let grid = Grid {
            nx: rng.gen_range(1..14),
            ny: rng.gen_range(1..14),
            pitch: rng.gen_range(5e-4..4e-3),
        };
        let patch = Patch::grid(grid, TAXEL).unwrap();
        let mut workspace = Workspace::new();
        for press in 0..12 {
            let (mesh, is_closed) = random_mesh(&mut rng);
            let rotation = random_rotation(&mut rng);
            let corner = mesh.vertices()[rng.gen_range(0..mesh.vertices().len())];
            let mut share = |n: usize| rng.gen_range(-0.6..0.6) * n as f64 * grid.pitch;
            let place = DVec3::new(share(grid.nx), share(grid.ny), 0.05);
            let mut pose = Pose::new(rotation, place - rotation * corner);
            if rng.gen_bool(0.3) {
                // Corners, edges and diagonals of faces often lie on the axes of taxels.
                pose.translation.x = (pose.translation.x / grid.pitch).round() * grid.pitch;
                pose.translation.y = 0.0;
            }
            let starts = starts(&mesh.moved(&pose), &patch);
            let first = starts.iter().copied().fold(f64::INFINITY, f64::min);
            if first.is_infinite() {
                continue;
            }
            let depth = TAXEL.stroke * 10f64.powf(rng.gen_range(-3.0..0.6));
            let travel = first + depth;
            let objects = [Model::from(MeshModel::new(mesh.clone()))];
            // At a pose, the law of all triangles needs a closed mesh.
            let goal = rng.gen_range(if is_closed { 0..3 } else { 0..2 });
            let contact = match goal {
                0 => Press::new(&patch, &objects, &[pose], Until::Depth(depth))
                    .run(&mut workspace)
                    .unwrap()
                    .unwrap(),
                1 => Press::new(&patch, &objects, &[pose], Until::Travel(travel))
                    .run(&mut workspace)
                    .unwrap()
                    .unwrap_or_default(),
                _ => {
                    pose.translation.z -= travel;
                    Press::new(&patch, &objects, &[pose], Until::Pose)
                        .run(&mut workspace)
                        .unwrap()
                        .unwrap_or_default()
                }
            };
            let placed = Surface::new(mesh.moved(&pose));
            let found = workspace.deflections().iter().zip(patch.layout().centers());
            for ((found, center), start) in found.zip(&starts) {
                let exact = match goal {
                    2 => by_every_triangle(&placed, TAXEL.radius, &TAXEL, center.truncate()),
                    _ => (travel - start).clamp(0.0, TAXEL.stroke),
                };
                assert!(
                    (found - exact).abs() < 1e-12,
                    "sequence {sequence}, press {press}: {found} for {exact}"
                );
            }
            n_touched[goal] += contact.n_touched;
            n_cases += 1;
        }
    }
    assert!(n_cases > 2_000, "{n_cases}");
    assert!(n_touched.iter().all(|&n| n > 4_000), "{n_touched:?}");
}
