//! Measures the speed of sequential ray tracing relative to code by a careful C++ engineer (`soa.cpp`) in the same run.
//!
//! The workload is that of `soa.cpp`: its Biotar (ten refractions, stop, image plane: 12 intersections), field 5 degrees,
//! a random wavelength per ray, a million rays, one thread. The two programs take turns, and each figure is the median
//! over the turns. The last line is JSON.

use spectra_core::isa::Vectorized;
use spectra_core::surface::{Kernel, Surface};
use spectra_core::{Isa, RayBatch};
use spectra_glass::{Category, Formula, Glass, Medium};
use spectra_lens::{Element, Lens, LensMedium};
use spectra_plugin_surfaces::{Conic, EvenAsphere, Plane, Sphere};
use spectra_tracer::{Indices, Tracer, Travel};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

/// Table of `soa.cpp`: twice the radius, twice the thickness, index and Abbe number behind the surface (0: air), clear diameter.
const BIOTAR: [[f64; 5]; 11] = [
    [83.6, 10.75, 1.64238, 48.0, 37.0],
    [321.0, 1.65, 1.0, 0.0, 37.0],
    [44.8, 15.55, 1.62306, 56.9, 33.0],
    [-1150.0, 5.05, 1.57566, 41.2, 33.0],
    [28.3, 11.1, 1.0, 0.0, 22.5],
    [0.0, 7.8, 1.0, 0.0, 22.5],
    [-38.5, 5.05, 1.6727, 32.2, 22.5],
    [50.5, 21.22, 1.64238, 48.0, 30.0],
    [-53.2, 0.97, 1.0, 0.0, 30.0],
    [106.0, 13.9, 1.64238, 48.0, 30.0],
    [-120.0, 2.0 * 32.664_346_461_698_344, 1.0, 0.0, 30.0],
];
const RAYS: usize = 1_000_000 / BATCH * BATCH;
const BATCH: usize = 256;
const INTERSECTIONS: f64 = 12.0;
const TURNS: usize = 5;
const REPEATS: usize = 5;
const FIELD_DEG: f64 = 5.0;

/// Returns a glass as `soa.cpp` models it: n = A + B / L^2 through nd and Vd, with L in micrometers.
fn cauchy(nd: f64, vd: f64) -> Medium {
    let (d, f, c) = (0.587_561_8_f64, 0.486_132_7_f64, 0.656_272_5_f64);
    let b = (nd - 1.0) / vd / (1.0 / (f * f) - 1.0 / (c * c));
    Medium::from(Glass::new("bench", "cauchy", Category::User, Formula::cauchy(&[nd - b / (d * d), b]), (350.0, 830.0)))
}

/// Coefficients of an asphere: eight nonzero terms that stay below 0.1 mm on the Biotar.
const COEFFICIENTS: [f64; 8] = [1e-6, 1e-8, -1e-10, 1e-13, -1e-15, 1e-18, -1e-21, 1e-24];

fn sphere(radius_mm: f64) -> Arc<dyn Surface> {
    Arc::new(Kernel(Sphere::new(radius_mm)))
}

fn conic(radius_mm: f64) -> Arc<dyn Surface> {
    Arc::new(Kernel(Conic::new(radius_mm, -0.1)))
}

fn even_asphere(radius_mm: f64) -> Arc<dyn Surface> {
    Arc::new(Kernel(EvenAsphere::<8>::new(radius_mm, -0.1, &COEFFICIENTS)))
}

fn biotar(glass: impl Fn(f64, f64) -> Medium, surface: fn(f64) -> Arc<dyn Surface>) -> Lens {
    let mut media = vec![LensMedium::air()];
    let mut elements = Vec::new();
    let mut before = 0;
    for [diameter, thickness, nd, vd, clear] in BIOTAR {
        let label = format!("{nd}");
        let after = if vd == 0.0 {
            0
        } else {
            media.iter().position(|m| m.label == label).unwrap_or_else(|| {
                media.push(LensMedium { medium: glass(nd, vd), stated_nd: Some(nd), label });
                media.len() - 1
            })
        };
        let stop = diameter == 0.0;
        let surface: Arc<dyn Surface> = if stop { Arc::new(Kernel(Plane::stop())) } else { surface(diameter / 2.0) };
        let mut element = Element::new("surface", surface, before, after);
        element.thickness_mm = thickness / 2.0;
        element.semi_diameter_mm = Some(clear / 2.0);
        elements.push(element);
        before = after;
    }
    let mut lens = Lens { elements, media, ..Lens::empty("Biotar of soa.cpp") };
    lens.arrange();
    lens
}

