//! Reads a lens file as a prescription, to write it in another format.

use crate::prescription::{
    Aperture, ApertureShape, AxisItem, CoordinateBreak, Displacement, Medium, Prescription, Surface, SurfaceShape,
    ZernikeOrdering,
};
use spectra_core::params::{
    Angle, Fault, Faults, Length, LengthOrInfinity, Node, Params, Readable, SpatialFrequency, StageNode, Value,
};
use spectra_core::resources::{Resource, ResourceError, Resources};
use spectra_glass::file::{self, Figures, StatedLines};
use spectra_glass::{LineTriple, ModelGlass, lines};

/// Reads a lens file of this program as a prescription. Data that other programs do not have are listed in
/// [`Prescription::left_out`]. The file must be valid, which loading the lens checks.
///
/// # Errors
/// A value that is needed is not valid.
pub fn read(params: &Params) -> Result<Prescription, Faults> {
    let lines = match value::<StatedLines>(params, "reference-line")? {
        Some(lines) => lines.triple(params, "reference-line")?,
        None => LineTriple::FDC,
    };
    let mut lens = Prescription {
        name: value::<String>(params, "name")?.unwrap_or_default(),
        maker: value(params, "maker")?,
        patent: value(params, "patent")?,
        year: value(params, "year")?,
        reference_line: Some(lines.mid.label()).filter(|_| params.get("reference-line").is_some()),
        ..Prescription::default()
    };
    for key in ["source", "remark"] {
        lens.remarks.extend(value::<String>(params, key)?);
    }
    if let Some(rims) = params.get("rims") {
        let fitted = rims.get("fitted").and_then(Node::as_str);
        let words = fitted.map(|to| format!("fitted to {to}")).or(rims.as_str().map(str::to_owned));
        lens.remarks.extend(words.as_ref().map(|words| format!("Rims {words}.")));
        lens.rims = words;
    }
    let known = [
        "name",
        "maker",
        "patent",
        "year",
        "f-number",
        "reference-line",
        "source",
        "remark",
        "rims",
        "surfaces",
        "coating",
        "absorption",
        "squeeze",
        "groups",
        "focus",
    ];
    note_others(params, &known, "", &mut lens);
    // An assumed coating is not reported as lost. A stated one is, as not altering: it dims the light but bends no ray.
    if let Some(coating) = params.get("coating").filter(|node| node.get("assumed").is_none()) {
        lens.leave_out(coating.span.line, false, "the coating");
    }
    for (key, what) in [
        ("squeeze", "other programs do not widen the picture"),
        ("groups", "the lens is written as focused at infinity"),
        ("focus", "the lens is written as focused at infinity"),
    ] {
        if let Some(node) = params.get(key) {
            lens.leave_out(node.span.line, false, format!("the key `{key}`: {what}"));
        }
    }
    let mut faults = Faults::new();
    let nodes: Vec<StageNode> = value(params, "surfaces")?.unwrap_or_default();
    for (at, node) in nodes.iter().enumerate() {
        faults.take(node.params().and_then(|params| item(&params, at + 1, lines, &mut lens)));
    }
    faults.into_result(lens)
}

/// Parses the value of a key; `None` if the key is absent.
fn value<T: Readable>(params: &Params, key: &str) -> Result<Option<T>, Faults> {
    params.get(key).map(|node| StageNode::new(node.clone(), format!("{}.{key}", params.path())).parse()).transpose()
}

/// Parses a length, mm.
fn mm(params: &Params, key: &str) -> Result<Option<f64>, Faults> {
    Ok(value::<Length>(params, key)?.map(|length| length.mm()))
}

/// Parses a radius, mm; infinite if the key is absent.
fn radius(params: &Params, key: &str) -> Result<f64, Faults> {
    Ok(value::<LengthOrInfinity>(params, key)?.map_or(f64::INFINITY, |length| length.mm()))
}

/// Parses a number; 0 if the key is absent.
fn number(params: &Params, key: &str) -> Result<f64, Faults> {
    Ok(value(params, key)?.unwrap_or(0.0))
}

fn coefficients(params: &Params) -> Result<Vec<f64>, Faults> {
    Ok(value(params, "coefficients")?.unwrap_or_default())
}

