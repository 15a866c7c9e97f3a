//! Reading of single numbers, and formatting of numbers for display.

/// Returns the finite number that a word contains; `None` for another word.
pub(crate) fn finite_number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Formats a number for readers with four significant digits and without trailing zeros, such as `2.05 million` or `3 × 10⁻⁵`.
pub fn short_number(number: f64) -> String {
    let power = number.abs().log10().floor();
    let (unit, word) = match power {
        6.0..9.0 => (1e6, " million"),
        9.0..12.0 => (1e9, " billion"),
        _ if (-4.0..6.0).contains(&power) || !power.is_finite() => return short_literal(number),
        _ => (10f64.powf(power), ""),
    };
    let digits = short_literal(number / unit);
    if !word.is_empty() {
        return digits + word;
    }
    let raised = |letter: char| match letter.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    let exponent: String = power.to_string().chars().map(raised).collect();
    match &digits[..] {
        "1" => format!("10{exponent}"),
        _ => format!("{digits} × 10{exponent}"),
    }
}

/// Formats a number with four significant digits and without trailing zeros as a literal of a TOML file, such as `2.05e6`.
pub fn short_literal(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    if !number.is_finite() {
        return number.to_string();
    }
    let digits_before = number.abs().log10().floor() as i32 + 1;
    if !(-3..=6).contains(&digits_before) {
        return format!("{number:.2e}").replace(".00e", "e");
    }
    let decimals = (4 - digits_before).max(0) as usize;
    let text = format!("{number:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Formats a time in seconds with a suitable unit and three significant digits, such as `20.3 µs`.
pub fn time_words(seconds: f64) -> String {
    if seconds == 0.0 {
        return "0 s".to_owned();
    }
    let (value, unit) = match seconds.abs() {
        s if s < 0.999e-6 => (seconds * 1e9, "ns"),
        s if s < 0.999e-3 => (seconds * 1e6, "µs"),
        s if s < 0.999 => (seconds * 1e3, "ms"),
        _ => (seconds, "s"),
    };
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    format!("{rounded} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_short_and_true() {
        for (number, text) in [
            (0.0, "0"),
            (7.0, "7"),
            (0.1, "0.1"),
            (1.0 / 3.0, "0.3333"),
            (1024.0, "1024"),
            (102.4, "102.4"),
            (12345.6, "12346"),
            (1e-5, "10⁻⁵"),
            (2.5e7, "25 million"),
            (-2.0512e6, "-2.051 million"),
            (3e9, "3 billion"),
            (2.5e-12, "2.5 × 10⁻¹²"),
            (2e15, "2 × 10¹⁵"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short_number(number), text);
        }
        assert_eq!([1e-5, 2.5e7].map(short_literal), ["1e-5", "2.50e7"]);
    }

    #[test]
    fn times_are_said_in_the_unit_that_suits_them_with_three_digits() {
        for (seconds, words) in [
            (0.0, "0 s"),
            (1e-9, "1 ns"),
            (4.2e-8, "42 ns"),
            (1e-6, "1 µs"),
            (2.0349e-5, "20.3 µs"),
            (0.12, "120 ms"),
            (1.0, "1 s"),
            (1234.0, "1230 s"),
        ] {
            assert_eq!(time_words(seconds), words);
        }
    }
}
