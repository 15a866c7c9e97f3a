//! The energy near a pose: deflections go linearly with the object's motion, their curvature is that of the forces there.
//!
//! So it knows which taxels a step lifts off, and which it meets: what makes the energy itself bend is in the model.

use super::free_object::PlacedSkin;
use super::loads::{Loads, Multipliers, Smoothness};
use super::pairs::Pair;
use super::six::{Six, SixBySix, add_outer, best_step, dot, eigen, norm, times};
use glam::{DMat3, DVec3};

/// Steps inside the model, at most.
const MAX_STEPS: usize = 40;

/// A model of the energy; motions are three translations of the centre of mass along the world's axes, and three rotations
/// about them through it, times an arm (metres).
#[derive(Clone, Debug, Default)]
pub(super) struct Model {
    /// ∂δ of each pair by the motion.
    slopes: Vec<Six>,
    deflections: Vec<f64>,
    loads: Loads,
    curvature: SixBySix,
    /// Energy at the pose, joules.
    energy: f64,
}

/// A step, and how much lower the model is there, joules.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub motion: Six,
    pub gain: f64,
}

/// What stays the same for all motions.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub skins: &'a [PlacedSkin<'a>],
    pub multipliers: &'a Multipliers,
    pub smoothness: Smoothness,
    /// m g, newtons.
    pub weight: DVec3,
    /// Metres.
    pub arm: f64,
}

impl Model {
    /// The model around the pose at which these are the pairs and loads.
    pub fn lay(&mut self, scene: &Scene, pairs: &[Pair], loads: &Loads) {
        self.slopes.clear();
        self.curvature = [[0.0; 6]; 6];
        for load in &loads.all {
            let to_patch = scene.skins[load.key.0 as usize]
                .world_from_patch
                .rotation
                .conjugate();
            let axes = DVec3::AXES.map(|axis| to_patch * axis);
            for at in load.pairs.clone() {
                let Some(reach) = pairs[at].reach else {
                    self.slopes.push([0.0; 6]);
                    continue;
                };
                let ways = ways(&axes, pairs[at].arm, scene.arm);
                let found = reach.derivatives();
                self.slopes.push(ways.map(|way| found.gradient.dot(way)));
                let force = loads.shares[at] * load.force;
                if force > 0.0 {
                    let turning = force / (scene.arm * scene.arm);
                    add_curvature(&mut self.curvature, force, &ways, found.curvature);
                    add_turning(
                        &mut self.curvature,
                        turning,
                        &axes,
                        pairs[at].arm,
                        found.gradient,
                    );
                }
            }
        }
    }

    /// Energy after a motion, with the weight's; joules.
    fn energy_after(&mut self, scene: &Scene, pairs: &[Pair], motion: &Six) -> f64 {
        let moved = pairs.iter().zip(&self.slopes);
        self.deflections.clear();
        self.deflections
            .extend(moved.map(|(pair, slope)| pair.deflection + dot(slope, motion)));
        let Scene {
            skins,
            multipliers,
            smoothness,
            ..
        } = *scene;
        self.loads
            .weigh(pairs, &self.deflections, skins, multipliers, smoothness);
        let [x, y, z, ..] = *motion;
        let bent = 0.5 * dot(motion, &times(&self.curvature, motion));
        self.loads.elastic + bent - scene.weight.dot(DVec3::new(x, y, z))
    }

    /// Gradient (N) and Hessian (N/m) after the motion that was looked at last.
    fn derivatives(&self, scene: &Scene, motion: &Six) -> (Six, SixBySix) {
        let mut gradient = times(&self.curvature, motion);
        for (slope, weight) in gradient.iter_mut().zip(scene.weight.to_array()) {
            *slope -= weight;
        }
        let mut hessian = self.curvature;
        for load in self.loads.carrying() {
            let (mut mean, mut sum) = ([0.0; 6], [0.0; 6]);
            let stiffening = load.force / load.smoothing;
            for at in load.pairs.clone() {
                let (slope, share) = (&self.slopes[at], self.loads.shares[at]);
                if share > 0.0 {
                    for k in 0..6 {
                        mean[k] += share * slope[k];
                        sum[k] += slope[k];
                    }
                    if load.n_sharing > 1 {
                        add_outer(&mut hessian, stiffening, slope, slope);
                    }
                }
            }
            if load.n_sharing > 1 {
                add_outer(
                    &mut hessian,
                    -stiffening / load.n_sharing as f64,
                    &sum,
                    &sum,
                );
            }
            add_outer(&mut hessian, load.tangent, &mean, &mean);
            for k in 0..6 {
                gradient[k] += load.force * mean[k];
            }
        }
        (gradient, hessian)
    }

