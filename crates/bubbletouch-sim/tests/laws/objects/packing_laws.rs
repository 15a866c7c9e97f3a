//! Laws of sphere packing: the stated tolerance holds on shapes of every kind, measured at points that the test chooses.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{MeshReport, Surface, TriangleMesh};
use bubbletouch_sim::packing::{Body, Packing, PackingError, pack_mesh, packing_error};
use glam::{DQuat, DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

use crate::mesh_shapes::{cuboid, icosphere, inside_out, joined, with_triangles};
use crate::overlapping::{Judge, turned};
use crate::scans::scan;

const MM: f64 = 1e-3;

fn tube() -> TriangleMesh {
    turned(&[(7.0, -5.0), (10.0, -5.0), (10.0, 5.0), (7.0, 5.0)], 32)
}

fn torus() -> TriangleMesh {
    let corner = |k: usize| DVec2::new(12.0, 0.0) + 4.0 * DVec2::from_angle(TAU * k as f64 / 16.0);
    let outline: Vec<(f64, f64)> = (0..16).map(|k| corner(k).into()).collect();
    turned(&outline, 40)
}

/// Packs a mesh, checks protrusion and gap, and returns the number of spheres.
fn assert_packs(mesh: TriangleMesh, body: Body, tolerance: f64, what: &str) -> usize {
    let surface = Surface::new(mesh);
    let packing = pack_mesh(&surface, body, tolerance).unwrap();
    let error = packing_error(&surface, body, &packing.spheres, 20_000);
    assert!(
        error.gap.max <= tolerance && error.protrusion.max <= 0.5 * tolerance,
        "{what} at {tolerance} m: {error:?}"
    );
    for sphere in packing.spheres.spheres() {
        let outermost = match body {
            Body::Solid => surface.signed_distance(sphere.center) + sphere.radius,
            Body::Sheet => sphere.radius,
        };
        assert!(
            outermost <= 0.5 * tolerance,
            "{what}: {sphere:?} is {outermost} m out"
        );
    }
    packing.spheres.n_spheres()
}

#[test]
fn a_ball_packs_to_one_sphere() {
    let n = assert_packs(icosphere(10.0 * MM, 2), Body::Solid, 0.5 * MM, "ball");
    assert_eq!(n, 1);
}

#[test]
fn spheres_are_within_the_tolerance_of_every_shape_inside_and_outside() {
    let mm = |x, y, z| MM * 0.5 * DVec3::new(x, y, z);
    let shapes = [
        ("box", cuboid(mm(15.0, 10.0, 8.0))),
        ("plate", cuboid(mm(10.0, 8.0, 0.3))),
        ("needle", cuboid(mm(20.0, 0.2, 0.1))),
        ("tube", tube()),
        ("torus", torus()),
    ];
    for (what, mesh) in shapes {
        assert_packs(mesh, Body::Solid, 0.7 * MM, what);
    }
}

#[test]
fn a_tolerance_larger_than_the_object_takes_one_sphere() {
    let tiny = cuboid(DVec3::splat(0.1 * MM));
    assert_eq!(assert_packs(tiny, Body::Solid, 1.0 * MM, "tiny box"), 1);
}

#[test]
fn a_box_takes_more_than_its_edges_need_and_less_than_two_and_a_half_times_that() {
    let (e, size) = (0.5 * MM, MM * DVec3::new(15.0, 12.0, 10.0));
    let n = assert_packs(cuboid(0.5 * size), Body::Solid, e, "box");
    let edges = 4.0 * (size.x + size.y + size.z);
    let bound = edges / (32f64.sqrt() * e);
    assert!(
        (n as f64) > bound && (n as f64) < 2.5 * bound,
        "{n} spheres, {bound} for the edges"
    );
}

/// Packs a surface within each of the tolerances, metres, in parallel.
fn packings(surface: &Surface, tolerances: &[f64]) -> Vec<Packing> {
    let packing = |&tolerance: &f64| pack_mesh(surface, Body::Solid, tolerance).unwrap();
    tolerances.par_iter().map(packing).collect()
}

#[test]
fn a_smaller_tolerance_never_gives_a_larger_error() {
    let surface = Surface::new(torus());
    let errors: Vec<_> = packings(&surface, &[1.4 * MM, 0.9 * MM, 0.6 * MM])
        .iter()
        .map(|packing| packing_error(&surface, Body::Solid, &packing.spheres, 20_000))
        .collect();
    for pair in errors.windows(2) {
        let numbers = |k: usize| {
            let error: &PackingError = &pair[k];
            [error.gap.max, error.protrusion.max, error.gap.mean]
        };
        let (coarse, fine) = (numbers(0), numbers(1));
        assert!((0..3).all(|k| fine[k] <= coarse[k]), "{errors:?}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let surface = Surface::new(tube());
    let packed = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let pool = pool.build().unwrap();
        pool.install(|| packings(&surface, &[1.4 * MM, 1.0 * MM]))
    };
    assert_eq!(packed(1), packed(7));
}

#[test]
fn a_rigid_motion_changes_the_number_of_spheres_little() {
    let motion = Pose::new(
        DQuat::from_scaled_axis(DVec3::new(0.3, 1.1, -0.7)),
        DVec3::splat(0.2),
    );
    let here = assert_packs(tube(), Body::Solid, 0.8 * MM, "tube");
    let there = assert_packs(tube().moved(&motion), Body::Solid, 0.8 * MM, "moved tube");
    assert!(here.abs_diff(there) * 10 <= here, "{here} and {there}");
}

#[test]
fn faces_inside_other_parts_take_no_spheres() {
    let large = cuboid(DVec3::splat(5.0 * MM));
    let inside = cuboid(DVec3::splat(3.0 * MM));
    let alone = assert_packs(large.clone(), Body::Solid, MM, "box");
    let both = joined(&[large.clone(), inside]);
    let surface = Surface::new(both);
    let of_large = pack_mesh(&Surface::new(large), Body::Solid, MM).unwrap();
    let error = packing_error(&surface, Body::Solid, &of_large.spheres, 10_000);
    assert!((error.buried_share - 9.0 / 34.0).abs() < 1e-3, "{error:?}");
    let packing = pack_mesh(&surface, Body::Solid, MM).unwrap();
    // The inner box still limits the size of balls.
    assert!(packing.spheres.n_spheres() < 2 * alone);
    let mut spheres = packing.spheres.spheres().iter();
    assert!(spheres.all(|s| s.center.abs().max_element() < 5.0 * MM));
}

#[test]
fn a_mesh_with_a_hole_is_packed_only_as_a_sheet() {
    let closed = cuboid(DVec3::splat(4.0 * MM));
    let open = with_triangles(&closed, closed.triangles()[2..].to_vec());
    let surface = Surface::new(open.clone());
    let error = pack_mesh(&surface, Body::Solid, 0.5 * MM).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("a hole 11.31 mm wide"));
    assert_packs(open, Body::Sheet, 0.5 * MM, "open box");
}

#[test]
fn what_cannot_be_packed_is_an_error() {
    let surface = Surface::new(cuboid(DVec3::splat(4.0 * MM)));
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = pack_mesh(&surface, Body::Solid, tolerance).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{tolerance}");
    }
    let inside_out = Surface::new(inside_out(surface.mesh()));
    let error = pack_mesh(&inside_out, Body::Solid, MM).unwrap_err();
    assert!(error.to_string().contains("volume"), "{error}");
}

