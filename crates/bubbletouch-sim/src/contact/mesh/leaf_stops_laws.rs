//! Laws of the stops of leaves: comparison with every triangle for each taxel, among vector instructions, and with the scene moved and mirrored.

use super::leaf_stops::{LeafStops, SearchStack, stop_leaf};
use super::skin_mesh::MeshAt;
use crate::contact::Instructions;
use crate::geometry::Pose;
use crate::mesh::{Triangle, TriangleMesh};
use crate::objects::MeshModel;
use crate::random::Seed;
use crate::world::{Grid, LEAF, Layout, Patch, PlacedTaxel, Taxel, Taxels};
use glam::{DQuat, DVec3};
use rand::Rng;

fn direction(rng: &mut impl Rng) -> DVec3 {
    let mut random = || rng.gen_range(-1.0..1.0);
    DVec3::new(random(), random(), random()).normalize_or(DVec3::X)
}

fn turn(rng: &mut impl Rng) -> DQuat {
    DQuat::from_scaled_axis(rng.gen_range(0.0..3.0) * direction(rng))
}

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

/// Returns a sheet without thickness, whose triangles are about a millimetre large.
fn sheet(rng: &mut impl Rng, size: f64) -> TriangleMesh {
    let n = 20_u32;
    let bend = rng.gen_range(-1.0..1.0) / size;
    let corners = (0..n * n).map(|i| {
        let (x, y) = (f64::from(i % n) / 19.0 - 0.5, f64::from(i / n) / 19.0 - 0.5);
        let (x, y) = (2.0 * size * x, 2.0 * size * y);
        DVec3::new(x, y, bend * x * x) + 1e-4 * direction(rng)
    });
    let corners: Vec<DVec3> = corners.collect();
    let cells = (0..n * n).filter(|i| i % n < n - 1 && i / n < n - 1);
    let faces = cells.flat_map(|i| [[i, i + 1, i + n], [i + 1, i + n + 1, i + n]]);
    TriangleMesh::new("sheet", corners, faces.collect()).unwrap()
}

fn random_mesh(rng: &mut impl Rng, kind: u64) -> TriangleMesh {
    let size = rng.gen_range(5e-3..4e-2);
    let tolerance = 10f64.powf(rng.gen_range(-4.0..-3.0));
    let flat = DVec3::new(1.0, rng.gen_range(0.1..1.0), rng.gen_range(0.05..1.0));
    let mesh = match kind % 6 {
        0 => TriangleMesh::cuboid("box", 2.0 * size * flat).unwrap(),
        1 => TriangleMesh::ellipsoid("e", size * flat, tolerance).unwrap(),
        2 => TriangleMesh::cylinder("c", size, size, tolerance).unwrap(),
        // The corners of half of the triangles are exchanged, so the surface has no outer side.
        3 => {
            let ball = TriangleMesh::ellipsoid("e", DVec3::splat(size), 1e-3).unwrap();
            let turned = |(k, face): (usize, &[u32; 3])| match k % 2 {
                0 => *face,
                _ => [face[0], face[2], face[1]],
            };
            let faces = ball.triangles().iter().enumerate().map(turned).collect();
            TriangleMesh::new("mixed", ball.vertices().to_vec(), faces).unwrap()
        }
        4 => soup(rng, size),
        _ => sheet(rng, size),
    };
    let far = if rng.gen_bool(0.2) { 3.0 } else { 0.0 };
    mesh.moved(&Pose::from_translation(far * direction(rng)))
}

struct Scene {
    patch: Patch,
    mesh: MeshModel,
    pose: Pose,
}

