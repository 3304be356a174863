//! Light along reflected paths: where it goes, and how long its optical path is.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_core::math::concentric_disk;
use spectra_core::numbers::Numbers;
use spectra_core::surface::{Action, Kernel, Surface};
use spectra_glass::Medium;
use spectra_lens::{Coating, Element, Lens, LensMedium};
use spectra_plugin_surfaces::{Conic, Plane, Sphere};
use spectra_tracer::{Indices, Ledger, Path, Tracer, Travel};
use std::sync::Arc;

const WAVELENGTH_NM: f64 = 587.56;

/// A surface: shape, index behind it, thickness, clear semi-diameter (mm).
type Row = (Arc<dyn Surface>, f64, f64, Option<f64>);

fn lens(surfaces: Vec<Row>) -> Lens {
    let mut lens = Lens::empty("by hand");
    let mut before = 0;
    for (surface, index, thickness_mm, semi_diameter_mm) in surfaces {
        let after = match index {
            1.0 => 0,
            index => {
                let medium = LensMedium { medium: Medium::Constant(index), ..LensMedium::air() };
                lens.media.push(medium);
                lens.media.len() - 1
            }
        };
        lens.elements.push(Element {
            thickness_mm,
            semi_diameter_mm,
            ..Element::new("by hand", surface, before, after)
        });
        before = after;
    }
    lens.arrange();
    lens
}

/// The Biotar of US 1786916, example 2, at the indices that the patent states, with the semi-diameters of the library's file.
fn biotar() -> Lens {
    let (crown, flint) = (1.64329, 1.6727);
    let rows = [
        (41.8, crown, 5.375, 18.0),
        (160.5, 1.0, 0.825, 18.0),
        (22.4, 1.6228, 7.775, 16.0),
        (-575.0, 1.57501, 2.525, 16.0),
        (14.15, 1.0, 5.45, 11.0),
        (0.0, 1.0, 4.0, 11.0),
        (-19.25, flint, 2.525, 11.0),
        (25.25, crown, 10.61, 14.0),
        (-26.6, 1.0, 0.485, 14.0),
        (53.0, crown, 6.95, 14.5),
        (-60.0, 1.0, 32.3552, 14.5),
    ];
    let shape = |radius: f64| -> Arc<dyn Surface> {
        if radius == 0.0 { Arc::new(Kernel(Plane::stop())) } else { Arc::new(Kernel(Sphere::new(radius))) }
    };
    let lens = lens(rows.map(|(radius, n, t, rim)| (shape(radius), n, t, Some(rim))).to_vec());
    assert_eq!(lens.elements[STOP].action, Action::Pass);
    lens.with_coating(Coating::Bare)
}

const STOP: usize = 5;
const RAYS: usize = 10_000;

/// Rays from a point to this radius of the front glass, mm, each of the same weight, together 1.
fn from_point(point: DVec3, radius_mm: f64, rays: &mut RayBatch) {
    rays.restart(RAYS);
    let numbers = Numbers::sobol(3);
    let c = rays.columns_mut();
    for i in 0..RAYS {
        let (x, y) = concentric_disk(numbers.one(0, i as u64, 3), numbers.one(0, i as u64, 4));
        let direction = (DVec3::new(radius_mm * x, radius_mm * y, 0.0) - point).normalize();
        (c.x[i], c.y[i], c.z[i]) = point.into();
        (c.l[i], c.m[i], c.n[i]) = direction.into();
        (c.wavelength_nm[i], c.weight[i]) = (WAVELENGTH_NM, 1.0 / RAYS as f64);
    }
}

fn ledger(tracer: &Tracer, path: &Path, (point, radius_mm): (DVec3, f64), polarized: bool) -> Ledger {
    let rays = RayBatch::new(RAYS);
    let mut rays = if polarized { rays.with_polarization() } else { rays };
    from_point(point, radius_mm, &mut rays);
    let mut work = tracer.work(RAYS).with_ledger();
    tracer.follow(&tracer.route(path), &mut rays, &mut work);
    work.take_ledger().expect("asked for")
}