/// Packs a mesh and checks it with code that is independent of the packing.
fn judge(what: &str, mesh: TriangleMesh, tolerance: f64, n_points: usize) -> (usize, String) {
    let surface = Surface::new(mesh);
    let packing = pack_mesh(&surface, Body::Solid, tolerance).unwrap();
    let found = Judge::new(surface.mesh()).look(&packing.spheres, n_points);
    let n = packing.spheres.n_spheres();
    assert!(
        found.gap <= tolerance && found.protrusion <= 0.5 * tolerance && found.n_outer > 0,
        "{what}: {n} spheres within {tolerance} m, {found:?}"
    );
    (n, format!("{found:?}"))
}

#[test]
fn parts_that_overlap_pack_within_the_tolerance_of_their_union() {
    let few = [
        "plate with posts",
        "lid on its box, face on face",
        "rod through the wall of a hollow box",
        "heap of boxes",
    ];
    let objects = crate::overlapping::objects().into_par_iter();
    let chosen = objects.filter(|(what, _)| few.contains(what));
    let n = chosen.map(|(what, mesh)| judge(what, mesh, 1.2 * MM, 1500));
    assert_eq!(n.count(), few.len());
}

/// This test takes minutes. Run it with `cargo test --release -p bubbletouch-sim packing_laws -- --ignored`.
#[test]
#[ignore = "packs all objects that overlap themselves, twice"]
fn all_parts_that_overlap_pack_within_the_tolerance_of_their_union() {
    let objects = crate::overlapping::objects().into_par_iter();
    objects.for_each(|(what, mesh)| {
        for tolerance in [0.5 * MM, 0.3 * MM] {
            judge(what, mesh.clone(), tolerance, 10_000);
        }
    });
}

