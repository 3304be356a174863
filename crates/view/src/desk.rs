//! What one page works on: a session of its own, on a thread of its own.
//!
//! The page leaves changes on the desk and takes frames from it. Changes of one control that arrive while a picture is traced count
//! once, by the last of them; the work at hand is stopped for them. A desk that nobody asks anything of is cleared.

use crate::controls::{self, Control};
use crate::parts::{fault_json, packed, said};
use crate::{save, section};
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::frame::{DisplayPicture, ExposureFrame};
use spectra_scene::Shot;
use spectra_session::{Control as Stop, Session, SessionError, Threads};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A page that asks nothing for so long is gone.
const PATIENCE: Duration = Duration::from_secs(25);
/// Light is traced in pieces of about this time, so that the picture is seen to grow.
const PIECE_S: f64 = 0.12;
/// Widths of the picture that a page may choose, pixels.
const WIDTHS_PX: [u32; 4] = [240, 480, 960, 1920];

/// What is rendered, and by what means.
#[derive(Clone, Debug)]
pub(crate) struct Order {
    pub scene: PathBuf,
    pub overrides: Vec<String>,
    pub isa: Isa,
    pub threads: usize,
}

/// A picture for the page.
pub(crate) struct Frame {
    pub number: u64,
    /// A head as JSON, with its length before it, and linear red, green and blue as `f32`, little-endian.
    pub bytes: Vec<u8>,
    exposure: ExposureFrame,
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
        std::thread::Builder::new().name("desk".to_owned()).spawn(move || own.work())?;
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
        })
    }

    /// What a pixel of the last frame got, channel by channel.
    pub(crate) fn pixel(&self, x: u32, y: u32) -> Option<Value> {
        let frame = held(&self.state).frame.clone()?;
        let size = frame.exposure.size;
        if x >= size.width_px || y >= size.height_px {
            return None;
        }
        let at = y as usize * size.width_px as usize + x as usize;
        let channels =
            frame.exposure.channels.iter().map(|c| json!({"name": c.name, "unit": c.unit, "value": c.values.get(at)}));
        Some(json!({"frame": frame.number, "channels": channels.collect::<Vec<_>>()}))
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

    fn work(&self) {
        let mut session = match Session::open(&self.order.scene, &self.order.overrides, self.order.isa) {
            Ok(session) => session,
            Err(error) => {
                self.tell(Some(said(&error, "")));
                return self.close();
            }
        };
        let size = session.scene().imager.size();
        let aspect = f64::from(size.height_px) / f64::from(size.width_px);
        self.adopt(&session);
        let resolution = |width: u32| {
            let height = (f64::from(width) * aspect).round().max(1.0);
            format!("imager.resolution=[{width}, {height}]")
        };
        if let Err(error) = session.change(&resolution(WIDTHS_PX[1])) {
            self.tell(Some(said(&error, "imager.resolution")));
        }
        self.adopt(&session);
        let mut pace_s: Option<f64> = None;
        let mut started = Instant::now();
        loop {
            let (pending, stop) = {
                let all = u64::from(session.scene().render.samples);
                let is_idle = |state: &mut State| {
                    !state.is_closed && state.pending.is_empty() && (session.samples() >= all || state.fault.is_some())
                };
                let waited = self.turned.wait_timeout_while(held(&self.state), Duration::from_secs(1), is_idle);
                let (mut state, waited) = waited.unwrap_or_else(PoisonError::into_inner);
                if held(&self.seen).elapsed() > PATIENCE {
                    state.is_closed = true;
                    self.turned.notify_all();
                }
                if state.is_closed {
                    return;
                }
                if waited.timed_out() && state.pending.is_empty() {
                    continue;
                }
                state.stop = Arc::new(Stop::new());
                (std::mem::take(&mut state.pending), Arc::clone(&state.stop))
            };
            let mut is_light_kept = true;
            if !pending.is_empty() {
                started = Instant::now();
                let mut trouble = None;
                for (path, text) in &pending {
                    let text =
                        if path == "width" { resolution(text.parse().unwrap_or(WIDTHS_PX[1])) } else { text.clone() };
                    match session.change(&text) {
                        Ok(kept) => is_light_kept &= kept.light,
                        Err(error) => trouble = Some(said(&error, path)),
                    }
                    if trouble.is_none() && path != "width" {
                        self.remember(path, &text);
                    }
                }
                if !is_light_kept {
                    pace_s = None;
                }
                self.tell(trouble);
                self.adopt(&session);
            }
            let all = u64::from(session.scene().render.samples);
            if !(is_light_kept && session.has_light() && !pending.is_empty()) && session.samples() < all {
                let first = session.samples() == 0;
                let more = pace_s.map_or(1.0, |pace_s| (PIECE_S / pace_s).floor()).clamp(1.0, 4096.0) as u64;
                let from = Instant::now();
                let step = session.step(more.min(all - session.samples()), &Threads(self.order.threads), &stop);
                if let Err(error) = step {
                    self.tell(Some(said(&error, "")));
                    continue;
                }
                // The first sample pays for what is made ready once.
                if !first && !stop.should_stop() {
                    pace_s = Some(from.elapsed().as_secs_f64().max(1e-6) / more as f64);
                } else if first {
                    pace_s = Some(from.elapsed().as_secs_f64().clamp(1e-6, PIECE_S));
                }
                // What was stopped before a whole sample of every pixel is no picture.
                if session.samples() == 0 {
                    continue;
                }
            }
            match self.picture(&mut session, started) {
                Ok(()) => {}
                Err(error) => self.tell(Some(said(&error, ""))),
            }
        }
    }

    /// Keeps what was set, for the scene's file.
    fn remember(&self, path: &str, text: &str) {
        let mut state = held(&self.state);
        state.changes.retain(|(other, _)| other != path);
        state.changes.push((path.to_owned(), text.to_owned()));
    }

    /// Shows the scene's controls and lens as they are now.
    fn adopt(&self, session: &Session) {
        let controls = controls::of_scene(session.scene().params.node());
        let mut state = held(&self.state);
        state.controls = controls;
        if !state.scene.as_ref().is_some_and(|before| Arc::ptr_eq(&before.lens, &session.scene().lens)) {
            state.section = [None, None];
        }
        state.scene = Some(Arc::clone(session.scene()));
        state.scenes += 1;
        self.turned.notify_all();
    }

    /// Says what is wrong, or that nothing is any more.
    fn tell(&self, fault: Option<Value>) {
        let mut state = held(&self.state);
        let is_new = fault.is_some() || state.fault.is_some();
        state.fault = fault;
        if is_new {
            // The page hears of it by a frame: the last one again, under a new number.
            let before = state.frame.take();
            state.number += 1;
            let head = json!({"frame": state.number, "fault": state.fault});
            let exposure = before.map_or_else(empty, |frame| frame.exposure.clone());
            state.frame = Some(Arc::new(Frame { number: state.number, bytes: packed(&head, &[]), exposure }));
        }
        self.turned.notify_all();
    }

    /// Develops the light so far and gives it to the page.
    fn picture(&self, session: &mut Session, started: Instant) -> Result<(), SessionError> {
        let rendering = session.look()?;
        let scene = Arc::clone(session.scene());
        let times = scene.film_times(&rendering.exposure);
        let developed = {
            let shot = Shot::new(&scene, &rendering.exposure, &times, &[], self.order.isa);
            shot.pictures().map_err(SessionError::Failed)?.to_vec()
        };
        let Some((_, picture)) = developed.into_iter().next() else { return Ok(()) };
        let warnings: Vec<Value> = session.warnings().map(|w| fault_json(&w.0)).collect();
        let mut state = held(&self.state);
        state.number += 1;
        let DisplayPicture { width_px, height_px, rgb } = picture;
        let head = json!({
            "frame": state.number,
            "scene": state.scenes,
            "fault": state.fault,
            "width": width_px,
            "height": height_px,
            "samples": session.samples(),
            "of": scene.render.samples,
            "rays": rendering.rays,
            "since_change_ms": started.elapsed().as_millis() as u64,
            "exposure_s": times.first().map_or(1.0, |time| time.time_s),
            "lens": scene.lens.name,
            "film": times.first().map(|time| time.film.clone()),
            "focus": scene.focus.to_string(),
            "warnings": warnings,
        });
        let mut exposure = rendering.exposure;
        // What each film got, by its own time.
        for time in &times {
            for channel in exposure.channels.get_mut(time.channels.clone()).into_iter().flatten() {
                channel.values.iter_mut().for_each(|v| *v *= time.gain as f32);
            }
        }
        let bytes = packed(&head, bytemuck::cast_slice(&rgb));
        state.frame = Some(Arc::new(Frame { number: state.number, bytes, exposure }));
        self.turned.notify_all();
        Ok(())
    }
}

fn empty() -> ExposureFrame {
    let size = spectra_core::frame::FrameSize { width_px: 0, height_px: 0, width_mm: 0.0, height_mm: 0.0 };
    ExposureFrame { size, channels: Vec::new() }
}

/// Whether a scene can be viewed at all: faults are told at the start, and not by a page.
///
/// # Errors
/// Everything that is wrong with it.
pub(crate) fn looked_at(scene: &Path, overrides: &[String], isa: Isa) -> Result<Session, SessionError> {
    Session::open(scene, overrides, isa)
}
