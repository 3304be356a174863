//! Bundles: which rays of a point pass a lens, and how far they reach.
//!
//! Every figure of a lens starts with this question: the marginal and the chief ray, the limit of the field, the focus, the pupil for
//! diffraction. A [`Bundle`] answers it for the light of one point, in front of the lens or behind it, at one wavelength. Each ray is
//! identified by where it crosses the *window*, a plane across the line from the point to the surface that light meets first:
//!
//! - [`Bundle::extent`] finds the rectangle of the window that contains everything that passes;
//! - [`Bundle::zones`] finds where along a line across the window rays begin and stop passing;
//! - [`Bundle::through`] finds the ray that meets a surface at a given point, such as the center of the stop;
//! - [`Bundle::trace`] traces rays at the positions of a [`RayPattern`].
//!
//! All methods use real rays. Small openings between the rays of a first scan are missed; each method says how finely it scans. The
//! renderer needs tables for all points of a frame at once and has its own searches in [`crate::aim`].

mod pattern;
mod window;

pub use pattern::RayPattern;
pub(crate) use window::Window;
pub use window::{Extent, ObjectPoint};

use crate::{Clipping, Optics};
use glam::{DVec2, DVec3};
use spectra_core::loss::ALIVE;
use spectra_core::{Loss, RayBatch};
use spectra_glass::DispersionError;
use spectra_tracer::{Indices, Path, RayPath, Tracer, Travel, Work};
use std::sync::Arc;

/// Number of rays that are traced at a time, so that their columns stay in the caches.
const BATCH: usize = 1024;
/// Number of parts into which each step of the search cuts the interval that contains an end of a zone.
const PARTS: usize = 32;
/// Grids, in cells per side, on which [`Bundle::extent`] searches for light, one after the other until a ray passes.
const GRIDS: [usize; 3] = [32, 100, 256];
/// Largest number of Newton steps in [`Bundle::through`]. A handful usually suffices, with halvings where the light is lost.
const NEWTON_STEPS: usize = 40;
/// Half the step of the numerical derivatives in Newton's method, as a fraction of the window's half side.
const SLOPE_STEP: f64 = 1e-5;
/// Distance from the target on a surface at which Newton's method stops, and the largest that is accepted at the end, mm.
const AT_PLACE_MM: f64 = 1e-10;
const NEAR_PLACE_MM: f64 = 1e-6;

/// A straight line across a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowLine {
    /// Start of the line in the window, mm.
    pub from: [f64; 2],
    /// Unit vector along the line.
    pub way: [f64; 2],
    /// Length of the line, mm.
    pub length_mm: f64,
}

impl WindowLine {
    /// Returns the point of the window at `along_mm` from the start of the line.
    #[must_use]
    pub fn at(&self, along_mm: f64) -> [f64; 2] {
        [0, 1].map(|k| self.from[k] + along_mm * self.way[k])
    }
}

/// The light of one point at one wavelength. Its methods find which of its rays pass a lens, and how far they reach.
#[derive(Debug)]
pub struct Bundle<'o> {
    optics: &'o Optics,
    tracer: Arc<Tracer>,
    indices: Indices,
    travel: Travel,
    wavelength_nm: f64,
    window: Window,
    /// Whether the plates in front of the frame shift the rays that start there.
    covered: bool,
}

