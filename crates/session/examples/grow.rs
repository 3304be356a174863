//! Shows a picture in the terminal while it grows: `cargo run --release -p spectra-session --example grow -- scenes/biotar-trix.yaml`.

use spectra_core::frame::DisplayPicture;
use spectra_plugins as _;
use spectra_session::{Control, Session, SessionOptions, Threads};
use std::io::Write;

/// Number of columns that the picture takes in the terminal.
const COLUMNS: u32 = 96;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = std::env::args().nth(1).unwrap_or_else(|| "biotar-trix".to_owned());
    // A cell of the terminal shows two pixels, one above the other.
    let size = format!("imager.resolution=[{COLUMNS}, {}]", COLUMNS * 2 / 3);
    let mut session = Session::open(scene.as_ref(), &[size], SessionOptions::default())?;
    for warning in session.warnings() {
        eprintln!("warning: {warning}");
    }
    let threads = Threads(std::thread::available_parallelism()?.get());
    let all = u64::from(session.scene().render.samples);
    while session.samples() < all {
        // Doubles the samples each time, so that every look lowers the noise by the same factor.
        let more = session.samples().clamp(1, all - session.samples());
        session.step(more, &threads, &Control::new())?;
        let picture = session.develop()?.remove(0).1;
        let mut out = std::io::stdout().lock();
        write!(out, "\x1b[H\x1b[2J{}", cells(&picture))?;
        writeln!(out, "{} of {all} samples of each pixel", session.samples())?;
    }
    Ok(())
}

/// Draws the picture in colored half blocks.
fn cells(picture: &DisplayPicture) -> String {
    let code = |linear: f32| {
        // The sRGB curve, IEC 61966-2-1.
        let v = f64::from(linear).clamp(0.0, 1.0);
        let coded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (255.0 * coded).round() as u8
    };
    let width = picture.width_px as usize;
    let mut text = String::new();
    for rows in picture.rgb.chunks(2 * width) {
        for column in 0..width {
            let [r, g, b] = rows[column].map(code);
            let [x, y, z] = rows.get(width + column).copied().unwrap_or_default().map(code);
            text.push_str(&format!("\x1b[38;2;{r};{g};{b}m\x1b[48;2;{x};{y};{z}m\u{2580}"));
        }
        text.push_str("\x1b[0m\n");
    }
    text
}
