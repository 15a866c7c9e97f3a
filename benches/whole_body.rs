//! Benchmarks of a step of a whole skin, by the size of the skin, of the touch, and by the object's number of spheres.

use bubbletouch::geometry::Pose;
use bubbletouch::objects::{Part, Shape, Solid, Sphere, SphereUnion, pack};
use bubbletouch::random::Seed;
use bubbletouch::signal::{
    BodyReading, BodyReadout, Moment, Noise, NoiseUnit, SensorError, SignalStep,
};
use bubbletouch::whole_body::{BodyState, CoveredRobot, Instructions, SphereClusters, WholeBody};
use bubbletouch::world::{Extrusion, Grid, Layout, Patch, Robot, Taxel};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use std::f64::consts::PI;

const TAXEL: Taxel = Taxel {
    radius: 0.5e-3,
    stiffness: 100.0,
    damping: 0.0,
    stroke: 2e-3,
};
const PITCH: f64 = 1e-3;

/// Returns a skin of at least `n_taxels` in patches of 10,000 at 1 mm. The patches are quarters of cylinders of 13 cm diameter, half a metre apart; the first
/// four form one trunk.
fn body(n_taxels: usize) -> (WholeBody, Vec<Pose>) {
    let sleeve = Extrusion::cylinder(0.065, 0.1, 0.5 * PI, PITCH).expect("lengths are positive");
    let n = n_taxels.div_ceil(sleeve.n_taxels());
    let patches = (0..n).map(|k| {
        let patch = Patch::new(format!("patch {k}"), sleeve.clone(), TAXEL);
        patch.expect("the taxel is a good one")
    });
    let pose = |k: usize| {
        let turn = glam::DQuat::from_rotation_z(0.5 * PI * (k % 4) as f64);
        let (row, column) = ((k / 4 / 20) as f64, (k / 4 % 20) as f64);
        Pose::new(turn, 0.5 * DVec3::new(row, column, 0.0))
    };
    let body = WholeBody::new(&patches.collect::<Vec<_>>()).expect("every patch has its name");
    (body, (0..n).map(pose).collect())
}

/// Returns a ball of `radius` metres made of n spheres: one large sphere, and equal small ones on its surface, as in packings.
fn ball(n: usize, radius: f64) -> SphereClusters {
    let golden = PI * (3.0 - 5f64.sqrt());
    let each = radius.min(2.0 * radius / (n as f64).sqrt());
    let spheres = (0..n).map(|k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        Sphere {
            center: (radius - each) * DVec3::new(across * cos, across * sin, z),
            radius: each,
        }
    });
    let inner = Sphere {
        center: DVec3::ZERO,
        radius: radius - each,
    };
    let all = (n > 1).then_some(inner).into_iter().chain(spheres).take(n);
    SphereClusters::new(&SphereUnion::new(all.collect()).expect("radii are positive"))
}

/// Skin with an object that moves over its trunk, about the trunk's axis and at a given depth.
struct Bench {
    body: WholeBody,
    state: BodyState,
    object: [SphereClusters; 1],
    /// Distance between the trunk's axis and the object's centre, metres.
    away: f64,
    step: u32,
}

impl Bench {
    fn new(n_taxels: usize, n_spheres: usize, away: f64) -> Self {
        let (body, poses) = body(n_taxels);
        let mut state = BodyState::at_rest(&body);
        state.place(&body, &poses).unwrap();
        Self {
            body,
            state,
            object: [ball(n_spheres, 0.1)],
            away,
            step: 0,
        }
    }

    /// Advances by one millisecond; returns the number of touched taxels.
    fn step(&mut self) -> usize {
        self.step += 1;
        let time = 1e-3 * f64::from(self.step);
        let angle = 0.8 + 0.2 * (3.0 * time).sin();
        let center = DVec3::new(angle.cos(), angle.sin(), 0.0) * self.away;
        let pose = Pose::new(glam::DQuat::from_rotation_y(time), center);
        let contact = self
            .state
            .press(&self.body, &self.object, &[pose], 1e-3)
            .unwrap();
        contact.n_touched
    }

    /// Creates a benchmark in which the depth gives the requested number of touched taxels.
    fn touching(n_taxels: usize, n_spheres: usize, n_touched: usize) -> Self {
        let (mut deep, mut high) = (0.065, 0.165);
        let at = |away| Self::new(40_000, n_spheres, away).step();
        for _ in 0..30 {
            let away = 0.5 * (deep + high);
            match at(away) < n_touched {
                true => high = away,
                false => deep = away,
            }
        }
        let found = at(deep);
        assert!(
            found.abs_diff(n_touched) * 20 <= n_touched,
            "{found} are touched"
        );
        Self::new(n_taxels, n_spheres, deep)
    }
}

