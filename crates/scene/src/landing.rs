//! Search for the place where the light of a source lands behind a lens, for imagers that center on it:
//! `imager: {around: source}`.

use crate::focus::FocusLight;
use spectra_core::glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::Numbers;
use spectra_core::params::{Params, Value};
use spectra_core::spectral::Grid;
use spectra_core::stage::Source;
use spectra_core::{Isa, RayBatch};
use spectra_optics::{AimPattern, FrontPupil, Optics};
use spectra_tracer::{Indices, Tracer, Travel};

/// Number of rays traced.
const RAYS: usize = 4096;
/// Seed of the rays' numbers, the same for every scene.
const SEED: u64 = 1;

/// Returns whether an imager asks to be centered on the light of the source.
pub(crate) fn is_wanted(imager: &Params) -> bool {
    matches!(imager.get("around").map(|node| &node.value), Some(Value::String(text)) if text == "source")
}

/// Returns the point in the image plane where the light of `source` lands: the median of x and that of y, in mm. Rays start all
/// over the source, fill everything that passes the lens, and have the wavelengths of source and channels. `size_hint` is the
/// hint for a lens without sizes: see [`crate::size_hint`].
///
/// # Errors
/// The message, and a hint for the user.
pub(crate) fn middle_mm(
    source: &dyn Source,
    lens: &Optics,
    light: &FocusLight,
    grid: &Grid,
    size_hint: &str,
) -> Result<[f64; 2], [String; 2]> {
    let Some(emit) = source.emit() else {
        let hint = "leave `around` out, or use a source that emits light, such as `{kind: point, ...}`";
        return Err(["the source has no light that could be followed to the imager".to_owned(), hint.to_owned()]);
    };
    let isa = Isa::Baseline;
    let blocked = || {
        let hint = "`spectra lens draw` shows what blocks it";
        ["none of the light of the source passes the lens to the imager".to_owned(), hint.to_owned()]
    };
    let band = Indices::Band { min_nm: grid.start_nm, max_nm: grid.end_nm() };
    let tracer = lens.tracer(band).map_err(|error| [error.to_string(), "use another glass".to_owned()])?;
    let numbers = Numbers::sobol(SEED);
    let columns: Vec<Vec<f64>> = (0..5)
        .map(|dimension| {
            let mut column = vec![0.0; RAYS];
            numbers.fill(isa, 0, 0, dimension, &mut column);
            column
        })
        .collect();
    let mut rays = RayBatch::new(RAYS);
    rays.restart(RAYS);
    for (nm, share) in rays.columns_mut().wavelength_nm.iter_mut().zip(&columns[0]) {
        *nm = light.wavelength_nm(*share).ok_or_else(|| {
            let hint = "use another light, or another film or response";
            ["the imager sees nothing of the light of the source".to_owned(), hint.to_owned()]
        })?;
    }
    emit.place(&mut rays, &columns[1], &columns[2]);
    if !emit.is_directed() {
        aim(lens, &tracer, &mut rays, [&columns[3], &columns[4]], grid, size_hint)?;
    }
    tracer.trace(&mut rays, &mut tracer.work_in_place(RAYS), Travel::Forward);
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    let mut places: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for i in (0..RAYS).filter(|i| rays.states()[*i] == ALIVE) {
        let distance = -z[i] / n[i];
        let at = [x[i] + distance * l[i], y[i] + distance * m[i]];
        if at.iter().all(|v| v.is_finite()) {
            places[0].push(at[0]);
            places[1].push(at[1]);
        }
    }
    let middle = |mut along: Vec<f64>| {
        along.sort_by(f64::total_cmp);
        along.get(along.len() / 2).copied()
    };
    let [across, down] = places;
    middle(across).zip(middle(down)).map(|(x, y)| [x, y]).ok_or_else(blocked)
}

/// Aims rays from their starting points over everything that passes the lens.
fn aim(
    lens: &Optics,
    tracer: &Tracer,
    rays: &mut RayBatch,
    places: [&[f64]; 2],
    grid: &Grid,
    size_hint: &str,
) -> Result<(), [String; 2]> {
    let [x, y, z] = rays.positions();
    let points: Vec<DVec3> = (0..rays.len()).map(|i| DVec3::new(x[i], y[i], z[i])).collect();
    let pupil = FrontPupil::search(lens, tracer, &points, grid.start_nm, grid.end_nm()).ok_or_else(|| {
        let text = "no surface of the lens states its size, so no light can be aimed at it";
        [text.to_owned(), size_hint.to_owned()]
    })?;
    pupil.aim(rays, places[0], places[1], AimPattern::Disk);
    Ok(())
}
