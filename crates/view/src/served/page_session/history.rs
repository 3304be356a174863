//! Earlier states of the scene, for undo.

use spectra_session::Snapshot;
use std::time::{Duration, Instant};

/// Largest number of steps that are kept; each holds the stages of a scene.
const STEPS: usize = 40;
/// Changes of one control within this time are one step, because a slider passes through many values.
const ONE_STEP: Duration = Duration::from_millis(1500);

/// An earlier state of the scene, and the changes that the page had made up to it.
#[derive(Clone)]
pub(super) struct SavedState {
    pub(super) moment: Snapshot,
    pub(super) changes: Vec<(String, String)>,
}

struct Step {
    before: SavedState,
    /// Controls that were changed from that state.
    controls: Vec<String>,
    /// Time of the last change of these controls.
    turned: Instant,
}

/// The steps that can be undone.
#[derive(Default)]
pub(super) struct History(Vec<Step>);

impl History {
    /// Adds a step: the state `before` these controls were changed.
    pub(super) fn push(&mut self, before: SavedState, controls: &[String]) {
        if let Some(last) = self.0.last_mut()
            && last.controls == controls
            && last.turned.elapsed() < ONE_STEP
        {
            last.turned = Instant::now();
            return;
        }
        if self.0.len() >= STEPS {
            self.0.remove(0);
        }
        self.0.push(Step { before, controls: controls.to_owned(), turned: Instant::now() });
    }

    /// Removes the last step and returns its state.
    pub(super) fn pop(&mut self) -> Option<SavedState> {
        self.0.pop().map(|step| step.before)
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}
