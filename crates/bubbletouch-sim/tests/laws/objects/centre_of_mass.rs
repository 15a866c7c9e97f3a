//! Laws of volume and centre of mass: overlapping parts count once, and solids, their packings and equal meshes agree.

use crate::mesh_shapes::{inside_out, joined};
use crate::scenes::{direction, rng};
use crate::shapes::{part, shape, solid};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::TriangleMesh;
use bubbletouch_sim::objects::{Catalogue, Part, Solid, Sphere, SphereUnion};
use glam::{DQuat, DVec3};
use rand::Rng;
use std::f64::consts::PI;

/// Returns a box between two corners.
fn cuboid([low, high]: [DVec3; 2]) -> TriangleMesh {
    let mesh = TriangleMesh::cuboid("box", high - low).unwrap();
    mesh.moved(&Pose::from_translation(0.5 * (low + high)))
}

/// Returns volume and centroid of the union of boxes whose corners have integer coordinates from 0 to 8.
fn counted(boxes: &[[DVec3; 2]]) -> (f64, DVec3) {
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    for cell in 0..512 {
        let middle = DVec3::new((cell % 8) as f64, (cell / 8 % 8) as f64, (cell / 64) as f64) + 0.5;
        if boxes
            .iter()
            .any(|[low, high]| middle.cmpgt(*low).all() && middle.cmplt(*high).all())
        {
            volume += 1.0;
            moment += middle;
        }
    }
    (volume, moment / volume)
}

#[test]
fn overlapping_parts_of_a_mesh_count_once() {
    for case in 0..60 {
        let mut rng = rng("union", case);
        let boxes: Vec<[DVec3; 2]> = (0..rng.gen_range(1..6))
            .map(|_| {
                let low = [0; 3].map(|_| rng.gen_range(0..7));
                let high = low.map(|low: i32| rng.gen_range(low + 1..=8));
                [low, high].map(|corner| DVec3::from_array(corner.map(f64::from)))
            })
            .collect();
        let (volume, center) = counted(&boxes);
        // Boxes with integer corners often share faces, edges or corners.
        let pose = Pose::new(
            DQuat::from_rotation_arc(DVec3::Z, direction(&mut rng)),
            direction(&mut rng),
        );
        let mesh = joined(&boxes.iter().copied().map(cuboid).collect::<Vec<_>>()).moved(&pose);
        for (mesh, sign) in [(&mesh, 1.0), (&inside_out(&mesh), -1.0)] {
            let (found, centroid) = mesh.volume_and_centroid();
            assert!(
                (found - sign * volume).abs() < 1e-6 * volume,
                "{case}: {found} for {volume}"
            );
            assert!(
                centroid.distance(pose.transform_point(center)) < 1e-6,
                "{case}: {centroid}"
            );
        }
    }
}

#[test]
fn a_cavity_does_not_count_and_a_part_inside_a_part_adds_nothing() {
    let cube = |half: f64| cuboid([DVec3::splat(-half), DVec3::splat(half)]);
    let volume = |meshes: &[TriangleMesh]| joined(meshes).volume_and_centroid().0;
    assert!((volume(&[cube(2.0), inside_out(&cube(1.0))]) - 56.0).abs() < 1e-12);
    assert!((volume(&[cube(2.0), cube(1.0)]) - 64.0).abs() < 1e-12);
    assert!((volume(&[cube(2.0), inside_out(&cube(1.0)), cube(0.5)]) - 57.0).abs() < 1e-12);
    assert!((volume(&[cube(2.0), cube(2.0), cube(2.0)]) - 64.0).abs() < 1e-12);
}

