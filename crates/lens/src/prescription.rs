//! Lens files: reads a prescription in YAML, with the source of its figures.

use crate::prism::{self, PRISM, PrismParams};
use crate::schema::SurfaceOrBreak;
use crate::surface_file::{BREAK, BreakParams, SurfaceKeys, displacement};
use crate::{
    Coating, CoatingForm, DustForm, Element, FocusLaw, FocusTable, Group, GroupTravel, HazeForm, Lens, LensMedium,
    Rims, ScratchesForm, aperture, read_coating, read_layers, read_separation, read_stated_coating, separation,
};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;
use spectra_core::names;
use spectra_core::params::{
    Angle, Deferred, FNumber, Fault, Faults, Length, Node, OrInfinity, Params, Positive, Quantity, Ratio, StageNode,
    Value, Whole, keys_of,
};
use spectra_core::registry::{self, Context};
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::surface::{Action, Kernel, Plane, Surface};
use spectra_glass::file::{self, Figures, StatedLines};
use spectra_glass::{Catalog, GlassFacts, LineTriple, Medium, ModelGlass};
use std::sync::Arc;

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

/// Difference between a stated index and the glass's own above which a warning is given.
const INDEX_TOLERANCE: f64 = 0.002;

/// Shortest radius of a surface, mm; anything shorter is less than a wavelength.
const SHORTEST_RADIUS_MM: f64 = 1e-6;

/// Reads a length in mm; `None` if the node is not a length.
fn length_mm(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Number(number) => Some(number.value),
        Value::String(text) => Length::from_text(text).ok().map(Length::mm),
        _ => None,
    }
}

/// Returns the JSON Schema of a lens file. Its surfaces refer to the definition `surface`, see
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

