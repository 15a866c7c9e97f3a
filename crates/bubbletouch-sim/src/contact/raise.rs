//! Taxels raised by a sphere, several at once.

/// What is needed is compared before its root is taken: a square that is less than this share of the least that counts has a root
/// that does not, however both are rounded. Larger: rounding decides; smaller: roots in vain.
pub(super) const ALMOST: f64 = 1.0 - 1e-12;

/// Whether √q − h may be above a deflection; `squares` are q, m², and `heights` h, metres. False where it is not.
#[inline(always)]
pub(crate) fn beats<const N: usize>(
    squares: &[f64; N],
    heights: &[f64; N],
    deflections: &[f64; N],
) -> bool {
    let (heights, deflections, mut bars) = (*heights, *deflections, [0.0; N]);
    for k in 0..N {
        let bar = (heights[k] + deflections[k]).max(0.0);
        bars[k] = bar * bar * ALMOST - squares[k];
    }
    !super::Below::of(&bars, 0.0).is_empty()
}

/// Raises deflections to √q − h where q is above zero; `squares` are q, m², and `heights` h, metres.
///
/// Written for compilers: by numbers, as the parts of an iterator that are compiled elsewhere would be called; by way of copies, as
/// numbers in memory that may be the same are not computed together; roots of all, as those of less than nothing cost no more; and a
/// maximum, as a comparison in its place becomes a masked store, for which some processors take ten times as long.
#[inline(always)]
pub(crate) fn raise<const N: usize>(
    squares: &[f64; N],
    heights: &[f64; N],
    deflections: &mut [f64; N],
) {
    let (squares, heights, mut raised) = (*squares, *heights, *deflections);
    for k in 0..N {
        let needed = squares[k].sqrt() - heights[k];
        let needed = if squares[k] > 0.0 { needed } else { 0.0 };
        raised[k] = raised[k].max(needed);
    }
    *deflections = raised;
}
