//! Sample touches as heat maps, side by side on one scale of colours.

use crate::error::{Error, Result};
use crate::report::colours::heat;
use crate::report::drawing::escape;
use crate::report::heat_map::{ColourScale, block_sentence, check_frame, largest_of_blocks};
use crate::report::page::about::Snapshots;
use crate::report::page::picture::Picture;
use crate::table::short_number;
use ndarray::Array2;

/// Taxels a side up to which each has a pixel of its own.
const MOST_CELLS: usize = 96;
/// Touches in a page, at most: each is some kilobytes.
const MOST_TOUCHES: usize = 120;
/// Colours of a heat map.
const N_COLOURS: usize = 128;

/// A set of touches; the error says which frame nobody can draw.
pub fn touches_html(set: &Snapshots) -> Result<String> {
    for (name, frame) in &set.frames {
        check_frame(frame).map_err(|error| error.under(format!("{name}: ")))?;
    }
    let scale = ColourScale::over(set.frames.iter().flat_map(|(_, frame)| frame), set.quantity);
    let largest = set.frames.iter().map(|(_, f)| f.nrows().max(f.ncols()));
    let block = largest.max().unwrap_or(1).div_ceil(MOST_CELLS);
    let mut html = format!(
        "<p class=\"quiet\">{}{}; x runs to the right, y up.</p>",
        escape(&set.caption),
        block_sentence(block)
    );
    html += &colour_bar(set, scale)?;
    html += "<div class=\"touches\">";
    for (name, frame) in set.frames.iter().take(MOST_TOUCHES) {
        let shown = largest_of_blocks(frame, (block, block));
        let places = shown.mapv(|value| scale.place(value * set.quantity.factor()));
        let title = format!("{name}: largest {}", value_words(frame, set));
        let image = Picture::of_png(&png(&places)?, (shown.ncols(), shown.nrows()), &title);
        html += &format!(
            "<figure>{}<figcaption>{}</figcaption></figure>",
            image.element,
            escape(name)
        );
    }
    html += "</div>";
    if set.frames.len() > MOST_TOUCHES {
        let n = set.frames.len();
        html += &format!("<p class=\"quiet\">The first {MOST_TOUCHES} of {n}.</p>");
    }
    Ok(html)
}

fn value_words(frame: &Array2<f64>, set: &Snapshots) -> String {
    let largest = frame.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let shown = short_number(largest * set.quantity.factor());
    format!("{} {shown} {}", set.quantity.name(), set.quantity.unit())
}

fn colour_bar(set: &Snapshots, scale: ColourScale) -> Result<String> {
    let bar = Array2::from_shape_fn((1, N_COLOURS), |(_, x)| x as f64 / (N_COLOURS - 1) as f64);
    let image = Picture::of_png(&png(&bar)?, (N_COLOURS, 1), "dark is low, light is high");
    let [low, high] = [scale.low, scale.high].map(|end| format!("{end:.2}").replace('-', "−"));
    let (name, unit) = (set.quantity.name(), set.quantity.unit());
    Ok(format!(
        "<p class=\"colours\">{name} <span>{low}</span>{}<span>{high} {unit}</span></p>",
        image.element
    ))
}

/// A pixel a value between 0 and 1; row 0, the lowest y, at the bottom.
fn png(places: &Array2<f64>) -> Result<Vec<u8>> {
    let failed = |e: png::EncodingError| Error::input("picture", e, "a size that fits into a PNG");
    let (height, width) = places.dim();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    let palette = (0..N_COLOURS).flat_map(|i| heat(i as f64 / (N_COLOURS - 1) as f64));
    encoder.set_palette(palette.collect::<Vec<u8>>());
    encoder.set_compression(png::Compression::High);
    let rows = places.outer_iter().rev();
    let last = (N_COLOURS - 1) as f64;
    let pixels = rows.flatten().map(|place| (place * last).round() as u8);
    let pixels: Vec<u8> = pixels.collect();
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(&pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn the_lowest_row_is_at_the_bottom_and_colours_are_those_of_the_map() {
        let bytes = png(&array![[0.0, 1.0], [0.5, 0.0], [0.25, 0.25]]).unwrap();
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (2, 3));
        let pixel = |x: usize, y: usize| [0, 1, 2].map(|c| pixels[3 * (2 * y + x) + c]);
        assert_eq!(pixel(0, 2), heat(0.0));
        assert_eq!(pixel(1, 2), heat(1.0));
        assert_eq!(pixel(0, 1), heat(64.0 / 127.0));
        assert_eq!(pixel(0, 0), pixel(1, 0));
    }
}
