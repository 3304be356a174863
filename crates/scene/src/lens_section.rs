//! The `lens` section of a scene: which lens, and how it is set.
//!
//! The lens is scaled, reversed, coated, stopped down and focused as its maker intended, in this order. Then groups are
//! misaligned. A focus by real rays, as a camera finds it, sees the misaligned lens. A matte box comes last. The frame is moved
//! back by the image shift of the cover plates in front of it, with or without focusing.
//!
//! By default the lens is focused where the contrast on the axis is highest in the light of the scene. It is therefore set after the
//! other stages are known. The tracer ends at the frame's nominal plane and knows no plates. Focus adds what they do in closed form
//! ([`spectra_core::cover`]), and the imager itself passes the light through them.

use crate::filters::FilterForm;
use crate::focus::{Focus, FocusBy, FocusLight};
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::cover::CoverStack;
use spectra_core::params::{
    Angle, Deferred, Dimension, FNumber, Fault, Faults, Length, Node, OrInfinity, Params, Positive, Reading,
    SpatialFrequency, StageNode, Value, Wavelength,
};
use spectra_core::resources::Resources;
use spectra_exchange::Format;
use spectra_lens::{
    ApertureForm, ApertureShape, CoatingForm, DustForm, FocusError, HazeForm, Lens, MatteBox, Misalignment, ScaleError,
    ScratchesForm, SeparationForm,
};
use spectra_optics::{ApertureError, Criterion, FocusSearch, Optics, stop_down};
use std::sync::Arc;

/// The `lens` section of a scene file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct LensSection {
    /// A lens file beside the scene, or the name of a bundled lens.
    #[expect(dead_code, reason = "states the key; the lens is read even where another key is faulty")]
    file: String,
    /// Focal length that the whole lens is scaled to, at its reference line, mm if bare; that of the lens file if absent. Patents
    /// state many lenses for a focal length of 1 or 100.
    focal_length: Option<Positive<Length>>,
    /// Whether the lens is mounted back to front.
    #[serde(default)]
    reverse: bool,
    /// Coating of all surfaces: `ideal` (no reflection), `bare`, `single-layer`, `three-layer`, a layer or a stack. If absent,
    /// that of the lens file, or else the usual coating for the year of the lens.
    coating: Option<Deferred<CoatingForm>>,
    /// Separated cement in all surfaces between two glasses, instead of what the lens file says: the width of the air gap, and
    /// how far it reaches in from the edge.
    separation: Option<Deferred<SeparationForm>>,
    /// Haze on all surfaces between glass and air, instead of what the lens file says: the share of the light that each surface
    /// scatters, and how widely.
    haze: Option<Deferred<HazeForm>>,
    /// Dust on all surfaces between glass and air, instead of what the lens file says: the share that it covers, and the size of
    /// its grains.
    dust: Option<Deferred<DustForm>>,
    /// Scratches on all surfaces between glass and air, instead of what the lens file says: the share that they cover or a
    /// drawing of them, and their width.
    scratches: Option<Deferred<ScratchesForm>>,
    /// Whether glass absorbs light. If absent, as in the lens file, or else true.
    absorption: Option<bool>,
    /// F-number, set with the real marginal ray; as in the lens file if absent. The f-number in the name of a lens means wide
    /// open.
    f_number: Option<FNumber>,
    /// Shape of the opening at the stop, such as blades or a mask: one or a list, as in a lens file; round if absent.
    aperture: Option<Deferred<ApertureForm>>,
    /// Distance from the first vertex that is in focus, mm if bare, or `infinity`; the lens file's focus if absent. An object at
    /// this distance on the axis has the highest contrast, in the light and at the aperture of the scene. To focus by another
    /// criterion, write a map.
    focus: Option<Deferred<FocusForm>>,
    /// Factor by which the lens squeezes the picture horizontally, 0.1 to 10; it sets the shape of the pixels in the files. If
    /// absent, as in the lens file.
    #[schemars(range(min = 0.1, max = 10))]
    squeeze: Option<f64>,
    /// Misalignment: groups of the lens that are displaced or tilted. None if absent.
    #[serde(default)]
    adjust: Vec<Deferred<AdjustParams>>,
    /// Filters in front of the lens, at most 16, each a name of a transmittance or a map; none if absent.
    #[expect(dead_code, reason = "states the key; filters are read by themselves")]
    filters: Option<Deferred<Vec<FilterForm>>>,
    /// A matte box: a rectangular opening in front of the lens; none if absent.
    matte_box: Option<Deferred<MatteBoxParams>>,
}

