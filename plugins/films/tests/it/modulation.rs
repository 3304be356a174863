//! Edges in the film process: comparison of the developed film with the MTF on the data sheet.

use crate::film::build;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::stage::Film;
use spectra_film::print::metered_exposure_lx_s;
use spectra_plugin_films::StockFilm;
use std::f64::consts::PI;

/// Returns a frame of square pixels that has the exposure `value(column, row)` in every channel.
fn frame(film: &StockFilm, [width, height]: [u32; 2], pitch_mm: f64, value: impl Fn(u32, u32) -> f64) -> ExposureFrame {
    let [width_mm, height_mm] = [width, height].map(|n| f64::from(n) * pitch_mm);
    let size = FrameSize { width_px: width, height_px: height, width_mm, height_mm };
    let values: Vec<f32> = (0..width * height).map(|k| value(k % width, k / width) as f32).collect();
    let channel =
        |c: spectra_core::spectral::Channel| ExposureChannel { name: c.name, unit: c.unit, values: values.clone() };
    ExposureFrame { size, channels: film.channels().into_iter().map(channel).collect() }
}

/// Returns the modulation transfer at `frequencies`, cycles/mm. An ideally sharp edge of contrast 1.4 : 1 around the exposure of a mid gray
/// is developed and converted back to exposure through the curve. The loss by the pixel's own size is divided out.
fn response(film: &StockFilm, layer: usize, pitch_mm: f64, frequencies: &[f64]) -> Vec<f64> {
    let gray = metered_exposure_lx_s(film.stock().iso.expect("a speed"));
    let (width, height) = ((2.4 / pitch_mm) as u32, (1.2 / pitch_mm) as u32);
    let edge = |x: u32, _: u32| gray * if x < width / 2 { 1.4_f64.sqrt() } else { 1.0 / 1.4_f64.sqrt() };
    let plane = &film.developed(&frame(film, [width, height], pitch_mm, edge)).expect("complete")[layer];
    let row = &plane[(height / 2 * width) as usize..][..width as usize];
    let exposure = |d: &f32| {
        let x = film.emulsion().log10_exposure_at(layer, f64::from(*d)).expect("on the curve");
        spectra_core::math::pow(10.0, x)
    };
    let profile: Vec<f64> = row.iter().map(exposure).collect();
    // Near the ends of the frame, development is affected by the unexposed film beside it.
    let middle = width as usize / 2;
    let steps: Vec<f64> = (middle / 2..3 * middle / 2).map(|k| profile[k + 1] - profile[k]).collect();
    let total: f64 = steps.iter().sum();
    let at = |f: &f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (k, step) in steps.iter().enumerate() {
            let phase = 2.0 * PI * f * k as f64 * pitch_mm;
            re += step * phase.cos();
            im += step * phase.sin();
        }
        let pixel = PI * f * pitch_mm;
        (re * re + im * im).sqrt() / total.abs() / (pixel.sin() / pixel)
    };
    frequencies.iter().map(at).collect()
}

/// From 10 to 60 cycles/mm the MTF of the film alone is within 0.04 of the sheets, whose curves rise to 1.10 and 1.23. The points are
/// those of the sheets, from the stocks' files.
#[test]
fn edges_are_as_sharp_as_the_sheet_says() {
    for name in ["kodak-tri-x-400", "kodak-double-x-5222"] {
        let film = build(&format!("stock: {name}\nexposure: 1/60 s\ngrain: false\nhalation: off\n"));
        let points: Vec<[f64; 2]> =
            film.stock().layers[0].mtf.iter().copied().filter(|p| (9.0..65.0).contains(&p[0])).collect();
        let frequencies: Vec<f64> = points.iter().map(|p| p[0]).collect();
        for pitch in [0.002, 0.004] {
            let found = response(&film, 0, pitch, &frequencies);
            for ([f, sheet], found) in points.iter().zip(&found) {
                println!("{name}, {pitch} mm, {f:.1} cycles/mm: {found:.3}, sheet {sheet:.3}");
                assert!((found - sheet).abs() < 0.04, "{name} {pitch} {f}: {found}, sheet {sheet}");
            }
            assert!(found[0] > 1.05, "{name}: over 1, as the sheet is");
        }
    }
}

/// An edge falls monotonically without adjacency. With it, the edge overshoots on both sides, and even areas keep the curve's densities.
#[test]
fn edges_overshoot_and_even_areas_do_not() {
    let gray = metered_exposure_lx_s(400.0);
    let row = |yaml: &str| {
        let film = build(&format!("stock: kodak-tri-x-400\nexposure: 1/60 s\ngrain: false\nhalation: off\n{yaml}"));
        let edge = frame(&film, [400, 200], 0.004, |x, _| gray * if x < 200 { 4.0 } else { 0.25 });
        film.developed(&edge).expect("complete")[0][100 * 400..101 * 400].to_vec()
    };
    let (with, without) = (row(""), row("adjacency: false\n"));
    assert!((100..299).all(|k| without[k] >= without[k + 1] - 1e-6));
    let (high, low) = (without[100], without[299]);
    let most = with[100..300].iter().fold(0.0_f32, |a, b| a.max(*b));
    let least = with[100..300].iter().fold(9.0_f32, |a, b| a.min(*b));
    println!("{high} to {most}, {low} to {least}");
    assert!(most > high + 0.02 && least < low - 0.02);
    assert!((with[100] - high).abs() < 0.003 && (with[299] - low).abs() < 0.003);
}

/// Around bright lamps, adjacency makes no density below base and fog and none above the curve's end.
#[test]
fn adjacency_stays_between_the_ends_of_the_curve() {
    for name in ["kodak-tri-x-400", "kodak-double-x-5222", "kodak-vision3-250d-5207", "kodak-ektachrome-100d"] {
        let film = build(&format!("stock: {name}\nexposure: 1/60 s\ngrain: false\n"));
        let lamps = frame(&film, [120, 120], 0.006, |x, y| if (x / 7 + y / 5) % 6 == 0 { 300.0 } else { 1e-5 });
        for (layer, plane) in film.developed(&lamps).expect("complete").iter().enumerate() {
            let (low, high) = film.emulsion().range(layer);
            let inside = |d: &f32| (low - 1e-5..=high + 1e-5).contains(&f64::from(*d));
            assert!(plane.iter().all(inside), "{name} {layer}: {low} to {high}");
        }
    }
}
