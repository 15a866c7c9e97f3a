//! Laws of contact with a mesh: one taxel and one triangle against a search, a patch against every triangle, and closed forms.

use crate::random_scenes::Scene;
use bubbletouch_sim::contact::{Contact, Press, Until, Workspace, stopping_height};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Triangle, TriangleMesh};
use bubbletouch_sim::objects::{MeshModel, Model, Sphere, SphereUnion};
use bubbletouch_sim::world::{Grid, Patch, Phase, RestPoses, Taxel, VelocityPlan};
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;

use crate::mesh_shapes::{cuboid, icosphere};
use crate::random_scenes::{TAXEL, direction, random_pose, rng};
use crate::time_loop::time_loop;

/// Returns a triangle of size 1: arbitrary, thin, collinear, a point, vertical, horizontal, or with a vertical edge.
fn odd_triangle(rng: &mut impl Rng, kind: u64) -> Triangle {
    let [a, mut b, mut c] = [0; 3].map(|_| direction(rng) * rng.gen_range(0.1..1.0));
    match kind % 8 {
        1 => c = a + 0.3 * (b - a) + 10f64.powf(rng.gen_range(-12.0..-2.0)) * direction(rng),
        2 => c = a + rng.gen_range(-1.0..2.0) * (b - a),
        3 => (b, c) = (a, a),
        4 => c = a + DVec3::new(0.7 * (b - a).x, 0.7 * (b - a).y, 0.8),
        5 => (b.z, c.z) = (a.z, a.z),
        6 => b = a + DVec3::Z * rng.gen_range(0.1..1.0),
        _ => {}
    }
    Triangle([a, b, c])
}

/// Returns the lowest z at which a ball at (x, y) is a radius away from the triangle. Sampling finds a point that is nearer, and bisection follows below it.
/// The distance to a convex set is convex along the line.
pub(super) fn stopping_height_by_search(
    triangle: &Triangle,
    radius: f64,
    at: DVec2,
) -> Option<f64> {
    let distance = |z: f64| {
        let point = at.extend(z);
        triangle.closest(point).0.distance(point)
    };
    let bounds = triangle.bounds();
    let (bottom, top) = (bounds.min.z - 2.0 * radius, bounds.max.z + 2.0 * radius);
    let (mut low, mut high) = (bottom, top);
    for _ in 0..150 {
        let (l, h) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
        // Equal values count as lower: where the distance is flat, the lower position is as near.
        if distance(l) <= distance(h) {
            high = h
        } else {
            low = l
        }
    }
    let nearest = 0.5 * (low + high);
    if distance(nearest) >= radius {
        return None;
    }
    let (mut outside, mut inside) = (bottom, nearest);
    for _ in 0..80 {
        let middle = 0.5 * (outside + inside);
        if distance(middle) >= radius {
            outside = middle
        } else {
            inside = middle
        }
    }
    Some(inside)
}

