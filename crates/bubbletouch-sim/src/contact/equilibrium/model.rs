//! Quadratic model of the energy near a pose: deflections are linear in the motion, and their curvature is weighted with the forces at the pose.
//!
//! The model includes taxels that a step lifts off or meets, because these change the curvature of the energy most.

use super::energy::Energy;
use super::loads::Loads;
use super::pair::Key;
use super::pairs::Pairs;
use super::scene::Scene;
use super::shear_springs::ShearSpringModel;
use super::slopes::Slopes;
use super::symmetric::{Six, Symmetric, best_step, dot, norm};
use glam::DVec3;

/// Maximum number of Newton iterations that minimise the quadratic model.
const MAX_STEPS: usize = 40;
/// Value of [`MAX_STEPS`] if a mesh can touch a rigid shape. Between the present pose and the minimum, the model of such a scene has many kinks, where a corner meets
/// another face.
const MAX_ROUGH_STEPS: usize = 150;

/// Quadratic model of the energy as a function of the motions of the bodies; a motion has six components per body.
#[derive(Clone, Debug, Default)]
pub(super) struct Model {
    slopes: Slopes,
    /// Forces on the bodies after the most recently evaluated motion.
    loads: Loads,
    curvature: Symmetric,
    held: ShearSpringModel,
    /// Scratch memory for one taxel: the mean energy gradient of each body that pushes the taxel, weighted with the loads.
    means: Vec<(u32, Six)>,
    /// Scratch memory for one taxel: the sum of the energy gradients of each body that pushes the taxel.
    sums: Vec<(u32, Six)>,
}

/// Motion of the bodies, and the predicted decrease of the energy, joules.
#[derive(Clone, Debug)]
pub(super) struct Step {
    pub motion: Vec<f64>,
    pub gain: f64,
}

impl Model {
    /// Sets up the model at the poses for which the energy was evaluated. Returns the gradient (N) and the Hessian (N/m) at these poses.
    pub fn lay(
        &mut self,
        scene: &Scene,
        Energy { pairs, loads }: &Energy,
    ) -> (Vec<f64>, Symmetric) {
        self.curvature.clear(6 * scene.bodies.len());
        self.slopes.clear();
        for (group, load) in pairs.groups.iter().zip(&loads.all) {
            let axes = match group.key {
                Key::Taxel(skin, _) => {
                    let skin = &scene.ground.skins[skin as usize];
                    let to_patch = skin.world_from_patch.rotation.conjugate();
                    DVec3::AXES.map(|axis| to_patch * axis)
                }
                Key::Rigid(..) => DVec3::AXES,
            };
            for at in group.pairs.clone() {
                let (pair, force) = (&pairs.all[at], loads.shares[at] * load.force);
                let curvature = &mut self.curvature;
                self.slopes
                    .lay(&scene.bodies, &axes, pair, curvature, force);
            }
        }
        self.held
            .lay(&scene.springs, &scene.bodies, &mut self.curvature);
        let still = vec![0.0; self.curvature.n()];
        self.derivatives(scene, pairs, loads, &still)
    }

    /// Returns the energy after a motion, including the work of the weights, joules.
    fn energy_after(&mut self, scene: &Scene, pairs: &Pairs, motion: &[f64]) -> f64 {
        let Self { loads, slopes, .. } = self;
        loads.weigh(
            (&scene.multipliers, &scene.smoothness),
            pairs,
            |(at, pair)| pair.deflection + slopes.dot(at, motion),
        );
        let bodies = scene.bodies.iter().zip(motion.chunks(6));
        let fallen: f64 = bodies
            .map(|(body, motion)| body.weight.dot(DVec3::from_slice(motion)))
            .sum();
        let bent = 0.5 * dot(motion, &self.curvature.times(motion));
        self.loads.elastic + self.held.energy_after(motion) + bent - fallen
    }

