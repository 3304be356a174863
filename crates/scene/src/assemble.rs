//! Assembly of a [`Scene`] from a scene file; all faults are reported together.

use crate::hints::{self, FileIs};
use crate::lens_section::LensSection;
use crate::render_section::RenderSection;
use crate::resources::read_yaml;
use crate::reuse::ReusableStages;
use crate::scene_builder::SceneBuilder;
use crate::{Output, Scene, films, language, yaml};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Deferred, Fault, Faults, Node, Params, StageNode, Warnings, Wavelength, Whole};
use spectra_core::registry::StageOf;
use spectra_core::resources::Resources;
use spectra_core::spectral::{BAND, Grid};
use spectra_core::stage::{Imager, Source, WavelengthSampler};
use std::collections::BTreeMap;
use std::path::Path;

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
            return Err(fault.hint("the shorter one first, as in `[380, 780]`, at least 1 nm apart").into());
        }
        let count = (last - first).ceil() as usize + 1;
        Ok(Grid { start_nm: first, step_nm: (last - first) / (count - 1) as f64, count })
    }
}

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
    let warnings = Warnings::new();
    let builder = SceneBuilder::new(params, resources, &warnings, earlier);
    builder.build(name, text).map_err(|faults| hints::with_hints(faults, params))
}
