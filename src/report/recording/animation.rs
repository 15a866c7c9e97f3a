//! Animation of a recording as an animated PNG, which browsers and image viewers play. The colours are the same as in all other pictures.
//!
//! GIF is not supported, because it would need another crate and has fewer colours and larger files.

use super::reader::RecordingFile;
use super::scene_view::SceneView;
use super::skin_picture::{Picture, SkinPicture};
use crate::error::{Error, Result};
use crate::files::write_bytes;
use crate::objects::Model;
use crate::report::pictures::ColourScale;
use crate::signal::Quantity;
use bubbletouch_sim::raster::pixels::changed_rows;
use png::{BitDepth, BlendOp, ColorType, Encoder, EncodingError};
use std::path::Path;

/// Maximum number of frames in an animation. Longer recordings show fewer frames per second, because larger files are slow in browsers.
pub const MAX_SHOWN: usize = 600;

/// Playback settings of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playback {
    /// Playback speed: seconds of the recording that are shown in one second of the animation, positive. At 0.1, the animation is ten times slower than real
    /// time.
    pub speed: f64,
    /// Maximum number of pictures per second, above 0 and at most 50, the limit of browsers.
    pub fps: f64,
}

impl Default for Playback {
    fn default() -> Self {
        Self {
            speed: 1.0,
            fps: 25.0,
        }
    }
}

/// Frame of an animation, with the time for which it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownFrame {
    /// Index of the frame in the recording.
    pub frame: usize,
    /// Time for which the frame is shown, milliseconds.
    pub milliseconds: u64,
}

/// Selects the frames of an animation and their durations: for each picture, the latest recorded frame, without repetitions.
///
/// The first and the last frame are always selected. If there would be more than [`MAX_SHOWN`] frames, ticks are further apart. A frame is shown until the
/// recording time of the next one. The last frame is shown as long as the previous one; a single frame is shown for one second. `time` is in seconds,
/// increasing.
///
/// # Errors
/// If a playback setting is out of its range, or there are no frames.
pub fn shown_frames(time: &[f64], playback: &Playback) -> Result<Vec<ShownFrame>> {
    let Playback { speed, fps } = *playback;
    if !(speed.is_finite() && speed > 0.0 && fps > 0.0 && fps <= 50.0) {
        return Err(Error::input(
            "animation",
            format!("speed {speed}, {fps} pictures a second"),
            "a positive speed, and above 0 to 50 pictures a second",
        ));
    }
    let (Some(first), Some(last)) = (time.first(), time.last()) else {
        return Err(Error::input("animation", "no frames", "at least one"));
    };
    let tick = (speed / fps).max((last - first) / (MAX_SHOWN - 2) as f64);
    // Times are sums of steps; the tolerance covers their rounding errors.
    let slack = 1e-6 * tick;
    let n_ticks = ((last - first + slack) / tick) as usize;
    let newest = |at: usize| {
        let due = first + at as f64 * tick + slack;
        time.partition_point(|&time| time <= due) - 1
    };
    let mut frames: Vec<usize> = (0..=n_ticks).map(newest).collect();
    frames.push(time.len() - 1);
    frames.dedup();
    let at = |frame: usize| ((time[frame] - first) / speed * 1e3).round() as u64;
    let pairs = frames.windows(2).map(|pair| ShownFrame {
        frame: pair[0],
        milliseconds: at(pair[1]) - at(pair[0]),
    });
    let mut shown: Vec<ShownFrame> = pairs.collect();
    shown.push(ShownFrame {
        frame: time.len() - 1,
        milliseconds: shown.last().map_or(1000, |before| before.milliseconds),
    });
    Ok(shown)
}

/// Returns the colour scale of a quantity of a patch over all frames of a recording. Stills and films have this scale.
///
/// # Errors
/// If the recording cannot be read.
pub fn colour_scale(
    recording: &mut RecordingFile,
    patch: usize,
    quantity: Quantity,
) -> Result<ColourScale> {
    let mut range = [0.0_f64; 2];
    recording.each_frame(patch, quantity, |_, values| {
        for &value in values {
            range = [range[0].min(value), range[1].max(value)];
        }
    })?;
    Ok(ColourScale::over(&range, quantity))
}

/// Writes the frames of a patch in a recording as an endless animated PNG with one colour scale. Beside the skin, the film shows all patches and the objects that
/// have a model in `models`, by name; a strip shows the total force on the patch over time. Returns the frames that are shown.
///
/// The memory holds only one picture and the file.
///
/// # Errors
/// Returns the errors of [`shown_frames`], or an error if the recording cannot be read or the file cannot be written.
pub fn write_animation(
    path: &Path,
    recording: &mut RecordingFile,
    patch: usize,
    (quantity, models): (Quantity, &[(String, Model)]),
    playback: &Playback,
) -> Result<Vec<ShownFrame>> {
    let shown = shown_frames(recording.time(), playback)?;
    let scale = colour_scale(recording, patch, quantity)?;
    let skin = SkinPicture::new(&recording.header().patches[patch], scale)?;
    let scene = SceneView::new(recording, patch, models, skin.size().0)?;
    let failed = |error: EncodingError| Error::io(path, "encode", std::io::Error::other(error));
    let mut bytes = Vec::new();
    let mut draw = |one: &ShownFrame| {
        let values = recording.frame(patch, quantity, one.frame)?;
        let now = skin.frame(&values, &frame_note(recording.time(), one.frame))?;
        scene.beside(&now, (recording, one.frame), (&values, scale))
    };
    let mut before = draw(&shown[0])?;
    let mut film = start(&mut bytes, (before.width, before.height), shown.len()).map_err(failed)?;
    add(&mut film, None, &before, &shown[0]).map_err(failed)?;
    for one in &shown[1..] {
        let now = draw(one)?;
        add(&mut film, Some(&before), &now, one).map_err(failed)?;
        before = now;
    }
    film.finish().map_err(failed)?;
    write_bytes(path, &bytes)?;
    Ok(shown)
}

