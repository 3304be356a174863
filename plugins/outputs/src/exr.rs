//! `kind: exr`: exposures and pictures as OpenEXR files.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::frame::{ExposureFrame, ExtraRequest, ImageState};
use spectra_core::params::{Faults, Params};
use spectra_core::registry::Context;
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::{Film, Imager};
use spectra_pictures::library;
use spectra_pictures::write::{LinearSpace, exr, picture_exr, tiled_exr};
use spectra_scene::{FileContent, GhostPaths, LightKind, LightLayer, Output, Shot};

/// The linear exposure as an OpenEXR file with its recorded channels, or the finished picture.
///
/// The exposure keeps everything that was computed: 32-bit floats in lux seconds (or in the unit of the channel), with the scene and how it
/// was rendered in the header. Use it for measurements, and to keep the light of a long render. `layers` adds kinds of light, each with a
/// channel for each channel of the exposure: `layers: [direct, ghosts]` adds `direct.Y` and `ghosts.Y` to `Y`. All four kinds together are
/// the exposure, up to the rounding of their 32 bits. A kind that the picture does not have is 0. `ghost-paths: 6` splits `ghosts`:
/// `ghosts.7-3.Y` is the light that surface 7 and then surface 3 reflect, for each of the six strongest paths, and `ghosts.other.Y` is the
/// rest.
///
/// `holds: picture` is for compositing, and writes `SCENE-picture.exr`: R, G and B of the developed, printed or balanced picture in linear
/// light. No color is clipped to the gamut of a screen. 1 is the film's white, or what the picture of the imager shows as white. The header
/// states the primaries (`chromaticities`, `adoptedNeutral`) and the name of the color space for OpenColorIO (`oiio:ColorSpace`) and for
/// the Color Interop Forum (`colorInteropID`). `spectra:image state` in the header says what the values are. Imagers that record without
/// film give scene-referred values, prints and projections display-referred ones. Scans on a density scale give data: R, G and B are the
/// values of the scale. Several films side by side get a file each.
///
/// # Example
/// ```yaml
/// {kind: exr}
/// ```
/// ```yaml
/// {kind: exr, layers: [direct, glare, star], ghost-paths: 6}
/// ```
/// ```yaml
/// {kind: exr, holds: picture, space: acescg, layers: [exposures]}
/// ```
///
/// # References
/// - Academy S-2014-004, ACEScg.
/// - Color Interop Forum, Color space encodings for texture assets and CG rendering, 2024.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ExrParams {
    /// Whether the file is written in tiles, for viewers that read only a part of a large file; needs a program built with OpenImageIO.
    #[serde(default)]
    tiled: bool,
    /// Content of the file: `light`, the exposure (the default), or `picture`.
    #[serde(default)]
    holds: Content,
    /// Color space with `holds: picture`: `linear-srgb` (the default), `rec2020`, `p3-d65`, `acescg` (with the white of ACES), or `xyz`.
    /// All except `acescg` have the white D65; CAT02 adapts one white to another.
    space: Option<Space>,
    /// Layers in addition to the main channels. Of light: `direct`, straight through the lens; `ghosts`; `glare`, the veil; `star`, the
    /// light that diffraction moves, negative where more leaves than arrives. With `holds: picture`: `exposures` of each channel, for a
    /// film in lux seconds after scatter and halation, as `exposure.red`; `densities` of each layer of a film as a densitometer reads them,
    /// grain included, as `density.red`, and those of a print as `print.red`, or `print.silver` on paper.
    #[schemars(length(max = 4))]
    layers: Option<Vec<LayerGroup>>,
    /// Number of ghost paths that get layers of their own. These are the strongest of the picture by their light on the frame in watts, as
    /// in its `ledger`. Each is named by the surfaces that reflect, as by `spectra lens ghosts`. All others form one more layer.
    #[schemars(range(min = 1, max = 32))]
    ghost_paths: Option<u8>,
    /// Whether R, G and B take 16 bits each, with `holds: picture`: half the space, three digits.
    half: Option<bool>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Content {
    #[default]
    Light,
    Picture,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[schemars(inline)]
enum Space {
    #[default]
    #[serde(rename = "linear-srgb")]
    Srgb,
    #[serde(rename = "rec2020")]
    Rec2020,
    #[serde(rename = "p3-d65")]
    P3D65,
    #[serde(rename = "acescg")]
    AcesCg,
    #[serde(rename = "xyz")]
    Xyz,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum LayerGroup {
    Exposures,
    Densities,
    Direct,
    Ghosts,
    Glare,
    Star,
}

impl LayerGroup {
    /// Returns the kind of light that the layer holds; `None` if it is made from a picture.
    fn light(self) -> Option<LightKind> {
        match self {
            Self::Exposures | Self::Densities => None,
            Self::Direct => Some(LightKind::Direct),
            Self::Ghosts => Some(LightKind::Ghosts),
            Self::Glare => Some(LightKind::Glare),
            Self::Star => Some(LightKind::Star),
        }
    }
}

impl From<Space> for LinearSpace {
    fn from(space: Space) -> Self {
        match space {
            Space::Srgb => Self::Srgb,
            Space::Rec2020 => Self::Rec2020,
            Space::P3D65 => Self::P3D65,
            Space::AcesCg => Self::AcesCg,
            Space::Xyz => Self::Xyz,
        }
    }
}

spectra_core::register!(spectra_scene::OutputEntry, "exr": ExrParams, build);

struct Exr {
    tiled: bool,
    lights: Vec<LightKind>,
    ghost_paths: usize,
}

impl Exr {
    /// Selects the layers that this output writes from those that the picture has.
    fn selected_layers<'a>(&self, layers: &'a [LightLayer]) -> Result<Vec<&'a LightLayer>, WriteFault> {
        let (kinds, paths): (Vec<_>, Vec<_>) = layers.iter().partition(|layer| layer.paths == GhostPaths::All);
        let of_kind = |kind: &LightKind| kinds.iter().copied().find(|layer| layer.kind == *kind);
        let mut own: Vec<&LightLayer> = self.lights.iter().filter_map(of_kind).collect();
        if own.len() < self.lights.len() {
            return Err(WriteFault::Format("this light was saved without separate kinds of light".to_owned()));
        }
        if self.ghost_paths > 0 {
            if paths.is_empty() {
                return Err(WriteFault::Format("this light was saved without separate ghost paths".to_owned()));
            }
            own.extend(paths);
        }
        Ok(own)
    }
}

