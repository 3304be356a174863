//! Units in the heads of columns.

/// A hint for a unit that is not known.
pub(super) const HINT: &str = "mm, cm, m, in (inch) and um are known, as in `radius [in]`; without a unit it is mm";

/// Millimeters of a unit of length.
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

/// A column's name and its unit: in brackets, or behind the last `_` or blank where that is one.
pub(super) fn split(head: &str) -> (&str, Option<&str>) {
    if let Some((name, rest)) = head.split_once(['[', '(']) {
        return (name, Some(rest.trim_end_matches([']', ')', ' '])));
    }
    match head.rsplit_once(['_', ' ']) {
        Some((name, unit)) if length_mm(unit).is_some() => (name, Some(unit)),
        _ => (head, None),
    }
}
