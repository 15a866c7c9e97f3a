//! Laws of primitive shapes as meshes: closed, outwards, corners on the shape, and facets within the tolerance.

use crate::scenes::{direction, rng};
use bubbletouch_sim::mesh::{Surface, TriangleMesh, Welded};
use glam::{DVec2, DVec3};
use rand::Rng;
use std::f64::consts::PI;

/// Returns a random point on the round surface of a shape.
type OnSurface = fn(&mut dyn FnMut() -> f64, DVec3) -> DVec3;

/// Returns the name, the mesh, the volume and the round surface of each shape with the given sizes: radius and length, or radii.
fn shapes(sizes: DVec3, tolerance: f64) -> [(&'static str, TriangleMesh, f64, OnSurface); 3] {
    let DVec3 { x, y, z } = sizes;
    let cylinder = TriangleMesh::cylinder("cylinder", x, y, tolerance).unwrap();
    let ellipsoid = TriangleMesh::ellipsoid("ellipsoid", sizes, tolerance).unwrap();
    let capsule = TriangleMesh::capsule("capsule", x, y, tolerance).unwrap();
    let on_cylinder: OnSurface = |random, sizes| {
        let around = sizes.x * DVec2::from_angle(PI * random());
        around.extend(0.5 * sizes.y * random())
    };
    let on_ellipsoid: OnSurface = |random, sizes| sizes * unit(random);
    let on_capsule: OnSurface = |random, sizes| {
        let out = sizes.x * unit(random);
        out + 0.5 * sizes.y * out.z.signum() * DVec3::Z
    };
    let [ball, disc] = [4.0 / 3.0 * PI, PI * x * x];
    [
        ("cylinder", cylinder, disc * y, on_cylinder),
        ("ellipsoid", ellipsoid, ball * x * y * z, on_ellipsoid),
        ("capsule", capsule, disc * (y + 4.0 / 3.0 * x), on_capsule),
    ]
}

fn unit(random: &mut dyn FnMut() -> f64) -> DVec3 {
    DVec3::new(random(), random(), random()).normalize_or(DVec3::X)
}

#[test]
fn facets_of_round_shapes_are_within_the_tolerance() {
    for case in 0..12 {
        let mut rng = rng("primitives", case);
        let sizes = DVec3::from_array([0; 3].map(|_| rng.gen_range(5e-3..5e-2)));
        let tolerance = 10f64.powf(rng.gen_range(-5.0..-3.0));
        for (name, mesh, volume, on_surface) in shapes(sizes, tolerance) {
            assert!(Welded::new(&mesh).is_closed(), "{name}");
            let enclosed = mesh.volume_and_centroid().0;
            let within = 1.0 - 4.0 * tolerance / sizes.min_element();
            let is_inside = enclosed < volume && enclosed > within * volume;
            assert!(is_inside, "{name}: {enclosed} {volume}");
            let surface = Surface::new(mesh);
            let mut largest = 0.0_f64;
            for _ in 0..300 {
                let point = on_surface(&mut || rng.gen_range(-1.0..1.0), sizes);
                // Positive outside: the facets are inside the shape.
                let distance = surface.signed_distance(point);
                assert!(distance > -1e-12, "{name}: {distance}");
                largest = largest.max(distance);
            }
            // The mesh is not needlessly fine.
            let share = largest / tolerance;
            assert!(share > 0.1 && share <= 1.0 + 1e-9, "{name}: {share}");
        }
    }
}

#[test]
fn a_mirrored_mesh_is_the_mirror_image_and_faces_outwards() {
    let mut rng = rng("mirrored", 0);
    let mesh = TriangleMesh::cuboid("box", DVec3::new(0.02, 0.03, 0.05)).unwrap();
    let shift = bubbletouch_sim::geometry::Pose::from_translation(DVec3::new(0.1, 0.2, 0.3));
    let mesh = mesh.moved(&shift);
    let (volume, _) = mesh.volume_and_centroid();
    let surface = Surface::new(mesh.clone());
    for axis in 0..3 {
        let mirrored = mesh.mirrored(axis);
        assert!((mirrored.volume_and_centroid().0 - volume).abs() < 1e-15);
        let mirrored = Surface::new(mirrored);
        for _ in 0..50 {
            let point = DVec3::new(0.1, 0.2, 0.3) + 0.05 * direction(&mut rng);
            let mut image = point;
            image[axis] = -image[axis];
            let difference = surface.signed_distance(point) - mirrored.signed_distance(image);
            assert!(difference.abs() < 1e-15);
        }
    }
    let scaled = mesh.scaled("box", DVec3::new(-2.0, -1.0, -0.5)).unwrap();
    assert!((scaled.volume_and_centroid().0 - volume).abs() < 1e-15);
    let error = mesh.scaled("box", DVec3::splat(f64::INFINITY)).unwrap_err();
    assert!(error.to_string().starts_with("box: vertex 1"), "{error}");
}

#[test]
fn sizes_of_no_shape_are_refused() {
    let allowed = "m; a finite positive number";
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let radii = DVec3::new(1.0, bad, 1.0);
        for (mesh, place) in [
            (TriangleMesh::cylinder("c", bad, 1.0, 1e-3), "c: radius"),
            (TriangleMesh::cylinder("c", 1.0, bad, 1e-3), "c: length"),
            (TriangleMesh::capsule("c", bad, 1.0, 1e-3), "c: radius"),
            (TriangleMesh::ellipsoid("c", radii, 1e-3), "c: radius"),
        ] {
            let error = mesh.unwrap_err().to_string();
            assert!(error.starts_with(place) && error.contains(allowed));
        }
    }
    for tolerance in [0.0, -1.0, 1e-9, f64::NAN] {
        let error = TriangleMesh::cylinder("c", 1.0, 1.0, tolerance).unwrap_err();
        assert!(error.to_string().starts_with("c: tolerance"), "{error}");
    }
    assert!(TriangleMesh::capsule("c", 1.0, 0.0, 1e-3).is_ok());
    assert!(TriangleMesh::capsule("c", 1.0, -1e-9, 1e-3).is_err());
}
