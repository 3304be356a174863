//! Surfaces that draw random numbers: which numbers they get, and where light is aimed.

use glam::{DVec2, DVec3};
use spectra_core::numbers::{Numbers, RayNumbers, StageKey};
use spectra_core::surface::{Bending, Intersection, Kernel, PerRay, ScalarShape, Surface};
use spectra_core::{Loss, RayBatch};
use spectra_lens::{Element, Lens};
use spectra_optics::{FrontPupil, RearPupil};
use spectra_plugin_surfaces::{Plane, Sphere, ThinLens};
use spectra_tracer::{Indices, Path, Tracer, Travel};
use std::sync::Arc;

/// A plane that turns rays by the numbers that it draws.
#[derive(Debug)]
struct Scatter;

fn turn(numbers: &RayNumbers) -> DVec2 {
    (DVec2::from_array(numbers.pair(0)) - 0.5) * 0.2
}

impl ScalarShape for Scatter {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        Some(Intersection { distance_mm: -position.z / direction.z, normal: DVec3::Z })
    }
    fn sag_mm(&self, _: f64, _: f64) -> Option<f64> {
        Some(0.0)
    }
    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (0.0, 0.0)
    }
    fn draws(&self) -> bool {
        true
    }
    fn redirect(&self, at: &Bending) -> Option<Result<DVec3, Loss>> {
        Some(Ok((at.direction + turn(&at.numbers?).extend(0.0)).normalize()))
    }
}

/// Surfaces in air: kind, thickness, semi-diameter, mm.
fn lens(surfaces: &[(&str, f64, f64)]) -> Lens {
    let mut lens = Lens::empty("by hand");
    for (kind, thickness_mm, semi_diameter_mm) in surfaces {
        let surface: Arc<dyn Surface> = match *kind {
            "stop" => Arc::new(Kernel(Plane::stop())),
            "sphere" => Arc::new(Kernel(Sphere::new(80.0))),
            "window" => Arc::new(Kernel(Plane::refracting())),
            "lens" => Arc::new(PerRay(ThinLens::new(50.0))),
            _ => Arc::new(PerRay(Scatter)),
        };
        let (thickness_mm, semi_diameter_mm) = (*thickness_mm, Some(*semi_diameter_mm));
        lens.elements.push(Element { thickness_mm, semi_diameter_mm, ..Element::new(kind, surface, 0, 0) });
    }
    lens.arrange();
    lens
}

fn tracer(lens: &Lens) -> Tracer {
    Tracer::new(lens, Indices::At(550.0)).expect("media")
}

const RAYS: usize = 500;

/// Returns the directions, by tag, in which rays leave that start spread over 8 mm; `batch` rays are traced at a time.
fn directions(lens: &Lens, path: &Path, batch: usize, seed: Option<u64>) -> Vec<(u32, DVec3)> {
    let tracer = tracer(lens);
    let (route, mut work) = (tracer.route(path), tracer.work(batch));
    let mut out = Vec::new();
    for first in (0..RAYS).step_by(batch) {
        let mut rays = RayBatch::new(batch).with_numbers();
        rays.restart(batch.min(RAYS - first));
        if let Some(seed) = seed {
            rays.number(0, &Numbers::sobol(seed), "test", 3, first as u64);
        }
        let c = rays.columns_mut();
        for i in 0..c.x.len() {
            let at = (first + i) as f64 / RAYS as f64;
            (c.x[i], c.y[i], c.z[i]) = (8.0 * at, 8.0 * (7.0 * at).fract(), -10.0);
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
            (c.wavelength_nm[i], c.tag[i]) = (550.0, (first + i) as u32);
        }
        tracer.follow(&route, &mut rays, &mut work);
        let [l, m, n] = rays.directions();
        let alive = (0..rays.len()).filter(|i| rays.loss(*i).is_none());
        out.extend(alive.map(|i| (rays.tags()[i], DVec3::new(l[i], m[i], n[i]))));
    }
    out
}

/// Returns the turn that this stage gives to each ray of seed 1.
fn turns(stage: StageKey) -> Vec<DVec2> {
    let mut rays = RayBatch::new(RAYS).with_numbers();
    rays.restart(RAYS);
    rays.number(0, &Numbers::sobol(1), "test", 3, 0);
    rays.set_stage(stage);
    let c = rays.columns_mut();
    (0..RAYS).map(|i| turn(&c.numbers.of(i).expect("numbered"))).collect()
}

fn straight(lens: &Lens) -> Path {
    Path::through(lens.elements.len(), Travel::Forward)
}

/// A ray draws the same numbers in batches of any size, though most rays are dropped on the way to the surface. The numbers are
/// those of its own stream and sample.
#[test]
fn numbers_stay_with_their_rays() {
    let lens = lens(&[("stop", 5.0, 4.0), ("scatter", 5.0, 20.0), ("stop", 5.0, 30.0)]);
    let path = straight(&lens);
    let want = directions(&lens, &path, RAYS, Some(1));
    assert!((20..RAYS / 2).contains(&want.len()), "{} of {RAYS} pass", want.len());
    for batch in [1, 7, 64] {
        assert_eq!(directions(&lens, &path, batch, Some(1)), want, "batches of {batch}");
    }
    let turns = turns(StageKey::new("scatter", 0));
    assert!(want.iter().all(|(tag, d)| (*d - turns[*tag as usize].extend(1.0).normalize()).length() < 1e-15));
    // Without numbers nothing is left to chance.
    assert!(directions(&lens, &path, RAYS, None).iter().all(|(_, d)| *d == DVec3::Z));
    assert_ne!(directions(&lens, &path, RAYS, Some(2)), want);
}

