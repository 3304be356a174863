//! Finds the stage that produced a number that is not finite.

use crate::error::RenderError;
use crate::non_finite::{NonFinite, Step};
use crate::pipeline::{Pipeline, ThreadState};
use crate::sums::{LARGEST_CONTRIBUTION, LARGEST_EXPECTED};
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;

/// Checks a batch step by step and remembers the first number that is not finite.
#[derive(Debug, Default)]
pub(crate) struct FiniteCheck {
    /// Step, wavelength (nm) and whether it is infinite, for the first number that is not finite.
    found: Option<(Step, f64, bool)>,
    /// Rays without a valid position or direction at the start, because a ray of the previous batch ended there. They get theirs before the
    /// lens.
    stale: Vec<usize>,
}

impl FiniteCheck {
    /// Checks the rays after a step.
    pub(crate) fn look(&mut self, step: Step, rays: &RayBatch) {
        if self.found.is_some() {
            return;
        }
        let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
        let (wavelengths, weights, states) = (rays.wavelengths_nm(), rays.weights(), rays.states());
        let whole = |i: usize| [x[i], y[i], z[i], l[i], m[i], n[i]].iter().all(|v| v.is_finite());
        match step {
            Step::Wavelengths => self.stale = (0..rays.len()).filter(|i| !whole(*i)).collect(),
            Step::Lens => self.stale.clear(),
            _ => self.stale.retain(|i| !whole(*i)),
        }
        let stale = &self.stale;
        self.found = (0..rays.len()).filter(|i| states[*i] == ALIVE).find_map(|i| {
            let own = [weights[i], wavelengths[i]];
            let way = if stale.binary_search(&i).is_ok() { [0.0; 6] } else { [x[i], y[i], z[i], l[i], m[i], n[i]] };
            let of_ray = own.into_iter().chain(way);
            // If several numbers are not finite, report NaN: it is the one that points to a fault.
            let bad = of_ray.filter(|v| !v.is_finite()).reduce(|a, b| if a.is_nan() { a } else { b })?;
            Some((step, wavelengths[i], bad.is_infinite()))
        });
    }

    /// Returns an error if any number was not finite.
    pub(crate) fn no_number(&self, pipeline: &Pipeline) -> Option<RenderError> {
        self.found.map(|found| no_number(pipeline, found))
    }

    /// Explains why the contributions of the checked batch do not fit.
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
    RenderError::NonFinite(NonFinite { step, kind, wavelength_nm, infinite })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ray of the previous batch ended without a valid place. Its successor has no position yet when wavelengths are drawn, no direction
    /// yet when it is placed on the source, and both when it reaches the lens.
    #[test]
    fn what_a_ray_of_the_batch_before_left_is_nobodys_fault() {
        let mut rays = RayBatch::new(2);
        rays.restart(2);
        let c = rays.columns_mut();
        (c.x[1], c.l[1]) = (f64::NAN, f64::NAN);
        let mut blame = FiniteCheck::default();
        blame.look(Step::Wavelengths, &rays);
        rays.columns_mut().x[1] = 1.0;
        blame.look(Step::Source, &rays);
        assert_eq!(blame.found, None);
        let mut slip = FiniteCheck::default();
        slip.look(Step::Wavelengths, &rays);
        slip.look(Step::Lens, &rays);
        assert_eq!(slip.found.map(|(step, ..)| step), Some(Step::Lens));
        rays.columns_mut().l[1] = 0.0;
        blame.look(Step::Pupil, &rays);
        rays.columns_mut().x[1] = f64::INFINITY;
        blame.look(Step::Pupil, &rays);
        assert_eq!(blame.found.map(|(step, _, infinite)| (step, infinite)), Some((Step::Pupil, true)));
    }
}
