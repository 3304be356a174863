//! The size of the stop, computed from the size of the beam that a file states.
//!
//! Other programs launch rays that fill the entrance pupil: its diameter, an f-number or a numerical aperture limits the light as the rim
//! of the stop does. A lens file needs that rim. Its size is the height of the paraxial marginal ray:
//! n' u' = n u - y (n' - n) c at each surface, where each mirror reverses the sign of n.

use crate::number::shortest;
use crate::prescription::{AxisItem, Medium, Prescription, Surface, SurfaceShape, SystemAperture};
use spectra_glass::{Catalog, lines};

/// Relative tolerance within which the computed size and the size of an aperture on the stop are the same.
const SAME: f64 = 1e-4;

/// Gives the stop the size that the file's beam has there. If it cannot be computed, the beam is noted as not carried, at `line`. `mark` is
/// the word by which the file marks a surface as its stop.
pub(crate) fn size(lens: &mut Prescription, line: usize, mark: &str) {
    let stated = match lens.system_aperture {
        None | Some(SystemAperture::StopSize) => return,
        Some(SystemAperture::EntrancePupilDiameter(d)) => format!("the entrance pupil diameter of {} mm", shortest(d)),
        Some(SystemAperture::FNumber(n)) => format!("f/{}", shortest(n)),
        Some(SystemAperture::ObjectNumericalAperture(n)) => {
            format!("the numerical aperture {} at the object", shortest(n))
        }
        Some(SystemAperture::ImageNumericalAperture(n)) => {
            format!("the numerical aperture {} at the image", shortest(n))
        }
    };
    match semi_diameter_mm(lens, mark) {
        Ok((at, size)) => {
            if let AxisItem::Surface(stop) = &mut lens.items[at]
                && limit(stop, size)
            {
                let text = format!(
                    "The stop's semi-diameter of {} mm is the height of the paraxial marginal ray.",
                    shortest(size)
                );
                lens.remarks.push(text);
                lens.stop_is_computed = true;
            }
        }
        Err(why) => lens.leave_out(line, true, format!("{stated} does not limit the light: {why}")),
    }
}

/// Narrows a stop to a size; returns false if it is as narrow already.
fn limit(stop: &mut Surface, size: f64) -> bool {
    let own = stop.semi_diameter_mm;
    if own.is_some_and(|own| own <= size * (1.0 + SAME)) {
        return false;
    }
    // Keep a larger size as the edge of the element.
    let edge = stop.outer_semi_diameter_mm.unwrap_or(0.0).max(own.unwrap_or(0.0));
    stop.semi_diameter_mm = Some(size);
    stop.outer_semi_diameter_mm = (edge > size).then_some(edge);
    true
}

/// Returns the index of the stop among the items and its semi-diameter, or the reason why there is none with a hint what to write.
fn semi_diameter_mm(lens: &Prescription, mark: &str) -> Result<(usize, f64), String> {
    const WRITE: &str = "write `semi-diameter: ...` at the stop of the imported lens file";
    let is_stop = |item: &AxisItem| matches!(item, AxisItem::Surface(surface) if surface.stop);
    let Some(stop) = lens.items.iter().position(is_stop) else {
        return Err(format!(
            "no surface is the stop; write {mark} at one, or `stop: true` and `semi-diameter: ...` in the imported lens file"
        ));
    };
    let nm = lens
        .primary
        .or(Some(lens.wavelengths.len() / 2))
        .and_then(|at| lens.wavelengths.get(at))
        .map_or(lines::D.wavelength_nm, |wavelength| wavelength.nm);
    // Trace one ray parallel to the axis, and one from the axial point of the first surface.
    let (high, steep) = (trace(lens, stop, nm, [1.0, 0.0]), trace(lens, stop, nm, [0.0, 1.0]));
    let (high, steep) = match (high, steep) {
        (Ok(high), Ok(steep)) => (high, steep),
        (Err(glass), _) | (_, Err(glass)) => {
            return Err(format!(
                "the index of {glass} is not known; write it into the imported lens file, then {WRITE}"
            ));
        }
    };
    if high.bends_before_stop && is_decentered(&lens.items[..=stop]) {
        return Err(format!("surfaces in front of the stop are decentered; {WRITE}"));
    }
    // Ray from the axial object point, per unit slope there: height at the stop, and n u at the image.
    let from_object =
        lens.object_distance_mm.map(|d| (d * high.at_stop + steep.at_stop, d * high.behind + steep.behind));
    let size = match (lens.system_aperture, from_object) {
        (Some(SystemAperture::EntrancePupilDiameter(d)), _) => high.at_stop * d / 2.0,
        // Focal length over pupil diameter, wherever the object is.
        (Some(SystemAperture::FNumber(n)), _) => high.at_stop / (2.0 * n * high.behind),
        (Some(SystemAperture::ObjectNumericalAperture(_)), None) => {
            return Err(format!("the object is at infinity; {WRITE}"));
        }
        (Some(SystemAperture::ObjectNumericalAperture(na)), Some((at_stop, _))) => {
            at_stop * na / libm::sqrt(1.0 - na * na)
        }
        (Some(SystemAperture::ImageNumericalAperture(na)), None) => high.at_stop * na / high.behind,
        (Some(SystemAperture::ImageNumericalAperture(na)), Some((at_stop, behind))) => at_stop * na / behind,
        (Some(SystemAperture::StopSize) | None, _) => f64::NAN,
    };
    // Round to ten digits, because more would not be meaningful.
    let size: f64 = format!("{:.9e}", size.abs()).parse().unwrap_or(f64::NAN);
    if size > 0.0 && size.is_finite() { Ok((stop, size)) } else { Err(format!("no paraxial ray fits; {WRITE}")) }
}

