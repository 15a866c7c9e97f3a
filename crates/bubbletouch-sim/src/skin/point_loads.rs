//! Deflections of a patch under given contact forces: quasi-static, with the sum and the moment of the forces.
//!
//! A simulator of rigid bodies computes contact points and forces, but no pressure. The taxels of a patch share these forces as the geometry allows. Let
//! g_i be the deflection of taxel i at the engine's pose, negative if the taxel is not touched. If the patch travels by t along its axis and tilts by small
//! angles, a flat patch has the forces
//!
//! ```text
//! f_i = k_i min(s_i, max(0, g_i + t + a x_i + b y_i))
//! ```
//!
//! The travel and the tilts minimise a convex function, `Σ Φ_i(g_i + t + a x_i + b y_i) − t F − a M_x − b M_y` with Φ_i' = f_i. At its minimum, `Σ f_i = F`,
//! `Σ x_i f_i = M_x` and `Σ y_i f_i = M_y`: the sum, the moment and the centre of pressure are those of the contact forces. No minimum exists if the centre of
//! pressure is outside all taxels within reach; the nearest taxels then have the force. A curved patch travels without tilting.
//!
//! The remaining force and moment are tangential: `τ_i = f_i P_i (u + ω × r_i)` with P_i = 1 − n_i n_iᵀ. The vectors u and ω solve six linear equations, so
//! friction is shared in proportion to the normal forces.

use crate::contact::{Sample, Wrench, crossing};
use crate::geometry::Pose;
use crate::world::Patch;
use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};

/// Contact force on a patch, in the patch frame or in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointLoad {
    /// Point of contact, metres.
    pub point: DVec3,
    /// Force along the contact normal, newtons.
    pub normal: DVec3,
    /// Force perpendicular to the contact normal, newtons.
    pub friction: DVec3,
    /// Torque of the contact about its point (torsional and rolling friction), N·m.
    pub torque: DVec3,
}

impl PointLoad {
    /// Returns the load in a frame; `pose` maps the load's frame to this frame.
    pub fn transformed(&self, pose: &Pose) -> Self {
        Self {
            point: pose.transform_point(self.point),
            normal: pose.transform_vector(self.normal),
            friction: pose.transform_vector(self.friction),
            torque: pose.transform_vector(self.torque),
        }
    }
}

/// Part of the contact forces that the taxels carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadPart {
    /// Normal forces only. The sum of the taxels' forces along their axes equals the sum of the absolute normal forces.
    Normal,
    /// Force and torque in all directions.
    Whole,
}

/// Result of [`carry_loads`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CarriedLoad {
    /// Sum of the taxels' forces along their axes, newtons.
    pub force: f64,
    /// Sum of these forces that the contact forces require, newtons; larger than `force` if taxels are saturated or no taxel is within reach.
    pub required: f64,
    /// Travel of the patch along z, metres.
    pub travel: f64,
}

/// Memory for [`carry_loads`]: the taxels that an object can touch within the reach of a patch.
#[derive(Clone, Debug, Default)]
pub(super) struct LoadWorkspace {
    springs: Vec<Spring>,
}

/// Taxel within reach.
#[derive(Clone, Copy, Debug)]
struct Spring {
    taxel: usize,
    stiffness: f64,
    /// Largest deflection that other loads leave, metres.
    room: f64,
    /// Deflection at the pose of the object, metres; negative if the taxel is not touched.
    gap: f64,
    /// Changes of the deflection with the travel (dimensionless) and with two tilts, in units of the patch's size.
    slopes: DVec3,
}

impl Spring {
    /// Returns the force, newtons, and its derivative with respect to the deflection, N/m.
    fn force(&self, motion: DVec3) -> (f64, f64) {
        let needed = self.gap + self.slopes.dot(motion);
        let moves = needed > 0.0 && needed < self.room;
        let slope = if moves { self.stiffness } else { 0.0 };
        (self.stiffness * needed.clamp(0.0, self.room), slope)
    }
}

