//! Flat ends of a robot's cylinders that objects can touch.

use super::half_balls::{End, SAME, ends};
use crate::error::Result;
use crate::geometry::Pose;
use crate::world::{LinkGeometry, LinkShape, Robot};
use glam::DVec3;

/// Returns the flat ends of a robot's cylinders, link by link in the order of the file, the lower end of a cylinder first. An end is omitted if its middle is
/// in or on another collision shape when all joints are at zero. An omitted end is rounded by a sphere, or joined to another link.
pub(super) fn flat_ends(robot: &Robot) -> Result<Vec<End>> {
    let world_from_links = robot.forward(&Pose::IDENTITY, &vec![0.0; robot.n_positions()])?;
    let links = robot.links().iter().zip(&world_from_links).enumerate();
    let shapes: Vec<(usize, Pose, &LinkShape)> = links
        .flat_map(|(number, (link, world_from_link))| {
            let solids = link.solids();
            solids.map(move |shape| (number, world_from_link.compose(&shape.origin), shape))
        })
        .collect();
    let mut found = Vec::new();
    for (place, (link, world_from_shape, shape)) in shapes.iter().enumerate() {
        let LinkGeometry::Cylinder { radius, length } = shape.geometry else {
            continue;
        };
        let in_world = ends(world_from_shape, length);
        for ((middle, outwards), (in_world, _)) in
            ends(&shape.origin, length).into_iter().zip(in_world)
        {
            let mut others = shapes.iter().enumerate();
            let is_buried = others.any(|(other, (_, world_from_other, shape))| {
                other != place
                    && holds(
                        &shape.geometry,
                        world_from_other.inverse().transform_point(in_world),
                    )
            });
            if !is_buried {
                found.push(End::new(*link, (middle, outwards), radius));
            }
        }
    }
    Ok(found)
}

/// Returns whether a point in a shape's own frame lies in the shape or on it; false for a mesh.
fn holds(shape: &LinkGeometry, point: DVec3) -> bool {
    let beside = point.truncate().length();
    match *shape {
        LinkGeometry::Sphere { radius } => point.length() <= radius + SAME,
        LinkGeometry::Box { size } => (point.abs() - 0.5 * size).max_element() <= SAME,
        LinkGeometry::Cylinder { radius, length } => {
            beside <= radius + SAME && point.z.abs() <= 0.5 * length + SAME
        }
        LinkGeometry::Capsule { radius, length } => {
            let along = point.z.abs() - 0.5 * length;
            DVec3::new(beside, 0.0, along.max(0.0)).length() <= radius + SAME
        }
        LinkGeometry::Ellipsoid { semi_axes } => {
            let relative = point / semi_axes;
            relative.length() * semi_axes.min_element() <= semi_axes.min_element() + SAME
        }
        LinkGeometry::Mesh { .. } => false,
    }
}
