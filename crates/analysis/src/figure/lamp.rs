//! Figure of how the colors of objects change from one light to another, for the eye and on film.

use spectra_plot::legend::shortened;
use spectra_plot::{Canvas, Color, Rect, Stroke, TextStyle, nice_ticks};

const WIDTH: f64 = 1000.0;
const LEFT: f64 = 150.0;
const ROW: f64 = 34.0;
const TOP: f64 = 106.0;
/// Left edge of the bars, to the right of the patches.
const BARS: f64 = 420.0;
const RIGHT: f64 = 960.0;
const EYE: Color = Color::PALETTE[0];
const LAYERS: Color = Color::PALETTE[2];
const FILM: Color = Color::PALETTE[1];

/// The colors of an object in two lights.
#[derive(Clone, Debug)]
pub struct Patch {
    /// Name of the object.
    pub name: String,
    /// Colors seen by the eye in the reference light and in the lamp, sRGB, after adaptation to each light.
    pub eye: [[u8; 3]; 2],
    /// Colors of the finished picture in both lights, sRGB, balanced so that a gray is neutral in each.
    pub film: [[u8; 3]; 2],
    /// Color difference between the two lights, CIEDE2000: for the eye, for the layers of the film, and in the picture.
    pub apart: [f64; 3],
}

/// Draws objects in rows. A row shows the object's colors in a reference light and in a lamp side by side, for the eye and on
/// film, and bars of the color difference. `below` are two lines of text under the title.
#[must_use]
pub fn lamp(title: &str, below: [&str; 2], patches: &[Patch]) -> Canvas {
    let bottom = TOP + ROW * patches.len() as f64;
    let mut canvas = Canvas::new(WIDTH, bottom + 64.0, title);
    canvas.text([24.0, 30.0], &shortened(title), &TextStyle::new(16.0).weight(1.4));
    for (line, y) in below.into_iter().zip([52.0, 70.0]) {
        canvas.text([24.0, y], line, &TextStyle::new(12.5).color(Color::GREY));
    }
    let small = TextStyle::new(12.5);
    for (x, name, color) in [
        (LEFT, "eye", EYE),
        (LEFT + 128.0, "film", FILM),
        (BARS, "eye", EYE),
        (BARS + 40.0, "layers", LAYERS),
        (BARS + 100.0, "film", FILM),
    ] {
        canvas.text([x, TOP - 10.0], name, &small.clone().weight(1.3).color(color));
    }
    let most = patches.iter().flat_map(|p| p.apart).fold(1.0, f64::max);
    let ticks = nice_ticks(0.0, 1.05 * most, 6);
    let x = |value: f64| BARS + (RIGHT - BARS) * value / (1.05 * most);
    for value in &ticks.values {
        canvas.line([x(*value), TOP], [x(*value), bottom], &Stroke::new(Color::PALE, 0.8));
        canvas.text([x(*value), bottom + 18.0], &ticks.label(*value), &small.clone().middle());
    }
    let about = "color difference between the two lights / CIEDE2000";
    canvas.text([0.5 * (BARS + RIGHT), bottom + 42.0], about, &TextStyle::new(13.5).middle());
    for (i, patch) in patches.iter().enumerate() {
        let top = TOP + ROW * i as f64;
        canvas.text([LEFT - 12.0, top + 0.5 * ROW + small.half_cap()], &shortened(&patch.name), &small.clone().end());
        for (left, colors) in [(LEFT, patch.eye), (LEFT + 128.0, patch.film)] {
            let place = Rect::new(left, top + 2.0, left + 112.0, top + ROW - 2.0);
            // The two halves touch without a line between them, so that equal colors look like one patch.
            canvas.rectangle(place, Color::from(colors[0]));
            canvas.rectangle(Rect { left: left + 56.0, ..place }, Color::from(colors[1]));
        }
        let bars = patch.apart.into_iter().zip([EYE, LAYERS, FILM]);
        for (k, (value, color)) in bars.enumerate() {
            let from = top + 3.0 + 9.5 * k as f64;
            canvas.rectangle(Rect::new(BARS, from, x(value).max(BARS + 0.5), from + 8.5), color);
        }
    }
    canvas.line([BARS, TOP], [BARS, bottom], &Stroke::new(Color::INK, 1.1));
    canvas
}
