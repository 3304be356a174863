//! Turns the focus ring and prints how sharp the picture is: `cargo run --release -p spectra-session --example focus`.

use spectra_core::frame::ExposureFrame;
use spectra_plugins as _;
use spectra_session::{Control, Session, SessionError, SessionOptions, Threads};

fn main() -> Result<(), SessionError> {
    let scene = std::env::args().nth(1).unwrap_or_else(|| "biotar-ortho".to_owned());
    let set = ["imager.resolution=[480, 320]", "render.samples=16"].map(str::to_owned);
    let mut session = Session::open(scene.as_ref(), &set, SessionOptions::default())?;
    println!("focus / m   sharpness");
    for step in 0..=10 {
        let metres = 1.5 + 0.1 * f64::from(step);
        session.change(&format!("lens.focus={metres} m"))?;
        session.advance(16, &Threads(2), &Control::new())?;
        let sharpness = sharpness(&session.rendering()?.exposure);
        println!("{metres:9.2}   {sharpness:9.5}   {}", "*".repeat((1000.0 * sharpness) as usize));
    }
    Ok(())
}

/// Returns the mean squared step from pixel to pixel over the mean square; a blurred picture has small steps.
fn sharpness(exposure: &ExposureFrame) -> f64 {
    let values = &exposure.channels[0].values;
    let width = exposure.size.width_px as usize;
    let steps = values.chunks(width).flat_map(|row| row.windows(2).map(|pair| f64::from(pair[1] - pair[0]).powi(2)));
    let square: f64 = values.iter().map(|v| f64::from(*v).powi(2)).sum();
    steps.sum::<f64>() / square
}
