//! Builds the stages of a scene in the order in which they need each other.
//!
//! Focus needs all other sections, and a source needs the view of the lens. Faults are reported in the order of the sections all the same.

use crate::build_messages::BuildMessages;
use crate::focus::FocusLight;
use crate::frame_view::UncoveredFrame;
use crate::lens_section::{ConfiguredLens, UnfocusedLens, configure_lens, size_hint};
use crate::render_section::RenderSection;
use crate::reuse::ReusableStages;
use crate::scene_file::{BandSection, SceneFile};
use crate::warnings::AssembledScene;
use crate::{
    Lights, Output, RenderSettings, Scene, SceneFilm, color_cast, films, filters, frame_view, lamps, landing, output,
    responses,
};
use spectra_core::cover::CoverStack;
use spectra_core::params::{Fault, Faults, Node, Params, Value, Warnings, keys_of};
use spectra_core::registry::{self, Context, Stage};
use spectra_core::resources::Resources;
use spectra_core::spectral::{BAND, Channel};
use spectra_core::stage::{Imager, Source, WavelengthSampler};
use spectra_lens::MATTE_BOX;
use spectra_optics::Optics;
use std::sync::Arc;

/// Sections of a scene; `None` if a section is missing or is no map.
struct Sections {
    sampler: Params,
    source: Option<Params>,
    lens: Option<Params>,
    imager: Option<Params>,
    /// The film, unless there is a list of films.
    film: Option<Params>,
    render: Params,
    file: Option<SceneFile>,
}

/// Stages of a scene as far as they are built. A stage is `None` before its turn, and after a fault.
pub(crate) struct SceneBuilder<'a> {
    params: &'a Params,
    context: Context<'a>,
    warnings: &'a Warnings,
    earlier: ReusableStages<'a>,
    sections: Sections,
    /// Faults of the file as a whole, the wavelengths, the filters and the source.
    faults: Faults,
    /// Faults of the lens, which are reported after these.
    lens_faults: Faults,
    /// Faults of imager, films, settings and outputs, which are reported last.
    rear_faults: Faults,
    sampler: Option<Arc<dyn WavelengthSampler>>,
    /// Transmittance of the filters in front of the lens, if there are any.
    filters: Option<Vec<f64>>,
    imager: Option<Arc<dyn Imager>>,
    /// Whether the imager must be built again where the light lands.
    centers_on_light: bool,
    is_lens_read: bool,
    unfocused: Option<UnfocusedLens>,
    source: Option<Arc<dyn Source>>,
    /// The part of the frame that the lens leaves dark, if any.
    dark: Option<UncoveredFrame>,
    films: Option<Vec<SceneFilm>>,
    render: Option<RenderSection>,
    output: Option<Vec<Arc<dyn Output>>>,
    channels: Option<Vec<Channel>>,
    focus_light: Option<FocusLight>,
    lens: Option<ConfiguredLens>,
}

/// Returns the films of a scene if they are a list. A list is not a single stage, so it is read separately.
fn film_list(params: &Params) -> Option<&[Node]> {
    match params.get("film").map(|node| &node.value) {
        Some(Value::Seq(items)) => Some(items),
        _ => None,
    }
}

/// Returns the stage of the earlier scene if it was kept, or builds it from its section.
fn stage<S: Stage + ?Sized>(
    kept: &mut Option<Arc<S>>,
    section: Option<&Params>,
    context: &Context<'_>,
    faults: &mut Faults,
) -> Option<Arc<S>> {
    kept.take().or_else(|| faults.take(registry::build::<S>(section?, context)).map(Arc::from))
}

