//! Hemispheres of a robot that objects can touch: ends of capsules, and spheres.

use crate::error::Result;
use crate::geometry::Pose;
use crate::world::{Link, LinkGeometry, Robot};
use glam::{DQuat, DVec3};

/// Difference below which distances and radii count as equal, metres.
pub(super) const SAME: f64 = 1e-6;

/// Hemisphere on a link, or flat end of a link's cylinder.
pub(super) struct End {
    pub link: usize,
    /// Pose of the hemisphere or flat end on the link: origin at its centre, +z towards the pole or outwards.
    pub link_from_end: Pose,
    /// Radius of the hemisphere or flat end, metres.
    pub radius: f64,
}

impl End {
    pub fn new(link: usize, (center, outwards): (DVec3, DVec3), radius: f64) -> Self {
        let rotation = DQuat::from_rotation_arc(DVec3::Z, outwards);
        Self {
            link,
            link_from_end: Pose::new(rotation, center),
            radius,
        }
    }
}

/// Returns the outer hemispheres of a robot's collision shapes, link by link, in the order of the file. A sphere that is not at a cylinder's end has two
/// hemispheres. With all joints at zero, hemispheres within a larger sphere of another link are omitted.
pub(super) fn half_balls(robot: &Robot) -> Result<Vec<End>> {
    let all: Vec<End> = robot
        .links()
        .iter()
        .enumerate()
        .flat_map(|(number, link)| of_link(number, link))
        .collect();
    let links = robot.forward(&Pose::IDENTITY, &vec![0.0; robot.n_positions()])?;
    let center = |half: &End| links[half.link].transform_point(half.link_from_end.translation);
    let is_within = |inner: &End, outer: &End| {
        let apart = center(inner).distance(center(outer));
        outer.link != inner.link && outer.radius > inner.radius + apart
    };
    let is_hidden: Vec<bool> = all
        .iter()
        .map(|half| all.iter().any(|other| is_within(half, other)))
        .collect();
    let halves = all.into_iter().zip(is_hidden);
    Ok(halves
        .filter_map(|(half, is_hidden)| (!is_hidden).then_some(half))
        .collect())
}

fn of_link(number: usize, link: &Link) -> Vec<End> {
    let mut halves = Vec::new();
    for shape in link.solids() {
        match shape.geometry {
            LinkGeometry::Capsule { radius, length } => {
                for end in ends(&shape.origin, length) {
                    halves.push(End::new(number, end, radius));
                }
            }
            LinkGeometry::Sphere { radius } => {
                let center = shape.origin.translation;
                let is_end = |(place, _): &(DVec3, DVec3)| place.distance(center) < SAME;
                let cylinders = link.solids().filter_map(|other| match other.geometry {
                    LinkGeometry::Cylinder { radius: of, length } if (of - radius).abs() < SAME => {
                        Some(ends(&other.origin, length))
                    }
                    _ => None,
                });
                match cylinders.flatten().find(is_end) {
                    Some(end) => halves.push(End::new(number, end, radius)),
                    None => {
                        let up = shape.origin.transform_vector(DVec3::Z);
                        halves.push(End::new(number, (center, up), radius));
                        halves.push(End::new(number, (center, -up), radius));
                    }
                }
            }
            _ => {}
        }
    }
    halves
}

/// Returns the two ends of a cylinder at a pose, each as a centre and an outward unit vector.
pub(super) fn ends(link_from_cylinder: &Pose, length: f64) -> [(DVec3, DVec3); 2] {
    [-1.0, 1.0].map(|side| {
        let outwards = side * DVec3::Z;
        (
            link_from_cylinder.transform_point(0.5 * length * outwards),
            link_from_cylinder.transform_vector(outwards),
        )
    })
}
