//! The picture of a touched body: with what touches it, and the pressure on its patches without.

use super::picture::BodyPicture;
use crate::error::Result;
use crate::objects::Sphere;
use crate::report::canvas::{Hit, View};
use crate::report::colours::share;
use crate::report::picture::{Label, Picture};
use crate::report::shaded_view::{Lighting, PAINT, Stage};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Pixels of a panel.
const PANEL: [usize; 2] = [600, 900];
/// Skin that nothing touches, and taxels that something does.
const BARE: [u8; 3] = [226, 214, 200];
const TOUCHED: [u8; 3] = [0xd5, 0x5e, 0x00];
/// Radius of a place on the skin, metres: neighbours overlap. A touched taxel stands a little out.
const SKIN_RADIUS: f64 = 3.4e-3;
const TOUCHED_RADIUS: f64 = 3.8e-3;
/// From where the eye looks, radians: to the right of the robot's front, and up.
const AZIMUTH: f64 = 0.7;
const ELEVATION: f64 = 0.3;

/// A scene in two panels: the robot with what touches it, and the robot alone, its patches the bluer the higher their mean pressure,
/// touched taxels orange. The same bytes for the same input.
pub fn whole_body_picture(scene: &BodyPicture) -> Result<Picture> {
    let turn = DQuat::from_rotation_z(-FRAC_PI_2);
    let sphere = |center: DVec3, radius| Sphere {
        center: turn * center,
        radius,
    };
    let skin = scene.skin.iter().map(|place| sphere(place.0, SKIN_RADIUS));
    let touched = scene.touched.iter().map(|&at| sphere(at, TOUCHED_RADIUS));
    let alone: Vec<Sphere> = skin.chain(touched).collect();
    let object = scene.object.iter().map(|s| sphere(s.center, s.radius));
    let both: Vec<Sphere> = alone.iter().copied().chain(object).collect();

    let [width, height] = PANEL;
    let room = DVec2::new(0.62 * width as f64, height as f64 - 150.0);
    let stage = Stage::seen(View::from_angles(AZIMUTH, ELEVATION), &both, PANEL, room);
    let highest = scene.skin.iter().map(|place| place.1).fold(0.0, f64::max);
    let pressure = |number: usize| match scene.skin.get(number) {
        Some(&(_, pressure)) if pressure > 0.0 => share(0.15 + 0.85 * pressure / highest),
        Some(_) => BARE,
        None => TOUCHED,
    };
    let colour = |number: usize| match number {
        number if number < scene.skin.len() => BARE,
        number if number < alone.len() => TOUCHED,
        _ => PAINT,
    };
    let mut picture = Picture::blank(2 * width, height)?;
    let hits = stage.canvas.hits(&both);
    let number = |hits: &[Option<Hit>], ray: usize| hits[ray].map_or(0, |hit| hit.part);
    let view = stage.view(&hits, Lighting::Smoothed, |ray| colour(number(&hits, ray)));
    picture.place(&view, [0, 0], PANEL);
    let hits = stage.canvas.hits(&alone);
    let view = stage.view(&hits, Lighting::Smoothed, |ray| {
        pressure(number(&hits, ray))
    });
    picture.place(&view, [width, 0], PANEL);

    let label = |panel: f64, text: String, y: f64, size: u32| Label {
        text,
        x: (panel + 0.5) * width as f64,
        y,
        size,
    };
    let n_touched = scene.touched.len();
    let mut labels = vec![
        label(0.0, scene.scene.clone(), 30.0, 16),
        label(1.0, "mean pressure on each patch".to_owned(), 30.0, 16),
        label(
            1.0,
            format!("{n_touched} touched taxels in orange"),
            50.0,
            13,
        ),
    ];
    let below = [0.5 * width as f64, height as f64 - 24.0];
    labels.push(picture.draw_scale(stage.pixels_per_metre, width as f64, below, 13));
    draw_scale(&mut picture, width + width / 4, width / 2, height - 40);
    for (place, pressure) in [(-0.25, 0.0), (0.0, 0.5), (0.25, 1.0)] {
        let kilopascals = 1e-3 * pressure * highest;
        let kilopascals = match highest >= 1e4 {
            true => format!("{kilopascals:.0} kPa"),
            false => format!("{kilopascals:.2} kPa"),
        };
        labels.push(label(1.0 + place, kilopascals, height as f64 - 12.0, 12));
    }
    picture.write_labels(&labels)?;
    Ok(picture)
}

/// The colours from no pressure to the highest.
fn draw_scale(picture: &mut Picture, left: usize, width: usize, top: usize) {
    for column in 0..width {
        let colour = share(0.15 + 0.85 * column as f64 / width as f64);
        picture.fill(left + column..left + column + 1, top..top + 12, colour);
    }
}
