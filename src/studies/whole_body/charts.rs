//! Charts, answers and the picture of a whole-body study.

use crate::objects::Sphere;
use crate::report::pictures::{
    Align, Area, Drawing, PAINT, Picture, Rgb, TextStyle, draw_colours, draw_scale_bar, tint,
};
use crate::studies::prelude::*;
use crate::studies::whole_body::plan::*;
use crate::studies::whole_body::rows::*;
use crate::table::{Along, At, Rule, short_number};
use bubbletouch_sim::raster::{Canvas, Hit, Lighting, view_from};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Time of a control step of a kilohertz loop, µs.
const MILLISECOND: At = At::Value(1000.0);

/// Charts of the computing time per step by the number of taxels, of touched taxels and of spheres, of the time of each stage, and of accuracy against memory.
pub(super) const CHARTS: &[Chart] = &[
    Chart {
        name: "time_by_taxels",
        title: "Time of a step by the size of the skin, the touch the same",
        shown: &[("series", "skin")],
        x: "n_taxels",
        lines: &["touched"],
        ..LADDER
    },
    Chart {
        name: "time_by_touched",
        title: "Time of a step by the size of the touch, the skin the same",
        shown: &[("series", "touch")],
        x: "touched_mean",
        lines: &["n_spheres"],
        ..LADDER
    },
    Chart {
        name: "time_by_spheres",
        title: "Time of a step by the size of the object, skin and touch the same",
        shown: &[("series", "spheres")],
        x: "n_spheres",
        lines: &["touched"],
        ..LADDER
    },
    Chart {
        table: TIMING.name(),
        name: "time_by_stage",
        title: "From touch to answer: where the time of a step goes",
        shown: &[("series", "scene")],
        x: "us_median",
        y: "name",
        lines: &["compression", "n_threads"],
        panels: Some("stage"),
        mark: Mark::Points,
        rules: &[Rule::constant(Along::X, MILLISECOND, "a millisecond")],
        ..Chart::LINES
    },
    Chart {
        table: RECOGNITION.name(),
        name: "accuracy_by_memory",
        title: "Which object is it: accuracy against memory of a taxel",
        x: "bytes_per_taxel",
        y: "accuracy",
        lines: &["compression"],
        ..Chart::FRONT
    },
];

/// Time of a step along a scaling series.
const LADDER: Chart = Chart {
    table: STEPS.name(),
    y: "us_median",
    rules: &[Rule::constant(Along::Y, MILLISECOND, "a millisecond")],
    ..Chart::LINES
};

/// Returns answers about the time from touch to decision and about memory; the charts show the rest.
pub(super) fn answers(tables: &[Table]) -> Vec<String> {
    let (cases, timing) = (&tables[0], &tables[3]);
    let mut answers = Vec::new();
    let us = |row: usize| timing.number("us_median", row);
    let whole = (0..timing.n_rows).filter(|&row| timing.word("stage", row) == "whole");
    answers.extend(whole.max_by(|&a, &b| us(a).total_cmp(&us(b))).map(|row| {
        let [taxels, at_most, scene, compression] =
            ["n_taxels", "us_median", "name", "compression"].map(|name| timing.words(name, row));
        format!(
            "From touch to answer on {taxels} taxels: at most {at_most} (median over steps; scene {scene}, {compression})."
        )
    }));
    let bytes = cases.numbers("bytes_per_taxel").unwrap_or_default();
    answers.extend(bytes.iter().copied().reduce(f64::max).map(|most| {
        let most = short_number(most);
        format!("A body at rest takes at most {most} bytes a taxel.")
    }));
    answers
}

/// Contents of the picture of a scene, with all positions in the world frame.
struct SceneView {
    /// Points on the skin with a spacing of a few millimetres, metres. Each point has the mean pressure on its patch (force divided by area), Pa.
    skin: Vec<(DVec3, f64)>,
    /// Positions of all touched taxels, metres.
    touched: Vec<DVec3>,
    /// Spheres of the object that touches the robot, metres.
    object: Vec<Sphere>,
}

/// Distance between neighbouring points of the skin in the picture, metres.
const PICTURE_PITCH: f64 = 4e-3;
/// Width and height of each panel of the picture, pixels.
const PANEL: [usize; 2] = [600, 900];
/// Colour of untouched skin, as red, green and blue.
const BARE: [u8; 3] = [226, 214, 200];
/// Colour of touched taxels, as red, green and blue.
const TOUCHED: [u8; 3] = [0xd5, 0x5e, 0x00];
/// Radius of a drawn point of the skin, metres; neighbouring points overlap. Touched taxels are drawn slightly above the skin.
const SKIN_RADIUS: f64 = 3.4e-3;
const TOUCHED_RADIUS: f64 = 3.8e-3;
/// Azimuth of the camera, measured from the robot's front to the right, radians.
const AZIMUTH: f64 = 0.7;
/// Elevation of the viewing direction above the horizontal plane, radians.
const ELEVATION: f64 = 0.3;

