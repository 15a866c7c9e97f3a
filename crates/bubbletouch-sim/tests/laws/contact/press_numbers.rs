//! Every public press refuses numbers that are no poses, depths, travels, forces or directions, and outputs of another size. Each refusal is one sentence that
//! contains the number.

use bubbletouch_sim::contact::equilibrium::{EquilibriumSolver, FreeObject, Ground, PlacedSkin};
use bubbletouch_sim::contact::{FrictionState, MovedObject, Press, Row, Until, Workspace};
use bubbletouch_sim::dynamics::{Drive, System};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{LengthUnit, TriangleMesh};
use bubbletouch_sim::objects::{MeshModel, Model, SphereClusters};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::SensorError;
use bubbletouch_sim::whole_body::{BodyState, WholeBody};
use bubbletouch_sim::world::{Grid, Layout, Patch, Shear, Shears, Taxels};
use bubbletouch_sim::{Error, Result};
use glam::{DQuat, DVec3};

use crate::scenes;
use crate::scenes::TAXEL;

/// Use of a public press with an object at a pose, and with the number that ends the press; presses without such a number ignore the number.
struct Case {
    name: &'static str,
    /// Allowed numbers; `None` if the press has no number.
    allowed: Option<fn(f64) -> bool>,
    run: fn(&Patch, &[Model], &[Pose], f64) -> Result<()>,
}

const NOT_NEGATIVE: Option<fn(f64) -> bool> = Some(|number| number >= 0.0);
const POSITIVE: Option<fn(f64) -> bool> = Some(|number| number > 0.0);
const ANY: Option<fn(f64) -> bool> = Some(|_| true);

fn run(press: Press) -> Result<()> {
    press.run(&mut Workspace::new()).map(drop)
}

const CASES: &[Case] = &[
    Case {
        name: "at a pose",
        allowed: None,
        run: |patch, objects, poses, _| run(Press::new(patch, objects, poses, Until::Pose)),
    },
    Case {
        name: "at a pose, with contacts",
        allowed: None,
        run: |patch, objects, poses, _| {
            run(Press::new(patch, objects, poses, Until::Pose).with_contacts())
        },
    },
    Case {
        name: "to a depth",
        allowed: NOT_NEGATIVE,
        run: |patch, objects, poses, number| {
            run(Press::new(patch, objects, poses, Until::Depth(number)))
        },
    },
    Case {
        name: "to a depth, with contacts",
        allowed: NOT_NEGATIVE,
        run: |patch, objects, poses, number| {
            run(Press::new(patch, objects, poses, Until::Depth(number)).with_contacts())
        },
    },
    Case {
        name: "to a travel",
        allowed: ANY,
        run: |patch, objects, poses, number| {
            run(Press::new(patch, objects, poses, Until::Travel(number)))
        },
    },
    Case {
        name: "to a travel, with contacts",
        allowed: ANY,
        run: |patch, objects, poses, number| {
            run(Press::new(patch, objects, poses, Until::Travel(number)).with_contacts())
        },
    },
    Case {
        name: "to a force",
        allowed: POSITIVE,
        run: |patch, objects, poses, number| {
            run(Press::new(patch, objects, poses, Until::Force(number)))
        },
    },
    Case {
        name: "to a force, with contacts",
        allowed: POSITIVE,
        run: |patch, objects, poses, number| {
            run(Press::new(patch, objects, poses, Until::Force(number)).with_contacts())
        },
    },
    Case {
        name: "written",
        allowed: NOT_NEGATIVE,
        run: |patch, objects, poses, number| {
            let press = Press::new(patch, objects, poses, Until::Depth(number));
            let mut row = vec![0.0; patch.n_taxels()];
            press
                .write(Row::Double(&mut row), &mut Workspace::new())
                .map(drop)
        },
    },
    Case {
        name: "written onto zeros",
        allowed: POSITIVE,
        run: |patch, objects, poses, number| {
            let press = Press::new(patch, objects, poses, Until::Force(number));
            let mut row = vec![0.0; patch.n_taxels()];
            press
                .write_onto_zeros(Row::Single(&mut row), &mut Workspace::new())
                .map(drop)
        },
    },
    Case {
        name: "slide from a depth",
        allowed: NOT_NEGATIVE,
        run: |patch, objects, poses, number| {
            let press = Press::new(patch, objects, poses, Until::Depth(number));
            press
                .slide(1e-3 * DVec3::X, None, &mut Workspace::new())
                .map(drop)
        },
    },
    Case {
        name: "slide along a line",
        allowed: ANY,
        run: |patch, objects, poses, number| {
            let press = Press::new(patch, objects, poses, Until::Depth(1e-3));
            press
                .slide(number * DVec3::X, None, &mut Workspace::new())
                .map(drop)
        },
    },
    Case {
        name: "MovedObject::hold",
        allowed: NOT_NEGATIVE,
        run: |patch, objects, poses, force| {
            let moved = MovedObject {
                patch,
                objects,
                moving: None,
                direction: -DVec3::Z,
            };
            let travels = [-1e-3, 0.0, 1e-3];
            let held = moved.hold(&mut poses.to_vec(), travels, force, &mut Workspace::new());
            held.map(drop)
        },
    },
    Case {
        name: "MovedObject::hold within travels",
        allowed: ANY,
        run: |patch, objects, poses, travel| {
            let moved = MovedObject {
                patch,
                objects,
                moving: Some(0),
                direction: -DVec3::Z,
            };
            let travels = [0.0, 0.0, travel];
            let held = moved.hold(&mut poses.to_vec(), travels, 1.0, &mut Workspace::new());
            held.map(drop)
        },
    },
    Case {
        name: "BodyState::press",
        allowed: POSITIVE,
        run: |patch, objects, poses, dt| {
            let body = WholeBody::new(std::slice::from_ref(patch))?;
            let clusters = objects.iter().filter_map(Model::spheres);
            let clusters: Vec<_> = clusters.map(SphereClusters::new).collect();
            BodyState::at_rest(&body)
                .press(&body, &clusters, poses, dt)
                .map(drop)
        },
    },
    Case {
        name: "BodyState::place",
        allowed: None,
        run: |patch, _, poses, _| {
            let body = WholeBody::new(std::slice::from_ref(patch))?;
            BodyState::at_rest(&body).place(&body, poses)
        },
    },
    Case {
        name: "EquilibriumSolver::solve_all",
        allowed: None,
        run: |patch, objects, poses, _| {
            let free = objects.iter().filter_map(Model::spheres);
            let free = free.map(|union| FreeObject::new(union, 0.1, DVec3::ZERO));
            let free = free.collect::<Result<Vec<_>>>()?;
            let ground = Ground {
                skins: vec![PlacedSkin::new(patch, Pose::IDENTITY)],
                ..Ground::default()
            };
            let solved = EquilibriumSolver::new().solve_all(&free, &ground, -9.8 * DVec3::Z, poses);
            solved.map(drop)
        },
    },
];

