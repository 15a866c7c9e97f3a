//! Rigid motions, boxes and places.

use glam::{DQuat, DVec3, EulerRot};
use std::collections::HashSet;

/// A rigid motion: rotate, then translate. `a_from_b` maps points of frame b to frame a.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Unit quaternion.
    pub rotation: DQuat,
    /// Metres.
    pub translation: DVec3,
}

impl Pose {
    /// No motion.
    pub const IDENTITY: Self = Self {
        rotation: DQuat::IDENTITY,
        translation: DVec3::ZERO,
    };

    /// Rotate by a unit quaternion, then translate (metres).
    pub fn new(rotation: DQuat, translation: DVec3) -> Self {
        Self {
            rotation,
            translation,
        }
    }

    /// A pure translation, metres.
    pub fn from_translation(translation: DVec3) -> Self {
        Self::new(DQuat::IDENTITY, translation)
    }

    /// A pure rotation.
    pub fn from_rotation(rotation: DQuat) -> Self {
        Self::new(rotation, DVec3::ZERO)
    }

    /// `a_from_b.compose(&b_from_c)` is `a_from_c`: the right one acts first.
    pub fn compose(&self, inner: &Self) -> Self {
        Self::new(
            (self.rotation * inner.rotation).normalize(),
            self.transform_point(inner.translation),
        )
    }

    /// The motion that undoes this one.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self::new(rotation, -(rotation * self.translation))
    }

    /// `world_from_b.seen_from(&world_from_a)` is `a_from_b`: what `inverse().compose()` is, but of the difference of the
    /// places, so that it has all its digits however far from the world's origin both are.
    pub fn seen_from(&self, frame: &Self) -> Self {
        let back = frame.rotation.conjugate();
        Self::new(
            (back * self.rotation).normalize(),
            back * (self.translation - frame.translation),
        )
    }

    /// Where the motion takes a point, metres.
    pub fn transform_point(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// Where the motion takes a direction.
    pub fn transform_vector(&self, vector: DVec3) -> DVec3 {
        self.rotation * vector
    }
}

/// Turns about the fixed axes x, y, z in turn, radians (URDF's roll, pitch, yaw): `Rz(yaw) Ry(pitch) Rx(roll)`.
pub fn rotation_from_rpy(rpy: DVec3) -> DQuat {
    // Fixed axes x, y, z in turn are moving axes z, y, x.
    DQuat::from_euler(EulerRot::ZYX, rpy.z, rpy.y, rpy.x)
}

/// A quaternion as a person writes it, made exactly a rotation; `None` if its length is not 1 within 0.001, which holds four
/// written digits.
pub fn written_rotation(quaternion: DQuat) -> Option<DQuat> {
    let is_near = (quaternion.length() - 1.0).abs() <= 1e-3;
    is_near.then(|| quaternion.normalize())
}

/// An axis-aligned box, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

impl Aabb {
    /// The smallest box around other boxes; `None` for none.
    pub fn around(boxes: impl IntoIterator<Item = Self>) -> Option<Self> {
        boxes.into_iter().reduce(|a, b| Self {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        })
    }

    /// Edge lengths.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The square of the distance from a point to the box, zero inside; m².
    #[inline]
    pub fn distance_squared(&self, point: DVec3) -> f64 {
        let beyond = (self.min - point).max(point - self.max).max(DVec3::ZERO);
        beyond.length_squared()
    }

    /// The box that is wider by `margin` (metres, not negative) on every side.
    pub fn widened(&self, margin: f64) -> Self {
        Self {
            min: self.min - margin,
            max: self.max + margin,
        }
    }

    /// How far along a line (in lengths of `direction`) it enters the box, at least `from`; infinite if it passes by.
    pub fn entry(&self, origin: DVec3, direction: DVec3, from: f64) -> f64 {
        let (mut start, mut end) = (from, f64::INFINITY);
        for axis in 0..3 {
            let low = self.min[axis] - origin[axis];
            let high = self.max[axis] - origin[axis];
            if direction[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return f64::INFINITY;
                }
                continue;
            }
            let (a, b) = (low / direction[axis], high / direction[axis]);
            start = start.max(a.min(b));
            end = end.min(a.max(b));
        }
        // Rounding must not let a line slip between two boxes that touch.
        if start <= end + 1e-12 * end.abs() {
            start
        } else {
            f64::INFINITY
        }
    }

    /// The middle.
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
}

/// The bits of a place: exactly the same places have the same.
pub fn place_bits(point: DVec3) -> [u64; 3] {
    // Adding zero makes −0 and 0 the same place.
    (point + DVec3::ZERO).to_array().map(f64::to_bits)
}

/// Each place of `points` once, in the order of first occurrence.
pub fn distinct_places(points: &[DVec3]) -> Vec<DVec3> {
    let mut seen = HashSet::new();
    let is_new = |point: &DVec3| seen.insert(place_bits(*point));
    points.iter().copied().filter(is_new).collect()
}
