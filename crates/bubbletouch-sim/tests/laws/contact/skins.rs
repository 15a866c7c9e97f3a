//! Laws of contact on skins of any shape: comparison with a search along each taxel's axis, and with mirrored scenes.

use crate::random_scenes::{TAXEL, direction, random_pose, rng};
use bubbletouch_sim::contact::{Press, Until, Workspace, spring_load};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Model, Sphere, SphereUnion};
use bubbletouch_sim::world::{Grid, Layout, Patch, Taxel, Taxels};
use glam::DVec3;
use rand::Rng;

/// Returns a layout about 5 cm large; the families of layouts take turns.
fn random_layout(rng: &mut impl Rng, kind: u64) -> Layout {
    let pitch = rng.gen_range(1.5e-3..5e-3);
    let size = rng.gen_range(0.01..0.03);
    let layout = match kind % 7 {
        0 => Layout::grid(&Grid {
            nx: 12,
            ny: 9,
            pitch,
        }),
        1 => Layout::hexagonal(9, 11, pitch),
        2 => Layout::disc(size, pitch),
        3 => Layout::annulus(0.4 * size, size, pitch),
        4 => Layout::cylinder(size, 3.0 * size, rng.gen_range(0.5..6.2), pitch),
        5 => Layout::sphere_cap(size, rng.gen_range(0.5..3.0), pitch),
        _ => {
            let centers: Vec<DVec3> = (0..300).map(|_| size * direction(rng)).collect();
            let axes = centers.iter().map(|_| direction(rng)).collect();
            Layout::new(centers, axes)
        }
    };
    layout.unwrap()
}

fn random_skin(rng: &mut impl Rng, kind: u64) -> Patch {
    let layout = random_layout(rng, kind);
    let mut one = || Taxel {
        radius: rng.gen_range(0.3e-3..2e-3),
        stiffness: rng.gen_range(50.0..500.0),
        damping: 0.0,
        stroke: rng.gen_range(1e-3..8e-3),
    };
    let taxels = match kind % 2 {
        0 => Taxels::Equal(one()),
        _ => Taxels::Each((0..layout.n_taxels()).map(|_| one()).collect()),
    };
    Patch::new("skin", layout, taxels).unwrap()
}

/// Returns one to three objects of spheres from a micrometre to a metre, most of them near the skin's surface.
fn random_objects(rng: &mut impl Rng, skin: &Patch) -> Vec<Model> {
    let n_objects = rng.gen_range(1..4);
    let mut sphere = || {
        let radius = 10f64.powf(rng.gen_range(-6.0..0.0));
        let taxel = rng.gen_range(0..skin.n_taxels());
        let (place, axis) = (skin.layout().centers()[taxel], skin.layout().axes()[taxel]);
        let tilted = (axis + 0.7 * direction(rng)).normalize();
        let center = place + (radius + rng.gen_range(-8e-3..3e-3)) * tilted;
        Sphere { center, radius }
    };
    let mut object = || SphereUnion::new((0..12).map(|_| sphere()).collect()).unwrap();
    (0..n_objects).map(|_| object().into()).collect()
}

fn moved(model: &Model, pose: &Pose) -> Model {
    model.spheres().unwrap().moved(pose).into()
}

/// Returns a skin, objects given in the skin's frame, and the poses that bring the objects there.
fn random_scene(name: &str, case: u64) -> (Patch, Vec<Model>, Vec<Pose>) {
    let mut rng = rng(name, case);
    let skin = random_skin(&mut rng, case);
    let objects = random_objects(&mut rng, &skin);
    let poses: Vec<Pose> = objects.iter().map(|_| random_pose(&mut rng, 0.3)).collect();
    let objects = objects
        .iter()
        .zip(&poses)
        .map(|(object, pose)| moved(object, &pose.inverse()));
    (skin, objects.collect(), poses)
}

/// Returns the distance that a taxel must move back to stay outside a sphere. A search along the axis finds a point inside, and bisection between this point
/// and far behind finds the boundary. Returns 0 if nothing pushes the taxel.
fn needed_by_search(center: DVec3, axis: DVec3, taxel: &Taxel, sphere: &Sphere) -> f64 {
    let reach = taxel.radius + sphere.radius;
    let height = (sphere.center - center).dot(axis);
    let is_far = sphere.center.distance(center) > reach + taxel.stroke + taxel.radius;
    if is_far {
        return 0.0;
    }
    let distance = |z: f64| (center + z * axis).distance(sphere.center);
    let (mut low, mut high) = (height - 2.0 * reach, height + 2.0 * reach);
    for _ in 0..150 {
        let (l, h) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
        if distance(l) <= distance(h) {
            high = h
        } else {
            low = l
        }
    }
    let (mut outside, mut inside) = (height - 2.0 * reach, 0.5 * (low + high));
    if distance(inside) >= reach {
        return 0.0;
    }
    for _ in 0..80 {
        let middle = 0.5 * (outside + inside);
        if distance(middle) >= reach {
            outside = middle
        } else {
            inside = middle
        }
    }
    // At the corresponding distance ahead of the sphere's middle, the taxel would rest on the sphere's far side.
    match 2.0 * height - inside < -taxel.stroke - taxel.radius {
        true => 0.0,
        false => (-inside).max(0.0),
    }
}

