//! Tree of bounding boxes over the taxels of a patch, which finds the taxels within reach of a sphere.
//!
//! Let h = (c − p)·n, and b the distance of c from the axis. A sphere (c, R) pushes a taxel (rest centre p, axis n, radius ρ, stroke s) only if b < S = ρ + R.
//! Also, the sphere must not be wholly behind the substrate: `h + √(S² − b²) ≥ −s − ρ`. So the distance of c from the taxel's segment, from p back to p − (s +
//! ρ) n, is less than S. The boxes bound these segments.

use super::layouts::split_across;
use super::{Layout, Taxel, Taxels};
use crate::geometry::Aabb;
use crate::objects::Sphere;
use glam::DVec3;

/// Maximum number of taxels in a leaf, evaluated with one or two vector instructions. If larger, taxels are evaluated needlessly; if smaller, more bounding
/// boxes are tested.
pub(crate) const LEAF: usize = 8;
/// Stroke of taxels without a limit of the deflection, metres.
const ENDLESS: f64 = 1e6;
/// Factor that covers rounding of a sum of radii: far above 1e-16 and far below any measurable difference.
pub(crate) const RADIUS_ROUNDING: f64 = 1.0 + 1e-9;

/// Search tree over the taxels of a patch, grouped by neighbourhood in bounding boxes.
#[derive(Clone, Debug)]
pub struct TaxelTree {
    /// Nodes of the tree; each node precedes all nodes below it.
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// Largest sum of stroke and radius of a taxel, metres.
    depth: f64,
}

/// Taxel with the quantities that the contact law needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedTaxel {
    /// Index of the taxel in the layout.
    pub number: u32,
    /// Centre of the taxel at rest, metres.
    pub center: DVec3,
    /// Unit vectors perpendicular to the axis; X and Y for a taxel along Z, so that a flat patch is computed exactly as a grid.
    pub across: [DVec3; 2],
    /// Axis of the taxel, unit vector.
    pub axis: DVec3,
    /// Radius of the taxel, metres.
    pub radius: f64,
    /// Height of the substrate along the axis, relative to the taxel's centre at rest, metres.
    pub behind: f64,
}

/// Group of neighbouring taxels, stored coordinate by coordinate. Unused entries repeat the last taxel, with a substrate so high that nothing pushes them.
#[derive(Clone, Debug)]
pub(crate) struct Leaf {
    pub numbers: [u32; LEAF],
    /// Centres of the taxels at rest: x, y, z, metres.
    pub centers: [[f64; LEAF]; 3],
    /// Two unit vectors perpendicular to the axis of each taxel.
    pub across: [[[f64; LEAF]; 3]; 2],
    /// Axes of the taxels, unit vectors.
    pub axes: [[f64; LEAF]; 3],
    /// Radii of the taxels, metres.
    pub radii: [f64; LEAF],
    /// Heights of the taxels' substrates along their axes, relative to the taxels' centres at rest, metres.
    pub behind: [f64; LEAF],
}

/// Taxel index that marks an unused entry of a leaf.
const NONE: u32 = u32::MAX;

/// Node of the tree, with a bounding box around some taxels (their centres at rest and the substrate below them).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub bounds: Aabb,
    /// Largest radius of the node's taxels, metres.
    pub radius: f64,
    /// Index of the leaf; `None` if the node has children.
    leaf: Option<u32>,
    /// Index of the first node after this node's descendants.
    next: u32,
}

impl TaxelTree {
    pub fn new(layout: &Layout, taxels: &Taxels) -> Self {
        let n_taxels = layout.n_taxels();
        let depths = (0..n_taxels).map(|number| -taxels.at(number).substrate());
        let mut tree = Self {
            nodes: Vec::new(),
            leaves: Vec::with_capacity(n_taxels.div_ceil(LEAF)),
            depth: depths.fold(0.0, f64::max),
        };
        let mut numbers: Vec<u32> = (0..n_taxels as u32).collect();
        if n_taxels > 0 {
            tree.split((layout, taxels), &mut numbers);
        }
        tree
    }

