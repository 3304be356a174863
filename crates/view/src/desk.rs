//! What one page works on: a session of its own, on a thread of its own.
//!
//! The page leaves changes on the desk and takes frames from it. Changes of one control that arrive while a picture is traced count
//! once, by the last of them; the work at hand is stopped for them. A desk that nobody asks anything of is cleared.

use crate::controls::{self, Control};
use crate::parts::{fault_json, packed, said, spectra};
use crate::{save, section};
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::frame::{DisplayPicture, ExposureFrame};
use spectra_core::params::Node;
use spectra_scene::{NumberFamily, Shot};
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
/// The first picture after a change: its width, pixels, and its samples of a pixel.
const DRAFT_PX: u32 = 120;
const DRAFT_SAMPLES: u32 = 4;
/// What a draft has of its own.
const NOT_DRAFTED: [&str; 4] = ["width", "render.samples", "render.rays", "render.noise"];
/// After a draft the whole picture is begun when nothing was turned for so long.
const REST: Duration = Duration::from_millis(60);
/// The scene's file is looked at so often.
const GLANCE: Duration = Duration::from_millis(300);
/// A scene's file that is larger than this is none.
const MAX_SCENE_BYTES: u64 = 1 << 22;
/// Developed first at this width where the whole is larger, pixels.
const QUICK_PX: u32 = 480;

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
    stop: Arc<Stop>,
    is_closed: bool,
}

/// A value that was turned and that the whole picture does not have yet.
struct Owed {
    path: String,
    /// `path=value`; of the width, the number alone.
    text: String,
    is_drafted: bool,
}

/// How a picture comes to the page.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Detail {
    /// A small one, of few samples.
    Draft,
    /// All of its pixels; where they are many, fewer before.
    Quick,
    /// All of its pixels.
    Whole,
}

/// What came of a draft.
enum Drafted {
    /// The page has it.
    Shown,
    /// The light stays: the whole picture is as soon developed.
    SameLight,
    /// There is none.
    None,
}

/// What the thread of a desk has in hand.
struct Hand {
    session: Session,
    /// The same scene, small.
    draft: Option<Session>,
    shape: Shape,
    width_px: u32,
    owed: Vec<Owed>,
    is_light_owed: bool,
    /// A sample of all pixels takes so long.
    pace_s: Option<f64>,
    /// A text of the scene's file that is no scene.
    refused: Option<String>,
}

impl Hand {
    /// Of values of one control the last counts.
    fn owe(&mut self, turned: Vec<(String, String)>) {
        for (path, text) in turned {
            self.owed.retain(|owed| owed.path != path);
            self.owed.push(Owed { path, text, is_drafted: false });
        }
    }

    fn without_draft(&mut self) -> Drafted {
        self.draft = None;
        Drafted::None
    }

    /// Goes on with another scene.
    fn take_up(&mut self, session: Session, shape: Shape) {
        *self = Self {
            session,
            draft: None,
            shape,
            width_px: self.width_px,
            owed: std::mem::take(&mut self.owed),
            is_light_owed: true,
            pace_s: None,
            refused: None,
        };
    }
}

/// The shape of a scene's picture, as its file has it.
struct Shape {
    /// Height over width, in pixels.
    aspect: f64,
}

impl Shape {
    fn of(session: &Session) -> Self {
        let size = session.scene().imager.size();
        Self { aspect: f64::from(size.height_px) / f64::from(size.width_px) }
    }

    fn height_px(&self, width_px: u32) -> u32 {
        (f64::from(width_px) * self.aspect).round().max(1.0) as u32
    }

    fn resolution(&self, width_px: u32) -> String {
        format!("imager.resolution=[{width_px}, {}]", self.height_px(width_px))
    }

    /// `path=value` for the whole picture.
    fn text(&self, owed: &Owed) -> Option<String> {
        if owed.path != "width" {
            return Some(owed.text.clone());
        }
        owed.text.parse().ok().map(|width_px| self.resolution(width_px))
    }

