//! Grain of the film process, measured like a microdensitometer does, through a round aperture of 48 um.

use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::math::{log10, pow};
use spectra_core::registry::Context;
use spectra_core::resources::Resources;
use spectra_core::spectral::BAND;
use spectra_core::stage::Film;
use spectra_film::stock::Stock;
use spectra_plugin_films::StockFilm;
use spectra_scene::FileResources;

const APERTURE_MM: f64 = 0.048;
/// Apertures along a side. There are 8100 in all, so the standard deviation is known to 0.8 %.
const MANY: usize = 90;

fn build(stock: &str) -> StockFilm {
    let folder = tempfile::tempdir().expect("a folder");
    let plain = "exposure: 1/60 s\nscatter: false\nadjacency: false\nhalation: off\n";
    std::fs::write(folder.path().join("film.yaml"), format!("stock: {stock}\n{plain}")).expect("written");
    let resources = FileResources::beside(folder.path());
    let params = resources.document("film.yaml", &[], &[]).expect("YAML");
    StockFilm::build(&params, &Context::new(&resources, BAND)).unwrap_or_else(|faults| panic!("{stock}: {faults}"))
}

/// Returns the mean amount of each layer in each round aperture, on film that was evenly exposed to `lx_s`.
fn read(film: &StockFilm, lx_s: f64, pitch_mm: f64) -> Vec<Vec<f64>> {
    let side = (MANY as f64 * APERTURE_MM / pitch_mm).round() as usize;
    let side_mm = side as f64 * pitch_mm;
    let size = FrameSize { width_px: side as u32, height_px: side as u32, width_mm: side_mm, height_mm: side_mm };
    let channel = |c: spectra_core::spectral::Channel| ExposureChannel {
        name: c.name,
        unit: c.unit,
        values: vec![lx_s as f32; side * side],
    };
    let frame = ExposureFrame { size, channels: film.channels().into_iter().map(channel).collect() };
    let planes = film.developed(&frame).expect("complete");
    // Weights of the pixels under an aperture, from 8 x 8 points in each pixel. Apertures are aligned to whole pixels.
    let across = (APERTURE_MM / pitch_mm).round() as usize;
    let inside = |k: usize, s: usize| (k as f64 + (s as f64 + 0.5) / 8.0) / across as f64 - 0.5;
    let weight = |x: usize, y: usize| {
        let points = (0..64).filter(|s| {
            let (u, v) = (inside(x, s % 8), inside(y, s / 8));
            u * u + v * v <= 0.25
        });
        points.count() as f64
    };
    let weights: Vec<f64> = (0..across * across).map(|k| weight(k % across, k / across)).collect();
    let all: f64 = weights.iter().sum();
    let mean = |plane: &[f32], a: usize, b: usize| {
        let value = |k: usize| f64::from(plane[(b * across + k / across) * side + a * across + k % across]);
        weights.iter().enumerate().map(|(k, w)| w * value(k)).sum::<f64>() / all
    };
    planes.iter().map(|plane| (0..MANY * MANY).map(|k| mean(plane, k % MANY, k / MANY)).collect()).collect()
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    (mean, 1e3 * (values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0)).sqrt())
}

/// At density 1 over base and fog, silver has the granularity of its data sheet (F-4017 and H-1-5222), or the assumed one of other stocks.
#[test]
fn silver_is_as_grainy_as_its_figure_at_any_pixel() {
    for (stock, figure) in [
        ("kodak-tri-x-400", 17.0),
        ("kodak-double-x-5222", 14.0),
        ("ilford-ortho-plus", 10.0),
        ("blue-sensitive-plate", 14.0),
        ("panchromatic-plate", 14.0),
        ("kodak-t-max-100", 8.0),
        ("kodak-t-max-400", 10.0),
    ] {
        let film = build(stock);
        let clear = film.emulsion().range(0).0;
        let lx_s = pow(10.0, film.emulsion().log10_exposure_at(0, clear + 1.0).expect("on the curve"));
        for pitch in [0.002, 0.004, 0.008] {
            let (mean, found) = rms(read(&film, lx_s, pitch)[0].iter().copied());
            println!("{stock}, {pitch} mm: density {:.4} over fog, RMS {found:.2}, figure {figure}", mean - clear);
            assert!((mean - clear - 1.0).abs() < 0.003, "{stock} {mean}");
            assert!((found / figure - 1.0).abs() < 0.05, "{stock} {pitch}: {found}, figure {figure}");
        }
    }
}

/// Neutrally exposed color film, measured through the filter of each layer, has the sheet's granularity at that density, within 5 %, at
/// any pixel size. This includes what the dyes of other layers add through the filter.
#[test]
fn color_film_is_as_grainy_as_its_sheet_through_each_filter() {
    let resources = FileResources::beside("/nowhere".as_ref());
    let mut all = vec![
        ("kodak-vision3-250d-5207", vec![-2.3, -1.4, -0.5], vec![0.002, 0.004, 0.008]),
        ("kodak-ektachrome-100d", vec![-1.4, -1.0, -0.6], vec![0.002, 0.004, 0.008]),
    ];
    for name in Stock::bundled() {
        let stock = Stock::load(name, &resources).unwrap_or_else(|faults| panic!("{faults}"));
        if let Some(iso) = stock.iso.filter(|_| stock.layers.len() == 3 && all.iter().all(|s| s.0 != name)) {
            all.push((name, vec![log10(10.0 / iso)], vec![0.008]));
        }
    }
    for (stock, exposures, pitches) in all {
        let film = build(stock);
        let names: Vec<&str> = film.stock().layers.iter().map(|l| l.name.as_str()).collect();
        let products = film.stock().densitometry.products(&names).expect("filters");
        let densities = |amounts: &[f64]| -> Vec<f64> {
            film.emulsion().deposit().receiver_sums(amounts, &products).into_iter().map(|v| -log10(v)).collect()
        };
        let least: Vec<f64> = (0..3).map(|l| film.emulsion().range(l).0).collect();
        let clear = densities(&least);
        for x in exposures {
            for &pitch in &pitches {
                let planes = read(&film, pow(10.0, x), pitch);
                let read: Vec<Vec<f64>> =
                    (0..MANY * MANY).map(|k| densities(&[planes[0][k], planes[1][k], planes[2][k]])).collect();
                for layer in 0..3 {
                    let (mean, found) = rms(read.iter().map(|d| d[layer]));
                    let over = mean - clear[layer];
                    let table = &film.stock().layers[layer].granularity;
                    let above = table.partition_point(|p| p[0] <= over).clamp(1, table.len() - 1);
                    let [a, b] = [table[above - 1], table[above]];
                    let sheet = a[1] + (b[1] - a[1]) * ((over - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0);
                    let name = names[layer];
                    println!("{stock}, {pitch} mm, {name} at {over:.3}: RMS {found:.2}, sheet {sheet:.2}");
                    assert!(
                        (found / sheet - 1.0).abs() < 0.05,
                        "{stock} {pitch} {name} {over}: {found}, sheet {sheet}"
                    );
                }
            }
        }
    }
}
