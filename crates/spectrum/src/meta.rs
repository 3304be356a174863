//! The front matter of a spectrum file: what it holds, and where it comes from.

use schemars::JsonSchema;
use serde::Deserialize;
use std::fmt;

/// What a file's columns are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Emitted power per nanometre.
    Emission,
    /// Power in spectral lines.
    Lines,
    /// Share of power that passes.
    Transmittance,
    /// Share of power that is thrown back.
    Reflectance,
    /// Response per power.
    Sensitivity,
    /// Functions that weigh light into color values; they may be negative.
    ColorMatching,
    /// Vectors of which spectra are summed; they may be negative.
    Components,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Emission,
        Self::Lines,
        Self::Transmittance,
        Self::Reflectance,
        Self::Sensitivity,
        Self::ColorMatching,
        Self::Components,
    ];

    /// The word that stands in files.
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

    /// The kind of that word.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.word() == word)
    }

    /// What the name of a column says it is: `transmittance`, `Spectral response`, `power [W]`.
    #[must_use]
    pub fn of_header(name: &str) -> Option<Self> {
        // Power stands beside the others, too: `power reflectance`.
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

    /// Whether a value below 0 makes sense.
    #[must_use]
    pub fn may_be_negative(self) -> bool {
        matches!(self, Self::ColorMatching | Self::Components)
    }

    /// The largest value that is believed; more is a percentage, or a slip.
    ///
    /// A transmittance has 0.02 for the noise of its measurement; a reflectance factor may exceed 1, since a
    /// glossy or fluorescent patch can be brighter than the perfect diffuser in one direction.
    #[must_use]
    pub fn bound(self) -> Option<f64> {
        match self {
            Self::Transmittance => Some(1.02),
            Self::Reflectance => Some(1.5),
            Self::Sensitivity => Some(2.0),
            Self::Emission | Self::Lines | Self::ColorMatching | Self::Components => None,
        }
    }

    /// What a table of this kind is beyond its ends unless it says so itself.
    ///
    /// CIE 15:2004, 7.2.2.1 sets missing values of an illuminant or a material to the nearest one given; a
    /// detector that was not measured is taken as blind.
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

/// What a table is beyond its first and last wavelength.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Outside {
    /// 0.
    Zero,
    /// The nearest value given.
    Constant,
    /// Falls on at the mean logarithmic rate of the ten nanometres at that end; 0 where the values there do not
    /// fall toward the end, or change sign.
    Geometric,
}

impl Outside {
    /// The word that stands in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::Constant => "constant",
            Self::Geometric => "geometric",
        }
    }

    /// The extension of that word.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Zero, Self::Constant, Self::Geometric].into_iter().find(|o| o.word() == word)
    }
}

/// The scale on which values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// As they are.
    #[default]
    Linear,
    /// Their logarithm to base 10 (`unit: log10`); interpolated as such.
    Log10,
}

/// How a table is read between its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Interpolation {
    /// Straight lines: what CIE 15:2004 asks for illuminants, and right where a table has edges.
    #[default]
    Linear,
    /// Sprague's polynomial of fifth degree through six equally spaced points: what CIE 167:2005 asks for smooth
    /// measurements such as reflectances.
    Sprague,
}

impl Interpolation {
    /// The word that stands in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Sprague => "sprague",
        }
    }

    /// The interpolation of that word.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Linear, Self::Sprague].into_iter().find(|i| i.word() == word)
    }
}

/// Where the strengths of a lamp's lines come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Strengths {
    /// Measured: they compare as powers.
    Measured,
    /// Computed from a model of the discharge: they compare as far as the model holds.
    Computed,
    /// Observers' estimates: neighboring lines compare, lines far apart do not.
    Estimated,
}

impl Strengths {
    /// The word that stands in files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Computed => "computed",
            Self::Estimated => "estimated",
        }
    }

    /// The strengths of that word.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        [Self::Measured, Self::Computed, Self::Estimated].into_iter().find(|s| s.word() == word)
    }
}

/// Front matter. A file of your own may leave all of it out; a bundled file has every field but `notes`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meta {
    /// How people call it.
    pub name: Option<String>,
    /// What the columns are.
    pub kind: Option<Kind>,
    /// The quantity in words.
    pub quantity: Option<String>,
    /// Unit of the values: `1`, `1/nm`, `W/nm`, `log10` ...
    pub unit: Option<String>,
    /// Publication, maker's sheet or measurement.
    pub source: Option<String>,
    /// Terms under which the figures came.
    pub license: Option<String>,
    /// Conditions of the measurement.
    pub conditions: Option<String>,
    /// Of `kind: lines`: where their strengths come from.
    pub strengths: Option<Strengths>,
    /// First and last wavelength, nm.
    pub range_nm: Option<(f64, f64)>,
    /// What holds beyond the ends.
    pub outside: Option<Outside>,
    /// How it is read between its points; linear unless stated.
    pub interpolation: Interpolation,
    /// Anything else worth knowing.
    pub notes: Vec<String>,
}

impl Meta {
    /// Keys in the order in which files write them.
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

    /// Required keys that are absent; empty for a bundled file.
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

    /// The scale that `unit` names.
    #[must_use]
    pub fn scale(&self) -> Scale {
        if self.unit.as_deref() == Some("log10") { Scale::Log10 } else { Scale::Linear }
    }

    /// Sets `key`; the error says what the value should have been, or `None` for an unknown key.
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
            // Older files have the British word.
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
