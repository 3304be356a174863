//! The laws that every surface must obey.

use crate::ray::{Ray, Rays, outcome};
use crate::test_numbers::TestNumbers;
use glam::DVec3;
use spectra_core::loss::ALIVE;
use spectra_core::surface::{Action, BentRay, Surface};
use spectra_core::{Isa, Loss};

/// The laws of surfaces, with the facts about a surface that are needed to check them.
///
/// - A ray ends on the sag, on its own line, with a unit direction; the sag is never NaN.
/// - Refraction obeys Snell's law, n' d' x N = n d x N, in the plane of incidence; a mirror keeps the angle.
/// - If a surface has a phase, the phase bends light: along the surface, n' d' - n d is the gradient of the phase.
/// - Light is reversible.
/// - The result does not depend on how rays are split into batches, nor (bit by bit) on the instruction set, nor on dropped rays.
///   It depends on random numbers only if the surface says that it draws them ([`Surface::draws`]). Laws of single rays are
///   checked without numbers.
/// - Rays beyond the clear semi-diameter are vignetted. A lost ray keeps its cause and the surface's number; a ray that was lost
///   before is not touched.
/// - If the surface can be scaled, the scaled surface bends rays alike at proportionally scaled places.
/// - The curvature at the vertex is that of the sag, and rays near the axis are bent by the paraxial power.
/// - Wild rays (grazing, from far away, along the vertex plane) are met or lost; nothing panics and nothing is NaN.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceLaws {
    /// Largest distance from the axis at which rays are tried, mm.
    pub semi_diameter_mm: f64,
    /// Steepest slope of rays against the axis.
    pub steepest: f64,
    /// Largest distance from which rays start, mm.
    pub farthest_mm: f64,
    /// Whether light is bent by Snell's law; an ideal lens or a grating obeys another law.
    pub snell: bool,
    /// Whether returning light takes the same path.
    pub reversible: bool,
    /// Whether the vertex, where paraxial optics applies, is smooth and perpendicular to the axis; a cone's tip is not.
    pub smooth_vertex: bool,
    /// Largest distance from the sag at which a ray may end, mm.
    pub tolerance_mm: f64,
    /// Tolerance for directions; slopes computed by differences are good to about 1e-8.
    pub tolerance: f64,
    /// Number of rays of each sort.
    pub rays: usize,
}

impl Default for SurfaceLaws {
    /// Returns the laws of a smooth surface under Snell's law, with a semi-diameter of 10 mm.
    fn default() -> Self {
        Self {
            semi_diameter_mm: 10.0,
            steepest: 0.4,
            farthest_mm: 1000.0,
            snell: true,
            reversible: true,
            smooth_vertex: true,
            tolerance_mm: 1e-8,
            tolerance: 1e-7,
            rays: 2000,
        }
    }
}

/// Refractive indices before and after the surface: into glass, and out of it.
const INDICES: [(f64, f64); 2] = [(1.0, 1.7), (1.7, 1.0)];

impl SurfaceLaws {
    /// Checks all laws on a surface.
    ///
    /// # Panics
    /// At the first ray that breaks a law; the message describes it.
    pub fn hold(&self, surface: &dyn Surface) {
        for forward in [true, false] {
            let rays = self.some_rays(forward);
            for indices in INDICES {
                for action in [Action::Refract, Action::Reflect, Action::Pass] {
                    self.bends_each(surface, &rays, Rays { indices, action, ..Rays::default() });
                }
            }
            if surface.has_phase() {
                self.is_bent_by_its_phase(surface, &rays);
            }
            self.is_the_same_however_asked(surface, &rays);
            self.clips(surface, &rays);
        }
        self.scales(surface);
        self.is_known_to_paraxial_optics(surface);
        self.survives_wild_rays(surface);
    }

