//! Measures the cost of a plugin surface: a lens of twelve surfaces with one sphere written the way a plugin writes it, relative to
//! the same lens with built-in surfaces only. One thread, a random wavelength per ray. The lenses take turns, and each figure is the
//! median ratio over the turns. The last line is JSON.

use glam::DVec3;
use spectra_core::numbers::Numbers;
use spectra_core::surface::{
    FromSag, Hit, Intersection, Kernel, KernelShape, PerRay, Ray, Real, SagShape, ScalarShape, Surface,
};
use spectra_core::{Isa, RayBatch};
use spectra_lens::Lens;
use spectra_plugins as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

const LENS: &str = "canon-35-f1.8";
/// Index of the replaced surface, from 0: its radius is moderate and every ray meets it.
const REPLACED: usize = 3;
const RAYS: usize = 1 << 19;
const BATCH: usize = 256;
const TURNS: usize = 15;

/// The least that a plugin author writes: a sag.
#[derive(Debug)]
struct Sag(f64);

impl SagShape for Sag {
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        let r2 = x_mm * x_mm + y_mm * y_mm;
        let square = 1.0 - r2 / (self.0 * self.0);
        (square >= 0.0).then(|| r2 / self.0 / (1.0 + square.sqrt()))
    }
}

/// A sag with its slopes.
#[derive(Debug)]
struct SagAndSlope(Sag);

impl SagShape for SagAndSlope {
    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.0.sag_mm(x_mm, y_mm)
    }

    fn slope(&self, x_mm: f64, y_mm: f64) -> Option<(f64, f64)> {
        let radius = self.0.0;
        let square = radius * radius - x_mm * x_mm - y_mm * y_mm;
        let height = square.sqrt().copysign(radius);
        (square > 0.0).then(|| (x_mm / height, y_mm / height))
    }
}

/// A sag whose intersections are searched one ray at a time.
#[derive(Debug)]
struct OneByOne<S>(FromSag<S>);

impl<S: SagShape> ScalarShape for OneByOne<S> {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        self.0.intersect(position, direction)
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        self.0.sag_mm(x_mm, y_mm)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        self.0.vertex_curvature_per_mm()
    }
}

/// A sphere of the scalar tier: the intersection in closed form.
#[derive(Debug)]
struct Scalar(f64);

impl ScalarShape for Scalar {
    fn intersect(&self, position: DVec3, direction: DVec3) -> Option<Intersection> {
        let from_center = position - DVec3::new(0.0, 0.0, self.0);
        let b = direction.dot(from_center);
        let discriminant = b * b - (from_center.length_squared() - self.0 * self.0);
        if discriminant < 0.0 {
            return None;
        }
        // Take the root on the hemisphere that contains the vertex.
        let root = discriminant.sqrt().copysign(self.0 * direction.z);
        let distance_mm = -b - root;
        Some(Intersection { distance_mm, normal: from_center + distance_mm * direction })
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        Sag(self.0).sag_mm(x_mm, y_mm)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (1.0 / self.0, 1.0 / self.0)
    }
}

/// A sphere of the kernel tier: branch-free, for any instruction set.
#[derive(Clone, Copy, Debug)]
struct Vector(f64);

impl KernelShape for Vector {
    #[inline(always)]
    fn hit<R: Real, const FORWARD: bool>(&self, ray: Ray<R, FORWARD>) -> Hit<R> {
        let c = R::constant(1.0 / self.0);
        let ([x, y, z], [l, m, n]) = (ray.position, ray.direction);
        let b = n - c * (x * l + y * m + z * n);
        let q = c * (x * x + y * y + z * z) - (z + z);
        let discriminant = b * b - c * q;
        let cosine = ray.along(discriminant.sqrt());
        Hit { distance: q / (b + cosine), cosine, valid: discriminant }
    }

    #[inline(always)]
    fn normal<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let c = R::constant(1.0 / self.0);
        [-(c * x), -(c * y), R::constant(1.0) - c * z]
    }

    fn sag_mm(&self, x_mm: f64, y_mm: f64) -> Option<f64> {
        Sag(self.0).sag_mm(x_mm, y_mm)
    }

    fn vertex_curvature_per_mm(&self) -> (f64, f64) {
        (1.0 / self.0, 1.0 / self.0)
    }
}

