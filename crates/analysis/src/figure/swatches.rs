//! Rows of patches, to compare colors by eye.

use spectra_plot::{Canvas, Color, Rect, Stroke, TextStyle};

const WIDTH: f64 = 900.0;
const LEFT: f64 = 24.0;
/// Height of a row of patches, and of the line of text above it.
const ROW: f64 = 34.0;
const TEXT: f64 = 24.0;
/// Number of characters of a name that fit above a row.
const LONGEST: usize = 110;

/// Draws rows of colors (sRGB, 8 bit) under their names. Each row has the full width, so that patches of the same index in rows of equal
/// length are one below the other.
#[must_use]
pub fn swatches(title: &str, rows: &[(String, Vec<[u8; 3]>)]) -> Canvas {
    let height = 46.0 + rows.len() as f64 * (ROW + TEXT + 6.0) + 8.0;
    let mut canvas = Canvas::new(WIDTH, height, title);
    canvas.text([LEFT, 28.0], title, &TextStyle::new(15.0).weight(1.35));
    let mut top = 46.0;
    for (name, colors) in rows {
        canvas.text(
            [LEFT, top + 15.0],
            &name.chars().take(LONGEST).collect::<String>(),
            &TextStyle::new(12.5).color(Color::GREY),
        );
        let place = Rect::new(LEFT, top + TEXT, WIDTH - LEFT, top + TEXT + ROW);
        let width = place.width() / colors.len().max(1) as f64;
        for (i, color) in colors.iter().enumerate() {
            let left = place.left + width * i as f64;
            // Make the patch half a unit wider, so that no paper shows between two patches. The last one ends with the row.
            let right = (left + width + 0.5).min(place.right);
            canvas.rectangle(Rect::new(left, place.top, right, place.bottom), Color::from(*color));
        }
        canvas.outline(&place.corners(), &Stroke::new(Color::PALE, 0.8));
        top += ROW + TEXT + 6.0;
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_keep_their_colors_and_order() {
        let rows = [("a".to_owned(), vec![[250, 10, 20], [0, 200, 0]]), ("b".to_owned(), vec![[1, 2, 240]])];
        let pixels = swatches("two rows", &rows).to_pixels(1.0);
        let at = |x: usize, y: usize| pixels.rgb[y * pixels.width_px as usize + x];
        assert_eq!([at(100, 80), at(800, 80), at(450, 150)], [[250, 10, 20], [0, 200, 0], [1, 2, 240]]);
        assert!(pixels.height_px > 150 && at(5, 80) == [255; 3]);
    }
}
