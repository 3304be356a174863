//! The opening of a lens as seen from a point on film.

use crate::{Polygon, Wavefront};
use glam::{DVec2, DVec3};
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_core::params::Fault;
use spectra_lens::{Aperture, ApertureShape, Element};
use spectra_numerics::linear::least_squares;
use spectra_optics::{Bundle, Clipping, Optics};
use spectra_tracer::{Indices, Tracer, Travel};
use std::sync::Arc;

/// Number of pieces of each side of an opening, because sides are curved when seen from the film.
const PIECES: u32 = 6;
/// Number of rings of rays that measure how an opening is seen.
const RINGS: usize = 6;
/// Number of rays on each ring.
const SPOKES: usize = 24;
/// Radius of the outermost ring, as a multiple of the opening's.
const BEYOND: f64 = 1.2;
/// Number of corners of a rim that cuts the opening.
const CORNERS: usize = 192;
/// Halvings of the way to a rim, from the middle of what passes.
const HALVINGS: usize = 40;
/// Step by which the slopes at the middle of the stop are measured, in parts of the window's reach.
const SLOPE_STEP: f64 = 1e-5;
/// Radius of a stop without a size, as a multiple of the marginal ray's height there.
const ROOM: f64 = 1.3;
/// Number of rays across an opening that measure its wavefront.
const WAVE_RAYS: usize = 22;
/// Degree of the polynomial map from an opening to the directions in which it is seen.
const DEGREE: usize = 5;

/// Closed rings of corners, mm.
type Rings = Vec<Vec<[f64; 2]>>;

/// The opening of a lens, for computing how it looks from points of the film.
pub struct Pupil<'o> {
    optics: &'o Optics,
    /// Index of the element that shapes the light.
    stop: usize,
    /// Outline of the light that passes the stop, mm in its frame.
    rings: Rings,
    reach_mm: f64,
}

/// Rays from a point of the film over the opening and somewhat beyond it, the one through the middle of the stop first.
struct Rays<'o> {
    bundle: Bundle<'o>,
    /// Places of the rays in the window of the bundle, mm.
    places: Vec<[f64; 2]>,
    /// Direction cosines of the rays along two unit vectors.
    cosines: Vec<DVec2>,
    /// Where each meets the stop, mm in its frame.
    at_stop: Vec<Option<DVec2>>,
}