/// The account of every path closes. All light that was launched is on the film directly or after two reflections, out of
/// the front, lost at rims, or reflected a third time, which no path here follows.
#[test]
fn light_of_all_two_bounce_paths_adds_up() {
    let lens = biotar();
    let tracer = Tracer::new(&lens, Indices::At(WAVELENGTH_NM)).expect("media");
    let count = lens.elements.len();
    let glass: Vec<usize> = (0..count).filter(|i| *i != STOP).collect();
    let (on_axis, aside) = (DVec3::new(0.0, 0.0, -2000.0), DVec3::new(150.0, -600.0, -2000.0));
    let bundles = [(on_axis, 18.0), (aside, 18.0), (on_axis, 0.01)];
    // Reflected light is polarized: surfaces pass and reflect other fractions of it than of unpolarized light.
    let mut of_state = [0.0; 2];
    for (bundle, polarized) in bundles.into_iter().flat_map(|bundle| [(bundle, false), (bundle, true)]) {
        let account = |reflections: &[usize]| {
            let path = Path::reflected(count, Travel::Forward, reflections).expect("a path");
            let ledger = ledger(&tracer, &path, bundle, polarized);
            let spent = ledger.arrived + ledger.lost_from(0).total();
            assert!(
                (ledger.launched - 1.0).abs() < 1e-12 && (spent - ledger.launched).abs() < 1e-12,
                "{reflections:?}"
            );
            // What was lost before the last reflection belongs to the shorter path.
            let own =
                path.steps().iter().rposition(|s| s.act == spectra_tracer::Interaction::Reflect).map_or(0, |at| at + 1);
            (ledger.arrived, ledger.lost_from(own))
        };
        let (straight, lost) = account(&[]);
        let mut sum = straight + lost.missed + lost.vignetted + lost.absorbed;
        let (mut paths, mut ghosts, mut third) = (0, 0.0, 0.0);
        for (k, &first) in glass.iter().enumerate() {
            let (front, lost) = account(&[first]);
            sum += front + lost.missed + lost.vignetted + lost.absorbed;
            for &second in &glass[..k] {
                let (film, lost) = account(&[first, second]);
                sum += film + lost.missed + lost.vignetted + lost.absorbed;
                (paths, ghosts, third) = (paths + 1, ghosts + film, third + lost.elsewhere);
            }
        }
        assert_eq!(paths, 45);
        assert!((sum + third - 1.0).abs() < 1e-12, "{:e}", sum + third - 1.0);
        assert!(ghosts > 0.005 && third > 0.0, "{ghosts} {third}");
        if bundle.0 == aside {
            of_state[usize::from(polarized)] = ghosts;
        }
        // Along the axis three reflections at 4 to 6 % and ten surfaces leave 1.6 %.
        if bundle.1 < 1.0 {
            assert!((third - 0.016).abs() < 0.001, "{third}");
        }
    }
    assert!((of_state[1] / of_state[0] - 1.0).abs() > 1e-3, "{of_state:?}");
}

/// On the axis the weight of a ghost is the product of Fresnel's factors at normal incidence.
#[test]
fn the_axial_ray_has_the_product_of_its_reflectances() {
    let lens = biotar();
    let tracer = Tracer::new(&lens, Indices::At(WAVELENGTH_NM)).expect("media");
    let r = |at: usize| {
        let e = &lens.elements[at];
        let (n, m) = (lens.index(e.medium_before, WAVELENGTH_NM), lens.index(e.medium_after, WAVELENGTH_NM));
        ((n - m) / (n + m)) * ((n - m) / (n + m))
    };
    for reflections in [[1, 0], [4, 2], [10, 0], [7, 6], [9, 3]] {
        let path = Path::reflected(lens.elements.len(), Travel::Forward, &reflections).expect("a path");
        let mut want = 1.0;
        for step in path.steps() {
            want *=
                if step.act == spectra_tracer::Interaction::Reflect { r(step.element) } else { 1.0 - r(step.element) };
        }
        let mut rays = RayBatch::new(1);
        rays.restart(1);
        let c = rays.columns_mut();
        (c.x[0], c.y[0], c.z[0], c.l[0], c.m[0], c.n[0], c.wavelength_nm[0]) =
            (0.0, 0.0, -9.0, 0.0, 0.0, 1.0, WAVELENGTH_NM);
        tracer.follow(&tracer.route(&path), &mut rays, &mut tracer.work_in_place(1));
        let (got, directions) = (rays.weights()[0], rays.directions());
        assert!((got / want - 1.0).abs() < 1e-12, "{reflections:?}: {got} {want}");
        assert!(rays.loss(0).is_none() && (directions[2][0] - 1.0).abs() < 1e-14);
    }
}

