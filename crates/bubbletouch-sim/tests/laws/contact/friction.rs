//! Laws of friction on skins: friction cone, dissipation, steps of any size, symmetry, and textbook solutions for slip.

use bubbletouch_sim::contact::{
    ContactMode, ContactModeCounts, DamperState, FrictionLoad, FrictionState, NormalForce, Press,
    Until, spring_load,
};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::Model;
use bubbletouch_sim::world::{Layout, Patch, Shear, Shears, Taxel};
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;

use crate::mesh_shapes::cuboid;
use crate::scenes::{
    self, Pressed, TAXEL, direction, grid, mesh, one_taxel, pressed, rng, skin, touched,
};

const SHEAR: Shear = Shear {
    stiffness: 400.0,
    friction: 0.6,
};

fn ball(radius: f64) -> Model {
    scenes::ball(radius).into()
}

/// Creates a box whose lower side is in the plane z = 0 of its frame.
fn block(size: DVec3) -> Model {
    let lifted = cuboid(0.5 * size).moved(&Pose::from_translation(0.5 * size.z * DVec3::Z));
    mesh(lifted)
}

/// Test bench: a skin with friction on which objects move.
struct Bench {
    skin: Patch,
    objects: Vec<Model>,
    state: FrictionState,
    found: Pressed,
}

impl Bench {
    fn new(skin: Patch, objects: Vec<Model>, shears: Shears) -> Self {
        Self {
            state: FrictionState::at_rest(&skin, shears).unwrap(),
            found: touched(&skin, &[], &[]),
            skin,
            objects,
        }
    }

    fn step(&mut self, poses: &[Pose]) -> ContactModeCounts {
        self.found = touched(&self.skin, &self.objects, poses);
        let contacts = &self.found.contacts;
        self.state
            .step(&self.skin, contacts, poses, NormalForce::Springs)
    }

    /// Moves one object to a place without rotation, in one step.
    fn slide_to(&mut self, place: DVec3) -> ContactModeCounts {
        self.step(&[Pose::from_translation(place)])
    }

    fn load(&self) -> FrictionLoad {
        self.state.load(&self.skin, &self.found.contacts)
    }

    fn displacements(&self) -> Vec<DVec2> {
        let taxels = 0..self.skin.n_taxels();
        taxels.map(|t| self.state.displacement(t)).collect()
    }
}

/// Returns a curved or flat skin with a ball and a box at random on it, and their poses over the next 12 steps.
fn random_bench(name: &str, case: u64) -> (Bench, Vec<[Pose; 2]>) {
    let mut rng = rng(name, case);
    let layout = match case % 4 {
        0 => Layout::hexagonal(14, 14, 2e-3),
        1 => Layout::sphere_cap(0.02, 2.5, 2e-3),
        2 => Layout::cylinder(0.02, 0.03, 4.0, 2e-3),
        _ => {
            let centers: Vec<DVec3> = (0..300).map(|_| 0.02 * direction(&mut rng)).collect();
            let axes = centers.iter().map(|_| direction(&mut rng)).collect();
            Layout::new(centers, axes)
        }
    };
    let layout = layout.unwrap();
    let n = layout.n_taxels();
    let mut shear = || Shear {
        stiffness: 10f64.powf(rng.gen_range(1.0..4.0)),
        friction: rng.gen_range(0.0..1.5),
    };
    let shears = match case % 3 {
        0 => Shears::Equal(shear()),
        _ => Shears::Each((0..n).map(|_| shear()).collect()),
    };
    let middle = rng.gen_range(0..n);
    let (center, axis) = (layout.centers()[middle], layout.axes()[middle]);
    let skin = skin(layout, TAXEL);
    let objects = vec![ball(0.015), block(DVec3::new(0.03, 0.01, 0.02))];
    let size = 10f64.powf(rng.gen_range(-6.0..-2.0));
    let mut pose = |reach: f64| {
        let turn = DQuat::from_rotation_arc(DVec3::Z, axis);
        let nudge = DQuat::from_scaled_axis(40.0 * size * direction(&mut rng));
        let place = center + reach * axis + size * direction(&mut rng);
        Pose::new(nudge * turn, place)
    };
    let way = (0..12).map(|_| [pose(0.0145), pose(-0.5e-3)]).collect();
    (Bench::new(skin, objects, shears), way)
}

