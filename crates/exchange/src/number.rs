//! Numbers in lens files: parsing, scaling, and writing with the fewest digits that represent them exactly.

/// Parses a number as other programs write it: `1.5`, `.5`, `5.`, `+1E-3`, `1d-3`, or a word for infinity. `nan` is rejected.
pub(crate) fn parse(word: &str) -> Option<f64> {
    let plain = word.strip_prefix(['+', '-']).unwrap_or(word);
    let sign = if word.starts_with('-') { -1.0 } else { 1.0 };
    if ["inf", "infinity", "infinite"].iter().any(|name| plain.eq_ignore_ascii_case(name)) {
        return Some(sign * f64::INFINITY);
    }
    if !plain.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    let number: f64 = match plain.parse() {
        Ok(number) => number,
        // Accept the exponent letter of Fortran's double precision.
        Err(_) => plain.replacen(['d', 'D'], "e", 1).parse().ok()?,
    };
    Some(sign * number)
}

/// Converts a curvature per `unit_mm` to a radius, mm; 0 gives infinity. Among all radii that reproduce the curvature within two units in
/// its last place, it returns the one with the fewest digits, since that is what was typed in. Two units are the error of writing the
/// curvature with 16 digits.
pub(crate) fn radius_mm(curvature: f64, unit_mm: f64) -> f64 {
    if curvature == 0.0 {
        return f64::INFINITY;
    }
    let radius = 1.0 / curvature;
    if !radius.is_finite() {
        return f64::INFINITY;
    }
    let plain = (6..16)
        .filter_map(|digits| format!("{radius:.digits$e}").parse::<f64>().ok())
        .find(|candidate| (1.0 / candidate - curvature).abs() <= 2.0 * f64::EPSILON * curvature.abs())
        .unwrap_or(radius);
    plain * unit_mm
}

/// Returns the shortest text that reads back as the same number, with an exponent for very small and large numbers.
pub(crate) fn shortest(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let magnitude = number.abs();
    if (1e-5..1e15).contains(&magnitude) || !number.is_finite() { format!("{number}") } else { format!("{number:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_numbers() {
        for (word, number) in [
            ("1.5", 1.5),
            (".5", 0.5),
            ("5.", 5.0),
            ("-1.E-3", -1e-3),
            ("+2d2", 200.0),
            ("1.0E+01", 10.0),
            ("INFINITY", f64::INFINITY),
            ("-inf", f64::NEG_INFINITY),
        ] {
            assert_eq!(parse(word), Some(number), "{word}");
        }
        for word in ["", "nan", "x", "1.5.2", "--1", "-", "+-1", "e5", "1e", "1,5", "N-BK7"] {
            assert_eq!(parse(word), None, "{word}");
        }
    }

    #[test]
    fn radii_as_they_were_typed() {
        for radius in [41.8, 5.375, -575.0, 14.15, 23.713_000_000_001, -2551.1, 1e-3] {
            assert_eq!(radius_mm(1.0 / radius, 1.0), radius);
        }
        assert_eq!(radius_mm("-5.208333333333333565E-02".parse().expect("a number"), 1.0), -19.2);
        assert_eq!(radius_mm("4.950495049504951E-001".parse().expect("a number"), 1.0), 2.02);
        assert_eq!(radius_mm(0.0, 1.0), f64::INFINITY);
        assert_eq!(radius_mm(-0.0, 25.4), f64::INFINITY);
        assert_eq!(radius_mm(f64::from_bits(1), 1.0), f64::INFINITY);
        assert_eq!(radius_mm(0.5, 25.4), 50.8);
    }

    #[test]
    fn spelling_reads_back() {
        for number in [0.1, -1.5e-7, 1e20, 123_456_789.25, 2.0_f64.powi(-60), 1.0 / 3.0, 1e-5] {
            assert_eq!(shortest(number).parse::<f64>(), Ok(number));
        }
        assert_eq!(shortest(-1.5e-7), "-1.5e-7");
        assert_eq!(shortest(50.0), "50");
        assert_eq!(shortest(-0.0), "0");
    }
}
