//! Tests of the bundled Ilford Ortho Plus against its sheet.

use spectra_core::math::{log10, pow};
use spectra_core::spectral::{BAND, Grid};
use spectra_film::develop::{Effects, develop};
use spectra_film::emulsion::{Emulsion, EmulsionError};
use spectra_film::raster::Raster;
use spectra_film::stock::{SensitivityScale, SpectralSensitivity, Stock};
use spectra_scene::FileResources;
use spectra_spectrum::{Emission, illuminant, v_lambda};

fn ortho_plus() -> Stock {
    Stock::load("ilford-ortho-plus", &FileResources::beside("/nowhere".as_ref())).expect("bundled and sound")
}

fn sensitometric() -> (Emission, Emission) {
    let light = |name| illuminant(name).expect("bundled");
    (light("iso-7589-sensitometric-daylight"), light("iso-7589-sensitometric-studio-tungsten"))
}

#[test]
fn says_what_the_sheet_says() {
    let stock = ortho_plus();
    assert_eq!((stock.iso, stock.iso_tungsten), (Some(80.0), Some(40.0)));
    assert_eq!(stock.bases.iter().map(|b| b.thickness_mm).collect::<Vec<_>>(), [0.125, 0.18]);
    assert!(stock.layers[0].developments[0].assumed && stock.layers[0].developments[0].remark.is_some());
    assert_eq!(stock.filter_factors.len(), 4);
    assert_eq!(Stock::bundled().filter(|name| *name == "ilford-ortho-plus").count(), 1);
}

/// The sheet's ISO 80 in daylight and 40 in tungsten light are steps of a third of a stop: 1.58 to 2.5. An independent computation from the
/// table, read as equal-energy, gives 1.73.
#[test]
fn daylight_to_tungsten_speed_ratio() {
    let (daylight, tungsten) = sensitometric();
    let sensitivity = &ortho_plus().layers[0].sensitivity;
    let ratio = sensitivity.per_lux(&daylight) / sensitivity.per_lux(&tungsten);
    assert!((1.58..=2.5).contains(&ratio), "{ratio}");
    assert!((ratio - 1.73).abs() <= 0.005, "{ratio}");
}

/// The other reading of the same plot, divided by a lamp of 2850 K: an independent computation gives 2.15.
#[test]
fn speed_ratio_where_the_lamp_is_divided_out() {
    let (daylight, tungsten) = sensitometric();
    let text = spectra_data::text("spectra/film/ilford-ortho-plus.csv").expect("bundled");
    let table = spectra_spectrum::table::Table::parse("ortho", text, None).expect("sound");
    let points: Vec<[f64; 2]> =
        table.wavelengths_nm.iter().zip(table.values[0].iter()).map(|(w, s)| [*w, *s]).collect();
    let lamp = Emission::blackbody(2850.0).expect("a lamp");
    let divided =
        SpectralSensitivity::new(&points, SensitivityScale::Log10 { floor: Some(0.0) }, Some(lamp)).expect("sound");
    let ratio = divided.per_lux(&daylight) / divided.per_lux(&tungsten);
    assert!((ratio - 2.15).abs() <= 0.01, "{ratio}");
}

#[test]
fn sees_blue_and_green_but_no_red() {
    let stock = ortho_plus();
    let s = |w: f64| stock.layers[0].sensitivity.at(w);
    for w in [350.0, 355.0, 565.0, 570.0, 589.3, 643.85, 656.27, 830.0] {
        assert_eq!(s(w), 0.0, "{w}");
    }
    // Peaks of the digitized plot: 10^0.976 at 425 nm and 10^0.978 at 540 nm, with a saddle of 10^0.806 at 510 nm.
    for (w, want) in [(425.0, 9.4624), (540.0, 9.5060), (510.0, 6.3973)] {
        assert!((s(w) / want - 1.0).abs() < 1e-4, "{w}: {}", s(w));
    }
    // 2 to 8 % of a daylight exposure comes from below 380 nm: the band must begin at 350.
    let light = illuminant("D65").expect("bundled");
    let below = Grid { start_nm: 350.0, step_nm: 1.0, count: 31 };
    let seen = |grid: Grid| {
        let table: Vec<f64> = grid.wavelengths_nm().map(s).collect();
        light.to_power(&grid).seen_by(&table)
    };
    let share = seen(below) / seen(BAND);
    assert!((0.02..0.08).contains(&share), "{share}");
}