#[test]
fn without_friction_the_load_is_that_of_the_springs_to_the_bit() {
    let mut n_touched = 0;
    for case in 0..60 {
        let (bench, way) = random_bench("frictionless", case);
        let slippery = Shear {
            friction: 0.0,
            ..SHEAR
        };
        let mut bench = Bench::new(bench.skin, bench.objects, Shears::Equal(slippery));
        for poses in way {
            let counts = bench.step(&poses);
            let contacts = &bench.found.contacts;
            let springs = spring_load(&bench.skin, contacts).on_object;
            let load = bench.load();
            let bits = |v: DVec3| v.to_array().map(f64::to_bits);
            assert_eq!(bits(load.on_object.force), bits(springs.force));
            assert_eq!(bits(load.on_object.torque), bits(springs.torque));
            assert_eq!(load.friction.force, DVec3::ZERO);
            assert_eq!(counts.n_slipping + counts.n_sticking, contacts.len());
            n_touched += contacts.len();
        }
    }
    assert!(n_touched > 10_000, "{n_touched}");
}

#[test]
fn friction_is_within_its_cone_after_a_step_of_any_size() {
    let (mut n_slipping, mut n_sticking) = (0, 0);
    for case in 0..120 {
        let (mut bench, way) = random_bench("cone", case);
        for poses in way {
            let counts = bench.step(&poses);
            n_slipping += counts.n_slipping;
            n_sticking += counts.n_sticking;
            for (taxel, force) in bench.state.force3().iter().enumerate() {
                let most = bench.state.shears().at(taxel).friction * force.z;
                let friction = bench.state.friction(taxel).length();
                assert!(friction <= most * (1.0 + 1e-14), "{friction} of {most}");
                let is_free = bench.state.contact_modes()[taxel] == ContactMode::Free;
                assert_eq!(is_free, *force == DVec3::ZERO);
                assert_eq!(is_free, bench.found.deflections[taxel] == 0.0);
            }
        }
    }
    assert!(
        n_slipping > 5_000 && n_sticking > 5_000,
        "{n_slipping} {n_sticking}"
    );
}

#[test]
fn readings_of_all_taxels_add_up_to_what_the_objects_feel() {
    for case in 0..60 {
        let (mut bench, way) = random_bench("sum", case);
        for poses in way {
            bench.step(&poses);
            let (mut on_patch, mut size) = (DVec3::ZERO, 0.0);
            for contact in bench.found.contacts.iter().filter(|c| !c.is_grazing()) {
                let force = bench.state.force3()[contact.taxel];
                let frame = bench.skin.layout().frame(contact.taxel);
                on_patch += frame * DVec3::new(force.x, force.y, -force.z);
                size += force.length();
            }
            let contacts = bench.found.contacts.iter();
            let load = bench
                .state
                .load(&bench.skin, contacts.filter(|c| !c.is_grazing()));
            assert!((load.on_object.force + on_patch).length() <= 1e-12 * size);
        }
    }
}

#[test]
fn a_straight_way_in_one_step_is_the_same_in_many() {
    // The path is not parallel to the initial displacement: a first step goes sideways.
    for (aside, along) in [(0.0, 1e-4), (0.9e-3, 2e-3), (2e-3, 1e-3), (1e-3, 20e-3)] {
        let place = |x: f64, y: f64| DVec3::new(x, y, -TAXEL.radius - 1e-3);
        let displacements = |n: u32| {
            let plate = block(DVec3::new(0.2, 0.2, 0.01));
            let mut bench = Bench::new(grid(8, 8, 3e-3), vec![plate], Shears::Equal(SHEAR));
            bench.slide_to(place(0.0, 0.0));
            bench.slide_to(place(0.0, aside));
            for k in 1..=n {
                bench.slide_to(place(along * f64::from(k) / f64::from(n), aside));
            }
            bench.displacements()
        };
        let once = displacements(1);
        assert!(once[0].length() > 0.0);
        for n in [2, 30] {
            for (a, b) in once.iter().zip(displacements(n)) {
                assert!(a.distance(b) < 1e-13 * a.length(), "{n} steps: {a} {b}");
            }
        }
    }
}

