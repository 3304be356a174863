//! The draft of the scene: a small picture with few samples, which shows a change first.

use super::PageSession;
use super::show::PictureRole;
use super::work_state::{ExposedFilm, WorkState};
use crate::page::ChangeKind;
use spectra_session::{Control as Stop, Effort, SessionOptions, Threads};
use std::mem::take;
use std::sync::Arc;

impl PageSession {
    /// Makes and shows a draft of the scene with all changes. Returns whether the page has it; there is none if the light is still valid,
    /// because the whole picture is then developed as quickly.
    pub(super) fn make_draft(&self, work: &mut WorkState) -> bool {
        let mut same_light = work.draft.is_some() && work.session.has_light();
        if same_light && !work.is_light_owed && work.owed.iter().all(|owed| owed.turned.is_of_development()) {
            // The draft gets the change when it is needed next.
            return false;
        }
        match self.turn_draft(work) {
            Some(is_light_kept) => same_light &= is_light_kept,
            None => return work.without_draft(),
        }
        // A photograph's own pixels are developed as quickly as a draft.
        if work.draft.as_ref().is_some_and(|draft| draft.series().is_without_lens()) {
            work.draft = None;
        }
        work.owed.iter_mut().for_each(|owed| owed.is_drafted = true);
        work.is_light_owed |= !same_light;
        let is_for_whole = matches!(&work.owed[..], [only] if !only.turned.is_for_draft());
        !is_for_whole && work.is_light_owed && self.show_draft(work)
    }

    /// Applies the changes to the draft, or makes one that has them. Returns whether the light of the draft is still valid; `None` if it
    /// cannot have the changes.
    fn turn_draft(&self, work: &mut WorkState) -> Option<bool> {
        let index = work.index_owed();
        let Some(draft) = &mut work.draft else {
            work.behind.clear();
            let mut texts: Vec<String> =
                work.owed.iter().flat_map(|owed| owed.turned.what.texts(&work.shape)).collect();
            texts.extend(work.draft_texts());
            // Faults are reported when the whole scene is changed.
            let options = SessionOptions { picture: index, effort: Effort::Draft, ..work.session.options() };
            work.draft = work.session.branch(&texts, options).ok();
            return Some(false);
        };
        let mut texts = take(&mut work.behind);
        for owed in work.owed.iter().filter(|owed| !owed.is_drafted && owed.turned.is_for_draft()) {
            if let ChangeKind::Set(own) = &owed.turned.what {
                texts.extend_from_slice(own);
            }
        }
        draft.change_unprepared(&texts, index, None, &Threads(self.order.threads)).ok().map(|kept| kept.light)
    }

    /// Traces the draft and gives its picture to the page. Returns whether the page has it; the draft is dropped if it has no picture.
    fn show_draft(&self, work: &mut WorkState) -> bool {
        let Some(draft) = &mut work.draft else { return false };
        self.draw(draft, false);
        let all = u64::from(draft.scene().render.samples);
        let traced = draft.advance(all, &Threads(self.order.threads), &Stop::new());
        let seen = match traced {
            Ok(()) if draft.samples() > 0 => draft.rendering(),
            _ => return work.without_draft(),
        };
        let shown = seen.and_then(|seen| {
            let light = Arc::new(ExposedFilm::of(seen));
            let mut taken = self.taken(draft, &work.shape, work.clock.started, light, PictureRole::Draft);
            taken.leaves_out(&work.session);
            self.show(&taken)
        });
        shown.is_ok() || work.without_draft()
    }
}
