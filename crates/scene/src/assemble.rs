//! Assembly of a [`Scene`] from a scene file; all faults are reported together.

use crate::build_messages::BuildMessages;
use crate::color_cast;
use crate::filters;
use crate::focus::FocusLight;
use crate::hints::{self, FileIs};
use crate::lens_section::{ConfiguredLens, LensSection, configure_lens, size_hint};
use crate::resources::read_yaml;
use crate::reuse::ReusableStages;
use crate::{
    ConePattern, Direction, GhostSpread, Lights, NumberFamily, Output, Reflections, RenderSettings, Scene, films,
    frame_view, lamps, landing, language, output, responses, warnings, yaml,
};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::numbers::seed_of_frame;
use spectra_core::params::{
    Deferred, Fault, Faults, Node, Params, Ratio, StageNode, Value, Warnings, Wavelength, Whole, keys_of,
};
use spectra_core::registry::{self, Context, StageOf};
use spectra_core::resources::Resources;
use spectra_core::spectral::{BAND, Channel, Grid};
use spectra_core::stage::{Film, Imager, Source, WavelengthSampler};
use spectra_lens::MATTE_BOX;
use spectra_optics::Optics;
use spectra_tracer::StrayReflectances;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// A scene: the subject, the lens, what records the light, and which files to write.
///
/// Each section that names a stage (`source`, `wavelengths`, `imager`, `film`) is a map with the `kind` of the stage and
/// its own keys. `spectra list` lists the kinds, and `spectra doc STAGE/NAME` describes their keys. Any number can have a
/// unit (`2 m`, `1/125 s`, `f/2.8`, `550 nm`); a bare number has the unit that the description of the key names ("mm if
/// bare"). Files are looked up beside the scene first, then among the bundled ones.
///
/// `spectra run SCENE` renders a scene, `spectra check SCENE` reports all of its errors.
///
/// # Example
/// ```yaml
/// spectra: 1
/// source: {kind: chart, chart: resolution, distance: 2 m, width: 1.5 m, illuminant: D65, luminance: 300 cd/m2}
/// lens: {file: zeiss-biotar-50-f1.4, f-number: f/2, focus: 2 m}
/// imager: {kind: film, format: 135, resolution: [960, 640]}
/// film: {stock: ilford-ortho-plus, exposure: 1/60 s}
/// render: {samples: 256, seed: 1}
/// output: [exr, png]
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[expect(
    dead_code,
    reason = "states which keys a scene has; sections are taken one by one, so that a fault in one hides none in another"
)]
pub(crate) struct SceneFile {
    /// Version of the format: 1.
    spectra: Whole<1, 1>,
    /// What is in front of the lens.
    source: Deferred<StageOf<dyn Source>>,
    /// How wavelengths are drawn, and from which band; `source-times-response` over 350 to 830 nm if absent.
    #[serde(default)]
    wavelengths: Option<Deferred<StageOf<dyn WavelengthSampler>>>,
    /// The lens: its file, f-number, focus and filters.
    lens: Deferred<LensSection>,
    /// What records the light.
    imager: Deferred<StageOf<dyn Imager>>,
    /// The film on a film imager, or a list of films that get the same light; other imagers take none.
    #[serde(default)]
    film: Option<Deferred<films::FilmForm>>,
    /// How many rays are traced, and how.
    #[serde(default)]
    render: Option<Deferred<RenderSection>>,
    /// The files to write, named after the scene; EXR and PNG if absent.
    #[serde(default)]
    output: Option<Vec<Deferred<StageOf<dyn Output>>>>,
    // The following keys are consumed before a scene is assembled. They are listed so that a misspelled one is reported.
    /// Scenes that this one builds on: a file or a list of files. Maps merge, and the values of this scene win.
    #[serde(default)]
    include: Option<Deferred<language::IncludeForm>>,
    /// Values with names: `$name` stands for the value, `${name}` for its text within another text.
    #[serde(default)]
    variables: Option<Deferred<BTreeMap<String, StageNode>>>,
    /// Values to render one picture each of: paths with lists of values, in all combinations; or a list of maps.
    #[serde(default)]
    sweep: Option<Deferred<language::SweepForm>>,
    /// A sequence of frames, and the values that change over it.
    #[serde(default)]
    animation: Option<Deferred<language::AnimationForm>>,
}

