//! The opening of a lens as a place on film sees it.

use crate::{Polygon, Wave};
use glam::{DVec2, DVec3};
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_core::{Isa, RayBatch};
use spectra_lens::{Aperture, Element, Indices, Lens, Path, Route, Shape, Tracer, Travel};
use spectra_numerics::linear::least_squares;

/// Pieces of the sides of an opening: they bend on their way to the film.
const PIECES: u32 = 6;
/// Rings of rays, and rays on each, by which it is found how an opening is seen; and how far beyond its rim they go.
const RINGS: usize = 6;
const SPOKES: usize = 24;
const BEYOND: f64 = 1.2;
/// Corners of a rim that cuts the opening.
const CORNERS: usize = 192;
/// Steps toward the middle of the stop.
const STEPS: usize = 40;
/// How much larger than its marginal ray a stop without a size is taken.
const ROOM: f64 = 1.3;
/// Rays across an opening that find its wavefront.
const WAVE_RAYS: usize = 22;
/// Degree of the map from an opening to the directions in which it is seen.
const DEGREE: usize = 5;

/// Closed rings, mm.
type Rings = Vec<Vec<[f64; 2]>>;

/// The openings of a lens, to be seen from the film.
pub struct Pupil {
    lens: Lens,
    tracer: Tracer,
    /// The element that shapes the light, and the way to it from the film.
    stop: usize,
    routes: Vec<Route>,
    /// What passes the stop, mm in its frame.
    rings: Vec<Vec<[f64; 2]>>,
    reach_mm: f64,
}

impl Pupil {
    /// Of a lens as it is set.
    ///
    /// # Errors
    /// Why what its stop does to light is not known.
    pub fn new(lens: &Lens) -> Result<Self, String> {
        let smallest = || {
            let sized =
                lens.elements.iter().enumerate().filter_map(|(at, e)| e.semi_diameter_mm.map(|size| (at, size)));
            sized.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
        };
        let stop = lens.stop().or_else(smallest).ok_or("the lens states no opening, so no edge bends light")?;
        let rings = match opening(&lens.elements[stop])? {
            Some(rings) => rings,
            // Rims stop the light alone: what they cut is all that their marginal ray leaves open, and more.
            None => {
                let height = lens.marginal_ray().ok().and_then(|ray| ray.stop_height_mm);
                let open = circle(ROOM * height.ok_or("the stop states no size, so no edge bends light")?);
                open.rings(None, PIECES).unwrap_or_default()
            }
        };
        let reach_mm = rings.iter().flatten().map(|[x, y]| (x * x + y * y).sqrt()).fold(0.0, f64::max);
        let tracer = without_rims(lens, lens.reference_nm)?;
        let count = lens.elements.len();
        let route = |at: usize| tracer.route(&Path::through(count, Travel::Backward).up_to(|k| k == at));
        let routes = (0..count).map(route).collect();
        Ok(Self { lens: lens.clone(), tracer, stop, routes, rings, reach_mm })
    }

    /// Where rays from a point of the film (mm, frame of the image plane) in some directions meet an element, in its frame.
    fn met(&self, at: usize, point: DVec3, directions: &[DVec3]) -> Vec<Option<DVec2>> {
        let mut rays = RayBatch::new(directions.len());
        rays.restart(directions.len());
        let c = rays.columns_mut();
        for (i, direction) in directions.iter().enumerate() {
            (c.x[i], c.y[i], c.z[i]) = point.into();
            (c.l[i], c.m[i], c.n[i]) = (*direction).into();
            c.wavelength_nm[i] = self.lens.reference_nm;
        }
        self.tracer.follow(&self.routes[at], &mut rays, &mut self.tracer.work_in_place(directions.len()));
        let [x, y, z] = rays.positions();
        let local = |i: usize| self.lens.elements[at].pose.local_point(DVec3::new(x[i], y[i], z[i])).truncate();
        let states = rays.states();
        (0..directions.len()).map(|i| (states[i] == ALIVE).then(|| local(i)).filter(|p| p.is_finite())).collect()
    }

