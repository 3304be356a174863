//! A session: one picture of a scene, while it is rendered.
//!
//! It holds the scene, the renderer and the light so far. Stages are shared between scenes by `Arc`. A change sets a value in the tree as
//! `--set` does and assembles the scene again; sections that are unchanged keep their stages. The light is kept if source, lens, imager,
//! wavelength density and channels are still the same stages ([`ValidResults`]).

use crate::files::Files;
use crate::{Control, Names, Rendering, SessionError, SingleThread, Workers, header, still};
use spectra_core::params::{Faults, Node, Warning};
use spectra_core::resources::Resources;
use spectra_core::sink::Sink;
use spectra_core::stage::{Still, WavelengthDensity};
use spectra_core::{Isa, frame::ExposureFrame};
use spectra_render::{Effort, Light, RenderError, RenderOptions, Renderer};
use spectra_scene::{Developed, Scene, Series, Shot, ViewSearch, load_series, series_of_text, series_of_tree};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The results that remain valid after a change of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ValidResults {
    /// Whether the light is kept, so that nothing is traced again.
    pub light: bool,
    /// Whether the wavelength density is kept.
    pub density: bool,
    /// Whether the focused lens is kept.
    pub lens: bool,
    /// Whether the source is kept, with its files.
    pub source: bool,
}

/// A saved state of a session: its values, its picture of the series and its stages, without the light.
#[derive(Clone)]
pub struct Snapshot {
    series: Series,
    index: usize,
    scene: Arc<Scene>,
}

impl Snapshot {
    /// The pictures that the scene stands for in this state.
    #[must_use]
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// Index of the picture in the series, from 0.
    #[must_use]
    pub fn index(&self) -> usize {
        self.index
    }
}

/// A session on one picture of a scene: its stages, and its light so far.
pub struct Session {
    series: Series,
    index: usize,
    isa: Isa,
    scene: Arc<Scene>,
    /// The prepared scene and its light, once light is asked for.
    ready: Option<(Renderer, Light)>,
    /// A wavelength density that fits the scene, if one is known from before.
    density: Option<Arc<dyn WavelengthDensity>>,
    effort: Effort,
}

impl Session {
    /// Opens the scene of a file, with texts `path=value` on top.
    ///
    /// # Errors
    /// Every fault of the scene.
    pub fn open(path: &Path, overrides: &[String], isa: Isa) -> Result<Self, SessionError> {
        Self::of_series(load_series(path, overrides)?, 0, isa)
    }

    /// Opens a scene from its text. Its stages get their files from `resources`.
    ///
    /// # Errors
    /// The errors of [`Session::open`].
    pub fn of_text(name: &str, text: &str, resources: Arc<dyn Resources>, isa: Isa) -> Result<Self, SessionError> {
        Self::of_series(series_of_text(name, text, &[], resources)?, 0, isa)
    }

    /// Opens a scene from a tree. Its stages get their files from `resources`.
    ///
    /// # Errors
    /// The errors of [`Session::open`].
    pub fn of_tree(name: &str, root: Node, resources: Arc<dyn Resources>, isa: Isa) -> Result<Self, SessionError> {
        Self::of_series(series_of_tree(name, root, &[], resources)?, 0, isa)
    }

    /// Opens a picture of a series by its index, from 0.
    ///
    /// # Errors
    /// The errors of [`Session::open`].
    pub fn of_series(series: Series, index: usize, isa: Isa) -> Result<Self, SessionError> {
        Self::after(series, index, None, isa, Effort::Full)
    }

    /// Opens a picture of a series, and takes over the stages of `other` where both scenes have the same section.
    pub(crate) fn after(
        series: Series,
        index: usize,
        other: Option<Arc<Scene>>,
        isa: Isa,
        effort: Effort,
    ) -> Result<Self, SessionError> {
        let scene = series.scene_between(index, other, None, ViewSearch { effort, workers: &SingleThread })?.into();
        Ok(Self { series, index, isa, scene, ready: None, density: None, effort })
    }

    /// The assembled scene of the picture.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Returns the scene and drops the rest.
    pub(crate) fn into_scene(self) -> Arc<Scene> {
        self.scene
    }

    /// Returns a session on the same picture with these values `path=value` on top, without light. It shares the stages that do
    /// not depend on these values. `self` does not change.
    ///
    /// # Errors
    /// Every fault of the changed scene.
    pub fn branch(&self, texts: &[String]) -> Result<Self, SessionError> {
        self.branched(texts, self.index, Effort::Full)
    }

