//! A source with lights in it: whole, and as two.

use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source, Split};

/// Which light of a source a copy of it stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    /// All.
    Whole,
    /// That of the bright pixels.
    Lights,
    /// That of all others.
    Rest,
    /// None: the lights of what has none.
    Nothing,
}

/// A source whose copies stand for its lights and for the rest.
pub(crate) struct Halves<S> {
    pub whole: S,
    pub lights: S,
    pub rest: S,
    /// See [`Split::pays`].
    pub pays: bool,
}

impl<S: Source> Source for Halves<S> {
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