#[test]
fn where_the_normal_force_changes_finer_steps_tend_to_one_result() {
    let friction = |n: u32| {
        let mut bench = Bench::new(grid(12, 12, 2e-3), vec![ball(0.03)], Shears::Equal(SHEAR));
        bench.slide_to(DVec3::new(0.0, 0.0, 0.03));
        for k in 1..=n {
            let part = f64::from(k) / f64::from(n);
            bench.slide_to(DVec3::new(3e-4 * part, 1e-4 * part, 0.03 - 2e-3 * part));
        }
        bench.load().friction.force
    };
    let finest = friction(1024);
    let errors = [2, 8, 32].map(|n| (friction(n) - finest).length() / finest.length());
    assert!(errors[0] > 1e-3 && errors[0] < 0.3, "{errors:?}");
    assert!(errors.windows(2).all(|e| e[1] < 0.5 * e[0]), "{errors:?}");
}

#[test]
fn a_pressed_block_sticks_to_its_springs_and_then_slides_with_mu_n() {
    let skin = grid(10, 10, 3e-3);
    let objects = vec![block(DVec3::new(0.2, 0.2, 0.01))];
    let above = Pose::from_translation(0.01 * DVec3::Z);
    let weight = 12.0;
    let travel = pressed(Press::new(&skin, &objects, &[above], Until::Force(weight))).travel();
    let mut bench = Bench::new(skin, objects, Shears::Equal(SHEAR));
    let n = bench.skin.n_taxels() as f64;
    let onset = SHEAR.friction * weight / (SHEAR.stiffness * n);
    for k in 0..40 {
        let way = 0.05 * f64::from(k) * onset;
        let counts = bench.slide_to(DVec3::new(way, 0.0, above.translation.z - travel));
        let drag = -bench.load().friction.force;
        let textbook = (SHEAR.stiffness * n * way).min(SHEAR.friction * weight);
        assert!((drag.x - textbook).abs() < 1e-9, "{k}: {drag} {textbook}");
        assert!(drag.y.abs() < 1e-9 && drag.z.abs() < 1e-9);
        // Exactly at the onset of slip either result is valid.
        if k != 20 {
            assert_eq!(counts.n_slipping == 100, k > 20, "{k}: {counts:?}");
            assert_eq!(counts.n_sticking == 100, k < 20);
        }
    }
}

/// On a foundation of springs a ball's deflection is a paraboloid of depth d. The slip displacement is therefore u* (1 − r²/a²) at the distance r, with u* = μ
/// k d / k_t. If the ball is dragged by u < u*, the force is `F = μ N (1 − (1 − u/u*)²)`, and the outer ring slips first.
#[test]
fn under_a_dragged_ball_the_outer_taxels_slip_first_and_the_force_is_the_textbooks() {
    let shear = Shear {
        stiffness: 4000.0,
        friction: 0.1,
    };
    let (radius, depth) = (0.1, 1e-3);
    let mut bench = Bench::new(
        grid(80, 80, 0.4e-3),
        vec![ball(radius)],
        Shears::Equal(shear),
    );
    let height = radius + TAXEL.radius - depth;
    bench.slide_to(height * DVec3::Z);
    let weight = spring_load(&bench.skin, &bench.found.contacts).spring_force;
    let onset = shear.friction * TAXEL.stiffness * depth / shear.stiffness;
    let mut n_before = 0;
    for k in 1..=24 {
        let share = 0.05 * f64::from(k);
        let counts = bench.slide_to(DVec3::new(share * onset, 0.0, height));
        let textbook = shear.friction * weight * (1.0 - (1.0 - share).max(0.0).powi(2));
        let drag = -bench.load().friction.force.x;
        assert!(
            (drag - textbook).abs() < 5e-3 * textbook,
            "{k}: {drag} {textbook}"
        );
        assert!(
            counts.n_slipping >= n_before,
            "a ring that has slipped goes on"
        );
        n_before = counts.n_slipping;
        let from_middle = |grip: ContactMode| {
            let taxels = bench.state.contact_modes().iter().enumerate();
            let of_grip = taxels.filter(move |(_, g)| **g == grip);
            let centers = bench.skin.layout().centers();
            of_grip.map(|(taxel, _)| centers[taxel].length())
        };
        let innermost_slip = from_middle(ContactMode::Slip).fold(f64::INFINITY, f64::min);
        let outermost_stick = from_middle(ContactMode::Stick).fold(0.0, f64::max);
        // The motion of the ball itself, a few micrometres, moves the ring by the same distance.
        assert!(outermost_stick < innermost_slip + 20e-6, "{k}");
        // The deepest taxel slips last, at the onset, up to its distance from the ball's middle.
        if k != 20 {
            assert_eq!(counts.n_sticking == 0, k > 20, "{k}: {counts:?}");
        }
    }
}

