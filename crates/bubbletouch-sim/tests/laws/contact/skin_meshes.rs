//! Laws of contact between skins of any shape and meshes: comparison with every triangle, with the grid kernel, and with a forearm on a table.

use bubbletouch_sim::contact::{Press, Until, Workspace, spring_load};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Surface, TriangleMesh};
use bubbletouch_sim::objects::{MeshModel, Model};
use bubbletouch_sim::world::{Grid, Layout, Patch, Taxel, Taxels};
use glam::{DQuat, DVec3};
use rand::Rng;
use std::f64::consts::TAU;

use crate::mesh_shapes::{cuboid, icosphere};
use crate::random_scenes::{TAXEL, direction, rng};

fn random_turn(rng: &mut impl Rng) -> DQuat {
    DQuat::from_scaled_axis(rng.gen_range(0.0..3.0) * direction(rng))
}

/// Returns a crumpled surface whose triangles are consistently oriented.
fn crumpled_surface(rng: &mut impl Rng, size: f64) -> TriangleMesh {
    let n = 9_u32;
    let corner = |i: u32| DVec3::new(f64::from(i % n), f64::from(i / n), 0.0) / f64::from(n);
    let corners = (0..n * n).map(|i| size * (corner(i) + 0.15 * direction(rng) - 0.5));
    let cells = (0..n * n).filter(|i| i % n < n - 1 && i / n < n - 1);
    let faces = cells.flat_map(|i| [[i, i + 1, i + n], [i + 1, i + n + 1, i + n]]);
    TriangleMesh::new("sheet", corners.collect(), faces.collect()).unwrap()
}

fn random_mesh(rng: &mut impl Rng, kind: u64) -> TriangleMesh {
    let size = rng.gen_range(5e-3..4e-2);
    match kind % 3 {
        0 => cuboid(size * DVec3::new(1.0, rng.gen_range(0.1..1.0), rng.gen_range(0.05..1.0))),
        1 => icosphere(size, rng.gen_range(0..3)),
        _ => crumpled_surface(rng, 2.0 * size),
    }
}

/// Returns a skin with individual taxels, and a mesh at a pose on the skin.
fn random_scene(case: u64) -> (Patch, TriangleMesh, Pose) {
    let mut rng = rng("scene", case);
    let layout = match case % 4 {
        0 => Layout::cylinder(0.02, 0.05, rng.gen_range(1.0..TAU), 4e-3),
        1 => Layout::sphere_cap(0.02, 2.0, 4e-3),
        2 => Layout::hexagonal(10, 10, 4e-3),
        _ => {
            let centers: Vec<DVec3> = (0..120).map(|_| 0.02 * direction(&mut rng)).collect();
            let axes = centers.iter().map(|_| direction(&mut rng)).collect();
            Layout::new(centers, axes)
        }
    };
    let layout = layout.unwrap();
    let one = |k: usize| Taxel {
        radius: 1e-3 + 5e-6 * k as f64,
        stroke: 7e-3 - 1e-5 * k as f64,
        ..TAXEL
    };
    let taxels = (0..layout.n_taxels()).map(one).collect();
    let middle = layout.centers()[rng.gen_range(0..layout.n_taxels())];
    let skin = Patch::new("skin", layout, Taxels::Each(taxels)).unwrap();
    let mesh = random_mesh(&mut rng, case / 4);
    let corner = mesh.vertices()[rng.gen_range(0..mesh.vertices().len())];
    let rotation = random_turn(&mut rng);
    let shift = rng.gen_range(0.0..5e-3) * direction(&mut rng);
    let pose = Pose::new(rotation, middle + shift - rotation * corner);
    (skin, mesh, pose)
}

