//! What the page learns from the desk's thread: the controls of the scene, its lens, and its errors.

use super::{PageSession, lock};
use crate::page::SceneControls;
use crate::parts::packed;
use serde_json::{Value, json};
use spectra_session::Session;
use std::sync::Arc;

impl PageSession {
    /// Publishes the controls of the session's scene, which now have all accepted changes, and its lens if that was not drawn from the
    /// draft.
    pub(super) fn adopt(&self, session: &Session, is_lens_drawn: bool) {
        self.draw(session, is_lens_drawn);
        let controls = SceneControls::of(session);
        let mut state = lock(&self.state);
        state.turns_settled = state.turns_taken;
        state.page.adopt(session, controls);
        state.moment = Some(session.snapshot());
        self.turned.notify_all();
    }

    /// Publishes the session's scene, and marks its lens as changed unless `is_drawn` or it is the same one.
    pub(super) fn draw(&self, session: &Session, is_drawn: bool) {
        let mut state = lock(&self.state);
        if state.page.draw(session.scene(), is_drawn) {
            state.section = [None, None];
        }
    }

    /// Tells the page the scene's error, or that there is none any more, and which changes were refused.
    pub(super) fn tell(&self, fault: Option<Value>) {
        let mut state = lock(&self.state);
        let is_other = state.refused != state.refused_told || state.turns_settled != state.turns_told;
        let is_new = fault.is_some() || state.fault.is_some() || is_other;
        state.fault = fault;
        state.refused_told = state.refused.clone();
        state.turns_told = state.turns_settled;
        if is_new {
            // The page learns of it without waiting for a picture.
            state.page.number += 1;
            let head = json!({"frame": state.page.number, "scene": state.page.scenes, "fault": state.said()});
            state.note = Some((state.page.number, Arc::new(packed(&head, &[]))));
        }
        self.turned.notify_all();
    }
}