/// Returns the direction, a unit vector in the patch frame, in which a curved patch travels under its loads: against the mean force. A flat patch travels along z.
pub(super) fn travel_direction(loads: &[PointLoad]) -> DVec3 {
    let against: DVec3 = loads.iter().map(|load| -load.normal).sum();
    against.try_normalize().unwrap_or(DVec3::Z)
}

/// Returns whether all taxels point along z.
pub(super) fn is_flat(patch: &Patch) -> bool {
    patch.layout().axes().iter().all(|axis| *axis == DVec3::Z)
}

/// Adds the deflections of a flat patch under contact forces to `deflections`, metres, shape (n_taxels,).
///
/// `deep` contains the deflections, metres, at the pose of the object after a travel of `reach` metres along z, without a limit by the stroke. Taxels with
/// `deep = 0` are out of reach. Earlier deflections leave less room below the stroke.
///
/// # Panics
/// If the lengths of the slices differ from the number of taxels.
pub(super) fn carry_loads(
    patch: &Patch,
    (deep, reach): (&[f64], f64),
    (loads, part): (&[PointLoad], LoadPart),
    deflections: &mut [f64],
    workspace: &mut LoadWorkspace,
) -> CarriedLoad {
    let centers = patch.layout().centers();
    let wanted = wrench(loads, part);
    let required = -wanted.force.z;
    let mut origin = middle(loads);
    origin.z = centers[0].z;
    let size = extent(patch, origin);
    let springs = &mut workspace.springs;
    springs.clear();
    for (taxel, deep) in deep.iter().enumerate().filter(|(_, deep)| **deep > 0.0) {
        let properties = patch.taxels().at(taxel);
        let arm = (centers[taxel] - origin) / size;
        springs.push(Spring {
            taxel,
            stiffness: properties.stiffness,
            room: (properties.stroke - deflections[taxel]).max(0.0),
            gap: deep - reach,
            slopes: DVec3::new(1.0, arm.x, arm.y),
        });
    }
    let mut carried = CarriedLoad {
        required,
        ..CarriedLoad::default()
    };
    if required <= 0.0 || springs.is_empty() {
        carried.travel = reach;
        return carried;
    }
    // Σ f_i (x_i − x, y_i − y) of the normal forces.
    let about = moment_about(wanted, origin);
    let center = reachable(springs, DVec2::new(about.y, -about.x) / (size * required));
    let mut motion = tilt(springs, required * DVec3::new(1.0, center.x, center.y));
    motion.x = travel(springs, motion, required);
    carried.travel = motion.x.min(reach);
    for spring in springs.iter() {
        let (force, _) = spring.force(motion);
        carried.force += force;
        deflections[spring.taxel] += force / spring.stiffness;
    }
    carried
}

