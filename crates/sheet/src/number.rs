//! Formatting of numbers as text.

/// Formats a number with six digits, with a power of ten if it is under 1e-4 or over 1e6. Zero is `0`.
#[must_use]
pub fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let shown = format!("{value:.5e}");
    // The power of ten is taken after rounding.
    match shown.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok()) {
        Some(power @ -4..=5) => format!("{value:.*}", usize::try_from(5 - power).unwrap_or(0)),
        _ => shown,
    }
}

/// Formats a fraction as a percentage with this many decimals. A value that rounds to zero has no sign.
#[must_use]
pub fn percent(fraction: f64, decimals: usize) -> String {
    let shown = format!("{:.decimals$}", 100.0 * fraction);
    let is_zero = shown.trim_start_matches('-').bytes().all(|digit| matches!(digit, b'0' | b'.'));
    format!("{} %", if is_zero { shown.trim_start_matches('-') } else { &shown })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_six_digits() {
        assert_eq!(
            [0.0, 12.345_678_9, 123_456.7, 1.5e9, 2e-5, 999_999.9].map(significant),
            ["0", "12.3457", "123457", "1.50000e9", "2.00000e-5", "1.00000e6"]
        );
    }

    #[test]
    fn percentages_that_round_to_zero_have_no_sign() {
        assert_eq!([0.5, -0.001, -1e-7].map(|v| percent(v, 2)), ["50.00 %", "-0.10 %", "0.00 %"]);
    }
}