struct Rays {
    x: Vec<f64>,
    y: Vec<f64>,
    wavelength_nm: Vec<f64>,
}

/// Returns the rays of `soa.cpp`: same xorshift generator, same disk.
fn rays() -> Rays {
    let mut state = 88_172_645_463_325_252_u64;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    };
    let column = || Vec::with_capacity(RAYS);
    let mut rays = Rays { x: column(), y: column(), wavelength_nm: column() };
    let tangent = libm::tan(FIELD_DEG.to_radians());
    for _ in 0..RAYS {
        let (r, t) = (12.0 * uniform().sqrt(), std::f64::consts::TAU * uniform());
        rays.x.push(r * libm::cos(t));
        rays.y.push(r * libm::sin(t) - 40.0 * tangent);
        rays.wavelength_nm.push(1e3 * (0.4 + 0.3 * uniform()));
    }
    rays
}

/// A vectorized step that fills a batch with the rays from index `start` on, 20 mm in front of the lens.
struct Start<'a> {
    rays: &'a Rays,
    start: usize,
    batch: &'a mut RayBatch,
}

impl<'a> Vectorized for Start<'a> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (m, n) = (libm::sin(FIELD_DEG.to_radians()), libm::cos(FIELD_DEG.to_radians()));
        let c = self.batch.columns_mut();
        let len = c.x.len();
        let from = |column: &'a [f64]| &column[self.start..][..len];
        let from = [from(&self.rays.x), from(&self.rays.y), from(&self.rays.wavelength_nm)];
        start_all(from, [m, n], c.x, c.y, c.z, c.l, c.m, c.n, c.wavelength_nm);
    }
}

/// Copies all columns in one loop, as `soa.cpp` does, so that the three streams from memory are read side by side.
#[inline(always)]
fn start_all(
    [x, y, wavelength_nm]: [&[f64]; 3],
    [cosine_m, cosine_n]: [f64; 2],
    to_x: &mut [f64],
    to_y: &mut [f64],
    to_z: &mut [f64],
    to_l: &mut [f64],
    to_m: &mut [f64],
    to_n: &mut [f64],
    to_wavelength: &mut [f64],
) {
    let len = to_x.len();
    let (x, y, w) = (&x[..len], &y[..len], &wavelength_nm[..len]);
    let (to_y, to_z, to_l) = (&mut to_y[..len], &mut to_z[..len], &mut to_l[..len]);
    let (to_m, to_n, to_wavelength) = (&mut to_m[..len], &mut to_n[..len], &mut to_wavelength[..len]);
    for i in 0..len {
        to_x[i] = x[i];
        to_y[i] = y[i];
        to_z[i] = -20.0;
        to_l[i] = 0.0;
        to_m[i] = cosine_m;
        to_n[i] = cosine_n;
        to_wavelength[i] = w[i];
    }
}

/// A vectorized step that computes the intersection with the image plane, the twelfth.
struct Land<'a> {
    batch: &'a RayBatch,
    image: &'a mut [f64],
}

impl Vectorized for Land<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let ([_, y, z], [_, m, n]) = (self.batch.positions(), self.batch.directions());
        let len = self.image.len();
        let (y, z, m, n) = (&y[..len], &z[..len], &m[..len], &n[..len]);
        for i in 0..len {
            self.image[i] = y[i] - z[i] / n[i] * m[i];
        }
    }
}

