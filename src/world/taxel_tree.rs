//! A tree of boxes over the taxels of a patch, so that a sphere looks only at those that it can reach.
//!
//! A sphere (c, R) pushes a taxel (rest centre p, axis n, radius ρ, stroke s) only from in front of its substrate,
//! `(c − p)·n ≥ −s − ρ`, and from less than S = ρ + R beside its axis. So c is less than S away from the taxel's stretch, from
//! p back to p − (s + ρ) n. The boxes are around stretches.

use super::{Layout, Taxels};
use crate::geometry::Aabb;
use glam::DVec3;
use std::ops::Range;

/// Taxels in a leaf, at most. More: taxels are looked at in vain; fewer: more boxes are.
const LEAF: usize = 8;
/// What rounding may add to a reach, far above 1e-16 and far below what is felt.
const ROUNDING: f64 = 1.0 + 1e-9;

/// The taxels of a patch, neighbours together.
#[derive(Clone, Debug)]
pub(crate) struct TaxelTree {
    /// Each before all that are below it.
    nodes: Vec<Node>,
    taxels: Vec<PlacedTaxel>,
    /// The largest s + ρ, metres.
    depth: f64,
}

/// A taxel with what its contact needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedTaxel {
    /// Its number in the layout.
    pub number: u32,
    /// p, metres.
    pub center: DVec3,
    /// Unit vectors across the axis; X and Y for a taxel along Z, so that a flat patch is computed as a grid is.
    pub across: [DVec3; 2],
    /// n, unit.
    pub axis: DVec3,
    /// ρ, metres.
    pub radius: f64,
    /// −s − ρ, metres: what is lower along the axis is behind the substrate.
    pub behind: f64,
}

/// A box around the stretches of some taxels.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// The largest ρ, metres.
    radius: f64,
    /// Taxels of a leaf; none for others.
    first: u32,
    n_taxels: u32,
    /// The first node that is not below this one.
    next: u32,
}

impl TaxelTree {
    pub fn new(layout: &Layout, taxels: &Taxels) -> Self {
        let all: Vec<PlacedTaxel> = (0..layout.n_taxels())
            .map(|number| PlacedTaxel::of(layout, taxels, number))
            .collect();
        let mut tree = Self {
            nodes: Vec::new(),
            depth: all.iter().map(|taxel| -taxel.behind).fold(0.0, f64::max),
            taxels: all,
        };
        if !tree.taxels.is_empty() {
            tree.split(0..tree.taxels.len());
        }
        tree
    }

    /// The box around the stretches of all taxels, metres; `None` if there are none.
    pub fn bounds(&self) -> Option<&Aabb> {
        self.nodes.first().map(|root| &root.bounds)
    }

    /// The largest ρ, metres.
    pub fn largest_radius(&self) -> f64 {
        self.nodes.first().map_or(0.0, |root| root.radius)
    }

    /// The largest s + ρ, metres.
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// Whether a ball can push a taxel, or comes near to it; metres, in the patch frame.
    #[inline]
    pub fn is_near(&self, center: DVec3, radius: f64) -> bool {
        let root = self.nodes.first();
        root.is_some_and(|root| root.is_near(center, radius))
    }

    /// Calls `visit` with each taxel that a ball can push, and with some others; metres, in the patch frame.
    #[inline]
    pub fn each_near(&self, center: DVec3, radius: f64, mut visit: impl FnMut(&PlacedTaxel)) {
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            if !node.is_near(center, radius) {
                index = node.next as usize;
                continue;
            }
            let taxels = &self.taxels[node.first as usize..][..node.n_taxels as usize];
            taxels.iter().for_each(&mut visit);
            index += 1;
        }
    }

    /// Makes the nodes of a range of taxels, halved across its longest side.
    fn split(&mut self, range: Range<usize>) {
        let index = self.nodes.len();
        self.nodes.push(Node::around(&self.taxels[range.clone()]));
        if range.len() <= LEAF {
            self.nodes[index].first = range.start as u32;
            self.nodes[index].n_taxels = range.len() as u32;
        } else {
            let side = self.nodes[index].bounds.size().max_position();
            let taxels = &mut self.taxels[range.clone()];
            let half = taxels.len() / 2;
            // Ties by number: the tree depends on nothing but the taxels.
            taxels.select_nth_unstable_by(half, |a, b| {
                let order = a.center[side].total_cmp(&b.center[side]);
                order.then(a.number.cmp(&b.number))
            });
            self.split(range.start..range.start + half);
            self.split(range.start + half..range.end);
        }
        self.nodes[index].next = self.nodes.len() as u32;
    }
}