    /// Gradient and Hessian of the energy itself, at the pose.
    pub fn at_pose(&mut self, scene: &Scene, pairs: &[Pair]) -> (Six, SixBySix) {
        self.energy = self.energy_after(scene, pairs, &[0.0; 6]);
        self.derivatives(scene, &[0.0; 6])
    }

    /// A motion of at most `reach` that is good for the model: trust-region Newton steps inside it. The model must have been
    /// looked at [at its pose](Self::at_pose), where it has this gradient and these eigenvalues and vectors.
    pub fn best(
        &mut self,
        scene: &Scene,
        pairs: &[Pair],
        (gradient, parts): (&Six, &(Six, SixBySix)),
        reach: f64,
    ) -> Step {
        let start = self.energy;
        let enough = 0.03 * norm(gradient);
        let (mut motion, mut energy) = ([0.0; 6], start);
        let (mut gradient, mut parts) = (*gradient, *parts);
        let mut part = reach;
        for _ in 0..MAX_STEPS {
            let (step, promised) = best_step(&gradient, &parts, part);
            let next: Six = std::array::from_fn(|k| motion[k] + step[k]);
            let length = norm(&next);
            let is_far = length > reach * (1.0 + 1e-6);
            let next = next.map(|x| if is_far { x * reach / length } else { x });
            let after = self.energy_after(scene, pairs, &next);
            if after >= energy || energy - after < 0.1 * promised && !is_far {
                part *= 0.25;
            }
            if after < energy {
                (motion, energy) = (next, after);
                let (slope, hessian) = self.derivatives(scene, &motion);
                if is_far || norm(&slope) <= enough {
                    break;
                }
                (gradient, parts) = (slope, eigen(&hessian));
            } else if part < 1e-9 * reach {
                break;
            }
        }
        Step {
            motion,
            gain: start - energy,
        }
    }
}

/// How a sphere moves when the object goes along or turns about each of the axes; per metre.
pub(super) fn ways(axes: &[DVec3; 3], from_center: DVec3, arm: f64) -> [DVec3; 6] {
    let [x, y, z] = *axes;
    let turn = |axis: DVec3| axis.cross(from_center) / arm;
    [x, y, z, turn(x), turn(y), turn(z)]
}

pub(super) fn add_curvature(
    hessian: &mut SixBySix,
    force: f64,
    ways: &[DVec3; 6],
    curvature: DMat3,
) {
    let bent = ways.map(|way| curvature * way);
    for (row, way) in hessian.iter_mut().zip(ways) {
        for (entry, bent) in row.iter_mut().zip(&bent) {
            *entry += force * way.dot(*bent);
        }
    }
}

