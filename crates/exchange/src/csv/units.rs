//! Units in the headings of columns.

/// Hint for an unknown unit.
pub(super) const HINT: &str = "write mm, cm, m, in (inch) or um, as in `radius [in]`; without a unit it is mm";

/// Returns a unit of length in mm; `None` if it is unknown.
pub(super) fn length_mm(unit: &str) -> Option<f64> {
    Some(match unit.trim().to_lowercase().as_str() {
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => 1.0,
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => 10.0,
        "m" | "meter" | "meters" | "metre" | "metres" => 1000.0,
        "in" | "inch" | "inches" | "\u{2033}" => 25.4,
        "um" | "\u{b5}m" | "\u{3bc}m" | "micrometer" | "micrometers" | "micron" | "microns" => 1e-3,
        _ => return None,
    })
}

/// Splits a heading into name and unit. The unit is in brackets, or follows the last `_` or blank if it is a known one.
pub(super) fn split(head: &str) -> (&str, Option<&str>) {
    if let Some((name, rest)) = head.split_once(['[', '(']) {
        return (name, Some(rest.trim_end_matches([']', ')', ' '])));
    }
    match head.rsplit_once(['_', ' ']) {
        Some((name, unit)) if length_mm(unit).is_some() => (name, Some(unit)),
        _ => (head, None),
    }
}
