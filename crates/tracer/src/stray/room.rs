//! The rooms between surfaces: their walls, and where light meets them.

use super::StrayReflectances;
use crate::absorption::{Absorption, Grid};
use glam::{DVec2, DVec3};
use spectra_core::surface::{Action, Surface};
use spectra_lens::Coating;
use spectra_lens::Layer;
use spectra_lens::Pose;
use spectra_lens::Separation;
use spectra_lens::{Aperture, ApertureShape};
use spectra_lens::{Element, Lens};
use std::sync::Arc;

/// Light that meets a wall nearer than this starts on that wall, mm.
const ON_THE_WALL_MM: f64 = 1e-7;
/// Largest difference of sag, relative to the semi-diameter, at which a surface counts as a sphere.
const SAME_SHAPE: f64 = 1e-12;
/// Number of steps along a ray in the search for a surface given by its sag, and of halvings of the step that crosses it.
const STEPS: usize = 32;
const HALVINGS: usize = 50;
/// Step of the differences for the slope of a sag, mm.
const SLOPE_MM: f64 = 1e-4;
/// Largest fraction of the radius of a sphere that is used.
const MOST_OF_A_SPHERE: f64 = 0.999;
/// Smallest cosine of the angle between a surface's axis and the lens's; beyond it the lens has no straight barrel.
const STRAIGHT: f64 = 0.99;
/// Radius of the camera chamber at the imager, relative to half the diagonal of the imager.
const CHAMBER: f64 = 1.05;
/// Factor by which the disk that light is aimed at is larger than the paraxial pupil.
const PUPIL_MARGIN: f64 = 1.15;
/// Step of the tables of indices, nm.
const STEP_NM: f64 = 1.0;

/// The reason why the stray light of a lens cannot be computed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StrayError {
    /// No surface states a semi-diameter.
    #[error("no surface of the lens states a semi-diameter, so it has no barrel")]
    NoSizes,
    /// A surface that cannot be treated: its number, from 1, and what it is (a mirror, a prism, a grating, a surface that
    /// scatters, or a tilted surface).
    #[error("stray light is computed only for lenses on a straight axis whose surfaces refract; surface {0} is {1}")]
    NotStraight(usize, &'static str),
    /// The lens has no surfaces.
    #[error("the lens has no surfaces")]
    NoSurfaces,
}

/// The shape of a surface.
#[derive(Clone, Debug)]
enum WallShape {
    /// A sphere of this curvature, 1/mm; 0 is a plane.
    Sphere(f64),
    Sag(Arc<dyn Surface>),
}

/// One surface as a wall between two rooms.
#[derive(Clone, Debug)]
pub(super) struct Wall {
    pose: Pose,
    form: WallShape,
    clear2_mm2: f64,
    /// Radius to which the surface reaches, mm; outside the clear radius it is painted.
    outer_mm: f64,
    apertures: Vec<Aperture>,
    pub semi_diameter_mm: Option<f64>,
    /// Whether the surface separates two media.
    pub refracts: bool,
    pub coating: Coating,
    /// Where the cement has separated.
    pub separation: Option<Separation>,
    /// Layers of haze, dust or scratches on the surface.
    pub layers: Vec<Layer>,
    /// Media in front of the surface and behind it.
    pub media: [usize; 2],
}

impl Wall {
    /// Converts a point of the lens (mm) to x and y in the surface's own frame.
    pub fn place(&self, at: DVec3) -> [f64; 2] {
        let local = self.pose.local_point(at);
        [local.x, local.y]
    }

    /// Returns the x and y axes of the surface, in the frame of the lens.
    pub fn axes(&self) -> [DVec3; 2] {
        [DVec3::X, DVec3::Y].map(|axis| self.pose.direction(axis))
    }

    /// Height of the rim above the vertex plane, mm.
    fn rim_sag_mm(&self) -> f64 {
        match &self.form {
            WallShape::Sphere(c) => {
                c * self.outer_mm * self.outer_mm / (1.0 + (1.0 - (c * self.outer_mm).powi(2)).sqrt())
            }
            WallShape::Sag(surface) => surface.sag_mm(self.outer_mm, 0.0).unwrap_or(0.0),
        }
    }

