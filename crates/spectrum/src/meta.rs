//! Front matter of a spectrum file: what it holds, and where it comes from.

use schemars::JsonSchema;
use serde::Deserialize;
use std::fmt;

/// Kind of quantity in a file's columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Emitted power per nanometer.
    Emission,
    /// Power of spectral lines.
    Lines,
    /// Fraction of power that is transmitted.
    Transmittance,
    /// Fraction of power that is reflected.
    Reflectance,
    /// Response of a detector per power.
    Sensitivity,
    /// Functions that weight light to give color values; they may be negative.
    ColorMatching,
    /// Vectors from which spectra are summed; they may be negative.
    Components,
}

impl Kind {
    /// All kinds of spectra.
    pub const ALL: [Self; 7] = [
        Self::Emission,
        Self::Lines,
        Self::Transmittance,
        Self::Reflectance,
        Self::Sensitivity,
        Self::ColorMatching,
        Self::Components,
    ];

    /// Word for this kind in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Emission => "emission",
            Self::Lines => "lines",
            Self::Transmittance => "transmittance",
            Self::Reflectance => "reflectance",
            Self::Sensitivity => "sensitivity",
            Self::ColorMatching => "color-matching",
            Self::Components => "components",
        }
    }

    /// Returns the kind for a word in a file.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.word() == word)
    }

    /// Guesses the kind from the name of a column, such as `transmittance`, `Spectral response` or `power [W]`; `None` if it
    /// suggests no kind.
    #[must_use]
    pub fn of_header(name: &str) -> Option<Self> {
        // Power comes last, because it also occurs together with the others: `power reflectance`.
        const WORDS: [(Kind, &[&str]); 4] = [
            (Kind::Transmittance, &["transmittance", "transmission", "transmissivity"]),
            (Kind::Reflectance, &["reflectance", "reflection", "reflectivity"]),
            (Kind::Sensitivity, &["sensitivity", "response", "responsivity", "responsivities", "sensitivities"]),
            (Kind::Emission, &["emission", "radiance", "irradiance", "exitance", "intensity", "power", "flux", "spd"]),
        ];
        let name = name.to_lowercase();
        let has = |words: &[&str]| name.split(|c: char| !c.is_alphabetic()).any(|word| words.contains(&word));
        WORDS.into_iter().find(|(_, words)| has(words)).map(|(kind, _)| kind)
    }

    /// Returns whether negative values make sense for this kind.
    #[must_use]
    pub fn may_be_negative(self) -> bool {
        matches!(self, Self::ColorMatching | Self::Components)
    }

    /// Returns the largest plausible value of this kind, above which a value is a percentage or a mistake; `None` if there is no
    /// limit.
    ///
    /// The limit for a transmittance is 0.02 above 1, to allow for measurement noise. A reflectance factor may exceed 1,
    /// because a glossy or fluorescent patch can be brighter than the perfect diffuser in one direction.
    #[must_use]
    pub fn bound(self) -> Option<f64> {
        match self {
            Self::Transmittance => Some(1.02),
            Self::Reflectance => Some(1.5),
            Self::Sensitivity => Some(2.0),
            Self::Emission | Self::Lines | Self::ColorMatching | Self::Components => None,
        }
    }

    /// Returns how a table of this kind is continued beyond its ends, unless its file states a continuation.
    ///
    /// CIE 15:2004, 7.2.2.1 sets missing values of an illuminant or a material to the nearest given one; the sensitivity of a
    /// detector is taken as 0 where it was not measured.
    #[must_use]
    pub fn outside(self) -> Outside {
        match self {
            Self::Emission | Self::Transmittance | Self::Reflectance | Self::Components => Outside::Constant,
            Self::Lines | Self::Sensitivity | Self::ColorMatching => Outside::Zero,
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// Continuation of a table beyond its first and last wavelength.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Outside {
    /// The value is 0.
    Zero,
    /// The nearest given value is kept.
    Constant,
    /// The values continue to fall at the mean logarithmic rate of the last ten nanometers; 0 if the values there do not fall
    /// toward the end, or change sign.
    Geometric,
}

impl Outside {
    /// Word for this continuation in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Constant => "constant",
            Self::Geometric => "geometric",
        }
    }

    /// Returns the continuation for a word in a file.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Zero, Self::Constant, Self::Geometric].into_iter().find(|o| o.word() == word)
    }
}

/// Scale on which values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// The values themselves.
    #[default]
    Linear,
    /// Logarithm of the values to base 10 (`unit: log10`); interpolated as such.
    Log10,
}

/// Interpolation between the points of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Interpolation {
    /// Straight lines: recommended by CIE 15:2004 for illuminants, and right where a table has edges.
    #[default]
    Linear,
    /// Sprague's polynomial of fifth degree through six equally spaced points: recommended by CIE 167:2005 for smooth
    /// measurements such as reflectances.
    Sprague,
}

impl Interpolation {
    /// Word for this interpolation in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Sprague => "sprague",
        }
    }

    /// Returns the interpolation for a word in a file.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Linear, Self::Sprague].into_iter().find(|i| i.word() == word)
    }
}

