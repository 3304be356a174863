//! A lens made ready to trace, with a cache of its tracers.

use spectra_glass::DispersionError;
use spectra_lens::ApertureShape;
use spectra_lens::Lens;
use spectra_tracer::{Indices, Tracer};
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError};

/// The rims and apertures that end rays in a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clipping {
    /// All rims and apertures end rays, as the lens states them.
    AsStated,
    /// Irises count as circles of equal area, without blades; an f-number is defined in this way.
    RoundIris,
    /// The stop counts as the circle of its semi-diameter, whatever apertures it has.
    RoundStop,
    /// No rim and no aperture ends a ray. A ray ends only if it misses a surface or is totally reflected.
    None,
}

impl Clipping {
    /// Returns a copy of `lens` that clips rays this way.
    fn applied_to(self, lens: &Lens) -> Lens {
        let mut lens = lens.clone();
        match self {
            Self::AsStated => {}
            Self::RoundIris => {
                for element in &mut lens.elements {
                    element.apertures.retain(|aperture| !matches!(aperture.shape, ApertureShape::Iris(_)));
                }
            }
            Self::RoundStop => {
                if let Some(stop) = lens.stop() {
                    lens.elements[stop].apertures.clear();
                }
            }
            Self::None => lens.remove_rims(),
        }
        lens
    }
}

/// A cached tracer with the indices and the clipping for which it was made.
type Kept = (Indices, Clipping, Arc<Tracer>);

/// A lens that is ready for tracing, with a cache of its tracers.
///
/// Creating a [`Tracer`] fits the dispersion of every glass. Therefore each tracer is created on first use and cached. An
/// `Optics` dereferences to its [`Lens`].
#[derive(Debug)]
pub struct Optics {
    lens: Lens,
    tracers: Mutex<Vec<Kept>>,
}

impl Optics {
    /// Wraps `lens` for tracing, without creating a tracer yet.
    #[must_use]
    pub fn new(lens: Lens) -> Self {
        Self { lens, tracers: Mutex::default() }
    }

    /// Returns the tracer of the lens with all its rims and apertures.
    ///
    /// # Errors
    /// A medium has no usable index at one of the wavelengths.
    pub fn tracer(&self, indices: Indices) -> Result<Arc<Tracer>, DispersionError> {
        self.tracer_clipping(indices, Clipping::AsStated)
    }

    /// Returns the tracer of the lens with the rims and apertures that `clipping` keeps.
    ///
    /// # Errors
    /// A medium has no usable index at one of the wavelengths.
    pub fn tracer_clipping(&self, indices: Indices, clipping: Clipping) -> Result<Arc<Tracer>, DispersionError> {
        let mut kept = self.tracers.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((.., tracer)) = kept.iter().find(|(i, c, _)| *i == indices && *c == clipping) {
            return Ok(Arc::clone(tracer));
        }
        let tracer = match clipping {
            Clipping::AsStated => Tracer::new(&self.lens, indices)?,
            _ => Tracer::new(&clipping.applied_to(&self.lens), indices)?,
        };
        let tracer = Arc::new(tracer);
        kept.push((indices, clipping, Arc::clone(&tracer)));
        Ok(tracer)
    }
}

impl Deref for Optics {
    type Target = Lens;

    fn deref(&self) -> &Lens {
        &self.lens
    }
}

impl From<Lens> for Optics {
    fn from(lens: Lens) -> Self {
        Self::new(lens)
    }
}

impl Clone for Optics {
    /// Clones the lens and shares the tracers made so far.
    fn clone(&self) -> Self {
        let kept = self.tracers.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Self { lens: self.lens.clone(), tracers: Mutex::new(kept) }
    }
}