    /// Returns rays through points of the vertex plane, from near and far, in one sense of travel.
    fn some_rays(&self, forward: bool) -> Vec<Ray> {
        let spread = TestNumbers::new(if forward { 1 } else { 2 });
        let sense = if forward { 1.0 } else { -1.0 };
        let ray = |i: usize| {
            let (x, y) = spectra_core::math::concentric_disk(spread.at(i, 0), spread.at(i, 1));
            let (u, v) = spectra_core::math::concentric_disk(spread.at(i, 2), spread.at(i, 3));
            let d = DVec3::new(self.steepest * u, self.steepest * v, sense).normalize();
            let far = spectra_core::math::exp(spread.between(i, 4, 0.0, spectra_core::math::log(self.farthest_mm)));
            (self.semi_diameter_mm * DVec3::new(x, y, 0.0) - far * d, d)
        };
        (0..self.rays).map(ray).collect()
    }

    fn bends_each(&self, surface: &dyn Surface, rays: &[Ray], how: Rays) {
        let (n, m) = how.indices;
        let met = how.meet(surface, rays);
        let mut alive = 0;
        for (&(p, d), met) in rays.iter().zip(&met) {
            let case = || format!("{surface:?}, {:?} from {n} to {m}, ray at {p} mm along {d}", how.action);
            let Ok((q, after)) = *met else { continue };
            alive += 1;
            let sag = surface.sag_mm(q.x, q.y);
            let off = sag.map(|sag| (q.z - sag).abs());
            assert!(
                off.is_some_and(|off| off < self.tolerance_mm),
                "{}: ends at {q} mm, but the sag there is {sag:?}",
                case()
            );
            let aside = (q - p).cross(d).length();
            assert!(
                aside < self.tolerance_mm.max(1e-12 * (q - p).length()),
                "{}: ends {aside} mm off its own line",
                case()
            );
            let length = after.length();
            assert!((length - 1.0).abs() < 1e-12, "{}: the direction behind it has a length of {length}", case());
            if how.action == Action::Pass {
                assert!(after == d, "{}: passing on changes the direction to {after}", case());
                continue;
            }
            if let Some(normal) = normal(surface, q).filter(|_| self.snell) {
                let (law, broken) = if how.action == Action::Reflect {
                    ("the law of reflection", (after - (d - 2.0 * d.dot(normal) * normal)).length())
                } else {
                    ("Snell's law", (m * after.cross(normal) - n * d.cross(normal)).length())
                };
                assert!(broken < self.tolerance, "{}: {law} fails by {broken} at {q} mm, normal {normal}", case());
                let same_side = after.dot(normal) * d.dot(normal) > 0.0;
                assert!(same_side == (how.action == Action::Refract), "{}: goes on to the wrong side", case());
            }
            // On its way back, light at a grazing angle may meet a curved surface at another place first.
            if self.reversible && how.action == Action::Refract && after.z * d.z > 0.05 {
                let back = Rays { indices: (m, n), ..how }.meet(surface, &[(q + 0.5 * after, -after)])[0];
                if let Ok((there, out)) = back
                    && (there - q).length() < 1e-3
                {
                    let off = (out + d).length();
                    assert!(off < self.tolerance, "{}: its way back is along {out}, off by {off}", case());
                } else {
                    assert!(back.is_ok(), "{}: on its way back it ends with {back:?}", case());
                }
            }
        }
        let least = if how.action == Action::Refract { rays.len() / 10 } else { rays.len() / 2 };
        assert!(
            alive >= least,
            "{surface:?}: {:?} from {n} to {m}, only {alive} of {} rays go on; is the semi-diameter right?",
            how.action,
            rays.len()
        );
    }

