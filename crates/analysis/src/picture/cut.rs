//! Quantities along a line through a picture.

use super::measured::{Measured, NotMeasured};
use super::quantity_map::QuantityMap;
use std::fmt::Write;

/// The line of a cut through a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutLine {
    /// Along a row, counted from 0 at the top.
    Row(u32),
    /// Along a column, counted from 0 at the left.
    Column(u32),
    /// Along a straight line from one point to another, given as columns and rows; the center of the first pixel is at 0.5, 0.5.
    Line {
        /// Start of the line.
        from: [f64; 2],
        /// End of the line.
        to: [f64; 2],
    },
}

/// Values of quantities at points along a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// Name and unit of each quantity.
    pub labels: Vec<String>,
    /// Position of each point: column and row, in pixels.
    pub places_px: Vec<[f64; 2]>,
    /// Distance of each point from the start, in pixels.
    pub distance_px: Vec<f64>,
    /// Distance of each point from the start on the film, mm; `None` if the size of the film is not known.
    pub distance_mm: Option<Vec<f64>>,
    /// Values of each quantity at each point; NaN where it is undefined.
    pub values: Vec<Vec<f64>>,
}

impl Cut {
    /// Samples the quantities `fields` along the line `way` through `picture`. A row or column has one point per pixel. A
    /// straight line has about one point per pixel of its length, interpolated between the four nearest pixels; a hue takes the
    /// value of the nearest.
    ///
    /// # Errors
    /// The line leaves the picture, or has no length.
    pub fn of(picture: &Measured, fields: &[QuantityMap], way: CutLine) -> Result<Self, NotMeasured> {
        let [width, height] = [picture.planes.width, picture.planes.height];
        let outside = |what: String| {
            let hint = format!("columns are 0 to {}, rows 0 to {}", width - 1, height - 1);
            NotMeasured::new(format!("{what} is not in the picture, which has {width} x {height} pixels"), hint)
        };
        let places_px: Vec<[f64; 2]> = match way {
            CutLine::Row(row) if row >= height => return Err(outside(format!("row {row}"))),
            CutLine::Row(row) => (0..width).map(|column| [f64::from(column) + 0.5, f64::from(row) + 0.5]).collect(),
            CutLine::Column(column) if column >= width => return Err(outside(format!("column {column}"))),
            CutLine::Column(column) => (0..height).map(|row| [f64::from(column) + 0.5, f64::from(row) + 0.5]).collect(),
            CutLine::Line { from, to } => {
                let size = [f64::from(width), f64::from(height)];
                for place in [from, to] {
                    if !(0..2).all(|i| (0.0..=size[i]).contains(&place[i])) {
                        return Err(outside(format!("the point {}, {}", place[0], place[1])));
                    }
                }
                let length = libm::hypot(to[0] - from[0], to[1] - from[1]);
                if length <= 0.0 {
                    let hint = "write two different points: COLUMN,ROW,COLUMN,ROW";
                    return Err(NotMeasured::new("the line starts and ends at the same point", hint));
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
            labels: fields.iter().map(QuantityMap::label).collect(),
            distance_px: distance([1.0, 1.0]),
            distance_mm: pixel_mm.map(distance),
            values: fields.iter().map(|f| places_px.iter().map(|p| at(picture, f, *p)).collect()).collect(),
            places_px,
        })
    }

    /// Returns the cut as CSV: `column,row,distance_px`, `distance_mm` if it is known, and the quantities. Columns and rows count from the
    /// corner of the picture, so that the center of the first pixel is at 0.5. Undefined values are empty.
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

/// Quotes a field of a CSV file if it needs quotes.
fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// Interpolates a field between the centers of pixels; at a center it returns exactly the value of the pixel.
fn at(picture: &Measured, field: &QuantityMap, [column, row]: [f64; 2]) -> f64 {
    let [width, height] = [picture.planes.width as usize, picture.planes.height as usize];
    let split = |at: f64, count: usize| {
        let at = (at - 0.5).clamp(0.0, count as f64 - 1.0);
        (at as usize, at - at.floor())
    };
    let ((x, right), (y, below)) = (split(column, width), split(row, height));
    let value = |x: usize, y: usize| field.values[y.min(height - 1) * width + x.min(width - 1)];
    // Take the nearest pixel for an angle, which has no mean.
    if field.is_hue {
        return value(if right < 0.5 { x } else { x + 1 }, if below < 0.5 { y } else { y + 1 });
    }
    let mix = |a: f64, b: f64, share: f64| if share == 0.0 { a } else { a + share * (b - a) };
    let across = |y: usize| mix(value(x, y), if right == 0.0 { 0.0 } else { value(x + 1, y) }, right);
    mix(across(y), if below == 0.0 { 0.0 } else { across(y + 1) }, below)
}
