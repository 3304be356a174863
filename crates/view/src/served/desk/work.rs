//! What the thread of a desk does: take up what was turned, trace, develop, and watch the scene's file.

use super::super::{memory, save};
use super::hand::{Drafted, Hand, Owed, Plate, Shape};
use super::show::Kind;
use super::watch::Stamps;
use super::{Desk, Frame, State, WIDTHS_PX, held, priority};
use crate::controls;
use crate::parts::{packed, said};
use serde_json::{Value, json};
use spectra_core::frame::ExposureFrame;
use spectra_scene::NumberFamily;
use spectra_session::{Control as Stop, Session, Threads, Workers};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// A page that asks nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(25);
/// Light is traced in pieces of at least about this time, and of this part of the time since the change, at most so long: the picture
/// is seen to grow, and little of the time goes into developing it.
const PIECE_S: f64 = 0.12;
const PIECE_PART: f64 = 0.5;
const LONGEST_PIECE_S: f64 = 1.0;
/// What a draft has of its own.
const NOT_DRAFTED: [&str; 6] =
    ["width", "render.samples", "render.rays", "render.noise", "render.reflections.order", "render.diffraction"];
/// What chooses another film, and so other light; all else of a film mostly leaves the light as it is.
const CHOOSES_FILM: [&str; 2] = ["stock", "kind"];
/// After a draft the whole picture is begun when nothing was turned for so long.
const REST: Duration = Duration::from_millis(60);
/// The scene's file is looked at so often.
const GLANCE: Duration = Duration::from_millis(300);
/// Memory that nobody used for so long is given back.
const TIDY: Duration = Duration::from_secs(1);
/// A scene's file that is larger than this is none.
const MAX_SCENE_BYTES: u64 = 1 << 22;

/// Threads whose work nobody waits for once something more is turned. They give way to the page.
struct Until<'a> {
    threads: usize,
    stop: &'a Stop,
}

impl Workers for Until<'_> {
    fn each(&self, work: &(dyn Fn() + Sync)) {
        priority::each(self.threads, work);
    }

    fn should_stop(&self) -> bool {
        self.stop.should_stop()
    }
}

