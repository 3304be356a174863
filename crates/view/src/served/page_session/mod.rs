//! The desk of one page ([`PageSession`]): a separate session on its own thread, around the [`PageState`] that every page has.
//!
//! The page leaves changes on the desk and takes frames from it. If several changes of one control arrive while a picture is traced, only
//! the last one counts. A draft is traced to its end; preparing and tracing the whole picture stops for changes. A desk that receives no requests for 25 s is closed. There are at most four
//! desks.
//!
//! **Draft and whole** (`draft`, `apply`). The desk holds the scene twice: the whole session, and a draft of it, 120 pixels wide with four
//! samples, which shares the stages that do not depend on size. A change goes to the draft first. The whole gets it once nothing has
//! changed for 60 ms. Changes of a film's development go to the whole at once, because its light mostly stays; the draft gets them when it
//! is next needed. A draft is prepared with little effort (`Effort::Draft`): few zones, no outlines, few rays for meters, no ghosts and no
//! stars. The whole takes the focused lens of the draft (`Session::change_unprepared`) and is prepared when it is traced.
//!
//! **Refused changes** are reported until the control changes again, and leave the scene as it was. If a fault shows only when light is
//! traced, the session goes back to an earlier state (`Snapshot`), as for a step back (`history`). `turns_settled` counts the changes that
//! the controls have. A field of the page waits until that count reaches the number of its own change; then it shows the value, or is red.
//! A control of a swept key chooses a picture.
//!
//! **Pieces** (`work`). The whole is traced in pieces of half of the time since the change, up to 1 s. Preparation and tracing stop if more
//! changes arrive. Stars are spread on the desk's thread and cannot be stopped. Light that does not have all of its samples is therefore
//! shown without them.
//!
//! **Files** (`watch`, `reload`). The scene's file and all files that it names are checked about three times a second. A different text is
//! taken up as a new session.
//!
//! A photograph ([`super::photograph`]) is the scene that `film develop` makes. Without a lens its film is exposed to pixels that are kept,
//! and there is no draft.

mod apply;
mod change;
mod draft;
mod history;
mod priority;
mod publish;
mod reload;
mod show;
mod watch;
mod work;
mod work_state;

use super::bench::is_prism;
use super::render_job::RenderJob;
use super::{export, memory, save};
use crate::page::{ChangeKind, PageState};
use crate::parts::spectra;
use crate::section;
use change::Change;
use serde_json::{Value, json};
use spectra_session::{Control as Stop, Snapshot};
use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

#[derive(Default)]
struct State {
    /// Changes that the desk's thread has not taken yet, one per control.
    pending: Vec<Change>,
    /// Number of undo steps that are requested and not taken yet.
    backs: usize,
    page: PageState,
    /// The last message without a picture: its number and its packed head.
    note: Option<(u64, Arc<Vec<u8>>)>,
    /// Reason why there is no picture of the current scene at all. Until something changes, nothing is traced.
    fault: Option<Value>,
    /// Refused changes, by control, with the errors; the scene is as it was before them.
    refused: BTreeMap<String, Value>,
    /// The refused changes of which the page was told.
    refused_told: BTreeMap<String, Value>,
    section: [Option<Arc<String>>; 2],
    /// Current state of the session.
    moment: Option<Snapshot>,
    /// Changes that the page made and that are not saved to the scene's file, as paths and texts `path=value`.
    changes: Vec<(String, String)>,
    /// Number of steps that can be undone.
    undos: usize,
    /// Number of times that the scene's file was loaded again after somebody wrote it.
    reread: u64,
    /// Number of changes that the page has sent; `turns_taken` counts those that the next picture has, and `turns_settled` those that the
    /// controls show or that are refused.
    turns: u64,
    turns_taken: u64,
    turns_settled: u64,
    /// Value of `turns_settled` that the page was told last.
    turns_told: u64,
    /// Whether a large picture is being developed on a different thread from the desk's.
    is_developing: bool,
    stop: Arc<Stop>,
    is_closed: bool,
}
impl State {
    /// Returns the error for the page: that of the scene, or otherwise one of a refused change.
    fn said(&self) -> Option<Value> {
        self.fault.clone().or_else(|| self.refused.values().next_back().cloned())
    }
}

/// A desk, shared by its thread and the requests of its page.
pub(crate) struct PageSession {
    order: RenderJob,
    /// Text of the scene's file as it was last read or saved; `None` for a bundled scene or a photograph.
    written: Mutex<Option<String>>,
    seen: Mutex<Instant>,
    state: Mutex<State>,
    turned: Condvar,
}

