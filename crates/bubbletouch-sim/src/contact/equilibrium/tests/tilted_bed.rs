//! Two bodies on a tilted bed of taxels, and the finite differences of their energy, for tests.

use crate::contact::equilibrium::FreeObject;
use crate::contact::equilibrium::body::Body;
use crate::contact::equilibrium::rigid_shape::RigidShape;
use crate::contact::equilibrium::scene::Scene;
use crate::contact::equilibrium::symmetric::{Symmetric, norm};
use crate::geometry::Pose;
use crate::world::{Grid, Patch, Taxel};
use glam::{DQuat, DVec3};

/// Returns a bed of n × n taxels.
pub(in crate::contact::equilibrium) fn patch(n: usize, damping: f64) -> Patch {
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping,
        stroke: 4e-3,
    };
    let grid = Grid {
        nx: n,
        ny: n,
        pitch: 2e-3,
    };
    Patch::grid(grid, taxel).unwrap()
}

pub(in crate::contact::equilibrium) fn world_from_patch() -> Pose {
    Pose::new(
        DQuat::from_rotation_x(0.4) * DQuat::from_rotation_y(-0.2),
        DVec3::new(0.1, -0.2, 0.3),
    )
}

/// Returns the two bodies with their start poses.
pub(in crate::contact::equilibrium) fn bodies<'a, S: Into<RigidShape<'a>>>(
    shapes: [S; 2],
    starts: [Pose; 2],
) -> Vec<Body<'a>> {
    let weights = [DVec3::new(0.1, 0.3, -0.9), DVec3::new(0.2, -0.1, -0.3)];
    let all = shapes.into_iter().zip(weights).zip(starts).enumerate();
    let body = |(number, ((shape, weight), start))| {
        let center = DVec3::new(1e-3, 2e-3, -1e-3);
        let object = FreeObject::new(shape, 1.0, center).unwrap();
        Body::new((number, object), weight, &start)
    };
    all.map(body).collect()
}

/// Returns the scene after some of the twelve motions of the bodies, given by number and length in metres, and the work of the weights, joules.
pub(in crate::contact::equilibrium) fn moved<'a>(
    scene: &Scene<'a>,
    steps: &[(usize, f64)],
) -> (Scene<'a>, f64) {
    let mut motion = [0.0; 12];
    steps.iter().for_each(|(k, by)| motion[*k] += by);
    let mut moved = scene.clone();
    let bodies = moved.bodies.iter_mut().zip(motion.chunks(6));
    let fallen = bodies.map(|(body, motion)| body.weight.dot(body.go(motion)));
    let fallen = fallen.sum();
    (moved, fallen)
}

/// First and second finite differences of the energy with respect to the twelve motions of two bodies.
pub(in crate::contact::equilibrium) struct Differences {
    slopes: [f64; 12],
    bends: [[f64; 12]; 12],
}

impl Differences {
    /// Computes the differences of `energy` (J) with the given steps for the first and the second ones, metres.
    pub fn new(mut energy: impl FnMut(&[(usize, f64)]) -> f64, [first, second]: [f64; 2]) -> Self {
        let mut slope = |k| (energy(&[(k, first)]) - energy(&[(k, -first)])) / (2.0 * first);
        let slopes = std::array::from_fn(&mut slope);
        let h = second;
        let mut bend = |i, j| {
            let along = energy(&[(i, h), (j, h)]) + energy(&[(i, -h), (j, -h)]);
            (along - energy(&[(i, h), (j, -h)]) - energy(&[(i, -h), (j, h)])) / (4.0 * h * h)
        };
        Self {
            slopes,
            bends: std::array::from_fn(|i| std::array::from_fn(|j| bend(i, j))),
        }
    }

    /// Compares gradient and Hessian with the differences. The largest errors are relative to the length of the gradient and the size of the Hessian.
    pub fn assert_equal(
        &self,
        (gradient, hessian): (&[f64], &Symmetric),
        [first, second]: [f64; 2],
    ) {
        let (length, largest) = (norm(gradient), hessian.size());
        for (i, (entry, slope)) in gradient.iter().zip(self.slopes).enumerate() {
            let error = (entry - slope).abs();
            assert!(error < first * length, "{i}: {entry} {slope}");
            let mut unit = vec![0.0; 12];
            unit[i] = 1.0;
            for (j, entry) in hessian.times(&unit).iter().enumerate() {
                let error = (entry - self.bends[i][j]).abs();
                assert!(
                    error < second * largest,
                    "{i} {j}: {entry} {}",
                    self.bends[i][j]
                );
            }
        }
    }
}
