//! Converts code values to linear light.

use super::linear_picture::FileProblem;
use spectra_color::{Transfer, from_aces_cct};
use std::sync::Arc;

/// Encoding of light by code values.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Encoding {
    /// The transfer curve of a standard.
    Curve(Transfer),
    /// A power law: light is the code value to this power.
    Gamma(f64),
    /// Printing density of a scanned negative (Cineon), see [`cineon`].
    Cineon,
    /// ACEScct, the logarithmic encoding for grading.
    AcesCct,
    /// Absolute light of a display (SMPTE ST 2084), see [`pq`].
    Pq,
    /// A sampled curve: light at evenly spaced code values from 0 to 1, at least two.
    Sampled(Arc<[f32]>),
}

/// Names that `transfer` may have in a scene. ITU-R BT.709 and BT.2020 share one curve.
const NAMES: [(&str, Encoding); 4] = [
    ("linear", Encoding::Curve(Transfer::Linear)),
    ("srgb", Encoding::Curve(Transfer::Srgb)),
    ("rec709", Encoding::Curve(Transfer::Rec2020)),
    ("cineon", Encoding::Cineon),
];

/// Names of these encodings in OpenImageIO, in lower case: color spaces (including those of release 3), and the SMPTE 268M transfer
/// characteristics that it passes on unchanged. ITU-R BT.601 and SMPTE 274M have the curve of BT.709.
const WORDS: [(&str, &[&str]); 4] = [
    ("linear", &["linear", "scene_linear", "lin_srgb", "lin_rec709", "lin_rec709_scene"]),
    ("srgb", &["srgb", "srgb_rec709_scene", "srgb_rec709_display"]),
    ("rec709", &["rec709", "smpte 274m", "itu-r 709-4", "itu-r 601-5 system b or g", "itu-r 601-5 system m"]),
    ("cineon", &["kodaklog", "logarithmic", "printing density"]),
];

impl Encoding {
    /// Returns the encoding with this name in a scene.
    pub(super) fn named(name: &str) -> Result<Self, FileProblem> {
        NAMES.iter().find(|(own, _)| *own == name).map(|(_, encoding)| encoding.clone()).ok_or_else(|| {
            let trouble = FileProblem::at("transfer", format!("unknown transfer `{name}`"));
            trouble.hint("choose linear, srgb, rec709 or cineon")
        })
    }

    /// Returns the encoding that a library names for a file; `None` if the name is unknown here.
    pub(super) fn of_color_space(words: &str) -> Option<Self> {
        let words = words.trim().to_ascii_lowercase();
        if let Some((name, _)) = WORDS.iter().find(|(_, all)| all.contains(&words.as_str())) {
            return Self::named(name).ok();
        }
        let gamma: f64 = words.strip_prefix("gammacorrected").or(words.strip_prefix("gamma"))?.trim().parse().ok()?;
        (0.2..=5.0).contains(&gamma).then_some(Self::Gamma(gamma))
    }

    /// Light of a code value that is not an integer of few bits. Unlike [`Self::decode`], returns black for codes below black, which
    /// logarithmic scales have.
    pub(super) fn light(&self, code: f64) -> f32 {
        let light = self.decode(code) as f32;
        if matches!(self, Self::Cineon | Self::AcesCct) { light.max(0.0) } else { light }
    }

    /// Linear light of a code value. Integer codes are at most 1.
    pub(super) fn decode(&self, code: f64) -> f64 {
        match self {
            Self::Curve(transfer) => transfer.decode(code),
            Self::Gamma(gamma) => libm::pow(code.max(0.0), *gamma),
            Self::Cineon => cineon(code),
            Self::AcesCct => from_aces_cct(code),
            Self::Pq => pq(code),
            Self::Sampled(light) => {
                let place = code.clamp(0.0, 1.0) * (light.len() - 1) as f64;
                let at = (place as usize).min(light.len() - 2);
                let [a, b] = [light[at], light[at + 1]].map(f64::from);
                a + (b - a) * (place - at as f64)
            }
        }
    }

    /// Whether this is the curve of a display, for which photographs are made: not linear and not logarithmic.
    pub(super) fn is_for_display(&self) -> bool {
        match self {
            Self::Curve(Transfer::Linear) | Self::Cineon | Self::AcesCct | Self::Pq => false,
            Self::Curve(_) => true,
            Self::Gamma(_) | Self::Sampled(_) => self.decode(0.5) < 0.4,
        }
    }

