//! Pairs of spheres of free objects and the taxels or rigid contacts that they push, or could push after a small step.
//!
//! A rigid contact is treated as a taxel without a spring at the end of its stroke. The penetration of the sphere is treated as the deflection, and the
//! contact force as the force at the end of the stroke. Taxels and rigid contacts thus share one pair type.

use super::super::taxel_contact::GRAZING;
use super::body::Body;
use super::free_object::{Ground, PlacedSkin};
use super::meshes::{Depth, MeshOnSkin};
use super::pair::{Key, Kind, OTHERS, Pair, Part};
use super::reach::Reach;
use super::rigid_pairs::gather_rigid;
use super::rigid_shape::RigidShape;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Taxel or rigid contact, with all spheres that push against it.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub key: Key,
    pub pairs: Range<usize>,
    /// Stiffness of the taxel, N/m; 0 for a rigid contact.
    pub stiffness: f64,
    /// Remaining stroke of the taxel from its relaxed deflection, metres; 0 for a rigid contact.
    pub stroke: f64,
    /// Deflection of the taxel due to objects that are fixed or move along a given path, metres.
    pub others: f64,
    /// Weight of the lightest body that pushes the taxel, newtons.
    pub weight: f64,
}

/// Margins for collecting pairs of spheres and taxels that are not in contact yet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margins {
    /// Distance that the spheres may move without touching a taxel whose pair was not collected, metres.
    pub step: f64,
    /// Largest difference between the largest required deflection of a taxel and the deflections of its other spheres, metres. Spheres with a larger
    /// difference are omitted.
    pub window: f64,
    /// Penetrations of rigid meshes.
    pub depth: Depth,
}

/// Pairs of spheres and taxels or rigid counterparts at the present poses of all bodies.
///
/// A sphere behind a taxel's substrate does not push the taxel, even if the sphere later moves to the front of the substrate. Otherwise the energy would jump
/// at the substrate, and an object could hang on this jump. The list `behind` contains these pairs until sphere and taxel separate.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    /// Pairs that push or could push, sorted by taxel or rigid contact and then by sphere.
    pub all: Vec<Pair>,
    pub groups: Vec<Group>,
    /// Pairs without force because the sphere was behind the substrate of the taxel; sorted.
    pub behind: Vec<(Key, Part)>,
    deepest: Vec<f64>,
}

impl Pairs {
    /// Collects the pairs at the present poses of the bodies; `behind` lists the pairs whose sphere was behind the substrate of the taxel before, and `held` the
    /// contacts of rigid meshes that remain contacts until their parts miss each other clearly.
    pub fn look(
        &mut self,
        bodies: &[Body],
        ground: &Ground,
        margins: Margins,
        (behind, held): (&[(Key, Part)], &[Key]),
    ) {
        self.all.clear();
        self.behind.clear();
        for (number, skin) in ground.skins.iter().enumerate() {
            self.gather(bodies, (number as u32, skin), margins, behind);
        }
        self.behind.sort_unstable();
        let range = (2.0 * margins.step, margins.depth);
        gather_rigid(&mut self.all, bodies, ground, range, held);
        self.groups.clear();
        let mut first = 0;
        for of_key in self.all.chunk_by(|a, b| a.key == b.key) {
            let pairs = first..first + of_key.len();
            first = pairs.end;
            self.groups.push(group(of_key, pairs, bodies, ground));
        }
    }

    /// Returns the largest penetration of all rigid contacts, metres; at least 0.
    pub fn penetration(&self) -> f64 {
        let is_rigid = |pair: &&Pair| matches!(pair.key, Key::Rigid(..));
        let rigid = self.all.iter().filter(is_rigid);
        rigid.map(|pair| pair.deflection).fold(0.0, f64::max)
    }

    /// Returns the rigid contacts, sorted.
    pub fn rigid(&self) -> impl Iterator<Item = Key> {
        let keys = self.groups.iter().map(|group| group.key);
        keys.filter(|key| matches!(key, Key::Rigid(..)))
    }

    /// Returns, for each of `n_bodies` bodies, the number of its island (group of bodies in contact). Bodies that touch one another or push a common taxel
    /// form an island.
    pub fn islands(&self, n_bodies: usize) -> Vec<usize> {
        let mut islands: Vec<usize> = (0..n_bodies).collect();
        for group in &self.groups {
            let mut bodies = self.all[group.pairs.clone()].iter().flat_map(Pair::ends);
            let Some((first, ..)) = bodies.next() else {
                continue;
            };
            for (other, ..) in bodies {
                let [one, other] = [first, other].map(|body| islands[body]);
                if one != other {
                    let joined = islands.iter_mut().filter(|island| **island == other);
                    joined.for_each(|island| *island = one);
                }
            }
        }
        islands
    }

