//! The film around the frame: rebate, perforations, and the letters exposed on the edge.

use super::BorderKind;
use super::shape::{Capsule, cover};
use spectra_film::raster::Raster;
use spectra_plot::font::{CAP_HEIGHT, PEN, glyph};

/// Width of the film, mm (ISO 1007, ISO 491).
const FILM_MM: f64 = 35.0;
/// Distance from the film's edge to a perforation, and pitch of the perforations, mm.
const EDGE_MM: f64 = 2.01;
const PITCH_MM: f64 = 4.75;
/// Size of perforations across and along the film, mm. Still film has positive (KS) perforations, rectangles with round corners. Cine film
/// has negative (BH) perforations, circles cut off on two sides.
const STILL_MM: [f64; 2] = [2.8, 1.98];
const CORNER_MM: f64 = 0.5;
const CINE_MM: [f64; 2] = [2.794, 1.854];
/// Width of the border around a frame without perforations, mm.
const PLAIN_MM: f64 = 3.0;
/// Height of a letter on the edge, mm.
const LETTER_MM: f64 = 0.9;
/// Samples per pixel along each axis, for the coverage of pixels by perforations.
const LOOKS: usize = 4;

/// The border of one frame.
#[derive(Clone, Debug)]
pub(super) struct Border {
    kind: BorderKind,
    size_mm: [f64; 2],
    words: [String; 2],
}

/// Checks that a frame of the size `size_mm` fits between the perforations of the film. The error is a message and a hint.
pub(super) fn check(kind: BorderKind, size_mm: [f64; 2]) -> Result<(), [String; 2]> {
    let (across, word) = match kind {
        BorderKind::Plain => return Ok(()),
        BorderKind::Still => (size_mm[1], "high"),
        BorderKind::Cine => (size_mm[0], "wide"),
    };
    let room = FILM_MM - 2.0 * (EDGE_MM + STILL_MM[0]);
    if across <= room {
        return Ok(());
    }
    let text = format!(
        "a frame {across:.1} mm {word} does not fit between the perforations of 35 mm film, {room:.1} mm apart"
    );
    Err([text, "`border: plain`, or another format".to_owned()])
}

impl Border {
    pub(super) fn new(kind: BorderKind, size_mm: [f64; 2], name: &str, frame: u64) -> Self {
        let number = if kind == BorderKind::Still { format!("{frame}       {frame}A") } else { format!("{frame}") };
        Self { kind, size_mm, words: [name.to_owned(), number] }
    }

    /// Returns the width of the border on either side of the frame: across and down the picture, in mm.
    pub(super) fn margin_mm(&self) -> [f64; 2] {
        let [width, height] = self.size_mm;
        let whole = |side: f64| (side / PITCH_MM + 0.05).ceil() * PITCH_MM;
        match self.kind {
            BorderKind::Plain => [PLAIN_MM; 2],
            BorderKind::Still => [0.5 * (whole(width) - width), 0.5 * (FILM_MM - height)],
            BorderKind::Cine => [0.5 * (FILM_MM - width), 0.5 * (whole(height) - height)],
        }
    }

    /// Exposes the name of the film and the number of the frame on the edges.
    pub(super) fn print(&self, plane: &mut [f32], raster: &Raster, light: f32) {
        let [width, height] = self.size_mm;
        let margin = self.margin_mm();
        // Distance from the film's edge to the middle of the letters.
        let edge = match self.kind {
            BorderKind::Plain => 0.5 * PLAIN_MM,
            BorderKind::Still | BorderKind::Cine => 0.5 * EDGE_MM,
        };
        for (which, words) in self.words.iter().enumerate() {
            let letters = match self.kind {
                BorderKind::Cine => {
                    let x = if which == 0 { edge - margin[0] } else { width + margin[0] - edge };
                    written(words, [x, 0.5 * height], true)
                }
                BorderKind::Still | BorderKind::Plain => {
                    let y = if which == 0 { edge - margin[1] } else { height + margin[1] - edge };
                    written(words, [0.5 * width, y], false)
                }
            };
            for strokes in letters.iter().filter(|strokes| !strokes.is_empty()) {
                cover(strokes, raster, |pixel, share| plane[pixel] += light * share as f32);
            }
        }
    }

    /// Blends in the color `hole` where perforations leave no film.
    pub(super) fn punch(&self, rgb: &mut [[f32; 3]], raster: &Raster, hole: [f32; 3]) {
        let part = 1.0 / LOOKS as f64;
        for (i, pixel) in rgb.iter_mut().enumerate() {
            let px = [i % raster.width.max(1), i / raster.width.max(1)];
            let place = |axis: usize, k: usize| {
                (px[axis] as f64 + (k as f64 + 0.5) * part + raster.offset_px[axis] as f64) * raster.pitch_mm
            };
            let mut found = 0_usize;
            for k in 0..LOOKS * LOOKS {
                found += usize::from(self.is_hole([place(0, k % LOOKS), place(1, k / LOOKS)]));
            }
            if found > 0 {
                let share = found as f32 * (part * part) as f32;
                *pixel = [0, 1, 2].map(|c| pixel[c] + (hole[c] - pixel[c]) * share);
            }
        }
    }

