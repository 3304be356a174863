//! Working state of a desk's thread: the scene, a small draft of it, and the changes that each of them still lacks.

use super::change::Change;
use super::history::{History, SavedState};
use super::watch::Stamps;
use crate::page::AspectRatio;
use crate::served::photograph::Small;
use spectra_core::frame::ExposureFrame;
use spectra_core::params::Node;
use spectra_scene::Negatives;
use spectra_session::{Control as Stop, Rendering, Session, SessionError};
use std::sync::Arc;
use std::time::Instant;

/// Width in pixels of a draft, the first picture after a change. `DRAFT_SAMPLES` is its number of samples per pixel.
const DRAFT_PX: u32 = 120;
const DRAFT_SAMPLES: u32 = 4;
/// Width, in pixels, at which a larger picture is developed first.
const QUICK_PX: u32 = 480;

/// A changed value that the whole picture does not have yet.
pub(super) struct PendingChange {
    pub(super) turned: Change,
    pub(super) is_drafted: bool,
}

/// Changes that the scene accepted but of which no picture was made yet. It may still turn out that none can be made.
pub(super) struct UnrenderedChange {
    pub(super) before: SavedState,
    /// Controls that were changed since.
    pub(super) controls: Vec<String>,
}

/// Times of the work.
#[derive(Clone, Copy)]
pub(super) struct WorkClock {
    /// Time of the last change.
    pub(super) started: Instant,
    /// Time when the scene's file was last checked.
    pub(super) looked: Instant,
    /// Time of the last work, until its memory is returned.
    pub(super) worked: Option<Instant>,
}

/// The exposure of the film, and the negatives developed from it.
pub(super) struct ExposedFilm {
    pub(super) exposure: Arc<ExposureFrame>,
    pub(super) negatives: Negatives,
    /// Number of rays traced for it.
    pub(super) rays: u64,
}

impl ExposedFilm {
    pub(super) fn of(rendering: Rendering) -> Self {
        Self::got(rendering.exposure, rendering.rays)
    }

    fn got(exposure: ExposureFrame, rays: u64) -> Self {
        Self { exposure: Arc::new(exposure), negatives: Negatives::default(), rays }
    }

    /// Returns a copy with fewer pixels; `None` if it has few already.
    pub(super) fn small(&self) -> Option<Self> {
        (self.exposure.size.width_px > QUICK_PX).then(|| Self::got(shrunk(&self.exposure, QUICK_PX), self.rays))
    }
}

/// Working state of a desk's thread.
pub(super) struct WorkState {
    pub(super) session: Session,
    /// A small draft of the same scene.
    pub(super) draft: Option<Session>,
    pub(super) shape: AspectRatio,
    pub(super) width_px: u32,
    pub(super) owed: Vec<PendingChange>,
    /// Texts `path=value` that the draft does not have yet.
    pub(super) behind: Vec<String>,
    pub(super) is_light_owed: bool,
    /// Whether the page waits for a draft. The first picture of a scene is a draft, too.
    pub(super) is_draft_owed: bool,
    pub(super) clock: WorkClock,
    /// Stops the current work when something changes.
    pub(super) stop: Arc<Stop>,
    /// Light of the session so far, until more is traced.
    pub(super) light: Option<Arc<ExposedFilm>>,
    /// Light with fewer pixels, from at least half of the rays last shown. It gives the first picture after a change of the development.
    pub(super) small: Option<Arc<ExposedFilm>>,
    /// Time that one sample of all pixels takes, s; `None` until it is measured.
    pub(super) pace_s: Option<f64>,
    /// Stamps of the files that the scene names, from when they were read.
    pub(super) stamps: Stamps,
    /// Text of the scene's file, and stamps of the files that it names, which were found not to be a valid scene.
    pub(super) refused: Option<(Option<String>, Stamps)>,
    /// Earlier states of the scene.
    pub(super) history: History,
    pub(super) unproved: Option<UnrenderedChange>,
    /// Pixels of a photograph, kept for the next exposure.
    pub(super) pixels: Option<Small>,
}

impl WorkState {
    /// Creates the state for a scene of which nothing is traced yet.
    pub(super) fn of(session: Session, shape: AspectRatio, width_px: u32) -> Self {
        Self {
            session,
            draft: None,
            shape,
            width_px,
            owed: Vec::new(),
            behind: Vec::new(),
            is_light_owed: true,
            is_draft_owed: true,
            clock: WorkClock { started: Instant::now(), looked: Instant::now(), worked: None },
            stop: Arc::new(Stop::new()),
            light: None,
            small: None,
            pace_s: None,
            stamps: Stamps::default(),
            refused: None,
            history: History::default(),
            unproved: None,
            pixels: None,
        }
    }