/// Traced there and back along the same path, a ray returns to where it started, with the same weight.
#[test]
fn ghosts_are_reversible() {
    let lens = biotar();
    let tracer = Tracer::new(&lens, Indices::At(WAVELENGTH_NM)).expect("media");
    let count = lens.elements.len();
    let mut compared = 0;
    for (first, second) in [(1, 0), (4, 2), (10, 7), (6, 4), (10, 0)] {
        let there = tracer.route(&Path::reflected(count, Travel::Forward, &[first, second]).expect("a path"));
        let back = tracer.route(&Path::reflected(count, Travel::Backward, &[second, first]).expect("a path"));
        let mut rays = RayBatch::new(RAYS);
        from_point(DVec3::new(100.0, 300.0, -1500.0), 18.0, &mut rays);
        let start: Vec<DVec3> = (0..RAYS).map(|i| DVec3::from(rays.directions().map(|c| c[i]))).collect();
        let mut work = tracer.work_in_place(RAYS);
        tracer.follow(&there, &mut rays, &mut work);
        let there: Vec<f64> = rays.weights().to_vec();
        let alive: Vec<bool> = (0..RAYS).map(|i| rays.loss(i).is_none()).collect();
        let c = rays.columns_mut();
        for i in 0..RAYS {
            (c.l[i], c.m[i], c.n[i]) = (-c.l[i], -c.m[i], -c.n[i]);
            c.weight[i] = 1.0;
        }
        tracer.follow(&back, &mut rays, &mut work);
        for i in (0..RAYS).filter(|i| alive[*i]) {
            // A ray that grazes a rim may end on the way back.
            if rays.loss(i).is_some() {
                continue;
            }
            let out = DVec3::from(rays.directions().map(|c| c[i]));
            assert!((out + start[i]).length() < 1e-9, "{first} {second}: {out} {}", start[i]);
            let weight = there[i] * RAYS as f64;
            // Light that grazes a surface has the weight of a small cosine, which is known only to about 1e-16.
            let error = (rays.weights()[i] - weight).abs();
            assert!(error < 1e-9 * weight.max(1e-6), "{} {weight}", rays.weights()[i]);
            compared += 1;
        }
    }
    assert!(compared > 500, "{compared}");
}

/// Returns the optical path of each ray: from its start to the last surface, plus `index` times the distance to a focus (mm, frame of the
/// image plane; negative for a virtual one). Also returns the largest distance at which a ray misses that focus.
fn paths_to(lens: &Lens, rays: &[(DVec3, DVec3)], focus: DVec3, index: f64) -> (Vec<f64>, f64) {
    let tracer = Tracer::new(lens, Indices::At(WAVELENGTH_NM)).expect("media");
    let mut batch = RayBatch::with_optical_path(rays.len());
    batch.restart(rays.len());
    let c = batch.columns_mut();
    for (i, (p, d)) in rays.iter().enumerate() {
        (c.x[i], c.y[i], c.z[i]) = (*p).into();
        (c.l[i], c.m[i], c.n[i]) = (*d).into();
        c.wavelength_nm[i] = WAVELENGTH_NM;
    }
    tracer.trace(&mut batch, &mut tracer.work_in_place(rays.len()), Travel::Forward);
    let mut miss: f64 = 0.0;
    let path = |i: usize| {
        let p = DVec3::from(batch.positions().map(|c| c[i]));
        let d = DVec3::from(batch.directions().map(|c| c[i]));
        let along = (focus - p).dot(d);
        miss = miss.max((focus - p - along * d).length());
        batch.optical_path_mm().expect("carried")[i] + index * along
    };
    assert!((0..rays.len()).all(|i| batch.loss(i).is_none()));
    ((0..rays.len()).map(path).collect(), miss)
}

