//! What one page works on: a session of its own, on a thread of its own.
//!
//! The page leaves changes on the desk and takes frames from it. Changes of one control that arrive while a picture is traced count
//! once, by the last of them; the work at hand is stopped for them. A desk that nobody asks anything of is cleared.

mod hand;
mod priority;
mod show;
mod watch;
mod work;

use super::bench::is_prism;
use super::order::Order;
use super::{memory, save};
use crate::controls::Control;
use crate::parts::{pixel, spectra};
use crate::section;
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::frame::ExposureFrame;
use spectra_scene::FilmTime;
use spectra_session::{Control as Stop, Session, SessionError};
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

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
    /// Texts `path=value` by their paths, in the order in which the paths were first turned.
    pending: Vec<(String, String)>,
    controls: Vec<Control>,
    frame: Option<Arc<Frame>>,
    number: u64,
    fault: Option<Value>,
    section: [Option<Arc<String>>; 2],
    scene: Option<Arc<spectra_scene::Scene>>,
    /// How often the scene was another one: the page asks for its controls again.
    scenes: u64,
    /// What the page set, by path, for the scene's file.
    changes: Vec<(String, String)>,
    /// How often the lens was another one: the page asks for its drawing again.
    lenses: u64,
    /// How often the scene's file was taken up after somebody wrote it.
    reread: u64,
    /// Width of the whole picture, pixels.
    width_px: u32,
    /// Values that were turned; and those among them that the pictures have.
    turns: u64,
    turns_taken: u64,
    /// A large picture is being developed beside the desk's thread.
    is_developing: bool,
    stop: Arc<Stop>,
    is_closed: bool,
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
        let written = std::fs::read_to_string(&order.scene).ok();
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

    /// Takes a value that the page sent.
    ///
    /// # Errors
    /// Why the scene has no such value.
    pub(crate) fn turn(&self, path: &str, value: &Value) -> Result<(), String> {
        let mut state = held(&self.state);
        let text = if path == "width" {
            let width = value.as_u64().and_then(|w| u32::try_from(w).ok()).filter(|w| WIDTHS_PX.contains(w));
            width.ok_or("none of the widths")?.to_string()
        } else {
            let control = state.controls.iter().find(|c| c.path() == path).ok_or("no such control")?;
            control.text(value)?
        };
        match state.pending.iter_mut().find(|(other, _)| other == path) {
            Some((_, pending)) => *pending = text,
            None => state.pending.push((path.to_owned(), text)),
        }
        state.turns += 1;
        state.stop.stop();
        self.turned.notify_all();
        Ok(())
    }

    /// The first frame after this number, if there is one within the time.
    pub(crate) fn frame_after(&self, number: u64, patience: Duration) -> Option<Arc<Frame>> {
        let is_waiting =
            |state: &mut State| !state.is_closed && state.frame.as_ref().is_none_or(|frame| frame.number <= number);
        let waited = self.turned.wait_timeout_while(held(&self.state), patience, is_waiting);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        state.frame.clone().filter(|frame| frame.number > number)
    }

    /// What the scene's controls are and say now.
    pub(crate) fn controls(&self) -> Value {
        let state = held(&self.state);
        let name = self.order.scene.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        json!({
            "name": name,
            "controls": state.controls.iter().map(Control::to_json).collect::<Vec<_>>(),
            "widths": WIDTHS_PX,
            "saves": held(&self.written).is_some(),
            "changes": state.changes.len(),
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

/// Whether a scene can be viewed at all: faults are told at the start, and not by a page.
///
/// # Errors
/// Everything that is wrong with it.
pub(crate) fn looked_at(scene: &Path, overrides: &[String], isa: Isa) -> Result<Session, SessionError> {
    Session::open(scene, overrides, isa)
}
