//! One quantity of a picture at each pixel.

use super::measured::{Measured, NotMeasured, Unit};
use spectra_color::{RgbSpace, lab};

/// A quantity that can be computed for each pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Illuminance, lx.
    Illuminance,
    /// Luminous exposure, lx s.
    Exposure,
    /// Irradiance within the recorded bands, W m^-2.
    Irradiance,
    /// Luminance relative to white; plain Y if the picture is not relative to white.
    Luminance,
    /// CIE L*.
    Lightness,
    /// CIE chroma C*ab.
    Chroma,
    /// CIE hue angle h_ab, degrees, 0 to 360; undefined for grays.
    Hue,
    /// Values of the channel with this name.
    Channel(String),
}

impl Quantity {
    /// Quantities that have a fixed name, with these names.
    pub const NAMED: [(&'static str, Self); 7] = [
        ("illuminance", Self::Illuminance),
        ("exposure", Self::Exposure),
        ("irradiance", Self::Irradiance),
        ("luminance", Self::Luminance),
        ("lightness", Self::Lightness),
        ("chroma", Self::Chroma),
        ("hue", Self::Hue),
    ];

    /// Returns the quantity called `name`: a channel of the picture with this name, or else one of [`Self::NAMED`]; `L*` means
    /// lightness. `None` if there is no such quantity.
    #[must_use]
    pub fn named(name: &str, picture: &Measured) -> Option<Self> {
        if picture.planes.channel(name).is_some() {
            return Some(Self::Channel(name.to_owned()));
        }
        let name = if name == "L*" { "lightness" } else { name };
        Self::NAMED.into_iter().find(|(own, _)| *own == name).map(|(_, quantity)| quantity)
    }

    /// Returns the quantity to show by default. It is illuminance or exposure if the picture knows its light in absolute units,
    /// otherwise luminance. For a picture without colors it is the first channel.
    #[must_use]
    pub fn usual(picture: &Measured) -> Self {
        match picture.unit {
            _ if picture.colors.is_none() => {
                Self::Channel(picture.planes.channels.first().map_or_else(String::new, |c| c.name.clone()))
            }
            _ if picture.lux_per_y().is_some() => Self::Illuminance,
            Unit::LuxSeconds => Self::Exposure,
            Unit::Lux | Unit::OfWhite | Unit::Unknown => Self::Luminance,
        }
    }
}

/// Values of one quantity at each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityMap {
    /// Name of the quantity, without unit.
    pub name: String,
    /// Unit; empty if the quantity has none or none is known.
    pub unit: String,
    /// Values row by row from the top; NaN where undefined.
    pub values: Vec<f64>,
    /// Whether the quantity is an angle of 0 to 360 degrees.
    pub is_hue: bool,
    /// Description of the reference white, for quantities relative to one.
    pub white: Option<String>,
}

/// Chroma below which a hue is undefined.
const GRAY_CHROMA: f64 = 1.0;