    /// Position of the rim along z in the frame of the lens, mm.
    fn rim_z_mm(&self) -> f64 {
        self.pose.point(DVec3::new(0.0, 0.0, self.rim_sag_mm())).z
    }

    /// Fraction of the light that the openings of the surface pass at a point of its own frame.
    fn clear_at(&self, at: DVec3) -> f64 {
        if at.x * at.x + at.y * at.y > self.clear2_mm2 {
            return 0.0;
        }
        self.apertures.iter().map(|a| a.transmittance(at.x, at.y, self.semi_diameter_mm)).product()
    }

    /// Finds the nearest crossing ahead within the outer radius and `most_mm`: the distance (mm) and the local point.
    fn meet(&self, p: DVec3, d: DVec3, most_mm: f64) -> Option<(f64, DVec3)> {
        let (p, d) = (self.pose.local_point(p), self.pose.local_direction(d));
        let within = |t: f64| {
            let at = p + d * t;
            (t > ON_THE_WALL_MM && t < most_mm && at.x * at.x + at.y * at.y <= self.outer_mm * self.outer_mm)
                .then_some((t, at))
        };
        match &self.form {
            WallShape::Sphere(c) => {
                if *c == 0.0 {
                    return within(-p.z / d.z);
                }
                // Solve c (x^2 + y^2 + z^2) = 2 z for the half around the vertex.
                let (a, b, k) = (*c, c * p.dot(d) - d.z, c * p.length_squared() - 2.0 * p.z);
                let square = b * b - a * k;
                if square < 0.0 {
                    return None;
                }
                let root = square.sqrt();
                // One root without loss of digits, the other from the product of both.
                let far = -b - if b > 0.0 { root } else { -root };
                let (one, other) = (far / a, k / far);
                let (near, far) = if one < other { (one, other) } else { (other, one) };
                let half = |(t, at): (f64, DVec3)| (c * at.z < 1.0).then_some((t, at));
                within(near).and_then(half).or_else(|| within(far).and_then(half))
            }
            WallShape::Sag(surface) => {
                let height = |t: f64| {
                    let at = p + d * t;
                    surface.sag_mm(at.x, at.y).map(|sag| at.z - sag)
                };
                let step = most_mm.min(1e4) / STEPS as f64;
                let (mut t, mut before) = (ON_THE_WALL_MM, height(ON_THE_WALL_MM));
                for k in 1..=STEPS {
                    let next = ON_THE_WALL_MM + step * k as f64;
                    let here = height(next);
                    if let (Some(a), Some(b)) = (before, here)
                        && (a > 0.0) != (b > 0.0)
                    {
                        let (mut low, mut high) = (t, next);
                        for _ in 0..HALVINGS {
                            let middle = 0.5 * (low + high);
                            if height(middle).is_some_and(|m| (m > 0.0) == (a > 0.0)) {
                                low = middle
                            } else {
                                high = middle
                            }
                        }
                        if let Some(found) = within(0.5 * (low + high)) {
                            return Some(found);
                        }
                    }
                    (t, before) = (next, here);
                }
                None
            }
        }
    }

    /// Unit normal at a local point, in the frame of the lens.
    fn normal(&self, at: DVec3) -> DVec3 {
        let local = match &self.form {
            WallShape::Sphere(c) => DVec3::new(-c * at.x, -c * at.y, 1.0 - c * at.z),
            WallShape::Sag(surface) => {
                let slope = |x: f64, y: f64| {
                    let ends = [1.0, -1.0].map(|s| surface.sag_mm(at.x + s * x, at.y + s * y).unwrap_or(at.z));
                    (ends[0] - ends[1]) / (2.0 * SLOPE_MM)
                };
                DVec3::new(-slope(SLOPE_MM, 0.0), -slope(0.0, SLOPE_MM), 1.0)
            }
        };
        self.pose.direction(local).normalize()
    }
}

/// The barrel between two rims: a cone in the frame of the lens.
#[derive(Clone, Copy, Debug)]
struct Barrel {
    z_mm: [f64; 2],
    radius_mm: [f64; 2],
}

