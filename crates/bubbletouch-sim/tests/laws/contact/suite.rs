//! Laws of contact for all press functions on shared random scenes: layouts of all families, spheres from a micrometre to a metre, and meshes. Contacts occur
//! at edges, at the stroke, grazing, and behind the substrate.

use crate::counting::allocations;
use crate::mesh_shapes::{cuboid, icosphere};
use crate::random_scenes::{TAXEL, direction, random_pose, rng};
use bubbletouch_sim::contact::{Press, Until, Workspace, spring_load, stopping_height};
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Triangle, TriangleMesh};
use bubbletouch_sim::objects::{MeshModel, Model, Sphere, SphereClusters, SphereUnion};
use bubbletouch_sim::whole_body::{BodyState, WholeBody};
use bubbletouch_sim::world::{Dome, Extrusion, Grid, Layout, Patch, Taxel, Taxels};
use glam::{DQuat, DVec2, DVec3};
use rand::Rng;

const N_CASES: u64 = 180;
const N_FAMILIES: u64 = 9;

/// Patch and objects. The objects are given in the patch frame (`shapes`), and as models with poses (`models`).
struct Scene {
    patch: Patch,
    shapes: Vec<Shape>,
    models: Vec<Model>,
    poses: Vec<Pose>,
}

#[derive(Clone)]
enum Shape {
    Spheres(Vec<Sphere>),
    Mesh(TriangleMesh),
}

impl Shape {
    fn model(&self, pose: &Pose) -> Model {
        match self {
            Self::Spheres(spheres) => {
                let union = SphereUnion::new(spheres.clone()).unwrap();
                union.moved(&pose.inverse()).into()
            }
            Self::Mesh(mesh) => MeshModel::new(mesh.moved(&pose.inverse())).into(),
        }
    }
}

/// Returns a layout some centimetres large; the families of layouts take turns.
fn layout(rng: &mut impl Rng, family: u64) -> Layout {
    let (pitch, size) = (rng.gen_range(1.5e-3..5e-3), rng.gen_range(0.015..0.03));
    let grid = Grid {
        nx: 12,
        ny: 9,
        pitch,
    };
    let made = match family {
        0 => Layout::grid(&grid),
        1 => Layout::hexagonal(9, 11, pitch),
        2 => Layout::disc(size, pitch),
        3 => Layout::annulus(0.4 * size, size, pitch),
        4 => Layout::cylinder(size, 2.0 * size, rng.gen_range(0.5..6.2), pitch),
        5 => Layout::sphere_cap(size, rng.gen_range(0.5..3.0), pitch),
        6 => Dome::new(
            size,
            rng.gen_range(0.5..3.0),
            rng.gen_range(1.0..6.2),
            pitch,
        )
        .map(Layout::from),
        7 => Extrusion::grid(&grid).map(Layout::from),
        _ => {
            let centers: Vec<DVec3> = (0..150).map(|_| size * direction(rng)).collect();
            let axes = centers.iter().map(|_| direction(rng)).collect();
            Layout::new(centers, axes)
        }
    };
    made.unwrap()
}

impl Scene {
    fn random(name: &str, case: u64) -> Self {
        let mut rng = rng(name, case);
        let layout = layout(&mut rng, case % N_FAMILIES);
        let mut one = || Taxel {
            radius: rng.gen_range(0.3e-3..2e-3),
            stiffness: rng.gen_range(50.0..500.0),
            damping: 0.0,
            stroke: rng.gen_range(1e-3..6e-3),
        };
        let taxels = match case / N_FAMILIES % 3 {
            0 => Taxels::Each((0..layout.n_taxels()).map(|_| one()).collect()),
            _ => Taxels::Equal(one()),
        };
        let patch = Patch::new("skin", layout, taxels).unwrap();
        let shapes = (0..rng.gen_range(1..4)).map(|_| shape(&mut rng, &patch));
        let shapes = shapes.collect();
        Self::new(patch, shapes, &mut rng)
    }

