//! Colours of lines that colour-blind readers can distinguish, and colour maps for numbers.

pub use bubbletouch_sim::raster::Rgb;
use kuva::plot::ColorMap;

/// Default colour of objects in pictures: slate blue.
pub(crate) const PAINT: Rgb = [142, 178, 214];

/// Colour of text and axes.
pub const INK: Rgb = [0x1f, 0x23, 0x28];
/// Colour of secondary text, such as notes.
pub const MUTED: Rgb = [0x5c, 0x63, 0x6b];
/// Colour of grid lines.
pub const GRID: Rgb = [0xe4, 0xe6, 0xe9];
/// Background colour of charts and drawings.
pub const PAPER: Rgb = [0xff, 0xff, 0xff];

/// Line colours: the palette of Okabe and Ito (2008), without yellow (too pale on white) and with purple, because a study may compare eight classifiers.
pub const LINES: [Rgb; 8] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0xe6, 0x9f, 0x00],
    [0x56, 0xb4, 0xe9],
    [0x1f, 0x23, 0x28],
    [0x6a, 0x3d, 0x9a],
];

/// Returns the colour of a value from 0 to 1 (other values are clamped) in a perceptually uniform colour map; low values are dark.
pub fn heat(value: f64) -> Rgb {
    of_map(&ColorMap::Viridis, value)
}

/// Returns a shade of blue from pale (0) to dark (1); values outside 0 to 1 are clamped. The colour of 0 is not white, because white means that a value is
/// absent.
pub fn tint(part: f64) -> Rgb {
    of_map(&ColorMap::Blues, 0.12 + 0.88 * part.clamp(0.0, 1.0))
}

/// Returns the colour of a value from −1 to 1 (other values are clamped): dark blue, white at 0, dark red. Colour-blind readers can distinguish the colours.
pub fn diverging(value: f64) -> Rgb {
    of_map(&ColorMap::RedBlue, 0.5 * (1.0 - value))
}

fn of_map(map: &ColorMap, value: f64) -> Rgb {
    map.map_rgb(value).map_or(INK, |(r, g, b)| [r, g, b])
}

/// Returns the colour for text, black or white, that has more contrast with the background.
pub fn text_on(ground: Rgb) -> Rgb {
    let [r, g, b] = ground.map(f64::from);
    // Rec. 709 luma is sufficient to distinguish light and dark colours.
    if 0.2126 * r + 0.7152 * g + 0.0722 * b < 140.0 {
        PAPER
    } else {
        INK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luma([r, g, b]: Rgb) -> f64 {
        0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
    }

    #[test]
    fn heat_grows_lighter_and_tint_grows_darker_all_the_way() {
        for step in 0..32 {
            let (low, high) = (f64::from(step) / 32.0, f64::from(step + 1) / 32.0);
            assert!(luma(heat(low)) < luma(heat(high)), "{low}");
            assert!(luma(tint(low)) > luma(tint(high)), "{low}");
        }
    }

    #[test]
    fn diverging_is_palest_at_zero_and_darkens_both_ways() {
        for step in 0..16 {
            let (near, far) = (f64::from(step) / 16.0, f64::from(step + 1) / 16.0);
            assert!(luma(diverging(near)) > luma(diverging(far)), "{near}");
            assert!(luma(diverging(-near)) > luma(diverging(-far)), "{near}");
        }
        assert!(diverging(1.0)[0] > diverging(1.0)[2] && diverging(-1.0)[2] > diverging(-1.0)[0]);
    }

    #[test]
    fn text_stands_out_from_every_tint() {
        for step in 0..=32 {
            let ground = tint(f64::from(step) / 32.0);
            assert!((luma(text_on(ground)) - luma(ground)).abs() > 80.0);
        }
    }
}