fn collimated(radius_mm: f64, z_mm: f64) -> Vec<(DVec3, DVec3)> {
    let at = |k: usize| {
        let (r, t) = (radius_mm * (k as f64 / 50.0), 2.4 * k as f64);
        (DVec3::new(r * t.cos(), r * t.sin(), z_mm), DVec3::Z)
    };
    (0..=50).map(at).collect()
}

fn fan(point: DVec3, largest_rad: f64) -> Vec<(DVec3, DVec3)> {
    let toward = |k: usize| {
        let (a, t) = (largest_rad * (k as f64 / 50.0), 2.4 * k as f64);
        (point, DVec3::new(a.sin() * t.cos(), a.sin() * t.sin(), a.cos()))
    };
    (0..=50).map(toward).collect()
}

/// Surfaces that image a point without aberration make all optical paths equal (Malus and Dupin): to 1e-10 mm.
#[test]
fn optical_paths_to_a_perfect_image_are_equal() {
    let conic = |radius: f64, k: f64| -> Arc<dyn Surface> { Arc::new(Kernel(Conic::new(radius, k))) };
    let plane = || -> Arc<dyn Surface> { Arc::new(Kernel(Plane::refracting())) };
    let mirror = |surface, thickness_mm| {
        let mut lens = lens(vec![(surface, 1.0, thickness_mm, None)]);
        lens.elements[0].action = Action::Reflect;
        lens.arrange();
        lens
    };
    let n: f64 = 1.5168;
    let at_image = DVec3::ZERO;
    let behind = |z: f64| DVec3::new(0.0, 0.0, z);
    // A parabolic mirror of 100 mm; an ellipsoid from focus to focus, 66.7 and 200 mm from its vertex.
    let parabola = mirror(conic(-200.0, -1.0), -100.0);
    let (near, far) = (100.0 / 1.5, 100.0 / 0.5);
    let ellipsoid = mirror(conic(-100.0, -0.25), -far);
    // A plane, and a hyperboloid of k = -n^2 that focuses at R / (1 - n); an ellipsoid of k = -1 / n^2 that focuses in the glass.
    let hyperbola = lens(vec![(plane(), n, 12.0, None), (conic(-30.0, -n * n), 1.0, 30.0 / (n - 1.0), None)]);
    let egg = lens(vec![(conic(30.0, -1.0 / (n * n)), n, 30.0 * n / (n - 1.0), None)]);
    // Light in glass, leaving through a sphere of 20 mm: from a point R / n beyond its center, it seems to come from n R beyond it.
    // A plane in the object begins the glass.
    let object = -20.0 - 20.0 / n;
    let aplanat = lens(vec![(plane(), n, -object, None), (conic(-20.0, 0.0), 1.0, 1.0, None)]);
    let cases = [
        ("parabola", &parabola, collimated(40.0, -150.0), at_image, 1.0, 250.0),
        ("ellipsoid", &ellipsoid, fan(behind(-near), 0.5), at_image, 1.0, near + far),
        ("hyperbola", &hyperbola, collimated(15.0, -5.0), at_image, 1.0, 5.0 + 12.0 * n + 30.0 / (n - 1.0)),
        ("ellipsoid of glass", &egg, collimated(15.0, -9.0), at_image, n, 9.0 + n * (30.0 * n / (n - 1.0))),
        (
            "aplanat",
            &aplanat,
            fan(behind(0.0), 0.4),
            behind(-1.0 - 20.0 - 20.0 * n),
            1.0,
            -n * object - 20.0 - 20.0 * n,
        ),
    ];
    for (name, lens, rays, focus, index, want) in cases {
        let (paths, miss) = paths_to(lens, &rays, focus, index);
        assert!(miss < 1e-10, "{name}: {miss:e} mm beside the focus");
        let worst = paths.iter().map(|p| (p - want).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-10, "{name}: {worst:e} mm");
    }
}