    /// Creates the search tree of taxels whose axes are replaced by `direction` (unit vector), with unlimited strokes.
    pub fn travelling(layout: &Layout, taxels: &Taxels, direction: DVec3) -> Self {
        let endless = |taxel: &Taxel| Taxel {
            stroke: ENDLESS,
            ..*taxel
        };
        let taxels = match taxels {
            Taxels::Equal(taxel) => Taxels::Equal(endless(taxel)),
            Taxels::Each(each) => Taxels::Each(each.iter().map(endless).collect()),
        };
        let centers = layout.centers().iter();
        Self::new(
            &Layout::of_taxels(centers.map(|&center| (center, direction))),
            &taxels,
        )
    }

    /// Returns the bounding box of all taxels (their centres at rest and the substrate below them), metres; `None` if there are no taxels.
    pub fn bounds(&self) -> Option<&Aabb> {
        self.root().map(|root| &root.bounds)
    }

    /// Returns a ball that contains all taxels (their spheres at rest and the substrate below them), metres; `None` if there are no taxels.
    pub fn ball(&self) -> Option<Sphere> {
        let root = self.root()?;
        let ball = Sphere::around(&root.bounds);
        Some(Sphere {
            radius: ball.radius + root.radius,
            ..ball
        })
    }

    /// Returns the largest radius of a taxel, metres.
    pub fn largest_radius(&self) -> f64 {
        self.root().map_or(0.0, |root| root.radius)
    }

    /// Returns the largest sum of stroke and radius of a taxel, metres.
    pub fn depth(&self) -> f64 {
        self.depth
    }

    /// Returns whether a ball (centre and radius in metres, in the patch frame) may push a taxel. The result may also be true for a ball that only comes near
    /// a taxel.
    #[inline]
    pub fn is_near(&self, center: DVec3, radius: f64) -> bool {
        let root = self.root();
        root.is_some_and(|root| root.is_near(center, radius))
    }

    /// Returns the node that contains all taxels; `None` if there are no taxels.
    pub(crate) fn root(&self) -> Option<&Node> {
        self.nodes.first()
    }

    /// Calls `visit` with each taxel that a ball (metres, in the patch frame) can push, and possibly with other taxels nearby.
    #[inline]
    pub(crate) fn each_near(
        &self,
        center: DVec3,
        radius: f64,
        mut visit: impl FnMut(&PlacedTaxel),
    ) {
        self.each_leaf(
            |node| node.is_near(center, radius),
            |leaf| leaf.taxels().for_each(|taxel| visit(&taxel)),
        );
    }

    /// Returns a leaf with a taxel near the line through `point` along `direction` (unit vector); `None` if there are no taxels. Only the first taxel of each
    /// leaf is compared.
    pub(crate) fn leaf_beside(&self, point: DVec3, direction: DVec3) -> Option<&Leaf> {
        let beside = |leaf: &Leaf| {
            let away = leaf.vector(&leaf.centers, 0) - point;
            away.cross(direction).length_squared()
        };
        let nearest = self.leaves.iter().map(|leaf| (beside(leaf), leaf));
        let nearest = nearest.reduce(|a, b| if b.0 < a.0 { b } else { a });
        nearest.map(|(_, leaf)| leaf)
    }

