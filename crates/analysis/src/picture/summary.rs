//! Summary of a picture in figures.

use super::measured::Measured;
use serde::Serialize;
use spectra_color::RgbSpace;

/// Statistics of one channel of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelFigures {
    /// Name of the channel.
    pub name: String,
    /// Unit; empty if the file states none.
    pub unit: String,
    /// Smallest finite value; `None` if no value is finite.
    pub minimum: Option<f64>,
    /// Mean of the finite values.
    pub mean: Option<f64>,
    /// Largest finite value.
    pub maximum: Option<f64>,
    /// Number of pixels whose value is infinite or NaN.
    pub not_finite: usize,
}

/// Illuminance on the frame, lx.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Illuminance {
    /// Smallest illuminance, lx.
    pub minimum: f64,
    /// Mean illuminance, lx.
    pub mean: f64,
    /// Largest illuminance, lx.
    pub maximum: f64,
}

/// Part of a picture that a color space cannot show.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OutOfGamut {
    /// Name of the color space.
    pub space: &'static str,
    /// Share of the lit pixels whose color has a negative component in this space, 0 to 1.
    pub share: f64,
}

/// Statistics of a picture. Quantities that its file does not define are `None`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// All channels in the order of the file.
    pub channels: Vec<ChannelFigures>,
    /// Illuminance, lx.
    pub illuminance_lx: Option<Illuminance>,
    /// Luminous flux on the frame, lm.
    pub luminous_flux_lm: Option<f64>,
    /// Radiant power on the frame within the bands, W.
    pub radiant_power_w: Option<f64>,
    /// First and last wavelength of the bands, nm.
    pub band_nm: Option<[f64; 2]>,
    /// Mean XYZ (CIE 1931) in the picture's unit.
    pub mean_xyz: Option<[f64; 3]>,
    /// Chromaticity x, y of the mean XYZ.
    pub mean_xy: Option<[f64; 2]>,
    /// Share of the pixels that receive light, 0 to 1.
    pub lit_share: Option<f64>,
    /// Shares of colors outside sRGB, Display P3 and Rec. 2020.
    pub out_of_gamut: Vec<OutOfGamut>,
    /// Share of the clipped pixels, 0 to 1: at the end of an integer scale, or above white. `None` if neither is known.
    pub clipped_share: Option<f64>,
}

/// Negative components smaller than this, relative to the largest, are rounding errors of single precision.
const ROUNDING: f64 = 1e-6;

impl Summary {
    /// Computes the summary of a picture.
    #[must_use]
    pub fn of(picture: &Measured) -> Self {
        let planes = &picture.planes;
        let pixels = planes.pixels();
        let channels = planes.channels.iter().map(|c| figures(&c.name, &c.unit, &c.values)).collect();
        let spaces = [RgbSpace::srgb(), RgbSpace::display_p3(), RgbSpace::rec2020()];
        let (mut sum, mut counted, mut lit, mut outside) = ([0.0; 3], 0_usize, 0_usize, [0_usize; 3]);
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for pixel in 0..pixels {
            let Some(xyz) = picture.xyz(pixel).filter(|xyz| xyz.iter().all(|v| v.is_finite())) else { continue };
            counted += 1;
            sum.iter_mut().zip(xyz).for_each(|(sum, v)| *sum += v);
            (lowest, highest) = (lowest.min(xyz[1]), highest.max(xyz[1]));
            if xyz[1] > 0.0 {
                lit += 1;
                for (space, outside) in spaces.iter().zip(&mut outside) {
                    *outside += usize::from(is_outside(space, xyz));
                }
            }
        }
        let mean_xyz = (counted > 0).then(|| sum.map(|v| v / counted as f64));
        let lux = picture.lux_per_y();
        let illuminance = mean_xyz.zip(lux).map(|(mean, lux)| Illuminance {
            minimum: lowest * lux,
            mean: mean[1] * lux,
            maximum: highest * lux,
        });
        let area = picture.pixel_area_m2();
        let irradiances = (0..pixels).filter_map(|p| picture.irradiance_w_m2(p)).filter(|v| v.is_finite());
        let power = picture.bands().map(|_| irradiances.sum::<f64>());
        let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
        let spaces = spaces.iter().zip(outside).filter(|_| lit > 0);
        Self {
            channels,
            illuminance_lx: illuminance,
            luminous_flux_lm: area.zip(lux).filter(|_| counted > 0).map(|(area, lux)| sum[1] * lux * area),
            radiant_power_w: area.zip(power).map(|(area, power)| area * power),
            band_nm: picture.bands().and_then(|b| Some([b.first()?.edges_nm[0], b.last()?.edges_nm[1]])),
            mean_xy: mean_xyz.and_then(spectra_color::chromaticity),
            mean_xyz,
            lit_share: mean_xyz.map(|_| share(lit, pixels)),
            out_of_gamut: spaces.map(|(s, n)| OutOfGamut { space: s.name, share: share(n, lit) }).collect(),
            clipped_share: picture
                .clips_at()
                .map(|_| share((0..pixels).filter(|pixel| picture.is_clipped(*pixel)).count(), pixels)),
        }
    }
}

/// Whether a color has a negative component in a color space.
pub(super) fn is_outside(space: &RgbSpace, xyz: [f64; 3]) -> bool {
    let rgb = space.from_xyz(xyz);
    let largest = rgb.iter().fold(0.0_f64, |a, v| a.max(*v));
    rgb.iter().any(|v| *v < -ROUNDING * largest)
}

fn figures(name: &str, unit: &str, values: &[f32]) -> ChannelFigures {
    let (mut lowest, mut highest, mut sum, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0_usize);
    for value in values.iter().map(|v| f64::from(*v)).filter(|v| v.is_finite()) {
        (lowest, highest) = (lowest.min(value), highest.max(value));
        sum += value;
        count += 1;
    }
    let any = |value: f64| (count > 0).then_some(value);
    ChannelFigures {
        name: name.to_owned(),
        unit: unit.to_owned(),
        minimum: any(lowest),
        mean: any(sum / count.max(1) as f64),
        maximum: any(highest),
        not_finite: values.len() - count,
    }
}