impl<'o> Pupil<'o> {
    /// Prepares the opening of a lens in its current setting.
    ///
    /// # Errors
    /// The diffraction at the stop cannot be computed; the fault says why.
    pub fn new(optics: &'o Optics) -> Result<Self, Fault> {
        let smallest = || {
            let sized =
                optics.elements.iter().enumerate().filter_map(|(at, e)| e.semi_diameter_mm.map(|size| (at, size)));
            sized.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
        };
        let stop = optics.stop().or_else(smallest).ok_or("the lens states no opening, so no edge diffracts light")?;
        let rings = match opening(&optics.elements[stop])? {
            Some(rings) => rings,
            // The rims alone limit the light. Start from more than the marginal ray leaves open; the rims cut it below.
            None => {
                let height = optics.marginal_ray().ok().and_then(|ray| ray.stop_height_mm);
                let open = circle(ROOM * height.ok_or("the stop states no size, so no edge diffracts light")?);
                open.rings(None, PIECES).unwrap_or_default()
            }
        };
        let reach_mm = rings.iter().flatten().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f64::max);
        Ok(Self { optics, stop, rings, reach_mm })
    }

    /// Returns the opening as seen from a point of the film, in direction cosines along the two unit vectors `axes`. The point
    /// (mm) and the vectors are in the frame of the image plane. `None` if no opening is visible from the point.
    #[must_use]
    pub fn seen_from(&self, point: DVec3, axes: [DVec3; 2]) -> Option<Polygon> {
        let rays = self.rays_from(point, axes)?;
        let (places, seen): (Vec<DVec2>, Vec<DVec2>) =
            rays.at_stop.iter().zip(&rays.cosines).filter_map(|(p, c)| Some(((*p)? / self.reach_mm, *c))).unzip();
        let map = Map::fitted(&places, &seen)?;
        let mut rings = self.rings.clone();
        rings.iter_mut().flatten().for_each(|p| *p = map.at(DVec2::from(*p) / self.reach_mm).into());
        let turned = |mut rings: Rings| {
            rings.iter_mut().for_each(|ring| ring.reverse());
            rings
        };
        let opening = Polygon::new(rings.clone()).or_else(|| Polygon::new(turned(rings)))?;
        self.cut_by_rims(opening, &rays)
    }

    /// Returns rays from a point of the film over the opening. `None` if none goes through the middle of the stop.
    fn rays_from(&self, point: DVec3, axes: [DVec3; 2]) -> Option<Rays<'o>> {
        let indices = Indices::At(self.optics.reference_nm);
        let bundle = Bundle::behind(self.optics, point, indices).ok()??.clipped(Clipping::None).ok()?;
        let [a, b] = bundle.through(self.stop, DVec2::ZERO, [0.0; 2])?;
        let step = SLOPE_STEP * bundle.reach_mm();
        let met = bundle.meet(self.stop, &[[a - step, b], [a + step, b], [a, b - step], [a, b + step]]);
        let (sx, sy) = ((met[1]? - met[0]?) / (2.0 * step), (met[3]? - met[2]?) / (2.0 * step));
        let det = sx.perp_dot(sy);
        if det == 0.0 {
            return None;
        }
        let place = |v: DVec2| {
            let by = DVec2::new(v.perp_dot(sy), sx.perp_dot(v)) / det;
            [a + by.x, b + by.y]
        };
        let on_rings = (0..RINGS * SPOKES).map(|i| {
            let (sin, cos) = sin_cos_turns((i % SPOKES) as f64 / SPOKES as f64);
            DVec2::new(cos, sin) * (BEYOND * self.reach_mm * ((i / SPOKES) as f64 + 1.0) / RINGS as f64)
        });
        let places: Vec<[f64; 2]> = std::iter::once(DVec2::ZERO).chain(on_rings).map(place).collect();
        let directions = places.iter().map(|place| bundle.ray(*place).1);
        let cosines = directions.map(|d| DVec2::new(d.dot(axes[0]), d.dot(axes[1]))).collect();
        let at_stop = bundle.meet(self.stop, &places);
        Some(Rays { bundle, places, cosines, at_stop })
    }

    /// Cuts an opening in direction cosines by the rims of the other elements. `None` if they leave nothing.
    fn cut_by_rims(&self, mut opening: Polygon, rays: &Rays<'_>) -> Option<Polygon> {
        let scale = opening.reach();
        let middle = rays.cosines[0];
        let near: Vec<DVec2> = rays.cosines.iter().map(|p| (*p - middle) / scale).collect();
        let within = |p: &Option<DVec2>, radius: f64| p.is_some_and(|p| p.length() <= radius);
        let mut passes: Vec<bool> = rays.at_stop.iter().map(|p| within(p, self.reach_mm)).collect();
        let mut cuts = Vec::new();
        for (number, e) in self.optics.elements.iter().enumerate().filter(|(number, _)| *number != self.stop) {
            let Some(radius) = rim(e) else { continue };
            let met = rays.bundle.meet(number, &rays.places);
            let cut = |(stop, met): (&Option<DVec2>, &Option<DVec2>)| {
                within(stop, BEYOND * self.reach_mm) && !within(met, radius)
            };
            if !rays.at_stop.iter().zip(&met).any(cut) {
                continue;
            }
            passes.iter_mut().zip(&met).for_each(|(passes, met)| *passes &= within(met, radius));
            let lit = met.iter().zip(&near).filter_map(|(met, near)| Some((*near, (*met)? / radius)));
            let (from, to): (Vec<DVec2>, Vec<DVec2>) = lit.unzip();
            cuts.push(Map::fitted(&from, &to)?);
        }
        if cuts.is_empty() {
            return Some(opening);
        }
        let inside: Vec<DVec2> = near.iter().zip(&passes).filter(|(_, passes)| **passes).map(|(p, _)| *p).collect();
        if inside.is_empty() {
            return None;
        }
        let heart = inside.iter().sum::<DVec2>() / inside.len() as f64;
        // The maps are only valid where rays were traced.
        let end = near.iter().map(|p| p.length()).fold(0.0, f64::max).min(2.0 * BEYOND);
        for cut in &cuts {
            let corner = |i: usize| -> Option<[f64; 2]> {
                let (sin, cos) = sin_cos_turns(i as f64 / CORNERS as f64);
                let way = DVec2::new(cos, sin);
                let (mut low, mut high) = (0.0, reach_along(heart, way, end));
                if cut.at(heart + way * high).length() <= 1.0 {
                    return None;
                }
                for _ in 0..HALVINGS {
                    let half = 0.5 * (low + high);
                    *(if cut.at(heart + way * half).length() <= 1.0 { &mut low } else { &mut high }) = half;
                }
                Some((middle + (heart + way * low) * scale).into())
            };
            // Where the rim does not cross the opening there is nothing to cut.
            let corners: Vec<Option<[f64; 2]>> = (0..CORNERS).map(corner).collect();
            let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
            let lines: Vec<[[f64; 2]; 2]> = pairs.filter_map(|(a, b)| Some([(*a)?, (*b)?])).collect();
            opening = opening.left_of(&lines)?;
        }
        Some(opening)
    }
}

