//! Tests of color film: dyes from densities, and prints, scans and slides from dyes.

use spectra_core::math::{log10, pow};
use spectra_film::emulsion::Emulsion;
use spectra_film::positive::{Positive, PositiveError, ScanScale};
use spectra_film::stock::Stock;
use spectra_film::viewing_options::{PictureBlack, PictureWhite, Surround, ViewingOptions};
use spectra_scene::FileResources;
use spectra_spectrum::{BAND, Emission, find_reflectance, illuminant};

fn stock(name: &str) -> Stock {
    Stock::load(name, &FileResources::beside("/nowhere".as_ref())).unwrap_or_else(|faults| panic!("{faults}"))
}

fn usual(name: &str) -> (Stock, Emulsion) {
    let s = stock(name);
    let development = s.developments().next().expect("has one").to_owned();
    let emulsion = Emulsion::new(&s, &development).expect("sound");
    (s, emulsion)
}

fn d55() -> Emission {
    illuminant("D55").expect("bundled")
}

const GRAY_LX_S: f64 = 10.0 / 250.0;
/// The bare light is white.
const LAMP: ViewingOptions =
    ViewingOptions { white: PictureWhite::Lamp, black: PictureBlack::Kept, surround: Surround::Average };

fn printed() -> (Emulsion, Positive) {
    looked_at(ViewingOptions::default())
}

fn looked_at(look: ViewingOptions) -> (Emulsion, Positive) {
    let (_, negative) = usual("kodak-vision3-250d-5207");
    let (print, developed) = usual("kodak-vision-2383");
    let lamp = print.reference.clone();
    let positive = Positive::printed(&negative, GRAY_LX_S, &print, developed, &lamp, &d55(), look).expect("prints");
    (negative, positive)
}

/// A neutral step wedge, read by the densitometer of the sheet, gives the sheet's curves.
#[test]
fn a_step_wedge_recovers_the_curves_of_the_sheet() {
    for name in ["kodak-vision3-250d-5207", "kodak-vision-2383", "kodak-ektachrome-100d"] {
        let (s, emulsion) = usual(name);
        let names: Vec<&str> = s.layers.iter().map(|l| l.name.as_str()).collect();
        let products = s.densitometry.products(&names).expect("a status");
        let read = |amounts: &[f64]| -> Vec<f64> {
            emulsion.deposit().receiver_sums(amounts, &products).into_iter().map(|v| -log10(v)).collect()
        };
        let clear = read(&[0.0; 3]);
        let mut worst = 0.0_f64;
        for step in 0..60 {
            let x = -3.5 + f64::from(step) * 0.1;
            // Uses planes of a frame, not only the exact curve.
            let amounts: Vec<f64> = (0..3)
                .map(|i| {
                    let mut plane = vec![pow(10.0, x) as f32; 3];
                    emulsion.develop(i, &mut plane, 1.0);
                    f64::from(plane[1])
                })
                .collect();
            for (i, density) in read(&amounts).into_iter().enumerate() {
                let curve = &s.layers[i].developments[0].curve;
                worst = worst.max((density - clear[i] - (curve.density(x) - curve.density_range().0)).abs());
            }
        }
        println!("{name}: worst {worst:.5}");
        assert!(worst < 0.02 / 10.0, "{name}: {worst}");
    }
}

/// Mid gray of the meter's exposure is printed neutral and shown as 18 % of white. In a dark surround it has the aim densities of the print
/// stock, which look like 18.7 % of white there. Unexposed film prints black, and the clear print is white.
#[test]
fn a_mid_gray_prints_neutral() {
    let dark = looked_at(ViewingOptions { surround: Surround::Dark, ..ViewingOptions::default() });
    for ((negative, positive), want) in [(printed(), 0.18), (dark, 0.1873)] {
        let gray = positive.shown(&negative.neutral(log10(GRAY_LX_S)));
        assert!(gray.iter().all(|v| (v - want).abs() < 2e-4), "{want}: {gray:?}");
    }
    let (negative, positive) = printed();
    let black = positive.shown(&negative.neutral(f64::NEG_INFINITY));
    assert!(black.iter().all(|v| *v < 0.003), "{black:?}");
    let mut before = 0.0;
    for step in -20..=30 {
        let shown = positive.shown(&negative.neutral(log10(GRAY_LX_S) + f64::from(step) * 0.1));
        assert!(shown[1] >= before, "{step}: {shown:?}");
        before = shown[1];
    }
    assert!(before > 0.9, "{before}");
}