    /// Checks that the phase bends parallel light, whose object is at infinity: the phase difference of neighboring rays must match their
    /// change of direction.
    fn is_bent_by_its_phase(&self, surface: &dyn Surface, rays: &[Ray]) {
        /// Distance between neighbors in mm. The error of the differences is proportional to its square.
        const STEP_MM: f64 = 1e-3;
        let mut compared = 0;
        for indices in INDICES {
            for action in [Action::Refract, Action::Reflect] {
                let how = Rays { indices, action, ..Rays::default() };
                let (n, m) = (indices.0, if action == Action::Reflect { indices.0 } else { indices.1 });
                for &(p, d) in rays {
                    for aside in [DVec3::X, DVec3::Y].map(|axis| axis * STEP_MM) {
                        let met = how.meet(surface, &[(p - aside, d), (p, d), (p + aside, d)]);
                        let [Ok((a, from)), Ok((_, after)), Ok((b, to))] = met[..] else { continue };
                        compared += 1;
                        let phase = |point, after| {
                            let of = BentRay {
                                point,
                                before: d,
                                after,
                                wavelength_nm: how.wavelength_nm,
                                n_before: n,
                                n_after: m,
                                object_mm: f64::INFINITY,
                            };
                            surface.phase_mm(&of)
                        };
                        let (got, want) = (phase(b, to) - phase(a, from), (m * after - n * d).dot(b - a));
                        assert!(
                            (got - want).abs() < 1e-5 * STEP_MM,
                            "{surface:?}: {action:?} from {n} to {m}, ray at {p} mm along {d}: between points {a} and {b} mm the phase \
                             differs by {got} mm; the directions of the bent rays need {want} mm"
                        );
                    }
                }
            }
        }
        assert!(
            compared > rays.len() / 5,
            "{surface:?}: only {compared} rays with neighbors go on; is the semi-diameter right?"
        );
    }

    /// Checks that other batches and other instruction sets give the same rays.
    fn is_the_same_however_asked(&self, surface: &dyn Surface, rays: &[Ray]) {
        let clip_mm = 0.8 * self.semi_diameter_mm;
        let how = Rays { indices: INDICES[1], clip_mm, seed: Some(1), ..Rays::default() };
        let want = how.meet(surface, rays);
        let chance = [Some(2), None].map(|seed| Rays { seed, ..how }.meet(surface, rays));
        for other in chance.iter().filter(|_| !surface.draws()) {
            if let Some(i) = differs(other, &want) {
                panic!("{surface:?}: ray {i} gives {:?} or {:?} at random; `draws` denies it", other[i], want[i]);
            }
        }
        let mut few = how.send(rays, 0);
        few.columns_mut().state.iter_mut().step_by(2).for_each(|state| *state = Loss::Absorbed.state(3));
        few.compact();
        how.interact(surface, &mut few);
        for (at, i) in (1..rays.len()).step_by(2).enumerate() {
            let got = outcome(&few, at);
            assert!(got == want[i], "{surface:?}: ray {i} gives {got:?} if others were dropped, else {:?}", want[i]);
        }
        for batch in [1, 7, 64, 1024] {
            let got = Rays { batch, ..how }.meet(surface, rays);
            if let Some(i) = differs(&got, &want) {
                panic!(
                    "{surface:?}: ray {i} gives {:?} in batches of {batch}, {:?} in batches of 256",
                    got[i], want[i]
                );
            }
        }
        for isa in Isa::available() {
            let got = Rays { isa, ..how }.meet(surface, rays);
            if let Some(i) = differs(&got, &want) {
                panic!("{surface:?}: ray {i} gives {:?} on {}, {:?} on baseline", got[i], isa.name(), want[i]);
            }
        }
    }

