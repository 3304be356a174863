//! How the scene was set before, to go back to.

use spectra_session::Moment;
use std::time::{Duration, Instant};

/// So many steps are kept: each holds the stages of a scene.
const STEPS: usize = 40;
/// What one control is turned through within this time is one step: a slider goes through many values.
const ONE_STEP: Duration = Duration::from_millis(1500);

/// A scene as it was set, and what the page had set of it.
#[derive(Clone)]
pub(super) struct Before {
    pub(super) moment: Moment,
    pub(super) changes: Vec<(String, String)>,
}

struct Step {
    before: Before,
    /// What was turned from there.
    controls: Vec<String>,
    /// When that was turned last.
    turned: Instant,
}

/// The steps so far.
#[derive(Default)]
pub(super) struct History(Vec<Step>);

impl History {
    /// Keeps a step: what was `before` these controls were turned.
    pub(super) fn push(&mut self, before: Before, controls: &[String]) {
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

    /// The last step, which is taken away.
    pub(super) fn pop(&mut self) -> Option<Before> {
        self.0.pop().map(|step| step.before)
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }
}