/// Builds a lens from its parsed file.
///
/// # Errors
/// All faults of the file, with their places.
pub fn parse(params: &Params, resources: &dyn Resources) -> Result<Lens, Faults> {
    let file: LensFile = params.parse()?;
    let mut faults = Faults::new();
    let reference = file.reference_line.and_then(|lines| faults.take(lines.triple(params, "reference-line")));
    let reference = reference.unwrap_or(LineTriple::FDC);
    let reference_nm = reference.mid.wavelength_nm;
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
        reference_nm,
        abbe_lines: reference,
        ..Lens::empty("")
    };
    if file.surfaces.is_empty() {
        let fault = params.fault("surfaces", "a lens has at least one surface");
        faults.push(fault.hint("such as `- {kind: sphere, radius: 50, thickness: 5, glass: SCHOTT/N-BK7}`"));
    }
    let context = Context::new(resources, BAND);
    let place_keys = keys_of::<SurfaceKeys>();
    let mut medium_before = 0;
    let mut along = true;
    let mut breaks = Vec::new();
    let usual = registry::list().into_iter().find(|l| l.stage == "surface" && l.default).map_or("surface", |l| l.name);
    for (at, node) in file.surfaces.iter().enumerate() {
        let Some(params) = faults.take(node.params()) else { continue };
        if params.kind() == Some(BREAK) {
            let own = faults.take(params.parse::<BreakParams>());
            breaks.extend(own.map(|p| p.axis_break()));
            continue;
        }
        let (place, shape) = params.split(&place_keys);
        if params.kind() == Some(PRISM) {
            let stated = faults.take(place.parse::<SurfaceKeys>());
            let own = faults.take(shape.parse::<PrismParams>());
            let (Some(stated), Some(own)) = (stated, own) else { continue };
            faults.extend(prism::misplaced(&place));
            let number = lens.elements.len() + 1;
            let glass = match medium(&stated, &place, number, resources, reference, &mut lens) {
                Ok(Some(glass)) => remember(&mut lens.media, glass),
                Ok(None) => {
                    faults.push(
                        place
                            .fault("glass", "missing key `glass`: a prism is of glass")
                            .hint("add `glass: SCHOTT/N-BK7`"),
                    );
                    continue;
                }
                Err(more) => {
                    faults.extend(more);
                    continue;
                }
            };
            let index = lens.index(glass, reference_nm) / lens.index(medium_before, reference_nm);
            let Some(solid) = faults.take(own.solid(&shape, glass, index)) else { continue };
            let plane = Arc::new(Kernel(Plane::refracting()));
            let mut element = Element::new(PRISM, plane, medium_before, medium_before);
            element.semi_diameter_mm = Some(solid.reach_mm());
            element.solid = Some(Arc::new(solid));
            element.parameters = Some(shape);
            element.breaks = std::mem::take(&mut breaks);
            element.displacement = displacement(stated.decenter, stated.tilt);
            element.thickness_mm = stated.thickness.map_or(0.0, |t| t.mm());
            element.coating = stated.coating.as_ref().and_then(|node| faults.take(read_coating(node, resources)));
            element.reflectance = stated.reflectance.map_or(1.0, Ratio::number);
            lens.elements.push(element);
            continue;
        }
        let surface = registry::build::<dyn Surface>(&shape, &context);
        let surface = faults.take(surface.map_err(|faults| with_keys_of_all(faults, &place_keys)));
        let stated = faults.take(place.parse::<SurfaceKeys>());
        let (Some(surface), Some(stated)) = (surface, stated) else { continue };
        let semi_diameter_mm = stated.semi_diameter.map(|s| s.mm());
        let number = lens.elements.len() + 1;
        let medium_is_stated = stated.glass.is_some() || stated.nd.is_some() || stated.ne.is_some();
        if stated.mirror && medium_is_stated {
            let fault = place.fault("mirror", "there is no glass behind a mirror");
            faults.push(fault.hint("leave the glass out: the medium in front of the mirror continues"));
        }
        let medium_after = if stated.mirror || (surface.is_stop() && !medium_is_stated) {
            medium_before // a stop does not change the medium
        } else {
            match medium(&stated, &place, number, resources, reference, &mut lens) {
                Ok(Some(medium)) => remember(&mut lens.media, medium),
                Ok(None) => 0,
                Err(more) => {
                    faults.extend(more);
                    continue;
                }
            }
        };
        if stated.mirror {
            along = !along;
        }
        // If a bend of the axis follows, it states the distance itself.
        let distance_follows = file.surfaces.get(at + 1).is_none_or(|next| kind_of(next) == Some(BREAK));
        if stated.thickness.is_none() && medium_after != 0 && medium_after != medium_before && !distance_follows {
            let fault = place.fault("thickness", "missing key `thickness`: the glass behind this surface needs one");
            faults.push(fault.hint("add `thickness: ...`, the distance to the next surface; 0 where they touch"));
        }
        let thickness_mm = stated.thickness.map_or(0.0, |t| t.mm());
        let radius_mm = shape.get("radius").and_then(length_mm).map_or(f64::INFINITY, f64::abs);
        if radius_mm > 0.0 && radius_mm < SHORTEST_RADIUS_MM {
            let fault = shape.fault("radius", format!("{radius_mm:e} mm is too small a radius for a lens"));
            faults.push(fault.hint(format!("at least {SHORTEST_RADIUS_MM:e} mm; 0 for a plane")));
        }
        // Behind a mirror light runs the other way; between two planes in air the step may be a formal one.
        if thickness_mm < 0.0 && along && medium_after != medium_before {
            let fault = place.fault("thickness", format!("the thickness is negative: {thickness_mm} mm"));
            faults.push(fault.hint("thicknesses follow the direction of the light: write it without the minus sign"));
        }
        let apertures = stated.aperture.as_ref().map(|node| aperture::read(node, resources));
        let mut element = Element::new(shape.kind().unwrap_or(usual), Arc::from(surface), medium_before, medium_after);
        if stated.mirror && element.stop {
            faults.push(place.fault("mirror", "a stop does not refract light").hint("`kind: plane` with `stop: true`"));
        } else if stated.mirror {
            element.action = Action::Reflect;
        }
        element.parameters = Some(shape);
        element.breaks = std::mem::take(&mut breaks);
        element.displacement = displacement(stated.decenter, stated.tilt);
        element.reversed = stated.reversed;
        element.thickness_mm = thickness_mm;
        element.semi_diameter_mm = semi_diameter_mm;
        element.outer_semi_diameter_mm = stated.outer_semi_diameter.map(|s| s.mm());
        element.chamfer_mm = stated.chamfer.map_or(0.0, Length::mm);
        element.apertures = apertures.and_then(|read| faults.take(read)).unwrap_or_default();
        element.stop |= stated.stop;
        if element.stop
            && let Some(first) = lens.elements.iter().position(|e| e.stop)
        {
            let fault = place.fault_here(format!("a second stop: surface {} is one already", first + 1));
            faults.push(
                fault.hint("a lens has one stop; other surfaces limit the light by `semi-diameter` or `aperture`"),
            );
        }
        // Some tilted surfaces have no point on their axis. A sag that is not a number is an error in the code of the surface.
        if element.surface.sag_mm(0.0, 0.0).is_some_and(|sag| !sag.is_finite()) {
            let fault = place.fault_here("the sag of this surface at its vertex is not a number");
            faults.push(
                fault.hint("check its keys, and the code of its kind: where there is no surface it must return `None`"),
            );
        } else if let Some(semi_diameter_mm) = semi_diameter_mm.filter(|s| *s > 0.0)
            && let Some(reach_mm) = reach_mm(&*element.surface, semi_diameter_mm)
        {
            let text =
                format!("the surface ends {reach_mm} mm from its axis: it has no point at {semi_diameter_mm} mm");
            faults.push(place.fault("semi-diameter", text).hint("a smaller semi-diameter, or a longer radius"));
        }
        element.coating = stated.coating.as_ref().and_then(|node| faults.take(read_coating(node, resources)));
        element.reflectance = stated.reflectance.map_or(1.0, Ratio::number);
        if stated.reflectance.is_some() && !stated.mirror {
            let fault = place.fault("reflectance", "only a mirror has a `reflectance`");
            faults.push(fault.hint("what a lens surface reflects follows from its `coating`"));
        }
        let soil = soils(&stated.haze, &stated.dust, &stated.scratches);
        element.layers = read_layers(soil, resources, &mut faults);
        let is_bent = element.surface.is_directional() || element.surface.draws() || element.surface.is_stop();
        let bends = element.action == Action::Reflect || medium_before != medium_after;
        let rings = stated.onion_rings.as_ref().and_then(|node| faults.take(node.read()));
        element.onion_rings = rings.map(|rings| rings.rings());
        let misplaced = element.layers.first().map(|layer| layer.soil.key());
        let misplaced = misplaced.or(element.onion_rings.map(|_| "onion-rings"));
        if let Some(node) = &stated.separation
            && let Some(separation) = faults.take(read_separation(node, resources))
        {
            if !lens.is_cemented(&element) {
                let fault = place.fault(separation::KEY, "only cement can separate: no two glasses meet here");
                faults.push(fault.hint("state it at a surface between two glasses"));
            } else if separation.depth_mm.is_some() && semi_diameter_mm.is_none() {
                let fault = place.fault(separation::KEY, "`depth` is measured from the edge, but the surface has none");
                faults.push(fault.hint("add `semi-diameter: ...`, or leave `depth` out"));
            }
            element.separation = Some(separation);
        }
        if let Some(key) = misplaced.filter(|_| is_bent || !bends) {
            let fault = place.fault(key, format!("`{key}` belongs where glass meets another medium, or on a mirror"));
            faults.push(fault.hint("state it at a surface of glass"));
        }
        lens.elements.push(element);
        medium_before = medium_after;
    }
    warn_of_constant_indices(&mut lens);
    lens.image_breaks = breaks;
    let coating = file.coating.as_ref().map(|node| faults.take(read_stated_coating(node, resources)));
    (lens.coating, lens.coating_assumed) = match coating {
        None => (Coating::of_year(lens.year), true),
        Some(stated) => stated.map_or((Coating::Bare, false), |stated| (stated.coating, stated.assumed)),
    };
    for layer in read_layers(soils(&file.haze, &file.dust, &file.scratches), resources, &mut faults) {
        lens.add_layer(&layer);
    }
    lens.absorption = file.absorption;
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