/// The keys of the `wavelengths` section itself; its other keys belong to the sampler.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct BandSection {
    /// First and last wavelength of the band, nm if bare, from 200 to 2500 nm; 350 and 830 nm if absent.
    #[schemars(inner(range(min = 200, max = 2500)))]
    band: Option<[Wavelength; 2]>,
}

/// The `render` section of a scene file.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RenderSection {
    /// Direction in which rays are traced: `backward` (from the imager), `forward` (from the source), `both` or `auto` (the
    /// default). With `both`, lights that are far brighter than the rest of the source are traced from the source, and the rest
    /// from the imager. `auto` is `backward` if source and imager allow it, and `both` if that gives much less noise.
    #[serde(default)]
    direction: RequestedDirection,
    /// Backward: samples per pixel, a whole number from 1 to 4194304; 64 if absent. With `noise`, the largest number of samples
    /// per pixel; 8192 if absent.
    samples: Option<Whole<1, MAX_SAMPLES>>,
    /// Noise at which rendering stops: standard deviation of a pixel relative to the mean around it, 0.01 % to 50 %, of luminance
    /// or of the noisiest film layer. If absent, every pixel gets `samples`.
    #[schemars(extend("minimum" = 0.0001, "maximum" = 0.5))]
    noise: Option<Ratio>,
    /// Forward: total number of rays, a whole number from 1 to 1e15; 4 x pixels x `samples` if absent. With both directions, the
    /// rays from the lights; 12 x `samples` for each pixel that they reach if absent.
    rays: Option<Whole<1, MAX_RAYS>>,
    /// Seed of all random numbers, a whole number from 0 to 18446744073709551615; 1 if absent. The same scene with the same seed
    /// gives the same picture.
    seed: Option<Whole<0, { u64::MAX }>>,
    /// Number of the frame: gives each frame its own random numbers, noise and grain, derived from the seeds.
    frame: Option<Whole<0, { u64::MAX }>>,
    /// Rays that are traced together, a whole number from 8 to 65536; 256 if absent. It changes the speed, not the
    /// picture.
    batch: Option<Whole<8, 65_536>>,
    /// Kind of random numbers: `sobol` (the default), `lattice` (less noise where light is smooth, not at edges), `random` or
    /// `stratified`.
    #[serde(default)]
    numbers: NumberFamily,
    /// How rays fill the aperture: `disk` (the default), `rings` (of equal area) or `random`.
    #[serde(default)]
    cone: ConePattern,
    /// Ghosts and flare: light of the source's lights that surfaces of the lens reflect to the imager.
    #[serde(default)]
    reflections: ReflectionsSection,
    /// Veiling glare: light that glass, paint, film or sensor spread over the frame. `true`, or a map of what causes it; none if
    /// absent.
    glare: Option<GlareSection>,
    /// Whether the edge of the aperture spreads light: stars around lamps, and pictures that soften as the stop closes. If
    /// absent, only where lights are rendered separately and the star of the brightest pixel matters. A star matters if, just
    /// outside the neighboring pixels, it is brighter than 1 % of the median of the frame.
    diffraction: Option<bool>,
}

/// The forms in which `glare` can be written.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
enum GlareSection {
    /// Glare with black paint, or no glare.
    Switch(bool),
    /// Glare with these causes.
    Of(GlareParams),
}

/// Causes of veiling glare.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct GlareParams {
    /// Fraction of the light that barrel, rims, edges of the glass, blades and the inside of the camera scatter, from 0 to 1. If
    /// absent, 4 %, as for flat black paint.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    paint: Option<Ratio>,
    /// Fraction of the light that film or sensor scatter back into the lens, from 0 to 1; none if absent. Their mirror-like
    /// reflection is `reflections.imager`.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    imager: Option<Ratio>,
}

