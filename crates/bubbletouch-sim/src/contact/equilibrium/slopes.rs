//! Derivatives of deflections with respect to the motions of bodies.

use super::body::{Body, along, unit_motions};
use super::curvature::Curvature;
use super::pair::Pair;
use super::symmetric::{Six, Symmetric, dot};
use glam::{DMat3, DVec3};

/// Derivatives of contact deflections with respect to the motions of the bodies. A contact is a pair of sphere and taxel, or a rigid contact.
#[derive(Clone, Debug, Default)]
pub(super) struct Slopes {
    /// Index of the first entry of each pair in `all`, followed by the number of entries.
    first: Vec<u32>,
    all: Vec<(u32, Six)>,
}

impl Slopes {
    pub fn for_pair(&self, pair: usize) -> &[(u32, Six)] {
        &self.all[self.first[pair] as usize..self.first[pair + 1] as usize]
    }

    /// Returns the first-order change of a pair's deflection for a motion of the bodies, metres.
    pub fn dot(&self, pair: usize, motion: &[f64]) -> f64 {
        let of = self.for_pair(pair).iter();
        of.map(|(body, slope)| dot(slope, &motion[6 * *body as usize..]))
            .sum()
    }

    pub fn clear(&mut self) {
        self.all.clear();
        self.first.clear();
        self.first.push(0);
    }

    /// Appends the derivatives of the next pair's deflection. `axes` are the world's axes in the frame of the pair's arm. If `force` (newtons) is positive,
    /// the second derivative of the energy is added to `curvature`.
    pub fn lay(
        &mut self,
        bodies: &[Body],
        axes: &[DVec3; 3],
        pair: &Pair,
        curvature: &mut Symmetric,
        force: f64,
    ) {
        if let Some(Curvature {
            gradient,
            bending,
            turning,
        }) = pair.derivatives()
        {
            for ((body, sign, arm), turning) in pair.ends().zip(turning) {
                let own = unit_motions(axes, arm, bodies[body].arm());
                self.all.push((body as u32, along(&own, sign * gradient)));
                if force <= 0.0 {
                    continue;
                }
                let bent = own.map(|way| sign * force * (bending * way));
                for (other, other_sign, arm) in pair.ends() {
                    let ways = unit_motions(axes, arm, bodies[other].arm());
                    for (i, bent) in bent.iter().enumerate() {
                        let row = curvature.part_mut(6 * body + i, 6 * other);
                        for (entry, way) in row.iter_mut().zip(&ways) {
                            *entry += other_sign * bent.dot(*way);
                        }
                    }
                }
                let centripetal = force / bodies[body].arm().powi(2);
                add_turning(curvature, body, centripetal, axes, [arm, sign * gradient]);
                if turning == DMat3::ZERO {
                    continue;
                }
                for (other, other_sign, arm) in pair.ends() {
                    let ways = unit_motions(axes, arm, bodies[other].arm());
                    for (i, axis) in axes.iter().enumerate() {
                        let along = turning.transpose() * *axis;
                        let row = 6 * body + 3 + i;
                        for (j, way) in ways.iter().enumerate() {
                            let mixed = other_sign * force / bodies[body].arm() * along.dot(*way);
                            curvature.part_mut(row, 6 * other + j)[0] += mixed;
                            curvature.part_mut(6 * other + j, row)[0] += mixed;
                        }
                    }
                }
            }
        }
        self.first.push(self.all.len() as u32);
    }
}

/// Adds the second-order term of a body's rotation θ to the energy. The point r moves as r → r + θ × r + ½ θ × (θ × r), and the term for a direction a is a·½
/// θ × (θ × r) = ½ ((a·θ)(r·θ) − (a·r) θ²).
pub(super) fn add_turning(
    curvature: &mut Symmetric,
    body: usize,
    force: f64,
    axes: &[DVec3; 3],
    [r, a]: [DVec3; 2],
) {
    for i in 0..3 {
        let row = curvature.part_mut(6 * body + 3 + i, 6 * body + 3);
        for j in 0..3 {
            let both = 0.5 * (a.dot(axes[i]) * r.dot(axes[j]) + r.dot(axes[i]) * a.dot(axes[j]));
            let same = if i == j { a.dot(r) } else { 0.0 };
            row[j] += force * (both - same);
        }
    }
}
