//! Lens files: reads a prescription in YAML, with the source of its figures.

use crate::element_reader::ElementReader;
use crate::schema::SurfaceOrBreak;
use crate::surface_file::displacement;
use crate::{
    Coating, CoatingForm, DustForm, FocusLaw, FocusTable, Group, GroupTravel, HazeForm, Lens, Rims, ScratchesForm,
    read_layers, read_stated_coating,
};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use spectra_core::names;
use spectra_core::params::{
    Angle, Deferred, FNumber, Fault, Faults, Length, OrInfinity, Params, Positive, StageNode, Whole,
};
use spectra_core::resources::Resources;
use spectra_glass::LineTriple;
use spectra_glass::file::StatedLines;

/// A lens: its prescription, surface by surface, and the source of its figures.
///
/// Surfaces are listed in the order in which light meets them. Each has its shape (`kind` and the keys of that kind), the medium behind
/// it and the thickness to the next vertex; the last thickness leads to the image plane. Lengths are in millimeters unless
/// they have another unit. The origin is the vertex of the first surface, +z runs toward the image, +y is up. A radius is
/// positive if its center lies at larger z. Behind a mirror light runs the other way, and thicknesses are negative
/// there.
///
/// A `coordinate-break` among the surfaces bends the axis for everything that follows. `spectra doc surface` lists the kinds
/// and the keys that every surface has; `spectra lens info FILE` shows what the lens does.
///
/// # Example
/// ```yaml
/// # A cemented doublet
/// name: Doublet 100 mm f/5
/// source: textbook
/// surfaces:
///   - {kind: sphere, radius: 61.5, thickness: 6, glass: SCHOTT/N-BK7, semi-diameter: 10, stop: true}
///   - {kind: sphere, radius: -44.6, thickness: 2.5, glass: SCHOTT/N-SF5, semi-diameter: 10}
///   - {kind: sphere, radius: -129.9, thickness: 95.9, semi-diameter: 10}
/// groups:
///   - {name: doublet, surfaces: [1, 3]}
/// focus:
///   - {group: doublet, factor: 1}
/// coating: {layer: 1.38, quarter-wave-at: 550 nm}
/// ```
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct LensFile {
    /// Name of the lens, for people.
    name: String,
    /// Year of design; not known if absent.
    year: Option<i32>,
    /// F-number in the name of the lens, as makers round it. `f-number: f/1.4` in a scene then means full aperture, even if that is
    /// f/1.44. None if absent.
    f_number: Option<FNumber>,
    /// Factor by which an anamorphic lens squeezes the picture horizontally, 0.1 to 10, as makers round it. Pixels of its
    /// pictures are shown that many times as wide. 1 if absent.
    #[schemars(range(min = 0.1, max = 10))]
    squeeze: Option<f64>,
    /// Maker; not known if absent.
    maker: Option<String>,
    /// Patent and example; none if absent.
    patent: Option<String>,
    /// Reference line, at which indices are stated and the focus is defined: its short name (usually d, D or e), which implies the usual
    /// lines of Abbe numbers. Or three lines from blue to red, by name or wavelength, `[F', e, C']` or `[450 nm, 580 nm, 680 nm]`: the
    /// index is stated at the middle one, the Abbe number by all three. d if absent.
    reference_line: Option<StatedLines>,
    /// Source of the figures.
    source: Option<String>,
    /// Doubts about the figures and choices made, for people.
    remark: Option<String>,
    /// Origin of the semi-diameters: `stated` by the source, `computed` from rays that were meant to pass, `guessed`, or
    /// `{fitted: ...}` to measured light, with a note on what was measured. Not known if absent.
    rims: Option<Rims>,
    /// Surfaces of the lens, one or more, in the order in which light meets them.
    surfaces: Vec<Deferred<SurfaceOrBreak>>,
    /// Groups of surfaces that move together, in focusing or by misalignment; none if absent.
    #[serde(default)]
    groups: Vec<Deferred<GroupParams>>,
    /// Focusing laws: how groups move in focusing. The whole lens moves if absent.
    #[serde(default)]
    focus: Vec<Deferred<FocusParams>>,
    /// Coating of all surfaces that state none: `ideal`, `bare`, `single-layer`, `three-layer`, a layer or a stack; with
    /// `assumed: true` if it is not known. If absent, the usual coating of lenses of the `year`: `bare` before 1940 or without a year,
    /// `single-layer` before 1970, then `three-layer`.
    coating: Option<Deferred<CoatingForm>>,
    /// Haze on all surfaces where glass meets air, except those that state their own: the fraction of the light that each scatters, and how
    /// wide. None if absent.
    haze: Option<Deferred<HazeForm>>,
    /// Dust on the same surfaces: the fraction that it covers, and the size of its grains. None if absent.
    dust: Option<Deferred<DustForm>>,
    /// Scratches on the same surfaces: the fraction that they cover or a drawing of them, and their width. None if absent.
    scratches: Option<Deferred<ScratchesForm>>,
    /// Whether glass absorbs light, as its catalogue says.
    #[serde(default = "yes")]
    absorption: bool,
}