#[test]
fn two_round_parts_count_their_lens_once() {
    let ball = TriangleMesh::ellipsoid("ball", DVec3::ONE, 2e-3).unwrap();
    let apart = 0.8;
    let shift = Pose::from_translation(DVec3::new(apart, 0.0, 0.0));
    let two = joined(&[ball.clone(), ball.moved(&shift)]);
    let lens = PI / 12.0 * (4.0 + apart) * (2.0 - apart) * (2.0 - apart);
    let share = (8.0 / 3.0 * PI - lens) / (4.0 / 3.0 * PI);
    let (one, _) = ball.volume_and_centroid();
    let (volume, center) = two.volume_and_centroid();
    let found = volume / one;
    assert!((found - share).abs() < 2e-3, "{found} for {share}");
    let exact = DVec3::new(0.5 * apart, 0.0, center.z);
    assert!((center - exact).abs().max_element() < 1e-3, "{center}");
}

/// Returns the centroid of a solid, as the mean of random points in it, and its standard error along each axis.
fn sampled(solid: &Solid, n: usize) -> (DVec3, DVec3) {
    let mut rng = rng("sampled", 0);
    let bounds = solid.bounds();
    let (mut count, mut sum, mut squares) = (0.0, DVec3::ZERO, DVec3::ZERO);
    for _ in 0..n {
        let share = DVec3::from_array([0; 3].map(|_| rng.gen_range(0.0..1.0)));
        let point = bounds.min + bounds.size() * share;
        if solid.distance(point) < 0.0 {
            let from_middle = point - bounds.center();
            count += 1.0;
            sum += from_middle;
            squares += from_middle * from_middle;
        }
    }
    let mean = sum / count;
    let variance = squares / count - mean * mean;
    (
        bounds.center() + mean,
        DVec3::new(variance.x.sqrt(), variance.y.sqrt(), variance.z.sqrt()) / f64::sqrt(count),
    )
}

#[test]
fn every_shape_has_its_centre_of_mass() {
    let texts = [
        "ball diameter=0.03",
        "box size=[0.02,0.03,0.05] rounding=0.004",
        "torus ring_diameter=0.05 tube_diameter=0.02",
        "cone_frustum bottom_diameter=0.03 top_diameter=0.01 height=0.04",
        "capsule diameter=0.02 length=0.05",
        "strand points=[[0,0,0],[0.04,0.01,0]] diameters=[0.02,0.03]",
        "strand points=[[0,0,0],[0.04,0.01,0],[0.05,0.05,0.02]] diameters=[0.02,0.03,0.01]",
        "lathe profile=[[0,0],[0.03,0],[0.02,0.02],[0.04,0.05],[0.01,0.04],[0,0.03]]",
        "prism outline=[[0,0],[0.05,0],[0.05,0.01],[0.01,0.01],[0.01,0.04],[0,0.04]] thickness=0.01",
    ];
    for (number, text) in texts.into_iter().enumerate() {
        let pose = Pose::new(
            DQuat::from_rotation_y(0.4 * number as f64),
            DVec3::new(0.1, 0.0, -0.2),
        );
        // A ball of its own and far away shows the volume of the shape, too.
        let far = part("ball diameter=0.03", [0.2, 0.0, -0.2]);
        let solid = Solid::new(vec![Part::new(shape(text), pose).unwrap(), far]).unwrap();
        let (mean, error) = sampled(&solid, 400_000);
        let found = solid.center_of_mass();
        assert!(
            (found - mean).abs().cmplt(5.0 * error).all(),
            "{text}: {found} for {mean} ± {error}"
        );
    }
}

