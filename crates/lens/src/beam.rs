//! The light of one object point that passes a lens, as real rays.

use crate::{Indices, Lens, Tracer, Travel, Work};
use glam::DVec3;
use spectra_core::cover::CoverStack;
use spectra_core::isa::Vectorized;
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_core::{Isa, Loss, RayBatch};
use spectra_glass::DispersionError;

/// Where light comes from, frame of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObjectPoint {
    /// A point, mm.
    At(DVec3),
    /// Infinity: the unit direction in which the light runs.
    Toward(DVec3),
}

impl ObjectPoint {
    /// At a field angle (rad, positive: the light runs toward +y) on a plane `object_mm` in front of the first vertex
    /// (infinity allowed). The angle is that at which the point is seen from the paraxial entrance pupil, from the first
    /// vertex where there is none; on a plane it stays under 90 degrees.
    #[must_use]
    pub fn on_plane(lens: &Lens, object_mm: f64, field_rad: f64) -> Self {
        let (sin, cos) = (spectra_core::math::sin(field_rad), spectra_core::math::cos(field_rad));
        if object_mm == f64::INFINITY {
            return Self::Toward(DVec3::new(0.0, sin, cos));
        }
        let eye_mm = eye_z_mm(lens);
        Self::At(DVec3::new(0.0, -(object_mm + eye_mm) * sin / cos, -object_mm))
    }

    /// The same on a sphere about the eye point, for fields of any angle.
    #[must_use]
    pub fn on_sphere(lens: &Lens, object_mm: f64, field_rad: f64) -> Self {
        let direction = DVec3::new(0.0, spectra_core::math::sin(field_rad), spectra_core::math::cos(field_rad));
        if object_mm == f64::INFINITY {
            return Self::Toward(direction);
        }
        let eye_mm = eye_z_mm(lens);
        Self::At(DVec3::new(0.0, 0.0, eye_mm) - (object_mm + eye_mm) * direction)
    }
}

/// The paraxial entrance pupil, or the first vertex.
fn eye_z_mm(lens: &Lens) -> f64 {
    let pupil = lens.first_order(lens.reference_nm).entrance_pupil_z_mm;
    pupil.filter(|z| z.is_finite()).unwrap_or(0.0)
}

/// A radius that light enters a lens within whose first surface states no size, mm: some sizes of what does state one
/// (the stop), and room for the pupil to lie behind it.
fn far_enough_mm(lens: &Lens) -> f64 {
    let sized = lens.largest_semi_diameter_mm().map_or(0.0, |size| 4.0 * size);
    let far = sized + eye_z_mm(lens).abs();
    if far > 0.0 { far } else { 0.5 * lens.first_order(lens.reference_nm).efl_mm.abs().min(1e6) }
}

/// Rays that are traced at a time, so that their columns stay in the caches.
const BATCH: usize = 1024;

/// A window that rays from an object point are aimed through: a plane across the way to the front of the lens.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    point: ObjectPoint,
    /// The middle of the front of the lens, mm.
    middle: DVec3,
    across: [DVec3; 2],
    /// Radius of what has to be looked at, mm.
    pub reach_mm: f64,
}

/// A rectangle in a window, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cut {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Cut {
    /// Larger by this part of its size on each side, and at least by `least_mm`.
    pub(crate) fn grown(self, part: f64, least_mm: f64) -> Self {
        let by = [0, 1].map(|k| (part * (self.max[k] - self.min[k])).max(least_mm));
        Self { min: [self.min[0] - by[0], self.min[1] - by[1]], max: [self.max[0] + by[0], self.max[1] + by[1]] }
    }

    /// Places of a grid of `cells` by `cells`.
    fn places(self, cells: usize) -> impl Iterator<Item = [f64; 2]> {
        let at = move |k: usize, i: usize| self.min[k] + (self.max[k] - self.min[k]) * (i as f64 + 0.5) / cells as f64;
        (0..cells * cells).map(move |i| [at(0, i % cells), at(1, i / cells)])
    }
}

