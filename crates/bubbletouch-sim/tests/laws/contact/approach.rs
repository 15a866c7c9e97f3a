//! Laws of approaches by a skin of any layout: comparison with the grid kernel, and with all pairs of spheres and taxels.

use bubbletouch_sim::contact::{Contact, Press, Row, Until, Workspace};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{MeshModel, Model, Sphere, SphereUnion};
use bubbletouch_sim::world::{ArrayLayout, Grid, Layout, Patch, Taxels};
use glam::DVec3;
use rand::Rng;

use crate::mesh_shapes;
use crate::random_scenes::{TAXEL, random_pose, rng};

const GRID: Grid = Grid {
    nx: 16,
    ny: 16,
    pitch: 2e-3,
};

/// Returns a union of spheres from a millimetre to centimetres; in a deep press the small spheres move behind the substrate.
fn random_union(rng: &mut impl Rng) -> SphereUnion {
    let spheres = (0..rng.gen_range(1..60)).map(|_| Sphere {
        center: DVec3::from_array([0; 3].map(|_| rng.gen_range(-0.02..0.02))),
        radius: 10f64.powf(rng.gen_range(-3.0..-1.5)),
    });
    SphereUnion::new(spheres.collect()).unwrap()
}

#[test]
fn on_a_grid_it_is_the_grids_own_press() {
    let mut rng = rng("approach", 0);
    let patch = Patch::grid(GRID, TAXEL).unwrap();
    let (mut workspace, mut of_grid) = (Workspace::new(), Workspace::new());
    let (mut n_touched, mut n_deep) = (0, 0);
    for case in 0..400 {
        let objects: Vec<Model> = match case % 4 {
            0 => {
                let half = [0; 3].map(|_| rng.gen_range(1e-3..2e-2));
                let cuboid = mesh_shapes::cuboid(DVec3::from_array(half));
                vec![MeshModel::new(cuboid).into()]
            }
            _ => vec![random_union(&mut rng).into(), random_union(&mut rng).into()],
        };
        let poses: Vec<Pose> = objects
            .iter()
            .map(|_| random_pose(&mut rng, 0.03))
            .collect();
        let depth = TAXEL.stroke * 10f64.powf(rng.gen_range(-2.0..0.5));
        let press = Press::new(&patch, &objects, &poses, Until::Depth(depth));
        let touch = press.with_contacts().run(&mut workspace).unwrap();
        let contact = press.run(&mut of_grid).unwrap();
        assert_eq!(touch.is_some(), contact.is_some(), "case {case}");
        for (own, grid) in workspace.deflections().iter().zip(of_grid.deflections()) {
            assert!((own - grid).abs() < 1e-12, "case {case}: {own} for {grid}");
        }
        if let (Some(touch), Some(contact)) = (touch, contact) {
            assert!((touch.travel - contact.travel).abs() < 1e-12, "case {case}");
            assert_eq!(touch.n_touched, contact.n_touched, "case {case}");
            n_touched += 1;
            n_deep += usize::from(depth > TAXEL.stroke);
        }
    }
    assert!(n_touched > 200 && n_deep > 50, "{n_touched} {n_deep}");
}