    /// Light of all integer codes, from 0 to `levels` - 1.
    pub(super) fn table(&self, levels: usize) -> Vec<f32> {
        (0..levels).map(|i| self.decode(i as f64 / (levels - 1) as f64).max(0.0) as f32).collect()
    }

    /// Light of the largest integer code.
    pub(super) fn clipped_at(&self) -> f32 {
        self.decode(1.0) as f32
    }
}

/// Light of a code value of a scanned negative: density 0.002 per step of 10 bits, film of gamma 0.6, black at code 95, white (light 1) at
/// code 685. Light below black is negative.
///
/// Sources: Eastman Kodak, "Conversion of 10-bit Log Film Data to 8-bit Linear or Video Data", 1995; G. Kennel and D. Snider, SMPTE Journal
/// 102, 849 (1993).
fn cineon(code: f64) -> f64 {
    const DENSITY_PER_CODE: f64 = 0.002;
    const GAMMA: f64 = 0.6;
    let relative = |code: f64| libm::pow(10.0, (code - 685.0) * DENSITY_PER_CODE / GAMMA);
    let black = relative(95.0);
    (relative(code * 1023.0) - black) / (1.0 - black)
}

/// Light of a code value of SMPTE ST 2084; 1 is 203 cd/m2, the diffuse white of ITU-R BT.2408.
fn pq(code: f64) -> f64 {
    const POWERS: [f64; 2] = [0.159_301_757_812_5, 78.843_75];
    const FACTORS: [f64; 3] = [0.835_937_5, 18.851_562_5, 18.687_5];
    const PEAK_CD_M2: f64 = 10_000.0;
    const WHITE_CD_M2: f64 = 203.0;
    let root = libm::pow(code.clamp(0.0, 1.0), 1.0 / POWERS[1]);
    libm::pow((root - FACTORS[0]).max(0.0) / (FACTORS[1] - FACTORS[2] * root), 1.0 / POWERS[0]) * PEAK_CD_M2
        / WHITE_CD_M2
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ITU-R BT.2100, table 4: code 1 is 10 000 cd/m2. BT.2408 puts 203 cd/m2 at 58 %, and 100 cd/m2 at 51 %.
    #[test]
    fn pq_is_light_of_a_display() {
        let light = |code: f64| Encoding::Pq.decode(code) * 203.0;
        assert!(light(0.0).abs() < 1e-12 && (light(1.0) - 10_000.0).abs() < 1e-6);
        assert!((light(0.58) / 203.0 - 1.0).abs() < 0.02 && (light(0.508) / 100.0 - 1.0).abs() < 0.01);
    }

    /// Closed form: 10^(-590 * 0.002 / 0.6) = 0.0107978 is black; a stop is 0.6 * log10(2) / 0.002 = 90.309 codes.
    #[test]
    fn cineon_has_its_black_its_white_and_its_stops() {
        let light = |code: f64| Encoding::Cineon.decode(code / 1023.0);
        assert!(light(95.0).abs() < 1e-15 && (light(685.0) - 1.0).abs() < 1e-15);
        let black = 0.010_797_751_623_277_1;
        let with_black = |code: f64| light(code) * (1.0 - black) + black;
        for stops in [-2.0, -1.0, 1.0, 2.0, 3.0] {
            let found = with_black(685.0 + stops * 90.308_998_699_194_36);
            assert!((found / libm::exp2(stops) - 1.0).abs() < 1e-12, "{stops}: {found}");
        }
        // Gray of 18 % from the documentation of the Python package colour-science (`log_encoding_Cineon`).
        assert!((Encoding::Cineon.decode(0.457_319_613_085_418) - 0.18).abs() < 1e-12);
        assert!((f64::from(Encoding::Cineon.clipped_at()) - 13.524).abs() < 1e-2);
    }

    #[test]
    fn words_of_the_library_are_known_and_others_are_not_guessed() {
        for (words, name) in [
            ("Linear", "linear"),
            ("sRGB", "srgb"),
            ("Rec709", "rec709"),
            ("KodakLog", "cineon"),
            ("Printing density", "cineon"),
        ] {
            assert_eq!(Encoding::of_color_space(words), Encoding::named(name).ok(), "{words}");
        }
        assert_eq!(Encoding::of_color_space("GammaCorrected2.2"), Some(Encoding::Gamma(2.2)));
        assert_eq!(Encoding::of_color_space("Gamma1.8"), Some(Encoding::Gamma(1.8)));
        for words in ["AdobeRGB", "ACEScg", "Undefined", "GammaCorrected-1", ""] {
            assert_eq!(Encoding::of_color_space(words), None, "{words}");
        }
    }
}