impl Window {
    /// For an object point of a lens; `None` where no light runs from there to the lens.
    pub(crate) fn new(lens: &Lens, point: ObjectPoint) -> Option<Self> {
        let first = lens.elements.first()?;
        let radius_mm = first.semi_diameter_mm.unwrap_or_else(|| far_enough_mm(lens));
        // The cap of the first surface, seen from anywhere, lies inside of a ball about the middle of it.
        let sag_mm = first.semi_diameter_mm.and_then(|r| first.surface.sag_mm(r, 0.0)).unwrap_or(0.0);
        let sag_mm = if first.reversed { -sag_mm } else { sag_mm };
        let middle = first.pose.origin_mm + DVec3::new(0.0, 0.0, 0.5 * sag_mm);
        let reach_mm = (radius_mm * radius_mm + 0.25 * sag_mm * sag_mm).sqrt() * 1.02;
        let along = match point {
            ObjectPoint::At(p) => (middle - p).try_normalize()?,
            ObjectPoint::Toward(d) => d,
        };
        let x = if along.x.abs() < 0.9 { DVec3::X } else { DVec3::Z };
        let right = (x - x.dot(along) * along).normalize();
        Some(Self { point, middle, across: [right, along.cross(right)], reach_mm })
    }

    /// All of it.
    pub(crate) fn whole(&self) -> Cut {
        Cut { min: [-self.reach_mm; 2], max: [self.reach_mm; 2] }
    }

    /// The ray through a place of it: a point in front of the lens, mm, and its direction.
    pub(crate) fn ray(&self, [a, b]: [f64; 2]) -> (DVec3, DVec3) {
        let through = self.middle + a * self.across[0] + b * self.across[1];
        match self.point {
            ObjectPoint::Toward(d) => (through - 2.0 * self.reach_mm * d, d),
            ObjectPoint::At(p) => (p, (through - p).normalize()),
        }
    }

    /// Solid angle (for a far point: area) of a cell there, over that of a cell in the middle.
    pub(crate) fn share(&self, [a, b]: [f64; 2]) -> f64 {
        match self.point {
            ObjectPoint::Toward(_) => 1.0,
            ObjectPoint::At(p) => {
                let far2 = (self.middle - p).length_squared();
                let cos2 = far2 / (far2 + a * a + b * b);
                cos2 * cos2.sqrt()
            }
        }
    }

    /// Traces the rays through these places of it.
    fn trace(&self, tracer: &Tracer, rays: &mut RayBatch, work: &mut Work, places: &[[f64; 2]], wavelength_nm: f64) {
        rays.restart(places.len());
        let c = rays.columns_mut();
        for (i, place) in places.iter().copied().enumerate() {
            let (p, d) = self.ray(place);
            (c.x[i], c.y[i], c.z[i]) = p.into();
            (c.l[i], c.m[i], c.n[i]) = d.into();
            c.wavelength_nm[i] = wavelength_nm;
            c.weight[i] = self.share(place);
        }
        tracer.trace(rays, work, Travel::Forward);
    }

    /// What passes of a grid through a cut: the rectangle that holds it; else the last surface that anything reached, and
    /// why it ended there.
    pub(crate) fn passing(
        &self,
        tracer: &Tracer,
        cut: Cut,
        cells: usize,
        wavelength_nm: f64,
    ) -> Result<Cut, Option<(Loss, u32)>> {
        let places: Vec<[f64; 2]> = cut.places(cells).collect();
        let capacity = places.len().min(BATCH);
        let (mut rays, mut work) = (RayBatch::new(capacity), tracer.work_unweighed(capacity));
        let (mut seen, mut end): (Option<Cut>, Option<(Loss, u32)>) = (None, None);
        for places in places.chunks(BATCH) {
            self.trace(tracer, &mut rays, &mut work, places, wavelength_nm);
            for (place, state) in places.iter().zip(rays.states()) {
                if *state == ALIVE {
                    let old = seen.unwrap_or(Cut { min: *place, max: *place });
                    let low = [0, 1].map(|k| old.min[k].min(place[k]));
                    let high = [0, 1].map(|k| old.max[k].max(place[k]));
                    seen = Some(Cut { min: low, max: high });
                } else if let Some(own) = Loss::of_state(*state).filter(|own| end.is_none_or(|end| own.1 >= end.1)) {
                    end = Some(own);
                }
            }
        }
        let cell = [0, 1].map(|k| (cut.max[k] - cut.min[k]) / cells as f64);
        let grown = |s: Cut| Cut { min: [0, 1].map(|k| s.min[k] - cell[k]), max: [0, 1].map(|k| s.max[k] + cell[k]) };
        seen.map(grown).ok_or(end)
    }

