//! Formatting of numbers for display.

/// Formats a number with four significant digits and without trailing zeros.
pub fn short_number(number: f64) -> String {
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
            (1e-5, "1e-5"),
            (2.5e7, "2.50e7"),
        ] {
            assert_eq!(short_number(number), text);
        }
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
