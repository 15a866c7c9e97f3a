//! The picture of a fit: an object, the spheres that stand for it, and how far apart the two are.

use super::canvas::Hit;
use super::colours::{INK, diverging};
use super::picture::{Label, Picture};
use super::shaded_view::{Lighting, PAINT, Stage};
use crate::error::{Error, Result};
use crate::mesh::Surface;
use crate::objects::{Solid, SphereUnion};
use crate::packing::Body;
use glam::{DVec2, DVec3};

/// What spheres stand for.
#[derive(Clone, Copy)]
pub enum Original<'a> {
    /// A mesh and how it is understood.
    Mesh(&'a Surface, Body),
    /// A solid made of shapes.
    Solid(&'a Solid),
}

/// Three panels of `tile` × `tile` pixels: the original, the spheres with every sphere visible, and the spheres painted by
/// their signed distance from the original (positive: outside it; from a sheet all distances are positive), with a colour
/// bar in millimetres.
///
/// The same bytes for the same input. An error for a tile of fewer than 200 or more than 6,000 pixels.
pub fn fit_picture(
    name: &str,
    original: Original,
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
    let margin = 0.10 * tile as f64;
    let room = DVec2::new(tile as f64 - 1.6 * margin, tile as f64 - 3.4 * margin);
    let stage = Stage::new(spheres.spheres(), [tile, tile], room);
    let size = (0.030 * tile as f64).clamp(9.0, 18.0) as u32;
    let mut labels = Vec::new();
    let mut label = |panel: usize, text: String, y: f64| {
        let x = (panel as f64 + 0.5) * tile as f64;
        labels.push(Label { text, x, y, size });
    };
    let seen = stage.canvas.hits(spheres.spheres());
    let distances = stage.canvas.values(&seen, |point| original.distance(point));
    let scale = Scale::of(&seen, &distances);
    let bounds = spheres.bounds();
    let (middle, radius) = (bounds.center(), bounds.size().length());
    let whole = stage.canvas.cast(
        |start, direction| original.first_hit(start, direction, 2.0 * radius),
        middle,
        radius,
    );
    let views = [
        stage.view(&whole, Lighting::Plain, |_| PAINT),
        stage.view(&seen, Lighting::Plain, |_| PAINT),
        stage.view(&seen, Lighting::Unlit, |ray| {
            diverging(distances[ray] / scale.end)
        }),
    ];
    for (panel, view) in views.iter().enumerate() {
        picture.place(view, [panel * tile, 0], [tile, tile]);
    }
    let above = 0.75 * margin;
    label(0, format!("{name}: {}", original.describe()), above);
    label(1, format!("{} spheres", spheres.n_spheres()), above);
    label(2, scale.describe(), above);
    let below = [0.5 * tile as f64, tile as f64 - 0.35 * margin];
    labels.push(picture.draw_scale(stage.pixels_per_metre, tile as f64, below, size));
    scale.draw(&mut picture, tile, size, &mut labels);
    picture.write_labels(&labels)?;
    Ok(picture)
}

impl Original<'_> {
    /// Where a ray from outside meets it first, within a length of it, and the unit normal there, towards the start.
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

    /// Signed distance of a point, metres.
    fn distance(&self, point: DVec3) -> f64 {
        match self {
            Self::Mesh(surface, Body::Solid) => surface.signed_distance(point),
            Self::Mesh(surface, Body::Sheet) => surface
                .closest(point, f64::INFINITY)
                .map_or(f64::INFINITY, |closest| closest.distance),
            Self::Solid(solid) => solid.distance(point),
        }
    }

    fn describe(&self) -> String {
        match self {
            Self::Mesh(surface, _) => format!("{} triangles", surface.mesh().n_triangles()),
            Self::Solid(solid) => {
                let parts = match solid.parts().len() {
                    1 => "1 shape".to_owned(),
                    n => format!("{n} shapes"),
                };
                match solid.cuts().len() {
                    0 => parts,
                    n => format!("{parts} less {n}"),
                }
            }
        }
    }
}

/// Sphere tracing: each step is as long as the distance to the surface, so that none passes it (Hart 1996).
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

/// What the colours of the third panel mean, metres.
struct Scale {
    lowest: f64,
    highest: f64,
    /// The colours reach from minus this to this.
    end: f64,
}