#[test]
fn a_taxel_stops_at_a_triangle_where_a_search_says() {
    let (mut n_met, mut worst) = (0, 0.0_f64);
    for case in 0..8_000 {
        let mut rng = rng("stop", case);
        let size = 10f64.powf(rng.gen_range(-3.5..-0.5));
        let triangle = Triangle(odd_triangle(&mut rng, case).0.map(|v| size * v));
        let radius = 10f64.powf(rng.gen_range(-3.5..-2.0));
        let weights = DVec3::new(rng.r#gen(), rng.r#gen(), rng.r#gen());
        let [a, b, c] = triangle.0;
        let under = (weights.x * a + weights.y * b + weights.z * c) / weights.element_sum();
        let away = direction(&mut rng) * rng.gen_range(0.0..1.5) * radius;
        let at = DVec2::new(under.x + away.x, under.y + away.y);
        let searched = stopping_height_by_search(&triangle, radius, at);
        match (stopping_height(&triangle, radius, at), searched) {
            (Some(found), Some(searched)) => {
                n_met += 1;
                worst = worst.max((found - searched).abs());
                assert!(
                    (found - searched).abs() < 1e-9,
                    "case {case}: {found} {searched} {triangle:?}"
                );
            }
            (None, None) => {}
            (found, searched) => {
                // At the rim the height has no finite slope, and the ball misses the triangle only by rounding.
                let larger = stopping_height_by_search(&triangle, radius * (1.0 + 1e-12), at);
                let smaller = stopping_height_by_search(&triangle, radius * (1.0 - 1e-12), at);
                assert!(
                    larger.is_some() != smaller.is_some(),
                    "case {case}: {found:?} {searched:?} {triangle:?}"
                );
            }
        }
    }
    assert!(n_met > 4_000, "{n_met}");
    assert!(worst > 0.0, "{worst}");
}

/// Returns the heights at which each object's triangles stop each taxel, from the closed form for one taxel; infinite if no triangle does.
fn every_triangle(scene: &Scene, poses: &[Pose]) -> Vec<(f64, Vec<f64>)> {
    let (grid, taxel) = scene.grid();
    let heights = |(object, pose): (&Model, &Pose)| {
        let Model::Mesh(mesh) = object else {
            panic!("a scene of meshes")
        };
        let placed = mesh.mesh().moved(pose);
        let top = placed
            .vertices()
            .iter()
            .map(|v| v.z)
            .fold(f64::MIN, f64::max);
        let mut heights = vec![f64::INFINITY; grid.n_taxels()];
        for t in 0..placed.n_triangles() {
            for (k, lowest) in heights.iter_mut().enumerate() {
                let at = DVec2::new(grid.x(k % grid.nx), grid.y(k / grid.nx));
                let height = stopping_height(&placed.triangle(t), taxel.radius, at);
                *lowest = lowest.min(height.unwrap_or(f64::INFINITY));
            }
        }
        (top, heights)
    };
    scene.objects.iter().zip(poses).map(heights).collect()
}

/// Computes deflections from the heights at which meshes stop the taxels, as the contact module's documentation defines. Meshes that are lower than `behind` do
/// not count.
fn deflections(scene: &Scene, heights: &[(f64, Vec<f64>)], travel: f64, behind: f64) -> Vec<f64> {
    let (grid, taxel) = scene.grid();
    let mut deflections = vec![0.0_f64; grid.n_taxels()];
    for (top, heights) in heights {
        if *top >= behind {
            for (deflection, height) in deflections.iter_mut().zip(heights) {
                *deflection = deflection.max(travel - height).min(taxel.stroke);
            }
        }
    }
    deflections
}

/// Returns a crumpled surface, a box, a ball, or loose triangles of all kinds.
fn random_mesh(rng: &mut impl Rng, kind: u64) -> TriangleMesh {
    let size = 10f64.powf(rng.gen_range(-2.5..-1.2));
    match kind % 4 {
        0 => cuboid(
            size * DVec3::new(
                rng.gen_range(0.1..1.0),
                rng.gen_range(0.1..1.0),
                rng.gen_range(0.01..1.0),
            ),
        ),
        1 => icosphere(size, rng.gen_range(0..4)),
        2 => {
            let n = rng.gen_range(2..12_u32);
            let mut corners = Vec::new();
            for i in 0..n * n {
                let flat = DVec3::new(f64::from(i % n), f64::from(i / n), 0.0) / f64::from(n);
                corners.push(size * (flat + rng.gen_range(0.0..0.3) * direction(rng) - 0.5));
            }
            let cells = (0..n * n).filter(|i| i % n < n - 1 && i / n < n - 1);
            let faces = cells.flat_map(|i| [[i, i + 1, i + n], [i + 1, i + n + 1, i + n]]);
            TriangleMesh::new("sheet", corners, faces.collect()).unwrap()
        }
        _ => {
            let corners: Vec<DVec3> = (0..30).flat_map(|k| odd_triangle(rng, k).0).collect();
            let faces = (0..30).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let corners = corners.iter().map(|v| size * v).collect();
            TriangleMesh::new("loose", corners, faces).unwrap()
        }
    }
}

fn random_scene(rng: &mut impl Rng, kind: u64) -> (Scene, Vec<Pose>) {
    let grid = Grid {
        nx: rng.gen_range(1..24),
        ny: rng.gen_range(1..24),
        pitch: 10f64.powf(rng.gen_range(-3.3..-2.2)),
    };
    let taxel = Taxel {
        radius: grid.pitch * rng.gen_range(0.2..1.5),
        ..TAXEL
    };
    let n = rng.gen_range(1..3);
    let objects: Vec<Model> = (0..n)
        .map(|k| MeshModel::new(random_mesh(rng, kind + k)).into())
        .collect();
    let poses = objects.iter().map(|_| match kind % 3 {
        // Vertical pose: flat faces and vertical walls at the skin.
        0 => Pose::from_translation(0.01 * direction(rng)),
        _ => random_pose(rng, 0.01),
    });
    let poses = poses.collect();
    let patch = Patch::grid(grid, taxel).unwrap();
    (Scene { patch, objects }, poses)
}

fn assert_close(a: &[f64], b: &[f64], tolerance: f64, what: &str) {
    for (taxel, (x, y)) in a.iter().zip(b).enumerate() {
        assert!(
            (x - y).abs() <= tolerance,
            "{what}: taxel {taxel}: {x} and {y}"
        );
    }
}

#[test]
fn a_patch_feels_what_every_triangle_does_to_every_taxel() {
    let mut workspace = Workspace::new();
    let mut n_touched = 0;
    for case in 0..300 {
        let mut rng = rng("patch", case);
        let (scene, poses) = random_scene(&mut rng, case);
        let heights = every_triangle(&scene, &poses);
        let travel = rng.gen_range(-0.03..0.03);
        Press::new(&scene.patch, &scene.objects, &poses, Until::Travel(travel))
            .run(&mut workspace)
            .unwrap();
        let all = f64::NEG_INFINITY;
        let expected = deflections(&scene, &heights, travel, all);
        assert_close(
            workspace.deflections(),
            &expected,
            1e-12,
            &format!("case {case}"),
        );
        n_touched += expected.iter().filter(|&&d| d > 0.0).count();

        let lowest = heights.iter().flat_map(|(_, heights)| heights).copied();
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        let press = Press::new(&scene.patch, &scene.objects, &poses, Until::Depth(0.0));
        let Some(Contact { travel: first, .. }) = press.run(&mut workspace).unwrap() else {
            assert_eq!(lowest, f64::INFINITY, "case {case}");
            continue;
        };
        assert!(
            (first - lowest).abs() < 1e-12,
            "case {case}: {first} {lowest}"
        );
        let depth = match case % 3 {
            0 => rng.gen_range(0.0..0.2),
            _ => rng.gen_range(0.0..0.02),
        };
        let contact = Press::new(&scene.patch, &scene.objects, &poses, Until::Depth(depth))
            .run(&mut workspace)
            .unwrap()
            .unwrap();
        assert_eq!(contact.travel, first + depth);
        let expected = deflections(&scene, &heights, first + depth, all);
        let what = format!("case {case}, depth {depth}");
        assert_close(workspace.deflections(), &expected, 1e-12, &what);
    }
    assert!(n_touched > 5_000, "the cases press for real: {n_touched}");
}

#[test]
fn a_box_pressed_flat_is_flat_and_its_edge_is_round() {
    let grid = Grid {
        nx: 41,
        ny: 1,
        pitch: 1e-3,
    };
    let patch = Patch::grid(grid, TAXEL).unwrap();
    // The box extends from x = −10.4 mm to 10.4 mm, and upwards from z = 0.
    let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 0.05));
    let objects = vec![MeshModel::new(cuboid(DVec3::new(10.4e-3, 0.02, 0.05))).into()];
    let mut workspace = Workspace::new();
    let contact = Press::new(&patch, &objects, &[pose], Until::Depth(2e-3))
        .run(&mut workspace)
        .unwrap()
        .unwrap();
    assert!((contact.travel - (2e-3 - TAXEL.radius)).abs() < 1e-16);
    for (column, &found) in workspace.deflections().iter().enumerate() {
        let beside: f64 = (grid.x(column).abs() - 10.4e-3).max(0.0);
        // A taxel 0.6 mm beside the edge stops 0.8 mm below the edge, whereas a taxel under the face stops 1 mm below it.
        let exact = if beside < TAXEL.radius {
            2e-3 - TAXEL.radius + (TAXEL.radius.powi(2) - beside * beside).sqrt()
        } else {
            0.0
        };
        assert!(
            (found - exact).abs() < 1e-15,
            "column {column}: {found} {exact}"
        );
    }
}