    /// Returns the gradient (N) and the Hessian (N/m) of the energy after a motion with the given loads.
    fn derivatives(
        &mut self,
        scene: &Scene,
        pairs: &Pairs,
        loads: &Loads,
        motion: &[f64],
    ) -> (Vec<f64>, Symmetric) {
        let mut gradient = self.curvature.times(motion);
        for (body, gradient) in scene.bodies.iter().zip(gradient.chunks_mut(6)) {
            add(gradient, -1.0, &body.weight.to_array());
        }
        let mut hessian = self.curvature.clone();
        self.held
            .add_derivatives(motion, &mut gradient, &mut hessian);
        let Self {
            slopes,
            means,
            sums,
            ..
        } = self;
        for (group, load) in loads.carrying(&pairs.groups) {
            means.clear();
            sums.clear();
            let stiffening = load.force / load.smoothing;
            for at in group.pairs.clone() {
                let share = loads.shares[at];
                if share <= 0.0 {
                    continue;
                }
                for (body, slope) in slopes.for_pair(at) {
                    add(of_body(means, *body), share, slope);
                    add(
                        &mut gradient[6 * *body as usize..],
                        load.force * share,
                        slope,
                    );
                    if load.n_sharing > 1 {
                        add(of_body(sums, *body), 1.0, slope);
                    }
                }
                if load.n_sharing > 1 {
                    add_square(&mut hessian, stiffening, slopes.for_pair(at));
                }
            }
            add_square(&mut hessian, -stiffening / load.n_sharing as f64, sums);
            add_square(&mut hessian, load.tangent, means);
        }
        (gradient, hessian)
    }

