//! A cache of developed films, for printing the same exposure several times.

use spectra_core::frame::{ExposureFrame, ExtraRequest, FinishedPicture};
use spectra_core::params::Fault;
use spectra_core::stage::{Film, Negative};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Developed films of one exposure. If only the way in which a film is printed, scanned or viewed changes, its kept negative is
/// used again. A film that develops differently is developed again. The negatives take as much memory as the exposure.
#[derive(Default)]
pub struct Negatives(Mutex<Vec<Option<Developed>>>);

/// A film, and its developed negative.
type Developed = (Arc<dyn Film>, Negative);

impl Negatives {
    /// Returns the picture of the film at index `place` for its part of the exposure. The exposure must be the same in every
    /// call.
    pub(crate) fn finish(
        &self,
        place: usize,
        film: &Arc<dyn Film>,
        exposure: &ExposureFrame,
    ) -> Result<FinishedPicture, Fault> {
        let wanted = ExtraRequest::default();
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() <= place {
            all.resize_with(place + 1, || None);
        }
        let before = all[place].take().filter(|(before, _)| film.develops_as(&**before));
        let negative = match before {
            Some((_, negative)) => negative,
            None => match film.negative(exposure, wanted)? {
                Some(negative) => negative,
                None => return film.finish(exposure, wanted),
            },
        };
        let finished = film.print(&negative, wanted);
        all[place] = Some((Arc::clone(film), negative));
        finished
    }
}

impl fmt::Debug for Negatives {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_struct("Negatives").finish_non_exhaustive()
    }
}
