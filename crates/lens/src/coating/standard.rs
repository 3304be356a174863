//! Standard coatings: the usual coatings of a period, for lenses of which only the year is known.
//!
//! A lens that states no coating gets the coating of its year, marked as assumed. Evaporated layers of magnesium fluoride came into
//! production around 1940 (A. Smakula, German patent DE 685767, 1935; C. H. Cartwright and A. F. Turner, Physical Review 55, 1939, 675),
//! three layers around 1970 (J. T. Cox, G. Hass and A. Thelen, "Triple-layer antireflection coatings on glass for the visible and near
//! infrared", JOSA 52, 1962, 965; Asahi's Super-Multi-Coating of 1971).

use super::{Coating, CoatingEntry, Stack, StackLayer};
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::Arc;

/// Index of a layer of magnesium fluoride.
const MAGNESIUM_FLUORIDE: f64 = 1.38;
/// Index of a layer of zirconium oxide.
const ZIRCONIUM_OXIDE: f64 = 2.10;
/// Index of a layer of magnesium oxide.
const MAGNESIUM_OXIDE: f64 = 1.72;
/// Design wavelength of the single layer, nm: near the peak of the eye's sensitivity.
const SINGLE_NM: f64 = 550.0;
/// Design wavelength of the three layers, nm: the middle of 430 to 650 nm by wave number.
const THREE_NM: f64 = 515.0;

/// First year of the single layer.
const SINGLE_FROM: i32 = 1940;
/// First year of the three layers.
const THREE_FROM: i32 = 1970;

/// Registers a kind of coating that has no parameters.
macro_rules! coating {
    ($(#[$doc:meta])* $name:literal, $params:ident, $coating:expr) => {
        $(#[$doc])*
        #[derive(Debug, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        struct $params {}

        spectra_core::register!(CoatingEntry, $name: $params, |params, _| {
            params.parse::<$params>().map(|_| Box::new($coating))
        });
    };
}

coating! {
    /// A perfect coating: all light passes, nothing is reflected.
    ///
    /// Use it for a lens whose losses do not matter, or to see how much the losses cost.
    ///
    /// # Example
    /// ```yaml
    /// {kind: ideal}
    /// ```
    "ideal", Ideal, Coating::Ideal
}
coating! {
    /// Uncoated glass, by Fresnel's formulas.
    ///
    /// Lenses made before 1940 have no coating. Each surface of ordinary glass loses 4 % of the light, heavy flint more.
    ///
    /// # Example
    /// ```yaml
    /// {kind: bare}
    /// ```
    "bare", Bare, Coating::Bare
}
coating! {
    /// A quarter wave of magnesium fluoride at 550 nm.
    ///
    /// Lenses from 1940 to 1970 usually have it. Ordinary glass loses 1.3 % of the light at each surface, and reflections look purple.
    ///
    /// # Example
    /// ```yaml
    /// {kind: single-layer}
    /// ```
    "single-layer", SingleLayer, Coating::single_layer()
}
coating! {
    /// Three layers: a quarter wave of index 1.38, half a wave of 2.10, a quarter wave of 1.72, at 515 nm.
    ///
    /// Lenses from 1970 on usually have it. The loss stays below 0.5 % from 430 to 650 nm.
    ///
    /// # Example
    /// ```yaml
    /// {kind: three-layer}
    /// ```
    ///
    /// # References
    /// - J. T. Cox, G. Hass and A. Thelen, JOSA 52, 965 (1962).
    "three-layer", ThreeLayer, Coating::three_layer()
}

impl Coating {
    /// Returns a quarter-wave layer of magnesium fluoride for 550 nm. Its reflectance is 1.3 % on glass of index 1.52 and 0.4 %
    /// on 1.7.
    #[must_use]
    pub fn single_layer() -> Self {
        Self::quarter_wave(MAGNESIUM_FLUORIDE, SINGLE_NM)
    }

    /// Returns three layers for 515 nm: a quarter wave of index 1.38, half a wave of 2.10 and a quarter wave of 1.72. The
    /// reflectance is below 0.5 % from 430 to 650 nm on glass of index 1.51 to 1.78.
    #[must_use]
    pub fn three_layer() -> Self {
        let layer = |waves: f64, index: f64| StackLayer::constant(waves * THREE_NM / index, index, 0.0);
        let layers = vec![layer(0.25, MAGNESIUM_FLUORIDE), layer(0.5, ZIRCONIUM_OXIDE), layer(0.25, MAGNESIUM_OXIDE)];
        Self::Stack(Arc::new(Stack::new(layers)))
    }

    /// Returns the usual coating of lenses of a year: none before 1940, one layer before 1970, then three. If the year is unknown
    /// the glass is bare, because no coating is taken for granted.
    #[must_use]
    pub fn of_year(year: Option<i32>) -> Self {
        match year {
            Some(THREE_FROM..) => Self::three_layer(),
            Some(SINGLE_FROM..) => Self::single_layer(),
            _ => Self::Bare,
        }
    }

    /// Describes the coating in a few words: `bare`, `a single layer of MgF2`, `three layers`.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::Ideal => "no reflections".to_owned(),
            Self::Bare => "bare".to_owned(),
            Self::Layer { index, .. } if *index == MAGNESIUM_FLUORIDE => "a single layer of MgF2".to_owned(),
            Self::Layer { index, .. } => format!("a single layer of index {index}"),
            Self::Stack(stack) => match stack.len() {
                3 => "three layers".to_owned(),
                count => format!("{count} layers"),
            },
            Self::Measured(_) => "coatings as measured".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reflectance(coating: &Coating, n: f64, nm: f64) -> f64 {
        1.0 - coating.transmittance(1.0, n, 1.0, nm).mean()
    }

    /// Three layers reflect less than 0.5 % from 430 to 650 nm on the usual glasses, by the characteristic matrix; a single layer does not.
    #[test]
    fn three_layers_stay_below_half_a_percent() {
        for n in [1.5168, 1.55, 1.5891, 1.62, 1.6727, 1.72, 1.755, 1.78] {
            for nm in 430..=650 {
                let r = reflectance(&Coating::three_layer(), n, f64::from(nm));
                assert!(r < 0.005, "n {n}, {nm} nm: {r}");
            }
        }
        assert!(reflectance(&Coating::single_layer(), 1.5168, 550.0) > 0.0125);
    }

    #[test]
    fn by_year() {
        for (year, want) in [
            (None, Coating::Bare),
            (Some(1927), Coating::Bare),
            (Some(1939), Coating::Bare),
            (Some(1940), Coating::single_layer()),
            (Some(1969), Coating::single_layer()),
            (Some(1970), Coating::three_layer()),
            (Some(2024), Coating::three_layer()),
        ] {
            assert_eq!(Coating::of_year(year), want, "{year:?}");
        }
    }
}
