//! Vector of eight numbers in single precision, as two vectors of glam, which are vector registers on every processor of x86-64.

use crate::objects::mesh_blocks::{LANES, Lane};
use crate::world::LEAF;
use glam::{BVec4A, Vec4};
use std::ops::{Add, Div, Mul, Sub};

/// Number of lanes.
pub(super) const N: usize = 8;
/// Number of vectors that contain the children of a node, or the triangles of a block.
pub(super) const GROUPS: usize = LANES / N;

const _: () = assert!(LANES.is_multiple_of(N) && LEAF == N);

/// Eight numbers, one a lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eight([Vec4; 2]);

/// Truth values of eight lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask([BVec4A; 2]);

/// Eight vectors, stored by component.
pub(super) type Eight3 = [Eight; 3];

impl Eight {
    /// Returns one number in all lanes.
    #[inline(always)]
    pub fn splat(number: f32) -> Self {
        Self([Vec4::splat(number); 2])
    }

    #[inline(always)]
    pub fn new(lanes: &[f32; N]) -> Self {
        let (halves, _) = lanes.as_chunks::<4>();
        Self([Vec4::from_array(halves[0]), Vec4::from_array(halves[1])])
    }

    #[inline(always)]
    pub fn to_lanes(self) -> [f32; N] {
        let [[a, b, c, d], [e, f, g, h]] = self.0.map(|half| half.to_array());
        [a, b, c, d, e, f, g, h]
    }

    #[inline(always)]
    fn zip(self, other: Self, of: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        Self([of(self.0[0], other.0[0]), of(self.0[1], other.0[1])])
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, Vec4::max)
    }

    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.zip(other, Vec4::min)
    }

    #[inline(always)]
    pub fn abs(self) -> Self {
        Self([self.0[0].abs(), self.0[1].abs()])
    }

    /// Returns the largest number of all lanes.
    #[inline(always)]
    pub fn largest(self) -> f32 {
        self.0[0].max(self.0[1]).max_element()
    }

    /// Returns the smallest number of all lanes.
    #[inline(always)]
    pub fn smallest(self) -> f32 {
        self.0[0].min(self.0[1]).min_element()
    }

    /// Returns the sum of all lanes.
    #[inline(always)]
    pub fn sum(self) -> f32 {
        (self.0[0] + self.0[1]).element_sum()
    }

    #[inline(always)]
    pub fn is_below(self, other: Self) -> Mask {
        Mask([self.0[0].cmplt(other.0[0]), self.0[1].cmplt(other.0[1])])
    }

    #[inline(always)]
    pub fn is_at_most(self, other: Self) -> Mask {
        Mask([self.0[0].cmple(other.0[0]), self.0[1].cmple(other.0[1])])
    }
}

impl Mask {
    /// Returns the mask of the lanes whose bits are set.
    #[inline(always)]
    pub fn of_bits(bits: u32) -> Self {
        let is_set = |lane: u32| bits >> lane & 1 == 1;
        let four = |k: u32| BVec4A::new(is_set(k), is_set(k + 1), is_set(k + 2), is_set(k + 3));
        Self([four(0), four(4)])
    }

    /// Returns one bit for each lane that is true.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0[0].bitmask() | self.0[1].bitmask() << 4
    }

    /// Returns the numbers of `yes` in lanes that are true, and the numbers of `no` in the other lanes.
    #[inline(always)]
    pub fn select(self, yes: Eight, no: Eight) -> Eight {
        Eight([
            Vec4::select(self.0[0], yes.0[0], no.0[0]),
            Vec4::select(self.0[1], yes.0[1], no.0[1]),
        ])
    }

    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self([self.0[0] & other.0[0], self.0[1] & other.0[1]])
    }
}

impl Add for Eight {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Eight {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Div for Eight {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Mul for Eight {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

/// Returns the numbers of one group of children or triangles.
#[inline(always)]
pub(super) fn group_of(lanes: &Lane, group: usize) -> Eight {
    Eight::new(&lanes.as_chunks::<N>().0[group])
}

/// Returns the vectors of one group of children or triangles.
#[inline(always)]
pub(super) fn vectors_of(lanes: &[Lane; 3], group: usize) -> Eight3 {
    [
        group_of(&lanes[0], group),
        group_of(&lanes[1], group),
        group_of(&lanes[2], group),
    ]
}

/// Returns the vector of one lane in all lanes.
#[inline(always)]
pub(super) fn splat_vector(lanes: &[Lane; 3], lane: usize) -> Eight3 {
    [
        Eight::splat(lanes[0][lane]),
        Eight::splat(lanes[1][lane]),
        Eight::splat(lanes[2][lane]),
    ]
}

/// Returns the differences of vectors.
#[inline(always)]
pub(super) fn difference(a: &Eight3, b: &Eight3) -> Eight3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns the scalar products of vectors.
#[inline(always)]
pub(super) fn dot(a: &Eight3, b: &Eight3) -> Eight {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns the cross products of vectors.
#[inline(always)]
pub(super) fn cross(a: &Eight3, b: &Eight3) -> Eight3 {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
