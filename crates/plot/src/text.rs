//! Text drawn as strokes.

use crate::color::Color;
use crate::font::{self, UNITS_PER_EM};
use crate::geometry::{Point, Rect};

/// The part of a line of text that is placed at the given point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The start of the text.
    Start,
    /// The middle of the text.
    Middle,
    /// The end of the text.
    End,
}

/// Style of a line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct TextStyle {
    /// Size of the em, canvas units.
    pub size: f64,
    /// Color of the strokes.
    pub color: Color,
    /// Part of the text that is placed at the given point, along the line. Across the line, the baseline goes through the point.
    pub anchor: Anchor,
    /// Rotation counterclockwise, degrees: 90 reads upward.
    pub turn_deg: f64,
    /// Width of the strokes relative to the regular one: 1.4 is bold.
    pub weight: f64,
    /// Color of a halo around the strokes that sets them off from what lies below; `None` for no halo.
    pub halo: Option<Color>,
}

impl TextStyle {
    /// Creates a regular style in ink, with the text starting at its point. `size` is the em in canvas units.
    #[must_use]
    pub fn new(size: f64) -> Self {
        Self { size, color: Color::INK, anchor: Anchor::Start, turn_deg: 0.0, weight: 1.0, halo: None }
    }

    /// Returns this style with another color.
    #[must_use]
    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    /// Returns this style with the text centered at its point.
    #[must_use]
    pub fn middle(self) -> Self {
        Self { anchor: Anchor::Middle, ..self }
    }

    /// Returns this style with the text ending at its point.
    #[must_use]
    pub fn end(self) -> Self {
        Self { anchor: Anchor::End, ..self }
    }

    /// Returns this style rotated counterclockwise, degrees.
    #[must_use]
    pub fn turned_deg(self, turn_deg: f64) -> Self {
        Self { turn_deg, ..self }
    }

    /// Returns this style with another relative width of the strokes.
    #[must_use]
    pub fn weight(self, weight: f64) -> Self {
        Self { weight, ..self }
    }

    /// Returns this style with a halo of this color.
    #[must_use]
    pub fn halo(self, halo: Color) -> Self {
        Self { halo: Some(halo), ..self }
    }

    /// Width of the pen, canvas units.
    pub(crate) fn pen(&self) -> f64 {
        self.size / UNITS_PER_EM * font::PEN * self.weight
    }

    /// Half the height of capitals: how far the middle of a line of text lies above its baseline, canvas units.
    #[must_use]
    pub fn half_cap(&self) -> f64 {
        0.5 * font::CAP_HEIGHT / UNITS_PER_EM * self.size
    }

    /// Returns the approximate bounds of a line of text that is not rotated: from the baseline to the top of capitals.
    #[must_use]
    pub fn bounds(&self, at: Point, text: &str) -> Rect {
        let width = text_width(text, self.size);
        let left = at[0] - width * self.share();
        Rect::new(left, at[1] - 2.0 * self.half_cap(), left + width, at[1])
    }

    fn share(&self) -> f64 {
        match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        }
    }

    /// Returns the strokes of the pen for a line of text.
    pub(crate) fn strokes(&self, at: Point, text: &str) -> Vec<Vec<Point>> {
        let start = -text_width(text, self.size) * self.share();
        let turn = self.turn_deg.to_radians();
        let (sin, cos) = (libm::sin(turn), libm::cos(turn));
        let mut out = Vec::new();
        let mut pen = start;
        for (letter, level) in levels(text) {
            let unit = self.size * level.size / UNITS_PER_EM;
            let glyph = font::glyph(letter);
            out.extend(glyph.strokes.iter().map(|stroke| {
                let place = stroke.iter().map(|p| [pen + unit * p[0], unit * p[1] + level.rise * self.size]);
                place.map(|[x, y]| [at[0] + cos * x - sin * y, at[1] - sin * x - cos * y]).collect()
            }));
            pen += unit * glyph.advance;
        }
        out
    }
}

/// Size and height of a letter relative to the line.
#[derive(Clone, Copy)]
struct Level {
    size: f64,
    rise: f64,
}

const LINE: Level = Level { size: 1.0, rise: 0.0 };
const RAISED: Level = Level { size: 0.68, rise: 0.34 };
const LOWERED: Level = Level { size: 0.68, rise: -0.16 };

/// Splits a text into letters. `_{...}` is a subscript and `^{...}` a superscript, as in `n_{d}` and `10^{-3}`.
fn levels(text: &str) -> Vec<(char, Level)> {
    let mut out = Vec::new();
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        let marked = [("_{", LOWERED), ("^{", RAISED)].into_iter().find_map(|(mark, level)| {
            let (within, after) = rest.strip_prefix(mark)?.split_once('}')?;
            Some((within, after, level))
        });
        match marked {
            Some((within, after, level)) => {
                out.extend(within.chars().map(|c| (c, level)));
                rest = after;
            }
            None => {
                let raised = match letter {
                    '\u{b9}' => Some('1'),
                    '\u{b2}' => Some('2'),
                    '\u{b3}' => Some('3'),
                    '\u{207b}' => Some('\u{2212}'),
                    _ => None,
                };
                out.push(raised.map_or((letter, LINE), |r| (r, RAISED)));
                rest = &rest[letter.len_utf8()..];
            }
        }
    }
    out
}

/// Returns the width of a line of text whose em is `size`, in the same unit.
#[must_use]
pub fn text_width(text: &str, size: f64) -> f64 {
    levels(text).iter().map(|(letter, level)| font::glyph(*letter).advance * level.size * size / UNITS_PER_EM).sum()
}

/// Returns the text without its markup, for screen readers.
pub(crate) fn plain(text: &str) -> String {
    levels(text).iter().map(|(letter, _)| letter).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_raise_and_lower() {
        assert_eq!(plain("n_{d} = 10^{-3} a_b ^{"), "nd = 10-3 a_b ^{");
        assert!(text_width("n_{d}", 10.0) < text_width("nd", 10.0));
    }

    #[test]
    fn the_anchor_is_where_it_says() {
        let reach = |style: &TextStyle| {
            let xs: Vec<f64> = style.strokes([100.0, 50.0], "HH").into_iter().flatten().map(|p| p[0]).collect();
            (xs.iter().copied().fold(f64::MAX, f64::min), xs.iter().copied().fold(f64::MIN, f64::max))
        };
        let (left, right) = reach(&TextStyle::new(20.0).middle());
        assert!((left + right - 200.0).abs() < 1e-9);
        assert!(reach(&TextStyle::new(20.0)).0 > 100.0 && reach(&TextStyle::new(20.0).end()).1 < 100.0);
        let upward = TextStyle::new(20.0).turned_deg(90.0).strokes([0.0, 0.0], "HH");
        assert!(upward.into_iter().flatten().all(|p| p[0] <= 1e-9 && p[1] < 0.0));
    }
}