/// Fetches numbers that will be read soon into the cache. The arrays are far larger than the caches, and a batch is traced between accesses.
#[allow(unsafe_code, reason = "a prefetch reads and writes nothing that a program could see, at any address")]
fn prefetch(soon: &[f64]) {
    #[cfg(target_arch = "x86_64")]
    for line in soon.chunks(8) {
        // SAFETY: see the reason above.
        unsafe {
            std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T1 }>(line.as_ptr().cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = soon;
}

/// Traces all rays once. Returns how many reached the image plane and how many were lost.
fn trace(tracer: &Tracer, isa: Isa, rays: &Rays, image: &mut [f64]) -> (usize, u64) {
    let mut batch = RayBatch::new(BATCH).on(isa);
    let mut work = tracer.work(BATCH);
    let mut landed = 0;
    for start in (0..RAYS).step_by(BATCH) {
        batch.restart(BATCH.min(RAYS - start));
        isa.run(Start { rays, start, batch: &mut batch });
        // Fetch the next batch's rays, and the memory for this batch's image points, while this batch is traced.
        let next = (start + BATCH).min(RAYS)..(start + 2 * BATCH).min(RAYS);
        for column in [&rays.x, &rays.y, &rays.wavelength_nm] {
            prefetch(&column[next.clone()]);
        }
        prefetch(&image[landed..(landed + BATCH).min(RAYS)]);
        tracer.trace(&mut batch, &mut work, Travel::Forward);
        let len = batch.len();
        isa.run(Land { batch: &batch, image: &mut image[landed..landed + len] });
        landed += len;
    }
    (landed, work.losses.total())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Compiles `soa.cpp` if a compiler is installed; otherwise returns `None`.
fn build_soa() -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/soa.cpp");
    let target = std::env::temp_dir().join(format!("spectra-soa-{}", std::process::id()));
    let flags = ["-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-pthread", "-DREAL=double"];
    for wide in [&["-mprefer-vector-width=512"][..], &[]] {
        let built = Command::new("c++").args(flags).args(wide).arg(&source).arg("-o").arg(&target).output();
        if built.is_ok_and(|out| out.status.success()) {
            return Some(target);
        }
    }
    None
}

fn run_soa(program: &Path) -> Option<f64> {
    let output = Command::new(program).args(["1e6", "1", &REPEATS.to_string(), "1"]).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    text.split("\"rays_per_s\":").nth(1)?.split(',').next()?.trim().parse().ok()
}

fn main() {
    // `cargo test --benches` only checks that the benchmark runs, not how fast.
    let quick = !std::env::args().any(|a| a == "--bench");
    let turns = if quick { 1 } else { TURNS };
    let soa = if quick { None } else { build_soa() };
    let rays = rays();
    let mut image = vec![0.0; RAYS];
    let band = Indices::Band { min_nm: 400.0, max_nm: 700.0 };
    let wide = Indices::Band { min_nm: 350.0, max_nm: 830.0 };
    let make = |lens: &Lens, indices, isa: Isa| {
        (Tracer::new(lens, indices).expect("the glasses of the bench have indices"), isa)
    };
    let best = Isa::detect();
    let numbers = biotar(cauchy, sphere);
    let catalogue = biotar(
        |nd, _| {
            let name = if nd < 1.6 {
                "LZOS/LF5"
            } else if nd < 1.63 {
                "SCHOTT/SK10"
            } else if nd < 1.65 {
                "SCHOTT/BAF9"
            } else {
                "SCHOTT/SF5"
            };
            spectra_glass::Catalog::bundled().medium(name).expect("a bundled glass")
        },
        sphere,
    );
    let mut cases: Vec<(String, (Tracer, Isa), Vec<f64>)> = Vec::new();
    cases.push((format!("spectra {}, glasses of soa.cpp", best.name()), make(&numbers, band, best), Vec::new()));
    cases.push((
        format!("spectra {}, catalogue glasses, 350-830 nm", best.name()),
        make(&catalogue, wide, best),
        Vec::new(),
    ));
    for isa in Isa::available().into_iter().filter(|i| *i != best) {
        cases.push((format!("spectra {}, glasses of soa.cpp", isa.name()), make(&numbers, band, isa), Vec::new()));
        let aspheres = make(&biotar(cauchy, even_asphere), band, isa);
        cases.push((format!("spectra {}, ten even aspheres of 8 terms", isa.name()), aspheres, Vec::new()));
    }
    // The same lens with another kind of surface in all ten places.
    for (name, surface) in [("conics", conic as fn(f64) -> _), ("even aspheres of 8 terms", even_asphere)] {
        cases.push((
            format!("spectra {}, ten {name}", best.name()),
            make(&biotar(cauchy, surface), band, best),
            Vec::new(),
        ));
    }
    let mut soa_rates = Vec::new();
    let mut ratios = Vec::new();
    for _ in 0..turns {
        let reference = soa.as_deref().and_then(run_soa);
        soa_rates.extend(reference);
        for (i, (_, (tracer, isa), rates)) in cases.iter_mut().enumerate() {
            let times = (0..if quick { 1 } else { REPEATS }).map(|_| {
                let start = Instant::now();
                std::hint::black_box(trace(tracer, *isa, &rays, &mut image));
                start.elapsed().as_secs_f64()
            });
            let rate = RAYS as f64 / median(times.collect());
            rates.push(rate);
            if i == 0 {
                ratios.extend(reference.map(|soa| rate / soa));
            }
        }
    }
    let (landed, lost) = trace(&cases[0].1.0, best, &rays, &mut image);
    let mean_y = image[..landed].iter().sum::<f64>() / landed as f64;
    // soa.cpp prints the same value: same rays, same glass, same lens.
    assert!((mean_y - 4.354_748).abs() < 2e-6, "mean height {mean_y} mm, soa.cpp has 4.354748");
    let soa_rate = (!soa_rates.is_empty()).then(|| median(soa_rates));
    println!("{:<48} {:>12} {:>8}", "one thread, f64, random wavelength per ray", "M rays/s", "ratio");
    if let Some(rate) = soa_rate {
        println!("{:<48} {:>12.1} {:>8.2}", "soa.cpp (C++, fused multiply-add)", rate / 1e6, 1.0);
    }
    for (name, _, rates) in &cases {
        let rate = median(rates.clone());
        let ratio = soa_rate.map_or_else(|| "-".to_owned(), |soa| format!("{:.2}", rate / soa));
        println!("{name:<48} {:>12.1} {ratio:>8}", rate / 1e6);
    }
    // Rate of each turn relative to the rate of the spheres in the same turn.
    let to_spheres = |case: &(String, (Tracer, Isa), Vec<f64>)| {
        median(case.2.iter().zip(&cases[0].2).map(|(rate, sphere)| rate / sphere).collect())
    };
    let [.., conics, aspheres] = &cases[..] else { unreachable!("conics and aspheres were pushed last") };
    let (conics, aspheres) = (to_spheres(conics), to_spheres(aspheres));
    println!("ray rate relative to spheres: conics {conics:.3}, even aspheres of 8 terms {aspheres:.3}");
    // For each narrower instruction set, spheres and aspheres are next to each other after the first two cases.
    let mut json = String::new();
    for (isa, pair) in Isa::available().into_iter().filter(|i| *i != best).zip(cases[2..].chunks(2)) {
        let ratio = median(pair[1].2.iter().zip(&pair[0].2).map(|(rate, sphere)| rate / sphere).collect());
        println!("even aspheres of 8 terms relative to spheres, {}: {ratio:.3}", isa.name());
        json.push_str(&format!(",\"even_asphere_to_sphere_{}\":{ratio:.4}", isa.name()));
    }
    let rate = median(cases[0].2.clone());
    let ratio = if ratios.is_empty() { "null".to_owned() } else { format!("{:.4}", median(ratios)) };
    println!(
        "{{\"bench\":\"kernel\",\"isa\":\"{}\",\"rays_per_second\":{rate:.0},\"intersections_per_second\":{:.0},\"ratio_to_soa\":{ratio},\"conic_to_sphere\":{conics:.4},\"even_asphere_to_sphere\":{aspheres:.4}{json},\"mean_y_mm\":{mean_y:.6},\"lost\":{lost}}}",
        best.name(),
        rate * INTERSECTIONS
    );
    if let Some(program) = soa {
        // A file left behind in the temporary folder does no harm.
        let _ = std::fs::remove_file(program);
    }
}