    /// What passes of it all, looked for on finer and finer grids.
    pub(crate) fn search(&self, tracer: &Tracer, wavelength_nm: f64) -> Result<Cut, Option<(Loss, u32)>> {
        let mut last = None;
        for cells in [32, 100, 256] {
            match self.passing(tracer, self.whole(), cells, wavelength_nm) {
                Ok(cut) => return Ok(cut),
                Err(why) => last = why,
            }
        }
        Err(last)
    }
}

/// Rays of one object point behind a lens, in the frame of the image plane. Through plates before the frame they land
/// elsewhere: as the frame moves back by z the plates move with it, so that a ray meets it at `x_mm + z * slope_x`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beam {
    /// Where each meets a frame at z = 0, mm.
    pub x_mm: Vec<f64>,
    /// Where each meets a frame at z = 0, mm.
    pub y_mm: Vec<f64>,
    /// dx/dz.
    pub slope_x: Vec<f64>,
    /// dy/dz.
    pub slope_y: Vec<f64>,
    /// Flux, any scale.
    pub weight: Vec<f64>,
}

/// Mean and spread of a beam.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    x: f64,
    y: f64,
    u: f64,
    v: f64,
    /// Variance of the places, mm^2.
    places: f64,
    /// Covariance of places and slopes, mm.
    mixed: f64,
    /// Variance of the slopes.
    slopes: f64,
}

impl Beam {
    /// Traces a grid of `cells` by `cells` over what passes of the light of an object point, for each wavelength (nm) with
    /// its weight. `None` where nothing passes, or no surface states a size.
    ///
    /// # Errors
    /// A medium has no usable index at a wavelength.
    pub fn of(
        lens: &Lens,
        point: ObjectPoint,
        light: &[(f64, f64)],
        cells: usize,
    ) -> Result<Option<Self>, DispersionError> {
        let limited = lens.largest_semi_diameter_mm().is_some();
        let Some(window) = Window::new(lens, point).filter(|_| limited) else { return Ok(None) };
        let mut beam = Self::default();
        for (wavelength_nm, weight) in light {
            let tracer = Tracer::new(lens, Indices::At(*wavelength_nm), Isa::detect())?;
            if let Ok(cut) = window.search(&tracer, *wavelength_nm) {
                let mut rays = RayBatch::new(cells * cells);
                let mut work = tracer.work(cells * cells);
                window.trace(&tracer, &mut rays, &mut work, &cut.places(cells).collect::<Vec<_>>(), *wavelength_nm);
                let area = (cut.max[0] - cut.min[0]) * (cut.max[1] - cut.min[1]);
                beam.take(&rays, weight * area, lens.cover.as_ref());
            }
        }
        Ok((!beam.weight.is_empty()).then_some(beam))
    }