fn patches() -> [Patch; 2] {
    let grid = Grid {
        nx: 8,
        ny: 8,
        pitch: 2e-3,
    };
    let cap = Layout::sphere_cap(8e-3, 1.0, 2e-3).unwrap();
    [
        Patch::grid(grid, TAXEL).unwrap(),
        Patch::new("fingertip", cap, Taxels::Equal(TAXEL)).unwrap(),
    ]
}

fn ball() -> Model {
    scenes::ball(0.01).into()
}

/// Pose at which both patches press both objects.
const PLACE: Pose = Pose {
    rotation: DQuat::IDENTITY,
    translation: DVec3::new(0.0, 0.0, 0.018),
};

/// Requires that the error is about input, and that its sentence is one line with the number.
fn check(name: &str, number: f64, pressed: Result<()>) {
    let Err(error @ Error::Input { .. }) = pressed else {
        panic!("{name} with {number}: {pressed:?}");
    };
    let sentence = error.to_string();
    assert_eq!(sentence.matches(';').count(), 1, "{name}: {sentence}");
    assert!(!sentence.contains('\n'), "{name}: {sentence}");
    assert!(
        sentence.contains(&number.to_string()),
        "{name} with {number}: {sentence}"
    );
}

#[test]
fn no_press_accepts_a_number_that_is_none() {
    let mesh = TriangleMesh::cuboid("box", DVec3::splat(0.02)).unwrap();
    let objects = [ball(), MeshModel::new(mesh).into()];
    let mut n_refused = 0;
    for patch in &patches() {
        for object in &objects {
            for press in CASES {
                // Whole bodies and equilibria press spheres only.
                let is_of_spheres = ["BodyState", "Equilibrium"];
                if object.spheres().is_none()
                    && is_of_spheres
                        .iter()
                        .any(|name| press.name.starts_with(name))
                {
                    continue;
                }
                let run = |pose: Pose, number| {
                    (press.run)(patch, std::slice::from_ref(object), &[pose], number)
                };
                if press.name != "to a force, with contacts" || object.spheres().is_some() {
                    let allowed = run(PLACE, 1e-3);
                    assert!(allowed.is_ok(), "{}: {allowed:?}", press.name);
                }
                for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                        let at = PLACE.translation + number * axis;
                        let moved = Pose::new(DQuat::IDENTITY, at);
                        check(press.name, number, run(moved, 1e-3));
                    }
                    let turned = DQuat::from_xyzw(number, 0.0, 0.0, 1.0);
                    check(
                        press.name,
                        number,
                        run(Pose::new(turned, PLACE.translation), 1e-3),
                    );
                    if press.allowed.is_some() {
                        check(press.name, number, run(PLACE, number));
                    }
                    n_refused += 1;
                }
                for length in [0.0, 0.5, 1.01] {
                    let turned = DQuat::from_xyzw(0.0, 0.0, 0.0, length);
                    check(
                        press.name,
                        length,
                        run(Pose::new(turned, PLACE.translation), 1e-3),
                    );
                }
                for number in [-1e-3, 0.0] {
                    if press.allowed.is_some_and(|is_allowed| !is_allowed(number)) {
                        check(press.name, number, run(PLACE, number));
                    }
                }
                let several = (press.run)(patch, std::slice::from_ref(object), &[PLACE; 3], 1e-3);
                check(press.name, 3.0, several);
            }
        }
    }
    assert_eq!(n_refused, 3 * 2 * (2 * CASES.len() - 3));
}