/// Parses an angle in degrees. A bare number is used as it is, since converting it to radians and back would change its last digit.
fn degrees(node: &Node, path: &str) -> Result<f64, Faults> {
    match &node.value {
        Value::Number(number) => Ok(number.value),
        _ => Ok(StageNode::new(node.clone(), path).parse::<Angle>()?.rad().to_degrees()),
    }
}

fn angle(params: &Params, key: &str) -> Result<f64, Faults> {
    params.get(key).map_or(Ok(0.0), |node| degrees(node, key))
}

fn displacement(params: &Params) -> Result<Displacement, Faults> {
    let mut by = Displacement::default();
    for (at, length) in value::<Vec<Length>>(params, "decenter")?.unwrap_or_default().iter().take(2).enumerate() {
        by.decenter_mm[at] = length.mm();
    }
    if let Some(Value::Seq(angles)) = params.get("tilt").map(|node| &node.value) {
        for (at, node) in angles.iter().take(3).enumerate() {
            by.tilt_deg[at] = degrees(node, "tilt")?;
        }
    }
    Ok(by)
}

/// Notes the keys that are not in `known` as left out.
fn note_others(params: &Params, known: &[&str], whose: &str, lens: &mut Prescription) {
    if let Value::Map(entries) = &params.node().value {
        for (key, _) in entries {
            if !known.contains(&key.text.as_str()) {
                lens.leave_out(key.span.line, true, format!("{whose}the key `{}`", key.text));
            }
        }
    }
}

/// Keys that every surface may have.
const PLACE: [&str; 16] = [
    "thickness",
    "glass",
    "nd",
    "vd",
    "ne",
    "ve",
    "semi-diameter",
    "mirror",
    "stop",
    "outer-semi-diameter",
    "chamfer",
    "aperture",
    "decenter",
    "tilt",
    "remark",
    "reversed",
];

/// Kind of a surface that names none: the default of the registry, which lists kinds of surfaces that this crate does not know.
const USUAL_KIND: &str = "sphere";

fn item(params: &Params, number: usize, lines: LineTriple, lens: &mut Prescription) -> Result<(), Faults> {
    let kind = params.kind().unwrap_or(USUAL_KIND).to_owned();
    let line = params.node().span.line;
    let whose = format!("surface {number}: ");
    if kind == "coordinate-break" {
        note_others(params, &["decenter", "tilt", "order", "thickness"], &whose, lens);
        lens.items.push(AxisItem::Break(CoordinateBreak {
            by: displacement(params)?,
            tilt_first: value::<String>(params, "order")?.as_deref() == Some("tilt-first"),
            thickness_mm: mm(params, "thickness")?.unwrap_or(0.0),
        }));
        return Ok(());
    }
    let (shape, known) = shape(&kind, params)?;
    let (_, own) = params.split(&PLACE);
    if let SurfaceShape::Other { kind } = &shape {
        lens.leave_out(line, true, format!("{whose}the kind `{kind}`, written as a plane"));
    } else {
        note_others(&own, known, &whose, lens);
    }
    let is_stop = shape == SurfaceShape::Stop;
    let mirror = value(params, "mirror")?.unwrap_or(false);
    let stands_in = || lens.surfaces().filter(|s| !s.mirror).last().map(|s| s.medium.clone()).unwrap_or_default();
    let stated = ["glass", "nd", "ne"].iter().any(|key| params.get(key).is_some());
    let surface = Surface {
        shape,
        thickness_mm: mm(params, "thickness")?.unwrap_or(0.0),
        // Give a stop the medium at its position.
        medium: if is_stop && !stated { stands_in() } else { medium(params, lines)? },
        mirror,
        stop: is_stop || value(params, "stop")?.unwrap_or(false),
        semi_diameter_mm: mm(params, "semi-diameter")?,
        outer_semi_diameter_mm: mm(params, "outer-semi-diameter")?,
        apertures: apertures(params)?,
        displacement: displacement(params)?,
        comment: value(params, "remark")?.unwrap_or_default(),
    };
    if value(params, "reversed")?.unwrap_or(false) {
        lens.leave_out(line, true, format!("{whose}the key `reversed`"));
    }
    if params.get("chamfer").is_some() {
        lens.leave_out(line, false, format!("{whose}the chamfer"));
    }
    lens.items.push(AxisItem::Surface(Box::new(surface)));
    Ok(())
}

