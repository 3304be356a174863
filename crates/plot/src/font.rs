//! A stroke font: each letter is the path of a pen.
//!
//! The font was drawn for this program on a grid of 20 units per em: baseline at 0, lowercase letters 10 high, capitals and figures 14,
//! descenders to -4. Unlike on the canvas, y points upward, as is usual in type design.

use crate::geometry::Point;

/// Number of grid units per em.
pub const UNITS_PER_EM: f64 = 20.0;
/// Height of capitals and figures, grid units.
pub const CAP_HEIGHT: f64 = 14.0;
/// Width of the pen, grid units.
pub const PEN: f64 = 1.55;

/// Side bearing: distance from the path of the pen to the edge of the letter on either side, grid units.
const BEARING: f64 = 1.6;
/// Width of every figure, grid units: equal, so that figures line up in columns.
const FIGURE: f64 = 8.4;
const SPACE: f64 = 5.6;

/// The strokes and the advance width of a letter.
#[derive(Clone, Debug, PartialEq)]
pub struct Glyph {
    /// Distance from the start of this letter to the next, grid units.
    pub advance: f64,
    /// Paths of the pen, grid units; x is measured from the left edge of the letter.
    pub strokes: Vec<Vec<Point>>,
}

/// Returns the glyph of a character; a box if the font lacks it.
#[must_use]
pub fn glyph(letter: char) -> Glyph {
    if matches!(letter, ' ' | '\u{a0}') {
        return Glyph { advance: SPACE, strokes: Vec::new() };
    }
    if letter == '\u{2009}' {
        return Glyph { advance: 0.5 * SPACE, strokes: Vec::new() };
    }
    let (width, way) = way(letter).unwrap_or((8.0, "M0 0 L0 14 L8 14 L8 0 L0 0"));
    let mut strokes = follow(way);
    strokes.iter_mut().flatten().for_each(|p| p[0] += BEARING);
    Glyph { advance: width + 2.0 * BEARING, strokes }
}

/// Whether the font has its own glyph for a character.
#[must_use]
pub fn has(letter: char) -> bool {
    matches!(letter, ' ' | '\u{a0}' | '\u{2009}') || way(letter).is_some()
}

/// Converts a description of strokes to points. M x y starts a stroke and L x y draws a straight line. C x y x y x y draws a cubic Bezier
/// curve. A x y rx ry from to draws an arc of an ellipse around x y, counterclockwise between two angles in degrees.
fn follow(text: &str) -> Vec<Vec<Point>> {
    let mut strokes: Vec<Vec<Point>> = Vec::new();
    for (numbers, command) in text.split(['M', 'L', 'C', 'A']).zip(commands(text)) {
        let n: Vec<f64> = numbers.split_whitespace().map(|n| n.parse().expect("the font is numbers")).collect();
        match (command, n.as_slice()) {
            ('M', [x, y]) => strokes.push(vec![[*x, *y]]),
            ('L', [x, y]) => strokes.last_mut().expect("M comes first").push([*x, *y]),
            ('C', [ax, ay, bx, by, x, y]) => {
                let stroke = strokes.last_mut().expect("M comes first");
                let start = *stroke.last().expect("M sets a point");
                stroke.extend(bezier(start, [*ax, *ay], [*bx, *by], [*x, *y]));
            }
            ('A', [x, y, rx, ry, from, to]) => {
                let arc = arc([*x, *y], [*rx, *ry], *from, *to);
                match strokes.last_mut() {
                    Some(stroke) if stroke.last().is_some_and(|p| near(*p, arc[0])) => stroke.extend(&arc[1..]),
                    _ => strokes.push(arc),
                }
            }
            _ => {}
        }
    }
    strokes
}

/// Iterates over the commands before each list of numbers; the first list, before any command, is empty.
fn commands(text: &str) -> impl Iterator<Item = char> {
    std::iter::once(' ').chain(text.chars().filter(|c| matches!(c, 'M' | 'L' | 'C' | 'A')))
}

fn near(a: Point, b: Point) -> bool {
    (a[0] - b[0]).abs() < 0.3 && (a[1] - b[1]).abs() < 0.3
}

fn bezier(start: Point, a: Point, b: Point, end: Point) -> impl Iterator<Item = Point> {
    const STEPS: u32 = 10;
    (1..=STEPS).map(move |i| {
        let t = f64::from(i) / f64::from(STEPS);
        let s = 1.0 - t;
        [0, 1].map(|k| s * s * s * start[k] + 3.0 * s * s * t * a[k] + 3.0 * s * t * t * b[k] + t * t * t * end[k])
    })
}

