//! The taxels of a layout in an order that keeps neighbours together.

use crate::world::Layout;
use glam::DVec3;

/// Taxels that are to be together at last, and so many of those, and so on: the tiles of a body's patch.
const TILE: usize = 8;

impl Layout {
    /// The same taxels in an order in which each 8, 64, 512 and so on from the first on are neighbours, and which taxel of this layout
    /// each of them is. The same layout always gives the same order.
    pub fn with_neighbours_together(&self) -> (Self, Vec<usize>) {
        let mut order: Vec<usize> = (0..self.n_taxels()).collect();
        halve(&mut order, self.centers());
        let taxels = order.iter().map(|&k| (self.centers()[k], self.axes()[k]));
        (Self::of_taxels(taxels), order)
    }
}

/// Halves taxels across the longest side of where they are, at a whole number of the largest parts, until a tile is left.
fn halve(order: &mut [usize], centers: &[DVec3]) {
    if order.len() <= TILE {
        return;
    }
    let mut part = TILE;
    while part * TILE < order.len() {
        part *= TILE;
    }
    let half = (order.len() / 2).next_multiple_of(part);
    let all = || order.iter().map(|&k| centers[k]);
    let low = all().fold(DVec3::INFINITY, DVec3::min);
    let high = all().fold(DVec3::NEG_INFINITY, DVec3::max);
    let side = (high - low).max_position();
    // Ties by number: the order depends on nothing but the taxels.
    order.select_nth_unstable_by(half, |&a, &b| {
        let order = centers[a][side].total_cmp(&centers[b][side]);
        order.then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(half);
    halve(left, centers);
    halve(right, centers);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn every_taxel_is_there_once_and_near_its_neighbours() {
        let mut rng = Seed::new(1).named("order").rng();
        for n in [1, 7, 8, 9, 64, 65, 100, 5000] {
            let centers: Vec<DVec3> = (0..n)
                .map(|_| DVec3::new(rng.r#gen(), rng.r#gen(), 0.0))
                .collect();
            let layout = Layout::new(centers, vec![DVec3::Z; n]).unwrap();
            let (ordered, order) = layout.with_neighbours_together();
            for (place, &k) in order.iter().enumerate() {
                assert_eq!(ordered.centers()[place], layout.centers()[k]);
            }
            let mut all = order.clone();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..n));
            // A tile of n points in a unit square is a part of it of about 8 / n.
            for tile in ordered.centers().chunks(TILE) {
                let far = tile.iter().map(|c| c.distance(tile[0])).fold(0.0, f64::max);
                assert!(far < 4.0 * (8.0 / n as f64).sqrt(), "{n} {far}");
            }
        }
    }
}