    fn clips(&self, surface: &dyn Surface, rays: &[Ray]) {
        let clip_mm = 0.7 * self.semi_diameter_mm;
        let open = Rays { action: Action::Pass, ..Rays::default() };
        let free = open.meet(surface, rays);
        let clipped = Rays { clip_mm, ..open }.meet(surface, rays);
        for (i, (free, clipped)) in free.iter().zip(&clipped).enumerate() {
            let Ok((q, _)) = free else {
                assert_eq!(free, clipped, "{surface:?}: ray {i} ends differently if the surface is clipped");
                continue;
            };
            let radius = q.truncate().length();
            let want = if radius <= clip_mm { *free } else { Err(Loss::Vignetted) };
            let near = (radius - clip_mm).abs() < 1e-9;
            assert!(
                near || *clipped == want,
                "{surface:?}: ray {i} meets it {radius} mm off the axis, clipped at {clip_mm} mm: {clipped:?}"
            );
        }
        // Every second ray has already ended; its state must not change.
        let mut batch = Rays { clip_mm, ..open }.send(rays, 0);
        let before = Loss::Absorbed.state(3);
        batch.columns_mut().state.iter_mut().step_by(2).for_each(|state| *state = before);
        let lost = Rays { clip_mm, ..open }.interact(surface, &mut batch);
        let newly = batch.states().iter().filter(|s| **s != ALIVE && **s != before).count();
        assert_eq!(lost, newly, "{surface:?}: `interact` returns {lost}, but {newly} rays ended");
        for i in 0..rays.len() {
            if i % 2 == 0 {
                assert_eq!(batch.states()[i], before, "{surface:?}: ray {i}, which had ended before, ends again");
            } else {
                assert!(
                    outcome(&batch, i) == clipped[i],
                    "{surface:?}: ray {i} depends on whether its neighbors are alive"
                );
            }
        }
    }

    fn scales(&self, surface: &dyn Surface) {
        const FACTOR: f64 = 2.5;
        let Some(larger) = surface.scaled(FACTOR) else { return };
        for indices in INDICES {
            let how = Rays { indices, ..Rays::default() };
            let rays = self.some_rays(true);
            let far: Vec<Ray> = rays.iter().map(|(p, d)| (*p * FACTOR, *d)).collect();
            let [own, of_larger] = [how.meet(surface, &rays), how.meet(&*larger, &far)];
            let (mut compared, mut apart) = (0, 0);
            for (i, (own, of_larger)) in own.iter().zip(&of_larger).enumerate() {
                let (Ok((p, d)), Ok((q, e))) = (own, of_larger) else {
                    // A ray at the very edge of the surface may be lost by rounding.
                    apart += usize::from(own.is_err() != of_larger.is_err());
                    continue;
                };
                compared += 1;
                let same =
                    (*p * FACTOR - *q).length() < FACTOR * self.tolerance_mm && (*d - *e).length() < self.tolerance;
                assert!(same, "{surface:?}: ray {i} ends as {own:?}, but {FACTOR} times as large as {of_larger:?}");
            }
            assert!(
                compared > self.rays / 20 && apart <= self.rays / 100,
                "{surface:?}: of {} rays, {compared} go on at both sizes and {apart} at only one of them",
                self.rays
            );
        }
    }

    fn is_known_to_paraxial_optics(&self, surface: &dyn Surface) {
        if !self.smooth_vertex {
            return;
        }
        let at = |x: f64, y: f64| surface.sag_mm(x, y).unwrap_or(f64::NAN);
        assert!(at(0.0, 0.0).abs() < 1e-9, "{surface:?}: the sag at the vertex is {} mm, not 0", at(0.0, 0.0));
        let curvature: [f64; 2] = surface.vertex_curvature_per_mm().into();
        let h = 1e-2 * self.semi_diameter_mm.min(1.0);
        for (axis, stated) in ["x", "y"].into_iter().zip(curvature) {
            let along = |k: f64| if axis == "x" { at(k * h, 0.0) } else { at(0.0, k * h) };
            // A fourth-order difference; the remainder with the sixth derivative is negligible here.
            let second =
                (16.0 * (along(1.0) + along(-1.0)) - (along(2.0) + along(-2.0)) - 30.0 * along(0.0)) / (12.0 * h * h);
            let close = (stated - second).abs() < 1e-5 * (stated.abs() + 0.01);
            assert!(close, "{surface:?}: curvature along {axis} is stated as {stated} per mm; the sag has {second}");
        }
        // n' u' = n u - power h, for a ray along the axis.
        let h = 1e-4;
        for (n, m) in INDICES {
            let power: [f64; 2] = surface.paraxial_power_per_mm(n, m).into();
            for (axis, (power, place)) in [DVec3::X, DVec3::Y].into_iter().zip(power.into_iter().zip(["x", "y"])) {
                let rays = [axis * h - DVec3::Z, -axis * h - DVec3::Z].map(|p| (p, DVec3::Z));
                let met = Rays { indices: (n, m), ..Rays::default() }.meet(surface, &rays);
                let [Ok((_, a)), Ok((_, b))] = met[..] else {
                    panic!("{surface:?}: a ray next to the axis ends: {met:?}");
                };
                // The difference of two rays cancels a tilt or a grating's order, which bends both alike.
                let slope = 0.5 * ((a / a.z).dot(axis) - (b / b.z).dot(axis));
                let close = (m * slope + power * h).abs() < 2e-5 * h * (power.abs() + 0.01);
                assert!(
                    close || !self.snell && a.truncate().length() > 1e-2,
                    "{surface:?}: from {n} to {m} the power in the section of {place} is stated as {power} per mm; a ray \
                     {h} mm off the axis has {}",
                    -m * slope / h
                );
            }
        }
    }

