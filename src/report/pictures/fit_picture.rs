//! Picture of a sphere approximation: the object, the spheres, and the distance between them.

use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::objects::{Solid, SphereUnion};
use crate::packing::Body;
use crate::quantile::quantile;
use crate::report::pictures::{
    Align, Area, Drawing, PAINT, Picture, TextStyle, diverging, draw_colours, draw_scale_bar,
};
use crate::spelling::counted;
use crate::table::short_number;
use bubbletouch_sim::raster::{Canvas, Hit, Lighting, three_quarter_view};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Object that is approximated by spheres and shown in the picture.
pub enum Original {
    /// Triangle mesh, interpreted as a solid body or as an open surface.
    Mesh(Box<Surface>, Body),
    /// Solid that consists of primitive shapes.
    Solid(Solid),
}

/// Draws an object and its spheres in three panels of `tile` × `tile` pixels. The first shows the original, the second the single spheres. The third shows the
/// spheres coloured by their signed distance from the original, with a colour bar in millimetres. Distances are positive outside the original; for an open
/// surface, all distances are positive.
///
/// Equal input gives equal bytes.
///
/// # Errors
/// If a tile has fewer than 200 or more than 6,000 pixels.
pub fn fit_picture(
    name: &str,
    original: &Original,
    spheres: &SphereUnion,
    tile: usize,
) -> Result<Picture> {
    if !(200..=6_000).contains(&tile) {
        let allowed = "200 to 6000 pixels a side";
        return Err(Error::input(
            "panel of a picture",
            format!("{tile} pixels"),
            allowed,
        ));
    }
    let mut picture = Picture::blank(3 * tile, tile)?;
    let side = tile as f64;
    let margin = 0.10 * side;
    let room = DVec2::new(side - 1.6 * margin, side - 3.4 * margin);
    let canvas = Canvas::new(three_quarter_view(), spheres.spheres(), [tile; 2], room);
    let bounds = spheres.bounds();
    let (middle, radius) = (bounds.center(), bounds.size().length());
    let whole = canvas.cast(
        &|start, direction| original.first_hit(start, direction, 2.0 * radius),
        middle,
        radius,
    );
    let seen = canvas.hits(spheres.spheres());
    let distance = |(ray, hit): (usize, &Option<Hit>)| {
        let hit = hit.as_ref();
        hit.map_or(0.0, |hit| original.distance(canvas.point(ray, hit.height)))
    };
    let distances: Vec<f64> = seen.par_iter().enumerate().map(distance).collect();
    let scale = DistanceScale::new(&seen, &distances);
    let paint = |_: usize, _: &Hit| PAINT;
    picture.paint(&canvas, [0, 0], &whole, Lighting::Plain, &paint);
    picture.paint(&canvas, [tile, 0], &seen, Lighting::Plain, &paint);
    let error = |ray: usize, _: &Hit| diverging(distances[ray] / scale.end);
    picture.paint(&canvas, [2 * tile, 0], &seen, Lighting::Unlit, &error);

    let mut drawing = Drawing::new(3.0 * side, side);
    let style = TextStyle::new((0.030 * side).clamp(9.0, 18.0) as u32).align(Align::Middle);
    let [lowest, highest] = [scale.lowest, scale.highest].map(signed_millimetres);
    let above = [
        match original {
            Original::Mesh(surface, _) => {
                let triangles = counted(surface.mesh().n_triangles(), "triangle");
                format!("{name}: {triangles}")
            }
            Original::Solid(_) => name.to_owned(),
        },
        counted(spheres.n_spheres(), "sphere"),
        format!("spheres outside (+) or inside (−): {lowest} to {highest} mm"),
    ];
    for (panel, text) in above.iter().enumerate() {
        let middle = (panel as f64 + 0.5) * side;
        drawing.text((middle, 0.75 * margin), text, style);
    }
    let below = (0.5 * side, side - 0.35 * margin);
    draw_scale_bar(&mut drawing, below, canvas.pixels_per_metre(), 0.22 * side);
    scale.draw(&mut drawing, side, style);
    picture.print(&drawing)?;
    Ok(picture)
}

