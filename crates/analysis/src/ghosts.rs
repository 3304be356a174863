//! The ghosts of a lens one by one: axial light from infinity that two or four surfaces reflect.

use crate::draw::{DrawnRay, SectionView};
use glam::DVec3;
use serde::Serialize;
use spectra_core::RayBatch;
use spectra_core::loss::ALIVE;
use spectra_core::math::{cos, sin, sin_cos_turns};
use spectra_glass::{DispersionError, lines};
use spectra_lens::Section;
use spectra_optics::{FrontOpening, Optics};
use spectra_tracer::{Indices, Ledger, Path, PathSearch, Route, Tracer, Travel};
use std::sync::Arc;

/// A ghost: axial light from infinity along one path of reflections.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ghost {
    /// Reflecting surfaces in the order of the light, counted from 1.
    pub surfaces: Vec<usize>,
    /// Light that reaches the image plane along this path, divided by that of the straight path.
    pub energy: f64,
    /// Focus of the ghost, mm: distance from the image plane to the paraxial image of infinity along this path, positive behind
    /// the plane. `None` if the light leaves parallel.
    pub focus_mm: Option<f64>,
    /// Paraxial focal length of the path, mm; `None` if the light leaves parallel. Divided by the focal length of the lens, it is
    /// the size of the ghost image relative to the regular image. A negative ratio means a ghost that is upside down relative to
    /// the regular image.
    pub focal_length_mm: Option<f64>,
    /// Diameter of the disk that a point at infinity makes on the image plane, mm.
    pub size_mm: f64,
    /// Color: `energy` at the lines C', e and F' (red, green, blue), each divided by the value at e.
    pub color: [f64; 3],
}

impl Ghost {
    /// Returns the brightness on the image plane relative to other ghosts: `energy` divided by the area of the disk. The diameter
    /// of the disk counts as at least 0.1 mm.
    #[must_use]
    pub fn density(&self) -> f64 {
        let size = self.size_mm.max(0.1);
        self.energy / (size * size)
    }
}

/// The ghosts of a lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Ghosts {
    /// The ghosts, brightest first (by energy).
    pub paths: Vec<Ghost>,
    /// Fraction of the light entering the lens that is not followed: it is reflected more often, or starts a path with too little
    /// light.
    pub not_traced: f64,
}

/// Settings of a search for ghosts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GhostSearch {
    /// Wavelength, nm.
    pub wavelength_nm: f64,
    /// Largest number of reflections: 2 or 4.
    pub order: usize,
    /// Fraction of the straight light below which a path of four reflections is skipped.
    pub share: f64,
}

/// Number of rays across the front, for two and for four reflections.
const RAYS: usize = 4096;
const RAYS_OF_FOUR: usize = 1024;
/// Number of test rays that find the part of the beam that reaches the image along a ghost path.
const TRIED: usize = 1001;
// Height of the paraxial ray, mm.
const PARAXIAL_MM: f64 = 1e-3;
/// Slopes below this count as parallel.
const PARALLEL: f64 = 1e-12;

/// Finds the ghosts of a lens as it is set, brightest first. All figures except the color are at the wavelength of the search. The list is
/// empty if no surface reflects.
///
/// # Errors
/// A medium has no index at this wavelength or at one of the lines C', e and F'.
pub fn ghosts(lens: &Optics, search: GhostSearch) -> Result<Ghosts, DispersionError> {
    let tracer = |nm: f64| lens.tracer(Indices::At(nm)).map(|tracer| (nm, tracer));
    let main = tracer(search.wavelength_nm)?;
    let colors = [lines::C_PRIME, lines::E, lines::F_PRIME].map(|line| tracer(line.wavelength_nm));
    let [red, green, blue] = colors;
    let colors = [red?, green?, blue?];
    let radius_mm = FrontOpening::of(lens).map_or(0.0, |opening| opening.radius_mm());
    let elements = main.1.surfaces();
    let straight = Path::through(elements, Travel::Forward);
    let light = |(nm, tracer): &(f64, Arc<Tracer>), path: &Path, rays: usize| {
        disk(tracer, &tracer.route(path), *nm, radius_mm, rays)
    };
    let first = light(&main, &straight, RAYS);
    let own = first.energy;
    let surfaces = main.1.reflecting();
    let least = search.share * own;
    let mut found = Vec::new();
    let mut visit = |path: &Path, _: f64| {
        let disk = light(&main, path, RAYS);
        let reflections = path.reflections().count();
        if reflections > 0 && path.leaves() == Travel::Forward {
            found.push((path.clone(), reflections, disk.energy, disk.size_mm));
        }
        disk.ledger
    };
    let branches = PathSearch { elements, surfaces: &surfaces, order: search.order, least };
    let left = branches.follow(&mut Vec::new(), 0.0, &mut visit);
    let entered = first.ledger.launched - first.ledger.steps.first().map_or(0.0, |step| step.missed + step.vignetted);
    // Paths of four reflections are many, so fewer rays measure their colors.
    let own_colors = [RAYS, RAYS_OF_FOUR].map(|rays| colors.each_ref().map(|c| light(c, &straight, rays).energy));
    let mut paths: Vec<Ghost> = found
        .into_iter()
        .map(|(path, reflections, energy, size_mm)| {
            let (rays, own_colors) =
                if reflections > 2 { (RAYS_OF_FOUR, own_colors[1]) } else { (RAYS, own_colors[0]) };
            let by_color: Vec<f64> =
                colors.iter().zip(own_colors).map(|(c, own)| light(c, &path, rays).energy / own).collect();
            let over = |of: f64| if by_color[1] > 0.0 { of / by_color[1] } else { 0.0 };
            let (focus_mm, focal_length_mm) = focus(&main.1, &main.1.route(&path), search.wavelength_nm);
            Ghost {
                surfaces: path.reflections().map(|at| at + 1).collect(),
                energy: if own > 0.0 { energy / own } else { 0.0 },
                focus_mm,
                focal_length_mm,
                size_mm,
                color: [over(by_color[0]), 1.0, over(by_color[2])],
            }
        })
        .collect();
    paths.sort_by(|a, b| b.energy.total_cmp(&a.energy).then_with(|| a.surfaces.cmp(&b.surfaces)));
    Ok(Ghosts { paths, not_traced: if entered > 0.0 { left / entered } else { 0.0 } })
}

