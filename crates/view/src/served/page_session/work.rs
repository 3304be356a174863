//! The work of a desk's thread: it applies changes, traces, develops, and watches the scene's file.

use super::super::{memory, save};
use super::change::ChangeKind;
use super::history::SavedState;
use super::show::PictureRole;
use super::work_state::{AspectRatio, Drafted, ExposedFilm, UnrenderedChange, WorkState};
use super::{PageSession, State, WIDTHS_PX, lock, priority};
use crate::controls;
use crate::parts::{SeriesValues, error_json, packed};
use serde_json::{Value, json};
use spectra_scene::NumberFamily;
use spectra_session::{Control as Stop, Effort, Session, SessionError, SessionOptions, Threads, Workers};
use std::mem::take;
use std::path::Path;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// Time without requests after which a page counts as gone.
const PATIENCE: Duration = Duration::from_secs(25);
/// Light is traced in pieces that take at least about `PIECE_S` seconds, the fraction `PIECE_PART` of the time since the change, and at
/// most `LONGEST_PIECE_S` seconds. The picture thus grows visibly, and little time goes into developing it.
const PIECE_S: f64 = 0.12;
const PIECE_PART: f64 = 0.5;
const LONGEST_PIECE_S: f64 = 1.0;
/// Controls that do not apply to a draft, which has its own values.
const NOT_DRAFTED: [&str; 6] =
    ["width", "render.samples", "render.rays", "render.noise", "render.reflections.order", "render.diffraction"];
/// Keys that choose another film, and so need other light. Other keys of a film mostly leave the light valid.
const CHOOSES_FILM: [&str; 2] = ["stock", "kind"];
/// Time without changes, after a draft, until the whole picture is begun.
const REST: Duration = Duration::from_millis(60);
/// Interval at which the scene's file is checked.
const GLANCE: Duration = Duration::from_millis(300);
/// Time without work after which free memory is returned to the system.
const TIDY: Duration = Duration::from_secs(1);
/// Width of the first picture of a photograph, pixels; it needs no rays.
const PHOTOGRAPH_PX: u32 = 960;
/// Largest width at which a photograph is shown, pixels.
const LARGEST_PX: u32 = 8192;
/// Largest size of a scene's file, bytes; a larger file is ignored.
const MAX_SCENE_BYTES: u64 = 1 << 22;

/// Threads of low priority whose work stops when something changes.
struct Until<'a> {
    threads: usize,
    stop: &'a Stop,
}

impl Workers for Until<'_> {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        priority::each(self.threads, work);
    }

    fn should_stop(&self) -> bool {
        self.stop.should_stop()
    }
}

