//! Tests of `frame`, the traces of camera and handling: no change if it is off, and the same result for a frame however it is reached.

use spectra_core::frame::{ExposureChannel, ExposureFrame, FrameSize};
use spectra_core::stage::Film;
use spectra_plugin_films as _;
use spectra_testing::{assert_fault, film};

const SIZE: FrameSize = FrameSize { width_px: 120, height_px: 80, width_mm: 36.0, height_mm: 24.0 };

/// Returns a film and a manually exposed frame, mid gray with a bright square.
fn exposed(stock: &str, more: &str) -> (Box<dyn Film>, ExposureFrame) {
    let film = film(&format!("{{stock: {stock}, exposure: 1 s, optics: off{more}}}"));
    let gray = if stock == "kodak-tri-x-400" { 10.0 / 400.0 } else { 0.1 };
    let values = (0..SIZE.pixels()).map(|i| {
        let (x, y) = (i % 120, i / 120);
        if (50..60).contains(&x) && (30..40).contains(&y) { 3.0 * gray } else { gray }
    });
    let values: Vec<f32> = values.collect();
    let channel = |c: spectra_core::spectral::Channel| ExposureChannel {
        name: c.name.to_string(),
        unit: "lx s".into(),
        values: values.clone(),
    };
    let channels = film.channels().into_iter().map(channel).collect();
    (film, ExposureFrame { size: SIZE, channels })
}

/// Settings that switch off scatter, adjacency, halation and grain.
const BARE: &str = ", scatter: false, adjacency: false, halation: off, grain: false";

fn picture(stock: &str, more: &str, frame: u64) -> spectra_core::frame::DisplayPicture {
    let (mut film, exposure) = exposed(stock, more);
    film.set_frame(frame);
    film.develop(&exposure).expect("developed")
}

#[test]
fn nothing_happens_unasked() {
    for more in ["", BARE] {
        let plain = picture("kodak-tri-x-400", more, 3);
        assert_eq!(plain, picture("kodak-tri-x-400", &format!("{more}, frame: {{}}"), 3));
    }
}

/// Dust is white on a print and black in a projection; scratches are white on a print and bright in a projection.
#[test]
fn dust_holds_light_back() {
    for (stock, effect, lighter) in [
        ("kodak-tri-x-400", "dust: 40", true),
        ("kodak-ektachrome-100d", "dust: 40", false),
        ("kodak-tri-x-400", "scratches: 8", true),
        ("kodak-ektachrome-100d", "scratches: 8", true),
    ] {
        let plain = picture(stock, BARE, 1);
        let soiled = picture(stock, &format!("{BARE}, frame: {{{effect}}}"), 1);
        let changed: Vec<f32> =
            plain.rgb.iter().zip(&soiled.rgb).map(|(a, b)| b[1] - a[1]).filter(|d| *d != 0.0).collect();
        assert!(changed.len() > 20, "{stock} {effect}: {}", changed.len());
        assert!(changed.iter().all(|d| (*d > 0.0) == lighter), "{stock} {effect}: {changed:?}");
    }
}

/// A frame looks the same whatever frames came before it; the next frame looks different.
#[test]
fn frames_are_their_own() {
    for effect in ["gate-weave: 0.3 mm", "breathing: 0.2", "dust: 40", "scratches: 8"] {
        let more = format!("{BARE}, frame: {{{effect}}}");
        let (mut film, exposure) = exposed("kodak-tri-x-400", &more);
        film.set_frame(9);
        let ninth = film.develop(&exposure).expect("developed");
        film.set_frame(8);
        let eighth = film.develop(&exposure).expect("developed");
        film.set_frame(9);
        assert_eq!(ninth, film.develop(&exposure).expect("developed"), "{effect}");
        // A scratch lasts for several frames, but it varies along the film.
        assert_ne!(ninth, eighth, "{effect}");
        let other = picture("kodak-tri-x-400", &format!("{more}, grain-seed: 5"), 9);
        assert_ne!(ninth, other, "{effect}");
    }
}

/// Inside the border the frame is unchanged, grain by grain. Around it are unexposed film with letters, and perforations.
#[test]
fn a_border_leaves_the_frame_alone() {
    const LEFT: usize = 3;
    const TOP: usize = 18;
    let more = ", scatter: false, adjacency: false, halation: off";
    for (stock, hole_is_light) in [("kodak-tri-x-400", false), ("kodak-ektachrome-100d", true)] {
        let plain = picture(stock, more, 1);
        let framed = picture(stock, &format!("{more}, frame: {{border: still}}"), 1);
        assert_eq!((framed.width_px, framed.height_px), (126, 116));
        for y in 0..80 {
            let inner = &framed.rgb[(TOP + y) * 126 + LEFT..][..120];
            assert_eq!(inner, &plain.rgb[y * 120..(y + 1) * 120], "{stock} {y}");
        }
        // A place near the center of a perforation: half a pitch beside the middle, 2.01 mm and half of 2.8 mm from the edge.
        let (x, y) = (63.0 + 0.5 * 4.75 / 0.3, (2.01 + 1.4 - 0.1) / 0.3);
        let hole = framed.rgb[y as usize * 126 + x as usize];
        assert!(if hole_is_light { hole[1] > 0.9 } else { hole[1] < 0.05 }, "{stock}: {hole:?}");
        let letters = framed.rgb[..6 * 126].iter().filter(|p| p[1] > 0.3).count();
        assert!(letters > 15, "{stock}: {letters}");
    }
}

#[test]
fn a_frame_lies_between_the_perforations() {
    let (film, _) = exposed("kodak-tri-x-400", ", frame: {border: cine}");
    let [text, hint] = film.check_frame(&SIZE).expect_err("36 mm on 35 mm film");
    assert!(text.contains("perforations") && hint.contains("plain"), "{text} {hint}");
    assert!(film.check_frame(&FrameSize { width_mm: 24.0, height_mm: 16.0, ..SIZE }).is_ok());
    for slip in ["dust: -1", "gate-weave: 3 mm", "border: polaroid", "scratches: 1000"] {
        let key = slip.split(':').next().unwrap_or_default();
        let scene = format!("{{stock: kodak-tri-x-400, exposure: 1 s, frame: {{{slip}}}}}");
        assert_fault("film", &scene, &format!("frame.{key}"));
    }
}