/// A paraxial ray through the lens.
struct Ray {
    /// Height at the stop, mm.
    at_stop: f64,
    /// Product n u behind the last surface.
    behind: f64,
    /// Whether a surface in front of the stop has power.
    bends_before_stop: bool,
}

/// Traces a paraxial ray from the first vertex. The error is the name of a glass without an index.
fn trace(lens: &Prescription, stop: usize, nm: f64, [mut y, mut slope]: [f64; 2]) -> Result<Ray, String> {
    let (mut n, mut at_stop, mut bends_before_stop) = (1.0_f64, 0.0, false);
    for (at, item) in lens.items.iter().enumerate() {
        if at == stop {
            at_stop = y;
        }
        if let AxisItem::Surface(surface) = item {
            let after = if surface.mirror { -n } else { index(&surface.medium, nm)?.copysign(n) };
            let (curvature, power) = bend(&surface.shape);
            let power = (after - n) * curvature + power;
            bends_before_stop |= at < stop && power != 0.0;
            slope = (n * slope - y * power) / after;
            n = after;
        }
        y += item.thickness_mm() * slope;
    }
    Ok(Ray { at_stop, behind: n * slope, bends_before_stop })
}

/// Returns the curvature at the vertex in y-z and the power of an ideal lens, both in 1/mm.
fn bend(shape: &SurfaceShape) -> (f64, f64) {
    let square = |coefficients: &[f64], at: usize| 2.0 * coefficients.get(at).copied().unwrap_or(0.0);
    match shape {
        SurfaceShape::Plane | SurfaceShape::Stop | SurfaceShape::TiltedPlane { .. } | SurfaceShape::Other { .. } => {
            (0.0, 0.0)
        }
        SurfaceShape::Sphere { radius }
        | SurfaceShape::Conic { radius, .. }
        | SurfaceShape::Grating { radius, .. }
        | SurfaceShape::Zernike { radius, .. }
        | SurfaceShape::Biconic { radius_y: radius, .. } => (1.0 / radius, 0.0),
        SurfaceShape::EvenAsphere { radius, coefficients, .. } | SurfaceShape::Toroid { radius, coefficients, .. } => {
            (1.0 / radius + square(coefficients, 0), 0.0)
        }
        SurfaceShape::OddAsphere { radius, coefficients, .. } => (1.0 / radius + square(coefficients, 1), 0.0),
        SurfaceShape::Cylinder { radius, along_x } => (if *along_x { 1.0 / radius } else { 0.0 }, 0.0),
        SurfaceShape::ThinLens { focal_length } => (0.0, 1.0 / focal_length),
    }
}

fn index(medium: &Medium, nm: f64) -> Result<f64, String> {
    let (name, index) = match medium {
        Medium::Air => return Ok(1.0),
        Medium::Glass { name, nd, .. } => {
            let known = Catalog::bundled().medium(name).ok().map(|medium| medium.index(nm));
            (name.clone(), known.filter(|n| n.is_finite()).or(*nd))
        }
        Medium::Model { nd, vd, .. } => {
            let model = spectra_glass::Medium::from_nd_vd(*nd, vd.unwrap_or(0.0)).map(|medium| medium.index(nm));
            (format!("nd {nd}"), model.filter(|n| n.is_finite()).or(Some(*nd)))
        }
        Medium::Unknown { name } => (name.clone(), None),
    };
    index.ok_or(name)
}

/// Whether any of these items is decentered.
fn is_decentered(items: &[AxisItem]) -> bool {
    items.iter().any(|item| match item {
        AxisItem::Surface(surface) => surface.displacement.decenter_mm != [0.0; 2],
        AxisItem::Break(axis) => axis.by.decenter_mm != [0.0; 2],
    })
}
