//! A session: one picture of a scene, while it is rendered.
//!
//! It holds the scene, the renderer and the light so far. Stages are shared between scenes by `Arc`. A change sets a value in the tree as
//! `--set` does and assembles the scene again; sections that are unchanged keep their stages. The light is kept if source, lens, imager,
//! wavelength density and channels are still the same stages ([`ValidResults`]).

mod snapshot;

pub use snapshot::{Snapshot, ValidResults};

use crate::files::Files;
use crate::{Control, Names, Rendering, SessionError, SessionOptions, SingleThread, Workers, header};
use spectra_core::frame::ExposureFrame;
use spectra_core::params::{Faults, Warning};
use spectra_core::sink::Sink;
use spectra_core::stage::{Still, WavelengthDensity};
use spectra_render::{Light, RenderError, RenderOptions, Renderer};
use spectra_scene::{Developed, Scene, Series, Shot, ViewSearch, load_series};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A session on one picture of a scene: its stages, and its light so far.
pub struct Session {
    series: Series,
    options: SessionOptions,
    scene: Arc<Scene>,
    /// The prepared scene and its light, once light is asked for.
    ready: Option<(Renderer, Light)>,
    /// A wavelength density that fits the scene, if one is known from before.
    density: Option<Arc<dyn WavelengthDensity>>,
    /// The renderer of another picture, whose search may serve this one.
    earlier: Option<Renderer>,
}

impl Session {
    /// Opens the scene of a file, with texts `path=value` on top.
    ///
    /// # Errors
    /// Every fault of the scene.
    pub fn open(path: &Path, overrides: &[String], options: SessionOptions) -> Result<Self, SessionError> {
        Self::new(load_series(path, overrides)?, options)
    }

    /// Opens a picture of a series.
    ///
    /// # Errors
    /// Every fault of the scene.
    pub fn new(series: Series, options: SessionOptions) -> Result<Self, SessionError> {
        Self::sharing(series, (None, None), options)
    }

    /// Opens a picture of a series. Takes over the stages of `other` where both scenes have the same section, and what the renderer of an
    /// `earlier` picture has found if no more than their seeds differ.
    pub(crate) fn sharing(
        series: Series,
        (other, earlier): (Option<Arc<Scene>>, Option<Renderer>),
        options: SessionOptions,
    ) -> Result<Self, SessionError> {
        let search = ViewSearch { effort: options.effort, workers: &SingleThread };
        let scene = series.scene_between(options.picture, other, None, search)?.into();
        Ok(Self { series, options, scene, ready: None, density: None, earlier })
    }

    /// Returns another session, without light, with these values `path=value` on top. It shares the stages that do not depend on
    /// them. `self` does not change.
    ///
    /// # Errors
    /// Every fault of the changed scene.
    pub fn branch(&self, texts: &[String], options: SessionOptions) -> Result<Self, SessionError> {
        Self::sharing(self.series.with_all(texts)?, (Some(Arc::clone(&self.scene)), None), options)
    }

    /// Options of this session, with the index of its current picture.
    #[must_use]
    pub fn options(&self) -> SessionOptions {
        self.options
    }

    /// Says before the scene is prepared whether the light itself is kept in a file that the scene does not name.
    pub(crate) fn keep_light(&mut self, keeps: bool) {
        self.options.keeps_light = keeps;
    }

    /// The assembled scene of the picture.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Returns the scene and its renderer, if it was prepared, and drops the rest.
    pub(crate) fn into_scene(self) -> (Arc<Scene>, Option<Renderer>) {
        (self.scene, self.ready.map(|(renderer, _)| renderer).or(self.earlier))
    }

    /// Returns the number, values and name of the picture in its series.
    #[must_use]
    pub fn member(&self) -> spectra_scene::Member {
        self.series.member(self.options.picture)
    }