impl<'a> SceneBuilder<'a> {
    /// Splits a scene into its sections, and keeps those stages of the earlier scene that fit.
    pub(crate) fn new(
        params: &'a Params,
        resources: &'a dyn Resources,
        warnings: &'a Warnings,
        earlier: ReusableStages<'a>,
    ) -> Self {
        let mut faults = Faults::new();
        let mut earlier = earlier.fitting(params);
        let others = if film_list(params).is_some() { params.split(&["film"]).1 } else { params.clone() };
        let file = faults.take(others.parse::<SceneFile>());
        // A key whose value is null counts as absent: `--set film=null` removes the film. If a section is missing or unknown, the others
        // are still checked, so that all faults are reported together.
        let others = others.without_nulls();
        let section = |key: &str| faults.take(others.stage_at(key)).flatten();
        let [wavelengths, source, lens, imager, film, render] =
            ["wavelengths", "source", "lens", "imager", "film", "render"].map(section);
        let wavelengths = wavelengths.unwrap_or_else(|| params.default_stage("wavelengths"));
        let (band, sampler) = wavelengths.split(&keys_of::<BandSection>());
        let grid = faults.take(band.parse::<BandSection>().and_then(|b| b.grid(&band))).unwrap_or(BAND);
        let render = render.unwrap_or_else(|| params.default_stage("render"));
        let kept = earlier.take_messages();
        kept.warnings.into_iter().for_each(|warning| warnings.push(warning));
        kept.ends.into_iter().for_each(|end| warnings.push_end(end));
        Self {
            params,
            context: Context { warnings: Some(warnings), ..Context::new(resources, grid) },
            warnings,
            earlier,
            sections: Sections { sampler, source, lens, imager, film, render, file },
            faults,
            lens_faults: Faults::new(),
            rear_faults: Faults::new(),
            sampler: None,
            filters: None,
            imager: None,
            centers_on_light: false,
            is_lens_read: false,
            unfocused: None,
            source: None,
            dark: kept.dark,
            films: None,
            render: None,
            output: None,
            channels: None,
            focus_light: None,
            lens: None,
        }
    }

    /// Builds all stages and puts them together.
    ///
    /// # Errors
    /// Every fault of the scene, each with its place.
    pub(crate) fn build(mut self, name: &str, text: String) -> Result<Scene, Faults> {
        self.build_sampler();
        self.read_filters();
        self.build_imager();
        self.build_source();
        if self.earlier.search.workers.should_stop() {
            return Err(Fault::new("the work was stopped").into());
        }
        self.build_films();
        self.read_settings_and_outputs();
        self.set_channels();
        self.focus_lens();
        self.center_imager();
        let settings = self.check_together();
        self.into_scene(name, text, settings)
    }

    fn build_sampler(&mut self) {
        let section = Some(&self.sections.sampler);
        self.sampler = stage(&mut self.earlier.sampler, section, &self.context, &mut self.faults);
    }

    fn read_filters(&mut self) {
        let Context { grid, resources, .. } = self.context;
        let lens = self.sections.lens.as_ref();
        self.filters = lens.and_then(|p| self.faults.take(filters::filters_of(p, grid, resources))).flatten();
    }

    fn build_imager(&mut self) {
        let section = self.sections.imager.as_ref();
        self.centers_on_light = self.earlier.imager.is_none() && section.is_some_and(landing::is_wanted);
        self.imager = stage(&mut self.earlier.imager, section, &self.context, &mut self.rear_faults);
    }

    /// Returns the cover plates in front of the frame.
    fn cover(&self) -> Option<CoverStack> {
        self.imager.as_ref().and_then(|imager| imager.cover())
    }

    /// Reads the lens and sets it, except for the focus, if that was not done before.
    fn read_lens(&mut self) {
        if std::mem::replace(&mut self.is_lens_read, true) {
            return;
        }
        let (cover, resources) = (self.cover(), self.context.resources);
        let lens = self.sections.lens.as_ref();
        self.unfocused = lens.and_then(|p| self.lens_faults.take(configure_lens(p, resources, cover)));
    }

    /// Builds the source with what the frame sees through the lens. A lens that may be kept is not read as long as that view is known.
    fn build_source(&mut self) {
        let is_view_known = self.earlier.knows_view();
        if !(is_view_known && self.earlier.may_have_lens()) {
            self.read_lens();
        }
        let mut view = None;
        if !is_view_known {
            let both = self.unfocused.as_ref().zip(self.imager.as_ref());
            let found = both.and_then(|(unfocused, imager)| {
                frame_view::find_view(&Optics::new(unfocused.lens.clone()), &**imager, self.earlier.search)
            });
            (view, self.dark) = found.map_or((None, None), |found| (Some(found.view), found.dark));
        }
        let context = Context { view: view.as_ref(), ..self.context };
        let section = self.sections.source.as_ref();
        self.source = stage(&mut self.earlier.source, section, &context, &mut self.faults);
    }

