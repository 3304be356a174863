//! The `lens` section of a scene: which lens, and how it is set.
//!
//! In this order: the lens is turned round, coated, stopped and focused as its maker meant it; then groups go out of place;
//! a focus by real rays, as a camera finds it, sees them so; a matte box comes last.

use crate::filters::FilterForm;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{
    Angle, Dimension, FNumber, Fault, Faults, Length, OrInfinity, Params, Positive, Reading, SpatialFrequency,
    StageNode, Value, Wavelength,
};
use spectra_core::resources::Resources;
use spectra_lens::{
    ApertureError, ApertureForm, CoatingForm, Criterion, FocusError, FocusSearch, Lens, MatteBox, Misalignment, Shape,
};

/// The `lens` section.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct LensSection {
    /// A lens file beside the scene, or the name of a bundled lens.
    #[expect(dead_code, reason = "states the key; the lens is read even where another key is faulty")]
    file: String,
    /// Whether it is mounted the other way round.
    #[serde(default)]
    reverse: bool,
    /// Coating of all surfaces, in place of what the lens file states: `ideal`, `bare`, or a layer.
    #[schemars(with = "Option<CoatingForm>")]
    coating: Option<StageNode>,
    /// Whether glass absorbs; as the lens file says if absent.
    absorption: Option<bool>,
    /// Aperture, set by the real marginal ray; as the lens file says if absent.
    f_number: Option<FNumber>,
    /// What limits the light at the stop beside its round opening: blades, a mask; one or a list, as in a lens file.
    #[schemars(with = "Option<ApertureForm>")]
    aperture: Option<StageNode>,
    /// Distance that is in focus, from the first vertex, mm if bare, or `infinity`; the lens file's focus if absent. Or
    /// a map with what to focus by.
    #[schemars(with = "Option<FocusForm>")]
    focus: Option<StageNode>,
    /// Groups out of place: misalignment. None if absent.
    #[serde(default)]
    #[schemars(with = "Vec<AdjustParams>")]
    adjust: Vec<StageNode>,
    /// Filters in front of it, at most 16, each a name of a transmittance or a map; none if absent.
    #[expect(dead_code, reason = "states the key; filters are read by themselves")]
    #[schemars(with = "Option<Vec<FilterForm>>")]
    filters: Option<StageNode>,
    /// A rectangular opening in front of it; none if absent.
    #[schemars(with = "Option<MatteBoxParams>")]
    matte_box: Option<StageNode>,
}

/// A matte box.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MatteBoxParams {
    /// Distance of the opening in front of the first vertex, mm if bare.
    distance: Positive<Length>,
    /// Width of the opening, mm if bare.
    width: Positive<Length>,
    /// Its height, mm if bare.
    height: Positive<Length>,
}

/// `focus` as a map.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct FocusParams {
    /// Distance that is in focus, from the first vertex, mm if bare, or `infinity`.
    distance: OrInfinity<Positive<Length>>,
    /// What is sharpest: `paraxial` (by first order; the default), `rms` (the smallest spot) or `contrast` (at a
    /// spatial frequency).
    #[schemars(extend("enum" = ["paraxial", "rms", "contrast"]))]
    by: Option<String>,
    /// Field angle that is in focus, degrees if bare, within 89; on the axis if absent.
    #[schemars(extend("minimum" = -89, "maximum" = 89))]
    field: Option<Angle>,
    /// Wavelength that is in focus, 200 to 2500 nm, nm if bare; the reference line of the lens if absent. Or else
    /// `spectrum`.
    wavelength: Option<Wavelength>,
    /// In place of `wavelength`, 1 to 64 of them, nm if bare, each with its weight, more than 0.
    #[schemars(length(min = 1, max = 64))]
    spectrum: Option<Vec<(Wavelength, f64)>>,
    /// With `by: contrast`: the spatial frequency whose contrast counts, line pairs a mm if bare; 30 if absent.
    frequency: Option<Positive<SpatialFrequency>>,
}

/// What a focus is written as.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "states what is allowed; `focus_of` reads it")]
enum FocusForm {
    /// The distance alone.
    Distance(OrInfinity<Positive<Length>>),
    /// What to focus by.
    By(FocusParams),
}

/// A group out of place.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct AdjustParams {
    /// Name of the group, one of the lens file.
    group: String,
    /// Shift along x and y, mm if bare; as the lens file has it if absent.
    decenter: Option<[Length; 2]>,
    /// Tilts about x, y and z, degrees if bare, about the vertex of its first surface; as the lens file has them if
    /// absent.
    tilt: Option<[Angle; 3]>,
    /// Shift along the axis toward the image, mm if bare; none if absent.
    shift: Option<Length>,
}

