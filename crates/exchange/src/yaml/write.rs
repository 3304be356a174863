//! Writes a prescription as a lens file.

use super::quote::{comment, quoted, scalar};
use crate::number::shortest;
use crate::prescription::{
    Aperture, ApertureShape, AxisItem, CoordinateBreak, Displacement, FieldKind, Medium, Prescription, Surface,
    SurfaceShape, SystemAperture, ZernikeOrdering,
};

/// Largest number of notes that are written.
const MOST_NOTES: usize = 200;

/// Writes a prescription as the text of a lens file. Comments at the top list everything that was not carried over; notes that
/// alter the path of light are repeated in the remark. `source` is the name of the file from which the lens comes.
#[must_use]
pub fn write(lens: &Prescription, source: Option<&str>) -> String {
    let mut out = String::new();
    let mut line = |text: &str| {
        out.push_str(text);
        out.push('\n');
    };
    if let Some(source) = source {
        line(&format!("# Imported from {}.", comment(source)));
    }
    if !lens.left_out.is_empty() {
        line("# Not carried (! marks what changes the path of light):");
        for note in lens.left_out.iter().take(MOST_NOTES) {
            line(&format!("# {} {}", if note.alters { "!" } else { "-" }, comment(&note.to_string())));
        }
        if lens.left_out.len() > MOST_NOTES {
            line(&format!("# and {} more", lens.left_out.len() - MOST_NOTES));
        }
    }
    let name = if lens.name.trim().is_empty() { source.unwrap_or("unnamed lens") } else { &lens.name };
    line(&format!("name: {}", quoted(name)));
    if let Some(year) = lens.year {
        line(&format!("year: {year}"));
    }
    for (key, value) in [("maker", &lens.maker), ("patent", &lens.patent), ("reference-line", &lens.reference_line)] {
        if let Some(value) = value {
            line(&format!("{key}: {}", quoted(value)));
        }
    }
    if let Some(source) = source {
        line(&format!("source: {}", quoted(&format!("imported from {source}"))));
    }
    let remark = remark(lens);
    if !remark.is_empty() {
        line(&format!("remark: {}", quoted(&remark)));
    }
    match (lens.rims.as_deref(), rims(lens)) {
        (Some(rims), _) => match rims.strip_prefix("fitted to ") {
            Some(to) => line(&format!("rims: {{fitted: {}}}", quoted(to))),
            None => line(&format!("rims: {rims}")),
        },
        (None, Some(rims)) => line(&format!("rims: {rims}")),
        (None, None) => {}
    }
    line("surfaces:");
    for item in &lens.items {
        match item {
            AxisItem::Surface(surface) => {
                line(&format!("  - {{{}}}", surface_keys(surface).join(", ")));
            }
            AxisItem::Break(axis) => line(&format!("  - {{{}}}", break_keys(axis).join(", "))),
        }
    }
    out
}

/// Returns the origin of the clear sizes: `stated` in the file, or `computed` if only the stop clips and its size was computed from the
/// beam; `None` if nothing clips.
fn rims(lens: &Prescription) -> Option<&'static str> {
    let clips = |surface: &Surface| surface.semi_diameter_mm.is_some() || !surface.apertures.is_empty();
    let of_its_own = |surface: &&Surface| clips(surface) && !(surface.stop && lens.stop_is_computed);
    match lens.surfaces().any(clips) {
        true if lens.surfaces().filter(of_its_own).count() > 0 => Some("stated"),
        true => Some("computed"),
        false => None,
    }
}