/// Neutral subjects stay nearly neutral over the usual tones of pictures (three stops below mid gray to two above): encoded channels agree
/// within 7 of 255 in the print, 6 in the scan.
#[test]
fn a_gray_scale_stays_gray() {
    let (negative, print) = printed();
    let scan =
        Positive::scanned(&stock("kodak-vision3-250d-5207"), &negative, GRAY_LX_S, ScanScale::Picture).expect("scans");
    for (positive, most) in [(&print, 7.0), (&scan, 6.0)] {
        for step in -30..=20 {
            let amounts = negative.neutral(log10(GRAY_LX_S) + f64::from(step) * 0.1 * log10(2.0));
            let rgb = spectra_color::RgbSpace::srgb().encode(positive.shown(&amounts)).map(|v| v * 255.0);
            let spread = rgb.iter().fold(0.0_f64, |a, b| a.max(*b)) - rgb.iter().fold(255.0_f64, |a, b| a.min(*b));
            assert!(spread <= most, "{step}: {rgb:?}");
        }
    }
}

/// ColorChecker patches by name: the named hue dominates on print, slide and scan.
#[test]
fn colors_keep_their_names() {
    let light = illuminant("iso-7589-photographic-daylight").expect("bundled");
    let (negative_stock, negative) = usual("kodak-vision3-250d-5207");
    let (slide_stock, slide) = usual("kodak-ektachrome-100d");
    let projected = Positive::transmitted(&slide_stock, &slide, &d55(), ViewingOptions::default()).expect("shows");
    let scan = Positive::scanned(&negative_stock, &negative, GRAY_LX_S, ScanScale::Picture).expect("scans");
    let (_, print) = printed();
    let gray = find_reflectance("colorchecker#neutral-5").expect("bundled");
    let exposed = |s: &Stock, film: &Emulsion, patch: &str| -> Vec<f64> {
        let paint = find_reflectance(&format!("colorchecker#{patch}")).expect("bundled");
        let mid = metered(s);
        let layers = s.channels(&BAND).expect("seen");
        layers
            .iter()
            .enumerate()
            .map(|(i, channel)| {
                let of = |r: &spectra_spectrum::Reflectance| {
                    let response: Vec<f64> =
                        BAND.wavelengths_nm().zip(&channel.response).map(|(w, c)| c * r.at(w)).collect();
                    light.to_power(&BAND).seen_by(&response)
                };
                // The gray patch gets a mid gray's exposure: neutral by the balance of the film.
                film.amount(i, log10(mid * of(&paint) / of(&gray)))
            })
            .collect()
    };
    let leads = |rgb: [f64; 3], high: &[usize], low: &[usize]| {
        high.iter().all(|h| low.iter().all(|l| rgb[*h] > 1.15 * rgb[*l]))
    };
    for (patch, high, low) in [
        ("red", &[0][..], &[1, 2][..]),
        ("green", &[1], &[0, 2]),
        ("blue", &[2], &[0, 1]),
        ("yellow", &[0, 1], &[2]),
        ("magenta", &[0, 2], &[1]),
        ("cyan", &[1, 2], &[0]),
        ("blue-sky", &[2], &[0]),
        ("light-skin", &[0], &[1, 2]),
        ("foliage", &[1], &[2]),
    ] {
        let negative_amounts = exposed(&negative_stock, &negative, patch);
        let slide_amounts = exposed(&slide_stock, &slide, patch);
        for (name, rgb) in [
            ("print", print.shown(&negative_amounts)),
            ("scan", scan.shown(&negative_amounts)),
            ("slide", projected.shown(&slide_amounts)),
        ] {
            assert!(leads(rgb, high, low), "{patch}, {name}: {rgb:?}");
        }
    }
}