fn yes() -> bool {
    true
}

/// Returns the JSON Schema of a lens file. Its surfaces refer to the definition `surface`; see
/// [`spectra_core::registry::definitions`].
#[must_use]
pub fn lens_schema(generator: &mut SchemaGenerator) -> Schema {
    LensFile::json_schema(generator)
}

/// Reads a lens from a file, given by its path or by the name of a bundled lens.
///
/// # Errors
/// All faults of the file, with their places.
pub fn load(name: &str, resources: &dyn Resources) -> Result<Lens, Faults> {
    parse(&resources.document(name, &["lenses"], &[".yaml"])?, resources)
}

/// Builds a lens from the parsed content of its file.
///
/// # Errors
/// All faults of the file, with their places.
pub fn parse(params: &Params, resources: &dyn Resources) -> Result<Lens, Faults> {
    let file: LensFile = params.parse()?;
    let mut faults = Faults::new();
    let reference = file.reference_line.and_then(|lines| faults.take(lines.triple(params, "reference-line")));
    let reference = reference.unwrap_or(LineTriple::FDC);
    let mut lens = Lens {
        name: file.name,
        year: file.year,
        nominal_f_number: file.f_number.map(FNumber::number),
        squeeze: file.squeeze.unwrap_or(1.0),
        patent: file.patent,
        maker: file.maker,
        source: file.source,
        remark: file.remark,
        rims: file.rims,
        reference_nm: reference.mid.wavelength_nm,
        abbe_lines: reference,
        absorption: file.absorption,
        ..Lens::empty("")
    };
    if file.surfaces.is_empty() {
        let fault = params.fault("surfaces", "a lens has at least one surface");
        faults.push(fault.hint("such as `- {kind: sphere, radius: 50, thickness: 5, glass: SCHOTT/N-BK7}`"));
    }
    ElementReader::new(&mut lens, &mut faults, resources).read(&file.surfaces);
    let coating = file.coating.as_ref().map(|node| faults.take(read_stated_coating(node, resources)));
    (lens.coating, lens.coating_assumed) = match coating {
        None => (Coating::of_year(lens.year), true),
        Some(stated) => stated.map_or((Coating::Bare, false), |stated| (stated.coating, stated.assumed)),
    };
    let soils = [file.haze.as_deref(), file.dust.as_deref(), file.scratches.as_deref()];
    for layer in read_layers(soils, resources, &mut faults) {
        lens.add_layer(&layer);
    }
    for node in &file.groups {
        lens.groups.extend(faults.take(group(node, lens.elements.len())));
    }
    for node in &file.focus {
        let law = faults.take(focus_law(node, &lens.groups));
        if let Some(again) = law.as_ref().filter(|law| lens.focus_laws.iter().any(|l| l.group == law.group)) {
            let name = &lens.groups[again.group].name;
            faults.push(node.fault(format!("group `{name}` has two focusing laws")).hint("write one law per group"));
        }
        lens.focus_laws.extend(law);
    }
    lens.arrange();
    if faults.is_empty() {
        let doubts = lens.prescription_warnings();
        lens.warnings.extend(doubts);
    }
    faults.into_result(lens)
}