impl Barrel {
    fn meet(&self, p: DVec3, d: DVec3) -> Option<(f64, DVec3)> {
        let ([z0, z1], [r0, r1]) = (self.z_mm, self.radius_mm);
        if (z1 - z0).abs() < ON_THE_WALL_MM {
            let t = (z0 - p.z) / d.z;
            let r = (p + d * t).truncate().length();
            let is_wall = t > ON_THE_WALL_MM && r >= r0.min(r1) && r <= r0.max(r1);
            return is_wall.then_some((t, DVec3::Z));
        }
        let slope = (r1 - r0) / (z1 - z0);
        let radius = r0 + slope * (p.z - z0);
        // x^2 + y^2 = (radius + slope dz t)^2
        let grows = slope * d.z;
        let a = d.x * d.x + d.y * d.y - grows * grows;
        let b = p.x * d.x + p.y * d.y - radius * grows;
        let k = p.x * p.x + p.y * p.y - radius * radius;
        let square = b * b - a * k;
        if square < 0.0 {
            return None;
        }
        let far = -b - if b > 0.0 { square.sqrt() } else { -square.sqrt() };
        let (one, other) = (far / a, k / far);
        let (near, far) = if one < other { (one, other) } else { (other, one) };
        [near, far].into_iter().find_map(|t| {
            let at = p + d * t;
            let is_wall = t > ON_THE_WALL_MM && at.z >= z0.min(z1) && at.z <= z0.max(z1) && radius + grows * t >= 0.0;
            is_wall.then(|| {
                let out = at.truncate().normalize_or(DVec2::X);
                (t, DVec3::new(out.x, out.y, -slope).normalize())
            })
        })
    }
}

/// The wall that light meets next.
#[derive(Clone, Copy, Debug)]
pub(super) enum NextHit {
    /// A surface: its index, and the fraction of the light that its openings pass at that point.
    Skin(usize, f64),
    /// Painted metal or a painted edge.
    Paint,
    /// The imager of the camera.
    Imager,
}

/// A disk across the axis at which light is aimed, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disk {
    pub z_mm: f64,
    pub radius_mm: f64,
}

/// The inside of a lens and of the camera behind it, as a row of closed rooms.
#[derive(Clone, Debug)]
pub struct Interior {
    pub(super) skins: Vec<Wall>,
    /// Barrels between each surface and the one before; the last one lies between the last surface and the imager.
    barrels: Vec<Barrel>,
    imager_z_mm: f64,
    /// Half the width and height of the imager (mm), and its center.
    half_mm: [f64; 2],
    center_mm: [f64; 2],
    pub(super) matter: StrayReflectances,
    /// Targets of light from the imager that should leave the lens: the pupil and the last rim.
    pub(super) guides: [Disk; 2],
    /// The first rim.
    front: Disk,
    start_nm: f64,
    /// Index and absorption coefficient (1/mm) of each medium, by wavelength.
    pub(super) media: Vec<Vec<[f64; 2]>>,
}

