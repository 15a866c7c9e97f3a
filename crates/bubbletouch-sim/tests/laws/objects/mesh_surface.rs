//! Nearest points, signed distances and winding numbers of meshes: comparison with closed forms and with exhaustive search.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Bvh, LengthUnit, MeshFeature, Surface, Triangle, TriangleMesh};
use glam::{DQuat, DVec3};
use rand::Rng;

use crate::mesh_shapes::{corners, cuboid, icosphere, with_triangles};
use crate::scenes::{direction, rng};

/// Creates random triangles of all sizes and shapes: slivers, points, and triangles with shared corners.
fn soup(rng: &mut impl Rng, n: usize) -> TriangleMesh {
    let mut vertices: Vec<DVec3> = Vec::new();
    for _ in 0..n {
        let size = 10f64.powf(rng.gen_range(-4.0..0.0));
        let at = direction(rng) * rng.gen_range(0.0..1.0);
        let thin = 10f64.powi(-rng.gen_range(0..12));
        let along = direction(rng);
        let across = direction(rng);
        let top = size * (0.4 * along + thin * across);
        vertices.extend([at, at + size * along, at + top]);
    }
    let count = vertices.len() as u32;
    let mut triangles: Vec<[u32; 3]> = (0..n as u32)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    triangles.extend((0..n / 10).map(|_| [0; 3].map(|_: u32| rng.gen_range(0..count))));
    TriangleMesh::in_unit("soup", LengthUnit::Metre, vertices, triangles).unwrap()
}

/// Returns the distance from a point to a triangle by nested ternary search over barycentric coordinates; the distance is convex in each.
fn distance_by_search(triangle: &Triangle, point: DVec3) -> f64 {
    let [a, b, c] = triangle.0;
    let at = |u: f64, v: f64| (a + u * (b - a) + (1.0 - u) * v * (c - a) - point).length();
    let smallest = |f: &dyn Fn(f64) -> f64| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..100 {
            let (l, h) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
            if f(l) < f(h) { high = h } else { low = l }
        }
        f(0.5 * (low + high)).min(f(0.0)).min(f(1.0))
    };
    smallest(&|u| smallest(&|v| at(u, v)))
}

#[test]
fn the_nearest_point_of_a_triangle_is_what_a_search_finds() {
    for case in 0..600 {
        let mut rng = rng("triangle", case);
        let triangle = soup(&mut rng, 1).triangle(0);
        let size = triangle.longest_edge_squared().sqrt();
        let point = triangle.0[0] + direction(&mut rng) * size * rng.gen_range(0.0..3.0);
        let (on, feature) = triangle.closest(point);
        let (found, searched) = (on.distance(point), distance_by_search(&triangle, point));
        // The search has no local minimum, but its last digits are inaccurate where the distance is flat.
        let (low, high) = (searched - 2e-8 * size, searched + 1e-12);
        let what = format!("case {case}: {found} {searched} {feature:?}");
        assert!((low..=high).contains(&found), "{what}");
    }
}

#[test]
fn features_are_where_the_point_says() {
    let triangle = Triangle([DVec3::ZERO, DVec3::X, DVec3::Y]);
    for (point, feature) in [
        ([0.2, 0.2, 1.0], MeshFeature::Face),
        ([0.5, -1.0, 1.0], MeshFeature::Edge(0)),
        ([1.0, 1.0, 0.0], MeshFeature::Edge(1)),
        ([-1.0, 0.5, 0.0], MeshFeature::Edge(2)),
        ([-1.0, -1.0, 0.0], MeshFeature::Vertex(0)),
        ([3.0, 0.0, 0.0], MeshFeature::Vertex(1)),
        ([0.0, 3.0, -1.0], MeshFeature::Vertex(2)),
    ] {
        assert_eq!(triangle.closest(point.into()).1, feature, "{point:?}");
    }
}

#[test]
fn the_tree_finds_what_trying_every_triangle_finds() {
    for case in 0..40 {
        let mut rng = rng("tree", case);
        let n = rng.gen_range(1..400);
        let mesh = soup(&mut rng, n);
        let bvh = Bvh::new(&mesh);
        let every = || (0..mesh.n_triangles()).map(|t| (t, mesh.triangle(t)));
        for _ in 0..50 {
            let point = direction(&mut rng) * rng.gen_range(0.0..2.0);
            let distances = every().map(|(_, t)| t.closest(point).0.distance_squared(point));
            let nearest = distances.fold(f64::INFINITY, f64::min).sqrt();
            let found = bvh.closest(point, f64::INFINITY).unwrap();
            assert_eq!(found.distance, nearest);
            assert_eq!(found.point.distance(point), nearest);
            let on_triangle = mesh.triangle(found.triangle).closest(point);
            assert_eq!(on_triangle, (found.point, found.feature));
            assert!(bvh.closest(point, nearest * (1.0 - 1e-12)).is_none());

            let along = direction(&mut rng);
            let crossed = every().filter_map(|(_, t)| t.crossed_at(point, along));
            let ahead = crossed.filter(|&s| s >= 0.0);
            let first = ahead.fold(f64::INFINITY, f64::min);
            let hit = bvh.first_hit(point, along, 0.0..f64::INFINITY);
            assert_eq!(hit.map_or(f64::INFINITY, |hit| hit.along), first);

            let mut region = Triangle([point, point + 0.3 * along, point]).bounds();
            region.max += 0.1;
            let mut inside = Vec::new();
            bvh.each_in_box(&region, |n, _| inside.push(n));
            inside.sort_unstable();
            let meets = |t: &Triangle| {
                let b = t.bounds();
                b.min.cmple(region.max).all() && region.min.cmple(b.max).all()
            };
            let expected: Vec<_> = every().filter(|(_, t)| meets(t)).map(|(n, _)| n).collect();
            assert_eq!(inside, expected);
        }
    }
}