impl QuantityMap {
    /// Computes a quantity at each pixel of a picture. Lightness, chroma and hue are relative to a D65 white whose Y is `white`; if `None`,
    /// [`Measured::white`] is used.
    ///
    /// # Errors
    /// The picture does not contain what the quantity needs.
    pub fn of(picture: &Measured, quantity: &Quantity, white: Option<f64>) -> Result<Self, NotMeasured> {
        let pixels = 0..picture.planes.pixels();
        let colors = || picture.colors.as_ref().map(|_| ()).ok_or_else(|| picture.without_colors());
        let y = |pixel: usize| picture.xyz(pixel).map_or(f64::NAN, |xyz| xyz[1]);
        let plain = |name: &str, unit: &str, values: Vec<f64>| Self {
            name: name.to_owned(),
            unit: unit.to_owned(),
            values,
            is_hue: false,
            white: None,
        };
        let times = |factor: f64| pixels.clone().map(|p| y(p) * factor).collect();
        Ok(match quantity {
            Quantity::Channel(name) => {
                let channel = picture.planes.channel(name).ok_or_else(|| no_channel(picture, name))?;
                plain(name, &channel.unit, channel.values.iter().map(|v| f64::from(*v)).collect())
            }
            Quantity::Illuminance => {
                colors()?;
                plain("illuminance", "lx", times(picture.lux_per_y().ok_or_else(|| no_lux(picture))?))
            }
            Quantity::Exposure => {
                colors()?;
                if picture.unit != Unit::LuxSeconds {
                    let hint = "use `--quantity illuminance`, or give the imager an `exposure: 1/60 s`";
                    return Err(NotMeasured::new("the picture has no exposure in lx s", hint));
                }
                plain("exposure", "lx s", times(1.0))
            }
            Quantity::Irradiance => {
                if picture.bands().is_none() {
                    let hint = "`imager: {kind: spectral, bands: 40}` records it";
                    return Err(NotMeasured::new("the picture does not record its power by wavelength", hint));
                }
                let irradiance = |p: usize| picture.irradiance_w_m2(p).unwrap_or(f64::NAN);
                plain("irradiance", "W/m^{2}", pixels.map(irradiance).collect())
            }
            Quantity::Luminance => {
                colors()?;
                let unit = picture.unit.symbol();
                let name = if picture.unit == Unit::OfWhite { "luminance / white" } else { "Y" };
                plain(name, unit, times(1.0))
            }
            Quantity::Lightness | Quantity::Chroma | Quantity::Hue => {
                colors()?;
                let white = white.or_else(|| picture.white()).ok_or_else(dark)?;
                let against = RgbSpace::srgb().white_xyz().map(|v| v * white);
                let value = |pixel: usize| {
                    let [l, a, b] = lab(picture.xyz_under_d65(pixel).unwrap_or([f64::NAN; 3]), against);
                    let chroma = (a * a + b * b).sqrt();
                    match quantity {
                        Quantity::Lightness => l,
                        Quantity::Chroma => chroma,
                        _ if chroma < GRAY_CHROMA || !chroma.is_finite() => f64::NAN,
                        _ => libm::atan2(b, a).to_degrees().rem_euclid(360.0),
                    }
                };
                let (name, unit) = match quantity {
                    Quantity::Lightness => ("lightness L*", ""),
                    Quantity::Chroma => ("chroma C*", ""),
                    _ => ("hue h", "degrees"),
                };
                let field = plain(name, unit, pixels.map(value).collect());
                Self { is_hue: *quantity == Quantity::Hue, white: Some(describe_white(white, picture.unit)), ..field }
            }
        })
    }

    /// Smallest and largest finite value; `None` if no value is finite.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        let finite = self.values.iter().filter(|v| v.is_finite());
        finite.fold(None, |range: Option<[f64; 2]>, v| Some(range.map_or([*v; 2], |[a, b]| [a.min(*v), b.max(*v)])))
    }

    /// Name and unit, as written along a scale.
    #[must_use]
    pub fn label(&self) -> String {
        if self.unit.is_empty() { self.name.clone() } else { format!("{} / {}", self.name, self.unit) }
    }
}

/// Describes a white in words.
pub(super) fn describe_white(white: f64, unit: Unit) -> String {
    format!("white: Y = {} {}", short(white), unit.symbol()).trim_end().to_owned()
}

/// Formats a number with four digits.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        let whole = format!("{:.0}", value.abs()).len();
        let text = format!("{value:.*}", 5_usize.saturating_sub(whole));
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.3e}")
    }
}

pub(super) fn dark() -> NotMeasured {
    NotMeasured::new("no pixel of the picture is lit", "set what is shown as white with `--white`")
}

fn no_lux(picture: &Measured) -> NotMeasured {
    match picture.unit {
        Unit::OfWhite => NotMeasured::new(
            "the picture is relative to its white, not in lux",
            "use `--quantity luminance`; the linear exposure of the same render is in lx s",
        ),
        Unit::LuxSeconds => NotMeasured::new("the file does not state the exposure time", "use `--quantity exposure`"),
        Unit::Lux | Unit::Unknown => {
            NotMeasured::new("the file does not state the unit of its values", "use `--quantity luminance`")
        }
    }
}

fn no_channel(picture: &Measured, name: &str) -> NotMeasured {
    let names: Vec<_> = picture.planes.channels.iter().take(12).map(|c| format!("`{}`", c.name)).collect();
    NotMeasured::new(format!("the picture has no channel `{name}`"), format!("its channels are {}", names.join(", ")))
}
