//! The search for what passes: zone by zone, then verified.

use super::nodes::{Geometry, Node};
use super::probe::{Plane, Prober};
use super::shape::Shape;
use super::table::{Depth, Row, SLOTS, Table, Zone};
use crate::aperture::{self, Aperture};
use crate::{Indices, Lens, Tracer, Travel};
use glam::DVec3;
use spectra_core::Isa;
use spectra_core::loss::ALIVE;
use spectra_core::math::atan2;
use spectra_core::numbers::Numbers;

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sphere {
    pub center: DVec3,
    pub radius_mm: f64,
}

impl Sphere {
    /// Around the clear part of the first surface that light meets, in the frame that light comes in.
    /// Where that states no size, four times the largest that any surface states.
    pub fn around(lens: &Lens, travel: Travel) -> Option<Self> {
        let (element, pose) = match travel {
            Travel::Forward => lens.elements.first().map(|e| (e, e.pose))?,
            Travel::Backward => lens.elements.last().map(|e| (e, lens.image_pose.inverse().then(&e.pose)))?,
        };
        let largest = lens.largest_semi_diameter_mm()?;
        let rim = element.semi_diameter_mm.unwrap_or(4.0 * largest);
        let sag = element.surface.sag_mm(rim, 0.0).unwrap_or(0.0);
        let radius_mm = SLACK * (rim * rim + 0.25 * sag * sag).sqrt();
        Some(Self { center: pose.point(DVec3::new(0.0, 0.0, 0.5 * sag)), radius_mm })
    }
}

/// What is searched.
pub(super) struct Task<'a> {
    pub lens: &'a Lens,
    pub tracer: &'a Tracer,
    pub geometry: Geometry,
    pub depth: Depth,
    /// Depths that nodes stand at, in rising order: one, or one more than zones.
    pub depth_nodes: Vec<f64>,
    /// Largest measure of the angle that any point has.
    pub most: f64,
    /// The ends of the band, nm.
    pub band_nm: [f64; 2],
}

/// A sphere that holds a tilted rim, too.
const SLACK: f64 = 1.1;
/// Zones of the angle, with an axis of revolution and without one.
const ZONES: usize = 64;
const ZONES_WITHOUT_AXIS: usize = 32;
/// Zones of the azimuth, without one.
const AZIMUTHS: usize = 24;
/// Grid over what passes from one point.
const GRID: usize = 32;
const GRID_WITHOUT_AXIS: usize = 24;
/// Step in which the end of the field is looked for, in the measure of the angle: under two degrees.
const STEP: f64 = 0.02;
/// So far beyond the last light seen, in that measure, no more is looked for: some 15 degrees.
const GIVE_UP: f64 = 0.2;
/// Random rays beside each zone's shape, none of which may pass.
const CHECKS: usize = 1024;
/// How often a shape is widened before it is given up for the whole surface.
const ROUNDS: u64 = 8;
/// Half-zones on each side between which chief rays are crossed.
const BASE: usize = 11;