/// A matte box in front of the lens.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MatteBoxParams {
    /// Distance of the opening in front of the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Width of the opening, mm if bare.
    width: Positive<Length>,
    /// Height of the opening, mm if bare.
    height: Positive<Length>,
}

/// `focus` written as a map.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct FocusParams {
    /// Distance from the first vertex that is in focus, mm if bare, or `infinity`.
    distance: OrInfinity<Positive<Length>>,
    /// Criterion: `contrast` (the highest at a spatial frequency; the default), `spot` (the smallest RMS radius; `rms` means the
    /// same) or `paraxial`. With `paraxial` there is no search: from its infinity position in the file, the lens moves as far as
    /// first-order optics says, at its reference line. The distance between the image plane and the first-order image in the file
    /// is kept, because designers put the film where fast lenses are sharpest.
    #[serde(default)]
    by: By,
    /// Field angle that is in focus, -89 to 89 degrees, degrees if bare; 0, the axis, if absent.
    #[schemars(range(min = -89, max = 89))]
    field: Option<Angle>,
    /// Wavelength that is in focus, 200 to 2500 nm, nm if bare. If this and `spectrum` are absent: the light of the scene,
    /// weighted by the response of the film or the imager.
    #[schemars(range(min = 200, max = 2500))]
    wavelength: Option<Wavelength>,
    /// Instead of `wavelength`: 1 to 64 wavelengths, nm if bare, each with a weight greater than 0.
    #[schemars(length(min = 1, max = 64))]
    spectrum: Option<Vec<Weighed>>,
    /// Spatial frequency for `by: contrast`, line pairs per mm if bare. If absent, 30 on a 135 frame, and inversely proportional
    /// to the diagonal on other frames (on frames smaller than super 8, the value of super 8).
    frequency: Option<Positive<SpatialFrequency>>,
}

/// A wavelength, 200 to 2500 nm, and its weight.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(inline)]
struct Weighed(#[schemars(range(min = 200, max = 2500))] Wavelength, #[schemars(extend("exclusiveMinimum" = 0))] f64);

/// Criteria that a focus can be set by.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum By {
    #[default]
    Contrast,
    Spot,
    Rms,
    Paraxial,
}

/// The forms in which `focus` can be written.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
enum FocusForm {
    /// The distance alone.
    Distance(OrInfinity<Positive<Length>>),
    /// Map with distance and criterion.
    By(Box<FocusParams>),
}

/// A misaligned group of the lens.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct AdjustParams {
    /// Name of the group in the lens file.
    group: String,
    /// Shift along x and y, mm if bare; as in the lens file if absent.
    decenter: Option<[Length; 2]>,
    /// Tilts about x, y and z, degrees if bare, about the vertex of the group's first surface; as in the lens file if absent.
    tilt: Option<[Angle; 3]>,
    /// Shift along the axis toward the image, mm if bare; none if absent.
    shift: Option<Length>,
}

/// The requested focus, and the search for it.
struct FocusRequest {
    distance_mm: f64,
    by: FocusBy,
    search: Option<FocusSearch>,
    /// Whether only the distance was stated.
    plain: bool,
}

/// A lens as set by a scene.
#[derive(Clone)]
pub(crate) struct ConfiguredLens {
    pub(crate) lens: Arc<Optics>,
    pub(crate) focus: Focus,
    /// Warnings about how the lens is set.
    pub(crate) warnings: Vec<Fault>,
}

/// A lens that is set completely except for the focus by real rays, which depends on the light of the scene. It is focused by
/// first order.
pub(crate) struct UnfocusedLens {
    pub(crate) lens: Lens,
    params: Params,
    focus: Option<Deferred<FocusForm>>,
    matte_box: Option<MatteBox>,
}

