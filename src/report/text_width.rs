//! Width of texts in DejaVu Sans, the font of the pictures.

/// Widths of the ASCII characters U+0020 to U+007E in thousandths of the font size (DejaVu Sans 2.37, read with fontTools 4).
const ASCII: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337, 636, 636, 636,
    636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632,
    575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787, 695, 635, 611, 732, 684, 989, 685,
    611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579,
    278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838,
];

/// Returns the width of one line of text at a given font size, in the unit of the size.
///
/// A character outside ASCII counts as 0.7 em, slightly more than the mean, so that the reserved space is sufficient.
pub fn text_width(text: &str, size: f64) -> f64 {
    let advance = |letter: char| {
        let place = (letter as usize).wrapping_sub(0x20);
        u64::from(ASCII.get(place).copied().unwrap_or(700))
    };
    let thousandths: u64 = text.chars().map(advance).sum();
    thousandths as f64 * size / 1000.0
}

/// Wraps a text at spaces (not at no-break spaces) into lines of at most `width`, in the unit of the font size. A longer word has a line of its own.
pub fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    break_lines(text, |line| text_width(line, size) <= width)
}

/// Wraps a text at spaces (not at no-break spaces) into lines for which `fits` returns true. A word that does not fit has a line of its own.
pub(super) fn break_lines(text: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        let word = word.replace('\u{a0}', " ");
        match lines.last_mut() {
            Some(line) if fits(&format!("{line} {word}")) => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

/// Returns the text, shortened with an ellipsis if it does not fit into `width`.
pub fn shorten(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let starts = text.char_indices();
    let shorter = starts.map(|(end, _)| format!("{}…", &text[..end]));
    let fitting = shorter.take_while(|shorter| text_width(shorter, size) <= width);
    fitting.last().unwrap_or_else(|| "…".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_lines_fit_and_lose_no_word() {
        let text = "a quasi-static tactile skin simulator with very many settings in one line";
        let lines = wrap(text, 12.0, 140.0);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| text_width(line, 12.0) <= 140.0));
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn a_shortened_text_fits_and_says_that_it_was_cut() {
        let short = shorten("adjustable wrench, large", 10.0, 60.0);
        assert!(text_width(&short, 10.0) <= 60.0);
        assert!(short.ends_with('…') && short.starts_with("adj"));
        assert_eq!(shorten("mug", 10.0, 60.0), "mug");
        // The time does not grow with the square of the length, which would be minutes here.
        let long = [100, 1_000_000].map(|n| shorten(&"m".repeat(n), 10.0, 60.0));
        assert_eq!(long[0], long[1]);
    }
}