/// Second order of a rotation θ, which takes r to r + θ × r + ½ θ × (θ × r): a·½ θ × (θ × r) = ½ ((a·θ)(r·θ) − (a·r) θ²).
pub(super) fn add_turning(
    hessian: &mut SixBySix,
    force: f64,
    axes: &[DVec3; 3],
    r: DVec3,
    a: DVec3,
) {
    for i in 0..3 {
        for j in 0..3 {
            let both = 0.5 * (a.dot(axes[i]) * r.dot(axes[j]) + r.dot(axes[i]) * a.dot(axes[j]));
            let same = if i == j { a.dot(r) } else { 0.0 };
            hessian[3 + i][3 + j] += force * (both - same);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::balance::FreeObject;
    use crate::contact::balance::energy::Energy;
    use crate::geometry::Pose;
    use crate::objects::{Sphere, SphereUnion};
    use crate::random::Seed;
    use crate::world::{Grid, Patch, Taxel};
    use glam::DQuat;
    use rand::Rng;

    /// Seven spheres on a bed that is tilted in the world, deep enough for some stops.
    #[test]
    fn gradient_and_hessian_are_the_differences_of_the_energy() {
        let taxel = Taxel {
            radius: 1e-3,
            stiffness: 200.0,
            damping: 0.0,
            stroke: 4e-3,
        };
        let grid = Grid {
            nx: 16,
            ny: 16,
            pitch: 2e-3,
        };
        let patch = Patch::grid(grid, taxel).unwrap();
        let skins = [PlacedSkin {
            patch: &patch,
            world_from_patch: Pose::new(
                DQuat::from_rotation_x(0.4) * DQuat::from_rotation_y(-0.2),
                DVec3::new(0.1, -0.2, 0.3),
            ),
            pushed: &[],
        }];
        let mut rng = Seed::new(5).named("model").rng();
        let mut random = || DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0)));
        let spheres: Vec<_> = (0..7)
            .map(|_| Sphere {
                center: 8e-3 * random(),
                radius: 6e-3,
            })
            .collect();
        let union = SphereUnion::new(spheres).unwrap();
        let object = FreeObject::new(&union, 0.1, DVec3::new(1e-3, 2e-3, -1e-3)).unwrap();
        let (multipliers, arm) = (Multipliers::default(), 0.02);
        let scene = Scene {
            skins: &skins,
            multipliers: &multipliers,
            smoothness: Smoothness {
                smoothing: 2e-4,
                load: f64::INFINITY,
                least: 0.0,
                stop_stiffness: 1e4,
            },
            weight: DVec3::new(0.1, 0.3, -0.9),
            arm,
        };
        let start = skins[0]
            .world_from_patch
            .transform_point(DVec3::new(0.0, 0.0, 6e-3));
        let pose = |motion: &Six| {
            let [x, y, z, a, b, c] = *motion;
            let rotation = DQuat::from_scaled_axis(DVec3::new(a, b, c) / arm);
            let center = start + DVec3::new(x, y, z);
            Pose::new(rotation, center - rotation * object.center_of_mass)
        };
        let mut energy = Energy::default();
        let mut value = |motion: &Six| {
            energy.look(&object, &scene, &pose(motion), 0.0, &[]);
            energy.loads.elastic
                - scene
                    .weight
                    .dot(DVec3::new(motion[0], motion[1], motion[2]))
        };
        let along =
            |k: usize, by: f64| -> Six { std::array::from_fn(|i| if i == k { by } else { 0.0 }) };
        let step = 1e-6;
        let slopes: Six = std::array::from_fn(|k| {
            (value(&along(k, step)) - value(&along(k, -step))) / (2.0 * step)
        });
        let bends = [0, 1, 2, 3, 4, 5].map(|i| {
            [0, 1, 2, 3, 4, 5].map(|j| {
                let mut at = |a: f64, b: f64| {
                    let mut motion = along(i, a * 3e-6);
                    motion[j] += b * 3e-6;
                    value(&motion)
                };
                (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / (4.0 * 9e-12)
            })
        });
        let mut model = Model::default();
        energy.look(&object, &scene, &pose(&[0.0; 6]), 0.0, &[]);
        assert!(
            energy.loads.carrying().any(|load| load.n_sharing > 1),
            "ties are tested, too"
        );
        assert!(
            energy.loads.carrying().any(|load| load.stop > 0.0),
            "and stops"
        );
        model.lay(&scene, &energy.pairs.all, &energy.loads);
        let (gradient, hessian) = model.at_pose(&scene, &energy.pairs.all);
        let largest = hessian
            .iter()
            .flatten()
            .fold(0.0_f64, |a, b| a.max(b.abs()));
        for i in 0..6 {
            assert!(
                (gradient[i] - slopes[i]).abs() < 1e-4 * norm(&gradient),
                "{i}: {} {}",
                gradient[i],
                slopes[i]
            );
            for j in 0..6 {
                let error = (hessian[i][j] - bends[i][j]).abs();
                assert!(
                    error < 2e-3 * largest,
                    "{i} {j}: {} {}",
                    hessian[i][j],
                    bends[i][j]
                );
            }
        }
    }
}