/// Definition of the unit: the reference light gives as many lux-seconds on film as for the eye, whatever the grid of a scene.
#[test]
fn reference_daylight_gives_its_photometric_exposure() {
    let stock = ortho_plus();
    let (daylight, tungsten) = sensitometric();
    let power = daylight.to_power(&BAND);
    let v = v_lambda();
    let lux_of = |light: &Emission| {
        let luminous: Vec<f64> = BAND.wavelengths_nm().map(|w| 683.0 * v.at(w)).collect();
        light.to_power(&BAND).seen_by(&luminous)
    };
    let channel = &stock.channels(&BAND).expect("seen")[0];
    assert_eq!((channel.name.as_str(), channel.unit.as_str()), ("ortho", "lx s"));
    assert!((power.seen_by(&channel.response) / lux_of(&daylight) - 1.0).abs() < 1e-12);
    // In tungsten light the film is slower by the ratio above.
    let slower = tungsten.to_power(&BAND).seen_by(&channel.response) / lux_of(&tungsten);
    assert!((1.0 / slower - 1.73).abs() < 0.005, "{slower}");
    let narrow = Grid { start_nm: 400.0, step_nm: 1.0, count: 301 };
    let same = &stock.channels(&narrow).expect("seen")[0];
    assert_eq!(same.response[0], channel.response[50]);
}

/// ISO 6:1993: 0.8/S lx s gives 0.1 above base and fog. The sheet's pictorial average gradient is .62 to .70, over 1.5 of log10 exposure
/// from there (Ilford). It must not depend much on the measured length (ISO 6: 1.3).
#[test]
fn curve_passes_the_speed_point_with_the_gradient_of_the_sheet() {
    let stock = ortho_plus();
    let curve = &stock.layers[0].developments[0].curve;
    assert!((curve.density(log10(0.8 / 80.0)) - 0.1).abs() < 1e-12);
    assert!((curve.speed_point().expect("has one") - log10(0.01)).abs() < 1e-12);
    let over = |span| curve.average_gradient(span).expect("has a speed point");
    assert!((over(1.5) - 0.66).abs() < 1e-12, "{}", over(1.5));
    assert!((0.62..=0.70).contains(&over(1.3)), "{}", over(1.3));
    assert_eq!(curve.density_range(), (0.0, 2.5));
    assert_eq!(curve.unexposed_density(), 0.0);
}

/// Develops a row of pixels, exposed for `time_s`, on a film without effects.
fn developed(development: &str, row: &[f32], time_s: f64) -> Result<Vec<f32>, EmulsionError> {
    let stock = ortho_plus();
    let emulsion = Emulsion::new(&stock, development)?;
    let effects = Effects {
        mtf: vec![None],
        adjacency: vec![None],
        halation: vec![None],
        granularity: None,
        assumed: Vec::new(),
        piece: 0,
        seed: 0,
        first_layer: 0,
    };
    let factor = stock.reciprocity.map_or(1.0, |r| r.effect(time_s));
    let raster = Raster::new(row.len(), 1, 1.0);
    let planes = develop(&emulsion, &effects, &[row], factor, [&raster; 2], |_, plane| plane, |_, _| ());
    Ok(planes.expect("no effects").remove(0))
}

/// A step wedge of 21 half-stop steps through the whole development gives the stock's own curve.
#[test]
fn a_step_wedge_recovers_the_curve() {
    let curve = &ortho_plus().layers[0].developments[0].curve;
    let steps: Vec<f32> = (0..21).map(|i| 1e-3 * pow(2.0, f64::from(i) * 0.5) as f32).collect();
    let wedge = developed("pictorial", &steps, 1.0 / 60.0).expect("complete");
    assert_eq!(wedge.len(), steps.len());
    for (step, density) in steps.iter().zip(&wedge) {
        let want = curve.density(log10(f64::from(*step)));
        // Interpolation 5e-7, and rounding to 24 bits.
        assert!((f64::from(*density) - want).abs() < 1e-6, "{step}");
    }
    // No light, negative light and NaN leave it clear.
    assert_eq!(developed("pictorial", &[0.0, -1.0, f32::NAN], 1.0).expect("complete"), [0.0; 3]);
    assert!(developed("lith", &steps, 1.0).is_err());
}

/// From the sheet: a metered 10 s becomes 17.8 s, so 17.8 s have the effect of 10 s; up to 1 s nothing is lost.
#[test]
fn long_exposures_lose_what_the_sheet_says() {
    let reciprocity = ortho_plus().reciprocity.expect("printed");
    assert!((17.8 * reciprocity.effect(17.8) - 10.0).abs() < 0.02);
    for time_s in [1e-3, 1.0 / 60.0, 1.0] {
        assert_eq!(reciprocity.effect(time_s), 1.0);
    }
    assert!((reciprocity.effect(1.0 + 1e-9) - 1.0).abs() < 1e-9);
}
