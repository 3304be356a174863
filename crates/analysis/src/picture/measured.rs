//! A picture file with the physical meaning of its channels.

use super::bands::{Band, edges_nm, middle_nm, xyz_of_band};
use spectra_color::matrix::{Matrix, apply};
use spectra_color::{Adaptation, RgbSpace, Transfer, xyz_of_xy};
use spectra_pictures::read::{FileProblem, PictureChannels};

/// The unit of a picture's XYZ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Y is illuminance on the imager, lx.
    Lux,
    /// Y is exposure, lx s.
    LuxSeconds,
    /// Y is relative to white, whose Y is 1.
    OfWhite,
    /// Y is on a scale that the file does not state.
    Unknown,
}

impl Unit {
    /// Symbol of the unit as written behind a number; empty if there is none.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Lux => "lx",
            Self::LuxSeconds => "lx s",
            Self::OfWhite | Self::Unknown => "",
        }
    }
}

/// The channels from which the XYZ (CIE 1931) of a pixel are computed.
#[derive(Clone, Debug)]
pub enum Colors {
    /// X, Y and Z are channels; these are their indices.
    Xyz([usize; 3]),
    /// Linear red, green and blue of a color space: the indices of the channels, and the space.
    Rgb([usize; 3], Box<RgbSpace>),
    /// Bands of a spectrum.
    Bands(Vec<Band>),
}

/// A picture whose light can be measured: its channels and what they mean.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Channels as the file stores them.
    pub planes: PictureChannels,
    /// Source of the colors; `None` if the channels define none, such as those of a film's layers.
    pub colors: Option<Colors>,
    /// The unit of XYZ.
    pub unit: Unit,
    /// Width and height on the film, mm; `None` if the file does not state them.
    pub size_mm: Option<[f64; 2]>,
    /// Exposure time, s; `None` if the file does not state it.
    pub exposure_time_s: Option<f64>,
    /// Matrix from XYZ to XYZ under a D65 white; `None` if the primaries have this white already.
    to_d65: Option<Matrix>,
}

/// A measurement that a picture does not allow, and what to do instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{text}")]
pub struct NotMeasured {
    /// Description of what is missing.
    pub text: String,
    /// Hint that says what to write.
    pub hint: String,
}

impl NotMeasured {
    pub(super) fn new(text: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { text: text.into(), hint: hint.into() }
    }
}

impl Measured {
    /// Finds out what the channels of a picture mean, from their names, their units and the header.
    ///
    /// # Errors
    /// Two channels hold the same band of a spectrum.
    pub fn of(planes: PictureChannels) -> Result<Self, FileProblem> {
        let number = |name: &str| planes.channels.iter().position(|c| c.name == name);
        let all = |names: [&str; 3]| Some([number(names[0])?, number(names[1])?, number(names[2])?]);
        let bands = bands(&planes)?;
        let is_data = planes.attribute("spectra:image state") == Some("data");
        let is_ours = planes.attribute("spectra:version").is_some();
        let (colors, unit) = if let Some(bands) = bands {
            (Some(Colors::Bands(bands)), Unit::Lux)
        } else if let Some(at) = all(["X", "Y", "Z"]) {
            let unit = match planes.channels[at[1]].unit.as_str() {
                "lx" => Unit::Lux,
                "lx s" => Unit::LuxSeconds,
                _ => Unit::Unknown,
            };
            (Some(Colors::Xyz(at)), unit)
        } else if let Some(at) = all(["R", "G", "B"]).filter(|_| !is_data && planes.holds_xyz()) {
            (Some(Colors::Xyz(at)), if is_ours { Unit::OfWhite } else { Unit::Unknown })
        } else if let Some(at) = all(["R", "G", "B"]).filter(|_| !is_data) {
            let space = planes.chromaticities.map_or_else(
                || RgbSpace::srgb().clone(),
                |[r, g, b, white]| RgbSpace::new("of the file", [r, g, b], white, Transfer::Linear),
            );
            let shows_white = is_ours || planes.clipped_at.is_some();
            (Some(Colors::Rgb(at, Box::new(space))), if shows_white { Unit::OfWhite } else { Unit::Unknown })
        } else {
            (None, Unit::Unknown)
        };
        let size_mm = planes.attribute("spectra:film size").and_then(size_mm);
        let exposure_time_s = planes.attribute("spectra:exposure time").and_then(|text| {
            let time: f64 = text.strip_suffix(" s")?.parse().ok()?;
            (time.is_finite() && time > 0.0).then_some(time)
        });
        let white = if let Some(Colors::Rgb(_, space)) = &colors { Some(space.white_xy) } else { None };
        let d65 = RgbSpace::srgb();
        let is_other = |xy: &[f64; 2]| xy.iter().zip(d65.white_xy).any(|(a, b)| (a - b).abs() > 1e-4);
        let to_d65 = white.filter(is_other).map(|xy| Adaptation::Cat02.matrix(xyz_of_xy(xy, 1.0), d65.white_xyz()));
        Ok(Self { planes, colors, unit, size_mm, exposure_time_s, to_d65 })
    }