/// The wavefronts of a lens at one wavelength, for points at its focus distance.
pub struct Wavefronts<'a> {
    optics: &'a Optics,
    tracer: Arc<Tracer>,
    nm: f64,
}

impl<'a> Wavefronts<'a> {
    /// Prepares a lens at the wavelength `nm`; `None` if the index of a glass is not defined there.
    #[must_use]
    pub fn new(optics: &'a Optics, nm: f64) -> Option<Self> {
        Some(Self { optics, tracer: optics.tracer_clipping(Indices::At(nm), Clipping::None).ok()?, nm })
    }

    /// Returns the wavefront of the light that reaches a point of the film through `opening`, which is in direction cosines along
    /// the two unit vectors `axes`. The point (mm) and the vectors are in the frame of the image plane. `None` if too few rays
    /// pass.
    #[must_use]
    pub fn seen_from(&self, point: DVec3, axes: [DVec3; 2], opening: &Polygon) -> Option<Wavefront> {
        let normal = axes[0].cross(axes[1]);
        // Vector toward the lens.
        let rear = self.optics.image_pose.local_point(self.optics.elements.last()?.pose.origin_mm) - point;
        let along = |u: f64, v: f64| {
            let up = (1.0 - u * u - v * v).max(0.0).sqrt();
            let aside = axes[0] * u + axes[1] * v;
            [aside + normal * up, aside - normal * up].into_iter().max_by(|a, b| a.dot(rear).total_cmp(&b.dot(rear)))
        };
        let [low, high] = opening.bounds();
        let middle = |k: usize, n: usize, cells: usize| low[k] + (n as f64 + 0.5) / cells as f64 * (high[k] - low[k]);
        let mut cosines = vec![opening.center()];
        for row in 0..WAVE_RAYS {
            let v = middle(1, row, WAVE_RAYS);
            for [from, to] in opening.spans(v) {
                let columns = (0..WAVE_RAYS).map(|n| middle(0, n, WAVE_RAYS));
                cosines.extend(columns.filter(|u| from <= *u && *u <= to).map(|u| [u, v]));
            }
        }
        let mut rays = RayBatch::with_optical_path(cosines.len());
        rays.restart(cosines.len());
        let c = rays.columns_mut();
        for (i, [u, v]) in cosines.iter().enumerate() {
            (c.x[i], c.y[i], c.z[i]) = point.into();
            (c.l[i], c.m[i], c.n[i]) = along(*u, *v)?.into();
            c.wavelength_nm[i] = self.nm;
        }
        self.tracer.trace(&mut rays, &mut self.tracer.work(cosines.len()), Travel::Backward);
        let [at, way] = [rays.positions(), rays.directions()];
        let (at, way) =
            (|i: usize| DVec3::from_array(at.map(|c| c[i])), |i: usize| DVec3::from_array(way.map(|c| c[i])));
        let states = rays.states();
        if states[0] != ALIVE {
            return None;
        }
        // The ray from the middle of the opening gives the point that is seen there.
        let (from, toward) = (at(0), way(0));
        let distance = self.optics.focused_mm;
        let seen = from + toward * ((-distance - from.z) / toward.z);
        let paths = rays.optical_path_mm()?;
        let rest = |i: usize| {
            let (p, d) = (at(i), way(i));
            // Distance to where the ray comes nearest to that point; for an infinite distance, to a plane perpendicular to the middle ray.
            if distance.is_finite() { d.dot(seen - p) } else { (from - p).dot(toward) / d.dot(toward) }
        };
        let (places, mm): (Vec<_>, Vec<_>) = (0..cosines.len())
            .filter(|i| states[*i] == ALIVE)
            .map(|i| (cosines[i], paths[i] + rest(i)))
            .filter(|(_, mm)| mm.is_finite())
            .unzip();
        Wavefront::fitted(&places, &mm)
    }
}

