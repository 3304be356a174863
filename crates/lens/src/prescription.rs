//! Lens files: a prescription in YAML, and where it comes from.

use crate::{Element, Lens, LensMedium};
use serde::Deserialize;
use spectra_core::params::{Fault, Faults, Length, Params, StageNode};
use spectra_core::registry::{self, Context};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::surface::{Action, Surface};
use spectra_glass::{Catalogue, FindError, Medium, lines};
use std::sync::Arc;

/// A lens file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LensFile {
    /// Name for people.
    name: String,
    /// Year of design.
    year: Option<i32>,
    /// Maker.
    maker: Option<String>,
    /// Patent and example.
    patent: Option<String>,
    /// Line at which indices are stated and focus is meant: d, D or e.
    #[serde(default = "line_d")]
    reference_line: String,
    /// Where the figures come from.
    source: Option<String>,
    /// Doubts, choices of glass.
    remark: Option<String>,
    /// The surfaces, in the order of the light.
    surfaces: Vec<StageNode>,
}

fn line_d() -> String {
    "d".to_owned()
}

/// What every surface may state, whatever its kind; all other keys are the kind's own.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Place {
    /// Distance to the next vertex along the axis (of the last surface, to the image plane), mm if bare.
    #[serde(default)]
    thickness: Option<Length>,
    /// Medium behind the surface: a catalogue name, or its nd and vd. Air if absent.
    glass: Option<StageNode>,
    /// Index at the reference line, as the patent states it.
    nd: Option<f64>,
    /// Abbe number, as the patent states it.
    vd: Option<f64>,
    /// Clear semi-diameter, mm if bare; clips nothing if absent.
    semi_diameter: Option<Length>,
}

const PLACE_KEYS: [&str; 5] = ["thickness", "glass", "nd", "vd", "semi-diameter"];

/// A glass by its figures.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ModelFigures {
    /// Index at the d line.
    nd: f64,
    /// Abbe number; without one the glass has no dispersion.
    vd: Option<f64>,
}

/// Where a stated index and the glass's own differ by more, a person is told.
const INDEX_TOLERANCE: f64 = 0.002;

/// Reads a lens by the path of its file, or by its name among the bundled ones.
///
/// # Errors
/// All that is wrong with the file, with places.
pub fn load(name: &str, resources: &dyn Resources) -> Result<Lens, Faults> {
    parse(&resources.document(name, &["lenses"], &[".yaml"])?, resources)
}

/// Builds a lens from its parsed file.
///
/// # Errors
/// All that is wrong with it, with places.
pub fn parse(params: &Params, resources: &dyn Resources) -> Result<Lens, Faults> {
    let file: LensFile = params.parse()?;
    let mut faults = Faults::new();
    let reference_nm = lines::by_name(&file.reference_line).map_or_else(
        || {
            let fault = params.fault("reference-line", format!("unknown spectral line `{}`", file.reference_line));
            faults.push(fault.hint("d, D and e are usual"));
            lines::D.wavelength_nm
        },
        |line| line.wavelength_nm,
    );
    let mut lens = Lens {
        name: file.name,
        year: file.year,
        patent: file.patent,
        maker: file.maker,
        source: file.source,
        remark: file.remark,
        reference_nm,
        elements: Vec::new(),
        media: vec![LensMedium::air()],
        warnings: Vec::new(),
    };
    if file.surfaces.is_empty() {
        faults.push(params.fault("surfaces", "a lens has at least one surface"));
    }
    let context = Context { resources, grid: BAND, illuminant: None };
    let mut z_mm = 0.0;
    let mut medium_before = 0;
    for node in &file.surfaces {
        let Some(params) = faults.take(node.params()) else { continue };
        let (place, shape) = params.split(&PLACE_KEYS);
        let surface = faults.take(registry::build::<dyn Surface>(&shape, &context));
        let stated = faults.take(place.parse::<Place>());
        let (Some(surface), Some(stated)) = (surface, stated) else { continue };
        let thickness_mm = stated.thickness.map_or(0.0, |t| t.mm());
        if thickness_mm < 0.0 {
            let fault = place.fault("thickness", format!("the thickness is negative: {thickness_mm} mm"));
            faults.push(fault.hint("distances run in the sense of the light: write it without the minus sign"));
        }
        let semi_diameter_mm = stated.semi_diameter.map(|s| s.mm());
        if semi_diameter_mm.is_some_and(|s| s <= 0.0) {
            let fault = place.fault("semi-diameter", "the semi-diameter must be greater than 0");
            faults.push(fault.hint("leave it out where it is not known"));
        }
        let number = lens.elements.len() + 1;
        let medium_after = if surface.is_stop() && stated.glass.is_none() && stated.nd.is_none() {
            medium_before // a stop stands in the medium that is there
        } else {
            match medium(&stated, &place, number, &mut lens.warnings) {
                Ok(Some(medium)) => remember(&mut lens.media, medium),
                Ok(None) => 0,
                Err(more) => {
                    faults.extend(more);
                    continue;
                }
            }
        };
        let action = if surface.is_stop() { Action::Pass } else { Action::Refract };
        lens.elements.push(Element {
            kind: shape.kind().unwrap_or("surface").to_owned(),
            surface: Arc::from(surface),
            vertex_z_mm: z_mm,
            thickness_mm,
            semi_diameter_mm,
            action,
            medium_before,
            medium_after,
        });
        z_mm += thickness_mm;
        medium_before = medium_after;
    }
    let stops = lens.elements.iter().filter(|e| e.surface.is_stop()).count();
    if stops > 1 {
        faults.push(params.fault("surfaces", format!("{stops} surfaces are stops; a lens has one")));
    }
    faults.into_result(lens)
}

