//! The grain that a film tells, as an unevenness of the exposure, against frames that are developed.

use crate::film::build;
use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::stage::Film;

const SIDE: u32 = 192;

/// A frame of uniform exposures (lx s), one for each layer, with pixels of this pitch.
fn uniform(names: &[&str], exposures: &[f64], pitch_mm: f64) -> ExposureFrame {
    let side_mm = f64::from(SIDE) * pitch_mm;
    let size = FrameSize { width_px: SIDE, height_px: SIDE, width_mm: side_mm, height_mm: side_mm };
    let channel = |(name, exposure): (&&str, &f64)| ExposureChannel {
        name: (*name).to_owned(),
        unit: "lx s".into(),
        values: vec![*exposure as f32; (SIDE * SIDE) as usize],
    };
    ExposureFrame { size, channels: names.iter().zip(exposures).map(channel).collect() }
}

/// Grain spreads the amounts of a layer by as much as this unevenness of its exposure would. The tolerance is 6 %: 192 x 192 pixels of
/// correlated grain tell a deviation to within about 1 %, and the gradient is that of a finite step.
#[test]
fn grain_is_as_uneven_as_told() {
    for stock in ["kodak-tri-x-400", "kodak-vision3-250d-5207", "fuji-velvia-50"] {
        let yaml = format!("stock: {stock}\nexposure: 1/60 s\nscatter: false\nhalation: off\nadjacency: false\n");
        let (grainy, smooth) = (build(&yaml), build(&format!("{yaml}grain: false\n")));
        let channels = grainy.channels();
        let names: Vec<&str> = channels.iter().map(|channel| channel.name.as_str()).collect();
        for (pitch_mm, exposure) in [(0.006, 0.03), (0.01875, 0.03), (0.01875, 0.3), (0.075, 0.1)] {
            let even = vec![exposure; names.len()];
            let frame = uniform(&names, &even, pitch_mm);
            let told = grainy.grain_noise(&frame).expect("grain");
            let developed = grainy.developed(&frame).expect("developed");
            for layer in 0..names.len() {
                const STEP: f64 = 0.02;
                let amount = |factor: f64| {
                    let mut exposures = even.clone();
                    exposures[layer] *= factor;
                    f64::from(smooth.developed(&uniform(&names, &exposures, pitch_mm)).expect("developed")[layer][0])
                };
                let gradient = (amount(1.0 + STEP) - amount(1.0 - STEP)).abs() / (2.0 * STEP);
                let plane = &developed[layer];
                let mean = plane.iter().map(|v| f64::from(*v)).sum::<f64>() / plane.len() as f64;
                let variance = plane.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / plane.len() as f64;
                let (found, told) = (variance.sqrt() / gradient, told[layer].at(exposure));
                println!("{stock} {pitch_mm} mm, {exposure} lx s, layer {layer}: {found:.4}, told {told:.4}");
                assert!((told / found - 1.0).abs() < 0.06, "{stock} layer {layer}: {found}, told {told}");
            }
        }
    }
}

#[test]
fn a_film_without_grain_tells_none() {
    let film = build("stock: kodak-tri-x-400\nexposure: 1/60 s\ngrain: false\n");
    assert!(film.grain_noise(&uniform(&["panchromatic"], &[0.1], 0.01)).is_none());
}
