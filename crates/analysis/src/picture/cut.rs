//! Quantities along a line through a picture.

use super::field::Field;
use super::measured::{Measured, NotMeasured};
use std::fmt::Write;

/// Where a cut goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// Along a row, counted from 0 at the top.
    Row(u32),
    /// Along a column, counted from 0 at the left.
    Column(u32),
    /// From one place to another, in columns and rows; the middle of the first pixel is at 0.5, 0.5.
    Line {
        /// Where it begins.
        from: [f64; 2],
        /// Where it ends.
        to: [f64; 2],
    },
}

/// Quantities along a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Name and unit of each quantity.
    pub labels: Vec<String>,
    /// Where each point lies: column and row, in pixels.
    pub places_px: Vec<[f64; 2]>,
    /// Distance of each point from the beginning, in pixels.
    pub distance_px: Vec<f64>,
    /// The same on the film, mm, where the size of the film is known.
    pub distance_mm: Option<Vec<f64>>,
    /// For each quantity its value at each point; NaN where it is undefined.
    pub values: Vec<Vec<f64>>,
}

impl Cut {
    /// Quantities along `way`. Along a row or a column each point is a pixel; a line has a point a pixel of its length, each with
    /// the values of its four neighbors in between.
    ///
    /// # Errors
    /// The way leaves the picture, or has no length.
    pub fn of(picture: &Measured, fields: &[Field], way: Way) -> Result<Self, NotMeasured> {
        let [width, height] = [picture.planes.width, picture.planes.height];
        let outside = |what: String| {
            let hint = format!("columns are 0 to {}, rows 0 to {}", width - 1, height - 1);
            NotMeasured::new(format!("{what} is not in the picture, which has {width} x {height} pixels"), hint)
        };
        let places_px: Vec<[f64; 2]> = match way {
            Way::Row(row) if row >= height => return Err(outside(format!("row {row}"))),
            Way::Row(row) => (0..width).map(|column| [f64::from(column) + 0.5, f64::from(row) + 0.5]).collect(),
            Way::Column(column) if column >= width => return Err(outside(format!("column {column}"))),
            Way::Column(column) => (0..height).map(|row| [f64::from(column) + 0.5, f64::from(row) + 0.5]).collect(),
            Way::Line { from, to } => {
                let size = [f64::from(width), f64::from(height)];
                for place in [from, to] {
                    if !(0..2).all(|i| (0.0..=size[i]).contains(&place[i])) {
                        return Err(outside(format!("the place {}, {}", place[0], place[1])));
                    }
                }
                let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
                if length <= 0.0 {
                    let hint = "two places: COLUMN,ROW,COLUMN,ROW";
                    return Err(NotMeasured::new("a line from a place to itself has no length", hint));
                }
                let steps = length.ceil();
                let at = |i: usize| [0, 1].map(|k| from[k] + (to[k] - from[k]) * i as f64 / steps);
                (0..=steps as usize).map(at).collect()
            }
        };
        let start = places_px[0];
        let distance = |unit: [f64; 2]| {
            let far = |p: &[f64; 2]| libm::hypot((p[0] - start[0]) * unit[0], (p[1] - start[1]) * unit[1]);
            places_px.iter().map(far).collect::<Vec<f64>>()
        };
        let pixel_mm = picture.size_mm.map(|mm| [mm[0] / f64::from(width), mm[1] / f64::from(height)]);
        Ok(Self {
            labels: fields.iter().map(Field::label).collect(),
            distance_px: distance([1.0, 1.0]),
            distance_mm: pixel_mm.map(distance),
            values: fields.iter().map(|f| places_px.iter().map(|p| at(picture, f, *p)).collect()).collect(),
            places_px,
        })
    }

    /// As a table: `column,row,distance_px`, `distance_mm` where it is known, and the quantities. Columns and rows are those of the middle
    /// of a pixel: 0.5 is that of the first.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut out = String::from("column,row,distance_px");
        if self.distance_mm.is_some() {
            out.push_str(",distance_mm");
        }
        for label in &self.labels {
            // Writing to a String cannot fail.
            let _ = write!(out, ",{}", quoted(&label.replace("^{2}", "2")));
        }
        out.push('\n');
        for (i, [column, row]) in self.places_px.iter().enumerate() {
            let _ = write!(out, "{column},{row},{}", self.distance_px[i]);
            if let Some(mm) = &self.distance_mm {
                let _ = write!(out, ",{}", mm[i]);
            }
            for values in &self.values {
                let value = values[i];
                let _ = if value.is_nan() { write!(out, ",") } else { write!(out, ",{value}") };
            }
            out.push('\n');
        }
        out
    }
}

/// A field of a CSV file.
fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// A field between the middles of pixels; at those exactly theirs.
fn at(picture: &Measured, field: &Field, [column, row]: [f64; 2]) -> f64 {
    let [width, height] = [picture.planes.width as usize, picture.planes.height as usize];
    let split = |at: f64, count: usize| {
        let at = (at - 0.5).clamp(0.0, count as f64 - 1.0);
        (at as usize, at - at.floor())
    };
    let ((x, right), (y, below)) = (split(column, width), split(row, height));
    let value = |x: usize, y: usize| field.values[y.min(height - 1) * width + x.min(width - 1)];
    // An angle has no mean: the nearest.
    if field.is_hue {
        return value(if right < 0.5 { x } else { x + 1 }, if below < 0.5 { y } else { y + 1 });
    }
    let mix = |a: f64, b: f64, share: f64| if share == 0.0 { a } else { a + share * (b - a) };
    let across = |y: usize| mix(value(x, y), if right == 0.0 { 0.0 } else { value(x + 1, y) }, right);
    mix(across(y), if below == 0.0 { 0.0 } else { across(y + 1) }, below)
}
