//! Laws of taxels draped over meshes.

use bubbletouch_sim::geometry::Aabb;
use bubbletouch_sim::mesh::{Surface, TriangleMesh};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::world::{DrapeRegion, Layout};
use glam::DVec3;
use rand::Rng;

use crate::mesh_shapes::{cuboid, icosphere, inside_out, joined};

const PITCH: f64 = 4e-3;

/// Returns test meshes: a ball, a box, a thin plate, a ball as coarse as an icosahedron, and a finely triangulated ball.
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

/// Returns random points, uniformly distributed on the surface, with the normals of their triangles.
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

/// Returns a mesh without some of its triangles.
fn without(mesh: &TriangleMesh, triangles: std::ops::Range<usize>) -> TriangleMesh {
    let kept = mesh.triangles().iter().enumerate();
    let kept = kept.filter(|(number, _)| !triangles.contains(number));
    let kept = kept.map(|(_, triangle)| *triangle).collect();
    TriangleMesh::new("open", mesh.vertices().to_vec(), kept).unwrap()
}

/// Returns meshes with inner faces: a housing with a cavity, a housing with loose parts inside, two plates that face each other, and an open housing.
fn hollow_meshes() -> [(&'static str, TriangleMesh); 4] {
    let at = |mesh: TriangleMesh, x: f64| {
        let shift = bubbletouch_sim::geometry::Pose::from_translation(DVec3::new(x, 0.0, 0.0));
        mesh.moved(&shift)
    };
    let outer = cuboid(DVec3::splat(0.021));
    let cavity = inside_out(&cuboid(DVec3::splat(0.0168)));
    let lid = 10..12;
    let open = [&outer, &cavity].map(|mesh| without(mesh, lid.clone()));
    let open_housing = joined(&open);
    let plate = || cuboid(DVec3::new(1e-3, 0.02, 0.02));
    let loose = [
        at(icosphere(5e-3, 2), -8e-3),
        at(cuboid(DVec3::splat(4e-3)), 8e-3),
    ];
    [
        ("housing", joined(&[outer.clone(), cavity.clone()])),
        (
            "loose parts",
            joined(&[vec![outer.clone(), cavity], loose.into()].concat()),
        ),
        ("plates", joined(&[at(plate(), -5e-3), at(plate(), 5e-3)])),
        ("open housing", open_housing),
    ]
}

/// Returns whether a ray from a point meets a triangle farther away than a micrometre.
fn meets(mesh: &TriangleMesh, place: DVec3, direction: DVec3) -> bool {
    let triangles = (0..mesh.n_triangles()).map(|number| mesh.triangle(number));
    let mut along = triangles.filter_map(|triangle| triangle.crossed_at(place, direction));
    along.any(|along| along > 1e-6)
}

#[test]
fn the_axis_of_every_draped_taxel_leaves_the_mesh_freely() {
    for (name, mesh) in meshes().into_iter().chain(hollow_meshes()) {
        let layout = draped(&mesh);
        for (&center, &axis) in layout.centers().iter().zip(layout.axes()) {
            assert!(!meets(&mesh, center, axis), "{name}: {center} {axis}");
        }
        let has_inner_faces = !meshes().iter().any(|(other, _)| *other == name);
        assert_eq!(layout.n_left_out() > 0, has_inner_faces, "{name}");
    }
}

#[test]
fn inner_faces_carry_no_taxel_and_are_counted_and_the_outer_surface_stays_covered() {
    for (name, mesh) in hollow_meshes() {
        let layout = draped(&mesh);
        let (mut n_outer, mut n_inner) = (0, 0);
        for (point, normal) in points_on(&mesh, 4_000) {
            if meets(&mesh, point, normal) {
                n_inner += 1;
                continue;
            }
            n_outer += 1;
            let taxels = layout.centers().iter().zip(layout.axes());
            let same_side = taxels.filter(|(_, axis)| axis.dot(normal) > -0.3);
            let nearest = same_side.map(|(center, _)| center.distance(point));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            assert!(nearest <= PITCH, "{name}: {nearest}");
        }
        // The number of taxels per area is equal inside and outside.
        let inside = layout.n_left_out() as f64 / f64::from(n_inner);
        let outside = layout.n_taxels() as f64 / f64::from(n_outer);
        assert!(
            (inside / outside - 1.0).abs() < 0.25,
            "{name}: {inside} {outside}"
        );
    }
    // A housing is touched in the same way as the part without its cavity.
    let [(_, housing), ..] = hollow_meshes();
    let [solid, hollow] = [cuboid(DVec3::splat(0.021)), housing].map(|mesh| draped(&mesh));
    assert!(hollow.n_taxels().abs_diff(solid.n_taxels()) < solid.n_taxels() / 20);
    let moved = hollow.moved(&bubbletouch_sim::geometry::Pose::IDENTITY);
    assert_eq!(moved.n_left_out(), hollow.n_left_out());
    assert_eq!(Layout::disc(0.02, PITCH).unwrap().n_left_out(), 0);
}

#[test]
fn a_region_carries_taxels_where_all_its_conditions_hold() {
    let mesh = cuboid(DVec3::new(0.04, 0.03, 0.02));
    let on = |region: &DrapeRegion| Layout::draped_on(&mesh, PITCH, region, &Seed::new(3)).unwrap();
    let whole = on(&DrapeRegion::default());
    assert_eq!(whole, draped(&mesh));
    // The last two triangles form the face at z = 0.02.
    let top = DrapeRegion {
        triangles: Some(vec![10, 11]),
        ..DrapeRegion::default()
    };
    let half = DrapeRegion {
        beyond: Some((DVec3::new(0.01, 0.0, 0.0), DVec3::X)),
        ..top.clone()
    };
    let bounds = Aabb {
        min: DVec3::new(-1.0, 0.0, -1.0),
        max: DVec3::new(1.0, 1.0, 1.0),
    };
    let quarter = DrapeRegion {
        bounds: Some(bounds),
        ..half.clone()
    };
    let counts = [&top, &half, &quarter].map(|region| {
        let layout = on(region);
        assert!(layout.centers().iter().all(|center| center.z == 0.02));
        assert_eq!(layout.n_left_out(), 0);
        if region.beyond.is_some() {
            assert!(layout.centers().iter().all(|center| center.x >= 0.01));
        }
        if region.bounds.is_some() {
            assert!(layout.centers().iter().all(|center| center.y >= 0.0));
        }
        layout.n_taxels() as f64
    });
    let share = counts[0] * PITCH * PITCH / (0.08 * 0.06);
    assert!((0.85..1.25).contains(&share), "{share}");
    assert!((counts[1] / counts[0] - 0.375).abs() < 0.1 && counts[2] < 0.65 * counts[1]);
    let message = |region: DrapeRegion| {
        let layout = Layout::draped_on(&mesh, PITCH, &region, &Seed::new(3));
        layout.unwrap_err().to_string()
    };
    let triangles = |numbers: &[usize]| DrapeRegion {
        triangles: Some(numbers.to_vec()),
        ..DrapeRegion::default()
    };
    assert_eq!(message(triangles(&[3, 12])), "region: triangle 12; 0 to 11");
    assert!(message(triangles(&[])).starts_with("draped layout: no place of the region"));
    let upside_down = DrapeRegion {
        bounds: Some(Aabb {
            min: DVec3::ONE,
            max: DVec3::ZERO,
        }),
        ..DrapeRegion::default()
    };
    assert!(message(upside_down).contains("the least first"));
    let nowhere = DrapeRegion {
        beyond: Some((DVec3::ZERO, DVec3::ZERO)),
        ..DrapeRegion::default()
    };
    assert!(message(nowhere).contains("a normal that is not zero"));
}

#[test]
fn a_mesh_without_a_known_outside_is_refused() {
    let open = without(&cuboid(DVec3::splat(0.02)), 10..12);
    let message = |mesh: &TriangleMesh| {
        let layout = Layout::draped(mesh, PITCH, &Seed::new(1));
        layout.unwrap_err().to_string()
    };
    assert_eq!(
        message(&inside_out(&open)),
        "draped layout: an open mesh whose faces face inwards; faces counter-clockwise seen from outside, or a closed mesh, which is turned outwards"
    );
    // A closed mesh is turned outwards.
    let turned = draped(&inside_out(&cuboid(DVec3::splat(0.02))));
    let mut taxels = turned.centers().iter().zip(turned.axes());
    assert!(turned.n_left_out() == 0 && taxels.all(|(center, axis)| center.dot(*axis) > 0.0));
    // Two triangles of a flat surface with opposite orientations.
    let corners = [[0.0, 0.0], [0.05, 0.0], [0.05, 0.05], [0.0, 0.05]];
    let corners: Vec<DVec3> = corners
        .iter()
        .map(|[x, y]| DVec3::new(*x, *y, 0.0))
        .collect();
    let sheet =
        |second| TriangleMesh::new("sheet", corners.clone(), vec![[0, 1, 2], second]).unwrap();
    assert!(
        message(&sheet([0, 3, 2])).contains("an open mesh whose faces disagree about the outside")
    );
    assert!(
        draped(&sheet([0, 2, 3]))
            .axes()
            .iter()
            .all(|axis| axis.distance(DVec3::Z) < 1e-12)
    );
}
