//! The spheres of a free object and the taxels that they push, or could after a small step.

use super::super::taxel_contact::GRAZING;
use super::free_object::{FreeObject, PlacedSkin};
use super::reach::Reach;
use crate::geometry::Pose;
use glam::{DMat3, DVec3};

/// A skin's number and a taxel's in it.
pub(super) type Key = (u32, u32);

/// The sphere of a pair that is none of the free object's: how far other objects push the taxel.
pub(super) const OTHERS: u32 = u32::MAX;

/// A sphere and a taxel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub key: Key,
    pub sphere: u32,
    /// Metres; negative if they do not touch yet.
    pub deflection: f64,
    /// `None` of other objects.
    pub reach: Option<Reach>,
    /// From the centre of mass to the sphere's centre, in the patch frame.
    pub arm: DVec3,
}

/// How much more than what presses is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margins {
    /// How far spheres may move and still be known to meet a taxel, metres.
    pub step: f64,
    /// Spheres that push a taxel less far than the deepest by more than this do not count, metres.
    pub window: f64,
}

/// Pairs at one pose.
///
/// A sphere behind a taxel's substrate does not push it. It also does not while it comes up from there: else it would meet a
/// cliff where the substrate is, on which an object could hang. So such pairs are remembered until they are apart.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    /// Those that push or could, sorted by taxel and sphere.
    pub all: Vec<Pair>,
    /// Those that do not since the sphere came from behind; sorted.
    pub behind: Vec<(Key, u32)>,
    deepest: Vec<f64>,
}

impl Pairs {
    /// Looks at the object at a pose (`world_from_object`); `behind`: what was behind before.
    pub fn look(
        &mut self,
        object: &FreeObject,
        skins: &[PlacedSkin],
        pose: &Pose,
        margins: Margins,
        behind: &[(Key, u32)],
    ) {
        self.all.clear();
        self.behind.clear();
        for (number, skin) in skins.iter().enumerate() {
            self.gather(object, (number as u32, skin), pose, margins, behind);
        }
        self.behind.sort_unstable();
    }

    fn gather(
        &mut self,
        object: &FreeObject,
        (number, skin): (u32, &PlacedSkin),
        pose: &Pose,
        margins: Margins,
        behind: &[(Key, u32)],
    ) {
        let Self {
            all: pairs,
            behind: now_behind,
            deepest,
        } = self;
        let patch_from_object = pose.seen_from(&skin.world_from_patch);
        let rotation = DMat3::from_quat(patch_from_object.rotation);
        let center_of_mass = patch_from_object.transform_point(object.center_of_mass);
        let tree = skin.patch.tree();
        let Some(bounds) = tree.bounds() else { return };
        // A sphere may move by twice the step: along it, and by turning.
        let more = GRAZING * tree.depth() + 2.0 * margins.step;
        let away = bounds.distance_squared(center_of_mass).sqrt();
        if away > object.radius + tree.largest_radius() + more {
            return;
        }
        let first = pairs.len();
        deepest.clear();
        deepest.resize(skin.patch.n_taxels(), 0.0);
        for (index, sphere) in object.spheres.iter().enumerate() {
            let center = rotation * sphere.center + patch_from_object.translation;
            tree.each_near(center, sphere.radius + more, |taxel| {
                let found = Reach::new(center, sphere.radius, taxel, 2.0 * margins.step);
                let Some(reach) = found else { return };
                let (key, index) = ((number, taxel.number), index as u32);
                if reach.is_behind(taxel, center) || behind.binary_search(&(key, index)).is_ok() {
                    now_behind.push((key, index));
                    return;
                }
                let deepest = &mut deepest[taxel.number as usize];
                if reach.deflection >= *deepest - margins.window {
                    *deepest = deepest.max(reach.deflection);
                    pairs.push(Pair {
                        key,
                        sphere: index,
                        deflection: reach.deflection,
                        reach: Some(reach),
                        arm: center - center_of_mass,
                    });
                }
            });
        }
        for (taxel, (deepest, &others)) in deepest.iter_mut().zip(skin.pushed).enumerate() {
            if *deepest > 0.0 && others > 0.0 {
                *deepest = deepest.max(others);
                pairs.push(Pair {
                    key: (number, taxel as u32),
                    sphere: OTHERS,
                    deflection: others,
                    reach: None,
                    arm: DVec3::ZERO,
                });
            }
        }
        let mut kept = first;
        for index in first..pairs.len() {
            let pair = pairs[index];
            // Of a taxel that nothing pushes yet, all that could.
            let deepest = deepest[pair.key.1 as usize];
            if deepest == 0.0 || pair.deflection >= deepest - margins.window {
                pairs[kept] = pair;
                kept += 1;
            }
        }
        pairs.truncate(kept);
        pairs[first..].sort_unstable_by_key(|pair| (pair.key, pair.sphere));
    }
}
