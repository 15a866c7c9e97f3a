//! Pictures of recordings: every taxel is drawn once, in its colour and at its position, in still and moving pictures.

use crate::stored::{frame, normal};
use bubbletouch::geometry::Pose;
use bubbletouch::objects::{Model, Sphere, SphereUnion};
use bubbletouch::report::colours::heat;
use bubbletouch::report::heat_map::ColourScale;
use bubbletouch::report::recording::animation::{
    Playback, colour_scale, frame_note, write_animation,
};
use bubbletouch::report::recording::skin_picture::{Picture, SkinPicture};
use bubbletouch::report::recording::{
    ForceKind, RecordedPatch, RecordingFile, RecordingHeader, RecordingWriter,
};
use bubbletouch::signal::Quantity;
use bubbletouch::world::Grid;
use glam::DVec3;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

const SCALE: ColourScale = ColourScale {
    quantity: Quantity::Deflection,
    low: 0.0,
    high: 2.0,
};

fn grid() -> RecordedPatch {
    let grid = Grid {
        nx: 10,
        ny: 6,
        pitch: 2e-3,
    };
    RecordedPatch::of_grid("palm", grid, ForceKind::Normal)
}

/// Returns a third of a tube with 8 × 12 taxels.
fn tube() -> RecordedPatch {
    let taxels = (0..96).map(|taxel| {
        let angle = 0.2 * f64::from(taxel % 12);
        let axis = DVec3::new(angle.cos(), angle.sin(), 0.0);
        (0.03 * axis + 6e-3 * f64::from(taxel / 12) * DVec3::Z, axis)
    });
    let (centers, axes) = taxels.unzip();
    RecordedPatch {
        name: "forearm".to_owned(),
        centers,
        axes,
        grid: None,
        force: ForceKind::Normal,
        signal: None,
    }
}

/// Returns the mean position and the number of the pixels of a colour.
fn blob(picture: &Picture, colour: [u8; 3]) -> ([f64; 2], usize) {
    let (mut sum, mut n) = ([0.0; 2], 0);
    for (index, pixel) in picture.rgb.as_chunks::<3>().0.iter().enumerate() {
        // Only the area left of the colour bar, which contains all colours.
        if *pixel == colour && index % picture.width < 920 {
            sum[0] += (index % picture.width) as f64;
            sum[1] += (index / picture.width) as f64;
            n += 1;
        }
    }
    (sum.map(|s| s / n as f64), n)
}

#[test]
fn a_touched_taxel_is_one_spot_of_its_colour_and_neighbours_stand_side_by_side() {
    let discs = RecordedPatch {
        grid: None,
        ..grid()
    };
    for patch in [grid(), discs] {
        let skin = SkinPicture::new(&patch, SCALE).unwrap();
        let spot = |taxel: usize| {
            let mut values = vec![0.0; patch.n_taxels()];
            values[taxel] = 1.5e-3;
            blob(&skin.frame(&values, "t").unwrap(), heat(0.75))
        };
        let (first, n_first) = spot(0);
        let (right, n_correct) = spot(1);
        let (above, n_above) = spot(10);
        assert!(n_first > 100 && n_first.abs_diff(n_correct) < 9 && n_first.abs_diff(n_above) < 9);
        // Distances of neighbours in pixels: 2 mm in both directions.
        let (dx, dy) = (right[0] - first[0], first[1] - above[1]);
        assert!((right[1] - first[1]).abs() < 0.6 && (above[0] - first[0]).abs() < 0.6);
        let is_even = dx > 10.0 && (dx / dy - 1.0).abs() < 0.06;
        assert!(is_even, "{}: {dx}, {dy}", patch.name);
    }
}

#[test]
fn values_that_cannot_be_drawn_are_errors() {
    let scale = ColourScale {
        quantity: Quantity::Force,
        ..SCALE
    };
    let skin = SkinPicture::new(&tube(), scale).unwrap();
    let said = skin.frame(&[0.0; 5], "").unwrap_err().to_string();
    assert_eq!(said, "frame: 5 values; 96, one a taxel");
    let mut values = [0.0; 96];
    values[7] = f64::NAN;
    let said = skin.frame(&values, "").unwrap_err().to_string();
    assert_eq!(said, "frame, taxel 7: NaN; a finite number");
}