impl GlareSection {
    /// Returns the causes of glare that are asked for, together with the mirror-like reflectance of the imager; `None` if glare
    /// is off.
    fn matter(self, imager_mirror: f64) -> Option<StrayReflectances> {
        let usual = StrayReflectances { imager_mirror, ..StrayReflectances::default() };
        match self {
            Self::Switch(false) => None,
            Self::Switch(true) => Some(usual),
            Self::Of(own) => Some(StrayReflectances {
                paint: own.paint.map_or(usual.paint, Ratio::number),
                imager: own.imager.map_or(usual.imager, Ratio::number),
                ..usual
            }),
        }
    }
}

/// Settings for the reflections to trace.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ReflectionsSection {
    /// How often light may be reflected on its way to the imager: 0 (no ghosts), 2 or 4. If absent, 2 where lights are so bright
    /// that the brightest ghost is more than 1 % of the mean of the frame without ghosts, and 0 elsewhere. With 4, paths that
    /// begin with less than 1e-8 of the light are left out.
    order: Option<Whole<0, 4>>,
    /// Fraction of the light that film or sensor reflect back into the lens like a mirror, from 0 to 1. If absent, 0.043 is
    /// assumed, as for gelatin (index 1.52) in air.
    #[schemars(extend("minimum" = 0, "maximum" = 1))]
    imager: Option<Ratio>,
    /// Follow the polarization of the light at each surface: slower, and more accurate by some percent at steep angles. False if
    /// absent.
    #[serde(default)]
    polarized: bool,
    /// How the light of a ray lands: `footprint` (the default) spreads it over the part of the frame that the ray represents, so
    /// that ghosts are smooth. `none` puts all of it into the pixel that the ray hits, which is noisier; footprints are tested
    /// against it.
    #[serde(default)]
    spread: GhostSpread,
}

/// Fresnel reflectance of gelatin of index 1.52 at normal incidence.
const GELATIN: f64 = (0.52 / 2.52) * (0.52 / 2.52);

/// The forms in which `direction` can be written.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum RequestedDirection {
    #[default]
    Auto,
    Forward,
    Backward,
    Both,
}

/// Largest number of samples per pixel.
const MAX_SAMPLES: u64 = 4_194_304;
/// Largest number of rays of a picture.
const MAX_RAYS: u64 = 1_000_000_000_000_000;
const DEFAULT_SAMPLES: u64 = 64;
/// Default limit of samples with `noise`: a hundred times as many as most pictures need for 1 %.
const DEFAULT_MOST_SAMPLES: u64 = 8192;
const DEFAULT_BATCH: usize = 256;
const DEFAULT_SEED: u64 = 1;
/// Forward rays per pixel and sample if `rays` is not given; there are several because a forward ray lands anywhere.
const FORWARD_RAYS_A_SAMPLE: u64 = 4;

/// Reads the scene file, or the bundled scene of that name if there is no such file.
pub(crate) fn read(path: &Path) -> Result<Node, Faults> {
    if !path.exists()
        && let Ok(bundled) = crate::bundled::scene_file(&path.to_string_lossy())
        && let Some(bytes) = spectra_data::get(&bundled)
    {
        return yaml::parse_bytes(&format!("bundled:{bundled}"), bytes);
    }
    read_yaml(path).map_err(|faults| hints::unreadable(faults, path))
}

/// Returns the scene as written, with the overrides below it as comments. Settings that do not change a picture are left out, so
/// that the record in a picture file does not change with them.
pub(crate) fn record(text: &str, overrides: &[String]) -> String {
    let mut record = text.to_owned();
    if !record.is_empty() && !record.ends_with('\n') {
        record.push('\n');
    }
    for line in overrides.iter().filter(|o| !o.starts_with("render.batch")) {
        record.push_str("# --set ");
        record.push_str(line);
        record.push('\n');
    }
    record
}