#[test]
fn small_holes_are_closed_on_request_and_wide_ones_stay() {
    let whole = icosphere(10.0 * MM, 2);
    let without = |gone: &[usize]| {
        let kept = whole.triangles().iter().enumerate();
        let kept = kept.filter(|(t, _)| !gone.contains(t)).map(|(_, t)| *t);
        with_triangles(&whole, kept.collect())
    };
    let edge = whole.triangle(100).longest_edge_squared().sqrt();
    let open = without(&[100]);
    let closed = open.with_holes_closed(1.01 * edge).unwrap();
    assert_eq!(closed.widths.len(), 1);
    assert!((closed.widths[0] - edge).abs() < 1e-12);
    let large = open.scaled("ball", DVec3::splat(1e4)).unwrap();
    let closed_large = large.with_holes_closed(1.01e4 * edge).unwrap();
    assert_eq!(closed_large.widths.len(), 1);
    assert!(MeshReport::new(&closed.mesh).is_solid());
    let [volume, before] = [&closed.mesh, &whole].map(|mesh| mesh.volume_and_centroid().0);
    assert!((volume - before).abs() < 1e-12 * before);
    judge("ball with a closed hole", closed.mesh, 2.0 * MM, 1000);
    let wide = open.with_holes_closed(0.99 * edge).unwrap();
    assert_eq!((wide.widths.len(), &wide.mesh), (0, &open));
    // A mesh with two holes; the border of one of them passes a corner twice.
    let far = without(&[0, 200]).with_holes_closed(MM * 6.0).unwrap();
    assert_eq!(far.widths.len(), 2);
    assert!(MeshReport::new(&far.mesh).is_solid());
    let corner = whole.triangles()[100][0];
    let around: Vec<usize> = (0..whole.n_triangles())
        .filter(|&t| whole.triangles()[t].contains(&corner))
        .collect();
    let apart = around.iter().copied().find(|&t| {
        let shared = |c: &&u32| whole.triangles()[around[0]].contains(c);
        whole.triangles()[t].iter().filter(shared).count() == 1
    });
    let twice = without(&[around[0], apart.unwrap()]);
    let closed = twice.with_holes_closed(MM * 15.0).unwrap();
    assert_eq!(closed.widths.len(), 1);
    assert!(MeshReport::new(&closed.mesh).is_watertight());
    judge(
        "ball with a closed double hole",
        closed.mesh,
        2.0 * MM,
        1000,
    );
    for width in [-1.0, f64::NAN] {
        assert_eq!(whole.with_holes_closed(width).unwrap_err().exit_code(), 2);
    }
}

#[test]
fn scanned_objects_pack_within_half_a_millimetre() {
    let Some(folder) = crate::reference_data::folder("BUBBLETOUCH_YCB") else {
        return;
    };
    for (name, most) in [("014_lemon", 60), ("062_dice", 200)] {
        let mesh = scan(&folder.join(format!("{name}.ply")));
        let n = assert_packs(mesh, Body::Solid, 0.5 * MM, name);
        assert!(n < most, "{name}: {n} spheres");
    }
}

/// This test takes many minutes. Run it with `cargo test --release -p bubbletouch-sim packing_laws -- --ignored`.
#[test]
#[ignore = "packs all scans of the YCB set"]
fn all_scanned_objects_pack_within_half_a_millimetre() {
    let Some(folder) = crate::reference_data::folder("BUBBLETOUCH_YCB") else {
        return;
    };
    let files = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = files
        .filter(|path| path.extension().is_some_and(|e| e == "ply"))
        .collect();
    files.sort();
    assert!(files.len() >= 43, "{} scans", files.len());
    files.into_par_iter().for_each(|path| {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let (n, found) = judge(&name, scan(&path), 0.5 * MM, 2000);
        println!("{name}: {n} spheres, {found}");
    });
}