/// Locks a mutex, even if a thread panicked with it. Locks are held only while data is copied, so the data is consistent.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl PageSession {
    /// Opens a desk and starts its thread, which ends when the desk is closed or receives no requests for a while.
    pub(crate) fn open(order: RenderJob) -> std::io::Result<Arc<Self>> {
        let written = order.file().and_then(|file| std::fs::read_to_string(file).ok());
        let desk = Self {
            order,
            written: Mutex::new(written),
            seen: Mutex::new(Instant::now()),
            state: Mutex::new(State::default()),
            turned: Condvar::new(),
        };
        let desk = Arc::new(desk);
        let own = Arc::clone(&desk);
        std::thread::Builder::new().name("desk".to_owned()).spawn(move || {
            own.work();
            memory::give_back();
        })?;
        Ok(desk)
    }

    /// Records that the page has just sent a request.
    pub(crate) fn is_asked(&self) {
        *lock(&self.seen) = Instant::now();
    }

    /// Returns whether the desk's thread has ended or is about to end.
    pub(crate) fn is_closed(&self) -> bool {
        lock(&self.state).is_closed
    }

    /// Closes the desk and stops its work.
    pub(crate) fn close(&self) {
        let mut state = lock(&self.state);
        state.is_closed = true;
        state.stop.stop();
        self.turned.notify_all();
    }

    /// Accepts a change that the page sent, and returns its number among all changes.
    ///
    /// # Errors
    /// The reason why the scene cannot have such a value.
    pub(crate) fn turn(&self, path: &str, value: &Value) -> Result<u64, String> {
        let mut state = lock(&self.state);
        let from = state.pending.iter().rev().find_map(|change| change.what.picture());
        let mut what = state.page.change(path, value, from).map_err(|fault| fault.to_string())?;
        if let ChangeKind::Set(texts) = &mut what {
            self.complete(path, texts)?;
        }
        // Only the last value of each control counts.
        state.pending.retain(|other| other.control != path);
        state.pending.push(Change { control: path.to_owned(), what });
        state.turns += 1;
        let number = state.turns;
        state.stop.stop();
        self.turned.notify_all();
        Ok(number)
    }

    /// Adds the texts that go with those of a control: another film for a photograph also sets the light for which the film is made, so
    /// that gray stays gray.
    fn complete(&self, path: &str, texts: &mut Vec<String>) -> Result<(), String> {
        if path == "film.stock" && self.order.photograph.is_some() {
            let stock = texts.first().and_then(|text| text.split_once('=')).map_or("", |(_, stock)| stock);
            let light = super::photograph::light_of(stock).map_err(|error| error.to_string())?;
            texts.push(format!("source.illuminant={light}"));
        }
        Ok(())
    }

    /// Requests to undo the last step, and returns the number of this change.
    pub(crate) fn back(&self) -> u64 {
        let mut state = lock(&self.state);
        state.backs += 1;
        state.turns += 1;
        state.stop.stop();
        self.turned.notify_all();
        state.turns
    }

    /// Waits for a picture or a note with a higher number than `number`, and returns the last one; `None` if none comes within `patience`.
    pub(crate) fn frame_after(&self, number: u64, patience: Duration) -> Option<Vec<u8>> {
        let found = |state: &State| {
            let picture =
                state.page.frame.as_ref().filter(|frame| frame.number > number).map(|frame| frame.bytes.clone());
            let note = || state.note.as_ref().filter(|note| note.0 > number).map(|note| note.1.to_vec());
            picture.or_else(note)
        };
        let is_waiting = |state: &mut State| {
            let last = [state.page.frame.as_ref().map(|frame| frame.number), state.note.as_ref().map(|note| note.0)];
            !state.is_closed && last.into_iter().flatten().all(|last| last <= number)
        };
        let waited = self.turned.wait_timeout_while(lock(&self.state), patience, is_waiting);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        found(&state)
    }

    /// Returns the scene's controls with their current values, and the state of the desk, as JSON.
    pub(crate) fn controls(&self) -> Value {
        let saves = lock(&self.written).is_some();
        let state = lock(&self.state);
        let name = self.order.scene.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let own = json!({
            "saves": saves,
            "changes": state.changes.len(),
            "undos": state.undos,
            "turns": state.turns_settled,
            "refused": state.refused,
            "photograph": self.order.photograph.is_some(),
            "is_prism": state.page.scene.as_ref().is_some_and(|scene| is_prism(&scene.lens)),
        });
        state.page.controls(name.as_deref(), own)
    }

    /// Returns the exposure of a pixel of the last frame in each channel; `None` if there is no such pixel.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> Option<Value> {
        let frame = lock(&self.state).page.frame.clone()?;
        frame.pixel([x, y])
    }

    /// Returns the cross-section of the current lens as SVG; an empty text if it cannot be drawn, `None` without a scene.
    pub(crate) fn section(&self, is_dark: bool) -> Option<Arc<String>> {
        let (drawn, scene) = {
            let state = lock(&self.state);
            (state.section[usize::from(is_dark)].clone(), state.page.scene.clone())
        };
        if drawn.is_some() {
            return drawn;
        }
        let scene = scene?;
        let made = Arc::new(section::svg(&scene, is_dark).unwrap_or_default());
        let mut state = lock(&self.state);
        if state.page.scene.as_ref().is_some_and(|now| Arc::ptr_eq(now, &scene)) {
            state.section[usize::from(is_dark)] = Some(Arc::clone(&made));
        }
        Some(made)
    }

    /// Returns the spectrum of the current scene's light and the responses of its layers. `None` without a scene.
    pub(crate) fn spectra(&self) -> Option<Value> {
        let scene = lock(&self.state).page.scene.clone()?;
        Some(spectra(&scene))
    }

    /// Returns the command that renders the current picture at full size; `None` without a scene.
    pub(crate) fn command(&self) -> Option<String> {
        let moment = lock(&self.state).moment.clone()?;
        Some(export::command(&self.order, moment.series(), moment.index()))
    }

    /// Returns the text of a scene file that describes the current picture; `None` without a scene.
    pub(crate) fn text(&self) -> Option<Result<String, String>> {
        let moment = lock(&self.state).moment.clone()?;
        Some(export::text(&self.order, moment.series(), moment.index()))
    }

    /// Writes the page's changes into the scene's file, and returns how many values were written.
    ///
    /// # Errors
    /// The reason why the file is not written; it is then unchanged.
    pub(crate) fn save(&self) -> Result<usize, String> {
        let mut written = lock(&self.written);
        let Some(before) = &*written else {
            return Err("a bundled scene cannot be changed: make one of your own with `spectra new scene`".to_owned());
        };
        let changes = lock(&self.state).changes.clone();
        *written = Some(save::save(&self.order.scene, before, &self.order.overrides, &changes)?);
        // Changes that arrived meanwhile remain to be written.
        lock(&self.state).changes.retain(|change| !changes.contains(change));
        Ok(changes.len())
    }
}