/// Spatial frequency that counts where none is said, line pairs a mm: that of a sharp 35 mm negative.
const DEFAULT_FREQUENCY: f64 = 30.0;
/// Field angles of a plane, degrees.
const MAX_FIELD_DEG: f64 = 89.0;

/// What is in focus, and by what.
struct Focus {
    distance_mm: f64,
    search: Option<FocusSearch>,
}

/// The lens of a scene, set.
pub(crate) fn lens_of(params: &Params, resources: &dyn Resources) -> Result<Lens, Faults> {
    let mut faults = Faults::new();
    if let Some(kind) = params.kind() {
        let fault = params.fault("kind", "a lens has no kinds: its file is named by `file`");
        return Err(match params.get("file") {
            Some(_) => fault.hint("leave `kind` out"),
            None => fault.hint(format!("write `lens: {{file: {kind}}}`")).path("lens"),
        }
        .into());
    }
    let section = faults.take(params.parse::<LensSection>());
    // The lens is read even where another key of this section is faulty: all faults in one go.
    let file = params.get("file").and_then(|node| node.as_str());
    let lens = file.and_then(|file| {
        faults.take(spectra_lens::load(file, resources).map_err(|faults| params.place_at("file", faults)))
    });
    let (Some(section), Some(mut lens)) = (section, lens) else { return Err(faults) };
    if section.reverse {
        let reversed = faults.take(lens.reversed().map_err(|e| params.fault("reverse", e.to_string())));
        lens = reversed.unwrap_or(lens);
    }
    if let Some(coating) = section.coating.and_then(|node| faults.take(spectra_lens::read_coating(&node, resources))) {
        lens = lens.with_coating(coating);
    }
    lens.absorption = section.absorption.unwrap_or(lens.absorption);
    if let Some(f_number) = section.f_number {
        let stopped = lens.clone().at_f_number(f_number.number());
        lens = faults.take(stopped.map_err(|e| aperture_fault(params, &e))).unwrap_or(lens);
    }
    if let Some(node) = section.aperture {
        lens = faults.take(with_aperture(&lens, &node, resources)).unwrap_or(lens);
    }
    let focus = section.focus.and_then(|node| faults.take(focus_of(&node, lens.reference_nm)));
    if let Some(focus) = &focus {
        let focused = lens.clone().focused_at(focus.distance_mm);
        lens = faults.take(focused.map_err(|e| focus_fault(params, &e))).unwrap_or(lens);
    }
    for node in &section.adjust {
        lens = faults.take(adjusted(&lens, node)).unwrap_or(lens);
    }
    if let (Some(search), true) = (focus.and_then(|f| f.search), faults.is_empty()) {
        let found = lens.clone().focused_by(&search);
        lens = faults.take(found.map_err(|e| focus_fault(params, &e))).unwrap_or(lens);
    }
    if let Some(node) = section.matte_box
        && let Some(p) = faults.take(node.parse::<MatteBoxParams>())
    {
        let opening = MatteBox { distance_mm: p.distance.mm(), width_mm: p.width.mm(), height_mm: p.height.mm() };
        lens = lens.behind_matte_box(&opening);
    }
    faults.into_result(lens)
}

/// The lens with more at its stop.
fn with_aperture(lens: &Lens, node: &StageNode, resources: &dyn Resources) -> Result<Lens, Faults> {
    // A photographer's aperture is the f-number; the optical engineer's is what stands at the stop.
    if let Some(text) = node.node().as_str()
        && let Some(figure) = f_number_in(text)
    {
        let fault = node.fault("an aperture is what limits the light beside the stop's round opening, such as blades");
        return Err(fault.hint(format!("did you mean `f-number: f/{figure}`?")).into());
    }
    let apertures = spectra_lens::read_apertures(node, resources)?;
    let mut lens = lens.clone();
    let Some(stop) = lens.elements.iter_mut().find(|e| e.stop) else {
        return Err(node.fault("this lens has no stop").hint("state `aperture` at a surface of its file").into());
    };
    if stop.semi_diameter_mm.is_none() && apertures.iter().any(|a| matches!(a.shape, Shape::Iris(_))) {
        let fault = node.fault("how far are the blades closed? The stop of this lens has no size");
        return Err(fault.hint("`f-number: f/4` beside `aperture`").into());
    }
    stop.apertures.extend(apertures);
    Ok(lens)
}

