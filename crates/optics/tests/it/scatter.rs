//! Light scattered by haze, dust and scratches: the tracer's paths against walks that share only the lobes with them, and
//! balanced books.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::numbers::Numbers;
use spectra_lens::{Aperture, ApertureShape, Layer, LayerKind, Lens, Lobe, Run};
use spectra_optics::stop_down;
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Interior, Particle, StrayReflectances, Tracer, Travel, WalkNumbers, Walker};

const NM: f64 = 546.074;

/// The Biotar with haze on its front, dust inside, and scratches on a part of its rear.
fn soiled() -> Lens {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../lenses/zeiss-biotar-50-f1.4.yaml");
    let lens = spectra_lens::load(file, &FileResources::beside(std::path::Path::new(""))).expect("a lens");
    let mut lens = stop_down(lens, 2.0).expect("open enough");
    let outer: Vec<usize> = (0..lens.elements.len())
        .filter(|at| (lens.elements[*at].medium_before == 0) != (lens.elements[*at].medium_after == 0))
        .collect();
    let layer = |soil, stopped, scattered, lobe| Layer { soil, stopped, scattered, places: Vec::new(), lobe };
    let (front, inner, rear) = (outer[0], outer[2], outer[outer.len() - 1]);
    lens.elements[front].layers = vec![layer(LayerKind::Haze, 0.0, 0.1, Lobe::Harvey { shoulder: 0.03, slope: -2.5 })];
    lens.elements[inner].layers = vec![layer(LayerKind::Dust, 0.1, 0.1, Lobe::disks(20_000.0, 0.4))];
    let place = Aperture {
        shape: ApertureShape::Ellipse { half_width_mm: 5.0, half_height_mm: 9.0 },
        center_mm: [2.0, 0.0],
        obscures: false,
    };
    let scratches = layer(LayerKind::Scratches, 0.2, 0.2, Lobe::lines(4_000.0, Run::Along([1.0, 0.0])));
    lens.elements[rear].layers = vec![Layer { places: vec![place], ..scratches }];
    lens
}

/// Region of the image plane around the point where the light lands: by distance, and by whether it lies along x or y from there.
fn region(x: f64, y: f64) -> usize {
    let r = (x * x + y * y).sqrt();
    let ring = [0.3, 1.0, 2.0, 5.0, 10.0].iter().filter(|limit| r > **limit).count();
    2 * ring + usize::from(x.abs() > y.abs())
}

const REGIONS: usize = 12;

#[derive(Clone, Copy, Default)]
struct Sum {
    sum: f64,
    squares: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
    }

    fn mean(&self, n: usize) -> (f64, f64) {
        let (n, mean) = (n as f64, self.sum / n as f64);
        (mean, ((self.squares / n - mean * mean) / n).sqrt())
    }
}