/// Sets the lens of a scene, with these cover plates in front of the frame.
pub(crate) fn configure_lens(
    params: &Params,
    resources: &dyn Resources,
    cover: Option<CoverStack>,
) -> Result<UnfocusedLens, Faults> {
    let mut faults = Faults::new();
    if let Some(kind) = params.kind() {
        let fault = params.fault("kind", "a lens has no `kind`: name its file with `file`");
        return Err(match params.get("file") {
            Some(_) => fault.hint("leave `kind` out"),
            None if spectra_lens::load(kind, resources).is_ok() => {
                fault.hint(format!("write `lens: {{file: {kind}}}`")).path("lens")
            }
            None => fault
                .hint(
                    "`spectra list lens` has the names for `lens: {file: NAME}`; a file of your own has `name` and `surfaces`, \
                     for an ideal lens `[{kind: thin-lens, focal-length: 50, thickness: 50, semi-diameter: 8}]`",
                )
                .path("lens"),
        }
        .into());
    }
    let section = faults.take(params.parse::<LensSection>());
    // The lens is read even if another key of this section is faulty, so that all faults are reported together.
    let file = params.get("file").and_then(|node| node.as_str());
    let lens = file.and_then(|file| {
        faults.take(spectra_lens::load(file, resources).map_err(|faults| params.place_at("file", faults)))
    });
    let (Some(section), Some(mut lens)) = (section, lens) else { return Err(faults) };
    if let Some(wanted) = section.focal_length {
        lens = faults.take(at_focal_length(&lens, wanted.mm(), params)).unwrap_or(lens);
    }
    lens = with_build_options(lens, &section, params, resources, &mut faults);
    if let Some(f_number) = section.f_number {
        let stopped = stop_down(lens.clone(), f_number.number());
        lens = faults.take(stopped.map_err(|e| aperture_fault(params, &e))).unwrap_or(lens);
    }
    if let Some(node) = section.aperture {
        lens = faults.take(with_aperture(&lens, &node, resources)).unwrap_or(lens);
    }
    lens = lens.with_cover(cover);
    let wanted = section.focus.as_ref().and_then(|node| faults.take(focus_of(node, lens.reference_nm, None)));
    if let Some(wanted) = &wanted {
        let focused = lens.clone().focused_at(wanted.distance_mm);
        lens = faults.take(focused.map_err(|e| focus_fault(params, &e))).unwrap_or(lens);
    }
    for node in &section.adjust {
        lens = faults.take(adjusted(&lens, node)).unwrap_or(lens);
    }
    let matte_box = section.matte_box.and_then(|node| faults.take(node.parse::<MatteBoxParams>()));
    let matte_box =
        matte_box.map(|p| MatteBox { distance_mm: p.distance.mm(), width_mm: p.width.mm(), height_mm: p.height.mm() });
    faults.into_result(UnfocusedLens { lens, params: params.clone(), focus: section.focus, matte_box })
}

impl UnfocusedLens {
    /// Focuses the lens in the light of the scene. Without light, because another section is faulty, the lens stays as it is.
    pub(crate) fn focused(self, light: Option<&FocusLight>) -> Result<ConfiguredLens, Faults> {
        let Self { mut lens, params, focus: node, matte_box } = self;
        let mut focus = Focus { distance_mm: None, by: FocusBy::File, remark: None };
        let mut warnings = Vec::new();
        if let Some(node) = node {
            let wanted = focus_of(&node, lens.reference_nm, light)?;
            focus = Focus { distance_mm: Some(wanted.distance_mm), by: wanted.by, remark: None };
            match by_rays(&lens, &wanted) {
                _ if light.is_none() => {}
                Ok((found, remark)) => (lens, focus.remark) = (found, remark),
                Err(error @ (FocusError::NoLight { .. } | FocusError::NoTravel { .. })) if wanted.plain => {
                    focus.by = FocusBy::Paraxial;
                    focus.remark =
                        Some(format!("contrast cannot be computed ({error}); `by: paraxial` does not need it"));
                }
                Err(error) => return Err(focus_fault(&params, &error).into()),
            }
            let say = |remark: &String| params.fault("focus", remark);
            warnings.extend(focus.remark.as_ref().map(say));
        }
        if let Some(opening) = matte_box {
            lens = lens.behind_matte_box(&opening);
        }
        Ok(ConfiguredLens { lens: Arc::new(Optics::new(lens)), focus, warnings })
    }
}