/// Returns a patch whose axes vary smoothly, are parallel, or are random, and a mesh near one of its taxels.
fn random_scene(case: u64) -> Scene {
    let mut rng = Seed::new(31).named("leaf stops").numbered(case).rng();
    let size = rng.gen_range(6e-3..3e-2);
    let pitch = rng.gen_range(1e-3..4e-3);
    let (nx, ny) = (12, 9);
    let layout = match case % 5 {
        0 => Layout::cylinder(size, 2.0 * size, rng.gen_range(0.5..6.2), pitch),
        1 => Layout::sphere_cap(size, rng.gen_range(0.5..3.0), pitch),
        2 => Layout::grid(&Grid { nx, ny, pitch }),
        3 => {
            let tilt = turn(&mut rng);
            let grid = Layout::grid(&Grid { nx, ny, pitch }).unwrap();
            Ok(grid.moved(&Pose::from_rotation(tilt)))
        }
        _ => {
            let centers: Vec<DVec3> = (0..90).map(|_| size * direction(&mut rng)).collect();
            let axes = centers.iter().map(|_| direction(&mut rng)).collect();
            Layout::new(centers, axes)
        }
    };
    let layout = layout.unwrap();
    let mut one = || Taxel {
        radius: rng.gen_range(0.3e-3..3e-3),
        stiffness: 100.0,
        damping: 0.0,
        stroke: rng.gen_range(1e-3..8e-3),
    };
    let taxels = match case % 3 {
        0 => Taxels::Each((0..layout.n_taxels()).map(|_| one()).collect()),
        _ => Taxels::Equal(one()),
    };
    let taxel = rng.gen_range(0..layout.n_taxels());
    let (center, axis) = (layout.centers()[taxel], layout.axes()[taxel]);
    let mesh = random_mesh(&mut rng, case / 5);
    let corner = mesh.vertices()[rng.gen_range(0..mesh.vertices().len())];
    let rotation = if rng.gen_bool(0.2) {
        DQuat::IDENTITY
    } else {
        turn(&mut rng)
    };
    let height = rng.gen_range(-1.5..0.7) * taxels.at(taxel).stroke;
    let place = center + height * axis + rng.gen_range(0.0..pitch) * direction(&mut rng);
    let rounding = if rng.gen_bool(0.3) {
        rng.gen_range(1e-4..5e-3)
    } else {
        0.0
    };
    Scene {
        patch: Patch::new("skin", layout, taxels).unwrap(),
        mesh: MeshModel::rounded(mesh, rounding).unwrap(),
        pose: Pose::new(rotation, place - rotation * corner),
    }
}

/// Returns the height and the triangle at which the mesh stops a taxel, by every triangle.
fn by_every_triangle(mesh: &MeshAt, taxel: &PlacedTaxel) -> Option<(f64, u32)> {
    let numbers = 0..mesh.model().mesh().n_triangles();
    let stops = numbers.filter_map(|triangle| {
        let height = mesh.stop_in_front(taxel, triangle)?;
        (height < 0.0).then_some((height, triangle as u32))
    });
    let found = stops.reduce(|a, b| if b.0 < a.0 { b } else { a });
    match found {
        Some((height, _)) if height < taxel.behind + taxel.radius => found,
        _ => {
            let entered = mesh.entered(taxel);
            entered
                .map(|stop| (stop.height, stop.triangle as u32))
                .or(found)
        }
    }
}

/// Returns the point of a triangle nearest to a taxel at its stop, and the direction from the point to the taxel.
fn contact(scene: &Scene, taxel: &PlacedTaxel, (height, triangle): (f64, u32)) -> [DVec3; 2] {
    let corners = scene.mesh.mesh().triangle(triangle as usize).0;
    let triangle = Triangle(corners.map(|corner| scene.pose.transform_point(corner)));
    let center = taxel.center + height * taxel.axis;
    let (point, _) = triangle.closest(center);
    [point, (center - point).normalize_or_zero()]
}

/// Calls `visit` for each taxel of a scene, with its stop computed by the search with vector instructions.
fn each_stop(
    scene: &Scene,
    instructions: Instructions,
    mut visit: impl FnMut(&PlacedTaxel, Option<(f64, u32)>),
) {
    let mesh = MeshAt::new(&scene.mesh, &scene.pose);
    scene.patch.tree().each_leaf(
        |_| true,
        |leaf| {
            let mut stops = LeafStops::below_rest();
            stop_leaf(
                instructions,
                &mesh,
                leaf,
                &mut stops,
                &mut SearchStack::new(),
            );
            for k in (0..LEAF).filter(|k| leaf.is_used(*k)) {
                let stop = stops.triangles[k].map(|triangle| (stops.heights[k], triangle));
                visit(&leaf.taxel(k), stop);
            }
        },
    );
}