    fn build_films(&mut self) {
        self.films = self.earlier.films.take().or_else(|| match film_list(self.params) {
            Some(items) => self.rear_faults.take(films::several(items, self.params, &self.context)),
            None => {
                let section = self.sections.film.as_ref()?;
                self.rear_faults.take(registry::build(section, &self.context)).map(films::one)
            }
        });
    }

    fn read_settings_and_outputs(&mut self) {
        self.render = self.rear_faults.take(self.sections.render.parse::<RenderSection>());
        let file = self.sections.file.as_ref();
        self.output = file
            .and_then(|file| self.rear_faults.take(output::read(file.output.as_deref(), self.params, &self.context)));
    }

    /// Chooses the channels that record the light, checks them, and folds the filters into them.
    fn set_channels(&mut self) {
        let Some(mut channels) = self.unfiltered_channels() else { return };
        let section = if self.films.is_some() { "film" } else { "imager" };
        let wrong = responses::faults(&channels, &self.context.grid, section, self.params);
        if wrong.is_empty() {
            if let Some(transmittance) = &self.filters {
                filters::fold(&mut channels, transmittance);
            }
            self.channels = Some(channels);
        }
        self.rear_faults.extend(wrong);
    }

    /// Returns the channels of the films, or those of an imager that records light directly.
    fn unfiltered_channels(&mut self) -> Option<Vec<Channel>> {
        let fault = match (self.imager.as_ref()?.response(), &self.films) {
            (Some(own), None) => return Some(own.channels()),
            (None, Some(films)) => return Some(films::channels(films)),
            // A film that failed to build has already been reported.
            (None, None) if self.sections.film.is_some() || film_list(self.params).is_some() => return None,
            (Some(_), Some(_)) => {
                let fault = self.params.fault("film", "this imager records light directly and takes no film");
                fault.hint("write `imager: {kind: film, ...}`, or leave the film out")
            }
            (None, None) => {
                let fault = self.params.fault("imager", "a film imager needs a `film`");
                fault.hint("add a film, such as `film: {stock: ilford-ortho-plus, exposure: 1/60 s}`")
            }
        };
        self.rear_faults.push(fault);
        None
    }

    /// Focuses the lens in the light of the scene, as seen by the film or the imager.
    fn focus_lens(&mut self) {
        if let (Some(source), Some(imager), Some(channels)) = (&self.source, &self.imager, &self.channels) {
            let pictured = films::pictured(self.films.as_deref().unwrap_or_default(), channels);
            self.focus_light = Some(FocusLight::of(&**source, &**imager, pictured));
        }
        let cover = self.cover();
        self.lens = self.earlier.lens_in(self.focus_light.as_ref(), cover.as_ref());
        if self.lens.is_none() {
            self.read_lens();
            let unfocused = self.unfocused.take();
            let light = self.focus_light.as_ref();
            self.lens = unfocused.and_then(|lens| self.lens_faults.take(lens.focused(light)));
        }
    }

    /// Builds the imager again around the place where the light lands, if it asks for that. Its warnings were already collected.
    fn center_imager(&mut self) {
        let (Some(section), Some(ConfiguredLens { lens, .. }), Some(source), Some(light), Some(_)) =
            (&self.sections.imager, &self.lens, &self.source, &self.focus_light, &self.imager)
        else {
            return;
        };
        if !self.centers_on_light {
            return;
        }
        match landing::middle_mm(&**source, lens, light, &self.context.grid, size_hint(self.params.get("lens"))) {
            Ok(landing_mm) => {
                let context = Context { landing_mm: Some(landing_mm), warnings: None, ..self.context };
                self.imager = stage(&mut None, Some(section), &context, &mut self.rear_faults);
            }
            Err([text, hint]) => self.rear_faults.push(section.fault("around", text).hint(hint)),
        }
    }