impl Desk {
    pub(super) fn work(self: &Arc<Self>) {
        // Before there is much to do: later pictures are developed by it.
        priority::pool(self.order.threads);
        let mut session = match Session::open(&self.order.scene, &self.order.overrides, self.order.isa) {
            Ok(session) => session,
            Err(error) => {
                self.tell(Some(said(&error, "")));
                return self.close();
            }
        };
        let shape = Shape::of(&session);
        self.adopt(&session, false);
        if let Err(error) = session.change(&shape.resolution(WIDTHS_PX[1])) {
            self.tell(Some(said(&error, "imager.resolution")));
        }
        self.adopt(&session, true);
        let mut hand = Hand {
            session,
            draft: None,
            shape,
            width_px: WIDTHS_PX[1],
            owed: Vec::new(),
            behind: Vec::new(),
            is_light_owed: true,
            light: None,
            small: None,
            pace_s: None,
            stamps: Stamps::default(),
            refused: None,
        };
        let mut started = Instant::now();
        // The first picture of all is a draft, too.
        let mut is_asked_for_draft = true;
        let mut looked = Instant::now();
        // When there was work to do last, until its memory is given back.
        let mut worked = None;
        loop {
            let (pending, stop) = {
                let all = u64::from(hand.session.scene().render.samples);
                let is_done = hand.session.samples() >= all && hand.owed.is_empty() && !is_asked_for_draft;
                let is_idle = |state: &mut State| {
                    !state.is_closed && state.pending.is_empty() && (is_done || state.fault.is_some())
                };
                let waited = self.turned.wait_timeout_while(held(&self.state), GLANCE, is_idle);
                let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
                if held(&self.seen).elapsed() > PATIENCE {
                    state.is_closed = true;
                    self.turned.notify_all();
                }
                if state.is_closed {
                    break;
                }
                if !is_done || !state.pending.is_empty() {
                    worked = Some(Instant::now());
                }
                state.stop = Arc::new(Stop::new());
                state.turns_taken = state.turns;
                (std::mem::take(&mut state.pending), Arc::clone(&state.stop))
            };
            if worked.is_some_and(|worked| worked.elapsed() >= TIDY) {
                worked = None;
                memory::give_back();
            }
            if pending.is_empty() && looked.elapsed() >= GLANCE {
                looked = Instant::now();
                if self.is_written_anew(&mut hand) {
                    started = Instant::now();
                    is_asked_for_draft = true;
                }
            }
            if !pending.is_empty() {
                started = Instant::now();
                hand.owe(pending);
                is_asked_for_draft = true;
            }
            if std::mem::take(&mut is_asked_for_draft) {
                match self.drafted(&mut hand, started) {
                    Drafted::Shown => {
                        // While somebody drags, drafts alone follow: the whole is begun once the hand rests.
                        let rests = |state: &mut State| state.pending.is_empty() && !state.is_closed;
                        let waited = self.turned.wait_timeout_while(held(&self.state), REST, rests);
                        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
                        if !state.pending.is_empty() {
                            continue;
                        }
                    }
                    Drafted::SameLight | Drafted::None => {}
                }
            }
            if hand.owed.is_empty() {
                hand.is_light_owed = false;
            } else {
                let Some(is_light_kept) = self.settle(&mut hand, &stop) else { continue };
                if !is_light_kept && !hand.behind.is_empty() {
                    // What was taken for development alone is not.
                    is_asked_for_draft = true;
                    continue;
                }
                if is_light_kept && hand.session.has_light() {
                    if let Err(error) = self.picture(&mut hand, started, true) {
                        self.tell(Some(said(&error, "")));
                    }
                    continue;
                }
            }
            let scene = Arc::clone(hand.session.scene());
            let (all, done) = (u64::from(scene.render.samples), hand.session.samples());
            if done >= all || held(&self.state).fault.is_some() {
                continue;
            }
            // Strata are laid out for all samples in one go.
            let more = match hand.pace_s {
                _ if scene.render.numbers == NumberFamily::Stratified => all,
                None => 1,
                Some(pace_s) => {
                    let piece_s = (PIECE_PART * started.elapsed().as_secs_f64()).clamp(PIECE_S, LONGEST_PIECE_S);
                    (piece_s / pace_s).floor().clamp(1.0, 4096.0) as u64
                }
            };
            let from = Instant::now();
            let more = more.min(all - done);
            hand.light = None;
            // To search what passes the whole scene's lens may take longer than a draft: that, too, ends where more is turned.
            let workers = Until { threads: self.order.threads, stop: &stop };
            if let Err(error) = hand.session.step(more, &workers, &stop) {
                self.tell(Some(said(&error, "")));
                continue;
            }
            // The first sample pays for what is made ready once.
            let took_s = from.elapsed().as_secs_f64().max(1e-6);
            if done == 0 {
                hand.pace_s = Some(took_s.min(PIECE_S));
            } else if !stop.should_stop() {
                hand.pace_s = Some(took_s / more as f64);
            }
            // What was stopped before a whole sample of every pixel is no picture; where more was turned, this one is late.
            if hand.session.samples() == 0 || stop.should_stop() {
                continue;
            }
            if let Err(error) = self.picture(&mut hand, started, false) {
                self.tell(Some(said(&error, "")));
            }
        }
    }