    /// XYZ (CIE 1931) of a pixel in the picture's unit; `None` if the picture has no colors.
    #[must_use]
    pub fn xyz(&self, pixel: usize) -> Option<[f64; 3]> {
        let value = |channel: usize| f64::from(self.planes.channels[channel].values[pixel]);
        Some(match self.colors.as_ref()? {
            Colors::Xyz(at) => at.map(value),
            Colors::Rgb(at, space) => space.to_xyz(at.map(value)),
            Colors::Bands(bands) => {
                let mut sum = [0.0; 3];
                for band in bands {
                    let mean = value(band.channel);
                    sum.iter_mut().zip(band.xyz).for_each(|(sum, xyz)| *sum += mean * xyz);
                }
                sum
            }
        })
    }

    /// XYZ of a pixel adapted to a D65 white by CAT02 if the primaries have another white; `None` if the picture has no colors.
    #[must_use]
    pub fn xyz_under_d65(&self, pixel: usize) -> Option<[f64; 3]> {
        let xyz = self.xyz(pixel)?;
        Some(self.to_d65.as_ref().map_or(xyz, |matrix| apply(matrix, xyz)))
    }

    /// Irradiance of a pixel within the bands, W m^-2; `None` if no bands were recorded.
    #[must_use]
    pub fn irradiance_w_m2(&self, pixel: usize) -> Option<f64> {
        let bands = self.bands()?;
        let power = |band: &Band| {
            f64::from(self.planes.channels[band.channel].values[pixel]) * (band.edges_nm[1] - band.edges_nm[0])
        };
        Some(bands.iter().map(power).sum())
    }

    /// Bands in ascending order of wavelength; `None` if none were recorded.
    #[must_use]
    pub fn bands(&self) -> Option<&[Band]> {
        if let Some(Colors::Bands(bands)) = &self.colors { Some(bands) } else { None }
    }

    /// The value of red, green or blue at which a pixel counts as clipped: the largest integer of the file's format, or white. `None` if
    /// the file defines neither.
    #[must_use]
    pub fn clips_at(&self) -> Option<f64> {
        if !matches!(self.colors, Some(Colors::Rgb(..))) {
            return None;
        }
        self.planes.clipped_at.map(f64::from).or((self.unit == Unit::OfWhite).then_some(1.0))
    }

    /// Whether a pixel is clipped: red, green or blue is at the largest integer, or above white.
    #[must_use]
    pub fn is_clipped(&self, pixel: usize) -> bool {
        let (Some(Colors::Rgb(at, _)), Some(limit)) = (&self.colors, self.clips_at()) else { return false };
        let is_end = self.planes.clipped_at.is_some();
        at.iter().any(|channel| {
            let value = f64::from(self.planes.channels[*channel].values[pixel]);
            if is_end { value >= limit } else { value > limit }
        })
    }

