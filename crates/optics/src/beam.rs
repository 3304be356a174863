//! Beams: the light of one object point behind a lens, as real rays.

use crate::Optics;
use crate::bundle::{Bundle, ObjectPoint, RayPattern};
use spectra_core::cover::CoverStack;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_core::{Isa, RayBatch};
use spectra_glass::DispersionError;
use spectra_tracer::Indices;

/// The rays of one object point behind a lens, in the frame of the image plane. Plates in front of the frame are included; they
/// move with the frame. If the frame moves back by z, a ray meets it at `x_mm + z * slope_x`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beam {
    /// Position x of each ray on the plane z = 0, mm.
    pub x_mm: Vec<f64>,
    /// Position y of each ray on the plane z = 0, mm.
    pub y_mm: Vec<f64>,
    /// Slope dx/dz of each ray.
    pub slope_x: Vec<f64>,
    /// Slope dy/dz of each ray.
    pub slope_y: Vec<f64>,
    /// Flux of each ray, in arbitrary units.
    pub weight: Vec<f64>,
}

/// Means and second moments of a beam.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    x: f64,
    y: f64,
    u: f64,
    v: f64,
    /// Variance of the positions, mm^2.
    places: f64,
    /// Covariance of positions and slopes, mm.
    mixed: f64,
    /// Variance of the slopes.
    slopes: f64,
}

impl Beam {
    /// Traces the light of an object point through a lens. `light` is a list of wavelengths (nm) with their weights. For each
    /// wavelength, a grid of `cells` by `cells` rays covers the passing region. Returns `None` if no light passes, or no surface
    /// states a size.
    ///
    /// # Errors
    /// A medium has no usable index at a wavelength.
    pub fn trace(
        optics: &Optics,
        point: ObjectPoint,
        light: &[(f64, f64)],
        cells: usize,
    ) -> Result<Option<Self>, DispersionError> {
        let mut beam = Self::default();
        if optics.largest_semi_diameter_mm().is_none() {
            return Ok(None);
        }
        for (wavelength_nm, weight) in light {
            let bundle = Bundle::before(optics, point, Indices::At(*wavelength_nm))?;
            let Some((bundle, extent)) = bundle.and_then(|b| b.extent().ok().map(|extent| (b, extent))) else {
                continue;
            };
            let places: Vec<[f64; 2]> = RayPattern::Grid(cells).places(extent).collect();
            beam.add(&bundle.trace(&places), weight * extent.area_mm2(), optics.cover.as_ref());
        }
        Ok((!beam.weight.is_empty()).then_some(beam))
    }

    /// Adds the live rays of a batch in the frame of the image plane.
    fn add(&mut self, rays: &RayBatch, weight: f64, cover: Option<&CoverStack>) {
        let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
        for i in 0..rays.len() {
            let (u, v) = (l[i] / n[i], m[i] / n[i]);
            let depth_mm = cover.map_or(0.0, |c| c.depth_mm((u * u + v * v).sqrt(), rays.wavelengths_nm()[i]));
            let back_mm = z[i] + depth_mm;
            let (px, py) = (x[i] - back_mm * u, y[i] - back_mm * v);
            if rays.states()[i] == ALIVE && px.is_finite() && py.is_finite() {
                self.x_mm.push(px);
                self.y_mm.push(py);
                self.slope_x.push(u);
                self.slope_y.push(v);
                self.weight.push(weight * rays.weights()[i]);
            }
        }
    }

    /// Weighted mean of a function over the rays.
    fn mean(&self, of: impl Fn(usize) -> f64) -> f64 {
        let total: f64 = self.weight.iter().sum();
        self.weight.iter().enumerate().map(|(i, w)| w * of(i)).sum::<f64>() / total
    }

    fn moments(&self) -> Moments {
        let [x, y] = [&self.x_mm, &self.y_mm].map(|c| self.mean(|i| c[i]));
        let [u, v] = [&self.slope_x, &self.slope_y].map(|c| self.mean(|i| c[i]));
        let places = |i: usize| [self.x_mm[i] - x, self.y_mm[i] - y];
        let slopes = |i: usize| [self.slope_x[i] - u, self.slope_y[i] - v];
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        Moments {
            x,
            y,
            u,
            v,
            places: self.mean(|i| dot(places(i), places(i))),
            mixed: self.mean(|i| dot(places(i), slopes(i))),
            slopes: self.mean(|i| dot(slopes(i), slopes(i))),
        }
    }

    /// Returns the RMS distance of the rays from their centroid on the plane `z_mm` behind the image plane, mm.
    #[must_use]
    pub fn rms_mm(&self, z_mm: f64) -> f64 {
        let m = self.moments();
        (m.places + z_mm * (2.0 * m.mixed + z_mm * m.slopes)).max(0.0).sqrt()
    }