fn build(params: &Params, _: &Context<'_>) -> Result<Box<dyn Output>, Faults> {
    let p: ExrParams = params.parse()?;
    let mut faults = Faults::new();
    if p.tiled && library::library().is_none() {
        let fault = params.fault("tiled", "only OpenImageIO can write tiled OpenEXR files");
        faults.push(fault.hint(library::WITHOUT));
    }
    if p.holds == Content::Picture {
        if p.tiled {
            faults.push(params.fault("tiled", "a picture cannot be written in tiles").hint("leave out `tiled`"));
        }
        let layers = p.layers.unwrap_or_default();
        if let Some(at) = layers.iter().position(|layer| layer.light().is_some()) {
            let fault =
                params.fault(&format!("layers[{at}]"), "kinds of light are layers of the exposure, not of the picture");
            faults.push(fault.hint("write an output `{kind: exr, layers: [...]}` without `holds: picture`"));
        }
        if p.ghost_paths.is_some() {
            let fault = params.fault("ghost-paths", "ghost paths are layers of the exposure, not of the picture");
            faults.push(fault.hint("write an output `{kind: exr, ghost-paths: ...}` without `holds: picture`"));
        }
        let (space, half) = (p.space.unwrap_or_default().into(), p.half.unwrap_or(false));
        return faults.into_result(Box::new(PictureExr { space, layers, half }) as _);
    }
    for (key, given) in [("space", p.space.is_some()), ("half", p.half.is_some())] {
        if given {
            let fault = params.fault(key, format!("`{key}` is for the finished picture, not for the exposure"));
            faults.push(fault.hint("write `holds: picture`"));
        }
    }
    let mut lights = Vec::new();
    for (at, layer) in p.layers.unwrap_or_default().into_iter().enumerate() {
        match layer.light() {
            Some(kind) if lights.contains(&kind) => {
                let fault = params.fault(&format!("layers[{at}]"), format!("`{}` is listed twice", kind.name()));
                faults.push(fault.hint("leave one of them out"));
            }
            Some(kind) => lights.push(kind),
            None => {
                let fault = params
                    .fault(&format!("layers[{at}]"), "this layer belongs to the finished picture, not to the exposure");
                faults
                    .push(fault.hint("write `holds: picture`, or choose from `direct`, `ghosts`, `glare` and `star`"));
            }
        }
    }
    faults.into_result(Box::new(Exr { tiled: p.tiled, lights, ghost_paths: p.ghost_paths.unwrap_or(0).into() }) as _)
}