/// Adds tangential forces to the taxels, newtons, shape (n_taxels,), so that all forces have the sum and the moment of the loads. `deflections` are those under
/// these loads alone, metres; each taxel has a share in proportion to its normal force. Returns the wrench that no tangential forces have: the torque of
/// contacts at the rim, which are up to one spacing outside all taxels, or of a single touched taxel.
///
/// With [`LoadPart::Normal`], no forces are added, and the returned wrench is the one of the axial forces of a flat patch.
pub(super) fn share_friction(
    patch: &Patch,
    (loads, part): (&[PointLoad], LoadPart),
    deflections: &[f64],
    tangential: &mut [DVec3],
) -> Wrench {
    let (centers, axes) = (patch.layout().centers(), patch.layout().axes());
    let pressed = deflections
        .iter()
        .enumerate()
        .filter(|(_, deflection)| **deflection > 0.0);
    let pressed: Vec<(usize, f64)> = pressed
        .map(|(taxel, deflection)| (taxel, patch.taxels().at(taxel).stiffness * deflection))
        .collect();
    let axial = |sum: Wrench, &(taxel, force): &(usize, f64)| {
        sum + Wrench::at(centers[taxel], force * axes[taxel])
    };
    let missing = pressed.iter().fold(wrench(loads, part), axial);
    if part == LoadPart::Normal {
        return missing;
    }
    let origin = middle(loads);
    let size = extent(patch, origin);
    let torque = moment_about(missing, origin) / size;
    let wanted: [f64; 6] = std::array::from_fn(|k| {
        if k < 3 {
            missing.force[k]
        } else {
            torque[k - 3]
        }
    });
    // Tangential forces per unit of u and ω.
    let responses = |taxel: usize| -> [DVec3; 6] {
        let arm = (centers[taxel] - origin) / size;
        std::array::from_fn(|k| {
            let unit = DVec3::AXES[k % 3];
            (if k < 3 { unit } else { unit.cross(arm) }).reject_from_normalized(axes[taxel])
        })
    };
    let mut matrix = [[0.0; 6]; 6];
    for &(taxel, force) in &pressed {
        let responses = responses(taxel);
        for (i, row) in matrix.iter_mut().enumerate() {
            for (entry, response) in row.iter_mut().zip(&responses) {
                *entry += force * responses[i].dot(*response);
            }
        }
    }
    let solution = solve_semidefinite(matrix, wanted);
    let mut rest = missing;
    for &(taxel, force) in &pressed {
        let pairs = responses(taxel).into_iter().zip(solution);
        let shared = force
            * pairs
                .map(|(response, amount)| response * amount)
                .sum::<DVec3>();
        tangential[taxel] += shared;
        rest = rest + -Wrench::at(centers[taxel], shared);
    }
    rest
}

/// Returns the mean point of the loads, weighted by their normal forces, metres.
fn middle(loads: &[PointLoad]) -> DVec3 {
    let amount: f64 = loads.iter().map(|load| load.normal.length()).sum();
    let weighted = loads.iter().map(|load| load.normal.length() * load.point);
    weighted.sum::<DVec3>() / amount.max(f64::MIN_POSITIVE)
}

/// Returns the largest distance of a taxel from a point, metres.
fn extent(patch: &Patch, origin: DVec3) -> f64 {
    let distances = patch
        .layout()
        .centers()
        .iter()
        .map(|center| center.distance(origin));
    distances.fold(f64::MIN_POSITIVE, f64::max)
}

/// Returns the sum of the loads, in the patch frame about its origin. Normal forces alone act along z.
fn wrench(loads: &[PointLoad], part: LoadPart) -> Wrench {
    let of = |load: &PointLoad| match part {
        LoadPart::Normal => Wrench::at(load.point, -load.normal.length() * DVec3::Z),
        LoadPart::Whole => {
            let mut wrench = Wrench::at(load.point, load.normal + load.friction);
            wrench.torque += load.torque;
            wrench
        }
    };
    loads
        .iter()
        .map(of)
        .fold(Wrench::default(), |sum, next| sum + next)
}

fn moment_about(wrench: Wrench, origin: DVec3) -> DVec3 {
    wrench.torque - origin.cross(wrench.force)
}

/// Returns the travel, metres, at which the forces have the sum `required`, newtons, positive, or their largest sum. The tilts are those of `motion`.
fn travel(springs: &[Spring], motion: DVec3, required: f64) -> f64 {
    let start = |spring: &Spring| -spring.gap - spring.slopes.yz().dot(motion.yz());
    let first = springs.iter().map(start).fold(f64::INFINITY, f64::min);
    let last = springs.iter().map(|spring| start(spring) + spring.room);
    let last = last.fold(first, f64::max);
    let total = |travel: f64| {
        let motion = DVec3 {
            x: travel,
            ..motion
        };
        let zero = Sample {
            value: 0.0,
            slope: 0.0,
        };
        springs.iter().fold(zero, |sum, spring| {
            let (force, slope) = spring.force(motion);
            Sample {
                value: sum.value + force,
                slope: sum.slope + slope,
            }
        })
    };
    match total(last).value < required {
        true => last,
        false => crossing([first, last], (required, ACCURACY * required), total),
    }
}