fn arc(center: Point, radii: [f64; 2], from: f64, to: f64) -> Vec<Point> {
    let steps = ((to - from).abs() / 12.0).ceil().max(2.0) as u32;
    (0..=steps)
        .map(|i| {
            let angle = (from + (to - from) * f64::from(i) / f64::from(steps)).to_radians();
            [center[0] + radii[0] * libm::cos(angle), center[1] + radii[1] * libm::sin(angle)]
        })
        .collect()
}

/// Returns the width of a character, grid units, and the description of its strokes.
fn way(letter: char) -> Option<(f64, &'static str)> {
    letters(letter).or_else(|| marks(letter))
}

fn letters(letter: char) -> Option<(f64, &'static str)> {
    Some(match letter {
        '0' => (FIGURE, "A4.2 7 4.1 7 90 450"),
        '1' => (FIGURE, "M1.3 11.3 L5 14 L5 0"),
        '2' => (FIGURE, "A4.1 10.1 3.7 3.9 165 -36 L0.4 0 L8.2 0"),
        '3' => (FIGURE, "A4 10.55 3.5 3.45 155 -90 M2.6 7.1 L4 7.1 A4 3.55 4 3.55 90 -155"),
        '4' => (FIGURE, "M6.3 0 L6.3 14 L0 4.1 L8.6 4.1"),
        '5' => (FIGURE, "M7.5 14 L1.5 14 L0.8 7.5 A3.9 4.5 4.2 4.5 138 -150"),
        '6' => (FIGURE, "M7.8 11.9 C7.3 13.3 6.3 14 4.9 14 C2 14 0.2 11 0.2 5.6 L0.2 4.4 A4.2 4.4 4 4.4 180 540"),
        '7' => (FIGURE, "M0.3 14 L8.2 14 L3 0"),
        '8' => (FIGURE, "A4.2 10.6 3.4 3.4 -90 270 M4.2 7.2 A4.2 3.6 4 3.6 90 450"),
        '9' => (FIGURE, "M0.6 2.1 C1.1 0.7 2.1 0 3.5 0 C6.4 0 8.2 3 8.2 8.4 L8.2 9.6 A4.2 9.6 4 4.4 0 360"),
        'A' => (9.8, "M0 0 L4.9 14 L9.8 0 M1.7 4.9 L8.1 4.9"),
        'B' => {
            (8.7, "M0 0 L0 14 L4.5 14 A4.5 10.65 3.4 3.35 90 -90 L0 7.3 M4.5 7.3 L5 7.3 A5 3.65 3.7 3.65 90 -90 L0 0")
        }
        'C' => (10.2, "A6 7 6 7 48 312"),
        'D' => (9.8, "M0 0 L0 14 L3.4 14 A3.4 7 6.4 7 90 -90 L0 0"),
        'E' => (7.6, "M7.4 14 L0 14 L0 0 L7.6 0 M0 7.3 L6.6 7.3"),
        'F' => (7.2, "M7.2 14 L0 14 L0 0 M0 7 L6.2 7"),
        'G' => (11.2, "A6 7 6 7 48 330 L11.2 6.8 L6.9 6.8"),
        'H' => (9.2, "M0 0 L0 14 M9.2 0 L9.2 14 M0 7.3 L9.2 7.3"),
        'I' => (0.0, "M0 0 L0 14"),
        'J' => (6.0, "M6 14 L6 4 A3 4 3 4 0 -170"),
        'K' => (8.8, "M0 0 L0 14 M8.6 14 L0 4.9 M3.1 8.2 L8.8 0"),
        'L' => (7.0, "M0 14 L0 0 L7 0"),
        'M' => (11.4, "M0 0 L0 14 L5.7 3 L11.4 14 L11.4 0"),
        'N' => (9.2, "M0 0 L0 14 L9.2 0 L9.2 14"),
        'O' => (12.0, "A6 7 6 7 90 450"),
        'P' => (8.4, "M0 0 L0 14 L4.6 14 A4.6 10.2 3.8 3.8 90 -90 L0 6.4"),
        'Q' => (12.0, "A6 7 6 7 90 450 M7.4 3.6 L11.4 -0.8"),
        'R' => (8.8, "M0 0 L0 14 L4.6 14 A4.6 10.2 3.8 3.8 90 -90 L0 6.4 M4.6 6.4 L8.8 0"),
        'S' => (
            8.6,
            "M8.1 11.5 C7.5 13.2 6.2 14 4.4 14 C2.1 14 0.5 12.6 0.5 10.6 C0.5 8.4 2.4 7.8 4.4 7.3 \
             C6.7 6.7 8.6 6 8.6 3.6 C8.6 1.4 6.8 0 4.4 0 C2.2 0 0.6 1 0 2.8",
        ),
        'T' => (9.4, "M0 14 L9.4 14 M4.7 14 L4.7 0"),
        'U' => (9.2, "M0 14 L0 4.6 A4.6 4.6 4.6 4.6 180 360 L9.2 14"),
        'V' => (9.4, "M0 14 L4.7 0 L9.4 14"),
        'W' => (14.2, "M0 14 L3.6 0 L7.1 12.6 L10.6 0 L14.2 14"),
        'X' => (8.8, "M0 0 L8.8 14 M0 14 L8.8 0"),
        'Y' => (9.2, "M0 14 L4.6 6.6 L9.2 14 M4.6 6.6 L4.6 0"),
        'Z' => (8.8, "M0.3 14 L8.5 14 L0 0 L8.8 0"),
        'a' => (
            7.1,
            "M0.6 8 C1.1 9.3 2.2 10 3.7 10 C6 10 7.1 8.9 7.1 6.9 L7.1 0 \
             M7.1 5.8 C5 5.7 0 5.8 0 2.7 C0 1 1.3 0 3.1 0 C5.3 0 7.1 1.5 7.1 3.8",
        ),
        'b' => (8.0, "M0 14 L0 0 M0 5 A4 5 4 5 180 540"),
        'c' => (7.2, "A4.2 5 4.2 5 46 314"),
        'd' => (8.0, "A4 5 4 5 0 360 M8 14 L8 0"),
        'e' => (8.2, "M0.1 5.3 L8.2 5.3 A4.1 5 4.1 5 3 316"),
        'f' => (5.0, "M1.7 0 L1.7 11 C1.7 13 2.6 14 4.2 14 L5 14 M0 10 L4.7 10"),
        'g' => (8.0, "A4 5 4 5 0 360 M8 10 L8 -0.4 A4.1 -0.4 3.9 3.8 0 -150"),
        'h' => (7.2, "M0 14 L0 0 M0 6 A3.6 6 3.6 4 180 0 L7.2 0"),
        'i' => (0.0, "M0 0 L0 10 M0 13.4 L0 13.5"),
        'j' => (2.2, "M2.2 10 L2.2 -2 C2.2 -3.5 1.5 -4.2 0 -4.2 M2.2 13.4 L2.2 13.5"),
        'k' => (7.0, "M0 0 L0 14 M6.6 10 L0 3.6 M2.6 6.1 L7 0"),
        'l' => (0.0, "M0 14 L0 0"),
        'm' => (11.6, "M0 10 L0 0 M0 6.6 A2.9 6.6 2.9 3.4 180 0 L5.8 0 M5.8 6.6 A8.7 6.6 2.9 3.4 180 0 L11.6 0"),
        'n' => (7.2, "M0 10 L0 0 M0 6 A3.6 6 3.6 4 180 0 L7.2 0"),
        'o' => (8.4, "A4.2 5 4.2 5 90 450"),
        'p' => (8.0, "M0 10 L0 -4.2 M0 5 A4 5 4 5 180 540"),
        'q' => (8.0, "A4 5 4 5 0 360 M8 10 L8 -4.2"),
        'r' => (4.4, "M0 10 L0 0 M0 5.6 C0.2 8.6 1.7 10 4.4 9.8"),
        's' => (
            6.9,
            "M6.5 7.9 C6 9.3 5 10 3.5 10 C1.7 10 0.4 9 0.4 7.5 C0.4 5.9 1.9 5.5 3.5 5.2 \
             C5.3 4.8 6.9 4.3 6.9 2.6 C6.9 1 5.4 0 3.5 0 C1.8 0 0.5 0.7 0 2.1",
        ),
        't' => (4.8, "M1.7 13 L1.7 2.6 C1.7 0.8 2.5 0 4 0 L4.8 0 M0 10 L4.6 10"),
        'u' => (7.2, "M0 10 L0 4 A3.6 4 3.6 4 180 360 M7.2 10 L7.2 0"),
        'v' => (7.4, "M0 10 L3.7 0 L7.4 10"),
        'w' => (11.6, "M0 10 L2.9 0 L5.8 9.2 L8.7 0 L11.6 10"),
        'x' => (7.2, "M0 0 L7.2 10 M0 10 L7.2 0"),
        'y' => (7.6, "M0 10 L3.8 0 M7.6 10 L3.3 -1.6 C2.6 -3.4 1.9 -4.2 0.4 -4.2"),
        'z' => (7.0, "M0.2 10 L6.8 10 L0 0 L7 0"),
        _ => return None,
    })
}