fn skin(c: &mut Criterion) {
    let mut group = c.benchmark_group("body_skin_10000_touched_1000_spheres");
    for n_taxels in [100_000, 230_000, 2_000_000, 10_000_000] {
        let mut bench = Bench::touching(n_taxels, 1_000, 10_000);
        group.bench_function(BenchmarkId::from_parameter(n_taxels), |b| {
            b.iter(|| bench.step());
        });
    }
    group.finish();
}

fn touch(c: &mut Criterion) {
    let mut group = c.benchmark_group("body_touch_2000000_taxels_1000_spheres");
    for n_touched in [100, 1_000, 10_000, 20_000] {
        let mut bench = Bench::touching(2_000_000, 1_000, n_touched);
        group.bench_function(BenchmarkId::from_parameter(n_touched), |b| {
            b.iter(|| bench.step());
        });
    }
    let mut bench = Bench::new(2_000_000, 1_000, 1.0);
    assert_eq!(bench.step(), 0);
    group.bench_function("0", |b| b.iter(|| bench.step()));
    group.finish();
}

fn spheres(c: &mut Criterion) {
    let mut group = c.benchmark_group("body_object_2000000_taxels_10000_touched");
    for n_spheres in [1, 100, 1_000, 10_000] {
        let mut bench = Bench::touching(2_000_000, n_spheres, 10_000);
        group.bench_function(BenchmarkId::from_parameter(n_spheres), |b| {
            b.iter(|| bench.step());
        });
    }
    group.finish();
}

/// Benchmarks one thread beside two. For small touches neither is faster, because they are not divided among threads.
fn threads(c: &mut Criterion) {
    let mut group = c.benchmark_group("body_threads_2000000_taxels_1000_spheres");
    for n_touched in [100, 1_000, 10_000, 20_000] {
        for n_threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(n_threads)
                .build();
            let pool = pool.expect("two threads can be had");
            let mut bench = Bench::touching(2_000_000, 1_000, n_touched);
            let id = BenchmarkId::new(format!("{n_touched}_touched"), n_threads);
            group.bench_function(id, |b| pool.install(|| b.iter(|| bench.step())));
        }
    }
    group.finish();
}

/// Benchmarks each vector instruction set that this machine supports, with small spheres and with one that touches everything.
fn instructions(c: &mut Criterion) {
    let mut group = c.benchmark_group("body_instructions_2000000_taxels_10000_touched");
    for &instructions in Instructions::here() {
        for n_spheres in [1, 1_000, 10_000] {
            let mut bench = Bench::touching(2_000_000, n_spheres, 10_000);
            bench.state.use_instructions(instructions);
            let id = BenchmarkId::new(format!("{instructions:?}"), n_spheres);
            group.bench_function(id, |b| b.iter(|| bench.step()));
        }
    }
    group.finish();
}

/// Benchmarks a ball that rolls on a flat patch of rows, and on the same taxels as a draped patch.
fn draped(c: &mut Criterion) {
    let grid = Grid {
        nx: 300,
        ny: 300,
        pitch: 1e-3,
    };
    let extrusion = Extrusion::grid(&grid).expect("the grid has taxels");
    let (layout, _) = Layout::from(extrusion.clone()).with_neighbours_together();
    let rows = Patch::new("rows", extrusion, TAXEL);
    let draped = Patch::new("draped", layout.clone(), TAXEL);
    let object = [ball(1_000, 0.1)];
    let mut group = c.benchmark_group("body_draped_90000_taxels_1000_spheres");
    for patch in [rows, draped] {
        let patch = patch.expect("the taxel is a good one");
        let name = patch.name().to_owned();
        let body = WholeBody::new(&[patch]).expect("one name");
        let mut state = BodyState::at_rest(&body);
        let mut step = 0;
        group.bench_function(name, |b| {
            b.iter(|| {
                step += 1;
                let turn = glam::DQuat::from_rotation_y(1e-3 * f64::from(step));
                let pose = Pose::new(turn, DVec3::new(0.0, 0.0, 0.099));
                state
                    .press(&body, &object, &[pose], 1e-3)
                    .unwrap()
                    .n_touched
            });
        });
    }
    group.finish();
}

/// Hug of two people, the scene of `experiments/whole_body.toml`. The skin of one person has two million taxels. The other consists of a trunk, arms and
/// a head.
struct Hug {
    robot: CoveredRobot,
    state: BodyState,
    object: [SphereClusters; 1],
    world_from_trunk: Pose,
    frame: u64,
}