/// Focuses the lens by real rays if that is requested. Returns it with a remark, if there is one.
fn by_rays(lens: &Lens, wanted: &FocusRequest) -> Result<(Lens, Option<String>), FocusError> {
    let Some(search) = &wanted.search else { return Ok((lens.clone(), None)) };
    let found = Optics::new(search.focus(lens.clone())?);
    let apart = search.sections_apart_mm(&found)?.map(|mm| {
        format!(
            "lines along x and lines along y come into focus {:.2} mm apart; the mean of their contrasts is highest here; \
             stop down to sharpen both",
            mm.abs()
        )
    });
    Ok((Lens::clone(&found), apart))
}

/// Returns the lens with more apertures at its stop.
fn with_aperture(lens: &Lens, node: &StageNode, resources: &dyn Resources) -> Result<Lens, Faults> {
    // Photographers call the f-number aperture; for optical engineers it is the opening at the stop.
    if let Some(text) = node.node().as_str()
        && let Some(figure) = f_number_in(text)
    {
        let fault = node.fault("`aperture` describes the shape of the stop, such as its blades");
        return Err(fault.hint(format!("did you mean `f-number: f/{figure}`?")).into());
    }
    let apertures = spectra_lens::read_apertures(node, resources)?;
    let mut lens = lens.clone();
    let Some(stop) = lens.elements.iter_mut().find(|e| e.stop) else {
        return Err(node.fault("this lens has no stop").hint("state `aperture` at a surface of its file").into());
    };
    if stop.semi_diameter_mm.is_none() && apertures.iter().any(|a| matches!(a.shape, ApertureShape::Iris(_))) {
        let fault = node.fault("the stop of this lens has no size, so the size of the blades is unknown");
        return Err(fault.hint("add an f-number, such as `f-number: f/4`, beside `aperture`").into());
    }
    stop.apertures.extend(apertures);
    Ok(lens)
}

/// Returns the lens scaled to a focal length, mm.
fn at_focal_length(lens: &Lens, wanted_mm: f64, params: &Params) -> Result<Lens, Fault> {
    let own_mm = lens.first_order(lens.reference_nm).efl_mm.abs();
    // An afocal attachment has no focal length, and neither has a flat window.
    if !(own_mm.is_finite() && own_mm > 0.0 && own_mm < MOST_FOCAL_MM) {
        let fault =
            params.fault("focal-length", format!("{} has no focal length, so it cannot be scaled to one", lens.name));
        return Err(fault.hint("leave `focal-length` out; `spectra lens scale FILE --by 2` scales a file by a factor"));
    }
    let factor = wanted_mm / own_mm;
    let scaled = lens.clone().scaled(factor);
    let mut scaled = scaled.map_err(|error| {
        let fault = params.fault("focal-length", format!("the lens cannot be scaled: {error}"));
        fault.hint(match error {
            ScaleError::Surface(..) => {
                "leave `focal-length` out, or let the plugin implement `scaled` for this surface"
            }
            ScaleError::Drawing(_) => "leave `focal-length` out, or draw the aperture at the final size",
        })
    })?;
    scaled
        .notes
        .push(format!("the lens is scaled from a focal length of {own_mm:.4} mm to {wanted_mm} mm, {factor:.5} times"));
    Ok(scaled)
}

/// Focal length, mm, from which a lens counts as afocal.
const MOST_FOCAL_MM: f64 = 1e7;

/// Returns the lens with its build applied before f-number and focus: reversed, coated, separated, soiled, absorbing.
fn with_build_options(
    mut lens: Lens,
    section: &LensSection,
    params: &Params,
    resources: &dyn Resources,
    faults: &mut Faults,
) -> Lens {
    if section.reverse {
        let reversed = faults.take(lens.reversed().map_err(|e| params.fault("reverse", e.to_string())));
        lens = reversed.unwrap_or(lens);
    }
    let coating = section.coating.as_ref();
    if let Some(coating) = coating.and_then(|node| faults.take(spectra_lens::read_coating(node, resources))) {
        lens = lens.with_coating(coating);
    }
    if let Some(node) = &section.separation
        && let Some(separation) = faults.take(spectra_lens::read_separation(node, resources))
    {
        let (apart, many) = lens.with_separation(&separation);
        lens = apart;
        if many == 0 {
            let fault = params.fault("separation", format!("the lens {} has no cemented glasses", lens.name));
            faults.push(fault.hint("leave `separation` out, or use a lens with cemented glasses"));
        }
    }
    let soils = [section.haze.as_deref(), section.dust.as_deref(), section.scratches.as_deref()];
    for layer in spectra_lens::read_layers(soils, resources, faults) {
        lens = lens.with_layer(&layer);
    }
    lens.absorption = section.absorption.unwrap_or(lens.absorption);
    lens.squeeze = section.squeeze.unwrap_or(lens.squeeze);
    lens
}

