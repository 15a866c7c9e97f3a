//! Laws of sphere packing: what is promised holds on shapes of every kind, measured at points of the test's own choice.

use bubbletouch::geometry::Pose;
use bubbletouch::mesh::{Surface, TriangleMesh, read_ply};
use bubbletouch::packing::{Body, DetailChain, pack_mesh, packing_error};
use bubbletouch::study::PackingCache;
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::TAU;

mod mesh_shapes;
mod reference_data;
use mesh_shapes::{cuboid, icosphere};

const MM: f64 = 1e-3;

/// A closed outline (metres; x from the axis, y along it; counter-clockwise) turned about the z axis.
fn turned(outline: &[DVec2], n_around: usize) -> TriangleMesh {
    let n = outline.len();
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for step in 0..n_around {
        let turn = DVec2::from_angle(TAU * step as f64 / n_around as f64);
        for (k, corner) in outline.iter().enumerate() {
            vertices.push((turn * corner.x).extend(corner.y));
            let corner = |step: usize, k: usize| (step % n_around * n + k % n) as u32;
            let quad = [
                corner(step, k),
                corner(step + 1, k),
                corner(step + 1, k + 1),
                corner(step, k + 1),
            ];
            triangles.push([quad[0], quad[1], quad[2]]);
            triangles.push([quad[0], quad[2], quad[3]]);
        }
    }
    TriangleMesh::new("turned", vertices, triangles).unwrap()
}

fn tube() -> TriangleMesh {
    let corners = [(7.0, -5.0), (10.0, -5.0), (10.0, 5.0), (7.0, 5.0)];
    turned(&corners.map(|(r, z)| MM * DVec2::new(r, z)), 32)
}

fn torus() -> TriangleMesh {
    let corner = |k: usize| DVec2::new(12.0, 0.0) + 4.0 * DVec2::from_angle(TAU * k as f64 / 16.0);
    turned(&(0..16).map(|k| MM * corner(k)).collect::<Vec<_>>(), 40)
}

/// All triangles of both.
fn together(a: &TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let shift = a.vertices().len() as u32;
    let vertices = [a.vertices(), b.vertices()].concat();
    let shifted = b.triangles().iter().map(|t| t.map(|corner| corner + shift));
    let triangles = a.triangles().iter().copied().chain(shifted).collect();
    TriangleMesh::new("both", vertices, triangles).unwrap()
}

/// Packs and checks both sides of the promise; how many spheres.
fn assert_packs(mesh: TriangleMesh, body: Body, tolerance: f64, what: &str) -> usize {
    let surface = Surface::new(mesh);
    let packing = pack_mesh(&surface, body, tolerance).unwrap();
    let error = packing_error(&surface, body, &packing.spheres, 20_000);
    assert_eq!(packing.n_unproved, 0, "{what}");
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
    assert_eq!(
        assert_packs(icosphere(10.0 * MM, 2), Body::Solid, 0.5 * MM, "ball"),
        1
    );
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
        for tolerance in [0.6 * MM, 0.4 * MM] {
            assert_packs(mesh.clone(), Body::Solid, tolerance, what);
        }
    }
}

#[test]
fn a_tolerance_larger_than_the_object_takes_one_sphere() {
    let tiny = cuboid(DVec3::splat(0.1 * MM));
    assert_eq!(assert_packs(tiny, Body::Solid, 1.0 * MM, "tiny box"), 1);
}

#[test]
fn a_box_takes_more_than_its_edges_need_and_less_than_two_and_a_half_times_that() {
    let (e, size) = (0.3 * MM, MM * DVec3::new(15.0, 12.0, 10.0));
    let n = assert_packs(cuboid(0.5 * size), Body::Solid, e, "box");
    let edges = 4.0 * (size.x + size.y + size.z);
    let bound = edges / (32f64.sqrt() * e);
    assert!(
        (n as f64) > bound && (n as f64) < 2.5 * bound,
        "{n} spheres, {bound} for the edges"
    );
}

#[test]
fn a_smaller_tolerance_never_gives_a_larger_error() {
    let surface = Surface::new(torus());
    let chain = DetailChain::pack(&surface, Body::Solid, &[0.3 * MM, 0.8 * MM, 0.5 * MM]).unwrap();
    let errors: Vec<_> = chain
        .packings()
        .iter()
        .map(|packing| packing_error(&surface, Body::Solid, &packing.spheres, 20_000))
        .collect();
    for pair in errors.windows(2) {
        assert!(pair[1].gap.max <= pair[0].gap.max, "{errors:?}");
        assert!(
            pair[1].protrusion.max <= pair[0].protrusion.max,
            "{errors:?}"
        );
        assert!(pair[1].gap.mean <= pair[0].gap.mean, "{errors:?}");
    }
}

#[test]
fn a_chain_gives_the_coarsest_packing_that_is_fine_enough() {
    let surface = Surface::new(cuboid(DVec3::splat(3.0 * MM)));
    let chain = DetailChain::pack(&surface, Body::Solid, &[0.5 * MM, 1.0 * MM]).unwrap();
    assert_eq!(chain.coarsest_within(1.0 * MM).unwrap().tolerance, 1.0 * MM);
    assert_eq!(chain.coarsest_within(0.9 * MM).unwrap().tolerance, 0.5 * MM);
    assert_eq!(chain.coarsest_within(0.1 * MM).unwrap_err().exit_code(), 2);
    assert_eq!(
        DetailChain::pack(&surface, Body::Solid, &[])
            .unwrap_err()
            .exit_code(),
        2
    );
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let surface = Surface::new(tube());
    let packed = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads);
        let pool = pool.build().unwrap();
        pool.install(|| DetailChain::pack(&surface, Body::Solid, &[0.8 * MM, 0.5 * MM]).unwrap())
    };
    assert_eq!(packed(1), packed(7));
}

