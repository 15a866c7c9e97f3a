//! Laws of the forces between taxels and free meshes, from a search over all triangles.

use super::closed_forms::stopping_height_by_search;
use super::free_meshes::{BALANCED, DOWN, Free, G, Rest, at, bed, on_bed, settle};
use crate::scenes::touched;
use crate::{reference_data, scans};
use bubbletouch_sim::contact::equilibrium::Outcome;
use bubbletouch_sim::geometry::Pose;
use bubbletouch_sim::mesh::{Triangle, TriangleMesh};
use bubbletouch_sim::objects::{MeshModel, Model};
use bubbletouch_sim::world::Patch;
use glam::{DQuat, DVec2, DVec3};

/// Largest difference of two deflections of a taxel that count as equal, metres.
const EQUAL: f64 = 1e-8;

/// Stop of a taxel's ball by one triangle of an object, on a bed whose axes are vertical.
struct Stop {
    object: usize,
    deflection: f64,
    /// Touched point of the triangle, metres.
    point: DVec3,
    /// Unit vector from the touched point to the centre of the stopped ball.
    outward: DVec3,
}

/// Returns the stops of one taxel by all triangles of all objects.
fn stops(patch: &Patch, taxel: usize, objects: &[Vec<Triangle>]) -> Vec<Stop> {
    let (rest, radius) = (
        patch.layout().centers()[taxel],
        patch.taxels().at(taxel).radius,
    );
    let mut all = Vec::new();
    for (object, triangles) in objects.iter().enumerate() {
        for triangle in triangles {
            let bounds = triangle.bounds();
            let (low, high) = (bounds.min - radius - rest, bounds.max + radius - rest);
            let is_beside = low.x.max(low.y) > 0.0 || high.x.min(high.y) < 0.0;
            if is_beside || low.z > 0.0 {
                continue;
            }
            let across = DVec2::new(rest.x, rest.y);
            let Some(height) = stopping_height_by_search(triangle, radius, across) else {
                continue;
            };
            let center = across.extend(height);
            let point = triangle.closest(center).0;
            all.push(Stop {
                object,
                deflection: rest.z - height,
                point,
                outward: (center - point).normalize(),
            });
        }
    }
    all
}

/// Returns the largest residual of force and torque of all objects, relative to the weights. The reported loads supply only the shares of a taxel's force. The search over
/// all triangles supplies the deflections, directions and points of contact, and the reported contacts supply the forces between objects.
///
/// # Panics
/// If a taxel's force is not stiffness times deflection, or if a load has the direction of no triangle that stops the taxel.
fn residual(patch: &Patch, free: &[Free], rest: &Rest) -> f64 {
    let placed = free.iter().zip(rest.poses()).map(|(free, pose)| {
        let Model::Mesh(mesh) = &free.model else {
            panic!("a mesh");
        };
        let mesh = mesh.mesh().moved(&pose);
        (0..mesh.n_triangles())
            .map(|number| mesh.triangle(number))
            .collect()
    });
    let placed: Vec<Vec<Triangle>> = placed.collect();
    let mut pushes = Vec::new();
    for taxel in 0..patch.n_taxels() {
        let all = stops(patch, taxel, &placed);
        let deflections = all.iter().map(|stop| stop.deflection);
        let deepest = deflections.fold(0.0, f64::max);
        let loads = rest.loads.iter().filter(|load| load.taxel == taxel);
        let force: f64 = loads.clone().map(|load| load.force).sum();
        let expected = patch.taxels().at(taxel).stiffness * deepest;
        assert!(
            (force - expected).abs() < 1e-9,
            "taxel {taxel}: {force} {expected}"
        );
        for load in loads {
            let push = |stop: &&Stop| load.force * stop.outward / stop.outward.z;
            let is_stopping = |stop: &&Stop| {
                let is_deepest = deepest - stop.deflection < EQUAL;
                let error = (push(stop) - load.on_object.force).length();
                stop.object == load.object && is_deepest && error < 1e-6 * load.force
            };
            let stop = all.iter().find(is_stopping);
            let stop = stop.unwrap_or_else(|| panic!("no triangle has the load {load:?}"));
            pushes.push((load.object, push(&stop), stop.point));
        }
    }
    rest.residual(free, pushes.into_iter())
}

/// Returns the number of taxels that several parts of an object push equally far.
fn n_ties(rest: &Rest) -> usize {
    let of_taxel = rest.loads.chunk_by(|a, b| a.taxel == b.taxel);
    of_taxel.filter(|loads| loads.len() > 1).count()
}

fn solid(name: &str, vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Model {
    let mesh = TriangleMesh::new(name, vertices, triangles).unwrap();
    MeshModel::new(mesh.turned_outwards().0).into()
}

/// Returns a hollow pyramid that is open below. The apex of the inner pyramid is the origin, and the inner faces slope by 45°.
fn umbrella() -> Model {
    let ring = |half: f64| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| DVec3::new(half * x, half * y, -20e-3))
    };
    let apexes = [DVec3::ZERO, 2e-3 * DVec3::Z];
    let vertices = [&ring(20e-3)[..], &ring(22e-3), &apexes].concat();
    let mut triangles = Vec::new();
    for a in 0..4 {
        let b = (a + 1) % 4;
        triangles.extend([
            [a, 8, b],
            [a + 4, b + 4, 9],
            [a, b, b + 4],
            [a, b + 4, a + 4],
        ]);
    }
    solid("umbrella", vertices, triangles)
}

