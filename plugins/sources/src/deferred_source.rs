//! A source whose large files are read only when light is traced, not when a scene is checked.

use spectra_core::params::{Faults, Warning};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source, Split, Still};
use std::sync::OnceLock;

/// The data that was read, with warnings about it.
type Read<T> = Result<(T, Vec<Warning>), Faults>;
/// A function that reads the files and makes the source.
type Reader = Box<dyn Fn() -> Read<Box<dyn Source>> + Send + Sync>;
/// A function that reads the pixels of a picture.
type StillReader = Box<dyn Fn() -> Read<Still> + Send + Sync>;

/// A source that stands in for a file: white with the same size and position until [`Source::prepare`] is called, then the real
/// source.
pub(crate) struct DeferredSource {
    stand_in: Box<dyn Source>,
    reader: Reader,
    read: OnceLock<Box<dyn Source>>,
    /// Whether the real source emits rays.
    emits: bool,
    still: Option<StillReader>,
    /// Mid gray as a fraction of white, and whether the picture is already exposed; `None` if the source is not a picture.
    picture: Option<(f64, bool)>,
    doubts: OnceLock<Vec<Warning>>,
}

impl DeferredSource {
    /// Creates a source that uses `stand_in` until `reader` is called. `emits` says whether the real source emits rays; if not, the
    /// stand-in does not, either.
    pub(crate) fn new(
        stand_in: Box<dyn Source>,
        emits: bool,
        reader: impl Fn() -> Read<Box<dyn Source>> + Send + Sync + 'static,
    ) -> Self {
        Self {
            stand_in,
            reader: Box::new(reader),
            read: OnceLock::new(),
            emits,
            still: None,
            picture: None,
            doubts: OnceLock::new(),
        }
    }

    /// Returns this source as a flat picture whose pixels `still` reads.
    pub(crate) fn with_still(self, still: impl Fn() -> Read<Still> + Send + Sync + 'static) -> Self {
        Self { still: Some(Box::new(still)), ..self }
    }

    /// Returns this source as a picture whose mid gray is `gray` times white, the light of the stand-in. `is_exposed` says whether a
    /// camera has already chosen its exposure.
    pub(crate) fn of_picture(self, gray: f64, is_exposed: bool) -> Self {
        Self { picture: Some((gray, is_exposed)), ..self }
    }

    fn now(&self) -> &dyn Source {
        &**self.read.get().unwrap_or(&self.stand_in)
    }
}

impl Source for DeferredSource {
    fn prepare(&self) -> Result<(), Faults> {
        if self.read.get().is_none() {
            let (source, doubts) = (self.reader)()?;
            // If two threads read it at the same time, one of the two equal results is kept.
            let _ = self.doubts.set(doubts);
            let _ = self.read.set(source);
        }
        Ok(())
    }
    fn warnings(&self) -> &[Warning] {
        self.doubts.get().map_or(&[], Vec::as_slice)
    }
    fn spectrum(&self) -> &SpectralPower {
        self.now().spectrum()
    }
    fn focus_light(&self) -> &SpectralPower {
        self.stand_in.focus_light()
    }
    fn white(&self) -> &SpectralPower {
        self.stand_in.white()
    }
    fn peak_over_mean(&self) -> f64 {
        self.now().peak_over_mean()
    }
    fn distance_mm(&self) -> f64 {
        self.now().distance_mm()
    }
    fn emit(&self) -> Option<&dyn Emit> {
        self.now().emit().filter(|_| self.emits)
    }
    fn radiance(&self) -> Option<&dyn Radiance> {
        self.now().radiance()
    }
    fn split(&self) -> Option<Split<'_>> {
        self.now().split()
    }
    fn gray_over_mean(&self, response: &[f64]) -> Option<f64> {
        let (gray, _) = self.picture?;
        let [white, mean] = [&*self.stand_in, &**self.read.get()?].map(|source| source.spectrum().seen_by(response));
        Some(gray * white / mean).filter(|ratio| ratio.is_finite())
    }
    fn is_exposed(&self) -> bool {
        self.picture.is_some_and(|(_, is_exposed)| is_exposed)
    }
    fn still(&self) -> Option<Result<Still, Faults>> {
        let read = self.still.as_ref()?();
        Some(read.map(|(still, doubts)| {
            let _ = self.doubts.set(doubts);
            still
        }))
    }
    fn meaning(&self) -> Option<String> {
        self.now().meaning()
    }
    fn describe(&self) -> String {
        self.now().describe()
    }
}
