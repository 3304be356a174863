//! Which stage made a number that is none.

use crate::error::RenderError;
use crate::no_number::{NoNumber, Step};
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{LARGEST_CONTRIBUTION, LARGEST_EXPECTED};
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;

/// Looks over a batch step by step.
#[derive(Debug, Default)]
pub(crate) struct Blame {
    /// Step, wavelength, whether infinite: of the first number that is none.
    found: Option<(Step, f64, bool)>,
}

impl Blame {
    /// Looks at the rays after a step.
    pub(crate) fn look(&mut self, step: Step, rays: &RayBatch) {
        if self.found.is_some() {
            return;
        }
        let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
        let (wavelengths, weights, states) = (rays.wavelengths_nm(), rays.weights(), rays.states());
        self.found = (0..rays.len()).filter(|i| states[*i] == ALIVE).find_map(|i| {
            let of_ray = [weights[i], wavelengths[i], x[i], y[i], z[i], l[i], m[i], n[i]];
            // Where several numbers are none, NaN is the one that tells of a slip.
            let bad = of_ray.into_iter().filter(|v| !v.is_finite()).reduce(|a, b| if a.is_nan() { a } else { b })?;
            Some((step, wavelengths[i], bad.is_infinite()))
        });
    }

    /// Whether a number was none.
    pub(crate) fn no_number(&self, pipeline: &Pipeline) -> Option<RenderError> {
        self.found.map(|found| no_number(pipeline, found))
    }

    /// Why the contributions of the batch that was looked at do not fit.
    pub(crate) fn error(&self, pipeline: &Pipeline, state: &mut ThreadState, scale: f64) -> RenderError {
        if let Some(error) = self.no_number(pipeline) {
            return error;
        }
        let largest = state.largest(pipeline);
        if largest.is_finite() && largest * scale >= LARGEST_CONTRIBUTION {
            return RenderError::Overflow { times: largest * scale / LARGEST_EXPECTED };
        }
        no_number(pipeline, (Step::Response, f64::NAN, largest.is_infinite()))
    }
}

fn no_number(pipeline: &Pipeline, (step, wavelength_nm, infinite): (Step, f64, bool)) -> RenderError {
    let section = pipeline.scene.params.get(step.section());
    let kind = section.and_then(|node| node.get("kind").unwrap_or(node).as_str()).map(str::to_owned);
    RenderError::NoNumber(NoNumber { step, kind, wavelength_nm, infinite })
}
