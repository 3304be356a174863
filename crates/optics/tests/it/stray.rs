//! Stray light that walks inside a lens. Without walls it equals the light of the tracer's paths, both directions agree, the books close,
//! and white walls lose nothing.

use glam::DVec3;
use spectra_core::RayBatch;
use spectra_lens::{Coating, Lens};
use spectra_optics::stop_down;
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{
    Indices, Interior, Particle, Path, StrayError, StrayReflectances, Tracer, Travel, WalkNumbers, Walker,
};

const NM: f64 = 546.074;

fn biotar(f_number: f64) -> Lens {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../lenses/zeiss-biotar-50-f1.4.yaml");
    let lens = spectra_lens::load(file, &FileResources::beside(std::path::Path::new(""))).expect("a lens");
    stop_down(lens, f_number).expect("open enough")
}

fn start(position: DVec3, direction: DVec3) -> Particle {
    Particle { position, direction, weight: 1.0, mirrored: 0, scattered: 0, diffused: 0 }
}

/// Returns mean and standard error of `n` outcomes from their sum and their sum of squares.
fn mean(sum: f64, squares: f64, n: usize) -> (f64, f64) {
    let (n, mean) = (n as f64, sum / n as f64);
    (mean, ((squares / n - mean * mean) / n).sqrt())
}

/// A parallel beam on the axis and off it: light that arrives directly and by two reflections, against the sum of the tracer's paths.
#[test]
fn walks_by_glass_alone_are_the_paths_of_the_tracer() {
    let mut lens = biotar(2.0).with_coating(Coating::Bare);
    lens.absorption = true;
    let tracer = Tracer::new(&lens, Indices::At(NM)).expect("media");
    // The imager is so wide that everything that leaves the rear reaches it.
    let interior =
        Interior::new(&lens, [4000.0; 2], [NM; 2], StrayReflectances { paint: 0.0, imager: 0.0, imager_mirror: 0.0 });
    let interior = interior.expect("straight");
    for slope in [0.0_f64, 0.15] {
        let direction = DVec3::new(0.0, slope, 1.0).normalize();
        let radius = interior.front_rim_mm().1;
        let n = 60_000;
        let mut walker = Walker::new(&interior);
        walker.set_wavelength(NM);
        let mut came = [[0.0_f64; 2]; 3];
        for walk in 0..n {
            let mut chance = WalkNumbers::new(5, walk as u64);
            let (x, y) = spectra_core::math::concentric_disk(chance.number(), chance.number());
            let from = DVec3::new(radius * x, radius * y, -5.0);
            let mut own = [0.0; 3];
            walker.from_front(start(from, direction), &mut chance, |p| {
                if p.mirrored < 3 {
                    own[p.mirrored as usize] += p.weight;
                }
            });
            for (sum, own) in came.iter_mut().zip(own) {
                *sum = [sum[0] + own, sum[1] + own * own];
            }
        }
        let paths = |order: usize| {
            let paths = if order == 0 {
                vec![Path::through(tracer.surfaces(), Travel::Forward)]
            } else {
                Path::ghosts(tracer.surfaces(), &tracer.reflecting(), order)
            };
            let rays = 16_384;
            paths
                .iter()
                .map(|path| {
                    let mut batch = RayBatch::new(rays);
                    batch.restart(rays);
                    let c = batch.columns_mut();
                    for i in 0..rays {
                        let (u, v) = ((i as f64 + 0.5) / rays as f64, i as f64 * 0.618_033_988_749_894_9);
                        let (s, k) = spectra_core::math::sin_cos_turns(v - v.floor());
                        (c.x[i], c.y[i], c.z[i]) = (radius * u.sqrt() * k, radius * u.sqrt() * s, -5.0);
                        (c.l[i], c.m[i], c.n[i]) = direction.into();
                        c.wavelength_nm[i] = NM;
                        c.weight[i] = 1.0;
                    }
                    let mut work = tracer.work_in_place(rays).with_ledger();
                    tracer.follow(&tracer.route(path), &mut batch, &mut work);
                    work.take_ledger().expect("kept").arrived / rays as f64
                })
                .sum::<f64>()
        };
        for order in [0, 2] {
            let (got, error) = mean(came[order][0], came[order][1], n);
            let want = paths(order);
            println!("slope {slope}, {order} reflections: {got:.5} +- {error:.5}, paths {want:.5}");
            assert!((got - want).abs() < 4.0 * error && error < 0.06 * want, "{order}: {got} {want} {error}");
        }
        assert_eq!(came[1], [0.0; 2]);
    }
}

