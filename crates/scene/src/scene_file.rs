//! The keys of a scene file, and those of its section `wavelengths`.

use crate::lens_section::LensSection;
use crate::render_section::RenderSection;
use crate::{Output, films, language};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Deferred, Faults, Params, StageNode, Wavelength, Whole};
use spectra_core::registry::StageOf;
use spectra_core::spectral::{BAND, Grid};
use spectra_core::stage::{Imager, Source, WavelengthSampler};
use std::collections::BTreeMap;

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
    pub(crate) output: Option<Vec<Deferred<StageOf<dyn Output>>>>,
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

impl BandSection {
    /// Returns the grid of the band, with steps of at most 1 nm.
    ///
    /// # Errors
    /// The band is reversed or narrower than 1 nm.
    pub(crate) fn grid(&self, params: &Params) -> Result<Grid, Faults> {
        let Some([first, last]) = self.band else { return Ok(BAND) };
        let (first, last) = (first.nm(), last.nm());
        if last - first < 1.0 {
            let fault = params.fault("band", format!("not a band of wavelengths: {first} to {last} nm"));
            return Err(fault
                .hint("write the shorter wavelength first, at least 1 nm below the longer one, as in `[380, 780]`")
                .into());
        }
        let count = (last - first).ceil() as usize + 1;
        Ok(Grid { start_nm: first, step_nm: (last - first) / (count - 1) as f64, count })
    }
}
