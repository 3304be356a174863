//! What one page works on: a session of its own, on a thread of its own.
//!
//! The page leaves changes on the desk and takes frames from it. Changes of one control that arrive while a picture is traced count
//! once, by the last of them; the work at hand is stopped for them. A desk that nobody asks anything of is cleared.

mod hand;
mod history;
mod priority;
mod show;
mod turned;
mod watch;
mod work;

use super::bench::is_prism;
use super::order::Order;
use super::{memory, save, told};
use crate::controls::Control;
use crate::parts::{Picks, pixel, spectra};
use crate::section;
use serde_json::{Value, json};
use spectra_core::frame::ExposureFrame;
use spectra_scene::FilmTime;
use spectra_session::{Control as Stop, Moment};
use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use turned::{Turned, What};

/// Widths of the picture that a page may choose, pixels.
const WIDTHS_PX: [u32; 4] = [240, 480, 960, 1920];

/// A picture for the page.
pub(crate) struct Frame {
    pub number: u64,
    /// A head as JSON, with its length before it, and linear red, green and blue as [`halves`](crate::parts::halves) has them.
    pub bytes: Vec<u8>,
    exposure: Arc<ExposureFrame>,
    times: Vec<FilmTime>,
    /// Width of the picture that it is one of, pixels: that of its numbers or, of a draft, more.
    whole_px: u32,
}

#[derive(Default)]
struct State {
    /// What was turned, in the order in which it was first turned.
    pending: Vec<Turned>,
    /// So many steps back are asked for.
    backs: usize,
    controls: Vec<Control>,
    /// The pictures of the scene.
    picks: Picks,
    /// The last picture.
    frame: Option<Arc<Frame>>,
    /// What was said last without a picture: a number and a head.
    note: Option<(u64, Arc<Vec<u8>>)>,
    /// Of pictures and notes together.
    number: u64,
    /// Why there is no picture at all of the scene as it is; until something else is turned, nothing is traced.
    fault: Option<Value>,
    /// What was turned and refused, by control, with what is wrong: the scene is as it was.
    refused: BTreeMap<String, Value>,
    /// Those of them that the page was told.
    refused_told: BTreeMap<String, Value>,
    section: [Option<Arc<String>>; 2],
    scene: Option<Arc<spectra_scene::Scene>>,
    /// How the session is set.
    moment: Option<Moment>,
    /// How often the scene was another one: the page asks for its controls again.
    scenes: u64,
    /// What the page set, by path, for the scene's file.
    changes: Vec<(String, String)>,
    /// So many steps back can be taken.
    undos: usize,
    /// How often the lens was another one: the page asks for its drawing again.
    lenses: u64,
    /// How often the scene's file was taken up after somebody wrote it.
    reread: u64,
    /// Width of the whole picture, pixels, and those that can be chosen.
    width_px: u32,
    widths_px: Vec<u32>,
    /// Values that were turned; those among them that the pictures have; and those that the controls have, or that are refused.
    turns: u64,
    turns_taken: u64,
    turns_settled: u64,
    /// Those of them that the page was told.
    turns_told: u64,
    /// A large picture is being developed beside the desk's thread.
    is_developing: bool,
    stop: Arc<Stop>,
    is_closed: bool,
}
impl State {
    /// What is wrong, for the page: with the scene, or else with what was turned last of what is refused.
    fn said(&self) -> Option<Value> {
        self.fault.clone().or_else(|| self.refused.values().next_back().cloned())
    }
}

/// A desk, as the page's requests and its thread share it.
pub(crate) struct Desk {
    order: Order,
    /// The scene's file as it was opened, or saved since; none of a bundled scene.
    written: Mutex<Option<String>>,
    seen: Mutex<Instant>,
    state: Mutex<State>,
    turned: Condvar,
}

