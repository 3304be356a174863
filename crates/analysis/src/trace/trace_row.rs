//! Rows of the result of a trace.

use spectra_core::Loss;
use std::fmt::Write;

/// Format of the result of a trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values with a first row of names.
    #[default]
    Csv,
    /// One JSON object per line, with the same names. Fields that are empty in CSV are `null`.
    JsonLines,
}

/// Names of the columns. The first one, `ray`, is written only if every surface gets a row.
const COLUMNS: [&str; 12] = [
    "ray",
    "status",
    "surface",
    "x_mm",
    "y_mm",
    "z_mm",
    "l",
    "m",
    "n",
    "wavelength_nm",
    "transmittance",
    "optical_path_mm",
];

impl Format {
    pub(super) fn header(self, numbered: bool) -> String {
        match self {
            Self::Csv => COLUMNS[usize::from(!numbered)..].join(",") + "\n",
            Self::JsonLines => String::new(),
        }
    }
}

/// State of a ray at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RayState {
    pub point_mm: [f64; 3],
    pub direction: [f64; 3],
    /// Part of the light that is left, 0 to 1.
    pub transmittance: f64,
    /// Optical path, mm: index times length from the start of the ray.
    pub optical_path_mm: f64,
}

/// What became of a ray at a surface or at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fate {
    /// The ray passed a surface, counted from 1, and continued.
    Passed { surface: u32, light: RayState },
    /// The ray met the image plane.
    Hit(RayState),
    /// The ray ended at a surface.
    Lost { cause: Loss, surface: u32 },
}

/// One row of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TraceRow {
    /// Number of the ray in the table, from 1; `None` if it is not written.
    pub ray: Option<u64>,
    pub wavelength_nm: f64,
    pub fate: Fate,
}

impl TraceRow {
    /// Appends the row to `out`. Numbers have as many digits, up to 17, as needed to read back the same f64.
    pub(super) fn write(&self, format: Format, out: &mut String) {
        let number = |v: f64| Some(format!("{v:?}"));
        let (status, surface, light) = match self.fate {
            Fate::Passed { surface, light } => ("passed", Some(surface), Some(light)),
            Fate::Hit(light) => ("hit", None, Some(light)),
            Fate::Lost { cause, surface } => (cause.name(), Some(surface), None),
        };
        let at = |pick: fn(&RayState) -> f64| light.as_ref().map(pick).and_then(number);
        let fields: [Option<String>; 12] = [
            self.ray.map(|ray| ray.to_string()),
            Some(match format {
                Format::Csv => status.to_owned(),
                Format::JsonLines => format!("\"{status}\""),
            }),
            surface.map(|surface| surface.to_string()),
            at(|l| l.point_mm[0]),
            at(|l| l.point_mm[1]),
            at(|l| l.point_mm[2]),
            at(|l| l.direction[0]),
            at(|l| l.direction[1]),
            at(|l| l.direction[2]),
            number(self.wavelength_nm),
            at(|l| l.transmittance),
            at(|l| l.optical_path_mm),
        ];
        let first = usize::from(self.ray.is_none());
        for (i, (name, field)) in COLUMNS.iter().zip(&fields).enumerate().skip(first) {
            // Writing to a String cannot fail.
            let _ = match format {
                Format::Csv => {
                    write!(out, "{}{}", if i > first { "," } else { "" }, field.as_deref().unwrap_or_default())
                }
                Format::JsonLines => {
                    let before = if i > first { "," } else { "{" };
                    write!(out, "{before}\"{name}\":{}", field.as_deref().unwrap_or("null"))
                }
            };
        }
        out.push_str(if format == Format::JsonLines { "}\n" } else { "\n" });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_bit() {
        let values = [0.1 + 0.2, -1.0 / 3.0, 5e-324, -0.0, 1.7976931348623157e308, 123456789.0, 587.5618, 0.97, 81.25];
        let light = RayState {
            point_mm: [values[0], values[1], values[2]],
            direction: [values[3], values[4], values[5]],
            transmittance: values[7],
            optical_path_mm: values[8],
        };
        let row = TraceRow { ray: None, wavelength_nm: values[6], fate: Fate::Hit(light) };
        let mut text = String::new();
        row.write(Format::Csv, &mut text);
        let read: Vec<u64> =
            text.trim_end().split(',').skip(2).map(|f| f.parse::<f64>().expect("a number").to_bits()).collect();
        assert_eq!(read, values.map(f64::to_bits));
    }

    #[test]
    fn a_lost_ray_has_a_cause_a_surface_and_its_wavelength() {
        let row =
            TraceRow { ray: None, wavelength_nm: 546.1, fate: Fate::Lost { cause: Loss::TotalReflection, surface: 4 } };
        let mut text = String::new();
        row.write(Format::Csv, &mut text);
        assert_eq!(text, "tir,4,,,,,,,546.1,,\n");
        assert_eq!(text.matches(',').count(), Format::Csv.header(false).matches(',').count());
        let numbered = TraceRow { ray: Some(7), ..row };
        text.clear();
        numbered.write(Format::JsonLines, &mut text);
        assert!(text.starts_with(r#"{"ray":7,"status":"tir","surface":4,"x_mm":null,"#), "{text}");
    }
}
