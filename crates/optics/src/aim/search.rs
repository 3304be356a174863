//! The search for the light that passes: zone by zone, then verified.

use super::lattice::{Lattice, ZonePlace};
use super::measure::turns;
use super::outline::{Colors, Outlines, RING, STRIDE, TURN_STEPS, thin};
use super::probe::{Plane, Prober, Stages};
use super::region::{Region, Sector, turns_of};
use super::region_shape::RegionShape;
use super::shaped_opening::{self, ShapedOpening};
use super::star_region::{DIRECTIONS, StarRegion};
use super::table::{Drift, SLOTS, Table, Zone, ZoneRow};
use super::task::{Cancelled, Task};
use glam::DVec3;
use spectra_core::Isa;
use spectra_core::loss::ALIVE;
use spectra_core::math::sin_cos_turns;
use spectra_core::numbers::Numbers;
use spectra_core::workers::map_pieces;
use spectra_tracer::{Indices, Tracer, Travel};

/// The data that the search of all zones shares.
struct Searched<'a> {
    stopped: Option<&'a (ShapedOpening, Stages<'a>)>,
    lattice: &'a Lattice,
    colors: Colors,
    /// Number of azimuth zones of the outlines.
    looks: usize,
    bands: usize,
}

/// An outline of a zone, for one zone of the azimuth and one wavelength zone.
struct Outline {
    look: usize,
    color: usize,
    own: [[f32; 2]; STRIDE],
}

/// Distance beyond the last light seen, in the measure of the angle, at which the search stops: about 15 degrees.
const GIVE_UP: f64 = 0.2;
/// Number of times that a shape is widened before the search gives up.
const ROUNDS: u64 = 8;
/// Number of wavelength zones: of a round lens, of one with an opening that is not round, of one without an axis.
const COLORS: usize = 4;
const COLORS_STOPPED: usize = 4;
const COLORS_WITHOUT_AXIS: usize = 2;
/// Number of random rays beyond each outline, how far beyond they go, and how many rounds are sent while one passes beyond the ring.
const HOLD_CHECKS: usize = 256;
const HOLD_REACH: f64 = 0.4;
const HOLD_ROUNDS: u64 = 4;
/// Light that reaches out of an outline by less than this factor is left to the ring.
const SLIGHT: f64 = 1.008;
/// Number of half-zones to each side between which chief rays are intersected.
const BASE: usize = 11;