/// A parallel beam along the axis: light scattered at least once, in twelve regions, and light that never is.
#[test]
fn paths_and_walks_agree() {
    let lens = soiled();
    let interior =
        Interior::new(&lens, [4000.0; 2], [NM; 2], StrayReflectances { paint: 0.0, imager: 0.0, imager_mirror: 0.0 });
    let interior = interior.expect("straight");
    let radius = interior.front_rim_mm().1;
    let n = 1 << 17;
    let mut walker = Walker::new(&interior);
    walker.set_wavelength(NM);
    let (mut walked, mut walked_straight) = ([Sum::default(); REGIONS], Sum::default());
    for walk in 0..n {
        let mut chance = WalkNumbers::new(5, walk as u64);
        let (x, y) = spectra_core::math::concentric_disk(chance.number(), chance.number());
        let position = DVec3::new(radius * x, radius * y, -5.0);
        let start = Particle { position, direction: DVec3::Z, weight: 1.0, mirrored: 0, scattered: 0, diffused: 0 };
        walker.from_front(start, &mut chance, |p| {
            if p.mirrored == 0 && p.diffused > 0 {
                walked[region(p.position.x, p.position.y)].add(p.weight);
            } else if p.mirrored == 0 {
                walked_straight.add(p.weight);
            }
        });
    }
    let books = walker.ledger;
    assert!(((books.launched + books.aimed) / books.ended() - 1.0).abs() < 1e-9, "{books:?}");

    let made = || Tracer::new(&lens, Indices::At(NM)).expect("media");
    let (mut traced, mut traced_straight) = ([Sum::default(); REGIONS], Sum::default());
    let numbers = Numbers::random(3);
    for (tracer, is_scattered) in [(made().scattering(), true), (made(), false)] {
        let batch = 256;
        let (mut rays, mut work) = (RayBatch::new(batch).with_numbers(), tracer.work_in_place(batch));
        let mut chance = WalkNumbers::new(11, 0);
        for first in (0..n).step_by(batch) {
            rays.restart(batch);
            rays.number(0, &numbers, "test", 0, first as u64);
            let c = rays.columns_mut();
            for i in 0..batch {
                let (x, y) = spectra_core::math::concentric_disk(chance.number(), chance.number());
                (c.x[i], c.y[i], c.z[i]) = (radius * x, radius * y, -5.0);
                (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
                (c.wavelength_nm[i], c.weight[i]) = (NM, 1.0);
            }
            tracer.trace(&mut rays, &mut work, Travel::Forward);
            let ([x, y, z], [l, m, k]) = (rays.positions(), rays.directions());
            for i in (0..batch).filter(|i| rays.loss(*i).is_none()) {
                let t = -z[i] / k[i];
                let weight = rays.weights()[i];
                if is_scattered {
                    traced[region(x[i] + t * l[i], y[i] + t * m[i])].add(weight);
                } else {
                    traced_straight.add(weight);
                }
            }
        }
    }
    let mut squares = 0.0;
    let all = walked.iter().zip(&traced).chain([(&walked_straight, &traced_straight)]);
    for (at, (walked, traced)) in all.enumerate() {
        let ((w, ew), (t, et)) = (walked.mean(n), traced.mean(n));
        let errors = (w - t) / (ew * ew + et * et).sqrt();
        println!("{at}: walks {w:.6} +- {ew:.6}, paths {t:.6} +- {et:.6}: {errors:+.2}");
        assert!(w > 0.0 && errors.abs() < 4.0, "{at}");
        squares += errors * errors;
    }
    // 13 squares of standard deviation: a mean of 1 and a standard error of 0.39.
    assert!(squares / 13.0 < 1.0 + 3.5 * 0.39, "{squares}");
}

/// Straight light leaves the layers' fractions in the books.
#[test]
fn the_books_close() {
    let lens = soiled();
    let tracer = Tracer::new(&lens, Indices::At(NM)).expect("media");
    let n = 4096;
    let (mut rays, mut work) = (RayBatch::new(n), tracer.work_in_place(n).with_ledger());
    rays.restart(n);
    let c = rays.columns_mut();
    for i in 0..n {
        let (u, v) = ((i as f64 + 0.5) / n as f64, i as f64 * 0.618_033_988_749_894_9);
        let (sin, cos) = spectra_core::math::sin_cos_turns(v - v.floor());
        (c.x[i], c.y[i], c.z[i]) = (8.0 * u.sqrt() * cos, 8.0 * u.sqrt() * sin, -5.0);
        (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
        (c.wavelength_nm[i], c.weight[i]) = (NM, 1.0);
    }
    tracer.trace(&mut rays, &mut work, Travel::Forward);
    let ledger = work.take_ledger().expect("asked for");
    let booked = ledger.arrived + ledger.lost_from(0).total();
    assert!((booked / ledger.launched - 1.0).abs() < 1e-12, "{booked} {ledger:?}");
    // The front scatters a tenth of what its coating passes; dust inside stops as much as it scatters.
    let front = ledger.steps[0];
    let passed = ledger.launched - front.total() + front.scattered;
    assert!((front.scattered / passed - 0.1).abs() < 1e-12, "{front:?}");
    let dusty = ledger.steps.iter().skip(1).find(|step| step.scattered > 0.0).expect("dust");
    let passed = ledger.launched - ledger.steps[..4].iter().map(spectra_tracer::StepLedger::total).sum::<f64>();
    assert!(dusty.scattered > 0.05 * passed && dusty.absorbed >= dusty.scattered * (1.0 - 1e-9), "{dusty:?}");
}
