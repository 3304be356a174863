//! Units in the heads of columns.

use super::columns::Column;

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

/// The power of a length that figures of a column are.
pub(super) fn power(column: Column) -> Option<i32> {
    match column {
        Column::Radius | Column::Thickness | Column::SemiDiameter | Column::Diameter => Some(1),
        Column::Curvature => Some(-1),
        Column::Coefficient(power) => Some(1 - power as i32),
        // Of r^2; each one behind it has two powers less.
        Column::Coefficients => Some(-1),
        _ => None,
    }
}

/// Millimeters of the unit of a column: of a length as it stands, of its powers as `1/in`, `in^-3`, `1/in^3`, or the bare unit of the
/// lens. `None` where it is none, or another power than the column's.
pub(super) fn unit_mm(unit: &str, column: Column) -> Option<f64> {
    let wanted = power(column)?;
    let unit: String = unit.to_lowercase().chars().filter(|c| !c.is_whitespace() && *c != '^').collect();
    let (sign, unit) = match unit.strip_prefix("1/").or(unit.strip_prefix('/')) {
        Some(rest) => (-1, rest),
        None => (1, unit.as_str()),
    };
    let at = unit.find(|c: char| c.is_ascii_digit() || c == '-').unwrap_or(unit.len());
    let (name, digits) = unit.split_at(at);
    let stated = if digits.is_empty() { sign } else { sign * digits.parse::<i32>().ok()? };
    let bare = digits.is_empty() && sign == 1;
    let list = matches!(column, Column::Coefficients);
    (bare || stated == wanted && !list).then(|| length_mm(name)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_columns() {
        for (head, name, unit) in [
            ("radius [in]", "radius ", Some("in")),
            ("Radius (mm)", "Radius ", Some("mm")),
            ("radius_of_curvature_cm", "radius_of_curvature", Some("cm")),
            ("semi_diameter", "semi_diameter", None),
            ("a_4", "a_4", None),
        ] {
            assert_eq!(split(head), (name, unit), "{head}");
        }
        for (unit, column, mm) in [
            ("in", Column::Radius, Some(25.4)),
            ("Inches", Column::Thickness, Some(25.4)),
            ("m", Column::Diameter, Some(1000.0)),
            ("1/cm", Column::Curvature, Some(10.0)),
            ("mm-1", Column::Curvature, Some(1.0)),
            ("in^-3", Column::Coefficient(4), Some(25.4)),
            ("1/in^5", Column::Coefficient(6), Some(25.4)),
            ("in", Column::Coefficient(4), Some(25.4)),
            ("in^-3", Column::Coefficient(6), None),
            ("in^-3", Column::Coefficients, None),
            ("1/mm", Column::Radius, None),
            ("furlong", Column::Radius, None),
            ("mm", Column::Index, None),
        ] {
            assert_eq!(unit_mm(unit, column), mm, "{unit} {column:?}");
        }
    }
}
