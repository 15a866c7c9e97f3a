//! Pictures of an audit: the state of each taxel, and frames of doubtful touches.

use crate::audit::claim::Claim;
use crate::audit::context::Context;
use crate::audit::readings::TaxelState;
use crate::error::Result;
use crate::report::pictures::colours::heat;
use crate::report::pictures::picture::Picture;
use crate::report::study_folder::NamedPicture;
use bubbletouch_sim::raster::Rgb;

/// Largest width and height of the pictures of a row, pixels.
const WIDTH: usize = 450;
/// Maximum number of pairs of frames in a picture.
const MAX_PAIRS: usize = 4;
/// Space between two frames, pixels.
const GAP: usize = 8;

/// Draws the pictures of an audit.
///
/// # Errors
/// If a picture cannot be encoded.
pub fn pictures(
    context: &Context,
    claim: &Claim,
    states: &[TaxelState],
) -> Result<Vec<NamedPicture>> {
    let n_taxels = context.taxels.len();
    // Without a grid, the taxels of the list are arranged in a rectangle.
    let columns = (n_taxels as f64).sqrt().ceil() as usize;
    let shape = context
        .data
        .grid
        .unwrap_or((n_taxels.div_ceil(columns), columns));
    let mut pictures = vec![taxel_picture(context, states, shape)?];
    let copies = claim.copies.iter().map(|set| [set.rows[0], set.rows[1]]);
    let nearest = |touch: usize| context.near.neighbours[touch][0];
    let doubtful = claim.doubtful.iter().map(|doubtful| doubtful.touch);
    let doubtful = doubtful.map(|touch| [touch, nearest(touch)]);
    let rows: [(&str, &str, Vec<[usize; 2]>); 2] = [
        (
            "copies",
            "Copies: each pair shows a touch and its copy",
            copies.take(MAX_PAIRS).collect(),
        ),
        (
            "doubtful_labels",
            "Labels to look at: each pair shows a touch and its nearest touch, of another class",
            doubtful.take(MAX_PAIRS).collect(),
        ),
    ];
    let named = |touch: &usize| {
        let class = context.data.classes.get(context.labels[*touch]);
        class.map_or_else(|| touch.to_string(), |class| format!("{touch} ({class})"))
    };
    for (name, title, pairs) in rows {
        if !pairs.is_empty() {
            let said = pairs
                .iter()
                .map(|pair| pair.each_ref().map(named).join(" and "));
            let said = said.collect::<Vec<_>>().join(", ");
            let title = format!("{title}; touches, from the top: {said}");
            let panels = pairs.into_iter().flatten();
            let panels: Vec<_> = panels.map(|touch| colours_of(context, touch)).collect();
            pictures.push(draw((name, &title), shape, &panels)?);
        }
    }
    Ok(pictures)
}

/// Draws the mean reading of each taxel; faulty taxels are coloured.
fn taxel_picture(
    context: &Context,
    states: &[TaxelState],
    shape: (usize, usize),
) -> Result<NamedPicture> {
    let means = context.taxels.iter().map(|taxel| taxel.mean);
    let least = means.clone().fold(f64::INFINITY, f64::min);
    let largest = means.clone().fold(f64::NEG_INFINITY, f64::max);
    let range = (largest - least).max(f64::MIN_POSITIVE);
    let taxels = means.zip(states).zip(&context.n_missing);
    let colours = taxels.map(|((mean, state), n_missing)| match state {
        _ if *n_missing > 0 => [0, 158, 115],
        TaxelState::Constant => [0, 114, 178],
        TaxelState::Stuck => [213, 94, 0],
        TaxelState::Equal => [204, 121, 167],
        TaxelState::Working => [(235.0 - 150.0 * (mean - least) / range) as u8; 3],
    });
    let title = "Taxels: dark is a high mean reading; blue is constant, orange stuck for some time, pink equal to another, green has missing readings";
    draw(("taxels", title), shape, &[colours.collect()])
}

/// Returns the colours of the mean frame of a touch, as deviations from the medians of the taxels.
fn colours_of(context: &Context, touch: usize) -> Vec<Rgb> {
    let readings = context.means.row(touch);
    let away = readings.iter().zip(&context.taxels);
    let away: Vec<f64> = away.map(|(x, taxel)| (x - taxel.median).abs()).collect();
    let largest = away.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    away.iter().map(|x| heat(x / largest)).collect()
}

/// Draws rectangles of coloured taxels, two side by side, each taxel as a square. Row 0 of a grid is at the bottom.
fn draw(
    (name, title): (&str, &str),
    (rows, columns): (usize, usize),
    panels: &[Vec<Rgb>],
) -> Result<NamedPicture> {
    let n_across = panels.len().min(2);
    let n_down = panels.len().div_ceil(n_across);
    let side = (WIDTH / n_across / columns).min(WIDTH / rows).clamp(1, 24);
    let (wide, high) = (columns * side + GAP, rows * side + GAP);
    let size = (n_across * wide - GAP, n_down * high - GAP);
    let mut rgb = vec![255; 3 * size.0 * size.1];
    for (panel, colours) in panels.iter().enumerate() {
        let (left, top) = (panel % n_across * wide, panel / n_across * high);
        for (taxel, colour) in colours.iter().enumerate() {
            let (row, column) = (taxel / columns, taxel % columns);
            let y = top + (rows - 1 - row) * side;
            for y in y..y + side {
                let start = 3 * (y * size.0 + left + column * side);
                let pixels = &mut rgb[start..start + 3 * side];
                let pixels = pixels.chunks_exact_mut(3);
                pixels.for_each(|pixel| pixel.copy_from_slice(colour));
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
