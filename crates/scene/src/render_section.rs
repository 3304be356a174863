//! The `render` section of a scene, and the settings that follow from it.

use crate::{ConePattern, Direction, GhostSpread, Lights, NoiseLimit, NumberFamily, Reflections, RenderSettings};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::numbers::seed_of_frame;
use spectra_core::params::{Faults, Params, Ratio, Whole};
use spectra_core::stage::{Imager, Source};
use spectra_tracer::StrayReflectances;

/// The `render` section of a scene file.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct RenderSection {
    /// Direction in which rays are traced: `backward` (from the imager), `forward` (from the source), `both` or `auto` (the
    /// default). With `both`, lights that are far brighter than the rest of the source are traced from the source, and the rest
    /// from the imager. `auto` is `backward` if source and imager allow it, and `both` if that gives much less noise.
    #[serde(default)]
    direction: RequestedDirection,
    /// Backward: samples per pixel, a whole number from 1 to 4194304. With `noise`, the largest number of samples per pixel; 8192 if
    /// absent.
    samples: Option<Whole<1, MAX_SAMPLES>>,
    /// Noise at which rendering stops: standard deviation of a pixel relative to the mean around it, 0.01 % to 50 %, of luminance
    /// or of the noisiest film layer. `auto` is a third of the standard deviation of the film's grain there, which hides it, and
    /// 1 % if there is no grain or if `output` asks for a file of the light. If absent, every pixel gets `samples`; if `samples`
    /// and `rays` are absent as well, `auto`.
    noise: Option<NoiseSection>,
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

/// The forms in which `noise` can be written.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
enum NoiseSection {
    /// Fraction of the light.
    Of(#[schemars(extend("minimum" = 0.0001, "maximum" = 0.5))] Ratio),
    /// The word `auto`.
    Auto(AutoWord),
}

/// The word `auto` as the value of `noise`.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum AutoWord {
    /// A third of the grain of the film, or 1 %.
    Auto,
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

impl RenderSection {
    /// Resolves the section with the defaults for this source and imager.
    ///
    /// # Errors
    /// Every setting that contradicts another one, or that this source and imager do not allow.
    pub(crate) fn settings(
        &self,
        params: &Params,
        source: &dyn Source,
        imager: &dyn Imager,
    ) -> Result<RenderSettings, Faults> {
        let mut faults = Faults::new();
        let is_bare = self.noise.is_none() && self.samples.is_none() && self.rays.is_none();
        let noise = match self.noise {
            Some(NoiseSection::Of(asked)) => Some(NoiseLimit::Fraction(asked.number())),
            Some(NoiseSection::Auto(_)) => Some(NoiseLimit::Auto),
            // Stratified numbers are laid out for all samples, so they cannot stop earlier.
            None if is_bare && self.numbers != NumberFamily::Stratified => Some(NoiseLimit::Auto),
            None => None,
        };
        let default = if noise.is_some() { DEFAULT_MOST_SAMPLES } else { DEFAULT_SAMPLES };
        let samples = self.samples.map_or(default, Whole::get);
        if noise.is_some() && self.numbers == NumberFamily::Stratified {
            let fault = params.fault(
                "numbers",
                "`stratified` numbers need all of their samples, so rendering cannot stop at a noise level",
            );
            faults.push(fault.hint("write `numbers: sobol`, or leave `noise` out"));
        }
        // The largest default is 2^52 rays: 2^22 samples of 2^28 pixels, times four.
        let rays = self.rays.map_or(samples * FORWARD_RAYS_A_SAMPLE * imager.size().pixels() as u64, Whole::get);
        let seed = self.seed.map_or(DEFAULT_SEED, Whole::get);
        let frame = self.frame.map(Whole::get);
        if self.reflections.order.is_some_and(|order| order.get() % 2 == 1) {
            let fault = params.fault(
                "reflections.order",
                "light that is reflected an odd number of times leaves the lens at the front",
            );
            faults.push(fault.hint("write `order: 2` or `order: 4`, or `order: 0` for no ghosts"));
        }
        let (direction, lights) = self.direction(params, source, imager, &mut faults);
        if direction == Direction::Forward && rays > MAX_RAYS {
            let fault =
                params.fault("samples", format!("this makes {rays} rays, but at most {MAX_RAYS} can be traced"));
            faults.push(fault.hint("use fewer samples or pixels, or write `rays`"));
        }
        let imager_mirror = self.reflections.imager.map_or(GELATIN, Ratio::number);
        let glare = self.glare.and_then(|glare| glare.matter(imager_mirror));
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
            noise,
            rays,
            rays_stated: self.rays.is_some(),
            seed: frame.map_or(seed, |frame| seed_of_frame(seed, frame)),
            frame,
            batch: self.batch.map_or(DEFAULT_BATCH, Whole::size),
            numbers: self.numbers,
            cone: self.cone,
            reflections: Reflections {
                order: self.reflections.order.map(Whole::get_u32),
                imager: imager_mirror,
                imager_stated: self.reflections.imager.is_some(),
                polarized: self.reflections.polarized,
                spread: self.reflections.spread,
            },
            glare,
            diffraction: self.diffraction,
        })
    }

    /// Chooses the direction of the rays and how lights are rendered, and reports a choice that source or imager do not allow.
    fn direction(
        &self,
        params: &Params,
        source: &dyn Source,
        imager: &dyn Imager,
        faults: &mut Faults,
    ) -> (Direction, Lights) {
        let can_backward = source.radiance().is_some() && imager.launch().is_some();
        let can_forward = source.emit().is_some() && imager.receive().is_some();
        // If only the lights of a source emit rays, the rest is rendered backward.
        let has_lights = source.split().is_some_and(|split| split.lights.emit().is_some());
        let lights_forward = can_forward || has_lights && imager.receive().is_some();
        let direction = match self.direction {
            RequestedDirection::Auto if can_backward => Direction::Backward,
            RequestedDirection::Auto | RequestedDirection::Forward => Direction::Forward,
            RequestedDirection::Backward | RequestedDirection::Both => Direction::Backward,
        };
        let lights = match self.direction {
            RequestedDirection::Auto if can_backward && lights_forward => Lights::Auto,
            RequestedDirection::Both => Lights::Forward,
            _ => Lights::Same,
        };
        if lights == Lights::Forward && can_backward && !lights_forward {
            let fault = params.fault("direction", "this source cannot be rendered forward");
            faults.push(fault.hint("write `direction: backward` or `direction: auto`"));
        }
        if direction == Direction::Backward && !can_backward {
            let fault = params.fault("direction", "this source cannot be rendered backward");
            faults.push(fault.hint("write `direction: forward` or `direction: auto`"));
        }
        if direction == Direction::Forward && !can_forward {
            let fault = params.fault("direction", "this source cannot be rendered forward");
            faults.push(fault.hint("write `direction: backward` or `direction: auto`"));
        }
        (direction, lights)
    }
}