    fn branched(&self, texts: &[String], index: usize, effort: Effort) -> Result<Self, SessionError> {
        Self::after(self.series.with_all(texts)?, index, Some(Arc::clone(&self.scene)), self.isa, effort)
    }

    /// Returns a draft, for a first look, of what [`Session::branch`] returns. Less effort is spent on the search for the rays
    /// that pass the lens, and for those that frame and meters see. The result therefore differs in its bits.
    ///
    /// # Errors
    /// The errors of [`Session::branch`].
    pub fn draft(&self, texts: &[String]) -> Result<Self, SessionError> {
        self.draft_of(texts, self.index)
    }

    /// Returns a draft, as [`Session::draft`] does, of another picture of the series by its index, from 0.
    ///
    /// # Errors
    /// The errors of [`Session::branch`].
    pub fn draft_of(&self, texts: &[String], index: usize) -> Result<Self, SessionError> {
        self.branched(texts, index, Effort::Draft)
    }

    /// Returns the number, values and name of the picture in its series.
    #[must_use]
    pub fn member(&self) -> spectra_scene::Member {
        self.series.member(self.index)
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
        match self.made(&self.scene, self.density.clone(), workers) {
            Ok(ready) => self.ready = Some(ready),
            Err(RenderError::Stopped) => {}
            Err(error) => return Err(SessionError::of(&error, &self.scene)),
        }
        Ok(())
    }

    fn made(
        &self,
        scene: &Arc<Scene>,
        density: Option<Arc<dyn WavelengthDensity>>,
        workers: &dyn Workers,
    ) -> Result<(Renderer, Light), RenderError> {
        let renderer = Renderer::new(
            Arc::clone(scene),
            &RenderOptions { isa: self.isa, density, effort: self.effort, workers, ..RenderOptions::default() },
        )?;
        let light = renderer.begin()?;
        Ok((renderer, light))
    }