impl Task<'_> {
    /// Searches all zones. `None` where no surface states a size.
    pub fn run(self) -> Option<Table> {
        let [min_nm, max_nm] = self.band_nm;
        let iris = |a: &Aperture| matches!(a.shape, aperture::Shape::Iris(_));
        if self.lens.elements.iter().any(|e| e.semi_diameter_mm.is_some() && e.apertures.iter().any(iris)) {
            let lens = with_round_irises(self.lens);
            let has_more = lens.elements.iter().any(|e| e.apertures.iter().any(iris));
            let tracer = Tracer::new(&lens, Indices::Band { min_nm, max_nm }, self.tracer.isa()).ok()?;
            if !has_more {
                return Task { lens: &lens, tracer: &tracer, ..self }.run();
            }
        }
        let travel = self.geometry.travel;
        let mut prober = Prober::new(self.lens, self.tracer, travel, min_nm, max_nm)?;
        let with_axis = self.lens.has_axis_of_revolution();
        let azimuths = if with_axis { 1 } else { AZIMUTHS };
        let zones = if with_axis { ZONES } else { ZONES_WITHOUT_AXIS };
        let most = self.end_of_field(&mut prober, azimuths).min(self.most);
        let scale = if most > 0.0 { zones as f64 / most } else { 0.0 };
        let mut rows = Vec::new();
        if most > 0.0 {
            // Of a zone, its two edges and its middle are looked at; over the azimuth, its edges.
            let lattice = Lattice::new(&self, &mut prober, azimuths, 2 * zones, most);
            for depth in 0..self.depth.zones {
                for azimuth in 0..azimuths {
                    let row: Vec<Zone> = (0..zones)
                        .map(|zone| {
                            let place = ZonePlace { depth, azimuth, zone, azimuths, scale };
                            self.zone(&mut prober, &lattice, &place)
                        })
                        .collect();
                    rows.push(Row::new(&row));
                }
            }
        } else {
            rows = vec![Row::new(&[]); self.depth.zones * azimuths];
        }
        debug_assert!(zones < SLOTS);
        let surface = if travel == Travel::Forward { 1 } else { self.lens.elements.len() as u32 };
        Some(Table {
            eye_z_mm: self.geometry.eye_z_mm,
            angle_scale: scale,
            depth: self.depth,
            azimuths,
            rows,
            bound: self.geometry.bound,
            surface,
        })
    }

    /// The measure of the angle beyond which nothing passes; 0 where nothing does at all.
    fn end_of_field(&self, prober: &mut Prober<'_>, azimuths: usize) -> f64 {
        let (first, last) = (self.depth_nodes[0], self.depth_nodes[self.depth_nodes.len() - 1]);
        let depths = if first == last { vec![first] } else { vec![first, last] };
        let looks = azimuths.min(8);
        let mut end = 0.0;
        let mut step = 0;
        // Nobody builds a lens that sees more than 130 degrees to each side.
        while STEP * f64::from(step) <= 1.55_f64.min(self.most + STEP) {
            let measure = STEP * f64::from(step);
            let passes = depths.iter().any(|depth| {
                (0..looks)
                    .any(|k| self.geometry.node(prober, measure, *depth, turns(k as f64 / looks as f64), 8).is_some())
            });
            if passes {
                end = measure + STEP;
            } else if end > 0.0 && measure > end + GIVE_UP {
                break;
            }
            step += 1;
        }
        end
    }

    fn zone(&self, prober: &mut Prober<'_>, lattice: &Lattice, at: &ZonePlace) -> Zone {
        let nodes = lattice.of(at);
        let Some(plane) = self.plane(lattice, at) else { return Zone::default() };
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
        let Some(mut shape) = Shape::around(&places, margin) else { return Zone::default() };
        if fades {
            shape.half = shape.half.map(|h| h * 1.25);
        }
        // Where the light fades out in the zone, what passes may run away from what was seen.
        let (checks, reach) = if fades { (4 * CHECKS, 2.0) } else { (CHECKS, 1.3) };
        for round in 0..ROUNDS {
            let beside = self.beside(prober, &shape, &plane, at, (round, checks, reach));
            if beside.is_empty() {
                break;
            }
            places.extend(beside);
            // What was overlooked is as wide as a cell more.
            margin = margin.map(|m| m * 1.5);
            shape = match Shape::around(&places, margin) {
                Some(wider) => wider,
                None => break,
            };
        }
        let center = plane.at(shape.center) - DVec3::new(0.0, 0.0, self.geometry.eye_z_mm);
        let along = plane.along * shape.half[0];
        Zone {
            center: center.into(),
            half_along: [along.x, along.z],
            half_across: shape.half[1],
            ellipse: shape.ellipse,
        }
    }

    /// The plane of a zone: across its chief ray, where the chief rays of the fields around it cross.
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

    /// Places beside a zone's shape that light passes after all, from random points of the zone.
    fn beside(
        &self,
        prober: &mut Prober<'_>,
        shape: &Shape,
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
            // Most of them close to the edge.
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

/// Turns for a share of the azimuth's measure, both 1 all around.
fn turns(share: f64) -> f64 {
    let measure = 4.0 * (share - share.floor());
    let quarter = measure.floor();
    let part = measure - quarter;
    (quarter + atan2(part, 1.0 - part) * std::f64::consts::FRAC_2_PI) * 0.25
}

/// The lens with each iris in its middle opened to the circle around its corners: it passes all that the
/// lens does, and blades alone take the axis of revolution from no lens.
fn with_round_irises(lens: &Lens) -> Lens {
    let mut round = lens.clone();
    for e in &mut round.elements {
        let mut corner_mm = 0.0_f64;
        e.apertures.retain(|a| match (&a.shape, e.semi_diameter_mm) {
            (aperture::Shape::Iris(iris), Some(size)) if a.center_mm == [0.0; 2] => {
                if !a.obscures {
                    corner_mm = corner_mm.max(iris.opening(size).corner_radius_mm());
                }
                false
            }
            _ => true,
        });
        if corner_mm > 0.0 {
            e.semi_diameter_mm = Some(corner_mm);
        }
    }
    round
}

/// Where a zone is among the others.
struct ZonePlace {
    depth: usize,
    azimuth: usize,
    zone: usize,
    azimuths: usize,
    /// Zones a unit of the angle's measure.
    scale: f64,
}

/// All nodes: by depth, azimuth, and half-zones of the angle.
struct Lattice {
    rows: Vec<Vec<Option<Node>>>,
    azimuths: usize,
    depths: usize,
}

impl Lattice {
    fn new(task: &Task<'_>, prober: &mut Prober<'_>, azimuths: usize, steps: usize, most: f64) -> Self {
        let grid = if azimuths == 1 { GRID } else { GRID_WITHOUT_AXIS };
        let mut rows = Vec::new();
        for depth in &task.depth_nodes {
            for azimuth in 0..azimuths {
                let turns = turns(azimuth as f64 / azimuths as f64);
                let node = |k: usize| {
                    let measure = most * k as f64 / steps as f64;
                    task.geometry.node(prober, measure, *depth, turns, grid)
                };
                rows.push((0..=steps).map(node).collect());
            }
        }
        Self { rows, azimuths, depths: task.depth_nodes.len() }
    }

    /// Nodes of a zone that all see light.
    fn nodes_a_zone(&self) -> usize {
        3 * if self.azimuths > 1 { 2 } else { 1 } * if self.depths > 1 { 2 } else { 1 }
    }

    fn rows_of(&self, at: &ZonePlace) -> Vec<&Vec<Option<Node>>> {
        let depths = if self.depths > 1 { vec![at.depth, at.depth + 1] } else { vec![0] };
        let looks = if self.azimuths > 1 { vec![at.azimuth, (at.azimuth + 1) % self.azimuths] } else { vec![0] };
        depths.iter().flat_map(|d| looks.iter().map(move |a| &self.rows[d * self.azimuths + a])).collect()
    }

    /// The nodes at the edges and in the middle of a zone from which light passes.
    fn of(&self, at: &ZonePlace) -> Vec<&Node> {
        let from = 2 * at.zone;
        self.rows_of(at).into_iter().flat_map(|row| row[from..=from + 2].iter().flatten()).collect()
    }

    /// A row of nodes over the angle that runs through the zone, the one in which most light is seen.
    fn row(&self, at: &ZonePlace) -> &[Option<Node>] {
        let from = 2 * at.zone;
        let mut rows = self.rows_of(at);
        rows.sort_by_key(|row| row[from..=from + 2].iter().flatten().count());
        rows.pop().map_or(&[], |row| row)
    }
}
