//! Regions: the shape that contains all light of a zone, and the part of it that passes in each sector of the azimuth.

use super::lattice::{Lattice, ZonePlace};
use super::measure::turns;
use super::probe::{Bounds, Plane};
use super::region_shape::RegionShape;
use super::shaped_opening::{OpeningMap, ShapedOpening};
use super::star_region::{DIRECTIONS, StarRegion};
use super::table::{Drift, Zone};
use glam::DVec3;
use spectra_core::math::sin_cos_turns;
use std::borrow::Cow;

/// Relative margin around the edges seen from the ends of a zone.
const MARGIN: f64 = 0.0006;

/// Computes the motion of the center between two sums of `count` bounds (center along and across, half of each), mm.
fn shift(from: &[f64; 4], to: &[f64; 4], count: f64) -> [f64; 2] {
    [0, 1].map(|i| (to[i] - from[i]) / count)
}

/// Computes the growth of the size between two sums of bounds, as a fraction of their mean.
fn growth(from: &[f64; 4], to: &[f64; 4]) -> f64 {
    let [from, to] = [from, to].map(|sums| sums[2] + sums[3]);
    (2.0 * (to - from) / (to + from)).clamp(-0.4, 0.4)
}

/// Returns the ends of the azimuth of a zone, turns, in a table that has zones of the azimuth.
pub(super) fn turns_of(at: &ZonePlace) -> (f64, f64) {
    let end = |k: usize| if k == at.azimuths { 1.0 } else { turns(k as f64 / at.azimuths as f64) };
    (end(at.azimuth), end(at.azimuth + 1))
}

/// An interval of the azimuth, turns.
pub(super) struct Sector {
    pub from: f64,
    pub to: f64,
    /// Whether points are given along x and y of the lens; otherwise along and across the plane of the point.
    pub turned: bool,
    /// Whether an opening that is not round is seen in this sector.
    pub opening: bool,
}

impl Sector {
    /// Returns the azimuth at a fraction of the sector, turns.
    pub fn at(&self, part: f64) -> f64 {
        (self.from + part * (self.to - self.from)).min(1.0)
    }

    /// Converts a point of the sector to coordinates along and across the plane of the source point.
    pub fn local(&self, [x, y]: [f64; 2], turns: f64) -> [f64; 2] {
        if !self.turned {
            return [x, y];
        }
        let (sin, cos) = sin_cos_turns(turns);
        [x * cos + y * sin, y * cos - x * sin]
    }

    /// Converts coordinates along and across the plane of the source point to a point of the sector.
    fn place(&self, place: [f64; 2], turns: f64) -> [f64; 2] {
        if self.turned { turned(place, turns) } else { place }
    }
}

/// An opening and its views. For a round lens both are `None`; the views alone are `None` if they are not known.
pub(super) type OptionalOpening<'a> = (Option<&'a ShapedOpening>, Option<&'a [Vec<Option<OpeningMap>>]>);
/// An opening together with its views.
pub(super) type OpeningWithViews<'a> = (&'a ShapedOpening, &'a [Vec<Option<OpeningMap>>]);

/// The ellipse or rectangle of a zone, on the plane of the zone.
pub(super) struct Region {
    pub plane: Plane,
    pub shape: RegionShape,
    /// Whether light fades out within the zone.
    pub fades: bool,
    /// Change of the passing light over the angle of the zone.
    pub drift: Drift,
    /// Change of the passing light over each wavelength zone.
    pub by_band: Vec<BandDrift>,
}

/// The change of the passing light from the lower to the upper ends of a wavelength zone and of its depths.
#[derive(Clone, Copy, Default)]
pub(super) struct BandDrift {
    /// Shift along and across, mm: with the wavelength, then with the depth.
    shift: [[f64; 2]; 2],
    /// Growth with the wavelength and with the depth, as fractions of the size in the middle.
    growth: [f64; 2],
}

impl BandDrift {
    fn is_finite(&self) -> bool {
        self.shift.iter().flatten().chain(&self.growth).all(|v| v.is_finite())
    }

    /// Returns the values in the layout of an outline.
    pub fn columns(&self) -> [[f32; 2]; 3] {
        let [color, depth] = self.shift;
        [color, depth, self.growth].map(|pair| pair.map(|v| v as f32))
    }