/// Another stage in front, or one of the same kind behind, changes no number. A second stage of the same kind has its own numbers, and so
/// has a second visit.
#[test]
fn a_stage_more_moves_no_number() {
    let exits = |surfaces: &[(&str, f64, f64)], path: &dyn Fn(&Lens) -> Path| {
        let lens = lens(surfaces);
        directions(&lens, &path(&lens), RAYS, Some(1))
    };
    let (scatter, stop) = (("scatter", 5.0, 200.0), ("stop", 5.0, 200.0));
    let one = exits(&[scatter, stop], &straight);
    assert_eq!(exits(&[stop, scatter, stop], &straight), one);
    let first_only = |lens: &Lens| straight(lens).up_to(|at| at == 1);
    assert_eq!(exits(&[stop, scatter, scatter], &first_only), one);
    // Behind another that draws, and behind one of its own kind.
    for (before, own) in [("other", 0), ("scatter", 1)] {
        let both = exits(&[(before, 5.0, 200.0), scatter], &straight);
        let (a, b) = (turns(StageKey::new(before, 0)), turns(StageKey::new("scatter", own)));
        for (tag, direction) in both {
            let (a, b) = (a[tag as usize], b[tag as usize]);
            let want = (a.extend(1.0).normalize() + b.extend(0.0)).normalize();
            assert!((direction - want).length() < 1e-14 && a != b);
        }
    }
    // Reflected twice, it passes the scatterer three times.
    let window = ("window", 5.0, 200.0);
    let lens = lens(&[window, ("scatter", 5.0, 200.0), window]);
    let bounced = directions(&lens, &Path::reflected(3, Travel::Forward, &[2, 0]).expect("a path"), RAYS, Some(1));
    let turns = [0, 1, 2].map(|visit| turns(StageKey::new("scatter", visit << 32)));
    for (tag, direction) in bounced {
        let [a, b, c] = [0, 1, 2].map(|visit| turns[visit][tag as usize].extend(0.0));
        let mirrored = DVec3::new(1.0, 1.0, -1.0);
        let back = ((DVec3::Z + a).normalize() * mirrored + b).normalize();
        assert!((direction - (back * mirrored + c).normalize()).length() < 1e-14);
    }
}

/// Forward, light is aimed at the whole filter, although straight light passes only a small part of it. Backward, light is aimed at what
/// passes from behind, as without the filter. A stop in front of the filter counts forward, one behind it backward.
#[test]
fn light_is_aimed_at_all_that_scatters() {
    let without = lens(&[("sphere", 8.0, 25.0), ("stop", 0.0, 5.0), ("lens", 50.0, 20.0)]);
    let with = lens(&[("scatter", 8.0, 25.0), ("stop", 0.0, 5.0), ("lens", 50.0, 20.0)]);
    let source = DVec3::new(100.0, 0.0, -2000.0);
    let front = |lens: &Lens| {
        let pupil = FrontPupil::search(lens, &tracer(lens), &[source], 400.0, 700.0).expect("sizes");
        pupil.region(source).expect("searched").area_mm2()
    };
    let [narrow, wide] = [&without, &with].map(front);
    let disk = |r: f64| std::f64::consts::PI * r * r;
    assert!((disk(5.0)..1.5 * disk(5.0)).contains(&narrow), "{narrow}");
    assert!((disk(25.0)..1.5 * disk(25.0)).contains(&wide), "{wide}");
    let shaded = lens(&[("stop", 8.0, 10.0), ("scatter", 8.0, 25.0), ("stop", 0.0, 5.0), ("lens", 50.0, 20.0)]);
    assert!((disk(10.0)..1.5 * disk(10.0)).contains(&front(&shaded)), "{}", front(&shaded));
    let place = DVec3::new(3.0, 4.0, 0.0);
    let rear = |lens: &Lens| {
        let pupil = RearPupil::search(lens, &tracer(lens), &[DVec3::ZERO, place], 400.0, 700.0).expect("sizes");
        pupil.region(place).expect("searched").area_mm2()
    };
    let [a, b, c] = [&without, &with, &shaded].map(rear);
    assert!((a / b - 1.0).abs() < 0.2 && (c / b - 1.0).abs() < 1e-12, "{a} {b} {c}");
    // Seen from behind, a stop in front of what scatters hides nothing for certain.
    let closed = lens(&[("stop", 8.0, 0.1), ("scatter", 8.0, 25.0), ("stop", 0.0, 5.0), ("lens", 50.0, 20.0)]);
    assert!((rear(&closed) / b - 1.0).abs() < 0.1, "{} {b}", rear(&closed));
}