    /// Returns a motion that decreases the model and is not longer than the trust-region radius `reach`, metres. The function uses Newton steps. The model
    /// must have been set up for the given energy, gradient and Hessian. If the energy `is_rough`, Newton steps become longer again after a short one, because the
    /// model has many kinks that are far from its minimum.
    pub fn best(
        &mut self,
        scene: &Scene,
        Energy { pairs, loads }: &Energy,
        (mut gradient, mut hessian): (Vec<f64>, Symmetric),
        (reach, is_rough): (f64, bool),
    ) -> Step {
        let start = loads.elastic;
        let enough = 0.03 * scene.slope(&gradient);
        let (mut motion, mut energy) = (vec![0.0; gradient.len()], start);
        let mut part = reach;
        let n_steps = if is_rough { MAX_ROUGH_STEPS } else { MAX_STEPS };
        for _ in 0..n_steps {
            let (step, promised) = best_step(&gradient, &hessian, part);
            let mut next: Vec<f64> = motion.iter().zip(&step).map(|(a, b)| a + b).collect();
            let length = norm(&next);
            let is_far = length > reach * (1.0 + 1e-6);
            if is_far {
                next.iter_mut().for_each(|x| *x *= reach / length);
            }
            let after = self.energy_after(scene, pairs, &next);
            if after >= energy || energy - after < 0.1 * promised && !is_far {
                part *= 0.25;
            } else if is_rough && energy - after > 0.5 * promised {
                part = (4.0 * part).min(reach);
            }
            if after < energy {
                (motion, energy) = (next, after);
                let loads = std::mem::take(&mut self.loads);
                (gradient, hessian) = self.derivatives(scene, pairs, &loads, &motion);
                self.loads = loads;
                if is_far || scene.slope(&gradient) <= enough {
                    break;
                }
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

fn add(to: &mut [f64], factor: f64, v: &[f64]) {
    for (to, v) in to.iter_mut().zip(v) {
        *to += factor * v;
    }
}

fn of_body(sums: &mut Vec<(u32, Six)>, body: u32) -> &mut Six {
    let at = sums.iter().position(|sum| sum.0 == body);
    let at = at.unwrap_or_else(|| {
        sums.push((body, [0.0; 6]));
        sums.len() - 1
    });
    &mut sums[at].1
}

/// Adds `factor · v vᵀ` to the Hessian, where the vector v is given by its nonzero parts, six components per body.
fn add_square(hessian: &mut Symmetric, factor: f64, v: &[(u32, Six)]) {
    for (a, x) in v {
        for (b, y) in v {
            hessian.add_block([*a as usize, *b as usize], factor, x, y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::equilibrium::loads::{Multipliers, Smoothness};
    use crate::contact::equilibrium::meshes::Depth;
    use crate::contact::equilibrium::shear_springs::Spring;
    use crate::contact::equilibrium::tests::tilted_bed::{self, Differences};
    use crate::contact::equilibrium::{
        Ground, HalfSpace, Obstacle, PlacedSkin, TangentialSpring, Touched,
    };
    use crate::geometry::Pose;
    use crate::objects::{Sphere, SphereUnion};
    use crate::random::Seed;
    use crate::world::Shear;
    use glam::DVec2;
    use rand::Rng;

    /// Compares the derivatives of the energy with finite differences. Two objects of seven spheres penetrate each other, an obstacle and a plane, and press
    /// a tilted array of taxels, some to the end of their stroke. The step includes dampers, and some tangential springs act on the objects.
    #[test]
    fn gradient_and_hessian_are_the_differences_of_the_energy() {
        let patch = tilted_bed::patch(16, 2.0);
        let before: Vec<f64> = (0..256).map(|taxel| 1e-6 * f64::from(taxel)).collect();
        let world_from_patch = tilted_bed::world_from_patch();
        let skin = PlacedSkin::new(&patch, world_from_patch);
        let before = Some((&before[..], 0.01));
        // Some springs stick, some slip.
        let tips: Vec<TangentialSpring> = (0..12)
            .map(|k| TangentialSpring {
                taxel: 100 + 7 * k,
                object: k % 2,
                point: DVec3::new(2e-3, 1e-3 * k as f64, -3e-3),
                place: DVec3::new(3e-3 * k as f64, 2e-3, 3e-3),
                displacement: DVec2::new(1e-4 * k as f64, -2e-4),
                shear: Shear {
                    stiffness: 150.0,
                    friction: 0.5,
                },
                force: if k < 6 { 100.0 } else { 0.4 },
            })
            .collect();
        let skins = [PlacedSkin {
            before,
            tangential_springs: &tips,
            ..skin
        }];
        let mut rng = Seed::new(5).named("model").rng();
        let mut random = || DVec3::from_array(std::array::from_fn(|_| rng.gen_range(-1.0..1.0)));
        let mut union = |n: usize| {
            let spheres = (0..n).map(|_| Sphere {
                center: 8e-3 * random(),
                radius: 6e-3,
            });
            SphereUnion::new(spheres.collect()).unwrap()
        };
        let unions = [union(7), union(7), union(2)];
        let at = |x: f64| world_from_patch.transform_point(DVec3::new(x, 1e-3, 6e-3));
        let normal = DVec3::new(0.3, 0.1, 0.9).normalize();
        let ground = Ground {
            skins: skins.to_vec(),
            planes: vec![HalfSpace {
                normal,
                height: normal.dot(at(0.0)) - 8e-3,
            }],
            obstacles: vec![Obstacle {
                shape: (&unions[2]).into(),
                pose: Pose::from_translation(at(-5e-3)),
            }],
        };
        let starts = [0.0, 14e-3].map(|x| Pose::from_translation(at(x)));
        let bodies = tilted_bed::bodies([&unions[0], &unions[1]], starts);
        let scene = Scene {
            springs: Spring::all(&bodies, &ground),
            bodies,
            ground: &ground,
            multipliers: Multipliers::default(),
            smoothness: Smoothness {
                smoothing: 2e-4,
                load: f64::INFINITY,
                least: 0.0,
                stop_stiffness: 1e4,
            },
        };
        let mut energy = Energy::default();
        let value = |steps: &[(usize, f64)]| {
            let (moved, fallen) = tilted_bed::moved(&scene, steps);
            energy.look(&moved, (0.0, Depth::up_to(0.0)), (&[], &[]));
            energy.loads.elastic - fallen
        };
        let differences = Differences::new(value, [1e-6, 3e-6]);
        energy.look(&scene, (0.0, Depth::up_to(0.0)), (&[], &[]));
        let has = |what: fn(&Key) -> bool| {
            let all = energy.loads.carrying(&energy.pairs.groups);
            all.filter(|(group, _)| what(&group.key)).count()
        };
        assert!(has(|key| matches!(key, Key::Rigid(_, Touched::Plane(_)))) > 0);
        assert!(has(|key| matches!(key, Key::Rigid(_, Touched::Obstacle(..)))) > 0);
        assert!(has(|key| matches!(key, Key::Rigid(_, Touched::Object(..)))) > 0);
        let mut all = energy.loads.carrying(&energy.pairs.groups);
        assert!(all.any(|(_, load)| load.n_sharing > 1), "ties");
        let mut all = energy.loads.carrying(&energy.pairs.groups);
        let is_stop = |key: &Key| matches!(key, Key::Taxel(..));
        assert!(all.any(|(group, load)| is_stop(&group.key) && load.stop > 0.0));
        let mut model = Model::default();
        let (gradient, hessian) = model.lay(&scene, &energy);
        differences.assert_equal((&gradient, &hessian), [1e-4, 2e-3]);
    }
}