/// Relative accuracy of sums and moments of forces; a few roundings of a sum over a thousand taxels.
const ACCURACY: f64 = 1e-14;

/// Steps after which the search for the tilts ends. Every second step halves the error at least; the search takes 3 to 12 steps if a minimum exists.
const MAX_STEPS: usize = 60;

/// Damping of a step relative to the stiffest spring. If larger, the search takes more steps; if smaller, steps with fewer than three moving taxels are cut
/// more often.
const DAMPING: f64 = 1e-7;

/// Returns the point of the plane nearest to `point` that a centre of pressure of the springs can have: inside the convex hull of their places, and not on its
/// edges, where the tilts would be infinite.
fn reachable(springs: &[Spring], point: DVec2) -> DVec2 {
    let places = springs.iter().filter(|spring| spring.room > 0.0);
    let mut places: Vec<DVec2> = places.map(|spring| spring.slopes.yz()).collect();
    places.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    // Lower and upper chain, counterclockwise.
    let mut hull: Vec<DVec2> = Vec::new();
    for is_upper in [false, true] {
        let first = hull.len().saturating_sub(1);
        for &place in places.iter() {
            while let [.., a, b] = hull[first..]
                && (b - a).perp_dot(place - b) <= 0.0
            {
                hull.pop();
            }
            hull.push(place);
        }
        if !is_upper {
            places.reverse();
        }
    }
    let edges = hull.iter().zip(hull.iter().skip(1));
    if hull.len() > 3
        && edges
            .clone()
            .all(|(&a, &b)| (b - a).perp_dot(point - a) > 0.0)
    {
        return point;
    }
    let on_edge = edges.map(|(&a, &b)| {
        let along = (point - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE);
        a + along.clamp(0.0, 1.0) * (b - a)
    });
    let nearest = on_edge.min_by(|a, b| {
        a.distance_squared(point)
            .total_cmp(&b.distance_squared(point))
    });
    let middle = places.iter().sum::<DVec2>() / places.len().max(1) as f64;
    nearest.map_or(middle, |nearest| nearest + INSIDE * (middle - nearest))
}

/// Distance of a centre of pressure from the edges of the convex hull, relative to its distance from the middle. If larger, contacts on the rim press too far
/// inside; if smaller, the search for the tilts takes more steps.
const INSIDE: f64 = 1e-3;

/// Returns travel and tilts at which the forces have the sum and the moments `wanted`. The centre of pressure must be [`reachable`].
fn tilt(springs: &[Spring], wanted: DVec3) -> DVec3 {
    let stiffest = springs
        .iter()
        .map(|spring| spring.stiffness)
        .fold(0.0, f64::max);
    let mut motion = DVec3::ZERO;
    motion.x = travel(springs, motion, wanted.x);
    let far: f64 = springs
        .iter()
        .map(|spring| spring.gap.abs() + spring.room)
        .fold(0.0, f64::max);
    for _ in 0..MAX_STEPS {
        let mut missing = wanted;
        let mut matrix = DMat3::from_diagonal(DVec3::splat(DAMPING * stiffest));
        for spring in springs {
            let (force, slope) = spring.force(motion);
            missing -= force * spring.slopes;
            let s = slope * spring.slopes;
            matrix += DMat3::from_cols(
                s * spring.slopes.x,
                s * spring.slopes.y,
                s * spring.slopes.z,
            );
        }
        if missing.abs().max_element() <= ACCURACY * wanted.x
            || motion.abs().max_element() > MAX_TILT * far
        {
            break;
        }
        let step = matrix.inverse() * missing;
        // The slope of the convex function along the step, negative at the start.
        let along = |part: f64| {
            let at = motion + part * step;
            let start = Sample {
                value: -wanted.dot(step),
                slope: 0.0,
            };
            springs.iter().fold(start, |sum, spring| {
                let (force, slope) = spring.force(at);
                let way = spring.slopes.dot(step);
                Sample {
                    value: sum.value + force * way,
                    slope: sum.slope + slope * way * way,
                }
            })
        };
        let descent = missing.dot(step);
        let part = match along(1.0).value <= 0.1 * descent {
            true => 1.0,
            false => crossing([0.0, 1.0], (0.0, 0.1 * descent), along),
        };
        motion += part * step;
    }
    motion
}