/// Returns the remark of the lens file, which only people read.
fn remark(lens: &Prescription) -> String {
    let mut parts = Vec::new();
    let mut say = |text: String| parts.push(text);
    if let Some(distance) = lens.object_distance_mm {
        say(format!("The object is {} mm in front of the first surface.", shortest(distance)));
    }
    match lens.system_aperture {
        Some(SystemAperture::EntrancePupilDiameter(d)) => say(format!("Entrance pupil diameter {} mm.", shortest(d))),
        Some(SystemAperture::FNumber(n)) => say(format!("f/{}.", shortest(n))),
        Some(SystemAperture::ObjectNumericalAperture(n)) => {
            say(format!("Numerical aperture {} at the object.", shortest(n)))
        }
        Some(SystemAperture::ImageNumericalAperture(n)) => {
            say(format!("Numerical aperture {} at the image.", shortest(n)))
        }
        Some(SystemAperture::StopSize) | None => {}
    }
    if !lens.wavelengths.is_empty() {
        let words: Vec<String> = (lens.wavelengths.iter().enumerate())
            .map(|(at, wavelength)| {
                let primary = if lens.primary == Some(at) && lens.wavelengths.len() > 1 { " (primary)" } else { "" };
                format!("{}{primary}", shortest(wavelength.nm))
            })
            .collect();
        say(format!("Wavelengths in nm: {}.", words.join(", ")));
    }
    if let Some(fields) = &lens.fields {
        let what = match fields.kind {
            FieldKind::Angle => "angles in degrees",
            FieldKind::ObjectHeight => "heights of the object in mm",
            FieldKind::ParaxialImageHeight => "heights of the paraxial image in mm",
            FieldKind::RealImageHeight => "heights of the image in mm",
        };
        let points: Vec<String> =
            fields.points.iter().map(|[x, y]| format!("({}, {})", shortest(*x), shortest(*y))).collect();
        say(format!("Fields, {what} (x, y): {}.", points.join(", ")));
    }
    lens.remarks.iter().for_each(|remark| say(remark.clone()));
    let altering: Vec<&str> = lens.left_out.iter().filter(|note| note.alters).map(|note| note.text.as_str()).collect();
    if !altering.is_empty() {
        say(format!("Not carried: {}.", altering.into_iter().take(10).collect::<Vec<_>>().join("; ")));
    }
    parts.join(" ")
}

/// Formats a length: `inf`, or the shortest spelling.
fn length(mm: f64) -> String {
    if mm.is_finite() { shortest(mm) } else { "inf".to_owned() }
}

fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|v| shortest(*v)).collect::<Vec<_>>().join(", "))
}

fn displacement(by: &Displacement, keys: &mut Vec<String>) {
    if by.decenter_mm != [0.0; 2] {
        keys.push(format!("decenter: {}", list(&by.decenter_mm)));
    }
    if by.tilt_deg != [0.0; 3] {
        keys.push(format!("tilt: {}", list(&by.tilt_deg)));
    }
}

fn break_keys(axis: &CoordinateBreak) -> Vec<String> {
    let mut keys = vec!["kind: coordinate-break".to_owned()];
    displacement(&axis.by, &mut keys);
    if axis.tilt_first {
        keys.push("order: tilt-first".to_owned());
    }
    if axis.thickness_mm != 0.0 {
        keys.push(format!("thickness: {}", shortest(axis.thickness_mm)));
    }
    keys
}

fn surface_keys(surface: &Surface) -> Vec<String> {
    let mut keys = shape_keys(&surface.shape);
    // A lens file must state how thick a glass is, even if its thickness is 0.
    let begins_glass = !surface.mirror && !matches!(surface.medium, Medium::Air);
    if surface.thickness_mm != 0.0 || begins_glass {
        keys.push(format!("thickness: {}", shortest(surface.thickness_mm)));
    }
    if surface.mirror {
        keys.push("mirror: true".to_owned());
    } else {
        match &surface.medium {
            Medium::Air => {}
            Medium::Glass { name, nd, vd } => {
                keys.push(format!("glass: {}", scalar(name)));
                keys.extend(nd.map(|nd| format!("nd: {}", shortest(nd))));
                keys.extend(vd.filter(|_| nd.is_some()).map(|vd| format!("vd: {}", shortest(vd))));
            }
            Medium::Model { nd, vd, ng } => {
                let vd = vd.map_or(String::new(), |vd| format!(", vd: {}", shortest(vd)));
                let ng = ng.map_or(String::new(), |ng| format!(", ng: {}", shortest(ng)));
                keys.push(format!("glass: {{nd: {}{vd}{ng}}}", shortest(*nd)));
            }
            Medium::Unknown { name } => keys.push(format!("glass: {}", scalar(name))),
        }
    }
    if surface.stop && surface.shape != SurfaceShape::Stop {
        keys.push("stop: true".to_owned());
    }
    keys.extend(surface.semi_diameter_mm.map(|s| format!("semi-diameter: {}", shortest(s))));
    keys.extend(surface.outer_semi_diameter_mm.map(|s| format!("outer-semi-diameter: {}", shortest(s))));
    match surface.apertures.as_slice() {
        [] => {}
        [one] => keys.push(format!("aperture: {}", aperture(one))),
        several => {
            keys.push(format!("aperture: [{}]", several.iter().map(aperture).collect::<Vec<_>>().join(", ")));
        }
    }
    displacement(&surface.displacement, &mut keys);
    if !surface.comment.is_empty() {
        keys.push(format!("remark: {}", quoted(&surface.comment)));
    }
    keys
}