    /// What makes a draft of a scene.
    fn draft(&self, session: &Session) -> Vec<String> {
        let mut texts = vec![self.resolution(DRAFT_PX), format!("render.samples={DRAFT_SAMPLES}")];
        let render = &session.scene().render;
        if let Some(rays) = session
            .scene()
            .params
            .node()
            .at_path("render.rays")
            .and_then(Node::as_str)
            .and_then(|text| text.parse::<f64>().ok())
        {
            let pixels = |width_px: u32| f64::from(width_px) * f64::from(self.height_px(width_px));
            let whole = session.scene().imager.size().pixels() as f64 * f64::from(render.samples);
            let part = pixels(DRAFT_PX) * f64::from(DRAFT_SAMPLES) / whole;
            texts.push(format!("render.rays={}", (rays * part).ceil().max(1.0)));
        }
        texts
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
        let [x, y] = [x, y].map(|at| u32::try_from(part(at)).unwrap_or(u32::MAX));
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

    fn work(&self) {
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
            is_light_owed: true,
            pace_s: None,
            refused: None,
        };
        let mut started = Instant::now();
        // The first picture of all is a draft, too.
        let mut is_asked_for_draft = true;
        let mut looked = Instant::now();
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
                    return;
                }
                state.stop = Arc::new(Stop::new());
                state.turns_taken = state.turns;
                (std::mem::take(&mut state.pending), Arc::clone(&state.stop))
            };
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
            if !hand.owed.is_empty() {
                let is_light_kept = self.settle(&mut hand);
                if is_light_kept && hand.session.has_light() {
                    if let Err(error) = self.picture(&mut hand.session, &hand.shape, started, Detail::Quick) {
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
                Some(pace_s) => (PIECE_S / pace_s).floor().clamp(1.0, 4096.0) as u64,
            };
            let from = Instant::now();
            let more = more.min(all - done);
            if let Err(error) = hand.session.step(more, &Threads(self.order.threads), &stop) {
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
            if let Err(error) = self.picture(&mut hand.session, &hand.shape, started, Detail::Whole) {
                self.tell(Some(said(&error, "")));
            }
        }
    }

    /// Shows a small picture of few samples of the scene as it is to be.
    fn drafted(&self, hand: &mut Hand, started: Instant) -> Drafted {
        let workers = Threads(self.order.threads);
        let mut same_light = hand.draft.is_some() && hand.session.has_light();
        match &mut hand.draft {
            None => {
                let mut texts: Vec<String> = hand.owed.iter().filter_map(|owed| hand.shape.text(owed)).collect();
                texts.extend(hand.shape.draft(&hand.session));
                // What cannot be is said of the whole scene.
                hand.draft = hand.session.branch(&texts).ok();
            }
            Some(draft) => {
                for owed in hand.owed.iter().filter(|owed| !owed.is_drafted && !NOT_DRAFTED.contains(&&*owed.path)) {
                    match draft.change_on(&owed.text, &workers) {
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
        if traced.is_err() || draft.samples() == 0 || self.picture(draft, &hand.shape, started, Detail::Draft).is_err()
        {
            return hand.without_draft();
        }
        Drafted::Shown
    }

    /// Sets the scene as it is to be; says whether the light is the same.
    fn settle(&self, hand: &mut Hand) -> bool {
        let is_drafted = hand.draft.is_some() && hand.is_light_owed;
        let (mut is_light_kept, mut trouble) = (true, None);
        for owed in std::mem::take(&mut hand.owed) {
            let Some(text) = hand.shape.text(&owed) else { continue };
            match hand.session.change_on(&text, &Threads(self.order.threads)) {
                Ok(kept) => {
                    is_light_kept &= kept.light;
                    if owed.path == "width" {
                        hand.width_px = owed.text.parse().unwrap_or(hand.width_px);
                    } else {
                        self.remember(&owed.path, &text);
                    }
                }
                Err(error) => {
                    trouble = Some(said(&error, &owed.path));
                    // The draft may have taken it.
                    hand.draft = None;
                }
            }
        }
        hand.is_light_owed = false;
        if !is_light_kept {
            hand.pace_s = None;
        }
        self.tell(trouble);
        self.adopt(&hand.session, is_drafted);
        is_light_kept
    }

    /// Takes up the scene's file where somebody wrote it since; says whether there is another scene now. A file that is broken is
    /// told, and all stays as it is.
    fn is_written_anew(&self, hand: &mut Hand) -> bool {
        let mut written = held(&self.written);
        let Some(before) = &*written else { return false };
        let is_small = std::fs::metadata(&self.order.scene).is_ok_and(|found| found.len() <= MAX_SCENE_BYTES);
        if !is_small {
            return false;
        }
        // A file that is just being replaced is there the next time.
        let Ok(now) = std::fs::read_to_string(&self.order.scene) else { return false };
        if now == *before {
            if hand.refused.take().is_some() {
                self.tell(None);
            }
            return false;
        }
        if hand.refused.as_ref() == Some(&now) {
            return false;
        }
        // What the page set stays, but for what the file now says otherwise.
        let mut changes = held(&self.state).changes.clone();
        changes.retain(|(path, _)| save::says_same(before, &now, path));
        let opened = Session::open(&self.order.scene, &self.order.overrides, self.order.isa).and_then(|session| {
            let shape = Shape::of(&session);
            let mut texts: Vec<String> = changes.iter().map(|(_, text)| text.clone()).collect();
            texts.push(shape.resolution(hand.width_px));
            session.branch(&texts).map(|session| (session, shape))
        });
        match opened {
            Ok((session, shape)) => {
                *written = Some(now);
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
                hand.refused = Some(now);
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
    fn tell(&self, fault: Option<Value>) {
        let mut state = held(&self.state);
        let is_new = fault.is_some() || state.fault.is_some();
        state.fault = fault;
        if is_new {
            // The page hears of it by a frame: the last one again, under a new number.
            let before = state.frame.take();
            state.number += 1;
            let head = json!({"frame": state.number, "fault": state.fault});
            let (exposure, whole_px) = before.map_or_else(|| (empty(), 0), |f| (f.exposure.clone(), f.whole_px));
            state.frame = Some(Arc::new(Frame { number: state.number, bytes: packed(&head, &[]), exposure, whole_px }));
        }
        self.turned.notify_all();
    }

    /// Develops the light so far and gives it to the page.
    fn picture(
        &self,
        session: &mut Session,
        shape: &Shape,
        started: Instant,
        detail: Detail,
    ) -> Result<(), SessionError> {
        let rendering = session.look()?;
        if detail == Detail::Quick && rendering.exposure.size.width_px > QUICK_PX {
            let small = shrunk(&rendering.exposure, QUICK_PX);
            // What cannot be developed small is seen whole.
            let _ = self.show(session, shape, started, small, rendering.rays, true);
        }
        self.show(session, shape, started, rendering.exposure, rendering.rays, detail == Detail::Draft)
    }

    fn show(
        &self,
        session: &Session,
        shape: &Shape,
        started: Instant,
        mut exposure: ExposureFrame,
        rays: u64,
        is_draft: bool,
    ) -> Result<(), SessionError> {
        let scene = Arc::clone(session.scene());
        let times = scene.film_times(&exposure);
        let developed = {
            let shot = Shot::new(&scene, &exposure, &times, &[], self.order.isa);
            shot.pictures().map_err(SessionError::Failed)?.to_vec()
        };
        let Some((_, picture)) = developed.into_iter().next() else { return Ok(()) };
        let warnings: Vec<Value> = session.warnings().map(|w| fault_json(&w.0)).collect();
        // What each film got, by its own time.
        for time in &times {
            for channel in exposure.channels.get_mut(time.channels.clone()).into_iter().flatten() {
                channel.values.iter_mut().for_each(|v| *v *= time.gain as f32);
            }
        }
        let DisplayPicture { width_px, height_px, rgb } = picture;
        let mut state = held(&self.state);
        state.number += 1;
        let whole_px = if is_draft { state.width_px } else { width_px };
        let head = json!({
            "frame": state.number,
            "scene": state.scenes,
            "lens_drawn": state.lenses,
            "reread": state.reread,
            "turns": state.turns_taken,
            "fault": state.fault,
            "width": whole_px,
            "height": if is_draft { shape.height_px(whole_px) } else { height_px },
            "light": [width_px, height_px],
            "draft": is_draft,
            "samples": if is_draft { 0 } else { session.samples() },
            "of": scene.render.samples,
            "rays": rays,
            "since_change_ms": started.elapsed().as_millis() as u64,
            "exposure_s": times.first().map_or(1.0, |time| time.time_s),
            "lens": scene.lens.name,
            "film": times.first().map(|time| time.film.clone()),
            "focus": scene.focus.to_string(),
            "warnings": warnings,
        });
        let bytes = packed(&head, bytemuck::cast_slice(&rgb));
        state.frame = Some(Arc::new(Frame { number: state.number, bytes, exposure, whole_px }));
        self.turned.notify_all();
        Ok(())
    }
}

/// The same exposure of fewer pixels: each has the mean of those that it covers.
fn shrunk(exposure: &ExposureFrame, width_px: u32) -> ExposureFrame {
    let [from_x, from_y] = [exposure.size.width_px, exposure.size.height_px].map(|n| n as usize);
    let to_x = (width_px as usize).min(from_x).max(1);
    let to_y = (from_y * to_x).div_ceil(from_x).clamp(1, from_y.max(1));
    let span = |i: usize, from: usize, to: usize| i * from / to..((i + 1) * from / to).max(i * from / to + 1);
    let mut small = exposure.clone();
    (small.size.width_px, small.size.height_px) = (to_x as u32, to_y as u32);
    for channel in &mut small.channels {
        let values = std::mem::take(&mut channel.values);
        let mean = |(x, y): (usize, usize)| {
            let (columns, rows) = (span(x, from_x, to_x), span(y, from_y, to_y));
            let count = (columns.len() * rows.len()) as f64;
            let sum: f64 = rows.flat_map(|row| &values[row * from_x..][columns.clone()]).map(|v| f64::from(*v)).sum();
            (sum / count) as f32
        };
        channel.values = (0..to_y).flat_map(|y| (0..to_x).map(move |x| (x, y))).map(mean).collect();
    }
    small
}

/// Whether a lens is one piece of glass between plane faces that are tilted to each other.
fn is_prism(lens: &spectra_lens::Lens) -> bool {
    let [first, second] = &lens.elements[..] else { return false };
    let normal = |element: &spectra_lens::Element| element.pose.direction(glam::DVec3::Z);
    let is_plane = |element: &spectra_lens::Element| element.surface.vertex_curvature_per_mm() == (0.0, 0.0);
    is_plane(first) && is_plane(second) && normal(first).dot(normal(second)).abs() < 0.9999
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