fn metered(s: &Stock) -> f64 {
    10.0 / s.iso.expect("rated")
}

/// Whole frames use tables; each place agrees with the sum over the band to half a code value of 8 bits.
#[test]
fn frames_are_shown_as_their_places_are() {
    let (negative, print) = printed();
    let negative_stock = stock("kodak-vision3-250d-5207");
    let scan = Positive::scanned(&negative_stock, &negative, GRAY_LX_S, ScanScale::Picture).expect("scans");
    let table = Positive::transmitted(&negative_stock, &negative, &d55(), LAMP).expect("shows");
    // A lattice of amounts between the steps of the tables.
    let mut planes = [const { Vec::new() }; 3];
    for i in 0..1000_u32 {
        for (k, plane) in planes.iter_mut().enumerate() {
            let digit = i / 10_u32.pow(k as u32) % 10;
            plane.push(0.017 + digit as f32 * 0.187);
        }
    }
    let slices: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
    for (name, positive) in [("print", &print), ("scan", &scan), ("table", &table)] {
        let mut worst = 0.0_f64;
        for (i, shown) in positive.picture(&slices).iter().enumerate() {
            let exact = positive.shown(&planes.iter().map(|p| f64::from(p[i])).collect::<Vec<_>>());
            let code = |v: f64| spectra_color::Transfer::Srgb.encode(v) * 255.0;
            (0..3).for_each(|c| worst = worst.max((code(f64::from(shown[c])) - code(exact[c])).abs()));
        }
        println!("{name}: worst {worst:.3} of 255");
        assert!(worst < 1.0, "{name}: {worst}");
    }
}

/// Silver is neutral on any print stock, and a black-and-white negative prints as gray on color stock.
#[test]
fn black_and_white_prints_on_either_print_stock() {
    let (_, negative) = usual("kodak-double-x-5222");
    for (name, mid) in [("kodak-2302", 0.18), ("kodak-vision-2383", 0.18)] {
        let (print, developed) = usual(name);
        let lamp = print.reference.clone();
        let positive = Positive::printed(&negative, 0.04, &print, developed, &lamp, &d55(), ViewingOptions::default())
            .expect("prints");
        let gray = positive.shown(&negative.neutral(log10(0.04)));
        assert!(gray.iter().all(|v| (v - mid).abs() < 1e-4), "{name}: {gray:?}");
        let plane: Vec<f32> = (0..400).map(|i| 0.25 + i as f32 * 0.003).collect();
        for (d, shown) in plane.iter().zip(positive.picture(&[&plane])) {
            let exact = positive.shown(&[f64::from(*d)]);
            assert!((0..3).all(|c| (f64::from(shown[c]) - exact[c]).abs() < 1e-4), "{name} {d}");
        }
    }
    let (camera, developed) = usual("kodak-tri-x-400");
    let fault = Positive::printed(&negative, 0.04, &camera, developed, &d55(), &d55(), ViewingOptions::default())
        .expect_err("no print stock");
    assert!(matches!(fault, PositiveError::NoPrintStock { .. }));
}

/// One-stop steps from 4 below mid gray to 7 above it. On the logarithmic scale each rises by at least 1 % of the scale, and by more than
/// the grain of a 48 um aperture. The picture rises as well, and ends at white.
#[test]
fn a_scan_holds_what_the_negative_holds() {
    let (stock, negative) = usual("kodak-vision3-250d-5207");
    let scan = |scale| Positive::scanned(&stock, &negative, GRAY_LX_S, scale).expect("scans");
    let (picture, logarithm) = (scan(ScanScale::Picture), scan(ScanScale::Log));
    let code = |v: f64| spectra_color::Transfer::Srgb.encode(v);
    // Density above the base that a step of the scale means.
    let rms = stock.granularity.map_or(0.01, |g| g.rms / 1000.0);
    let mut before: Option<([f64; 3], [f64; 3])> = None;
    for stops in -4..=7 {
        let amounts = negative.neutral(log10(GRAY_LX_S) + f64::from(stops) * log10(2.0));
        let (seen, written) = (picture.shown(&amounts), logarithm.shown(&amounts).map(code));
        println!("{stops:+}: {seen:.4?} {written:.4?}");
        assert!(written.iter().all(|v| *v < 1.0), "{stops:+}: {written:?}");
        if let Some((seen_before, written_before)) = before {
            for c in 0..3 {
                let rise = written[c] - written_before[c];
                assert!(rise >= 0.01 && rise * 1023.0 * 0.002 > rms, "{stops:+}: {written:?}");
                assert!(seen[c] > seen_before[c] && seen[c] <= 1.0, "{stops:+}: {seen:?}");
            }
        }
        before = Some((seen, written));
    }
}

