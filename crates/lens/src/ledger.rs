//! Where the light of a path went: a weight for each step and cause.

use spectra_core::batch::Column;
use spectra_core::loss::ALIVE;
use spectra_core::{Loss, RayBatch};

/// What happened to the light of a path at one of its steps, in the unit of the rays' weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepLedger {
    /// Did not hit the surface.
    pub missed: f64,
    /// Hit it outside its clear aperture: the rim, the stop.
    pub vignetted: f64,
    /// Absorbed by the glass on the way there, by a mirror, or by the surface itself.
    pub absorbed: f64,
    /// Scattered by what lies on the surface: light of another kind.
    pub scattered: f64,
    /// Went on by another path: reflected where this one refracts (totally or in part), transmitted where this one reflects.
    pub elsewhere: f64,
}

impl StepLedger {
    /// All that left the path at this step.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.missed + self.vignetted + self.absorbed + self.scattered + self.elsewhere
    }
}

/// Where the light of one path went. `launched = arrived + sum of the steps' totals`, up to rounding.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Weight of the rays that entered the lens.
    pub launched: f64,
    /// Weight of the rays that left it at the path's end.
    pub arrived: f64,
    /// One entry per step of the path.
    pub steps: Vec<StepLedger>,
}

impl Ledger {
    /// What was lost from this step on: of a path by reflections, that from its last reflection on belongs to no shorter one.
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

/// Weights and states of a batch as they were booked last.
#[derive(Debug)]
pub(crate) struct Booked {
    weight: Column<f64>,
    state: Column<u64>,
}

impl Booked {
    pub(crate) fn new(capacity: usize) -> Self {
        Self { weight: Column::new(capacity), state: Column::new(capacity) }
    }

    /// Takes down the batch as it is.
    pub(crate) fn note(&mut self, rays: &RayBatch) {
        self.weight.slice_mut(rays.len()).copy_from_slice(rays.weights());
        self.state.slice_mut(rays.len()).copy_from_slice(rays.states());
    }

    /// Books the rays that ended since, and adds what the others lost to `taken`.
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

/// Weight of the living rays of a batch.
pub(crate) fn living(rays: &RayBatch) -> f64 {
    rays.states().iter().zip(rays.weights()).filter(|(state, _)| **state == ALIVE).map(|(_, weight)| weight).sum()
}