    /// Calls `visit` with each leaf if `may_count` returns true for all nodes on the path to the leaf.
    #[inline(always)]
    pub(crate) fn each_leaf(
        &self,
        mut may_count: impl FnMut(&Node) -> bool,
        mut visit: impl FnMut(&Leaf),
    ) {
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            if !may_count(node) {
                index = node.next as usize;
                continue;
            }
            if let Some(leaf) = node.leaf {
                visit(&self.leaves[leaf as usize]);
            }
            index += 1;
        }
    }

    /// Creates the nodes for some taxels, split across the longest side of the box around their centres into full leaves. Returns the index of the first
    /// node.
    fn split(&mut self, of: (&Layout, &Taxels), numbers: &mut [u32]) -> usize {
        let (layout, taxels) = of;
        let index = self.nodes.len();
        if numbers.len() <= LEAF {
            let placed = numbers.iter();
            let placed = placed.map(|&number| PlacedTaxel::new(layout, taxels, number as usize));
            let placed: Vec<PlacedTaxel> = placed.collect();
            let leaf = Some(self.leaves.len() as u32);
            self.leaves.push(Leaf::new(&placed));
            let node = Node::around(&placed);
            let next = index as u32 + 1;
            self.nodes.push(Node { leaf, next, ..node });
            return index;
        }
        let half = (numbers.len() / 2).next_multiple_of(LEAF);
        let center = |number: u32| layout.centers()[number as usize];
        let (left, right) = split_across(numbers, half, center);
        self.nodes.push(Node::EMPTY);
        let parts = [self.split(of, left), self.split(of, right)].map(|part| self.nodes[part]);
        self.nodes[index] = Node {
            bounds: Aabb::around(parts.map(|part| part.bounds)).expect("two parts"),
            radius: parts[0].radius.max(parts[1].radius),
            leaf: None,
            next: self.nodes.len() as u32,
        };
        index
    }
}

impl Leaf {
    fn new(taxels: &[PlacedTaxel]) -> Self {
        let at = |k: usize| &taxels[k.min(taxels.len() - 1)];
        let lanes = |of: &dyn Fn(&PlacedTaxel) -> f64| std::array::from_fn(|k| of(at(k)));
        let vectors = |of: &dyn Fn(&PlacedTaxel) -> DVec3| {
            std::array::from_fn(|axis| lanes(&|taxel| of(taxel)[axis]))
        };
        Self {
            numbers: std::array::from_fn(|k| taxels.get(k).map_or(NONE, |taxel| taxel.number)),
            centers: vectors(&|taxel| taxel.center),
            across: [0, 1].map(|side| vectors(&|taxel| taxel.across[side])),
            axes: vectors(&|taxel| taxel.axis),
            radii: lanes(&|taxel| taxel.radius),
            behind: std::array::from_fn(|k| taxels.get(k).map_or(f64::INFINITY, |t| t.behind)),
        }
    }

    /// Returns the vector of taxel `k` from vectors that are stored by component.
    #[inline(always)]
    pub fn vector(&self, of: &[[f64; LEAF]; 3], k: usize) -> DVec3 {
        DVec3::new(of[0][k], of[1][k], of[2][k])
    }

    /// Returns whether the entry `k` contains a taxel.
    #[inline(always)]
    pub fn is_used(&self, k: usize) -> bool {
        self.numbers[k] != NONE
    }

    /// Returns the taxel of the used entry `k`.
    pub fn taxel(&self, k: usize) -> PlacedTaxel {
        PlacedTaxel {
            number: self.numbers[k],
            center: self.vector(&self.centers, k),
            across: [0, 1].map(|side| self.vector(&self.across[side], k)),
            axis: self.vector(&self.axes, k),
            radius: self.radii[k],
            behind: self.behind[k],
        }
    }

    /// Returns an iterator over the taxels of the leaf, without unused entries.
    fn taxels(&self) -> impl Iterator<Item = PlacedTaxel> {
        let used = (0..LEAF).take_while(|k| self.is_used(*k));
        used.map(|k| self.taxel(k))
    }
}

impl Node {
    /// Returns an upper bound of the coordinates of the node's taxels along a direction, metres.
    #[inline(always)]
    pub fn front(&self, direction: DVec3) -> f64 {
        let (least, largest) = (self.bounds.min * direction, self.bounds.max * direction);
        least.max(largest).element_sum()
    }

    /// Returns the largest radius of the node's taxels, enlarged by more than rounding errors, metres.
    #[inline(always)]
    pub fn reach(&self) -> f64 {
        self.radius * RADIUS_ROUNDING
    }

