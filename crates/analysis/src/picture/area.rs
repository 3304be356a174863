//! The mean color and spectrum of a rectangle of a picture.

use super::measured::{Measured, NotMeasured};
use std::fmt::Write;

/// A rectangle of pixels in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rectangle {
    /// First column and row, from 0 at the upper left.
    pub from: [u32; 2],
    /// Number of columns and rows.
    pub size: [u32; 2],
}

/// Mean values of a picture over a rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// The rectangle averaged over.
    pub rectangle: Rectangle,
    /// Mean XYZ (CIE 1931) in the picture's unit; `None` for a picture without colors.
    pub xyz: Option<[f64; 3]>,
    /// Mean irradiance of each band, W m^-2 nm^-1, between `edges_nm`; empty if no bands were recorded.
    pub bands: Vec<f64>,
    /// Edges of the bands, nm: one more than there are bands.
    pub edges_nm: Vec<f64>,
}

impl Area {
    /// Averages over `rectangle`, or over the whole picture if it is `None`.
    ///
    /// # Errors
    /// The rectangle is empty, leaves the picture, or contains values that are not finite.
    pub fn of(picture: &Measured, rectangle: Option<Rectangle>) -> Result<Self, NotMeasured> {
        let size = [picture.planes.width, picture.planes.height];
        let rectangle = rectangle.unwrap_or(Rectangle { from: [0, 0], size });
        let fits = |i: usize| u64::from(rectangle.from[i]) + u64::from(rectangle.size[i]) <= u64::from(size[i]);
        if rectangle.size.contains(&0) || !fits(0) || !fits(1) {
            let Rectangle { from: [x, y], size: [width, height] } = rectangle;
            let text = format!("the area {x},{y},{width},{height} is not within {} x {} pixels", size[0], size[1]);
            return Err(NotMeasured::new(text, "write COLUMN,ROW,WIDTH,HEIGHT in pixels from the upper left"));
        }
        let [left, top] = rectangle.from.map(|v| v as usize);
        let [columns, rows] = rectangle.size.map(|v| v as usize);
        let pixels = || {
            (top..top + rows)
                .flat_map(move |row| (left..left + columns).map(move |column| row * size[0] as usize + column))
        };
        let count = (columns * rows) as f64;
        let mut xyz = picture.colors.as_ref().map(|_| [0.0; 3]);
        if let Some(sum) = &mut xyz {
            for pixel in pixels() {
                let value = picture.xyz(pixel).unwrap_or_default();
                sum.iter_mut().zip(value).for_each(|(sum, v)| *sum += v / count);
            }
        }
        let bands = picture.bands().unwrap_or_default();
        let mean = |channel: usize| {
            let values = &picture.planes.channels[channel].values;
            pixels().map(|pixel| f64::from(values[pixel])).sum::<f64>() / count
        };
        let means: Vec<f64> = bands.iter().map(|band| mean(band.channel)).collect();
        if xyz.iter().flatten().chain(&means).any(|v| !v.is_finite()) {
            return Err(NotMeasured::new("the area contains values that are not finite", "choose another area"));
        }
        let ends = bands.last().map(|band| band.edges_nm[1]);
        let edges_nm = bands.iter().map(|band| band.edges_nm[0]).chain(ends).collect();
        Ok(Self { rectangle, xyz, bands: means, edges_nm })
    }

    /// Returns the text of a spectrum file of the area, `kind: histogram`, whose counts are W m^-2 in each band. The spectrum is
    /// a light, which can be used as any `spectrum`, `illuminant` or filter factor. Negative values, which noise may cause, are
    /// replaced by 0. `said` describes where the area was measured and becomes the name of the spectrum.
    ///
    /// # Errors
    /// The picture has no bands, or no light falls on the area.
    pub fn histogram(&self, said: &str) -> Result<String, NotMeasured> {
        if self.bands.is_empty() {
            let text = "the picture has no bands, so its spectrum is not known";
            return Err(NotMeasured::new(text, "`imager: {kind: spectral, bands: 40}` records it"));
        }
        let widths = self.edges_nm.windows(2).map(|pair| pair[1] - pair[0]);
        let contents: Vec<f64> = self.bands.iter().zip(widths).map(|(mean, width)| (mean * width).max(0.0)).collect();
        if contents.iter().all(|v| *v == 0.0) {
            return Err(NotMeasured::new("no light falls on the area", "choose another area"));
        }
        let list = |values: &mut dyn Iterator<Item = String>| values.collect::<Vec<_>>().join(", ");
        let mut out = String::from("# Mean irradiance of an area, W/m2 in each band.\nspectra: 1\n");
        // Writing to a String cannot fail.
        let _ = writeln!(out, "name: {}\nof: emission\nkind: histogram", in_quotes(said));
        // Round edges to a millionth of a nanometer: sums of thirds would be long.
        let edge = |nm: &f64| ((1e6 * nm).round_ties_even() / 1e6).to_string();
        let _ = writeln!(out, "edges: [{}]", list(&mut self.edges_nm.iter().map(edge)));
        let _ = writeln!(out, "counts: [{}]", list(&mut contents.iter().map(f64::to_string)));
        Ok(out)
    }
}

/// Writes a text in double quotes for YAML.
fn in_quotes(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("\"{}\"", plain.replace('\\', "\\\\").replace('"', "\\\""))
}
