//! Developed films, kept while one way to print them follows another.

use spectra_core::frame::{ExposureFrame, Finished, Wanted};
use spectra_core::stage::{Film, Negative};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// The films of one exposure, developed. What changes only how they are printed, scanned or looked at needs no more than these;
/// where a film develops otherwise, it is developed anew. They take as much memory as the exposure.
#[derive(Default)]
pub struct Negatives(Mutex<Vec<Option<Developed>>>);

/// A film, and what came of it.
type Developed = (Arc<dyn Film>, Negative);

impl Negatives {
    /// The picture of the film at `place`, of its part of the exposure: always the same.
    pub(crate) fn finish(
        &self,
        place: usize,
        film: &Arc<dyn Film>,
        exposure: &ExposureFrame,
    ) -> Result<Finished, String> {
        let wanted = Wanted::default();
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
