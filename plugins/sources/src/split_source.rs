//! A source with bright lights: the whole, and its two parts, the lights and the rest.

use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source, Split};

/// The part of a source's light that a copy of it represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightPart {
    /// All light of the source.
    Whole,
    /// The light of the bright pixels.
    Lights,
    /// The light of all other pixels.
    Rest,
    /// No light: the lights of a picture that has none.
    Nothing,
}

/// A source with copies that represent its lights and the rest.
pub(crate) struct SplitSource<S> {
    pub whole: S,
    pub lights: S,
    pub rest: S,
    /// Whether splitting reduces noise, see [`Split::pays`].
    pub pays: bool,
}

impl<S: Source> Source for SplitSource<S> {
    fn spectrum(&self) -> &SpectralPower {
        self.whole.spectrum()
    }
    fn peak_over_mean(&self) -> f64 {
        self.whole.peak_over_mean()
    }
    fn distance_mm(&self) -> f64 {
        self.whole.distance_mm()
    }
    fn emit(&self) -> Option<&dyn Emit> {
        self.whole.emit()
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        self.whole.radiance()
    }
    fn split(&self) -> Option<Split<'_>> {
        Some(Split { lights: &self.lights, rest: &self.rest, pays: self.pays })
    }
    fn meaning(&self) -> Option<String> {
        self.whole.meaning()
    }
    fn describe(&self) -> String {
        self.whole.describe()
    }
}
