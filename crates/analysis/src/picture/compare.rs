//! Comparison of two pictures.

use super::measured::{Measured, NotMeasured, Unit};
use super::quantity_map::{QuantityMap, describe_white};
use serde::Serialize;
use spectra_color::{RgbSpace, ciede2000, lab};

/// Side of the blocks whose means are compared, pixels.
const BLOCK_PX: usize = 16;

/// Differences between two pictures in one quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Differs {
    /// Name of the channel, or `Y`.
    pub name: String,
    /// Unit; empty if there is none.
    pub unit: String,
    /// Means of the first and of the second picture.
    pub means: [f64; 2],
    /// Mean of second minus first, divided by the mean of both; `None` if that mean is 0.
    pub relative_mean: Option<f64>,
    /// Standard error of `relative_mean`, if the noise of the pixels is independent.
    pub relative_standard_error: Option<f64>,
    /// Root mean square of the differences divided by the mean of both.
    pub relative_rms: Option<f64>,
    /// Relative noise of a pixel in one picture: the standard deviation of the differences over the square root of 2, divided by the mean.
    /// This assumes that both pictures show one scene with the same noise.
    pub relative_noise: Option<f64>,
    /// Difference of the largest size, second minus first.
    pub largest: f64,
    /// Column and row of the largest difference.
    pub largest_at: [u32; 2],
    /// Share of the blocks of 16 x 16 pixels whose means differ by more than 3 standard errors. The standard error is estimated
    /// from the differences within each block. Noise alone gives a share of about 0.3 %. `None` if there is no whole block.
    pub blocks_beyond_3: Option<f64>,
    /// Number of pixels left out because the value of one picture is not finite.
    pub not_finite: usize,
}

/// Comparison of two pictures of the same size.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Differences of Y first, if both pictures have colors, then of each channel that both have.
    pub channels: Vec<Differs>,
    /// CIEDE2000 color difference of each pixel; `None` if a picture has no colors.
    pub delta_e: Option<Vec<f64>>,
    /// Description of the common white used for CIEDE2000.
    pub white: Option<String>,
}

impl Difference {
    /// Returns the mean, median, 95th percentile and maximum of CIEDE2000, and the column and row of the maximum. `width` is that
    /// of the pictures in pixels. `None` without colors.
    #[must_use]
    pub fn delta_e_figures(&self, width: u32) -> Option<([f64; 4], [u32; 2])> {
        let all = self.delta_e.as_ref()?;
        let mut finite: Vec<(f64, usize)> = all.iter().copied().zip(0..).filter(|(v, _)| v.is_finite()).collect();
        if finite.is_empty() {
            return None;
        }
        let mean = finite.iter().map(|(v, _)| v).sum::<f64>() / finite.len() as f64;
        // Of equal values take the first in the picture.
        finite.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let at = |quantile: f64| finite[((quantile * finite.len() as f64).ceil() as usize).clamp(1, finite.len()) - 1];
        let (most, pixel) = at(1.0);
        let place = [pixel as u32 % width, pixel as u32 / width];
        Some(([mean, at(0.5).0, at(0.95).0, most], place))
    }

    /// Returns CIEDE2000 of each pixel as a map that [`super::view()`] can draw; `None` without colors.
    #[must_use]
    pub fn field(&self) -> Option<QuantityMap> {
        let values = self.delta_e.clone()?;
        let name = "CIEDE2000".to_owned();
        Some(QuantityMap { name, unit: String::new(), values, is_hue: false, white: self.white.clone() })
    }
}

/// Compares two pictures of the same size pixel by pixel. Colors are seen relative to one D65 white for both, whose Y is `white`. If it is
/// `None`, [`Measured::white`] of the first picture is used, or else of the second. Colors of primaries with another white are adapted to
/// it.
///
/// # Errors
/// The pictures differ in size or unit, or have nothing in common.
pub fn compare(first: &Measured, second: &Measured, white: Option<f64>) -> Result<Difference, NotMeasured> {
    let size = |p: &Measured| [p.planes.width, p.planes.height];
    if size(first) != size(second) {
        let [[a, b], [c, d]] = [size(first), size(second)];
        let text = format!("the pictures have {a} x {b} and {c} x {d} pixels");
        return Err(NotMeasured::new(text, "render both at the same `resolution`"));
    }
    let both_colored = first.colors.is_some() && second.colors.is_some();
    if both_colored && first.unit != second.unit {
        let word = |unit: Unit| match unit {
            Unit::Lux => "in lx",
            Unit::LuxSeconds => "in lx s",
            Unit::OfWhite => "relative to white",
            Unit::Unknown => "of no stated unit",
        };
        let text = format!("the first picture is {}, the second {}", word(first.unit), word(second.unit));
        return Err(NotMeasured::new(text, "compare two pictures from the same kind of imager, or two finished ones"));
    }
    let pixels = first.planes.pixels();
    let mut channels = Vec::new();
    if both_colored {
        let y = |p: &Measured, pixel: usize| p.xyz_under_d65(pixel).map_or(f64::NAN, |xyz| xyz[1]);
        channels.push(differs("Y", first.unit.symbol(), first, &|i| [y(first, i), y(second, i)]));
    }
    for channel in &first.planes.channels {
        let is_y = both_colored && channel.name == "Y";
        let Some(other) = second.planes.channel(&channel.name).filter(|other| !is_y && other.unit == channel.unit)
        else {
            continue;
        };
        let values = |i: usize| [f64::from(channel.values[i]), f64::from(other.values[i])];
        channels.push(differs(&channel.name, &channel.unit, first, &values));
    }
    if channels.is_empty() {
        let text = "the pictures share neither colors nor a channel of the same name and unit";
        return Err(NotMeasured::new(text, "`spectra picture info` shows what each holds"));
    }
    let white = if both_colored { white.or_else(|| first.white()).or_else(|| second.white()) } else { None };
    let delta_e = white.map(|y| {
        let against = RgbSpace::srgb().white_xyz().map(|v| v * y);
        let of = |p: &Measured, pixel: usize| lab(p.xyz_under_d65(pixel).unwrap_or([f64::NAN; 3]), against);
        let differs = |i: usize| ciede2000(of(first, i), of(second, i));
        (0..pixels).map(differs).map(|v| if v.is_finite() { v } else { f64::NAN }).collect()
    });
    Ok(Difference { channels, delta_e, white: white.map(|y| describe_white(y, first.unit)) })
}