    /// Factor from the picture's Y to lux; `None` if the file does not define it.
    #[must_use]
    pub fn lux_per_y(&self) -> Option<f64> {
        match self.unit {
            Unit::Lux => Some(1.0),
            Unit::LuxSeconds => self.exposure_time_s.map(|time| 1.0 / time),
            Unit::OfWhite | Unit::Unknown => None,
        }
    }

    /// Area of a pixel on the film, m^2; `None` if the size of the film is not known.
    #[must_use]
    pub fn pixel_area_m2(&self) -> Option<f64> {
        let [width, height] = self.size_mm?;
        Some(1e-6 * width * height / self.planes.pixels() as f64)
    }

    /// Returns the Y that a screen shows as white. It is 1 if the picture is relative to white. Otherwise it is chosen as by automatic
    /// exposure: the 99th percentile of the lit pixels is shown as 0.9 of white. `None` without light or colors.
    #[must_use]
    pub fn white(&self) -> Option<f64> {
        const QUANTILE: f64 = 0.99;
        const SHOWN_AS: f64 = 0.9;
        if self.unit == Unit::OfWhite {
            return Some(1.0);
        }
        let lit = |v: &f64| *v > 0.0 && v.is_finite();
        let mut lit: Vec<f64> = (0..self.planes.pixels()).filter_map(|p| Some(self.xyz(p)?[1])).filter(lit).collect();
        if lit.is_empty() {
            return None;
        }
        // Nearest rank: the smallest value that at least this share of all values does not exceed.
        let rank = ((QUANTILE * lit.len() as f64).ceil() as usize).clamp(1, lit.len());
        let (_, anchor, _) = lit.select_nth_unstable_by(rank - 1, f64::total_cmp);
        Some(*anchor / SHOWN_AS)
    }

    /// Returns the error for a measurement that needs colors, which the channels of this picture do not define.
    #[must_use]
    pub fn without_colors(&self) -> NotMeasured {
        let names: Vec<_> = self.planes.channels.iter().take(8).map(|c| format!("`{}`", c.name)).collect();
        let text = format!("the channels {} of the picture do not define a color", names.join(", "));
        NotMeasured::new(
            text,
            "render with `imager: {kind: xyz}` or `spectral`, or write the finished picture: `{kind: exr, holds: picture}`",
        )
    }
}

/// Parses a size such as `36 x 24 mm`.
fn size_mm(text: &str) -> Option<[f64; 2]> {
    let (width, height) = text.strip_suffix(" mm")?.split_once(" x ")?;
    let number = |text: &str| text.parse().ok().filter(|v: &f64| v.is_finite() && *v > 0.0);
    Some([number(width)?, number(height)?])
}

/// Finds the bands of a spectral picture, in ascending order of wavelength; `None` if there are fewer than two.
fn bands(planes: &PictureChannels) -> Result<Option<Vec<Band>>, FileProblem> {
    let named = planes.channels.iter().enumerate();
    let mut middles: Vec<(f64, usize)> = named.filter_map(|(i, c)| Some((middle_nm(&c.name)?, i))).collect();
    middles.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some(pair) = middles.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let text = format!("two channels hold the band around {} nm", pair[0].0);
        return Err(FileProblem { key: "file", text, hint: Some("keep one channel for each band".to_owned()) });
    }
    let nm: Vec<f64> = middles.iter().map(|(nm, _)| *nm).collect();
    let Some(edges) = edges_nm(&nm) else { return Ok(None) };
    let band = |((_, channel), pair): (&(f64, usize), &[f64])| {
        let edges_nm = [pair[0], pair[1]];
        Band { channel: *channel, edges_nm, xyz: xyz_of_band(edges_nm) }
    };
    Ok(Some(middles.iter().zip(edges.windows(2)).map(band).collect()))
}
