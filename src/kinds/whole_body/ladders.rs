//! What a step costs by the size of skin, touch and object: rungs of sleeves under a cushion of spheres.

use super::drive::{Drive, Driven, PosedBody};
use super::objects::cushion;
use super::path::Path;
use super::plan::WholeBodyPlan;
use super::rows::{BodyCase, Series};
use super::sleeves::Sleeve;
use super::spec::LaddersSpec;
use crate::error::Result;
use crate::geometry::Pose;
use glam::DVec3;

/// Patches around and along a sleeve of the ladder of skins, ten, so that 100,000 taxels are one sleeve of patches of 10,000; and
/// of the other ladders, where the touch needs more room: as large as a trunk.
const SMALL: (usize, usize) = (5, 2);
const LARGE: (usize, usize) = (9, 4);
/// Share of a sleeve's taxels that a touch may cover, at most: there must be room for the cushion.
const MOST_TOUCHED: f64 = 0.4;
/// The cushion swings by so many radians about the sleeve's axis, and slides by such a share of its side, each half second.
const SWING: f64 = 0.05;
const SLIDE: f64 = 0.02;
const PERIOD: f64 = 0.5;
/// Halvings of the search for the depth at which so many taxels are touched.
const N_HALVINGS: usize = 40;

/// A rung: how much skin, how much of it touched, by how many spheres.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rung {
    pub series: Series,
    pub name: String,
    sleeve: (usize, usize),
    n_taxels: usize,
    n_touched: usize,
    n_spheres: usize,
}

/// All rungs, ladder by ladder.
pub(super) fn rungs(wanted: &LaddersSpec) -> Vec<Rung> {
    let n_spheres = wanted.spheres[0];
    let mut rungs = Vec::new();
    for &n_touched in &wanted.touched_at_taxels {
        for &n_taxels in &wanted.taxels {
            let sleeve = SMALL.0 * SMALL.1 * 10_000;
            if n_touched as f64 <= MOST_TOUCHED * n_taxels.min(sleeve) as f64 {
                rungs.push(Rung {
                    series: Series::Skin,
                    name: format!("{n_taxels} taxels, {n_touched} touched"),
                    sleeve: SMALL,
                    n_taxels,
                    n_touched,
                    n_spheres,
                });
            }
        }
    }
    let n_taxels = wanted.taxels_at_touch;
    let large = |series, name, n_touched, n_spheres| Rung {
        series,
        name,
        sleeve: LARGE,
        n_taxels,
        n_touched,
        n_spheres,
    };
    for &n_touched in &wanted.touched {
        let name = format!("{n_touched} touched");
        rungs.push(large(Series::Touch, name, n_touched, n_spheres));
    }
    for &n_spheres in &wanted.spheres {
        let name = format!("{n_spheres} spheres");
        let n_touched = wanted.touched_at_spheres;
        rungs.push(large(Series::Spheres, name, n_touched, n_spheres));
    }
    rungs
}

/// Climbs a rung.
pub(super) fn climb(plan: &WholeBodyPlan, rung: &Rung) -> Result<(BodyCase, Driven)> {
    let sleeve = Sleeve::of_body(rung.n_taxels, rung.sleeve, plan.pitch);
    let (body, poses) = sleeve.body(rung.n_taxels, plan.taxel, plan.pitch)?;
    let side = plan.pitch * (rung.n_touched as f64).sqrt();
    // Its spheres are where a taxel's own sphere begins.
    let object = cushion(rung.n_spheres, side, sleeve.radius() + plan.taxel.radius)?;
    let posed = PosedBody { body: &body, poses };
    let path = Path {
        world_from_link: Pose::IDENTITY,
        start: Pose::IDENTITY,
        moves: SLIDE * side * DVec3::Z,
        swing: SWING,
        period: PERIOD,
    };
    let mut drive = Drive::new(&posed, &object, path);
    // A cushion that goes deeper than the stroke only saturates more.
    let (mut out, mut deep) = (0.0, plan.taxel.stroke);
    for _ in 0..N_HALVINGS {
        let depth = 0.5 * (out + deep);
        let pressed = path.shifted(-depth * DVec3::X);
        match drive.probe(&pressed).n_touched < rung.n_touched {
            true => out = depth,
            false => deep = depth,
        }
    }
    drive.path = path.shifted(-deep * DVec3::X);
    let case = BodyCase {
        series: rung.series,
        name: rung.name.clone(),
        n_taxels: body.n_taxels(),
        n_patches: body.patches().len(),
        n_spheres: drive.n_spheres(),
    };
    Ok((case, drive.run(plan.n_steps(), plan.dt, &[])?))
}