/// Parallel light across the front after it followed a path.
struct Disk {
    /// Light that reaches the image plane.
    energy: f64,
    /// Diameter of its disk on the image plane, mm.
    size_mm: f64,
    ledger: Ledger,
}

/// Traces `many` parallel rays over the front along a route.
fn disk(tracer: &Tracer, route: &Route, wavelength_nm: f64, radius_mm: f64, many: usize) -> Disk {
    let mut rays = RayBatch::new(many);
    rays.restart(many);
    let c = rays.columns_mut();
    for i in 0..many {
        // Cells of equal area, turned by the golden section from ray to ray (H. Vogel, 1979).
        let r = radius_mm * ((i as f64 + 0.5) / many as f64).sqrt();
        let turns = i as f64 * 0.618_033_988_749_894_9;
        let (sin, cos) = sin_cos_turns(turns - turns.floor());
        (c.x[i], c.y[i], c.z[i], c.l[i], c.m[i], c.n[i]) = (r * cos, r * sin, -1.0, 0.0, 0.0, 1.0);
        c.wavelength_nm[i] = wavelength_nm;
    }
    let mut work = tracer.work(many).with_ledger();
    tracer.follow(route, &mut rays, &mut work);
    let ([x, y, z], [l, m, n]) = (rays.positions(), rays.directions());
    let (mut energy, mut farthest) = (0.0, 0.0_f64);
    for i in (0..rays.len()).filter(|i| rays.states()[*i] == ALIVE && n[*i] > 0.0 && rays.weights()[*i] > 0.0) {
        let way = -z[i] / n[i];
        let (x, y) = (x[i] + way * l[i], y[i] + way * m[i]);
        energy += rays.weights()[i];
        farthest = farthest.max((x * x + y * y).sqrt());
    }
    Disk { energy, size_mm: 2.0 * farthest, ledger: work.take_ledger().unwrap_or_default() }
}

/// Traces rays of a ghost for a drawing: parallel light at the angle `field_rad` to the axis, in `section`. `reflections` are the
/// reflecting surfaces in the order of the light, counted from 0. The `many` rays are spread evenly over the part of the beam
/// that reaches the image plane by these reflections. Fewer are returned if fewer reach it.
///
/// # Errors
/// A medium has no index at this wavelength.
///
/// # Panics
/// The reflections do not follow from one another.
pub fn ghost_rays(
    lens: &Optics,
    reflections: &[usize],
    wavelength_nm: f64,
    field_rad: f64,
    section: Section,
    many: usize,
) -> Result<Vec<DrawnRay>, DispersionError> {
    let tracer = lens.tracer(Indices::At(wavelength_nm))?;
    let path = Path::reflected(tracer.surfaces(), Travel::Forward, reflections).expect("surfaces in their order");
    let route = tracer.route(&path);
    let Some(opening) = FrontOpening::of(lens) else { return Ok(Vec::new()) };
    let view = SectionView { section };
    let (sin, cos) = (sin(field_rad), cos(field_rad));
    let (direction, side) = (view.across(sin, cos), view.across(cos, -sin));
    let start = |k: usize| -> DVec3 {
        let s_mm = opening.radius_mm() * (2.0 * (k as f64 + 0.5) / TRIED as f64 - 1.0);
        opening.center() + side * s_mm - direction * (3.0 * opening.radius_mm())
    };
    let comes = |k: usize| {
        let path = tracer.path_along(&route, start(k), direction, wavelength_nm);
        let forward = lens.image_pose.local_direction(path.direction).z > 0.0;
        (path.end.is_none() && forward && path.points.iter().all(|p| p.is_finite())).then_some(path)
    };
    let came: Vec<_> = (0..TRIED).filter_map(comes).collect();
    let many = many.min(came.len());
    let at = |k: usize| if many > 1 { k * (came.len() - 1) / (many - 1) } else { came.len() / 2 };
    Ok((0..many).map(|k| DrawnRay { path: came[at(k)].clone(), wavelength_nm, strength: 1.0 }).collect())
}

/// Returns the distance of the paraxial focus behind the image plane and the focal length, both in mm; both `None` if the light
/// is lost or parallel.
fn focus(tracer: &Tracer, route: &Route, wavelength_nm: f64) -> (Option<f64>, Option<f64>) {
    let mut rays = RayBatch::new(1);
    rays.restart(1);
    let c = rays.columns_mut();
    (c.x[0], c.y[0], c.z[0], c.l[0], c.m[0], c.n[0]) = (PARAXIAL_MM, 0.0, -1.0, 0.0, 0.0, 1.0);
    c.wavelength_nm[0] = wavelength_nm;
    tracer.follow(route, &mut rays, &mut tracer.work_in_place(1));
    let slope = rays.directions()[0][0] / rays.directions()[2][0];
    if rays.loss(0).is_some() || slope.abs() < PARALLEL {
        return (None, None);
    }
    let height = rays.positions()[0][0] - slope * rays.positions()[2][0];
    (Some(-height / slope), Some(-PARAXIAL_MM / slope))
}
