//! Conversion between decimal numbers of millimetres in files and metres. Numbers are rounded only once, so a layout keeps its bits when it is written and read
//! again.

/// Converts a decimal number of millimetres to metres; returns `None` if the text is no finite number.
pub(super) fn metres(mm: &str) -> Option<f64> {
    scaled(mm, -3)
}

/// Returns the number in the text, multiplied by a power of ten and rounded once; returns `None` if the text is no finite number.
pub(super) fn scaled(text: &str, power: i64) -> Option<f64> {
    let (digits, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], text[at + 1..].parse::<i64>().ok()?),
        None => (text, 0),
    };
    let number = format!("{digits}e{}", exponent.checked_add(power)?).parse::<f64>();
    number.ok().filter(|number| number.is_finite())
}

/// Returns the decimal number of millimetres, with as few digits as possible, that [`metres`] converts to the given number.
pub(super) fn millimetres(metres: f64) -> String {
    let text = format!("{metres:e}");
    let (digits, exponent) = text.split_once('e').expect("a number with an exponent");
    let exponent = exponent.parse::<i32>().expect("an integer") + 3;
    let text = format!("{digits}e{exponent}");
    // Numbers of usual size are written without an exponent.
    let plain = text.parse::<f64>().map(|mm| mm.to_string());
    let plain = plain
        .ok()
        .filter(|plain| self::metres(plain) == Some(metres));
    plain.filter(|plain| plain.len() < 24).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn millimetres_are_read_as_the_metres_that_were_written() {
        let mut rng = Seed::new(5).named("millimetres").rng();
        let random = (0..20_000).map(|_| {
            let size = 10f64.powi(rng.gen_range(-12..3));
            size * rng.gen_range(-1.0..1.0)
        });
        let special = [0.0, 1e-3, 0.7e-3, 5e-324, f64::MAX / 1e4, -1e-10];
        for number in random.collect::<Vec<f64>>().into_iter().chain(special) {
            assert_eq!(metres(&millimetres(number)), Some(number));
        }
        assert_eq!(
            (&millimetres(1.5e-3)[..], &millimetres(-0.02)[..]),
            ("1.5", "-20")
        );
        assert_eq!((metres("25"), metres("2.5E1")), (Some(0.025), Some(0.025)));
    }

    #[test]
    fn other_texts_are_no_millimetres() {
        for text in ["", "nan", "inf", "1e400", "x", "1e", "1e1e1", "e3"] {
            assert_eq!(metres(text), None, "{text}");
        }
    }
}