    /// Returns whether the film is exposed to a photograph's own pixels, without tracing rays.
    pub(super) fn is_flat(&self) -> bool {
        self.session.series().is_without_lens()
    }

    /// Returns whether there is nothing left to do for the picture.
    pub(super) fn is_done(&self) -> bool {
        let is_lit = || match self.is_flat() {
            true => self.light.is_some(),
            false => self.is_traced(),
        };
        self.owed.is_empty() && is_lit()
    }

    /// Returns whether the picture will have stars (diffraction at the aperture) that the light so far lacks.
    pub(super) fn is_without_stars(&self) -> bool {
        !self.is_flat() && has_stars(&self.session) && !self.is_traced()
    }

    /// Returns whether all samples are traced, or as many as the noise that the scene asks for takes.
    fn is_traced(&self) -> bool {
        self.session.is_complete()
    }

    /// Returns the light so far.
    pub(super) fn look(&mut self) -> Result<Arc<ExposedFilm>, SessionError> {
        let light = match self.light.take() {
            Some(light) => light,
            None if self.is_flat() => Arc::new(ExposedFilm::of(Small::expose(&mut self.pixels, &self.session)?)),
            // Stars take seconds, during which no change is noticed, so they come with the last sample.
            None if self.is_without_stars() => Arc::new(ExposedFilm::of(self.session.rendering_without_diffraction()?)),
            None => Arc::new(ExposedFilm::of(self.session.rendering()?)),
        };
        Ok(Arc::clone(self.light.insert(light)))
    }

    /// Adds changes to those that the whole picture lacks; for each control only the last value counts.
    pub(super) fn owe(&mut self, turned: Vec<Change>) {
        for turned in turned {
            self.owed.retain(|owed| owed.turned.control != turned.control);
            self.owed.push(PendingChange { turned, is_drafted: false });
        }
    }

    /// Returns the index of the picture of the series that is to be shown: the last one asked for, or the current one.
    pub(super) fn index_owed(&self) -> usize {
        self.owed.iter().rev().find_map(|owed| owed.turned.what.picture()).unwrap_or(self.session.index())
    }

    /// Drops the draft, and returns `false`: the page has none.
    pub(super) fn without_draft(&mut self) -> bool {
        self.draft = None;
        false
    }

    /// Returns the texts `path=value` that turn the scene into a draft.
    pub(super) fn draft_texts(&self) -> Vec<String> {
        let (session, shape) = (&self.session, &self.shape);
        let mut texts = vec![shape.resolution(DRAFT_PX), format!("render.samples={DRAFT_SAMPLES}")];
        // Searching for ghosts and computing diffraction at the stop takes seconds, so a draft does without.
        texts.extend(["render.reflections.order=0", "render.diffraction=false"].map(str::to_owned));
        let render = &session.scene().render;
        if let Some(rays) = session
            .scene()
            .params
            .node()
            .at_path("render.rays")
            .and_then(Node::as_str)
            .and_then(|text| text.parse::<f64>().ok())
        {
            let pixels = |width_px: u32| f64::from(width_px) * f64::from(shape.height_px(width_px));
            let whole = session.scene().imager.size().pixels() as f64 * f64::from(render.samples);
            let part = pixels(DRAFT_PX) * f64::from(DRAFT_SAMPLES) / whole;
            texts.push(format!("render.rays={}", (rays * part).ceil().max(1.0)));
        }
        texts
    }

    /// Replaces the scene by another one; changes that are not applied yet remain.
    pub(super) fn take_up(&mut self, session: Session, shape: AspectRatio) {
        let (owed, stop) = (std::mem::take(&mut self.owed), Arc::clone(&self.stop));
        *self = Self { owed, stop, clock: self.clock, ..Self::of(session, shape, self.width_px) };
    }
}

/// Returns whether lights get stars. If the scene does not say, they do if its source has lights.
pub(super) fn has_stars(session: &Session) -> bool {
    let scene = session.scene();
    scene.render.diffraction.unwrap_or_else(|| scene.source.split().is_some())
}

/// Returns an exposure with fewer pixels, each the mean of those that it covers.
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