/// Returns the picture of the scene with the most touched patches; the last scene if several have equally many. Returns `None` if no scene has a touched taxel.
///
/// # Errors
/// If the scene cannot be simulated.
pub(super) fn picture_of_body(plan: &WholeBodyPlan, cases: &Table) -> Result<Option<NamedPicture>> {
    let patches = |row: &usize| cases.number("patches_touched_mean", *row);
    let most = (0..cases.n_rows)
        .filter(|&row| cases.word("series", row) == "scene")
        .filter(|&row| cases.number("touched_max", row) > 0.0)
        .max_by(|a, b| patches(a).total_cmp(&patches(b)));
    let name = most.map(|row| cases.word("name", row));
    let mut scenes = plan.scenes.iter();
    let Some(scene) = scenes.find(|scene| Some(scene.spec.name.as_str()) == name) else {
        return Ok(None);
    };
    let name = &scene.spec.name;
    let drawn = draw(name, &view(plan, scene)?)?;
    Ok(Some(NamedPicture {
        name: "touched".to_owned(),
        title: format!("The scene {name}, and the pressure on each patch"),
        png: drawn.png()?,
        size: (drawn.width, drawn.height),
    }))
}

fn view(plan: &WholeBodyPlan, scene: &ScenePlan) -> Result<SceneView> {
    let covered = plan.cover(plan.pitch)?;
    let poses = plan.posture(&covered, &scene.positions)?.patches;
    let (mut drive, object) = plan.begin(scene, &covered)?;
    drive.probe(drive.path)?;
    let felt: Vec<(usize, f64)> = drive.touched().collect();
    let (mut pressures, mut touched) = (Vec::new(), Vec::new());
    let body = covered.body();
    for ((patch, pose), &first) in body.patches().iter().zip(&poses).zip(body.firsts()) {
        let taxels = first..first + patch.n_taxels();
        let of_patch = felt.iter().filter(|(taxel, _)| taxels.contains(taxel));
        let of_patch: Vec<&(usize, f64)> = of_patch.collect();
        let forces = of_patch.iter().map(|(_, d)| plan.taxel.stiffness * d);
        let force: f64 = forces.sum();
        pressures.push(force / (patch.n_taxels() as f64 * plan.pitch * plan.pitch));
        if !of_patch.is_empty() {
            let layout = patch.layout();
            let centers = of_patch
                .iter()
                .map(|(taxel, _)| layout.centers()[taxel - first]);
            touched.extend(centers.map(|center| pose.transform_point(center)));
        }
    }
    let coarse = plan.cover(PICTURE_PITCH.max(plan.pitch))?;
    let patches = coarse.body().patches().iter().zip(&poses).zip(&pressures);
    let mut skin = Vec::new();
    for ((patch, pose), &pressure) in patches {
        let layout = patch.layout();
        let centers = layout.centers().iter();
        skin.extend(centers.map(|&center| (pose.transform_point(center), pressure)));
    }
    Ok(SceneView {
        skin,
        touched,
        object: object.moved(&drive.path.at(0.0)).spheres().to_vec(),
    })
}

/// Draws two panels: the robot with the object, and the robot alone. A higher mean pressure on a patch is drawn in a deeper blue; touched taxels are orange.
/// Equal inputs give pictures with equal bytes.
fn draw(name: &str, scene: &SceneView) -> Result<Picture> {
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
    let [width, height] = PANEL.map(|side| side as f64);
    let room = DVec2::new(0.62 * width, height - 150.0);
    let canvas = Canvas::new(view_from(AZIMUTH, ELEVATION), &both, PANEL, room);
    let highest = scene.skin.iter().map(|place| place.1).fold(0.0, f64::max);
    let pressures = scene.skin.iter().map(|&(_, pressure)| match pressure {
        pressure if pressure > 0.0 => tint(pressure / highest),
        _ => BARE,
    });
    let touched = scene.touched.iter().map(|_| TOUCHED);
    let object = scene.object.iter().map(|_| PAINT);
    let bare = scene.skin.iter().map(|_| BARE);
    let left: Vec<Rgb> = bare.chain(touched.clone()).chain(object).collect();
    let right: Vec<Rgb> = pressures.chain(touched).collect();
    let mut picture = Picture::blank(2 * PANEL[0], PANEL[1])?;
    for (spheres, colours, corner) in [(&both, left, 0), (&alone, right, PANEL[0])] {
        let colour = |_: usize, hit: &Hit| colours[hit.part];
        let hits = canvas.hits(spheres);
        picture.paint(&canvas, [corner, 0], &hits, Lighting::Smoothed, &colour);
    }

    let mut drawing = Drawing::new(2.0 * width, height);
    let style = |size| TextStyle::new(size).align(Align::Middle);
    let touched = format!("{} touched taxels in orange", scene.touched.len());
    drawing.text((0.5 * width, 30.0), name, style(16));
    drawing.text(
        (1.5 * width, 30.0),
        "mean pressure on each patch",
        style(16),
    );
    drawing.text((1.5 * width, 50.0), &touched, style(13));
    let below = (0.5 * width, height - 24.0);
    draw_scale_bar(&mut drawing, below, canvas.pixels_per_metre(), 0.22 * width);
    let bar = Area {
        x: 1.25 * width,
        y: height - 40.0,
        width: 0.5 * width,
        height: 12.0,
    };
    draw_colours(&mut drawing, bar, tint);
    for part in [0.0, 0.5, 1.0] {
        let (x, y) = bar.at(part, 0.0);
        let kilopascals = format!(
            "{} kPa",
            short_number((0.1 * part * highest).round() / 100.0)
        );
        drawing.text((x, y + 16.0), &kilopascals, style(12));
    }
    picture.print(&drawing)?;
    Ok(picture)
}
