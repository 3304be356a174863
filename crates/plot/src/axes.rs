//! A frame with two axes.

use crate::canvas::Canvas;
use crate::color::Color;
use crate::geometry::{Point, Rect};
use crate::stroke::Stroke;
use crate::text::{TextStyle, text_width};
use crate::ticks::nice_ticks;

/// One axis of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit, such as `wavelength / nm`.
    pub label: String,
    /// Value at the start of the axis: left or bottom.
    pub from: f64,
    /// Value at the end of the axis; may be less than `from`.
    pub to: f64,
    /// Approximate number of ticks.
    pub ticks: usize,
    /// Number of parts into which minor ticks divide the interval between neighboring ticks.
    pub parts: usize,
}

impl Axis {
    /// Creates an axis with about eight ticks.
    #[must_use]
    pub fn new(label: &str, from: f64, to: f64) -> Self {
        Self { label: label.to_owned(), from, to, ticks: 8, parts: 5 }
    }

    /// Returns this axis with about `count` ticks, each interval divided into `parts` by minor ticks.
    #[must_use]
    pub fn ticks(self, count: usize, parts: usize) -> Self {
        Self { ticks: count, parts, ..self }
    }

    /// Position of a value along the axis: 0 at its start, 1 at its end.
    fn share(&self, value: f64) -> f64 {
        (value - self.from) / (self.to - self.from)
    }

    /// Returns the ticks with their labels, and the minor ticks.
    fn marks(&self) -> (Vec<(f64, String)>, Vec<f64>) {
        let (low, high) = (self.from.min(self.to), self.from.max(self.to));
        let ticks = nice_ticks(low, high, self.ticks);
        let small = ticks.step / self.parts.max(1) as f64;
        let mut between = Vec::new();
        if let Some(first) = ticks.values.first().filter(|_| small > 0.0) {
            let steps = ((high - low) / small).ceil().min(10_000.0) as i64 + self.parts as i64;
            let tolerance = 1e-9 * (high - low);
            between.extend(
                (-steps..=steps)
                    .filter(|i| i % self.parts.max(1) as i64 != 0)
                    .map(|i| first + i as f64 * small)
                    .filter(|v| (low - tolerance..=high + tolerance).contains(v)),
            );
        }
        (ticks.values.iter().map(|v| (*v, ticks.label(*v))).collect(), between)
    }
}

/// A frame with two axes that maps values to points on a canvas.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes {
    /// Rectangle of the frame. Labels are outside it, to the left and below.
    pub frame: Rect,
    /// Horizontal axis, from left to right.
    pub x: Axis,
    /// Vertical axis, from bottom to top.
    pub y: Axis,
    /// Text size (em) of the labels, canvas units.
    pub text_size: f64,
}

impl Axes {
    /// Creates a frame with two axes.
    #[must_use]
    pub fn new(frame: Rect, x: Axis, y: Axis) -> Self {
        Self { frame, x, y, text_size: 14.0 }
    }

    /// Returns the point on the canvas for two values.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> Point {
        [
            self.frame.left + self.x.share(x) * self.frame.width(),
            self.frame.bottom - self.y.share(y) * self.frame.height(),
        ]
    }

    /// Draws pale grid lines at the ticks. Call it before drawing the contents.
    pub fn draw_grid(&self, canvas: &mut Canvas) {
        let stroke = Stroke::new(Color::PALE, 0.8);
        for (value, _) in self.x.marks().0 {
            let [x, _] = self.at(value, self.y.from);
            canvas.line([x, self.frame.top], [x, self.frame.bottom], &stroke);
        }
        for (value, _) in self.y.marks().0 {
            let [_, y] = self.at(self.x.from, value);
            canvas.line([self.frame.left, y], [self.frame.right, y], &stroke);
        }
    }

    /// Draws the frame, its ticks, their labels and the names of the axes. Call it after drawing the contents.
    pub fn draw_frame(&self, canvas: &mut Canvas) {
        const TICK: f64 = 6.0;
        const SMALL: f64 = 3.5;
        let ink = Stroke::new(Color::INK, 1.1);
        let thin = Stroke::new(Color::INK, 0.8);
        let style = TextStyle::new(self.text_size);
        let Rect { left, bottom, .. } = self.frame;
        canvas.outline(&self.frame.corners(), &ink);
        let (labeled, small) = self.x.marks();
        for x in small.iter().map(|v| self.at(*v, self.y.from)[0]) {
            canvas.line([x, bottom], [x, bottom + SMALL], &thin);
        }
        for (value, label) in labeled {
            let [x, _] = self.at(value, self.y.from);
            canvas.line([x, bottom], [x, bottom + TICK], &ink);
            canvas.text([x, bottom + TICK + 4.0 + 2.0 * style.half_cap()], &label, &style.clone().middle());
        }
        let (labeled, small) = self.y.marks();
        for y in small.iter().map(|v| self.at(self.x.from, *v)[1]) {
            canvas.line([left, y], [left - SMALL, y], &thin);
        }
        let mut widest = 0.0_f64;
        for (value, label) in labeled {
            let [_, y] = self.at(self.x.from, value);
            canvas.line([left, y], [left - TICK, y], &ink);
            canvas.text([left - TICK - 4.0, y + style.half_cap()], &label, &style.clone().end());
            widest = widest.max(text_width(&label, self.text_size));
        }
        let name = TextStyle::new(self.text_size * 1.1).middle();
        let middle = 0.5 * (self.frame.left + self.frame.right);
        canvas.text([middle, bottom + TICK + 8.0 + 4.6 * style.half_cap() + 4.0], &self.x.label, &name);
        let middle = 0.5 * (self.frame.top + self.frame.bottom);
        canvas.text([left - TICK - 4.0 - widest - 11.0, middle], &self.y.label, &name.turned_deg(90.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_their_places_on_axes_that_run_either_way() {
        let axes = Axes::new(Rect::new(50.0, 10.0, 250.0, 110.0), Axis::new("V", 90.0, 20.0), Axis::new("n", 1.4, 1.9));
        assert_eq!(
            [axes.at(90.0, 1.4), axes.at(20.0, 1.9), axes.at(55.0, 1.4)],
            [[50.0, 110.0], [250.0, 10.0], [150.0, 110.0]]
        );
        let (labeled, small) = Axis::new("V", 90.0, 20.0).ticks(7, 2).marks();
        assert_eq!(labeled.len(), 8);
        assert_eq!(small, [25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 85.0]);
    }
}