/// The motion of a group in focusing.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct FocusParams {
    /// Name of the group, one of `groups`.
    group: String,
    /// Travel of the group relative to the others', toward the object if positive, not 0. Or give `table`.
    factor: Option<f64>,
    /// Object distances (mm if bare, or inf), descending, two or more, each with the shift toward the object (mm if
    /// bare). Or give `factor`.
    table: Option<Vec<(OrInfinity<Positive<Length>>, Length)>>,
    /// `x`, for a lens with cylinders: the group moves until the x-z section is in focus, too, while the other groups, or the whole
    /// lens, focus the y-z section. Instead of `factor` and `table`.
    section: Option<Across>,
}

/// The section that a group keeps in focus.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum Across {
    X,
}

fn focus_law(node: &StageNode, groups: &[Group]) -> Result<FocusLaw, Faults> {
    let params = Params::section(node.node().clone(), node.path())?;
    let p: FocusParams = params.parse()?;
    let Some(group) = groups.iter().position(|g| g.name == p.group) else {
        return Err(unknown_group(&params, "group", &p.group, groups).into());
    };
    let travel = match (p.factor, p.table) {
        (None, None) if p.section.is_some() => GroupTravel::SectionX,
        (Some(_), _) | (_, Some(_)) if p.section.is_some() => {
            let fault = params.fault("section", "a group that follows a section has no travel of its own");
            return Err(fault.hint("leave out `factor` and `table`").into());
        }
        (Some(factor), None) if factor.is_finite() && factor != 0.0 => GroupTravel::Factor(factor),
        (Some(_), None) => {
            let fault = params.fault("factor", "a group of factor 0 does not move");
            return Err(fault.hint("leave out its law").into());
        }
        (None, Some(points)) => {
            let points: Vec<_> = points.iter().map(|(distance, shift)| (distance.mm(), shift.mm())).collect();
            let fault = || params.fault("table", "list two or more distances, the farthest first, each with its shift");
            GroupTravel::Table(FocusTable::new(&points).ok_or_else(|| fault().hint("such as [[inf, 0], [2000, 0.4]]"))?)
        }
        (None, None) | (Some(_), Some(_)) => {
            let fault = params.fault_here("a group moves either by a `factor` or by a `table`, or follows a `section`");
            return Err(fault
                .hint("{group: rear, factor: 0.6}, or {group: rear, table: [[inf, 0], [500, 1.9]]}")
                .into());
        }
    };
    Ok(FocusLaw { group, travel })
}

/// Creates a fault at `key` for a group `name` that the lens does not have. `groups` are the groups that it has, for the hint.
pub fn unknown_group(params: &Params, key: &str, name: &str, groups: &[Group]) -> Fault {
    let fault = params.fault(key, format!("the lens has no group `{name}`"));
    let known: Vec<&str> = groups.iter().map(|g| g.name.as_str()).collect();
    fault.hint(if known.is_empty() {
        "its file defines none: `groups` is missing there".to_owned()
    } else {
        names::hint(name, &known, "")
    })
}

/// A group of surfaces that move together.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct GroupParams {
    /// Name of the group.
    name: String,
    /// First and last surface, by number from 1 (bends of the axis do not count).
    surfaces: [Whole<1, { u32::MAX as u64 }>; 2],
    /// Shift of the group along x and y, mm if bare; none if absent.
    decenter: Option<[Length; 2]>,
    /// Tilt of the group about the vertex of its first surface, about x, y and z, degrees if bare; none if absent.
    tilt: Option<[Angle; 3]>,
}

fn group(node: &StageNode, surfaces: usize) -> Result<Group, Faults> {
    let params = Params::section(node.node().clone(), node.path())?;
    let p: GroupParams = params.parse()?;
    let [first, last] = p.surfaces.map(Whole::size);
    if last < first || last > surfaces {
        let fault = params.fault("surfaces", format!("no surfaces {first} to {last} in this lens"));
        return Err(fault.hint(format!("write two numbers from 1 to {surfaces}, the smaller one first")).into());
    }
    Ok(Group {
        name: p.name,
        elements: first - 1..last,
        about: first - 1,
        displacement: displacement(p.decenter, p.tilt),
    })
}
