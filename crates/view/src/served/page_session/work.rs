//! The work of a desk's thread, as a machine of four states: it waits for changes, shows a draft, applies the changes to the whole scene,
//! and traces it piece by piece.

use super::change::Change;
use super::priority::{self, Until};
use super::work_state::WorkState;
use super::{PageSession, State, lock};
use crate::page::{AspectRatio, WIDTHS_PX};
use crate::parts::error_json;
use crate::served::memory;
use spectra_scene::NumberFamily;
use spectra_session::{Control as Stop, Session, SessionError};
use std::mem::take;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// Time without requests after which a page counts as gone.
const PATIENCE: Duration = Duration::from_secs(25);
/// Light is traced in pieces that take at least about `PIECE_S` seconds, the fraction `PIECE_PART` of the time since the change, and at
/// most `LONGEST_PIECE_S` seconds. The picture thus grows visibly, and little time goes into developing it.
const PIECE_S: f64 = 0.12;
const PIECE_PART: f64 = 0.5;
const LONGEST_PIECE_S: f64 = 1.0;
/// Time without changes, after a draft, until the whole picture is begun.
const REST: Duration = Duration::from_millis(60);
/// Interval at which the scene's file is checked.
const GLANCE: Duration = Duration::from_millis(300);
/// Time without work after which free memory is returned to the system.
const TIDY: Duration = Duration::from_secs(1);
/// Width in pixels of the first picture of a photograph. This picture needs no rays.
const PHOTOGRAPH_PX: u32 = 960;
/// Largest width, in pixels, at which a photograph is shown.
const LARGEST_PX: u32 = 8192;

/// What the desk's thread does next.
enum Phase {
    /// Waits for work, and takes the changes that the page sent.
    Idle,
    /// Shows a draft of the scene with all changes.
    Draft,
    /// Applies the changes to the whole scene.
    Settle,
    /// Traces a piece of the whole picture.
    Trace,
}

impl PageSession {
    /// Works until the desk is closed.
    pub(super) fn work(self: &Arc<Self>) {
        // Starts the pool that develops later pictures, before there is much to do.
        priority::pool(self.order.threads);
        let mut work = match self.order.session() {
            Ok(session) => self.begin(session),
            Err(error) => {
                self.tell(Some(error_json(&error, "")));
                return self.close();
            }
        };
        let mut phase = Some(Phase::Idle);
        while let Some(now) = phase {
            phase = match now {
                Phase::Idle => self.idle(&mut work),
                Phase::Draft => Some(self.draft(&mut work)),
                Phase::Settle => Some(self.settle(&mut work)),
                Phase::Trace => Some(self.trace(&mut work)),
            };
        }
    }

    /// Publishes a scene that was just opened, and sets the width of its first picture.
    fn begin(&self, mut session: Session) -> WorkState {
        let shape = AspectRatio::of(&session);
        self.adopt(&session, false);
        let own_px = session.scene().imager.size().width_px;
        let (widths_px, width_px) = match self.order.photograph {
            // A photograph is not shown larger than its own pixels.
            Some(_) => {
                let narrower = WIDTHS_PX.into_iter().filter(|width_px| *width_px < own_px);
                (narrower.chain([own_px.min(LARGEST_PX)]).collect(), own_px.min(PHOTOGRAPH_PX))
            }
            None => (WIDTHS_PX.to_vec(), WIDTHS_PX[1]),
        };
        lock(&self.state).page.widths_px = widths_px;
        if let Err(error) = session.change(&shape.resolution(width_px)) {
            self.tell(Some(error_json(&error, "imager.resolution")));
        }
        self.adopt(&session, true);
        WorkState::of(session, shape, width_px)
    }

    /// Takes what the page asks for, and looks at the scene's files. Returns `None` if the desk is closed.
    fn idle(self: &Arc<Self>, work: &mut WorkState) -> Option<Phase> {
        let (pending, backs) = self.requests(work)?;
        if work.clock.worked.is_some_and(|worked| worked.elapsed() >= TIDY) {
            work.clock.worked = None;
            memory::give_back();
        }
        if backs > 0 {
            work.clock.started = Instant::now();
            if !self.go_back(work, backs) {
                work.is_draft_owed = true;
            } else if let Err(error) = self.picture(work, true) {
                self.tell(Some(error_json(&error, "")));
            }
        }
        if pending.is_empty() && work.clock.looked.elapsed() >= GLANCE {
            work.clock.looked = Instant::now();
            if self.is_written_anew(work) {
                work.clock.started = Instant::now();
            }
        }
        if !pending.is_empty() {
            work.clock.started = Instant::now();
            work.owe(pending);
            work.is_draft_owed = true;
        }
        Some(if work.is_draft_owed { Phase::Draft } else { Phase::Settle })
    }