#[test]
fn an_output_of_another_size_is_refused() {
    for patch in &patches() {
        let (objects, goal) = ([ball()], Until::Depth(1e-3));
        for n in [0, patch.n_taxels() - 1, patch.n_taxels() + 1] {
            let press = Press::new(patch, &objects, &[PLACE], goal);
            let (mut double, mut single) = (vec![0.0; n], vec![0.0; n]);
            let written = press.write(Row::Double(&mut double), &mut Workspace::new());
            check("output", n as f64, written.map(drop));
            let written = press.write_onto_zeros(Row::Single(&mut single), &mut Workspace::new());
            check("output", n as f64, written.map(drop));
        }
        let [other] = patches()
            .into_iter()
            .filter(|other| other.name() != patch.name())
            .collect::<Vec<_>>()
            .try_into()
            .unwrap();
        let shear = Shears::Equal(Shear {
            stiffness: 100.0,
            friction: 0.5,
        });
        let mut friction = FrictionState::at_rest(&other, shear).unwrap();
        let press = Press::new(patch, &objects, &[PLACE], goal);
        let slid = press.slide(DVec3::ZERO, Some(&mut friction), &mut Workspace::new());
        check("friction", other.n_taxels() as f64, slid.map(drop));
    }
}

#[test]
fn a_direction_has_length_one() {
    let [patch, _] = patches();
    let objects = [ball()];
    for (direction, number) in [
        (DVec3::ZERO, 0.0),
        (2.0 * DVec3::X, 2.0),
        (f64::NAN * DVec3::X, f64::NAN),
        (f64::INFINITY * DVec3::X, f64::INFINITY),
    ] {
        let press = Press::new(&patch, &objects, &[PLACE], Until::Depth(1e-3)).along(direction);
        check("press", number, press.run(&mut Workspace::new()).map(drop));
        let moved = MovedObject {
            patch: &patch,
            objects: &objects,
            moving: None,
            direction,
        };
        let held = moved.hold(&mut [PLACE], [0.0; 3], 1.0, &mut Workspace::new());
        check("MovedObject", number, held.map(drop));
    }
    let moved = MovedObject {
        patch: &patch,
        objects: &objects,
        moving: Some(7),
        direction: DVec3::Z,
    };
    let held = moved.hold(&mut [PLACE], [0.0; 3], 1.0, &mut Workspace::new());
    check("moving object", 7.0, held.map(drop));
}

#[test]
fn a_guided_object_has_a_finite_pose_and_travel() {
    let ([patch, _], object) = (patches(), ball());
    for number in [f64::NAN, f64::INFINITY] {
        let system = |travel: f64, at: DVec3| {
            let drive = Drive::Free {
                mass: 0.1,
                gravity: 9.81,
                travel,
            };
            let pose = Pose::from_translation(at);
            System::new(&patch, 1e-3, &object, pose, drive, 0.01).map(drop)
        };
        assert!(system(0.0, PLACE.translation).is_ok());
        check("travel", number, system(number, PLACE.translation));
        check("pose", number, system(0.0, number * DVec3::Z));
    }
}

#[test]
fn more_strengths_than_a_sensor_error_has_are_refused() {
    for (error, given) in [
        (SensorError::Gain, &[0.1, 0.2][..]),
        (SensorError::Faults, &[0.1, 0.1, 0.1]),
    ] {
        let step = error.step(given, Seed::new(1));
        check("sensor error", given.len() as f64, step.map(drop));
    }
}

#[test]
fn a_mesh_of_twenty_metres_needs_its_unit() {
    let corners = || [DVec3::ZERO, 20.0 * DVec3::X, 20.0 * DVec3::Y].to_vec();
    let metres = TriangleMesh::new("die", corners(), vec![[0, 1, 2]]);
    let error = metres.unwrap_err().to_string();
    assert!(
        error.starts_with("die: 20 m wide") && error.contains("in mm it would be 20 mm"),
        "{error}"
    );
    let unit = LengthUnit::Millimetre;
    let die = TriangleMesh::in_unit("die", unit, corners(), vec![[0, 1, 2]]).unwrap();
    assert_eq!(die.bounds().size(), DVec3::new(0.02, 0.02, 0.0));
}