impl Original {
    /// Returns the first point where a ray hits the object within `length`, and the unit normal at this point. The normal points towards the start of the ray.
    fn first_hit(&self, start: DVec3, direction: DVec3, length: f64) -> Option<(DVec3, DVec3)> {
        match self {
            Self::Mesh(surface, _) => {
                let hit = surface.bvh().first_hit(start, direction, 0.0..length)?;
                let normal = surface.mesh().triangle(hit.triangle).double_area();
                let normal = normal.normalize_or_zero();
                let towards = if normal.dot(direction) > 0.0 {
                    -normal
                } else {
                    normal
                };
                Some((start + hit.along * direction, towards))
            }
            Self::Solid(solid) => march(solid, start, direction, length),
        }
    }

    /// Returns the signed distance of a point from the surface of the object, metres.
    fn distance(&self, point: DVec3) -> f64 {
        match self {
            Self::Mesh(surface, Body::Solid) => surface.signed_distance(point),
            Self::Mesh(surface, Body::Sheet) => surface
                .closest(point, f64::INFINITY)
                .map_or(f64::INFINITY, |closest| closest.distance),
            Self::Solid(solid) => solid.distance(point),
        }
    }
}

/// Finds the point where a ray hits a solid by sphere tracing (Hart 1996). Each step equals the distance to the surface, so that no step passes the surface.
fn march(solid: &Solid, start: DVec3, direction: DVec3, length: f64) -> Option<(DVec3, DVec3)> {
    const MAX_STEPS: usize = 400;
    let near = 1e-6 * length;
    let mut along = 0.0;
    for _ in 0..MAX_STEPS {
        let point = start + along * direction;
        let distance = solid.distance(point);
        if distance < near {
            let slope = |axis: DVec3| {
                solid.distance(point + near * axis) - solid.distance(point - near * axis)
            };
            let normal = DVec3::from_array(DVec3::AXES.map(slope));
            return Some((point, normal.normalize_or(-direction)));
        }
        along += distance;
        if along > length {
            return None;
        }
    }
    None
}

/// Colour scale of the third panel: distances between the spheres and the original object, metres.
struct DistanceScale {
    lowest: f64,
    highest: f64,
    /// Largest absolute distance on the colour scale, which covers −`end` to `end`.
    end: f64,
}

impl DistanceScale {
    /// Creates a colour scale that covers all visible distances except the most extreme 1 %.
    fn new(seen: &[Option<Hit>], distances: &[f64]) -> Self {
        let of_hit = |(hit, &distance): (&Option<Hit>, &f64)| hit.is_some().then_some(distance);
        let mut distances: Vec<f64> = seen.iter().zip(distances).filter_map(of_hit).collect();
        let mut of_part = |part: f64| quantile(&mut distances, part);
        Self {
            lowest: of_part(0.0),
            highest: of_part(1.0),
            end: of_part(0.005).abs().max(of_part(0.995).abs()).max(1e-9),
        }
    }

    /// Draws the colour bar below the third panel, with labels in millimetres at its ends and its middle.
    fn draw(&self, drawing: &mut Drawing, side: f64, style: TextStyle) {
        let corner = (2.25 * side, (13.0 / 14.0 * side).floor());
        let bar = Area::new(corner, (0.5 * side, (0.02 * side).max(4.0)));
        draw_colours(drawing, bar, |part| diverging(2.0 * part - 1.0));
        for (part, text) in [
            (0.0, signed_millimetres(-self.end)),
            (0.5, "0 mm".to_owned()),
            (1.0, signed_millimetres(self.end)),
        ] {
            let (x, y) = bar.at(part, 0.0);
            drawing.text((x, y + 5.0 + f64::from(style.size)), &text, style);
        }
    }
}

