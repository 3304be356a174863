//! Loading of a scene again whose files somebody wrote.

use super::work_state::WorkState;
use super::{PageSession, lock};
use crate::page::AspectRatio;
use crate::parts::error_json;
use crate::served::save;
use std::path::Path;

/// Largest size of a scene's file, bytes; a larger file is ignored.
const MAX_SCENE_BYTES: u64 = 1 << 22;

impl PageSession {
    /// Loads the scene again if somebody wrote its file, or one that it names, since. Returns whether there is another scene now. If a
    /// file is broken, the page is told, and everything stays as it is.
    pub(super) fn is_written_anew(&self, work: &mut WorkState) -> bool {
        let mut written = lock(&self.written);
        let now = match &*written {
            None => None,
            Some(_) => {
                let is_small = std::fs::metadata(&self.order.scene).is_ok_and(|found| found.len() <= MAX_SCENE_BYTES);
                // A file that is just being replaced will be there next time.
                let Some(now) = is_small.then(|| std::fs::read_to_string(&self.order.scene).ok()).flatten() else {
                    return false;
                };
                Some(now)
            }
        };
        let others = work.stamps.now(&work.session, self.order.file().unwrap_or(Path::new("")));
        if now == *written && !others.differ(&work.stamps) {
            work.stamps.learn(&others);
            if work.refused.take().is_some() {
                self.tell(None);
            }
            return false;
        }
        if work.refused.as_ref().is_some_and(|refused| refused.0 == now && !others.differ(&refused.1)) {
            return false;
        }
        // Changes of the page stay, except values that the file itself has changed.
        let mut changes = lock(&self.state).changes.clone();
        if let (Some(before), Some(now)) = (&*written, &now) {
            changes.retain(|(path, _)| save::says_same(before, now, path));
        }
        let opened = self.order.session().and_then(|session| {
            let shape = AspectRatio::of(&session);
            let mut texts: Vec<String> = changes.iter().map(|(_, text)| text.clone()).collect();
            texts.push(shape.resolution(work.width_px));
            session.branch(&texts, session.options()).map(|session| (session, shape))
        });
        match opened {
            Ok((session, shape)) => {
                *written = now;
                drop(written);
                work.take_up(session, shape);
                let mut state = lock(&self.state);
                state.changes = changes;
                state.refused.clear();
                state.undos = 0;
                state.reread += 1;
                drop(state);
                self.tell(None);
                self.adopt(&work.session, false);
                true
            }
            Err(error) => {
                drop(written);
                work.refused = Some((now, others));
                self.tell(Some(error_json(&error, "")));
                false
            }
        }
    }
}