    /// Node with arbitrary contents, which are replaced later.
    const EMPTY: Self = Self {
        bounds: Aabb {
            min: DVec3::ZERO,
            max: DVec3::ZERO,
        },
        radius: 0.0,
        leaf: None,
        next: 0,
    };

    fn around(taxels: &[PlacedTaxel]) -> Self {
        Self {
            bounds: Aabb::around(taxels.iter().map(PlacedTaxel::stretch))
                .expect("no node is empty"),
            radius: taxels.iter().map(|t| t.radius).fold(0.0, f64::max),
            leaf: None,
            next: 0,
        }
    }

    /// Returns whether a ball can push one of the node's taxels.
    #[inline(always)]
    pub fn is_near(&self, center: DVec3, radius: f64) -> bool {
        self.margin(center, radius) >= 0.0
    }

    /// Returns the squared sum of the radii of a ball and a taxel, minus the squared distance between the ball's centre and the node's box, m². The value is
    /// an upper bound for each of the node's taxels.
    #[inline(always)]
    pub fn margin(&self, center: DVec3, radius: f64) -> f64 {
        let reach = (self.radius + radius) * RADIUS_ROUNDING;
        reach * reach - self.bounds.distance_squared(center)
    }
}

impl PlacedTaxel {
    /// Creates the data of the taxel with index `number` in a layout.
    pub fn new(layout: &Layout, taxels: &Taxels, number: usize) -> Self {
        let frame = layout.frame(number);
        let taxel = taxels.at(number);
        Self {
            number: number as u32,
            center: layout.centers()[number],
            across: [frame.x_axis, frame.y_axis],
            axis: frame.z_axis,
            radius: taxel.radius,
            behind: taxel.substrate(),
        }
    }

    /// Returns the bounding box of the line from the taxel's centre at rest to the substrate.
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
    use crate::world::fixtures::{TAXEL, vector};
    use rand::Rng;

    #[test]
    fn no_taxel_that_a_ball_can_push_is_left_out() {
        let mut rng = Seed::new(1).named("taxel tree").rng();
        let mut direction = || vector(&mut rng).normalize_or(DVec3::X);
        let n = 3000;
        let centers: Vec<DVec3> = (0..n).map(|_| 0.05 * direction()).collect();
        // Half of the axes point outwards, as on a ball; the others are random.
        let axis = |k: usize| match k % 2 {
            0 => 20.0 * centers[k],
            _ => direction(),
        };
        let axes: Vec<DVec3> = (0..n).map(axis).map(DVec3::normalize).collect();
        let layout = Layout::new(centers, axes).unwrap();
        let taxels = (0..n).map(|k| Taxel {
            radius: 1e-3 + 1e-6 * k as f64,
            stroke: 6e-3 - 1e-6 * k as f64,
            ..TAXEL
        });
        let tree = TaxelTree::new(&layout, &Taxels::Each(taxels.collect()));
        let mut n_pushed = 0;
        let mut n_visited = 0;
        for case in 0..300 {
            let mut rng = Seed::new(2).numbered(case).rng();
            let center = 0.08 * vector(&mut rng);
            let radius = 10f64.powf(rng.gen_range(-6.0..-1.5));
            let mut is_visited = vec![false; n];
            tree.each_near(center, radius, |taxel| {
                is_visited[taxel.number as usize] = true
            });
            n_visited += is_visited.iter().filter(|&&v| v).count();
            for taxel in tree.leaves.iter().flat_map(Leaf::taxels) {
                let height = (center - taxel.center).dot(taxel.axis);
                let beside2 = center.distance_squared(taxel.center) - height * height;
                let q = (radius + taxel.radius).powi(2) - beside2;
                if q > 0.0 && q.sqrt() > height && height + q.sqrt() >= taxel.behind {
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
        let tree = TaxelTree::new(&layout, &Taxels::Equal(TAXEL));
        let taxel = tree.leaves[0].taxels().next().unwrap();
        assert_eq!(taxel.across, [DVec3::X, DVec3::Y]);
    }
}