/// Formats a length in metres as millimetres with a sign; negative numbers have a true minus sign.
fn signed_millimetres(metres: f64) -> String {
    let sign = if metres < 0.0 { "−" } else { "+" };
    format!("{sign}{}", short_number((1e6 * metres.abs()).round() / 1e3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mesh::TriangleMesh;
    use crate::objects::{Part, Shape, Sphere};

    /// Creates a square surface with sides of length 2 in the plane z = 0, viewed from above.
    fn square() -> Surface {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let corners = corners.map(|(x, y)| DVec3::new(x, y, 0.0));
        let triangles = vec![[0, 1, 2], [0, 2, 3]];
        Surface::new(TriangleMesh::new("square", corners.to_vec(), triangles).unwrap())
    }

    fn ball(radius: f64) -> SphereUnion {
        let center = DVec3::ZERO;
        SphereUnion::new(vec![Sphere { center, radius }]).unwrap()
    }

    /// Returns the sum of red minus blue over the pixels of the third panel, without its colour bar.
    fn redness(picture: &Picture) -> i64 {
        let tile = picture.height;
        let pixels = picture.rgb.chunks(3).enumerate();
        let wanted = pixels.filter(|(at, _)| {
            at % picture.width > 2 * tile && at / picture.width < tile - tile / 12
        });
        wanted
            .map(|(_, rgb)| i64::from(rgb[0]) - i64::from(rgb[2]))
            .sum()
    }

    #[test]
    fn rays_meet_a_solid_where_its_shape_says_and_a_mesh_where_its_triangles_are() {
        let ball = Original::Solid(Solid::from_shape(Shape::Ball { diameter: 1.0 }).unwrap());
        let mesh = Original::Mesh(Box::new(square()), Body::Sheet);
        for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-0.1, 0.45)] {
            let start = DVec3::new(x, y, 3.0);
            let (point, normal) = ball.first_hit(start, DVec3::NEG_Z, 6.0).unwrap();
            assert!((point.length() - 0.5).abs() < 1e-5, "{point}");
            assert!(normal.distance(point / 0.5) < 1e-3, "{normal} at {point}");
            let (point, normal) = mesh.first_hit(start, DVec3::NEG_Z, 6.0).unwrap();
            assert!(point.distance(DVec3::new(x, y, 0.0)) < 1e-12);
            assert_eq!(normal, DVec3::Z);
        }
        let beside = DVec3::new(1.2, 0.0, 3.0);
        assert!(ball.first_hit(beside, DVec3::NEG_Z, 6.0).is_none());
    }

    #[test]
    fn a_ray_goes_through_a_hole_that_ends_where_the_solid_does() {
        let cylinder = |diameter| Shape::Cylinder {
            diameter,
            height: 0.5,
        };
        let hole = Part::new(cylinder(0.4), Pose::IDENTITY).unwrap();
        let ring = Solid::from_shape(cylinder(1.0))
            .unwrap()
            .less(vec![hole])
            .unwrap();
        let ring = Original::Solid(ring);
        let first_hit = |x: f64| {
            let start = DVec3::new(x, 0.01, 1.5);
            ring.first_hit(start, DVec3::NEG_Z, 3.0)
        };
        assert!(first_hit(0.1).is_none());
        let (point, _) = first_hit(0.35).unwrap();
        assert!((point.z - 0.25).abs() < 1e-4, "{point}");
    }

    #[test]
    fn spheres_that_reach_outside_are_red_and_those_that_stay_inside_blue() {
        let solid = Original::Solid(Solid::from_shape(Shape::Ball { diameter: 0.04 }).unwrap());
        let shown = |radius| fit_picture("ball", &solid, &ball(radius), 200).unwrap();
        let (large, small) = (shown(0.021), shown(0.019));
        assert_eq!((large.width, large.height), (600, 200));
        assert!(redness(&large) > 100_000, "{}", redness(&large));
        assert!(redness(&small) < -100_000, "{}", redness(&small));
    }

    #[test]
    fn panels_of_other_sizes_than_a_screen_has_are_refused() {
        let solid = Original::Solid(Solid::from_shape(Shape::Ball { diameter: 0.04 }).unwrap());
        for tile in [0, 199, 6_001] {
            let error = fit_picture("ball", &solid, &ball(0.02), tile).unwrap_err();
            assert_eq!(error.exit_code(), 2);
        }
    }
}