    /// Returns how far (mm) behind the image plane the RMS distance of the rays from their centroid is smallest; `None` for
    /// parallel rays.
    #[must_use]
    pub fn least_rms_z_mm(&self) -> Option<f64> {
        let m = self.moments();
        Some(-m.mixed / m.slopes).filter(|z| z.is_finite())
    }

    /// Returns the geometrical contrast (modulation) of a grating of `per_mm` line pairs per mm, on the plane `z_mm` behind the
    /// image plane. It is the mean of lines along x and along y.
    #[must_use]
    pub fn contrast(&self, z_mm: f64, per_mm: f64) -> f64 {
        let [across, along] = self.contrasts(z_mm, per_mm);
        0.5 * (across + along)
    }

    /// Contrasts in x (of lines along y) and in y (of lines along x).
    fn contrasts(&self, z_mm: f64, per_mm: f64) -> [f64; 2] {
        let isa = Isa::detect();
        let one = |places, slopes| isa.run(Grating { places, slopes, weights: &self.weight, z_mm, per_mm });
        [one(&self.x_mm, &self.slope_x), one(&self.y_mm, &self.slope_y)]
    }

    /// Returns the beam with every `stride`-th ray.
    fn thinned(&self, stride: usize) -> Self {
        let every = |all: &[f64]| all.iter().step_by(stride).copied().collect();
        Self {
            x_mm: every(&self.x_mm),
            y_mm: every(&self.y_mm),
            slope_x: every(&self.slope_x),
            slope_y: every(&self.slope_y),
            weight: every(&self.weight),
        }
    }

    /// Returns how far (mm) behind the image plane the contrast at `per_mm` line pairs per mm is highest; `None` for parallel
    /// rays.
    #[must_use]
    pub fn best_contrast_z_mm(&self, per_mm: f64) -> Option<f64> {
        let mean = |[x, y]: [f64; 2]| 0.5 * (x + y);
        self.highest_contrast(per_mm, mean).map(|(z, _)| z)
    }

    /// Planes on which the lines along y and those along x have the most contrast, mm behind the image plane. Returns them only if
    /// neither plane keeps half of the other's contrast, so that no plane is sharp for both.
    pub(crate) fn sections_z_mm(&self, per_mm: f64) -> Option<[f64; 2]> {
        let best = [0, 1].map(|k| self.highest_contrast(per_mm, move |both| both[k]));
        let [(zx, cx), (zy, cy)] = [best[0]?, best[1]?];
        let lost = self.contrasts(zy, per_mm)[0] < 0.5 * cx && self.contrasts(zx, per_mm)[1] < 0.5 * cy;
        lost.then_some([zx, zy])
    }

    /// Finds the plane (mm) on which the function `of` of the contrasts in x and y is largest. Returns the plane and the largest
    /// value.
    fn highest_contrast(&self, per_mm: f64, of: impl Fn([f64; 2]) -> f64) -> Option<(f64, f64)> {
        let m = self.moments();
        let offsets = (0..self.weight.len())
            .map(|i| [self.x_mm[i] - m.x, self.y_mm[i] - m.y, self.slope_x[i] - m.u, self.slope_y[i] - m.v]);
        let steepest2 = offsets.clone().map(|[.., u, v]| u * u + v * v).fold(0.0, f64::max);
        if !(steepest2 > 0.0) {
            return None;
        }
        // Rays cross the middle ray between these planes, and the light is most concentrated somewhere between them.
        let crossings = offsets.filter(|[.., u, v]| u * u + v * v > STEEP2 * steepest2);
        let crossings = crossings.map(|[x, y, u, v]| -(x * u + y * v) / (u * u + v * v));
        // The stride is odd, so that no column of the grid is left out.
        let stride = (self.weight.len() / SCANNED_RAYS) | 1;
        let few = self.thinned(stride);
        let coarse = |z: f64| of(few.contrasts(z, per_mm));
        let fine = |z: f64| of(self.contrasts(z, per_mm));
        highest(crossings, 1.0 / (per_mm * steepest2.sqrt()), coarse, fine)
    }
}

/// Kernel that computes the contrast of a grating in the direction across its lines.
struct Grating<'a> {
    places: &'a [f64],
    slopes: &'a [f64],
    weights: &'a [f64],
    z_mm: f64,
    per_mm: f64,
}

/// Number of rays whose sines are computed together.
const TOGETHER: usize = 64;
/// Number of partial sums, always added in the same order, whatever the width of the vectors.
const SUMS: usize = 8;

