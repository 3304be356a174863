//! Tests of the veiling glare index: a bare and a coated lens, a lens that is black inside, and a comparison with light traced in the other
//! direction.

use glam::DVec3;
use spectra_analysis::glare::{BlackDisk, Glare, GlareTask, glare};
use spectra_core::workers::{SingleThread, Workers};
use spectra_lens::{Coating, Lens};
use spectra_optics::stop_down;
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Interior, Particle, WalkNumbers, Walker};

const NM: f64 = 546.074;

fn biotar(f_number: f64, coating: Coating) -> Lens {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../lenses/zeiss-biotar-50-f1.4.yaml");
    let lens = spectra_lens::load(file, &FileResources::beside(std::path::Path::new(""))).expect("a lens");
    stop_down(lens, f_number).expect("open enough").with_coating(coating)
}

fn task(walks: usize) -> GlareTask {
    GlareTask { walks, ..GlareTask::new(NM) }
}

fn found(lens: &Lens, task: &GlareTask) -> Glare {
    let glare = glare(lens, task, &SingleThread).expect("a straight lens");
    println!("{} {:?} paint {}: {glare:?}", lens.name, lens.coating, task.matter.paint);
    let l = glare.ledger;
    let sum = l.white + l.black + l.paint + l.glass + l.coatings + l.imager + l.not_traced;
    assert!((sum - 1.0 - l.aimed).abs() < 1e-9 && l.aimed.abs() < 0.02, "{l:?}");
    glare
}

#[test]
fn a_coating_halves_the_veil_of_a_double_gauss() {
    for (f_number, walks) in [(2.0, 60_000), (5.6, 200_000)] {
        let bare = found(&biotar(f_number, Coating::Bare), &task(walks));
        assert!(bare.index > 0.01 && bare.index < 0.1, "{}", bare.index);
        assert!(bare.standard_error < 0.06 * bare.index && bare.standard_error > 0.0);
        let coated = found(&biotar(f_number, Coating::quarter_wave(1.38, 550.0)), &task(walks));
        assert!(coated.index + 3.0 * coated.standard_error < 0.5 * bare.index, "{} {}", coated.index, bare.index);
    }
}

/// No surface reflects with an ideal coating, black paint and a black imager. Light that glass reflects totally ends at black walls.
#[test]
fn a_lens_that_is_black_inside_has_no_veil() {
    let mut task = task(300_000);
    task.matter.paint = 0.0;
    let glare = found(&biotar(2.0, Coating::Ideal), &task);
    assert!(glare.index < 1e-6, "{glare:?}");
}

/// Traces light of the field from the front to the center of the black disk's image: the index agrees within three standard errors.
#[test]
fn the_index_is_the_share_of_the_light_in_the_black_disk() {
    let lens = biotar(2.0, Coating::Bare);
    // The disk is large, so that enough of the field's light reaches its image.
    let task = GlareTask { disk_mm: 16.0, detector_mm: 11.0, ..task(100_000) };
    let glare = found(&lens, &task);
    let disk = BlackDisk::of(&lens, task.disk_mm).expect("an image");
    let interior = Interior::new(&lens, task.frame_mm, [NM; 2], task.matter).expect("straight");
    let mut walker = Walker::new(&interior);
    walker.set_wavelength(NM);
    // Start evenly over the cap of the first surface, with a cosine distribution about its normal: r = 41.8 mm, clear to 18 mm.
    let (r, clear) = (41.8_f64, 18.0_f64);
    let height = r - (r * r - clear * clear).sqrt();
    let [mut veil, mut all, mut squares] = [0.0_f64, 0.0, 0.0];
    let walks = 3_000_000;
    for walk in 0..walks {
        let mut chance = WalkNumbers::new(2, walk as u64);
        let z = height * chance.number();
        let (s, c) = spectra_core::math::sin_cos_turns(chance.number());
        let across = (2.0 * r * z - z * z).sqrt();
        let at = DVec3::new(across * c, across * s, z);
        let normal = (DVec3::new(0.0, 0.0, r) - at).normalize();
        let (a, b) = spectra_core::math::concentric_disk(chance.number(), chance.number());
        let side = normal.cross(DVec3::X).normalize();
        let direction = a * side + b * normal.cross(side) + (1.0 - a * a - b * b).max(0.0).sqrt() * normal;
        let start = Particle {
            position: at - 1e-3 * direction,
            direction,
            weight: 1.0,
            mirrored: 0,
            scattered: 0,
            diffused: 0,
        };
        let is_black = disk.holds(&start);
        let mut own = 0.0;
        walker.from_front(start, &mut chance, |p| {
            if p.position.x.hypot(p.position.y) < 0.5 * task.detector_mm {
                own += p.weight;
            }
        });
        all += own;
        if !is_black {
            (veil, squares) = (veil + own, squares + own * own);
        }
    }
    let share = veil / all;
    let error = squares.sqrt() / all;
    let sigma = error.hypot(glare.standard_error);
    println!("share of the light {share:.5} +- {error:.5}");
    assert!((share - glare.index).abs() < 3.0 * sigma && sigma < 0.08 * share, "{share} {} {sigma}", glare.index);
}

/// Threads that take pieces of work in any order.
struct Threads(usize);

impl Workers for Threads {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| (0..self.0).for_each(|_| drop(scope.spawn(work))));
    }
}

#[test]
fn the_bits_are_the_same_on_any_threads() {
    let lens = biotar(4.0, Coating::Bare);
    let one = glare(&lens, &task(20_000), &SingleThread);
    assert_eq!(one, glare(&lens, &task(20_000), &Threads(3)));
}