/// Traces all rays. Returns the time in seconds and the mean height in the image plane.
fn trace(tracer: &Tracer, batch: &mut RayBatch) -> (f64, f64) {
    let mut work = tracer.work(BATCH);
    let numbers = Numbers::random(1);
    let (mut sum, mut landed, mut seconds) = (0.0, 0_usize, 0.0);
    for start in (0..RAYS).step_by(BATCH) {
        batch.restart(BATCH);
        let c = batch.columns_mut();
        for i in 0..BATCH {
            let number = |dimension| numbers.one(0, (start + i) as u64, dimension);
            (c.x[i], c.y[i], c.z[i]) = (12.0 * number(0) - 6.0, 12.0 * number(1) - 6.0, -5.0);
            (c.l[i], c.m[i], c.n[i]) = (0.0, 0.0, 1.0);
            c.wavelength_nm[i] = 400.0 + 300.0 * number(2);
        }
        let begun = Instant::now();
        tracer.trace(batch, &mut work, Travel::Forward);
        seconds += begun.elapsed().as_secs_f64();
        landed += batch.len();
        sum += batch.positions()[0][..batch.len()].iter().map(|x| x.abs()).sum::<f64>();
    }
    (seconds, sum / landed as f64)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    // `cargo test --benches` only checks that the benchmark runs, not how fast.
    let quick = !std::env::args().any(|a| a == "--bench");
    let lens = spectra_lens::load(LENS, &FileResources::beside(Path::new("."))).expect("a bundled lens");
    assert_eq!(lens.elements.len(), 12);
    let radius_mm = 1.0 / lens.elements[REPLACED].surface.vertex_curvature_per_mm().0;
    let with = |surface: Arc<dyn Surface>| -> Lens {
        let mut lens = lens.clone();
        lens.elements[REPLACED].surface = surface;
        lens
    };
    let cases: [(&str, &str, Lens); 7] = [
        ("built-in surfaces only", "", lens.clone()),
        ("kernel tier", "kernel", with(Arc::new(Kernel(Vector(radius_mm))))),
        ("scalar tier, closed form", "scalar", with(Arc::new(PerRay(Scalar(radius_mm))))),
        ("scalar tier, sag and slopes", "sag_and_slope", with(Arc::new(PerRay(FromSag(SagAndSlope(Sag(radius_mm))))))),
        ("scalar tier, sag alone", "sag", with(Arc::new(PerRay(FromSag(Sag(radius_mm)))))),
        (
            "sag and slopes, ray by ray",
            "sag_and_slope_ray_by_ray",
            with(Arc::new(PerRay(OneByOne(FromSag(SagAndSlope(Sag(radius_mm))))))),
        ),
        ("sag alone, ray by ray", "sag_ray_by_ray", with(Arc::new(PerRay(OneByOne(FromSag(Sag(radius_mm))))))),
    ];
    let band = Indices::Band { min_nm: 400.0, max_nm: 700.0 };
    let isa = Isa::detect();
    let tracers = cases.each_ref().map(|(_, _, lens)| Tracer::new(lens, band).expect("its glasses have indices"));
    let mut batch = RayBatch::new(BATCH);
    let mut ratios: [Vec<f64>; 7] = Default::default();
    let mut fastest_s = f64::INFINITY;
    for _ in 0..if quick { 1 } else { TURNS } {
        let results = tracers.each_ref().map(|tracer| trace(tracer, &mut batch));
        for (i, (seconds, mean)) in results.iter().enumerate() {
            ratios[i].push(results[0].0 / seconds);
            assert!((mean - results[0].1).abs() < 1e-9, "{}: the rays land elsewhere", cases[i].0);
        }
        fastest_s = fastest_s.min(results[0].0);
    }
    println!("{LENS}, {} surfaces, one from a plugin; {}; ray rate relative to built-in surfaces", 12, isa.name());
    let mut json = String::new();
    for ((name, key, _), ratios) in cases.iter().zip(ratios) {
        let ratio = median(ratios);
        println!("{name:<32} {ratio:>6.3}");
        if !key.is_empty() {
            json.push_str(&format!(",\"{key}\":{ratio:.4}"));
        }
    }
    println!(
        "{{\"bench\":\"plugin\",\"isa\":\"{}\",\"rays_per_second\":{:.0}{json}}}",
        isa.name(),
        RAYS as f64 / fastest_s
    );
}