    /// Adds the living rays of a batch in the frame of the image plane.
    fn take(&mut self, rays: &RayBatch, weight: f64, cover: Option<&CoverStack>) {
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

    /// Sum over rays of a function, weighed, over the sum of weights.
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

    /// RMS distance of the rays from their centroid on the plane `z_mm` behind the image plane, mm.
    #[must_use]
    pub fn rms_mm(&self, z_mm: f64) -> f64 {
        let m = self.moments();
        (m.places + z_mm * (2.0 * m.mixed + z_mm * m.slopes)).max(0.0).sqrt()
    }

    /// The plane on which that is smallest, mm behind the image plane; `None` for parallel rays.
    #[must_use]
    pub fn least_rms_z_mm(&self) -> Option<f64> {
        let m = self.moments();
        Some(-m.mixed / m.slopes).filter(|z| z.is_finite())
    }

    /// Contrast of a grating of `per_mm` line pairs a mm by geometrical optics, the mean of lines along x and along y, on
    /// the plane `z_mm` behind the image plane.
    #[must_use]
    pub fn contrast(&self, z_mm: f64, per_mm: f64) -> f64 {
        let [across, along] = self.contrasts(z_mm, per_mm);
        0.5 * (across + along)
    }

    /// Contrast in x (of lines along y) and in y.
    fn contrasts(&self, z_mm: f64, per_mm: f64) -> [f64; 2] {
        let isa = Isa::detect();
        let one = |places, slopes| isa.run(Grating { places, slopes, weights: &self.weight, z_mm, per_mm });
        [one(&self.x_mm, &self.slope_x), one(&self.y_mm, &self.slope_y)]
    }

    /// One ray of each `stride`.
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

    /// The plane on which that is largest, mm behind the image plane; `None` for parallel rays.
    #[must_use]
    pub fn best_contrast_z_mm(&self, per_mm: f64) -> Option<f64> {
        let mean = |[x, y]: [f64; 2]| 0.5 * (x + y);
        self.highest_contrast(per_mm, mean).map(|(z, _)| z)
    }

    /// The planes on which the lines along y and those along x have the most contrast, mm behind the image plane, where
    /// neither plane holds half of the other's contrast: no plane is sharp for both.
    pub(crate) fn sections_z_mm(&self, per_mm: f64) -> Option<[f64; 2]> {
        let best = [0, 1].map(|k| self.highest_contrast(per_mm, move |both| both[k]));
        let [(zx, cx), (zy, cy)] = [best[0]?, best[1]?];
        let lost = self.contrasts(zy, per_mm)[0] < 0.5 * cx && self.contrasts(zx, per_mm)[1] < 0.5 * cy;
        lost.then_some([zx, zy])
    }

    /// Where some mean of the contrasts in x and y is largest, and that mean.
    fn highest_contrast(&self, per_mm: f64, of: impl Fn([f64; 2]) -> f64) -> Option<(f64, f64)> {
        let m = self.moments();
        let offsets = (0..self.weight.len())
            .map(|i| [self.x_mm[i] - m.x, self.y_mm[i] - m.y, self.slope_x[i] - m.u, self.slope_y[i] - m.v]);
        let steepest2 = offsets.clone().map(|[.., u, v]| u * u + v * v).fold(0.0, f64::max);
        if !(steepest2 > 0.0) {
            return None;
        }
        // Rays cross the middle one between these planes, and somewhere there the light is most together.
        let crossings = offsets.filter(|[.., u, v]| u * u + v * v > STEEP2 * steepest2);
        let crossings = crossings.map(|[x, y, u, v]| -(x * u + y * v) / (u * u + v * v));
        // Odd, so that no column of the grid is left out.
        let stride = (self.weight.len() / SCANNED_RAYS) | 1;
        let few = self.thinned(stride);
        let coarse = |z: f64| of(few.contrasts(z, per_mm));
        let fine = |z: f64| of(self.contrasts(z, per_mm));
        highest(crossings, 1.0 / (per_mm * steepest2.sqrt()), coarse, fine)
    }
}

/// What lines leave of the contrast of a grating, in one direction across it.
struct Grating<'a> {
    places: &'a [f64],
    slopes: &'a [f64],
    weights: &'a [f64],
    z_mm: f64,
    per_mm: f64,
}

/// Rays whose sines are found together.
const TOGETHER: usize = 64;
/// Sums side by side: always the same order, whatever the width of vectors.
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

/// Squares of slopes over the largest: rays that are flatter do not say where they cross the middle one.
pub(crate) const STEEP2: f64 = 0.01;
/// About as many rays are looked at on every plane; the best planes are looked at with all.
const SCANNED_RAYS: usize = 2000;
/// Planes looked at.
const PLANES: std::ops::RangeInclusive<f64> = 40.0..=400.0;
/// Planes in the depth over which the steepest ray goes a period aside.
const PLANES_A_PERIOD: f64 = 8.0;
/// Peaks of the first look that are looked at with all rays.
const PEAKS: usize = 3;

/// Where contrast is highest, and how high it is: somewhere between the places where rays cross the middle one, give or
/// take half of the depth (mm) over which the steepest ray goes a period aside. Over depth it has many peaks: the planes
/// there are looked at one by one, then the best of them closely.
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

/// Where a function with one valley between `low` and `high` is least: the golden section (J. Kiefer, Proc. Amer. Math.
/// Soc. 4 (1953), 502).
pub(crate) fn golden_section(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const PART: f64 = 0.618_033_988_749_894_9;
    const GOLDEN_STEPS: usize = 28;
    let mut inner = [high - PART * (high - low), low + PART * (high - low)];
    let mut values = inner.map(&f);
    // A thousandth of a thousandth of what is looked at is left.
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