    fn gather(
        &mut self,
        bodies: &[Body],
        (number, skin): (u32, &PlacedSkin),
        margins: Margins,
        behind: &[(Key, Part)],
    ) {
        let tree = skin.patch.tree();
        // A sphere can move by twice the step: by translation and by rotation.
        let more = GRAZING * tree.depth() + 2.0 * margins.step;
        let to_patch = skin.world_from_patch.inverse();
        let is_near = |body: &Body| {
            let center = to_patch.transform_point(body.center);
            tree.is_near(center, body.arm() + more)
        };
        if !bodies.iter().any(is_near) {
            return;
        }
        let first = self.all.len();
        self.deepest.clear();
        self.deepest.resize(skin.patch.n_taxels(), 0.0);
        for (slot, body) in bodies.iter().enumerate() {
            if is_near(body) {
                self.gather_body((slot as u32, body), (number, skin), (margins, more), behind);
            }
        }
        self.gather_others(number, skin);
        let Self { all, deepest, .. } = self;
        let mut kept = first;
        for index in first..all.len() {
            let pair = all[index];
            let Key::Taxel(_, taxel) = pair.key else {
                continue;
            };
            // If nothing pushes a taxel yet, all candidates are kept.
            let deepest = deepest[taxel as usize];
            if deepest == 0.0 || pair.deflection >= deepest - margins.window {
                all[kept] = pair;
                kept += 1;
            }
        }
        all.truncate(kept);
        all[first..].sort_unstable_by_key(|pair| (pair.key, pair.part));
    }

    fn gather_body(
        &mut self,
        (slot, body): (u32, &Body),
        (number, skin): (u32, &PlacedSkin),
        (margins, more): (Margins, f64),
        behind: &[(Key, Part)],
    ) {
        let Self {
            all: pairs,
            behind: now_behind,
            deepest,
            ..
        } = self;
        let patch_from_object = body.pose().seen_from(&skin.world_from_patch);
        let rotation = DMat3::from_quat(patch_from_object.rotation);
        let center_of_mass = patch_from_object.transform_point(body.object.center_of_mass);
        let tree = skin.patch.tree();
        if let RigidShape::Mesh(mesh) = body.object.shape {
            let on_skin = MeshOnSkin::new(mesh, &patch_from_object);
            let reach = body.arm() + more;
            tree.each_near(center_of_mass, reach, |taxel| {
                let at = taxel.number as usize;
                let key = Key::Taxel(number, taxel.number);
                let relaxed = skin.relaxed(at);
                on_skin.each(taxel, (2.0 * margins.step, margins.window), |found| {
                    let mut pair = Pair::on_mesh(key, slot, found, center_of_mass);
                    if found.is_behind || behind.binary_search(&(key, pair.part)).is_ok() {
                        now_behind.push((key, pair.part));
                        return;
                    }
                    pair.deflection -= relaxed;
                    if pair.deflection >= deepest[at] - margins.window {
                        deepest[at] = deepest[at].max(pair.deflection);
                        pairs.push(pair);
                    }
                });
            });
        }
        for (sphere, index) in body.object.shape.spheres().iter().zip(0..) {
            let center = rotation * sphere.center + patch_from_object.translation;
            tree.each_near(center, sphere.radius + more, |taxel| {
                let found = Reach::new(center, sphere.radius, taxel, 2.0 * margins.step);
                let Some(reach) = found else { return };
                let (key, part) = (Key::Taxel(number, taxel.number), (slot, index));
                if reach.is_behind(taxel, center) || behind.binary_search(&(key, part)).is_ok() {
                    now_behind.push((key, part));
                    return;
                }
                let at = taxel.number as usize;
                let deflection = reach.deflection - skin.relaxed(at);
                if deflection >= deepest[at] - margins.window {
                    deepest[at] = deepest[at].max(deflection);
                    pairs.push(Pair {
                        key,
                        part,
                        deflection,
                        kind: Kind::Taxel(reach),
                        arm: center - center_of_mass,
                    });
                }
            });
        }
    }

    /// Adds deflections due to objects that are fixed or move along a given path. The deflections are added only for taxels that a free object also pushes.
    fn gather_others(&mut self, number: u32, skin: &PlacedSkin) {
        let deepest = self.deepest.iter_mut().zip(skin.pushed);
        for (taxel, (deepest, others)) in deepest.enumerate() {
            let others = others - skin.relaxed(taxel);
            if *deepest > 0.0 && others > 0.0 {
                *deepest = deepest.max(others);
                self.all.push(Pair {
                    key: Key::Taxel(number, taxel as u32),
                    part: OTHERS,
                    deflection: others,
                    kind: Kind::Fixed,
                    arm: DVec3::ZERO,
                });
            }
        }
    }
}

fn group(pairs: &[Pair], places: Range<usize>, bodies: &[Body], ground: &Ground) -> Group {
    let all = pairs.iter().flat_map(Pair::ends);
    let weights = all.map(|(body, ..)| bodies[body].weight.length());
    let (mut stiffness, mut stroke, mut others) = (0.0, 0.0, 0.0);
    if let Key::Taxel(skin, taxel) = pairs[0].key {
        let (skin, taxel) = (&ground.skins[skin as usize], taxel as usize);
        let relaxed = skin.relaxed(taxel);
        stiffness = skin.stiffness(taxel);
        stroke = skin.patch.taxels().at(taxel).stroke - relaxed;
        let pushed = skin.pushed.get(taxel).copied().unwrap_or(0.0);
        others = (pushed - relaxed).max(0.0);
    }
    Group {
        key: pairs[0].key,
        pairs: places,
        stiffness,
        stroke,
        others,
        weight: weights.fold(f64::INFINITY, f64::min),
    }
}