impl Node {
    fn around(taxels: &[PlacedTaxel]) -> Self {
        Self {
            bounds: Aabb::around(taxels.iter().map(PlacedTaxel::stretch))
                .expect("no node is empty"),
            radius: taxels.iter().map(|t| t.radius).fold(0.0, f64::max),
            first: 0,
            n_taxels: 0,
            next: 0,
        }
    }

    #[inline]
    fn is_near(&self, center: DVec3, radius: f64) -> bool {
        let reach = (self.radius + radius) * ROUNDING;
        self.bounds.distance_squared(center) <= reach * reach
    }
}

impl PlacedTaxel {
    /// A taxel of a layout by its number.
    pub fn of(layout: &Layout, taxels: &Taxels, number: usize) -> Self {
        let frame = layout.frame(number);
        let taxel = taxels.at(number);
        Self {
            number: number as u32,
            center: layout.centers()[number],
            across: [frame.x_axis, frame.y_axis],
            axis: frame.z_axis,
            radius: taxel.radius,
            behind: -taxel.stroke - taxel.radius,
        }
    }

    /// The box around the stretch from its rest centre back to where its substrate is.
    fn stretch(&self) -> Aabb {
        let end = self.center + self.behind * self.axis;
        Aabb {
            min: self.center.min(end),
            max: self.center.max(end),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use crate::world::Taxel;
    use rand::Rng;

    #[test]
    fn no_taxel_that_a_ball_can_push_is_left_out() {
        let mut rng = Seed::new(1).named("taxel tree").rng();
        let mut direction = || {
            let mut random = || rng.gen_range(-1.0..1.0);
            DVec3::new(random(), random(), random()).normalize_or(DVec3::X)
        };
        let n = 3000;
        let centers: Vec<DVec3> = (0..n).map(|_| 0.05 * direction()).collect();
        // Half of the axes point outwards, as on a ball, and half anywhere.
        let axis = |k: usize| {
            if k.is_multiple_of(2) {
                20.0 * centers[k]
            } else {
                direction()
            }
        };
        let axes: Vec<DVec3> = (0..n).map(axis).map(DVec3::normalize).collect();
        let layout = Layout::new(centers, axes).unwrap();
        let taxels = (0..n).map(|k| Taxel {
            radius: 1e-3 + 1e-6 * k as f64,
            stiffness: 1.0,
            damping: 0.0,
            stroke: 6e-3 - 1e-6 * k as f64,
        });
        let tree = TaxelTree::new(&layout, &Taxels::Each(taxels.collect()));
        let mut n_pushed = 0;
        let mut n_visited = 0;
        for case in 0..300 {
            let mut rng = Seed::new(2).numbered(case).rng();
            let mut random = || rng.gen_range(-0.08..0.08);
            let center = DVec3::new(random(), random(), random());
            let radius = 10f64.powf(rng.gen_range(-6.0..-1.5));
            let mut is_visited = vec![false; n];
            tree.each_near(center, radius, |taxel| {
                is_visited[taxel.number as usize] = true
            });
            n_visited += is_visited.iter().filter(|&&v| v).count();
            for taxel in &tree.taxels {
                let height = (center - taxel.center).dot(taxel.axis);
                let beside2 = center.distance_squared(taxel.center) - height * height;
                let q = (radius + taxel.radius).powi(2) - beside2;
                if q > 0.0 && q.sqrt() > height && height >= taxel.behind {
                    n_pushed += 1;
                    assert!(is_visited[taxel.number as usize], "case {case}");
                }
            }
        }
        assert!(n_pushed > 1000, "{n_pushed}");
        assert!(n_visited < 300 * n / 4, "most are left out: {n_visited}");
    }

    #[test]
    fn a_flat_taxel_has_the_axes_of_the_patch() {
        let layout = Layout::new(vec![DVec3::ZERO], vec![DVec3::Z]).unwrap();
        let taxel = Taxel {
            radius: 1e-3,
            stiffness: 1.0,
            damping: 0.0,
            stroke: 5e-3,
        };
        let tree = TaxelTree::new(&layout, &Taxels::Equal(taxel));
        assert_eq!(tree.taxels[0].across, [DVec3::X, DVec3::Y]);
    }
}
