//! Laws of taxels draped over meshes.

use bubbletouch::mesh::{Surface, TriangleMesh};
use bubbletouch::random::Seed;
use bubbletouch::world::Layout;
use glam::DVec3;
use rand::Rng;

use crate::mesh_shapes::{cuboid, icosphere};

const PITCH: f64 = 4e-3;

/// A ball, a box, a thin plate, a ball as coarse as an icosahedron, and a ball in fine facets.
fn meshes() -> [(&'static str, TriangleMesh); 5] {
    [
        ("ball", icosphere(0.03, 4)),
        ("box", cuboid(DVec3::new(0.04, 0.03, 0.02))),
        ("plate", cuboid(DVec3::new(0.04, 0.03, 0.0005))),
        ("coarse ball", icosphere(0.03, 0)),
        ("fine ball", icosphere(0.02, 6)),
    ]
}

fn draped(mesh: &TriangleMesh) -> Layout {
    Layout::draped(mesh, PITCH, &Seed::new(3)).unwrap()
}

/// Random points of the surface, evenly, with the normals of their triangles.
fn points_on(mesh: &TriangleMesh, n: usize) -> Vec<(DVec3, DVec3)> {
    let mut rng = Seed::new(9).rng();
    let mut ends = Vec::new();
    let mut area = 0.0;
    for t in 0..mesh.n_triangles() {
        area += mesh.triangle(t).area();
        ends.push(area);
    }
    let mut point = || {
        let along = rng.gen_range(0.0..area);
        let triangle = mesh.triangle(ends.partition_point(|&end| end < along));
        let (mut u, mut v) = (rng.r#gen::<f64>(), rng.r#gen::<f64>());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = triangle.0;
        (a + u * (b - a) + v * (c - a), triangle.normal().unwrap())
    };
    (0..n).map(|_| point()).collect()
}

#[test]
fn draped_taxels_lie_on_the_surface_and_are_apart() {
    for (name, mesh) in meshes() {
        let layout = draped(&mesh);
        let surface = Surface::new(mesh);
        for (i, &center) in layout.centers().iter().enumerate() {
            assert!(
                surface.closest(center, 1e-12).is_some(),
                "{name}: on the surface"
            );
            for (j, other) in layout.centers().iter().enumerate().take(i) {
                let is_back = layout.axes()[i].dot(layout.axes()[j]) < -0.3;
                let distance = center.distance(*other);
                assert!(is_back || distance >= 0.83 * PITCH, "{name}: {distance}");
            }
        }
    }
}

#[test]
fn every_place_of_the_surface_has_a_taxel_of_its_side_within_a_pitch() {
    for (name, mesh) in meshes() {
        let layout = draped(&mesh);
        for (point, normal) in points_on(&mesh, 20_000) {
            let taxels = layout.centers().iter().zip(layout.axes());
            let same_side = taxels.filter(|(_, axis)| axis.dot(normal) > -0.3);
            let nearest = same_side.map(|(center, _)| center.distance(point));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest <= PITCH, "{name}: {nearest}");
        }
    }
}

#[test]
fn there_are_about_as_many_taxels_as_on_a_grid_of_the_pitch() {
    for (name, mesh) in meshes() {
        let share = draped(&mesh).n_taxels() as f64 * PITCH * PITCH / mesh.area();
        assert!((0.85..1.2).contains(&share), "{name}: {share}");
    }
}

#[test]
fn axes_point_out_of_balls_and_along_the_normals_of_plates() {
    for (name, mesh) in meshes() {
        let layout = draped(&mesh);
        for (center, axis) in layout.centers().iter().zip(layout.axes()) {
            assert!((axis.length() - 1.0).abs() < 1e-12);
            let out = center.normalize();
            match name {
                "fine ball" => assert!(axis.dot(out) > 0.9999, "{name}: {}", axis.dot(out)),
                "ball" => assert!(axis.dot(out) > 0.99, "{name}: {}", axis.dot(out)),
                "plate" if center.x.abs() < 0.037 && center.y.abs() < 0.027 => {
                    assert!((axis.z * center.z.signum() - 1.0).abs() < 1e-12, "{axis}");
                }
                _ => assert!(axis.dot(out) > 0.0 || name == "plate", "{name}"),
            }
        }
    }
}

#[test]
fn the_same_seed_drapes_the_same_taxels_and_another_one_others() {
    let mesh = cuboid(DVec3::new(0.04, 0.03, 0.02));
    assert_eq!(draped(&mesh), draped(&mesh));
    let other = Layout::draped(&mesh, PITCH, &Seed::new(4)).unwrap();
    assert_ne!(draped(&mesh), other);
}

#[test]
fn what_cannot_be_draped_is_refused() {
    let mesh = cuboid(DVec3::ONE);
    let message = |mesh: &TriangleMesh, pitch| {
        let layout = Layout::draped(mesh, pitch, &Seed::new(1));
        layout.unwrap_err().to_string()
    };
    assert_eq!(
        message(&mesh, -1.0),
        "taxel pitch: -1 m; a finite positive number"
    );
    assert_eq!(
        message(&mesh, 1e-3),
        "draped layout: pitch 0.001 m on 24 m²; a pitch that some 100,000 taxels cover the surface with"
    );
    let line = TriangleMesh::new("line", vec![DVec3::ZERO, DVec3::X], vec![[0, 1, 1]]).unwrap();
    assert_eq!(
        message(&line, 1e-3),
        "draped layout: a mesh without area; at least one triangle with a normal"
    );
}
