//! Bodies in the air: how far they certainly fall before they meet something.

use super::body::Body;
use super::free_object::Ground;
use super::pairs::{Key, Pairs, Rigid};
use glam::DVec3;

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
        if gap <= 0.0 || down.dot(plane.normal) < 0.0 {
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

/// Bodies that nothing but one another is near to: those that fall together, list by list.
pub(super) fn airborne(pairs: &Pairs, n_bodies: usize) -> Vec<Vec<usize>> {
    let mut leader: Vec<usize> = (0..n_bodies).collect();
    let mut is_held = vec![false; n_bodies];
    for pair in &pairs.all {
        match pair.key {
            Key::Rigid((one, _), Rigid::Body((other, _))) => {
                let [one, other] = [one, other].map(|body| leader[body as usize]);
                leader
                    .iter_mut()
                    .filter(|l| **l == other)
                    .for_each(|l| *l = one);
            }
            _ => pair.ends().for_each(|(body, ..)| is_held[body] = true),
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