#[test]
fn solids_of_overlapping_and_subtracted_shapes_have_their_exact_centre_of_mass() {
    // A hammer: its handle ends in the middle of the head.
    let handle = part("box size=[0.02,0.02,0.18]", [0.0, 0.0, 0.09]);
    let head = part("box size=[0.1,0.03,0.04]", [0.0, 0.0, 0.18]);
    let volumes = [0.02 * 0.02 * 0.16, 0.1 * 0.03 * 0.04];
    let exact = (volumes[0] * 0.08 + volumes[1] * 0.18) / (volumes[0] + volumes[1]);
    let hammer = Solid::new(vec![handle, head]).unwrap();
    let found = hammer.center_of_mass().z;
    assert!((found - exact).abs() < 3e-6, "{found} for {exact}");
    // A thin cup: a cylinder less a cylinder that ends in its rim.
    let [diameter, height, wall] = [0.08, 0.1, 5e-4];
    let inner = diameter - 2.0 * wall;
    let outside = format!("cylinder diameter={diameter} height={height}");
    let hole = format!("cylinder diameter={inner} height={}", height - wall);
    let cup = Solid::new(vec![part(&outside, [0.0, 0.0, 0.5 * height])]).unwrap();
    let hole = part(&hole, [0.0, 0.0, 0.5 * (height + wall)]);
    let cup = cup.less(vec![hole]).unwrap();
    let [o, i] = [0.5 * diameter, 0.5 * inner];
    let turned = solid(&format!(
        "lathe profile=[[0,0],[{o},0],[{o},{height}],[{i},{height}],[{i},{wall}],[0,{wall}]]"
    ));
    let [out, within] = [diameter, inner].map(|d| 0.25 * PI * d * d);
    let volumes = [out * height, within * (height - wall)];
    let exact = (volumes[0] * 0.5 * height - volumes[1] * 0.5 * (height + wall))
        / (volumes[0] - volumes[1]);
    assert!((turned.center_of_mass().z - exact).abs() < 1e-12);
    let found = cup.center_of_mass().z;
    assert!((found - exact).abs() < 1e-3 * height, "{found} for {exact}");
    // The spheres of a packing weigh like the solid.
    let packed = hammer.pack(5e-4).unwrap();
    assert_eq!(packed.center_of_mass(), hammer.center_of_mass());
    let pose = Pose::new(DQuat::from_rotation_x(1.0), DVec3::ONE);
    let moved = packed.moved(&pose).center_of_mass();
    assert!(moved.distance(pose.transform_point(hammer.center_of_mass())) < 1e-12);
}

#[test]
fn every_built_in_object_has_its_centre_of_mass() {
    for entry in Catalogue::builtin().unwrap().entries() {
        let (mean, error) = sampled(&entry.solid, 100_000);
        let found = entry.solid.center_of_mass();
        let within = 5.0 * error + 1e-3 * entry.solid.bounds().size().max_element();
        assert!(
            (found - mean).abs().cmplt(within).all(),
            "{}: {found} for {mean} ± {error}",
            entry.name
        );
    }
}

#[test]
fn spheres_of_a_file_balance_within_a_tenth_of_the_documented_error() {
    let sphere = |center: [f64; 3], radius| Sphere {
        center: DVec3::from_array(center),
        radius,
    };
    // A thin rod of spheres along x with a ball at its end.
    let rod = (0..400).map(|k| sphere([5e-4 * f64::from(k), 0.0, 0.0], 1e-3));
    let spheres: Vec<Sphere> = rod.chain([sphere([0.22, 0.0, 0.0], 0.02)]).collect();
    let union = SphereUnion::new(spheres.clone()).unwrap();
    let mut exact = [0.0; 2];
    let n = 2_000_000;
    for k in 0..n {
        let x = -1e-3 + (0.24 + 1e-3) * (f64::from(k) + 0.5) / f64::from(n);
        let nearest = (x / 5e-4).round().clamp(0.0, 399.0) * 5e-4;
        let square = |center: f64, radius: f64| radius * radius - (x - center).powi(2);
        let area = square(nearest, 1e-3).max(square(0.22, 0.02)).max(0.0);
        exact[0] += area;
        exact[1] += area * x;
    }
    let found = union.center_of_mass();
    let exact = exact[1] / exact[0];
    assert!((found.x - exact).abs() < 2e-4 * 0.24, "{found} for {exact}");
    assert!(found.y.abs() < 1e-9 && found.z.abs() < 1e-9, "{found}");
}