    /// Returns the number of samples traced in each pixel.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.ready.as_ref().map_or(0, |(_, light)| light.samples())
    }

    /// Traces this many more samples of each pixel, or fewer if `control` says stop.
    ///
    /// # Errors
    /// The errors of [`Session::advance`].
    pub fn step(&mut self, samples: u64, workers: &dyn Workers, control: &Control) -> Result<(), SessionError> {
        self.advance(self.samples() + samples, workers, control)
    }

    /// Traces until each pixel has this many samples, or `control` says stop.
    ///
    /// # Errors
    /// The scene cannot be rendered; the `numbers` cannot go beyond the samples that the scene states; a stage gave a number that
    /// light cannot have. The light from before remains.
    pub fn advance(&mut self, samples: u64, workers: &dyn Workers, control: &Control) -> Result<(), SessionError> {
        self.prepare(workers)?;
        let Some((renderer, light)) = &mut self.ready else { return Ok(()) };
        let traced = renderer.advance(light, samples, workers, control);
        traced.map_err(|error| SessionError::of(&error, &self.scene))
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
        still::expose(&self.scene)
    }

    /// Exposes the film, as [`Session::expose`] does, to pixels that [`spectra_core::stage::Source::still`] of its source gave
    /// before, or to fewer pixels of the same picture.
    ///
    /// # Errors
    /// The film has more pixels than the picture, or another shape.
    pub fn expose_still(&self, still: &Still) -> Result<Rendering, SessionError> {
        still::of_still(&self.scene, still)
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
        let shot = Shot::new(&self.scene, &exposure, &times, &[], self.isa);
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
        let shot = Shot::new(scene, exposure, &times, &attributes, self.isa).with_layers(&rendering.layers);
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
        self.change_on(text, &SingleThread)
    }

    /// Sets a value as [`Session::change`] does, and runs the searches that it needs on these workers. Any workers give the same
    /// bits.
    ///
    /// # Errors
    /// The errors of [`Session::change`].
    pub fn change_on(&mut self, text: &str, workers: &dyn Workers) -> Result<ValidResults, SessionError> {
        self.changed(&[text], self.index, true, None, workers)
    }

    /// Sets a value as [`Session::change`] does, but leaves the preparation of the scene until light is asked for, where it can
    /// be stopped. Errors of the preparation are reported then.
    ///
    /// # Errors
    /// Faults of the stages of the changed scene.
    pub fn change_later(&mut self, text: &str) -> Result<ValidResults, SessionError> {
        self.changed(&[text], self.index, false, None, &SingleThread)
    }

    /// Sets a value as [`Session::change_later`] does. Takes the focused lens from `other` if it fits, such as from a draft with
    /// the same change.
    ///
    /// # Errors
    /// The errors of [`Session::change_later`]; an error if the workers are told to stop meanwhile, which leaves everything
    /// unchanged.
    pub fn change_after(
        &mut self,
        text: &str,
        other: &Self,
        workers: &dyn Workers,
    ) -> Result<ValidResults, SessionError> {
        self.changed(&[text], self.index, false, Some(&other.scene), workers)
    }

    /// Sets several values at once and goes to another picture of the series, by its index from 0. The scene is prepared when
    /// light is asked for. `other` may provide the focused lens, as in [`Session::change_after`].
    ///
    /// # Errors
    /// The errors of [`Session::change_after`].
    pub fn turn(
        &mut self,
        texts: &[impl AsRef<str>],
        index: usize,
        other: Option<&Self>,
        workers: &dyn Workers,
    ) -> Result<ValidResults, SessionError> {
        let texts: Vec<&str> = texts.iter().map(AsRef::as_ref).collect();
        self.changed(&texts, index, false, other.map(|other| &*other.scene), workers)
    }

    /// Returns the current state, for [`Session::restore`].
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        Snapshot { series: self.series.clone(), index: self.index, scene: Arc::clone(&self.scene) }
    }

    /// Returns to an earlier state, and keeps the light if it is still valid. This cannot fail, because the state was valid
    /// before.
    pub fn restore(&mut self, moment: &Snapshot) -> ValidResults {
        let Snapshot { series, index, scene } = moment.clone();
        let kept = self.kept(&scene);
        if !kept.light {
            let known = self.ready.take().map(|(renderer, _)| Arc::clone(renderer.density())).or(self.density.take());
            self.density = known.filter(|_| kept.density);
        }
        (self.series, self.index, self.scene) = (series, index, scene);
        kept
    }

    /// The pictures that the scene stands for: one, the members of a sweep, or the frames of an animation.
    #[must_use]
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// Index of the picture in the series, from 0.
    #[must_use]
    pub fn index(&self) -> usize {
        self.index
    }

    fn changed(
        &mut self,
        texts: &[&str],
        index: usize,
        is_made_ready: bool,
        lens_of: Option<&Scene>,
        workers: &dyn Workers,
    ) -> Result<ValidResults, SessionError> {
        let series = self.series.with_all(texts)?;
        let search = ViewSearch { effort: self.effort, workers };
        let scene: Arc<Scene> = series.scene_between(index, Some(Arc::clone(&self.scene)), lens_of, search)?.into();
        let mut kept = self.kept(&scene);
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
            Some(_) if !is_made_ready => None,
            Some(ready) => match self.made(&scene, density.clone(), workers) {
                Ok(made) => Some(made),
                Err(error) => {
                    self.ready = Some(ready);
                    return Err(SessionError::of(&error, &scene));
                }
            },
        };
        (self.series, self.index, self.scene, self.density) = (series, index, scene, density);
        Ok(kept)
    }

    /// Returns which results for the current scene remain valid for another one.
    fn kept(&self, scene: &Scene) -> ValidResults {
        let before = &*self.scene;
        let responses = |scene: &Scene, which: Vec<usize>| -> Vec<Vec<f64>> {
            which.iter().filter_map(|at| scene.channels.get(*at)).map(|c| c.response.clone()).collect()
        };
        let same_channels = responses(before, before.picture_channels()) == responses(scene, scene.picture_channels());
        let same_meters = responses(before, before.meter_channels()) == responses(scene, scene.meter_channels())
            && before.metered_pixels() == scene.metered_pixels();
        let source = Arc::ptr_eq(&before.source, &scene.source);
        let lens = Arc::ptr_eq(&before.lens, &scene.lens);
        // A source that fills the frame is rebuilt for every lens, but the spectrum of its light stays the same.
        let system = before.source.spectrum() == scene.source.spectrum()
            && same_channels
            && before.grid == scene.grid
            && Arc::ptr_eq(&before.sampler, &scene.sampler);
        let same_light = system
            && source
            && same_meters
            && lens
            && before.imager.size() == scene.imager.size()
            && Arc::ptr_eq(&before.imager, &scene.imager)
            && before.ghost_paths() == scene.ghost_paths()
            && before.render.traces_as(&scene.render);
        ValidResults { light: same_light, density: system, lens, source }
    }

    /// Frees the memory of the light.
    pub(crate) fn forget_light(&mut self) {
        self.ready = None;
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