    /// Checks that wild rays are met or lost, without panic or NaN.
    fn survives_wild_rays(&self, surface: &dyn Surface) {
        let r = self.semi_diameter_mm;
        let spread = TestNumbers::new(3);
        for sense in [1.0, -1.0] {
            let mut rays = Vec::new();
            for i in 0..200 {
                let spot = DVec3::new(spread.between(i, 0, -30.0, 30.0), spread.between(i, 1, -30.0, 30.0), 0.0) * r;
                let (u, v) = (spread.between(i, 2, -1.0, 1.0), spread.between(i, 3, -1.0, 1.0));
                for (steep, far) in [(1e-3, 1e12), (1.0, 10.0 * r), (1e3, 10.0 * r), (1e9, r), (1e-300, 0.0)] {
                    let d = DVec3::new(steep * u, steep * v, sense).normalize();
                    rays.push((spot - far * d, d));
                }
            }
            // Rays along the vertex plane and beside it, and one that starts at the vertex.
            rays.extend([0.0, 0.5 * r, -3.0].map(|z| (DVec3::new(-2.0 * r, 0.0, z), DVec3::X)));
            rays.push((DVec3::ZERO, DVec3::Z * sense));
            for action in [Action::Refract, Action::Reflect, Action::Pass] {
                let how = Rays { action, ..Rays::default() };
                for (i, met) in how.meet(surface, &rays).iter().enumerate() {
                    let Ok((q, d)) = met else { continue };
                    let (p, along) = rays[i];
                    assert!(
                        q.is_finite() && d.is_finite(),
                        "{surface:?}: {action:?}, a wild ray at {p} mm along {along} gives {q} and {d}"
                    );
                }
            }
            for (p, _) in &rays {
                let sag = surface.sag_mm(p.x, p.y);
                assert!(!sag.is_some_and(f64::is_nan), "{surface:?}: the sag at ({}, {}) mm is NaN", p.x, p.y);
            }
        }
    }
}

/// Returns the index of the first ray that is not the same bit by bit.
fn differs(a: &[Result<Ray, Loss>], b: &[Result<Ray, Loss>]) -> Option<usize> {
    let bits = |(p, d): &Ray| [p.x, p.y, p.z, d.x, d.y, d.z].map(f64::to_bits);
    a.iter().zip(b).position(|(a, b)| match (a, b) {
        (Ok(a), Ok(b)) => bits(a) != bits(b),
        (a, b) => a != b,
    })
}

/// Returns the unit normal by differences of the sag; `None` next to the edge of the surface.
fn normal(surface: &dyn Surface, q: DVec3) -> Option<DVec3> {
    let h = 1e-3;
    let along = |dx: f64, dy: f64| {
        let at = |k: f64| surface.sag_mm(q.x + k * h * dx, q.y + k * h * dy);
        let (a, b) = (8.0 * (at(1.0)? - at(-1.0)?), at(2.0)? - at(-2.0)?);
        Some((a - b) / (12.0 * h))
    };
    Some(DVec3::new(-along(1.0, 0.0)?, -along(0.0, 1.0)?, 1.0).normalize())
}
