//! Line styles of the curves in one figure.

use spectra_plot::{Color, Stroke};

/// Returns the palette index of each curve. Three columns or channels for long, middle and short waves become reddish, green and blue.
/// `names` are like `cie-1931#x`, `exposure.X` or `X / lx s`.
pub(crate) fn order(names: &[String]) -> Vec<usize> {
    const THREES: [[&str; 3]; 4] = [["r", "g", "b"], ["red", "green", "blue"], ["x", "y", "z"], ["l", "m", "s"]];
    let last = |name: &String| {
        let name = name.split(" / ").next().unwrap_or(name);
        name.rsplit(['#', '.']).next().unwrap_or(name).to_lowercase()
    };
    let columns: Vec<String> = names.iter().map(last).collect();
    if THREES.iter().any(|three| columns == *three) { vec![1, 2, 0] } else { (0..names.len()).collect() }
}

/// Returns the color of curve `i`.
pub(crate) fn palette(i: usize) -> Color {
    Color::PALETTE[i % Color::PALETTE.len()]
}

/// Returns the line style of curve `i`: first solid lines in colors that people with any color vision tell apart, then the same colors with
/// three kinds of dashes. From the 29th curve on the styles repeat.
pub(crate) fn stroke(i: usize, width: f64) -> Stroke {
    const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[2.0, 2.6], &[9.0, 2.6, 2.0, 2.6]];
    let line = Stroke::new(palette(i), width);
    match DASHES[i / Color::PALETTE.len() % DASHES.len()] {
        [] => line,
        dashes => line.dashed(dashes),
    }
}
