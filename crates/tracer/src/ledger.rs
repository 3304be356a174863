//! The ledger of a path: where its light went, as a weight for each step and cause.
//!
//! On request it books what leaves a path at each step: light lost at rims, by absorption, and the part that continues on another path.
//! `crates/optics/tests/it/paths.rs` compares all paths with two reflections of a lens with the light that was launched.

use spectra_core::batch::Column;
use spectra_core::loss::ALIVE;
use spectra_core::{Loss, RayBatch};

/// The losses of the light of a path at one of its steps, in the unit of the rays' weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepLedger {
    /// Light that did not hit the surface at all.
    pub missed: f64,
    /// Light that hit the surface outside its clear aperture, such as the rim or the stop.
    pub vignetted: f64,
    /// Light absorbed by the glass in front of the surface, by a mirror, or by the surface itself.
    pub absorbed: f64,
    /// Light scattered by layers on the surface, which is traced as another kind of light.
    pub scattered: f64,
    /// Light that continued on another path: reflected where this path refracts (totally or in part), transmitted where it reflects.
    pub elsewhere: f64,
}

impl StepLedger {
    /// Returns all light that left the path at this step.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.missed + self.vignetted + self.absorbed + self.scattered + self.elsewhere
    }
}

/// The account of the light of one path: `launched = arrived + sum of the steps' totals`, up to rounding.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Weight of the rays that entered the lens.
    pub launched: f64,
    /// Weight of the rays that left the lens at the end of the path.
    pub arrived: f64,
    /// One entry per step of the path.
    pub steps: Vec<StepLedger>,
}

impl Ledger {
    /// Returns the light lost from step `step` on. Losses from the last reflection of a path on belong to no shorter path.
    #[must_use]
    pub fn lost_from(&self, step: usize) -> StepLedger {
        self.steps[step..].iter().fold(StepLedger::default(), |sum, s| StepLedger {
            missed: sum.missed + s.missed,
            vignetted: sum.vignetted + s.vignetted,
            absorbed: sum.absorbed + s.absorbed,
            scattered: sum.scattered + s.scattered,
            elsewhere: sum.elsewhere + s.elsewhere,
        })
    }
}

/// The weights and states of a batch when they were last recorded in the ledger.
#[derive(Debug)]
pub(crate) struct Booked {
    weight: Column<f64>,
    state: Column<u64>,
}

impl Booked {
    pub(crate) fn new(capacity: usize) -> Self {
        Self { weight: Column::new(capacity), state: Column::new(capacity) }
    }

    /// Records the batch as it is.
    pub(crate) fn note(&mut self, rays: &RayBatch) {
        self.weight.slice_mut(rays.len()).copy_from_slice(rays.weights());
        self.state.slice_mut(rays.len()).copy_from_slice(rays.states());
    }

    /// Books the rays that ended since the last record, and adds the losses of the others to the field that `taken` selects.
    pub(crate) fn settle(
        &mut self,
        rays: &RayBatch,
        step: &mut StepLedger,
        taken: impl Fn(&mut StepLedger) -> &mut f64,
    ) {
        let len = rays.len();
        let (weight, state) = (self.weight.slice_mut(len), self.state.slice_mut(len));
        for i in 0..len {
            if state[i] != ALIVE {
                continue;
            }
            let (now, left) = (rays.states()[i], rays.weights()[i]);
            *taken(step) += weight[i] - left;
            weight[i] = left;
            if let Some((cause, _)) = Loss::of_state(now) {
                state[i] = now;
                *match cause {
                    Loss::Missed | Loss::OutOfFrame => &mut step.missed,
                    Loss::Vignetted => &mut step.vignetted,
                    Loss::TotalReflection => &mut step.elsewhere,
                    _ => &mut step.absorbed,
                } += left;
            }
        }
    }
}

/// Returns the total weight of the live rays of a batch.
pub(crate) fn living(rays: &RayBatch) -> f64 {
    rays.states().iter().zip(rays.weights()).filter(|(state, _)| **state == ALIVE).map(|(_, weight)| weight).sum()
}