/// Origin of the strengths of a lamp's lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Strengths {
    /// Measured: the strengths compare as powers.
    Measured,
    /// Computed from a model of the discharge: the strengths compare as far as the model holds.
    Computed,
    /// Observers' estimates: neighboring lines compare, lines far apart do not.
    Estimated,
}

impl Strengths {
    /// Word for this origin in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Computed => "computed",
            Self::Estimated => "estimated",
        }
    }

    /// Returns the origin for a word in a file.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Measured, Self::Computed, Self::Estimated].into_iter().find(|s| s.word() == word)
    }
}

/// Front matter of a table. A file of your own may leave all of it out; a bundled file has every field but `notes`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meta {
    /// Common name of the spectrum.
    pub name: Option<String>,
    /// Kind of quantity in the columns.
    pub kind: Option<Kind>,
    /// Quantity in words.
    pub quantity: Option<String>,
    /// Unit of the values, such as `1`, `1/nm`, `W/nm` or `log10`.
    pub unit: Option<String>,
    /// Publication, manufacturer's data sheet or measurement from which the figures come.
    pub source: Option<String>,
    /// License of the figures.
    pub license: Option<String>,
    /// Conditions of the measurement.
    pub conditions: Option<String>,
    /// Origin of the strengths; only for `kind: lines`.
    pub strengths: Option<Strengths>,
    /// First and last wavelength of the table, nm.
    pub range_nm: Option<(f64, f64)>,
    /// Continuation of the table beyond its ends; `None` for the usual one of its kind ([`Kind::outside`]).
    pub outside: Option<Outside>,
    /// Interpolation between the points; linear unless stated.
    pub interpolation: Interpolation,
    /// Anything else worth knowing.
    pub notes: Vec<String>,
}

impl Meta {
    /// Keys of the front matter, in the order in which files write them.
    pub const KEYS: [&'static str; 13] = [
        "spectra",
        "name",
        "kind",
        "quantity",
        "unit",
        "source",
        "license",
        "conditions",
        "strengths",
        "interpolation",
        "outside",
        "range",
        "note",
    ];

    /// Lists the required keys that are absent; empty for a bundled file.
    #[must_use]
    pub fn missing(&self) -> Vec<&'static str> {
        let present = [
            ("name", self.name.is_some()),
            ("kind", self.kind.is_some()),
            ("quantity", self.quantity.is_some()),
            ("unit", self.unit.is_some()),
            ("source", self.source.is_some()),
            ("license", self.license.is_some()),
            ("conditions", self.conditions.is_some()),
            ("strengths", self.strengths.is_some() || self.kind != Some(Kind::Lines)),
            ("range", self.range_nm.is_some()),
        ];
        present.into_iter().filter(|(_, has)| !has).map(|(key, _)| key).collect()
    }

    /// Returns the scale that `unit` implies: [`Scale::Log10`] for `log10`, otherwise linear.
    #[must_use]
    pub fn scale(&self) -> Scale {
        if self.unit.as_deref() == Some("log10") { Scale::Log10 } else { Scale::Linear }
    }

    /// Sets `key` to `value`. The error describes the valid values, or is `None` for an unknown key.
    pub(crate) fn set(&mut self, key: &str, value: &str) -> Result<(), Option<&'static str>> {
        let text = || Some(value.to_owned());
        match key {
            "spectra" if value == "1" => {}
            "spectra" => return Err(Some("1, the format that this program reads")),
            "name" => self.name = text(),
            "quantity" => self.quantity = text(),
            "unit" if value == "%" || value.starts_with("percent") => {
                return Err(Some("1 or log10; divide percentages by 100"));
            }
            "unit" => self.unit = text(),
            "source" => self.source = text(),
            // Older files use the British spelling.
            "license" | "licence" => self.license = text(),
            "conditions" => self.conditions = text(),
            "note" => self.notes.push(value.to_owned()),
            "kind" => {
                let wanted = "emission, lines, transmittance, reflectance, sensitivity, color-matching or components";
                self.kind = Some(Kind::from_word(value).ok_or(Some(wanted))?);
            }
            "outside" => {
                self.outside = Some(Outside::from_word(value).ok_or(Some("zero, constant or geometric"))?);
            }
            "interpolation" => {
                self.interpolation = Interpolation::from_word(value).ok_or(Some("linear or sprague"))?;
            }
            "strengths" => {
                self.strengths = Some(Strengths::from_word(value).ok_or(Some("measured, computed or estimated"))?);
            }
            "range" => self.range_nm = Some(range(value).ok_or(Some("two wavelengths, such as 380-780 nm"))?),
            _ => return Err(None),
        }
        Ok(())
    }
}

fn range(text: &str) -> Option<(f64, f64)> {
    let (low, high) = text.strip_suffix("nm")?.split_once('-')?;
    let (low, high): (f64, f64) = (low.trim().parse().ok()?, high.trim().parse().ok()?);
    (low <= high).then_some((low, high))
}