impl Interior {
    /// Creates the interior of a lens as it is set, in front of an imager with the width and height `frame_mm`, for light of the
    /// band `band_nm` (nm). `matter` holds the reflectances inside.
    ///
    /// # Errors
    /// [`StrayError`] if the lens has no surfaces or sizes, or its rooms do not lie on a straight axis.
    pub fn new(
        lens: &Lens,
        frame_mm: [f64; 2],
        band_nm: [f64; 2],
        matter: StrayReflectances,
    ) -> Result<Self, StrayError> {
        let largest = lens.largest_semi_diameter_mm().filter(|_| !lens.elements.is_empty());
        if lens.elements.is_empty() {
            return Err(StrayError::NoSurfaces);
        }
        largest.ok_or(StrayError::NoSizes)?;
        for (at, e) in lens.elements.iter().enumerate() {
            let fault = if e.action == Action::Reflect {
                Some("a mirror")
            } else if e.solid.is_some() {
                Some("a prism")
            } else if e.surface.is_directional() || e.surface.draws() {
                Some("not clear glass")
            } else if e.pose.rotation.z_axis.z.abs() < STRAIGHT {
                Some("tilted")
            } else {
                None
            };
            if let Some(fault) = fault {
                return Err(StrayError::NotStraight(at + 1, fault));
            }
        }
        let skins: Vec<Wall> = (0..lens.elements.len()).map(|at| skin(lens, at)).collect();
        let half_mm = frame_mm.map(|side| 0.5 * side);
        let imager_z_mm = lens.image_z_mm();
        let diagonal = DVec2::from(half_mm).length();
        let rim = |skin: &Wall| (skin.rim_z_mm(), skin.outer_mm);
        let film = (imager_z_mm, diagonal * CHAMBER);
        let rims: Vec<(f64, f64)> = skins.iter().map(rim).chain([film]).collect();
        let barrel = |pair: &[(f64, f64)]| Barrel { z_mm: [pair[0].0, pair[1].0], radius_mm: [pair[0].1, pair[1].1] };
        let barrels = rims.windows(2).map(barrel).collect();
        let last = rims[rims.len() - 2];
        let rear = Disk { z_mm: last.0, radius_mm: last.1 };
        let steps = ((band_nm[1] - band_nm[0]) / STEP_NM).ceil() as usize + 1;
        let grid = Grid::over(band_nm[0], band_nm[1]);
        let medium = |m: &spectra_lens::LensMedium| {
            let clear = Absorption::of(&m.medium, lens.year, &grid).filter(|_| lens.absorption);
            let at = |k: usize| {
                let nm = band_nm[0] + STEP_NM * k as f64;
                [m.medium.index(nm), clear.as_ref().map_or(0.0, |absorption| absorption.at(grid.place(nm)))]
            };
            (0..=steps).map(at).collect()
        };
        Ok(Self {
            guides: [pupil(lens, &skins, imager_z_mm).unwrap_or(rear), rear],
            front: Disk { z_mm: rims[0].0, radius_mm: rims[0].1 },
            media: lens.media.iter().map(medium).collect(),
            start_nm: band_nm[0],
            skins,
            barrels,
            imager_z_mm,
            half_mm,
            center_mm: [0.0; 2],
            matter,
        })
    }

    /// Moves the center of the imager off the axis, to `center_mm`. The camera behind the lens is widened for it.
    #[must_use]
    pub fn with_imager_at(mut self, center_mm: [f64; 2]) -> Self {
        self.center_mm = center_mm;
        if let Some(chamber) = self.barrels.last_mut() {
            chamber.radius_mm[1] += DVec2::from(center_mm).length();
        }
        self
    }

    /// Position along the axis and radius of the first rim, mm. All light that enters passes through this rim.
    #[must_use]
    pub fn front_rim_mm(&self) -> (f64, f64) {
        (self.front.z_mm, self.front.radius_mm)
    }

    /// Position of the imager along the axis, mm.
    #[must_use]
    pub fn imager_z_mm(&self) -> f64 {
        self.imager_z_mm
    }

    /// Index and absorption coefficient (1/mm) of a medium at a wavelength (nm).
    pub(super) fn medium(&self, medium: usize, wavelength_nm: f64) -> [f64; 2] {
        let table = &self.media[medium];
        let place = ((wavelength_nm - self.start_nm) * (1.0 / STEP_NM)).clamp(0.0, (table.len() - 1) as f64);
        let cell = (place as usize).min(table.len() - 2);
        let part = place - cell as f64;
        std::array::from_fn(|k| table[cell][k] + part * (table[cell + 1][k] - table[cell][k]))
    }

    /// Returns the medium of a room.
    pub(super) fn medium_of(&self, room: usize) -> usize {
        if room == 0 { self.skins[0].media[0] } else { self.skins[room - 1].media[1] }
    }

