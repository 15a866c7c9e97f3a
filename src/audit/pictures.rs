//! Pictures of an audit: the state of each taxel, and frames of doubtful touches.

use crate::audit::checks::{label_noise, near_duplicates};
use crate::audit::context::Context;
use crate::audit::finding::{Finding, Verdict};
use crate::audit::tables::taxel_states;
use crate::error::Result;
use crate::report::pictures::colours::heat;
use crate::report::pictures::picture::Picture;
use crate::report::study_folder::NamedPicture;
use bubbletouch_sim::audit::pooled::spans;
use bubbletouch_sim::raster::Rgb;
use ndarray::{Axis, s};

/// Width of a picture of frames on the page, pixels.
const MAX_WIDTH: usize = 900;
/// Maximum number of pairs of frames in a picture.
const MAX_PAIRS: usize = 4;
/// Space between two frames, pixels.
const GAP: usize = 8;

/// Rectangles of coloured taxels side by side.
struct Panels {
    shape: (usize, usize),
    /// Colours of the taxels of each panel, row by row.
    panels: Vec<Vec<Rgb>>,
    /// Number of panels that belong together in one row of panels.
    n_across: usize,
}

/// Draws the pictures of an audit.
///
/// # Errors
/// If a picture cannot be encoded.
pub fn pictures(context: &Context, findings: &[Finding]) -> Result<Vec<NamedPicture>> {
    let n_taxels = context.taxels.len();
    // Without a grid, the taxels of the list are arranged in a rectangle.
    let columns = (n_taxels as f64).sqrt().ceil() as usize;
    let shape = context
        .data
        .grid
        .unwrap_or((n_taxels.div_ceil(columns), columns));
    let mut pictures = vec![taxel_picture(context, shape)?];
    let is_fault = |picture: &str| {
        let shown = findings.iter().filter(|finding| finding.picture == picture);
        shown
            .into_iter()
            .any(|finding| finding.verdict == Verdict::Fault)
    };
    let duplicates = near_duplicates::pairs(context).map_or(&[][..], |found| &found.pairs);
    if is_fault("near_duplicates") && !duplicates.is_empty() {
        let touches = duplicates.iter().take(MAX_PAIRS);
        let touches: Vec<usize> = touches.flat_map(|pair| [pair.0, pair.1]).collect();
        let title = "Near-duplicates: each pair shows a touch and its nearest touch";
        pictures.push(frames_picture(
            context,
            shape,
            &touches,
            ("near_duplicates", title),
        )?);
    }
    let doubtful = label_noise::deep_touches(context).map_or(&[][..], |found| &found.doubtful);
    let typical = |class: usize| {
        let best = context.best_at_random()?;
        let touches = 0..context.labels.len();
        let mut touches = touches.filter(|&touch| context.labels[touch] == class);
        touches.find(|&touch| best.is_correct[touch] == Some(true))
    };
    if is_fault("doubtful_labels") && !doubtful.is_empty() {
        let touches = doubtful.iter().take(MAX_PAIRS).flat_map(|doubtful| {
            let example = typical(doubtful.class).unwrap_or(doubtful.touch);
            [doubtful.touch, example]
        });
        let touches: Vec<usize> = touches.collect();
        let title = "Doubtful labels: each pair shows a touch and one of the class that the classifier gives it";
        pictures.push(frames_picture(
            context,
            shape,
            &touches,
            ("doubtful_labels", title),
        )?);
    }
    Ok(pictures)
}

/// Draws the mean reading of each taxel; faulty taxels are coloured.
fn taxel_picture(context: &Context, shape: (usize, usize)) -> Result<NamedPicture> {
    let means = context.taxels.iter().map(|taxel| taxel.mean);
    let (least, largest) = means
        .clone()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |range, x| {
            (range.0.min(x), range.1.max(x))
        });
    let grey = |mean: f64| {
        let place = if largest > least {
            (mean - least) / (largest - least)
        } else {
            0.0
        };
        [235.0 - 150.0 * place; 3].map(|level| level as u8)
    };
    let states = taxel_states(context);
    let colours = means.zip(states).map(|(mean, state)| match state {
        "dead" => [0, 114, 178],
        "stuck" => [213, 94, 0],
        "hot" => [204, 20, 60],
        _ => grey(mean),
    });
    let mut colours: Vec<Rgb> = colours.collect();
    for (taxel, _) in context
        .n_missing
        .iter()
        .enumerate()
        .filter(|(_, n)| **n > 0)
    {
        colours[taxel] = Rgb::from([0, 158, 115]);
    }
    let panels = Panels {
        shape,
        panels: vec![colours],
        n_across: 1,
    };
    let title = "Taxels: dark is a high mean reading; blue is dead, orange stuck, red hot, green has missing readings";
    panels.picture("taxels", title, MAX_WIDTH / 2)
}

/// Draws the mean frames of touches, two side by side.
fn frames_picture(
    context: &Context,
    shape: (usize, usize),
    touches: &[usize],
    (name, title): (&str, &str),
) -> Result<NamedPicture> {
    let (zero, full_scale) = context.scale;
    let panels = touches.iter().map(|touch| {
        let n = context.data.n_frames;
        let frames = context
            .data
            .frames
            .slice(s![touch * n..(touch + 1) * n, ..]);
        let mean = spans(frames, n, 1);
        let place = |reading: &f64| ((reading - zero) / (full_scale - zero)).clamp(0.0, 1.0);
        let places = mean
            .index_axis(Axis(0), 0)
            .iter()
            .map(place)
            .collect::<Vec<_>>();
        let largest = places.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        places.iter().map(|place| heat(place / largest)).collect()
    });
    let panels = Panels {
        shape,
        panels: panels.collect(),
        n_across: 2,
    };
    panels.picture(name, title, MAX_WIDTH / 2)
}

impl Panels {
    /// Draws the panels, each taxel as a square, at most `width` pixels wide.
    fn picture(&self, name: &str, title: &str, width: usize) -> Result<NamedPicture> {
        let (rows, columns) = self.shape;
        let n_down = self.panels.len().div_ceil(self.n_across);
        let room = width.saturating_sub(GAP * (self.n_across - 1)) / self.n_across;
        let side = (room / columns).min(400 / rows.max(1)).clamp(1, 24);
        let (wide, high) = (columns * side, rows * side);
        let size = (
            self.n_across * wide + (self.n_across - 1) * GAP,
            n_down * high + (n_down - 1) * GAP,
        );
        let mut rgb = vec![255; 3 * size.0 * size.1];
        for (panel, colours) in self.panels.iter().enumerate() {
            let left = panel % self.n_across * (wide + GAP);
            let top = panel / self.n_across * (high + GAP);
            for (taxel, colour) in colours.iter().enumerate() {
                let (row, column) = (taxel / columns, taxel % columns);
                // Row 0 of a grid is at the bottom.
                let y = top + (rows - 1 - row) * side;
                for y in y..y + side {
                    let start = 3 * (y * size.0 + left + column * side);
                    let pixels = &mut rgb[start..start + 3 * side];
                    for pixel in pixels.chunks_exact_mut(3) {
                        pixel.copy_from_slice(colour);
                    }
                }
            }
        }
        let picture = Picture {
            width: size.0,
            height: size.1,
            rgb,
        };
        Ok(NamedPicture {
            name: name.to_owned(),
            title: title.to_owned(),
            png: picture.png()?,
            size,
        })
    }
}
