//! Orientation of meshes: closed parts are turned outwards, cavities stay, and rays decide about open parts.

use crate::mesh_shapes::{cuboid, icosphere, inside_out, joined, partly_turned, with_triangles};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Orientation, Surface, TriangleMesh};
use bubbletouch_sim::packing::{Body, pack_mesh};
use glam::DVec3;

/// Joins several meshes, each moved by a vector.
fn placed(parts: &[(TriangleMesh, DVec3)]) -> TriangleMesh {
    let parts = parts.iter();
    let moved = parts.map(|(part, shift)| part.moved(&Pose::from_translation(*shift)));
    joined(&moved.collect::<Vec<_>>())
}

fn cube(half: f64) -> TriangleMesh {
    cuboid(DVec3::splat(half))
}

fn volume(mesh: &TriangleMesh) -> f64 {
    mesh.volume_and_centroid().0
}

/// Turns a mesh outwards; checks the number of turned triangles, and that a second call turns none.
fn turned(mesh: &TriangleMesh, expected: usize) -> TriangleMesh {
    let (outward, orientation) = mesh.clone().turned_outwards();
    match orientation {
        Orientation::Turned { n_triangles, n_all } => {
            assert_eq!((n_triangles, n_all), (expected, mesh.n_triangles()));
        }
        other => assert_eq!((other, expected), (Orientation::Outwards, 0)),
    }
    let (again, orientation) = outward.clone().turned_outwards();
    assert_eq!((&again, orientation), (&outward, Orientation::Outwards));
    outward
}

#[test]
fn a_closed_mesh_faces_outwards_whichever_of_its_triangles_were_turned() {
    let whole = cube(1.0);
    assert_eq!(turned(&whole, 0), whole);
    assert_eq!(turned(&inside_out(&whole), 12), whole);
    let mirrored = whole.vertices().iter().map(|v| DVec3::new(-v.x, v.y, v.z));
    let mirrored = TriangleMesh::new("m", mirrored.collect(), whole.triangles().to_vec()).unwrap();
    assert_eq!(volume(&mirrored), -8.0);
    assert_eq!(volume(&turned(&mirrored, 12)), 8.0);
    for flips in [1_u32, 0b1010_0110_0001, 0b1111_1111_1110] {
        let flipped = partly_turned(&whole, |k| flips >> k & 1 == 1);
        let outward = turned(&flipped, flips.count_ones() as usize);
        assert_eq!(outward, whole, "{flips:b}");
    }
}

#[test]
fn cavities_stay_and_parts_are_turned_one_by_one() {
    let at = |x: f64| DVec3::new(x, 0.0, 0.0);
    let housing = |flip: bool| {
        let parts = placed(&[(cube(1.0), at(0.0)), (inside_out(&cube(0.5)), at(0.1))]);
        if flip { inside_out(&parts) } else { parts }
    };
    assert!((volume(&turned(&housing(false), 0)) - 7.0).abs() < 1e-12);
    assert!((volume(&turned(&housing(true), 24)) - 7.0).abs() < 1e-12);
    // The order of the parts has no effect.
    let first_inner = placed(&[(cube(0.5), at(0.1)), (inside_out(&cube(1.0)), at(0.0))]);
    assert!((volume(&turned(&first_inner, 24)) - 7.0).abs() < 1e-12);
    let beside = placed(&[
        (housing(false), at(0.0)),
        (housing(true), at(5.0)),
        (cube(0.1), at(10.0)),
    ]);
    let outward = turned(&beside, 24);
    assert!((volume(&outward) - 14.008).abs() < 1e-12);
    // A solid in a cavity, and a hollow solid in a cavity.
    let nested = |inner: TriangleMesh| placed(&[(housing(false), at(0.0)), (inner, at(0.1))]);
    assert!((volume(&turned(&nested(cube(0.1)), 0)) - 7.008).abs() < 1e-12);
    assert!((volume(&turned(&nested(inside_out(&cube(0.1))), 12)) - 7.008).abs() < 1e-12);
    // Two parts that overlap and both face inwards.
    let crossing = placed(&[(cube(1.0), at(0.0)), (cube(1.0), at(0.5))]);
    assert_eq!(turned(&inside_out(&crossing), 24), crossing);
}

/// A ball of 320 triangles without its top, some of whose triangles are turned.
fn open_ball(is_turned: impl Fn(usize) -> bool) -> TriangleMesh {
    let ball = icosphere(1.0, 2);
    let is_low = |t: &&[u32; 3]| t.iter().all(|&v| ball.vertices()[v as usize].z < 0.8);
    let kept = ball.triangles().iter().filter(is_low).copied().collect();
    partly_turned(&with_triangles(&ball, kept), is_turned)
}

#[test]
fn open_meshes_are_judged_by_rays_and_never_turned() {
    let without_top = |mesh: &TriangleMesh| {
        let low = |t: &&[u32; 3]| t.iter().any(|&v| mesh.vertices()[v as usize].z < 0.0);
        with_triangles(mesh, mesh.triangles().iter().filter(low).copied().collect())
    };
    let open = without_top(&cube(1.0));
    let (same, orientation) = open.clone().turned_outwards();
    assert_eq!((&same, &orientation), (&open, &Orientation::Outwards));
    orientation.require("open.obj").unwrap();
    let inwards = without_top(&inside_out(&cube(1.0)));
    let (same, orientation) = inwards.clone().turned_outwards();
    assert_eq!(same, inwards);
    let error = orientation.require("open.obj").unwrap_err().to_string();
    assert!(
        error.starts_with("open.obj: an open mesh whose faces face inwards; "),
        "{error}"
    );
    // A mesh of ten triangles, two of them turned.
    let (_, mixed) = partly_turned(&open, |k| k % 5 == 0).turned_outwards();
    let error = mixed.require("mixed.obj").unwrap_err().to_string();
    assert!(error.contains("disagree"), "{error}");
    // Up to a twentieth of the area may be turned, as in a scan with faults.
    for (every, is_accepted) in [(100, true), (30, true), (10, false)] {
        let (_, orientation) = open_ball(|k| k % every == 0).turned_outwards();
        let is_outwards = orientation == Orientation::Outwards;
        assert_eq!(is_outwards, is_accepted, "one of {every}");
    }
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    let flat = TriangleMesh::new("flat", corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let (_, orientation) = flat.turned_outwards();
    assert_eq!(orientation, Orientation::Outwards, "a sheet has two sides");
}

#[test]
fn what_was_turned_can_be_packed() {
    let spheres = |mesh: TriangleMesh| pack_mesh(&Surface::new(mesh), Body::Solid, 0.2).unwrap();
    let whole = cube(1.0);
    assert!(pack_mesh(&Surface::new(inside_out(&whole)), Body::Solid, 0.2).is_err());
    let outward = inside_out(&whole).turned_outwards().0;
    assert_eq!(spheres(outward), spheres(whole));
}
