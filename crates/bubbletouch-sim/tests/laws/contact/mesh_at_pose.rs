//! Laws of grids pressed on meshes at a pose: comparison with every triangle, with a cast for each taxel, and among vector instructions.

use crate::mesh_shapes::{cuboid, icosphere};
use crate::random_scenes::{TAXEL, direction, random_pose, rng};
use bubbletouch_sim::contact::{Instructions, Press, Until, Workspace, stopping_height};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Surface, Triangle, TriangleMesh};
use bubbletouch_sim::objects::{MeshModel, Model};
use bubbletouch_sim::world::{Grid, Patch, Taxel};
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;

/// Returns triangles of very different sizes that intersect each other, some of them degenerate.
fn soup(rng: &mut impl Rng, size: f64) -> TriangleMesh {
    let mut corners = Vec::new();
    for n in 0..60 {
        let center = rng.gen_range(0.0..size) * direction(rng);
        let length = 10f64.powf(rng.gen_range(-4.0..-1.5));
        let first = center + length * direction(rng);
        let second = center + length * direction(rng);
        let third = match n % 10 {
            0 => first,
            1 => 0.3 * first + 0.7 * second,
            _ => center + length * direction(rng),
        };
        corners.extend([first, second, third]);
    }
    let faces = (0..60).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]);
    TriangleMesh::new("soup", corners, faces.collect()).unwrap()
}

/// Returns a closed mesh for kinds 0 to 4, otherwise triangles that enclose nothing.
fn random_mesh(rng: &mut impl Rng, kind: u64) -> TriangleMesh {
    let size = rng.gen_range(5e-3..4e-2);
    let tolerance = 10f64.powf(rng.gen_range(-4.5..-3.0));
    let mesh = match kind {
        0 => cuboid(size * DVec3::new(1.0, rng.gen_range(0.1..1.0), rng.gen_range(0.05..1.0))),
        1 => icosphere(size, rng.gen_range(0..4)),
        2 => TriangleMesh::cylinder("c", size, size, tolerance).unwrap(),
        3 => TriangleMesh::ellipsoid("e", size * DVec3::new(1.0, 0.5, 0.2), tolerance).unwrap(),
        // The corners of half of the triangles are exchanged, so the surface has no outer side.
        4 => {
            let ball = icosphere(size, 2);
            let turned = |(k, face): (usize, &[u32; 3])| match k % 2 {
                0 => *face,
                _ => [face[0], face[2], face[1]],
            };
            let faces = ball.triangles().iter().enumerate().map(turned);
            TriangleMesh::new("mixed", ball.vertices().to_vec(), faces.collect()).unwrap()
        }
        _ => soup(rng, size),
    };
    let far = if rng.gen_bool(0.2) { 3.0 } else { 0.0 };
    mesh.moved(&Pose::from_translation(far * direction(rng)))
}

/// Returns a grid, and a mesh of a kind from 0 to 5 at a pose in front of it, on it or behind it.
fn random_scene(case: u64) -> (Patch, TriangleMesh, f64, Pose) {
    let mut rng = rng("mesh at pose", case);
    let mesh = random_mesh(&mut rng, case % 6);
    let grid = Grid {
        nx: rng.gen_range(1..24),
        ny: rng.gen_range(1..24),
        pitch: rng.gen_range(5e-4..6e-3),
    };
    let taxel = Taxel {
        radius: rng.gen_range(2e-4..4e-3),
        stiffness: 100.0,
        damping: 0.0,
        stroke: rng.gen_range(1e-3..1e-2),
    };
    let rotation = match rng.gen_range(0..4) {
        0 => DQuat::IDENTITY,
        1 => DQuat::from_rotation_z(rng.gen_range(0.0..6.0)),
        _ => random_pose(&mut rng, 0.0).rotation,
    };
    let corner = mesh.vertices()[rng.gen_range(0..mesh.vertices().len())];
    let mut share = |n: usize| rng.gen_range(-0.6..0.6) * n as f64 * grid.pitch;
    let (x, y) = (share(grid.nx), share(grid.ny));
    let place = DVec3::new(x, y, rng.gen_range(-1.5..1.0) * taxel.stroke);
    let mut pose = Pose::new(rotation, place - rotation * corner);
    if rng.gen_bool(0.3) {
        // Corners, edges and diagonals of faces often lie on the axes of taxels.
        pose.translation.x = (pose.translation.x / grid.pitch).round() * grid.pitch;
        pose.translation.y = 0.0;
    }
    let rounding = if rng.gen_bool(0.3) {
        rng.gen_range(1e-4..5e-3)
    } else {
        0.0
    };
    (Patch::grid(grid, taxel).unwrap(), mesh, rounding, pose)
}

fn model(mesh: &TriangleMesh, rounding: f64) -> Model {
    MeshModel::rounded(mesh.clone(), rounding).unwrap().into()
}

