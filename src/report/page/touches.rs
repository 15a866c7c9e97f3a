//! Sample touches as heat maps side by side, with a common colour scale.

use crate::error::Result;
use crate::report::page::picture::png_element;
use crate::report::pictures::colours::heat;
use crate::report::pictures::drawing::escape;
use crate::report::pictures::heat_map::{
    ColourScale, block_sentence, check_frame, largest_of_blocks,
};
use crate::report::pictures::picture::Picture;
use crate::report::pictures::snapshots::Snapshots;
use crate::table::short_number;
use ndarray::Array2;

/// Maximum number of pixels along each side of a frame's heat map. In larger frames, each pixel shows the largest value of a block of taxels.
const MAX_CELLS: usize = 96;
/// Maximum number of touches whose frames a page shows; each frame needs some kilobytes.
const MAX_TOUCHES: usize = 120;
/// Number of distinct colours in a heat map.
const N_COLOURS: f64 = 128.0;

/// Returns the frames of a set of touches as HTML. An error contains the name of the frame that cannot be drawn.
pub fn touches_html(set: &Snapshots) -> Result<String> {
    for (name, frame) in &set.frames {
        check_frame(frame).map_err(|error| error.under(format!("{name}: ")))?;
    }
    let scale = ColourScale::over(set.frames.iter().flat_map(|(_, frame)| frame), set.quantity);
    let largest = set.frames.iter().map(|(_, f)| f.nrows().max(f.ncols()));
    let block = largest.max().unwrap_or(1).div_ceil(MAX_CELLS);
    let mut html = format!(
        "<p class=\"quiet\">{}{}; x runs to the right, y up.</p>",
        escape(&set.caption),
        block_sentence(block)
    );
    html += &colour_bar(scale)?;
    html += "<div class=\"touches\">";
    for (name, frame) in set.frames.iter().take(MAX_TOUCHES) {
        let shown = largest_of_blocks(frame, (block, block));
        let places = shown.mapv(|value| scale.place(value));
        let title = format!("{name}: largest {}", value_words(frame, set));
        let (image, name) = (image(&places, &title)?, escape(name));
        html += &format!("<figure>{image}<figcaption>{name}</figcaption></figure>");
    }
    html += "</div>";
    if set.frames.len() > MAX_TOUCHES {
        let n = set.frames.len();
        html += &format!("<p class=\"quiet\">The first {MAX_TOUCHES} of {n}.</p>");
    }
    Ok(html)
}

fn value_words(frame: &Array2<f64>, set: &Snapshots) -> String {
    let largest = frame.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let shown = short_number(largest * set.quantity.factor());
    format!("{} {shown} {}", set.quantity.name(), set.quantity.unit())
}

fn colour_bar(scale: ColourScale) -> Result<String> {
    let bar = Array2::from_shape_fn((1, 129), |(_, x)| x as f64 / N_COLOURS);
    let image = image(&bar, "dark is low, light is high")?;
    let [low, high] = [scale.low, scale.high].map(|end| format!("{end:.2}").replace('-', "−"));
    let (name, unit) = (scale.quantity.name(), scale.quantity.unit());
    Ok(format!(
        "<p class=\"colours\">{name} <span>{low}</span>{image}<span>{high} {unit}</span></p>"
    ))
}

fn image(places: &Array2<f64>, title: &str) -> Result<String> {
    let pixels = pixels(places);
    let size = (pixels.width, pixels.height);
    Ok(png_element(&pixels.png()?, size, title))
}

/// Returns a picture with one pixel per value (0 to 1). Row 0 of the values, the lowest y, is at the bottom.
fn pixels(places: &Array2<f64>) -> Picture {
    let (height, width) = places.dim();
    let rows = places.outer_iter().rev();
    // A small number of colours gives small files.
    let colour = |place: &f64| heat((place * N_COLOURS).round() / N_COLOURS);
    Picture {
        width,
        height,
        rgb: rows.flatten().flat_map(colour).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn the_lowest_row_is_at_the_bottom() {
        let places = array![[0.0, 1.0], [0.5, 0.0], [0.25, 0.25]];
        let pixels = pixels(&places);
        assert_eq!((pixels.width, pixels.height), (2, 3));
        let pixel = |x: usize, y: usize| [0, 1, 2].map(|c| pixels.rgb[3 * (2 * y + x) + c]);
        assert_eq!(pixel(0, 2), heat(0.0));
        assert_eq!(pixel(1, 2), heat(1.0));
        assert_eq!(pixel(0, 1), heat(0.5));
        assert_eq!(pixel(0, 0), heat(0.25));
    }
}