    /// Returns the shift and the relative size at these fractions of the wavelength and of the depth, each -0.5 to 0.5.
    fn at(&self, color: f64, depth: f64) -> ([f64; 2], f64) {
        let [by_color, by_depth] = self.shift;
        let moved = std::array::from_fn(|i| color * by_color[i] + depth * by_depth[i]);
        (moved, 1.0 + color * self.growth[0] + depth * self.growth[1])
    }
}

impl Region {
    pub fn zone(&self, eye_z_mm: f64) -> Zone {
        let center = self.plane.at(self.shape.center) - DVec3::new(0.0, 0.0, eye_z_mm);
        let along = self.plane.along * self.shape.half[0];
        Zone {
            center: center.into(),
            half_along: [along.x, along.z],
            half_across: self.shape.half[1],
            ellipse: self.shape.ellipse,
            drift: self.drift,
        }
    }

    /// Computes the mean change of the passing light from the lower to the upper ends of the zone. It follows the edges of what passes the
    /// rims, or the opening as seen if one is given.
    pub fn drifts(
        &self,
        lattice: &Lattice,
        at: &ZonePlace,
        bands: usize,
        opening: Option<OpeningWithViews<'_>>,
    ) -> (Drift, Vec<BandDrift>) {
        let known = || {
            let ends = lattice.ends(at)?;
            let depths = ends.len() / lattice.ends_a_depth();
            let colors = ends.first()?.1.edges.len();
            // Center along and across, and half of each: by end of the angle, by end of the depth, by wavelength.
            let mut by_angle = [[0.0; 4]; 2];
            let mut by_depth = [[0.0; 4]; 2];
            let mut by_color = vec![[0.0; 4]; colors];
            for (k, (_, node)) in ends.iter().enumerate() {
                let lines: Option<Vec<Cow<'_, [DVec3]>>> = match opening {
                    None => Some(node.edges.iter().map(|line| line[..].into()).collect()),
                    Some((opening, views)) => {
                        views[k].iter().map(|seen| Some(opening.around(seen.as_ref()?).into())).collect()
                    }
                };
                for (line, of_color) in lines?.iter().zip(&mut by_color) {
                    let places: Option<Vec<[f64; 2]>> =
                        line.iter().map(|p| self.plane.project(node.point, *p).map(|(place, _)| place)).collect();
                    let bounds = Bounds::around(&places?)?;
                    let ([a, c], [b, d]) = (bounds.center(), bounds.half());
                    for sums in [&mut by_angle[k % 2], &mut by_depth[k / lattice.ends_a_depth()], of_color] {
                        sums.iter_mut().zip([a, c, b, d]).for_each(|(sum, value)| *sum += value);
                    }
                }
            }
            let ends = ends.len() as f64;
            let half = 0.5 * ends * colors as f64;
            let [low, high] = by_angle;
            let drift = Drift {
                shift: shift(&low, &high, half),
                growth: [2, 3].map(|i| (2.0 * (high[i] - low[i]) / (high[i] + low[i])).clamp(-0.8, 0.8)),
            };
            let [near, far] = by_depth;
            let of_depth =
                if depths > 1 { (shift(&near, &far, half), growth(&near, &far)) } else { Default::default() };
            let of_band = |band: usize| {
                let (from, to) = (by_color[band], by_color[(band + 1).min(colors - 1)]);
                let of_color = (shift(&from, &to, ends), growth(&from, &to));
                BandDrift { shift: [of_color.0, of_depth.0], growth: [of_color.1, of_depth.1] }
            };
            let by_band: Vec<BandDrift> = (0..bands).map(of_band).collect();
            let is_finite = drift.shift.iter().chain(&drift.growth).all(|v| v.is_finite());
            (is_finite && by_band.iter().all(BandDrift::is_finite)).then_some((drift, by_band))
        };
        let still = (Drift::default(), vec![BandDrift::default(); bands]);
        if self.fades { still } else { known().unwrap_or(still) }
    }

    /// Converts a point at these fractions of the angle, wavelength and depth (each -0.5 to 0.5) to the middle of the zone.
    fn still(&self, place: [f64; 2], band: usize, [angle, color, depth]: [f64; 3]) -> [f64; 2] {
        let (moved, size) = self.by_band[band].at(color, depth);
        self.drift.still(std::array::from_fn(|i| place[i] - moved[i]), angle).map(|p| p / size)
    }

    /// Converts a point in the middle of the zone to these fractions of the angle, wavelength and depth: the inverse of [`Region::still`].
    pub fn moved(&self, place: [f64; 2], band: usize, [angle, color, depth]: [f64; 3]) -> [f64; 2] {
        let (moved, size) = self.by_band[band].at(color, depth);
        let place = self.drift.moved(place.map(|p| p * size), angle);
        std::array::from_fn(|i| place[i] + moved[i])
    }

    /// Returns the reach of the passing light in each of these consecutive sectors of the zone, by wavelength. If it is not known, the
    /// whole shape is returned.
    pub fn reaches(
        &self,
        lattice: &Lattice,
        at: &ZonePlace,
        sectors: &[Sector],
        seen: OptionalOpening<'_>,
        bands: usize,
    ) -> Vec<Vec<StarRegion>> {
        let known = if self.fades {
            None
        } else if let (Some(opening), Some(views)) = seen {
            self.by_openings(lattice, at, sectors, (opening, views), bands)
        } else if seen.0.is_some() {
            None
        } else {
            self.by_edges(lattice, at, sectors, bands)
        };
        let known = known.unwrap_or_else(|| vec![None; sectors.len()]);
        let whole = |sector: &Sector| (0..bands).map(|band| self.whole(sector, band)).collect();
        sectors.iter().zip(known).map(|(sector, known)| known.unwrap_or_else(|| whole(sector))).collect()
    }

    /// Returns the ellipse or rectangle itself as a reach.
    fn whole(&self, sector: &Sector, band: usize) -> StarRegion {
        let mut reach = StarRegion::EMPTY;
        // The reach must contain the shape wherever the drift moves it.
        let Drift { shift, growth } = self.drift;
        let BandDrift { shift: [by_color, by_depth], growth: [of_color, of_depth] } = self.by_band[band];
        let smallest = 1.0 - 0.5 * (of_color.abs() + of_depth.abs());
        let [a, b] = [0, 1].map(|i| {
            (self.shape.half[i] + 0.5 * (shift[i].abs() + by_color[i].abs() + by_depth[i].abs()))
                / ((1.0 - 0.5 * growth[i].abs()) * smallest)
        });
        let line: Vec<[f64; 2]> = if self.shape.ellipse {
            let around = (0..DIRECTIONS).map(StarRegion::way);
            around.map(|[x, y]| [x * a * 1.001, y * b * 1.001]).collect()
        } else {
            vec![[a, b], [-a, b], [-a, -b], [a, -b]]
        };
        let parts: &[f64] = if sector.turned { &[0.0, 0.5, 1.0] } else { &[0.0] };
        for part in parts {
            let own: Vec<[f64; 2]> = line.iter().map(|p| sector.place(*p, sector.at(*part))).collect();
            reach.include(&own);
        }
        reach
    }

    /// Computes the reach from what the ends of the zone see through the rims, by wavelength zone.
    fn by_edges(
        &self,
        lattice: &Lattice,
        at: &ZonePlace,
        sectors: &[Sector],
        bands: usize,
    ) -> Option<Vec<Option<Vec<StarRegion>>>> {
        let ends = self.ends(lattice, at, bands)?;
        let of_sector = |sector: &Sector| {
            let of_band = |lines: &Vec<End>| {
                let mut reach = StarRegion::EMPTY;
                for end in lines {
                    reach.include(&end.rims.iter().map(|p| sector.place(*p, end.turns)).collect::<Vec<_>>());
                }
                reach
            };
            held(ends.iter().map(of_band).collect())
        };
        Some(sectors.iter().map(of_sector).collect())
    }

    /// Computes the reach from what the ends of the zone see through the rims and the opening, by wavelength zone.
    fn by_openings(
        &self,
        lattice: &Lattice,
        at: &ZonePlace,
        sectors: &[Sector],
        (opening, views): OpeningWithViews<'_>,
        bands: usize,
    ) -> Option<Vec<Option<Vec<StarRegion>>>> {
        let ends = self.ends(lattice, at, bands)?;
        // Each sector shares its ends with its neighbors.
        let turns = sectors.iter().map(|sector| sector.at(0.0)).chain(sectors.last().map(|sector| sector.at(1.0)));
        let of_turn = |turns: f64| -> Option<Vec<StarRegion>> {
            let of_band = |(band, lines): (usize, &Vec<End>)| {
                let mut reach = StarRegion::EMPTY;
                for end in lines {
                    let seen = views[end.node][end.color].as_ref()?;
                    let line = opening.line(seen, turns);
                    let line: Option<Vec<_>> = line.iter().map(|p| self.stilled(end, *p, band)).collect();
                    let [mut own, mut rims] = [StarRegion::EMPTY; 2];
                    for (reach, line) in [(&mut own, &line?), (&mut rims, &end.rims)] {
                        reach.include(&line.iter().map(|p| turned(*p, turns)).collect::<Vec<_>>());
                    }
                    own.limit(&rims);
                    reach.join(&own);
                }
                Some(reach)
            };
            ends.iter().enumerate().map(of_band).collect()
        };
        let by_turn: Vec<Option<Vec<StarRegion>>> = turns.map(of_turn).collect();
        let of_sector = |ends: &[Option<Vec<StarRegion>>]| {
            let [from, to] = ends else { return None };
            let mut both = from.clone()?;
            both.iter_mut().zip(to.as_ref()?).for_each(|(reach, other)| reach.join(other));
            held(both)
        };
        Some(by_turn.windows(2).map(of_sector).collect())
    }

    /// Returns the ends of the zone with the rims that they see, by wavelength zone. Each end appears twice, for the two ends of the
    /// wavelengths. Returns `None` if one of them sees nothing.
    fn ends(&self, lattice: &Lattice, at: &ZonePlace, bands: usize) -> Option<Vec<Vec<End>>> {
        let ends = lattice.ends(at)?;
        let deep = ends.len() > lattice.ends_a_depth();
        let of_band = |band: usize| {
            let mut own = Vec::with_capacity(2 * ends.len());
            for (at, (turns, node)) in ends.iter().enumerate() {
                // Ends come in pairs, the lower and the upper one; so do the depths.
                let half = |upper: bool| if upper { 0.5 } else { -0.5 };
                let depth = if deep { half(at >= lattice.ends_a_depth()) } else { 0.0 };
                for upper in [false, true] {
                    let color = (band + usize::from(upper)).min(node.edges.len() - 1);
                    let parts = [half(at % 2 == 1), half(upper), depth];
                    let mut end = End { node: at, color, turns: *turns, from: node.point, parts, rims: Vec::new() };
                    end.rims = node.edges[color].iter().map(|p| self.stilled(&end, *p, band)).collect::<Option<_>>()?;
                    if end.rims.is_empty() {
                        return None;
                    }
                    own.push(end);
                }
            }
            Some(own)
        };
        (0..bands).map(of_band).collect()
    }

    /// Converts a point that an end sees to the middle of the zone, along and across from the center.
    fn stilled(&self, end: &End, place: DVec3, band: usize) -> Option<[f64; 2]> {
        let ([along, across], _) = self.plane.project(end.from, place)?;
        let from_center = [along - self.shape.center[0], across - self.shape.center[1]];
        Some(self.still(from_center, band, end.parts))
    }
}

/// The rims that an end of a zone sees at one wavelength.
struct End {
    /// Index among the ends of the zone, and index of the wavelength.
    node: usize,
    color: usize,
    /// Azimuth of the end's point, turns, and the point, mm.
    turns: f64,
    from: DVec3,
    /// Position in the zone as fractions of the angle, the wavelength and the depth, each -0.5 to 0.5.
    parts: [f64; 3],
    /// Points of the rims, along and across, converted to the middle of the zone.
    rims: Vec<[f64; 2]>,
}

/// Adds a small margin to the reaches; `None` if one of them is empty.
fn held(mut reaches: Vec<StarRegion>) -> Option<Vec<StarRegion>> {
    if reaches.iter().any(StarRegion::is_empty) {
        return None;
    }
    reaches.iter_mut().for_each(|reach| reach.scale(1.0 + MARGIN));
    Some(reaches)
}

/// Converts a point given along and across the plane of a source point at this azimuth to x and y of the lens.
fn turned([along, across]: [f64; 2], turns: f64) -> [f64; 2] {
    let (sin, cos) = sin_cos_turns(turns);
    [along * cos - across * sin, along * sin + across * cos]
}