impl Hug {
    fn new() -> Self {
        let robot = Robot::read("objects/robots/humanoid.urdf".as_ref());
        let robot = robot.expect("the robot is committed");
        let mut positions = vec![0.0; robot.n_positions()];
        for joint in ["left_shoulder", "right_shoulder"] {
            let joint = robot.joint(joint).expect("it has shoulders");
            let (coordinate, ..) = robot.drive_of(joint).expect("they move");
            positions[coordinate] = -0.5 * PI;
        }
        let links = robot.forward(&Pose::IDENTITY, &positions);
        let links = links.expect("one value a joint");
        let covered = CoveredRobot::new(&robot, TAXEL, PITCH, 0.1).expect("it has links");
        let mut poses = Vec::new();
        covered.patch_poses(&links, &mut poses);
        let mut state = BodyState::at_rest(covered.body());
        state.place(covered.body(), &poses).unwrap();
        let trunk = Shape::Capsule {
            diameter: 0.3042,
            length: 0.76,
        };
        let arms = Shape::Torus {
            ring_diameter: 0.376,
            tube_diameter: 0.09,
        };
        let parts = [
            (trunk, [0.2954, 0.0, 0.24]),
            (arms, [0.0, 0.0, 0.15]),
            (Shape::Ball { diameter: 0.18 }, [0.16, 0.07, 0.62]),
        ];
        let parts = parts
            .map(|(shape, at)| Part::new(shape, Pose::from_translation(DVec3::from_array(at))));
        let parts = parts.into_iter().collect::<Result<_, _>>();
        let solid = Solid::new(parts.expect("lengths are positive")).expect("there are parts");
        let spheres = pack(&solid, 0.25e-3).expect("it can be packed");
        Self {
            world_from_trunk: links[robot.link("trunk").expect("it has one")],
            robot: covered,
            state,
            object: [SphereClusters::new(&spheres)],
            frame: 0,
        }
    }

    /// Advances a breath by one millisecond; returns the number of touched taxels.
    fn press(&mut self) -> usize {
        self.frame += 1;
        let breath = (PI * 1e-3 * self.frame as f64).sin();
        let moved = Pose::from_translation(breath * DVec3::new(0.3e-3, 0.0, 0.5e-3));
        let pose = [self.world_from_trunk.compose(&moved)];
        let contact = self
            .state
            .press(self.robot.body(), &self.object, &pose, 1e-3)
            .unwrap();
        contact.n_touched
    }

    /// Returns the time of a frame within a session of one hour.
    fn moment(&self) -> Moment {
        Moment {
            frame: self.frame,
            time: (self.frame as f64 / 3.6e6).fract(),
        }
    }
}

/// Benchmarks the readout of a hug: press, readout of the touched taxels, both, and readout of every taxel.
fn readout(c: &mut Criterion) {
    let skin = Seed::new(2018).named("skin");
    let noise = SignalStep::Noise(Noise {
        std: 0.05,
        unit: NoiseUnit::FullScale,
    });
    let drift = SensorError::Drift.step(&[0.05], skin).unwrap();
    let faults = SensorError::Faults.step(&[0.01], skin).unwrap();
    let all = [noise, drift, faults];
    let mut group = c.benchmark_group("body_hug_2045187_taxels");
    for n_threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .build();
        let pool = pool.expect("two threads can be had");
        let mut hug = Hug::new();
        assert!(hug.press() > 30_000);
        let id = |name: &str| BenchmarkId::new(name, n_threads);
        group.bench_function(id("press"), |b| pool.install(|| b.iter(|| hug.press())));
        let mut reading = BodyReading::default();
        let body = hug.robot.body().clone();
        let read = |steps: &[SignalStep]| {
            BodyReadout::new(steps, &body, &skin).expect("strengths are in their ranges")
        };
        for (name, readout) in [
            ("read_touched_noise", read(&[noise])),
            ("read_touched_noise_drift_dead", read(&all)),
        ] {
            group.bench_function(id(name), |b| {
                let mut frame = 0;
                pool.install(|| {
                    b.iter(|| {
                        frame += 1;
                        let moment = Moment {
                            frame,
                            ..hug.moment()
                        };
                        readout.read_touched(&body, &hug.state, moment, &mut reading);
                    });
                });
            });
        }
        let readout = read(&all);
        group.bench_function(id("press_and_read_noise_drift_dead"), |b| {
            pool.install(|| {
                b.iter(|| {
                    hug.press();
                    readout.read_touched(&body, &hug.state, hug.moment(), &mut reading);
                });
            });
        });
        let taxels: Vec<usize> = (0..body.n_taxels()).collect();
        let mut values = vec![0.0; taxels.len()];
        group.sample_size(10);
        group.bench_function(id("read_all_noise_drift_dead"), |b| {
            pool.install(|| b.iter(|| readout.read(&taxels, hug.moment(), &mut values)));
        });
        group.sample_size(100);
    }
    group.finish();
}

criterion_group!(
    benches,
    skin,
    touch,
    spheres,
    threads,
    instructions,
    draped,
    readout
);
criterion_main!(benches);
