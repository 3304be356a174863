//! Legends of figures: names beside pieces of their lines, and the line styles of several curves.

use crate::canvas::Canvas;
use crate::color::Color;
use crate::geometry::Point;
use crate::stroke::Stroke;
use crate::text::{TextStyle, text_width};

/// Longest name in a legend, in characters; a longer one would push the others off the sheet.
pub const LONGEST_NAME: usize = 48;

/// Shortens a name to [`LONGEST_NAME`] characters, with `...` at its end if it is cut.
#[must_use]
pub fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST_NAME {
        return name.to_owned();
    }
    let start: String = name.chars().take(LONGEST_NAME - 3).collect();
    format!("{start}...")
}

/// Lays out the entries of a legend in rows between `start`, the first baseline start, and the right edge `right`. Each entry has
/// a piece of its line before its name. Returns the baseline start of each entry and the number of rows.
#[must_use]
pub fn rows(names: &[String], start: Point, right: f64, style: &TextStyle) -> (Vec<Point>, usize) {
    const GAP: f64 = 24.0;
    let mut at = start;
    let mut rows = 1;
    let places = names.iter().map(|name| {
        let width = SAMPLE + text_width(name, style.size) + GAP;
        if at[0] > start[0] && at[0] + width - GAP > right {
            at = [start[0], at[1] + 1.6 * style.size];
            rows += 1;
        }
        let place = at;
        at[0] += width;
        place
    });
    let places = places.collect();
    (places, rows)
}

/// Distance from the start of a legend entry to its name: the piece of line and the gap after it, canvas units.
pub const SAMPLE: f64 = 30.0;

/// Draws an entry of a legend: a piece of the curve's line, then its name. `at` is the start of the baseline.
pub fn entry(canvas: &mut Canvas, at: Point, name: &str, stroke: &Stroke, style: &TextStyle) {
    let y = at[1] - style.half_cap();
    canvas.line([at[0], y], [at[0] + SAMPLE - 7.0, y], stroke);
    canvas.text([at[0] + SAMPLE, at[1]], name, style);
}

/// Draws an entry like [`entry`], with a disc instead of a line.
pub fn entry_disc(canvas: &mut Canvas, at: Point, name: &str, color: Color, style: &TextStyle) {
    canvas.disc([at[0] + 0.5 * (SAMPLE - 7.0), at[1] - style.half_cap()], 4.0, color);
    canvas.text([at[0] + SAMPLE, at[1]], name, style);
}

/// Returns the palette index of each curve. If the curves are three columns or channels for long, middle and short waves, their
/// colors are reddish, green and blue. `names` are like `cie-1931#x`, `exposure.X` or `X / lx s`.
#[must_use]
pub fn order(names: &[String]) -> Vec<usize> {
    const THREES: [[&str; 3]; 4] = [["r", "g", "b"], ["red", "green", "blue"], ["x", "y", "z"], ["l", "m", "s"]];
    let last = |name: &String| {
        let name = name.split(" / ").next().unwrap_or(name);
        name.rsplit(['#', '.']).next().unwrap_or(name).to_lowercase()
    };
    let columns: Vec<String> = names.iter().map(last).collect();
    if THREES.iter().any(|three| columns == *three) { vec![1, 2, 0] } else { (0..names.len()).collect() }
}

/// Returns the color of curve `i`.
#[must_use]
pub fn palette(i: usize) -> Color {
    Color::PALETTE[i % Color::PALETTE.len()]
}

/// Returns the line style of curve `i`: first solid lines in colors that people with any color vision tell apart, then the same colors with
/// three kinds of dashes. From the 29th curve on the styles repeat.
#[must_use]
pub fn stroke(i: usize, width: f64) -> Stroke {
    const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[2.0, 2.6], &[9.0, 2.6, 2.0, 2.6]];
    let line = Stroke::new(palette(i), width);
    match DASHES[i / Color::PALETTE.len() % DASHES.len()] {
        [] => line,
        dashes => line.dashed(dashes),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_legends_take_rows_and_long_names_are_cut() {
        let names: Vec<String> = (0..9).map(|i| format!("a rather long name of a light, {i}")).collect();
        let (places, rows) = rows(&names, [90.0, 26.0], 876.0, &TextStyle::new(14.0));
        assert!(rows > 2 && places.iter().all(|p| p[0] + SAMPLE + text_width(&names[0], 14.0) <= 876.0));
        assert_eq!(shortened(&"x".repeat(500)).len(), LONGEST_NAME);
    }
}