impl PageSession {
    pub(super) fn work(self: &Arc<Self>) {
        // Starts the pool that develops later pictures, before there is much to do.
        priority::pool(self.order.threads);
        let mut session = match self.order.session() {
            Ok(session) => session,
            Err(error) => {
                self.tell(Some(error_json(&error, "")));
                return self.close();
            }
        };
        let shape = AspectRatio::of(&session);
        self.adopt(&session, false);
        let own_px = session.scene().imager.size().width_px;
        let widths_px = match self.order.photograph {
            // A photograph is not shown larger than its own pixels.
            Some(_) => WIDTHS_PX.into_iter().filter(|w| *w < own_px).chain([own_px.min(LARGEST_PX)]).collect(),
            None => WIDTHS_PX.to_vec(),
        };
        let width_px = match self.order.photograph {
            Some(_) => own_px.min(PHOTOGRAPH_PX),
            None => WIDTHS_PX[1],
        };
        lock(&self.state).widths_px = widths_px;
        if let Err(error) = session.change(&shape.resolution(width_px)) {
            self.tell(Some(error_json(&error, "imager.resolution")));
        }
        self.adopt(&session, true);
        let mut hand = WorkState::of(session, shape, width_px);
        let mut started = Instant::now();
        // The first picture of all is a draft, too.
        let mut is_asked_for_draft = true;
        let mut looked = Instant::now();
        // Time of the last work, until its memory is returned.
        let mut worked = None;
        loop {
            let (pending, backs, stop) = {
                let is_done = hand.is_done() && !is_asked_for_draft;
                let is_idle = |state: &mut State| {
                    let is_asked = !state.pending.is_empty() || state.backs > 0;
                    !state.is_closed && !is_asked && (is_done || state.fault.is_some())
                };
                let waited = self.turned.wait_timeout_while(lock(&self.state), GLANCE, is_idle);
                let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
                if lock(&self.seen).elapsed() > PATIENCE {
                    state.is_closed = true;
                    self.turned.notify_all();
                }
                if state.is_closed {
                    break;
                }
                if !is_done || !state.pending.is_empty() || state.backs > 0 {
                    worked = Some(Instant::now());
                }
                state.stop = Arc::new(Stop::new());
                state.turns_taken = state.turns;
                (take(&mut state.pending), take(&mut state.backs), Arc::clone(&state.stop))
            };
            if worked.is_some_and(|worked| worked.elapsed() >= TIDY) {
                worked = None;
                memory::give_back();
            }
            if backs > 0 {
                started = Instant::now();
                if !self.go_back(&mut hand, backs) {
                    is_asked_for_draft = true;
                } else if let Err(error) = self.picture(&mut hand, started, true) {
                    self.tell(Some(error_json(&error, "")));
                }
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
            if take(&mut is_asked_for_draft) {
                match self.drafted(&mut hand, started) {
                    Drafted::Shown => {
                        // While somebody drags, only drafts follow. The whole picture is begun once the hand rests.
                        let rests = |state: &mut State| state.pending.is_empty() && !state.is_closed;
                        let waited = self.turned.wait_timeout_while(lock(&self.state), REST, rests);
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
                if hand.is_flat() {
                    self.exposed(&mut hand, started);
                    continue;
                }
                if !is_light_kept && !hand.behind.is_empty() {
                    // A change that was expected to affect only the development needs new light, so the draft must catch up.
                    is_asked_for_draft = true;
                    continue;
                }
                if is_light_kept && hand.session.has_light() {
                    match self.picture(&mut hand, started, true) {
                        Ok(()) => hand.unproved = None,
                        Err(error) => self.take_back(&mut hand, &error),
                    }
                    continue;
                }
            }
            if hand.is_flat() {
                if !hand.is_done() && lock(&self.state).fault.is_none() {
                    self.exposed(&mut hand, started);
                }
                continue;
            }
            let scene = Arc::clone(hand.session.scene());
            let (all, done) = (u64::from(scene.render.samples), hand.session.samples());
            if done >= all || lock(&self.state).fault.is_some() {
                continue;
            }
            // Strata are laid out for all samples at once.
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
            // The search for the rays that pass the lens of the whole scene may take longer than a draft; it also stops when something
            // changes.
            let workers = Until { threads: self.order.threads, stop: &stop };
            if let Err(error) = hand.session.step(more, &workers, &stop) {
                self.take_back(&mut hand, &error);
                is_asked_for_draft = hand.is_light_owed;
                continue;
            }
            // The first sample includes preparation that happens once.
            let took_s = from.elapsed().as_secs_f64().max(1e-6);
            if done == 0 {
                hand.pace_s = Some(took_s.min(PIECE_S));
            } else if !stop.should_stop() {
                hand.pace_s = Some(took_s / more as f64);
            }
            // Without a whole sample of every pixel there is no picture. If something changed, the picture is outdated.
            if hand.session.samples() == 0 || stop.should_stop() {
                continue;
            }
            match self.picture(&mut hand, started, false) {
                Ok(()) => hand.unproved = None,
                Err(error) => {
                    self.take_back(&mut hand, &error);
                    is_asked_for_draft = hand.is_light_owed;
                }
            }
        }
    }

    /// Exposes the film to a photograph's own pixels, and shows the picture.
    fn exposed(self: &Arc<Self>, hand: &mut WorkState, started: Instant) {
        hand.light = None;
        match self.picture(hand, started, true) {
            Ok(()) => hand.unproved = None,
            Err(error) => self.take_back(hand, &error),
        }
    }

    /// Takes back changes of which no picture can be made: they are refused, and the scene is restored. If nothing was changed, the
    /// error is that of the scene itself.
    fn take_back(&self, hand: &mut WorkState, error: &SessionError) {
        let Some(UnrenderedChange { before, controls }) = hand.unproved.take() else {
            return self.tell(Some(error_json(error, "")));
        };
        hand.session.restore(&before.moment);
        hand.history.pop();
        self.at_another(hand, &mut false);
        let mut state = lock(&self.state);
        state.changes = before.changes;
        state.undos = hand.history.len();
        for control in controls {
            state.refused.insert(control.clone(), error_json(error, &control));
        }
        drop(state);
        self.adopt(&hand.session, false);
        self.tell(None);
    }

    /// Undoes steps; changes that are not applied yet count as the last step. Returns whether the light is still valid.
    fn go_back(&self, hand: &mut WorkState, steps: usize) -> bool {
        let steps = steps - usize::from(!hand.owed.is_empty());
        let mut is_light_kept = hand.session.has_light() && hand.unproved.is_none();
        hand.owed.clear();
        for _ in 0..steps {
            let Some(before) = hand.history.pop() else { break };
            is_light_kept &= hand.session.restore(&before.moment).light;
            lock(&self.state).changes = before.changes;
        }
        self.at_another(hand, &mut is_light_kept);
        let mut state = lock(&self.state);
        state.refused.clear();
        state.fault = None;
        state.undos = hand.history.len();
        drop(state);
        self.adopt(&hand.session, false);
        self.tell(None);
        is_light_kept
    }

    /// Continues from another state of the session, at the chosen width. Sets `is_light_kept` to false if the width had to change.
    fn at_another(&self, hand: &mut WorkState, is_light_kept: &mut bool) {
        if hand.session.scene().imager.size().width_px != hand.width_px {
            // The session had another width then. If the chosen width cannot be set, the old width remains.
            let resolution = hand.shape.resolution(hand.width_px);
            let _ =
                hand.session.change_unprepared(&[resolution], hand.session.index(), None, &Threads(self.order.threads));
            *is_light_kept = false;
        }
        hand.unproved = None;
        hand.draft = None;
        hand.behind.clear();
        (hand.light, hand.small) = (None, None);
        if !*is_light_kept {
            hand.pace_s = None;
        }
        hand.is_light_owed = !*is_light_kept;
    }

    /// Makes and shows a draft, a small picture with few samples, of the scene with all changes.
    fn drafted(&self, hand: &mut WorkState, started: Instant) -> Drafted {
        let workers = Threads(self.order.threads);
        let mut same_light = hand.draft.is_some() && hand.session.has_light();
        if same_light && !hand.is_light_owed && hand.owed.iter().all(|owed| is_of_development(&owed.turned.control)) {
            // The draft gets the change when it is needed next.
            return Drafted::SameLight;
        }
        let index = hand.index_owed();
        match &mut hand.draft {
            None => {
                hand.behind.clear();
                let mut texts: Vec<String> = hand.owed.iter().flat_map(|owed| hand.shape.texts(&owed.turned)).collect();
                texts.extend(hand.shape.draft(&hand.session));
                // Faults are reported when the whole scene is changed.
                let options = SessionOptions { picture: index, effort: Effort::Draft, ..hand.session.options() };
                hand.draft = hand.session.branch(&texts, options).ok();
            }
            Some(draft) => {
                let mut texts = take(&mut hand.behind);
                for owed in hand.owed.iter().filter(|owed| !owed.is_drafted) {
                    match &owed.turned.what {
                        ChangeKind::Set(own) if !NOT_DRAFTED.contains(&&*owed.turned.control) => {
                            texts.extend_from_slice(own)
                        }
                        _ => {}
                    }
                }
                match draft.change_unprepared(&texts, index, None, &workers) {
                    Ok(kept) => same_light &= kept.light,
                    Err(_) => return hand.without_draft(),
                }
            }
        }
        // A photograph's own pixels are developed as quickly as a draft.
        if hand.draft.as_ref().is_some_and(|draft| draft.series().is_without_lens()) {
            hand.draft = None;
        }
        hand.owed.iter_mut().for_each(|owed| owed.is_drafted = true);
        hand.is_light_owed |= !same_light;
        if hand.owed.iter().any(|owed| NOT_DRAFTED.contains(&&*owed.turned.control)) && hand.owed.len() == 1 {
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
            Ok(()) if draft.samples() > 0 => draft.rendering(),
            _ => return hand.without_draft(),
        };
        let shown = seen.and_then(|seen| {
            let mut taken =
                self.taken(draft, &hand.shape, started, Arc::new(ExposedFilm::of(seen)), PictureRole::Draft);
            taken.leaves_out(&hand.session);
            self.show(&taken)
        });
        if shown.is_err() {
            return hand.without_draft();
        }
        Drafted::Shown
    }

    /// Applies the changes to the scene, and returns whether the light is still valid. `None` if another change stopped it; changes that
    /// are not applied then remain.
    fn settle(&self, hand: &mut WorkState, stop: &Stop) -> Option<bool> {
        let is_drafted = hand.draft.is_some() && hand.is_light_owed;
        // Without a draft to look at, somebody waits for this, so it is not stopped.
        let never = Stop::new();
        let stop = if is_drafted { stop } else { &never };
        let workers = Until { threads: self.order.threads, stop };
        let mut is_light_kept = true;
        let time_s = hand.session.scene().exposure_time_s();
        let is_developed_only = hand.owed.iter().all(|owed| is_of_development(&owed.turned.control));
        let before = SavedState { moment: hand.session.snapshot(), changes: lock(&self.state).changes.clone() };
        let mut controls = Vec::new();
        for owed in take(&mut hand.owed) {
            let (texts, control) = (hand.shape.texts(&owed.turned), owed.turned.control.clone());
            let index = owed.turned.picture().unwrap_or(hand.session.index());
            // A draft with this change has the focused lens, which the scene can take over.
            let draft = hand.draft.as_ref().filter(|_| !NOT_DRAFTED.contains(&&*control));
            let changed = hand.session.change_unprepared(&texts, index, draft, &workers);
            match changed {
                Ok(kept) => {
                    is_light_kept &= kept.light;
                    if hand.draft.is_some() && is_of_development(&control) && !owed.is_drafted {
                        hand.behind.extend(texts.iter().cloned());
                    }
                    lock(&self.state).refused.remove(&control);
                    if let ChangeKind::Width(width_px) = owed.turned.what {
                        hand.width_px = width_px;
                    } else {
                        texts.iter().for_each(|text| self.remember(text));
                        controls.push(control);
                    }
                }
                Err(_) if stop.should_stop() => hand.owed.push(owed),
                Err(error) => {
                    lock(&self.state).refused.insert(control.clone(), error_json(&error, &control));
                    // The draft may have the refused change.
                    hand.draft = None;
                    hand.is_light_owed |= is_drafted;
                }
            }
        }
        if !controls.is_empty() {
            hand.history.push(before.clone(), &controls);
            let unproved = hand.unproved.get_or_insert(UnrenderedChange { before, controls: Vec::new() });
            unproved.controls.extend(controls);
        }
        if !is_light_kept {
            hand.pace_s = None;
        }
        // The exposure follows from the light, unless something that is applied to the sum of the light has changed.
        if !is_light_kept || !is_developed_only || hand.session.scene().exposure_time_s() != time_s {
            (hand.light, hand.small) = (None, None);
        }
        if !hand.owed.is_empty() {
            hand.is_light_owed |= !is_light_kept;
            return None;
        }
        hand.is_light_owed = false;
        lock(&self.state).undos = hand.history.len();
        self.adopt(&hand.session, is_drafted);
        self.tell(None);
        Some(is_light_kept)
    }

    /// Loads the scene again if somebody wrote its file, or one that it names, since. Returns whether there is another scene now. If a
    /// file is broken, the page is told, and everything stays as it is.
    fn is_written_anew(&self, hand: &mut WorkState) -> bool {
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
        let others = hand.stamps.now(&hand.session, self.order.file().unwrap_or(Path::new("")));
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
        // Changes of the page stay, except values that the file itself has changed.
        let mut changes = lock(&self.state).changes.clone();
        if let (Some(before), Some(now)) = (&*written, &now) {
            changes.retain(|(path, _)| save::says_same(before, now, path));
        }
        let opened = self.order.session().and_then(|session| {
            let shape = AspectRatio::of(&session);
            let mut texts: Vec<String> = changes.iter().map(|(_, text)| text.clone()).collect();
            texts.push(shape.resolution(hand.width_px));
            session.branch(&texts, session.options()).map(|session| (session, shape))
        });
        match opened {
            Ok((session, shape)) => {
                *written = now;
                drop(written);
                hand.take_up(session, shape);
                let mut state = lock(&self.state);
                state.changes = changes;
                state.refused.clear();
                state.undos = 0;
                state.reread += 1;
                drop(state);
                self.tell(None);
                self.adopt(&hand.session, false);
                true
            }
            Err(error) => {
                drop(written);
                hand.refused = Some((now, others));
                self.tell(Some(error_json(&error, "")));
                false
            }
        }
    }

    /// Records a change, a text `path=value`, for saving it to the scene's file.
    fn remember(&self, text: &str) {
        let path = text.split_once('=').map_or(text, |(path, _)| path);
        let mut state = lock(&self.state);
        state.changes.retain(|(other, _)| other != path);
        state.changes.push((path.to_owned(), text.to_owned()));
    }

    /// Publishes the controls of the session's scene, which now have all accepted changes, and its lens if that was not drawn from the
    /// draft.
    fn adopt(&self, session: &Session, is_lens_drawn: bool) {
        self.draw(session, is_lens_drawn);
        let controls = controls::of_session(session);
        let picks = SeriesValues::of(session);
        let mut state = lock(&self.state);
        state.turns_settled = state.turns_taken;
        state.controls = controls;
        state.picks = picks;
        state.moment = Some(session.snapshot());
        state.width_px = session.scene().imager.size().width_px;
        state.scenes += 1;
        self.turned.notify_all();
    }

    /// Publishes the session's scene, and marks its lens as changed unless `is_drawn` or it is the same one.
    fn draw(&self, session: &Session, is_drawn: bool) {
        let mut state = lock(&self.state);
        let is_same = |before: &Arc<spectra_scene::Scene>| Arc::ptr_eq(&before.lens, &session.scene().lens);
        if !is_drawn && !state.scene.as_ref().is_some_and(is_same) {
            state.section = [None, None];
            state.lenses += 1;
        }
        state.scene = Some(Arc::clone(session.scene()));
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
            state.number += 1;
            let head = json!({"frame": state.number, "scene": state.scenes, "fault": state.said()});
            state.note = Some((state.number, Arc::new(packed(&head, &[]))));
        }
        self.turned.notify_all();
    }
}

/// Returns whether a path belongs to the development of a film, so that a change of it mostly leaves the light valid.
fn is_of_development(path: &str) -> bool {
    path.starts_with("film.") && !CHOOSES_FILM.iter().any(|key| path.rsplit('.').next() == Some(key))
}
