//! One row of the result.

use spectra_core::Loss;
use std::fmt::Write;

/// How the result is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values with a first row of names.
    #[default]
    Csv,
    /// One JSON object a line, with the same names; what is empty there is `null` here.
    JsonLines,
}

impl Format {
    pub(super) fn header(self) -> &'static str {
        match self {
            Self::Csv => "status,surface,x_mm,y_mm,z_mm,l,m,n\n",
            Self::JsonLines => "",
        }
    }
}

/// What became of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Row {
    Hit { point_mm: [f64; 3], direction: [f64; 3] },
    Lost { cause: Loss, surface: u32 },
}

impl Row {
    /// Appends the row. Numbers have as many digits, up to 17, as it takes to read back the same f64.
    pub(super) fn write(&self, format: Format, out: &mut String) {
        // Writing to a String cannot fail.
        let _ = match (format, self) {
            (Format::Csv, Self::Hit { point_mm: [x, y, z], direction: [l, m, n] }) => {
                writeln!(out, "hit,,{x:?},{y:?},{z:?},{l:?},{m:?},{n:?}")
            }
            (Format::Csv, Self::Lost { cause, surface }) => writeln!(out, "{},{surface},,,,,,", cause.name()),
            (Format::JsonLines, Self::Hit { point_mm: [x, y, z], direction: [l, m, n] }) => writeln!(
                out,
                r#"{{"status":"hit","surface":null,"x_mm":{x:?},"y_mm":{y:?},"z_mm":{z:?},"l":{l:?},"m":{m:?},"n":{n:?}}}"#
            ),
            (Format::JsonLines, Self::Lost { cause, surface }) => writeln!(
                out,
                r#"{{"status":"{}","surface":{surface},"x_mm":null,"y_mm":null,"z_mm":null,"l":null,"m":null,"n":null}}"#,
                cause.name()
            ),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_bit() {
        let values = [0.1 + 0.2, -1.0 / 3.0, 5e-324, -0.0, 1.7976931348623157e308, 123456789.0];
        let row =
            Row::Hit { point_mm: [values[0], values[1], values[2]], direction: [values[3], values[4], values[5]] };
        let mut text = String::new();
        row.write(Format::Csv, &mut text);
        let read: Vec<u64> =
            text.trim_end().split(',').skip(2).map(|f| f.parse::<f64>().expect("a number").to_bits()).collect();
        assert_eq!(read, values.map(f64::to_bits));
    }

    #[test]
    fn a_lost_ray_has_a_cause_a_surface_and_nothing_else() {
        let mut text = String::new();
        Row::Lost { cause: Loss::TotalReflection, surface: 4 }.write(Format::Csv, &mut text);
        assert_eq!(text, "tir,4,,,,,,\n");
        assert_eq!(text.matches(',').count(), Format::Csv.header().matches(',').count());
    }
}
