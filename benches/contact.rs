//! Benchmarks of single presses: the contact kernel beside an evaluation of every sphere against every taxel.

use bubbletouch::contact::equilibrium::{EquilibriumSolver, FreeObject, PlacedSkin};
use bubbletouch::contact::{Instructions, Press, Until, Workspace};
use bubbletouch::geometry::Pose;
use bubbletouch::mesh::{MeshFormat, SizeLimits, Surface, TriangleMesh};
use bubbletouch::objects::{
    Catalogue, MeshModel, Model, Sphere, SphereUnion, vertex_spheres, write_spheres,
};
use bubbletouch::packing::{Body, pack_mesh};
use bubbletouch::random::Seed;
use bubbletouch::scene::{ScenePlan, SceneSpec, Simulation, Stepping};
use bubbletouch::world::{Grid, Layout, Patch, RestPoses, Taxel, Touch};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::{DQuat, DVec3};
use rand::Rng;
use std::fs::File;
use std::hint::black_box;
use std::io::BufReader;

/// Patch and the objects that press it.
struct Scene {
    patch: Patch,
    objects: Vec<Model>,
}

const DEPTH: f64 = 3e-3;

/// Returns n equal spheres on the surface of a bumpy egg, similar to the vertex spheres of a scanned object.
fn egg(n: usize) -> SphereUnion {
    let mut rng = Seed::new(6).rng();
    let spheres = (0..n).map(|_| {
        let direction = DVec3::from(rng.r#gen::<[f64; 3]>()) * 2.0 - DVec3::ONE;
        Sphere {
            center: direction.normalize_or(DVec3::Z) * DVec3::new(0.05, 0.04, 0.03),
            radius: 2e-3,
        }
    });
    SphereUnion::new(spheres.collect()).expect("radii are positive")
}

fn patch(n: usize) -> Patch {
    let grid = Grid {
        nx: n,
        ny: n,
        pitch: 0.128 / n as f64,
    };
    let taxel = Taxel {
        radius: 0.5 * grid.pitch,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    Patch::grid(grid, taxel).expect("the grid has taxels")
}

fn zero_touch(object: &Model) -> Pose {
    let rest = RestPoses::AsModelled.poses(object).swap_remove(0);
    let touch = Touch {
        rest: 0,
        offset: [0.0; 2],
        yaw: 0.3,
        tilt: [0.0; 2],
        depth: DEPTH,
        indices: [None; 7],
    };
    touch.patch_from_object(&rest)
}

/// Evaluates every sphere against every taxel, at the travel that the kernel found.
fn every_pair(scene: &Scene, pose: &Pose, travel: f64, deflections: &mut [f64]) {
    let grid = scene.patch.layout().as_grid().expect("a grid");
    let taxel = scene.patch.taxels().at(0);
    deflections.fill(0.0);
    let spheres = scene.objects[0]
        .spheres()
        .map_or(&[][..], SphereUnion::spheres);
    for sphere in spheres {
        let c = pose.transform_point(sphere.center);
        let reach2 = (taxel.radius + sphere.radius).powi(2);
        for row in 0..grid.ny {
            for column in 0..grid.nx {
                let q = reach2 - (c.x - grid.x(column)).powi(2) - (c.y - grid.y(row)).powi(2);
                if q > 0.0 {
                    let deflection = &mut deflections[row * grid.nx + column];
                    *deflection = deflection.max(q.sqrt() - (c.z - travel));
                }
            }
        }
    }
}

fn press(c: &mut Criterion) {
    let mut group = c.benchmark_group("press");
    for n_taxels in [32, 64, 128] {
        for n_spheres in [1_000, 8_000] {
            let scene = Scene {
                patch: patch(n_taxels),
                objects: vec![egg(n_spheres).into()],
            };
            let pose = zero_touch(&scene.objects[0]);
            let size = format!("{n_taxels}x{n_taxels}_taxels_{n_spheres}_spheres");
            let mut workspace = Workspace::new();
            group.bench_function(BenchmarkId::new("kernel", &size), |b| {
                b.iter(|| {
                    Press::new(
                        black_box(&scene.patch),
                        &scene.objects,
                        &[pose],
                        Until::Depth(DEPTH),
                    )
                    .run(&mut workspace)
                    .unwrap()
                });
            });
        }
    }
    let scene = Scene {
        patch: patch(64),
        objects: vec![egg(8_000).into()],
    };
    let pose = zero_touch(&scene.objects[0]);
    let travel = Press::new(&scene.patch, &scene.objects, &[pose], Until::Depth(DEPTH))
        .run(&mut Workspace::new())
        .unwrap()
        .map_or(0.0, |contact| contact.travel);
    let mut deflections = vec![0.0; 64 * 64];
    group.sample_size(10);
    group.bench_function("every_pair/64x64_taxels_8000_spheres", |b| {
        b.iter(|| every_pair(black_box(&scene), &pose, travel, &mut deflections));
    });
    group.finish();
}

fn catalogue(c: &mut Criterion) {
    let mut group = c.benchmark_group("press_object_64x64");
    let catalogue = Catalogue::builtin().expect("the built-in catalogue is valid");
    for name in ["banana", "mug", "scissors", "plate"] {
        let object = catalogue
            .object(name)
            .and_then(|entry| entry.build(2.5e-4))
            .expect("a built-in object");
        let n_spheres = object.model.n_spheres();
        let scene = Scene {
            patch: patch(64),
            objects: vec![object.model],
        };
        let pose = zero_touch(&scene.objects[0]);
        let mut workspace = Workspace::new();
        let id = BenchmarkId::new(name, format!("{n_spheres}_spheres"));
        group.bench_function(id, |b| {
            b.iter(|| {
                Press::new(
                    black_box(&scene.patch),
                    &scene.objects,
                    &[pose],
                    Until::Depth(DEPTH),
                )
                .run(&mut workspace)
                .unwrap()
            });
        });
    }
    group.finish();
}

/// Returns the mesh of a ball with hills, similar to a scanned object.
fn scan(n_rings: usize) -> TriangleMesh {
    let n = n_rings as u32;
    let corner = |ring: u32, k: u32| {
        let (up, out) = (std::f64::consts::PI * f64::from(ring) / f64::from(n)).sin_cos();
        let (sin, cos) =
            (std::f64::consts::TAU * f64::from(k % (2 * n)) / f64::from(2 * n)).sin_cos();
        let hill = 1.0 + 0.01 * (9.0 * out).sin() * (7.0 * cos).cos();
        hill * DVec3::new(up * cos, up * sin, out) * DVec3::new(0.05, 0.04, 0.03)
    };
    let vertices = (0..=n).flat_map(|ring| (0..2 * n).map(move |k| corner(ring, k)));
    let at = |ring: u32, k: u32| ring * 2 * n + k % (2 * n);
    let cells = (0..n).flat_map(|ring| (0..2 * n).map(move |k| (ring, k)));
    let triangles = cells.flat_map(|(ring, k)| {
        let [a, b] = [at(ring, k), at(ring, k + 1)];
        let [c, d] = [at(ring + 1, k), at(ring + 1, k + 1)];
        [[a, c, b], [b, c, d]]
    });
    TriangleMesh::new("scan", vertices.collect(), triangles.collect()).expect("a valid mesh")
}

/// Returns a mustard bottle as one sphere per vertex of its scan, and packed to a tenth of the pitch. The mesh is read from BUBBLETOUCH_YCB. Without it, a
/// generated mesh and the built-in bottle are used, and a note is printed.
fn bottles() -> [(&'static str, Model); 2] {
    let folder = std::env::var_os("BUBBLETOUCH_YCB").map(std::path::PathBuf::from);
    let path = folder.map(|folder| folder.join("006_mustard_bottle.ply"));
    let Some(path) = path.filter(|path| path.exists()) else {
        eprintln!(
            "BUBBLETOUCH_YCB has no mustard bottle: a generated ball and the built-in bottle stand for it"
        );
        let ball = vertex_spheres("scan", scan(64).vertices()).expect("vertices apart");
        let bottle = Catalogue::builtin().expect("the built-in catalogue is valid");
        let bottle = bottle
            .object("mustard_bottle")
            .and_then(|entry| entry.build(2e-4));
        let bottle = bottle.expect("a built-in object");
        return [("vertex", ball.into()), ("packed", bottle.model)];
    };
    let place = path.display().to_string();
    let file = BufReader::new(File::open(&path).expect("the mesh can be read"));
    let mesh = MeshFormat::Ply.read(&place, None, &SizeLimits::ANY, file);
    let mesh = mesh
        .and_then(|file| file.into_mesh(&place))
        .expect("a good mesh");
    let vertex = vertex_spheres(&place, mesh.vertices()).expect("vertices apart");
    let packing = pack_mesh(&Surface::new(mesh), Body::Solid, 2e-4).expect("a closed mesh");
    [
        ("vertex", vertex.into()),
        ("packed", packing.spheres.into()),
    ]
}

/// Benchmarks touches as in the original study, each with another offset, yaw or tilt; the bottle stands or lies.
fn touches(c: &mut Criterion) {
    let mut group = c.benchmark_group("press_64x64");
    for (name, model) in bottles() {
        let n_spheres = model.n_spheres();
        let scene = Scene {
            patch: patch(64),
            objects: vec![model],
        };
        let standing = RestPoses::AsModelled
            .poses(&scene.objects[0])
            .swap_remove(0);
        let lying = RestPoses::Stable.poses(&scene.objects[0]).swap_remove(0);
        for (rest_name, rest) in [("standing", standing), ("lying", lying)] {
            let pose = |number: usize| {
                let digit = |place: usize, n: usize| (number / place % n) as f64;
                let touch = Touch {
                    rest: 0,
                    offset: [2e-3 * digit(1, 6), 2e-3 * digit(6, 6)],
                    yaw: (10.0 * digit(36, 6)).to_radians(),
                    tilt: [216, 432].map(|place| (5.0 * digit(place, 2)).to_radians()),
                    depth: DEPTH,
                    indices: [None; 7],
                };
                touch.patch_from_object(&rest)
            };
            let poses: Vec<Pose> = (0..864).map(pose).collect();
            let (mut workspace, mut number) = (Workspace::new(), 0);
            let id = BenchmarkId::new(format!("{name}_{n_spheres}"), rest_name);
            group.bench_function(id, |b| {
                b.iter(|| {
                    number = (number + 1) % poses.len();
                    Press::new(
                        black_box(&scene.patch),
                        &scene.objects,
                        &[poses[number]],
                        Until::Depth(DEPTH),
                    )
                    .run(&mut workspace)
                    .unwrap()
                });
            });
        }
    }
    group.finish();
}

/// Benchmarks one touch with each of the vector instruction sets that this machine supports.
fn instructions(c: &mut Criterion) {
    let mut group = c.benchmark_group("press_instructions");
    for n_spheres in [1_000, 8_000] {
        let scene = Scene {
            patch: patch(64),
            objects: vec![egg(n_spheres).into()],
        };
        let pose = zero_touch(&scene.objects[0]);
        for &instructions in Instructions::here() {
            let mut workspace = Workspace::with(instructions);
            let id = BenchmarkId::new(format!("{instructions:?}"), n_spheres);
            group.bench_function(id, |b| {
                b.iter(|| {
                    Press::new(
                        black_box(&scene.patch),
                        &scene.objects,
                        &[pose],
                        Until::Depth(DEPTH),
                    )
                    .run(&mut workspace)
                    .unwrap()
                });
            });
        }
    }
    group.finish();
}

/// Benchmarks triangles beside spheres around their vertices.
fn mesh(c: &mut Criterion) {
    let mut group = c.benchmark_group("press_mesh_64x64");
    for n_rings in [32, 64] {
        let mesh = scan(n_rings);
        let n_triangles = mesh.n_triangles();
        let spheres = vertex_spheres("scan", mesh.vertices()).expect("vertices apart");
        let models: [(&str, Model); 2] = [
            ("mesh", MeshModel::new(mesh).into()),
            ("vertex_spheres", spheres.into()),
        ];
        for (name, model) in models {
            let scene = Scene {
                patch: patch(64),
                objects: vec![model],
            };
            let pose = zero_touch(&scene.objects[0]);
            let mut workspace = Workspace::new();
            let id = BenchmarkId::new(name, format!("{n_triangles}_triangles"));
            group.bench_function(id, |b| {
                b.iter(|| {
                    Press::new(
                        black_box(&scene.patch),
                        &scene.objects,
                        &[pose],
                        Until::Depth(DEPTH),
                    )
                    .run(&mut workspace)
                    .unwrap()
                });
            });
        }
    }
    group.finish();
}

/// Benchmarks a forearm's skin of 64 × 64 taxels beside a flat patch of as many taxels, with both kernels.
fn curved(c: &mut Criterion) {
    let mut group = c.benchmark_group("curved_press");
    let radius = 64.0 * 4e-3 / std::f64::consts::TAU;
    let cylinder = Layout::cylinder(radius, 63.0 * 4e-3, std::f64::consts::TAU, 4e-3);
    let flat = patch(64);
    let cylinder = Patch::new(
        "forearm",
        cylinder.expect("lengths are positive"),
        flat.taxels().clone(),
    )
    .expect("the taxel is a good one");
    let scene = Scene {
        patch: flat.clone(),
        objects: vec![egg(1_000).into()],
    };
    let pose = zero_touch(&scene.objects[0]);
    let travel = Press::new(&scene.patch, &scene.objects, &[pose], Until::Depth(DEPTH))
        .run(&mut Workspace::new())
        .unwrap()
        .map_or(0.0, |contact| contact.travel);
    let down = Pose::from_translation(-travel * DVec3::Z).compose(&pose);
    // The egg lies with its broad side on the cylinder.
    let beside = Pose::new(
        DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
        DVec3::X * (radius + 0.03 + 2e-3 + 1e-3 - DEPTH),
    );
    let mut workspace = Workspace::new();
    let skins = [("cylinder", cylinder, beside), ("plane", flat, down)];
    for (name, skin, pose) in &skins {
        let id = format!("{name}_4096_taxels_1000_spheres");
        group.bench_function(id, |b| {
            b.iter(|| {
                Press::new(black_box(skin), &scene.objects, &[*pose], Until::Pose)
                    .with_contacts()
                    .run(&mut workspace)
                    .unwrap()
                    .unwrap_or_default()
            });
        });
    }
    let mut workspace = Workspace::new();
    group.bench_function("grid_kernel_4096_taxels_1000_spheres", |b| {
        b.iter(|| {
            Press::new(
                black_box(&scene.patch),
                &scene.objects,
                &[down],
                Until::Pose,
            )
            .run(&mut workspace)
            .unwrap()
            .unwrap_or_default()
        });
    });
    group.finish();
}

/// Benchmarks the equilibrium of an egg of 1,000 spheres on 64 × 64 taxels. After each 0.1 mm by which the skin is lifted, the solver starts from the last pose
/// and forces.
fn rest(c: &mut Criterion) {
    let mut group = c.benchmark_group("balance");
    let skin = patch(64);
    let egg = egg(1_000);
    let object = FreeObject::new(&egg, 0.3, DVec3::ZERO).expect("the mass is positive");
    let mut balancer = EquilibriumSolver::new();
    let mut settle = |height: f64, start: &Pose| {
        let skins = [PlacedSkin::new(
            &skin,
            Pose::from_translation(height * DVec3::Z),
        )];
        let balance = balancer.solve(&object, &skins, -9.81 * DVec3::Z, start);
        balance.expect("the start is finite")
    };
    let mut height = 0.0;
    let mut pose = settle(height, &Pose::from_translation(0.1 * DVec3::Z)).pose;
    group.bench_function("settled_step_4096_taxels_1000_spheres", |b| {
        b.iter(|| {
            height += 1e-4;
            pose = settle(black_box(height), &pose).pose;
        });
    });
    group.finish();
}

/// Benchmarks a frame of a scene: an egg rocks on 64 × 64 taxels, and each frame lists the contacts. Runs without and with dampers and friction (one step per
/// frame).
fn frame(c: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a folder for the egg");
    let egg = egg(8_000);
    let file = std::fs::File::create(folder.path().join("egg.csv")).expect("a new file");
    write_spheres(&egg, file).expect("room for the egg");
    let text = |kind: &str| {
        format!(
            r#"
            title = "An egg rocks"
            output_hz = 1000.0
            duration_s = 1e5
            [[patches]]
            name = "array"
            layout = {{ grid = {{ nx = 64, ny = 64, pitch_mm = 2.0 }} }}
            stroke_mm = 5.0
            {kind}
            [[objects]]
            name = "egg"
            spheres = "egg.csv"
            at = {{ position_mm = [0.0, 0.0, 30.0] }}
            motion = {{ phases = [{{ duration_s = 1e5, angular_deg_per_s = [0.0, 0.0, 20.0] }}] }}
            "#
        )
    };
    let mut group = c.benchmark_group("scene_frame");
    for (name, kind) in [
        ("plain", ""),
        ("damped", "damping_n_s_per_m = 0.5"),
        ("friction", "friction = 0.6"),
    ] {
        let spec = SceneSpec::parse("egg.toml", &text(kind)).expect("a scene");
        let plan = ScenePlan::new("egg.toml", folder.path(), spec).expect("a good scene");
        let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
        let id = BenchmarkId::new(name, "4096_taxels_8000_spheres");
        group.bench_function(id, |b| {
            b.iter(|| simulation.next_frame().expect("a frame").map(|f| f.time));
        });
    }
    group.finish();
}

criterion_group!(
    benches,
    press,
    touches,
    instructions,
    catalogue,
    mesh,
    curved,
    rest,
    frame
);
criterion_main!(benches);
