//! Exposure times as a photographer writes them.

/// Largest distance of 1/t from a whole number that still counts as that number, relative and absolute.
const WHOLE: (f64, f64) = (1e-6, 1e-3);

/// Formats an exposure time in seconds as a photographer writes it: `1/125 s`, `1/700 s`, `0.4 s`, `2 s`. One over a whole
/// number is shown exactly. Other times are rounded to what a shutter can distinguish: two digits below 0.3 s, three from there
/// on. Below 1e-7 s and from 1e5 s on, the time is shown as a plain number.
#[must_use]
pub fn format_time(seconds: f64) -> String {
    if !(1e-7..1e5).contains(&seconds) {
        return match seconds {
            0.0 => "0 s".to_owned(),
            s if s.is_finite() => format!("{} s", short(&format!("{s:.2e}"))),
            s => format!("{s} s"),
        };
    }
    let below = 1.0 / seconds;
    if seconds < 1.0 && (below - below.round()).abs() <= WHOLE.1.min(WHOLE.0 * below) {
        return format!("1/{} s", below.round());
    }
    if seconds >= 0.3 {
        return format!("{} s", digits(seconds, 3));
    }
    let rounded = if below < 10.0 { below.round() } else { digits(below, 2) };
    // Between 1/3 and 1/10 s a fraction may be too coarse.
    if (rounded - below).abs() <= 0.03 * below || below >= 10.0 {
        format!("1/{rounded} s")
    } else {
        format!("{} s", digits(seconds, 2))
    }
}

/// Rounds a number to `count` significant digits.
fn digits(value: f64, count: usize) -> f64 {
    format!("{value:.*e}", count - 1).parse().unwrap_or(value)
}

/// Drops trailing zeros of the mantissa: `1.20e-9` becomes `1.2e-9`.
fn short(text: &str) -> String {
    match text.split_once('e') {
        Some((number, power)) => format!("{}e{power}", number.trim_end_matches('0').trim_end_matches('.')),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_those_of_a_shutter() {
        let times = [
            1.0 / 125.0,
            1.0 / 137.0,
            0.00143,
            0.00978,
            0.0433,
            0.14,
            0.135,
            1.0 / 3.0,
            0.5,
            0.4,
            1.0,
            1.25,
            2.0,
            1234.0,
            8.01e-6,
            0.0,
            1.2e-9,
        ];
        let wanted = [
            "1/125 s",
            "1/137 s",
            "1/700 s",
            "1/100 s",
            "1/23 s",
            "1/7 s",
            "0.14 s",
            "1/3 s",
            "1/2 s",
            "0.4 s",
            "1 s",
            "1.25 s",
            "2 s",
            "1230 s",
            "1/120000 s",
            "0 s",
            "1.2e-9 s",
        ];
        assert_eq!(times.map(format_time), wanted);
    }

    /// The text is never farther from the time than a third of a third-stop.
    #[test]
    fn words_stay_near_the_time() {
        for i in 0..4000 {
            let seconds = 1e-7 * crate::math::pow(1e11, f64::from(i) / 4000.0);
            let text = format_time(seconds);
            let number = text.trim_end_matches(" s");
            let said = match number.split_once('/') {
                Some((_, below)) => 1.0 / below.parse::<f64>().expect("a number"),
                None => number.parse().expect("a number"),
            };
            assert!((said / seconds - 1.0).abs() < 0.051, "{seconds}: {text}");
        }
    }
}