/// Assembles all stages of a scene from a tree in which includes, variables and series are already resolved.
///
/// # Errors
/// Every fault of the scene, each with its place.
pub(crate) fn assemble(
    name: &str,
    text: String,
    params: &Params,
    resources: &dyn Resources,
    earlier: ReusableStages<'_>,
) -> Result<Scene, Faults> {
    if let Some(fault) = hints::other_file(params.node(), FileIs::Scene) {
        return Err(Fault { message: fault.message, hint: fault.hint, ..params.fault_here("") }.into());
    }
    all_stages(name, text, params, resources, earlier).map_err(|faults| hints::with_hints(faults, params))
}

fn all_stages(
    name: &str,
    text: String,
    params: &Params,
    resources: &dyn Resources,
    earlier: ReusableStages<'_>,
) -> Result<Scene, Faults> {
    let mut faults = Faults::new();
    let mut earlier = earlier.fitting(params);
    // A list of films is not a single stage, so its section is read separately. A key whose value is null counts as absent:
    // `--set film=null` removes the film.
    let (several, others) = match params.get("film").map(|node| &node.value) {
        Some(Value::Seq(items)) => (Some(items), params.split(&["film"]).1),
        _ => (None, params.clone()),
    };
    let file: Option<SceneFile> = faults.take(others.parse());
    // If a section is missing or unknown, the others are still checked, so that all faults are reported together.
    let others = others.without_nulls();
    let section = |key: &str, faults: &mut Faults| faults.take(others.stage_at(key)).flatten();
    let parts = ["wavelengths", "source", "lens", "imager", "film", "render"].map(|key| section(key, &mut faults));
    let [wavelengths, source, lens, imager, film, render] = parts;
    let film_is_wanted = film.is_some() || several.is_some();
    let (band, sampler) =
        wavelengths.unwrap_or_else(|| params.default_stage("wavelengths")).split(&keys_of::<BandSection>());
    let grid = faults.take(band.parse::<BandSection>().and_then(|b| grid_of(&b, &band))).unwrap_or(BAND);
    let warnings = Warnings::new();
    let said = earlier.take_messages();
    said.warnings.into_iter().for_each(|warning| warnings.push(warning));
    said.ends.into_iter().for_each(|end| warnings.push_end(end));
    let context = Context { warnings: Some(&warnings), ..Context::new(resources, grid) };
    let sampler = match earlier.sampler.take() {
        Some(sampler) => Some(sampler),
        None => faults.take(registry::build::<dyn WavelengthSampler>(&sampler, &context)).map(Arc::from),
    };
    let filters = lens.as_ref().and_then(|p| faults.take(filters::filters_of(p, grid, resources))).flatten();
    // Focus needs all other sections, and a source needs the view of the lens. Faults are reported in the order of the sections
    // all the same.
    let (mut of_lens, mut behind) = (Faults::new(), Faults::new());
    let imager_place = imager.clone().filter(|p| earlier.imager.is_none() && landing::is_wanted(p));
    let mut imager = match earlier.imager.take() {
        Some(imager) => Some(imager),
        None => imager.and_then(|p| behind.take(registry::build::<dyn Imager>(&p, &context))).map(Arc::from),
    };
    let lens_place = lens.clone();
    let cover = imager.as_ref().and_then(|imager| imager.cover());
    let hold =
        |faults: &mut Faults| lens.as_ref().and_then(|p| faults.take(configure_lens(p, resources, cover.clone())));
    let is_view_known = earlier.source.is_some() && (earlier.same_view || earlier.is_check);
    // A lens that can be taken over from the earlier scene is not read again.
    let held = if is_view_known && earlier.may_have_lens() { None } else { Some(hold(&mut of_lens)) };
    let seen = || {
        let (held, imager) = held.as_ref()?.as_ref().zip(imager.as_ref())?;
        frame_view::find_view(&Optics::new(held.lens.clone()), &**imager, earlier.search)
    };
    let (source, dark) = match earlier.source.take() {
        Some(source) if is_view_known => (Some(source), said.dark),
        Some(source) => (Some(source), seen().and_then(|seen| seen.dark)),
        None => {
            let seen = seen();
            let context = Context { view: seen.as_ref().map(|seen| &seen.view), ..context };
            (
                source.and_then(|p| faults.take(registry::build::<dyn Source>(&p, &context))).map(Arc::from),
                seen.and_then(|seen| seen.dark),
            )
        }
    };
    if earlier.search.workers.should_stop() {
        return Err(Fault::new("the work was stopped").into());
    }
    let films = match several {
        _ if earlier.films.is_some() => earlier.films.take(),
        Some(items) => behind.take(films::several(items, params, &context)),
        None => film.and_then(|p| behind.take(registry::build::<dyn Film>(&p, &context))).map(films::one),
    };
    let render = render.unwrap_or_else(|| params.default_stage("render"));
    let settings = behind.take(render.parse::<RenderSection>());
    let output = file.as_ref().and_then(|f| behind.take(output::read(f.output.as_deref(), params, &context)));
    let mut channels = imager.as_ref().and_then(|imager| match (imager.response(), &films) {
        (Some(own), None) => Some(own.channels()),
        (None, Some(films)) => Some(films::channels(films)),
        (Some(_), Some(_)) => {
            let fault = params.fault("film", "this imager records light directly and takes no film");
            behind.push(fault.hint("write `imager: {kind: film, ...}`, or leave the film out"));
            None
        }
        // A film that failed to build has already been reported.
        (None, None) if film_is_wanted => None,
        (None, None) => {
            behind.push(
                params
                    .fault("imager", "a film imager needs a `film`")
                    .hint("such as `film: {stock: ilford-ortho-plus, exposure: 1/60 s}`"),
            );
            None
        }
    });
    if let Some(own) = &channels {
        let wrong = responses::faults(own, &grid, if films.is_some() { "film" } else { "imager" }, params);
        if !wrong.is_empty() {
            channels = None;
        }
        behind.extend(wrong);
    }
    if let (Some(channels), Some(transmittance)) = (&mut channels, &filters) {
        filters::fold(channels, transmittance);
    }
    // The lens is focused in the light of the scene, as seen by the film or the imager.
    let focus_light = match (&source, &imager, &channels) {
        (Some(source), Some(imager), Some(channels)) => {
            let pictured = films::pictured(films.as_deref().unwrap_or_default(), channels);
            Some(FocusLight::of(&**source, &**imager, pictured))
        }
        _ => None,
    };
    let lens = match earlier.lens_in(focus_light.as_ref(), cover.as_ref()) {
        Some(lens) => Some(lens),
        None => {
            let held = held.unwrap_or_else(|| hold(&mut of_lens));
            held.and_then(|held| of_lens.take(held.focused(focus_light.as_ref())))
        }
    };
    if let (Some(place), Some(ConfiguredLens { lens, .. }), Some(source), Some(light)) =
        (imager_place, &lens, &source, &focus_light)
        && imager.is_some()
    {
        // The landing place of the light is known now, so the imager is built again around it. Its warnings were already
        // collected.
        match landing::middle_mm(&**source, lens, light, &grid, size_hint(params.get("lens"))) {
            Ok(landing_mm) => {
                let context = Context { landing_mm: Some(landing_mm), warnings: None, ..context };
                imager = behind.take(registry::build::<dyn Imager>(&place, &context)).map(Arc::from);
            }
            Err([text, hint]) => behind.push(place.fault("around", text).hint(hint)),
        }
    }
    faults.extend(of_lens);
    if let (Some(place), Some(ConfiguredLens { lens, .. }), Some(source)) = (lens_place, &lens, &source)
        && lens.elements.first().is_some_and(|e| e.kind == MATTE_BOX && e.vertex_z_mm() <= -source.distance_mm())
    {
        let fault = place.fault("matte-box.distance", "the source stands between the matte box and the lens");
        faults.push(fault.hint(format!("closer to the lens than {} mm", source.distance_mm())));
    }
    faults.extend(behind);
    if let (Some(imager), Some(outputs)) = (&imager, &output) {
        faults.extend(output::check(outputs, &**imager, films.as_deref().unwrap_or_default(), params));
    }
    if let (Some(imager), Some(films)) = (&imager, &films) {
        let misfit = films.iter().find_map(|film| film.film.check_frame(&imager.size()).err());
        faults.extend(misfit.map(|[text, hint]| params.fault("imager.resolution", text).hint(hint)));
    }
    let settings = match (&settings, &source, &imager) {
        (Some(s), Some(source), Some(imager)) => faults.take(render_settings(s, &render, &**source, &**imager)),
        _ => None,
    };
    let parts = (source, sampler, lens, imager, channels, settings, output);
    let (Some(source), Some(sampler), Some(lens), Some(imager), Some(channels), Some(render), Some(output)) =
        faults.into_result(parts)?
    else {
        return Err(Fault::new("the scene is incomplete").into());
    };
    let (mut films, mut imager) = (films.unwrap_or_default(), imager);
    if let Some(frame) = render.frame.filter(|_| !earlier.is_check) {
        // Stages shared with another scene already belong to this frame.
        Arc::get_mut(&mut imager).into_iter().for_each(|imager| imager.set_frame(frame));
        films.iter_mut().filter_map(|film| Arc::get_mut(&mut film.film)).for_each(|film| film.set_frame(frame));
    }
    let channels: Arc<[Channel]> = channels.into();
    let ConfiguredLens { lens, focus, warnings: of_focus } = lens;
    let pictured = films::pictured(&films, &channels);
    let pays = || source.split().is_some_and(|split| split.pays);
    let apart = render.lights == Lights::Forward || render.lights == Lights::Auto && pays();
    let ghosts = render.reflections.order.map_or(apart, |order| order > 0);
    let whole = warnings::AssembledScene {
        params,
        resources,
        lens: &lens,
        source: &*source,
        channels: &pictured,
        grid,
        ghosts,
    };
    let said = BuildMessages { warnings: warnings.all(), ends: warnings.ends(), dark };
    whole.warn(said.dark.as_ref(), &warnings);
    of_focus.iter().for_each(|fault| warnings.push(fault.clone()));
    color_cast::casts(&films, &channels, source.white(), &grid, params)
        .into_iter()
        .for_each(|cast| warnings.push(cast.0));
    for text in films::warnings(&films) {
        warnings.push(params.fault("film", text));
    }
    let warnings = warnings.into_vec();
    let notes = lamps::notes(params);
    Ok(Scene {
        name: name.to_owned(),
        text,
        grid,
        source,
        sampler,
        lens,
        focus,
        focused: (focus_light, of_focus),
        said,
        imager,
        films,
        channels,
        render,
        output,
        warnings,
        notes,
        params: params.clone(),
    })
}