#[test]
fn a_finer_ball_feels_like_a_sphere() {
    let grid = Grid {
        nx: 32,
        ny: 32,
        pitch: 2e-3,
    };
    let patch = Patch::grid(grid, TAXEL).unwrap();
    let pose = Pose::new(
        DQuat::from_scaled_axis(DVec3::new(0.3, 0.2, 0.1)),
        DVec3::new(3e-4, 5e-4, 0.04),
    );
    let mut workspace = Workspace::new();
    let mut felt = |object: Model| {
        Press::new(&patch, &[object], &[pose], Until::Travel(4e-3))
            .run(&mut workspace)
            .unwrap();
        workspace.deflections().to_vec()
    };
    let sphere = Sphere {
        center: DVec3::ZERO,
        radius: 0.04,
    };
    let exact = felt(SphereUnion::new(vec![sphere]).unwrap().into());
    let mut last = f64::INFINITY;
    for level in 1..7 {
        let found = felt(MeshModel::new(icosphere(0.04, level)).into());
        let difference = |(a, b): (&f64, &f64)| a - b;
        let worst = exact.iter().zip(&found).map(difference).fold(0.0, f64::max);
        assert!(
            exact.iter().zip(&found).all(|(a, b)| a >= b),
            "the mesh is inscribed"
        );
        assert!(worst < 0.4 * last, "level {level}: {worst} after {last}");
        last = worst;
    }
    assert!(last < 2e-5, "{last}");
}