    /// Waits until there is work, and takes the changes and the number of undo steps that the page asked for. Returns `None` if the desk is
    /// closed.
    fn requests(&self, work: &mut WorkState) -> Option<(Vec<Change>, usize)> {
        let is_done = work.is_done() && !work.is_draft_owed;
        let is_asked = |state: &State| !state.pending.is_empty() || state.backs > 0;
        let is_idle = |state: &mut State| !state.is_closed && !is_asked(state) && (is_done || state.fault.is_some());
        let waited = self.turned.wait_timeout_while(lock(&self.state), GLANCE, is_idle);
        let (mut state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if lock(&self.seen).elapsed() > PATIENCE {
            state.is_closed = true;
            self.turned.notify_all();
        }
        if state.is_closed {
            return None;
        }
        if !is_done || is_asked(&state) {
            work.clock.worked = Some(Instant::now());
        }
        work.stop = Arc::new(Stop::new());
        state.stop = Arc::clone(&work.stop);
        state.turns_taken = state.turns;
        Some((take(&mut state.pending), take(&mut state.backs)))
    }

    /// Shows a draft. While somebody drags, only drafts follow; the whole picture is begun once the hand rests.
    fn draft(&self, work: &mut WorkState) -> Phase {
        work.is_draft_owed = false;
        if !self.make_draft(work) {
            return Phase::Settle;
        }
        let rests = |state: &mut State| state.pending.is_empty() && !state.is_closed;
        let waited = self.turned.wait_timeout_while(lock(&self.state), REST, rests);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if state.pending.is_empty() { Phase::Settle } else { Phase::Idle }
    }

    /// Applies the changes to the whole scene, and develops it if its light is still valid.
    fn settle(self: &Arc<Self>, work: &mut WorkState) -> Phase {
        if work.owed.is_empty() {
            work.is_light_owed = false;
            return Phase::Trace;
        }
        let Some(is_light_kept) = self.apply(work) else { return Phase::Idle };
        if work.is_flat() {
            work.light = None;
        } else if !is_light_kept && !work.behind.is_empty() {
            // A change that was expected to affect only the development needs new light, so the draft must catch up.
            work.is_draft_owed = true;
            return Phase::Idle;
        } else if !is_light_kept || !work.session.has_light() {
            return Phase::Trace;
        }
        let shown = self.picture(work, true);
        self.prove(work, shown);
        Phase::Idle
    }

    /// Traces a piece of the whole picture and shows it. A photograph's own pixels are exposed at once.
    fn trace(self: &Arc<Self>, work: &mut WorkState) -> Phase {
        if lock(&self.state).fault.is_some() {
            return Phase::Idle;
        }
        if work.is_flat() {
            if !work.is_done() {
                work.light = None;
                let shown = self.picture(work, true);
                self.prove(work, shown);
            }
            return Phase::Idle;
        }
        let (all, done) = (u64::from(work.session.scene().render.samples), work.session.samples());
        if work.session.is_complete() {
            return Phase::Idle;
        }
        let traced = match self.trace_piece(work, all, done) {
            // Without a whole sample of every pixel there is no picture. If something changed, the picture is outdated.
            Ok(()) if work.session.samples() == 0 || work.stop.should_stop() => return Phase::Idle,
            Ok(()) => self.picture(work, false),
            Err(error) => Err(error),
        };
        if !self.prove(work, traced) {
            work.is_draft_owed = work.is_light_owed;
        }
        Phase::Idle
    }

    /// Traces the next samples of the whole picture, which has `done` of `all` samples, and measures the time that they take.
    fn trace_piece(&self, work: &mut WorkState, all: u64, done: u64) -> Result<(), SessionError> {
        // Strata are laid out for all samples at once.
        let more = match work.pace_s {
            _ if work.session.scene().render.numbers == NumberFamily::Stratified => all,
            None => 1,
            Some(pace_s) => {
                let since_s = work.clock.started.elapsed().as_secs_f64();
                let piece_s = (PIECE_PART * since_s).clamp(PIECE_S, LONGEST_PIECE_S);
                (piece_s / pace_s).floor().clamp(1.0, 4096.0) as u64
            }
        };
        let from = Instant::now();
        let more = more.min(all - done);
        work.light = None;
        // The search for the rays that pass the lens of the whole scene may take longer than a draft; it also stops when something
        // changes.
        let workers = Until { threads: self.order.threads, stop: &work.stop };
        work.session.step(more, &workers, &work.stop)?;
        // The first sample includes preparation that happens once.
        let took_s = from.elapsed().as_secs_f64().max(1e-6);
        if done == 0 {
            work.pace_s = Some(took_s.min(PIECE_S));
        } else if !work.stop.should_stop() {
            work.pace_s = Some(took_s / more as f64);
        }
        Ok(())
    }

    /// Accepts the changes if their picture was shown, and takes them back otherwise. Returns whether it was shown.
    fn prove(&self, work: &mut WorkState, shown: Result<(), SessionError>) -> bool {
        match &shown {
            Ok(()) => work.unproved = None,
            Err(error) => self.take_back(work, error),
        }
        shown.is_ok()
    }
}