/// The medium that a surface states, or `None` for air.
fn medium(
    stated: &Place,
    place: &Params,
    number: usize,
    warnings: &mut Vec<String>,
) -> Result<Option<LensMedium>, Faults> {
    let by_figures = |nd: f64, vd: Option<f64>, key: &str| -> Result<Medium, Fault> {
        let refuse = |what: String| Err(place.fault(key, what).hint("nd lies between 1 and 4, vd between 5 and 200"));
        if !(1.0..=4.0).contains(&nd) {
            return refuse(format!("an index of {nd}"));
        }
        match vd {
            None => Ok(Medium::Constant(nd)),
            Some(vd) if (5.0..=200.0).contains(&vd) => {
                Medium::from_nd_vd(nd, vd).ok_or_else(|| place.fault(key, format!("no glass has nd {nd} and vd {vd}")))
            }
            Some(vd) => refuse(format!("an Abbe number of {vd}")),
        }
    };
    let Some(glass) = &stated.glass else {
        let Some(nd) = stated.nd else {
            if stated.vd.is_some() {
                return Err(place.fault("vd", "`vd` without `nd` says nothing").into());
            }
            return Ok(None);
        };
        let label = stated.vd.map_or(format!("n = {nd}"), |vd| format!("nd = {nd}, vd = {vd}"));
        return Ok(Some(LensMedium { medium: by_figures(nd, stated.vd, "nd")?, stated_nd: Some(nd), label }));
    };
    if let Some(name) = glass.node().as_str() {
        if name == "air" {
            return Ok(None);
        }
        let found = match stated.nd {
            Some(nd) => Catalogue::bundled().find_with(name, nd, stated.vd).map(Medium::from),
            None => Catalogue::bundled().medium(name),
        };
        let medium = found.map_err(|e| {
            let hint = match &e {
                FindError::Unknown { nearest, .. } => {
                    nearest.first().map(|c| format!("did you mean `{}`?", c.full_name))
                }
                FindError::Ambiguous { candidates, .. } => {
                    candidates.first().map(|c| format!("for example `{}`", c.full_name))
                }
            };
            place
                .fault("glass", e.to_string())
                .hint(hint.unwrap_or_else(|| "or state `glass: {nd: ..., vd: ...}`".to_owned()))
        })?;
        let own = medium.index(lines::D.wavelength_nm);
        if let Some(nd) = stated.nd.filter(|nd| (nd - own).abs() > INDEX_TOLERANCE) {
            warnings.push(format!("surface {number}: {name} has nd {own:.5}, the prescription states {nd}"));
        }
        return Ok(Some(LensMedium { medium, stated_nd: stated.nd.or(Some(own)), label: name.to_owned() }));
    }
    let figures: ModelFigures = glass.parse()?;
    let medium = by_figures(figures.nd, figures.vd, "glass")?;
    let label = figures.vd.map_or(format!("n = {}", figures.nd), |vd| format!("nd = {}, vd = {vd}", figures.nd));
    Ok(Some(LensMedium { medium, stated_nd: stated.nd.or(Some(figures.nd)), label }))
}

/// Number of a medium: that of an equal one, or a new one.
fn remember(media: &mut Vec<LensMedium>, medium: LensMedium) -> usize {
    let same = |m: &LensMedium| m.label == medium.label && m.stated_nd == medium.stated_nd;
    media.iter().position(same).unwrap_or_else(|| {
        media.push(medium);
        media.len() - 1
    })
}