/// Returns the distance from a place in a disk about the origin to its edge, along a direction.
fn reach_along(from: DVec2, way: DVec2, radius: f64) -> f64 {
    let along = from.dot(way);
    -along + (along * along + (radius * radius - from.length_squared()).max(0.0)).sqrt()
}

/// Returns the radius of the clear aperture of an element about its vertex, if it is round.
fn rim(e: &Element) -> Option<f64> {
    let round = e.apertures.iter().filter(|a| a.center_mm == [0.0; 2] && !a.obscures).filter_map(|a| match a.shape {
        ApertureShape::Ring { outer_mm, .. } => Some(outer_mm),
        _ => None,
    });
    round.chain(e.semi_diameter_mm).reduce(f64::min).filter(|r| r.is_finite())
}

/// Returns the outline of the light that passes the stop, as rings; `None` if the stop states no size.
fn opening(e: &Element) -> Result<Option<Rings>, Fault> {
    let unknown = || {
        Fault::new("diffraction by a picture used as a mask, or a drawing with gray or crossing outlines, is not known")
    };
    let holes: Vec<&Aperture> = e.apertures.iter().filter(|a| a.obscures).collect();
    let mut outer = e.apertures.iter().filter(|a| !a.obscures);
    let own = outer.next().cloned().or_else(|| e.semi_diameter_mm.map(circle));
    let Some(own) = own else { return Ok(None) };
    let mut rings = own.rings(e.semi_diameter_mm, PIECES).ok_or_else(unknown)?;
    for other in outer {
        // Two openings in one plane: take the part inside both, where the second is convex.
        let all = other.rings(e.semi_diameter_mm, PIECES).ok_or_else(unknown)?;
        let [convex] = &all[..] else { return Err(unknown()) };
        let both = Polygon::new(rings).and_then(|first| first.within(convex)).ok_or("the stop lets nothing pass")?;
        let [cx, cy] = both.center();
        rings = both.rings().iter().map(|r| r.iter().map(|[x, y]| [x + cx, y + cy]).collect()).collect();
    }
    for hole in holes {
        rings.extend(hole.rings(e.semi_diameter_mm, PIECES).ok_or_else(unknown)?);
    }
    Ok(Some(rings))
}

fn circle(radius_mm: f64) -> Aperture {
    Aperture { shape: ApertureShape::Ring { inner_mm: 0.0, outer_mm: radius_mm }, center_mm: [0.0; 2], obscures: false }
}

/// A polynomial map of the plane.
struct Map {
    by: [Vec<f64>; 2],
}

/// Returns the terms of the polynomial at a point.
fn terms(p: DVec2) -> Vec<f64> {
    let mut terms = Vec::with_capacity((DEGREE + 1) * (DEGREE + 2) / 2);
    for degree in 0..DEGREE + 1 {
        for k in 0..degree + 1 {
            let power = |v: f64, n: usize| (0..n).fold(1.0, |product, _| product * v);
            terms.push(power(p.x, degree - k) * power(p.y, k));
        }
    }
    terms
}

impl Map {
    fn fitted(from: &[DVec2], to: &[DVec2]) -> Option<Self> {
        let rows: Vec<f64> = from.iter().flat_map(|p| terms(*p)).collect();
        let columns = (DEGREE + 1) * (DEGREE + 2) / 2;
        let solved = |values: Vec<f64>| least_squares(&rows, &values, columns);
        let x = solved(to.iter().map(|p| p.x).collect())?;
        Some(Self { by: [x, solved(to.iter().map(|p| p.y).collect())?] })
    }

    fn at(&self, p: DVec2) -> DVec2 {
        let terms = terms(p);
        let sum = |by: &[f64]| by.iter().zip(&terms).map(|(a, b)| a * b).sum();
        DVec2::new(sum(&self.by[0]), sum(&self.by[1]))
    }
}
