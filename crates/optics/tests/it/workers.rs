//! The pupil search finds the same on any number of threads.

use glam::DVec3;
use spectra_core::workers::Workers;
use spectra_lens::{Aperture, ApertureShape, Iris, Lens};
use spectra_optics::{FrontPupil, RearPupil};
use spectra_plugin_surfaces as _;
use spectra_scene::FileResources;
use spectra_tracer::{Indices, Tracer};
use std::path::Path;

struct Threads(usize);

impl Workers for Threads {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        std::thread::scope(|scope| {
            for _ in 0..self.0 {
                scope.spawn(work);
            }
        });
    }
}

fn lens(name: &str) -> Lens {
    spectra_lens::load(name, &FileResources::beside(Path::new(env!("CARGO_MANIFEST_DIR"))))
        .expect("a lens of the library")
}

/// One thread that is told to stop after this many queries.
struct Impatient(std::sync::atomic::AtomicUsize);

impl Workers for Impatient {
    fn run_on_all(&self, work: &(dyn Fn() + Sync)) {
        work();
    }

    fn should_stop(&self) -> bool {
        use std::sync::atomic::Ordering::Relaxed;
        self.0.fetch_update(Relaxed, Relaxed, |left| left.checked_sub(1)).is_err()
    }
}

/// A search whose result is no longer wanted ends without a result.
#[test]
fn a_search_can_be_stopped() {
    let lens = lens("zeiss-biotar-50-f1.4");
    let band_nm = [450.0, 650.0];
    let tracer = Tracer::new(&lens, Indices::Band { min_nm: band_nm[0], max_nm: band_nm[1] }).expect("media");
    let film = [DVec3::ZERO, DVec3::new(18.0, 12.0, 0.0)];
    // Stopped at the nodes; stopped at the zones; not stopped.
    for (looks, is_found) in [(0, false), (20, false), (150, false), (1_000_000, true)] {
        let workers = Impatient(looks.into());
        assert_eq!(RearPupil::search_on(&lens, &tracer, &film, band_nm, &workers).is_some(), is_found, "{looks}");
    }
}

/// Compares all contents of a pupil by their debug output, which tells numbers apart to the last bit.
#[test]
fn pupils_have_the_same_bits_on_any_number_of_threads() {
    let mut bladed = lens("zeiss-biotar-50-f1.4");
    let stop = bladed.elements.iter_mut().find(|e| e.surface.is_stop()).expect("a stop");
    stop.semi_diameter_mm = Some(4.0);
    let shape = ApertureShape::Iris(Iris { blades: 7, blade_radius_mm: f64::INFINITY, rotation_rad: 0.2 });
    stop.apertures.push(Aperture { shape, center_mm: [0.0; 2], obscures: false });
    let (min_nm, max_nm) = (450.0, 650.0);
    let tracer = |lens: &Lens| Tracer::new(lens, Indices::Band { min_nm, max_nm }).expect("media");
    let plain = lens("canon-35-f1.8");
    let source = [DVec3::new(100.0, 0.0, -2000.0)];
    let alone = FrontPupil::search(&plain, &tracer(&plain), &source, min_nm, max_nm).expect("sizes");
    let many = FrontPupil::search_on(&plain, &tracer(&plain), &source, [min_nm, max_nm], &Threads(3)).expect("sizes");
    assert!(format!("{many:?}") == format!("{alone:?}"), "forward");
    let film = [DVec3::ZERO, DVec3::new(18.0, 12.0, 0.0)];
    let alone = RearPupil::search(&bladed, &tracer(&bladed), &film, min_nm, max_nm).expect("sizes");
    let many = RearPupil::search_on(&bladed, &tracer(&bladed), &film, [min_nm, max_nm], &Threads(3)).expect("sizes");
    assert!(format!("{many:?}") == format!("{alone:?}"), "backward");
}