/// Light from a uniform field to the middle of the imager, walked from the imager and walked from the field; every wall reflects.
#[test]
fn both_directions_agree_and_the_books_close() {
    for (f_number, matter) in [
        (1.5, StrayReflectances { paint: 0.3, imager: 0.0, imager_mirror: 0.0 }),
        (4.0, StrayReflectances { paint: 0.2, imager: 0.3, imager_mirror: 0.2 }),
    ] {
        let lens = biotar(f_number).with_coating(Coating::Bare);
        let interior = Interior::new(&lens, [36.0, 24.0], [NM; 2], matter).expect("straight");
        let radius = 9.0;
        let mut walker = Walker::new(&interior);
        walker.set_wavelength(NM);
        // Straight light, and all other light.
        let mut back = [[0.0_f64; 2]; 2];
        let n = 150_000;
        for walk in 0..n {
            let mut chance = WalkNumbers::new(1, walk as u64);
            let (x, y) = spectra_core::math::concentric_disk(chance.number(), chance.number());
            if let Some(out) = walker.from_imager([radius * x, radius * y], &mut chance) {
                let sum = &mut back[usize::from(!out.is_straight())];
                *sum = [sum[0] + out.weight, sum[1] + out.weight * out.weight];
            }
        }
        let ledger = walker.ledger;
        assert!(((ledger.launched + ledger.aimed) / ledger.ended() - 1.0).abs() < 1e-9, "{ledger:?}");
        assert!(ledger.aimed.abs() < 0.02 * ledger.launched, "{ledger:?}");
        let mut walker = Walker::new(&interior);
        walker.set_wavelength(NM);
        // Evenly over the cap of the first surface, with the cosine to its normal: r = 41.8 mm, clear to 18 mm.
        let (r, clear) = (41.8_f64, 18.0_f64);
        let height = r - (r * r - clear * clear).sqrt();
        let area = std::f64::consts::TAU * r * height / (std::f64::consts::PI * radius * radius);
        let mut there = [[0.0_f64; 2]; 2];
        let m = 600_000;
        for walk in 0..m {
            let mut chance = WalkNumbers::new(2, walk as u64);
            let z = height * chance.number();
            let (s, c) = spectra_core::math::sin_cos_turns(chance.number());
            let across = (2.0 * r * z - z * z).sqrt();
            let at = DVec3::new(across * c, across * s, z);
            let normal = (DVec3::new(0.0, 0.0, r) - at).normalize();
            let (a, b) = spectra_core::math::concentric_disk(chance.number(), chance.number());
            let side = normal.cross(DVec3::X).normalize();
            let direction = a * side + b * normal.cross(side) + (1.0 - a * a - b * b).max(0.0).sqrt() * normal;
            let mut own = [0.0; 2];
            walker.from_front(start(at - 1e-3 * direction, direction), &mut chance, |p| {
                if p.position.x.hypot(p.position.y) < radius {
                    own[usize::from(!p.is_straight())] += p.weight;
                }
            });
            for (sum, own) in there.iter_mut().zip(own) {
                *sum = [sum[0] + own, sum[1] + own * own];
            }
        }
        let ledger = walker.ledger;
        assert!(((ledger.launched + ledger.aimed) / ledger.ended() - 1.0).abs() < 1e-9 && ledger.aimed == 0.0);
        for (back, there) in back.into_iter().zip(there) {
            let (a, ea) = mean(back[0], back[1], n);
            let (b, eb) = mean(there[0] * area, there[1] * area * area, m);
            let sigma = ea.hypot(eb);
            println!("f/{f_number}: from the imager {a:.5} +- {ea:.5}, from the field {b:.5} +- {eb:.5}");
            assert!((a - b).abs() < 4.0 * sigma && sigma < 0.1 * a, "{a} {b} {sigma}");
        }
    }
}

/// If walls absorb nothing and there is no other exit, all light leaves through the front.
#[test]
fn white_walls_lose_nothing() {
    let mut lens = biotar(2.0).with_coating(Coating::Bare);
    lens.absorption = false;
    let matter = StrayReflectances { paint: 1.0, imager: 0.5, imager_mirror: 0.5 };
    let interior = Interior::new(&lens, [36.0, 24.0], [NM; 2], matter).expect("straight");
    let mut walker = Walker::new(&interior);
    walker.set_wavelength(NM);
    for walk in 0..2000 {
        let from = start(DVec3::new(0.0, 3.0, -5.0), DVec3::new(0.05, 0.1, 1.0).normalize());
        walker.from_front(from, &mut WalkNumbers::new(3, walk), |_| {});
    }
    let ledger = walker.ledger;
    assert!((ledger.front / ledger.launched - 1.0).abs() < 1e-9 && ledger.not_traced == 0.0, "{ledger:?}");
}

/// Lenses whose inside is not a row of rooms are refused, each with its reason.
#[test]
fn some_lenses_have_no_straight_barrel() {
    let matter = StrayReflectances::default();
    let refused = |lens: &Lens| Interior::new(lens, [36.0, 24.0], [NM; 2], matter).map(|_| ()).expect_err("refused");
    assert_eq!(refused(&Lens::empty("none")), StrayError::NoSurfaces);
    let mut lens = biotar(2.0);
    lens.elements.iter_mut().for_each(|e| e.semi_diameter_mm = None);
    assert_eq!(refused(&lens), StrayError::NoSizes);
    let mut lens = biotar(2.0);
    lens.elements[3].action = spectra_core::surface::Action::Reflect;
    assert_eq!(refused(&lens), StrayError::NotStraight(4, "a mirror"));
    let mut lens = biotar(2.0);
    lens.elements[1].displacement.tilt_rad[0] = 0.5;
    lens.arrange();
    assert_eq!(refused(&lens), StrayError::NotStraight(2, "tilted"));
}
