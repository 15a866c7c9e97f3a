//! Bodies in the air: how far they certainly fall before they meet something.

use super::body::Body;
use super::energy::Energy;
use super::free_object::Ground;
use super::pairs::{Key, Pair, Rigid};
use glam::DVec3;

/// Less of the way down than this is along a wall.
const STEEP: f64 = 1e-9;

/// What is below a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fall {
    /// Something is too near to say.
    Near,
    /// Nothing for this far, metres.
    Free(f64),
    /// Nothing at all.
    Endless,
}

/// What a body meets on its way `down` (unit): skin, what is rigid, and `others`.
pub(super) fn fall(body: &Body, ground: &Ground, others: &[&Body], down: DVec3) -> Fall {
    let mut way = f64::INFINITY;
    for skin in ground.skins {
        let Some(bounds) = skin.patch.tree().bounds() else {
            continue;
        };
        let to_patch = skin.world_from_patch.inverse();
        let center = to_patch.transform_point(body.center);
        let reach = body.arm() + skin.patch.tree().largest_radius();
        let gap = bounds.distance_squared(center).sqrt() - reach;
        let entry = bounds
            .widened(reach)
            .entry(center, to_patch.transform_vector(down), 0.0);
        if gap <= 0.0 || entry.is_finite() {
            way = way.min(gap);
        }
    }
    for plane in ground.planes {
        let gap = body.center.dot(plane.normal) - plane.height - body.arm();
        // Along a wall it falls for ever.
        if down.dot(plane.normal) < -STEEP {
            way = way.min(gap);
        }
    }
    let obstacles = ground.obstacles.iter().map(|obstacle| {
        let center = obstacle.spheres.bounds().center();
        let radius = obstacle.spheres.reach_from(center);
        (obstacle.pose.transform_point(center), radius)
    });
    let others = others.iter().map(|other| (other.center, other.arm()));
    for (center, radius) in obstacles.chain(others) {
        let (to, reach) = (center - body.center, radius + body.arm());
        let gap = to.length() - reach;
        let beside = (to - to.dot(down) * down).length();
        if gap <= 0.0 || beside < reach && to.dot(down) > 0.0 {
            way = way.min(gap);
        }
    }
    match way {
        f64::INFINITY => Fall::Endless,
        way if way <= 0.0 => Fall::Near,
        way => Fall::Free(way),
    }
}

/// Bodies that nothing but one another carries, list by list of those that fall together.
pub(super) fn airborne(energy: &Energy, n_bodies: usize) -> Vec<Vec<usize>> {
    let mut leader: Vec<usize> = (0..n_bodies).collect();
    let mut is_held = vec![false; n_bodies];
    let Energy { pairs, loads, .. } = energy;
    for (group, load) in pairs.groups.iter().zip(&loads.all) {
        match group.key {
            Key::Rigid((one, _), Rigid::Body((other, _))) => {
                let [one, other] = [one, other].map(|body| leader[body as usize]);
                let others = leader.iter_mut().filter(|leader| **leader == other);
                others.for_each(|leader| *leader = one);
            }
            _ if load.force > 0.0 => {
                let ends = pairs.all[group.pairs.clone()].iter().flat_map(Pair::ends);
                ends.for_each(|(body, ..)| is_held[body] = true);
            }
            _ => {}
        }
    }
    let together = (0..n_bodies).map(|first| {
        let all = (0..n_bodies).filter(|&body| leader[body] == first);
        all.collect::<Vec<_>>()
    });
    together
        .filter(|all| !all.is_empty() && !all.iter().any(|&body| is_held[body]))
        .collect()
}