impl Vectorized for Grating<'_> {
    type Output = f64;
    #[inline(always)]
    fn run(self) -> f64 {
        let Some(first) = self.places.first() else { return 0.0 };
        let (mut re, mut im, mut total) = ([0.0; SUMS], [0.0; SUMS], [0.0; SUMS]);
        let (mut sines, mut cosines) = ([0.0; TOGETHER], [0.0; TOGETHER]);
        let chunks = self.places.chunks(TOGETHER).zip(self.slopes.chunks(TOGETHER)).zip(self.weights.chunks(TOGETHER));
        for ((places, slopes), weights) in chunks {
            let waves = sines.iter_mut().zip(&mut cosines);
            for ((place, slope), (sine, cosine)) in places.iter().zip(slopes).zip(waves) {
                let periods = (place + slope * self.z_mm - first) * self.per_mm;
                (*sine, *cosine) = sin_cos_turns(periods - periods.floor());
            }
            let rows = weights.chunks(SUMS).zip(sines.chunks(SUMS)).zip(cosines.chunks(SUMS));
            for ((weights, sines), cosines) in rows {
                for (k, ((weight, sine), cosine)) in weights.iter().zip(sines).zip(cosines).enumerate() {
                    re[k] += weight * cosine;
                    im[k] += weight * sine;
                    total[k] += weight;
                }
            }
        }
        let [re, im, total] = [re, im, total].map(|sums| sums.iter().sum::<f64>());
        (re * re + im * im).sqrt() / total
    }
}

/// Smallest squared slope relative to the largest: flatter rays do not tell where they cross the middle ray.
pub(crate) const STEEP2: f64 = 0.01;
/// Approximate number of rays that are evaluated on every plane; the planes with the highest contrast are evaluated with all
/// rays.
const SCANNED_RAYS: usize = 2000;
/// Smallest and largest number of planes that are scanned.
const PLANES: std::ops::RangeInclusive<f64> = 40.0..=400.0;
/// Number of planes within the depth over which the steepest ray moves aside by one period.
const PLANES_A_PERIOD: f64 = 8.0;
/// Number of peaks of the first scan that are evaluated with all rays.
const PEAKS: usize = 3;

/// Finds the plane (mm) with the highest contrast, and that contrast. The plane lies between the crossings of rays with the
/// middle ray, plus or minus half of the depth (`period_mm`) over which the steepest ray moves aside by one period. Contrast has
/// many peaks over depth, so the planes there are scanned one by one. Then those with the highest contrast are refined.
pub(crate) fn highest(
    crossings: impl Iterator<Item = f64>,
    period_mm: f64,
    coarse: impl Fn(f64) -> f64,
    fine: impl Fn(f64) -> f64,
) -> Option<(f64, f64)> {
    let (low, high) = crossings.fold((f64::INFINITY, -f64::INFINITY), |(a, b), z| (a.min(z), b.max(z)));
    let (low, high) = (low - 0.5 * period_mm, high + 0.5 * period_mm);
    if !(low < high && (high - low).is_finite()) {
        return None;
    }
    let steps = ((high - low) / period_mm * PLANES_A_PERIOD).clamp(*PLANES.start(), *PLANES.end()).ceil();
    let step = (high - low) / steps;
    let scores: Vec<f64> = (0..=steps as usize).map(|i| coarse(low + step * i as f64)).collect();
    let at = |i: usize| scores.get(i).copied().unwrap_or(f64::NEG_INFINITY);
    let is_peak = |i: &usize| at(*i) >= at(i.wrapping_sub(1)) && at(*i) >= at(i + 1);
    let mut peaks: Vec<usize> = (0..scores.len()).filter(is_peak).collect();
    peaks.sort_by(|a, b| at(*b).total_cmp(&at(*a)).then(a.cmp(b)));
    let found = peaks.into_iter().take(PEAKS).map(|i| {
        let middle = low + step * i as f64;
        let z = golden_section(middle - step, middle + step, |z| -fine(z));
        (z, fine(z))
    });
    found.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

/// Finds the minimum of a function with one valley between `low` and `high`, by the golden section (J. Kiefer, Proc. Amer. Math.
/// Soc. 4 (1953), 502).
pub(crate) fn golden_section(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PART: f64 = 0.618_033_988_749_894_9;
    const GOLDEN_STEPS: usize = 28;
    let mut inner = [high - PART * (high - low), low + PART * (high - low)];
    let mut values = inner.map(&f);
    // About a millionth of the interval is left.
    for _ in 0..GOLDEN_STEPS {
        if values[0] <= values[1] {
            high = inner[1];
            inner = [high - PART * (high - low), inner[0]];
            values = [f(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + PART * (high - low)];
            values = [values[1], f(inner[1])];
        }
    }
    0.5 * (low + high)
}