#[test]
fn on_closed_ways_friction_only_takes_energy() {
    let mut n_lossy = 0;
    for case in 0..60 {
        let (mut bench, mut way) = random_bench("energy", case);
        // Without rotations, the work of an object is the work of one force along one motion.
        let rotations = way[0].map(|pose| pose.rotation);
        for poses in &mut way {
            poses[0].rotation = rotations[0];
            poses[1].rotation = rotations[1];
        }
        way.push(way[0]);
        let mut work = 0.0;
        let mut scale = 0.0;
        let mut last = way[0];
        for poses in way {
            bench.step(&poses);
            for object in 0..2 {
                let contacts = bench.found.contacts.iter();
                let of_object = contacts.filter(|c| c.object == object);
                let force = bench.state.load(&bench.skin, of_object).friction.force;
                let motion = poses[object].translation - last[object].translation;
                work += force.dot(motion);
                scale += force.length() * motion.length();
            }
            last = poses;
        }
        assert!(work <= 1e-12 * scale, "case {case}: {work} of {scale}");
        n_lossy += usize::from(work < -0.05 * scale);
    }
    assert!(n_lossy > 20, "{n_lossy}");
}

#[test]
fn sliding_the_other_way_gives_mirrored_forces() {
    let slid = |sign: f64| {
        let mut bench = Bench::new(grid(16, 16, 2e-3), vec![ball(0.03)], Shears::Equal(SHEAR));
        for k in 0..10 {
            let x = sign * 3e-4 * f64::from(k);
            bench.slide_to(DVec3::new(x, 1e-4 * f64::from(k), 0.029));
        }
        bench.state.force3().to_vec()
    };
    let (right, left) = (slid(1.0), slid(-1.0));
    for row in 0..16 {
        for column in 0..16 {
            let mirrored = left[row * 16 + 15 - column];
            let expected = DVec3::new(-mirrored.x, mirrored.y, mirrored.z);
            assert!(right[row * 16 + column].distance(expected) < 1e-12);
        }
    }
    assert!(right.iter().map(|f| f.x).sum::<f64>() > 0.1);
}

#[test]
fn a_taxel_that_is_left_or_touched_by_another_object_forgets_its_shear() {
    let pair = vec![ball(0.03), ball(0.03)];
    let mut bench = Bench::new(one_taxel(), pair, Shears::Equal(SHEAR));
    let on = |x: f64| Pose::from_translation(DVec3::new(x, 0.0, 0.029));
    let off = Pose::from_translation(DVec3::new(0.0, 0.0, 0.05));
    bench.step(&[on(0.0), off]);
    bench.step(&[on(1e-4), off]);
    assert!((bench.state.displacement(0).x - 1e-4).abs() < 1e-15);
    bench.step(&[off, off]);
    assert_eq!(bench.state.force3(), [DVec3::ZERO]);
    assert_eq!(bench.state.contact_modes(), [ContactMode::Free]);
    bench.step(&[on(2e-4), off]);
    assert_eq!(bench.state.displacement(0), DVec2::ZERO);
    bench.step(&[on(3e-4), off]);
    assert!((bench.state.displacement(0).x - 1e-4).abs() < 1e-15);
    bench.step(&[off, on(0.0)]);
    assert_eq!(bench.state.displacement(0), DVec2::ZERO);
}

