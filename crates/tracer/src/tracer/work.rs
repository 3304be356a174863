//! Scratch space of one tracing thread.

use super::Tracer;
use super::kernels::Evaluate;
use crate::ledger::{Booked, Ledger};
use crate::transmission::{Passage, RaysBefore};
use spectra_core::batch::Column;
use spectra_core::surface::IndexColumns;
use spectra_core::{LossCounts, RayBatch};
use spectra_glass::Dispersion;

/// Scratch space of one tracing thread: the refractive indices of each ray, records of how rays met surfaces, and counts of lost
/// rays.
#[derive(Debug, Default)]
pub struct Work {
    pub(super) media: Vec<IndexColumnPair>,
    /// Counts of the rays lost so far, by cause and surface.
    pub losses: LossCounts,
    pub(super) compact: bool,
    pub(super) capacity: usize,
    /// Records of how rays met surfaces: for a lens that does not pass all light, and for batches that carry their optical path.
    pub(super) before: Option<RaysBefore>,
    /// The ledger of where light goes, if one is kept.
    pub(super) ledger: Option<(Ledger, Booked)>,
}

impl Work {
    /// Keeps a ledger of where the light of a path goes. Each ledger serves one path; see [`Work::take_ledger`].
    #[must_use]
    pub fn with_ledger(mut self) -> Self {
        self.ledger = Some((Ledger::default(), Booked::new(self.capacity)));
        self
    }

    /// Weighs rays by what media have absorbed of them so far.
    pub(super) fn weigh_absorbed(&mut self, rays: &mut RayBatch) {
        if let Some(noted) = &mut self.before {
            noted.weigh_absorbed(rays);
        }
    }

    /// Returns the ledger kept so far and starts a new one; `None` if no ledger is kept.
    pub fn take_ledger(&mut self) -> Option<Ledger> {
        self.ledger.as_mut().map(|(ledger, _)| std::mem::take(ledger))
    }
}

impl Tracer {
    /// Returns scratch space for batches of up to `capacity` rays. Tracing removes ended rays from a batch once they are more
    /// than half of it.
    #[must_use]
    pub fn work(&self, capacity: usize) -> Work {
        let media = self.media.iter().map(|medium| IndexColumnPair::new(medium, capacity)).collect();
        let before = (!self.is_ideal()).then(|| self.before(capacity));
        Work { media, losses: LossCounts::default(), compact: true, capacity, before, ledger: None }
    }

    /// Returns scratch space with which tracing never removes rays, so every ray keeps its place in the batch.
    #[must_use]
    pub fn work_in_place(&self, capacity: usize) -> Work {
        Work { compact: false, ..self.work(capacity) }
    }

    /// Returns scratch space for rendering, with which clear coatings of thin layers are computed in single precision, within
    /// 1e-6.
    #[must_use]
    pub fn work_for_light(&self, capacity: usize) -> Work {
        let work = self.work(capacity);
        if !self.passages.iter().any(Passage::has_single_precision) {
            return work;
        }
        Work { before: work.before.map(|before| before.in_single_precision(capacity, self.media.len())), ..work }
    }

    /// Returns scratch space for tracing that only asks which rays pass, and where. Rays stay in place and keep their weights.
    #[must_use]
    pub fn work_unweighed(&self, capacity: usize) -> Work {
        Work { before: self.has_rings().then(|| self.before(capacity)), ..self.work_in_place(capacity) }
    }

    /// Evaluates the index of each medium at the wavelength of each ray.
    pub(super) fn refractive_indices(&self, rays: &RayBatch, work: &mut Work) {
        let len = rays.len();
        for (medium, columns) in self.media.iter().zip(&mut work.media) {
            if !columns.constant {
                let (n, inverse) = (columns.n.slice_mut(len), columns.inverse.slice_mut(len));
                rays.isa().run(Evaluate { medium, wavelength_nm: rays.wavelengths_nm(), n, inverse });
            }
        }
        if let Some(noted) = &mut work.before {
            let indices = work.media.iter().map(|medium| medium.n.slice(len));
            noted.note_wavelengths(rays, indices, self.absorptions.as_ref());
        }
    }
}

/// Index and inverse index of one medium, for each ray of a batch.
#[derive(Debug)]
pub(super) struct IndexColumnPair {
    pub(super) n: Column<f64>,
    inverse: Column<f64>,
    /// Whether the index is the same for every ray, so that the columns are written only once.
    constant: bool,
}

impl IndexColumnPair {
    fn new(medium: &Dispersion, capacity: usize) -> Self {
        let (mut n, mut inverse) = (Column::new(capacity), Column::new(capacity));
        if let Some(index) = medium.constant() {
            n.slice_mut(capacity).fill(index);
            inverse.slice_mut(capacity).fill(1.0 / index);
        }
        Self { n, inverse, constant: medium.constant().is_some() }
    }
}

pub(super) fn columns(medium: &IndexColumnPair, len: usize) -> IndexColumns<'_> {
    IndexColumns { n: medium.n.slice(len), inverse: medium.inverse.slice(len) }
}