    /// Joins the faults in the order of the sections, adds those that need several stages, and returns the settings of the render.
    fn check_together(&mut self) -> Option<RenderSettings> {
        let params = self.params;
        self.faults.extend(std::mem::take(&mut self.lens_faults));
        if let (Some(section), Some(ConfiguredLens { lens, .. }), Some(source)) =
            (&self.sections.lens, &self.lens, &self.source)
            && lens.elements.first().is_some_and(|e| e.kind == MATTE_BOX && e.vertex_z_mm() <= -source.distance_mm())
        {
            let text = "the source stands between the matte box and the lens";
            let hint = format!("write a distance of less than {} mm", source.distance_mm());
            self.faults.push(section.fault("matte-box.distance", text).hint(hint));
        }
        self.faults.extend(std::mem::take(&mut self.rear_faults));
        let imager = self.imager.as_deref()?;
        if let Some(outputs) = &self.output {
            let films = self.films.as_deref().unwrap_or_default();
            self.faults.extend(output::check(outputs, imager, films, params));
        }
        if let Some(films) = &self.films {
            let misfit = films.iter().find_map(|film| film.film.check_frame(&imager.size()).err());
            self.faults.extend(misfit.map(|[text, hint]| params.fault("imager.resolution", text).hint(hint)));
        }
        let settings = self.render.as_ref()?.settings(&self.sections.render, self.source.as_deref()?, imager);
        self.faults.take(settings)
    }

    /// Returns the scene if all of its stages were built without a fault.
    fn into_scene(self, name: &str, text: String, settings: Option<RenderSettings>) -> Result<Scene, Faults> {
        let parts = (self.source, self.sampler, self.lens, self.imager, self.channels, settings, self.output);
        let (Some(source), Some(sampler), Some(lens), Some(mut imager), Some(channels), Some(render), Some(output)) =
            self.faults.into_result(parts)?
        else {
            return Err(Fault::new("the scene is incomplete").into());
        };
        let mut films = self.films.unwrap_or_default();
        if let Some(frame) = render.frame.filter(|_| !self.earlier.is_check) {
            // Stages shared with another scene already belong to this frame.
            Arc::get_mut(&mut imager).into_iter().for_each(|imager| imager.set_frame(frame));
            films.iter_mut().filter_map(|film| Arc::get_mut(&mut film.film)).for_each(|film| film.set_frame(frame));
        }
        let ConfiguredLens { lens, focus, warnings: focus_warnings } = lens;
        let said = BuildMessages { warnings: self.warnings.all(), ends: self.warnings.ends(), dark: self.dark };
        let mut scene = Scene {
            name: name.to_owned(),
            text,
            grid: self.context.grid,
            source,
            sampler,
            lens,
            focus,
            focused: (self.focus_light, focus_warnings),
            said,
            imager,
            films,
            channels: channels.into(),
            render,
            output,
            warnings: Vec::new(),
            notes: lamps::notes(self.params),
            params: self.params.clone(),
        };
        warn(&scene, self.context.resources, self.warnings);
        scene.warnings = self.warnings.all();
        Ok(scene)
    }
}

/// Adds the warnings that need the whole scene.
fn warn(scene: &Scene, resources: &dyn Resources, warnings: &Warnings) {
    let pays = || scene.source.split().is_some_and(|split| split.pays);
    let apart = scene.render.lights == Lights::Forward || scene.render.lights == Lights::Auto && pays();
    let whole = AssembledScene {
        params: &scene.params,
        resources,
        lens: &scene.lens,
        source: &*scene.source,
        channels: &films::pictured(&scene.films, &scene.channels),
        grid: scene.grid,
        ghosts: scene.render.reflections.order.map_or(apart, |order| order > 0),
    };
    whole.warn(scene.said.dark.as_ref(), warnings);
    scene.focused.1.iter().for_each(|fault| warnings.push(fault.clone()));
    color_cast::casts(&scene.films, &scene.channels, scene.source.white(), &scene.grid, &scene.params)
        .into_iter()
        .for_each(|cast| warnings.push(cast.0));
    for text in films::warnings(&scene.films) {
        warnings.push(scene.params.fault("film", text));
    }
}
