//! All computations of a touch agree: with any vector instructions and any number of threads, sparse and dense. The results also agree with an exhaustive
//! comparison of all spheres and taxels.

use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::objects::{Model, Sphere, SphereUnion};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::whole_body::{BodyContact, BodyState, Instructions};
use bubbletouch_sim::whole_body::{SphereClusters, WORTH_THREADS, WholeBody};
use bubbletouch_sim::world::{Extrusion, Grid, Layout, Patch, Taxel};
use glam::DVec3;
use rand::Rng;
use std::f64::consts::{PI, TAU};

use super::whole_body_laws::{as_skins, random_dome, random_extrusion};
use crate::every_part::{Behind, Expected, by_every_part};
use crate::scenes::{self, TAXEL, direction, random_pose, rng, skin};

const DT: f64 = 1e-3;

/// Creates a patch of each kind of surface, some with enough taxels for several threads.
fn body(rng: &mut impl Rng, taxel: Taxel, pitch: f64) -> WholeBody {
    let [nx, ny] = [0; 2].map(|_| rng.gen_range(1..60));
    let grid = Grid { nx, ny, pitch };
    let cap = Layout::sphere_cap(rng.gen_range(0.02..0.05), rng.gen_range(0.5..PI), pitch).unwrap();
    let (cap, _) = cap.with_neighbours_together();
    // Neighbours are not adjacent in this order, which is slower but must give equal results.
    let mixed = Layout::cylinder(0.03, 0.05, TAU, pitch).unwrap();
    let n = mixed.n_taxels();
    let step = (1..n).rev().find(|&step| gcd(step, n) == 1).unwrap_or(1) / 2 + 1;
    let order: Vec<usize> = (0..n).map(|k| k * coprime(step, n) % n).collect();
    let mixed = Layout::new(
        order.iter().map(|&k| mixed.centers()[k]).collect(),
        order.iter().map(|&k| mixed.axes()[k]).collect(),
    )
    .unwrap();
    let patches = [
        Patch::new("flat", Extrusion::grid(&grid).unwrap(), taxel),
        Patch::new("rows", random_extrusion(rng), taxel),
        Patch::new("dome", random_dome(rng), taxel),
        Patch::new("cap", cap.clone(), taxel),
        Patch::new("mixed", mixed.clone(), taxel),
    ];
    WholeBody::new(&patches.map(Result::unwrap)).unwrap()
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Returns the first number from `step` on that is coprime to n.
fn coprime(step: usize, n: usize) -> usize {
    (step..).find(|&step| gcd(step, n) == 1).unwrap_or(1)
}

/// Returns small spheres, and some that are larger than a patch.
fn union(rng: &mut impl Rng) -> SphereUnion {
    let n = 10f64.powf(rng.gen_range(0.0..2.7)) as usize;
    let spheres = (0..n).map(|_| {
        let radius = 10f64.powf(rng.gen_range(-4.0..-0.5));
        Sphere {
            center: (rng.gen_range(0.0..0.03) + radius) * direction(rng),
            radius,
        }
    });
    SphereUnion::new(spheres.collect()).unwrap()
}

/// A body, and objects that move over it.
struct Scene {
    body: WholeBody,
    patches: Vec<Pose>,
    unions: Vec<SphereUnion>,
    /// Poses of the objects at each step.
    steps: Vec<Vec<Pose>>,
}

impl Scene {
    fn random(case: u64) -> Self {
        let mut rng = rng("variants", case);
        let taxel = Taxel {
            damping: if case.is_multiple_of(3) { 0.5 } else { 0.0 },
            ..TAXEL
        };
        let pitch = if case.is_multiple_of(5) {
            1e-3
        } else {
            rng.gen_range(2e-3..5e-3)
        };
        let body = body(&mut rng, taxel, pitch);
        let patches = body.patches().iter();
        let patches: Vec<Pose> = patches.map(|_| random_pose(&mut rng, 0.05)).collect();
        let unions: Vec<SphereUnion> = (0..rng.gen_range(1..4)).map(|_| union(&mut rng)).collect();
        let step = |_| {
            let distance = rng.gen_range(0.0..0.08);
            let poses = unions.iter().map(|_| random_pose(&mut rng, distance));
            poses.collect()
        };
        let steps = (0..3).map(step).collect();
        Self {
            body,
            patches,
            unions,
            steps,
        }
    }

    /// Returns the result of each step: the counts, the exact values of the touched taxels, and all deflections.
    fn walk(&self, instructions: Instructions, n_threads: usize) -> Vec<Step> {
        let clusters: Vec<SphereClusters> = self.unions.iter().map(SphereClusters::new).collect();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .build();
        pool.unwrap().install(|| {
            let mut state = BodyState::at_rest(&self.body);
            state.use_instructions(instructions);
            state.place(&self.body, &self.patches).unwrap();
            let step = |poses: &Vec<Pose>| {
                let contact = state.press(&self.body, &clusters, poses, DT).unwrap();
                let touched = state.touched(&self.body);
                let all = (0..self.patches.len()).flat_map(|patch| state.deflections(patch));
                Step {
                    contact,
                    touched: touched.map(|(taxel, d)| (taxel, d.to_bits())).collect(),
                    dense: all.copied().collect(),
                }
            };
            self.steps.iter().map(step).collect()
        })
    }

    /// Compares all spheres with all taxels, without dampers.
    fn by_every_part(&self, poses: &[Pose]) -> Vec<Expected> {
        let objects: Vec<Model> = self.unions.iter().cloned().map(Model::from).collect();
        let patches = as_skins(&self.body).into_iter().zip(&self.patches);
        let scenes = patches.map(|(patch, at)| scenes::Scene {
            patch,
            objects: objects.clone(),
            poses: poses.iter().map(|pose| pose.seen_from(at)).collect(),
        });
        scenes
            .flat_map(|scene| by_every_part(&scene, Behind::Ignored))
            .collect()
    }
}

#[derive(PartialEq)]
struct Step {
    contact: BodyContact,
    touched: Vec<(usize, u64)>,
    dense: Vec<f64>,
}

#[test]
fn every_variant_gives_the_same_bits_and_what_every_pair_gives() {
    let (mut n_touched, mut n_shared, mut by_patch) = (0, 0, [0; 5]);
    for case in 0..60 {
        let scene = Scene::random(case);
        let expected = scene.walk(Instructions::Baseline, 1);
        for &instructions in Instructions::here() {
            for n_threads in [1, 2, 5] {
                let same = scene.walk(instructions, n_threads) == expected;
                assert!(same, "case {case}, {instructions:?}, {n_threads} threads");
            }
        }
        for (step, poses) in expected.iter().zip(&scene.steps) {
            let touched = step.touched.iter();
            let sparse = touched.map(|&(taxel, bits)| (taxel, f64::from_bits(bits)));
            let sparse = scene.body.frame(sparse);
            assert!(sparse == step.dense, "case {case}: sparse and dense");
            assert_eq!(step.touched.len(), step.contact.n_touched);
            assert!(step.touched.is_sorted_by_key(|&(taxel, _)| taxel));
            n_touched += step.contact.n_touched;
            n_shared += usize::from(step.contact.n_touched >= WORTH_THREADS);
            for &(taxel, _) in &step.touched {
                by_patch[scene.body.firsts().partition_point(|&first| first <= taxel) - 1] += 1;
            }
            if scene.body.patches()[0].taxel().damping == 0.0 {
                let slow = scene.by_every_part(poses);
                let saturated = slow.iter().filter(|slow| slow.deflection == TAXEL.stroke);
                // A taxel at its stroke may be saturated in one computation and not in the other.
                assert!(step.contact.n_saturated.abs_diff(saturated.count()) <= 1);
                for (taxel, (fast, slow)) in step.dense.iter().zip(&slow).enumerate() {
                    let is_same = (fast - slow.deflection).abs() <= 1e-12;
                    let is_flank = slow.tolerance.is_infinite();
                    assert!(
                        is_same || is_flank,
                        "case {case}, taxel {taxel}: {fast} {slow:?}"
                    );
                }
            }
        }
    }
    assert!(
        n_touched > 50_000 && n_shared > 10,
        "{n_touched} {n_shared}"
    );
    assert!(by_patch.iter().all(|&n| n > 2_000), "{by_patch:?}");
}

#[test]
fn a_draped_patch_has_61_bytes_a_taxel_at_rest_and_its_layout() {
    let layout = whole_ball(0.05);
    let body = WholeBody::new(&[skin(layout.clone(), TAXEL)]).unwrap();
    assert_eq!(body.patches()[0].layout(), layout);
    let bytes = body.n_bytes() + BodyState::at_rest(&body).n_bytes();
    let share = bytes as f64 / body.n_taxels() as f64;
    assert!(
        body.n_taxels() > 20_000 && share < 62.0,
        "{share} bytes a taxel"
    );
}

/// Returns a ball covered with taxels a millimetre apart.
fn whole_ball(radius: f64) -> Layout {
    Layout::sphere_cap(radius, PI, 1e-3)
        .unwrap()
        .with_neighbours_together()
        .0
}

#[test]
fn a_small_touch_of_a_large_draped_patch_evaluates_few_spheres() {
    let body = WholeBody::new(&[skin(whole_ball(0.1), TAXEL)]).unwrap();
    let mut rng = Seed::new(3).rng();
    let centers = (0..2000).map(|_| 0.05 * direction(&mut rng));
    let object = [SphereClusters::new(&scenes::union(centers, 2e-3))];
    let mut state = BodyState::at_rest(&body);
    let pose = [Pose::from_translation(0.151 * DVec3::Z)];
    let contact = state.press(&body, &object, &pose, DT).unwrap();
    assert!(contact.n_touched > 50, "{contact:?}");
    assert_eq!(contact.n_evaluated + contact.n_rejected, 2000);
    assert!(contact.n_evaluated < 200, "{contact:?}");
}