/// Returns the shape, and the keys that define it completely.
fn shape(kind: &str, params: &Params) -> Result<(SurfaceShape, &'static [&'static str]), Faults> {
    let r = || radius(params, "radius");
    let conic = || number(params, "conic");
    Ok(match kind {
        "plane" => (SurfaceShape::Plane, &[]),
        "stop" => (SurfaceShape::Stop, &[]),
        "sphere" => (SurfaceShape::conic(r()?, 0.0), &["radius"]),
        "conic" => (SurfaceShape::conic(r()?, conic()?), &["radius", "conic"]),
        "even-asphere" => (
            SurfaceShape::EvenAsphere { radius: r()?, conic: conic()?, coefficients: coefficients(params)? },
            &["radius", "conic", "coefficients"],
        ),
        "odd-asphere" => (
            SurfaceShape::OddAsphere { radius: r()?, conic: conic()?, coefficients: coefficients(params)? },
            &["radius", "conic", "coefficients"],
        ),
        "cylinder" => {
            let along_x = value::<String>(params, "axis")?.as_deref() == Some("x");
            (SurfaceShape::Cylinder { radius: r()?, along_x }, &["radius", "axis"])
        }
        "toroid" => (
            SurfaceShape::Toroid {
                radius: r()?,
                conic: conic()?,
                coefficients: coefficients(params)?,
                rotation_radius: radius(params, "rotation-radius")?,
            },
            &["radius", "conic", "coefficients", "rotation-radius"],
        ),
        "biconic" => (
            SurfaceShape::Biconic {
                radius_x: radius(params, "radius-x")?,
                radius_y: radius(params, "radius-y")?,
                conic_x: number(params, "conic-x")?,
                conic_y: number(params, "conic-y")?,
            },
            &["radius-x", "radius-y", "conic-x", "conic-y"],
        ),
        "tilted-plane" => {
            let (about_x, about_y) = (angle(params, "tilt-x")?.to_radians(), angle(params, "tilt-y")?.to_radians());
            let (tan_x, tan_y) = (0.0 - libm::tan(about_y) / libm::cos(about_x), libm::tan(about_x));
            (SurfaceShape::TiltedPlane { tan_x, tan_y }, &["tilt-x", "tilt-y"])
        }
        "thin-lens" => {
            let focal_length = mm(params, "focal-length")?.unwrap_or(f64::INFINITY);
            (SurfaceShape::ThinLens { focal_length }, &["focal-length"])
        }
        "grating" => (
            SurfaceShape::Grating {
                lines_per_mm: value::<SpatialFrequency>(params, "lines-per-mm")?.map_or(0.0, |f| f.per_mm()),
                order: number(params, "order")?,
                radius: r()?,
                conic: conic()?,
                direction_deg: angle(params, "direction")?,
            },
            &["lines-per-mm", "order", "radius", "conic", "direction"],
        ),
        "zernike" => {
            let fringe = value::<String>(params, "ordering")?.as_deref() == Some("fringe");
            let shape = SurfaceShape::Zernike {
                radius: r()?,
                conic: conic()?,
                normalization_radius: mm(params, "normalization-radius")?.unwrap_or(1.0),
                coefficients: coefficients(params)?,
                ordering: if fringe { ZernikeOrdering::Fringe } else { ZernikeOrdering::Noll },
            };
            (shape, &["radius", "conic", "normalization-radius", "coefficients", "ordering"])
        }
        other => (SurfaceShape::Other { kind: other.to_owned() }, &[]),
    })
}