impl<'o> Bundle<'o> {
    /// Returns the bundle of a point in front of the lens; `None` if no light of the point runs toward the lens.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn before(optics: &'o Optics, point: ObjectPoint, indices: Indices) -> Result<Option<Self>, DispersionError> {
        Self::through_window(optics, Window::before(optics, point), indices, Travel::Forward)
    }

    /// Returns the bundle of a point behind the lens, mm in the frame of the image plane. Its rays run backward, through the plates
    /// in front of the frame if there are any. Returns `None` if the lens has no surface.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn behind(optics: &'o Optics, point_mm: DVec3, indices: Indices) -> Result<Option<Self>, DispersionError> {
        Self::through_window(optics, Window::behind(optics, point_mm), indices, Travel::Backward)
    }

    fn through_window(
        optics: &'o Optics,
        window: Option<Window>,
        indices: Indices,
        travel: Travel,
    ) -> Result<Option<Self>, DispersionError> {
        let Some(window) = window else { return Ok(None) };
        let wavelength_nm = match indices {
            Indices::At(nm) => nm,
            Indices::Band { .. } | Indices::Stated => optics.reference_nm,
        };
        let tracer = optics.tracer(indices)?;
        let covered = travel == Travel::Backward && optics.cover.is_some();
        Ok(Some(Self { optics, tracer, indices, travel, wavelength_nm, window, covered }))
    }

    /// Returns this bundle for a lens with other rims and apertures.
    ///
    /// # Errors
    /// A medium has no usable index.
    pub fn clipped(self, clipping: Clipping) -> Result<Self, DispersionError> {
        Ok(Self { tracer: self.optics.tracer_clipping(self.indices, clipping)?, ..self })
    }

    /// Returns half the side of the window, mm. The window contains the crossing of every ray that can reach the lens.
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        self.window.reach_mm
    }

    /// Returns the line from the middle of the window along its second axis, to the window's edge. For a point on the axis or in
    /// the y-z section the line lies in that section.
    #[must_use]
    pub fn upward(&self) -> WindowLine {
        WindowLine { from: [0.0; 2], way: [0.0, 1.0], length_mm: self.window.reach_mm }
    }

    /// Returns the ray through a point of the window in front of the lens: its starting point (mm) and its unit direction.
    #[must_use]
    pub fn ray(&self, place: [f64; 2]) -> (DVec3, DVec3) {
        let (start, direction) = self.window.ray(place);
        if !self.covered {
            return (start, direction);
        }
        // Toward the lens, in front of the plates, a ray runs as if it had started nearer to the lens.
        let slope = (direction.x * direction.x + direction.y * direction.y).sqrt() / direction.z.abs();
        let depth_mm = self.optics.cover.as_ref().map_or(0.0, |cover| cover.depth_mm(slope, self.wavelength_nm));
        (start - DVec3::new(0.0, 0.0, depth_mm), direction)
    }

    /// Follows the ray through a point of the window in front of the lens, surface by surface.
    #[must_use]
    pub fn path(&self, place: [f64; 2]) -> RayPath {
        let (start, direction) = self.ray(place);
        self.tracer.path(start, direction, self.wavelength_nm)
    }

    /// Puts the rays through `places` into a batch. Their weights are the solid angles of equal cells, relative to one in the middle.
    fn launch(&self, rays: &mut RayBatch, places: &[[f64; 2]]) {
        rays.restart(places.len());
        let c = rays.columns_mut();
        for (i, place) in places.iter().copied().enumerate() {
            let (start, direction) = self.ray(place);
            (c.x[i], c.y[i], c.z[i]) = start.into();
            (c.l[i], c.m[i], c.n[i]) = direction.into();
            c.wavelength_nm[i] = self.wavelength_nm;
            c.weight[i] = self.window.share(place);
        }
    }

    /// Traces the rays through `places` and returns them as they leave the lens. Ray i belongs to `places[i]`. Its weight is the
    /// solid angle of a cell at this place, relative to an equal cell in the middle of the window, times the transmittance of the
    /// lens.
    #[must_use]
    pub fn trace(&self, places: &[[f64; 2]]) -> RayBatch {
        let mut rays = RayBatch::new(places.len());
        self.launch(&mut rays, places);
        self.tracer.trace(&mut rays, &mut self.tracer.work_in_place(places.len()), self.travel);
        rays
    }

    /// Traces the rays through `places` without weights and calls `seen` with the number and the state of each.
    fn trace_each(&self, places: &[[f64; 2]], mut seen: impl FnMut(usize, u64)) {
        let capacity = places.len().min(BATCH);
        let (mut rays, mut work) = (RayBatch::new(capacity), self.tracer.work_unweighed(capacity));
        for (part, places) in places.chunks(BATCH).enumerate() {
            self.launch(&mut rays, places);
            self.tracer.trace(&mut rays, &mut work, self.travel);
            rays.states().iter().enumerate().for_each(|(i, state)| seen(part * BATCH + i, *state));
        }
    }

    /// Returns for each point of the window in `places` whether its ray passes the lens.
    #[must_use]
    pub fn passes(&self, places: &[[f64; 2]]) -> Vec<bool> {
        let mut passes = vec![false; places.len()];
        self.trace_each(places, |i, state| passes[i] = state == ALIVE);
        passes
    }

    /// Returns the rectangle of the window that contains all rays that pass, to within a cell of the first grid that finds such
    /// rays.
    ///
    /// # Errors
    /// No ray passes. The error is the last surface (from 1) that any ray reached, and why rays end there.
    pub fn extent(&self) -> Result<Extent, Option<(Loss, u32)>> {
        let mut last = None;
        for cells in GRIDS {
            match self.extent_within(self.window.whole(), cells) {
                Ok(extent) => return Ok(extent),
                Err(why) => last = why,
            }
        }
        Err(last)
    }

    /// Returns the rectangle around the passing rays of a grid of `cells` by `cells` rays over `part` of the window, enlarged by
    /// a cell on each side.
    ///
    /// # Errors
    /// No ray passes. The error is the last surface (from 1) that any ray reached, and why rays end there.
    pub fn extent_within(&self, part: Extent, cells: usize) -> Result<Extent, Option<(Loss, u32)>> {
        let places: Vec<[f64; 2]> = RayPattern::Grid(cells).places(part).collect();
        let (mut found, mut end): (Option<Extent>, Option<(Loss, u32)>) = (None, None);
        self.trace_each(&places, |i, state| {
            let place = places[i];
            if state == ALIVE {
                let old = found.unwrap_or(Extent { min: place, max: place });
                let min = [0, 1].map(|k| old.min[k].min(place[k]));
                let max = [0, 1].map(|k| old.max[k].max(place[k]));
                found = Some(Extent { min, max });
            } else if let Some(own) = Loss::of_state(state).filter(|own| end.is_none_or(|end| own.1 >= end.1)) {
                end = Some(own);
            }
        });
        let cell = part.cell_mm(cells);
        let grown =
            |e: Extent| Extent { min: [0, 1].map(|k| e.min[k] - cell[k]), max: [0, 1].map(|k| e.max[k] + cell[k]) };
        found.map(grown).ok_or(end)
    }

    /// Returns the intervals of a line across the window in which rays pass. Each is given by the distances (mm) of its first and
    /// its last passing ray from the start of the line. A first scan uses `probes` + 1 rays; then the ends are found to
    /// `accuracy` times the length of the line. An interval that reaches the end of the line ends there.
    #[must_use]
    pub fn zones(&self, line: &WindowLine, probes: usize, accuracy: f64) -> Vec<[f64; 2]> {
        let step = line.length_mm / probes as f64;
        let along: Vec<f64> = (0..=probes).map(|i| step * i as f64).collect();
        let passes = self.passes(&along.iter().map(|t| line.at(*t)).collect::<Vec<_>>());
        let edge = |passing, blocked| self.edge(line, [passing, blocked], accuracy * line.length_mm);
        let mut zones = Vec::new();
        let mut start = passes[0].then_some(0.0);
        for i in 1..=probes {
            match (passes[i - 1], passes[i]) {
                (false, true) => start = Some(edge(along[i], along[i - 1])),
                (true, false) => zones.extend(start.take().map(|start| [start, edge(along[i - 1], along[i])])),
                _ => {}
            }
        }
        zones.extend(start.map(|start| [start, line.length_mm]));
        zones
    }

    /// Returns the last passing distance along a line, between a distance that passes and one that does not, mm.
    fn edge(&self, line: &WindowLine, [mut passing, mut blocked]: [f64; 2], accuracy_mm: f64) -> f64 {
        while (blocked - passing).abs() > accuracy_mm {
            let step = (blocked - passing) / PARTS as f64;
            let along: Vec<f64> = (1..PARTS).map(|i| passing + step * i as f64).collect();
            let places: Vec<[f64; 2]> = along.iter().map(|t| line.at(*t)).collect();
            let first = self.passes(&places).iter().position(|passes| !passes).unwrap_or(along.len());
            let next = [
                if first > 0 { along[first - 1] } else { passing },
                if first < along.len() { along[first] } else { blocked },
            ];
            if next == [passing, blocked] {
                break;
            }
            [passing, blocked] = next;
        }
        passing
    }

    /// Returns the points where the rays through `places` meet an element, mm in the frame of its pose; `None` for rays that end
    /// before it or at it.
    #[must_use]
    pub fn meet(&self, element: usize, places: &[[f64; 2]]) -> Vec<Option<DVec2>> {
        let path = Path::through(self.tracer.surfaces(), self.travel).up_to(|at| at == element);
        let route = self.tracer.route(&path);
        let mut rays = RayBatch::new(places.len());
        let mut work: Work = self.tracer.work_unweighed(places.len());
        self.launch(&mut rays, places);
        let mut met = vec![None; places.len()];
        self.tracer.follow_each(&route, &mut rays, &mut work, |at, rays| {
            if at == element {
                let [x, y, _] = rays.positions();
                for (i, met) in met.iter_mut().enumerate().filter(|(i, _)| rays.states()[*i] == ALIVE) {
                    *met = Some(DVec2::new(x[i], y[i])).filter(|p| p.is_finite());
                }
            }
        });
        met
    }

    /// Returns the point of the window whose ray meets an element at `target` (mm, frame of the element's pose). It uses Newton's
    /// method in two dimensions from `guess`, with steps halved while they bring no improvement. Returns `None` if no ray comes
    /// within 1e-6 mm of the target.
    #[must_use]
    pub fn through(&self, element: usize, target: DVec2, guess: [f64; 2]) -> Option<[f64; 2]> {
        let miss = |place: [f64; 2]| Some(self.meet(element, &[place])[0]? - target);
        let h = SLOPE_STEP * self.window.reach_mm;
        let mut place = guess;
        let mut off = miss(place)?;
        for _ in 0..NEWTON_STEPS {
            if off.length() < AT_PLACE_MM {
                return Some(place);
            }
            let [a, b] = place;
            let around = self.meet(element, &[[a - h, b], [a + h, b], [a, b - h], [a, b + h]]);
            let across = (around[1]? - around[0]?) / (2.0 * h);
            let along = (around[3]? - around[2]?) / (2.0 * h);
            let step = DVec2::new(off.perp_dot(along), across.perp_dot(off)) / across.perp_dot(along);
            if !step.is_finite() {
                return None;
            }
            let mut part = 1.0;
            let better = loop {
                let next = [a - part * step.x, b - part * step.y];
                match miss(next) {
                    Some(next_off) if next_off.length() < off.length() => break Some((next, next_off)),
                    _ if part < 1e-3 => break None,
                    _ => part *= 0.5,
                }
            };
            match better {
                Some(next) => (place, off) = next,
                // No improvement in the last digits: this is the point.
                None => break,
            }
        }
        (off.length() < NEAR_PLACE_MM).then_some(place)
    }
}