    fn new(patch: Patch, shapes: Vec<Shape>, rng: &mut impl Rng) -> Self {
        let poses: Vec<Pose> = shapes.iter().map(|_| random_pose(rng, 0.3)).collect();
        let models = shapes.iter().zip(&poses);
        Self {
            models: models.map(|(shape, pose)| shape.model(pose)).collect(),
            patch,
            shapes,
            poses,
        }
    }
}

/// Returns spheres or a mesh near the taxels of a patch.
fn shape(rng: &mut impl Rng, patch: &Patch) -> Shape {
    if rng.gen_bool(0.7) {
        let spheres = (0..14).map(|k| {
            let radius = 10f64.powi(-6 + k % 7);
            let center = near_a_taxel(rng, patch, radius);
            Sphere { center, radius }
        });
        return Shape::Spheres(spheres.collect());
    }
    let middle = near_a_taxel(rng, patch, 0.012);
    let mesh = match rng.gen_bool(0.5) {
        true => cuboid(DVec3::new(0.012, rng.gen_range(1e-3..0.02), 0.01)),
        false => icosphere(0.012, 1),
    };
    let turn = DQuat::from_scaled_axis(rng.gen_range(0.0..3.0) * direction(rng));
    Shape::Mesh(mesh.moved(&Pose::new(turn, middle)))
}

/// Returns the centre of a ball that touches a taxel: lightly, at its stroke, past it, from the side, or from behind.
fn near_a_taxel(rng: &mut impl Rng, patch: &Patch, radius: f64) -> DVec3 {
    let taxel = rng.gen_range(0..patch.n_taxels());
    let (place, axis) = (
        patch.layout().centers()[taxel],
        patch.layout().axes()[taxel],
    );
    let own = patch.taxels().at(taxel);
    let height = match rng.gen_range(0..8) {
        0 => own.radius - own.stroke,
        1 => -own.stroke - own.radius - radius - 1e-3,
        2 => -rng.gen_range(0.0..radius),
        _ => rng.gen_range(-own.stroke..own.radius),
    };
    let tilted = (axis + rng.gen_range(0.0..1.0) * direction(rng)).normalize();
    place + (radius + height) * tilted
}

/// Function that presses a patch on objects at their poses and returns the deflections; `None` for unsupported scenes.
type Perturbation = fn(&Scene) -> Option<Vec<f64>>;

