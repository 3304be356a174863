//! Development of pictures for the page: a small one at once, and a large one in the background.
//!
//! Large pictures are developed one at a time, beside the desk's thread, and dropped if more changes arrive meanwhile. The desk waits only
//! for the picture by which a change is first seen.

use super::work_state::{ExposedFilm, WorkState, has_stars};
use super::{PageSession, State, lock, priority};
use crate::page::{AspectRatio, PagePicture};
use crate::parts::{error_json, head, joined};
use serde_json::{Value, json};
use spectra_scene::{FilmTime, Scene};
use spectra_session::{Session, SessionError};
use std::sync::{Arc, PoisonError};
use std::time::Instant;

/// The role of a picture for the page.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum PictureRole {
    /// A draft, with fewer pixels than the whole picture.
    Draft,
    /// The first picture that shows a change.
    First,
    /// A later picture, which is dropped if something else changes.
    Later,
}

/// Light of a scene that is to be developed, with the head of its picture.
pub(super) struct DevelopJob {
    scene: Arc<Scene>,
    plate: Arc<ExposedFilm>,
    times: Vec<FilmTime>,
    head: Value,
    shape: AspectRatio,
    started: Instant,
    kind: PictureRole,
    /// Number of changes that the picture includes.
    turns: u64,
}

impl DevelopJob {
    /// Lists in the head what a draft leaves out and the picture of its session will have: ghosts and stars.
    pub(super) fn leaves_out(&mut self, session: &Session) {
        let scene = session.scene();
        let has_lights = || scene.source.split().is_some();
        let has_ghosts = scene.render.reflections.order.map_or_else(has_lights, |order| order > 0);
        let all = [(has_ghosts, "ghosts"), (has_stars(session), "stars")];
        self.head["left_out"] = all.iter().filter(|(has, _)| *has).map(|(_, name)| *name).collect();
    }
}

impl PageSession {
    /// Develops the light so far and gives the picture to the page. If `quick`, a small picture comes before a large one.
    pub(super) fn picture(self: &Arc<Self>, work: &mut WorkState, quick: bool) -> Result<(), SessionError> {
        let of = |work: &WorkState, plate, kind| {
            let mut taken = self.taken(&work.session, &work.shape, work.clock.started, plate, kind);
            if work.is_without_stars() {
                taken.head["left_out"] = json!(["stars"]);
            }
            taken
        };
        if quick {
            let small = match &work.small {
                Some(small) => Some(Arc::clone(small)),
                None => work.look()?.small().map(Arc::new),
            };
            work.small.clone_from(&small);
            match small {
                // If the small picture cannot be developed, the whole one follows anyway.
                Some(small) => drop(self.show(&of(work, small, PictureRole::Draft))),
                None => {
                    let whole = work.look()?;
                    return self.show(&of(work, whole, PictureRole::First));
                }
            }
        }
        let whole = work.look()?;
        // For a first look, half as many rays are good enough. The small light, with its negatives, is kept until there are twice as many
        // rays, or all samples.
        let is_whole = work.session.is_complete();
        let is_better = |rays: u64| whole.rays >= 2 * rays || (is_whole && whole.rays > rays);
        if !quick && work.small.as_ref().is_none_or(|small| is_better(small.rays)) {
            work.small = whole.small().map(Arc::new);
        }
        // Large pictures are developed one after the other, in the background, so that changes need not wait for them.
        if self.is_developed() {
            self.show_beside(of(work, whole, PictureRole::Later))?;
            self.is_developed();
        }
        Ok(())
    }

    /// Waits until no picture is being developed in the background; returns `false` if something changed before.
    fn is_developed(&self) -> bool {
        let goes_on = |state: &mut State| state.is_developing && state.pending.is_empty() && !state.is_closed;
        let waited = self.turned.wait_while(lock(&self.state), goes_on);
        !waited.unwrap_or_else(PoisonError::into_inner).is_developing
    }

    /// Develops and shows a picture in the background, or on this thread if the system has no more threads.
    fn show_beside(self: &Arc<Self>, taken: DevelopJob) -> Result<(), SessionError> {
        let Some(pool) = priority::pool(self.order.threads) else {
            return self.show(&taken);
        };
        lock(&self.state).is_developing = true;
        let own = Arc::clone(self);
        pool.spawn(move || {
            // Dropping this marks the end, also after a panic.
            let ended = Ended(Arc::clone(&own));
            if let Err(error) = own.show(&taken) {
                own.tell(Some(error_json(&error, "")));
            }
            drop(ended);
        });
        Ok(())
    }

    pub(super) fn taken(
        &self,
        session: &Session,
        shape: &AspectRatio,
        started: Instant,
        plate: Arc<ExposedFilm>,
        kind: PictureRole,
    ) -> DevelopJob {
        let scene = Arc::clone(session.scene());
        let times = scene.film_times(&plate.exposure);
        let mut head = head(session, &times, plate.rays);
        if session.series().is_without_lens() {
            // No samples are traced, so the picture is complete.
            (head["samples"], head["of"], head["flat"]) = (1.into(), 1.into(), true.into());
        } else if kind == PictureRole::Draft {
            head["samples"] = 0.into();
        }
        let turns = lock(&self.state).turns_taken;
        DevelopJob { scene, plate, times, head, shape: *shape, started, kind, turns }
    }

    /// Develops light and gives the picture to the page, unless it is outdated by then.
    pub(super) fn show(&self, taken: &DevelopJob) -> Result<(), SessionError> {
        let DevelopJob { scene, plate, times, kind, .. } = taken;
        let exposure = Arc::clone(&plate.exposure);
        let developed = PagePicture::develop(scene, exposure, times.clone(), &plate.negatives, self.order.isa)?;
        let Some(picture) = developed else { return Ok(()) };
        let [width_px, height_px] = picture.size_px();
        let is_draft = *kind == PictureRole::Draft;
        let is_late = |state: &State| {
            state.turns_taken != taken.turns || (*kind == PictureRole::Later && !state.pending.is_empty())
        };
        let mut state = lock(&self.state);
        if is_late(&state) {
            return Ok(());
        }
        let own = json!({
            "reread": state.reread,
            "turns": taken.turns,
            "light": [width_px, height_px],
            "draft": is_draft,
            "since_change_ms": taken.started.elapsed().as_millis() as u64,
        });
        let whole_px = state.page.width_px;
        let whole_px = if is_draft { [whole_px, taken.shape.height_px(whole_px)] } else { [width_px, height_px] };
        let fault = state.said();
        state.page.show(picture, whole_px, joined(taken.head.clone(), own), fault.as_ref());
        self.turned.notify_all();
        Ok(())
    }
}

/// Marks the development in the background as finished when dropped.
struct Ended(Arc<PageSession>);

impl Drop for Ended {
    fn drop(&mut self) {
        lock(&self.0.state).is_developing = false;
        self.0.turned.notify_all();
    }
}
