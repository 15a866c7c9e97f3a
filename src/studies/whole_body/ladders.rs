//! Scaling series: computing time per step while the skin, the touch or the object grows. The skin consists of equal cylinders ("sleeves") far apart. A square
//! of spheres (cushion), bent around the first sleeve, touches it.

use crate::studies::prelude::*;
use crate::studies::whole_body::drive::{Drive, Posture, cushion};
use crate::studies::whole_body::plan::*;
use crate::studies::whole_body::rows::*;
use crate::studies::whole_body::spec::*;
use crate::whole_body::WholeBody;
use crate::world::{Extrusion, Oscillation, Patch};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Numbers of patches around and along a cylindrical sleeve of skin, from the smallest to the largest sleeve. With ten patches of 10,000 taxels each, 100,000
/// taxels are one sleeve. The series of growing touches and of growing objects begin with the second sleeve, which is as large as a trunk.
const SLEEVES: [(usize, usize); 3] = [(5, 2), (9, 4), (18, 8)];
/// Number of taxels of a patch on a skin that is larger than its first sleeve.
const PATCH_TAXELS: usize = 10_000;
/// Largest relative difference between the number of touched taxels that a size asks for and the measured mean. The depth is found at the start of the path; the
/// mean over the path differs from it by about 1 %.
const SAME_TOUCH: f64 = 0.05;
/// Amplitude of the rotation of the square of spheres about the sleeve's axis, radians.
const SWING: f64 = 0.05;
/// Amplitude of the translation of the square of spheres along the sleeve, as a fraction of the side length of the square.
const SLIDE: f64 = 0.02;
/// Period of the oscillation of the square of spheres, seconds.
const PERIOD: f64 = 0.5;
/// Number of bisections in the search for the press depth at which the required number of taxels is touched.
const N_HALVINGS: usize = 40;

/// One size in a scaling series: the numbers of taxels, of touched taxels and of spheres that the study asks for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct ScalingPoint {
    pub series: Series,
    /// Name of the work item.
    pub name: String,
    sleeve: (usize, usize),
    n_taxels: usize,
    n_touched: usize,
    n_spheres: usize,
}

/// Returns all sizes of all scaling series in the specification.
pub(super) fn rungs(wanted: &LaddersSpec) -> Vec<ScalingPoint> {
    let mut rungs = Vec::new();
    for &n_touched in &wanted.touched_at_taxels {
        let has_room = |n: &&usize| n_touched <= LaddersSpec::max_touched(**n);
        rungs.extend(
            wanted
                .taxels
                .iter()
                .filter(has_room)
                .map(|&n_taxels| ScalingPoint {
                    series: Series::Skin,
                    name: format!("{n_taxels} taxels, {n_touched} touched"),
                    sleeve: sleeve(&SLEEVES, n_touched),
                    n_taxels,
                    n_touched,
                    n_spheres: wanted.spheres[0],
                }),
        );
    }
    let large = |series, name, n_touched, n_spheres| ScalingPoint {
        series,
        name,
        sleeve: sleeve(&SLEEVES[1..], n_touched),
        n_taxels: wanted.taxels_at_touch,
        n_touched,
        n_spheres,
    };
    rungs.extend(wanted.touched.iter().map(|&n| {
        let name = format!("{n} touched");
        large(Series::Touch, name, n, wanted.spheres[0])
    }));
    rungs.extend(wanted.spheres.iter().map(|&n| {
        let name = format!("{n} spheres");
        large(Series::Spheres, name, wanted.touched_at_spheres, n)
    }));
    rungs
}

/// Returns the smallest of the given sleeves that has room for a touch of `n_touched` taxels, or the largest one.
fn sleeve(sleeves: &[(usize, usize)], n_touched: usize) -> (usize, usize) {
    let has_room = |(around, along): &&(usize, usize)| {
        n_touched <= LaddersSpec::max_touched(around * along * PATCH_TAXELS)
    };
    let smallest = sleeves.iter().find(has_room);
    *smallest.unwrap_or(&sleeves[sleeves.len() - 1])
}

impl ScalingPoint {
    /// Returns the name of the measured case, and the number of touched taxels that cases of a series share. The number is the one that the study asks for,
    /// unless the measured mean of `touched` differs from it.
    fn measured(&self, n_taxels: usize, touched: f64) -> (String, usize) {
        let asked = self.n_touched as f64;
        let n_touched = match (touched - asked).abs() <= SAME_TOUCH * asked {
            true => self.n_touched,
            false => touched.round() as usize,
        };
        let name = match self.series {
            Series::Skin => format!("{n_taxels} taxels, {n_touched} touched"),
            Series::Touch => format!("{n_touched} touched"),
            Series::Spheres | Series::Scene => self.name.clone(),
        };
        (name, n_touched)
    }
}