#[test]
fn a_grid_on_a_mesh_equals_a_cast_for_each_taxel() {
    let (mut n_touched, mut n_saturated) = (0, 0);
    for case in 0..3_000 {
        let (patch, mesh, rounding, pose) = random_scene(case);
        let objects = [model(&mesh, rounding)];
        let mut casts = Workspace::new();
        let expected = Press::new(&patch, &objects, &[pose], Until::Pose)
            .with_contacts()
            .run(&mut casts)
            .unwrap()
            .unwrap_or_default();
        let mut first: Option<Vec<f64>> = None;
        for &instructions in Instructions::here() {
            let mut workspace = Workspace::with(instructions);
            let found = Press::new(&patch, &objects, &[pose], Until::Pose)
                .run(&mut workspace)
                .unwrap()
                .unwrap_or_default();
            for (found, expected) in workspace.deflections().iter().zip(casts.deflections()) {
                let difference = (found - expected).abs();
                assert!(difference < 1e-12, "case {case}: {found} {expected}");
            }
            assert_eq!(found.n_saturated, expected.n_saturated, "case {case}");
            let bits = first.get_or_insert_with(|| workspace.deflections().to_vec());
            assert!(
                bits == workspace.deflections(),
                "case {case}, {instructions:?}"
            );
        }
        n_touched += expected.n_touched;
        n_saturated += expected.n_saturated;
    }
    assert!(n_touched > 50_000, "{n_touched}");
    assert!(
        n_saturated > 10_000 && n_saturated < n_touched,
        "{n_saturated}"
    );
}

#[test]
fn a_grid_on_a_rough_scan_equals_a_cast_for_each_taxel() {
    let mut n_touched = 0;
    for case in 0..40 {
        let mut rng = rng("rough scan", case);
        // Triangles from a tenth of a pitch to several pitches, and bumps from far smaller than a triangle to spikes.
        let ball = icosphere(rng.gen_range(5e-3..6e-2), rng.gen_range(3..6));
        let roughness = 10f64.powf(rng.gen_range(-6.0..-3.0));
        let bumps = ball.vertices().iter();
        let bumps = bumps.map(|&vertex| vertex + roughness * direction(&mut rng));
        let mesh = TriangleMesh::new("rough", bumps.collect(), ball.triangles().to_vec()).unwrap();
        let grid = Grid {
            nx: 40,
            ny: 30,
            pitch: rng.gen_range(1e-3..3e-3),
        };
        let patch = Patch::grid(grid, TAXEL).unwrap();
        let pose = random_pose(&mut rng, 0.0);
        let far = Pose::new(pose.rotation, DVec3::new(0.0, 0.0, 0.1));
        let objects = [model(&mesh, 0.0)];
        let depth = rng.gen_range(0.2..1.5) * TAXEL.stroke;
        let mut workspace = Workspace::new();
        let contact = Press::new(&patch, &objects, &[far], Until::Depth(depth))
            .run(&mut workspace)
            .unwrap()
            .unwrap();
        let pose = Pose::new(pose.rotation, DVec3::new(0.0, 0.0, 0.1 - contact.travel));
        let mut casts = Workspace::new();
        n_touched += Press::new(&patch, &objects, &[pose], Until::Pose)
            .with_contacts()
            .run(&mut casts)
            .unwrap()
            .unwrap_or_default()
            .n_touched;
        let mut first: Option<Vec<f64>> = None;
        for &instructions in Instructions::here() {
            let mut workspace = Workspace::with(instructions);
            Press::new(&patch, &objects, &[pose], Until::Pose)
                .run(&mut workspace)
                .unwrap();
            for (found, expected) in workspace.deflections().iter().zip(casts.deflections()) {
                let difference = (found - expected).abs();
                assert!(difference < 1e-12, "case {case}: {found} {expected}");
            }
            let bits = first.get_or_insert_with(|| workspace.deflections().to_vec());
            assert!(
                bits == workspace.deflections(),
                "case {case}, {instructions:?}"
            );
        }
        let deepest = casts.deflections().iter().fold(0.0_f64, |a, &b| a.max(b));
        let expected = depth.min(TAXEL.stroke);
        assert!((deepest - expected).abs() < 1e-12, "case {case}");
    }
    assert!(n_touched > 2_000, "{n_touched}");
}

/// Returns the deflection that the documented rule gives a taxel at `at`, evaluated over all triangles.
pub(super) fn by_every_triangle(surface: &Surface, reach: f64, taxel: &Taxel, at: DVec2) -> f64 {
    let behind = taxel.substrate();
    let mesh = surface.mesh();
    let mut lowest = f64::INFINITY;
    for triangle in (0..mesh.n_triangles()).map(|number| mesh.triangle(number)) {
        let Some(height) = stopping_height(&triangle, reach, at) else {
            continue;
        };
        let upside_down = Triangle(triangle.0.map(|v| DVec3::new(v.x, v.y, -v.z)));
        let far_side = -stopping_height(&upside_down, reach, at).unwrap_or(f64::INFINITY);
        if far_side >= behind {
            lowest = lowest.min(height);
        }
    }
    let beside = at + taxel.radius * DVec2::new(0.011, 0.007);
    if surface.contains(beside.extend(behind)) {
        return taxel.stroke;
    }
    (-lowest).clamp(0.0, taxel.stroke)
}

#[test]
fn a_grid_on_a_mesh_equals_all_triangles_one_by_one() {
    let mut n_touched = 0;
    for case in (0..900).filter(|case| case % 6 < 4) {
        let (patch, mesh, rounding, pose) = random_scene(case);
        let placed = Surface::new(mesh.moved(&pose));
        let mut workspace = Workspace::new();
        Press::new(&patch, &[model(&mesh, rounding)], &[pose], Until::Pose)
            .run(&mut workspace)
            .unwrap();
        let taxel = patch.taxels().at(0);
        let reach = taxel.radius + rounding;
        for (found, center) in workspace.deflections().iter().zip(patch.layout().centers()) {
            let exact = by_every_triangle(&placed, reach, taxel, center.truncate());
            assert!(
                (found - exact).abs() < 1e-12,
                "case {case}: {found} {exact}"
            );
            n_touched += usize::from(*found > 0.0);
        }
    }
    assert!(n_touched > 10_000, "{n_touched}");
}
