//! The lines of curves that stand beside each other in a figure.

use spectra_plot::{Color, Stroke};

/// Which line each curve has, by its place in the palette. Three columns or channels that stand for long, middle and short waves are
/// reddish, green and blue. `names` are as in `cie-1931#x`, `exposure.X` or `X / lx s`.
pub(crate) fn order(names: &[String]) -> Vec<usize> {
    const THREES: [[&str; 3]; 4] = [["r", "g", "b"], ["red", "green", "blue"], ["x", "y", "z"], ["l", "m", "s"]];
    let last = |name: &String| {
        let name = name.split(" / ").next().unwrap_or(name);
        name.rsplit(['#', '.']).next().unwrap_or(name).to_lowercase()
    };
    let columns: Vec<String> = names.iter().map(last).collect();
    if THREES.iter().any(|three| columns == *three) { vec![1, 2, 0] } else { (0..names.len()).collect() }
}

/// The color of the curve `i`.
pub(crate) fn palette(i: usize) -> Color {
    Color::PALETTE[i % Color::PALETTE.len()]
}

/// The line of the curve `i`: as many colors as people of any color vision tell apart, then the same dashed in three ways. From the
/// 29th on they repeat.
pub(crate) fn stroke(i: usize, width: f64) -> Stroke {
    const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.0], &[2.0, 2.6], &[9.0, 2.6, 2.0, 2.6]];
    let line = Stroke::new(palette(i), width);
    match DASHES[i / Color::PALETTE.len() % DASHES.len()] {
        [] => line,
        dashes => line.dashed(dashes),
    }
}