/// Corrects the hints for unknown keys of a kind of surface, which knows only its own keys: adds the keys that all surfaces have.
fn with_keys_of_all(mut faults: Faults, of_all: &[String]) -> Faults {
    for fault in &mut faults.0 {
        let key = fault.message.strip_prefix("unknown key `").and_then(|rest| rest.strip_suffix('`'));
        let Some((key, hint)) = key.zip(fault.hint.as_mut()) else { continue };
        if let Some(own) = hint.strip_prefix("known keys: ") {
            *hint = names::nearest(key, of_all.iter().map(String::as_str)).map_or_else(
                || format!("known keys: {own}, {}", of_all.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
        } else if hint == "no keys are allowed here" {
            *hint = names::hint(key, of_all, "");
        }
    }
    faults
}

/// Collects the nodes of haze, dust and scratches in the order that [`read_layers`] expects.
fn soils<'a>(
    haze: &'a Option<Deferred<HazeForm>>,
    dust: &'a Option<Deferred<DustForm>>,
    scratches: &'a Option<Deferred<ScratchesForm>>,
) -> [Option<&'a StageNode>; 3] {
    [haze.as_deref(), dust.as_deref(), scratches.as_deref()]
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

/// Creates a fault at `key` for a group that the lens does not have.
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
        return Err(fault.hint(format!("two numbers from 1 to {surfaces}, the smaller one first")).into());
    }
    Ok(Group {
        name: p.name,
        elements: first - 1..last,
        about: first - 1,
        displacement: displacement(p.decenter, p.tilt),
    })
}