    /// Returns whether a place, mm from the frame's upper left corner, lies in a perforation.
    fn is_hole(&self, place: [f64; 2]) -> bool {
        let middle = [0, 1].map(|axis| place[axis] - 0.5 * self.size_mm[axis]);
        let (along, across, [high, long]) = match self.kind {
            BorderKind::Plain => return false,
            BorderKind::Still => (middle[0], middle[1], STILL_MM),
            BorderKind::Cine => (middle[1], middle[0], CINE_MM),
        };
        // Perforations lie symmetrically about the middle of the frame.
        let turn = along / PITCH_MM;
        let u = ((turn - turn.floor()) - 0.5) * PITCH_MM;
        let v = across.abs() - (0.5 * FILM_MM - EDGE_MM - 0.5 * high);
        if u.abs() > 0.5 * long || v.abs() > 0.5 * high {
            return false;
        }
        if self.kind == BorderKind::Cine {
            return u * u + v * v <= 0.25 * high * high;
        }
        let (du, dv) = (u.abs() - (0.5 * long - CORNER_MM), v.abs() - (0.5 * high - CORNER_MM));
        du <= 0.0 || dv <= 0.0 || du * du + dv * dv <= CORNER_MM * CORNER_MM
    }
}

/// Returns the strokes of each letter of a text centered at a place, mm. `turned` rotates it by 90 degrees, to be read along a film that
/// runs down.
fn written(words: &str, [x, y]: [f64; 2], turned: bool) -> Vec<Vec<Capsule>> {
    let unit = LETTER_MM / CAP_HEIGHT;
    let length: f64 = words.chars().map(|letter| glyph(letter).advance).sum();
    let mut pen = -0.5 * length;
    words
        .chars()
        .map(|letter| {
            let glyph = glyph(letter);
            let place = |[a, b]: [f64; 2]| {
                let (along, up) = ((pen + a) * unit, (b - 0.5 * CAP_HEIGHT) * unit);
                if turned { [x + up, y + along] } else { [x + along, y - up] }
            };
            let lines = glyph.strokes.iter().flat_map(|way| way.windows(2));
            let strokes =
                lines.map(|w| Capsule { from: place(w[0]), to: place(w[1]), radius: 0.5 * PEN * unit }).collect();
            pen += glyph.advance;
            strokes
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holes_mm2(kind: BorderKind, size_mm: [f64; 2], pitch_mm: f64) -> (f64, [f64; 2]) {
        let border = Border::new(kind, size_mm, "film", 3);
        let margin = border.margin_mm();
        let count = [0, 1].map(|i| ((size_mm[i] + 2.0 * margin[i]) / pitch_mm).round() as usize);
        let offset = margin.map(|mm| -(mm / pitch_mm).round() as i64);
        let raster = Raster { offset_px: offset, ..Raster::new(count[0], count[1], pitch_mm) };
        let mut rgb = vec![[0.0_f32; 3]; raster.pixels()];
        border.punch(&mut rgb, &raster, [1.0; 3]);
        let area = rgb.iter().map(|p| f64::from(p[0])).sum::<f64>() * pitch_mm * pitch_mm;
        (area, count.map(|n| n as f64 * pitch_mm))
    }

    /// A still frame with a pitch of 38 mm has eight perforations on either side, a motion-picture frame with a pitch of 19 mm has four.
    /// Each kind has its own area, and the film is 35 mm wide.
    #[test]
    fn perforations_are_those_of_the_standards() {
        let still = 2.8 * 1.98 - (4.0 - std::f64::consts::PI) * 0.25;
        let (radius, half) = (1.397_f64, 0.927_f64);
        let cine = 2.0
            * (half * (radius * radius - half * half).sqrt()
                + radius * radius * spectra_core::math::asin(half / radius));
        for (kind, frame, wanted, whole) in [
            (BorderKind::Still, [36.0, 24.0], 16.0 * still, [38.0, 35.0]),
            (BorderKind::Cine, [24.0, 18.0], 8.0 * cine, [35.0, 19.0]),
            (BorderKind::Plain, [56.0, 56.0], 0.0, [62.0, 62.0]),
        ] {
            for pitch_mm in [0.02, 0.1] {
                let (area, size) = holes_mm2(kind, frame, pitch_mm);
                assert!((area - wanted).abs() <= 0.02 * wanted, "{kind:?}: {area} {wanted}");
                assert!((0..2).all(|i| (size[i] - whole[i]).abs() < 0.11), "{kind:?}: {size:?}");
            }
        }
        assert!(check(BorderKind::Still, [36.0, 24.0]).is_ok() && check(BorderKind::Cine, [36.0, 24.0]).is_err());
    }
}