impl Output for Exr {
    fn kind(&self) -> &'static str {
        "exr"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["", ".exr"]
    }

    fn content(&self) -> FileContent {
        FileContent::Light
    }

    fn lights(&self) -> &[LightKind] {
        &self.lights
    }

    fn ghost_paths(&self) -> usize {
        self.ghost_paths
    }

    fn write(&self, shot: &Shot<'_>, _: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let write = if self.tiled { tiled_exr } else { exr };
        let (gains, squeeze) = (shot.gains(), shot.scene.lens.squeeze);
        if self.lights.is_empty() && self.ghost_paths == 0 {
            return write(out, shot.exposure, &gains, squeeze, shot.attributes);
        }
        let layers = self.selected_layers(shot.layers)?;
        let channels = shot.exposure.channels.iter().chain(layers.iter().flat_map(|layer| &layer.channels));
        let frame = ExposureFrame { size: shot.exposure.size, channels: channels.cloned().collect() };
        let gains = gains.repeat(1 + layers.len());
        write(out, &frame, &gains, squeeze, shot.attributes)
    }
}

/// Output of the finished picture.
struct PictureExr {
    space: LinearSpace,
    layers: Vec<LayerGroup>,
    half: bool,
}

impl PictureExr {
    /// Whether the scene asks for a layer of this name.
    fn takes(&self, name: &str) -> bool {
        let is_of = |group: &LayerGroup| match group {
            LayerGroup::Exposures => name.starts_with("exposure."),
            LayerGroup::Densities => name.starts_with("density.") || name.starts_with("print."),
            // Kinds of light were already rejected.
            _ => false,
        };
        self.layers.iter().any(is_of)
    }
}

impl Output for PictureExr {
    fn kind(&self) -> &'static str {
        "exr"
    }

    fn ending(&self) -> [&'static str; 2] {
        ["-picture", ".exr"]
    }

    fn content(&self) -> FileContent {
        FileContent::Picture
    }

    fn check(&self, imager: &dyn Imager) -> Result<(), [String; 2]> {
        if imager.response().is_some() && self.layers.contains(&LayerGroup::Densities) {
            return Err(["there is no density without a film".to_owned(), "write `layers: [exposures]`".to_owned()]);
        }
        Ok(())
    }

    fn check_film(&self, film: &dyn Film) -> Result<(), [String; 2]> {
        if !self.layers.is_empty() && !film.has_layers() {
            let text = format!("{} does not say what its layers hold", film.name());
            return Err([text, "leave out `layers`".to_owned()]);
        }
        let is_data = film.image_state() == ImageState::Data;
        if is_data && self.space != LinearSpace::default() {
            return Err([DENSITIES.to_owned(), "leave out `space`, or write `scan: picture`".to_owned()]);
        }
        Ok(())
    }

    fn extra_request(&self) -> ExtraRequest {
        ExtraRequest { unclamped: true, layers: !self.layers.is_empty() }
    }

    fn write(&self, shot: &Shot<'_>, film: usize, out: &mut dyn Out) -> Result<(), WriteFault> {
        let beside = shot.extra_data(film)?;
        let layers: Vec<_> = beside.layers.iter().filter(|layer| self.takes(&layer.name)).cloned().collect();
        let mut attributes = shot.attributes.to_vec();
        attributes.extend(beside.white.as_ref().map(|white| ("spectra:white".to_owned(), format!("1 is {white}"))));
        let colors = (self.space, shot.image_state(film));
        picture_exr(out, shot.unclamped_picture(film)?, &layers, colors, self.half, shot.pixel_aspect(), &attributes)
    }
}

/// Message about a color space for values that are not colors.
pub(crate) const DENSITIES: &str = "a scan on a density scale has no color space";