#[test]
fn spheres_and_a_mesh_in_one_scene_feel_like_the_larger_of_both() {
    let patch = Patch::grid(
        Grid {
            nx: 30,
            ny: 30,
            pitch: 2e-3,
        },
        TAXEL,
    )
    .unwrap();
    let sphere = Sphere {
        center: DVec3::new(0.01, 0.0, 0.0),
        radius: 0.015,
    };
    let ball: Model = SphereUnion::new(vec![sphere]).unwrap().into();
    let brick: Model = MeshModel::new(cuboid(DVec3::splat(0.014))).into();
    let mut workspace = Workspace::new();
    let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 0.02));
    let mut felt = |objects: &[&Model], travel: Option<f64>| {
        let poses = vec![pose; objects.len()];
        let objects: Vec<Model> = objects.iter().map(|&o| o.clone()).collect();
        let contact = match travel {
            Some(travel) => Press::new(&patch, &objects, &poses, Until::Travel(travel))
                .run(&mut workspace)
                .unwrap()
                .unwrap_or_default(),
            None => Press::new(&patch, &objects, &poses, Until::Depth(3e-3))
                .run(&mut workspace)
                .unwrap()
                .unwrap(),
        };
        (contact.travel, workspace.deflections().to_vec())
    };
    let (travel, both) = felt(&[&ball, &brick], None);
    let (swapped_travel, swapped) = felt(&[&brick, &ball], None);
    assert_eq!((travel, &both), (swapped_travel, &swapped));
    let (ball, brick) = (
        felt(&[&ball], Some(travel)).1,
        felt(&[&brick], Some(travel)).1,
    );
    let larger: Vec<f64> = ball.iter().zip(&brick).map(|(a, b)| a.max(*b)).collect();
    assert_eq!(both, larger);
    assert!(ball.iter().any(|&d| d > 0.0) && brick.iter().any(|&d| d > 0.0));
}

#[test]
fn a_mesh_behind_the_substrate_does_not_count_unless_it_was_pressed_through_the_skin() {
    let patch = Patch::grid(
        Grid {
            nx: 8,
            ny: 8,
            pitch: 2e-3,
        },
        TAXEL,
    )
    .unwrap();
    let objects = vec![MeshModel::new(cuboid(DVec3::splat(0.01))).into()];
    let scene = Scene { patch, objects };
    let mut workspace = Workspace::new();
    let mut n_touched = |height: f64| {
        let pose = Pose::from_translation(DVec3::new(0.0, 0.0, height));
        Press::new(&scene.patch, &scene.objects, &[pose], Until::Pose)
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default()
            .n_touched
    };
    // The top of the mesh is at height + 10 mm. A taxel that rests on it is 1 mm higher, and the limit is 6 mm behind the skin.
    assert_eq!(n_touched(-0.01701), 0);
    assert_eq!(n_touched(-0.01699), 64);
    let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 0.05));
    let through = Press::new(&scene.patch, &scene.objects, &[pose], Until::Depth(0.05))
        .run(&mut workspace)
        .unwrap()
        .unwrap();
    assert_eq!((through.n_touched, through.n_saturated), (64, 64));
    // The patch moves 60 mm in steps of a millimetre.
    let down = Phase {
        duration: 0.1,
        linear: -DVec3::Z,
        angular: DVec3::ZERO,
    };
    let still = VelocityPlan::new(Pose::IDENTITY, Vec::new()).unwrap();
    let plan = VelocityPlan::new(pose, vec![down]).unwrap();
    let frames = time_loop(&scene, [&[still], &[plan]], 1e-3, 100);
    let last = &frames.deflections[99];
    assert!(last.iter().all(|&deflection| deflection == TAXEL.stroke));
}

#[test]
fn a_mesh_lies_on_the_table_like_its_solid() {
    let brick = Model::from(MeshModel::new(cuboid(DVec3::new(0.05, 0.03, 0.01))));
    assert!(brick.center_of_mass().length() < 1e-15);
    let poses = RestPoses::Stable.poses(&brick);
    let heights: Vec<f64> = poses.iter().map(|pose| 0.5 * pose.height).collect();
    assert!(
        (heights[0] - 0.01).abs() < 1e-9 && poses[0].probability > 0.3,
        "{heights:?}"
    );
    for half in [0.01, 0.03, 0.05] {
        assert!(
            heights.iter().any(|h| (h - half).abs() < 1e-9),
            "{half}: {heights:?}"
        );
    }
    let ball = icosphere(0.03, 3).moved(&Pose::from_translation(DVec3::X));
    let ball = Model::from(MeshModel::new(ball));
    assert!((ball.center_of_mass() - DVec3::X).length() < 1e-12);
    assert!((ball.bounds().size() - 0.06).abs().max_element() < 1e-3);
}
