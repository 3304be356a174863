//! Meridional fans: the rays of one field angle that a lens lets through, found by tracing.

use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::math::{cos, sin};
use spectra_core::{Isa, RayBatch};
use spectra_glass::DispersionError;
use spectra_lens::{Indices, Lens, RayPath, Section, Tracer, Travel};

/// Rays tried across the front of the lens.
const TRIED: usize = 1201;
/// Halvings at the ends of what passes: the step of the search over 2^20.
const HALVINGS: usize = 20;
/// How far beyond the largest surface the search goes, as parts of it.
const REACH: f64 = 2.5;
/// Half the height of the search where no surface states a size, as part of the focal length.
const REACH_OF_FOCAL_LENGTH: f64 = 1.0;

/// Finds fans of one lens in one light.
#[derive(Debug)]
pub struct FanFinder<'a> {
    lens: &'a Lens,
    tracer: Tracer,
    section: Section,
    wavelength_nm: f64,
    /// Point of the axis that the rays aim about, mm from the first vertex.
    aim_z_mm: f64,
    reach_mm: f64,
    /// Whether every surface states a size.
    is_sized: bool,
}

/// The rays of one object point in one section that pass: where they cross the line through the aim, across them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// Angle to the axis, rad: positive for light that comes from below (or from -x).
    pub field_rad: f64,
    /// Distance of the object from the first vertex, mm; infinity allowed.
    pub object_mm: f64,
    /// Lowest ray, mm.
    pub low_mm: f64,
    /// Highest ray, mm.
    pub high_mm: f64,
}

impl<'a> FanFinder<'a> {
    /// For a lens at one wavelength, nm.
    ///
    /// # Errors
    /// A medium has no index there.
    pub fn new(lens: &'a Lens, section: Section, wavelength_nm: f64) -> Result<Self, DispersionError> {
        let first_order = lens.first_order_in(section, wavelength_nm);
        let extent = lens
            .elements
            .iter()
            .flat_map(|e| [e.semi_diameter_mm, e.outer_semi_diameter_mm])
            .flatten()
            .reduce(f64::max)
            .unwrap_or_else(|| (REACH_OF_FOCAL_LENGTH * first_order.efl_mm.abs()).clamp(0.1, 1e4));
        let pupil = first_order.entrance_pupil_z_mm.filter(|z| z.is_finite() && z.abs() < 100.0 * extent);
        Ok(Self {
            tracer: Tracer::new(lens, Indices::At(wavelength_nm), Isa::Baseline)?,
            lens,
            section,
            wavelength_nm,
            aim_z_mm: pupil.unwrap_or(0.0),
            reach_mm: REACH * extent,
            is_sized: lens.elements.iter().all(|e| e.stop || e.semi_diameter_mm.is_some()),
        })
    }

    /// Start (mm, frame of the lens) and direction of the ray that crosses the aim's line at `s_mm`.
    #[must_use]
    pub fn ray(&self, field_rad: f64, object_mm: f64, s_mm: f64) -> (DVec3, DVec3) {
        let (sin, cos) = (sin(field_rad), cos(field_rad));
        let across = |v: f64, z: f64| match self.section {
            Section::X => DVec3::new(v, 0.0, z),
            Section::Y => DVec3::new(0.0, v, z),
        };
        let aim = across(0.0, self.aim_z_mm) + s_mm * across(cos, -sin);
        if object_mm.is_finite() {
            let object = across(-(object_mm + self.aim_z_mm) * sin / cos, -object_mm);
            return (object, (aim - object).normalize());
        }
        let direction = across(sin, cos);
        // Far enough in front that no surface lies before the start.
        (aim - direction * (3.0 * self.reach_mm + self.aim_z_mm.abs()), direction)
    }

    /// Whether a ray passes: it ends nowhere, and nowhere runs back between surfaces that have crossed, which only a
    /// lens without stated sizes lets it.
    fn passes(&self, field_rad: f64, object_mm: f64, s_mm: f64) -> bool {
        let path = self.path(field_rad, object_mm, s_mm);
        if path.end.is_some() || self.is_sized {
            return path.end.is_none();
        }
        let steps = path.points.iter().skip(1).zip(path.points.iter().skip(2));
        steps.zip(&self.lens.elements).enumerate().all(|(at, ((from, to), e))| {
            let next = self.lens.elements[at + 1].pose.origin_mm;
            (*to - *from).dot(next - e.pose.origin_mm) >= 0.0
        })
    }

