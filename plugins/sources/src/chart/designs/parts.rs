//! Parts that several charts share.

use super::super::drawing::{Align, Drawing};
use super::super::ink::{Ink, PATCHES};
use super::super::shape::{Rectangle, Ring, SiemensStar, Wedge};

/// The white of a good print.
pub const WHITE: Ink = Ink::Gray(0.9);
/// The black of a good print.
pub const BLACK: Ink = Ink::Gray(0.03);

/// Velvet black, darker than the darkest patch that it frames.
pub const FRAME: Ink = Ink::Gray(0.01);

/// Draws the 24 color patches around `center`: squares of `side` mm, at a pitch of `pitch` mm.
pub fn patch_block(drawing: &mut Drawing, center: [f64; 2], side: f64, pitch: f64) {
    for (i, name) in PATCHES.into_iter().enumerate() {
        let (column, row) = ((i % 6) as f64, (i / 6) as f64);
        let place = [center[0] + pitch * (column - 2.5), center[1] + pitch * (1.5 - row)];
        drawing.add(Rectangle::new(place, side, side), Ink::Patch(name));
        drawing.mark(name, place, 0.5 * side);
    }
}

/// Draws a black Siemens star with `cycles` filled sectors on the existing ground.
pub fn star(drawing: &mut Drawing, center: [f64; 2], radius: f64, cycles: u32) {
    drawing.add(SiemensStar::new(center, radius, cycles, 0.0), BLACK);
    drawing.mark("siemens star", center, radius);
}

/// Draws a square turned by `degrees` counterclockwise.
pub fn slanted_square(drawing: &mut Drawing, center: [f64; 2], side: f64, degrees: f64, ink: Ink) {
    drawing.add(Rectangle::new(center, side, side).turned(degrees.to_radians()), ink);
    drawing.mark(format!("slanted edge {degrees:+}"), center, 0.75 * side);
}

/// Converts a resolution of `hundreds` x 100 line widths per picture height to cycles per mm on a chart. The picture height is
/// `height`, mm.
pub fn frequency(hundreds: f64, height: f64) -> f64 {
    50.0 * hundreds / height
}

/// Draws a target for one point of the field, in a circle of `radius` mm: a star, edges slanted both ways, and lines. As seen
/// from the center of the chart, the lines on the far side are tangential and those on the near side radial.
pub fn field_target(drawing: &mut Drawing, center: [f64; 2], radius: f64) {
    let k = radius / 135.0;
    drawing.add(Ring::disk(center, radius), WHITE);
    drawing.add(Ring::new(center, radius - 1.25 * k, 2.5 * k), BLACK);
    star(drawing, center, 54.0 * k, 36);

    let outward = libm::atan2(center[1], center[0]);
    let radial = [libm::cos(outward), libm::sin(outward)];
    let tangent = [-radial[1], radial[0]];
    let at = |r: f64, t: f64| {
        [center[0] + r * k * radial[0] + t * k * tangent[0], center[1] + r * k * radial[1] + t * k * tangent[1]]
    };
    // The upper square leans one way, the lower one the other way.
    let up = if radial[0] >= 0.0 { 1.0 } else { -1.0 };
    slanted_square(drawing, at(0.0, 94.0 * up), 46.0 * k, 5.0, BLACK);
    slanted_square(drawing, at(0.0, -94.0 * up), 46.0 * k, -5.0, BLACK);

    for (middle, lines, stripe) in [(106.5, 12, 1.0), (81.5, 6, 2.0)] {
        drawing.add(Wedge::lines(at(middle, -23.0), at(middle, 23.0), lines, 2.0 * stripe * k), BLACK);
    }
    for (middle, lines, stripe) in [(12.5, 12, 1.0), (-12.5, 6, 2.0)] {
        drawing.add(Wedge::lines(at(-118.0, middle), at(-72.0, middle), lines, 2.0 * stripe * k), BLACK);
    }
}

/// Direction in which a wedge narrows.
#[derive(Clone, Copy, PartialEq)]
pub enum Narrowing {
    /// The wedge narrows toward -y, with figures on its right.
    Down,
    /// The wedge narrows toward +x, with figures above.
    Right,
    /// The wedge narrows toward -x, with figures above.
    Left,
}

/// Draws a hyperbolic wedge of 9 lines, `length` mm long, with its wide end at `start`. Its resolution runs from the first to the
/// last of `figures`, in hundreds of line widths per picture height. The picture height is `height`, mm. Each figure gets a tick
/// and a number.
pub fn wedge(drawing: &mut Drawing, start: [f64; 2], length: f64, narrowing: Narrowing, figures: &[u32], height: f64) {
    let [first, last] = [figures[0], figures[figures.len() - 1]].map(f64::from);
    let direction = match narrowing {
        Narrowing::Down => [0.0, -1.0],
        Narrowing::Right => [1.0, 0.0],
        Narrowing::Left => [-1.0, 0.0],
    };
    let along = |t: f64| [start[0] + t * direction[0], start[1] + t * direction[1]];
    let frequencies = [frequency(first, height), frequency(last, height)];
    drawing.add(Wedge::new(start, along(length), 9, frequencies), BLACK);
    for &figure in figures {
        let value = f64::from(figure);
        let [x, y] = along(length * (value - first) / (last - first));
        let half = 8.5 / (2.0 * frequency(value, height));
        let label = figure.to_string();
        if narrowing == Narrowing::Down {
            drawing.add(Rectangle::between([x + half + 2.0, y - 0.4], [x + half + 6.0, y + 0.4]), BLACK);
            drawing.text(&label, [x + half + 8.0, y - 4.0], 8.0, Align::Left, BLACK);
        } else {
            drawing.add(Rectangle::between([x - 0.4, y + half + 2.0], [x + 0.4, y + half + 6.0]), BLACK);
            drawing.text(&label, [x, y + half + 8.0], 8.0, Align::Center, BLACK);
        }
    }
}

/// Draws two square groups of five lines, one vertical and one horizontal, with their tops at `top`. Their resolution is
/// `hundreds` x 100 line widths per picture height `height`, mm.
///
/// The outer sides of the groups, at `x` and at `x + pitch`, face away from the center of the chart if `pitch` points toward it.
pub fn line_pair(drawing: &mut Drawing, [x, top]: [f64; 2], pitch: f64, hundreds: f64, height: f64) {
    let period = 1.0 / frequency(hundreds, height);
    let side = 4.5 * period;
    let inward = side * pitch.signum();
    let middle = top - 0.5 * side;
    let upright = x + 0.5 * inward;
    drawing.add(Wedge::lines([upright, top - side], [upright, top], 5, period), BLACK);
    let level = x + pitch;
    drawing.add(Wedge::lines([level, middle], [level + inward, middle], 5, period), BLACK);
}
