//! Scattering of the rays of a batch by the layers on the surfaces of a lens.
//!
//! A tracer traces one of two kinds of light. By default it traces light that nothing scatters: dimmed by the layers, without random
//! numbers, and aimed as usual. `Tracer::scattering` makes one for light that is scattered at least once. A random number of the ray
//! chooses the surface that scatters it first, in proportion to the largest fraction that each surface scatters; behind that surface chance
//! decides. The weight is the product of the straight fractions at the surfaces before, times the scattered fraction there over the
//! probability of the choice.
//!
//! The pupil search ends at the first layer, so these rays fill the whole opening behind it. That is why straight light, nearly all of the
//! light, is not among them. Walks ([`crate::Walker`]) know layers, too, and check the tracer (`crates/optics/tests/it/scatter.rs`).

use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::numbers::StageKey;
use spectra_core::{Loss, RayBatch};
use spectra_lens::Coating;
use spectra_lens::Layer;
use spectra_lens::scatter::{Shares, which};

/// Key of the number that decides which surface of a path scatters a ray first.
pub(crate) const FIRST: StageKey = StageKey::new("scatter", u64::MAX);

/// Dimensions of the random numbers that are drawn at one surface, in order.
const WHETHER: u32 = 0;
const WHICH: u32 = 1;
const HOW_FAR: u32 = 2;
const WHICH_WAY: u32 = 3;

/// A surface with layers on the path of scattered light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScatterSurface {
    /// Key from which the surface draws its own numbers.
    pub stage: StageKey,
    /// Interval of the numbers of [`FIRST`] for which this surface is the first to scatter.
    pub first: [f64; 2],
}

/// Multiplies the weights of the live rays of a batch by the fraction that `of` selects.
pub(crate) fn dim(rays: &mut RayBatch, layers: &[Layer], semi_diameter_mm: Option<f64>, of: impl Fn(Shares) -> f64) {
    let c = rays.weight_columns();
    let [x, y, _] = c.position;
    for i in 0..c.weight.len() {
        if c.state[i] == ALIVE {
            c.weight[i] *= of(Shares::at(layers, [x[i], y[i]], semi_diameter_mm));
        }
    }
}

/// The surface that rays met, and the columns of the batch before they met it.
pub(crate) struct ScatterEvent<'a> {
    pub layers: &'a [Layer],
    pub semi_diameter_mm: Option<f64>,
    /// Directions in front of the surface.
    pub before: [&'a [f64]; 3],
    /// Indices in front of the surface and behind it; equal for a mirror.
    pub n: [&'a [f64]; 2],
    pub mirror: bool,
    /// Coating of the surface, if it is a refracting surface that weighs light.
    pub coating: Option<&'a Coating>,
    pub number: u32,
}

/// Scatters the rays of light that is scattered at least once, behind a surface. Returns how many ended.
///
/// One number per ray chooses the surface that scatters it first, whatever lies there. Before that surface light goes straight and is
/// weighted with the straight fraction. There it is weighted with the scattered fraction over the probability of the choice; behind it,
/// chance decides. Rays without numbers go straight.
pub(crate) fn scatter(rays: &mut RayBatch, place: &ScatterSurface, meeting: &ScatterEvent<'_>) -> usize {
    let len = rays.len();
    rays.set_stage(FIRST);
    let c = rays.columns_mut();
    let first: Vec<Option<f64>> =
        (0..len).map(|i| c.numbers.of(i).filter(|_| c.state[i] == ALIVE).map(|numbers| numbers.number(0))).collect();
    rays.set_stage(place.stage);
    let c = rays.columns_mut();
    let mut ended = 0;
    for i in 0..len {
        if c.state[i] != ALIVE {
            continue;
        }
        let at = [c.x[i], c.y[i]];
        let shares = Shares::at(meeting.layers, at, meeting.semi_diameter_mm);
        let (Some(first), Some(numbers)) = (first[i], c.numbers.of(i)) else {
            c.weight[i] *= shares.straight;
            continue;
        };
        let [from, upto] = place.first;
        if first >= upto {
            c.weight[i] *= shares.straight;
            continue;
        }
        let scattered = shares.open - shares.straight;
        if first >= from {
            c.weight[i] *= scattered / (upto - from);
        } else {
            c.weight[i] *= shares.open;
            if numbers.number(WHETHER) * shares.open >= scattered {
                continue;
            }
        }
        let layer = which(meeting.layers, at, meeting.semi_diameter_mm, numbers.number(WHICH));
        let Some(layer) = layer else {
            // No layer lies here.
            c.weight[i] = 0.0;
            continue;
        };
        let nm = c.wavelength_nm[i];
        let step = layer.lobe.step(numbers.pair(HOW_FAR), numbers.pair(WHICH_WAY), nm, at);
        let before = DVec3::from_array(meeting.before.map(|column| column[i]));
        let after = DVec3::new(c.l[i], c.m[i], c.n[i]);
        let n = meeting.n.map(|column| column[i]);
        match stepped(before, after, n, step, meeting, nm) {
            Some((direction, part)) => {
                (c.l[i], c.m[i], c.n[i]) = direction.into();
                c.weight[i] *= part;
            }
            None => {
                c.state[i] = Loss::Absorbed.state(meeting.number);
                ended += 1;
            }
        }
    }
    ended
}

/// Returns the direction behind the surface after a step, and the transmittance of the coating there relative to straight light. Returns
/// `None` if the step leads beyond 90 degrees.
fn stepped(
    before: DVec3,
    after: DVec3,
    [n, n_after]: [f64; 2],
    [x, y]: [f64; 2],
    meeting: &ScatterEvent<'_>,
    wavelength_nm: f64,
) -> Option<(DVec3, f64)> {
    // Refraction and reflection change the direction along the normal.
    let normal = (if meeting.mirror { after - before } else { n_after * after - n * before }).try_normalize()?;
    let normal = if normal.dot(after) < 0.0 { -normal } else { normal };
    let across_x = (DVec3::X - normal.x * normal).try_normalize().unwrap_or(DVec3::Y);
    let across_y = if normal.z < 0.0 { across_x.cross(normal) } else { normal.cross(across_x) };
    let along = n_after * (after - after.dot(normal) * normal) + x * across_x + y * across_y;
    let square = along.length_squared();
    let low = n.min(n_after);
    if !(square < low * low) {
        return None;
    }
    let direction = along / n_after + normal * (1.0 - square / (n_after * n_after)).sqrt();
    // Light that comes from the side of the layer is refracted after its step.
    let part = match meeting.coating {
        Some(coating) if n < n_after => {
            let passes = |cosine: f64| coating.transmittance(n, n_after, cosine, wavelength_nm).mean();
            let straight = passes(before.dot(normal).abs().min(1.0));
            if straight > 0.0 { passes((1.0 - square / (n * n)).sqrt()) / straight } else { 0.0 }
        }
        _ => 1.0,
    };
    Some((direction, part))
}