impl Task<'_> {
    /// Searches all zones. Returns `None` if no surface states a size, or if the workers are to stop.
    pub fn run(self) -> Option<Table> {
        let [min_nm, max_nm] = self.band_nm;
        let travel = self.geometry.travel;
        if let Some((round, at)) = shaped_opening::split(self.lens) {
            let tracer = Tracer::new(&round, Indices::Band { min_nm, max_nm }).ok()?.scattering_like(self.tracer);
            // If light scatters before it reaches the opening, only the round lens can be aimed at.
            // A draft aims at the round lens, too.
            let is_seen = self.effort.fineness().outlines;
            let opening = || ShapedOpening::new(self.lens, &round, at, travel, self.band_nm, self.tracer);
            let opening = is_seen.then(opening).flatten();
            let itself = Stages::of(self.tracer, travel);
            return Task { lens: &round, tracer: &tracer, ..self }.search(opening.map(|opening| (opening, itself)));
        }
        self.search(None)
    }

    /// Searches all zones of the task's lens. If that is the round lens around an opening, `stopped` holds the opening and the stages of
    /// the lens itself.
    fn search(&self, stopped: Option<(ShapedOpening, Stages<'_>)>) -> Option<Table> {
        let travel = self.geometry.travel;
        let [from_nm, to_nm] = self.band_nm;
        let stages = &Stages::new(self.lens, self.tracer, travel, from_nm, to_nm)?;
        let with_axis = self.lens.has_axis_of_revolution();
        let fineness = self.effort.fineness();
        let azimuths = if with_axis { 1 } else { fineness.azimuths };
        let zones = fineness.zones[usize::from(!with_axis)];
        let most = self.end_of_field(stages, azimuths).min(self.most);
        let scale = if most > 0.0 { zones as f64 / most } else { 0.0 };
        let surface = if travel == Travel::Forward { 1 } else { self.lens.elements.len() as u32 };
        let bands = if to_nm <= from_nm {
            1
        } else if stopped.is_some() {
            COLORS_STOPPED
        } else if with_axis {
            COLORS
        } else {
            COLORS_WITHOUT_AXIS
        };
        let colors = Colors { from_nm, to_nm, zones: bands };
        let mut table = Table {
            eye_z_mm: self.geometry.eye_z_mm,
            angle_scale: scale,
            depth: self.depth,
            azimuths,
            rows: vec![ZoneRow::new(&[]); self.depth.zones * azimuths],
            bound: self.geometry.bound,
            surface,
            outlines: None,
        };
        if most <= 0.0 {
            return Some(table);
        }
        debug_assert!(zones < SLOTS);
        let looks = stopped.as_ref().map_or(azimuths, |(opening, _)| opening.azimuths());
        let turns = stopped.as_ref().map_or(Vec::new(), |_| {
            let zone = |step: usize| (turns((step as f64 + 0.5) / TURN_STEPS as f64) * looks as f64) as usize;
            (0..TURN_STEPS).map(|step| zone(step).min(looks - 1) as u16).collect()
        });
        // Each zone is probed at its two edges and its middle; over the azimuth, at its edges.
        let nodes_nm = if fineness.outlines { colors.nodes_nm() } else { Vec::new() };
        let lattice = Lattice::new(self, stages, azimuths, 2 * zones, most, &nodes_nm).ok()?;
        let all = Searched { stopped: stopped.as_ref(), lattice: &lattice, colors, looks, bands };
        let rows = self.depth.zones * azimuths;
        let fresh = || (stages.prober(), stopped.as_ref().map(|(_, itself)| itself.prober()));
        let found = map_pieces(self.workers, rows * zones, fresh, |(prober, itself), piece| {
            let (row, zone) = (piece / zones, piece % zones);
            let at = ZonePlace { depth: row / azimuths, azimuth: row % azimuths, zone, azimuths, scale };
            self.check_cancelled()?;
            Ok::<_, Cancelled>(self.outlined(&all, prober, itself.as_mut(), &at))
        });
        let found = found.ok()?;
        let mut corners = vec![[0.0_f32; 2]; rows / azimuths * looks * zones * bands * STRIDE];
        for (row, found) in found.chunks(zones).enumerate() {
            let zone = |(zone, _): &(Zone, Vec<Outline>)| *zone;
            table.rows[row] =
                ZoneRow::new(&found.iter().map(|f| f.as_ref().map_or(Zone::default(), zone)).collect::<Vec<_>>());
            for (zone, (_, outlines)) in
                found.iter().enumerate().filter_map(|(zone, found)| Some((zone, found.as_ref()?)))
            {
                for Outline { look, color, own } in outlines {
                    let place = (row / azimuths * looks + look) * zones + zone;
                    corners[(place * bands + color) * STRIDE..][..STRIDE].copy_from_slice(own);
                }
            }
        }
        let outlines = Outlines { colors, zones, azimuths: looks, turns, turned: looks > 1, corners };
        table.outlines = fineness.outlines.then_some(outlines);
        Some(table)
    }

    /// Searches one zone and its outlines; `None` if nothing passes.
    fn outlined<'p>(
        &self,
        all: &Searched<'_>,
        prober: &mut Prober<'p>,
        itself: Option<&mut Prober<'p>>,
        at: &ZonePlace,
    ) -> Option<(Zone, Vec<Outline>)> {
        let Searched { lattice, colors, looks, bands, .. } = *all;
        let opening = all.stopped.map(|(opening, _)| opening);
        let mut region = self.zone(prober, lattice, at)?;
        if !self.effort.fineness().outlines {
            return Some((region.zone(self.geometry.eye_z_mm), Vec::new()));
        }
        let folds = opening.map_or(1, |opening| opening.folds);
        let views = lattice.views(at, opening, &colors);
        let each = looks / at.azimuths / folds;
        let sector = |look: usize| Sector {
            from: if opening.is_some() { look as f64 / looks as f64 } else { turns_of(at).0 },
            to: if opening.is_some() { (look + 1) as f64 / looks as f64 } else { turns_of(at).1 },
            turned: looks > 1,
            opening: opening.is_some(),
        };
        let sectors: Vec<Sector> = (0..each).map(sector).collect();
        let seen = (opening, views.as_deref());
        (region.drift, region.by_band) = region.drifts(lattice, at, bands, None);
        // The passing light moves as the rims or as the opening do: choose what leaves less area to aim at, judged by one sector.
        if let (Some(opening), Some(views)) = seen {
            let area = |region: &Region| {
                let one = region.reaches(lattice, at, &sectors[..1], seen, bands);
                one.iter().flatten().map(StarRegion::area).sum::<f64>()
            };
            let (drift, by_band) = region.drifts(lattice, at, bands, Some((opening, views)));
            let with_opening = Region { drift, by_band, ..region };
            if area(&with_opening) < area(&region) {
                region = with_opening;
            }
        }
        let all_reaches = region.reaches(lattice, at, &sectors, seen, bands);
        let whole = itself.unwrap_or(prober);
        let mut outlines = Vec::with_capacity(each * folds * bands);
        for (look, mut reaches) in all_reaches.into_iter().enumerate() {
            if !region.fades {
                self.hold(whole, &region, at, (look, &sectors[look]), &colors, &mut reaches);
            }
            for (color, reach) in reaches.iter().enumerate() {
                let outline = reach.corners();
                for fold in 0..folds {
                    let (sin, cos) = sin_cos_turns(fold as f64 / folds as f64);
                    let mut own = [[0.0; 2]; STRIDE];
                    own[outline.len()..STRIDE - 1].copy_from_slice(&region.by_band[color].columns());
                    own[STRIDE - 1][0] = thin(&outline);
                    for (corner, [x, y]) in own.iter_mut().zip(outline) {
                        let (x, y) = (f64::from(x), f64::from(y));
                        *corner = [(x * cos - y * sin) as f32, (x * sin + y * cos) as f32];
                    }
                    outlines.push(Outline { look: at.azimuth + look + fold * each, color, own });
                }
            }
        }
        Some((region.zone(self.geometry.eye_z_mm), outlines))
    }

    /// Raises the reach of a zone, by wavelength, to include what random rays find beyond it.
    fn hold(
        &self,
        prober: &mut Prober<'_>,
        region: &Region,
        at: &ZonePlace,
        (look, sector): (usize, &Sector),
        colors: &Colors,
        reaches: &mut [StarRegion],
    ) {
        let numbers = Numbers::random(0xa2);
        let stream = ((at.depth * at.azimuths + at.azimuth) * SLOTS + at.zone) * 64 + look;
        for round in 0..HOLD_ROUNDS {
            let columns: [Vec<f64>; 6] = std::array::from_fn(|dimension| {
                let mut column = vec![0.0; HOLD_CHECKS];
                let first = round * HOLD_CHECKS as u64;
                numbers.fill(Isa::Baseline, stream as u64, first, dimension as u32, &mut column);
                column
            });
            let mut probes = Vec::with_capacity(HOLD_CHECKS);
            for i in 0..HOLD_CHECKS {
                let [angle, part, azimuth, a, b, color] = std::array::from_fn(|d| columns[d][i]);
                let nm = colors.from_nm + color * (colors.to_nm - colors.from_nm);
                let zone = colors.zone(nm);
                let direction = (a * DIRECTIONS as f64) as usize % DIRECTIONS;
                // Most of the rays go close to the edge.
                let r = reaches[zone].at(direction) * (1.0 + HOLD_REACH * b * b);
                let place = StarRegion::way(direction).map(|w| w * r);
                let turns = sector.at(azimuth);
                let depth = self.depth.from
                    + (at.depth as f64 + part) * (self.depth.to - self.depth.from) / self.depth.zones as f64;
                let measure = (at.zone as f64 + angle) / at.scale;
                let Some(point) = self.geometry.point(measure, depth.min(self.depth.to), turns) else { continue };
                let parts = [angle - 0.5, colors.at(nm) - zone as f64 - 0.5, part - 0.5];
                let [along, across] = region.moved(sector.local(place, turns), zone, parts);
                let local = region.plane.at([region.shape.center[0] + along, region.shape.center[1] + across]);
                let (sin, cos) = sin_cos_turns(turns);
                let target = DVec3::new(local.x * cos - local.y * sin, local.x * sin + local.y * cos, local.z);
                probes.push((zone, place, (point, target, nm)));
            }
            let states = prober.pass(probes.iter().map(|p| p.2));
            let mut beyond = false;
            for ((zone, place, _), _) in probes.iter().zip(states).filter(|(_, s)| **s == ALIVE) {
                beyond |= reaches[*zone].raise(*place, SLIGHT, 1.0 + RING, sector.opening);
            }
            if !beyond {
                break;
            }
        }
    }

    /// Finds the measure of the angle beyond which nothing passes; 0 if nothing passes at all.
    fn end_of_field(&self, stages: &Stages<'_>, azimuths: usize) -> f64 {
        let prober = &mut stages.prober();
        let step_of = self.effort.fineness().step;
        let (first, last) = (self.depth_nodes[0], self.depth_nodes[self.depth_nodes.len() - 1]);
        let depths = if first == last { vec![first] } else { vec![first, last] };
        let looks = azimuths.min(8);
        let mut end = 0.0;
        let mut step = 0;
        // No lens sees more than 130 degrees to each side.
        while step_of * f64::from(step) <= 1.55_f64.min(self.most + step_of) {
            let measure = step_of * f64::from(step);
            let passes = depths.iter().any(|depth| {
                (0..looks).any(|k| {
                    self.geometry.node(prober, measure, *depth, turns(k as f64 / looks as f64), 8, &[]).is_some()
                })
            });
            if passes {
                end = measure + step_of;
            } else if end > 0.0 && measure > end + GIVE_UP {
                break;
            }
            step += 1;
        }
        end
    }

    /// Finds the shape that contains everything that passes in a zone; `None` if nothing does.
    fn zone(&self, prober: &mut Prober<'_>, lattice: &Lattice, at: &ZonePlace) -> Option<Region> {
        let nodes = lattice.of(at);
        let plane = self.plane(lattice, at)?;
        let fades = nodes.len() < lattice.nodes_a_zone();
        let mut places = Vec::new();
        let mut margin = [0.0_f64; 2];
        for node in &nodes {
            for target in &node.targets {
                if let Some((place, factor)) = plane.project(node.point, *target) {
                    places.push(place);
                    for (margin, cell) in margin.iter_mut().zip(node.cell) {
                        *margin = margin.max(cell * factor);
                    }
                }
            }
        }
        let mut shape = RegionShape::around(&places, margin)?;
        if fades {
            shape.half = shape.half.map(|h| h * 1.25);
        }
        // If the light fades out in the zone, the passing region may move away from what was seen.
        let checks = self.effort.fineness().checks;
        let (checks, reach) = if fades { (4 * checks, 2.0) } else { (checks, 1.3) };
        for round in 0..ROUNDS {
            let beside = self.beside(prober, &shape, &plane, at, (round, checks, reach));
            if beside.is_empty() {
                break;
            }
            places.extend(beside);
            // The missed part may extend by one more cell.
            margin = margin.map(|m| m * 1.5);
            shape = match RegionShape::around(&places, margin) {
                Some(wider) => wider,
                None => break,
            };
        }
        Some(Region { plane, shape, fades, drift: Drift::default(), by_band: Vec::new() })
    }

    /// Finds the plane of a zone: across its chief ray, where the chief rays of the fields around it cross.
    fn plane(&self, lattice: &Lattice, at: &ZonePlace) -> Option<Plane> {
        let middle = 2 * at.zone + 1;
        let row = lattice.row(at);
        let seen = |k: usize| row.get(k).and_then(Option::as_ref);
        let chief = seen(middle).or(seen(middle - 1)).or(seen(middle + 1))?;
        let flat = |v: DVec3| DVec3::new(v.x, 0.0, v.z);
        let way = flat(chief.center - chief.point);
        let distance = way.length();
        let direction = way / distance;
        let lower = (middle.saturating_sub(BASE)..middle).find_map(seen);
        let upper = (middle + 1..=(middle + BASE).min(row.len() - 1)).rev().find_map(seen);
        let mut shift = 0.0;
        if let (Some(lower), Some(upper)) = (lower, upper) {
            let (a, b) = (flat(lower.center - lower.point).normalize(), flat(upper.center - upper.point).normalize());
            let turn = a.x * b.z - a.z * b.x;
            let gap = flat(upper.center - lower.center);
            let crossing = lower.center + a * ((gap.x * b.z - gap.z * b.x) / turn);
            let found = flat(crossing - chief.center).dot(direction);
            if found.is_finite() {
                let limit =
                    self.geometry.bound.radius_mm + (self.geometry.bound.center.z - self.geometry.eye_z_mm).abs();
                shift = found.clamp(-(2.0 * limit).min(0.7 * distance), 2.0 * limit);
            }
        }
        let along = DVec3::new(direction.z, 0.0, -direction.x);
        let along = if along.x < 0.0 { -along } else { along };
        let origin = flat(chief.center) + direction * shift;
        Some(Plane { origin, along, across: DVec3::Y })
    }

    /// Finds points outside a zone's shape that pass light after all, with rays from random points of the zone.
    fn beside(
        &self,
        prober: &mut Prober<'_>,
        shape: &RegionShape,
        plane: &Plane,
        at: &ZonePlace,
        (round, checks, reach): (u64, usize, f64),
    ) -> Vec<[f64; 2]> {
        let numbers = Numbers::random(0xa1);
        let stream = (at.depth * at.azimuths + at.azimuth) * SLOTS + at.zone;
        let columns: [Vec<f64>; 6] = std::array::from_fn(|dimension| {
            let mut column = vec![0.0; checks];
            numbers.fill(Isa::Baseline, stream as u64, round * checks as u64, dimension as u32, &mut column);
            column
        });
        let [min_nm, max_nm] = self.band_nm;
        let mut probes = Vec::new();
        for i in 0..checks {
            let [angle, depth, azimuth, a, b, color] = std::array::from_fn(|d| columns[d][i]);
            // Most of the rays go close to the edge.
            let place = shape.beside(a, 1.0 + (reach - 1.0) * b * b);
            let turns = turns((at.azimuth as f64 + azimuth) / at.azimuths as f64);
            let depth = self.depth.from
                + (at.depth as f64 + depth) * (self.depth.to - self.depth.from) / self.depth.zones as f64;
            let depth = depth.min(self.depth.to);
            let Some(point) = self.geometry.point((at.zone as f64 + angle) / at.scale, depth, turns) else { continue };
            let (sin, cos) = spectra_core::math::sin_cos_turns(turns);
            let local = plane.at(place);
            let target = DVec3::new(local.x * cos - local.y * sin, local.x * sin + local.y * cos, local.z);
            probes.push((place, (point, target, min_nm + color * (max_nm - min_nm))));
        }
        let mut beside = Vec::new();
        for chunk in probes.chunks(prober.capacity()) {
            let states = prober.pass(chunk.iter().map(|p| p.1));
            beside.extend(chunk.iter().zip(states).filter(|(_, s)| **s == ALIVE).map(|(p, _)| p.0));
        }
        beside
    }
}
