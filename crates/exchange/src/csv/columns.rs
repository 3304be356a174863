//! Names of the columns of a table.

/// Content of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Lens,
    Number,
    Kind,
    Radius,
    Curvature,
    Thickness,
    Glass,
    Index,
    Abbe,
    SemiDiameter,
    Diameter,
    Conic,
    /// Coefficient of this power of the distance from the axis.
    Coefficient(u32),
    Coefficients,
    Comment,
    /// A value that follows from others, or does not belong to a surface.
    Unused,
}

/// Column names in lower case, without blanks, dashes and units.
const NAMES: [(&str, Column); 122] = [
    ("lens", Column::Lens),
    ("name", Column::Lens),
    ("lensname", Column::Lens),
    ("surface", Column::Number),
    ("surf", Column::Number),
    ("number", Column::Number),
    ("no", Column::Number),
    ("#", Column::Number),
    ("index#", Column::Number),
    ("type", Column::Kind),
    ("kind", Column::Kind),
    ("surfacetype", Column::Kind),
    ("radius", Column::Radius),
    ("r", Column::Radius),
    ("roc", Column::Radius),
    ("radiusofcurvature", Column::Radius),
    ("curvature", Column::Curvature),
    ("curv", Column::Curvature),
    ("c", Column::Curvature),
    ("thickness", Column::Thickness),
    ("t", Column::Thickness),
    ("d", Column::Thickness),
    ("distance", Column::Thickness),
    ("separation", Column::Thickness),
    ("gap", Column::Thickness),
    ("glass", Column::Glass),
    ("glassafter", Column::Glass),
    ("material", Column::Glass),
    ("medium", Column::Glass),
    ("nd", Column::Index),
    ("n", Column::Index),
    ("ndafter", Column::Index),
    ("index", Column::Index),
    ("refractiveindex", Column::Index),
    ("vd", Column::Abbe),
    ("v", Column::Abbe),
    ("vdafter", Column::Abbe),
    ("abbe", Column::Abbe),
    ("abbenumber", Column::Abbe),
    ("semidiameter", Column::SemiDiameter),
    ("sd", Column::SemiDiameter),
    ("semiaperture", Column::SemiDiameter),
    ("clearsemidiameter", Column::SemiDiameter),
    ("diameter", Column::Diameter),
    ("diam", Column::Diameter),
    ("clearaperture", Column::Diameter),
    ("conic", Column::Conic),
    ("k", Column::Conic),
    ("conicconstant", Column::Conic),
    ("aspherecoefficients", Column::Coefficients),
    ("coefficients", Column::Coefficients),
    ("comment", Column::Comment),
    ("remark", Column::Comment),
    ("note", Column::Comment),
    ("label", Column::Comment),
    ("surfaceno", Column::Number),
    ("si", Column::Number),
    ("sn", Column::Number),
    ("m", Column::Number),
    ("i", Column::Number),
    ("surfacenumber", Column::Number),
    ("surf#", Column::Number),
    ("sno", Column::Number),
    ("s", Column::Number),
    ("nr", Column::Number),
    ("flaeche", Column::Number),
    ("fläche", Column::Number),
    ("面番号", Column::Number),
    ("radiusofcurvaturer", Column::Radius),
    ("curvatureradius", Column::Radius),
    ("ri", Column::Radius),
    ("radien", Column::Radius),
    ("krümmungsradius", Column::Radius),
    ("曲率半径", Column::Radius),
    ("di", Column::Thickness),
    ("interval", Column::Thickness),
    ("axialdistance", Column::Thickness),
    ("axialthickness", Column::Thickness),
    ("surfaceseparation", Column::Thickness),
    ("surfaceinterval", Column::Thickness),
    ("thicknessordistance", Column::Thickness),
    ("thickness/distance", Column::Thickness),
    ("dicke", Column::Thickness),
    ("abstand", Column::Thickness),
    ("dicken", Column::Thickness),
    ("面間隔", Column::Thickness),
    ("間隔", Column::Thickness),
    ("ndi", Column::Index),
    ("ne", Column::Index),
    ("ve", Column::Abbe),
    ("brechzahl", Column::Index),
    ("brechungsindex", Column::Index),
    ("屈折率", Column::Index),
    ("vdi", Column::Abbe),
    ("abbeno", Column::Abbe),
    ("abbeconstant", Column::Abbe),
    ("abbevalue", Column::Abbe),
    ("abbezahl", Column::Abbe),
    ("アッベ数", Column::Abbe),
    ("glas", Column::Glass),
    ("硝材", Column::Glass),
    ("effectivediameter", Column::Diameter),
    ("effectivedia", Column::Diameter),
    ("cleardiameter", Column::Diameter),
    ("φ", Column::Diameter),
    ("ø", Column::Diameter),
    ("ea", Column::Diameter),
    ("durchmesser", Column::Diameter),
    ("有効径", Column::Diameter),
    ("effectiveradius", Column::SemiDiameter),
    ("semidia", Column::SemiDiameter),
    ("effectivesemidiameter", Column::SemiDiameter),
    ("remarks", Column::Comment),
    ("bemerkung", Column::Comment),
    ("備考", Column::Comment),
    ("θgf", Column::Unused),
    ("thetagf", Column::Unused),
    ("pgf", Column::Unused),
    ("gf", Column::Unused),
    ("vdpgf", Column::Unused),
    ("focallength", Column::Unused),
    ("焦点距離", Column::Unused),
];