    /// Returns the files on disk that the pictures depend on: the scene, its includes, and the files that its stages have read so
    /// far.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        self.series.files_on_disk()
    }

    /// Iterates over the warnings to consider before trusting the picture. Those about large files come once these are read.
    pub fn warnings(&self) -> impl Iterator<Item = &Warning> {
        self.series.warnings().iter().chain(&self.scene.warnings).chain(self.scene.source.warnings())
    }

    /// Prepares the scene for tracing, unless that is done already. If the workers are told to stop, the session remains
    /// unprepared.
    ///
    /// # Errors
    /// Faults of the scene that show only once the stages are put together.
    pub fn prepare(&mut self, workers: &dyn Workers) -> Result<(), SessionError> {
        if self.ready.is_some() {
            return Ok(());
        }
        match self.begin(&self.scene, self.density.clone(), workers) {
            Ok(ready) => {
                self.ready = Some(ready);
                // What it shares with the new one is held by that one.
                self.earlier = None;
            }
            Err(RenderError::Stopped) => {}
            Err(error) => return Err(SessionError::of(&error, &self.scene)),
        }
        Ok(())
    }

    /// Returns a renderer for a scene, and its light before any ray.
    fn begin(
        &self,
        scene: &Arc<Scene>,
        density: Option<Arc<dyn WavelengthDensity>>,
        workers: &dyn Workers,
    ) -> Result<(Renderer, Light), RenderError> {
        let options = RenderOptions {
            isa: self.options.isa,
            density,
            effort: self.options.effort,
            keeps_light: self.options.keeps_light,
            workers,
            ..RenderOptions::default()
        };
        let renderer = match &self.earlier {
            Some(earlier) => earlier.for_picture(Arc::clone(scene), &options)?,
            None => Renderer::new(Arc::clone(scene), &options)?,
        };
        let light = renderer.begin()?;
        Ok((renderer, light))
    }

    /// Returns the number of samples traced in each pixel.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.ready.as_ref().map_or(0, |(_, light)| light.samples())
    }

    /// Traces this many more samples of each pixel, or fewer if `control` asks to stop.
    ///
    /// # Errors
    /// The errors of [`Session::advance`].
    pub fn step(&mut self, samples: u64, workers: &dyn Workers, control: &Control) -> Result<(), SessionError> {
        self.advance(self.samples() + samples, workers, control)
    }

    /// Traces until each pixel has this many samples, or `control` asks to stop.
    ///
    /// # Errors
    /// The scene cannot be rendered; `render.numbers` works only with the number of samples that the scene states; or a stage
    /// returned NaN or infinity. Light traced before is kept.
    pub fn advance(&mut self, samples: u64, workers: &dyn Workers, control: &Control) -> Result<(), SessionError> {
        self.prepare(workers)?;
        let Some((renderer, light)) = &mut self.ready else { return Ok(()) };
        let traced = renderer.advance(light, samples, workers, control);
        traced.map_err(|error| SessionError::of(&error, &self.scene))
    }

    /// Traces the first pass over the frame, unless it is complete, or until `control` asks to stop.
    ///
    /// # Errors
    /// The errors of [`Session::advance`].
    pub(crate) fn first_pass(&mut self, workers: &dyn Workers, control: &Control) -> Result<(), SessionError> {
        self.prepare(workers)?;
        let Some((renderer, light)) = &mut self.ready else { return Ok(()) };
        let traced = renderer.first_pass(light, workers, control);
        traced.map_err(|error| SessionError::of(&error, &self.scene))
    }

    /// Returns whether the first pass over the frame is complete.
    pub(crate) fn covers_frame(&self) -> bool {
        self.ready.as_ref().is_some_and(|(_, light)| light.covers_frame())
    }

    /// Number of samples of each pixel at which the picture is complete: those that the scene states, or fewer once it is clean.
    #[must_use]
    pub fn samples_in_all(&self) -> u64 {
        if self.is_complete() { self.samples() } else { u64::from(self.scene.render.samples) }
    }

    /// Returns whether the light has all samples that the scene states, or is as clean as the scene asks for.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.ready.as_ref().is_some_and(|(renderer, light)| renderer.is_complete(light))
    }

    /// Returns the light so far, as the current scene shows it.
    ///
    /// # Errors
    /// Not enough memory; the errors of [`Session::prepare`].
    pub fn rendering(&mut self) -> Result<Rendering, SessionError> {
        self.prepare(&SingleThread)?;
        let Some((renderer, light)) = &self.ready else { return Err(Faults::new().into()) };
        renderer.rendering(&self.scene, light).map_err(|error| SessionError::of(&error, &self.scene))
    }

    /// Returns the light so far without diffraction at the edge of the aperture, which takes seconds to compute: lamps have no
    /// stars.
    ///
    /// # Errors
    /// The errors of [`Session::rendering`].
    pub fn rendering_without_diffraction(&mut self) -> Result<Rendering, SessionError> {
        self.prepare(&SingleThread)?;
        let Some((renderer, light)) = &self.ready else { return Err(Faults::new().into()) };
        let mut plain = Scene::clone(&self.scene);
        plain.render.diffraction = Some(false);
        renderer.rendering(&plain, light).map_err(|error| SessionError::of(&error, &self.scene))
    }

    /// Exposes the scene's film to its flat picture, pixel by pixel, as through an ideal lens at f/2.8 instead of the scene's
    /// lens. No ray is traced, and the light so far does not change.
    ///
    /// # Errors
    /// The source is not a flat picture, or its file is broken; the film has more pixels than the picture, or another shape.
    pub fn expose(&self) -> Result<Rendering, SessionError> {
        Ok(spectra_darkroom::expose(&self.scene)?)
    }

    /// Exposes the film, as [`Session::expose`] does, to pixels that [`spectra_core::stage::Source::still`] of its source gave
    /// before, or to fewer pixels of the same picture.
    ///
    /// # Errors
    /// The film has more pixels than the picture, or another shape.
    pub fn expose_still(&self, still: &Still) -> Result<Rendering, SessionError> {
        Ok(spectra_darkroom::expose_still(&self.scene, still)?)
    }

    /// Returns whether any ray was traced.
    #[must_use]
    pub fn has_light(&self) -> bool {
        self.ready.as_ref().is_some_and(|(_, light)| light.rays() > 0)
    }

    /// Returns the remarks that a user should read about a rendering of this session.
    #[must_use]
    pub fn rendering_warnings(&self, rendering: &Rendering) -> Vec<String> {
        self.ready.as_ref().map_or_else(Vec::new, |(renderer, light)| renderer.warnings(light, rendering))
    }

    /// Develops the light so far. Returns one picture for each film, with its name if there are several.
    ///
    /// # Errors
    /// The errors of [`Session::rendering`]; an imager that gives no picture.
    pub fn develop(&mut self) -> Result<Vec<Developed>, SessionError> {
        let exposure: ExposureFrame = self.rendering()?.exposure;
        let times = self.scene.film_times(&exposure);
        let shot = Shot::new(&self.scene, &exposure, &times, &[], self.options.isa);
        shot.pictures().map(<[Developed]>::to_vec).map_err(SessionError::of_stage)
    }

    /// Returns the density from which wavelengths are drawn; `None` until the scene is prepared.
    #[must_use]
    pub fn density(&self) -> Option<&Arc<dyn WavelengthDensity>> {
        self.ready.as_ref().map(|(renderer, _)| renderer.density())
    }

    /// Writes the files that the scene asks for from the light so far, and returns their names.
    ///
    /// # Errors
    /// The errors of [`Session::rendering`]; a file that cannot be written.
    pub fn write(&mut self, sink: &dyn Sink) -> Result<Vec<String>, SessionError> {
        let rendering = self.rendering()?;
        let (scene, exposure) = (&self.scene, &rendering.exposure);
        let times = scene.film_times(exposure);
        let attributes = header::attributes(scene, exposure, &times, rendering.partial, env!("CARGO_PKG_VERSION"));
        let shot = Shot::new(scene, exposure, &times, &attributes, self.options.isa).with_layers(&rendering.layers);
        let files = Files::of(&Names::of_scene(), scene, &self.member())?;
        files.write(&shot, sink, None)?;
        Ok(files.names())
    }

    /// Sets a value with a text `path=value`, as `--set` does. Stages and light that do not depend on it are kept. If there is an
    /// error, nothing changes.
    ///
    /// # Errors
    /// Every fault of the changed scene.
    pub fn change(&mut self, text: &str) -> Result<ValidResults, SessionError> {
        self.set(&[text], self.options.picture, true, None, &SingleThread)
    }

    /// Sets several values, as [`Session::change`] does, and goes to another picture of the series, by its index from 0. The scene
    /// is prepared when light is asked for, where it can be stopped; errors of the preparation are reported then. If `lens_from`
    /// has a focused lens that fits, such as a draft with the same change, it is taken over. Any workers give the same bits.
    ///
    /// # Errors
    /// Faults of the stages of the changed scene; an error if the workers are told to stop meanwhile. Either leaves everything
    /// unchanged.
    pub fn change_unprepared(
        &mut self,
        texts: &[impl AsRef<str>],
        picture: usize,
        lens_from: Option<&Self>,
        workers: &dyn Workers,
    ) -> Result<ValidResults, SessionError> {
        let texts: Vec<&str> = texts.iter().map(AsRef::as_ref).collect();
        self.set(&texts, picture, false, lens_from.map(|other| &*other.scene), workers)
    }

    /// The pictures that the scene stands for: one, the members of a sweep, or the frames of an animation.
    #[must_use]
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// Index of the picture in the series, from 0.
    #[must_use]
    pub fn index(&self) -> usize {
        self.options.picture
    }

    fn set(
        &mut self,
        texts: &[&str],
        picture: usize,
        is_prepared: bool,
        lens_from: Option<&Scene>,
        workers: &dyn Workers,
    ) -> Result<ValidResults, SessionError> {
        let series = self.series.with_all(texts)?;
        let search = ViewSearch { effort: self.options.effort, workers };
        let scene: Arc<Scene> = series.scene_between(picture, Some(Arc::clone(&self.scene)), lens_from, search)?.into();
        let mut kept = self.valid_results(&scene);
        let (system, same_light) = (kept.density, kept.light);
        let ready = self.ready.take();
        let known = ready.as_ref().map(|(renderer, _)| renderer.density()).or(self.density.as_ref());
        let density = known.filter(|_| system).cloned();
        self.ready = match ready {
            None => {
                kept = ValidResults { light: false, density: density.is_some(), ..kept };
                None
            }
            Some(ready) if same_light => Some(ready),
            Some(_) if !is_prepared => None,
            Some(ready) => match self.begin(&scene, density.clone(), workers) {
                Ok(begun) => Some(begun),
                Err(error) => {
                    self.ready = Some(ready);
                    return Err(SessionError::of(&error, &scene));
                }
            },
        };
        (self.series, self.options.picture, self.scene, self.density) = (series, picture, scene, density);
        Ok(kept)
    }

    /// Frees the memory of the light, and keeps the renderer for the next picture.
    pub(crate) fn forget_light(&mut self) {
        if let Some((renderer, _)) = self.ready.take() {
            self.earlier = Some(renderer);
        }
    }

    /// Writes the light so far, for another process to continue.
    ///
    /// # Errors
    /// Errors of the stream, and those of [`Session::prepare`].
    pub fn save(&mut self, out: &mut dyn Write) -> Result<(), SessionError> {
        self.prepare(&SingleThread)?;
        let Some((_, light)) = &self.ready else { return Ok(()) };
        let scene = self.scene.text.as_bytes();
        out.write_all(&(scene.len() as u64).to_le_bytes())?;
        out.write_all(scene)?;
        Ok(light.save(out)?)
    }

    /// Replaces the light by light that another session of the same scene saved.
    ///
    /// # Errors
    /// Errors of the stream; light of another scene, which leaves everything unchanged; and the errors of [`Session::prepare`].
    pub fn load(&mut self, from: &mut dyn Read) -> Result<(), SessionError> {
        self.prepare(&SingleThread)?;
        let Some((renderer, light)) = &mut self.ready else { return Ok(()) };
        let scene = self.scene.text.as_bytes();
        let mut length = [0; 8];
        from.read_exact(&mut length)?;
        let mut known = vec![0; scene.len()];
        let fits = u64::from_le_bytes(length) == scene.len() as u64;
        if fits {
            from.read_exact(&mut known)?;
        }
        if known != scene {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "this light belongs to another scene").into());
        }
        *light = Light::load(renderer, from)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_plugins as _;

    /// The next picture of a series gets the renderer of a picture whose light is no longer needed.
    #[test]
    fn the_renderer_outlives_the_light() {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/biotar-ortho.yaml");
        let set = ["imager.resolution=[48, 32]".to_owned()];
        let mut session = Session::open(&scene, &set, SessionOptions::default()).expect("a scene");
        session.prepare(&SingleThread).expect("prepared");
        session.forget_light();
        assert!(!session.has_light() && session.into_scene().1.is_some());
    }
}