fn marks(letter: char) -> Option<(f64, &'static str)> {
    Some(match letter {
        '.' => (0.0, "M0 0 L0 0.2"),
        ',' => (1.0, "M1 0.3 L0 -2.6"),
        ':' => (0.0, "M0 0 L0 0.2 M0 8.4 L0 8.6"),
        ';' => (1.0, "M1 0.3 L0 -2.6 M1 8.4 L1 8.6"),
        '!' => (0.0, "M0 14 L0 4 M0 0 L0 0.2"),
        '?' => (7.0, "A3.5 10.6 3.5 3.4 165 -40 C4.6 7.2 3.4 6.4 3.4 4.2 M3.4 0 L3.4 0.2"),
        '\'' | '\u{2019}' | '\u{2032}' => (0.6, "M0.5 14 L0.1 10.4"),
        '"' => (3.0, "M0 14 L0 10.4 M3 14 L3 10.4"),
        '(' => (3.2, "M3.2 15 C-1 10.5 -1 1 3.2 -3.4"),
        ')' => (3.2, "M0 15 C4.2 10.5 4.2 1 0 -3.4"),
        '[' => (3.0, "M3 15 L0 15 L0 -3 L3 -3"),
        ']' => (3.0, "M0 15 L3 15 L3 -3 L0 -3"),
        '{' => (3.6, "M3.6 15 C0.8 15 2.6 6 0 6 C2.6 6 0.8 -3 3.6 -3"),
        '}' => (3.6, "M0 15 C2.8 15 1 6 3.6 6 C1 6 2.8 -3 0 -3"),
        '/' => (5.4, "M0 -2 L5.4 15"),
        '\\' => (5.4, "M0 15 L5.4 -2"),
        '|' => (0.0, "M0 15 L0 -4"),
        '-' | '\u{2010}' => (4.2, "M0 5.2 L4.2 5.2"),
        '\u{2013}' => (8.4, "M0 5.2 L8.4 5.2"),
        '\u{2212}' => (8.4, "M0 6.2 L8.4 6.2"),
        '+' => (8.4, "M0 6.2 L8.4 6.2 M4.2 10.4 L4.2 2"),
        '\u{b1}' => (8.4, "M0 7.6 L8.4 7.6 M4.2 11.8 L4.2 3.4 M0 0.6 L8.4 0.6"),
        '=' => (8.4, "M0 8.4 L8.4 8.4 M0 4 L8.4 4"),
        '<' => (7.6, "M7.6 10.6 L0 6.2 L7.6 1.8"),
        '>' => (7.6, "M0 10.6 L7.6 6.2 L0 1.8"),
        '\u{d7}' => (6.4, "M0 3 L6.4 9.4 M0 9.4 L6.4 3"),
        '\u{b7}' => (0.0, "M0 6.1 L0 6.3"),
        '*' => (6.0, "M3 14 L3 8 M0.4 12.5 L5.6 9.5 M0.4 9.5 L5.6 12.5"),
        '_' => (8.4, "M0 -2.6 L8.4 -2.6"),
        '~' => (8.4, "M0 5.2 C1.6 9 4.4 7.4 4.8 6.2 C5.6 4.6 7.4 4.2 8.4 7.2"),
        '^' => (6.4, "M0 9.4 L3.2 14 L6.4 9.4"),
        '`' => (2.0, "M0 14 L2 11.4"),
        '#' => (8.4, "M1.6 0 L3.4 14 M5.4 0 L7.2 14 M0.2 9.6 L8.4 9.6 M0 4.4 L8.2 4.4"),
        '%' => (12.6, "A2.7 10.9 2.7 3.1 90 450 M10.6 14 L2 0 M9.9 6.2 A9.9 3.1 2.7 3.1 90 450"),
        '&' => (
            9.6,
            "M9.6 0 L2 10 C0.8 11.8 1.8 14 4 14 C6.2 14 7 12 5.8 10.4 C4.6 8.8 0 7.6 0 3.8 \
             C0 1.4 1.8 0 4 0 C6.8 0 8.6 2.6 9 5.8",
        ),
        '@' => (12.6, "A6.3 5.4 2.8 3.2 90 450 M9.1 8.6 L9.1 4.4 C9.1 1.4 12.6 2.4 12.6 6.2 A6.3 6.2 6.3 6.8 0 310"),
        '$' => (
            8.6,
            "M8.1 11.5 C7.5 13 6.2 13.6 4.4 13.6 C2.1 13.6 0.5 12.4 0.5 10.6 C0.5 8.4 2.4 7.8 4.4 7.3 \
             C6.7 6.7 8.6 6 8.6 3.6 C8.6 1.6 6.8 0.4 4.4 0.4 C2.2 0.4 0.6 1.2 0 2.8 M4.3 15.6 L4.3 -1.6",
        ),
        '\u{b0}' => (4.6, "A2.3 11.7 2.3 2.3 90 450"),
        '\u{3b1}' => (8.6, "M8.6 10 C7.4 6 5.6 0 3.6 0 C1.2 0 0 2.2 0 5 C0 7.8 1.2 10 3.6 10 C6 10 6.4 0 8.6 0"),
        '\u{3b2}' => (
            7.8,
            "M0 -4.2 L0 10.4 C0 12.8 1.4 14 3.4 14 C5.4 14 6.8 12.8 6.8 10.9 C6.8 9 5.4 7.6 3 7.6 M3 7.6 C6 7.6 7.8 6 7.8 3.9 C7.8 1.5 6.2 0 3.8 0 C2.2 0 0.8 0.6 0 1.8",
        ),
        '\u{394}' => (10.4, "M0 0 L5.2 14 L10.4 0 L0 0"),
        '\u{3b8}' => (7.8, "A3.9 7 3.9 7 90 450 M0 7.1 L7.8 7.1"),
        '\u{3bb}' => (8.0, "M0.2 14 C2.2 14.2 2.6 12.6 3.4 10.2 L6.6 1.4 C7 0.4 7.4 0 8 0 M4.1 8.1 L0.2 0"),
        '\u{3bc}' | '\u{b5}' => {
            (7.6, "M0 10 L0 -4.2 M0 3.6 C0 1.2 1.4 0 3.4 0 C5.6 0 7 1.6 7 4 M7 10 L7 1.2 C7 0.4 7.2 0 7.6 0")
        }
        '\u{3bd}' => (7.4, "M0 10 L3.4 0 C5.8 2.8 7.4 6 7.2 10"),
        '\u{3c6}' => (9.4, "M2.8 9.6 C-1 7.6 -1.4 0 4.6 0 C10.6 0 10.6 10 6.8 10 C4.4 10 4.6 6 4.6 -4.2"),
        '\u{3c9}' => {
            (11.0, "M2 10 C-0.8 6.6 -0.6 0 2.8 0 C4.8 0 5.5 1.8 5.5 6 C5.5 1.8 6.2 0 8.2 0 C11.6 0 11.8 6.6 9 10")
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_of_ascii_and_the_letters_of_optics_are_there() {
        let more = "\u{b0}\u{b1}\u{b5}\u{b7}\u{d7}\u{2013}\u{2019}\u{2032}\u{2212}\u{3b1}\u{3b2}\u{394}\u{3b8}\u{3bb}\u{3bc}\u{3bd}\u{3c6}\u{3c9}";
        for letter in (' '..='~').chain(more.chars()) {
            assert!(has(letter), "{letter}");
            let glyph = glyph(letter);
            assert!(letter == ' ' || !glyph.strokes.is_empty(), "{letter}");
            for [x, y] in glyph.strokes.into_iter().flatten() {
                // The pen stays within the letter except for overhangs of half its width.
                assert!((-0.2..=glyph.advance + 0.2).contains(&x) && (-5.0..=16.0).contains(&y), "{letter}: {x} {y}");
            }
        }
        assert!(!has('\u{4e2d}') && !glyph('\u{4e2d}').strokes.is_empty());
    }

    #[test]
    fn figures_are_of_one_width() {
        assert!(('0'..='9').all(|d| glyph(d).advance == glyph('0').advance));
    }

    #[test]
    fn a_way_is_followed() {
        let strokes = follow("M0 5 A4 5 4 5 180 540 M1 1 L2 2 C2 3 3 3 3 2");
        assert_eq!([strokes.len(), strokes[1].len()], [2, 12]);
        assert!(near(strokes[0][0], [0.0, 5.0]) && near(*strokes[0].last().expect("points"), [0.0, 5.0]));
        assert_eq!(strokes[1].last(), Some(&[3.0, 2.0]));
    }
}