/// Returns the `kind` of an item of `surfaces`.
fn kind_of(node: &StageNode) -> Option<&str> {
    node.node().get("kind").unwrap_or(node.node()).as_str()
}

/// Fraction by which a semi-diameter may exceed the surface. Published tables round the semi-diameter of a hemisphere up (the Minolta
/// fisheye's by 0.7 %).
const BEYOND: f64 = 0.02;

/// Returns where a surface ends, mm from its axis, if that is before `semi_diameter_mm` along both x and y.
fn reach_mm(surface: &dyn Surface, semi_diameter_mm: f64) -> Option<f64> {
    // There is no surface where the sag is not a number, just as for light.
    let reaches = |r: f64| [(r, 0.0), (0.0, r)].iter().any(|(x, y)| surface.sag_mm(*x, *y).is_some_and(f64::is_finite));
    if reaches(semi_diameter_mm * (1.0 - BEYOND)) || !reaches(0.0) {
        return None;
    }
    let (mut inside, mut outside) = (0.0, semi_diameter_mm);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if reaches(middle) { inside = middle } else { outside = middle }
    }
    // Rounded as a person would write it.
    Some((outside * 1e4).round() / 1e4)
}

/// Returns the index that a surface states besides its glass or instead of one, with its Abbe number and the lines of both.
fn stated_figures(
    stated: &SurfaceKeys,
    place: &Params,
    reference: LineTriple,
) -> Result<Option<(f64, Option<f64>, LineTriple)>, Fault> {
    let needs = |v: &str, n: &str| Err(place.fault(v, format!("`{v}` needs `{n}`")).hint(format!("add `{n}: ...`")));
    match (stated.nd, stated.ne) {
        (Some(_), Some(_)) => {
            let fault = place.fault("ne", "the index of this surface is stated at two lines");
            Err(fault.hint("`glass: {nd: ..., ne: ...}` takes all that a patent states"))
        }
        (None, _) if stated.vd.is_some() => needs("vd", "nd"),
        (_, None) if stated.ve.is_some() => needs("ve", "ne"),
        (Some(nd), None) => Ok(Some((nd, stated.vd, reference))),
        (None, Some(ne)) => Ok(Some((ne, stated.ve, LineTriple::F_PRIME_E_C_PRIME))),
        (None, None) => Ok(None),
    }
}

/// Returns the medium that a surface states, or `None` for air. `nd` and `vd` of a surface refer to the reference lines.
fn medium(
    stated: &SurfaceKeys,
    place: &Params,
    number: usize,
    resources: &dyn Resources,
    reference: LineTriple,
    lens: &mut Lens,
) -> Result<Option<LensMedium>, Faults> {
    let figures = stated_figures(stated, place, reference)?;
    let reference_nm = reference.mid.wavelength_nm;
    // The stated index, if it is stated at the reference line.
    let stated_nd = figures.filter(|(_, _, lines)| lines.mid.wavelength_nm == reference_nm).map(|(n, ..)| n);
    let Some(glass) = &stated.glass else {
        let Some((n, v, lines)) = figures else { return Ok(None) };
        let medium = match v {
            None => Medium::Constant(n),
            Some(v) => {
                let (key, n_key) = if stated.ne.is_some() { ("ve", "ne") } else { ("vd", "nd") };
                let fault = || place.fault(key, format!("no glass has {n_key} {n} and {key} {v}"));
                let unusual = LineTriple::of_reference(lines.mid) != Some(lines);
                let model = ModelGlass::new(n, v, lines).filter(|model| !unusual || model.falls()).map(Medium::Model);
                model.ok_or_else(|| fault().hint("an index near 1 has no such dispersion"))?
            }
        };
        let label = match v {
            None => format!("n = {n}"),
            Some(v) => {
                let usual = LineTriple::of_reference(lines.mid) == Some(lines);
                let of_v = if usual { lines.mid.indexed("v") } else { lines.abbe_label() };
                format!("{} = {n}, {of_v} = {v}", lines.mid.indexed("n"))
            }
        };
        let stated_nd = stated_nd.unwrap_or_else(|| medium.index(reference_nm));
        return Ok(Some(LensMedium { medium, stated_nd: Some(stated_nd), label }));
    };
    if let Some(name) = glass.node().as_str() {
        if name == "air" {
            return Ok(None);
        }
        let medium = if file::is_file(name) || name.eq_ignore_ascii_case("vacuum") {
            file::medium(name, place, "glass", resources)?
        } else {
            let beside = GlassFacts { figures, maker: lens.maker.as_deref(), year: lens.year };
            let chosen = Catalog::bundled().choose(name, beside);
            let chosen = chosen.map_err(|e| place.fault("glass", e.message()).hint(e.hint()))?;
            lens.warnings.extend(chosen.note.map(|note| format!("surface {number}: {note}")));
            Medium::from(chosen.glass)
        };
        if let Some((n, _, lines)) = figures {
            let own = medium.index(lines.mid.wavelength_nm);
            if (n - own).abs() > INDEX_TOLERANCE {
                let called = lines.mid.indexed("n");
                let text = format!("surface {number}: {name} has {called} {own:.5}, but the prescription states {n}");
                lens.warnings.push(text);
            }
        }
        let stated_nd = stated_nd.unwrap_or_else(|| medium.index(reference_nm));
        return Ok(Some(LensMedium { medium, stated_nd: Some(stated_nd), label: name.to_owned() }));
    }
    let params = Params::section(glass.node().clone(), glass.path())?;
    // A glass written out in place, with the keys of a glass file. A map of figures alone is a model glass.
    if ["formula", "table", "file", "name"].iter().any(|key| glass.node().get(key).is_some()) {
        let called = format!("surface {number}");
        let medium = Medium::from(file::from_params(&params, &called, resources)?);
        let label = medium.name();
        return Ok(Some(LensMedium {
            stated_nd: Some(stated_nd.unwrap_or_else(|| medium.index(reference_nm))),
            medium,
            label,
        }));
    }
    let figures: Figures = params.parse()?;
    let (medium, label) = figures.medium(&params)?;
    let stated_nd = stated_nd.or(figures.index_at(reference_nm)).unwrap_or_else(|| medium.index(reference_nm));
    Ok(Some(LensMedium { stated_nd: Some(stated_nd), medium, label }))
}

