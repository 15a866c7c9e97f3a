//! Reordering of a layout's taxels so that neighbours have consecutive numbers.

use crate::world::Layout;
use glam::DVec3;

/// Number of neighbouring taxels in the smallest group, called a tile.
const TILE: usize = 8;

impl Layout {
    /// Returns the layout with its taxels reordered so that neighbours have close indices, and each taxel's old index. Each aligned group of 8, 64, 512 and
    /// so on consists of neighbouring taxels. The order is deterministic.
    pub fn with_neighbours_together(&self) -> (Self, Vec<usize>) {
        let mut order: Vec<usize> = (0..self.n_taxels()).collect();
        halve(&mut order, self.centers());
        let taxels = order.iter().map(|&k| (self.centers()[k], self.axes()[k]));
        (Self::of_taxels(taxels), order)
    }
}

/// Reorders taxels by repeated halving across the longest side of their bounding box, until groups have the size of a tile. Each cut is at a multiple of the
/// largest group size.
fn halve(order: &mut [usize], centers: &[DVec3]) {
    if order.len() <= TILE {
        return;
    }
    let mut part = TILE;
    while part * TILE < order.len() {
        part *= TILE;
    }
    let half = (order.len() / 2).next_multiple_of(part);
    let (left, right) = split_across(order, half, |k| centers[k]);
    halve(left, centers);
    halve(right, centers);
}

/// Reorders taxels and divides them, across the longest side of the bounding box of their centres, into the first `half` taxels and the others.
pub(crate) fn split_across<T: Copy + Ord>(
    taxels: &mut [T],
    half: usize,
    center: impl Fn(T) -> DVec3,
) -> (&mut [T], &mut [T]) {
    let all = || taxels.iter().map(|&taxel| center(taxel));
    let low = all().fold(DVec3::INFINITY, DVec3::min);
    let side = (all().fold(DVec3::NEG_INFINITY, DVec3::max) - low).max_position();
    // Ties are broken by index, so that the order depends on the taxels only.
    taxels.select_nth_unstable_by(half, |&a, &b| {
        let order = center(a)[side].total_cmp(&center(b)[side]);
        order.then(a.cmp(&b))
    });
    taxels.split_at_mut(half)
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
            // Each tile covers about 8 / n of the unit square with n points.
            for tile in ordered.centers().chunks(TILE) {
                let far = tile.iter().map(|c| c.distance(tile[0])).fold(0.0, f64::max);
                assert!(far < 4.0 * (8.0 / n as f64).sqrt(), "{n} {far}");
            }
        }
    }
}