#[test]
fn a_thousand_triangles_at_one_place_make_a_tree() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = TriangleMesh::new("pile", corners, vec![[0, 1, 2]; 1000]).unwrap();
    let within = |limit: f64| Bvh::new(&mesh).closest(DVec3::Z, limit);
    assert_eq!(within(2.0).unwrap().distance, 1.0);
    assert!(within(1.0).is_none(), "strictly closer");
}

#[test]
fn the_signed_distance_of_a_box_is_exact() {
    let half = DVec3::new(0.3, 0.1, 0.05);
    let surface = Surface::new(cuboid(half));
    assert!(surface.is_closed());
    let mut rng = rng("box", 0);
    for _ in 0..5000 {
        let point = 2.0 * half * direction(&mut rng) * rng.gen_range(0.0..1.0);
        let beyond = point.abs() - half;
        let exact = beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0);
        let found = surface.signed_distance(point);
        assert!((found - exact).abs() < 1e-15, "{point}: {found} {exact}");
    }
}

#[test]
fn the_signed_distance_of_a_finer_ball_is_closer_to_the_balls() {
    let mut last = f64::INFINITY;
    for level in 1..6 {
        let surface = Surface::new(icosphere(1.0, level));
        let mut rng = rng("ball", 0);
        let mut worst = 0.0_f64;
        for _ in 0..500 {
            let distance = rng.gen_range(0.5..2.0);
            let found = surface.signed_distance(distance * direction(&mut rng));
            assert!(found >= distance - 1.0 - 1e-14, "the mesh is inscribed");
            worst = worst.max((found - (distance - 1.0)).abs());
        }
        assert!(worst < 0.3 * last, "level {level}: {worst} after {last}");
        last = worst;
    }
    assert!(last < 1e-3);
}

#[test]
fn winding_numbers_agree_with_the_sum_over_all_triangles_and_with_signs() {
    let surface = Surface::new(icosphere(1.0, 4));
    let mesh = surface.mesh();
    let mut rng = rng("winding", 0);
    let mut worst = 0.0_f64;
    for _ in 0..400 {
        let point = direction(&mut rng) * rng.gen_range(0.0..1.5);
        let winding = surface.winding_number(point);
        let exact = f64::from(u8::from(surface.signed_distance(point) < 0.0));
        worst = worst.max((winding - exact).abs());
    }
    assert!(worst < 0.05, "{worst}");
    // A ball with a hole: the winding number is a fraction in the hole, and still nearly 1 in the middle.
    let mut rest = mesh.triangles().to_vec();
    rest.retain(|t| t.iter().any(|&v| mesh.vertices()[v as usize].z < 0.9));
    let open = Surface::new(with_triangles(mesh, rest));
    assert!(!open.is_closed());
    assert!((0.3..0.7).contains(&open.winding_number(0.9 * DVec3::Z)));
    assert!(open.contains(DVec3::ZERO) && !open.contains(1.3 * DVec3::Z));
    assert!(open.signed_distance(DVec3::ZERO) < 0.0 && open.signed_distance(2.0 * DVec3::X) > 0.0);
}

#[test]
fn a_rigid_motion_changes_no_distance() {
    let mesh = cuboid(DVec3::new(0.03, 0.02, 0.01));
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -1.0, 2.0));
    let pose = Pose::new(turn, DVec3::new(0.5, 2.0, -1.0));
    let (still, moved) = (Surface::new(mesh.clone()), Surface::new(mesh.moved(&pose)));
    let mut rng = rng("motion", 0);
    for _ in 0..500 {
        let point = 0.05 * direction(&mut rng) * rng.gen_range(0.0..1.0);
        let a = still.signed_distance(point);
        let b = moved.signed_distance(pose.transform_point(point));
        assert!((a - b).abs() < 1e-14, "{a} {b}");
    }
}

#[test]
fn corners_stored_once_a_face_close_a_mesh_all_the_same() {
    let shared = cuboid(DVec3::ONE);
    let triangles = (0..shared.n_triangles() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    let split = TriangleMesh::new("split", corners(&shared), triangles.collect()).unwrap();
    let surface = Surface::new(split);
    assert!(surface.is_closed());
    assert_eq!(surface.signed_distance(DVec3::splat(1.5)), 0.75_f64.sqrt());
}

#[test]
fn meshes_that_are_none_are_refused() {
    let corners = || vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let error = |v, t| TriangleMesh::new("m.ply", v, t).unwrap_err().to_string();
    let none = "m.ply: no vertices; at least one vertex";
    assert_eq!(error(vec![], vec![]), none);
    let none = "m.ply: no triangles; at least one triangle";
    assert_eq!(error(corners(), vec![]), none);
    let outside = "m.ply: face 2: vertex indices [0, 1, 3]; 0 to 2, the indices of the vertices";
    assert_eq!(error(corners(), vec![[0, 1, 2], [0, 1, 3]]), outside);
    let mut broken = corners();
    broken[1].y = f64::NAN;
    assert!(error(broken, vec![[0, 1, 2]]).starts_with("m.ply: vertex 2: [1, NaN, 0]"));
}