#[test]
fn the_search_of_a_leaf_finds_the_stop_by_every_triangle() {
    let (mut n_touched, mut n_saturated, mut n_ties) = (0, 0, 0);
    for case in 0..450 {
        let scene = random_scene(case);
        let mesh = MeshAt::new(&scene.mesh, &scene.pose);
        each_stop(&scene, Instructions::Best, |taxel, found| {
            let expected = by_every_triangle(&mesh, taxel);
            let height = |stop: Option<(f64, u32)>| stop.map_or(0.0, |stop| stop.0);
            let difference = (height(found) - height(expected)).abs();
            assert!(
                difference < 1e-12,
                "case {case}, taxel {}: {found:?} for {expected:?}",
                taxel.number
            );
            let (Some(found), Some(expected)) = (found, expected) else {
                return;
            };
            n_touched += 1;
            n_saturated += usize::from(found.0 < taxel.behind + taxel.radius);
            n_ties += usize::from(found.1 != expected.1);
            let [a, b] = [found, expected].map(|stop| contact(&scene, taxel, stop));
            assert!(
                a[0].distance(b[0]) < 1e-9 && a[1].distance(b[1]) < 1e-6,
                "case {case}, taxel {}: {a:?} for {b:?}, {found:?} for {expected:?}",
                taxel.number
            );
        });
    }
    assert!(n_touched > 8_000, "{n_touched}");
    assert!(n_saturated > 1_000, "{n_saturated}");
    assert!(n_ties < n_touched / 2, "{n_ties} of {n_touched}");
}

#[test]
fn a_rigid_motion_of_skin_and_mesh_changes_no_stop() {
    let (mut n_touched, mut n_changed) = (0, 0);
    for case in 0..300 {
        let scene = random_scene(case);
        let mut rng = Seed::new(32).numbered(case).rng();
        let motion = Pose::new(turn(&mut rng), 0.1 * direction(&mut rng));
        let patch = &scene.patch;
        let moved = Scene {
            patch: Patch::new(
                "moved",
                patch.layout().moved(&motion),
                patch.taxels().clone(),
            )
            .unwrap(),
            mesh: scene.mesh.clone(),
            pose: motion.compose(&scene.pose),
        };
        // The deflection needed by a taxel inside the mesh depends on the ray that enters the mesh, so heights are limited to the stroke.
        let heights = |scene: &Scene| {
            let mut heights = vec![0.0; scene.patch.n_taxels()];
            each_stop(scene, Instructions::Best, |taxel, stop| {
                let lowest = taxel.behind + taxel.radius;
                heights[taxel.number as usize] = stop.map_or(0.0, |stop| stop.0.max(lowest));
            });
            heights
        };
        let (before, after) = (heights(&scene), heights(&moved));
        n_touched += before.iter().filter(|height| **height < 0.0).count();
        let pairs = before.iter().zip(&after);
        n_changed += pairs.filter(|(a, b)| (**a - **b).abs() > 1e-9).count();
    }
    assert!(n_touched > 5_000, "{n_touched}");
    // A ray a hundredth of a radius beside the axis decides whether a substrate is inside the mesh.
    assert!(n_changed <= n_touched / 1000, "{n_changed} of {n_touched}");
}

#[test]
fn the_lowest_stop_of_a_leaf_is_the_lowest_of_its_taxels() {
    let mut n_touched = 0;
    for case in 0..300 {
        let scene = random_scene(case);
        let mesh = MeshAt::new(&scene.mesh, &scene.pose);
        let taxels = &crate::world::Travelling::new(&scene.patch, DVec3::Z).taxels;
        taxels.each_leaf(
            |_| true,
            |leaf| {
                let mut stops = LeafStops::lowest_below(-1e-4);
                stop_leaf(
                    Instructions::Best,
                    &mesh,
                    leaf,
                    &mut stops,
                    &mut SearchStack::new(),
                );
                let lowest = stops.heights.iter().fold(0.0, |a: f64, b| a.min(*b));
                let used = (0..LEAF).filter(|k| leaf.is_used(*k));
                let each = used.filter_map(|k| by_every_triangle(&mesh, &leaf.taxel(k)));
                let expected = each.fold(-1e-4, |a: f64, (height, _)| a.min(height));
                assert!((lowest - expected).abs() < 1e-12, "case {case}");
                n_touched += usize::from(lowest < -1e-4);
            },
        );
    }
    assert!(n_touched > 500, "{n_touched}");
}