/// Tests arbitrary contents of the row, rows of zeros, and all remainders of the row length by the kernel's block size.
#[test]
fn a_press_into_a_row_leaves_the_frame_and_nothing_else_there() {
    let mut rng = rng("approach", 5);
    let (mut workspace, mut into) = (Workspace::new(), Workspace::new());
    let mut n_touched = [0; 4];
    for case in 0..400 {
        let grid = Grid {
            nx: rng.gen_range(1..40),
            ny: rng.gen_range(1..40),
            ..GRID
        };
        let patch = match case % 5 {
            0 => {
                let layout = ArrayLayout::Hexagonal.taxels(&GRID, 0.02).unwrap();
                Patch::new("skin", layout, Taxels::Equal(TAXEL)).unwrap()
            }
            _ => Patch::grid(grid, TAXEL).unwrap(),
        };
        let object: Model = match case % 7 {
            0 => MeshModel::new(mesh_shapes::cuboid(DVec3::splat(5e-3))).into(),
            _ => random_union(&mut rng).into(),
        };
        let (objects, poses) = ([object], [random_pose(&mut rng, 0.03)]);
        let goal = match case % 4 {
            0 => Until::Pose,
            1 => Until::Depth(1e-3),
            2 => Until::Travel(rng.gen_range(-0.02..0.02)),
            _ => Until::Force(1e-3),
        };
        let press = Press::new(&patch, &objects, &poses, goal);
        let pressed = press.run(&mut workspace).unwrap();
        let n = patch.n_taxels();
        for before in [f64::NAN, 0.0] {
            let (mut doubles, mut singles) = (vec![before; n], vec![before as f32; n]);
            for row in [Row::Double(&mut doubles), Row::Single(&mut singles)] {
                let same = match before == 0.0 {
                    true => press.write_onto_zeros(row, &mut into),
                    false => press.write(row, &mut into),
                };
                assert_eq!(same.unwrap(), pressed, "case {case}");
                assert_eq!(into.deflections(), workspace.deflections(), "case {case}");
            }
            assert_eq!(doubles, workspace.deflections(), "case {case}");
            let rounded = doubles.iter().map(|double| *double as f32);
            assert!(singles.into_iter().eq(rounded), "case {case}");
        }
        n_touched[case % 4] += usize::from(pressed.is_some_and(|c| c.n_touched > 0));
    }
    assert!(n_touched.iter().all(|n| *n > 20), "{n_touched:?}");
}

#[test]
fn first_contact_is_that_of_the_nearest_pair_of_spheres() {
    let mut rng = rng("approach", 1);
    let mut workspace = Workspace::new();
    let mut n_met = 0;
    for case in 0..120 {
        let layout = [
            ArrayLayout::Hexagonal,
            ArrayLayout::Disc,
            ArrayLayout::Cylinder,
            ArrayLayout::Cap,
        ][case % 4];
        let layout = layout.taxels(&GRID, 0.02).unwrap();
        let skin = Patch::new("skin", layout, Taxels::Equal(TAXEL)).unwrap();
        let direction =
            DVec3::new(rng.gen_range(-0.3..0.3), rng.gen_range(-0.3..0.3), 1.0).normalize();
        let union = random_union(&mut rng);
        let pose = random_pose(&mut rng, 0.05);
        let objects = [Model::from(union.clone())];
        let found = Press::new(&skin, &objects, &[pose], Until::Depth(0.0))
            .along(direction)
            .run(&mut workspace)
            .unwrap();
        let found = found.map(|contact| contact.travel);
        let mut expected = f64::INFINITY;
        for sphere in union.spheres() {
            for center in skin.layout().centers() {
                let away = pose.transform_point(sphere.center) - *center;
                let ahead = away.dot(direction);
                let reach = sphere.radius + TAXEL.radius;
                let beside2 = away.length_squared() - ahead * ahead;
                let half2 = reach * reach - beside2;
                if half2 > 0.0 {
                    expected = expected.min(ahead - half2.sqrt());
                }
            }
        }
        let Some(found) = found else {
            assert!(expected.is_infinite(), "case {case}: {expected}");
            continue;
        };
        n_met += 1;
        assert!(
            (found - expected).abs() < 1e-12,
            "case {case}: {found} for {expected}"
        );
        // Just before first contact no taxel is touched, and just behind it at least one is.
        let mut n_touched = |travel: f64| {
            let moved = Pose {
                translation: pose.translation - travel * direction,
                ..pose
            };
            Press::new(&skin, &objects, &[moved], Until::Pose)
                .with_contacts()
                .run(&mut workspace)
                .unwrap()
                .unwrap_or_default()
                .n_touched
        };
        assert!(n_touched(found + 1e-9) > 0, "case {case}");
    }
    assert!(n_met > 60, "{n_met}");
}