    /// The opening in direction cosines along two unit vectors, as a point of the film sees it: mm and vectors in the frame of the image
    /// plane. `None` where it sees none.
    #[must_use]
    pub fn seen_from(&self, point: DVec3, axes: [DVec3; 2]) -> Option<Polygon> {
        let rear = self.lens.elements.last()?.pose.origin_mm;
        let toward = (self.lens.image_pose.local_point(rear) - point).try_normalize()?;
        let e1 = (axes[0] - axes[0].dot(toward) * toward).try_normalize()?;
        let e2 = toward.cross(e1);
        let direction = |a: DVec2| (toward + a.x * e1 + a.y * e2).normalize();
        // The ray through the middle of the stop, by Newton's method.
        let mut at = DVec2::ZERO;
        let step = 1e-5;
        let look = |at: DVec2| -> Option<(DVec2, [DVec2; 2])> {
            let rays = [at, at + DVec2::X * step, at + DVec2::Y * step].map(direction);
            let met = self.met(self.stop, point, &rays);
            let (p, px, py) = (met[0]?, met[1]?, met[2]?);
            Some((p, [(px - p) / step, (py - p) / step]))
        };
        let (mut off, mut slopes) = look(at)?;
        let solve = |[sx, sy]: [DVec2; 2], v: DVec2| {
            let det = sx.perp_dot(sy);
            (det != 0.0).then(|| DVec2::new(v.perp_dot(sy), sx.perp_dot(v)) / det)
        };
        let mut part = 1.0;
        for _ in 0..STEPS {
            if off.length() < 1e-9 * self.reach_mm {
                break;
            }
            let next = at - solve(slopes, off)? * part;
            match look(next).filter(|(p, _)| p.length() < off.length()) {
                Some((p, s)) => (at, off, slopes, part) = (next, p, s, 1.0),
                None => part *= 0.5,
            }
        }
        if off.length() > 1e-3 * self.reach_mm {
            return None;
        }
        let directions: Vec<DVec3> = std::iter::once((0.0, 0.0))
            .chain((0..RINGS * SPOKES).map(|i| {
                let (sin, cos) = sin_cos_turns((i % SPOKES) as f64 / SPOKES as f64);
                let r = BEYOND * self.reach_mm * ((i / SPOKES) as f64 + 1.0) / RINGS as f64;
                (r * cos, r * sin)
            }))
            .map(|(x, y)| solve(slopes, DVec2::new(x, y)).map(|a| direction(at + a)))
            .collect::<Option<_>>()?;
        let cosines: Vec<DVec2> = directions.iter().map(|d| DVec2::new(d.dot(axes[0]), d.dot(axes[1]))).collect();
        let at_stop = self.met(self.stop, point, &directions);
        let known: Vec<usize> = (0..directions.len()).filter(|i| at_stop[*i].is_some()).collect();
        let places: Vec<DVec2> = known.iter().filter_map(|i| at_stop[*i].map(|p| p / self.reach_mm)).collect();
        let seen: Vec<DVec2> = known.iter().map(|i| cosines[*i]).collect();
        let map = Map::fitted(&places, &seen)?;
        let mut rings: Vec<Vec<[f64; 2]>> = self.rings.clone();
        rings.iter_mut().flatten().for_each(|p| *p = map.at(DVec2::from(*p) / self.reach_mm).into());
        let turned = |mut rings: Vec<Vec<[f64; 2]>>| {
            rings.iter_mut().for_each(|ring| ring.reverse());
            rings
        };
        let mut opening = Polygon::new(rings.clone()).or_else(|| Polygon::new(turned(rings)))?;
        // Rims, as far as they cut it.
        let scale = opening.reach();
        let middle = cosines[0];
        let near: Vec<DVec2> = cosines.iter().map(|p| (*p - middle) / scale).collect();
        let mut passes: Vec<bool> = at_stop.iter().map(|p| p.is_some_and(|p| p.length() <= self.reach_mm)).collect();
        let mut cuts = Vec::new();
        for (number, e) in self.lens.elements.iter().enumerate().filter(|(number, _)| *number != self.stop) {
            let Some(radius) = rim(e) else { continue };
            let met = self.met(number, point, &directions);
            let outside = |p: &Option<DVec2>| p.is_none_or(|p| p.length() > radius);
            let cuts_it = passes
                .iter()
                .zip(&at_stop)
                .zip(&met)
                .any(|((_, stop), met)| stop.is_some_and(|p| p.length() <= 1.2 * self.reach_mm) && outside(met));
            if !cuts_it {
                continue;
            }
            passes.iter_mut().zip(&met).for_each(|(passes, met)| *passes &= !outside(met));
            let lit: Vec<usize> = (0..met.len()).filter(|i| met[*i].is_some()).collect();
            let from: Vec<DVec2> = lit.iter().map(|i| near[*i]).collect();
            let to: Vec<DVec2> = lit.iter().filter_map(|i| met[*i].map(|p| p / radius)).collect();
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
        let farthest = 2.0 * BEYOND;
        for cut in &cuts {
            let end = near.iter().map(|p| p.length()).fold(0.0, f64::max).min(farthest);
            let corner = |i: usize| -> Option<[f64; 2]> {
                let (sin, cos) = sin_cos_turns(i as f64 / CORNERS as f64);
                let way = DVec2::new(cos, sin);
                // Within what was looked at, as the map knows nothing beyond.
                let (mut low, mut high) = (0.0, reach_along(heart, way, end));
                if cut.at(heart + way * high).length() <= 1.0 {
                    return None;
                }
                for _ in 0..40 {
                    let half = 0.5 * (low + high);
                    *(if cut.at(heart + way * half).length() <= 1.0 { &mut low } else { &mut high }) = half;
                }
                Some((middle + (heart + way * low) * scale).into())
            };
            // Where the rim does not come by there is nothing to cut.
            let corners: Vec<Option<[f64; 2]>> = (0..CORNERS).map(corner).collect();
            let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
            let lines: Vec<[[f64; 2]; 2]> = pairs.filter_map(|(a, b)| Some([(*a)?, (*b)?])).collect();
            opening = opening.left_of(&lines)?;
        }
        Some(opening)
    }
}

fn without_rims(lens: &Lens, nm: f64) -> Result<Tracer, String> {
    let mut open = lens.clone();
    for e in &mut open.elements {
        e.semi_diameter_mm = None;
        e.apertures.clear();
    }
    Tracer::new(&open, Indices::At(nm), Isa::detect()).map_err(|e| e.to_string())
}

/// The wavefronts of a lens at one wavelength, of points at the distance that it is focused at.
pub struct Waves<'a> {
    lens: &'a Lens,
    tracer: Tracer,
    nm: f64,
}