#[test]
fn a_rigid_motion_changes_the_number_of_spheres_little() {
    let motion = Pose::new(
        DQuat::from_scaled_axis(DVec3::new(0.3, 1.1, -0.7)),
        DVec3::splat(0.2),
    );
    let here = assert_packs(tube(), Body::Solid, 0.4 * MM, "tube");
    let there = assert_packs(
        tube().moved(&motion),
        Body::Solid,
        0.4 * MM,
        "tube elsewhere",
    );
    assert!(
        here.abs_diff(there) * 10 <= here,
        "{here} and {there} spheres"
    );
}

#[test]
fn faces_inside_other_parts_take_no_spheres() {
    let large = cuboid(DVec3::splat(5.0 * MM));
    let inside = cuboid(DVec3::splat(3.0 * MM));
    let alone = assert_packs(large.clone(), Body::Solid, 0.5 * MM, "box");
    let both = together(&large, &inside);
    let error = packing_error(
        &Surface::new(both.clone()),
        Body::Solid,
        &pack_mesh(&Surface::new(large), Body::Solid, 0.5 * MM)
            .unwrap()
            .spheres,
        10_000,
    );
    assert!((error.buried_share - 9.0 / 34.0).abs() < 1e-3, "{error:?}");
    let surface = Surface::new(both);
    let packing = pack_mesh(&surface, Body::Solid, 0.5 * MM).unwrap();
    // The inner box still bounds how large balls are.
    assert!(packing.spheres.n_spheres() < 2 * alone);
    assert!(
        packing
            .spheres
            .spheres()
            .iter()
            .all(|s| s.center.abs().max_element() < 5.0 * MM)
    );
}

#[test]
fn a_mesh_with_a_hole_is_packed_only_as_a_sheet() {
    let closed = cuboid(DVec3::splat(4.0 * MM));
    let open = closed.triangles()[2..].to_vec();
    let open = TriangleMesh::new("open", closed.vertices().to_vec(), open).unwrap();
    let surface = Surface::new(open.clone());
    let error = pack_mesh(&surface, Body::Solid, 0.5 * MM).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("4 edges at holes"), "{error}");
    assert_packs(open, Body::Sheet, 0.5 * MM, "open box");
}

#[test]
fn what_cannot_be_packed_is_an_error() {
    let surface = Surface::new(cuboid(DVec3::splat(4.0 * MM)));
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = pack_mesh(&surface, Body::Solid, tolerance).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{tolerance}");
    }
    let turned: Vec<_> = surface
        .mesh()
        .triangles()
        .iter()
        .map(|&[a, b, c]| [a, c, b])
        .collect();
    let vertices = surface.mesh().vertices().to_vec();
    let inside_out = Surface::new(TriangleMesh::new("turned", vertices, turned).unwrap());
    let error = pack_mesh(&inside_out, Body::Solid, MM).unwrap_err();
    assert!(error.to_string().contains("volume"), "{error}");
}

#[test]
fn the_cache_gives_back_what_was_packed_and_knows_what_from() {
    let folder = tempfile::tempdir().unwrap();
    let cache = PackingCache::new(folder.path());
    let surface = Surface::new(cuboid(DVec3::new(4.0, 3.0, 2.0) * MM));
    let mut n_calls = 0;
    let mut pack = |tolerance| {
        let watch = &mut |_| n_calls += 1;
        cache
            .pack_mesh(&surface, Body::Solid, tolerance, watch)
            .unwrap()
            .packing
    };
    let first = pack(0.3 * MM);
    let again = pack(0.3 * MM);
    let finer = pack(0.2 * MM);
    assert_eq!(first, again);
    assert_ne!(first.spheres, finer.spheres);
    assert!(n_calls > 0);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    let kept = cache.path(surface.mesh(), Body::Solid, 0.3 * MM);
    let other = cuboid(DVec3::new(4.0, 3.0, 2.1) * MM);
    assert_ne!(kept, cache.path(&other, Body::Solid, 0.3 * MM));
    assert_ne!(kept, cache.path(surface.mesh(), Body::Sheet, 0.3 * MM));
    std::fs::write(&kept, "x,y,z,r\n1,2").unwrap();
    let error = cache
        .pack_mesh(&surface, Body::Solid, 0.3 * MM, &mut |_| {})
        .unwrap_err();
    assert!(error.to_string().contains(".csv"), "{error}");
}

#[test]
fn scanned_objects_pack_within_half_a_millimetre() {
    let Some(folder) = reference_data::folder("BUBBLETOUCH_YCB") else {
        return;
    };
    for (name, most) in [("014_lemon", 60), ("062_dice", 200)] {
        let path = std::path::Path::new(&folder).join(format!("{name}.ply"));
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mesh = read_ply(name, file).unwrap().into_mesh(name).unwrap();
        let n = assert_packs(mesh, Body::Solid, 0.5 * MM, name);
        assert!(n < most, "{name}: {n} spheres");
    }
}