/// Writes 40 frames of a spot that moves and becomes deeper.
fn write(path: &Path) {
    let patches = vec![grid(), tube()];
    let header = RecordingHeader {
        patches: patches.clone(),
        objects: vec!["ball".to_owned()],
        ..RecordingHeader::default()
    };
    let mut writer = RecordingWriter::create(path, header).unwrap();
    for k in 0..40 {
        let reading = |patch: &RecordedPatch| {
            let mut values = vec![0.0; patch.n_taxels()];
            values[k] = 5e-5 * k as f64;
            normal(&values, &values, Pose::IDENTITY)
        };
        let readings = patches.iter().map(reading);
        let ball = Pose::from_translation(DVec3::new(1e-3 * k as f64, 0.0, 0.02));
        let now = frame(0.01 * k as f64, readings.collect(), &[ball]);
        writer.push(&now).unwrap();
    }
    writer.finish().unwrap();
}

/// Returns the frames of an APNG as a viewer shows them, and the sum of their delays in seconds.
fn played(path: &Path) -> (Vec<Vec<u8>>, f64) {
    let file = BufReader::new(File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let n_frames = reader.info().animation_control().unwrap().num_frames;
    let width = reader.info().width as usize;
    let mut canvas: Vec<u8> = Vec::new();
    let (mut shown, mut seconds) = (Vec::new(), 0.0);
    for _ in 0..n_frames {
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let control = *reader.info().frame_control().unwrap();
        seconds += f64::from(control.delay_num) / f64::from(control.delay_den);
        assert_eq!((control.x_offset, control.width as usize), (0, width));
        if canvas.is_empty() {
            canvas = vec![0; 3 * width * control.height as usize];
        }
        let first = width * control.y_offset as usize;
        let pixels = bytes.as_chunks::<4>().0.iter();
        for (index, pixel) in pixels.take(width * control.height as usize).enumerate() {
            if pixel[3] == 255 {
                canvas[3 * (first + index)..][..3].copy_from_slice(&pixel[..3]);
            }
        }
        shown.push(canvas.clone());
    }
    (shown, seconds)
}

#[test]
fn an_animation_shows_the_pictures_of_its_frames_on_one_scale() {
    let folder = tempfile::tempdir().unwrap();
    let [path, out] = ["touch.npz", "touch.png"].map(|name| folder.path().join(name));
    write(&path);
    let mut file = RecordingFile::open(&path).unwrap();
    for patch in [0, 1] {
        let playback = Playback {
            speed: 0.5,
            fps: 5.0,
        };
        let mut film = |models: &[(String, Model)]| {
            let what = (Quantity::Deflection, models);
            write_animation(&out, &mut file, patch, what, &playback).unwrap()
        };
        film(&[]);
        let (bare, _) = played(&out);
        let radius = 8e-3;
        let center = DVec3::ZERO;
        let ball = SphereUnion::new(vec![Sphere { center, radius }]).unwrap();
        let shown = film(&[("ball".to_owned(), ball.into())]);
        let frames: Vec<usize> = shown.iter().map(|shown| shown.frame).collect();
        assert_eq!(frames, [0, 10, 20, 30, 39]);
        let (pictures, seconds) = played(&out);
        // 0.39 s at half the speed; the last frame is shown as long as the previous one.
        assert!((seconds - 0.78 - 0.18).abs() < 1e-9, "{seconds}");
        let scale = ColourScale {
            quantity: Quantity::Deflection,
            low: 0.0,
            high: f64::from(1.95e-3_f32) * 1e3,
        };
        let skin = &file.header().patches[patch].clone();
        let skin = SkinPicture::new(skin, scale).unwrap();
        assert_eq!(pictures.len(), frames.len());
        // The skin is at the top left, and the scene with the ball beside it; the strip is below.
        let width = skin.size().0 + 640;
        for ((picture, bare), &frame) in pictures.iter().zip(&bare).zip(&frames) {
            let values = file.frame(patch, Quantity::Deflection, frame).unwrap();
            let note = frame_note(file.time(), frame);
            let rows = picture.chunks(3 * width).take(skin.size().1);
            let left = rows.flat_map(|row| &row[..3 * skin.size().0]);
            let wanted = skin.frame(&values, &note).unwrap().rgb;
            assert!(left.eq(&wanted), "frame {frame}");
            assert_ne!(picture, bare, "the ball is in frame {frame}");
        }
        // The ball and the mark of the time move.
        let height = pictures[0].len() / (3 * width);
        for (from, to) in [(0, 640), (height - 200, height)] {
            let left = if from == 0 { skin.size().0 } else { 0 };
            let part = |picture: &[u8]| -> Vec<u8> {
                let rows = picture.chunks(3 * width).take(to).skip(from);
                rows.flat_map(|row| row[3 * left..].to_vec()).collect()
            };
            assert_ne!(part(&pictures[0]), part(&pictures[4]));
        }
        let scale_of_stills = colour_scale(&mut file, patch, Quantity::Deflection);
        assert_eq!(scale_of_stills.unwrap(), scale);
    }
}