/// Returns the column with this name, which a unit may follow; `None` if it is unknown.
pub(super) fn by_name(name: &str) -> Option<Column> {
    let (bare, _) = super::units::split(name);
    let plain: String = bare
        .chars()
        .filter(|c| !c.is_whitespace() && !matches!(c, '-' | '_' | '.'))
        .flat_map(char::to_lowercase)
        .collect();
    let plain = plain.trim_matches('"');
    let unitless = plain.strip_suffix("mm").filter(|rest| !rest.is_empty()).unwrap_or(plain);
    if let Some((_, column)) = NAMES.iter().find(|(known, _)| *known == unitless) {
        return Some(*column);
    }
    let power: u32 = unitless.strip_prefix('a')?.parse().ok()?;
    (power.is_multiple_of(2) && (2..=40).contains(&power)).then_some(Column::Coefficient(power))
}

/// Hint that lists names of columns.
pub(super) const HINT: &str = "known columns: lens, surface, type, radius, curvature, thickness, glass, nd, vd, semi-diameter, \
                               diameter, conic, a2, a4, ..., comment; a unit may follow in brackets: radius [in]";

/// Returns the power of a length in which the values of a column are measured.
pub(super) fn power(column: Column) -> Option<i32> {
    match column {
        Column::Radius | Column::Thickness | Column::SemiDiameter | Column::Diameter => Some(1),
        Column::Curvature => Some(-1),
        Column::Coefficient(power) => Some(1 - power as i32),
        // Use the power for r^2; each following coefficient has two powers less.
        Column::Coefficients => Some(-1),
        _ => None,
    }
}

/// Returns the unit of a column in mm. A length has its unit as it is, a power of it one like `1/in`, `in^-3` or `1/in^3`, or the bare unit
/// of the lens. `None` if it is not a unit, or has a power that the column does not have.
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
    (bare || stated == wanted && !list).then(|| super::units::length_mm(name)).flatten()
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
            assert_eq!(super::super::units::split(head), (name, unit), "{head}");
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

    #[test]
    fn many_spellings() {
        for (name, column) in [
            ("radius_mm", Column::Radius),
            ("R", Column::Radius),
            ("Radius [mm]", Column::Radius),
            ("Semi-Diameter", Column::SemiDiameter),
            ("semi_diameter_mm", Column::SemiDiameter),
            ("nd_after", Column::Index),
            ("Abbe Number", Column::Abbe),
            ("A4", Column::Coefficient(4)),
            ("a_10", Column::Coefficient(10)),
            ("asphere_coefficients", Column::Coefficients),
        ] {
            assert_eq!(by_name(name), Some(column), "{name}");
        }
        for name in ["", "mm", "a3", "a42", "colour"] {
            assert_eq!(by_name(name), None, "{name}");
        }
    }
}
