//! The part of a page's session that needs neither threads nor a clock: controls, counters, errors, and the last picture.
//!
//! A server keeps it behind a lock and adds drafts, undo and the scene's file (`served::page_session`). Without a server (`crates/web`) it
//! stands beside the session. Both lend their own workers to the session, and a server adds the times that it measures to a picture's head.

use crate::control::Control;
use crate::controls::of_session;
use crate::parts::{halves, joined, packed, pixel};
use crate::series_values::SeriesValues;
use serde_json::{Value, json};
use spectra_core::Isa;
use spectra_core::frame::{DisplayPicture, ExposureFrame};
use spectra_core::params::Fault;
use spectra_scene::{FilmTime, Negatives, Scene, Shot};
use spectra_session::{Session, SessionError};
use std::sync::Arc;

/// Widths of the picture, in pixels, that a page may choose. The second is the initial width.
pub const WIDTHS_PX: [u32; 4] = [240, 480, 960, 1920];

/// A change of the scene that a page asks for.
#[derive(Clone, Debug)]
pub enum ChangeKind {
    /// Sets values in the scene together, each by a text `path=value`; the first text is that of the control.
    Set(Vec<String>),
    /// Sets the width of the picture, pixels.
    Width(u32),
    /// Selects a picture of the series by its index, from 0.
    Picture(usize),
}

impl ChangeKind {
    /// Returns the index of the picture of the series that the change selects; `None` if it selects none.
    #[must_use]
    pub fn picture(&self) -> Option<usize> {
        match self {
            Self::Picture(index) => Some(*index),
            _ => None,
        }
    }

    /// Returns the texts `path=value` that the change sets in a scene. `shape` is the aspect ratio of its picture, which gives
    /// the height for a width.
    #[must_use]
    pub fn texts(&self, shape: &AspectRatio) -> Vec<String> {
        match self {
            Self::Set(texts) => texts.clone(),
            Self::Width(width_px) => vec![shape.resolution(*width_px)],
            Self::Picture(_) => Vec::new(),
        }
    }
}

/// The aspect ratio of a scene's picture, from the scene's file.
#[derive(Clone, Copy, Debug)]
pub struct AspectRatio {
    /// Height divided by width, both in pixels.
    aspect: f64,
}

impl AspectRatio {
    /// Returns the aspect ratio of the session's picture.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let size = session.scene().imager.size();
        Self { aspect: f64::from(size.height_px) / f64::from(size.width_px) }
    }

    pub(crate) fn height_px(&self, width_px: u32) -> u32 {
        (f64::from(width_px) * self.aspect).round().max(1.0) as u32
    }

    pub(crate) fn resolution(&self, width_px: u32) -> String {
        format!("imager.resolution=[{width_px}, {}]", self.height_px(width_px))
    }
}

/// The controls of a scene and, for a series, the values that each of its pictures was rendered with.
#[derive(Default)]
pub struct SceneControls {
    all: Vec<Control>,
    /// Values of the pictures of the series.
    picks: SeriesValues,
}

impl SceneControls {
    /// Gathers the controls of a session's scene.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        Self { all: of_session(session), picks: SeriesValues::of(session) }
    }
}

/// A developed picture in the format of a page, and the exposure from which it was developed.
pub struct PagePicture {
    size_px: [u32; 2],
    /// Linear red, green and blue in the format of [`halves`].
    light: Vec<u8>,
    exposure: Arc<ExposureFrame>,
    times: Vec<FilmTime>,
}

impl PagePicture {
    /// Develops an exposure of a scene; `times` are the exposure times of its films. A film whose negative is in `negatives` is
    /// only printed again. Returns `None` if the imager gives no picture.
    ///
    /// # Errors
    /// The reason why there is no picture.
    pub fn develop(
        scene: &Scene,
        exposure: Arc<ExposureFrame>,
        times: Vec<FilmTime>,
        negatives: &Negatives,
        isa: Isa,
    ) -> Result<Option<Self>, SessionError> {
        let shot = Shot::new(scene, &exposure, &times, &[], isa).with_negatives(negatives);
        let developed = shot.pictures().map_err(SessionError::of_stage)?.first();
        let picture = developed.map(|(_, DisplayPicture { width_px, height_px, rgb })| {
            ([*width_px, *height_px], halves(rgb.as_flattened()))
        });
        drop(shot);
        Ok(picture.map(|(size_px, light)| Self { size_px, light, exposure, times }))
    }

    /// Width and height of the picture, pixels.
    #[must_use]
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }
}

/// A picture that the page has.
pub(crate) struct Frame {
    pub(crate) number: u64,
    /// The length of the head, the head as JSON, and linear red, green and blue in the format of [`halves`].
    pub(crate) bytes: Vec<u8>,
    exposure: Arc<ExposureFrame>,
    times: Vec<FilmTime>,
    /// Width of the whole picture in pixels. For a draft it exceeds the width of the picture in `bytes`.
    whole_px: u32,
}