/// Returns the text line above a frame: its index and its time, with the digits that the time steps require.
pub fn frame_note(time: &[f64], frame: usize) -> String {
    let n = time.len();
    let step = (time[n - 1] - time[0]) / n.saturating_sub(1).max(1) as f64;
    let digits = match step > 0.0 {
        true => (-step.log10()).ceil().clamp(1.0, 6.0) as usize,
        false => 3,
    };
    format!(
        "t = {:.digits$} s, frame {frame} of 0–{}",
        time[frame],
        n - 1
    )
}

fn start(
    out: &mut Vec<u8>,
    (width, height): (usize, usize),
    n_shown: usize,
) -> std::result::Result<png::Writer<&mut Vec<u8>>, EncodingError> {
    let mut encoder = Encoder::new(out, width as u32, height as u32);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_animated(n_shown as u32, 0)?;
    encoder.set_blend_op(BlendOp::Over)?;
    encoder.write_header()
}

/// Appends a frame to the animation file. Only the rows that changed since the previous frame are written, with unchanged pixels transparent. The file is ten
/// times smaller than with whole frames.
fn add(
    film: &mut png::Writer<&mut Vec<u8>>,
    before: Option<&Picture>,
    now: &Picture,
    shown: &ShownFrame,
) -> std::result::Result<(), EncodingError> {
    let before = before.map(|before| &before.rgb[..]);
    let (rows, part) = changed_rows(before, &now.rgb, now.width);
    let (numerator, denominator) = delay(shown.milliseconds);
    film.set_frame_delay(numerator, denominator)?;
    // The position is reset first, because the new rows must fit at the position of the previous ones.
    film.set_frame_position(0, 0)?;
    film.set_frame_dimension(now.width as u32, rows.len() as u32)?;
    film.set_frame_position(0, rows.start as u32)?;
    film.write_image_data(&part)
}

/// Converts a delay to the form in APNG files: a fraction of a second with 16-bit numerator and denominator.
fn delay(milliseconds: u64) -> (u16, u16) {
    match u16::try_from(milliseconds) {
        Ok(milliseconds) => (milliseconds, 1000),
        Err(_) => (u16::try_from(milliseconds / 1000).unwrap_or(u16::MAX), 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total(shown: &[ShownFrame]) -> u64 {
        shown[..shown.len() - 1]
            .iter()
            .map(|s| s.milliseconds)
            .sum()
    }

    fn play(time: &[f64], speed: f64, fps: f64) -> Vec<ShownFrame> {
        shown_frames(time, &Playback { speed, fps }).unwrap()
    }

    #[test]
    fn playing_takes_as_long_as_it_took_whatever_the_frames() {
        let even: Vec<f64> = (0..1001).map(|k| 0.002 * f64::from(k)).collect();
        let uneven: Vec<f64> = (0..200).map(|k| 0.5 + 1e-4 * f64::from(k * k)).collect();
        for time in [&even, &uneven] {
            let span = time[time.len() - 1] - time[0];
            for (speed, fps) in [(1.0, 25.0), (0.1, 50.0), (3.0, 10.0), (1e-3, 30.0)] {
                let shown = play(time, speed, fps);
                let expected = (span / speed * 1e3).round() as u64;
                assert_eq!(total(&shown), expected, "{speed} {fps}");
                assert_eq!(
                    (shown[0].frame, shown[shown.len() - 1].frame),
                    (0, time.len() - 1)
                );
                assert!(shown.windows(2).all(|pair| pair[0].frame < pair[1].frame));
                assert!(shown.len() <= MAX_SHOWN);
            }
        }
    }

    #[test]
    fn even_frames_are_thinned_evenly() {
        let time: Vec<f64> = (0..1001).map(|k| 0.002 * f64::from(k)).collect();
        let shown = play(&time, 1.0, 25.0);
        let frames: Vec<usize> = shown.iter().map(|s| s.frame).collect();
        assert_eq!(frames, (0..=1000).step_by(20).collect::<Vec<_>>());
        assert!(shown.iter().all(|s| s.milliseconds == 40));
    }

    #[test]
    fn frames_that_are_slower_than_the_playback_are_all_shown() {
        let shown = play(&[0.0, 0.5, 0.7, 2.0], 1.0, 25.0);
        let expected = [(0, 500), (1, 200), (2, 1300), (3, 1300)];
        assert_eq!(shown.len(), 4);
        for (shown, (frame, milliseconds)) in shown.iter().zip(expected) {
            assert_eq!(
                *shown,
                ShownFrame {
                    frame,
                    milliseconds
                }
            );
        }
    }

    #[test]
    fn what_cannot_be_played_is_an_error() {
        for (speed, fps) in [
            (0.0, 25.0),
            (f64::NAN, 25.0),
            (1.0, 0.0),
            (1.0, 60.0),
            (-1.0, 5.0),
        ] {
            assert!(shown_frames(&[0.0, 1.0], &Playback { speed, fps }).is_err());
        }
        assert!(shown_frames(&[], &Playback::default()).is_err());
        assert_eq!(play(&[3.0], 1.0, 25.0).len(), 1);
    }

    #[test]
    fn notes_have_the_digits_of_the_steps() {
        assert_eq!(
            frame_note(&[0.0, 0.002, 0.004], 1),
            "t = 0.002 s, frame 1 of 0–2"
        );
        assert_eq!(frame_note(&[2.0], 0), "t = 2.000 s, frame 0 of 0–0");
    }
}