/// Returns whether the lens of a section cannot reach the requested f-number.
pub(crate) fn is_too_fast(params: &Params, resources: &dyn Resources) -> bool {
    let Ok(section) = params.parse::<LensSection>() else { return false };
    let file = params.get("file").and_then(|node| node.as_str());
    let Some(lens) = file.and_then(|file| spectra_lens::load(file, resources).ok()) else { return false };
    let lens = with_build_options(lens, &section, params, resources, &mut Faults::new());
    let stopped = section.f_number.map(|f_number| stop_down(lens, f_number.number()));
    matches!(stopped, Some(Err(ApertureError::TooFast { .. })))
}

/// Returns the number in `f/4` or `4`.
fn f_number_in(text: &str) -> Option<f64> {
    match Reading::of(text) {
        Reading::Bare(figure) => Some(figure),
        Reading::Quantity { value, unit } if unit.dimension == Dimension::FNumber => Some(value),
        _ => None,
    }
}

/// Returns advice for a lens whose surfaces state no size: which key to write. For a lens file of another program, the advice
/// names that program's keyword. `section` is the scene's `lens` section.
#[must_use]
pub fn size_hint(section: Option<&Node>) -> &'static str {
    file_of(section).map_or(SIZE_HINT, size_hint_of)
}

/// Returns the advice of [`size_hint`] for the lens file named `file`.
#[must_use]
pub fn size_hint_of(file: &str) -> &'static str {
    Format::of_name(file).map_or(SIZE_HINT, Format::how_to_clip)
}

/// Returns advice for a lens without an aperture stop: which key to write. `file` is the name of the lens file. For a file of
/// another program, the advice names that program's keyword.
#[must_use]
pub fn stop_hint_of(file: &str) -> &'static str {
    Format::of_name(file).map_or(STOP_HINT, Format::how_to_stop)
}

const SIZE_HINT: &str = "state `semi-diameter` in the lens file, at least for the first surface";
const STOP_HINT: &str = "in the lens file, write `stop: true` at a surface, or a line `- {kind: stop, thickness: ...}` where the stop stands";

/// Returns the name of the lens file that a section states.
fn file_of(section: Option<&Node>) -> Option<&str> {
    section.and_then(|node| node.get("file").unwrap_or(node).as_str())
}

/// Returns a fault at `f-number`.
fn aperture_fault(params: &Params, error: &ApertureError) -> Fault {
    let hint = match error {
        ApertureError::TooFast { widest, .. } => {
            format!("write f/{:.2} or slower, or leave `f-number` out for wide open", (widest * 100.0).ceil() / 100.0)
        }
        ApertureError::NoStop => file_of(Some(params.node())).map_or(STOP_HINT, stop_hint_of).to_owned(),
        ApertureError::Unlimited => size_hint(Some(params.node())).to_owned(),
        ApertureError::NoRay(_) | ApertureError::Medium(_) => "leave `f-number` out for wide open".to_owned(),
    };
    params.fault("f-number", error.to_string()).hint(hint)
}

/// Returns a fault at `focus`, or at its `distance`.
fn focus_fault(params: &Params, error: &FocusError) -> Fault {
    let key =
        if params.get("focus").is_some_and(|node| node.get("distance").is_some()) { "focus.distance" } else { "focus" };
    let hint = match error {
        FocusError::TooNear { nearest_mm } => match params.node().at_path(key).map(|node| &node.value) {
            Some(Value::Number(number)) => {
                format!("a number without a unit is in mm: did you mean `{} m`?", number.value)
            }
            _ => format!("write a distance of more than {nearest_mm:.1} mm, or `infinity`"),
        },
        FocusError::BeyondTable { nearest_mm, farthest_mm, .. } => {
            format!(
                "write a distance from {nearest_mm} to {farthest_mm} mm, or extend the focusing table in the lens file"
            )
        }
        _ => "write a different distance, or `infinity`".to_owned(),
    };
    params.fault(key, error.to_string()).hint(hint)
}