    /// Shows a small picture of few samples of the scene as it is to be.
    fn drafted(&self, hand: &mut Hand, started: Instant) -> Drafted {
        let workers = Threads(self.order.threads);
        let mut same_light = hand.draft.is_some() && hand.session.has_light();
        if same_light && !hand.is_light_owed && hand.owed.iter().all(|owed| is_of_development(&owed.path)) {
            // The draft takes it up when it is wanted.
            return Drafted::SameLight;
        }
        match &mut hand.draft {
            None => {
                hand.behind.clear();
                let mut texts: Vec<String> = hand.owed.iter().filter_map(|owed| hand.shape.text(owed)).collect();
                texts.extend(hand.shape.draft(&hand.session));
                // What cannot be is said of the whole scene.
                hand.draft = hand.session.draft(&texts).ok();
            }
            Some(draft) => {
                let fresh = |owed: &&Owed| !owed.is_drafted && !NOT_DRAFTED.contains(&&*owed.path);
                let behind = std::mem::take(&mut hand.behind);
                for text in behind.iter().chain(hand.owed.iter().filter(fresh).map(|owed| &owed.text)) {
                    match draft.change_on(text, &workers) {
                        Ok(kept) => same_light &= kept.light,
                        Err(_) => return hand.without_draft(),
                    }
                }
            }
        }
        hand.owed.iter_mut().for_each(|owed| owed.is_drafted = true);
        hand.is_light_owed |= !same_light;
        if hand.owed.iter().any(|owed| NOT_DRAFTED.contains(&&*owed.path)) && hand.owed.len() == 1 {
            return Drafted::None;
        }
        if !hand.is_light_owed {
            return Drafted::SameLight;
        }
        let Some(draft) = &mut hand.draft else { return Drafted::None };
        self.draw(draft, false);
        let all = u64::from(draft.scene().render.samples);
        let traced = draft.advance(all, &workers, &Stop::new());
        let seen = match traced {
            Ok(()) if draft.samples() > 0 => draft.look(),
            _ => return hand.without_draft(),
        };
        let shown = seen.and_then(|seen| {
            self.show(&self.taken(draft, &hand.shape, started, Arc::new(Plate::of(seen)), Kind::Draft))
        });
        if shown.is_err() {
            return hand.without_draft();
        }
        Drafted::Shown
    }

    /// Sets the scene as it is to be; says whether the light is the same. `None` where more was turned meanwhile: what is not set is
    /// owed still.
    fn settle(&self, hand: &mut Hand, stop: &Stop) -> Option<bool> {
        let is_drafted = hand.draft.is_some() && hand.is_light_owed;
        // Where there is no draft to look at, this is what is waited for.
        let never = Stop::new();
        let stop = if is_drafted { stop } else { &never };
        let workers = Until { threads: self.order.threads, stop };
        let (mut is_light_kept, mut trouble) = (true, None);
        let time_s = hand.session.scene().exposure_time_s();
        let is_developed_only = hand.owed.iter().all(|owed| is_of_development(&owed.path));
        for owed in std::mem::take(&mut hand.owed) {
            let Some(text) = hand.shape.text(&owed) else { continue };
            // Where a draft of it was made, the scene can be.
            let changed = match &hand.draft {
                Some(draft) if !NOT_DRAFTED.contains(&&*owed.path) => hand.session.change_after(&text, draft, &workers),
                _ => hand.session.change_on(&text, &Threads(self.order.threads)),
            };
            match changed {
                Ok(kept) => {
                    is_light_kept &= kept.light;
                    if hand.draft.is_some() && is_of_development(&owed.path) && !owed.is_drafted {
                        hand.behind.push(text.clone());
                    }
                    if owed.path == "width" {
                        hand.width_px = owed.text.parse().unwrap_or(hand.width_px);
                    } else {
                        self.remember(&owed.path, &text);
                    }
                }
                Err(_) if stop.should_stop() => hand.owed.push(owed),
                Err(error) => {
                    trouble = Some(said(&error, &owed.path));
                    // The draft may have taken it.
                    hand.draft = None;
                }
            }
        }
        if !is_light_kept {
            hand.pace_s = None;
        }
        // What the film got follows from the light, but for what is done to the sum of it.
        if !is_light_kept || !is_developed_only || hand.session.scene().exposure_time_s() != time_s {
            (hand.light, hand.small) = (None, None);
        }
        if !hand.owed.is_empty() {
            hand.is_light_owed |= !is_light_kept;
            return None;
        }
        hand.is_light_owed = false;
        self.tell(trouble);
        self.adopt(&hand.session, is_drafted);
        Some(is_light_kept)
    }