impl Frame {
    /// Returns the exposure of a pixel of the whole picture in each channel; `None` if there is no such pixel.
    pub(crate) fn pixel(&self, at: [u32; 2]) -> Option<Value> {
        // In a draft, the coarser pixel that covers the place.
        let part = |at: u32| u64::from(at) * u64::from(self.exposure.size.width_px) / u64::from(self.whole_px.max(1));
        pixel(&self.exposure, &self.times, self.number, at.map(part))
    }
}

/// The state that a page keeps of its session.
#[derive(Default)]
pub struct PageState {
    controls: SceneControls,
    pub(crate) scene: Option<Arc<Scene>>,
    /// Width of the whole picture in pixels; `widths_px` are the widths to choose from.
    pub(crate) width_px: u32,
    pub(crate) widths_px: Vec<u32>,
    /// The last picture made for the page.
    pub(crate) frame: Option<Arc<Frame>>,
    /// Number of pictures and messages so far; the last one has this number.
    pub(crate) number: u64,
    /// Number of times that the scene changed; when it changes, the page requests the controls again.
    pub(crate) scenes: u64,
    /// Number of times that the lens changed; when it changes, the page requests the drawing again.
    lenses: u64,
}

impl PageState {
    /// Creates the state of a page that has no picture of the session yet.
    #[must_use]
    pub fn of(session: &Session) -> Self {
        let mut page = Self { widths_px: WIDTHS_PX.to_vec(), ..Self::default() };
        page.draw(session.scene(), false);
        page.adopt(session, SceneControls::of(session));
        page
    }

    /// Converts a setting made on the page to the change it asks for. `path` is that of a control, or `width` for the width of
    /// the picture in pixels; `value` is the new value.
    ///
    /// If the control varies over a series, the change selects a picture with this value. If several pictures have it, the change
    /// selects the one that shares most other values with picture `from` (index from 0). `None` stands for the current picture.
    ///
    /// # Errors
    /// The reason why there is no such control, value or picture.
    pub fn change(&self, path: &str, value: &Value, from: Option<usize>) -> Result<ChangeKind, Fault> {
        if path == "width" {
            let width = value.as_u64().and_then(|width| u32::try_from(width).ok());
            let width = width.filter(|width| self.widths_px.contains(width));
            return width.map(ChangeKind::Width).ok_or_else(|| Fault::new("not one of the widths"));
        }
        let control = self.controls.all.iter().find(|control| control.path() == path);
        let control = control.ok_or_else(|| Fault::new("no such control"))?;
        let text = control.text(value).map_err(Fault::new)?;
        match control.picked(value) {
            Some(word) => {
                let picture = self.controls.picks.with(from, path, &word);
                picture.map(ChangeKind::Picture).ok_or_else(|| Fault::new("no picture of the series has this value"))
            }
            None => Ok(ChangeKind::Set(vec![text])),
        }
    }

    /// Takes over `controls` and the width of the session's scene after the scene changed.
    pub fn adopt(&mut self, session: &Session, controls: SceneControls) {
        self.controls = controls;
        self.width_px = session.scene().imager.size().width_px;
        self.scenes += 1;
    }

    /// Takes over a scene, and returns whether its lens counts as changed, so that the page requests the drawing again. The lens
    /// counts as unchanged if `is_drawn`, or if it is the one before.
    pub fn draw(&mut self, scene: &Arc<Scene>, is_drawn: bool) -> bool {
        let is_same = |before: &Arc<Scene>| Arc::ptr_eq(&before.lens, &scene.lens);
        let is_other = !is_drawn && !self.scene.as_ref().is_some_and(is_same);
        self.lenses += u64::from(is_other);
        self.scene = Some(Arc::clone(scene));
        is_other
    }

    /// Makes `picture` the last picture of the page, and returns it packed for the page. `whole_px` is the width and height in
    /// pixels at which the page shows it. `head` holds facts to add to its head. `fault` is the error that the page shows; `None`
    /// for no error.
    pub fn show(&mut self, picture: PagePicture, whole_px: [u32; 2], head: Value, fault: Option<&Value>) -> &[u8] {
        let PagePicture { light, exposure, times, .. } = picture;
        self.number += 1;
        let own = json!({
            "frame": self.number,
            "scene": self.scenes,
            "lens_drawn": self.lenses,
            "fault": fault,
            "width": whole_px[0],
            "height": whole_px[1],
        });
        let bytes = packed(&joined(head, own), &light);
        let frame = Frame { number: self.number, bytes, exposure, times, whole_px: whole_px[0] };
        &self.frame.insert(Arc::new(frame)).bytes
    }

    /// Returns the controls of the scene with their current values as JSON, together with the entries of `own`. `name` is the
    /// name of the scene for the page, if it has one.
    #[must_use]
    pub fn controls(&self, name: Option<&str>, own: Value) -> Value {
        let controls: Vec<Value> = self.controls.all.iter().map(Control::to_json).collect();
        joined(own, json!({"name": name, "controls": controls, "widths": self.widths_px, "width": self.width_px}))
    }

    /// Returns the exposure at a pixel of the last picture in each channel as JSON. `at` is the column and row in the picture as
    /// the page shows it. `None` if there is no such pixel.
    #[must_use]
    pub fn pixel(&self, at: [u32; 2]) -> Option<Value> {
        self.frame.as_ref()?.pixel(at)
    }
}