/// A lock is held for copying alone: what a thread that panicked left is whole.
fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Desk {
    /// A desk with its thread, which ends when the desk is closed or forgotten.
    pub(crate) fn open(order: Order) -> std::io::Result<Arc<Self>> {
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

    /// Somebody is there.
    pub(crate) fn is_asked(&self) {
        *held(&self.seen) = Instant::now();
    }

    /// Whether its thread has ended or is to end.
    pub(crate) fn is_closed(&self) -> bool {
        held(&self.state).is_closed
    }

    /// Ends the work.
    pub(crate) fn close(&self) {
        let mut state = held(&self.state);
        state.is_closed = true;
        state.stop.stop();
        self.turned.notify_all();
    }

    /// Takes a value that the page sent; gives its number among all that were turned.
    ///
    /// # Errors
    /// Why the scene has no such value.
    pub(crate) fn turn(&self, path: &str, value: &Value) -> Result<u64, String> {
        let mut state = held(&self.state);
        let what = if path == "width" {
            let width = value.as_u64().and_then(|w| u32::try_from(w).ok());
            What::Width(width.filter(|w| state.widths_px.contains(w)).ok_or("none of the widths")?)
        } else {
            let control = state.controls.iter().find(|c| c.path() == path).ok_or("no such control")?;
            let text = control.text(value)?;
            match control.picked(value) {
                Some(word) => {
                    let from = state.pending.iter().rev().find_map(Turned::picture);
                    What::Picture(state.picks.with(from, path, &word).ok_or("no picture of the scene has it")?)
                }
                None => What::Set(self.together(path, text)?),
            }
        };
        // Of values of one control the last counts.
        state.pending.retain(|other| other.control != path);
        state.pending.push(Turned { control: path.to_owned(), what });
        state.turns += 1;
        let number = state.turns;
        state.stop.stop();
        self.turned.notify_all();
        Ok(number)
    }

    /// A text `path=value` with what goes with it: of a photograph, the light that a film is made for, so that gray is gray.
    fn together(&self, path: &str, text: String) -> Result<Vec<String>, String> {
        let mut all = vec![text];
        if path == "film.stock" && self.order.photograph.is_some() {
            let stock = all[0].split_once('=').map_or("", |(_, stock)| stock).to_owned();
            let light = super::photograph::light_of(&stock).map_err(|error| error.to_string())?;
            all.push(format!("source.illuminant={light}"));
        }
        Ok(all)
    }

    /// Takes the last step back.
    pub(crate) fn back(&self) -> u64 {
        let mut state = held(&self.state);
        state.backs += 1;
        state.turns += 1;
        state.stop.stop();
        self.turned.notify_all();
        state.turns
    }

    /// The last picture after this number, or what was said after it, if there is one within the time.
    pub(crate) fn frame_after(&self, number: u64, patience: Duration) -> Option<Vec<u8>> {
        let found = |state: &State| {
            let picture = state.frame.as_ref().filter(|frame| frame.number > number).map(|frame| frame.bytes.clone());
            let note = || state.note.as_ref().filter(|note| note.0 > number).map(|note| note.1.to_vec());
            picture.or_else(note)
        };
        let is_waiting = |state: &mut State| {
            let last = [state.frame.as_ref().map(|frame| frame.number), state.note.as_ref().map(|note| note.0)];
            !state.is_closed && last.into_iter().flatten().all(|last| last <= number)
        };
        let waited = self.turned.wait_timeout_while(held(&self.state), patience, is_waiting);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        found(&state)
    }

    /// What the scene's controls are and say now.
    pub(crate) fn controls(&self) -> Value {
        let saves = held(&self.written).is_some();
        let state = held(&self.state);
        let name = self.order.scene.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        json!({
            "name": name,
            "controls": state.controls.iter().map(Control::to_json).collect::<Vec<_>>(),
            "widths": state.widths_px,
            "width": state.width_px,
            "saves": saves,
            "changes": state.changes.len(),
            "undos": state.undos,
            "turns": state.turns_settled,
            "refused": state.refused,
            "photograph": self.order.photograph.is_some(),
            "is_prism": state.scene.as_ref().is_some_and(|scene| is_prism(&scene.lens)),
        })
    }

    /// What a pixel of the last frame got, channel by channel.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> Option<Value> {
        let frame = held(&self.state).frame.clone()?;
        let size = frame.exposure.size;
        // Of a draft, the pixel that covers it.
        let part = |at: u32| u64::from(at) * u64::from(size.width_px) / u64::from(frame.whole_px.max(1));
        pixel(&frame.exposure, &frame.times, frame.number, [x, y].map(part))
    }

    /// The cross-section of the lens as it is set now; an empty text where it cannot be drawn.
    pub(crate) fn section(&self, is_dark: bool) -> Option<Arc<String>> {
        let (drawn, scene) = {
            let state = held(&self.state);
            (state.section[usize::from(is_dark)].clone(), state.scene.clone())
        };
        if drawn.is_some() {
            return drawn;
        }
        let scene = scene?;
        let made = Arc::new(section::svg(&scene, is_dark).unwrap_or_default());
        let mut state = held(&self.state);
        if state.scene.as_ref().is_some_and(|now| Arc::ptr_eq(now, &scene)) {
            state.section[usize::from(is_dark)] = Some(Arc::clone(&made));
        }
        Some(made)
    }

    /// The light and the layers of the scene as it is set now.
    pub(crate) fn spectra(&self) -> Option<Value> {
        let scene = held(&self.state).scene.clone()?;
        Some(spectra(&scene))
    }

    /// The command that makes the picture that is seen, with all of its pixels.
    pub(crate) fn command(&self) -> Option<String> {
        let moment = held(&self.state).moment.clone()?;
        Some(told::command(&self.order, moment.series(), moment.index()))
    }

    /// The text of a scene that says what is seen.
    pub(crate) fn text(&self) -> Option<Result<String, String>> {
        let moment = held(&self.state).moment.clone()?;
        Some(told::text(&self.order, moment.series(), moment.index()))
    }

    /// Writes what the page set into the scene's file; says how many values.
    ///
    /// # Errors
    /// Why it is not written; then the file is as it was.
    pub(crate) fn save(&self) -> Result<usize, String> {
        let mut written = held(&self.written);
        let Some(before) = &*written else {
            return Err(
                "a bundled scene is not written to: `spectra new scene` makes one of your own to view".to_owned()
            );
        };
        let changes = held(&self.state).changes.clone();
        *written = Some(save::save(&self.order.scene, before, &self.order.overrides, &changes)?);
        // What was turned meanwhile is still to be written.
        held(&self.state).changes.retain(|change| !changes.contains(change));
        Ok(changes.len())
    }
}