    /// Takes up the scene's file, or one that it names, where somebody wrote it since; says whether there is another scene now. A
    /// file that is broken is told, and all stays as it is.
    fn is_written_anew(&self, hand: &mut Hand) -> bool {
        let mut written = held(&self.written);
        let now = match &*written {
            None => None,
            Some(_) => {
                let is_small = std::fs::metadata(&self.order.scene).is_ok_and(|found| found.len() <= MAX_SCENE_BYTES);
                // A file that is just being replaced is there the next time.
                let Some(now) = is_small.then(|| std::fs::read_to_string(&self.order.scene).ok()).flatten() else {
                    return false;
                };
                Some(now)
            }
        };
        let others = hand.stamps.now(&hand.session, &self.order.scene);
        if now == *written && !others.differ(&hand.stamps) {
            hand.stamps.learn(&others);
            if hand.refused.take().is_some() {
                self.tell(None);
            }
            return false;
        }
        if hand.refused.as_ref().is_some_and(|refused| refused.0 == now && !others.differ(&refused.1)) {
            return false;
        }
        // What the page set stays, but for what the file now says otherwise.
        let mut changes = held(&self.state).changes.clone();
        if let (Some(before), Some(now)) = (&*written, &now) {
            changes.retain(|(path, _)| save::says_same(before, now, path));
        }
        let opened = Session::open(&self.order.scene, &self.order.overrides, self.order.isa).and_then(|session| {
            let shape = Shape::of(&session);
            let mut texts: Vec<String> = changes.iter().map(|(_, text)| text.clone()).collect();
            texts.push(shape.resolution(hand.width_px));
            session.branch(&texts).map(|session| (session, shape))
        });
        match opened {
            Ok((session, shape)) => {
                *written = now;
                drop(written);
                hand.take_up(session, shape);
                let mut state = held(&self.state);
                state.changes = changes;
                state.reread += 1;
                drop(state);
                self.tell(None);
                self.adopt(&hand.session, false);
                true
            }
            Err(error) => {
                drop(written);
                hand.refused = Some((now, others));
                self.tell(Some(said(&error, "")));
                false
            }
        }
    }

    /// Keeps what was set, for the scene's file.
    fn remember(&self, path: &str, text: &str) {
        let mut state = held(&self.state);
        state.changes.retain(|(other, _)| other != path);
        state.changes.push((path.to_owned(), text.to_owned()));
    }

    /// Shows the scene's controls as they are now, and its lens, if that was not drawn from the draft.
    fn adopt(&self, session: &Session, is_lens_drawn: bool) {
        self.draw(session, is_lens_drawn);
        let controls = controls::of_scene(session.scene().params.node());
        let mut state = held(&self.state);
        state.controls = controls;
        state.width_px = session.scene().imager.size().width_px;
        state.scenes += 1;
        self.turned.notify_all();
    }

    /// Shows the lens as it is now.
    fn draw(&self, session: &Session, is_drawn: bool) {
        let mut state = held(&self.state);
        let is_same = |before: &Arc<spectra_scene::Scene>| Arc::ptr_eq(&before.lens, &session.scene().lens);
        if !is_drawn && !state.scene.as_ref().is_some_and(is_same) {
            state.section = [None, None];
            state.lenses += 1;
        }
        state.scene = Some(Arc::clone(session.scene()));
    }

    /// Says what is wrong, or that nothing is any more.
    pub(super) fn tell(&self, fault: Option<Value>) {
        let mut state = held(&self.state);
        let is_new = fault.is_some() || state.fault.is_some();
        state.fault = fault;
        if is_new {
            // The page hears of it by a frame: the last one again, under a new number.
            let before = state.frame.take();
            state.number += 1;
            let head = json!({"frame": state.number, "fault": state.fault});
            let (exposure, times, whole_px) = match before {
                Some(before) => (Arc::clone(&before.exposure), before.times.clone(), before.whole_px),
                None => (Arc::new(empty()), Vec::new(), 0),
            };
            let (number, bytes) = (state.number, packed(&head, &[]));
            state.frame = Some(Arc::new(Frame { number, bytes, exposure, times, whole_px }));
        }
        self.turned.notify_all();
    }
}

/// Whether a value is of the development of a film, by its path.
fn is_of_development(path: &str) -> bool {
    path.starts_with("film.") && !CHOOSES_FILM.iter().any(|key| path.rsplit('.').next() == Some(key))
}

fn empty() -> ExposureFrame {
    let size = spectra_core::frame::FrameSize { width_px: 0, height_px: 0, width_mm: 0.0, height_mm: 0.0 };
    ExposureFrame { size, channels: Vec::new() }
}
