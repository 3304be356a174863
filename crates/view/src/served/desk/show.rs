//! Develops light and gives the picture to the page: a small one at once, and a large one beside whatever is turned next.

use super::hand::{Hand, Plate, Shape, has_stars};
use super::{Desk, Frame, State, held, priority};
use crate::parts::{halves, head, packed, said};
use serde_json::{Value, json};
use spectra_core::frame::DisplayPicture;
use spectra_scene::{FilmTime, Scene, Shot};
use spectra_session::{Session, SessionError};
use std::sync::{Arc, PoisonError};
use std::time::Instant;

/// What a picture is to the page.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Fewer pixels than the picture will have.
    Draft,
    /// What was turned is first seen by it.
    First,
    /// Once more is turned, nobody waits for it.
    Later,
}

/// Light that was taken, of a scene, and what is said of it.
pub(super) struct Taken {
    scene: Arc<Scene>,
    plate: Arc<Plate>,
    times: Vec<FilmTime>,
    head: Value,
    shape: Shape,
    started: Instant,
    kind: Kind,
    /// Values that were turned before it.
    turns: u64,
}

impl Taken {
    /// Says what a draft leaves out that the picture of its session will have.
    pub(super) fn leaves_out(&mut self, session: &Session) {
        let scene = session.scene();
        let has_lights = || scene.source.split().is_some();
        let has_ghosts = scene.render.reflections.order.map_or_else(has_lights, |order| order > 0);
        let all = [(has_ghosts, "ghosts"), (has_stars(session), "stars")];
        self.head["left_out"] = all.iter().filter(|(has, _)| *has).map(|(_, name)| *name).collect();
    }
}

impl Desk {
    /// Develops the light so far and gives it to the page. If it is to be `quick`, a small picture comes before a large one.
    pub(super) fn picture(
        self: &Arc<Self>,
        hand: &mut Hand,
        started: Instant,
        quick: bool,
    ) -> Result<(), SessionError> {
        let of = |hand: &Hand, plate, kind| {
            let mut taken = self.taken(&hand.session, &hand.shape, started, plate, kind);
            if hand.is_without_stars() {
                taken.head["left_out"] = json!(["stars"]);
            }
            taken
        };
        if quick {
            let small = match &hand.small {
                Some(small) => Some(Arc::clone(small)),
                None => hand.look()?.small().map(Arc::new),
            };
            hand.small.clone_from(&small);
            match small {
                // What cannot be developed small is seen whole.
                Some(small) => drop(self.show(&of(hand, small, Kind::Draft))),
                None => {
                    let whole = hand.look()?;
                    return self.show(&of(hand, whole, Kind::First));
                }
            }
        }
        let whole = hand.look()?;
        // Half as many rays are as good for a first look, and what was developed of them is kept, until all are there.
        let is_whole = hand.session.samples() >= u64::from(hand.session.scene().render.samples);
        let is_better = |rays: u64| whole.rays >= 2 * rays || (is_whole && whole.rays > rays);
        if !quick && hand.small.as_ref().is_none_or(|small| is_better(small.rays)) {
            hand.small = whole.small().map(Arc::new);
        }
        // One after the other; and for none of them does anybody wait who turns something.
        if self.is_developed() {
            self.show_beside(of(hand, whole, Kind::Later))?;
            self.is_developed();
        }
        Ok(())
    }

    /// Waits until no picture is being developed beside this thread; `false` where more was turned meanwhile.
    fn is_developed(&self) -> bool {
        let goes_on = |state: &mut State| state.is_developing && state.pending.is_empty() && !state.is_closed;
        let waited = self.turned.wait_while(held(&self.state), goes_on);
        !waited.unwrap_or_else(PoisonError::into_inner).is_developing
    }

    /// Shows it from a thread of its own, or from this one where the system has no more.
    fn show_beside(self: &Arc<Self>, taken: Taken) -> Result<(), SessionError> {
        let Some(pool) = priority::pool(self.order.threads) else {
            return self.show(&taken);
        };
        held(&self.state).is_developing = true;
        let own = Arc::clone(self);
        pool.spawn(move || {
            // A panic, too, ends it.
            let ended = Ended(Arc::clone(&own));
            if let Err(error) = own.show(&taken) {
                own.tell(Some(said(&error, "")));
            }
            drop(ended);
        });
        Ok(())
    }

    pub(super) fn taken(
        &self,
        session: &Session,
        shape: &Shape,
        started: Instant,
        plate: Arc<Plate>,
        kind: Kind,
    ) -> Taken {
        let scene = Arc::clone(session.scene());
        let times = scene.film_times(&plate.exposure);
        let mut head = head(json!({}), session, &times, plate.rays);
        if session.series().is_without_lens() {
            // No sample is traced: all of it is there.
            (head["samples"], head["of"], head["flat"]) = (1.into(), 1.into(), true.into());
        } else if kind == Kind::Draft {
            head["samples"] = 0.into();
        }
        let turns = held(&self.state).turns_taken;
        Taken { scene, plate, times, head, shape: *shape, started, kind, turns }
    }

    /// Develops it, and gives it to the page unless that is of no use any more.
    pub(super) fn show(&self, taken: &Taken) -> Result<(), SessionError> {
        let Taken { scene, plate, times, kind, .. } = taken;
        let shot = Shot::new(scene, &plate.exposure, times, &[], self.order.isa).keeping(&plate.negatives);
        let Some((_, picture)) = shot.pictures().map_err(SessionError::Failed)?.first() else { return Ok(()) };
        let DisplayPicture { width_px, height_px, rgb } = picture;
        let [width_px, height_px] = [*width_px, *height_px];
        let is_draft = *kind == Kind::Draft;
        let is_late =
            |state: &State| state.turns_taken != taken.turns || (*kind == Kind::Later && !state.pending.is_empty());
        let light = halves(bytemuck::cast_slice(rgb));
        let mut state = held(&self.state);
        if is_late(&state) {
            return Ok(());
        }
        state.number += 1;
        let whole_px = if is_draft { state.width_px } else { width_px };
        let own = json!({
            "frame": state.number,
            "scene": state.scenes,
            "lens_drawn": state.lenses,
            "reread": state.reread,
            "turns": taken.turns,
            "fault": state.said(),
            "width": whole_px,
            "height": if is_draft { taken.shape.height_px(whole_px) } else { height_px },
            "light": [width_px, height_px],
            "draft": is_draft,
            "since_change_ms": taken.started.elapsed().as_millis() as u64,
        });
        let mut head = taken.head.clone();
        if let (Value::Object(head), Value::Object(own)) = (&mut head, own) {
            head.extend(own);
        }
        let (exposure, times) = (Arc::clone(&plate.exposure), times.clone());
        let (number, bytes) = (state.number, packed(&head, &light));
        state.frame = Some(Arc::new(Frame { number, bytes, exposure, times, whole_px }));
        self.turned.notify_all();
        Ok(())
    }
}

/// Says that the picture beside is developed, when it goes.
struct Ended(Arc<Desk>);

impl Drop for Ended {
    fn drop(&mut self) {
        held(&self.0.state).is_developing = false;
        self.0.turned.notify_all();
    }
}