    /// The path of a ray through the lens.
    #[must_use]
    pub fn path(&self, field_rad: f64, object_mm: f64, s_mm: f64) -> RayPath {
        let (position, direction) = self.ray(field_rad, object_mm, s_mm);
        self.tracer.path(position, direction, self.wavelength_nm)
    }

    /// The fan of a field angle; `None` where nothing passes. Where several bundles pass, the widest.
    #[must_use]
    pub fn fan(&self, field_rad: f64, object_mm: f64) -> Option<Fan> {
        let at = |i: f64| self.at(i);
        let passed: Vec<bool> = self.passed(field_rad, object_mm).collect();
        let (mut best, mut start) = (0..0, None);
        for i in 0..=TRIED {
            match (passed.get(i).copied().unwrap_or(false), start) {
                (true, None) => start = Some(i),
                (false, Some(from)) => {
                    if i - from > best.len() {
                        best = from..i;
                    }
                    start = None;
                }
                _ => {}
            }
        }
        if best.is_empty() {
            return None;
        }
        let passes = |s_mm: f64| self.passes(field_rad, object_mm, s_mm);
        let edge = |inside: f64, outside: f64| {
            let (mut inside, mut outside) = (inside, outside);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (inside + outside);
                if passes(middle) {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            inside
        };
        let (first, last) = (best.start as f64, (best.end - 1) as f64);
        let low_mm = edge(at(first), at(first - 1.0));
        let high_mm = edge(at(last), at(last + 1.0));
        Some(Fan { field_rad, object_mm, low_mm, high_mm })
    }

    /// Where a ray that is tried crosses the line through the aim, mm.
    fn at(&self, i: f64) -> f64 {
        i * (2.0 * self.reach_mm / (TRIED - 1) as f64) - self.reach_mm
    }

    /// Whether anything passes.
    fn sees(&self, field_rad: f64, object_mm: f64) -> bool {
        self.passed(field_rad, object_mm).any(|passes| passes)
    }

    /// Of each ray that is tried, whether it passes.
    fn passed(&self, field_rad: f64, object_mm: f64) -> impl Iterator<Item = bool> {
        let mut rays = RayBatch::new(TRIED);
        rays.restart(TRIED);
        let c = rays.columns_mut();
        for i in 0..TRIED {
            let (position, direction) = self.ray(field_rad, object_mm, self.at(i as f64));
            (c.x[i], c.y[i], c.z[i]) = position.into();
            (c.l[i], c.m[i], c.n[i]) = direction.into();
            c.wavelength_nm[i] = self.wavelength_nm;
        }
        self.tracer.trace(&mut rays, &mut self.tracer.work_in_place(TRIED), Travel::Forward);
        let passes = move |i: usize| {
            rays.states()[i] == ALIVE && (self.is_sized || self.passes(field_rad, object_mm, self.at(i as f64)))
        };
        (0..TRIED).map(passes)
    }

    /// The largest field angle at which anything passes, rad, up to `limit_rad`: to 0.01 degrees.
    #[must_use]
    pub fn largest_field_rad(&self, object_mm: f64, limit_rad: f64) -> Option<f64> {
        if !self.sees(0.0, object_mm) {
            return None;
        }
        // From the middle outward: a lens may be blind between two bundles, which is not its field.
        let step = 1.0_f64.to_radians();
        let (mut seen, mut next) = (0.0, step);
        while next <= limit_rad && self.sees(next, object_mm) {
            seen = next;
            next += step;
        }
        let mut blind = next.min(limit_rad);
        while blind - seen > 0.01_f64.to_radians() {
            let middle = 0.5 * (seen + blind);
            if self.sees(middle, object_mm) {
                seen = middle;
            } else {
                blind = middle;
            }
        }
        Some(seen)
    }
}