    /// Finds what light in a room meets next: the wall, the distance (mm) and the wall's unit normal against the light. Returns
    /// `None` if the light leaves in front of the lens, or passes a gap between rounded rims.
    pub(super) fn next(&self, room: usize, p: DVec3, d: DVec3) -> Option<(NextHit, f64, DVec3)> {
        let mut best: Option<(NextHit, f64, DVec3)> = None;
        let mut most = f64::INFINITY;
        if room > 0
            && let Some((t, normal)) = self.barrels[room - 1].meet(p, d)
        {
            (best, most) = (Some((NextHit::Paint, t, normal)), t);
        }
        if room == self.skins.len() {
            let t = (self.imager_z_mm - p.z) / d.z;
            if t > ON_THE_WALL_MM && t < most {
                let at = p + d * t;
                let ([x, y], [cx, cy]) = (self.half_mm, self.center_mm);
                let met =
                    if (at.x - cx).abs() <= x && (at.y - cy).abs() <= y { NextHit::Imager } else { NextHit::Paint };
                (best, most) = (Some((met, t, DVec3::Z)), t);
            }
        }
        let walls = [room.checked_sub(1), Some(room).filter(|k| *k < self.skins.len())];
        for k in walls.into_iter().flatten() {
            if let Some((t, at)) = self.skins[k].meet(p, d, most) {
                (best, most) = (Some((NextHit::Skin(k, self.skins[k].clear_at(at)), t, self.skins[k].normal(at))), t);
            }
        }
        best.map(|(met, t, normal)| (met, t, if normal.dot(d) > 0.0 { -normal } else { normal }))
    }
}

fn skin(lens: &Lens, at: usize) -> Wall {
    let e = &lens.elements[at];
    let reach = |e: &Element| {
        let size_mm = e.semi_diameter_mm?;
        let iris = e.apertures.iter().find_map(|a| match &a.shape {
            ApertureShape::Iris(iris) => Some(iris.opening(size_mm).corner_radius_mm()),
            _ => None,
        });
        Some(iris.unwrap_or(size_mm))
    };
    let own = reach(e);
    let near = [lens.elements[..at].iter().rev().find_map(reach), lens.elements[at + 1..].iter().find_map(reach)];
    let beside = near.into_iter().flatten().reduce(f64::max);
    // The barrel at a stop is as wide as the glass beside it.
    let outer = match (own, e.action) {
        (Some(own), Action::Pass) => own.max(beside.unwrap_or(own)),
        (Some(own), _) => own,
        (None, _) => beside.unwrap_or(1.0),
    };
    let c = e.surface.vertex_curvature_per_mm();
    let round = c.0 == c.1;
    let outer_mm = if round && c.0 != 0.0 { outer.min(MOST_OF_A_SPHERE / c.0.abs()) } else { outer };
    let sphere = |r: f64| c.0 * r * r / (1.0 + (1.0 - (c.0 * r) * (c.0 * r)).max(0.0).sqrt());
    let is_sphere = round
        && [[0.3, 0.1], [-0.2, 0.66], [0.7, -0.7], [0.0, 1.0]].iter().all(|[x, y]| {
            let (x, y) = (x * outer_mm, y * outer_mm);
            let sag = e.surface.sag_mm(x, y);
            sag.is_some_and(|sag| (sag - sphere((x * x + y * y).sqrt())).abs() < SAME_SHAPE * outer_mm.max(1.0))
        });
    Wall {
        pose: e.pose,
        form: if is_sphere { WallShape::Sphere(c.0) } else { WallShape::Sag(Arc::clone(&e.surface)) },
        clear2_mm2: own.map_or(f64::INFINITY, |own| own * own),
        outer_mm,
        apertures: e.apertures.clone(),
        semi_diameter_mm: e.semi_diameter_mm,
        refracts: e.action == Action::Refract && e.medium_before != e.medium_after,
        coating: lens.coating_of(e),
        separation: e.separation.clone(),
        layers: e.layers.clone(),
        media: [e.medium_before, e.medium_after],
    }
}

/// Returns the disk of the exit pupil, if the pupil lies in front of the imager.
fn pupil(lens: &Lens, skins: &[Wall], imager_z_mm: f64) -> Option<Disk> {
    let first_order = lens.first_order(lens.reference_nm);
    let (z_mm, scale) = (first_order.exit_pupil_z_mm?, first_order.exit_pupil_magnification?);
    let stop = &skins[lens.stop()?];
    let opening = if stop.clear2_mm2.is_finite() { stop.clear2_mm2.sqrt() } else { stop.outer_mm };
    let radius_mm = PUPIL_MARGIN * opening * scale.abs();
    (z_mm < imager_z_mm - 1.0 && radius_mm.is_finite() && radius_mm > 0.0).then_some(Disk { z_mm, radius_mm })
}