/// The values of a file, linear or logarithmic, give back the density that a densitometer reads.
#[test]
fn scales_of_a_scan_give_back_density() {
    for name in ["kodak-vision3-250d-5207", "kodak-tri-x-400"] {
        let (stock, negative) = usual(name);
        let gray = 10.0 / stock.iso.expect("rated");
        let scan = |scale| Positive::scanned(&stock, &negative, gray, scale).expect("scans");
        let scales = [scan(ScanScale::Log), scan(ScanScale::Density)];
        let products = stock.densitometry.products(&["red", "green", "blue"]);
        let read = |amounts: &[f64]| match &products {
            Some(products) => {
                negative.deposit().receiver_sums(amounts, products).into_iter().map(|v| -log10(v)).collect()
            }
            None => vec![amounts[0]; 3],
        };
        let clear = read(&negative.neutral(f64::NEG_INFINITY));
        for step in -8..=14 {
            let x = log10(gray) + f64::from(step) * 0.5 * log10(2.0);
            // A color, through the tables of a whole frame.
            let offsets: Vec<f64> = (0..negative.layers()).map(|i| x + i as f64 * 0.1).collect();
            let amounts = negative.developed(&offsets);
            let planes: Vec<Vec<f32>> = amounts.iter().map(|a| vec![*a as f32]).collect();
            let planes: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
            let wanted = read(&amounts);
            let files = scales.each_ref().map(|s| {
                s.picture(&planes)[0].map(|v| {
                    // 16 bits of a file.
                    (spectra_color::Transfer::Srgb.encode(f64::from(v)) * 65535.0).round() / 65535.0
                })
            });
            for c in 0..3 {
                let from_log = (files[0][c] * 1023.0 - 95.0) * 0.002 + clear[c];
                let from_linear = files[1][c] * 4.0;
                let saturated = files[0][c] >= 1.0;
                assert!(saturated || (from_log - wanted[c]).abs() < 0.005, "{name} {step}: {from_log} {wanted:?}");
                assert!((from_linear - wanted[c]).abs() < 0.005, "{name} {step}: {from_linear} {wanted:?}");
                assert!(!saturated || step > 12, "{name} {step}: {wanted:?}");
            }
        }
    }
}

/// 24 megapixels of color negative, from exposures to the picture of the print: curves, dyes, printing and viewing. Run with `--ignored
/// --nocapture`; it needs 1.2 GB.
#[test]
#[ignore = "a measurement: prints its time"]
fn time_of_24_megapixels() {
    let (negative, print) = printed();
    let planes: Vec<Vec<f32>> = (0..3_u32)
        .map(|k| (0..24_000_000_u32).map(|i| 1e-3 * (1 + i.wrapping_mul(2_654_435_761 + k) % 1000) as f32).collect())
        .collect();
    let mut planes = planes;
    let begun = std::time::Instant::now();
    planes.iter_mut().enumerate().for_each(|(i, plane)| negative.develop(i, plane, 1.0));
    let developed = begun.elapsed();
    let slices: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
    let picture = print.picture(&slices);
    println!("developed in {developed:.2?}, shown by {:.2?}; {} pixels", begun.elapsed(), picture.len());
    assert_eq!(picture.len(), 24_000_000);
}
