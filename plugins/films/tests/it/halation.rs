//! Halation of the bundled stocks in the film process.

use crate::film::build;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::stage::Film;
use spectra_film::stock::{Process, Stock};
use spectra_plugin_films::StockFilm;
use spectra_scene::FileResources;

const SIDE: u32 = 201;
const PITCH_MM: f64 = 0.006;

/// Returns a frame of exposure `dark` with one pixel of exposure `light` in the middle.
fn point(film: &StockFilm, light: f32, dark: f32) -> ExposureFrame {
    let side_mm = f64::from(SIDE) * PITCH_MM;
    let size = FrameSize { width_px: SIDE, height_px: SIDE, width_mm: side_mm, height_mm: side_mm };
    let middle = (SIDE / 2 * SIDE + SIDE / 2) as usize;
    let values: Vec<f32> = (0..(SIDE * SIDE) as usize).map(|k| if k == middle { light } else { dark }).collect();
    let channel =
        |c: spectra_core::spectral::Channel| ExposureChannel { name: c.name, unit: c.unit, values: values.clone() };
    ExposureFrame { size, channels: film.channels().into_iter().map(channel).collect() }
}

/// Returns the middle row of a plane from its center to the right end.
fn ray<T: Copy>(plane: &[T]) -> Vec<T> {
    let middle = (SIDE / 2) as usize;
    plane[middle * SIDE as usize + middle..][..=middle].to_vec()
}

/// Every camera film has halation, says that it is assumed, and has none if it is switched off.
#[test]
fn every_camera_film_halates_unless_told_not_to() {
    let resources = FileResources::beside("/nowhere".as_ref());
    for name in Stock::bundled() {
        let stock = Stock::load(name, &resources).unwrap_or_else(|faults| panic!("{faults}"));
        if stock.process == Process::Print {
            continue;
        }
        assert!(stock.halation.as_ref().is_some_and(|h| h.assumed), "{name}");
        let plain = format!("stock: {name}\nexposure: 1/60 s\nscatter: false\n");
        let last = stock.layers.len() - 1;
        let halo = |more: &str| {
            let film = build(&format!("{plain}{more}"));
            let frame = point(&film, 1e4, 0.0);
            ray(&film.exposed(&frame).expect("complete")[last])[60]
        };
        assert!(halo("") > 0.0, "{name}");
        assert_eq!(halo("halation: off\n"), 0.0, "{name}");
        assert!(build(&plain).describe().contains("halation"), "{name}");
        // Settings of a scene act alike on all stocks, so three are enough.
        if !["kodak-tri-x-400", "kodak-vision3-250d-5207", "kodak-ektachrome-100d"].contains(&name) {
            continue;
        }
        assert_eq!(halo("assumed: off\n"), 0.0, "{name}");
        assert!(halo("assumed: off\nhalation: {entering: 0.2, transmittance: 0.5, index: 1.5}\n") > 0.0, "{name}");
        assert!(!build(&format!("{plain}halation: off\n")).describe().contains("halation"), "{name}");
    }
}

/// Returning light reaches the layers from below: first red, then green, then blue. In the red and green layers the ring begins where
/// total reflection does, at 2 t tan(asin(1/n)).
#[test]
fn halos_on_color_film_are_as_the_layers_lie() {
    for name in ["kodak-vision3-250d-5207", "kodak-ektachrome-100d"] {
        let film = build(&format!("stock: {name}\nexposure: 1/60 s\nscatter: false\ngrain: false\n"));
        let layers = film.exposed(&point(&film, 1e5, 0.0)).expect("complete");
        let [blue, green, red] = [0, 1, 2].map(|l| ray(&layers[l]));
        let want = 2.0 * 0.13 * spectra_core::math::tan(spectra_core::math::asin(1.0 / 1.48));
        for layer in [&green, &red] {
            let steepest = (8..95).max_by(|a, b| {
                let step = |k: usize| layer[k + 1] - layer[k];
                step(*a).total_cmp(&step(*b))
            });
            let ring = (steepest.expect("some") as f64 + 0.5) * PITCH_MM;
            println!("{name}: ring at {ring:.4} mm, by total reflection {want:.4}");
            assert!((ring - want).abs() < 1.5 * PITCH_MM, "{ring} {want}");
        }
        for k in [10, 30, 45, 60, 90] {
            let shares = [blue[k] / red[k], green[k] / red[k]];
            println!("{name} at {:.3} mm: blue {:.4}, green {:.4} of red", k as f64 * PITCH_MM, shares[0], shares[1]);
            // Fractions of the light that enters the base. Each layer is scaled by its response to even light with halation, which changes
            // them by under 2 %.
            assert!((shares[0] / 0.01 - 1.0).abs() < 0.03 && (shares[1] / 0.25 - 1.0).abs() < 0.03, "{shares:?}");
        }
    }
}

/// Around a white lamp in the dark, a slide and the print of a color negative without backing show a red to orange halo.
#[test]
fn the_halo_of_a_white_lamp_is_red_to_orange() {
    for (name, light) in [("cinestill-800t", 2e5), ("kodak-ektachrome-100d", 2e6)] {
        let film = build(&format!("stock: {name}\nexposure: 1/60 s\ngrain: false\n"));
        let gray = 10.0 / film.stock().iso.expect("a speed") as f32;
        let picture = film.develop(&point(&film, gray * light, gray * 0.01)).expect("complete");
        let row = ray(&picture.rgb);
        let [r, g, b] = row[48].map(f64::from);
        let hue = 60.0 * (g - b) / (r - b);
        println!("{name}: {r:.4} {g:.4} {b:.4}, hue {hue:.0} degrees");
        assert!(r > 1.5 * g && g > b && (0.0..45.0).contains(&hue), "{name}: {r} {g} {b}");
    }
}