#[test]
fn a_ball_that_rolls_drags_nothing_and_one_that_spins_in_place_neither() {
    let (radius, angle) = (0.03, 0.02_f64);
    let high = radius + TAXEL.radius - 1e-3;
    let mut bench = Bench::new(one_taxel(), vec![ball(radius)], Shears::Equal(SHEAR));
    // The taxel stays under the ball's middle from −angle/2 to angle/2 while the ball rolls on it.
    let rolled = |a: f64| Pose::new(DQuat::from_rotation_y(a), DVec3::new(radius * a, 0.0, high));
    bench.step(&[rolled(-0.5 * angle)]);
    bench.step(&[rolled(0.5 * angle)]);
    let drag = bench.state.displacement(0).length();
    assert!(drag < radius * angle.powi(3), "{drag}");
    let mut bench = Bench::new(one_taxel(), vec![ball(radius)], Shears::Equal(SHEAR));
    bench.slide_to(high * DVec3::Z);
    bench.step(&[Pose::new(DQuat::from_rotation_z(1.0), high * DVec3::Z)]);
    assert!(bench.state.displacement(0).length() < 1e-15);
    // A plate that rotates about a pivot drags a taxel beside the pivot along the tangent, neither inwards nor outwards.
    let beside = Layout::new(vec![5e-3 * DVec3::X], vec![DVec3::Z]).unwrap();
    let plate = vec![block(DVec3::new(0.1, 0.1, 0.01))];
    let mut bench = Bench::new(skin(beside, TAXEL), plate, Shears::Equal(SHEAR));
    for turn in [0.0, 0.02] {
        let low = -TAXEL.radius - 1e-3;
        bench.step(&[Pose::new(DQuat::from_rotation_z(turn), low * DVec3::Z)]);
    }
    let dragged = bench.state.displacement(0);
    assert!(dragged.x.abs() < 1e-15, "{dragged}");
    assert!(
        (dragged.y - 5e-3 * 0.02_f64.sin()).abs() < 1e-15,
        "{dragged}"
    );
}

#[test]
fn a_damped_taxel_grips_with_all_that_presses_it() {
    for (damping, faster) in [(0.0, 1.0), (0.5, 1.5)] {
        let taxel = Taxel { damping, ..TAXEL };
        let skin = skin(Layout::hexagonal(6, 6, 2e-3).unwrap(), taxel);
        let objects = vec![block(DVec3::new(0.2, 0.2, 0.01))];
        let mut state = FrictionState::at_rest(&skin, Shears::Equal(SHEAR)).unwrap();
        let mut damper = DamperState::at_rest(skin.n_taxels());
        let mut found = touched(&skin, &[], &[]);
        for k in 0..5 {
            let step = f64::from(k);
            let place = DVec3::new(5e-3 * step, 0.0, -1e-3 - 0.5e-3 * step);
            let poses = [Pose::from_translation(place)];
            found = touched(&skin, &objects, &poses);
            damper.step(skin.taxels(), 1e-3, &found.deflections);
            let normal = NormalForce::Dampers(&damper);
            state.step(&skin, &found.contacts, &poses, normal);
        }
        let springs = spring_load(&skin, &found.contacts).spring_force;
        let friction = state.load(&skin, &found.contacts).friction.force.length();
        let all: f64 = damper.force.iter().sum();
        assert!((friction - SHEAR.friction * all).abs() < 1e-9 * all);
        assert!(all >= faster * springs && (damping > 0.0 || all == springs));
    }
}

#[test]
fn what_cannot_be_a_shear_spring_is_refused_with_its_taxel() {
    let message = |shears| {
        let state = FrictionState::at_rest(&grid(2, 2, 2e-3), shears);
        state.unwrap_err().to_string()
    };
    let soft = Shear {
        stiffness: 0.0,
        ..SHEAR
    };
    let sticky = Shear {
        friction: f64::NAN,
        ..SHEAR
    };
    assert_eq!(
        message(Shears::Equal(soft)),
        "skin patch patch, shear stiffness: 0 N/m; a finite positive number"
    );
    assert_eq!(
        message(Shears::Each(vec![SHEAR, SHEAR, sticky, SHEAR])),
        "skin patch patch, taxel 3, friction coefficient: NaN; zero or a positive number"
    );
    assert_eq!(
        message(Shears::Each(vec![SHEAR])),
        "skin patch patch: 1 taxels for 4 places; one taxel a place, or one for all"
    );
}