const WAYS: [(&str, Perturbation); 4] = [
    ("at a pose", |scene| {
        let mut workspace = Workspace::new();
        Press::new(&scene.patch, &scene.models, &scene.poses, Until::Pose)
            .run(&mut workspace)
            .unwrap();
        Some(workspace.deflections().to_vec())
    }),
    ("with contacts", |scene| {
        let mut workspace = Workspace::new();
        Press::new(&scene.patch, &scene.models, &scene.poses, Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap();
        Some(workspace.deflections().to_vec())
    }),
    ("taxels one by one", |scene| {
        let places = scene.patch.layout();
        let loose = Layout::new(places.centers().to_vec(), places.axes().to_vec()).unwrap();
        let loose = Patch::new("loose", loose, scene.patch.taxels().clone()).unwrap();
        let mut workspace = Workspace::new();
        Press::new(&loose, &scene.models, &scene.poses, Until::Pose)
            .run(&mut workspace)
            .unwrap();
        Some(workspace.deflections().to_vec())
    }),
    ("as a body", |scene| {
        let clusters = scene.models.iter();
        let clusters: Option<Vec<_>> = clusters
            .map(|model| Some(SphereClusters::new(model.spheres()?)))
            .collect();
        let clusters = clusters?;
        let body = WholeBody::new(std::slice::from_ref(&scene.patch)).ok()?;
        let mut state = BodyState::at_rest(&body);
        state.press(&body, &clusters, &scene.poses, 1.0).unwrap();
        Some(state.deflections(0).to_vec())
    }),
];

/// Returns the deflection of a taxel by all parts, and the tolerance of this value (metres). Parts behind the substrate count only if `behind_counts`.
fn by_every_part(scene: &Scene, taxel: usize, behind_counts: bool) -> (f64, f64) {
    let (place, axis) = (
        scene.patch.layout().centers()[taxel],
        scene.patch.layout().axes()[taxel],
    );
    let own = scene.patch.taxels().at(taxel);
    let behind = match behind_counts {
        true => f64::NEG_INFINITY,
        false => -own.stroke - own.radius,
    };
    let (mut needed, mut tolerance) = (0.0_f64, 1e-12);
    for shape in &scene.shapes {
        match shape {
            Shape::Spheres(spheres) => {
                for &Sphere { center, radius } in spheres {
                    let (away, reach) = (center - place, own.radius + radius);
                    let height = away.dot(axis);
                    let left = reach * reach - (away - height * axis).length_squared();
                    // Rounding decides whether a sphere touches along a flank and at the substrate.
                    let top = height + left.max(0.0).sqrt();
                    if left.abs() < 1e-9 * reach * reach || (top - behind).abs() < 1e-9 * reach {
                        tolerance = f64::INFINITY;
                    } else if left > 0.0 && top >= behind {
                        needed = needed.max(left.sqrt() - height);
                        let size = reach * reach / left.sqrt() + center.length() + 0.3;
                        tolerance = f64::max(tolerance, 8.0 * f64::EPSILON * size);
                    }
                }
            }
            Shape::Mesh(mesh) => {
                needed = needed.max(by_every_triangle(mesh, (place, axis), own, behind));
                tolerance = f64::max(tolerance, 1e-9);
            }
        }
    }
    (needed.min(own.stroke), tolerance)
}

/// Returns the deflection of a taxel by every triangle, computed in the taxel's frame (origin at its centre, z along its axis).
fn by_every_triangle(
    mesh: &TriangleMesh,
    (place, axis): (DVec3, DVec3),
    own: &Taxel,
    behind: f64,
) -> f64 {
    let turn = DQuat::from_rotation_arc(axis, DVec3::Z);
    let placed = mesh.moved(&Pose::new(turn, turn * -place));
    let triangles = (0..placed.n_triangles()).map(|number| placed.triangle(number));
    let triangles: Vec<Triangle> = triangles.collect();
    if behind.is_finite() && is_inside(&triangles, behind) {
        return own.stroke;
    }
    let heights = triangles.iter().filter_map(|triangle| {
        let height = stopping_height(triangle, own.radius, DVec2::ZERO)?;
        // Seen from above, a triangle stops a taxel at the highest position where both touch.
        let mirrored = Triangle(triangle.0.map(|v| DVec3::new(v.x, v.y, -v.z)));
        let highest = -stopping_height(&mirrored, own.radius, DVec2::ZERO)?;
        (highest >= behind).then_some(height)
    });
    -heights.fold(0.0, f64::min)
}

/// Returns whether the axis enters the mesh behind a height and leaves the mesh ahead of it.
fn is_inside(triangles: &[Triangle], height: f64) -> bool {
    let crossed = triangles.iter().filter_map(|triangle| {
        let along = triangle.crossed_at(DVec3::new(0.0, 0.0, height), DVec3::Z)?;
        Some((along, triangle.normal()?.z))
    });
    let (mut ahead, mut back) = ((f64::INFINITY, 0.0), (f64::NEG_INFINITY, 0.0));
    for (along, rise) in crossed {
        if along >= 0.0 && along < ahead.0 {
            ahead = (along, rise);
        }
        if along <= 0.0 && along > back.0 {
            back = (along, rise);
        }
    }
    ahead.1 > 0.0 && back.1 < 0.0
}

#[test]
fn every_way_pushes_every_taxel_as_far_as_every_part_says() {
    let mut n_touched = [0; WAYS.len()];
    let (mut n_meshes, mut n_edges) = (0, 0);
    for case in 0..N_CASES {
        let scene = Scene::random("parts", case);
        let of_taxel = |taxel| by_every_part(&scene, taxel, false);
        let expected: Vec<_> = (0..scene.patch.n_taxels()).map(of_taxel).collect();
        for (number, (name, way)) in WAYS.iter().enumerate() {
            let Some(found) = way(&scene) else { continue };
            for (taxel, (&found, &(expected, tolerance))) in found.iter().zip(&expected).enumerate()
            {
                n_touched[number] += usize::from(found > 0.0);
                let is_mesh = tolerance == 1e-9;
                n_meshes += usize::from(is_mesh);
                if (found - expected).abs() > tolerance {
                    // The test whether a substrate is in a mesh uses a ray a hundredth of a radius beside the axis.
                    assert!(
                        is_mesh,
                        "{name}, case {case}, taxel {taxel}: {found} for {expected}"
                    );
                    n_edges += 1;
                }
            }
        }
    }
    assert!(n_touched.iter().all(|&n| n > 1_000), "{n_touched:?}");
    assert!(n_edges < n_meshes / 1000, "{n_edges} of {n_meshes}");
}

#[test]
fn a_way_from_the_front_counts_all_and_takes_nothing_away_on_flat_patches() {
    let mut workspace = Workspace::new();
    let (mut n_touched, mut n_checked) = (0, 0);
    for case in (0..N_CASES).filter(|case| matches!(case % N_FAMILIES, 0..4 | 7)) {
        let mut scene = Scene::random("front", case);
        let mut before = vec![0.0; scene.patch.n_taxels()];
        for step in 0..12 {
            let travel = -0.004 + 0.002 * f64::from(step);
            Press::new(
                &scene.patch,
                &scene.models,
                &scene.poses,
                Until::Travel(travel),
            )
            .run(&mut workspace)
            .unwrap();
            let found = workspace.deflections();
            let pairs = found.iter().zip(&before);
            assert!(
                pairs.into_iter().all(|(now, before)| now >= before),
                "case {case}"
            );
            before.copy_from_slice(found);
        }
        // At the present pose the parts are lower by this distance.
        let lower = Pose::from_translation(-0.018 * DVec3::Z);
        for shape in &mut scene.shapes {
            *shape = match shape {
                Shape::Mesh(mesh) => Shape::Mesh(mesh.moved(&lower)),
                Shape::Spheres(spheres) => Shape::Spheres(
                    spheres
                        .iter()
                        .map(|sphere| Sphere {
                            center: lower.transform_point(sphere.center),
                            ..*sphere
                        })
                        .collect(),
                ),
            };
        }
        for (taxel, &found) in before.iter().enumerate() {
            let (expected, tolerance) = by_every_part(&scene, taxel, true);
            let place = format!("case {case}, taxel {taxel}: {found} for {expected}");
            assert!((found - expected).abs() <= tolerance, "{place}");
            n_touched += usize::from(found > 0.0);
            n_checked += usize::from(tolerance < 1e-6);
        }
    }
    assert!(
        n_touched > 3_000 && n_checked > n_touched,
        "{n_touched} of {n_checked}"
    );
}

#[test]
fn a_rigid_motion_of_the_world_changes_nothing() {
    let (mut n_compared, mut n_flanks) = (0, 0);
    for case in 0..N_CASES {
        let scene = Scene::random("motion", case);
        let mut rng = rng("to", case);
        let motion = random_pose(&mut rng, 0.5);
        let moved = scene.shapes.iter().map(|shape| match shape {
            Shape::Mesh(mesh) => Shape::Mesh(mesh.moved(&motion)),
            Shape::Spheres(spheres) => {
                let union = SphereUnion::new(spheres.clone()).unwrap();
                Shape::Spheres(union.moved(&motion).spheres().to_vec())
            }
        });
        let taxels = scene.patch.taxels().clone();
        let patch = Patch::new("moved", scene.patch.layout().moved(&motion), taxels).unwrap();
        let there = Scene::new(patch, moved.collect(), &mut rng);
        for (name, way) in WAYS {
            let (Some(a), Some(b)) = (way(&scene), way(&there)) else {
                continue;
            };
            for (taxel, (a, b)) in a.iter().zip(&b).enumerate() {
                let (_, tolerance) = by_every_part(&scene, taxel, false);
                n_compared += usize::from(*a > 0.0);
                if (a - b).abs() > 4.0 * tolerance {
                    n_flanks += 1;
                    let is_near = tolerance >= 1e-9;
                    assert!(is_near, "{name}, case {case}, taxel {taxel}: {a} {b}");
                }
            }
        }
    }
    assert!(
        n_compared > 10_000 && n_flanks < n_compared / 500,
        "{n_flanks} of {n_compared}"
    );
}

#[test]
fn the_order_of_objects_changes_no_bit() {
    for case in 0..N_CASES {
        let mut scene = Scene::random("order", case);
        let before = WAYS.map(|(_, way)| way(&scene));
        scene.models.reverse();
        scene.poses.reverse();
        for ((name, way), before) in WAYS.iter().zip(before) {
            assert_eq!(way(&scene), before, "{name}, case {case}");
        }
    }
}

#[test]
fn force_and_torque_are_minus_the_gradient_of_the_energy() {
    let mut workspace = Workspace::new();
    let mut n_checked = [0; 2];
    for case in 0..4 * N_CASES {
        let mut rng = rng("energy", case);
        let layout = layout(&mut rng, case % N_FAMILIES);
        let taxel = Taxel {
            stroke: 0.05,
            ..TAXEL
        };
        let patch = Patch::new("skin", layout, taxel).unwrap();
        let number = rng.gen_range(0..patch.n_taxels());
        let (place, axis) = (
            patch.layout().centers()[number],
            patch.layout().axes()[number],
        );
        let radius = rng.gen_range(0.01..0.1);
        let object: Model = match case % 2 {
            0 => {
                let center = DVec3::ZERO;
                SphereUnion::new(vec![Sphere { center, radius }])
                    .unwrap()
                    .into()
            }
            _ => MeshModel::new(icosphere(radius, 2)).into(),
        };
        let objects = [object];
        let pose = Pose::from_translation(place + (radius - 1e-3) * axis);
        let contact = Press::new(&patch, &objects, &[pose], Until::Pose)
            .with_contacts()
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default();
        let parts: Vec<usize> = workspace.contacts().iter().map(|c| c.part).collect();
        let is_grazing = workspace.contacts().iter().any(|c| c.cosine < 0.1);
        if contact.n_touched < 2 || contact.n_saturated > 0 || is_grazing {
            continue;
        }
        let load = spring_load(&patch, workspace.contacts()).on_object;
        // The slope of the energy has kinks between triangles.
        let mut is_smooth = true;
        let mut energy = |motion: Pose| {
            Press::new(&patch, &objects, &[motion.compose(&pose)], Until::Pose)
                .with_contacts()
                .run(&mut workspace)
                .unwrap();
            let by = workspace.contacts().iter().map(|contact| contact.part);
            is_smooth &= by.eq(parts.iter().copied());
            let springs = workspace.deflections().iter();
            springs.map(|d| 0.5 * TAXEL.stiffness * d * d).sum::<f64>()
        };
        let step = 1e-7;
        let mut slopes = Vec::new();
        for along in DVec3::AXES {
            let mut slope = |motion: &dyn Fn(f64) -> Pose| {
                (energy(motion(step)) - energy(motion(-step))) / (2.0 * step)
            };
            let moved = slope(&|s| Pose::from_translation(s * along));
            let turned = slope(&|a| Pose::from_rotation(DQuat::from_scaled_axis(a * along)));
            slopes.push((
                moved + load.force.dot(along),
                turned + load.torque.dot(along),
            ));
        }
        if !is_smooth {
            continue;
        }
        n_checked[(case % 2) as usize] += 1;
        let scale = 1e-5 * load.force.length();
        for (force, torque) in slopes {
            assert!(
                force.abs() < scale && torque.abs() < 0.1 * scale,
                "case {case}: {force} {torque}"
            );
        }
    }
    assert!(n_checked.iter().all(|&n| n > 40), "{n_checked:?}");
}

/// Function that presses an object with a reused workspace and returns the number of touched taxels.
type Repeated = fn(&Patch, &[Model], &[Pose], &mut Workspace) -> usize;

const ON_ANY_LAYOUT: [(&str, Repeated); 2] = [
    ("at a pose", |patch, objects, poses, workspace| {
        Press::new(patch, objects, poses, Until::Pose)
            .run(workspace)
            .unwrap()
            .unwrap_or_default()
            .n_touched
    }),
    ("with contacts", |patch, objects, poses, workspace| {
        let contact = Press::new(patch, objects, poses, Until::Pose)
            .with_contacts()
            .run(workspace)
            .unwrap()
            .unwrap_or_default();
        assert!(
            spring_load(patch, workspace.contacts())
                .spring_force
                .is_finite()
        );
        contact.n_touched
    }),
];

const ON_FLAT_GRIDS: [(&str, Repeated); 3] = [
    ("to a travel", |patch, objects, poses, workspace| {
        Press::new(patch, objects, poses, Until::Travel(0.0))
            .run(workspace)
            .unwrap()
            .unwrap_or_default()
            .n_touched
    }),
    ("to a depth", |patch, objects, poses, workspace| {
        let contact = Press::new(patch, objects, poses, Until::Depth(1e-3))
            .run(workspace)
            .unwrap();
        contact.unwrap().n_touched
    }),
    ("to a force", |patch, objects, poses, workspace| {
        let contact = Press::new(patch, objects, poses, Until::Force(0.01)).run(workspace);
        contact.unwrap().unwrap().n_touched
    }),
];

#[test]
fn presses_after_the_first_allocate_nothing() {
    let radius = 0.03;
    let center = DVec3::ZERO;
    let ball = SphereUnion::new(vec![Sphere { center, radius }]).unwrap();
    let objects: [Model; 2] = [ball.into(), MeshModel::new(icosphere(radius, 2)).into()];
    for family in 0..N_FAMILIES {
        let layout = layout(&mut rng("allocation", family), family);
        let patch = Patch::new("skin", layout, TAXEL).unwrap();
        let number = patch.n_taxels() / 2;
        let (place, axis) = (
            patch.layout().centers()[number],
            patch.layout().axes()[number],
        );
        let on_flat = if family == 0 { &ON_FLAT_GRIDS[..] } else { &[] };
        for (object, (name, press)) in objects.iter().flat_map(|object| {
            let presses = ON_ANY_LAYOUT.iter().chain(on_flat);
            presses.map(move |press| (std::slice::from_ref(object), press))
        }) {
            let mut workspace = Workspace::new();
            let mut n_touched = Vec::with_capacity(50);
            let mut allocated = |step: u32| {
                // The deepest press comes first, so later presses touch no more taxels.
                let height = radius - 2e-3 + 5e-5 * f64::from(step);
                let pose = [Pose::from_translation(place + height * axis)];
                allocations(|| n_touched.push(press(&patch, object, &pose, &mut workspace)))
            };
            let case = format!("layout {family}, {name}");
            assert!(allocated(0) > 0, "{case}");
            assert_eq!((1..50).map(&mut allocated).sum::<usize>(), 0, "{case}");
            assert!(n_touched[0] > 0, "{case}");
        }
    }
}