fn differs(name: &str, unit: &str, picture: &Measured, values: &dyn Fn(usize) -> [f64; 2]) -> Differs {
    let [width, height] = [picture.planes.width as usize, picture.planes.height as usize];
    let (mut sums, mut count, mut square, mut sum) = ([0.0; 2], 0_usize, 0.0, 0.0);
    let (mut largest, mut largest_at) = (0.0_f64, 0);
    let finite = |i: usize| Some(values(i)).filter(|v| v.iter().all(|v| v.is_finite()));
    for i in 0..width * height {
        let Some([a, b]) = finite(i) else { continue };
        count += 1;
        (sums[0], sums[1]) = (sums[0] + a, sums[1] + b);
        let d = b - a;
        (sum, square) = (sum + d, square + d * d);
        if d.abs() > largest.abs() {
            (largest, largest_at) = (d, i);
        }
    }
    let n = count.max(1) as f64;
    let means = sums.map(|v| v / n);
    let mean = 0.5 * (means[0] + means[1]);
    let over = |value: f64| (mean != 0.0 && value.is_finite()).then(|| value / mean.abs());
    let variance = (square / n - (sum / n) * (sum / n)).max(0.0) * n / (n - 1.0).max(1.0);
    let (mut beyond, mut blocks) = (0_usize, 0_usize);
    for top in (0..height / BLOCK_PX).map(|i| i * BLOCK_PX) {
        for left in (0..width / BLOCK_PX).map(|i| i * BLOCK_PX) {
            let pixels = (top..top + BLOCK_PX).flat_map(|row| (left..left + BLOCK_PX).map(move |c| row * width + c));
            let all: Vec<f64> = pixels.filter_map(finite).map(|[a, b]| b - a).collect();
            let n = all.len() as f64;
            let mean = all.iter().sum::<f64>() / n;
            let variance = all.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (n - 1.0);
            // Skip blocks that are dark in both pictures.
            if variance > 0.0 || mean != 0.0 {
                blocks += 1;
                beyond += usize::from(mean.abs() > 3.0 * (variance / n).sqrt());
            }
        }
    }
    Differs {
        name: name.to_owned(),
        unit: unit.to_owned(),
        means,
        relative_mean: over(means[1] - means[0]),
        relative_standard_error: over((variance / n).sqrt()),
        relative_rms: over((square / n).sqrt()),
        relative_noise: over((0.5 * variance).sqrt()),
        largest,
        largest_at: [(largest_at % width) as u32, (largest_at / width) as u32],
        blocks_beyond_3: (blocks > 0).then(|| beyond as f64 / blocks as f64),
        not_finite: width * height - count,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_color::matrix::apply;
    use spectra_pictures::read::{ChannelData, PictureChannels};
    use spectra_pictures::write::LinearSpace;

    /// Builds a picture with colors given in linear sRGB, written in another color space.
    fn picture(space: LinearSpace, chromaticities: [[f64; 2]; 4]) -> Measured {
        let colors = [[1.0, 1.0, 1.0], [0.18, 0.18, 0.18], [0.8, 0.05, 0.1], [0.02, 0.3, 0.6]];
        let matrix = space.from_srgb();
        let of = |at: usize| colors.iter().map(|rgb| apply(&matrix, *rgb)[at] as f32).collect();
        let plane =
            |(at, name): (usize, &str)| ChannelData { name: name.to_owned(), unit: String::new(), values: of(at) };
        Measured::of(PictureChannels {
            format: "OpenEXR",
            width: 2,
            height: 2,
            pixel_aspect: 1.0,
            channels: ["R", "G", "B"].into_iter().enumerate().map(plane).collect(),
            chromaticities: Some(chromaticities),
            attributes: Vec::new(),
            clipped_at: None,
            warnings: Vec::new(),
        })
        .expect("colors")
    }

    /// One picture in five spaces: no color differs, even if the white of the primaries is that of ACES, or the values are XYZ.
    #[test]
    fn one_picture_in_several_spaces_does_not_differ() {
        let of = |space: &RgbSpace| {
            let [r, g, b] = space.primaries_xy;
            [r, g, b, space.white_xy]
        };
        let srgb = picture(LinearSpace::Srgb, of(RgbSpace::srgb()));
        for (space, xy) in [
            (LinearSpace::AcesCg, of(RgbSpace::aces_cg())),
            (LinearSpace::Rec2020, of(RgbSpace::rec2020())),
            (LinearSpace::P3D65, of(RgbSpace::display_p3())),
            (LinearSpace::Xyz, [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]]),
        ] {
            let difference = compare(&srgb, &picture(space, xy), Some(1.0)).expect("of one size");
            let largest = difference.delta_e.expect("colors").into_iter().fold(0.0, f64::max);
            assert!(largest < 1e-3, "{space:?}: {largest}");
        }
    }
}
