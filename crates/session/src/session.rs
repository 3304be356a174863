//! One picture of a scene, on its way.

use crate::files::Files;
use crate::{Alone, Control, Names, Rendering, SessionError, Workers, header, still};
use spectra_core::params::{Faults, Node, Warning};
use spectra_core::resources::Resources;
use spectra_core::sink::Sink;
use spectra_core::stage::{Still, WavelengthDensity};
use spectra_core::{Isa, frame::ExposureFrame};
use spectra_render::{Effort, Light, RenderError, Renderer};
use spectra_scene::{Developed, Scene, Search, Series, Shot, load_series, series_of_text, series_of_tree};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a change of a scene leaves of what was made before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    /// The light: nothing is traced again.
    pub light: bool,
    /// The density of wavelengths.
    pub density: bool,
    /// The lens, focused.
    pub lens: bool,
    /// The source, with its files.
    pub source: bool,
}

/// How a session was set: its values, its picture of the series and its stages, without the light.
#[derive(Clone)]
pub struct Moment {
    series: Series,
    index: usize,
    scene: Arc<Scene>,
}

impl Moment {
    /// The pictures that the scene stood for.
    #[must_use]
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// The place of its picture among them, from 0.
    #[must_use]
    pub fn index(&self) -> usize {
        self.index
    }
}

/// One picture of a scene: its stages, and its light so far.
pub struct Session {
    series: Series,
    index: usize,
    isa: Isa,
    scene: Arc<Scene>,
    /// The scene made ready, once light is asked for, with that light.
    ready: Option<(Renderer, Light)>,
    /// A density of wavelengths that fits the scene, where one is known from before.
    density: Option<Arc<dyn WavelengthDensity>>,
    effort: Effort,
}

