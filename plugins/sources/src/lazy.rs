//! A source whose large files are read when light is traced, not when a scene is checked.

use spectra_core::params::{Faults, Warning};
use spectra_core::spectral::SpectralPower;
use spectra_core::stage::{Emit, Radiance, Source, Split, Still};
use std::sync::OnceLock;

/// What was read, and what is doubtful in it.
type Read<T> = Result<(T, Vec<Warning>), Faults>;
/// How the source itself is made.
type Reader = Box<dyn Fn() -> Read<Box<dyn Source>> + Send + Sync>;
/// How its pixels are read.
type StillReader = Box<dyn Fn() -> Read<Still> + Send + Sync>;

/// A white source of the same size and place until [`Source::prepare`] is called, then the real one.
pub(crate) struct Lazy {
    stand_in: Box<dyn Source>,
    reader: Reader,
    read: OnceLock<Box<dyn Source>>,
    /// Whether the real one emits rays.
    emits: bool,
    still: Option<StillReader>,
    /// Of a picture: mid gray as a part of white, and whether it was exposed already.
    picture: Option<(f64, bool)>,
    doubts: OnceLock<Vec<Warning>>,
}

impl Lazy {
    /// `stand_in` answers for radiance, and emits rays if it `emits`, as the real one does.
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

    /// The same, a flat picture whose pixels are read by `still`.
    pub(crate) fn with_still(self, still: impl Fn() -> Read<Still> + Send + Sync + 'static) -> Self {
        Self { still: Some(Box::new(still)), ..self }
    }

    /// The same, a picture whose mid gray is `gray` of white, the light of the stand-in; `is_exposed` if it was taken by a camera that found
    /// its exposure.
    pub(crate) fn of_picture(self, gray: f64, is_exposed: bool) -> Self {
        Self { picture: Some((gray, is_exposed)), ..self }
    }

    fn now(&self) -> &dyn Source {
        &**self.read.get().unwrap_or(&self.stand_in)
    }
}

impl Source for Lazy {
    fn prepare(&self) -> Result<(), Faults> {
        if self.read.get().is_none() {
            let (source, doubts) = (self.reader)()?;
            // Where two threads read it at once, one of two equal ones is kept.
            let _ = self.doubts.set(doubts);
            let _ = self.read.set(source);
        }
        Ok(())
    }
    fn doubts(&self) -> &[Warning] {
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