/// Bound of the tilts relative to the largest gap, in units of the patch's size, beyond which the nearest taxels carry the whole force. If smaller, small
/// objects between taxels lose their moment.
const MAX_TILT: f64 = 1e4;

/// Solves a positive semidefinite system by elimination with diagonal pivots. Directions whose pivot is rounding error remain zero.
fn solve_semidefinite(mut matrix: [[f64; 6]; 6], mut values: [f64; 6]) -> [f64; 6] {
    let largest = (0..6).map(|k| matrix[k][k]).fold(0.0, f64::max);
    let mut order: Vec<usize> = Vec::with_capacity(6);
    while let Some(pivot) = (0..6)
        .filter(|k| !order.contains(k))
        .max_by(|&a, &b| matrix[a][a].total_cmp(&matrix[b][b]))
    {
        if matrix[pivot][pivot] <= 1e-12 * largest {
            break;
        }
        order.push(pivot);
        let eliminated = matrix[pivot];
        for row in (0..6).filter(|k| !order.contains(k)) {
            let factor = matrix[row][pivot] / eliminated[pivot];
            for (entry, of_pivot) in matrix[row].iter_mut().zip(eliminated) {
                *entry -= factor * of_pivot;
            }
            values[row] -= factor * values[pivot];
        }
    }
    let mut solution = [0.0; 6];
    for (at, &pivot) in order.iter().enumerate().rev() {
        let known: f64 = order[at + 1..]
            .iter()
            .map(|&k| matrix[pivot][k] * solution[k])
            .sum();
        solution[pivot] = (values[pivot] - known) / matrix[pivot][pivot];
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Press, Until, Workspace};
    use crate::objects::{Model, Sphere, SphereUnion};
    use crate::random::Seed;
    use crate::world::{Grid, Taxel};
    use rand::Rng;

    const TAXEL: Taxel = Taxel {
        radius: 1e-3,
        stiffness: 500.0,
        damping: 0.0,
        stroke: 5e-3,
    };
    const REACH: f64 = 7e-3;

    fn ball(radius: f64) -> [Model; 1] {
        let center = DVec3::ZERO;
        [SphereUnion::new(vec![Sphere { center, radius }])
            .unwrap()
            .into()]
    }

    /// Deflections of a patch with a stroke that is larger by the reach, at a pose that is deeper by the reach.
    fn deep(grid: Grid, objects: &[Model], at: DVec3) -> Vec<f64> {
        let taxel = Taxel {
            stroke: TAXEL.stroke + REACH,
            ..TAXEL
        };
        let patch = Patch::grid(grid, taxel).unwrap();
        let mut workspace = Workspace::new();
        let pose = Pose::from_translation(at - REACH * DVec3::Z);
        Press::new(&patch, objects, &[pose], Until::Pose)
            .run(&mut workspace)
            .unwrap();
        workspace.deflections().to_vec()
    }

    #[test]
    fn forces_on_the_taxels_have_the_sum_and_the_moment_of_the_contacts() {
        let mut rng = Seed::new(61).rng();
        let (grid, mut workspace) = (
            Grid {
                nx: 16,
                ny: 12,
                pitch: 2e-3,
            },
            LoadWorkspace::default(),
        );
        let patch = Patch::grid(grid, TAXEL).unwrap();
        for _ in 0..300 {
            let objects = ball(rng.gen_range(2e-3..4e-2));
            let radius = objects[0].bounds().max.z;
            let place = DVec3::new(rng.gen_range(-1e-2..1e-2), rng.gen_range(-8e-3..8e-3), 0.0);
            let at = place + DVec3::Z * (radius + rng.gen_range(-2e-3..2e-3));
            let mut near = |scale: f64| {
                DVec3::new(
                    rng.gen_range(-scale..scale),
                    rng.gen_range(-scale..scale),
                    0.0,
                )
            };
            let loads: Vec<PointLoad> = (0..3)
                .map(|_| PointLoad {
                    point: place + near(1.5e-3) + 1e-3 * DVec3::Z,
                    normal: near(0.1) - 0.2 * DVec3::Z,
                    friction: near(0.1),
                    torque: 1e-3 * near(0.1),
                })
                .collect();
            let deep = deep(grid, &objects, at);
            for part in [LoadPart::Normal, LoadPart::Whole] {
                let mut deflections = vec![0.0; patch.n_taxels()];
                let mut tangential = vec![DVec3::ZERO; patch.n_taxels()];
                let carried = carry_loads(
                    &patch,
                    (&deep, REACH),
                    (&loads, part),
                    &mut deflections,
                    &mut workspace,
                );
                let rest = share_friction(&patch, (&loads, part), &deflections, &mut tangential);
                let (force, size) = (carried.required, rest.torque.abs());
                assert!((carried.force - force).abs() < 1e-12 * force, "{carried:?}");
                assert!(rest.force.abs().max_element() < 1e-12, "{part:?} {rest:?}");
                assert!(size.max_element() < 1e-11, "{part:?} {radius} {rest:?}");
                assert!(deflections.iter().all(|d| (0.0..=TAXEL.stroke).contains(d)));
                // Untouched taxels have no friction.
                let pairs = deflections.iter().zip(&tangential);
                assert!(pairs.clone().all(|(d, t)| *d > 0.0 || *t == DVec3::ZERO));
            }
        }
    }

    #[test]
    fn a_centred_contact_presses_like_the_ball_and_a_contact_on_the_rim_presses_the_rim() {
        let (grid, mut workspace) = (
            Grid {
                nx: 9,
                ny: 9,
                pitch: 2e-3,
            },
            LoadWorkspace::default(),
        );
        let (patch, objects) = (Patch::grid(grid, TAXEL).unwrap(), ball(0.02));
        let at = DVec3::new(0.0, 0.0, 0.0195);
        let deep = deep(grid, &objects, at);
        let mut deflections = vec![0.0; patch.n_taxels()];
        let mut loads = [PointLoad {
            normal: -3.0 * DVec3::Z,
            ..PointLoad::default()
        }];
        let mut carry = |loads: &[PointLoad], deflections: &mut [f64]| {
            deflections.fill(0.0);
            let (deep, loads) = ((&deep[..], REACH), (loads, LoadPart::Normal));
            carry_loads(&patch, deep, loads, deflections, &mut workspace)
        };
        carry(&loads, &mut deflections);
        let mut pressed = Workspace::new();
        let poses = [Pose::from_translation(at)];
        Press::new(&patch, &objects, &poses, Until::Force(3.0))
            .run(&mut pressed)
            .unwrap();
        let differences = deflections
            .iter()
            .zip(pressed.deflections())
            .map(|(a, b)| (a - b).abs());
        assert!(differences.fold(0.0, f64::max) < 1e-12);

        // 1 mm outside the outermost column: the force is on this column, and the torque of the offset is returned.
        loads[0].point = DVec3::new(9e-3, 0.0, 0.0);
        let carried = carry(&loads, &mut deflections);
        let rest = share_friction(&patch, (&loads, LoadPart::Normal), &deflections, &mut []);
        assert!((carried.force - 3.0).abs() < 1e-11);
        assert!((rest.torque.y - 3e-3).abs() < 1e-4, "{rest:?}");

        // More force than the taxels within reach carry.
        loads[0] = PointLoad {
            normal: -1e4 * DVec3::Z,
            ..PointLoad::default()
        };
        let carried = carry(&loads, &mut deflections);
        assert!(carried.force < carried.required && deflections.iter().all(|d| *d <= TAXEL.stroke));
    }
}