fn aperture(aperture: &Aperture) -> String {
    let mut keys = match &aperture.shape {
        ApertureShape::Ring { inner, outer } => {
            vec!["shape: ring".to_owned(), format!("inner: {}", shortest(*inner)), format!("outer: {}", length(*outer))]
        }
        ApertureShape::Rectangle { half_width, half_height } => vec![
            "shape: rectangle".to_owned(),
            format!("half-width: {}", shortest(*half_width)),
            format!("half-height: {}", shortest(*half_height)),
        ],
        ApertureShape::Ellipse { half_width, half_height } => vec![
            "shape: ellipse".to_owned(),
            format!("half-width: {}", shortest(*half_width)),
            format!("half-height: {}", shortest(*half_height)),
        ],
        ApertureShape::Polygon { points } => {
            let points: Vec<String> = points.iter().map(|point| list(point)).collect();
            vec!["shape: polygon".to_owned(), format!("points: [{}]", points.join(", "))]
        }
        ApertureShape::Other { name } => vec![format!("shape: {}", scalar(name))],
    };
    if aperture.center_mm != [0.0; 2] {
        keys.push(format!("center: {}", list(&aperture.center_mm)));
    }
    if aperture.obscures {
        keys.push("obscures: true".to_owned());
    }
    format!("{{{}}}", keys.join(", "))
}

fn shape_keys(shape: &SurfaceShape) -> Vec<String> {
    let kind = |name: &str| vec![format!("kind: {name}")];
    let with = |name: &str, figures: &[(&str, f64)]| {
        let mut keys = kind(name);
        keys.extend(figures.iter().map(|(key, value)| format!("{key}: {}", length(*value))));
        keys
    };
    let with_list = |mut keys: Vec<String>, coefficients: &[f64]| {
        if !coefficients.is_empty() {
            keys.push(format!("coefficients: {}", list(coefficients)));
        }
        keys
    };
    match shape {
        SurfaceShape::Plane => kind("plane"),
        SurfaceShape::Stop => kind("stop"),
        SurfaceShape::Sphere { radius } => with("sphere", &[("radius", *radius)]),
        SurfaceShape::Conic { radius, conic } => with("conic", &[("radius", *radius), ("conic", *conic)]),
        SurfaceShape::EvenAsphere { radius, conic, coefficients } => {
            with_list(with("even-asphere", &[("radius", *radius), ("conic", *conic)]), coefficients)
        }
        SurfaceShape::OddAsphere { radius, conic, coefficients } => {
            with_list(with("odd-asphere", &[("radius", *radius), ("conic", *conic)]), coefficients)
        }
        SurfaceShape::Cylinder { radius, along_x } => {
            let mut keys = with("cylinder", &[("radius", *radius)]);
            keys.push(format!("axis: {}", if *along_x { "x" } else { "y" }));
            keys
        }
        SurfaceShape::Toroid { radius, conic, coefficients, rotation_radius } => {
            let keys = with("toroid", &[("radius", *radius), ("conic", *conic), ("rotation-radius", *rotation_radius)]);
            with_list(keys, coefficients)
        }
        SurfaceShape::Biconic { radius_x, radius_y, conic_x, conic_y } => with(
            "biconic",
            &[("radius-x", *radius_x), ("radius-y", *radius_y), ("conic-x", *conic_x), ("conic-y", *conic_y)],
        ),
        SurfaceShape::TiltedPlane { tan_x, tan_y } => {
            // Rotations: z = y tan(tilt-x) - x tan(tilt-y) / cos(tilt-x), about x first and then about the new y.
            let about_x = libm::atan(*tan_y);
            let about_y = 0.0 - libm::atan(tan_x * libm::cos(about_x));
            with("tilted-plane", &[("tilt-x", about_x.to_degrees()), ("tilt-y", about_y.to_degrees())])
        }
        SurfaceShape::ThinLens { focal_length } => with("thin-lens", &[("focal-length", *focal_length)]),
        SurfaceShape::Grating { lines_per_mm, order, radius, conic: _, direction_deg } => {
            let mut keys = with("grating", &[("lines-per-mm", *lines_per_mm), ("order", *order), ("radius", *radius)]);
            if *direction_deg != 0.0 {
                keys.push(format!("direction: {}", shortest(*direction_deg)));
            }
            keys
        }
        SurfaceShape::Zernike { radius, conic, normalization_radius, coefficients, ordering } => {
            let figures = [("radius", *radius), ("conic", *conic), ("normalization-radius", *normalization_radius)];
            let mut keys = with_list(with("zernike", &figures), coefficients);
            keys.push(format!("ordering: {}", if *ordering == ZernikeOrdering::Noll { "noll" } else { "fringe" }));
            keys
        }
        SurfaceShape::Other { kind: name } => kind(name),
    }
}