/// Returns a slab with `n` grooves along y in its lower side, `pitch` metres apart, whose faces slope by 45°.
fn grooved(n: usize, pitch: f64) -> Model {
    let (width, top) = (12e-3, 6e-3);
    let mut vertices = Vec::new();
    for k in 0..=2 * n {
        let x = 0.5 * pitch * (k as f64 - n as f64);
        let z = if k % 2 == 0 { 0.0 } else { 0.5 * pitch };
        let section = [(-width, z), (width, z), (width, top), (-width, top)];
        vertices.extend(section.map(|(y, z)| DVec3::new(x, y, z)));
    }
    let last = 8 * n as u32;
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    triangles.extend([[last, last + 2, last + 1], [last, last + 3, last + 2]]);
    for first in (0..last).step_by(4) {
        for side in 0..4 {
            let (a, b) = (first + side, first + (side + 1) % 4);
            triangles.extend([[a, a + 4, b], [b, a + 4, b + 4]]);
        }
    }
    solid("grooved slab", vertices, triangles)
}

/// The ball of the taxel is in the apex of the pyramid and touches four faces. A single one of them would push the object aside with its whole weight.
#[test]
fn a_taxel_in_a_valley_shares_its_force_between_the_faces() {
    let patch = bed(1, 2e-3, 100.0);
    let free = [Free::new(umbrella(), 0.02)];
    let weight = 0.02 * G;
    for (x, y, tilt) in [(0.0, 0.0, 0.0), (0.4e-3, -0.1e-3, 0.1)] {
        let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.8, 0.0), tilt);
        let start = Pose::new(turn, DVec3::new(x, y, 5e-3));
        let rest = settle(&free, &on_bed(&patch), DOWN, &[start]);
        let found = rest.solutions[0];
        assert_eq!(found.outcome, Outcome::AtRest);
        assert!(found.imbalance <= BALANCED);
        // The centre of the ball is √2 radii below the apex.
        let expected = 2f64.sqrt() * 1e-3 - weight / 100.0;
        let error = (found.pose.translation - expected * DVec3::Z).length();
        assert!(error < 1e-8, "{error:e}");
        assert!(residual(&patch, &free, &rest) < BALANCED);
        assert_eq!(n_ties(&rest), 1);
        let contact = touched(&patch, &[free[0].model.clone()], &[found.pose]).contacts[0];
        let alone = contact.push(100.0 * contact.deflection).force;
        assert!((alone.z - weight).abs() < 1e-6 * weight);
        let aside = DVec2::new(alone.x, alone.y).length();
        assert!((aside - weight).abs() < 1e-5 * weight, "{alone}");
    }
}

#[test]
fn forces_on_a_grooved_slab_balance_as_a_search_over_all_triangles_computes_them() {
    let patch = bed(16, 4e-3, 100.0);
    let mut n_tied = 0;
    for (k, pitch) in [4e-3, 5e-3, 6.5e-3].into_iter().enumerate() {
        for tilt in [0.0, 0.04] {
            let free = [Free::new(grooved(5, pitch), 0.03 + 0.02 * k as f64)];
            let turn = DQuat::from_rotation_z(0.1 * k as f64) * DQuat::from_rotation_y(tilt);
            let start = Pose::new(turn, DVec3::new(0.7e-3, 0.4e-3, 4e-3));
            let rest = settle(&free, &on_bed(&patch), DOWN, &[start]);
            assert_eq!(rest.solutions[0].outcome, Outcome::AtRest, "{pitch}");
            let residual = residual(&patch, &free, &rest);
            assert!(residual <= BALANCED, "{residual:e}");
            n_tied += n_ties(&rest);
        }
    }
    assert!(n_tied > 5, "{n_tied}");
}

/// Scans press some taxels with two facets at once. Such taxels decide the balance of lateral forces and torques.
#[test]
fn forces_on_dropped_scans_balance_as_a_search_over_all_triangles_computes_them() {
    let Some(folder) = reference_data::folder("BUBBLETOUCH_YCB") else {
        return;
    };
    let scan = |name: &str, mass: f64| {
        let mesh = scans::scan(&folder.join(format!("{name}.ply")));
        Free::new(MeshModel::new(mesh).into(), mass)
    };
    let patch = bed(48, 4e-3, 100.0);
    let drops = [
        (("024_bowl", 0.147), ("058_golf_ball", 0.046)),
        (("024_bowl", 0.147), ("062_dice", 0.005)),
        (("026_sponge", 0.0062), ("062_dice", 0.005)),
    ];
    let mut n_tied = 0;
    for (lower, upper) in drops {
        let free = [lower, upper].map(|(name, mass)| scan(name, mass));
        let mut top = 3e-3;
        let starts: Vec<Pose> = free
            .iter()
            .map(|free| {
                let (bounds, middle) = (free.model.bounds(), free.model.bounds().center());
                let start = at(1e-3 - middle.x, -middle.y, top - bounds.min.z);
                top += bounds.size().z + 3e-3;
                start
            })
            .collect();
        let rest = settle(&free, &on_bed(&patch), DOWN, &starts);
        for found in &rest.solutions {
            assert_eq!(found.outcome, Outcome::AtRest, "{lower:?} {upper:?}");
        }
        let residual = residual(&patch, &free, &rest);
        assert!(residual <= BALANCED, "{lower:?} {upper:?}: {residual:e}");
        n_tied += n_ties(&rest);
    }
    assert!(n_tied > 0);
}