#[test]
fn what_was_pressed_goes_on_being_pressed_behind_the_substrate() {
    let mut workspace = Workspace::new();
    let layout = ArrayLayout::Cap.taxels(&GRID, 0.03).unwrap();
    let skin = Patch::new("cap", layout, Taxels::Equal(TAXEL)).unwrap();
    let pin = Sphere {
        center: DVec3::ZERO,
        radius: 0.5e-3,
    };
    let objects = [SphereUnion::new(vec![pin]).unwrap().into()];
    let pose = Pose::from_translation(0.05 * DVec3::Z);
    let touch = Press::new(&skin, &objects, &[pose], Until::Depth(3.0 * TAXEL.stroke))
        .with_contacts()
        .run(&mut workspace)
        .unwrap();
    assert!(touch.unwrap().n_saturated >= 1);
    let moved = Pose::from_translation((0.05 - touch.unwrap().travel) * DVec3::Z);
    let there = Press::new(&skin, &objects, &[moved], Until::Pose)
        .with_contacts()
        .run(&mut workspace)
        .unwrap()
        .unwrap_or_default();
    assert_eq!(there.n_touched, 0, "without its way it is behind");
}

#[test]
fn taxels_that_do_not_know_their_grid_are_pressed_alike() {
    let grid = Patch::grid(GRID, TAXEL).unwrap();
    let places = grid.layout();
    let places = Layout::new(places.centers().to_vec(), places.axes().to_vec()).unwrap();
    let loose = Patch::new("loose", places, Taxels::Equal(TAXEL)).unwrap();
    let (mut of_grid, mut of_loose) = (Workspace::new(), Workspace::new());
    let mut n_touched = [0; 3];
    for case in 0..300 {
        let mut rng = rng("loose", case);
        let objects: Vec<Model> =
            vec![random_union(&mut rng).into(), random_union(&mut rng).into()];
        let poses = [0; 2].map(|_| random_pose(&mut rng, 0.03));
        let mut same =
            |a: Option<Contact>, b: Option<Contact>, of: [&Workspace; 2], goal: usize| {
                assert_eq!(a.is_some(), b.is_some(), "case {case}");
                let [a, b] = [a, b].map(Option::unwrap_or_default);
                assert!(
                    (a.travel - b.travel).abs() < 1e-12,
                    "case {case}: {a:?} {b:?}"
                );
                assert_eq!(a.n_saturated, b.n_saturated, "case {case}");
                for (own, grid) in of[1].deflections().iter().zip(of[0].deflections()) {
                    assert!((own - grid).abs() < 1e-12, "case {case}: {own} for {grid}");
                }
                n_touched[goal] += a.n_touched;
            };
        let depth = TAXEL.stroke * 10f64.powf(rng.gen_range(-2.0..0.5));
        let a = Press::new(&grid, &objects, &poses, Until::Depth(depth))
            .run(&mut of_grid)
            .unwrap();
        let b = Press::new(&loose, &objects, &poses, Until::Depth(depth))
            .run(&mut of_loose)
            .unwrap();
        same(a, b, [&of_grid, &of_loose], 0);
        let Some(contact) = a else {
            continue;
        };
        let travel = contact.travel - depth + rng.gen_range(-1e-3..0.02);
        let a = Press::new(&grid, &objects, &poses, Until::Travel(travel))
            .run(&mut of_grid)
            .unwrap()
            .unwrap_or_default();
        let b = Press::new(&loose, &objects, &poses, Until::Travel(travel))
            .run(&mut of_loose)
            .unwrap()
            .unwrap_or_default();
        same(Some(a), Some(b), [&of_grid, &of_loose], 1);
        let force = 10f64.powf(rng.gen_range(-3.0..0.0));
        let a = Press::new(&grid, &objects, &poses, Until::Force(force)).run(&mut of_grid);
        let b = Press::new(&loose, &objects, &poses, Until::Force(force)).run(&mut of_loose);
        assert_eq!(a.is_ok(), b.is_ok(), "case {case}: {force} N");
        if let (Ok(a), Ok(b)) = (a, b) {
            same(a, b, [&of_grid, &of_loose], 2);
        }
    }
    assert!(n_touched.iter().all(|&n| n > 1_000), "{n_touched:?}");
}