impl<'a> Waves<'a> {
    /// At a wavelength, nm, that its glasses know.
    #[must_use]
    pub fn new(lens: &'a Lens, nm: f64) -> Option<Self> {
        Some(Self { lens, tracer: without_rims(lens, nm).ok()?, nm })
    }

    /// The wavefront of the light that comes to a point of the film through an opening in direction cosines along two unit vectors: mm
    /// and vectors in the frame of the image plane. `None` where too few rays come through.
    #[must_use]
    pub fn seen_from(&self, point: DVec3, axes: [DVec3; 2], opening: &Polygon) -> Option<Wave> {
        let normal = axes[0].cross(axes[1]);
        // Toward the lens.
        let rear = self.lens.image_pose.local_point(self.lens.elements.last()?.pose.origin_mm) - point;
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
        // The ray from the middle of the opening says where the point is that is seen there.
        let (from, toward) = (at(0), way(0));
        let distance = self.lens.focused_mm;
        let seen = from + toward * ((-distance - from.z) / toward.z);
        let paths = rays.optical_path_mm()?;
        let rest = |i: usize| {
            let (p, d) = (at(i), way(i));
            // To where the ray comes nearest to that point; of an infinite distance, to a plane across the middle ray.
            if distance.is_finite() { d.dot(seen - p) } else { (from - p).dot(toward) / d.dot(toward) }
        };
        let (places, mm): (Vec<_>, Vec<_>) = (0..cosines.len())
            .filter(|i| states[*i] == ALIVE)
            .map(|i| (cosines[i], paths[i] + rest(i)))
            .filter(|(_, mm)| mm.is_finite())
            .unzip();
        Wave::fitted(&places, &mm)
    }
}

/// How far it is from a place in a disk about the origin to its edge.
fn reach_along(from: DVec2, way: DVec2, radius: f64) -> f64 {
    let along = from.dot(way);
    -along + (along * along + (radius * radius - from.length_squared()).max(0.0)).sqrt()
}

/// Radius of what an element lets pass about its vertex, where it is round.
fn rim(e: &Element) -> Option<f64> {
    let round = e.apertures.iter().filter(|a| a.center_mm == [0.0; 2] && !a.obscures).filter_map(|a| match a.shape {
        Shape::Ring { outer_mm, .. } => Some(outer_mm),
        _ => None,
    });
    round.chain(e.semi_diameter_mm).reduce(f64::min).filter(|r| r.is_finite())
}

/// What passes the stop, as rings.
fn opening(e: &Element) -> Result<Option<Rings>, String> {
    let unknown = || {
        "what a picture as a mask, or a drawing with gray or crossing outlines, does to light is not known".to_owned()
    };
    let holes: Vec<&Aperture> = e.apertures.iter().filter(|a| a.obscures).collect();
    let mut outer = e.apertures.iter().filter(|a| !a.obscures);
    let own = outer.next().cloned().or_else(|| e.semi_diameter_mm.map(circle));
    let Some(own) = own else { return Ok(None) };
    let mut rings = own.rings(e.semi_diameter_mm, PIECES).ok_or_else(unknown)?;
    for other in outer {
        // Two openings in one plane: what is inside of both, where the second is convex.
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
    Aperture { shape: Shape::Ring { inner_mm: 0.0, outer_mm: radius_mm }, center_mm: [0.0; 2], obscures: false }
}

/// A polynomial map of the plane.
struct Map {
    by: [Vec<f64>; 2],
}

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