/// A fault at `f-number`.
/// The figure of `f/4` or `4`.
fn f_number_in(text: &str) -> Option<f64> {
    match Reading::of(text) {
        Reading::Bare(figure) => Some(figure),
        Reading::Quantity { value, unit } if unit.dimension == Dimension::FNumber => Some(value),
        _ => None,
    }
}

fn aperture_fault(params: &Params, error: &ApertureError) -> Fault {
    let hint = match error {
        ApertureError::TooFast { widest, .. } => {
            format!("f/{:.2} or slower; leave `f-number` out for wide open", (widest * 100.0).ceil() / 100.0)
        }
        ApertureError::NoStop => "mark one in the lens file: `- {kind: stop, thickness: ...}`".to_owned(),
        ApertureError::Unlimited => "state `semi-diameter` in the lens file".to_owned(),
        ApertureError::NoRay(_) | ApertureError::Medium(_) => "leave `f-number` out for wide open".to_owned(),
    };
    params.fault("f-number", error.to_string()).hint(hint)
}

/// A fault at `focus`, or at its `distance`.
fn focus_fault(params: &Params, error: &FocusError) -> Fault {
    let key =
        if params.get("focus").is_some_and(|node| node.get("distance").is_some()) { "focus.distance" } else { "focus" };
    let hint = match error {
        FocusError::TooNear { nearest_mm } => format!("farther than {nearest_mm:.1} mm, or `infinity`"),
        FocusError::BeyondTable { nearest_mm, farthest_mm, .. } => {
            format!("from {nearest_mm} to {farthest_mm} mm; or extend the table in the lens file")
        }
        _ => "another distance, or `infinity`".to_owned(),
    };
    params.fault(key, error.to_string()).hint(hint)
}

fn focus_of(node: &StageNode, reference_nm: f64) -> Result<Focus, Faults> {
    if !matches!(node.node().value, Value::Map(_)) {
        let distance: OrInfinity<Positive<Length>> = node.parse()?;
        return Ok(Focus { distance_mm: distance.mm(), search: None });
    }
    let params = Params::section(node.node().clone(), node.path())?;
    let p: FocusParams = params.parse()?;
    let mut faults = Faults::new();
    let criterion = match p.by.as_deref() {
        None | Some("paraxial") => None,
        Some("rms") => Some(Criterion::Rms),
        Some("contrast") => Some(Criterion::Contrast { per_mm: p.frequency.map_or(DEFAULT_FREQUENCY, |f| f.per_mm()) }),
        Some(other) => {
            let fault = params.fault("by", format!("no way to focus by `{other}`"));
            faults.push(fault.hint("paraxial, rms or contrast"));
            None
        }
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
            let needed = if key == "frequency" { "`by: contrast`" } else { "`by: rms` or `by: contrast`" };
            faults.push(params.fault(key, format!("`{key}` matters only with {needed}")));
        }
    }
    let field_rad = p.field.map_or(0.0, Angle::rad);
    if field_rad.abs() > MAX_FIELD_DEG.to_radians() {
        let fault = params.fault("field", "no plane is seen at this angle");
        faults.push(fault.hint(format!("between {} and {MAX_FIELD_DEG} degrees", -MAX_FIELD_DEG)));
    }
    let light = match (p.wavelength, p.spectrum) {
        (None, None) => vec![(reference_nm, 1.0)],
        (Some(wavelength), None) => vec![(wavelength.nm(), 1.0)],
        (None, Some(spectrum)) => {
            let light: Vec<(f64, f64)> = spectrum.iter().map(|(w, weight)| (w.nm(), *weight)).collect();
            let good = (1..=64).contains(&light.len()) && light.iter().all(|(_, w)| *w > 0.0 && w.is_finite());
            if !good {
                let fault = params.fault("spectrum", "1 to 64 wavelengths, each with a positive weight");
                faults.push(fault.hint("such as [[486, 1], [546, 2], [656, 1]]"));
            }
            light
        }
        (Some(_), Some(_)) => {
            faults.push(params.fault("spectrum", "either `wavelength` or `spectrum`"));
            Vec::new()
        }
    };
    if light.iter().any(|(nm, _)| !(200.0..=2500.0).contains(nm)) {
        let key = if p.wavelength.is_some() { "wavelength" } else { "spectrum" };
        faults.push(params.fault(key, "this is no light").hint("from 200 to 2500 nm"));
    }
    let object_mm = p.distance.mm();
    let search = criterion.map(|criterion| FocusSearch { object_mm, field_rad, criterion, light });
    faults.into_result(Focus { distance_mm: object_mm, search })
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
