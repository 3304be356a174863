//! Changes of the whole scene: they are applied, refused, taken back and undone.

use super::history::SavedState;
use super::priority::Until;
use super::work_state::{UnrenderedChange, WorkState};
use super::{PageSession, lock};
use crate::page::ChangeKind;
use crate::parts::error_json;
use spectra_session::{Control as Stop, SessionError, Threads};
use std::mem::take;
use std::sync::Arc;

impl PageSession {
    /// Applies the changes to the scene, and returns whether the light is still valid. `None` if another change stopped it; changes that
    /// are not applied then remain.
    pub(super) fn apply(&self, work: &mut WorkState) -> Option<bool> {
        let is_drafted = work.draft.is_some() && work.is_light_owed;
        // Without a draft to look at, somebody waits for this, so it is not stopped.
        let stop = if is_drafted { Arc::clone(&work.stop) } else { Arc::new(Stop::new()) };
        let workers = Until { threads: self.order.threads, stop: &stop };
        let mut is_light_kept = true;
        let time_s = work.session.scene().exposure_time_s();
        let is_developed_only = work.owed.iter().all(|owed| owed.turned.is_of_development());
        let before = SavedState { moment: work.session.snapshot(), changes: lock(&self.state).changes.clone() };
        let mut controls = Vec::new();
        for owed in take(&mut work.owed) {
            let (texts, control) = (owed.turned.what.texts(&work.shape), owed.turned.control.clone());
            let index = owed.turned.what.picture().unwrap_or(work.session.index());
            // A draft with this change has the focused lens, which the scene can take over.
            let draft = work.draft.as_ref().filter(|_| owed.turned.is_for_draft());
            let changed = work.session.change_unprepared(&texts, index, draft, &workers);
            match changed {
                Ok(kept) => {
                    is_light_kept &= kept.light;
                    if work.draft.is_some() && owed.turned.is_of_development() && !owed.is_drafted {
                        work.behind.extend(texts.iter().cloned());
                    }
                    lock(&self.state).refused.remove(&control);
                    if let ChangeKind::Width(width_px) = owed.turned.what {
                        work.width_px = width_px;
                    } else {
                        texts.iter().for_each(|text| self.remember(text));
                        controls.push(control);
                    }
                }
                Err(_) if stop.should_stop() => work.owed.push(owed),
                Err(error) => {
                    lock(&self.state).refused.insert(control.clone(), error_json(&error, &control));
                    // The draft may have the refused change.
                    work.draft = None;
                    work.is_light_owed |= is_drafted;
                }
            }
        }
        if !controls.is_empty() {
            work.history.push(before.clone(), &controls);
            let unproved = work.unproved.get_or_insert(UnrenderedChange { before, controls: Vec::new() });
            unproved.controls.extend(controls);
        }
        if !is_light_kept {
            work.pace_s = None;
        }
        // The exposure follows from the light, unless something that is applied to the sum of the light has changed.
        if !is_light_kept || !is_developed_only || work.session.scene().exposure_time_s() != time_s {
            (work.light, work.small) = (None, None);
        }
        if !work.owed.is_empty() {
            work.is_light_owed |= !is_light_kept;
            return None;
        }
        work.is_light_owed = false;
        lock(&self.state).undos = work.history.len();
        self.adopt(&work.session, is_drafted);
        self.tell(None);
        Some(is_light_kept)
    }

    /// Records a change, a text `path=value`, for saving it to the scene's file.
    fn remember(&self, text: &str) {
        let path = text.split_once('=').map_or(text, |(path, _)| path);
        let mut state = lock(&self.state);
        state.changes.retain(|(other, _)| other != path);
        state.changes.push((path.to_owned(), text.to_owned()));
    }

    /// Takes back changes of which no picture can be made: they are refused, and the scene is restored. If nothing was changed, the
    /// error is that of the scene itself.
    pub(super) fn take_back(&self, work: &mut WorkState, error: &SessionError) {
        let Some(UnrenderedChange { before, controls }) = work.unproved.take() else {
            return self.tell(Some(error_json(error, "")));
        };
        work.session.restore(&before.moment);
        work.history.pop();
        self.at_another(work, &mut false);
        let mut state = lock(&self.state);
        state.changes = before.changes;
        state.undos = work.history.len();
        for control in controls {
            state.refused.insert(control.clone(), error_json(error, &control));
        }
        drop(state);
        self.adopt(&work.session, false);
        self.tell(None);
    }

    /// Undoes steps; changes that are not applied yet count as the last step. Returns whether the light is still valid.
    pub(super) fn go_back(&self, work: &mut WorkState, steps: usize) -> bool {
        let steps = steps - usize::from(!work.owed.is_empty());
        let mut is_light_kept = work.session.has_light() && work.unproved.is_none();
        work.owed.clear();
        for _ in 0..steps {
            let Some(before) = work.history.pop() else { break };
            is_light_kept &= work.session.restore(&before.moment).light;
            lock(&self.state).changes = before.changes;
        }
        self.at_another(work, &mut is_light_kept);
        let mut state = lock(&self.state);
        state.refused.clear();
        state.fault = None;
        state.undos = work.history.len();
        drop(state);
        self.adopt(&work.session, false);
        self.tell(None);
        is_light_kept
    }

    /// Continues from another state of the session, at the chosen width. Sets `is_light_kept` to false if the width had to change.
    fn at_another(&self, work: &mut WorkState, is_light_kept: &mut bool) {
        if work.session.scene().imager.size().width_px != work.width_px {
            // The session had another width then. If the chosen width cannot be set, the old width remains.
            let resolution = work.shape.resolution(work.width_px);
            let _ =
                work.session.change_unprepared(&[resolution], work.session.index(), None, &Threads(self.order.threads));
            *is_light_kept = false;
        }
        work.unproved = None;
        work.draft = None;
        work.behind.clear();
        (work.light, work.small) = (None, None);
        if !*is_light_kept {
            work.pace_s = None;
        }
        work.is_light_owed = !*is_light_kept;
    }
}