fn grid_of(section: &BandSection, params: &Params) -> Result<Grid, Faults> {
    let Some([first, last]) = section.band else { return Ok(BAND) };
    let (first, last) = (first.nm(), last.nm());
    if last - first < 1.0 {
        let fault = params.fault("band", format!("not a band of wavelengths: {first} to {last} nm"));
        return Err(fault.hint("the shorter one first, as in `[380, 780]`, at least 1 nm apart").into());
    }
    let count = (last - first).ceil() as usize + 1;
    Ok(Grid { start_nm: first, step_nm: (last - first) / (count - 1) as f64, count })
}

fn render_settings(
    s: &RenderSection,
    params: &Params,
    source: &dyn Source,
    imager: &dyn Imager,
) -> Result<RenderSettings, Faults> {
    let mut faults = Faults::new();
    let default = if s.noise.is_some() { DEFAULT_MOST_SAMPLES } else { DEFAULT_SAMPLES };
    let samples = s.samples.map_or(default, Whole::get);
    if s.noise.is_some() && s.numbers == NumberFamily::Stratified {
        let fault = params.fault(
            "numbers",
            "`stratified` numbers need all of their samples, so rendering cannot stop at a noise level",
        );
        faults.push(fault.hint("write `numbers: sobol`, or leave `noise` out"));
    }
    // The largest default is 2^52 rays: 2^22 samples of 2^28 pixels, times four.
    let rays = s.rays.map_or(samples * FORWARD_RAYS_A_SAMPLE * imager.size().pixels() as u64, Whole::get);
    let seed = s.seed.map_or(DEFAULT_SEED, Whole::get);
    let frame = s.frame.map(Whole::get);
    if s.reflections.order.is_some_and(|order| order.get() % 2 == 1) {
        let fault = params
            .fault("reflections.order", "light that is reflected an odd number of times leaves the lens at the front");
        faults.push(fault.hint("write `order: 2` or `order: 4`, or `order: 0` for no ghosts"));
    }
    let can_backward = source.radiance().is_some() && imager.launch().is_some();
    let can_forward = source.emit().is_some() && imager.receive().is_some();
    // If only the lights of a source emit rays, the rest is rendered backward.
    let has_lights = source.split().is_some_and(|split| split.lights.emit().is_some());
    let lights_forward = can_forward || has_lights && imager.receive().is_some();
    let direction = match s.direction {
        RequestedDirection::Auto if can_backward => Direction::Backward,
        RequestedDirection::Auto | RequestedDirection::Forward => Direction::Forward,
        RequestedDirection::Backward | RequestedDirection::Both => Direction::Backward,
    };
    let lights = match s.direction {
        RequestedDirection::Auto if can_backward && lights_forward => Lights::Auto,
        RequestedDirection::Both => Lights::Forward,
        _ => Lights::Same,
    };
    if lights == Lights::Forward && can_backward && !lights_forward {
        let fault = params.fault("direction", "this source cannot be rendered forward");
        faults.push(fault.hint("write `direction: backward`, or leave it to `auto`"));
    }
    if direction == Direction::Backward && !can_backward {
        let fault = params.fault("direction", "this source cannot be rendered backward");
        faults.push(fault.hint("write `direction: forward`, or leave it to `auto`"));
    }
    if direction == Direction::Forward && !can_forward {
        let fault = params.fault("direction", "this source cannot be rendered forward");
        faults.push(fault.hint("write `direction: backward`, or leave it to `auto`"));
    }
    if direction == Direction::Forward && rays > MAX_RAYS {
        let fault = params.fault("samples", format!("this makes {rays} rays, but at most {MAX_RAYS} can be traced"));
        faults.push(fault.hint("use fewer samples or pixels, or write `rays`"));
    }
    let imager_mirror = s.reflections.imager.map_or(GELATIN, Ratio::number);
    let glare = s.glare.and_then(|glare| glare.matter(imager_mirror));
    if let Some(matter) = glare.filter(|matter| matter.imager + matter.imager_mirror > 1.0) {
        let fault = params.fault("glare.imager", "the imager sends back more light than reaches it");
        faults.push(fault.hint(format!(
            "`glare.imager` and `reflections.imager` ({}) must add up to at most 1",
            matter.imager_mirror
        )));
    }
    faults.into_result(RenderSettings {
        direction,
        lights,
        samples: samples as u32,
        noise: s.noise.map(Ratio::number),
        rays,
        rays_stated: s.rays.is_some(),
        seed: frame.map_or(seed, |frame| seed_of_frame(seed, frame)),
        frame,
        batch: s.batch.map_or(DEFAULT_BATCH, Whole::size),
        numbers: s.numbers,
        cone: s.cone,
        reflections: Reflections {
            order: s.reflections.order.map(Whole::get_u32),
            imager: s.reflections.imager.map_or(GELATIN, Ratio::number),
            imager_stated: s.reflections.imager.is_some(),
            polarized: s.reflections.polarized,
            spread: s.reflections.spread,
        },
        glare,
        diffraction: s.diffraction,
    })
}
