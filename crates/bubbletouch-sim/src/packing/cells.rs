//! Partition of space into cells with few points each, for independent processing.

use crate::geometry::Aabb;
use glam::DVec3;

/// Partition of space by a tree of axis-aligned planes (k-d tree).
pub(super) struct Cells {
    nodes: Vec<Node>,
    n_cells: usize,
}

enum Node {
    Plane {
        axis: usize,
        at: f64,
        /// Index of the child cell below the plane; the child cell above the plane has the next index.
        below: usize,
    },
    Cell(usize),
}

impl Cells {
    /// Builds cells of at most `most` points each. Each cut divides the points along the longest axis; the fraction `share` of the points lies below the cut.
    pub fn new(points: &[DVec3], most: usize, share: f64) -> Self {
        let mut cells = Self {
            nodes: vec![Node::Cell(0)],
            n_cells: 0,
        };
        cells.cut(0, &mut points.to_vec(), most, share);
        cells
    }

    pub fn n_cells(&self) -> usize {
        self.n_cells
    }

    /// Returns the index of the cell that contains a point.
    pub fn cell_of(&self, point: DVec3) -> usize {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                Node::Cell(cell) => return cell,
                Node::Plane { axis, at, below } => node = below + usize::from(point[axis] >= at),
            }
        }
    }

    fn cut(&mut self, node: usize, points: &mut [DVec3], most: usize, share: f64) {
        let bounds = Aabb::around_points(points.iter().copied());
        let (low, high, size) = (bounds.min, bounds.max, bounds.size());
        if points.len() <= most || size.max_element() <= 0.0 {
            self.nodes[node] = Node::Cell(self.n_cells);
            self.n_cells += 1;
            return;
        }
        let axis = size.max_position();
        let middle = (points.len() as f64 * share) as usize;
        points.select_nth_unstable_by(middle, |a, b| a[axis].total_cmp(&b[axis]));
        // Points on the plane belong to the upper child, regardless of the order that the selection produced.
        let at = match points[middle][axis] {
            at if at > low[axis] => at,
            _ => 0.5 * (low[axis] + high[axis]),
        };
        points.sort_unstable_by_key(|p| p[axis] >= at);
        let n_below = points.partition_point(|p| p[axis] < at);
        let below = self.nodes.len();
        self.nodes[node] = Node::Plane { axis, at, below };
        self.nodes.extend([Node::Cell(0), Node::Cell(0)]);
        let (lower, upper) = points.split_at_mut(n_below);
        self.cut(below, lower, most, share);
        self.cut(below + 1, upper, most, 1.0 - share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn every_cell_holds_some_points_and_not_too_many() {
        let mut rng = Seed::new(1).named("cells").rng();
        // On a lattice, many points have a coordinate in common.
        let mut lattice = || f64::from(rng.gen_range(0..12));
        let points: Vec<DVec3> = (0..3000)
            .map(|_| DVec3::new(lattice(), lattice(), 0.1 * lattice()))
            .collect();
        for share in [0.5, 0.4, 0.6] {
            let cells = Cells::new(&points, 100, share);
            let mut counts = vec![0; cells.n_cells()];
            points.iter().for_each(|&p| counts[cells.cell_of(p)] += 1);
            assert!(counts.iter().all(|&n| n > 0 && n <= 100), "{counts:?}");
        }
    }

    #[test]
    fn points_at_one_place_are_one_cell() {
        let cells = Cells::new(&[DVec3::ONE; 50], 10, 0.5);
        assert_eq!(cells.n_cells(), 1);
        assert_eq!(cells.cell_of(DVec3::ZERO), 0);
    }
}