fn focus_of(node: &Deferred<FocusForm>, reference_nm: f64, light: Option<&FocusLight>) -> Result<FocusRequest, Faults> {
    // If nothing responds to the source, the reference line is used.
    let seen = light.map_or(&[][..], |light| &light.light);
    let seen = if seen.is_empty() { vec![(reference_nm, 1.0)] } else { seen.to_vec() };
    let default_per_mm = light.map_or(30.0, |light| light.per_mm);
    let p = match node.read()? {
        FocusForm::By(p) => p,
        FocusForm::Distance(distance) => {
            let (object_mm, criterion) = (distance.mm(), Criterion::Contrast { per_mm: default_per_mm });
            let search = light.map(|_| FocusSearch { object_mm, field_rad: 0.0, criterion, light: seen });
            let by = FocusBy::Contrast { per_mm: default_per_mm };
            return Ok(FocusRequest { distance_mm: object_mm, by, search, plain: true });
        }
    };
    let params = Params::section(node.node().clone(), node.path())?;
    let mut faults = Faults::new();
    let by = match p.by {
        By::Contrast => {
            FocusBy::Contrast { per_mm: p.frequency.map_or(default_per_mm, |frequency| frequency.per_mm()) }
        }
        By::Spot | By::Rms => FocusBy::Spot,
        By::Paraxial => FocusBy::Paraxial,
    };
    let criterion = match by {
        FocusBy::Contrast { per_mm } => Some(Criterion::Contrast { per_mm }),
        FocusBy::Spot => Some(Criterion::Rms),
        FocusBy::Paraxial | FocusBy::File => None,
    };
    let by_rays = criterion.is_some();
    let is_contrast = matches!(criterion, Some(Criterion::Contrast { .. }));
    for (key, given, used) in [
        ("field", p.field.is_some(), by_rays),
        ("wavelength", p.wavelength.is_some(), by_rays),
        ("spectrum", p.spectrum.is_some(), by_rays),
        ("frequency", p.frequency.is_some(), is_contrast),
    ] {
        if given && !used && faults.is_empty() {
            let needed = if key == "frequency" { "`by: contrast`" } else { "`by: contrast` or `by: spot`" };
            faults.push(params.fault(key, format!("`{key}` matters only with {needed}")));
        }
    }
    let field_rad = p.field.map_or(0.0, Angle::rad);
    let light = match (p.wavelength, &p.spectrum) {
        (None, None) => seen,
        (Some(wavelength), None) => vec![(wavelength.nm(), 1.0)],
        (None, Some(spectrum)) => {
            spectrum.iter().map(|Weighed(wavelength, weight)| (wavelength.nm(), *weight)).collect()
        }
        (Some(_), Some(_)) => {
            faults.push(params.fault("spectrum", "`wavelength` and `spectrum` exclude each other"));
            Vec::new()
        }
    };
    let object_mm = p.distance.mm();
    let search = criterion.map(|criterion| FocusSearch { object_mm, field_rad, criterion, light });
    faults.into_result(FocusRequest { distance_mm: object_mm, by, search, plain: false })
}

fn adjusted(lens: &Lens, node: &StageNode) -> Result<Lens, Faults> {
    let params = Params::section(node.node().clone(), node.path())?;
    let p: AdjustParams = params.parse()?;
    let by = Misalignment {
        decenter_mm: p.decenter.map(|d| d.map(Length::mm)),
        tilt_rad: p.tilt.map(|t| t.map(Angle::rad)),
        shift_mm: p.shift.map_or(0.0, Length::mm),
    };
    let moved = lens.clone().with_misalignment(&p.group, &by);
    moved.ok_or_else(|| spectra_lens::unknown_group(&params, "group", &p.group, &lens.groups).into())
}