/// Returns the medium of a surface. Other programs state nd and Vd, so figures at other lines are converted to these.
fn medium(params: &Params, lines: LineTriple) -> Result<Medium, Faults> {
    let pair = |n, v| -> Result<(Option<f64>, Option<f64>), Faults> { Ok((value(params, n)?, value(params, v)?)) };
    let (n, v, lines) = match pair("ne", "ve")? {
        (Some(ne), ve) => (Some(ne), ve, LineTriple::F_PRIME_E_C_PRIME),
        (None, _) => pair("nd", "vd").map(|(n, v)| (n, v, lines))?,
    };
    let Some(glass) = params.get("glass") else {
        return Ok(n.map_or(Medium::Air, |n| at_d(n, v, lines)));
    };
    match glass.as_str() {
        Some(name) if name.eq_ignore_ascii_case("air") => Ok(Medium::Air),
        Some(name) => {
            // Figures next to a name only tell which glass of that name is meant.
            let (nd, vd) = match n.map(|n| at_d(n, v, lines)) {
                Some(Medium::Model { nd, vd, .. }) if v.is_some() || lines == LineTriple::FDC => (Some(nd), vd),
                _ => (None, None),
            };
            Ok(Medium::Glass { name: name.to_owned(), nd, vd })
        }
        None => {
            let own = Params::section(glass.clone(), "glass")?;
            if ["formula", "table", "file", "name"].iter().any(|key| own.get(key).is_some()) {
                let glass = file::from_params(&own, "glass", &NoFiles)?;
                let vd = Some(glass.vd()).filter(|vd| vd.is_finite());
                let ng = Some(glass.index(lines::G.wavelength_nm)).filter(|n| n.is_finite());
                return Ok(Medium::Model { nd: glass.nd(), vd, ng });
            }
            let figures = value::<Figures>(params, "glass")?.unwrap_or_default();
            let mut medium = figures_at_d(&figures.medium(&own)?.0);
            if let Medium::Model { ng, .. } = &mut medium {
                *ng = figures.ng;
            }
            Ok(medium)
        }
    }
}

/// Converts an index and an Abbe number for any lines to nd and Vd; figures at d, F and C stay as they are.
fn at_d(n: f64, v: Option<f64>, lines: LineTriple) -> Medium {
    let model = v.filter(|_| lines != LineTriple::FDC).and_then(|v| ModelGlass::new(n, v, lines));
    model.map_or(Medium::Model { nd: n, vd: v, ng: None }, |model| figures_at_d(&spectra_glass::Medium::Model(model)))
}

fn figures_at_d(medium: &spectra_glass::Medium) -> Medium {
    let vd = match medium {
        spectra_glass::Medium::Model(model) if model.lines() == LineTriple::FDC => Some(model.abbe_number()),
        other => Some(other.abbe_number(LineTriple::FDC)).filter(|vd| vd.is_finite()),
    };
    let nd = match medium {
        // Keep the number as it was written, to the last digit.
        spectra_glass::Medium::Model(model) if model.lines() == LineTriple::FDC => model.index_mid(),
        other => other.index(lines::D.wavelength_nm),
    };
    Medium::Model { nd, vd, ng: None }
}

/// Resources without any files: a glass in a lens file that refers to a file of its own is not carried over.
struct NoFiles;

impl Resources for NoFiles {
    fn read(&self, path: &str, _: &[&str], _: &[&str], _: u64) -> Result<Resource, ResourceError> {
        Err(ResourceError::Io(format!("the glass of `{path}` is not carried: state its `nd` and `vd`")))
    }

    fn document(&self, path: &str, _: &[&str], _: &[&str]) -> Result<Params, Faults> {
        Err(Fault::new(format!("the glass of `{path}` is not carried: state its `nd` and `vd`")).into())
    }
}

fn apertures(params: &Params) -> Result<Vec<Aperture>, Faults> {
    let Some(node) = params.get("aperture") else { return Ok(Vec::new()) };
    let nodes: Vec<&Node> = match &node.value {
        Value::Seq(several) => several.iter().collect(),
        _ => vec![node],
    };
    nodes.into_iter().map(aperture).collect()
}

fn aperture(node: &Node) -> Result<Aperture, Faults> {
    let params = Params::section(node.clone(), "aperture")?;
    let size = |key: &str| mm(&params, key).map(|size| size.unwrap_or(0.0));
    let shape = match value::<String>(&params, "shape")?.unwrap_or_default().as_str() {
        "ring" => ApertureShape::Ring { inner: size("inner")?, outer: radius(&params, "outer")? },
        "rectangle" => ApertureShape::Rectangle { half_width: size("half-width")?, half_height: size("half-height")? },
        "ellipse" => ApertureShape::Ellipse { half_width: size("half-width")?, half_height: size("half-height")? },
        other => ApertureShape::Other { name: other.to_owned() },
    };
    let mut center_mm = [0.0; 2];
    for (at, length) in value::<Vec<Length>>(&params, "center")?.unwrap_or_default().iter().take(2).enumerate() {
        center_mm[at] = length.mm();
    }
    Ok(Aperture { shape, center_mm, obscures: value(&params, "obscures")?.unwrap_or(false) })
}