impl Scale {
    /// Covers all distances that are seen but for the extreme hundredth, which would leave the others pale.
    fn of(seen: &[Option<Hit>], distances: &[f64]) -> Self {
        let of_hit = |(hit, &distance): (&Option<Hit>, &f64)| hit.is_some().then_some(distance);
        let mut distances: Vec<f64> = seen.iter().zip(distances).filter_map(of_hit).collect();
        distances.sort_by(f64::total_cmp);
        let of_part = |part: f64| {
            let last = distances.len().saturating_sub(1);
            distances
                .get((part * last as f64) as usize)
                .copied()
                .unwrap_or(0.0)
        };
        let largest = of_part(0.005).abs().max(of_part(0.995).abs()).max(1e-9);
        let power = 10f64.powf(largest.log10().floor());
        let ends = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0].map(|step| step * power);
        let end = ends.into_iter().find(|&end| end >= largest);
        Self {
            lowest: of_part(0.0),
            highest: of_part(1.0),
            end: end.unwrap_or(10.0 * power),
        }
    }

    fn describe(&self) -> String {
        let [lowest, highest] = [self.lowest, self.highest].map(signed_millimetres);
        format!("spheres outside (+) or inside (−): {lowest} to {highest} mm")
    }

    /// A bar under the third panel, with its ends and its middle in millimetres.
    fn draw(&self, picture: &mut Picture, tile: usize, size: u32, labels: &mut Vec<Label>) {
        let (left, width) = (2 * tile + tile / 4, tile / 2);
        let top = tile - tile / 14;
        let height = (tile / 50).max(4);
        for x in 0..width {
            let value = 2.0 * (x as f64 + 0.5) / width as f64 - 1.0;
            picture.fill(left + x..left + x + 1, top..top + height, diverging(value));
        }
        for place in [-1.0, 0.0, 1.0] {
            let x = left as f64 + 0.5 * (1.0 + place) * width as f64;
            let tick = x.round() as usize;
            picture.fill(tick..tick + 1, top + height..top + height + 4, INK);
            let text = match place {
                0.0 => "0 mm".to_owned(),
                _ => signed_millimetres(place * self.end),
            };
            let y = (top + height) as f64 + 5.0 + f64::from(size);
            labels.push(Label { text, x, y, size });
        }
    }
}

/// With at most three decimals, and a true minus.
fn signed_millimetres(metres: f64) -> String {
    let sign = if metres < 0.0 { "−" } else { "+" };
    let rounded = format!("{:.3}", metres.abs() * 1e3);
    let digits = rounded.trim_end_matches('0').trim_end_matches('.');
    format!("{sign}{digits}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::mesh::TriangleMesh;
    use crate::objects::{Part, Shape, Sphere};

    /// A square of side 2 at z = 0, seen from above.
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

    /// Red minus blue, summed over the third panel above its colour bar.
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
        let ball = Solid::of(Shape::Ball { diameter: 1.0 }).unwrap();
        let square = square();
        for (x, y) in [(0.0, 0.0), (0.3, -0.2), (-0.1, 0.45)] {
            let start = DVec3::new(x, y, 3.0);
            let (point, normal) = Original::Solid(&ball)
                .first_hit(start, DVec3::NEG_Z, 6.0)
                .unwrap();
            assert!((point.length() - 0.5).abs() < 1e-5, "{point}");
            assert!(normal.distance(point / 0.5) < 1e-3, "{normal} at {point}");
            let mesh = Original::Mesh(&square, Body::Sheet);
            let (point, normal) = mesh.first_hit(start, DVec3::NEG_Z, 6.0).unwrap();
            assert!(point.distance(DVec3::new(x, y, 0.0)) < 1e-12);
            assert_eq!(normal, DVec3::Z);
        }
        let beside = DVec3::new(1.2, 0.0, 3.0);
        assert!(
            Original::Solid(&ball)
                .first_hit(beside, DVec3::NEG_Z, 6.0)
                .is_none()
        );
    }

    #[test]
    fn a_ray_goes_through_a_hole_that_ends_where_the_solid_does() {
        let cylinder = |diameter| Shape::Cylinder {
            diameter,
            height: 0.5,
        };
        let hole = Part::new(cylinder(0.4), Pose::IDENTITY).unwrap();
        let ring = Solid::of(cylinder(1.0)).unwrap().less(vec![hole]).unwrap();
        let first_hit = |x: f64| {
            let start = DVec3::new(x, 0.01, 1.5);
            Original::Solid(&ring).first_hit(start, DVec3::NEG_Z, 3.0)
        };
        assert!(first_hit(0.1).is_none());
        let (point, _) = first_hit(0.35).unwrap();
        assert!((point.z - 0.25).abs() < 1e-4, "{point}");
    }

    #[test]
    fn spheres_that_reach_outside_are_red_and_those_that_stay_inside_blue() {
        let solid = Solid::of(Shape::Ball { diameter: 0.04 }).unwrap();
        let shown =
            |radius| fit_picture("ball", Original::Solid(&solid), &ball(radius), 200).unwrap();
        let (large, small) = (shown(0.021), shown(0.019));
        assert_eq!((large.width, large.height), (600, 200));
        assert!(redness(&large) > 100_000, "{}", redness(&large));
        assert!(redness(&small) < -100_000, "{}", redness(&small));
    }

    #[test]
    fn panels_of_other_sizes_than_a_screen_has_are_refused() {
        let solid = Solid::of(Shape::Ball { diameter: 0.04 }).unwrap();
        for tile in [0, 199, 6_001] {
            let error =
                fit_picture("ball", Original::Solid(&solid), &ball(0.02), tile).unwrap_err();
            assert_eq!(error.exit_code(), 2);
        }
    }
}