impl Session {
    /// The scene of a file, with texts `path=value` on top.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn open(path: &Path, overrides: &[String], isa: Isa) -> Result<Self, SessionError> {
        Self::of_series(load_series(path, overrides)?, 0, isa)
    }

    /// The scene of a text; its stages ask `resources` for files.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn of_text(name: &str, text: &str, resources: Arc<dyn Resources>, isa: Isa) -> Result<Self, SessionError> {
        Self::of_series(series_of_text(name, text, &[], resources)?, 0, isa)
    }

    /// The scene of a tree.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn of_tree(name: &str, root: Node, resources: Arc<dyn Resources>, isa: Isa) -> Result<Self, SessionError> {
        Self::of_series(series_of_tree(name, root, &[], resources)?, 0, isa)
    }

    /// A picture by its place in a series, from 0.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn of_series(series: Series, index: usize, isa: Isa) -> Result<Self, SessionError> {
        Self::after(series, index, None, isa, Effort::Full)
    }

    /// The same, with the stages of another scene where both say the same.
    pub(crate) fn after(
        series: Series,
        index: usize,
        other: Option<Arc<Scene>>,
        isa: Isa,
        effort: Effort,
    ) -> Result<Self, SessionError> {
        let scene = series.scene_between(index, other, None, Search { effort, workers: &Alone })?.into();
        Ok(Self { series, index, isa, scene, ready: None, density: None, effort })
    }

    /// The scene, assembled.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The scene alone.
    pub(crate) fn into_scene(self) -> Arc<Scene> {
        self.scene
    }

    /// The same picture with these values `path=value` on top, without light. Of this one's stages it has those that do not rest on
    /// them; this one stays as it is.
    ///
    /// # Errors
    /// Everything that is wrong with the scene as it would be.
    pub fn branch(&self, texts: &[String]) -> Result<Self, SessionError> {
        self.branched(texts, self.index, Effort::Full)
    }

    fn branched(&self, texts: &[String], index: usize, effort: Effort) -> Result<Self, SessionError> {
        Self::after(self.series.with_all(texts)?, index, Some(Arc::clone(&self.scene)), self.isa, effort)
    }

    /// The same for a first look: what passes the lens, and what frame and meters see, is found with less effort, and so the bits are
    /// others.
    ///
    /// # Errors
    /// As [`Session::branch`].
    pub fn draft(&self, texts: &[String]) -> Result<Self, SessionError> {
        self.draft_of(texts, self.index)
    }

    /// The same of another picture of the series, by its place from 0.
    ///
    /// # Errors
    /// As [`Session::branch`].
    pub fn draft_of(&self, texts: &[String], index: usize) -> Result<Self, SessionError> {
        self.branched(texts, index, Effort::Draft)
    }

    /// The picture among those that the scene's file stands for.
    #[must_use]
    pub fn member(&self) -> spectra_scene::Member {
        self.series.member(self.index)
    }

    /// The files on disk that its pictures rest on: the scene, what it includes, and what its stages have asked for so far.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        self.series.files_on_disk()
    }

    /// What a person should know before believing the picture; of large files, once they are read.
    pub fn warnings(&self) -> impl Iterator<Item = &Warning> {
        self.series.warnings().iter().chain(&self.scene.warnings).chain(self.scene.source.doubts())
    }

    /// Makes the scene ready, if it is not; where the workers are to stop meanwhile, it stays as it is.
    ///
    /// # Errors
    /// What shows only once the stages are put together, as a fault of the scene.
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
        let renderer = Renderer::with_effort(Arc::clone(scene), self.isa, density, self.effort, workers)?;
        let light = renderer.begin()?;
        Ok((renderer, light))
    }

    /// Of each pixel, so many samples are traced.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.ready.as_ref().map_or(0, |(_, light)| light.samples())
    }

    /// Traces so many samples of each pixel more; fewer where `control` says stop.
    ///
    /// # Errors
    /// As [`Session::advance`].
    pub fn step(&mut self, samples: u64, workers: &dyn Workers, control: &Control) -> Result<(), SessionError> {
        self.advance(self.samples() + samples, workers, control)
    }

    /// Traces until so many samples of each pixel are there, or `control` says stop.
    ///
    /// # Errors
    /// The scene cannot be rendered; `numbers` that cannot go on beyond the samples of the scene; a stage that gave a number
    /// that no light can have. The light before stays.
    pub fn advance(&mut self, samples: u64, workers: &dyn Workers, control: &Control) -> Result<(), SessionError> {
        self.prepare(workers)?;
        let Some((renderer, light)) = &mut self.ready else { return Ok(()) };
        let traced = renderer.advance(light, samples, workers, control);
        traced.map_err(|error| SessionError::of(&error, &self.scene))
    }

    /// The light so far, as the scene has it now.
    ///
    /// # Errors
    /// There is no memory for it.
    pub fn look(&mut self) -> Result<Rendering, SessionError> {
        self.prepare(&Alone)?;
        let Some((renderer, light)) = &self.ready else { return Err(Faults::new().into()) };
        renderer.look(&self.scene, light).map_err(|error| SessionError::of(&error, &self.scene))
    }

    /// The same without what the edge of the aperture does to it, which takes seconds: stars of lights are left out.
    ///
    /// # Errors
    /// As [`Session::look`].
    pub fn look_without_stars(&mut self) -> Result<Rendering, SessionError> {
        self.prepare(&Alone)?;
        let Some((renderer, light)) = &self.ready else { return Err(Faults::new().into()) };
        let mut plain = Scene::clone(&self.scene);
        plain.render.diffraction = Some(false);
        renderer.look(&plain, light).map_err(|error| SessionError::of(&error, &self.scene))
    }

    /// The exposure of the scene's film to its flat picture, pixel by pixel, as by an ideal lens at f/2.8 in place of the scene's: no
    /// ray is traced, and the light so far stays as it is.
    ///
    /// # Errors
    /// The source is no flat picture, or its file is broken; the film has more pixels than the picture, or another shape.
    pub fn expose(&self) -> Result<Rendering, SessionError> {
        still::expose(&self.scene)
    }

    /// The same of pixels that [`spectra_core::stage::Source::still`] of its source gave before, or of the same picture with fewer.
    ///
    /// # Errors
    /// The film has more pixels than the picture, or another shape.
    pub fn expose_still(&self, still: &Still) -> Result<Rendering, SessionError> {
        still::of_still(&self.scene, still)
    }

    /// Whether any ray was traced.
    #[must_use]
    pub fn has_light(&self) -> bool {
        self.ready.as_ref().is_some_and(|(_, light)| light.rays() > 0)
    }

    /// What a person should know of such a rendering.
    #[must_use]
    pub fn remarks(&self, rendering: &Rendering) -> Vec<String> {
        self.ready.as_ref().map_or_else(Vec::new, |(renderer, light)| renderer.remarks(light, rendering))
    }

    /// The pictures of the light so far: one for each film, with its name where there are several.
    ///
    /// # Errors
    /// As [`Session::look`]; the imager has no picture.
    pub fn develop(&mut self) -> Result<Vec<Developed>, SessionError> {
        let exposure: ExposureFrame = self.look()?.exposure;
        let times = self.scene.film_times(&exposure);
        let shot = Shot::new(&self.scene, &exposure, &times, &[], self.isa);
        shot.pictures().map(<[Developed]>::to_vec).map_err(SessionError::Failed)
    }

    /// The density that wavelengths are drawn by, once the scene is made ready.
    #[must_use]
    pub fn density(&self) -> Option<&Arc<dyn WavelengthDensity>> {
        self.ready.as_ref().map(|(renderer, _)| renderer.density())
    }

    /// Writes the files that the scene asks for, of the light so far, and says how they are called.
    ///
    /// # Errors
    /// As [`Session::look`]; a file that could not be written.
    pub fn write(&mut self, sink: &dyn Sink) -> Result<Vec<String>, SessionError> {
        let rendering = self.look()?;
        let (scene, exposure) = (&self.scene, &rendering.exposure);
        let times = scene.film_times(exposure);
        let attributes = header::attributes(scene, exposure, &times, rendering.partial, env!("CARGO_PKG_VERSION"));
        let shot = Shot::new(scene, exposure, &times, &attributes, self.isa).with_layers(&rendering.layers);
        let files = Files::of(&Names::of_scene(), scene, &self.member())?;
        files.write(&shot, sink, None)?;
        Ok(files.names())
    }

    /// Sets a value, as `--set` does: a text `path=value`. Of the stages and the light that is kept which does not rest on it;
    /// where something is wrong, all stays as it was.
    ///
    /// # Errors
    /// Everything that is wrong with the scene as it would be.
    pub fn change(&mut self, text: &str) -> Result<Kept, SessionError> {
        self.change_on(text, &Alone)
    }

    /// The same, with what is searched anew on these workers: the same bits on any.
    ///
    /// # Errors
    /// As [`Session::change`].
    pub fn change_on(&mut self, text: &str, workers: &dyn Workers) -> Result<Kept, SessionError> {
        self.changed(&[text], self.index, true, None, workers)
    }

    /// The same, but what the change asks to be made ready anew is made when light is asked for again, where it can be stopped. What
    /// shows only then is told then.
    ///
    /// # Errors
    /// What is wrong with the stages of the scene as it would be.
    pub fn change_later(&mut self, text: &str) -> Result<Kept, SessionError> {
        self.changed(&[text], self.index, false, None, &Alone)
    }

    /// The same, where `other` may have the lens as the change asks for it, focused: a draft that was changed so before.
    ///
    /// # Errors
    /// As [`Session::change_later`]; and something where the workers are to stop meanwhile, which then leaves all as it was.
    pub fn change_after(&mut self, text: &str, other: &Self, workers: &dyn Workers) -> Result<Kept, SessionError> {
        self.changed(&[text], self.index, false, Some(&other.scene), workers)
    }

    /// Sets several values at once and goes to another picture of the series, by its place from 0; made ready when light is asked for
    /// again. `other` may have the lens as this asks for it, as in [`Session::change_after`].
    ///
    /// # Errors
    /// As [`Session::change_after`].
    pub fn turn(
        &mut self,
        texts: &[impl AsRef<str>],
        index: usize,
        other: Option<&Self>,
        workers: &dyn Workers,
    ) -> Result<Kept, SessionError> {
        let texts: Vec<&str> = texts.iter().map(AsRef::as_ref).collect();
        self.changed(&texts, index, false, other.map(|other| &*other.scene), workers)
    }

    /// How it is set now.
    #[must_use]
    pub fn moment(&self) -> Moment {
        Moment { series: self.series.clone(), index: self.index, scene: Arc::clone(&self.scene) }
    }

    /// Goes back to how it was set, with the light where that is the same; it cannot be refused, since it was so before.
    pub fn back_to(&mut self, moment: &Moment) -> Kept {
        let Moment { series, index, scene } = moment.clone();
        let kept = self.kept(&scene);
        if !kept.light {
            let known = self.ready.take().map(|(renderer, _)| Arc::clone(renderer.density())).or(self.density.take());
            self.density = known.filter(|_| kept.density);
        }
        (self.series, self.index, self.scene) = (series, index, scene);
        kept
    }

    /// The pictures that the scene stands for: one, those of a sweep, the frames of an animation.
    #[must_use]
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// The place of its picture among them, from 0.
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
    ) -> Result<Kept, SessionError> {
        let series = self.series.with_all(texts)?;
        let search = Search { effort: self.effort, workers };
        let scene: Arc<Scene> = series.scene_between(index, Some(Arc::clone(&self.scene)), lens_of, search)?.into();
        let mut kept = self.kept(&scene);
        let (system, same_light) = (kept.density, kept.light);
        let ready = self.ready.take();
        let known = ready.as_ref().map(|(renderer, _)| renderer.density()).or(self.density.as_ref());
        let density = known.filter(|_| system).cloned();
        self.ready = match ready {
            None => {
                kept = Kept { light: false, density: density.is_some(), ..kept };
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

    /// What another scene leaves of what was made for the one that is there.
    fn kept(&self, scene: &Scene) -> Kept {
        let before = &*self.scene;
        let responses = |scene: &Scene, which: Vec<usize>| -> Vec<Vec<f64>> {
            which.iter().filter_map(|at| scene.channels.get(*at)).map(|c| c.response.clone()).collect()
        };
        let same_channels = responses(before, before.picture_channels()) == responses(scene, scene.picture_channels());
        let same_meters = responses(before, before.meter_channels()) == responses(scene, scene.meter_channels())
            && before.metered_pixels() == scene.metered_pixels();
        let source = Arc::ptr_eq(&before.source, &scene.source);
        let lens = Arc::ptr_eq(&before.lens, &scene.lens);
        // A source that fills the frame is another one with every lens; its light has the spectrum of before.
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
        Kept { light: same_light, density: system, lens, source }
    }

    /// Gives the memory of the light back.
    pub(crate) fn forget_light(&mut self) {
        self.ready = None;
    }

    /// Writes the light so far, for another process to go on with.
    ///
    /// # Errors
    /// What the stream has; and as [`Session::prepare`].
    pub fn save(&mut self, out: &mut dyn Write) -> Result<(), SessionError> {
        self.prepare(&Alone)?;
        let Some((_, light)) = &self.ready else { return Ok(()) };
        let scene = self.scene.text.as_bytes();
        out.write_all(&(scene.len() as u64).to_le_bytes())?;
        out.write_all(scene)?;
        Ok(light.save(out)?)
    }

    /// Takes up the light that another session of the same scene saved, in place of its own.
    ///
    /// # Errors
    /// What the stream has; light of another scene, which leaves all as it was; and as [`Session::prepare`].
    pub fn load(&mut self, from: &mut dyn Read) -> Result<(), SessionError> {
        self.prepare(&Alone)?;
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
            return Err(io::Error::new(io::ErrorKind::InvalidData, "this light is of another scene").into());
        }
        *light = Light::load(renderer, from)?;
        Ok(())
    }
}