#[test]
fn a_contact_lies_on_its_triangle_a_radius_from_the_taxel() {
    let mut workspace = Workspace::new();
    for case in 0..120 {
        let (skin, mesh, pose) = random_scene(case);
        let placed = mesh.moved(&pose);
        Press::new(&skin, &[MeshModel::new(mesh).into()], &[pose], Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap();
        for contact in workspace.contacts() {
            let axis = skin.layout().axes()[contact.taxel];
            let pushed = skin.layout().centers()[contact.taxel] - contact.needed * axis;
            let radius = skin.taxels().at(contact.taxel).radius;
            assert!((pushed.distance(contact.point) - radius).abs() < 1e-9);
            let on = placed.triangle(contact.part).closest(contact.point).0;
            assert!(on.distance(contact.point) < 1e-12);
            assert!((contact.point + radius * contact.normal - pushed).length() < 1e-9);
        }
    }
}

#[test]
fn balls_as_spheres_and_as_fine_meshes_press_nearly_the_same() {
    let layout = Layout::sphere_cap(0.02, 1.5, 2e-3).unwrap();
    let skin = Patch::new("fingertip", layout, Taxels::Equal(TAXEL)).unwrap();
    let radius = 0.03;
    let mesh = MeshModel::new(icosphere(radius, 6)).into();
    let ball = bubbletouch_sim::objects::Sphere {
        center: DVec3::ZERO,
        radius,
    };
    let ball: Model = bubbletouch_sim::objects::SphereUnion::new(vec![ball])
        .unwrap()
        .into();
    let pose = Pose::from_translation(DVec3::new(0.02, 0.01, 0.043));
    let [a, b] = [mesh, ball].map(|model: Model| {
        let mut workspace = Workspace::new();
        Press::new(&skin, &[model], &[pose], Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap();
        let load = spring_load(&skin, workspace.contacts());
        (workspace.deflections().to_vec(), load)
    });
    let largest =
        a.0.iter()
            .zip(&b.0)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
    assert!(largest < 2e-5, "{largest}");
    assert!(b.1.spring_force > 1.0);
    let difference = a.1.on_object.force - b.1.on_object.force;
    assert!(
        difference.length() < 0.02 * b.1.spring_force,
        "{difference}"
    );
}

/// Returns a closed skin around a forearm with a level z axis.
fn forearm() -> Patch {
    let layout = Layout::cylinder(0.03, 0.1, TAU, 5e-3).unwrap();
    Patch::new("forearm", layout, Taxels::Equal(TAXEL)).unwrap()
}

#[test]
fn what_a_forearm_lies_on_does_not_press_its_other_side() {
    let skin = forearm();
    let table: Model = MeshModel::new(cuboid(DVec3::new(0.01, 1.0, 1.0))).into();
    // The top of the mesh is at x = −0.029. Taxels rest at x = −0.03 with a radius of 1 mm, so they are pushed by up to 2 mm.
    let pose = Pose::from_translation(DVec3::new(-0.039, 0.0, 0.0));
    let mut workspace = Workspace::new();
    let counts = Press::new(&skin, &[table], &[pose], Until::Pose)
        .with_contacts()
        .run(&mut workspace)
        .unwrap()
        .unwrap_or_default();
    assert!(
        counts.n_touched > 50 && counts.n_saturated == 0,
        "{counts:?}"
    );
    for contact in workspace.contacts() {
        let axis = skin.layout().axes()[contact.taxel];
        assert!(axis.x < -0.9, "{axis}");
        // A taxel whose axis is inclined by θ to a plane moves back until it is a radius away from the plane.
        let needed = (TAXEL.radius - 0.029) / -axis.x + 0.03;
        assert!((contact.needed - needed).abs() < 1e-12);
        assert!((contact.normal - DVec3::X).length() < 1e-9);
    }
}

#[test]
fn walls_on_both_sides_of_a_forearm_press_only_their_own_sides() {
    let skin = forearm();
    let wall = cuboid(DVec3::new(0.01, 1.0, 1.0));
    let sides = [-0.039, 0.039].map(|x| wall.moved(&Pose::from_translation(x * DVec3::X)));
    let corners = sides.iter().flat_map(|side| side.vertices().to_vec());
    let faces = sides.iter().zip([0, 8]).flat_map(|(side, first)| {
        let faces = side.triangles().iter();
        faces
            .map(move |face| face.map(|corner| corner + first))
            .collect::<Vec<_>>()
    });
    let both = TriangleMesh::new("walls", corners.collect(), faces.collect()).unwrap();
    let mut workspace = Workspace::new();
    let model: Model = MeshModel::new(both).into();
    let counts = Press::new(&skin, &[model], &[Pose::IDENTITY], Until::Pose)
        .with_contacts()
        .run(&mut workspace)
        .unwrap()
        .unwrap_or_default();
    assert!(
        counts.n_touched > 100 && counts.n_saturated == 0,
        "{counts:?}"
    );
    let load = spring_load(&skin, workspace.contacts());
    assert!(load.on_object.force.length() < 1e-9 * load.spring_force);
}

#[test]
fn a_taxel_whose_substrate_is_inside_of_a_mesh_is_saturated() {
    let layout = Layout::grid(&Grid {
        nx: 5,
        ny: 5,
        pitch: 2e-3,
    });
    let skin = Patch::new("palm", layout.unwrap(), Taxels::Equal(TAXEL)).unwrap();
    let mut workspace = Workspace::new();
    for mesh in [cuboid(DVec3::splat(0.05)), icosphere(0.05, 3)] {
        assert!(Surface::new(mesh.clone()).contains(DVec3::ZERO));
        let model: Model = MeshModel::new(mesh).into();
        let counts = Press::new(&skin, &[model], &[Pose::IDENTITY], Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default();
        assert_eq!((counts.n_touched, counts.n_saturated), (25, 25));
        assert!(workspace.contacts().iter().all(|c| c.needed > 0.04));
    }
}