/// Simulates one size of a scaling series and measures its computing times.
pub(super) fn climb(plan: &WholeBodyPlan, rung: &ScalingPoint) -> Result<Driven> {
    let sleeve = Sleeve::of_body(rung.n_taxels, rung.sleeve, plan.pitch);
    let (body, patches) = sleeve.body(rung.n_taxels, plan.taxel, plan.pitch)?;
    let side = plan.pitch * (rung.n_touched as f64).sqrt();
    // The inner surface of the cushion lies at the radius of the taxel spheres.
    let object = cushion(rung.n_spheres, side, sleeve.radius() + plan.taxel.radius)?;
    let posture = Posture {
        body: &body,
        patches,
        links: vec![Pose::IDENTITY],
    };
    let aim = Aim {
        link: 0,
        from: DVec3::X,
        motion: Oscillation {
            start: Pose::IDENTITY,
            linear: SLIDE * side * DVec3::Z,
            angular: SWING * DVec3::Z,
            period: PERIOD,
        },
    };
    let mut drive = Drive::new(&posture, &object, &aim)?;
    let path = drive.path;
    // Beyond the stroke, a deeper cushion only saturates more taxels.
    let (mut out, mut deep) = (0.0, plan.taxel.stroke);
    for _ in 0..N_HALVINGS {
        let depth = 0.5 * (out + deep);
        let probed = drive.probe(path.shifted(-depth * aim.from))?;
        match probed.n_touched < rung.n_touched {
            true => out = depth,
            false => deep = depth,
        }
    }
    drive.path = path.shifted(-deep * aim.from);
    let mut driven = drive.run(plan, (rung.series, &rung.name), &[])?;
    let (name, n_touched) = rung.measured(driven.case.n_taxels, driven.count.touched_mean);
    driven.case.name = name;
    driven.n_touched = Some(n_touched);
    Ok(driven)
}

/// Cylinder covered with skin: the numbers of patches around and along it, and the side length of a patch, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sleeve {
    n_around: usize,
    n_along: usize,
    side: f64,
}

/// Distance between the axes of neighbouring cylinders, metres.
const APART: f64 = 1.0;

impl Sleeve {
    /// Returns a sleeve of patches with 100 × 100 taxels each. If the skin has fewer taxels than such a sleeve, the patches are smaller.
    fn of_body(n_taxels: usize, (n_around, n_along): (usize, usize), pitch: f64) -> Self {
        let a_patch = n_taxels as f64 / (n_around * n_along) as f64;
        let a_patch = a_patch.min(PATCH_TAXELS as f64);
        Self {
            n_around,
            n_along,
            side: pitch * a_patch.sqrt().round(),
        }
    }

    /// Returns the radius of the sleeve: distance from the axis of the sleeve to the rest centres of the taxels, metres.
    fn radius(&self) -> f64 {
        self.n_around as f64 * self.side / TAU
    }

    /// Returns a skin of about `n_taxels` taxels on cylinders (sleeves), which are parallel to the z axis and stand in rows of twenty. The first sleeve is at
    /// the origin, and the last one may have fewer patches.
    fn body(&self, n_taxels: usize, taxel: Taxel, pitch: f64) -> Result<(WholeBody, Vec<Pose>)> {
        let (radius, length) = (self.radius(), self.side - pitch);
        let part = Extrusion::cylinder(radius, length, length / radius, pitch)?;
        let n_patches = (n_taxels as f64 / part.n_taxels() as f64).round().max(1.0) as usize;
        let patches =
            (0..n_patches).map(|number| Patch::new(format!("patch {number}"), part.clone(), taxel));
        let poses = (0..n_patches).map(|number| self.pose(number)).collect();
        Ok((
            WholeBody::new(&patches.collect::<Result<Vec<_>>>()?)?,
            poses,
        ))
    }

    fn pose(&self, number: usize) -> Pose {
        let a_sleeve = self.n_around * self.n_along;
        let (sleeve, place) = (number / a_sleeve, number % a_sleeve);
        let (row, column) = ((sleeve / 20) as f64, (sleeve % 20) as f64);
        let turn = TAU * (place % self.n_around) as f64 / self.n_around as f64;
        let ring = (place / self.n_around) as f64;
        let height = (ring - 0.5 * (self.n_along - 1) as f64) * self.side;
        let place = DVec3::new(APART * row, APART * column, height);
        Pose::new(DQuat::from_rotation_z(turn), place)
    }
}