/// Warns where an Abbe number was probably forgotten: at a glass without dispersion in a lens whose other glasses have one.
fn warn_of_constant_indices(lens: &mut Lens) {
    let is_constant = |number: &usize| matches!(lens.media[*number].medium, Medium::Constant(_));
    let disperses = |number: &usize| matches!(lens.media[*number].medium, Medium::Model(_) | Medium::Glass(_));
    let behind = || lens.elements.iter().map(|e| e.medium_after);
    if !behind().any(|number| disperses(&number)) {
        return;
    }
    let text = |(at, number): (usize, usize)| {
        format!(
            "surface {}: its glass ({}) has no dispersion, unlike the other glasses of this lens: add `vd: ...`, or `vd: 0` if \
             there is none",
            at + 1,
            lens.media[number].label
        )
    };
    // Only where light enters the glass, not where a stop or a mirror stands in it.
    let into = lens.elements.iter().enumerate().filter(|(_, e)| e.medium_after != e.medium_before);
    let constant: Vec<String> =
        into.map(|(at, e)| (at, e.medium_after)).filter(|(_, number)| is_constant(number)).map(text).collect();
    lens.warnings.extend(constant);
}

/// Returns the index of a medium in the list, and adds the medium if no equal one is there.
fn remember(media: &mut Vec<LensMedium>, medium: LensMedium) -> usize {
    let same = |m: &LensMedium| m.label == medium.label && m.stated_nd == medium.stated_nd && m.medium == medium.medium;
    media.iter().position(same).unwrap_or_else(|| {
        media.push(medium);
        media.len() - 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::surface::{FromSag, PerRay, SagShape};

    /// A sphere computed with a root. Beyond its radius the sag is `None` if its author was careful, otherwise not a number.
    #[derive(Clone, Debug)]
    struct Root {
        radius_mm: f64,
        is_careful: bool,
    }

    impl SagShape for Root {
        fn sag_mm(&self, x: f64, y: f64) -> Option<f64> {
            let sag = self.radius_mm - (self.radius_mm * self.radius_mm - x * x - y * y).sqrt();
            (sag.is_finite() || !self.is_careful).then_some(sag)
        }
    }

    #[test]
    fn a_sag_that_is_no_number_ends_the_surface() {
        for is_careful in [true, false] {
            let surface = PerRay(FromSag(Root { radius_mm: 5.0, is_careful }));
            assert_eq!(reach_mm(&surface, 6.25), Some(5.0), "{is_careful}");
            assert_eq!(reach_mm(&surface, 4.0), None, "{is_careful}");
        }
    }
}