/// Returns whether a taxel moves along the flank of a sphere, where its height has no bounded slope.
fn is_on_a_flank(skin: &Patch, taxel: usize, objects: &[Model], share: f64) -> bool {
    let (center, axis) = (skin.layout().centers()[taxel], skin.layout().axes()[taxel]);
    let radius = skin.taxels().at(taxel).radius;
    let spheres = objects
        .iter()
        .flat_map(|object| object.spheres().unwrap().spheres());
    spheres.into_iter().any(|sphere| {
        let beside = (sphere.center - center).cross(axis).length();
        let reach = radius + sphere.radius;
        (beside - reach).abs() < share * reach
    })
}

#[test]
fn every_taxel_stops_where_a_search_along_its_axis_says() {
    let mut workspace = Workspace::new();
    let (mut n_touched, mut n_saturated, mut n_flanks) = (0, 0, 0);
    for case in 0..70 {
        let (skin, objects, poses) = random_scene("search", case);
        let counts = Press::new(&skin, &objects, &poses, Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default();
        let placed: Vec<Model> = objects
            .iter()
            .zip(&poses)
            .map(|(o, p)| moved(o, p))
            .collect();
        for taxel in 0..skin.n_taxels() {
            let properties = skin.taxels().at(taxel);
            let (center, axis) = (skin.layout().centers()[taxel], skin.layout().axes()[taxel]);
            let spheres = placed
                .iter()
                .flat_map(|object| object.spheres().unwrap().spheres());
            let needed = spheres.map(|s| needed_by_search(center, axis, properties, s));
            let expected = needed.fold(0.0, f64::max).min(properties.stroke);
            let got = workspace.deflections()[taxel];
            if (got - expected).abs() >= 1e-9 {
                n_flanks += 1;
                let place = format!("case {case}, taxel {taxel}: {got} and {expected}");
                assert!(is_on_a_flank(&skin, taxel, &placed, 1e-9), "{place}");
            }
        }
        n_touched += counts.n_touched;
        n_saturated += counts.n_saturated;
    }
    assert!(
        n_touched > 1_500 && n_saturated > 250,
        "{n_touched} {n_saturated}"
    );
    assert!(n_flanks < 5, "{n_flanks}");
}

#[test]
fn a_contact_says_what_its_taxel_touches() {
    let mut workspace = Workspace::new();
    for case in 0..140 {
        let (skin, objects, poses) = random_scene("contacts", case);
        let counts = Press::new(&skin, &objects, &poses, Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default();
        let contacts = workspace.contacts();
        assert_eq!(contacts.len(), counts.n_touched);
        assert!(
            contacts
                .windows(2)
                .all(|pair| pair[0].taxel < pair[1].taxel)
        );
        for contact in contacts {
            let taxel = skin.taxels().at(contact.taxel);
            let axis = skin.layout().axes()[contact.taxel];
            let pushed = skin.layout().centers()[contact.taxel] - contact.needed * axis;
            let sphere = objects[contact.object].spheres().unwrap().spheres()[contact.part];
            let center = poses[contact.object].transform_point(sphere.center);
            let reach = taxel.radius + sphere.radius;
            assert!(
                (pushed.distance(center) - reach).abs() < 1e-14,
                "it touches"
            );
            assert!((center + reach * contact.normal - pushed).length() < 1e-14);
            assert!((contact.point - center - sphere.radius * contact.normal).length() < 1e-14);
            assert!((contact.normal.length() - 1.0).abs() < 1e-14);
            assert!((contact.cosine + contact.normal.dot(axis)).abs() < 1e-14);
            assert_eq!(contact.deflection, workspace.deflections()[contact.taxel]);
            assert_eq!(contact.deflection, contact.needed.min(taxel.stroke));
        }
        let n_deflected = workspace.deflections().iter().filter(|&&d| d > 0.0).count();
        assert_eq!(n_deflected, counts.n_touched);
        let saturated = contacts
            .iter()
            .filter(|c| c.is_saturated(skin.taxels().at(c.taxel)));
        assert_eq!(saturated.count(), counts.n_saturated);
    }
}

#[test]
fn the_contacts_of_a_grid_are_those_of_the_same_taxels_one_by_one() {
    let (mut by_rows, mut one_by_one) = (Workspace::new(), Workspace::new());
    let (mut n_touched, mut n_tied) = (0, 0);
    for case in 0..300 {
        let mut rng = rng("rows", case);
        let grid = Grid {
            nx: rng.gen_range(1..30),
            ny: rng.gen_range(1..30),
            pitch: 10f64.powf(rng.gen_range(-3.5..-2.0)),
        };
        let layout = Layout::grid(&grid).unwrap();
        let stiffness = |taxel: usize| 100.0 + taxel as f64;
        let taxels = match case % 2 {
            0 => Taxels::Equal(TAXEL),
            _ => Taxels::Each(
                (0..grid.n_taxels())
                    .map(|taxel| Taxel {
                        stiffness: stiffness(taxel),
                        ..TAXEL
                    })
                    .collect(),
            ),
        };
        let loose = Layout::new(layout.centers().to_vec(), layout.axes().to_vec()).unwrap();
        let loose = Patch::new("skin", loose, taxels.clone()).unwrap();
        let skin = Patch::new("skin", layout, taxels).unwrap();
        let mut objects = random_objects(&mut rng, &skin);
        // Each object occurs twice, so two parts need equal deflections at each taxel, and the first part counts.
        let twice = objects[0].spheres().unwrap().spheres().repeat(2);
        objects[0] = SphereUnion::new(twice).unwrap().into();
        objects.push(objects[0].clone());
        let poses = vec![random_pose(&mut rng, 0.3); objects.len()];
        let objects: Vec<Model> = objects
            .iter()
            .map(|object| moved(object, &poses[0].inverse()))
            .collect();
        let counts = Press::new(&skin, &objects, &poses, Until::Pose)
            .with_contacts()
            .run(&mut by_rows)
            .unwrap()
            .unwrap_or_default();
        assert_eq!(
            counts,
            Press::new(&loose, &objects, &poses, Until::Pose)
                .with_contacts()
                .run(&mut one_by_one)
                .unwrap()
                .unwrap_or_default()
        );
        assert_eq!(
            by_rows.contacts(),
            one_by_one.contacts(),
            "case {case}: taxels, parts, normals and points"
        );
        assert_eq!(by_rows.deflections(), one_by_one.deflections());
        let tied = by_rows.contacts().iter().filter(|c| c.object == 0);
        n_tied += tied.clone().count();
        assert!(
            tied.clone().all(|contact| contact.part < 12),
            "the first of two equal spheres"
        );
        n_touched += counts.n_touched;
        assert!(
            by_rows
                .contacts()
                .iter()
                .all(|contact| contact.object < objects.len() - 1),
            "the first of two equal objects"
        );
    }
    assert!(n_touched > 5_000 && n_tied > 1_000, "{n_touched} {n_tied}");
}

#[test]
fn a_mirrored_scene_gives_mirrored_deflections() {
    let mirror = |v: DVec3| DVec3::new(-v.x, v.y, v.z);
    let (mut here, mut there) = (Workspace::new(), Workspace::new());
    for case in 0..140 {
        let (skin, objects, poses) = random_scene("mirror", case);
        let placed: Vec<Model> = objects
            .iter()
            .zip(&poses)
            .map(|(o, p)| moved(o, p))
            .collect();
        let identity = vec![Pose::IDENTITY; placed.len()];
        Press::new(&skin, &placed, &identity, Until::Pose)
            .with_contacts()
            .run(&mut here)
            .unwrap();
        let centers = skin.layout().centers().iter().map(|&c| mirror(c)).collect();
        let axes = skin.layout().axes().iter().map(|&a| mirror(a)).collect();
        let layout = Layout::new(centers, axes).unwrap();
        let mirrored = Patch::new("mirrored", layout, skin.taxels().clone()).unwrap();
        let mirrored_sphere = |sphere: &Sphere| Sphere {
            center: mirror(sphere.center),
            ..*sphere
        };
        let objects = placed.iter().map(|object| {
            let spheres = object.spheres().unwrap().spheres().iter();
            SphereUnion::new(spheres.map(mirrored_sphere).collect())
                .unwrap()
                .into()
        });
        Press::new(
            &mirrored,
            &objects.collect::<Vec<Model>>(),
            &identity,
            Until::Pose,
        )
        .with_contacts()
        .run(&mut there)
        .unwrap();
        for (taxel, (a, b)) in here
            .deflections()
            .iter()
            .zip(there.deflections())
            .enumerate()
        {
            let is_same = (a - b).abs() <= 1e-12 || is_on_a_flank(&skin, taxel, &placed, 1e-4);
            assert!(is_same, "case {case}, taxel {taxel}: {a} {b}");
        }
        let [a, b] = [(&skin, &here), (&mirrored, &there)]
            .map(|(skin, workspace)| spring_load(skin, workspace.contacts()));
        let largest = a.on_object.force.length();
        // If two spheres need equal deflections, rounding may choose either; flanks also cause large lateral forces.
        if here.contacts().iter().all(|c| c.cosine > 0.1) {
            let difference = mirror(a.on_object.force) - b.on_object.force;
            assert!(
                difference.length() <= 1e-9 * largest,
                "case {case}: {difference}"
            );
        }
    }
}

#[test]
fn skin_and_objects_push_each_other_equally_and_every_spring_along_its_axis() {
    let mut workspace = Workspace::new();
    for case in 0..100 {
        let (skin, objects, poses) = random_scene("reaction", case);
        Press::new(&skin, &objects, &poses, Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap();
        let contacts = workspace.contacts();
        let load = spring_load(&skin, contacts);
        let both = load.on_object + load.on_patch();
        assert_eq!((both.force, both.torque), (DVec3::ZERO, DVec3::ZERO));
        let mut parts = bubbletouch_sim::contact::Wrench::default();
        for object in 0..objects.len() {
            let of_one = contacts.iter().filter(|c| c.object == object);
            parts = parts + spring_load(&skin, of_one).on_object;
        }
        assert!((parts.force - load.on_object.force).length() < 1e-9 * (1.0 + load.spring_force));
        for contact in contacts.iter().filter(|c| !c.is_grazing()) {
            let spring = skin.taxels().at(contact.taxel).stiffness * contact.deflection;
            let one = spring_load(&skin, [contact]);
            let along = one.on_object.force.dot(skin.layout().axes()[contact.taxel]);
            assert!(
                (along - spring).abs() < 1e-12 * spring.max(1.0),
                "{along} {spring}"
            );
        }
    }
}

#[test]
fn pressure_has_its_centre_under_the_ball_and_says_what_is_saturated() {
    let skin = Patch::new(
        "palm",
        Layout::disc(0.02, 1e-3).unwrap(),
        Taxels::Equal(TAXEL),
    );
    let skin = skin.unwrap();
    let ball = Sphere {
        center: DVec3::ZERO,
        radius: 0.05,
    };
    let objects = [SphereUnion::new(vec![ball]).unwrap().into()];
    let mut workspace = Workspace::new();
    let mut load = |depth: f64| {
        let pose = Pose::from_translation((ball.radius + TAXEL.radius - depth) * DVec3::Z);
        Press::new(&skin, &objects, &[pose], Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap();
        spring_load(&skin, workspace.contacts())
    };
    let light = load(1e-3);
    assert!(light.center_of_pressure.unwrap().length() < 1e-15);
    assert_eq!(light.saturated_share, 0.0);
    assert!((light.on_object.force.z - light.spring_force).abs() < 1e-12);
    assert!(light.on_object.force.truncate().length() < 1e-12);
    assert_eq!(load(0.03).saturated_share, 1.0);
    let none = load(-1e-3);
    assert_eq!((none.spring_force, none.center_of_pressure), (0.0, None));
}

#[test]
fn of_two_spheres_that_push_a_taxel_the_same_the_first_decides() {
    let layout = Layout::new(vec![DVec3::ZERO], vec![DVec3::Z]).unwrap();
    let skin = Patch::new("one", layout, Taxels::Equal(TAXEL)).unwrap();
    let sphere = |x: f64| Sphere {
        center: DVec3::new(x, 0.0, 4e-3),
        radius: 5e-3,
    };
    let union = |xs: &[f64]| SphereUnion::new(xs.iter().map(|&x| sphere(x)).collect()).unwrap();
    let mut workspace = Workspace::new();
    for x in [2e-3, -2e-3] {
        let objects = [union(&[x, -x]).into(), union(&[-x]).into()];
        Press::new(&skin, &objects, &[Pose::IDENTITY; 2], Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap();
        let [contact] = workspace.contacts() else {
            panic!("one taxel is touched")
        };
        assert_eq!((contact.object, contact.part), (0, 0));
        assert!(contact.normal.x * x < 0.0, "away from the first sphere");
    }
}
